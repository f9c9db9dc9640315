"""What is wrong with the samples of a master, reported from all of them: each rule as it is described.

The change of a sample is that of the position since the sample before, its time the time since then."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

COUNTS, JUMP, VELOCITY, FROZEN = 1, 2, 3, 5
ROW = 30


@dataclass(frozen=True)
class Sample:
    """A position (unwrapped, u) so many seconds after the sample before, with velocity and acceleration."""

    time: float
    position: float
    velocity: float = 0.0
    acceleration: float = 0.0


@dataclass(frozen=True)
class Reported:
    """What is reported after a sample."""

    code: int
    likely_period: float
    velocity_ratio: float


def reported(samples: Sequence[Sample], *, has_velocity: bool, is_smoothed: bool = False) -> list[Reported]:
    """What is reported after each sample; `has_velocity`: modes 1 and 2; `is_smoothed`: mode 4."""
    watch = _Watch(samples, has_velocity)
    result: list[Reported] = []
    shown: list[int] = []  # the codes of the episode, in the order in which they were seen
    quiet = period = ratio = 0.0
    code = 0
    for n in range(len(samples)):
        quiet += samples[n].time if n else 0.0
        if code == 0 and not is_smoothed and watch.comes_in_counts(n):
            code = COUNTS
        seen: list[int] = []
        if watch.is_jump(n - 1):
            seen.append(JUMP)
            period = watch.excess(n - 1)
        if has_velocity and (row := watch.contradicting_row(n)) >= ROW:
            seen.append(VELOCITY)
            ratio = watch.ratio(n, row)
        if has_velocity and watch.is_frozen(n):
            seen.append(FROZEN)
        if seen:
            quiet = 0.0
            if min(seen) not in shown:
                shown.append(min(seen))
                code = min(seen)
        elif shown and quiet >= 10.0 * (1.0 - 1e-9):
            shown, code = [], 0
        result.append(Reported(code, period, ratio))
    return result


class _Watch:
    def __init__(self, samples: Sequence[Sample], has_velocity: bool) -> None:
        self.samples, self.has_velocity = samples, has_velocity
        self.changes = [0.0] + [b.position - a.position for a, b in pairwise(samples)]
        self.jumps: dict[int, bool] = {}
        self.alternating: dict[int, int] = {}

    # --- counts ---

    def second_difference(self, n: int) -> float:
        """0 if it is rounding."""
        if n < 2:
            return 0.0
        difference = self.changes[n] - self.changes[n - 1]
        is_rounding = abs(difference) <= 1e-8 * (abs(self.samples[n].position) + abs(self.changes[n]))
        return 0.0 if is_rounding else difference

    def comes_in_counts(self, n: int) -> bool:
        """Whether this second difference, and the 30 before it that are not 0, change their sign alone."""
        difference = self.second_difference(n)
        if difference == 0.0:
            return False
        before = next((d for m in range(n - 1, 1, -1) if (d := self.second_difference(m)) != 0.0), 0.0)
        last = next((m for m in range(n - 1, 1, -1) if self.second_difference(m) != 0.0), 0)
        time, former = self.samples[n].time, self.samples[n - 1].time
        alternates = abs(difference + before) <= 1e-3 * abs(difference) and abs(time - former) <= 1e-9 * time
        self.alternating[n] = self.alternating.get(last, 0) + 1 if alternates else 0
        return self.alternating[n] >= ROW

    # --- jumps ---

    def travel(self, n: int) -> float:
        """I: by the velocities at both ends."""
        a, b = self.samples[n - 1], self.samples[n]
        return b.time * (a.velocity + b.velocity) / 2.0

    def is_jump(self, n: int) -> bool:
        """Whether the change at sample n, the one before the newest, was a jump."""
        if n < 1:
            return False
        if n not in self.jumps:
            self.jumps[n] = self._is_candidate(n) and self._speed(n + 1) <= 0.1 * self._speed(n)
        return self.jumps[n]

    def _speed(self, n: int) -> float:
        return abs(self.changes[n]) / self.samples[n].time

    def _is_candidate(self, n: int) -> bool:
        if n < ROW - 1:  # it is the thirtieth
            return False
        a, b = self.samples[n - 1], self.samples[n]
        before = [m for m in range(1, n) if not self.is_jump(m)]
        greatest = max((abs(self.changes[m]) for m in before), default=0.0)
        fastest = max((self._speed(m) for m in before), default=0.0)
        given = 0.0
        if self.has_velocity:
            given = b.time * max(abs(a.velocity), abs(b.velocity))
            given += b.time**2 / 2.0 * max(abs(a.acceleration), abs(b.acceleration))
        usual = max(greatest, b.time * fastest, given)
        return greatest > 0.0 and abs(self.changes[n]) > 10.0 * usual

    def excess(self, n: int) -> float:
        expected = self.travel(n)
        if not self.has_velocity:
            expected = self.changes[n - 1] * self.samples[n].time / self.samples[n - 1].time
        return abs(self.changes[n] - expected)

    # --- velocities ---

    def _contradicts(self, n: int) -> bool:
        change, travel, a, b = self.changes[n], self.travel(n), self.samples[n - 1], self.samples[n]
        allowed = (
            max(abs(change), abs(travel)) / 2.0,
            b.time**2 / 2.0 * max(abs(a.acceleration), abs(b.acceleration)),
            1e-8 * (abs(b.position) + abs(change)),
        )
        return change != 0.0 and abs(change - travel) > max(allowed)

    def contradicting_row(self, n: int) -> int:
        """How many samples in a row, the newest one included, contradict their velocity with a change of one sign."""
        length = 0
        while n - length >= 1 and self._contradicts(n - length) and self.changes[n - length] * self.changes[n] > 0.0:
            length += 1
        return length

    def ratio(self, n: int, row: int) -> float:
        numbers = range(n - row + 1, n + 1)
        return sum(self.travel(m) for m in numbers) / sum(self.changes[m] for m in numbers)

    def is_frozen(self, n: int) -> bool:
        """Whether the position has not changed in 30 samples in which the line runs, and for far too long a way."""
        if n < 1 or self.changes[n] != 0.0 or self.travel(n) == 0.0:
            return False
        begin = max(m for m in range(n) if m == 0 or self.changes[m] != 0.0)
        running = [m for m in range(begin + 1, n + 1) if self.travel(m) != 0.0]
        way = sum(
            self.samples[m].time * (abs(self.samples[m - 1].velocity) + abs(self.samples[m].velocity)) / 2.0
            for m in running
        )
        greatest = max((abs(self.changes[m]) for m in range(1, n) if not self.is_jump(m)), default=0.0)
        return len(running) >= ROW and way > 100.0 * greatest and way > 2e-7 * abs(self.samples[n].position)
