"""Variants of a line: ways in which the follower can receive the axis, and the follower's outputs in each.

The follower and its commands are the same in all variants. Each variant is compared with the follower that sees the
true axis.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..interface.roles import MOTION
from ..scenario.evaluate.cuts import find_cuts
from ..scenario.evaluate.find_pieces import Piece, find_pieces, rises
from ..scenario.evaluate.remote_errors import remote_errors
from ..scenario.recording import Reals, Recording
from .line import RAMP, REMOTE, ProductionLine
from .package import LinePackage
from .runs import Inputs, Values, run_alone

RAW = "raw telegrams"
ESTIMATOR = "estimator"
SLOPE = ("slope1_numerator", "slope1_denominator")
UNIFORM = 0.5  # for both slopes: the estimator BEAT then corrects uniformly from beat to beat


@dataclass(frozen=True)
class FollowerEvent:
    """A cut of the follower, the start of a transition, or a product between two cuts.

    Attributes:
        number: from 1 on; of a product that of its piece.
        begin, end: in s: the first and the last point of a cut; the first point that shows a transition; the beginning
            of the cut before a product, and the end of the cut that ended it.
        place: the mark of a cut, the position on the master where a transition should begin, the ordered length of a
            product, in u.
        error: on the true axis, in u: how far the slave lags behind the mark where that is farthest; how far the axis
            was beyond the position; how much longer the product is.
        recorded: how much longer a product is as recorded by the follower, in u.
    """

    number: int
    begin: float
    end: float
    place: float
    error: float
    recorded: float | None = None


@dataclass(frozen=True)
class Variant:
    """The outputs of the follower for one way in which it receives the axis.

    Attributes:
        recording: the follower's outputs.
        deviation: slave.position minus that of the follower that sees the true axis, in u; shape (steps,).
        index: how far the cycle index is ahead of the sender's, in cycles; shape (steps,).
        cuts, switches: those of the follower.
        pieces: those that the follower reports, measured on the true axis; `products`: those between two cuts.
        missed: how many cuts the follower left out or made late in each step; shape (steps,).
    """

    name: str
    recording: Recording
    deviation: Reals
    index: Reals
    cuts: list[FollowerEvent]
    switches: list[FollowerEvent]
    pieces: list[Piece]
    products: list[FollowerEvent]
    missed: Reals

    @property
    def events(self) -> list[FollowerEvent]:
        """What the follower does on the material: its products, its cuts, or its transitions."""
        return self.products or self.cuts or self.switches


def run_through_remote_sync(
    line: ProductionLine, package: LinePackage, start: Mapping[str, Any] | None = None
) -> tuple[Values, Values]:
    """RemoteSync alone, then the follower alone with RemoteSync's outputs: the outputs of both.

    `start`: start values of RemoteSync; without them RemoteSync has those of the wired line."""
    remote = run_alone(line, package, REMOTE, line.telegrams, start)
    return remote, run_follower(line, package, {f"master.{n}": _delayed(remote[f"slave.{n}"]) for n in MOTION})


def run_follower(line: ProductionLine, package: LinePackage, axis: Inputs) -> Values:
    """The outputs of the follower that runs alone, with this axis as its master."""
    return run_alone(line, package, line.follower.recipe.name, {**axis, **line.commands})


def true_axis(line: ProductionLine) -> Inputs:
    """The axis itself as the follower's master."""
    motions = [line.follower.master.at(i * line.step_size) for i in range(line.steps)]
    return {f"master.{n}": np.array([getattr(m, n) for m in motions]) for n in MOTION}


def raw_axis(line: ProductionLine) -> Inputs:
    """The uncorrected telegrams as the follower's master."""
    return {f"master.{n}": line.telegrams[f"{line.remote.names.part}.{n}"] for n in MOTION}


def _delayed(values: Reals) -> Reals:
    """An output as a parallel co-simulation passes it on: one step later."""
    return np.concatenate([[0.0], values[:-1]])


def wired_name(line: ProductionLine) -> str:
    """The name of the variant that is wired."""
    uniform = all(line.start.get(name) == UNIFORM for name in SLOPE)
    estimator = "PHASE" if line.start.get(ESTIMATOR) == _estimator_number(line, "PHASE") else "BEAT"
    return _variant_name(f"{estimator}, uniform" if estimator == "BEAT" and uniform else estimator)


