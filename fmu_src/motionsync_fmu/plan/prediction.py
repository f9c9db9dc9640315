"""What a machine can do at one length or at one line velocity, from the block's own predictions."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from motionsync.cut_to_length.limits import (
    Machine,
    approach_distance,
    cycle_time,
    gap_time,
    is_admissible,
    lead,
    max_line_velocity,
    shortest_pitch,
    stroke,
    tool_time,
)

from ..scenario.judge import Check
from .machine_data import NO_PITCH, MachineData

SHARE = 0.01  # by which limits are raised, and times and ways cut down, to see what it brings
NEAR = 1e-9  # relative; nearer to a limit means at it
HALVINGS = 200

LENGTH, LINE = "length", "line velocity"
VELOCITY, ACCELERATION, JERK, STROKE = "velocity", "acceleration", "jerk", "stroke"
CYCLE, WAYS = "cycle time", "ways of approach, cut and gap"
LIMITS = {  # what limits the carriage, and the machine's data that say how far
    VELOCITY: ("max_velocity", "homing_velocity"),
    ACCELERATION: ("approach_acceleration", "homing_acceleration", "homing_deceleration"),
    JERK: ("approach_jerk", "homing_jerk"),
}
NEEDS = {  # what else a cycle is made of
    "approach": ("approach_distance", "approach_reserve"),
    "settling": ("settle_time", "on_delay"),
    "cut": ("cut_time", "cut_distance"),
    "gap": ("gap_travel", "gap_distance"),
    "clearing": ("retract_time",),
    "rest at home": ("homing_settle_time",),
}


@dataclass(frozen=True)
class Cycle:
    """The parts of the shortest cycle, in the order in which they come, in s."""

    approach: float
    settling: float
    cut: float
    gap: float
    clearing: float
    way_home: float
    rest: float

    @property
    def parts(self) -> dict[str, float]:
        """The parts by their names."""
        return {name.replace("_", " "): value for name, value in vars(self).items()}

    @property
    def time(self) -> float:
        """From the start of one approach to the earliest start of the next, in s."""
        return math.fsum(vars(self).values())


@dataclass(frozen=True)
class Point:
    """What a machine can do at one length, or at one line velocity.

    Attributes:
        asked: LENGTH or LINE: which of the two was given; the other one is the result.
        length: of the pieces, in u of true material; None: at this line velocity no length is possible.
        velocity: of the line, in u/s of the master; 0: no velocity is possible.
        lost: the line velocity above which cuts are lost, or the length below which they are; between it and the
            result the approach's reserve is used up. None: there is no result.
        bound: what limits it: VELOCITY or STROKE of the carriage, where longer pieces would not help, CYCLE, or WAYS,
            where a slower line would not help.
        gains: of all that was relaxed by SHARE, by what share of its value the result improves.
        cycle: the shortest cycle at this velocity; None: there is none.
        stroke: the way from home that it takes, in u.
        checks: what runs of the block were expected to do, and did; none: it was not run.
        remark: what has to be known beside; empty: nothing.
    """

    asked: str
    length: float | None
    velocity: float
    lost: float | None
    bound: str
    gains: dict[str, float]
    cycle: Cycle | None
    stroke: float
    checks: list[Check] = field(default_factory=list)
    remark: str = ""

    @property
    def confirmed(self) -> bool:
        """Whether the runs of the block did what was predicted."""
        return all(check.passed for check in self.checks)

    @property
    def limited_by(self) -> str:
        """The bound in words; of the cycle time with the limit of the carriage on which it depends most."""
        if self.bound == CYCLE and (greatest := max(LIMITS, key=lambda name: self.gains[name])):
            return f"{CYCLE}: {greatest}" if self.gains[greatest] else CYCLE
        return self.bound


def cycle_at(machine: Machine, velocity: float) -> Cycle:
    """The parts of the shortest cycle at a line velocity > 0."""
    carriage = machine.coupling * velocity
    approach = 2.0 * approach_distance(machine, velocity) / carriage
    cut = machine.cut_distance / carriage if machine.by_distance else machine.cut_time
    sync, gap, rest = tool_time(machine, carriage, approach), gap_time(machine, carriage), machine.homing_settle_time
    settling = max(sync - cut - machine.retract_time, 0.0)
    home = cycle_time(machine, velocity) - approach - sync - gap - rest
    return Cycle(approach, settling, cut, gap, machine.retract_time, home, rest)


def relaxed(machine: Machine) -> Iterator[tuple[str, Machine]]:
    """The machine with each of its limits raised by SHARE, and with each of its needs cut down by so much."""

    def scaled(fields: tuple[str, ...], factor: float) -> Machine:
        return replace(machine, **{name: factor * getattr(machine, name) for name in fields})

    for name, fields in LIMITS.items():
        yield name, scaled(fields, 1.0 + SHARE)
    room = machine.max_position - machine.home_position
    yield STROKE, replace(machine, max_position=machine.max_position + SHARE * room)
    for name, fields in NEEDS.items():
        yield name, scaled(fields, 1.0 - SHARE)


def is_lost(machine: Machine, velocity: float, pitch: float) -> bool:
    """Whether cuts of this pitch, in u of the master, are lost at this line velocity, which may be > 0 and admissible.

    A cycle that is longer than the pitch lets the next approach begin late, and be shorter by as much. Cuts are lost
    where that is shorter than the limits allow. Else the next cycle is shorter by twice as much, and the carriage has
    caught up; but where the tool's delay is waited for in sync, it is not, and each start is later than the one before.
    """
    late = machine.coupling * (shortest_pitch(machine, velocity) - pitch)
    distance = approach_distance(machine, velocity) - max(late, 0.0)
    if late <= 0.0 or distance < lead(machine, velocity):
        return late > 0.0
    return shortest_pitch(replace(machine, approach_distance=distance, approach_reserve=0.0), velocity) > pitch


def fastest(data: MachineData, length: float) -> Point:
    """The greatest line velocity at which pieces of this length can be cut."""
    machine, pitch = data.machine, data.pitch(length)
    velocity = max_line_velocity(machine, pitch)
    if velocity <= 0.0:
        return Point(LENGTH, length, 0.0, None, WAYS, {}, None, stroke(machine, 0.0))
    gains = {name: _gain(max_line_velocity(other, pitch), velocity) for name, other in relaxed(machine)}
    return Point(
        LENGTH,
        length,
        velocity,
        _boundary(velocity, data.greatest_velocity, lambda v: is_lost(machine, v, pitch)),
        bound_at(data, velocity),
        gains,
        cycle_at(machine, velocity),
        stroke(machine, velocity),
    )


def shortest(data: MachineData, velocity: float) -> Point:
    """The shortest pieces that can be cut at this line velocity, in u/s > 0."""
    machine = data.machine
    bound = bound_at(data, velocity / (1.0 + NEAR))
    if bound != CYCLE:
        top = data.greatest_velocity
        gains = (
            {name: _gain(max_line_velocity(other, NO_PITCH), top) for name, other in relaxed(machine)} if top else {}
        )
        return Point(LINE, None, velocity, None, bound, gains, None, stroke(machine, velocity))
    pitch = shortest_pitch(machine, velocity)
    gains = {name: _gain(pitch, shortest_pitch(other, velocity)) for name, other in relaxed(machine)}
    lost = _boundary(pitch, 0.0, lambda p: is_lost(machine, velocity, p))
    return Point(
        LINE,
        max(data.length(pitch), 0.0),
        velocity,
        max(data.length(lost), 0.0),
        CYCLE,
        gains,
        cycle_at(machine, velocity),
        stroke(machine, velocity),
    )


def _gain(better: float, worse: float) -> float:
    """By what share one value is greater than the other; 0 where that is rounding."""
    share = better / worse - 1.0
    return share if share > NEAR else 0.0


def bound_at(data: MachineData, velocity: float) -> str:
    """What limits a line that is a little faster than this velocity, in u/s, however long the pieces are; CYCLE: no
    more than the cycle time does."""
    machine, more = data.machine, velocity * (1.0 + NEAR)
    if machine.coupling * more > machine.max_velocity:
        return VELOCITY
    return CYCLE if is_admissible(machine, more) else STROKE


def _boundary(kept: float, lost: float, is_lost: Callable[[float], bool]) -> float:
    """The last value from `kept` towards `lost` at which nothing is lost, by bisection."""
    if not is_lost(lost):
        return lost
    for _ in range(HALVINGS):
        middle = 0.5 * (kept + lost)
        if middle in (kept, lost):
            break
        if is_lost(middle):
            lost = middle
        else:
            kept = middle
    return kept
