"""What a line is worth: the follower's errors with RemoteSync, without it, and with other estimators.

The follower is the same each time, with the same commands; what differs is how it gets to know the axis. Against it
stands the follower that sees the true axis.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motionsync.remote_sync.interface import Estimator

from ..interface.roles import MOTION
from ..scenario.cuts import Cut, find_cuts
from ..scenario.judge import Check, check
from ..scenario.recording import Reals, Recording
from ..scenario.telegrams import errors
from .line import RAMP, REMOTE, Line
from .package import Package
from .runs import Inputs, MissingLibraryError, Values, run_alone, run_cosim, run_ssp

AGREEMENT = 1e-9  # of FMPy and libcosim, relative to each output's greatest magnitude, at least 1
FIRST = 2  # steps in which they may differ: in the first one FMPy's inputs are zero
RAW = "raw telegrams"
ESTIMATORS: Mapping[str, Mapping[str, Any]] = {
    "BEAT": {"estimator": Estimator.BEAT},
    "BEAT, uniform": {"estimator": Estimator.BEAT, "slope1_numerator": 0.5, "slope1_denominator": 0.5},
    "PHASE": {"estimator": Estimator.PHASE},
}


@dataclass(frozen=True)
class Switch:
    """A transition of a follower that is switched on and off.

    Attributes:
        time: when it was first seen, in s.
        place: where it is to begin, in u.
        error: how far beyond that on the true axis it began, in u.
    """

    time: float
    place: float
    error: float


@dataclass(frozen=True)
class Way:
    """One way for the follower to see the axis, and what came of it.

    Attributes:
        name: of the way.
        recording: the follower's outputs.
        away: slave.position less where it is if the follower sees the true axis, in u; shape (steps,).
        index: how far the cycle index is ahead of the sender's, in cycles; shape (steps,).
        cuts, switches: those of the follower; the errors are those on the true axis.
    """

    name: str
    recording: Recording
    away: Reals
    index: Reals
    cuts: list[Cut]
    switches: list[Switch]


@dataclass(frozen=True)
class Figures:
    """A way's errors in a part of the run, in u; None where there was nothing to tell of.

    Attributes:
        name: of the way.
        cuts: how many there were.
        worst, mean, spread: of the cuts' errors: the greatest magnitude, the mean, from the least to the greatest.
        switches: the greatest magnitude of the errors of the places where transitions began.
        away: the greatest magnitude of `Way.away`.
        jump: its greatest change in a step: by so much the setpoint jumps for no reason of the axis.
        index: of the index error, from the least to the greatest, in cycles.
    """

    name: str
    cuts: int
    worst: float | None
    mean: float | None
    spread: float | None
    switches: float | None
    away: float | None
    jump: float | None
    index: float | None


@dataclass(frozen=True)
class Agreement:
    """How far FMPy and libcosim are apart in an output: in the first steps, and after them."""

    name: str
    first: float
    later: float
    allowed: float


@dataclass(frozen=True)
class Result:
    """All that was found out about a line.

    Attributes:
        synced: when RemoteSync first was, in s; infinite: never.
        settled: from when on its drift is used in full: from here on the errors are judged.
        wired: the way through the SSP package.
        ways: all of them: the wired one first, then the raw telegrams, then other estimators.
        before, after: their figures, up to `settled` and from there on.
        agreements: of FMPy and libcosim; empty if libcosim is missing.
        missing: why there is no run of libcosim; empty if there is one.
        checks: what was expected.
    """

    synced: float
    settled: float
    remote: Values
    ways: list[Way]
    before: list[Figures]
    after: list[Figures]
    agreements: list[Agreement]
    missing: str
    checks: list[Check]

    @property
    def wired(self) -> Way:
        return self.ways[0]

    @property
    def passed(self) -> bool:
        return all(c.passed for c in self.checks)


def examine(line: Line, package: Package, told: Callable[[str], None] = lambda text: None) -> Result:
    """Run the line in FMPy and in libcosim, and the follower alone on the other ways; `told` is told what runs.

    Raises:
        UserError: an FMU refused a value or a step.
    """
    told("the follower on the true axis and on the raw telegrams")
    truth = _follower(line, package, _true_axis(line))
    raw = _follower(line, package, {f"master.{n}": line.telegrams[f"remote.{n}"] for n in MOTION})
    told("FMPy's SSP simulation")
    found = run_ssp(line, package)
    told("libcosim")
    try:
        agreements, missing = list(_agreements(found, run_cosim(line, package))), ""
    except MissingLibraryError as e:
        agreements, missing = [], str(e)
    remote, follower = found[REMOTE], line.follower.recipe.name
    ways = [_way(line, _wired_name(line), found[follower], truth, remote), _way(line, RAW, raw, truth, None)]
    for name, start in _others(line).items():
        told(f"estimator {name}")
        other, values = through(line, package, start)
        ways.append(_way(line, f"RemoteSync, {name}", values, truth, other))
    synced, settled = _settled(line, remote)
    return Result(
        synced,
        settled,
        remote,
        ways,
        [_figures(way, line.times < settled) for way in ways],
        [_figures(way, line.times >= settled) for way in ways],
        agreements,
        missing,
        list(_checks(line, ways[0], synced, settled, agreements)),
    )


# --- ways ---


def through(line: Line, package: Package, start: Mapping[str, Any] | None = None) -> tuple[Values, Values]:
    """RemoteSync alone, with other start values if given, and the follower alone behind it: the outputs of both, and
    the same as those of the wired line."""
    remote = run_alone(line, package, REMOTE, line.telegrams, start)
    return remote, _follower(line, package, {f"master.{n}": _handed_over(remote[f"slave.{n}"]) for n in MOTION})


def _follower(line: Line, package: Package, axis: Inputs) -> Values:
    return run_alone(line, package, line.follower.recipe.name, {**axis, **line.commands})


def _true_axis(line: Line) -> Inputs:
    motions = [line.follower.master.at(i * line.step_size) for i in range(line.steps)]
    return {f"master.{n}": np.array([getattr(m, n) for m in motions]) for n in MOTION}


def _handed_over(values: Reals) -> Reals:
    """What a parallel co-simulation shows of an output: in each step what it was at the end of the step before."""
    return np.concatenate([[0.0], values[:-1]])


def _wired_name(line: Line) -> str:
    given = {name: line.start.get(name) for name in ESTIMATORS["BEAT, uniform"]}
    uniform = given["slope1_numerator"] == given["slope1_denominator"] == 0.5
    estimator = "PHASE" if given["estimator"] == Estimator.PHASE else "BEAT, uniform" if uniform else "BEAT"
    return f"RemoteSync, {estimator}"


def _others(line: Line) -> dict[str, Mapping[str, Any]]:
    """The estimators that are not wired; PHASE is for equal cycles only."""
    equal = line.remote.data_cycle == line.step_size
    return {
        name: start
        for name, start in ESTIMATORS.items()
        if f"RemoteSync, {name}" != _wired_name(line) and (equal or name != "PHASE")
    }


def _way(line: Line, name: str, values: Values, truth: Values, remote: Values | None) -> Way:
    s = line.follower
    motions = [s.master.until(t) for t in line.times.tolist()]
    master = np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in motions])
    recording = Recording(line.times, _shown(values), master, [])
    away = _nearest(values["slave.position"] - truth["slave.position"], s.period)
    return Way(
        name,
        recording,
        away,
        _index(line, remote, master),
        find_cuts(s.cuts, recording) if s.cuts else [],
        list(_switches(line, recording)) if line.places is not None else [],
    )


def _shown(values: Values) -> Values:
    """With `state`, which is `state_code`."""
    return values | ({"state": values["state_code"]} if "state_code" in values else {})


def _nearest(difference: Any, period: float) -> Any:
    return difference - period * np.round(difference / period) if period else difference


def _index(line: Line, remote: Values | None, master: Reals) -> Reals:
    """Of the telegrams, or of RemoteSync's corrected index: how far ahead of the sender's; the first step is left out
    of it, and has the error of the second."""
    corrected = np.zeros(line.steps) if remote is None else remote["corrected_cycle_index"]
    values = {"corrected_cycle_index": corrected, "slave.position": np.zeros(line.steps)}
    found = errors(line.remote, Recording(line.times, values, master, []))
    index = found.index if remote is None else found.corrected_index
    return np.concatenate([index[:1], index])


def _switches(line: Line, recording: Recording) -> Iterator[Switch]:
    """Where transitions began on the true axis: in the first step that shows one, its progress tells how long ago."""
    ramp, begin, progress, distance = (recording.values[name] for name in RAMP)
    for i in np.flatnonzero(np.diff(ramp, prepend=0.0) > 0.0).tolist():
        travel = math.copysign(distance[i] * progress[i], recording.master[i, 1])
        beyond = _nearest(recording.master[i, 0] - travel - begin[i], line.follower.period)
        yield Switch(float(recording.time[i]), float(begin[i]), float(beyond))


# --- figures ---


def _settled(line: Line, remote: Values) -> tuple[float, float]:
    """When RemoteSync is synced, and when it has blended over to that."""
    on = remote["synced"] > 0.0
    if not on.any():
        return math.inf, math.inf
    synced = float(line.times[int(np.argmax(on))])
    block = line.recipes[REMOTE].block()
    cycles = line.start.get("new_drift_blending_cycles", block.new_drift_blending_cycles)
    return synced, synced + max(cycles * line.step_size, line.start.get("blending_time", block.blending_time))


def _figures(way: Way, chosen: Any) -> Figures:
    times = way.recording.time[chosen]
    begin, end = (times[0], times[-1]) if len(times) else (math.inf, math.inf)
    cuts = np.array([c.error for c in way.cuts if begin <= c.begin <= end])
    switches = np.array([s.error for s in way.switches if begin <= s.time <= end])
    away = way.away[chosen]
    return Figures(
        way.name,
        len(cuts),
        _greatest(cuts),
        float(cuts.mean()) if len(cuts) else None,
        _spread(cuts),
        _greatest(switches),
        _greatest(away),
        _greatest(np.diff(away)),
        _spread(way.index[chosen]),
    )


def _greatest(values: Reals) -> float | None:
    return float(np.abs(values).max()) if len(values) else None


def _spread(values: Reals) -> float | None:
    return float(np.ptp(values)) if len(values) else None


def _agreements(ssp: Mapping[str, Values], cosim: Mapping[str, Values]) -> Iterator[Agreement]:
    for component, values in ssp.items():
        for name, column in values.items():
            apart = np.abs(column - cosim[component][name])
            allowed = AGREEMENT * max(1.0, float(np.abs(column).max()))
            first, later = (float(part.max(initial=0.0)) for part in (apart[:FIRST], apart[FIRST:]))
            yield Agreement(f"{component}.{name}", first, later, allowed)


# --- judgement ---


def _checks(line: Line, wired: Way, synced: float, settled: float, agreements: list[Agreement]) -> Iterator[Check]:
    s = line.follower
    yield Check("RemoteSync in sync", f"from {synced:.10g} s on" if synced < math.inf else "never", synced < math.inf)
    if agreements:
        worst = max(agreements, key=lambda a: a.later / a.allowed)
        expected = f"FMPy and libcosim agree from step {FIRST + 1} on, to {AGREEMENT:g} of each output's magnitude"
        yield Check(expected, f"{worst.later:.2g} apart in {worst.name}", worst.later <= worst.allowed)
    yield from check(replace(s, cuts=None), wired.recording)
    if s.cuts and s.cuts.count is not None:
        yield Check(f"number of cuts = {s.cuts.count}", f"{len(wired.cuts)}", len(wired.cuts) == s.cuts.count)
    if s.cuts and s.cuts.tolerance is not None:
        judged = [abs(c.error) for c in wired.cuts if c.begin >= settled]
        expected = f"cuts within {s.cuts.tolerance:g} of a mark on the true axis, once in sync"
        yield _judged(expected, judged, s.cuts.tolerance, "cut")
    if line.places is not None:
        judged = [abs(x.error) for x in wired.switches if x.time >= settled]
        expected = f"transitions within {line.places:g} of their place on the true axis, once in sync"
        yield _judged(expected, judged, line.places, "transition")


def _judged(expected: str, errors: list[float], tolerance: float, what: str) -> Check:
    if not errors:
        return Check(expected, f"no {what}", False)
    worst = max(errors)
    return Check(expected, f"at most {worst:.3g} away in {len(errors)} {what}s", worst <= tolerance)
