"""Judges a run: the expectations of its scenario, and the reference beside the scenario's file."""

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from motionsync.var import Unit

from ..errors import UserError
from ..interface.roles import books
from ..interface.units import unit_name
from ..interface.variables import Variable
from .amounts import engineering
from .cuts import Cut, CutSpec, PieceSpec
from .production import Production
from .recording import Recording, greatest_position
from .scenario import AtTime, Expectation, Scenario, When, Within
from .settings import COMPARISONS, Unmet
from .telegrams import Remote, errors
from .work import Work


@dataclass(frozen=True)
class Check:
    """One expectation, and what was found."""

    expected: str
    found: str
    passed: bool

    @property
    def text(self) -> str:
        """The expectation and what was found, in one sentence."""
        return f"{self.expected}: found {self.found}"


@dataclass(frozen=True)
class Deviation:
    """How far a variable is from the reference.

    Attributes:
        greatest: the greatest |difference|, in the variable's unit.
        at: the time of it, in s.
        allowed: how great it may be.
        points: at how many times both were compared.
        scale: the greatest magnitude in the reference, at least 1.
    """

    name: str
    greatest: float
    at: float
    allowed: float
    points: int
    scale: float

    @property
    def passed(self) -> bool:
        return self.greatest <= self.allowed

    @property
    def text(self) -> str:
        """The deviation in one sentence."""
        if not self.points:
            return f"{self.name}: the reference has no time in common with the run"
        found = engineering(self.greatest, scale=self.scale)
        allowed = engineering(self.allowed)
        return f"{self.name}: {found} from the reference at {engineering(self.at)} s, {allowed} allowed"


def judged_outputs(scenario: Scenario) -> set[str]:
    """The outputs by which a run of the scenario is judged; empty if nothing has to be judged from its course."""
    variables = scenario.recipe.variables.values()
    names = {name for e in scenario.expectations for name in _expected(e)}
    if scenario.cuts:
        names |= {scenario.cuts.name, "slave.position"}
    if kept := books(variables):
        names |= {*kept.told, "slave.position"}
    if scenario.remote and scenario.remote.accuracy:
        names |= {scenario.remote.names.corrected_index, "slave.position"}
    return names


def _expected(e: Expectation) -> Iterable[str]:
    match e:
        case AtTime():
            return e.values
        case When():
            return (e.name,)
        case Within():
            return e.limits


def check(scenario: Scenario, recording: Recording) -> list[Check]:
    """What was found for every expectation of the scenario; then for the reactions that it requires and that did not
    happen, its cuts and its remote axis."""
    return check_work(Work(scenario, recording))


def check_work(made: Work) -> list[Check]:
    """The same of a run whose cuts or pieces are asked for elsewhere, too."""
    scenario, recording = made.scenario, made.recording
    found: list[Check] = []
    for e in scenario.expectations:
        match e:
            case AtTime():
                found += _at_time(e, recording, scenario.recipe.variables)
            case When():
                found.append(_when(e, recording, scenario.remote.clocks.task_cycle if scenario.remote else 0.0))
            case Within():
                found += _within(e, recording)
    found += missing(recording.unmet)
    unit = unit_name(Unit.POSITION, scenario.unit)
    if scenario.cuts:
        found += _cuts(scenario.cuts, made.cuts, recording, unit)
    if scenario.pieces and made.production:
        found += _pieces(scenario.pieces, made.production)
    if scenario.remote:
        found += _accuracy(scenario.remote, recording, unit)
    return found


def missing(unmet: Iterable[Unmet]) -> list[Check]:
    """The reactions that the scenario requires and that did not happen."""
    return [Check(u.expected, u.found, False) for u in unmet if u.reaction.required]


def _at_time(e: AtTime, recording: Recording, variables: Mapping[str, Variable]) -> Iterator[Check]:
    i = int(np.argmin(np.abs(recording.time - e.at)))
    for name, wanted in e.values.items():
        value = float(recording.values[name][i])
        text = variables[name].text
        named = text(wanted)
        allowed = f" ± {engineering(e.tolerance)}" if named == f"{wanted:.10g}" else ""
        found = named if value == wanted else text(value)
        yield Check(f"{name} = {named}{allowed} at {e.at:.10g} s", found, abs(value - wanted) <= e.tolerance)


