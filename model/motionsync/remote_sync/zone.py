"""Beats: where the sender's cycle index gains or loses a count on the receiver's.

Source: TwinCAT TS5066, identification of beat effects.
"""

from dataclasses import dataclass

from ..var import Enumeration


class Finding(Enumeration):
    """What has come of a cycle's difference"""

    NOTHING = 0, "the stretch or the zone goes on"
    SETTLED = 1, "the first quiet stretch, at the first difference"
    SETTLED_ELSEWHERE = 2, "the first quiet stretch, at another difference"
    CLOSED = 3, "a quiet stretch at the confirmed difference: it was a flicker"
    BEAT = 4, "a quiet stretch one count further"
    JUMP = 5, "a quiet stretch two or more counts further"


@dataclass(slots=True)
class Zone:
    """The difference D = sender's index - receiver's index (in data indices), watched cycle by cycle.

    It steps by one at a beat; the jitter of the clocks widens the step to a zone in which it flickers. Only when it
    has been quiet for a while is the step identified. The zone is `open` from the `first` change away from the
    `confirmed` D on; `last` is the latest change. `above` and `below` count the cycles of the zone with a D greater
    and less than the confirmed one.
    """

    difference: int = 0
    confirmed: int = 0
    settled: bool = False
    open: bool = False
    first: int = 0
    last: int = 0
    above: int = 0
    below: int = 0

    def begin(self, difference: int) -> None:
        """In cycle 0; the first quiet stretch is still to come."""
        self.difference = difference
        self.confirmed = difference
        self.settled = False
        self.open = False
        self.last = 0

    def look(self, cycle: int, difference: int, limit: int) -> Finding:
        """At the D of a cycle; it is quiet when it has not changed for `limit` cycles."""
        if difference != self.difference:
            self.difference = difference
            self.last = cycle
            if not self.open:
                self.open = True
                self.first = cycle
                self.above = 0
                self.below = 0
        if self.open:
            self.above += 1 if difference > self.confirmed else 0
            self.below += 1 if difference < self.confirmed else 0
        if cycle - self.last < limit or (self.settled and not self.open):
            return Finding.NOTHING
        return self.confirm()

    def confirm(self) -> Finding:
        """A quiet stretch."""
        step = abs(self.difference - self.confirmed)
        settled = self.settled
        self.confirmed = self.difference
        self.settled = True
        self.open = False
        if not settled:
            return Finding.SETTLED if step == 0 else Finding.SETTLED_ELSEWHERE
        if step == 0:
            return Finding.CLOSED
        return Finding.BEAT if step == 1 else Finding.JUMP
