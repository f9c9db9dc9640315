"""The tunable parameters of the machine: validated, and taken over if they are valid."""

from dataclasses import dataclass

from .. import var
from ..cutting.interface import LateMode
from ..cutting.settings import PieceParameter, PieceSettings, has_narrow_window
from ..numerics.computable_range import LARGEST, is_usable
from ..numerics.grid import floor
from .faults import KnifeParameter, Refusal
from .interface import GREATEST_OVERSPEED, LEAST_OVERSPEED, RotaryKnifeInterface, SyncMode
from .knife import Knife
from .window import PARK_MARGIN, Window, is_narrow, leaves_way, widest_half


@dataclass(slots=True)
class KnifeSettings:
    """The values of the machine's tunable parameters when they were valid last.

    Attributes:
        invalid_factor, invalid_window, invalid_line: the first parameter of each group that is out of its range.
        are_valid: no parameter is out of its range, those of pieces included.
        window: that of the parameters which were validated last.
    """

    invalid_factor: KnifeParameter = KnifeParameter.NONE
    invalid_window: KnifeParameter = KnifeParameter.NONE
    invalid_line: KnifeParameter = KnifeParameter.NONE
    are_valid: bool = True
    material_factor: float = 1.0
    before: float = 20.0
    after: float = 20.0
    overspeed: float = 0.0
    margin: float = 0.02
    late_mode: LateMode = LateMode.SKIP
    window: Window = var.part(Window)

    def are_current(self, block: RotaryKnifeInterface, pieces: PieceSettings) -> bool:
        """Whether no parameter has been tuned since the settings were taken over."""
        return (
            self.material_factor == block.material_factor
            and self.before == block.sync.before
            and self.after == block.sync.after
            and self.overspeed == block.sync.overspeed
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

    def update(self, block: RotaryKnifeInterface, knife: Knife, pieces: PieceSettings) -> None:
        """Validate the block's parameters, and take over those of each group in which all are valid."""
        is_factor = is_usable(block.material_factor * block.calibration.factor)
        self.invalid_factor = checked(KnifeParameter.NONE, is_factor, KnifeParameter.MATERIAL_FACTOR)
        if is_factor:
            self.material_factor = block.material_factor
        self.validate_window(block, knife)
        if self.invalid_window == KnifeParameter.NONE:
            self.before = block.sync.before
            self.after = block.sync.after
            self.overspeed = block.sync.overspeed
        is_mode = LateMode.SKIP <= block.late_mode <= LateMode.STOP_LINE
        invalid = checked(KnifeParameter.NONE, 0.0 <= block.line.margin < 1.0, KnifeParameter.MARGIN)
        self.invalid_line = checked(invalid, is_mode, KnifeParameter.LATE_MODE)
        if self.invalid_line == KnifeParameter.NONE:
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
        self.are_valid = self.first_invalid() == KnifeParameter.NONE and pieces.first_invalid() == PieceParameter.NONE

    def validate_window(self, block: RotaryKnifeInterface, knife: Knife) -> None:
        """Find the first parameter of the window that is out of its range. NaN is out of every range."""
        sync = block.sync
        is_overspeed = LEAST_OVERSPEED <= sync.overspeed <= GREATEST_OVERSPEED
        is_before = 0.0 <= sync.before <= LARGEST and is_narrow(knife, sync.before)
        is_after = 0.0 <= sync.after <= LARGEST and is_narrow(knife, sync.after)
        invalid = checked(KnifeParameter.NONE, is_before, KnifeParameter.SYNC_BEFORE)
        invalid = checked(invalid, is_after, KnifeParameter.SYNC_AFTER)
        invalid = checked(invalid, is_overspeed, KnifeParameter.OVERSPEED)
        margin = PARK_MARGIN * knife.turn
        if invalid == KnifeParameter.NONE:
            self.window.set(knife, 1.0, sync.before, sync.after, sync.overspeed)
            is_after = self.window.end.position + margin <= knife.park_angle
            invalid = checked(invalid, is_after, KnifeParameter.SYNC_AFTER)
            invalid = checked(invalid, leaves_way(knife, self.window), KnifeParameter.SYNC_BEFORE)
        self.invalid_window = invalid
        overspeed = sync.overspeed if is_overspeed else self.overspeed
        block.local.allowed_from = 0.0
        block.local.allowed_to = 0.0
        if invalid == KnifeParameter.SYNC_BEFORE:
            block.local.allowed_to = widest_half(knife, overspeed, knife.spacing - knife.park_angle - margin)
        elif invalid == KnifeParameter.SYNC_AFTER:
            block.local.allowed_to = widest_half(knife, overspeed, knife.park_angle - margin)

    def start_refusal(self, block: RotaryKnifeInterface, knife: Knife) -> Refusal:
        """Why the start values contradict one another; NONE: they do not."""
        self.validate_window(block, knife)
        if self.invalid_window != KnifeParameter.NONE:
            return self.window_refusal(block, knife)
        return Refusal.NONE if has_narrow_window(block.mark) else Refusal.MARK_WINDOW

    def window_refusal(self, block: RotaryKnifeInterface, knife: Knife) -> Refusal:
        """Which of the start values leaves no way between two windows: the one that alone can be changed to leave one;
        the blades or the park angle, if the windows do not forbid it."""
        sync = block.sync
        is_before = self.invalid_window == KnifeParameter.SYNC_BEFORE
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

    def first_invalid(self) -> KnifeParameter:
        """The first parameter of the machine that is out of its range."""
        invalid = checked(self.invalid_factor, self.invalid_window == KnifeParameter.NONE, self.invalid_window)
        return checked(invalid, self.invalid_line == KnifeParameter.NONE, self.invalid_line)

    def refused_parameter(self, pieces: PieceSettings) -> int:
        """The number of the first parameter that is out of its range; 0: all are valid."""
        if self.are_valid:
            return 0
        if self.first_invalid() != KnifeParameter.NONE:
            return self.first_invalid()
        return pieces.first_invalid()

    def can_fix(self, pieces: PieceSettings) -> bool:
        """Whether all is valid that a piece is fixed with."""
        is_window = self.invalid_window == KnifeParameter.NONE and self.invalid_factor == KnifeParameter.NONE
        return is_window and pieces.invalid_piece == PieceParameter.NONE

    def can_start(self, pieces: PieceSettings) -> bool:
        """Whether all is valid that the command start reads."""
        is_machine_valid = self.first_invalid() == KnifeParameter.NONE
        return is_machine_valid and self.can_fix(pieces) and pieces.invalid_start == PieceParameter.NONE

    def describe(self, window: Window, knife: Knife, factor: float) -> None:
        """The window with the present settings; `factor`: travel of the material per travel of the master."""
        window.set(knife, factor, self.before, self.after, self.overspeed)


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


def checked(invalid: KnifeParameter, is_valid: bool, parameter: KnifeParameter) -> KnifeParameter:
    """The first invalid parameter of a check so far; without one this parameter, unless it is valid."""
    return invalid if invalid != KnifeParameter.NONE or is_valid else parameter