def _when(e: When, recording: Recording, cycle: float) -> Check:
    """`cycle`: the length of the block's own cycles, in s, or 0.

    An expectation without a tolerance allows one step of the run, or one cycle if that is longer."""
    tolerance = max(float(np.diff(recording.time).max()), cycle) if e.tolerance is None else e.tolerance
    holds = np.asarray(COMPARISONS[e.comparison](recording.values[e.name], e.value))
    expected = f"first {e.text} at {e.time:.10g} s ± {engineering(tolerance)}"
    if not holds.any():
        return Check(expected, "never", False)
    time = float(recording.time[int(np.argmax(holds))])
    return Check(expected, f"{time:.10g} s", abs(time - e.time) <= tolerance * (1.0 + 1e-9))


def _within(e: Within, recording: Recording) -> Iterator[Check]:
    chosen = (recording.time >= e.begin - 1e-9) & (recording.time <= e.end + 1e-9)
    for name, (low, high) in e.limits.items():
        values = recording.values[name][chosen]
        least, greatest = float(values.min()), float(values.max())
        passed = low - e.tolerance <= least and greatest <= high + e.tolerance
        limits = f"from {low:.10g} to {high:.10g} ± {engineering(e.tolerance)}"
        expected = f"{name} {limits} between {e.begin:.10g} s and {e.end:.10g} s"
        yield Check(expected, f"{least:.10g} to {greatest:.10g}", passed)


def _cuts(spec: CutSpec, found: Sequence[Cut], recording: Recording, unit: str) -> Iterator[Check]:
    """`found`: the cuts of the run; `unit`: the name of the unit of positions."""
    if spec.count is not None:
        yield Check(f"number of cuts = {spec.count}", f"{len(found)}", len(found) == spec.count)
    if found or spec.count != 0:
        worst = max((abs(c.error) for c in found), default=math.inf)
        within, length = engineering(spec.tolerance, unit), engineering(spec.length, unit)
        away = f"at most {engineering(worst, unit, scale=greatest_position(recording), digits=3)} away"
        expected = f"cuts within {within} of a mark, one mark each {length}"
        yield Check(expected, away if found else "no cut", worst <= spec.tolerance)


def _pieces(spec: PieceSpec, made: Production) -> Iterator[Check]:
    if spec.count is not None:
        yield Check(f"number of pieces = {spec.count}", f"{made.cuts}", made.cuts == spec.count)
    if spec.kinds is not None:
        kinds = tuple(piece.name for piece in made.pieces)
        yield Check(
            f"kinds of the pieces = {', '.join(spec.kinds)}", ", ".join(kinds) or "no piece", kinds == spec.kinds
        )
    within = engineering(spec.tolerance, made.unit)
    if spec.lengths is not None:
        yield _lengths(spec.lengths, spec.tolerance, made)
    elif made.products or (spec.count != 0 and not made.pieces):
        worst = max((abs(piece.error) for piece in made.products), default=math.inf)
        off = f"at most {made.worst_text} off" if made.products else "no piece"
        yield Check(f"products as long as ordered, within {within}", off, worst <= spec.tolerance)
    if gaps := made.gaps:
        away = f"at most {engineering(max(gaps), made.unit, scale=made.scale, digits=3)} away"
        expected = f"cuts within {within} of where they are told, by the positions of slave and material"
        yield Check(expected, away, max(gaps) <= spec.tolerance)


