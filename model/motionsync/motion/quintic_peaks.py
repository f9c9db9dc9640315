"""The greatest values of a quintic's derivatives, exact: nothing is sampled."""

from dataclasses import dataclass

from .. import var
from ..numerics.polynomial import Polynomial
from .laws import Quintic


@dataclass(slots=True)
class QuinticPeaks:
    """The greatest magnitudes of a quintic's first three derivatives over its whole length, and its least slope.

    Each is at an end of the curve, or where the next derivative is 0."""

    d1: float = 0.0
    d2: float = 0.0
    d3: float = 0.0
    least_d1: float = 0.0
    polynomial: Polynomial = var.part(Polynomial)

    def measure(self, curve: Quintic) -> None:
        """Measure a curve. On the way to the roots of the second derivative are those of the next two."""
        _, d1, d2, d3 = curve.at(0.0)
        self.d1 = abs(d1)
        self.d2 = abs(d2)
        self.d3 = abs(d3)
        self.least_d1 = d1
        self.include(curve, curve.length)
        polynomial = self.polynomial
        polynomial.degree = 3
        polynomial.coefficients[0] = 2.0 * curve.c2
        polynomial.coefficients[1] = 6.0 * curve.c3
        polynomial.coefficients[2] = 12.0 * curve.c4
        polynomial.coefficients[3] = 20.0 * curve.c5
        polynomial.start()
        for order in range(polynomial.leading - 1, -1, -1):
            polynomial.find_derivative_roots(order)
            for i in range(polynomial.root_count):
                self.include(curve, polynomial.roots[i] * curve.length)

    def include(self, curve: Quintic, x: float) -> None:
        """The curve's derivatives at x count."""
        _, d1, d2, d3 = curve.at(x)
        self.d1 = max(self.d1, abs(d1))
        self.d2 = max(self.d2, abs(d2))
        self.d3 = max(self.d3, abs(d3))
        self.least_d1 = min(self.least_d1, d1)
