"""Why a command is refused, and why a call of the block fails."""

from ..master import TOO_MANY_TURNS
from ..var import Enumeration


class Fault(Enumeration):
    """Why a command was refused"""

    NONE = 0, "no fault"
    PHASING = 1, "command refused: output_phasing must have a magnitude of 1e-9 to 1e12", "output_phasing"


class Refusal(Enumeration):
    """Why `initialize` or `step` cannot be carried out with the values given; such a call has changed nothing"""

    NONE = 0, "done"
    MASTER_TURNS = 1, *TOO_MANY_TURNS
