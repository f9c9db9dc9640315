"""The tunable parameters that the machine computes with: which of them is out of its range, and the last good ones.

A parameter may be tuned at any time and to any value. The block computes with the `Settings`, which take over new
values only if all of them are good.
"""

from dataclasses import dataclass

from .. import var
from ..axis_limits import limit_in_use
from ..limits import LEAST_LIMIT, MOST, usable
from .interface import Approach, CutToLengthInterface, Gap, Homing, Mark, SawAxis, Tool, ToolMode
from .limits import Machine
from .tunables import Tunable

LONGEST = 1e6  # s


@dataclass(slots=True)
class Settings:
    """The values of the tunable parameters when all of them were good last."""

    axis: SawAxis = var.part(SawAxis, hidden=True)
    approach: Approach = var.part(Approach, hidden=True)
    homing: Homing = var.part(Homing, hidden=True)
    tool: Tool = var.part(Tool, hidden=True)
    gap: Gap = var.part(Gap, hidden=True)
    mark: Mark = var.part(Mark, hidden=True)
    home_position: float = 0.0
    material_factor: float = 1.0
    kerf: float = 0.0
    length_tolerance: float = 0.5
    front_position: float = 0.0
    trim_length: float = 0.0
    sample_length: float = 100.0
    waste_length: float = 100.0
    batch_size: int = 0
    margin: float = 0.02

    def are_those_of(self, block: CutToLengthInterface) -> bool:
        """Whether no parameter has been tuned since they were taken."""
        return (
            self.home_position == block.home_position
            and self.material_factor == block.material_factor
            and self.kerf == block.kerf
            and self.length_tolerance == block.length_tolerance
            and self.front_position == block.front_position
            and self.trim_length == block.trim_length
            and self.sample_length == block.sample_length
            and self.waste_length == block.waste_length
            and self.batch_size == block.batch_size
            and self.margin == block.line.margin
            and is_same_axis(self.axis, block.axis)
            and is_same_approach(self.approach, block.approach)
            and is_same_homing(self.homing, block.homing)
            and is_same_tool(self.tool, block.tool)
            and is_same_gap(self.gap, block.gap)
            and is_same_mark(self.mark, block.mark)
        )

    def take(self, block: CutToLengthInterface) -> None:
        """Take over the block's parameters, all of which are good."""
        var.copy(self.axis, block.axis)
        var.copy(self.approach, block.approach)
        var.copy(self.homing, block.homing)
        var.copy(self.tool, block.tool)
        var.copy(self.gap, block.gap)
        var.copy(self.mark, block.mark)
        self.home_position = block.home_position
        self.material_factor = block.material_factor
        self.kerf = block.kerf
        self.length_tolerance = block.length_tolerance
        self.front_position = block.front_position
        self.trim_length = block.trim_length
        self.sample_length = block.sample_length
        self.waste_length = block.waste_length
        self.batch_size = block.batch_size
        self.margin = block.line.margin

    def describe(self, machine: Machine, factor: float, cosine: float) -> None:
        """Put the limits in use into what a cycle is computed from; `factor` is found by calibration, `cosine` that of
        the diagonal angle."""
        axis = self.axis
        deceleration = axis.deceleration()
        machine.coupling = self.material_factor * factor / cosine
        machine.home_position = self.home_position
        machine.max_position = axis.max_position
        machine.max_velocity = axis.max_velocity
        machine.approach_distance = self.approach.distance
        machine.approach_reserve = self.approach.reserve
        machine.approach_acceleration = limit_in_use(self.approach.acceleration, axis.max_acceleration)
        machine.approach_jerk = limit_in_use(self.approach.jerk, axis.max_jerk)
        machine.homing_velocity = limit_in_use(self.homing.velocity, axis.max_velocity)
        machine.homing_acceleration = limit_in_use(self.homing.acceleration, axis.max_acceleration)
        machine.homing_deceleration = limit_in_use(self.homing.deceleration, deceleration)
        machine.homing_jerk = limit_in_use(self.homing.jerk, axis.max_jerk)
        machine.homing_settle_time = self.homing.settle_time
        machine.by_distance = self.tool.mode == ToolMode.DISTANCE
        machine.cut_time = self.tool.cut_time
        machine.cut_distance = self.tool.cut_distance
        machine.settle_time = self.tool.settle_time
        machine.on_delay = self.tool.on_delay
        machine.retract_time = self.tool.retract_time
        machine.gap_distance = self.gap.distance
        machine.gap_travel = self.gap.travel


