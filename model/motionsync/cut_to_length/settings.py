"""The tunable parameters of the machine: validated, and taken over if all of them are valid."""

from dataclasses import dataclass

from .. import var
from ..cutting.interface import LateMode
from ..cutting.settings import LONGEST, PieceParameter, PieceSettings, has_narrow_window
from ..motion.axis_limits import AxisLimits, limit_in_use
from ..numerics.computable_range import LARGEST, is_usable
from .faults import Refusal, SawParameter
from .interface import Approach, CutToLengthInterface, Gap, Homing, Tool, ToolMode
from .machine_limits import Machine

GREATEST_RESERVE = 1e6


@dataclass(slots=True)
class MachineSettings:
    """The values of the machine's tunable parameters when all were valid last.

    Attributes:
        invalid: the first parameter that is out of its range.
        are_valid: no parameter is out of its range, those of pieces included.
    """

    invalid: SawParameter = SawParameter.NONE
    are_valid: bool = True
    axis: AxisLimits = var.part(AxisLimits, hidden=True)
    approach: Approach = var.part(Approach, hidden=True)
    homing: Homing = var.part(Homing, hidden=True)
    tool: Tool = var.part(Tool, hidden=True)
    gap: Gap = var.part(Gap, hidden=True)
    home_position: float = 0.0
    material_factor: float = 1.0
    margin: float = 0.02
    late_mode: LateMode = LateMode.SKIP

    def are_current(self, block: CutToLengthInterface, pieces: PieceSettings) -> bool:
        """Whether no parameter has been tuned since the settings were taken over."""
        return (
            var.same(self.axis, block.axis)
            and var.same(self.approach, block.approach)
            and var.same(self.homing, block.homing)
            and is_same_tool(self.tool, block.tool)
            and var.same(self.gap, block.gap)
            and self.home_position == block.home_position
            and self.material_factor == block.material_factor
            and self.margin == block.line.margin
            and self.late_mode == block.late_mode
            and pieces.has_piece(
                block.kerf,
                block.length_tolerance,
                block.sample_length,
                block.waste_length,
                block.batch_size,
                block.change_mode,
            )
            and pieces.has_start(block.start_mode, block.front_position, block.trim_length)
            and pieces.has_mark(block.mark)
        )

    def update(self, block: CutToLengthInterface, pieces: PieceSettings) -> None:
        """Validate the block's parameters, and take over those of each group in which all are valid."""
        self.invalid = first_invalid(block)
        if self.invalid == SawParameter.NONE:
            var.copy(self.axis, block.axis)
            var.copy(self.approach, block.approach)
            var.copy(self.homing, block.homing)
            var.copy(self.tool, block.tool)
            var.copy(self.gap, block.gap)
            self.home_position = block.home_position
            self.material_factor = block.material_factor
            self.margin = block.line.margin
            self.late_mode = block.late_mode
        pieces.set_piece(
            block.kerf,
            block.length_tolerance,
            block.sample_length,
            block.waste_length,
            block.batch_size,
            block.change_mode,
        )
        pieces.set_start(block.start_mode, block.front_position, block.trim_length)
        pieces.set_mark(block.mark)
        self.are_valid = self.invalid == SawParameter.NONE and pieces.first_invalid() == PieceParameter.NONE

    def refused_parameter(self, pieces: PieceSettings) -> int:
        """The number of the first parameter that is out of its range; 0: all are valid."""
        if self.are_valid:
            return 0
        if self.invalid != SawParameter.NONE:
            return self.invalid
        return pieces.first_invalid()

    def can_fix(self, pieces: PieceSettings) -> bool:
        """Whether all is valid that a piece is fixed with."""
        return self.invalid != SawParameter.MATERIAL_FACTOR and pieces.invalid_piece == PieceParameter.NONE

    def can_start(self, pieces: PieceSettings) -> bool:
        """Whether all is valid that the command start reads."""
        is_start_valid = pieces.invalid_start == PieceParameter.NONE
        return self.can_fix(pieces) and self.invalid == SawParameter.NONE and is_start_valid

    def describe(self, machine: Machine, pieces: PieceSettings, calibration: float, cosine: float) -> None:
        """Write the limits in use into what a cycle is computed from, and the factor of the material's travel.

        `calibration`: the factor found by calibration; `cosine`: of the diagonal angle."""
        pieces.factor = self.material_factor * calibration
        axis = self.axis
        deceleration = axis.deceleration()
        machine.coupling = pieces.factor / cosine
        machine.home_position = self.home_position
        machine.min_position = axis.min_position
        machine.max_position = axis.max_position
        machine.max_velocity = axis.max_velocity
        machine.max_acceleration = axis.max_acceleration
        machine.max_deceleration = deceleration
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


