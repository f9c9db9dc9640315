"""The BEAT estimator: the sender's drift, and the offset of its index, from beats. Source: TwinCAT TS5066, corrections.

Times and lengths are in receiver cycles, offsets in indices."""

from dataclasses import dataclass

from .. import var
from .beat_history import BeatHistory
from .transition_zone import Observation, TransitionZone


@dataclass(slots=True)
class BeatEstimator:
    """The offset of the corrected index c from an even count of the receiver's cycles: c = n / r + offset(n), with the
    receiver's cycle n and r, a sender's cycle in receiver's cycles.

    With enough beats, the target of the offset is the confirmed difference plus what the sender has gained since the
    latest beat; before, in time mode, it is the confirmed difference alone. So that the offset is continuous, it goes
    over linearly after each identification, in `change_cycle`, from its value then, `offset_before`, to the new target
    within `blending` cycles.

    Parameters: `periods`, the distances that are averaged; `knee_share` and `knee`, the share of a beat's count in the
    first part of the time between two beats, and the length of that part; `ignores_drift`, the drift is never used; the
    two lengths of blending.
    """

    periods: int = 1
    knee_share: float = 0.95
    knee: float = 0.5
    ignores_drift: bool = False
    drift_blending: int = 90
    time_blending: int = 90
    confirmed: int = 0
    offset_before: float = 0.0
    change_cycle: int = 0
    blending: int = 1
    history: BeatHistory = var.part(BeatHistory)

    def start(self, difference: int) -> None:
        """Start in cycle 0, at the first difference."""
        self.history.start()
        self.confirmed = difference
        self.offset_before = float(difference)
        self.change_cycle = 0
        self.blending = self.time_blending

    def has_usable_drift(self) -> bool:
        """Whether there have been enough beats, and their drift may be used."""
        return self.history.mean > 0.0 and not self.ignores_drift

    def drift(self) -> float:
        """Data indices that the sender gains in a receiver cycle; 0 until there have been enough beats."""
        return self.history.sign / self.history.mean if self.history.mean > 0.0 else 0.0

    def offset(self, cycle: int) -> float:
        """Of the corrected index in this cycle, in data indices."""
        target = float(self.confirmed)
        if self.has_usable_drift():
            target += self.history.sign * self.beat_share((cycle - self.history.time) / self.history.mean)
        weight = min(1.0, (cycle - self.change_cycle) / self.blending)
        return (1.0 - weight) * self.offset_before + weight * target

    def beat_share(self, x: float) -> float:
        """The share of a beat's count that is in the offset after the part x of the time between two beats: 0 to 1."""
        if x >= 1.0:
            return 1.0
        if x <= self.knee:
            return x * (self.knee_share / self.knee)
        return self.knee_share + (x - self.knee) * ((1.0 - self.knee_share) / (1.0 - self.knee))

    def is_contradicted_by(self, zone: TransitionZone) -> bool:
        """Whether the zone shows a jump, or a beat opposite to the ones before: then the estimate starts again."""
        if zone.observation == Observation.JUMP:
            return True
        return zone.observation == Observation.BEAT and self.history.is_reversed_by(self.sign_in(zone))

    def sign_in(self, zone: TransitionZone) -> int:
        """1 where the zone's new difference is greater than the one before, else -1."""
        return 1 if zone.confirmed > self.confirmed else -1

    def update(self, zone: TransitionZone, cycle: int) -> None:
        """Change the target by what the zone shows in this cycle."""
        if zone.observation in (Observation.NOTHING, Observation.SETTLED, Observation.CLOSED):
            return
        self.offset_before = self.offset(cycle)
        self.change_cycle = cycle
        if zone.observation == Observation.JUMP:
            self.history.forget()
        elif zone.observation == Observation.BEAT:
            sign = self.sign_in(zone)
            is_reversed = self.history.is_reversed_by(sign)
            self.history.add(0.5 * (zone.first + zone.last), sign, self.periods)
            if is_reversed:
                self.history.beats = 1
        self.confirmed = zone.confirmed
        self.blending = self.drift_blending if self.has_usable_drift() else self.time_blending