def other_estimators(line: ProductionLine) -> dict[str, Mapping[str, Any]]:
    """RemoteSync's start values for the variants that are not wired, by name; PHASE needs equal cycles."""
    beat = {ESTIMATOR: _estimator_number(line, "BEAT")}
    starts: dict[str, Mapping[str, Any]] = {"BEAT": beat, "BEAT, uniform": beat | dict.fromkeys(SLOPE, UNIFORM)}
    if line.remote.data_cycle == line.step_size:
        starts["PHASE"] = {ESTIMATOR: _estimator_number(line, "PHASE")}
    return {_variant_name(name): start for name, start in starts.items() if _variant_name(name) != wired_name(line)}


def _variant_name(estimator: str) -> str:
    return f"{REMOTE}, {estimator}"


def _estimator_number(line: ProductionLine, name: str) -> int:
    """The number of the estimator with this name."""
    members = line.recipes[REMOTE].variables[ESTIMATOR].choices
    return next(int(member) for member in members if member.name == name)


def variant_of(line: ProductionLine, name: str, values: Values, truth: Values, remote: Values | None) -> Variant:
    """A variant from the outputs of the follower, of the follower that sees the true axis, and of RemoteSync (None: the
    follower sees the telegrams)."""
    s = line.follower
    motions = [s.master.until(t) for t in line.times.tolist()]
    master = np.array([(m.position, m.velocity, m.acceleration, m.jerk) for m in motions])
    state = {"state": values["state_code"]} if "state_code" in values else {}  # its number
    recording = Recording(line.times, values | state, master, [], s.settings)
    deviation = _shortest(values["slave.position"] - truth["slave.position"], s.period)
    cuts = find_cuts(s.cuts, recording, s.slave_period) if s.cuts else []
    pieces = find_pieces(s, recording)
    return Variant(
        name,
        recording,
        deviation,
        _index_errors(line, remote, master),
        [FollowerEvent(i, c.begin, c.end, c.mark, c.error) for i, c in enumerate(cuts, 1)],
        list(_find_switches(line, recording)) if line.switch_tolerance is not None else [],
        pieces,
        [
            FollowerEvent(p.number, before.cut[0], p.cut[1], p.ordered, p.measured - p.ordered, p.error)
            for before, p in pairwise(pieces)
            if p.product and p.measured is not None and before.cut and p.cut
        ],
        rises(values[v.skipped]) + rises(values[v.late]) if (v := line.piece_variables) else np.zeros(line.steps),
    )


def _shortest(difference: Any, period: float) -> Any:
    """A difference of positions without whole periods."""
    return difference - period * np.round(difference / period) if period else difference


def _index_errors(line: ProductionLine, remote: Values | None, master: Reals) -> Reals:
    """How far the index is ahead of the sender's, in cycles; shape (steps,).

    The index is RemoteSync's corrected one, or without `remote` that of the telegrams. The errors are known from the
    second step on; the first step gets the error of the second."""
    name = line.remote.names.corrected_index
    corrected = np.zeros(line.steps) if remote is None else remote[name]
    values = {name: corrected, "slave.position": np.zeros(line.steps)}
    errors = remote_errors(line.remote, Recording(line.times, values, master, []))
    index = errors.index if remote is None else errors.corrected_index
    return np.concatenate([index[:1], index])


def _find_switches(line: ProductionLine, recording: Recording) -> Iterator[FollowerEvent]:
    """The starts of transitions, on the true axis.

    The travel since the start follows from the transition's progress at the end of the first step that shows it."""
    ramp, begin, progress, distance = (recording.values[name] for name in RAMP)
    for number, i in enumerate(np.flatnonzero(np.diff(ramp, prepend=0.0) > 0.0).tolist(), 1):
        travel = math.copysign(distance[i] * progress[i], recording.master[i, 1])
        error = _shortest(recording.master[i, 0] - travel - begin[i], line.follower.period)
        time = float(recording.time[i])
        yield FollowerEvent(number, time, time, float(begin[i]), float(error))
