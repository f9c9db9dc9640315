"""The BEAT estimator: the correction grows between the beats by the drift that the beats before have shown.

Source: TwinCAT TS5066, corrections. All times and lengths are in receiver cycles, offsets in data indices.
"""

from dataclasses import dataclass

from .. import var
from .history import History
from .zone import Finding, Zone


@dataclass(slots=True)
class Beats:
    """The offset of the corrected index c from an even count of the receiver's cycles: c = n / r + offset(n).

    As long as enough beats are known, the law is the confirmed difference plus what the sender has gained since the
    latest beat; before, in time mode, it is the confirmed difference alone. After each identification, in the cycle
    `since`, the offset goes over linearly from what it was there, `origin`, to the new law within `blending` cycles.
    The offset is therefore always continuous.

    Parameters: `periods`, the distances that are averaged; `slope` and `knee`, the share of a beat's count in the first
    part of the time between two beats, and the length of that part; `forced`, the drift is never used; the two lengths
    of blending.
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
        """In cycle 0, at the first difference."""
        self.history.begin()
        self.confirmed = difference
        self.origin = float(difference)
        self.since = 0
        self.blending = self.time_blending

    def ready(self) -> bool:
        """Whether enough beats are known, and their drift may be used."""
        return self.history.mean > 0.0 and not self.forced

    def gain(self) -> float:
        """Data indices that the sender gains in a receiver cycle; 0 until enough beats are known."""
        return self.history.sign / self.history.mean if self.history.mean > 0.0 else 0.0

    def offset(self, cycle: int) -> float:
        """Of the corrected index in this cycle, in data indices."""
        law = float(self.confirmed)
        if self.ready():
            law += self.history.sign * self.share((cycle - self.history.time) / self.history.mean)
        w = min(1.0, (cycle - self.since) / self.blending)
        return (1.0 - w) * self.origin + w * law

    def share(self, x: float) -> float:
        """The share of a beat's count that is in the offset after the part x of the time between two beats: 0 to 1."""
        if x >= 1.0:
            return 1.0
        if x <= self.knee:
            return x * (self.slope / self.knee)
        return self.slope + (x - self.knee) * ((1.0 - self.slope) / (1.0 - self.knee))

    def is_contradicted_by(self, zone: Zone) -> bool:
        """Whether the zone has found a jump, or a beat opposite to the ones before: then the estimate begins anew."""
        if zone.finding == Finding.JUMP:
            return True
        return zone.finding == Finding.BEAT and self.history.reverses(self.sign_in(zone))

    def sign_in(self, zone: Zone) -> int:
        """1 where the zone's new difference is greater than the one before, else -1."""
        return 1 if zone.confirmed > self.confirmed else -1

    def learn(self, zone: Zone, cycle: int) -> None:
        """What the zone has found in this cycle changes the law."""
        if zone.finding in (Finding.NOTHING, Finding.SETTLED, Finding.CLOSED):
            return
        self.origin = self.offset(cycle)
        self.since = cycle
        if zone.finding == Finding.JUMP:
            self.history.forget()
        elif zone.finding == Finding.BEAT:
            sign = self.sign_in(zone)
            anew = self.history.reverses(sign)
            self.history.add(0.5 * (zone.first + zone.last), sign, self.periods)
            if anew:
                self.history.beats = 1
        self.confirmed = zone.confirmed
        self.blending = self.drift_blending if self.ready() else self.time_blending
