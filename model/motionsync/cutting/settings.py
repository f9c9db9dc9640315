"""The tunable parameters of pieces, of the command start, and of marks: validated, and taken over if they are valid.

A parameter may be tuned at any time and to any value. A block computes with its settings, which take over the values of
a group only if all of them are valid.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import LARGEST, SMALLEST_LIMIT
from ..var import Enumeration
from .interface import ChangeMode, Mark, StartMode

LONGEST = 1e6  # s
MARK_WINDOW = ("mark.window", "mark.spacing")


class PieceParameter(Enumeration):
    """Which tuned parameter of pieces, start or marks is out of its range"""

    # A machine has further parameters, with numbers of its own: 1 to 25, 40, and those above 42.
    NONE = 0, "none"
    KERF = 26, "kerf must be 0 to 1e12", "kerf"
    LENGTH_TOLERANCE = 27, "length_tolerance must be 0 to 1e12", "length_tolerance"
    FRONT_POSITION = 28, "front_position must be within 1e12", "front_position"
    TRIM_LENGTH = 29, "trim_length must be 0 to 1e12", "trim_length"
    SAMPLE_LENGTH = 30, "sample_length must be 1e-12 to 1e12", "sample_length"
    WASTE_LENGTH = 31, "waste_length must be 1e-12 to 1e12", "waste_length"
    BATCH_SIZE = 32, "batch_size must be at least 0", "batch_size"
    SENSOR_DISTANCE = 33, "mark.sensor_distance must be within 1e12", "mark.sensor_distance"
    CUT_OFFSET = 34, "mark.cut_offset must be within 1e12", "mark.cut_offset"
    SPACING = 35, "mark.spacing must be 0 to 1e12", "mark.spacing"
    WINDOW = 36, "mark.window must be 0 or more, and less than half of mark.spacing if that is not 0", *MARK_WINDOW
    EVERY = 37, "mark.every must be at least 1", "mark.every"
    MAX_MISSING = 38, "mark.max_missing must be at least 0", "mark.max_missing"
    MARK_DELAY = 39, "mark.delay must be 0 to 1e6 s", "mark.delay"
    START_MODE = 41, "start_mode must be 1, 2 or 3", "start_mode"
    CHANGE_MODE = 42, "change_mode must be 1 or 2", "change_mode"


@dataclass(slots=True)
class PieceSettings:
    """The values of the tunable parameters when their group was valid last.

    Attributes:
        invalid_piece, invalid_start, invalid_mark: the first parameter of each group that is out of its range.
        factor: true travel of the material per travel of the master, calibration included.
    """

    invalid_piece: PieceParameter = PieceParameter.NONE
    invalid_start: PieceParameter = PieceParameter.NONE
    invalid_mark: PieceParameter = PieceParameter.NONE
    factor: float = 1.0

    kerf: float = 0.0
    length_tolerance: float = 0.5
    sample_length: float = 100.0
    waste_length: float = 100.0
    batch_size: int = 0
    change_mode: ChangeMode = ChangeMode.NEXT_PIECE
    start_mode: StartMode = StartMode.FRONT
    front_position: float = 0.0
    trim_length: float = 0.0
    mark: Mark = var.part(Mark, hidden=True)

    def has_piece(
        self,
        kerf: float,
        length_tolerance: float,
        sample_length: float,
        waste_length: float,
        batch_size: int,
        change_mode: ChangeMode,
    ) -> bool:
        """Whether these are the settings of pieces."""
        return (
            self.kerf == kerf
            and self.length_tolerance == length_tolerance
            and self.sample_length == sample_length
            and self.waste_length == waste_length
            and self.batch_size == batch_size
            and self.change_mode == change_mode
        )

    def set_piece(
        self,
        kerf: float,
        length_tolerance: float,
        sample_length: float,
        waste_length: float,
        batch_size: int,
        change_mode: ChangeMode,
    ) -> None:
        """Validate what a piece is fixed and recorded with, and take it over if it is valid."""
        invalid = checked(PieceParameter.NONE, 0.0 <= kerf <= LARGEST, PieceParameter.KERF)
        invalid = checked(invalid, 0.0 <= length_tolerance <= LARGEST, PieceParameter.LENGTH_TOLERANCE)
        invalid = checked(invalid, SMALLEST_LIMIT <= sample_length <= LARGEST, PieceParameter.SAMPLE_LENGTH)
        invalid = checked(invalid, SMALLEST_LIMIT <= waste_length <= LARGEST, PieceParameter.WASTE_LENGTH)
        invalid = checked(invalid, batch_size >= 0, PieceParameter.BATCH_SIZE)
        is_mode = ChangeMode.NEXT_PIECE <= change_mode <= ChangeMode.THIS_PIECE
        self.invalid_piece = checked(invalid, is_mode, PieceParameter.CHANGE_MODE)
        if self.invalid_piece == PieceParameter.NONE:
            self.kerf = kerf
            self.length_tolerance = length_tolerance
            self.sample_length = sample_length
            self.waste_length = waste_length
            self.batch_size = batch_size
            self.change_mode = change_mode

    def has_start(self, start_mode: StartMode, front_position: float, trim_length: float) -> bool:
        """Whether these are the settings of the command start."""
        return (
            self.start_mode == start_mode and self.front_position == front_position and self.trim_length == trim_length
        )

    def set_start(self, start_mode: StartMode, front_position: float, trim_length: float) -> None:
        """Validate what the command start reads, and take it over if it is valid."""
        is_mode = StartMode.FRONT <= start_mode <= StartMode.CONTINUE
        invalid = checked(PieceParameter.NONE, is_mode, PieceParameter.START_MODE)
        invalid = checked(invalid, abs(front_position) <= LARGEST, PieceParameter.FRONT_POSITION)
        is_length = start_mode != StartMode.TRIM or 0.0 <= trim_length <= LARGEST
        self.invalid_start = checked(invalid, is_length, PieceParameter.TRIM_LENGTH)
        if self.invalid_start == PieceParameter.NONE:
            self.start_mode = start_mode
            self.front_position = front_position
            self.trim_length = trim_length

    def has_mark(self, mark: Mark) -> bool:
        """Whether these are the settings of marks."""
        own = self.mark
        return (
            own.sensor_distance == mark.sensor_distance
            and own.cut_offset == mark.cut_offset
            and own.spacing == mark.spacing
            and own.window == mark.window
            and own.every == mark.every
            and own.max_missing == mark.max_missing
            and own.delay == mark.delay
        )

    def set_mark(self, mark: Mark) -> None:
        """Validate the parameters of marks, and take them over if they are valid."""
        invalid = checked(PieceParameter.NONE, abs(mark.sensor_distance) <= LARGEST, PieceParameter.SENSOR_DISTANCE)
        invalid = checked(invalid, abs(mark.cut_offset) <= LARGEST, PieceParameter.CUT_OFFSET)
        invalid = checked(invalid, 0.0 <= mark.spacing <= LARGEST, PieceParameter.SPACING)
        invalid = checked(invalid, 0.0 <= mark.window <= LARGEST and has_narrow_window(mark), PieceParameter.WINDOW)
        invalid = checked(invalid, mark.every >= 1, PieceParameter.EVERY)
        invalid = checked(invalid, mark.max_missing >= 0, PieceParameter.MAX_MISSING)
        self.invalid_mark = checked(invalid, 0.0 <= mark.delay <= LONGEST, PieceParameter.MARK_DELAY)
        if self.invalid_mark == PieceParameter.NONE:
            var.copy(self.mark, mark)

    def first_invalid(self) -> PieceParameter:
        """The first parameter of all groups that is out of its range; NONE if all are valid."""
        invalid = checked(self.invalid_piece, self.invalid_start == PieceParameter.NONE, self.invalid_start)
        return checked(invalid, self.invalid_mark == PieceParameter.NONE, self.invalid_mark)


def checked(invalid: PieceParameter, is_valid: bool, parameter: PieceParameter) -> PieceParameter:
    """The first invalid parameter of a check so far; without one this parameter, unless it is valid."""
    return invalid if invalid != PieceParameter.NONE or is_valid else parameter


def has_narrow_window(mark: Mark) -> bool:
    """Whether the windows of two consecutive marks do not meet."""
    return mark.spacing == 0.0 or mark.window < 0.5 * mark.spacing
