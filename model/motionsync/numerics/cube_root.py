"""The cube root, from + - * / and the square root alone: the platforms' C libraries do not agree on its last bits."""

from math import sqrt

ITERATIONS = 20  # a bound that no search comes near: three are usual
CONVERGED = 1e-6  # of the root: the error after a step that is no longer is below 1e-17 of it


def cube_root(x: float) -> float:
    """The cube root of 0 <= x <= 1e300, within 4e-16 of its magnitude.

    Halley's method, of third order. It starts at x^(1/4 + 1/16 + 1/64), the first terms of x^(1/3)."""
    if x <= 0.0:
        return 0.0
    fourth = sqrt(sqrt(x))
    sixteenth = sqrt(sqrt(fourth))
    root = fourth * sixteenth * sqrt(sqrt(sixteenth))
    for _ in range(ITERATIONS):
        cube = root * root * root
        step = root * ((cube - x) / (2.0 * cube + x))
        root -= step
        if abs(step) <= CONVERGED * root:
            break
    return root
