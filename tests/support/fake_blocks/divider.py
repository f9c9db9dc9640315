"""A block with an input of each type that fails in each possible way, for tests of tools that serve any block."""

from dataclasses import dataclass

from motionsync import var
from motionsync.var import Enumeration


class Mode(Enumeration):
    """What the small block does"""

    DIVIDE = 1, "1 / divisor"
    REFUSE = -2, "refuses"


class Answer(Enumeration):
    """What it answers"""

    NONE = 0, "done"
    REQUESTED = 7, "asked to refuse", "mode", "flag", "count"


@dataclass(slots=True)
class Divider:
    """Divides a gain by a divisor."""

    divisor: float = var.input(1.0, "the divisor")
    gain: float = var.parameter(1.0, "a factor", tunable=True, above=0.0)
    mode: Mode = var.input(Mode.DIVIDE, "what to do")
    flag: bool = var.input(False, "a flag")
    count: int = var.input(3, "a number")
    quotient: float = var.output(0.0, "gain / divisor")
    counted: int = var.output(0, "count, or its opposite where flag is set")

    def initialize(self) -> Answer:
        return Answer.NONE

    def step(self, h: float) -> Answer:
        if self.mode == Mode.REFUSE:
            return Answer.REQUESTED
        self.quotient = self.gain / self.divisor
        self.counted = -self.count if self.flag else self.count
        return Answer.NONE
