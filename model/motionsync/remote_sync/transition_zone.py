"""Beats: where the sender's index gains or loses a count. Source: TwinCAT TS5066, identification of beat effects."""

from dataclasses import dataclass

from ..var import Enumeration


class Observation(Enumeration):
    """What the difference in a cycle shows"""

    NOTHING = 0, "the stretch or the zone goes on"
    SETTLED = 1, "the first quiet stretch, at the first difference"
    SETTLED_ELSEWHERE = 2, "the first quiet stretch, at another difference"
    CLOSED = 3, "a quiet stretch at the confirmed difference: it was a flicker"
    BEAT = 4, "a quiet stretch one count further"
    JUMP = 5, "a quiet stretch two or more counts further"


@dataclass(slots=True)
class TransitionZone:
    """The difference D = sender's index - receiver's index (in data indices), watched cycle by cycle.

    D steps by one at a beat. The jitter of the clocks widens the step to a zone in which D flickers. The step is
    identified only when D has been quiet for a while. The zone `is_open` from the `first` change away from the
    `confirmed` D on; `last` is the latest change. `above` and `below` count the cycles of the zone with a D greater
    and less than the confirmed one. `observation` is what the present cycle shows.
    """

    difference: int = 0
    confirmed: int = 0
    is_settled: bool = False
    is_open: bool = False
    first: int = 0
    last: int = 0
    above: int = 0
    below: int = 0
    observation: Observation = Observation.NOTHING

    def start(self, difference: int) -> None:
        """Start in cycle 0; the first quiet stretch is still to come."""
        self.difference = difference
        self.confirmed = difference
        self.is_settled = False
        self.is_open = False
        self.last = 0

    def observe(self, cycle: int, difference: int, limit: int) -> None:
        """Take the D of a cycle. A stretch is quiet when D has not changed for `limit` cycles."""
        if difference != self.difference:
            self.difference = difference
            self.last = cycle
            if not self.is_open:
                self.is_open = True
                self.first = cycle
                self.above = 0
                self.below = 0
        if self.is_open:
            self.above += 1 if difference > self.confirmed else 0
            self.below += 1 if difference < self.confirmed else 0
        self.observation = Observation.NOTHING
        if cycle - self.last >= limit and (self.is_open or not self.is_settled):
            self.confirm()

    def confirm(self) -> None:
        """Close the zone by a quiet stretch; its difference is the confirmed one from now on."""
        self.observation = self.observation_of(abs(self.difference - self.confirmed))
        self.confirmed = self.difference
        self.is_settled = True
        self.is_open = False

    def observation_of(self, step: int) -> Observation:
        """What a quiet stretch shows that is so many counts away from the confirmed difference."""
        if not self.is_settled:
            return Observation.SETTLED if step == 0 else Observation.SETTLED_ELSEWHERE
        if step == 0:
            return Observation.CLOSED
        return Observation.BEAT if step == 1 else Observation.JUMP
