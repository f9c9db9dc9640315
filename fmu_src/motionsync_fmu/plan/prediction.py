"""What a machine can do at one length or at one line velocity, from the block's own predictions."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from motionsync.cut_to_length.machine_limits import (
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

from ..scenario.evaluate.expectations import Check
from .machine_data import ENDLESS_PITCH, MachineData
from .motor import MotorUse

SHARE = 0.01  # by which limits are raised, and times and distances reduced, to compute gains
TOLERANCE = 1e-9  # relative; nearer to a limit means at it
HALVINGS = 200

LENGTH, LINE = "length", "line velocity"
VELOCITY, ACCELERATION, JERK, STROKE = "velocity", "acceleration", "jerk", "stroke"
CYCLE, WAYS = "cycle time", "ways of approach, cut and gap"
LIMITS = {  # what limits the carriage, and the fields of the machine with these limits
    VELOCITY: ("max_velocity", "homing_velocity"),
    ACCELERATION: ("approach_acceleration", "homing_acceleration", "homing_deceleration"),
    JERK: ("approach_jerk", "homing_jerk"),
}
NEEDS = {  # what else takes time or distance in a cycle, and the fields of the machine
    "approach": ("approach_distance", "approach_reserve"),
    "settling": ("settle_time", "on_delay"),
    "cut": ("cut_time", "cut_distance"),
    "gap": ("gap_travel", "gap_distance"),
    "clearing": ("retract_time",),
    "rest at home": ("homing_settle_time",),
}


@dataclass(frozen=True)
class Cycle:
    """The parts of the shortest cycle in their sequence, in s."""

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
class Prediction:
    """The greatest line velocity at one length, or the shortest length at one line velocity.

    Attributes:
        given: LENGTH or LINE: which of the two is given; the other one is the result.
        length: of the pieces, in u of true material; None: at this line velocity no length is possible.
        velocity: of the line, in u/s of the master; 0: no velocity is possible.
        lost: the line velocity above which cuts are lost, or the length below which they are; between it and the
            result the approach's reserve is used up. None: there is no result.
        bound: what limits the result: VELOCITY or STROKE of the carriage, where longer pieces would not help, CYCLE, or
            WAYS, where a slower line would not help.
        gains: by what share of its value the result improves when a limit or need is relaxed by SHARE, by their names.
        cycle: the shortest cycle at this velocity; None: there is none.
        stroke: the distance from home that the carriage travels, in u.
        checks: what runs of the block were expected to do, and did; empty: it was not run.
        note: a limitation of the confirmation; empty: none.
        motor: what the carriage's motor has to give; None: there is no cycle, or the load is not known.
    """

    given: str
    length: float | None
    velocity: float
    lost: float | None
    bound: str
    gains: dict[str, float]
    cycle: Cycle | None
    stroke: float
    checks: list[Check] = field(default_factory=list)
    note: str = ""
    motor: MotorUse | None = None

    @property
    def is_confirmed(self) -> bool:
        """Whether the runs of the block did what was predicted."""
        return all(check.passed for check in self.checks)

    @property
    def limited_by(self) -> str:
        """The bound in words; of the cycle time with the limit of the carriage on which it depends most."""
        if self.bound == CYCLE and (greatest := max(LIMITS, key=lambda name: self.gains[name])):
            return f"{CYCLE}: {greatest}" if self.gains[greatest] else CYCLE
        return self.bound


def compute_cycle(machine: Machine, velocity: float) -> Cycle:
    """The parts of the shortest cycle at a line velocity > 0."""
    carriage = machine.coupling * velocity
    approach = 2.0 * approach_distance(machine, velocity) / carriage
    cut = machine.cut_distance / carriage if machine.by_distance else machine.cut_time
    sync, gap, rest = tool_time(machine, carriage, approach), gap_time(machine, carriage), machine.homing_settle_time
    settling = max(sync - cut - machine.retract_time, 0.0)
    home = cycle_time(machine, velocity) - approach - sync - gap - rest
    return Cycle(approach, settling, cut, gap, machine.retract_time, home, rest)


def relax_each(machine: Machine) -> Iterator[tuple[str, Machine]]:
    """Yield the machine with each of its limits raised, and with each of its needs reduced, by SHARE, with its name."""

    def scaled(fields: tuple[str, ...], factor: float) -> Machine:
        return replace(machine, **{name: factor * getattr(machine, name) for name in fields})

    for name, fields in LIMITS.items():
        yield name, scaled(fields, 1.0 + SHARE)
    travel = machine.max_position - machine.home_position
    yield STROKE, replace(machine, max_position=machine.max_position + SHARE * travel)
    for name, fields in NEEDS.items():
        yield name, scaled(fields, 1.0 - SHARE)


def is_lost(machine: Machine, velocity: float, pitch: float) -> bool:
    """Whether cuts of this pitch, in u of the master, are lost at this line velocity, which must be > 0 and admissible.

    A cycle that is longer than the pitch lets the next approach begin late, and be shorter by as much. Cuts are lost
    where that is shorter than the limits allow. Else the next cycle is shorter by twice as much, and the carriage has
    caught up; but where the tool's delay is waited for in sync, it is not, and each start is later than the one before.
    """
    late = machine.coupling * (shortest_pitch(machine, velocity) - pitch)
    distance = approach_distance(machine, velocity) - max(late, 0.0)
    if late <= 0.0 or distance < lead(machine, velocity):
        return late > 0.0
    return shortest_pitch(replace(machine, approach_distance=distance, approach_reserve=0.0), velocity) > pitch


def predict_greatest_velocity(data: MachineData, length: float) -> Prediction:
    """Predict the greatest line velocity at which pieces of this length can be cut."""
    machine, pitch = data.machine, data.pitch(length)
    velocity = max_line_velocity(machine, pitch)
    if velocity <= 0.0:
        return Prediction(LENGTH, length, 0.0, None, WAYS, {}, None, stroke(machine, 0.0))
    gains = {name: _gain(max_line_velocity(other, pitch), velocity) for name, other in relax_each(machine)}
    return Prediction(
        LENGTH,
        length,
        velocity,
        _find_boundary(velocity, data.greatest_velocity, lambda v: is_lost(machine, v, pitch)),
        find_bound(data, velocity),
        gains,
        compute_cycle(machine, velocity),
        stroke(machine, velocity),
    )


def predict_shortest_length(data: MachineData, velocity: float) -> Prediction:
    """Predict the length of the shortest pieces that can be cut at this line velocity, in u/s > 0."""
    machine = data.machine
    bound = find_bound(data, velocity / (1.0 + TOLERANCE))
    if bound != CYCLE:
        top = data.greatest_velocity
        gains = (
            {name: _gain(max_line_velocity(other, ENDLESS_PITCH), top) for name, other in relax_each(machine)}
            if top
            else {}
        )
        return Prediction(LINE, None, velocity, None, bound, gains, None, stroke(machine, velocity))
    pitch = shortest_pitch(machine, velocity)
    gains = {name: _gain(pitch, shortest_pitch(other, velocity)) for name, other in relax_each(machine)}
    lost = _find_boundary(pitch, 0.0, lambda p: is_lost(machine, velocity, p))
    return Prediction(
        LINE,
        max(data.length(pitch), 0.0),
        velocity,
        max(data.length(lost), 0.0),
        CYCLE,
        gains,
        compute_cycle(machine, velocity),
        stroke(machine, velocity),
    )


def _gain(better: float, worse: float) -> float:
    """By what share one value is greater than the other; 0 where that is rounding."""
    share = better / worse - 1.0
    return share if share > TOLERANCE else 0.0


def find_bound(data: MachineData, velocity: float) -> str:
    """What limits a line that is a little faster than this velocity, in u/s, however long the pieces are; CYCLE: only
    the cycle time does."""
    machine, more = data.machine, velocity * (1.0 + TOLERANCE)
    if machine.coupling * more > machine.max_velocity:
        return VELOCITY
    return CYCLE if is_admissible(machine, more) else STROKE


def _find_boundary(safe: float, lost: float, is_lost: Callable[[float], bool]) -> float:
    """The last value from `safe` towards `lost` at which no cut is lost, by bisection."""
    if not is_lost(lost):
        return lost
    for _ in range(HALVINGS):
        middle = 0.5 * (safe + lost)
        if middle in (safe, lost):
            break
        if is_lost(middle):
            lost = middle
        else:
            safe = middle
    return safe
