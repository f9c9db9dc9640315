"""The tunable parameters that the machine computes with: which of them is out of its range, and the last good ones.

A parameter may be tuned at any time and to any value. The block computes with the `Settings`. There are four groups, by
what reads them: the machine's cycle, the pieces, the command start, the marks. The settings take over the values of a
group only if all of them are good.
"""

from dataclasses import dataclass

from .. import var
from ..axis_limits import limit_in_use
from ..limits import LEAST_LIMIT, MOST, usable
from .interface import (
    Approach,
    ChangeMode,
    CutToLengthInterface,
    Gap,
    Homing,
    LateMode,
    Mark,
    SawAxis,
    StartMode,
    Tool,
    ToolMode,
)
from .limits import Machine
from .tunables import Tunable

LONGEST = 1e6  # s
GREATEST_RESERVE = 1e6


@dataclass(slots=True)
class Settings:
    """The values of the tunable parameters when their group was good last.

    Attributes:
        bad_machine, bad_pieces, bad_start, bad_marks: the first parameter of each group that is out of its range.
        factor: true travel of the material per travel of the master, calibration included.
    """

    bad_machine: Tunable = Tunable.NONE
    bad_pieces: Tunable = Tunable.NONE
    bad_start: Tunable = Tunable.NONE
    bad_marks: Tunable = Tunable.NONE
    factor: float = 1.0

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
    start_mode: StartMode = StartMode.FRONT
    change_mode: ChangeMode = ChangeMode.NEXT_PIECE
    late_mode: LateMode = LateMode.SKIP

    def are_those_of(self, block: CutToLengthInterface) -> bool:
        """Whether no parameter has been tuned since they were taken."""
        return (
            is_same_axis(self.axis, block.axis)
            and is_same_approach(self.approach, block.approach)
            and is_same_homing(self.homing, block.homing)
            and is_same_tool(self.tool, block.tool)
            and is_same_gap(self.gap, block.gap)
            and is_same_mark(self.mark, block.mark)
            and self.home_position == block.home_position
            and self.material_factor == block.material_factor
            and self.kerf == block.kerf
            and self.length_tolerance == block.length_tolerance
            and self.front_position == block.front_position
            and self.trim_length == block.trim_length
            and self.sample_length == block.sample_length
            and self.waste_length == block.waste_length
            and self.batch_size == block.batch_size
            and self.margin == block.line.margin
            and self.start_mode == block.start_mode
            and self.change_mode == block.change_mode
            and self.late_mode == block.late_mode
        )

    def judge(self, block: CutToLengthInterface) -> None:
        """Judge the block's parameters, and take over each group that is good."""
        self.bad_machine = first_bad_of_machine(block)
        self.bad_pieces = first_bad_of_pieces(block)
        self.bad_start = first_bad_of_start(block)
        self.bad_marks = first_bad_of_marks(block.mark)
        if self.bad_machine == Tunable.NONE:
            self.take_machine(block)
        if self.bad_pieces == Tunable.NONE:
            self.take_pieces(block)
        if self.bad_start == Tunable.NONE:
            self.start_mode = block.start_mode
            self.front_position = block.front_position
            self.trim_length = block.trim_length
        if self.bad_marks == Tunable.NONE:
            var.copy(self.mark, block.mark)

    def take_machine(self, block: CutToLengthInterface) -> None:
        """Take over what a cycle is computed from."""
        var.copy(self.axis, block.axis)
        var.copy(self.approach, block.approach)
        var.copy(self.homing, block.homing)
        var.copy(self.tool, block.tool)
        var.copy(self.gap, block.gap)
        self.home_position = block.home_position
        self.material_factor = block.material_factor
        self.margin = block.line.margin
        self.late_mode = block.late_mode

    def take_pieces(self, block: CutToLengthInterface) -> None:
        """Take over what a piece is fixed and judged with."""
        self.kerf = block.kerf
        self.length_tolerance = block.length_tolerance
        self.sample_length = block.sample_length
        self.waste_length = block.waste_length
        self.batch_size = block.batch_size
        self.change_mode = block.change_mode

    def first_bad(self) -> Tunable:
        """The first parameter of all that is out of its range; NONE if all are good."""
        bad = judged(self.bad_machine, self.bad_pieces == Tunable.NONE, self.bad_pieces)
        bad = judged(bad, self.bad_start == Tunable.NONE, self.bad_start)
        return judged(bad, self.bad_marks == Tunable.NONE, self.bad_marks)

    def can_fix(self) -> bool:
        """Whether all is good that a piece is fixed with."""
        return self.bad_pieces == Tunable.NONE and self.bad_machine != Tunable.MATERIAL_FACTOR

    def can_start(self) -> bool:
        """Whether all is good that the command start reads."""
        return self.can_fix() and self.bad_machine == Tunable.NONE and self.bad_start == Tunable.NONE

    def describe(self, machine: Machine, factor: float, cosine: float) -> None:
        """Put the limits in use into what a cycle is computed from; `factor` is found by calibration, `cosine` that of
        the diagonal angle."""
        self.factor = self.material_factor * factor
        axis = self.axis
        deceleration = axis.deceleration()
        machine.coupling = self.factor / cosine
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