def _lengths(lengths: tuple[float, ...], tolerance: float, made: Production) -> Check:
    """Whether there are pieces of these lengths, in this order."""
    expected = f"{len(lengths)} lengths, each within {engineering(tolerance, made.unit)}"
    if len(lengths) != len(made.pieces):
        return Check(expected, f"{len(made.pieces)} pieces", False)
    off = [abs(piece.length - length) for piece, length in zip(made.pieces, lengths, strict=True)]
    worst = max(off, default=0.0)
    text = f"at most {engineering(worst, made.unit, scale=made.scale, digits=3)} off"
    if worst > tolerance:
        piece, length = made.pieces[off.index(worst)], lengths[off.index(worst)]
        text = f"piece {piece.number} of {engineering(piece.length)} instead of {engineering(length, made.unit)}"
    return Check(expected, text, worst <= tolerance)


def _accuracy(remote: Remote, recording: Recording, unit: str) -> Iterator[Check]:
    """`unit`: the name of the unit of positions."""
    allowed = remote.accuracy
    if allowed is None:
        return
    found = errors(remote, recording)
    chosen = found.time >= allowed.begin - 1e-9
    since = f"from {allowed.begin:.10g} s on"
    if allowed.index is not None:
        width = float(np.ptp(found.corrected_index[chosen]))
        name = remote.names.corrected_index
        expected = f"{name} within {engineering(allowed.index)} cycles of the true index, peak to peak, {since}"
        yield Check(expected, engineering(width, digits=3), width <= allowed.index)
    if allowed.position is not None:
        worst = float(np.abs(found.corrected_position[chosen]).max())
        behind = f", {allowed.behind:g} data cycles behind," if allowed.behind else ""
        expected = f"slave.position within {engineering(allowed.position, unit)} of the true axis{behind} {since}"
        yield Check(expected, f"at most {engineering(worst, unit, digits=3)} away", worst <= allowed.position)


def read_reference(scenario: Scenario) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]], float] | None:
    """Names, rows of shape (points, 1 + names) and relative tolerance of the scenario's reference; None without one.

    Raises:
        UserError: a reference that cannot be read or names an unknown variable.
    """
    file = scenario.file.parent / f"{scenario.recipe.name}_ref.csv"
    options = file.with_suffix(".opt")
    if not file.exists():
        return None
    try:
        with file.open(newline="") as lines:
            header, *rows = list(csv.reader(lines))
        settings = dict(line.split(",") for line in options.read_text().splitlines() if line.strip())
        tolerance = float(settings["RelTol"])
        table = np.array(rows, float)
        if table.shape[1] != len(header):
            raise ValueError("rows of different lengths")
    except (OSError, ValueError, KeyError, IndexError) as e:
        raise UserError(f"{file}: not a reference: {e}") from None
    return header[1:], table, tolerance


def compare(scenario: Scenario, recording: Recording) -> list[Deviation]:
    """Compare a recording with the reference at their common times.

    Two rows of the reference at one time are the values before and after a jump; any value between them agrees. The
    tolerance is relative to the greatest magnitude of the variable in the reference, at least 1.
    """
    reference = read_reference(scenario)
    if reference is None:
        return []
    names, table, tolerance = reference
    if unknown := [n for n in names if n not in recording.values]:
        raise UserError(f"{scenario.file.parent}: the reference has {unknown[0]!r}, the FMU has not")
    times = np.unique(table[:, 0])
    at = np.searchsorted(recording.time, times - 1e-9)
    common = (at < len(recording.time)) & (
        np.abs(recording.time[np.minimum(at, len(recording.time) - 1)] - times) <= 1e-9
    )
    first = np.searchsorted(table[:, 0], times[common], "left")
    last = np.searchsorted(table[:, 0], times[common], "right") - 1
    found = []
    for column, name in enumerate(names, 1):
        before, after = table[first, column], table[last, column]
        values = recording.values[name][at[common]]
        beyond = np.maximum(np.minimum(before, after) - values, values - np.maximum(before, after))
        away = np.maximum(beyond, 0.0)
        worst = int(np.argmax(away)) if len(away) else 0
        scale = max(1.0, float(np.abs(table[:, column]).max()))
        greatest, time = (float(away[worst]), float(times[common][worst])) if len(away) else (math.inf, 0.0)
        found.append(Deviation(name, greatest, time, tolerance * scale, int(common.sum()), scale))
    return found
