"""Why the small block refuses a command."""

from ..declare import Choice

LIMITS = (".limit", ".missing", "angle")


class Fault(Choice):
    """Why the command was refused"""

    NONE = 0, "no fault"
    LIMIT = 0x42DD, "refused: the limit must be > 0", *LIMITS
