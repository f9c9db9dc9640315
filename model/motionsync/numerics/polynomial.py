"""The real roots of a polynomial inside (0, 1), to rounding.

Between two roots of its derivative a polynomial is monotone: a change of sign there brackets exactly one root. So the
roots of the highest derivative, a straight line, lead down to those of the polynomial itself.
"""

from dataclasses import dataclass
from math import isfinite

from .. import var

TERMS = 7  # coefficients of the highest degree
EPSILON = 1.0 / 4503599627370496.0  # 2^-52
ROUNDING = 256.0 * EPSILON  # of the coefficients' magnitudes: a sum that should be 0 is not greater than this
ITERATIONS = 100  # six as a rule; a root next to 0 may need more, and is then 1e-18 off at most


@dataclass(slots=True)
class Polynomial:
    """f(u) = sum of coefficients[n] u^n, n = 0 to degree <= 6; its roots, ascending, are roots[0] to roots[count - 1].

    `chain` holds the scaled coefficients of f and, from TERMS k on, those of its k-th derivative; `leading` is the
    degree of f without leading zeros.
    """

    degree: int = 0
    coefficients: list[float] = var.array(7)
    root_count: int = 0
    roots: list[float] = var.array(6)
    chain: list[float] = var.array(49)
    leading: int = 0

    def differentiate(self) -> None:
        """Make f its derivative."""
        for n in range(self.degree):
            self.coefficients[n] = (n + 1.0) * self.coefficients[n + 1]
        self.coefficients[self.degree] = 0.0
        self.degree = max(self.degree - 1, 0)

    def coefficient_sum(self) -> float:
        """Sum of the coefficients' magnitudes: |f| is not greater in [0, 1]."""
        size = 0.0
        for n in range(self.degree + 1):
            size += abs(self.coefficients[n])
        return size

    def solve(self) -> None:
        """Find the roots with 0 < u < 1; there are none where f is 0 everywhere or a coefficient is not finite.

        f(0) is used exactly. f(1), and f at the derivative's roots, count as 0 within rounding: a root at 1 is not
        reported, and two roots closer than rounding are reported once.
        """
        self.start()
        for order in range(self.leading - 1, -1, -1):
            self.find_derivative_roots(order)

    def start(self) -> None:
        """Fill the chain, scaled where squares would leave a double's range, and find the degree; no root is known yet.

        The degree is 0, which means no roots, where f is 0 everywhere or a coefficient is not finite."""
        self.root_count = 0
        self.leading = 0
        size = self.coefficient_sum()
        if not isfinite(size) or size == 0.0:
            return
        scale = 1.0 if 1e-100 < size < 1e100 else size
        for n in range(self.degree + 1):
            self.chain[n] = self.coefficients[n] / scale
            if self.chain[n] != 0.0:
                self.leading = n
        for order in range(1, self.leading):
            at = TERMS * order
            for n in range(self.leading - order + 1):
                self.chain[at + n] = (n + 1.0) * self.chain[at - TERMS + n + 1]

    def find_derivative_roots(self, order: int) -> None:
        """Find the roots of the derivative of that order from those of the next derivative.

        The latter cut (0, 1) into intervals on which the derivative is monotone. Each root is read before a new one is
        stored in its element."""
        degree = self.leading - order
        cuts = self.root_count
        root_count = 0
        low = 0.0
        before = self.chain[TERMS * order]
        for n in range(cuts + 1):
            high = self.roots[n] if n < cuts else 1.0
            after = self.value(order, degree, high)
            crossing = before < 0.0 < after or after < 0.0 < before
            root = self.find_root_between(order, degree, low, high, before < 0.0) if crossing else high
            if (crossing or after == 0.0) and 0.0 < root < 1.0:
                self.roots[root_count] = root
                root_count += 1
            low = high
            before = after
        self.root_count = root_count

    def value(self, order: int, degree: int, u: float) -> float:
        """The derivative of that order at u, or 0 if it is within the rounding of its terms; at u = 1 the rounding of
        the coefficients themselves counts too."""
        at = TERMS * order
        value = self.chain[at + degree]
        terms = abs(value)
        n = at + degree
        while n > at:
            n -= 1
            value = value * u + self.chain[n]
            terms = terms * u + abs(self.chain[n])
        return 0.0 if abs(value) <= (ROUNDING if u == 1.0 else degree * EPSILON) * terms else value

    def find_root_between(self, order: int, degree: int, low: float, high: float, rising: bool) -> float:
        """The root between two values of opposite signs.

        A Newton step is taken if it stays inside and is at most half as long as the step before, a bisection otherwise.
        The search ends with the step from where the value is within the rounding of its terms."""
        at = TERMS * order
        step = high - low
        u = low + 0.5 * step
        for _ in range(ITERATIONS):
            value = self.chain[at + degree]
            derivative = 0.0
            terms = abs(value)
            n = at + degree
            while n > at:
                n -= 1
                derivative = derivative * u + value
                value = value * u + self.chain[n]
                terms = terms * u + abs(self.chain[n])
            if (value > 0.0) == rising:
                high = u
            else:
                low = u
            newton = u - value / derivative if derivative != 0.0 else u
            inside = low < newton < high
            if abs(value) <= degree * EPSILON * terms:
                return newton if inside else u
            if inside and 2.0 * abs(newton - u) < step:
                step = abs(newton - u)
                u = newton
            else:
                step = 0.5 * (high - low)
                u = low + step
                if u <= low or u >= high:
                    break
        return u
