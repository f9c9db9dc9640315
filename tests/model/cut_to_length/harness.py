"""A CutToLength on a scripted line, the pieces that it makes, and the machines from which its tests begin."""

from dataclasses import dataclass
from typing import Any, Self

import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.interface import State
from motionsync.cut_to_length.machine_limits import Machine
from motionsync.cutting.interface import PieceKind
from motionsync.master import MasterInput
from tests.model.cut_to_length.machine_results import REFERENCE
from tests.support.blocks.harness import MOTION, BlockHarness

INSTANT = 2.0**-40  # s, a step in which nothing moves
JUST = 1e-6  # s, just before or just after an event
LEAD = 86.60254037844386  # u, lead(1000) of the reference machine: sqrt(1.5 1000^3 / 200000) > 0.75 1000^2 / 10000

# The reference machine with an approach over 100, for pieces of 1500. On a line of 1000 u/s that is at m = 1000 t, all
# is round:
#   start at C - 100, sync 0.2 s later at s = 100, the cut ends 0.25 s later at s = S = 350. The way home: R(x) =
#   x / a + a / j = x / 10000 + 0.05, G(1500) = 250 R(2500) + 750 R(1500) = 75 + 150 = 225 < S, so T_r = R(2500) +
#   R(1500) + (350 - 225) / 1500 = 0.5 + 0.083333 = 0.583333. T_c = 1.033333, p_min = 1033.333, stroke =
#   350 + 500 R(1000) = 425.
# With `start` at t = 0: start 1.4, sync 1.6, cut 1.85, home 2.433333, next start 2.9, ...
ROUND: dict[str, Any] = {**REFERENCE, "approach.distance": 100.0, "length": 1500.0}
HOME_AGAIN = 1.85 + 0.5 + 125.0 / 1500.0  # s, when the first cycle of the round machine is over


@dataclass(frozen=True)
class Piece:
    """What `last` states of a piece."""

    length: float
    error: float
    kind: PieceKind
    is_accepted: bool
    time: float
    reserve: float


class CutToLengthHarness(BlockHarness):
    """A CutToLength; a command that is given falls again after the next step.

    Attributes:
        pieces: what the machine has made since `start`, of each step the last piece.
    """

    TYPE = CutToLength
    SHOWN = (*MOTION, "state_code", "statistics.cuts")

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.given_commands: tuple[str, ...] = ()
        self.fallen_commands: tuple[str, ...] = ()
        self.pieces: list[Piece] = []
        self.cuts = 0
        super().__init__(*arguments, **options)

    def twin(self) -> Self:
        other = super().twin()
        other.pieces = list(self.pieces)
        return other

    def after_step(self) -> None:
        for name in self.given_commands:
            self.set({name: False})
        self.fallen_commands, self.given_commands = self.given_commands, ()
        if self["statistics.cuts"] > self.cuts:
            last = self.block.last
            self.pieces.append(Piece(last.length, last.error, last.kind, self["last.good"], last.time, last.reserve))
        self.cuts = self["statistics.cuts"]

    def give(self, *commands: str) -> Self:
        """Rising edges of these commands with the next step; one that has just been true falls before it."""
        if set(commands) & set(self.fallen_commands):
            self.now()
        self.given_commands += commands
        return self.set(dict.fromkeys(commands, True))

    def order(self, length: float, quantity: int = 1) -> Self:
        """Append an order with the next step."""
        return self.set({"order.length": length, "order.quantity": quantity}).give("order.add")

    def now(self) -> Self:
        """Let what was set and given act, before any time passes."""
        return self.run(INSTANT)

    def at(self, time: float, *, acceleration: float = 0.0) -> Self:
        """Run until this time since the initialization, in one step."""
        return self.run(time - self.time, acceleration=acceleration)

    def watched(self, time: float, *, step: float = 0.05) -> Self:
        """Run until this time in steps short enough that each piece is listed."""
        left = time - self.time
        return self.run(left, cuts=[i * step for i in range(1, int(left / step) + 1)])

    def cut_counts(self) -> tuple[int, int]:
        """How many cuts were made, and how many skipped."""
        return self["statistics.cuts"], self["statistics.skipped"]

    def statistics(self, *names: str) -> tuple[Any, ...]:
        return tuple(self[f"statistics.{name}"] for name in names)

    def lengths(self) -> list[float]:
        return [piece.length for piece in self.pieces]

    def kinds(self) -> list[PieceKind]:
        return [piece.kind for piece in self.pieces]


def machine_data(values: dict[str, Any] | None = None) -> Machine:
    """What the block computes its predictions from, of the reference machine with these values."""
    machine: Machine = CutToLengthHarness({**REFERENCE, **(values or {})}).block.carriage.machine
    return machine


def near(*values: float, tolerance: float = 1e-9) -> Any:
    """What equals one number, or a tuple of several, within the tolerance, relative or absolute."""
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def each(*values: float, tolerance: float = 1e-9) -> Any:
    """What equals a list of these numbers within the tolerance, relative or absolute."""
    return pytest.approx(list(values), rel=tolerance, abs=tolerance)


def idle_machine(
    values: dict[str, Any] | None = None,
    *,
    speed: float = 1000.0,
    master_position: float = 0.0,
    mode: MasterInput = MasterInput.START_OF_STEP,
) -> CutToLengthHarness:
    """The round machine with further values, OFF; its line runs from `master_position` on."""
    return CutToLengthHarness({**ROUND, **(values or {})}, speed=speed, master_position=master_position, mode=mode)


def started_machine(
    values: dict[str, Any] | None = None,
    *,
    speed: float = 1000.0,
    master_position: float = 0.0,
    mode: MasterInput = MasterInput.START_OF_STEP,
) -> CutToLengthHarness:
    """As `idle_machine`, and `start` is given with the next step."""
    return idle_machine(values, speed=speed, master_position=master_position, mode=mode).give("start")


def assert_state(saw: CutToLengthHarness, time: float, before: State, after: State) -> None:
    """The state changes at this time: `before` holds just before, `after` just after. The harness ends up there."""
    saw.at(time - JUST)
    assert saw.state == before, time
    saw.at(time + JUST)
    assert saw.state == after, time