def start_refusal(block: CutToLengthInterface) -> Refusal:
    """Why the start values contradict one another; NONE: they do not."""
    low = block.axis.min_position
    high = block.axis.max_position
    if not (low <= block.home_position and block.home_position <= high):
        return Refusal.HOME
    if not (low <= block.axis.initial_position and block.axis.initial_position <= high):
        return Refusal.INITIAL_POSITION
    return Refusal.NONE if has_narrow_window(block.mark) else Refusal.WINDOW


def is_same_tool(a: Tool, b: Tool) -> bool:
    """Whether the parameters of two tools are the same; their inputs and outputs do not count."""
    return (
        a.settle_time == b.settle_time
        and a.on_delay == b.on_delay
        and a.cut_time == b.cut_time
        and a.cut_distance == b.cut_distance
        and a.retract_time == b.retract_time
        and a.timeout == b.timeout
    )


def first_invalid(block: CutToLengthInterface) -> SawParameter:
    """The first parameter that is out of its range. NaN is out of every range."""
    axis = block.axis
    approach = block.approach
    homing = block.homing
    tool = block.tool
    gap = block.gap
    factor = block.material_factor * block.calibration.factor
    is_home = -LARGEST <= axis.min_position <= block.home_position <= axis.max_position <= LARGEST
    is_mode = LateMode.SKIP <= block.late_mode <= LateMode.STOP_LINE
    invalid = checked(SawParameter.NONE, is_usable(factor), SawParameter.MATERIAL_FACTOR)
    invalid = checked(invalid, is_home, SawParameter.HOME_POSITION)
    invalid = checked(invalid, is_usable(axis.max_velocity), SawParameter.MAX_VELOCITY)
    invalid = checked(invalid, is_usable(axis.max_acceleration), SawParameter.MAX_ACCELERATION)
    invalid = checked(invalid, is_usable_or_0(axis.max_deceleration), SawParameter.MAX_DECELERATION)
    invalid = checked(invalid, is_usable(axis.max_jerk), SawParameter.MAX_JERK)
    invalid = checked(invalid, 0.0 <= approach.distance <= LARGEST, SawParameter.APPROACH_DISTANCE)
    invalid = checked(invalid, 0.0 <= approach.reserve <= GREATEST_RESERVE, SawParameter.APPROACH_RESERVE)
    invalid = checked(invalid, is_usable_or_0(approach.acceleration), SawParameter.APPROACH_ACCELERATION)
    invalid = checked(invalid, is_usable_or_0(approach.jerk), SawParameter.APPROACH_JERK)
    invalid = checked(invalid, is_usable_or_0(homing.velocity), SawParameter.HOMING_VELOCITY)
    invalid = checked(invalid, is_usable_or_0(homing.acceleration), SawParameter.HOMING_ACCELERATION)
    invalid = checked(invalid, is_usable_or_0(homing.deceleration), SawParameter.HOMING_DECELERATION)
    invalid = checked(invalid, is_usable_or_0(homing.jerk), SawParameter.HOMING_JERK)
    invalid = checked(invalid, 0.0 <= homing.settle_time <= LONGEST, SawParameter.HOMING_SETTLE_TIME)
    invalid = checked(invalid, 0.0 <= homing.spare_time <= LONGEST, SawParameter.HOMING_SPARE_TIME)
    invalid = checked(invalid, 0.0 < homing.slowest <= 1.0, SawParameter.HOMING_SLOWEST)
    invalid = checked(invalid, 0.0 <= tool.settle_time <= LONGEST, SawParameter.SETTLE_TIME)
    invalid = checked(invalid, 0.0 <= tool.on_delay <= LONGEST, SawParameter.ON_DELAY)
    invalid = checked(invalid, 0.0 <= tool.cut_time <= LONGEST, SawParameter.CUT_TIME)
    invalid = checked(invalid, 0.0 <= tool.cut_distance <= LARGEST, SawParameter.CUT_DISTANCE)
    invalid = checked(invalid, 0.0 <= tool.retract_time <= LONGEST, SawParameter.RETRACT_TIME)
    invalid = checked(invalid, 0.0 <= tool.timeout <= LONGEST, SawParameter.TIMEOUT)
    invalid = checked(invalid, 0.0 <= gap.distance <= LARGEST, SawParameter.GAP_DISTANCE)
    invalid = checked(invalid, is_usable(gap.travel), SawParameter.GAP_TRAVEL)
    invalid = checked(invalid, 0.0 <= block.line.margin < 1.0, SawParameter.MARGIN)
    return checked(invalid, is_mode, SawParameter.LATE_MODE)


def checked(invalid: SawParameter, is_valid: bool, parameter: SawParameter) -> SawParameter:
    """The first invalid parameter of a check so far; without one this parameter, unless it is valid."""
    return invalid if invalid != SawParameter.NONE or is_valid else parameter


def is_usable_or_0(limit: float) -> bool:
    """Whether a limit is usable, or 0, which means another limit."""
    return limit == 0.0 or is_usable(limit)
