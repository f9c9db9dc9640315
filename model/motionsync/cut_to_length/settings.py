"""The tunable parameters of the machine, validated: the last valid ones are the settings."""

from dataclasses import dataclass

from .. import var
from ..cutting.settings import CuttingSettings, contradiction, has_narrow_window
from ..motion.axis_limits import AxisLimits, limit_in_use
from .faults import Refusal, SawContradiction
from .interface import Approach, CutToLengthInterface, Gap, Homing, ToolMode, ToolParameters
from .machine_limits import Machine


@dataclass(slots=True)
class MachineSettings:
    """The values of each group of parameters when all in it were valid last; home belongs to the axis."""

    axis: AxisLimits = var.part(AxisLimits, hidden=True)
    approach: Approach = var.part(Approach, hidden=True)
    homing: Homing = var.part(Homing, hidden=True)
    tool: ToolParameters = var.part(ToolParameters, hidden=True)
    gap: Gap = var.part(Gap, hidden=True)
    home_position: float = 0.0

    def take_over(self, block: CutToLengthInterface) -> None:
        """Become the block's parameters, group by group, as far as they are valid."""
        if is_home_reachable(block) and var.first_invalid(block.axis) == 0:
            var.copy(self.axis, block.axis)
            self.home_position = block.home_position
        var.copy_valid(self.approach, block.approach)
        var.copy_valid(self.homing, block.homing)
        var.copy_valid(self.tool, block.tool)
        var.copy_valid(self.gap, block.gap)

    def are_current(self, block: CutToLengthInterface) -> bool:
        """Whether they are the block's parameters: none is invalid, and none was tuned since they were taken over."""
        return (
            var.same(self.axis, block.axis)
            and self.home_position == block.home_position
            and var.same(self.approach, block.approach)
            and var.same(self.homing, block.homing)
            and var.same(self.tool, block.tool)
            and var.same(self.gap, block.gap)
        )

    def describe(self, machine: Machine, cutting: CuttingSettings, calibration: float, cosine: float) -> None:
        """Write the limits in use into what a cycle is computed from, and the factor of the material's travel.

        `calibration`: the factor found by calibration; `cosine`: of the diagonal angle."""
        cutting.factor = cutting.cycle.material_factor * calibration
        axis = self.axis
        deceleration = axis.deceleration()
        machine.coupling = cutting.factor / cosine
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
    axis = block.axis
    if not is_home_reachable(block):
        return Refusal.HOME
    if not axis.min_position <= axis.initial_position <= axis.max_position:
        return Refusal.INITIAL_POSITION
    return Refusal.NONE if has_narrow_window(block.mark) else Refusal.WINDOW


def refused_parameter(block: CutToLengthInterface) -> int:
    """The code of the first parameter that is out of its range, or contradicts another one; 0: all are valid."""
    invalid = var.first_invalid(block)
    if invalid > 0:
        return invalid
    if not is_home_reachable(block):
        return SawContradiction.HOME
    return contradiction(block)


def is_home_reachable(block: CutToLengthInterface) -> bool:
    """Whether home is between the ends of the stroke."""
    return block.axis.min_position <= block.home_position <= block.axis.max_position