def first_bad_of_machine(block: CutToLengthInterface) -> Tunable:
    """Of what a cycle is computed from. NaN is out of every range."""
    bad = judged(Tunable.NONE, usable(block.material_factor * block.calibration.factor), Tunable.MATERIAL_FACTOR)
    if bad == Tunable.NONE:
        bad = first_bad_of_axis(block.axis, block.home_position)
    if bad == Tunable.NONE:
        bad = first_bad_of_approach(block.approach)
    if bad == Tunable.NONE:
        bad = first_bad_of_homing(block.homing)
    if bad == Tunable.NONE:
        bad = first_bad_of_tool(block.tool, block.gap)
    bad = judged(bad, 0.0 <= block.line.margin < 1.0, Tunable.MARGIN)
    return judged(bad, LateMode.SKIP <= block.late_mode <= LateMode.STOP_LINE, Tunable.LATE_MODE)


def first_bad_of_axis(axis: SawAxis, home: float) -> Tunable:
    low = axis.min_position
    high = axis.max_position
    bad = judged(Tunable.NONE, -MOST <= low <= home <= high <= MOST, Tunable.HOME_POSITION)
    bad = judged(bad, usable(axis.max_velocity), Tunable.MAX_VELOCITY)
    bad = judged(bad, usable(axis.max_acceleration), Tunable.MAX_ACCELERATION)
    bad = judged(bad, usable_or_0(axis.max_deceleration), Tunable.MAX_DECELERATION)
    return judged(bad, usable(axis.max_jerk), Tunable.MAX_JERK)


def first_bad_of_approach(approach: Approach) -> Tunable:
    bad = judged(Tunable.NONE, 0.0 <= approach.distance <= MOST, Tunable.APPROACH_DISTANCE)
    bad = judged(bad, 0.0 <= approach.reserve <= GREATEST_RESERVE, Tunable.APPROACH_RESERVE)
    bad = judged(bad, usable_or_0(approach.acceleration), Tunable.APPROACH_ACCELERATION)
    return judged(bad, usable_or_0(approach.jerk), Tunable.APPROACH_JERK)


def first_bad_of_homing(homing: Homing) -> Tunable:
    bad = judged(Tunable.NONE, usable_or_0(homing.velocity), Tunable.HOMING_VELOCITY)
    bad = judged(bad, usable_or_0(homing.acceleration), Tunable.HOMING_ACCELERATION)
    bad = judged(bad, usable_or_0(homing.deceleration), Tunable.HOMING_DECELERATION)
    bad = judged(bad, usable_or_0(homing.jerk), Tunable.HOMING_JERK)
    bad = judged(bad, 0.0 <= homing.settle_time <= LONGEST, Tunable.HOMING_SETTLE_TIME)
    bad = judged(bad, 0.0 <= homing.spare_time <= LONGEST, Tunable.HOMING_SPARE_TIME)
    return judged(bad, 0.0 < homing.slowest <= 1.0, Tunable.HOMING_SLOWEST)


