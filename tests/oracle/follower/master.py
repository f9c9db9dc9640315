"""The master as the Follower's oracle sees it: where it is, and when it reaches, leaves or falls below a position."""

from dataclasses import replace

from tests.oracle.follower.cycle import DECEL, FOLLOWING, HOMING, SYNCHRONIZED, Phase
from tests.oracle.master import CLOSE, Stretch
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

MOVED = mp.mpf(1e-9)
"""Of the master's cycle: how far it may be from where it was (2) or back from its largest value (14)."""

CYCLE = (FOLLOWING, SYNCHRONIZED, DECEL, HOMING)


class MasterCrossings:
    """A run at its present time, on the present stretch of the master; `largest`: its position since leaving park."""

    stretch: Stretch
    time: Number
    state: int
    phase: Phase | None
    largest: Number

    def _master_position(self) -> Number:
        return self.stretch.at(self.time).position

    def _reached(self) -> Number:
        """The master's position in the cycle's sense: back by rounding it is still where it was."""
        return max(self._master_position(), self.largest) if self.state in CYCLE else self._master_position()

    def _reaches(self, position: Number, until: Number) -> Number | None:
        """When the master reaches a position from below; now if it is there."""
        margin = CLOSE * (1 + abs(position))
        if self._reached() >= position - margin:
            return self.time
        if self.stretch.direction <= 0 or self.stretch.at(until).position < position - margin:
            return None
        return self.stretch.when(position, self.time, until)

    def _falls(self, position: Number, until: Number, *, touching: bool = False) -> Number | None:
        """When the master, on its way back, reaches a position (touching) or goes below it."""
        margin = CLOSE * (1 + abs(position)) * (1 if touching else -1)
        if self.stretch.direction >= 0 or self.stretch.at(until).position > position + margin:
            return None
        return self.time if self._master_position() <= position else self.stretch.when(position, self.time, until)

    def _leaves(self, position: Number, until: Number) -> Number | None:
        """When the master is further away from a position than it may be."""
        phase, direction = self.phase, self.stretch.direction
        assert phase
        allowed = MOVED * phase.values.cycle
        if abs(self.stretch.at(until).position - position) <= allowed:
            return None
        if abs(self._master_position() - position) > allowed:
            return self.time
        return self.stretch.when(position + direction * allowed, self.time, until)


def wrapped_start(pieces: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return pieces
    shift = mp.floor(pieces[0].start.position / period) * period
    return [replace(p, start=replace(p.start, position=p.start.position - shift)) for p in pieces]
