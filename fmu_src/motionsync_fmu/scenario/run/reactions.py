"""The reactions of a scenario in one run, and the drive of its master: the program of a controller with a task cycle.

The cycle is the *scan*, the step size in the scenario's file, whatever the step size of the run is. At each of its
multiples the program uses outputs that were sampled SAMPLE_LEAD of a scan earlier: what happens exactly at a scan is
seen at the next one, independently of rounding. What it sets acts from the scan on, or `after` seconds later. A master
that follows a velocity takes it at each scan.
"""

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from heapq import heappop, heappush
from itertools import count
from operator import attrgetter
from typing import Any

import numpy as np

from ..recording import Reals
from ..scenario import Scenario
from ..script import Script
from ..settings import OutputCondition, Reaction, Setting, UnmetReaction

SAMPLE_LEAD = 1.0 / 128.0  # of a scan: how long before it the outputs are sampled
COMPARISON_MARGIN = 1e-9  # of a value, at least of 1: by so much it is beyond another, or else it is equal
DECIMALS = 12  # of a scan's time in s: then a time that is typed is the same number
UNIT = 1e12  # units of the last decimal in 1
LONG = 8192.0  # s; from here on, neighbouring numbers are more than a unit of the last decimal apart


class ReactionProgram:
    """The inputs of one run: the settings of the scenario, those of its reactions to outputs, and the motion of the
    master.

    Attributes:
        names: the outputs that the conditions compare and that the master follows.
        settings: those made so far.
        master: the scripted axis; one with a drive is determined up to the scan of the next sample.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._drive, self._scan = scenario.drive, scenario.scan
        followed = {self._drive.follows} if self._drive else set()
        self.names = sorted({r.condition.name for r in scenario.reactions} | followed)
        self.settings: list[Setting] = []
        begin = scenario.master.at(0.0)
        self.master = Script(begin.position, begin.velocity, 0.0, ()) if self._drive else scenario.master
        self._reactions = scenario.reactions
        self._stop_time = scenario.stop_time
        self._samples = _sample_times(scenario) if scenario.reacts else iter(())
        self._next_sample = next(self._samples, None)
        self._was_true = [True] * len(self._reactions)
        self._counts = [0] * len(self._reactions)
        declared = scenario.recipe.variables
        added = {name for r in self._reactions for name in r.add}
        self._current_values = {name: scenario.start.get(name, declared[name].start) for name in added}
        self._scheduled = sorted(scenario.settings, key=attrgetter("at"))
        self._scheduled_index = 0
        self._sequence = count()
        self._pending: list[tuple[float, int, Reaction]] = []  # time, position in the sequence

    @property
    def next_sample_time(self) -> float:
        """The time of the next sample of the outputs, in s; infinite: there is none."""
        return self._next_sample[0] if self._next_sample else math.inf

    @property
    def next_setting_time(self) -> float:
        """The time of the next setting that is scheduled or pending, in s; infinite: there is none."""
        return min(self._next_scheduled_time, self._next_reaction_time)

    @property
    def _next_scheduled_time(self) -> float:
        return self._scheduled[self._scheduled_index].at if self._scheduled_index < len(self._scheduled) else math.inf

    @property
    def _next_reaction_time(self) -> float:
        return self._pending[0][0] if self._pending else math.inf

    @property
    def unmet(self) -> list[UnmetReaction]:
        """The reactions that happened less often than they could have."""
        return [UnmetReaction(r, n) for r, n in zip(self._reactions, self._counts, strict=True) if n < r.least]

    def sample_start(self, outputs: Mapping[str, Any]) -> None:
        """Sample the outputs at time 0: a condition that is true there has not become true."""
        self._was_true = [_is_true(r.condition, outputs) for r in self._reactions]

    def sample(self, outputs: Mapping[str, Any]) -> None:
        """Sample the outputs at `next_sample_time`: react to each condition that has become true, from the scan on, and
        move a master that follows."""
        assert self._next_sample
        (_, scan), self._next_sample = self._next_sample, next(self._samples, None)
        if self._drive:
            velocity, requested = self.master.until(scan).velocity, float(outputs[self._drive.follows])
            self.master.accelerate_from(scan, self._drive.acceleration(velocity, requested, self._scan))
        for i, r in enumerate(self._reactions):
            was_true, self._was_true[i] = self._was_true[i], _is_true(r.condition, outputs)
            at = round(scan + r.after, DECIMALS)
            if self._was_true[i] and not was_true and self._counts[i] != r.times and at < self._stop_time:
                self._counts[i] += 1
                heappush(self._pending, (at, next(self._sequence), r))

    def take_settings(self, until: float) -> dict[str, Any]:
        """Make the settings up to a time, in s; returns their values."""
        values: dict[str, Any] = {}
        while self.next_setting_time <= until:
            is_scheduled = self._next_scheduled_time <= self._next_reaction_time
            setting = self._pop_scheduled() if is_scheduled else self._pop_reaction()
            changed = self._current_values.keys() & setting.values.keys()
            self._current_values |= {name: setting.values[name] for name in changed}
            self.settings.append(setting)
            values |= setting.values
        return values

    def _pop_scheduled(self) -> Setting:
        """The next setting of the scenario."""
        self._scheduled_index += 1
        return self._scheduled[self._scheduled_index - 1]

    def _pop_reaction(self) -> Setting:
        """The next setting of a reaction."""
        at, _, due = heappop(self._pending)
        return Setting(at, {**due.set, **{name: self._current_values[name] + added for name, added in due.add.items()}})


@lru_cache(maxsize=8)
def scan_times(scan: float, stop_time: float) -> Reals:
    """The times of the scans, in s: one scan, two, ... before the end of the run. The array cannot be changed.

    It is cached, since many runs have the same scans."""
    times = round_times(np.arange(1.0, stop_time / scan + 2.0) * scan)
    before_end = times[times < stop_time]
    before_end.setflags(write=False)
    return before_end


def round_times(times: Reals) -> Reals:
    """Each time, in s, at least 0, as `round` gives it with DECIMALS decimals, a hundred times as quickly.

    The time in units of the last decimal is the sum of two numbers: the product as it is rounded, and the product's
    error, which Dekker's algorithm finds exactly. Together they determine the nearest whole number of units, of two
    the even one. Its quotient is the nearest number to that decimal fraction."""
    short = np.minimum(times, LONG)
    units, error = _exact_product(short, UNIT)
    nearest = np.rint(units)
    above, odd = units - nearest, nearest % 2.0 == 1.0
    up = (error > 0.5 - above) | ((error == 0.5 - above) & odd)
    down = (error < -0.5 - above) | ((error == -0.5 - above) & odd)
    return np.where(times < LONG, (nearest + up - down) / UNIT, times)


def _exact_product(x: Reals, y: float) -> tuple[Reals, Reals]:
    """The product as it is rounded, and what is missing to the exact one (T. J. Dekker 1971, Mul12)."""
    product = x * y
    (x_high, x_low), (y_high, y_low) = _split_bits(x), _split_bits(np.array(y))
    return product, x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)


def _split_bits(x: Reals) -> tuple[Reals, Reals]:
    """Two numbers of half as many bits, whose sum is x (T. J. Dekker 1971)."""
    most = 134217729.0 * x  # 2^27 + 1
    high = most - (most - x)
    return high, x - high


def _sample_times(scenario: Scenario) -> Iterator[tuple[float, float]]:
    """The time of the sample for each scan, and that of the scan, both in s."""
    return (
        (scan - SAMPLE_LEAD * scenario.scan, scan) for scan in scan_times(scenario.scan, scenario.stop_time).tolist()
    )


def _is_true(condition: OutputCondition, outputs: Mapping[str, Any]) -> bool:
    difference = float(outputs[condition.name]) - condition.value
    margin = COMPARISON_MARGIN * max(1.0, abs(condition.value))
    match condition.comparison:
        case "<":
            return difference < -margin
        case ">":
            return difference > margin
        case _:
            return abs(difference) <= margin
