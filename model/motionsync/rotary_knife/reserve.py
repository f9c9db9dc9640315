"""The reserve of a cycle: the share of its time in which the knife was at rest."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock


@dataclass(slots=True)
class RestTime:
    """The times of a cycle, from one cut to the next.

    Attributes:
        has_cut: there has been a cut since the command start.
        rested: for how long the knife was at rest in this cycle, the present rest apart, s.
        is_resting: the knife is at rest.
        cut_clock: the time since the last cut.
        rest_clock: the time since the present rest began.
    """

    has_cut: bool = False
    rested: float = 0.0
    is_resting: bool = False
    cut_clock: Clock = var.part(Clock)
    rest_clock: Clock = var.part(Clock)

    def start(self, now: float) -> None:
        """The machine starts, with the knife at rest, at a time since the step's beginning, s."""
        self.has_cut = False
        self.is_resting = False
        self.rested = 0.0
        self.rest(now)

    def rest(self, now: float) -> None:
        """The knife is at rest from now on."""
        if not self.is_resting:
            self.is_resting = True
            self.rest_clock.start(now)

    def leave(self, now: float) -> None:
        """The knife is at rest no more, if it was."""
        if self.is_resting:
            self.is_resting = False
            self.rested += self.rest_clock.time + now

    def share(self, now: float, is_late: bool) -> float:
        """The reserve of the cycle that ends with a cut now; that of a late cut is 0, that of the first one is 1."""
        if not self.has_cut:
            return 1.0
        time = self.cut_clock.time + now
        if is_late or time <= 0.0:
            return 0.0
        return max(0.0, min(self.rested / time, 1.0))

    def cut(self, now: float) -> None:
        """A cut is made."""
        self.has_cut = True
        self.rested = 0.0
        self.cut_clock.start(now)

    def advance(self, h: float) -> None:
        self.cut_clock.advance(h)
        self.rest_clock.advance(h)
