"""Variants of a line: how the follower gets to know the axis, and its outputs then.

The follower is the same each time, with the same commands. All variants are judged against the follower that sees the
true axis.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..interface.roles import MOTION
from ..scenario.cuts import Cut, find_cuts
from ..scenario.recording import Reals, Recording
from ..scenario.telegrams import errors
from .line import RAMP, REMOTE, Line
from .package import Package
from .runs import Inputs, Values, run_alone

RAW = "raw telegrams"
ESTIMATOR = "estimator"
SLOPE = ("slope1_numerator", "slope1_denominator")
UNIFORM = 0.5  # for both: the estimator BEAT then corrects uniformly from beat to beat


@dataclass(frozen=True)
class Switch:
    """A transition of a follower that is switched on and off.

    Attributes:
        time: the end of the first step that shows it, in s.
        place: where on the master it is to begin, in u.
        error: how far beyond that place, on the true axis, it began, in u.
    """

    time: float
    place: float
    error: float


@dataclass(frozen=True)
class Variant:
    """One way for the follower to get to know the axis, and its outputs then.

    Attributes:
        recording: the follower's outputs.
        away: slave.position less what it is where the follower sees the true axis, in u; shape (steps,).
        index: how far the cycle index is ahead of the sender's, in cycles; shape (steps,).
        cuts, switches: those of the follower; the errors are those on the true axis.
    """

    name: str
    recording: Recording
    away: Reals
    index: Reals
    cuts: list[Cut]
    switches: list[Switch]


def through(line: Line, package: Package, start: Mapping[str, Any] | None = None) -> tuple[Values, Values]:
    """RemoteSync alone, then the follower alone with RemoteSync's outputs: the outputs of both.

    Without other start values they are those of the wired line."""
    remote = run_alone(line, package, REMOTE, line.telegrams, start)
    return remote, run_follower(line, package, {f"master.{n}": _handed_over(remote[f"slave.{n}"]) for n in MOTION})


def run_follower(line: Line, package: Package, axis: Inputs) -> Values:
    """The outputs of the follower alone that sees this axis."""
    return run_alone(line, package, line.follower.recipe.name, {**axis, **line.commands})


def true_axis(line: Line) -> Inputs:
    """The axis itself as the follower's master."""
    motions = [line.follower.master.at(i * line.step_size) for i in range(line.steps)]
    return {f"master.{n}": np.array([getattr(m, n) for m in motions]) for n in MOTION}


def raw_axis(line: Line) -> Inputs:
    """The telegrams as the follower's master, as they are."""
    return {f"master.{n}": line.telegrams[f"{line.remote.names.part}.{n}"] for n in MOTION}


def _handed_over(values: Reals) -> Reals:
    """An output as a parallel co-simulation passes it on: in each step its value at the end of the step before."""
    return np.concatenate([[0.0], values[:-1]])


def wired_name(line: Line) -> str:
    """The name of the variant that is wired."""
    given = {name: line.start.get(name) for name in SLOPE}
    uniform = all(value == UNIFORM for value in given.values())
    estimator = "PHASE" if line.start.get(ESTIMATOR) == _estimator(line, "PHASE") else "BEAT"
    return _named(f"{estimator}, uniform" if estimator == "BEAT" and uniform else estimator)


def other_estimators(line: Line) -> dict[str, Mapping[str, Any]]:
    """RemoteSync's start values for the variants that are not wired, by their names; PHASE is for equal cycles only."""
    beat = {ESTIMATOR: _estimator(line, "BEAT")}
    starts: dict[str, Mapping[str, Any]] = {"BEAT": beat, "BEAT, uniform": beat | dict.fromkeys(SLOPE, UNIFORM)}
    if line.remote.data_cycle == line.step_size:
        starts["PHASE"] = {ESTIMATOR: _estimator(line, "PHASE")}
    return {_named(name): start for name, start in starts.items() if _named(name) != wired_name(line)}


def _named(estimator: str) -> str:
    return f"{REMOTE}, {estimator}"


def _estimator(line: Line, name: str) -> int:
    """The number of an estimator."""
    members = line.recipes[REMOTE].variables[ESTIMATOR].choices
    return next(int(member) for member in members if member.name == name)


def variant_of(line: Line, name: str, values: Values, truth: Values, remote: Values | None) -> Variant:
    """A variant from the outputs of the follower, of the follower that sees the true axis, and of RemoteSync (None: the
    follower sees the telegrams)."""
    s = line.follower
    motions = [s.master.until(t) for t in line.times.tolist()]
    master = np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in motions])
    recording = Recording(line.times, _shown(values), master, [])
    away = _nearest(values["slave.position"] - truth["slave.position"], s.period)
    return Variant(
        name,
        recording,
        away,
        _index(line, remote, master),
        find_cuts(s.cuts, recording) if s.cuts else [],
        list(_switches(line, recording)) if line.places is not None else [],
    )


def _shown(values: Values) -> Values:
    """The outputs with `state`, whose number is `state_code`."""
    return values | ({"state": values["state_code"]} if "state_code" in values else {})


def _nearest(difference: Any, period: float) -> Any:
    """A difference of positions without whole periods."""
    return difference - period * np.round(difference / period) if period else difference


def _index(line: Line, remote: Values | None, master: Reals) -> Reals:
    """How far the index of the telegrams (without `remote`), or RemoteSync's corrected one, is ahead of the sender's.
    Errors begin with the second step; the first one gets the same."""
    name = line.remote.names.corrected_index
    corrected = np.zeros(line.steps) if remote is None else remote[name]
    values = {name: corrected, "slave.position": np.zeros(line.steps)}
    found = errors(line.remote, Recording(line.times, values, master, []))
    index = found.index if remote is None else found.corrected_index
    return np.concatenate([index[:1], index])


def _switches(line: Line, recording: Recording) -> Iterator[Switch]:
    """Where transitions began on the true axis. The progress of a transition in the first step that shows it tells how
    far back that was."""
    ramp, begin, progress, distance = (recording.values[name] for name in RAMP)
    for i in np.flatnonzero(np.diff(ramp, prepend=0.0) > 0.0).tolist():
        travel = math.copysign(distance[i] * progress[i], recording.master[i, 1])
        beyond = _nearest(recording.master[i, 0] - travel - begin[i], line.follower.period)
        yield Switch(float(recording.time[i]), float(begin[i]), float(beyond))
