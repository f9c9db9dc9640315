"""The reactions of a scenario in one run, and the drive of its master: the program of a controller with a task cycle.

The cycle is the *scan*, the step size in the scenario's file, whatever the step size of the run is. At each of its
multiples the program knows the outputs of a little earlier, LOOK of a scan before. So it sees what happens exactly at a
scan at the next one, and rounding has no say in it. What it sets acts from the scan on, or `after` seconds later. A
master that follows a velocity takes it at each scan.
"""

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from heapq import heappop, heappush
from itertools import count
from operator import attrgetter
from typing import Any

import numpy as np

from .recording import Reals
from .scenario import Scenario
from .script import Script
from .settings import Condition, Reaction, Setting, Unmet

LOOK = 1.0 / 128.0  # of a scan: how long before it the outputs are looked at
MARGIN = 1e-9  # of a value, at least of 1: by so much it is beyond another, or else it is equal
DECIMALS = 12  # of a scan's time in s: then a time that is typed is the same number
UNIT = 1e12  # so many of the last decimal are 1
LONG = 8192.0  # s; from here on, neighbouring numbers are more than a unit of the last decimal apart


class Program:
    """Everything that a scenario gives the block in one run: its settings, what its reactions make of the outputs, and
    the motion of the master.

    Attributes:
        names: the outputs that the conditions compare and that the master follows.
        settings: what has been set so far.
        master: the scripted axis; one with a drive is known up to the scan after the next look.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._drive, self._scan = scenario.drive, scenario.scan
        followed = {self._drive.follows} if self._drive else set()
        self.names = sorted({r.condition.name for r in scenario.reactions} | followed)
        self.settings: list[Setting] = []
        self.master = _beginning(scenario.master) if self._drive else scenario.master
        self._reactions = scenario.reactions
        self._stop_time = scenario.stop_time
        self._looks = _looks(scenario) if scenario.reacts else iter(())
        self._next = next(self._looks, None)
        self._held = [True] * len(self._reactions)
        self._happened = [0] * len(self._reactions)
        declared = scenario.recipe.variables
        added = {name for r in self._reactions for name in r.add}
        self._present = {name: scenario.start.get(name, declared[name].start) for name in added}
        self._known = sorted(scenario.settings, key=attrgetter("at"))
        self._taken = 0  # of these
        self._order = count()
        self._waiting: list[tuple[float, int, Reaction]] = []  # what sets when; of the same time, in this order

    @property
    def next_look(self) -> float:
        """When the outputs are looked at next, in s; infinite: never again."""
        return self._next[0] if self._next else math.inf

    @property
    def next_setting(self) -> float:
        """The earliest time, in s, at which something is set, as far as it is known; infinite: there is nothing."""
        return min(self._next_known, self._next_reaction)

    @property
    def _next_known(self) -> float:
        return self._known[self._taken].at if self._taken < len(self._known) else math.inf

    @property
    def _next_reaction(self) -> float:
        return self._waiting[0][0] if self._waiting else math.inf

    @property
    def unmet(self) -> list[Unmet]:
        """The reactions that happened less often than they could have."""
        return [Unmet(r, n) for r, n in zip(self._reactions, self._happened, strict=True) if n < r.least]

    def begin(self, outputs: Mapping[str, Any]) -> None:
        """The outputs at time 0: a condition that holds has not become true."""
        self._held = [_holds(r.condition, outputs) for r in self._reactions]

    def look(self, outputs: Mapping[str, Any]) -> None:
        """The outputs at `next_look`: each condition that has become true is reacted to, from the scan on, and the
        master follows."""
        assert self._next
        (_, scan), self._next = self._next, next(self._looks, None)
        if self._drive:
            velocity, asked = self.master.until(scan).velocity, float(outputs[self._drive.follows])
            self.master.go_on(scan, self._drive.acceleration(velocity, asked, self._scan))
        for i, r in enumerate(self._reactions):
            held, self._held[i] = self._held[i], _holds(r.condition, outputs)
            at = round(scan + r.after, DECIMALS)
            if self._held[i] and not held and self._happened[i] != r.times and at < self._stop_time:
                self._happened[i] += 1
                heappush(self._waiting, (at, next(self._order), r))

    def take(self, until: float) -> dict[str, Any]:
        """The values that are set up to a time, in s; they count as set from now on."""
        values: dict[str, Any] = {}
        while self.next_setting <= until:
            setting = self._take_known() if self._next_known <= self._next_reaction else self._take_reaction()
            self._present |= {name: value for name, value in setting.values.items() if name in self._present}
            self.settings.append(setting)
            values |= setting.values
        return values

    def _take_known(self) -> Setting:
        """What the scenario sets next."""
        self._taken += 1
        return self._known[self._taken - 1]

    def _take_reaction(self) -> Setting:
        """What a reaction sets next."""
        at, _, due = heappop(self._waiting)
        return Setting(at, {**due.set, **{name: self._present[name] + more for name, more in due.add.items()}})


@lru_cache(maxsize=8)
def scans(scan: float, stop_time: float) -> Reals:
    """The times of the scans, in s: one scan, two, ... before the end of the run. The array cannot be changed.

    It is kept for the next one who asks, since many runs have the same scans."""
    times = rounded(np.arange(1.0, stop_time / scan + 2.0) * scan)
    before_end = times[times < stop_time]
    before_end.setflags(write=False)
    return before_end


def rounded(times: Reals) -> Reals:
    """Each time, in s, at least 0, as `round` gives it with DECIMALS decimals, a hundred times as quickly.

    The time in units of the last decimal is the sum of two numbers: the product as it is rounded, and the product's
    error, which Dekker's algorithm finds exactly. Together they tell the nearest whole number of units, of two the even
    one. Its quotient is the nearest number to that decimal fraction."""
    short = np.minimum(times, LONG)
    units, error = _product(short, UNIT)
    nearest = np.rint(units)
    above, odd = units - nearest, nearest % 2.0 == 1.0
    up = (error > 0.5 - above) | ((error == 0.5 - above) & odd)
    down = (error < -0.5 - above) | ((error == -0.5 - above) & odd)
    return np.where(times < LONG, (nearest + up - down) / UNIT, times)


def _product(x: Reals, y: float) -> tuple[Reals, Reals]:
    """The product as it is rounded, and what is missing to the exact one (T. J. Dekker 1971, Mul12)."""
    product = x * y
    (x_high, x_low), (y_high, y_low) = _halves(x), _halves(np.array(y))
    return product, x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)


def _halves(x: Reals) -> tuple[Reals, Reals]:
    """Two numbers of half as many bits, whose sum is x (T. J. Dekker 1971)."""
    most = 134217729.0 * x  # 2^27 + 1
    high = most - (most - x)
    return high, x - high


def _beginning(master: Script) -> Script:
    """A script of its own that begins like this one."""
    begin = master.at(0.0)
    return Script(begin.position, begin.velocity, 0.0, ())


def _looks(scenario: Scenario) -> Iterator[tuple[float, float]]:
    """When the outputs are looked at for each scan, and the scan; both in s."""
    return ((scan - LOOK * scenario.scan, scan) for scan in scans(scenario.scan, scenario.stop_time).tolist())


def _holds(condition: Condition, outputs: Mapping[str, Any]) -> bool:
    beyond = float(outputs[condition.name]) - condition.value
    margin = MARGIN * max(1.0, abs(condition.value))
    match condition.comparison:
        case "<":
            return beyond < -margin
        case ">":
            return beyond > margin
        case _:
            return abs(beyond) <= margin