def is_same_axis(a: SawAxis, b: SawAxis) -> bool:
    return (
        a.max_velocity == b.max_velocity
        and a.max_acceleration == b.max_acceleration
        and a.max_deceleration == b.max_deceleration
        and a.max_jerk == b.max_jerk
        and a.min_position == b.min_position
        and a.max_position == b.max_position
    )


def is_same_approach(a: Approach, b: Approach) -> bool:
    return a.distance == b.distance and a.reserve == b.reserve and a.acceleration == b.acceleration and a.jerk == b.jerk


def is_same_homing(a: Homing, b: Homing) -> bool:
    return (
        a.velocity == b.velocity
        and a.acceleration == b.acceleration
        and a.deceleration == b.deceleration
        and a.jerk == b.jerk
        and a.settle_time == b.settle_time
        and a.spare_time == b.spare_time
        and a.slowest == b.slowest
    )


def is_same_tool(a: Tool, b: Tool) -> bool:
    return (
        a.settle_time == b.settle_time
        and a.on_delay == b.on_delay
        and a.cut_time == b.cut_time
        and a.cut_distance == b.cut_distance
        and a.retract_time == b.retract_time
        and a.timeout == b.timeout
    )


def is_same_gap(a: Gap, b: Gap) -> bool:
    return a.distance == b.distance and a.travel == b.travel


def is_same_mark(a: Mark, b: Mark) -> bool:
    return (
        a.sensor_distance == b.sensor_distance
        and a.cut_offset == b.cut_offset
        and a.spacing == b.spacing
        and a.window == b.window
        and a.every == b.every
        and a.max_missing == b.max_missing
        and a.delay == b.delay
    )


def first_bad(block: CutToLengthInterface) -> Tunable:
    """The first parameter that is out of its range; NONE if all are good. NaN is out of every range."""
    bad = first_bad_of_machine(block)
    if bad == Tunable.NONE:
        bad = first_bad_of_cycle(block)
    if bad == Tunable.NONE:
        bad = first_bad_of_pieces(block)
    return first_bad_of_marks(block.mark) if bad == Tunable.NONE else bad


def first_bad_of_machine(block: CutToLengthInterface) -> Tunable:
    """The axis, where it waits, and what it cuts."""
    axis = block.axis
    if not (-MOST <= axis.min_position <= block.home_position and block.home_position <= axis.max_position <= MOST):
        return Tunable.HOME_POSITION
    if not usable(block.material_factor * block.calibration.factor):
        return Tunable.MATERIAL_FACTOR
    if not usable(axis.max_velocity):
        return Tunable.MAX_VELOCITY
    if not usable(axis.max_acceleration):
        return Tunable.MAX_ACCELERATION
    if not usable_or_0(axis.max_deceleration):
        return Tunable.MAX_DECELERATION
    if not usable(axis.max_jerk):
        return Tunable.MAX_JERK
    return Tunable.NONE if 0.0 <= block.line.margin < 1.0 else Tunable.MARGIN


def first_bad_of_cycle(block: CutToLengthInterface) -> Tunable:
    """The approach, the way home, the tool and the gap."""
    bad = first_bad_of_approach(block.approach)
    if bad == Tunable.NONE:
        bad = first_bad_of_homing(block.homing)
    if bad == Tunable.NONE:
        bad = first_bad_of_tool(block.tool)
    if bad != Tunable.NONE:
        return bad
    if not 0.0 <= block.gap.distance <= MOST:
        return Tunable.GAP_DISTANCE
    return Tunable.NONE if LEAST_LIMIT <= block.gap.travel <= MOST else Tunable.GAP_TRAVEL


