"""The blade: its command, where it is, and when a stage ends in which it acts."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..cutting.piece import PieceInProgress
from ..master import Master
from ..master_path import NEVER, MasterPath
from ..slave import Edge
from .carriage import Carriage, Stage
from .instants import Condition, first_instant
from .interface import Tool, ToolMode


@dataclass(slots=True)
class Blade:
    """What is modelled of the blade besides `tool.command` and `tool.blade_down`.

    Attributes:
        done_edge: of the feedback that the cut is through.
        command_clock: the time since its command has changed.
        is_early: in this cycle it has touched before sync.
    """

    done_edge: Edge = var.part(Edge)
    command_clock: Clock = var.part(Clock)
    is_early: bool = False

    def command(self, tool: Tool, down: bool, now: float, block_time: float) -> None:
        """Set the tool's command at a time since the step's beginning, which has this time of the block."""
        if tool.command != down:
            tool.command = down
            tool.command_time = block_time + now
            self.command_clock.start(now)

    def update(self, tool: Tool, retract_time: float) -> None:
        """The blade is clear some time after its command has ended, wherever the carriage is."""
        if tool.blade_down and not tool.command:
            tool.blade_down = self.command_clock.time < retract_time

    def instant_before_sync(self, tool: Tool, master: Master, carriage: Carriage, piece: PieceInProgress) -> float:
        """When the tool is commanded, or the blade touches, in s since the step's beginning; NEVER: not before sync, or
        not before the line goes back."""
        path = master.path
        cycle = carriage.cycle_machine
        time = NEVER
        if not tool.command:
            if cycle.on_delay > cycle.settle_time:
                time = first_instant(Condition.COMMAND, master, carriage, piece, path.until)
        elif not tool.blade_down:
            time = path.due(self.command_clock, cycle.on_delay)
        if time == NEVER:
            return NEVER
        if first_instant(Condition.SYNC, master, carriage, piece, time) < time:
            return NEVER
        if first_instant(Condition.BACK, master, carriage, piece, time) < time:
            return NEVER
        if tool.command and carriage.is_nearly_in_sync(master, time):
            return NEVER  # the blade touches in sync
        return time

    def instant_in_sync(self, tool: Tool, carriage: Carriage, path: MasterPath) -> float:
        """When the next event in sync is due: the tool is commanded, the blade touches, or the cut starts."""
        cycle = carriage.cycle_machine
        sync_clock = carriage.stage_clock
        if not tool.command:
            return path.due(sync_clock, max(cycle.settle_time - cycle.on_delay, 0.0))
        touch = path.due(self.command_clock, cycle.on_delay)
        settled = path.due(sync_clock, cycle.settle_time)
        if not tool.blade_down and touch < settled:
            return touch
        return max(touch, settled)


def stage_end(carriage: Carriage, blade: Blade, tool: Tool, master: Master, piece: PieceInProgress) -> float:
    """When the next event of a stage on the curve is due, in s since the step's beginning; NEVER: not on what is left
    of the section.

    SYNCHRONOUS: the tool is commanded, the blade touches, or the cut starts. CUTTING: the cut is through, or the tool
    does not answer. PULLING: the gap is open. CLEARING: the blade is clear."""
    path = master.path
    clock = carriage.stage_clock
    time = NEVER
    match carriage.stage:
        case Stage.SYNCHRONOUS:
            time = blade.instant_in_sync(tool, carriage, path)
        case Stage.CUTTING:
            if tool.mode == ToolMode.DISTANCE:
                time = first_instant(Condition.THROUGH, master, carriage, piece, path.until)
            elif tool.mode == ToolMode.TIME:
                time = path.due(clock, carriage.cycle_machine.cut_time)
            elif carriage.cut_timeout > 0.0:
                time = path.due(clock, carriage.cut_timeout)
        case Stage.PULLING:
            time = first_instant(Condition.GAP_OPEN, master, carriage, piece, path.until)
        case _:
            time = path.due(clock, carriage.clearing_time)
    return time
