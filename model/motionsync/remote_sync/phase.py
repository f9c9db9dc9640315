"""The PHASE estimator: phase and drift of the sender's clock, tracked by a Kalman filter.

motionsync's own, beside the source's. The time of a beat is not the middle of its zone: the cycles of the zone that lie
beyond the beat are counted, which averages the jitter. The phase at that time is then known to a few thousandths of a
cycle. All times are in receiver cycles, the phase in data indices; for equal nominal cycles.
"""

from dataclasses import dataclass

from .. import var
from .history import History
from .zone import Finding, Zone

BEAT_DEVIATION = 0.005  # rho: standard deviation of the phase at a beat
WALK = 2e-15  # q: how fast the drift wanders, variance a cycle
DRIFT_DEVIATION = 3e-4  # d0: of the drift before the first beat
SLACK = 0.05  # mu: so far the phase may lie outside the count that the difference shows
START_VARIANCE = 1.0 / 12.0  # of a phase of which only the count is known
BEATS_TO_SYNC = 2
LONG = 20000.0  # cycles between the first two beats: so long a walk would let the drift overshoot


@dataclass(slots=True)
class PhaseFilter:
    """The sender's phase less the receiver's count is phase + drift (n - time) in cycle n.

    `phase_variance` and `drift_variance` tell how uncertain both are at `time`, and `covariance` how far their errors
    belong together. What an identification in the cycle `since` changes at once is worked off by a `rest` that fades
    linearly within `blending` cycles, so that the offset is continuous. `blending` and `forced` (the drift is never
    used) are parameters.
    """

    forced: bool = False
    blending: int = 90
    phase: float = 0.0
    drift: float = 0.0
    time: float = 0.0
    phase_variance: float = 0.0
    covariance: float = 0.0
    drift_variance: float = 0.0
    rest: float = 0.0
    since: int = 0
    confirmed: int = 0
    history: History = var.part(History)

    def begin(self, difference: int) -> None:
        """In cycle 0: the phase is anywhere in the count of the first difference."""
        self.history.begin()
        self.confirmed = difference
        self.phase = difference + 0.5
        self.drift = 0.0
        self.time = 0.0
        self.phase_variance = START_VARIANCE
        self.covariance = 0.0
        self.drift_variance = DRIFT_DEVIATION * DRIFT_DEVIATION
        self.rest = 0.0
        self.since = 0

    def ready(self) -> bool:
        """Whether enough beats are known, and their drift may be used."""
        return self.history.beats >= BEATS_TO_SYNC and not self.forced

    def offset(self, cycle: int) -> float:
        """Of the corrected index from the receiver's count in this cycle, in data indices."""
        return self.estimate(cycle) + self.rest * max(0.0, 1.0 - (cycle - self.since) / self.blending)

    def estimate(self, cycle: int) -> float:
        return self.phase + self.drift * (cycle - self.time)

    def learn(self, zone: Zone, cycle: int) -> None:
        """What the zone has found in this cycle changes the estimate; with a jump the beats are forgotten."""
        before = self.offset(cycle) if zone.finding != Finding.NOTHING else 0.0
        match zone.finding:
            case Finding.SETTLED_ELSEWHERE:
                self.phase = zone.confirmed + 0.5
            case Finding.BEAT:
                self.correct(zone, cycle)
            case Finding.JUMP:
                self.phase = zone.confirmed + 0.5
                self.time = float(cycle)
                self.phase_variance = START_VARIANCE
                self.covariance = 0.0
                self.history.forget()
            case _:
                pass
        self.confirmed = zone.confirmed
        held = not zone.open and self.try_hold(cycle)
        moved = zone.finding in (Finding.SETTLED_ELSEWHERE, Finding.BEAT, Finding.JUMP)
        if moved or (zone.finding == Finding.CLOSED and held):
            self.rest = before - self.estimate(cycle)
            self.since = cycle

    def correct(self, zone: Zone, cycle: int) -> None:
        """A beat: at its time the phase was the border between both counts.

        The filter predicts phase and drift at that time with constant drift. Then it corrects both by the error of the
        predicted phase, each with its own gain: only the phase is measured."""
        gained = zone.confirmed > self.confirmed
        beat_time = cycle + 0.5 - (zone.above if gained else zone.below)
        border = float(max(self.confirmed, zone.confirmed))
        self.history.add(beat_time, 1 if gained else -1, 1)
        span = beat_time - self.time
        if self.history.beats == 2 and self.history.known == 1 and span > LONG:
            self.join(beat_time, border, 1.0 if gained else -1.0, span)
            return
        predicted = self.phase + self.drift * span
        phase_variance = (
            self.phase_variance
            + 2.0 * span * self.covariance
            + span * span * self.drift_variance
            + WALK * span * span * span / 3.0
        )
        covariance = self.covariance + span * self.drift_variance + WALK * span * span / 2.0
        drift_variance = self.drift_variance + WALK * span
        error_variance = phase_variance + BEAT_DEVIATION * BEAT_DEVIATION
        phase_gain = phase_variance / error_variance
        drift_gain = covariance / error_variance
        error = border - predicted
        self.phase = predicted + phase_gain * error
        self.drift += drift_gain * error
        self.time = beat_time
        self.phase_variance = (1.0 - phase_gain) * phase_variance
        self.covariance = (1.0 - phase_gain) * covariance
        self.drift_variance = drift_variance - drift_gain * covariance

    def join(self, beat_time: float, border: float, gained: float, span: float) -> None:
        """The first two beats, far apart: the line through both.

        A single beat says almost nothing about the drift; over so long a gap the filter would attribute the error to
        the wandering of the drift and overshoot."""
        variance = BEAT_DEVIATION * BEAT_DEVIATION
        self.drift = gained / span
        self.phase = border
        self.time = beat_time
        self.phase_variance = variance
        self.covariance = variance / span
        self.drift_variance = 2.0 * variance / (span * span)

    def try_hold(self, cycle: int) -> bool:
        """Between two zones the phase is in the confirmed count. Where the estimate would leave that count, the drift
        is wrong: it becomes the one that leads to the border. Whether that was so."""
        least = self.confirmed - SLACK
        greatest = self.confirmed + 1.0 + SLACK
        now = self.estimate(cycle)
        if least <= now <= greatest:
            return False
        now = least if now < least else greatest
        self.drift = (now - self.phase) / (cycle - self.time)
        return True
