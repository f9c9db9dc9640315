"""The PHASE estimator: phase and drift of the sender's clock, tracked by a Kalman filter.

motionsync's own, beside the source's. A beat is dated by counting the cycles of its zone that lie beyond it, which
averages the jitter, instead of by the zone's middle; each date tells the phase there to a few thousandths of a cycle.
All times are in receiver cycles, the phase in data indices; for equal nominal cycles.
"""

from dataclasses import dataclass

from .. import var
from .history import History
from .zone import Finding, Zone

DATE_DEVIATION = 0.005  # rho: standard deviation of the phase at a beat
WALK = 2e-15  # q: how fast the drift wanders, variance a cycle
DRIFT_DEVIATION = 3e-4  # d0: of the drift before the first beat
SLACK = 0.05  # mu: so far the phase may lie outside the count that the difference shows
START_VARIANCE = 1.0 / 12.0  # of a phase of which only the count is known
BEATS_TO_SYNC = 2
LONG = 20000.0  # cycles between the first two beats: so long a walk would let the drift overshoot


@dataclass(slots=True)
class Phase:
    """The sender's phase less the receiver's count is x + d (n - t) in cycle n, with the covariances p11, p12, p22.

    What an identification in the cycle `since` changes at once is worked off by a `rest` that fades linearly within
    `blending` cycles, so that the offset is continuous. `blending` and `forced` are parameters.
    """

    forced: bool = False
    blending: int = 90
    x: float = 0.0
    d: float = 0.0
    t: float = 0.0
    p11: float = 0.0
    p12: float = 0.0
    p22: float = 0.0
    rest: float = 0.0
    since: int = 0
    confirmed: int = 0
    history: History = var.part(History)

    def begin(self, difference: int) -> None:
        """In cycle 0: anywhere in the first difference's count."""
        self.history.begin()
        self.confirmed = difference
        self.x = difference + 0.5
        self.d = 0.0
        self.t = 0.0
        self.p11 = START_VARIANCE
        self.p12 = 0.0
        self.p22 = DRIFT_DEVIATION * DRIFT_DEVIATION
        self.rest = 0.0
        self.since = 0

    def ready(self) -> bool:
        return self.history.beats >= BEATS_TO_SYNC and not self.forced

    def offset(self, cycle: int) -> float:
        return self.estimate(cycle) + self.rest * max(0.0, 1.0 - (cycle - self.since) / self.blending)

    def estimate(self, cycle: int) -> float:
        return self.x + self.d * (cycle - self.t)

    def take(self, zone: Zone, finding: Finding, cycle: int) -> bool:
        """What the zone has found in this cycle; True where the beats are forgotten, with a jump."""
        before = self.offset(cycle) if finding != Finding.NOTHING else 0.0
        match finding:
            case Finding.SETTLED_ELSEWHERE:
                self.x = zone.confirmed + 0.5
            case Finding.BEAT:
                self.correct(zone, cycle)
            case Finding.JUMP:
                self.x = zone.confirmed + 0.5
                self.t = float(cycle)
                self.p11 = START_VARIANCE
                self.p12 = 0.0
                self.history.forget()
            case _:
                pass
        self.confirmed = zone.confirmed
        held = not zone.open and self.hold_in(cycle)
        moved = finding in (Finding.SETTLED_ELSEWHERE, Finding.BEAT, Finding.JUMP)
        if moved or (finding == Finding.CLOSED and held):
            self.rest = before - self.estimate(cycle)
            self.since = cycle
        return finding == Finding.JUMP

    def correct(self, zone: Zone, cycle: int) -> None:
        """A beat: there, at the time b, the phase was the border between both counts. Prediction to b with constant
        drift, then the gains g1 and g2 of a measurement of the phase alone."""
        gained = zone.confirmed > self.confirmed
        b = cycle + 0.5 - (zone.above if gained else zone.below)
        border = float(max(self.confirmed, zone.confirmed))
        self.history.add(b, 1 if gained else -1, 1)
        span = b - self.t
        if self.history.beats == 2 and self.history.known == 1 and span > LONG:
            self.join(b, border, 1.0 if gained else -1.0, span)
            return
        predicted = self.x + self.d * span
        p11 = self.p11 + 2.0 * span * self.p12 + span * span * self.p22 + WALK * span * span * span / 3.0
        p12 = self.p12 + span * self.p22 + WALK * span * span / 2.0
        p22 = self.p22 + WALK * span
        s = p11 + DATE_DEVIATION * DATE_DEVIATION
        g1 = p11 / s
        g2 = p12 / s
        error = border - predicted
        self.x = predicted + g1 * error
        self.d += g2 * error
        self.t = b
        self.p11 = (1.0 - g1) * p11
        self.p12 = (1.0 - g1) * p12
        self.p22 = p22 - g2 * p12

    def join(self, b: float, border: float, gained: float, span: float) -> None:
        """The first two beats, far apart: the line through both dates. The one before told next to nothing of the
        drift, and the filter would take too much of that error for a walk up to now."""
        variance = DATE_DEVIATION * DATE_DEVIATION
        self.d = gained / span
        self.x = border
        self.t = b
        self.p11 = variance
        self.p12 = variance / span
        self.p22 = 2.0 * variance / (span * span)

    def hold_in(self, cycle: int) -> bool:
        """Between two zones the phase is in the confirmed count: where it would leave that, the drift was wrong."""
        least = self.confirmed - SLACK
        greatest = self.confirmed + 1.0 + SLACK
        now = self.estimate(cycle)
        if least <= now <= greatest:
            return False
        now = least if now < least else greatest
        self.d = (now - self.x) / (cycle - self.t)
        return True
