"""The BEAT estimator: the correction grows between the beats by the drift that the beats before have shown.

Source: TwinCAT TS5066, corrections. All dates and lengths are in receiver cycles, offsets in data indices.
"""

from dataclasses import dataclass

from .. import var
from .history import History
from .zone import Finding, Zone


@dataclass(slots=True)
class Beats:
    """The offset of the corrected index c from an even count of the receiver's cycles: c = n / r + offset(n).

    The law is the confirmed difference plus what the sender has gained since the latest beat, as long as beats enough
    are known; before, in time mode, it is the confirmed difference alone. After each identification, in the cycle
    `since`, the offset goes over linearly from what it was there, `origin`, to the new law within `blending` cycles:
    so it is continuous always.

    `periods`, `slope` (numerator) and `knee` (denominator of the first part's length), `forced`, and the two lengths of
    blending are parameters.
    """

    periods: int = 1
    slope: float = 0.95
    knee: float = 0.5
    forced: bool = False
    drift_blending: int = 90
    time_blending: int = 90
    confirmed: int = 0
    origin: float = 0.0
    since: int = 0
    blending: int = 1
    history: History = var.part(History)

    def begin(self, difference: int) -> None:
        """In cycle 0: at the first difference."""
        self.history.begin()
        self.confirmed = difference
        self.origin = float(difference)
        self.since = 0
        self.blending = self.time_blending

    def ready(self) -> bool:
        """Whether beats enough are known for a drift that may be used."""
        return self.history.mean > 0.0 and not self.forced

    def gain(self) -> float:
        """Data indices that the sender gains in a receiver cycle; 0 until enough beats are known."""
        return self.history.sign / self.history.mean if self.history.mean > 0.0 else 0.0

    def offset(self, cycle: int) -> float:
        law = float(self.confirmed)
        if self.ready():
            law += self.history.sign * self.share((cycle - self.history.date) / self.history.mean)
        w = min(1.0, (cycle - self.since) / self.blending)
        return (1.0 - w) * self.origin + w * law

    def share(self, x: float) -> float:
        """g: of the beat's count, after the part x of the time between two beats; all of it from 1 on."""
        if x >= 1.0:
            return 1.0
        if x <= self.knee:
            return x * (self.slope / self.knee)
        return self.slope + (x - self.knee) * ((1.0 - self.slope) / (1.0 - self.knee))

    def take(self, zone: Zone, finding: Finding, cycle: int) -> bool:
        """What the zone has found in this cycle; True where all begins anew, with an opposite beat or a jump."""
        if finding in (Finding.NOTHING, Finding.SETTLED, Finding.CLOSED):
            return False
        self.origin = self.offset(cycle)
        self.since = cycle
        anew = finding == Finding.JUMP
        if finding == Finding.JUMP:
            self.history.forget()
        elif finding == Finding.BEAT:
            sign = 1 if zone.confirmed > self.confirmed else -1
            anew = self.history.reverses(sign)
            self.history.add(0.5 * (zone.first + zone.last), sign, self.periods)
            if anew:
                self.history.beats = 1
        self.confirmed = zone.confirmed
        self.blending = self.drift_blending if self.ready() else self.time_blending
        return anew
