"""The reserve of a cycle: the share of its time that the carriage was ready at home."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock


@dataclass(slots=True)
class CycleReserve:
    """The times of a cycle, from the start of the last cut's approach to that of the next one.

    Attributes:
        share: the reserve of the cycle that ended with the last start of an approach.
        waited: the time that the carriage was ready at home before starts of this cycle, s.
        is_first: there has been no cut since the command start.
        start_clock: the time since the last start of an approach.
        cycle_clock: the time since the start of the last cut's approach.
        ready_clock: the time since the carriage has been ready for a start.
    """

    share: float = 1.0
    waited: float = 0.0
    is_first: bool = True
    start_clock: Clock = var.part(Clock)
    cycle_clock: Clock = var.part(Clock)
    ready_clock: Clock = var.part(Clock)

    def reset(self) -> None:
        """The machine starts: no cycle is under way."""
        self.is_first = True
        self.waited = 0.0

    def start_approach(self, now: float, is_late: bool) -> None:
        """An approach starts, this time after the step's beginning."""
        self.waited += self.ready_clock.time + now
        if self.is_first:
            self.share = 1.0
        elif is_late:
            self.share = 0.0
        else:
            since_start = self.cycle_clock.time + now
            self.share = max(0.0, min(self.waited / since_start, 1.0)) if since_start > 0.0 else 1.0
        self.start_clock.start(now)

    def end_cut(self) -> None:
        """A cut is made: the cycle counts from the start of its approach."""
        self.is_first = False
        self.waited = 0.0
        var.copy(self.cycle_clock, self.start_clock)

    def advance(self, h: float) -> None:
        self.start_clock.advance(h)
        self.cycle_clock.advance(h)
        self.ready_clock.advance(h)
