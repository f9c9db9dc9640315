"""How the machine is operated: what its commands have asked for, what was refused, and why it has stopped."""

from dataclasses import dataclass

from .. import var
from ..cutting.commands import PieceCommands
from ..slave import Edge
from .faults import Fault
from .interface import CutToLengthInterface


@dataclass(slots=True)
class Operation:
    """The operation of the machine, by commands that are given by their rising edges.

    Attributes:
        pieces: the commands for pieces; its `fault` is why the last of all commands was refused.
        fault: why the machine has stopped, as `error_id` shows it.
        has_stepped: there has been a step since the initialization.
        is_stopping: the machine rests as soon as the carriage is at home.
        is_cut_pending: a cut_now has not been carried out yet.
    """

    start_edge: Edge = var.part(Edge)
    stop_edge: Edge = var.part(Edge)
    abort_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    cut_now_edge: Edge = var.part(Edge)
    done_edge: Edge = var.part(Edge)
    pieces: PieceCommands = var.part(PieceCommands)
    fault: int = 0
    has_stepped: bool = False
    is_stopping: bool = False
    is_cut_pending: bool = False

    def take_levels(self, block: CutToLengthInterface) -> None:
        """Take the present levels of the commands as they are: the first value seen is no edge."""
        self.start_edge.take_level(block.start)
        self.stop_edge.take_level(block.stop)
        self.abort_edge.take_level(block.abort)
        self.reset_edge.take_level(block.reset)
        self.cut_now_edge.take_level(block.cut_now)
        self.done_edge.take_level(block.tool.done)

    def start(self) -> None:
        """Accept the command start."""
        self.pieces.fault = Fault.NONE
        self.is_stopping = False
        self.is_cut_pending = False

    def stop(self) -> None:
        """Accept the command stop or abort."""
        self.pieces.fault = Fault.NONE
        self.is_stopping = True
        self.is_cut_pending = False

    def reset(self, is_at_rest: bool) -> None:
        """Clear what was refused, and the fault once the carriage rests; in motion the command does nothing."""
        if self.fault == Fault.NONE or is_at_rest:
            self.fault = Fault.NONE
            self.pieces.fault = Fault.NONE

    def request_cut(self, running: bool) -> None:
        """Store a cut_now until the carriage is ready at home."""
        if not running or self.is_stopping:
            self.pieces.fault = Fault.CUT_NOW
        else:
            self.pieces.fault = Fault.NONE
            self.is_cut_pending = True

    def fail(self, fault: int) -> None:
        """The machine stops for a fault."""
        self.fault = fault
        self.is_cut_pending = False
