"""The tunable parameters of the window, validated: the last valid ones are the settings."""

from dataclasses import dataclass

from .. import var
from ..cutting.settings import contradiction, has_narrow_window
from ..numerics.grid import floor
from .faults import KnifeContradiction, Refusal
from .interface import RotaryKnifeInterface, Sync, SyncMode
from .knife import Knife
from .window import PARK_MARGIN, Window, is_narrow, leaves_way, widest_half


@dataclass(slots=True)
class KnifeSettings:
    """The values of the window's parameters when they were valid last.

    Attributes:
        contradiction: which of those that were validated last leaves no way between two windows.
        window: that of the parameters which were validated last.
    """

    sync: Sync = var.part(Sync, hidden=True)
    contradiction: KnifeContradiction = KnifeContradiction.NONE
    window: Window = var.part(Window)

    def take_over(self, block: RotaryKnifeInterface, knife: Knife) -> None:
        """Become the block's parameters, if they are valid and leave a way between two windows."""
        self.validate_window(block, knife)
        if self.contradiction == KnifeContradiction.NONE:
            var.copy_valid(self.sync, block.sync)

    def are_current(self, block: RotaryKnifeInterface) -> bool:
        """Whether they are the block's parameters: none is invalid, and none was tuned since they were taken over."""
        return var.same(self.sync, block.sync)

    def validate_window(self, block: RotaryKnifeInterface, knife: Knife) -> None:
        """Find out whether parameters that are within their ranges leave a way between two windows, and put out what
        the one that does not may be."""
        sync = block.sync
        margin = PARK_MARGIN * knife.turn
        self.contradiction = KnifeContradiction.NONE
        block.local.allowed_from = 0.0
        block.local.allowed_to = 0.0
        if var.first_invalid(sync) > 0:
            return
        if not is_narrow(knife, sync.before):
            self.contradiction = KnifeContradiction.BEFORE
        elif not is_narrow(knife, sync.after):
            self.contradiction = KnifeContradiction.AFTER
        else:
            self.window.set(knife, 1.0, sync.before, sync.after, sync.overspeed)
            if not self.window.end.position + margin <= knife.park_angle:
                self.contradiction = KnifeContradiction.AFTER
            elif not leaves_way(knife, self.window):
                self.contradiction = KnifeContradiction.BEFORE
        if self.contradiction == KnifeContradiction.BEFORE:
            block.local.allowed_to = widest_half(knife, sync.overspeed, knife.spacing - knife.park_angle - margin)
        elif self.contradiction == KnifeContradiction.AFTER:
            block.local.allowed_to = widest_half(knife, sync.overspeed, knife.park_angle - margin)

    def start_refusal(self, block: RotaryKnifeInterface, knife: Knife) -> Refusal:
        """Why the start values contradict one another; NONE: they do not."""
        self.validate_window(block, knife)
        if self.contradiction != KnifeContradiction.NONE:
            return self.window_refusal(block, knife)
        return Refusal.NONE if has_narrow_window(block.mark) else Refusal.MARK_WINDOW

    def window_refusal(self, block: RotaryKnifeInterface, knife: Knife) -> Refusal:
        """Which of the start values leaves no way between two windows: the one that alone can be changed to leave one;
        the blades or the park angle, if the windows do not forbid it."""
        sync = block.sync
        is_before = self.contradiction == KnifeContradiction.BEFORE
        refusal = Refusal.SYNC_BEFORE if is_before else Refusal.SYNC_AFTER
        if not (is_narrow(knife, sync.before) and is_narrow(knife, sync.after)):
            return refusal
        margin = PARK_MARGIN * knife.turn
        begin = self.window.begin.position - margin
        end = self.window.end.position + margin
        needed = 2.0 * max(end, -begin) if block.knife.park_angle == 0.0 else end - begin
        if knife.spacing < needed <= knife.turn:
            block.local.allowed_from = 1.0
            block.local.allowed_to = floor(knife.turn / needed)
            return Refusal.BLADES
        if block.knife.park_angle > 0.0 and needed <= knife.spacing:
            block.local.allowed_from = end
            block.local.allowed_to = knife.spacing + begin
            return Refusal.PARK_ANGLE
        return refusal

    def refused_parameter(self, block: RotaryKnifeInterface) -> int:
        """The code of the first parameter that is out of its range, or contradicts another one; 0: all are valid."""
        invalid = var.first_invalid(block)
        if invalid > 0:
            return invalid
        if self.contradiction != KnifeContradiction.NONE:
            return self.contradiction
        return contradiction(block)


def describe_knife(knife: Knife, block: RotaryKnifeInterface) -> None:
    """Write what is fixed into what curves and limits are computed from."""
    knife.turn = block.knife.turn
    knife.circumference = block.knife.circumference
    knife.spacing = block.knife.turn / float(block.knife.blades)
    knife.park_angle = block.knife.park_angle if block.knife.park_angle > 0.0 else 0.5 * knife.spacing
    knife.is_horizontal = block.sync.mode == SyncMode.HORIZONTAL
    knife.may_park = block.allow_parking
    knife.max_velocity = block.axis.max_velocity
    knife.max_acceleration = block.axis.max_acceleration
    knife.max_jerk = block.axis.max_jerk
