"""The PHASE estimator, motionsync's own: phase and drift of the sender's clock, tracked by a Kalman filter.

The time of a beat is not the middle of its zone: the cycles of the zone that are beyond the beat are counted, which
averages the jitter. All times are in receiver cycles, the phase in data indices; for equal nominal cycles.
"""

from dataclasses import dataclass

from .. import var
from .beat_history import BeatHistory
from .transition_zone import Observation, TransitionZone

BEAT_DEVIATION = 0.005  # rho: standard deviation of the phase at a beat
WALK = 2e-15  # q: how fast the drift wanders, variance a cycle
DRIFT_DEVIATION = 3e-4  # d0: of the drift before the first beat
SLACK = 0.05  # mu: so far the phase may be outside the count that the difference shows
START_VARIANCE = 1.0 / 12.0  # of a phase of which only the count is determined
BEATS_TO_SYNC = 2
LONG = 20000.0  # cycles between the first two beats: so long a walk would let the drift overshoot


@dataclass(slots=True)
class PhaseFilter:
    """The sender's phase less the receiver's count is phase + drift (n - time) in cycle n.

    `phase_variance` and `drift_variance` are the uncertainties of both at `time`, and `covariance` is how far their
    errors depend on each other. What an identification in the cycle `change_cycle` changes at once is taken back by a
    `remainder` that fades linearly within `blending` cycles, so that the offset is continuous. `blending` and
    `ignores_drift` (the drift is never used) are parameters.
    """

    ignores_drift: bool = False
    blending: int = 90
    phase: float = 0.0
    drift: float = 0.0
    time: float = 0.0
    phase_variance: float = 0.0
    covariance: float = 0.0
    drift_variance: float = 0.0
    remainder: float = 0.0
    change_cycle: int = 0
    confirmed: int = 0
    history: BeatHistory = var.part(BeatHistory)

    def start(self, difference: int) -> None:
        """Start in cycle 0: the phase is anywhere in the count of the first difference."""
        self.history.start()
        self.confirmed = difference
        self.phase = difference + 0.5
        self.drift = 0.0
        self.time = 0.0
        self.phase_variance = START_VARIANCE
        self.covariance = 0.0
        self.drift_variance = DRIFT_DEVIATION * DRIFT_DEVIATION
        self.remainder = 0.0
        self.change_cycle = 0

    def has_usable_drift(self) -> bool:
        """Whether there have been enough beats, and their drift may be used."""
        return self.history.beats >= BEATS_TO_SYNC and not self.ignores_drift

    def offset(self, cycle: int) -> float:
        """Of the corrected index from the receiver's count in this cycle, in data indices."""
        return self.estimate(cycle) + self.remainder * max(0.0, 1.0 - (cycle - self.change_cycle) / self.blending)

    def estimate(self, cycle: int) -> float:
        return self.phase + self.drift * (cycle - self.time)

    def update(self, zone: TransitionZone, cycle: int) -> None:
        """Change the estimate by what the zone shows in this cycle; with a jump the beats are forgotten."""
        before = self.offset(cycle) if zone.observation != Observation.NOTHING else 0.0
        match zone.observation:
            case Observation.SETTLED_ELSEWHERE:
                self.phase = zone.confirmed + 0.5
            case Observation.BEAT:
                self.correct_by_beat(zone, cycle)
            case Observation.JUMP:
                self.phase = zone.confirmed + 0.5
                self.time = float(cycle)
                self.phase_variance = START_VARIANCE
                self.covariance = 0.0
                self.history.forget()
            case _:
                pass
        self.confirmed = zone.confirmed
        is_limited = not zone.is_open and self.try_limit(cycle)
        has_moved = zone.observation in (Observation.SETTLED_ELSEWHERE, Observation.BEAT, Observation.JUMP)
        if has_moved or (zone.observation == Observation.CLOSED and is_limited):
            self.remainder = before - self.estimate(cycle)
            self.change_cycle = cycle

    def correct_by_beat(self, zone: TransitionZone, cycle: int) -> None:
        """Correct phase and drift by a beat, at whose time the phase was the border between both counts: predict both
        with constant drift, then correct each, with its own gain, by the error of the predicted phase."""
        has_gained = zone.confirmed > self.confirmed
        beat_time = cycle + 0.5 - (zone.above if has_gained else zone.below)
        border = float(max(self.confirmed, zone.confirmed))
        self.history.add(beat_time, 1 if has_gained else -1, 1)
        span = beat_time - self.time
        if self.history.beats == 2 and self.history.count == 1 and span > LONG:
            self.fit_two_beats(beat_time, border, 1.0 if has_gained else -1.0, span)
            return
        predicted = self.phase + self.drift * span
        phase_variance = self.phase_variance + 2.0 * span * self.covariance + span * span * self.drift_variance
        phase_variance += WALK * span * span * span / 3.0
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

    def fit_two_beats(self, beat_time: float, border: float, sign: float, span: float) -> None:
        """Take the line through the first two beats, which are far apart: over so long a gap the filter would attribute
        the error to the wandering of the drift, and overshoot."""
        variance = BEAT_DEVIATION * BEAT_DEVIATION
        self.drift = sign / span
        self.phase = border
        self.time = beat_time
        self.phase_variance = variance
        self.covariance = variance / span
        self.drift_variance = 2.0 * variance / (span * span)

    def try_limit(self, cycle: int) -> bool:
        """Keep the phase in the confirmed count between two zones: if the estimate would leave that count, the drift is
        wrong and becomes the one that leads to the border. Whether that was so."""
        lowest = self.confirmed - SLACK
        highest = self.confirmed + 1.0 + SLACK
        estimate = self.estimate(cycle)
        if lowest <= estimate <= highest:
            return False
        border = lowest if estimate < lowest else highest
        self.drift = (border - self.phase) / (cycle - self.time)
        return True
