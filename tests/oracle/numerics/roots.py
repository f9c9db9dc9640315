"""The real roots of a polynomial in (0, 1), exactly: Descartes' rule of signs on halved intervals, in whole numbers."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import comb, gcd, lcm

from tests.oracle.numerics.mp import Ratio, mpq

Exact = list[Ratio]
Whole = list[int]  # coefficients of a polynomial, times any factor > 0
FINE = 90  # a root has this precision, in bits, to which two are distinguished


def at(f: Sequence[float | Ratio], u: Ratio) -> Ratio:
    value = mpq(0)
    for c in reversed(f):
        value = value * u + mpq(c)
    return value


def derivative(f: Sequence[float | Ratio], order: int = 1) -> Exact:
    exact = [mpq(c) for c in f]
    for _ in range(order):
        exact = [n * c for n, c in enumerate(exact)][1:]
    return exact


def roots_inside(f: Sequence[float | Ratio]) -> Exact:
    """The distinct roots, ascending; none of a polynomial that is 0 everywhere."""
    fractions = [mpq(c) for c in f]
    factor = lcm(*(c.denominator for c in fractions))
    whole = distinct(reduced([int(c * factor) for c in fractions]))
    n = len(whole) - 1
    factor = lcm(*(comb(n, i) for i in range(n + 1)))
    bernstein = [sum(comb(k, i) * whole[i] * factor // comb(n, i) for i in range(k + 1)) for k in range(n + 1)]
    return list(isolated(whole, bernstein, 0, 0))


def reduced(f: Whole) -> Whole:
    """Without leading zeros and without a common factor."""
    while f and f[-1] == 0:
        f = f[:-1]
    common = gcd(*f)
    return [c // common for c in f]


def divided(f: Whole, by: Whole) -> tuple[Whole, Whole]:
    """Quotient and remainder of f, times a power of the divisor's leading coefficient that leaves them whole."""
    quotient = [0] * max(len(f) - len(by) + 1, 0)
    for shift in reversed(range(len(quotient))):
        leading = f[-1]
        quotient = [by[-1] * q for q in quotient]
        quotient[shift] = leading
        f = [by[-1] * c - leading * (by[n - shift] if n >= shift else 0) for n, c in enumerate(f)][:-1]
    return quotient, f


def distinct(f: Whole) -> Whole:
    """The polynomial with the same roots, each only once: over its greatest common divisor with its derivative."""
    a, b = f, reduced([n * c for n, c in enumerate(f)][1:])
    while b:
        a, b = b, reduced(divided(a, b)[1])
    return reduced(divided(f, a)[0]) if a else f


def isolated(f: Whole, bernstein: Whole, number: int, bits: int) -> Iterator[Ratio]:
    """The roots from number / 2^bits to (number + 1) / 2^bits. Bernstein's coefficients there, times any factor > 0,
    change their signs as often as there are roots, or an even number more."""
    signs = [b > 0 for b in bernstein if b != 0]
    changes = sum(a != b for a, b in pairwise(signs))
    if changes == 1:
        yield refined(f, number, bits, signs[-1])
    if changes < 2 or bits > FINE:
        return
    left: Whole = []
    right: Whole = []
    row = bernstein
    while row:
        left.append(row[0] << len(row) - 1)
        right.insert(0, row[-1] << len(row) - 1)
        row = [a + b for a, b in pairwise(row)]
    yield from isolated(f, left, 2 * number, bits + 1)
    if right[0] == 0:
        yield mpq(2 * number + 1, 2 << bits)
    yield from isolated(f, right, 2 * number + 1, bits + 1)


def refined(f: Whole, number: int, bits: int, rising: bool) -> Ratio:
    while bits < FINE:
        number, bits = 2 * number + 1, bits + 1  # the middle
        value = 0
        for i, c in enumerate(reversed(f)):
            value = value * number + (c << bits * i)
        if value == 0:
            return mpq(number, 1 << bits)
        if (value > 0) == rising:
            number -= 1
    return mpq(2 * number + 1, 2 << bits)
