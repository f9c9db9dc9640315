"""A small block around the geometry of a rotary knife: for tests and measurements of the compiled code.

It is in a file of its own since a module of tests, whose functions are wrapped, cannot be compiled.
"""

from dataclasses import dataclass

from motionsync import var
from motionsync.rotary_knife.curves import Way
from motionsync.rotary_knife.knife import Knife
from motionsync.rotary_knife.limits import CycleLimit, EarliestCut, LengthLimits
from motionsync.rotary_knife.window import CurvePoint, Cut, Window


@dataclass(slots=True)
class KnifeGeometry:
    """`initialize` prepares two windows of a knife; `step` solves the limits of the pieces between them at a velocity,
    `times` times, and computes the slave where the master is `place` beyond the first cut."""

    times: int = 1
    factor: float = 1.0
    before: float = 20.0
    after: float = 20.0
    next_before: float = 20.0
    next_after: float = 20.0
    overspeed: float = 0.0
    velocity: float = 1000.0
    pitch: float = 600.0
    least: float = 600.0
    place: float = 0.0
    knife: Knife = var.part(Knife)  # noqa: RUF009
    leaving: Window = var.part(Window)  # noqa: RUF009
    cut: Cut = var.part(Cut)  # noqa: RUF009
    slave: CurvePoint = var.part(CurvePoint)  # noqa: RUF009
    way: Way = var.part(Way)  # noqa: RUF009
    cycle: CycleLimit = var.part(CycleLimit)  # noqa: RUF009
    ramp_up: CycleLimit = var.part(CycleLimit)  # noqa: RUF009
    lengths: LengthLimits = var.part(LengthLimits)  # noqa: RUF009
    turning: EarliestCut = var.part(EarliestCut)  # noqa: RUF009
    parking: EarliestCut = var.part(EarliestCut)  # noqa: RUF009

    def initialize(self) -> int:
        knife = self.knife
        self.leaving.set(knife, self.factor, self.before, self.after, self.overspeed)
        self.cut.window.set(knife, self.factor, self.next_before, self.next_after, self.overspeed)
        self.cut.place = self.pitch
        self.cut.position = knife.spacing
        self.lengths.prepare(knife, self.cut.window)
        return 0

    def step(self, h: float) -> int:
        knife = self.knife
        leaving = self.leaving
        for _ in range(self.times):
            self.cycle.solve_piece(knife, leaving, self.cut.window, self.pitch)
            self.ramp_up.solve_ramp_up(knife, self.cut.window)
            self.lengths.solve_shortest(knife, self.cut.window, self.velocity)
            self.way.plan(knife, leaving.after, leaving.end, self.cut, True)
            self.turning.search.start(leaving.after, leaving.end, self.cut)
            self.turning.find_turning(knife, self.velocity, self.least, self.pitch)
            self.parking.search.start(leaving.after, leaving.end, self.cut)
            self.parking.find_parking(knife, self.velocity, self.least)
        position, d1, d2, d3 = self.way.first.at(self.place)
        self.slave.set(position, d1, d2, d3)
        return 0
