"""How the machine is operated: what its commands have asked for, what was refused, and why it has stopped."""

from dataclasses import dataclass

from .. import var
from ..slave import Edge
from .commands import PieceCommands
from .faults import PieceFault
from .material import Material


@dataclass(slots=True)
class Operation:
    """The operation of the machine, by commands that are given by their rising edges.

    Attributes:
        pieces: the commands for pieces; its `fault` is why the last of all commands was refused.
        fault: why the machine has stopped, as `error_id` shows it.
        has_stepped: there has been a step since the initialization.
        is_stopping: the machine rests as soon as it can.
        is_cut_pending: a cut_now has not been carried out yet.
    """

    start_edge: Edge = var.part(Edge)
    stop_edge: Edge = var.part(Edge)
    abort_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    cut_now_edge: Edge = var.part(Edge)
    pieces: PieceCommands = var.part(PieceCommands)
    fault: int = 0
    has_stepped: bool = False
    is_stopping: bool = False
    is_cut_pending: bool = False

    def take_levels(self, start: bool, stop: bool, abort: bool, reset: bool, cut_now: bool) -> None:
        """Take the present levels of the commands as they are: the first value seen is no edge."""
        self.start_edge.take_level(start)
        self.stop_edge.take_level(stop)
        self.abort_edge.take_level(abort)
        self.reset_edge.take_level(reset)
        self.cut_now_edge.take_level(cut_now)

    def is_started_now(self, start: bool, auto_start: bool) -> bool:
        """Whether the command start comes in the present step; it may be refused."""
        return (start and not self.start_edge.before) or (auto_start and not self.has_stepped)

    def start(self) -> None:
        """Accept the command start."""
        self.pieces.fault = PieceFault.NONE
        self.is_stopping = False
        self.is_cut_pending = False

    def stop(self) -> None:
        """Accept the command stop or abort."""
        self.pieces.fault = PieceFault.NONE
        self.is_stopping = True
        self.is_cut_pending = False

    def reset(self, is_at_rest: bool) -> None:
        """Clear what was refused, and the fault once the machine rests; in motion the command does nothing."""
        if self.fault == PieceFault.NONE or is_at_rest:
            self.fault = PieceFault.NONE
            self.pieces.fault = PieceFault.NONE

    def request_cut(self, running: bool) -> None:
        """Store a cut_now until it can be carried out."""
        if not running or self.is_stopping:
            self.pieces.fault = PieceFault.CUT_NOW
        else:
            self.pieces.fault = PieceFault.NONE
            self.is_cut_pending = True

    def try_take_cut(self, material: Material, cut: float, is_reachable: bool) -> bool:
        """Carry out the cut_now that waits: the piece ends at this position. It is refused if the cut cannot be reached
        from here, or leaves no piece."""
        self.is_cut_pending = False
        if is_reachable and material.try_fix_short(cut):
            return True
        self.pieces.fault = PieceFault.CUT_NOW
        return False

    def fail(self, fault: int) -> None:
        """The machine stops for a fault."""
        self.fault = fault
        self.is_cut_pending = False
