"""Why the machine does not do what it was told, and why it stops. The numbers are our own."""

from ..master import TURNS
from ..var import Enumeration

END_POSITIONS = ("axis.min_position", "axis.max_position")
GAP = ("gap.distance", "gap.travel")
MARKS = ("mark.spacing", "mark.window")


class Fault(Enumeration):
    """Why a command was refused (1 to 6), or why the machine has stopped (16 to 20)"""

    NONE = 0, "no fault"
    START = 1, "refused: start needs state OFF, and with start_mode CONTINUE a cut to go on from", "start_mode"
    ORDER = 2, "refused: an order needs a length above 0 and a quantity of at least 1", "order.length", "order.quantity"
    ORDERS_FULL = 3, "refused: 64 orders wait already", "order.length", "order.quantity"
    CALIBRATION = (
        4,
        "refused: calibration needs a piece that has been cut, and a measured length above 0 that leaves the factor "
        "within 1e-6 to 1e6",
        "calibration.measured_length",
        "last.length",
    )
    TUNABLE = 5, "refused: a tuned parameter is out of its range: local.refused_parameter tells which"
    CUT_NOW = 6, "refused: cut_now needs a machine that is running"
    CUT_MISSED = (
        16,
        "the line is too fast for the next cut, and late_mode is STOP_LINE",
        "master.velocity",
        "limits.max_line_velocity",
    )
    STROKE = 17, "the carriage has to stop before the end of its stroke", "slave.position", *END_POSITIONS
    MARKS_MISSING = 18, "more marks in a row are missing than mark.max_missing allows", "mark.max_missing"
    TOOL_TIMEOUT = 19, "tool.done has not come within tool.timeout", "tool.timeout"
    MARKS_FULL = 20, "64 marks wait already"


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TURNS
    HOME = 2, "home_position must lie between the software end positions", "home_position", *END_POSITIONS
    INITIAL_POSITION = (
        3,
        "axis.initial_position must lie between the software end positions",
        "axis.initial_position",
        *END_POSITIONS,
    )
    WINDOW = 4, "mark.window must be less than half of mark.spacing", *MARKS
    TRAVEL = (
        5,
        "the master must not travel more than 1e4 of the shortest piece in one step",
        "master.position",
        "master.velocity",
        "master.acceleration",
    )
