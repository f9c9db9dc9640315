"""The greatest values of a quintic's derivatives, exact: nothing is sampled."""

from dataclasses import dataclass

from . import var
from .laws import Quintic
from .polynomial import Polynomial


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
        """Measure a curve."""
        _, d1, d2, d3 = curve.at(0.0)
        self.d1 = abs(d1)
        self.d2 = abs(d2)
        self.d3 = abs(d3)
        self.least_d1 = d1
        self.include(curve, curve.length)
        for order in range(2, 5):
            self.differentiate(curve, order)
            self.polynomial.solve()
            for i in range(self.polynomial.root_count):
                self.include(curve, self.polynomial.roots[i] * curve.length)

    def differentiate(self, curve: Quintic, order: int) -> None:
        """The polynomial becomes the curve's derivative of that order, by u."""
        self.polynomial.degree = 5
        self.polynomial.coefficients[0] = curve.c0
        self.polynomial.coefficients[1] = curve.c1
        self.polynomial.coefficients[2] = curve.c2
        self.polynomial.coefficients[3] = curve.c3
        self.polynomial.coefficients[4] = curve.c4
        self.polynomial.coefficients[5] = curve.c5
        for _ in range(order):
            self.polynomial.differentiate()

    def include(self, curve: Quintic, x: float) -> None:
        """The curve's derivatives at x count."""
        _, d1, d2, d3 = curve.at(x)
        self.d1 = max(self.d1, abs(d1))
        self.d2 = max(self.d2, abs(d2))
        self.d3 = max(self.d3, abs(d3))
        self.least_d1 = min(self.least_d1, d1)
