"""A section of the slave's cam: one law of its position over the master's. Source: Robox mv_follow2.

Master positions and travels are in master units (M), slave positions in slave units (S); d1, d2, d3 are the derivatives
of the slave's position by the master's (S/M, S/M2, S/M3).
"""

from dataclasses import dataclass

from .. import var
from ..motion.laws import Quintic, half_ramp, half_ramp_mirrored
from ..numerics.computable_range import clamp
from ..var import Enumeration

FAR = 1e300  # beyond every position of the master


class Shape(Enumeration):
    """The law of a section"""

    REST = 0, "standstill"
    LINE = 1, "constant ratio"
    RAMP_UP = 2, "simple jerk ramp from rest"
    RAMP_DOWN = 3, "simple jerk ramp to rest"
    QUINTIC = 4, "polynomial of order 5"


@dataclass(slots=True)
class CamSection:
    """The slave's law from the master's position `begin` (M) to `end`, where the next section starts.

    `length` is the master travel of the law itself, which differs from end - begin by rounding only. `position` is the
    slave's position at `begin`. Of a ramp, `stroke` is the slave's travel (S). `ratio` is d1 on a line and at the fast
    end of a ramp (S/M).
    """

    shape: Shape = Shape.REST
    begin: float = 0.0
    end: float = 0.0
    length: float = 1.0
    position: float = 0.0
    stroke: float = 0.0
    ratio: float = 1.0
    quintic: Quintic = var.part(Quintic)

    def set_rest(self, begin: float, end: float, position: float) -> None:
        """The slave is at rest; without end if `end` is FAR."""
        self.set_law(Shape.REST, begin, end, 1.0, position)

    def set_line(self, begin: float, end: float, position: float, ratio: float) -> None:
        """The slave runs with `ratio` times the master's velocity."""
        self.set_law(Shape.LINE, begin, end, 1.0, position)
        self.ratio = ratio

    def set_ramp_up(self, end: float, position: float, stroke: float, ratio: float) -> None:
        """position + 2 stroke q(u): d1 goes from 0 to `ratio` while the master travels 2 stroke / ratio."""
        length = 2.0 * stroke / ratio
        self.set_law(Shape.RAMP_UP, end - length, end, length, position)
        self.stroke = stroke
        self.ratio = ratio

    def set_ramp_down(self, begin: float, position: float, stroke: float, ratio: float) -> None:
        """position + 2 stroke (u - q(u)): d1 goes from `ratio` to 0 while the master travels 2 stroke / ratio."""
        length = 2.0 * stroke / ratio
        self.set_law(Shape.RAMP_DOWN, begin, begin + length, length, position)
        self.stroke = stroke
        self.ratio = ratio

    def set_quintic(
        self,
        begin: float,
        end: float,
        length: float,
        position: float,
        d1: float,
        d2: float,
        target: float,
        target_d1: float,
    ) -> None:
        """The quintic from (position, d1, d2) to (target, target_d1, 0)."""
        self.set_law(Shape.QUINTIC, begin, end, length, position)
        self.quintic.fit(length, position, d1, d2, target, target_d1, 0.0)

    def set_law(self, shape: Shape, begin: float, end: float, length: float, position: float) -> None:
        """Set what the laws have in common."""
        self.shape = shape
        self.begin = begin
        self.end = end
        self.length = length
        self.position = position

    def at(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position (S) and d1, d2, d3 with the master at that position (M)."""
        travel = master - self.begin
        match self.shape:
            case Shape.LINE:
                return self.position + self.ratio * travel, self.ratio, 0.0, 0.0
            case Shape.RAMP_UP:
                q, d1, d2, d3 = half_ramp(clamp(travel / self.length, 0.0, 1.0))
                return self.ramp_at(q, d1, d2, d3)
            case Shape.RAMP_DOWN:
                q, d1, d2, d3 = half_ramp_mirrored(clamp(travel / self.length, 0.0, 1.0))
                return self.ramp_at(q, d1, d2, d3)
            case Shape.QUINTIC:
                return self.quintic.at(clamp(travel, 0.0, self.length))
            case _:
                return self.position, 0.0, 0.0, 0.0

    def at_or_before(self, master: float) -> tuple[float, float, float, float]:
        """As `at`; before the section the slave goes on as at its beginning, with the same d1."""
        missing = max(self.begin - master, 0.0)
        position, d1, d2, d3 = self.at(max(master, self.begin))
        if missing == 0.0:
            return position, d1, d2, d3
        return position - d1 * missing, d1, 0.0, 0.0

    def ramp_at(self, q: float, d1: float, d2: float, d3: float) -> tuple[float, float, float, float]:
        """As `at`, from a ramp law over u = 0 to 1 and its derivatives by u: 1/2 long, with d1 = 1 at its fast end."""
        return (
            self.position + 2.0 * self.stroke * q,
            self.ratio * d1,
            self.ratio * d2 / self.length,
            self.ratio * d3 / self.length / self.length,
        )

    def progress(self, master: float) -> float:
        """Share of the section that the master has travelled, 0 to 1; 0 in a section without end."""
        travel = self.end - self.begin
        return clamp((master - self.begin) / travel, 0.0, 1.0) if 0.0 < travel < FAR else 0.0

    def shift(self, dropped: float) -> None:
        """The master's positions are from now on smaller by `dropped`."""
        self.begin -= dropped
        self.end -= dropped
