"""Confirms predictions: the block is run just below and just above them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from motionsync.cut_to_length.limits import shortest_pitch
from motionsync.var import Unit

from ..interface.units import unit_name
from ..scenario.judge import Check
from .machine_data import MachineData
from .prediction import LENGTH, NEAR, Point, cycle_at
from .simulation import PIECES, Run, arrival, simulate

ASIDE = 1e-6  # relative: how far beside a prediction the block is run
SLOW = 1e-3  # of the greatest line velocity
MANY = 200  # pieces, within which a start that is late by ASIDE of a pitch comes to be too late
SAME_TIME = 1e-9  # relative
LEAST_LENGTH = 1e-6  # u; what is shorter is no length to the block
GAP_SKIPPED = "the gap exceeds the axis's limits at this velocity: the block leaves it out, and its cycle is shorter"


def confirmed(data: MachineData, point: Point) -> Point:
    """The point with what runs of the block were expected to do, and did."""
    if point.length is None:
        return replace(point, checks=[_nothing_is_cut(data, point.velocity)])
    if point.velocity <= 0.0:
        return replace(point, checks=[_is_always_too_fast(data, point.length)])
    if point.length <= LEAST_LENGTH:
        return point
    result = point.velocity if point.asked == LENGTH else point.length
    sides = _Sides(data, point)
    below = sides.run(result, -ASIDE)
    made = Check(f"{sides.told(result, -ASIDE)}: every cut is made", below.text, below.made and not below.warned)
    if below.gap_skipped:
        return replace(point, checks=[made], remark=GAP_SKIPPED)
    return replace(point, checks=[made, _cycle(data, point), *_above(sides, result, point.lost or 0.0)])


@dataclass(frozen=True)
class _Sides:
    """The block, run beside a point. What is `more` asks more of it: a faster line, or a shorter pitch."""

    data: MachineData
    point: Point

    def place(self, result: float, more: float) -> tuple[float, float]:
        """Length and line velocity of a run."""
        assert self.point.length is not None
        if self.point.asked == LENGTH:
            return self.point.length, result * (1.0 + more)
        return self.data.length(self.data.pitch(result) / (1.0 + more)), self.point.velocity * (1.0 - NEAR)

    def run(self, result: float, more: float, pieces: int = PIECES) -> Run:
        return simulate(self.data, *self.place(result, more), pieces)

    def told(self, result: float, more: float) -> str:
        """Length and line velocity of a run, in words."""
        length, velocity = self.place(result, more)
        names = (unit_name(kind, self.data.unit) for kind in (Unit.POSITION, Unit.VELOCITY))
        u, v = (f" {name}" if name else "" for name in names)
        return f"pieces of {length:.9g}{u} at {velocity:.9g}{v}"


def _above(sides: _Sides, result: float, lost: float) -> Iterator[Check]:
    """What has to happen above the point: a warning at once; cuts are missed as soon as the reserve is used up."""
    has_reserve = abs(lost - result) > 3.0 * ASIDE * result
    warned = "line_too_fast stands before a cut is missed"
    if has_reserve:
        for value, more in ((result, ASIDE), (lost, -ASIDE)):
            run = sides.run(value, more)
            yield Check(f"{sides.told(value, more)}: {warned}, and none is", run.text, run.made and run.warned)
    if lost > LEAST_LENGTH:
        run = sides.run(lost, ASIDE, MANY)
        yield Check(f"{sides.told(lost, ASIDE)}: {warned}, and some are", run.text, run.warned and run.skipped > 0)


def _cycle(data: MachineData, point: Point) -> Check:
    """The carriage comes home as long after the start of its approach as is predicted."""
    velocity = point.velocity * (1.0 - NEAR)  # an admissible one, rounded or not
    cycle = cycle_at(data.machine, velocity)
    expected, found = cycle.time - cycle.rest, arrival(data, velocity)
    return Check(
        f"the carriage is at home {expected:.9g} s after the start of its approach",
        f"{found:.9g} s",
        abs(found - expected) <= SAME_TIME * expected,
    )


def _is_always_too_fast(data: MachineData, length: float) -> Check:
    """Pieces shorter than the ways of a cycle are too short for a line of any velocity."""
    run = simulate(data, length, SLOW * data.greatest_velocity)
    return Check(f"pieces of {length:.9g} on a slow line: line_too_fast stands", run.text, run.warned)


def _nothing_is_cut(data: MachineData, velocity: float) -> Check:
    """A line too fast for the carriage, or for its stroke, has every cut skipped, however long the pieces are."""
    length = data.length(2.0 * shortest_pitch(data.machine, velocity))
    run = simulate(data, length, velocity)
    return Check(f"at {velocity:.9g}: no cut is made, however long the pieces", run.text, run.skipped > 0 == run.cuts)
