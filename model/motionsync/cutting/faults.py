"""Why a command for pieces is refused, and why marks stop the machine."""

from ..var import Enumeration


class PieceFault(Enumeration):
    """Why a command for pieces was refused (2 to 4), or marks have stopped the machine (18, 20)"""

    # A machine has further faults, with numbers of its own.
    NONE = 0, "no fault"
    ORDER = 2, "refused: an order needs a length above 0 and a quantity of at least 1", "order.length", "order.quantity"
    ORDERS_FULL = 3, "refused: 64 orders wait already", "order.length", "order.quantity"
    CALIBRATION = (
        4,
        "refused: calibration needs a piece that has been cut, and a measured length above 0 that leaves the factor "
        "within 1e-6 to 1e6",
        *("calibration.measured_length", "last.length"),
    )
    MARKS_MISSING = 18, "more marks in a row are missing than mark.max_missing allows", "mark.max_missing"
    MARKS_FULL = 20, "64 marks wait already"
