"""Why a machine that cuts to length refuses a command, and why it stops."""

from ..var import Enumeration

LINE_VELOCITIES = ("master.velocity", "limits.max_line_velocity")
LONG_TRAVEL = (  # a refusal's text and the variables it names
    "the master must not travel more than 1e4 of the shortest piece in one step; if its counter wraps there, set "
    "master.period",
    "master.position",
    "master.velocity",
    "master.acceleration",
    "master.period",
)


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
        "within 1e-6 to 1e6",
        *("calibration.measured_length", "last.length"),
    )
    TUNABLE = 5, "refused: a tuned parameter is out of its range: local.refused_parameter shows which"
    CUT_NOW = 6, "refused: cut_now needs a machine that is running"
    CUT_MISSED = 16, "the line is too fast for the next cut, and late_mode is STOP_LINE", *LINE_VELOCITIES
    MARKS_MISSING = 18, "more marks in a row are missing than mark.max_missing allows", "mark.max_missing"
    MARKS_FULL = 20, "64 marks wait already"
