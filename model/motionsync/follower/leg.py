"""One phase's law: the slave's position over the master's. Source: Robox mv_follow2, phases of the cycle.

Master positions and travels are in master units (M), slave positions in slave units (S).
"""

from dataclasses import dataclass

from .. import var
from ..laws import Quintic, half_ramp
from ..limits import clamp
from ..polynomial import Polynomial
from ..var import Enumeration

FAR = 1e300  # beyond every position of the master


class Shape(Enumeration):
    """Of a law"""

    REST = 0, "standstill"
    LINE = 1, "constant ratio"
    RAMP_UP = 2, "simple jerk ramp from rest"
    RAMP_DOWN = 3, "simple jerk ramp to rest"
    QUINTIC = 4, "polynomial of order 5"


@dataclass(slots=True)
class Leg:
    """The slave from the master's position `begin` (M) to `end`, where the next phase begins.

    `length` is the law's own master travel, which differs from end - begin by rounding only; `position` is the slave's
    at the beginning, `space` its travel on a ramp (S), `ratio` its slope at a ramp's fast end and on a line (S/M).
    """

    shape: Shape = Shape.REST
    begin: float = 0.0
    end: float = 0.0
    length: float = 1.0
    position: float = 0.0
    space: float = 0.0
    ratio: float = 1.0
    quintic: Quintic = var.part(Quintic)

    def rest(self, begin: float, end: float, position: float) -> None:
        self.lay(Shape.REST, begin, end, 1.0, position)

    def rest_for_ever(self, begin: float, position: float) -> None:
        self.rest(begin, FAR, position)

    def line(self, begin: float, end: float, position: float, ratio: float) -> None:
        self.lay(Shape.LINE, begin, end, 1.0, position)
        self.ratio = ratio

    def ramp_up(self, end: float, position: float, space: float, ratio: float) -> None:
        """position + 2 space q(u) over the travel 2 space / ratio: slope 0 to `ratio`, twice the slave's way."""
        length = 2.0 * space / ratio
        self.lay(Shape.RAMP_UP, end - length, end, length, position)
        self.space = space
        self.ratio = ratio

    def ramp_down(self, begin: float, position: float, space: float, ratio: float) -> None:
        """position + 2 space (u - q(u)) over the travel 2 space / ratio: slope `ratio` to 0."""
        length = 2.0 * space / ratio
        self.lay(Shape.RAMP_DOWN, begin, begin + length, length, position)
        self.space = space
        self.ratio = ratio

    def curve(
        self,
        begin: float,
        end: float,
        length: float,
        position: float,
        slope: float,
        curvature: float,
        target: float,
        end_slope: float,
    ) -> None:
        """The quintic from (position, slope, curvature) to (target, end_slope, 0); slopes in S/M, curvature in S/M2."""
        self.lay(Shape.QUINTIC, begin, end, length, position)
        self.quintic.fit(length, position, slope, curvature, target, end_slope, 0.0)

    def lay(self, shape: Shape, begin: float, end: float, length: float, position: float) -> None:
        self.shape = shape
        self.begin = begin
        self.end = end
        self.length = length
        self.position = position

    def at(self, master: float) -> tuple[float, float, float, float]:
        """Position (S) and its first three derivatives with respect to the master (S/M, S/M2, S/M3)."""
        way = master - self.begin
        match self.shape:
            case Shape.LINE:
                return self.position + self.ratio * way, self.ratio, 0.0, 0.0
            case Shape.RAMP_UP:
                q, slope, curvature, twist = half_ramp(clamp(way / self.length, 0.0, 1.0))
                return self.ramp(2.0 * self.space * q, slope, curvature, twist)
            case Shape.RAMP_DOWN:
                u = clamp(way / self.length, 0.0, 1.0)
                q, slope, curvature, twist = half_ramp(u)
                return self.ramp(2.0 * self.space * (u - q), 1.0 - slope, -curvature, -twist)
            case Shape.QUINTIC:
                return self.quintic.at(clamp(way, 0.0, self.length))
            case _:
                return self.position, 0.0, 0.0, 0.0

    def ramp(self, way: float, slope: float, curvature: float, twist: float) -> tuple[float, float, float, float]:
        """From derivatives by u of a law whose fast end has the slope 1."""
        return (
            self.position + way,
            self.ratio * slope,
            self.ratio * curvature / self.length,
            self.ratio * twist / self.length / self.length,
        )

    def progress(self, master: float) -> float:
        """Share of the phase's master travel that is done; 0 where it has no end."""
        travel = self.end - self.begin
        return clamp((master - self.begin) / travel, 0.0, 1.0) if 0.0 < travel < FAR else 0.0

    def shift(self, turned: float) -> None:
        """The master's positions count from elsewhere."""
        self.begin -= turned
        self.end -= turned

    def take(self, other: "Leg") -> None:
        """Become a copy of the other."""
        self.lay(other.shape, other.begin, other.end, other.length, other.position)
        self.space = other.space
        self.ratio = other.ratio
        var.copy(self.quintic, other.quintic)


@dataclass(slots=True)
class Peaks:
    """The greatest |s'| (S/M) and |s''| (S/M2) of a quintic over its whole length."""

    slope: float = 0.0
    curvature: float = 0.0
    polynomial: Polynomial = var.part(Polynomial)

    def measure(self, curve: Quintic) -> None:
        """At both ends and where the next derivative vanishes."""
        self.slope = 0.0
        self.curvature = 0.0
        for order in range(2, 4):
            self.differentiate(curve, order)
            self.polynomial.solve()
            self.look(curve, 0.0)
            self.look(curve, curve.length)
            for i in range(self.polynomial.count):
                self.look(curve, self.polynomial.roots[i] * curve.length)

    def differentiate(self, curve: Quintic, order: int) -> None:
        """The polynomial becomes that derivative of the curve, by u."""
        self.polynomial.degree = 5
        self.polynomial.coefficients[0] = curve.c0
        self.polynomial.coefficients[1] = curve.c1
        self.polynomial.coefficients[2] = curve.c2
        self.polynomial.coefficients[3] = curve.c3
        self.polynomial.coefficients[4] = curve.c4
        self.polynomial.coefficients[5] = curve.c5
        for _ in range(order):
            self.polynomial.differentiate()

    def look(self, curve: Quintic, x: float) -> None:
        _, slope, curvature, _ = curve.at(x)
        self.slope = max(self.slope, abs(slope))
        self.curvature = max(self.curvature, abs(curvature))