def first_bad_of_tool(tool: Tool, gap: Gap) -> Tunable:
    bad = judged(Tunable.NONE, 0.0 <= tool.settle_time <= LONGEST, Tunable.SETTLE_TIME)
    bad = judged(bad, 0.0 <= tool.on_delay <= LONGEST, Tunable.ON_DELAY)
    bad = judged(bad, 0.0 <= tool.cut_time <= LONGEST, Tunable.CUT_TIME)
    bad = judged(bad, 0.0 <= tool.cut_distance <= MOST, Tunable.CUT_DISTANCE)
    bad = judged(bad, 0.0 <= tool.retract_time <= LONGEST, Tunable.RETRACT_TIME)
    bad = judged(bad, 0.0 <= tool.timeout <= LONGEST, Tunable.TIMEOUT)
    bad = judged(bad, 0.0 <= gap.distance <= MOST, Tunable.GAP_DISTANCE)
    return judged(bad, LEAST_LIMIT <= gap.travel <= MOST, Tunable.GAP_TRAVEL)


def first_bad_of_pieces(block: CutToLengthInterface) -> Tunable:
    """Of what a piece is fixed and judged with."""
    bad = judged(Tunable.NONE, 0.0 <= block.kerf <= MOST, Tunable.KERF)
    bad = judged(bad, 0.0 <= block.length_tolerance <= MOST, Tunable.LENGTH_TOLERANCE)
    bad = judged(bad, LEAST_LIMIT <= block.sample_length <= MOST, Tunable.SAMPLE_LENGTH)
    bad = judged(bad, LEAST_LIMIT <= block.waste_length <= MOST, Tunable.WASTE_LENGTH)
    bad = judged(bad, block.batch_size >= 0, Tunable.BATCH_SIZE)
    return judged(bad, ChangeMode.NEXT_PIECE <= block.change_mode <= ChangeMode.THIS_PIECE, Tunable.CHANGE_MODE)


def first_bad_of_start(block: CutToLengthInterface) -> Tunable:
    """Of what the command start reads."""
    bad = judged(Tunable.NONE, StartMode.FRONT <= block.start_mode <= StartMode.CONTINUE, Tunable.START_MODE)
    bad = judged(bad, abs(block.front_position) <= MOST, Tunable.FRONT_POSITION)
    trims = block.start_mode == StartMode.TRIM
    return judged(bad, not trims or 0.0 <= block.trim_length <= MOST, Tunable.TRIM_LENGTH)


def first_bad_of_marks(mark: Mark) -> Tunable:
    bad = judged(Tunable.NONE, abs(mark.sensor_distance) <= MOST, Tunable.SENSOR_DISTANCE)
    bad = judged(bad, abs(mark.cut_offset) <= MOST, Tunable.CUT_OFFSET)
    bad = judged(bad, 0.0 <= mark.spacing <= MOST, Tunable.SPACING)
    bad = judged(bad, 0.0 <= mark.window <= MOST and is_narrow(mark), Tunable.WINDOW)
    bad = judged(bad, mark.every >= 1, Tunable.EVERY)
    bad = judged(bad, mark.max_missing >= 0, Tunable.MAX_MISSING)
    return judged(bad, 0.0 <= mark.delay <= LONGEST, Tunable.MARK_DELAY)


def judged(bad: Tunable, good: bool, parameter: Tunable) -> Tunable:
    """The bad parameter found before; without one this parameter, unless it is good."""
    return bad if bad != Tunable.NONE or good else parameter


def is_narrow(mark: Mark) -> bool:
    """Whether the windows of two marks that follow one another do not meet."""
    return mark.spacing == 0.0 or mark.window < 0.5 * mark.spacing


def usable_or_0(limit: float) -> bool:
    """Whether a limit is good, of which 0 stands for another one."""
    return limit == 0.0 or usable(limit)
