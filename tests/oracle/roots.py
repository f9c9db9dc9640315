"""The real roots of a polynomial in (0, 1) from exact fractions: Descartes' rule of signs on halved intervals."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from math import comb

Exact = list[Fraction]
FINE = Fraction(1, 2**90)  # the precision of a root, to which two are distinguished


def at(f: Sequence[float | Fraction], u: Fraction) -> Fraction:
    value = Fraction(0)
    for c in reversed(f):
        value = value * u + Fraction(c)
    return value


def derivative(f: Sequence[float | Fraction], order: int = 1) -> Exact:
    exact = [Fraction(c) for c in f]
    for _ in range(order):
        exact = [n * c for n, c in enumerate(exact)][1:]
    return exact


def roots_inside(f: Sequence[float | Fraction]) -> Exact:
    """The distinct roots, ascending; none of a polynomial that is 0 everywhere."""
    exact = distinct(trimmed([Fraction(c) for c in f]))
    n = len(exact) - 1
    bernstein = [sum((comb(k, i) * exact[i] / comb(n, i) for i in range(k + 1)), Fraction(0)) for k in range(n + 1)]
    return list(isolated(exact, bernstein, Fraction(0), Fraction(1)))


def trimmed(f: Exact) -> Exact:
    while f and f[-1] == 0:
        f = f[:-1]
    return f


def divided(f: Exact, by: Exact) -> tuple[Exact, Exact]:
    """Quotient and remainder."""
    quotient = [Fraction(0)] * max(len(f) - len(by) + 1, 0)
    while len(f) >= len(by):
        shift, factor = len(f) - len(by), f[-1] / by[-1]
        quotient[shift] = factor
        f = trimmed([c - factor * (by[n - shift] if n >= shift else 0) for n, c in enumerate(f)][:-1])
    return quotient, f


def distinct(f: Exact) -> Exact:
    """The polynomial with the same roots, each only once: over its greatest common divisor with its derivative."""
    a, b = f, trimmed(derivative(f))
    while b:
        a, b = b, divided(a, b)[1]
    return divided(f, a)[0] if a else f


def isolated(f: Exact, bernstein: Exact, low: Fraction, high: Fraction) -> Iterator[Fraction]:
    """Bernstein's coefficients change their signs as often as there are roots, or an even number more."""
    signs = [b > 0 for b in bernstein if b != 0]
    changes = sum(a != b for a, b in pairwise(signs))
    if changes == 1:
        yield refined(f, low, high, signs[-1])
    if changes < 2 or high - low < FINE:
        return
    left: Exact = []
    right: Exact = []
    row = bernstein
    while row:
        left.append(row[0])
        right.insert(0, row[-1])
        row = [(a + b) / 2 for a, b in pairwise(row)]
    middle = (low + high) / 2
    yield from isolated(f, left, low, middle)
    if right[0] == 0:
        yield middle
    yield from isolated(f, right, middle, high)


def refined(f: Exact, low: Fraction, high: Fraction, rising: bool) -> Fraction:
    while high - low > FINE:
        middle = (low + high) / 2
        value = at(f, middle)
        if value == 0:
            return middle
        low, high = (low, middle) if (value > 0) == rising else (middle, high)
    return (low + high) / 2
