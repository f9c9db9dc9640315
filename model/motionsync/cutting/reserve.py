"""The reserve of a cycle: the share of its time in which the tool waits."""

from dataclasses import dataclass

from .. import var
from ..clock import Clock


@dataclass(slots=True)
class Reserve:
    """The times of a cycle, which leads from the start of one cut to that of the next: a saw's cut starts with its
    approach, a knife's is made in an instant.

    Attributes:
        share: the reserve of the cycle that ended last.
        is_first: no cut has been made since the command start.
        waited: the time of this cycle in which the tool has waited, the present wait apart, s.
        is_waiting: the tool is ready at rest.
        wait_clock: the time since the present wait began.
        start_clock: the time since a cut was started last.
        cycle_clock: the time since the last cut that was made was started.
    """

    share: float = 1.0
    is_first: bool = True
    waited: float = 0.0
    is_waiting: bool = False
    wait_clock: Clock = var.part(Clock)
    start_clock: Clock = var.part(Clock)
    cycle_clock: Clock = var.part(Clock)

    def reset(self) -> None:
        """The machine starts: no cycle is under way."""
        self.is_first = True
        self.waited = 0.0
        self.is_waiting = False

    def wait(self, now: float) -> None:
        """The tool waits from a time since the step's beginning on, s."""
        if not self.is_waiting:
            self.is_waiting = True
            self.wait_clock.start(now)

    def leave(self, now: float) -> None:
        """The tool waits no more, if it did."""
        if self.is_waiting:
            self.is_waiting = False
            self.waited += self.wait_clock.time + now

    def start_cut(self, now: float, is_late: bool) -> None:
        """A cut starts, and ends the cycle; the reserve of a late one is 0, that of the first one is 1."""
        self.leave(now)
        time = self.cycle_clock.time + now
        if self.is_first or (time <= 0.0 and not is_late):
            self.share = 1.0
        else:
            self.share = 0.0 if is_late else max(0.0, min(self.waited / time, 1.0))
        self.start_clock.start(now)

    def end_cut(self) -> None:
        """The cut is made: the next cycle counts from its start."""
        self.is_first = False
        self.waited = 0.0
        var.copy(self.cycle_clock, self.start_clock)

    def advance(self, h: float) -> None:
        self.wait_clock.advance(h)
        self.start_clock.advance(h)
        self.cycle_clock.advance(h)
