"""Why a machine that cuts to length refuses a command, and why it stops."""

from ..var import Enumeration

REFUSED_MARK = ("local.refused_mark", "statistics.marks_refused", "mark.sensor_distance", "mark.cut_offset")
NEXT_LENGTH = ("length", "order.length_active", "length_correction", "kerf")
LINE_VELOCITIES = ("master.velocity", "limits.max_line_velocity")
FACTORS = ("material_factor", "calibration.factor")
MARK_WINDOW = ("mark.window must be less than half of mark.spacing", "mark.spacing", "mark.window")
LONG_TRAVEL = (  # a refusal's text and the variables it names
    "the master must not travel more than 1e4 of the shortest piece in one step; if its counter wraps there, set "
    "master.period",
    "master.position",
    "master.velocity",
    "master.acceleration",
    "master.period",
)


class MarkRefusal(Enumeration):
    """Why a mark was refused"""

    NONE = 0, "none was"
    NO_LENGTH = (
        1,
        "mark refused: between its cut and the cut before it, or the material's front end, no piece is left",
        *REFUSED_MARK,
    )
    FAR = 2, "mark refused: its cut is more than 1e4 of mark.spacing ahead", *REFUSED_MARK, "mark.spacing"


class Contradiction(Enumeration):
    """Which tunable parameters contradict one another; 1 to 1000 are parameters out of their own ranges"""

    # A machine has further ones, with numbers of its own: from 1003 on.
    NONE = 0, "none"
    WINDOWS_MEET = 1001, *MARK_WINDOW
    FACTOR = 1002, "material_factor times calibration.factor must be 1e-12 to 1e12", *FACTORS


class NoLength(Enumeration):
    """Why the next piece has no length"""

    NONE = 0, "it has one, or need not have one"
    NOT_GIVEN = 1, "no piece is cut: no order waits, and length must be above 1e-6", "length"
    TOO_SHORT = (
        2,
        "no piece is cut: its length, and the material that it takes, must be above 1e-6 and above the rounding of "
        "positions",
        *NEXT_LENGTH,
    )
    TOO_LONG = 3, "no piece is cut: it must be at most limits.max_length", "limits.max_length", *NEXT_LENGTH


class PieceFault(Enumeration):
    """Why a command was refused (1 to 6), or why the machine has stopped (16, 18, 20)"""

    # A machine has further faults, with numbers of its own.
    NONE = 0, "no fault"
    START = 1, "refused: start needs state OFF, and with start_mode CONTINUE a cut to go on from", "start_mode"
    ORDER = 2, "refused: an order needs a length above 0 and a quantity of at least 1", "order.length", "order.quantity"
    ORDERS_FULL = 3, "refused: 64 orders wait already", "order.length", "order.quantity"
    CALIBRATION = (
        4,
        "refused: calibration needs a piece that has been cut, and a measured length above 0 that leaves the factor "
        "within 0.5 to 2",
        *("calibration.measured_length", "last.length", "calibration.factor"),
    )
    TUNABLE = 5, "refused: a tuned parameter is out of its range: local.refused_parameter shows which"
    CUT_NOW = 6, "refused: cut_now needs a machine that is running, and material beyond the last cut", "piece.length"
    CUT_MISSED = 16, "the line is too fast for the next cut, and late_mode is STOP_LINE", *LINE_VELOCITIES
    MARKS_MISSING = 18, "more marks in a row are missing than mark.max_missing allows", "mark.max_missing"
    MARKS_FULL = 20, "64 marks wait already"
