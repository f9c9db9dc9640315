"""When the reactions of a scenario happen, and how its master follows, found from an oracle's own trajectory.

A controller looks at the outputs 1/128 of a scan before each scan, and sets something from the scan on, or `after`
seconds later. The scans are the multiples of the scenario's `step_size`, before its `stop_time`; a condition that holds
at 0 has not become true. A master that follows a velocity u takes it at each scan, as it is at the look: from there to
the next scan, T later, its acceleration is (u - v)(1 - exp(-T/time_constant))/T, at most max_acceleration.

Between two firings, or two changes of u, nothing is unknown: the oracle is asked for a stretch of looks, the first
firings in it become sets, u becomes what it is there, and the oracle is asked again from there on.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

Rows = Callable[[Mapping[str, Any], Sequence[float]], Sequence[Mapping[str, float]]]
"""An oracle's `reference`: the outputs for a script at some times."""

STRETCH = 128
"""Looks that the oracle is asked for at once; twice as many each time that nothing happens in them."""


@dataclass(slots=True)
class _Reaction:
    """One table [[on]], with the values of enumerations as numbers."""

    table: Mapping[str, Any]
    held: bool = True
    fired: int = 0

    def is_true(self, row: Mapping[str, float]) -> bool:
        """A number is beyond another by more than 1e-9 of it, at least of 1; or it is equal to it."""
        name, comparison, value = self.table["when"].split()
        beyond, margin = row[name] - float(value), 1e-9 * max(1.0, abs(float(value)))
        return {"==": abs(beyond) <= margin, "<": beyond < -margin, ">": beyond > margin}[comparison]

    def rises(self, row: Mapping[str, float]) -> bool:
        before, self.held = self.held, self.is_true(row)
        return self.held and not before


@dataclass(slots=True)
class _Line:
    """A master that follows a velocity: the table [master], and what was asked for at each of the first scans."""

    table: Mapping[str, Any]
    scan: float
    requested: list[float] = field(default_factory=list)

    def takes(self, row: Mapping[str, float]) -> bool:
        """Whether the velocity at the next look differs from that of the look before, by more than 1e-9 of it."""
        value, before = row[self.table["follows"]], self.requested[-1] if self.requested else math.nan
        changed = not abs(value - before) <= 1e-9 * max(1.0, abs(before))
        self.requested.append(value if changed else before)
        return changed

    def master(self, scans: int) -> dict[str, Any]:
        """The script up to the first scan and from each of so many scans on, if what is asked for stays as it is."""
        velocity, scan = mp.mpf(self.table.get("velocity", 0)), mp.mpf(self.scan)
        rate = (1 - mp.exp(-scan / mp.mpf(self.table["time_constant"]))) / scan
        limit = mp.mpf(self.table.get("max_acceleration", mp.inf))
        segments: list[dict[str, Number]] = [{"duration": scan}]
        for i in range(scans if self.requested else 0):
            needed = (self.requested[min(i, len(self.requested) - 1)] - velocity) * rate
            segments.append({"duration": scan, "acceleration": min(max(needed, -limit), limit)})
            velocity += segments[-1]["acceleration"] * scan
        return {**{k: self.table[k] for k in ("position", "velocity") if k in self.table}, "segments": segments}


@dataclass(slots=True)
class _RecordedSets:
    """What is set: (time, values, additions), in the order in which it was ordered."""

    sets: list[tuple[float, Mapping[str, Any], Mapping[str, Any]]] = field(default_factory=list)

    def tables(self, start: Mapping[str, Any]) -> list[dict[str, Any]]:
        """The tables [[set]]; an addition counts from the value of that time."""
        present, tables = dict(start), []
        for at, values, additions in sorted(self.sets, key=lambda entry: entry[0]):
            given = dict(values) | {name: present.get(name, 0) + more for name, more in additions.items()}
            present |= given
            tables.append({"at": at, **given})
        return tables


def settled(script: Mapping[str, Any], rows: Rows) -> dict[str, Any]:
    """The script without [[on]]: all that its reactions set is in [[set]], and a master that follows has segments, one
    a scan. Steps end at the looks, too.

    `script`: a condition is written as NAME COMPARISON NUMBER; a variable that is added to has a start value.

    Raises:
        ArithmeticError: a condition changes exactly at a look, so that rounding decides what happens.
    """
    scan, stop = float(script["step_size"]), float(script["stop_time"])
    scans: list[float] = []
    while (time := round((len(scans) + 1) * scan, 12)) < stop:
        scans.append(time)
    sample_times = [time - scan / 128 for time in scans]
    reactions = [_Reaction(table) for table in script["on"]]
    line = _Line(script["master"], scan) if "follows" in script["master"] else None
    result = _RecordedSets([(t["at"], {k: v for k, v in t.items() if k != "at"}, {}) for t in script.get("set", ())])
    ends = [*script.get("expect", ()), *({"at": sample_time} for sample_time in sample_times)]
    base = {k: v for k, v in script.items() if k != "on"} | {"expect": ends}

    def now(until: int) -> dict[str, Any]:
        """The script, with the master's motion up to this scan."""
        master = {"master": line.master(until)} if line else {}
        return base | {"set": result.tables(script["start"])} | master

    (first,) = rows(now(0) | {"stop_time": scan}, [0.0])
    for reaction in reactions:
        reaction.held = reaction.is_true(first)
    i, length = 0, STRETCH
    while i < len(sample_times):
        stretch, length = sample_times[i : i + length], 2 * length
        until = i + len(stretch)
        stretch_rows = rows(now(until) | {"stop_time": scans[until - 1]}, stretch)
        if len(stretch_rows) != len(stretch):
            raise ArithmeticError(f"something happens exactly at a look between {stretch[0]} and {stretch[-1]}")
        for row in stretch_rows:
            fired = [r for r in reactions if r.rises(row) and r.fired != r.table.get("times")]
            fired = [r for r in fired if round(scans[i] + r.table.get("after", 0.0), 12) < stop]
            for r in fired:
                r.fired += 1
                at = round(scans[i] + r.table.get("after", 0.0), 12)
                result.sets.append((at, r.table.get("set", {}), r.table.get("add", {})))
            i += 1
            if (line is not None and line.takes(row)) or fired:
                length = STRETCH
                break
    return now(len(scans))
