"""The pieces of a rotary knife: each has the window of the cut that ends it, read when the piece is fixed.

Readings of the specification that it leaves open:
- A window without a way to the next one, or that leaves no space for the park angle, is out of its range: of the
  variables, the last ones that left both hold on where something else is computed with them.
- `sync.overspeed` does nothing where the mode is HORIZONTAL.
- A length above max_length counts as none, where the knife must not park, for the first piece after `start` as well;
  for TRIM and for what marks decide it does not.
- A request for a sample that is not taken for its length waits on.
"""

from collections.abc import Callable, Mapping
from typing import Any

from tests.oracle.cutting.ranges import LENGTHS, Ranges
from tests.oracle.cutting.records import PieceRecords
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import Window
from tests.oracle.rotary_knife.limits import Knife, longest_turning

WINDOW = ("sync.before", "sync.after", "sync.overspeed")
RANGES = Ranges({"sync.before": LENGTHS, "sync.after": LENGTHS, "sync.overspeed": (-0.2, 0.5)})


class KnifeRecords(PieceRecords):
    """`window`: of the cut that ends the piece in progress."""

    warnings_of_piece = ("limit_exceeded", "change_pending")

    def __init__(self, inputs: Mapping[str, Any], knife: Knife) -> None:
        super().__init__(inputs, RANGES)
        self.knife = knife
        self.window = self.window_as_set()

    @property
    def has_valid_window(self) -> bool:
        """Whether what has been set makes a window."""
        return RANGES.are_valid(self.settings, WINDOW) and self._has_way(self.settings)

    def _has_way(self, inputs: Mapping[str, Any]) -> bool:
        return self.knife.has_way(*(mp.mpf(inputs[name]) for name in WINDOW))

    def window_as_set(self) -> Window:
        """The window of a piece that is fixed now."""
        return self.knife.window(self.f, *(mp.mpf(self.inputs[name]) for name in WINDOW))

    def accept_settings(self) -> None:
        before = {name: self.inputs[name] for name in WINDOW}
        super().accept_settings()
        if not self._has_way(self.inputs):
            self.inputs |= before

    def start(self, master: Number, factor: Number) -> None:
        self.window = self.window_as_set()
        super().start(master, factor)

    def fix_piece(self) -> None:
        sample_requested = self.sample_requested
        if not self.has_valid_window:
            self.piece, self.has_invalid_settings = None, True
            return
        super().fix_piece()
        if self.piece is None:
            return
        window = self.window_as_set()
        if not (self.knife.may_park or self.is_by_marks) and self.piece.pitch > self.longest_pitch():
            self.piece, self.has_invalid_settings, self.sample_requested = None, True, sample_requested
            return
        self.window = window

    def longest_pitch(self) -> Number:
        """Of a piece on which the knife does not come to rest, between two windows as they are set."""
        window = self.window_as_set()
        return longest_turning(self.knife, window, window) + window.before + window.after

    def change_piece(self, is_reachable: Callable[[float], bool]) -> None:
        piece = self.piece
        super().change_piece(is_reachable)
        if self.piece is not piece:
            self.window = self.window_as_set()
