"""Why the small block refuses a command."""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration

LIMITS = (".limit", ".missing", "angle")


class Fault(Enumeration):
    """Why the command was refused"""

    NONE = 0, "no fault"
    LIMIT = 0x42DD, "refused: the limit must be > 0", *LIMITS


class Refusal(Enumeration):
    """Why a call of the small block fails"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
