"""Beats: where the sender's cycle index gains or loses a count on the receiver's.

Source: TwinCAT TS5066, identification of beat effects.
"""

from dataclasses import dataclass

from ..var import Enumeration


class Finding(Enumeration):
    """What a cycle's difference has shown"""

    NOTHING = 0, "the stretch or the zone goes on"
    SETTLED = 1, "the first quiet stretch, at the first difference"
    SETTLED_ELSEWHERE = 2, "the first quiet stretch, at another difference"
    CLOSED = 3, "a quiet stretch at the confirmed difference: it was a flicker"
    BEAT = 4, "a quiet stretch one count further"
    JUMP = 5, "a quiet stretch two or more counts further"


@dataclass(slots=True)
class Zone:
    """The difference D = sender's index - receiver's index (in data indices), watched cycle by cycle.

    D steps by one at a beat. The jitter of the clocks widens the step to a zone in which D flickers. The step is
    identified only when D has been quiet for a while. The zone is `open` from the `first` change away from the
    `confirmed` D on; `last` is the latest change. `above` and `below` count the cycles of the zone with a D greater
    and less than the confirmed one. `finding` is what the present cycle has shown.
    """

    difference: int = 0
    confirmed: int = 0
    settled: bool = False
    open: bool = False
    first: int = 0
    last: int = 0
    above: int = 0
    below: int = 0
    finding: Finding = Finding.NOTHING

    def begin(self, difference: int) -> None:
        """In cycle 0; the first quiet stretch is still to come."""
        self.difference = difference
        self.confirmed = difference
        self.settled = False
        self.open = False
        self.last = 0

    def skip(self) -> None:
        """A cycle in which no new index is due."""
        self.finding = Finding.NOTHING

    def observe(self, cycle: int, difference: int, limit: int) -> None:
        """The D of a cycle. A stretch is quiet when D has not changed for `limit` cycles."""
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
        self.finding = Finding.NOTHING
        if cycle - self.last >= limit and (self.open or not self.settled):
            self.confirm()

    def confirm(self) -> None:
        """A quiet stretch closes the zone; its difference is the confirmed one from now on."""
        self.finding = self.finding_of(abs(self.difference - self.confirmed))
        self.confirmed = self.difference
        self.settled = True
        self.open = False

    def finding_of(self, step: int) -> Finding:
        """What a quiet stretch shows that is so many counts away from the confirmed difference."""
        if not self.settled:
            return Finding.SETTLED if step == 0 else Finding.SETTLED_ELSEWHERE
        if step == 0:
            return Finding.CLOSED
        return Finding.BEAT if step == 1 else Finding.JUMP
