"""Numbers of 50 digits: each operation is rounded to 169 bits, by MPFR (gmpy2).

gmpy2 keeps the precision of operations in a context, of which each thread has its own. `mpf`, with which every
computation begins, sets it; nothing else in the project uses it.
"""

from collections.abc import Sequence
from typing import Any, TypeAlias

import gmpy2  # type: ignore[import-untyped]
import numpy as np

Number: TypeAlias = Any
"""An mpfr of gmpy2."""
Ratio: TypeAlias = Any
"""An mpq of gmpy2: an exact fraction, as those of Python, in a quarter of the time."""

BITS = 169
EXTRA_BITS = 160
"""By which roots are computed more precisely: a double root has half the digits of a polynomial's coefficients."""

floor, ceil, nint, sign = gmpy2.floor, gmpy2.ceil, gmpy2.rint, gmpy2.sign
cos, sin, exp, isfinite, mpq = gmpy2.cos, gmpy2.sin, gmpy2.exp, gmpy2.is_finite, gmpy2.mpq
asin, cbrt = gmpy2.asin, gmpy2.cbrt


def mpf(value: Any = 0) -> Number:
    """A number from one of Python's or an mpq, as exact as 50 digits are, or from a text."""
    context = gmpy2.get_context()
    if context.precision != BITS:
        context.precision = BITS
        context.trap_divzero = True
    return gmpy2.mpfr(value) if isinstance(value, str) else ONE * value  # in a quarter of the time


ONE = mpf("1")
ZERO, inf = mpf(0), mpf("inf")
pi = gmpy2.const_pi(BITS)
EPSILON = mpf(2) ** -BITS
"""The relative error of an operation."""
MOST_ITERATIONS = 2000


def sqrt(value: Any) -> Number:
    """Raises ValueError below 0."""
    if value < 0:
        raise ValueError(f"the root of {value} is not a real number")
    return gmpy2.sqrt(value)


def factorial(n: int) -> Number:
    return mpf(gmpy2.fac(n))


def solve_linear(matrix: Sequence[Sequence[Number]], values: Sequence[Number]) -> list[Number]:
    """The solution of a system of linear equations, by elimination with the greatest pivot of each column."""
    rows = [[*row, value] for row, value in zip(matrix, values, strict=True)]
    for column in range(len(rows)):
        greatest = max(range(column, len(rows)), key=lambda i: abs(rows[i][column]))
        rows[column], rows[greatest] = rows[greatest], rows[column]
        pivot = [x / rows[column][column] for x in rows[column]]
        rows = [
            pivot if i == column else [x - row[column] * p for x, p in zip(row, pivot, strict=True)]
            for i, row in enumerate(rows)
        ]
    return [row[-1] for row in rows]


def roots(polynomial: Sequence[Number]) -> list[tuple[Number, Number]]:
    """Real and imaginary parts of all roots of a polynomial, coefficients in rising order, the last one not 0.

    Durand and Kerner's method, from numpy's roots. Of a root of multiplicity m, 1/m of the digits are right.

    Raises:
        ArithmeticError: it does not converge.
    """
    maximum = max(abs(c) for c in polynomial)
    rough = np.roots([float(c / maximum) for c in reversed(polynomial)])
    with gmpy2.context(gmpy2.get_context(), precision=BITS + EXTRA_BITS):
        result = [gmpy2.mpc(complex(root)) + gmpy2.mpc(0, 1e-9 * (i + 1)) for i, root in enumerate(rough)]
        for _ in range(MOST_ITERATIONS):
            greatest = ZERO
            for i, root in enumerate(result):
                step = ZERO
                for coefficient in reversed(polynomial):
                    step = step * root + coefficient
                step /= polynomial[-1]
                for other in (*result[:i], *result[i + 1 :]):
                    step /= root - other if root != other else 1
                result[i] = root - step
                greatest = max(greatest, abs(step))
            if greatest < EPSILON:
                return [(root.real, root.imag) for root in result]
    raise ArithmeticError(f"the roots of {polynomial} do not converge")