def first_bad_of_approach(approach: Approach) -> Tunable:
    if not 0.0 <= approach.distance <= MOST:
        return Tunable.APPROACH_DISTANCE
    if not 0.0 <= approach.reserve <= 1e6:
        return Tunable.APPROACH_RESERVE
    if not usable_or_0(approach.acceleration):
        return Tunable.APPROACH_ACCELERATION
    return Tunable.NONE if usable_or_0(approach.jerk) else Tunable.APPROACH_JERK


def first_bad_of_homing(homing: Homing) -> Tunable:
    if not usable_or_0(homing.velocity):
        return Tunable.HOMING_VELOCITY
    if not usable_or_0(homing.acceleration):
        return Tunable.HOMING_ACCELERATION
    if not usable_or_0(homing.deceleration):
        return Tunable.HOMING_DECELERATION
    if not usable_or_0(homing.jerk):
        return Tunable.HOMING_JERK
    if not 0.0 <= homing.settle_time <= LONGEST:
        return Tunable.HOMING_SETTLE_TIME
    if not 0.0 <= homing.spare_time <= LONGEST:
        return Tunable.HOMING_SPARE_TIME
    return Tunable.NONE if 0.0 < homing.slowest <= 1.0 else Tunable.HOMING_SLOWEST


def first_bad_of_tool(tool: Tool) -> Tunable:
    if not 0.0 <= tool.settle_time <= LONGEST:
        return Tunable.SETTLE_TIME
    if not 0.0 <= tool.on_delay <= LONGEST:
        return Tunable.ON_DELAY
    if not 0.0 <= tool.cut_time <= LONGEST:
        return Tunable.CUT_TIME
    if not 0.0 <= tool.cut_distance <= MOST:
        return Tunable.CUT_DISTANCE
    if not 0.0 <= tool.retract_time <= LONGEST:
        return Tunable.RETRACT_TIME
    return Tunable.NONE if 0.0 <= tool.timeout <= LONGEST else Tunable.TIMEOUT


def first_bad_of_pieces(block: CutToLengthInterface) -> Tunable:
    """What a piece is measured with."""
    if not 0.0 <= block.kerf <= MOST:
        return Tunable.KERF
    if not 0.0 <= block.length_tolerance <= MOST:
        return Tunable.LENGTH_TOLERANCE
    if not abs(block.front_position) <= MOST:
        return Tunable.FRONT_POSITION
    if not 0.0 <= block.trim_length <= MOST:
        return Tunable.TRIM_LENGTH
    if not LEAST_LIMIT <= block.sample_length <= MOST:
        return Tunable.SAMPLE_LENGTH
    if not LEAST_LIMIT <= block.waste_length <= MOST:
        return Tunable.WASTE_LENGTH
    return Tunable.NONE if block.batch_size >= 0 else Tunable.BATCH_SIZE


def first_bad_of_marks(mark: Mark) -> Tunable:
    if not abs(mark.sensor_distance) <= MOST:
        return Tunable.SENSOR_DISTANCE
    if not abs(mark.cut_offset) <= MOST:
        return Tunable.CUT_OFFSET
    if not 0.0 <= mark.spacing <= MOST:
        return Tunable.SPACING
    if not (0.0 <= mark.window <= MOST and is_narrow(mark)):
        return Tunable.WINDOW
    if mark.every < 1:
        return Tunable.EVERY
    if mark.max_missing < 0:
        return Tunable.MAX_MISSING
    return Tunable.NONE if 0.0 <= mark.delay <= LONGEST else Tunable.MARK_DELAY


def is_narrow(mark: Mark) -> bool:
    """Whether the windows of two marks that follow one another do not meet."""
    return mark.spacing == 0.0 or mark.window < 0.5 * mark.spacing


def usable_or_0(limit: float) -> bool:
    """Whether a limit is good, of which 0 stands for another one."""
    return limit == 0.0 or usable(limit)
