"""The run of a block along a script as its oracle takes it, and the comparison of both."""

import math
from bisect import bisect_right
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import accumulate, pairwise
from typing import Any

from motionsync.master import MasterInput
from motionsync.var import Block
from motionsync_fmu.interface.stepper import Stepper
from tests.oracle.master import Stretch, stretches
from tests.oracle.numerics import mp
from tests.support.blocks.harness import Row

CLOSE = 1e-10
"""Time (s) by which the end of a segment may be rounded."""
ROUNDING = 1e-15
"""Of a value that has a tolerance, relative to it."""
Script = dict[str, Any]
Reference = Callable[[Mapping[str, Any], Sequence[float]], list[Row]]
"""What an oracle answers: its rows at some times; two of one time where something jumps."""


class Feed:
    """What a simulator would set at the master's inputs: exact values of the script, rounded once."""

    def __init__(self, script: Script, mode: MasterInput) -> None:
        self.stretches = stretches(script["master"], mp.mpf(script["stop_time"]) + 1)
        self.begin_times = [stretch.begin for stretch in self.stretches]
        self.period = mp.mpf(script["start"].get("master.period", 0))
        self.mode = mode

    def stretch(self, time: float, *, after: bool) -> Stretch:
        """The stretch at `time`; where two meet the one after or before."""
        return self.stretches[bisect_right(self.begin_times, time + (CLOSE if after else -CLOSE)) - 1]

    def inputs(self, time: float, *, after: bool) -> Row:
        """The master's inputs for that time."""
        motion = self.stretch(time, after=after).at(mp.mpf(time))
        position = motion.position
        if self.period:
            position -= mp.floor(position / self.period) * self.period
        values = {"master.position": float(position)}
        if self.mode != MasterInput.POSITION_ONLY:
            values |= {"master.velocity": float(motion.velocity), "master.acceleration": float(motion.acceleration)}
        return values


def corners(script: Script) -> set[float]:
    """The times at which a step has to end: where something is set, and the ends of the master's segments."""
    ends = accumulate((segment["duration"] for segment in script["master"]["segments"]), initial=0.0)
    stop: float = script["stop_time"]
    return {stop, *(end for end in ends if end <= stop), *(table["at"] for table in script["set"])}


def grid(script: Script, h: float) -> set[float]:
    """The multiples of h in a script's run."""
    return {k * h for k in range(math.ceil(script["stop_time"] / h))}


def simulate(
    block: Block,
    script: Script,
    ends: Iterable[float],
    names: Collection[str],
    *,
    mode: MasterInput = MasterInput.START_OF_STEP,
    recorded: Collection[float] | None = None,
    stride: int = 1,
) -> list[Row]:
    """The outputs of a new block after its initialization and at the ends of its steps, `ends` and the corners: of each
    `stride`-th step, or at the times in `recorded`.

    An end closer than 1e-9 s to a corner is left out."""
    stepper, feed, fixed = Stepper(block), Feed(script, mode), sorted(corners(script))
    sets: dict[float, dict[str, Any]] = {}
    for table in script["set"]:
        sets.setdefault(table["at"], {}).update({name: value for name, value in table.items() if name != "at"})
    others = {end for end in ends if 0.0 < end < fixed[-1] and _distance(fixed, end) > 1e-9}
    stepper.initialize({**script["start"], "master.input_mode": mode, **feed.inputs(0.0, after=True)})
    rows = []

    def record(number: int, time: float) -> None:
        if number % stride == 0 if recorded is None else time in recorded:
            rows.append({"time": time, **{name: float(value) for name, value in stepper.get(names).items()}})

    record(0, 0.0)
    for number, (begin, end) in enumerate(pairwise(sorted({*fixed, *others})), start=1):
        is_end = mode == MasterInput.END_OF_STEP
        master = feed.inputs(end, after=False) if is_end else feed.inputs(begin, after=True)
        stepper.step(end - begin, {**sets.get(begin, {}), **master})
        record(number, end)
    return rows


def _distance(sorted_times: Sequence[float], time: float) -> float:
    """To the nearest of some times, the first of which is before this one and the last after it."""
    index = bisect_right(sorted_times, time)
    return min(time - sorted_times[index - 1], sorted_times[index] - time)


def find_differences(
    reference: Reference,
    script: Script,
    rows: Sequence[Row],
    tolerances: Mapping[str, float],
    periods: Mapping[str, float] = {},
) -> list[str]:
    """Where the block's rows are neither at nor between the oracle's for that time: the variables with a tolerance.

    `periods`: of variables that may differ by whole turns and stay within one; 0: none."""
    expected: dict[float, list[Row]] = {}
    for row in reference(script, [row["time"] for row in rows]):
        expected.setdefault(row["time"], []).append(row)
    differences = []
    for row in rows:
        for name in row.keys() & tolerances.keys():
            value, allowed, period = row[name], [other[name] for other in expected[row["time"]]], periods.get(name, 0.0)
            if not is_among(value, allowed, tolerances[name], period):
                differences.append(f"{name} is {value!r} at {row['time']!r}, not {allowed}")
    return differences


def is_among(value: float, allowed: Sequence[float], tolerance: float, period: float) -> bool:
    """Whether a value is at or between the allowed ones; with a period at one of them, or whole turns away."""
    if period > 0.0:
        return 0.0 <= value < period and any(abs(math.remainder(value - x, period)) <= tolerance for x in allowed)
    margin = max(tolerance, ROUNDING * abs(value)) if tolerance else 0.0
    return min(allowed) - margin <= value <= max(allowed) + margin
