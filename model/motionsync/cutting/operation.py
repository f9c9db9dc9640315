"""How the machine is operated: what its commands have asked for, what was refused, and why it has stopped."""

from dataclasses import dataclass

from .. import var
from ..slave import Edge
from .commands import PieceCommands
from .faults import PieceFault
from .interface import CuttingInterface, StartMode
from .material import Material

MOST_PITCHES = 1e4  # that the master may travel in one step


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

    def take_levels(self, block: CuttingInterface) -> None:
        """Take the present levels of all commands as they are: the first value seen is no edge."""
        self.start_edge.take_level(block.start)
        self.stop_edge.take_level(block.stop)
        self.abort_edge.take_level(block.abort)
        self.reset_edge.take_level(block.reset)
        self.cut_now_edge.take_level(block.cut_now)
        self.pieces.take_levels(block)

    def longest_travel(self, block: CuttingInterface, material: Material, shortest: float) -> float:
        """How far the master may travel in the present step, u; 0: any distance.

        `shortest`: the least pitch of the piece in progress and of all that wait."""
        is_started = (block.start and not self.start_edge.before) or (block.auto_start and not self.has_stepped)
        return MOST_PITCHES * material.repeated_pitch(shortest, block.length) if block.running or is_started else 0.0

    def reset(self, block: CuttingInterface, is_at_rest: bool) -> None:
        """Carry out reset: clear what was refused, and the fault once the machine rests; in motion it does nothing."""
        if self.reset_edge.try_rise(block.reset) and (self.fault == PieceFault.NONE or is_at_rest):
            self.fault = PieceFault.NONE
            self.pieces.fault = PieceFault.NONE

    def try_abort(self, block: CuttingInterface) -> bool:
        """Accept the command abort, if it comes and the machine runs."""
        if self.abort_edge.try_rise(block.abort) and block.running:
            self.accept(True)
            return True
        return False

    def try_stop(self, block: CuttingInterface) -> bool:
        """Accept the command stop, if it comes and the machine runs."""
        if self.stop_edge.try_rise(block.stop) and block.running:
            self.accept(True)
            return True
        return False

    def try_start(self, block: CuttingInterface, material: Material, is_off: bool, are_valid: bool) -> bool:
        """Accept the command start, if it comes, the machine is off, and it has what it needs; else that is refused.

        `are_valid`: all tunable parameters are."""
        is_automatic = block.auto_start and not self.has_stepped
        if not (self.start_edge.try_rise(block.start) or is_automatic):
            return False
        can_continue = block.start_mode != StartMode.CONTINUE or material.has_cut
        if not (is_off and self.fault == PieceFault.NONE and can_continue):
            self.pieces.fault = PieceFault.START
        elif not are_valid:
            self.pieces.fault = PieceFault.TUNABLE
        else:
            self.accept(False)
            return True
        return False

    def accept(self, is_stopping: bool) -> None:
        """A command that starts or stops the machine is accepted."""
        self.pieces.fault = PieceFault.NONE
        self.is_stopping = is_stopping
        self.is_cut_pending = False

    def try_request_cut(self, block: CuttingInterface) -> bool:
        """Store a cut_now, if it comes and the machine runs, until it can be carried out."""
        if not self.cut_now_edge.try_rise(block.cut_now):
            return False
        self.pieces.fault = PieceFault.NONE
        if not block.running or self.is_stopping:
            self.pieces.fault = PieceFault.CUT_NOW
        else:
            self.is_cut_pending = True
        return self.pieces.fault == PieceFault.NONE

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
