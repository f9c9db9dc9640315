"""Checks a run against the expectations of its scenario."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...interface.variables import Variable
from ..computed_columns import needed_outputs
from ..cutting import CutSpec, PieceSpec
from ..engineering import engineering
from ..recording import Recording, greatest_position, nearest_turn
from ..remote_view import RemoteView
from ..scenario import AtTime, Scenario, When, Within
from ..settings import COMPARISONS, UnmetReaction
from .cuts import Cut
from .cutting_results import CuttingResults
from .production import Production
from .remote_errors import remote_errors
from .true_pieces import TruePieces


@dataclass(frozen=True)
class Check:
    """An expectation, and the actual result, in words."""

    expected: str
    actual: str
    passed: bool

    @property
    def text(self) -> str:
        """The expectation and the result in one sentence."""
        return f"{self.expected}: found {self.actual}"


def checked_outputs(scenario: Scenario) -> set[str]:
    """The outputs that the expectations of a scenario check over time; empty if there are none."""
    names = {name for e in scenario.expectations for name in e.names if name in scenario.recipe.variables}
    names |= {*needed_outputs(scenario.servo, scenario.load)}
    if scenario.cuts:
        names |= {scenario.cuts.name, "slave.position"}
    if pieces := scenario.recipe.piece_variables:
        names |= {*pieces.outputs, "slave.position"}
    if scenario.slave_period and (scenario.cuts or pieces):
        names.add("slave.velocity")  # it unwraps the position
    if scenario.remote and scenario.remote.accuracy:
        names |= {scenario.remote.names.corrected_index, "slave.position"}
    return names


def check_expectations(scenario: Scenario, recording: Recording, results: CuttingResults | None = None) -> list[Check]:
    """The results for every expectation of the scenario; then for the reactions that it requires and that did not
    happen, its cuts and its remote axis. `results`: the cuts and pieces of the run, if the caller has them."""
    results = results or CuttingResults(scenario, recording)
    checks: list[Check] = []
    for e in scenario.expectations:
        match e:
            case AtTime():
                checks += _check_values_at_time(e, recording, scenario)
            case When():
                checks.append(
                    _check_first_time(e, recording, scenario.remote.clocks.task_cycle if scenario.remote else 0.0)
                )
            case Within():
                checks += _check_limits(e, recording, scenario)
    checks += check_reactions(recording.unmet)
    unit = unit_name(Unit.POSITION, scenario.unit)
    if scenario.cuts:
        checks += _check_cuts(scenario.cuts, results.cuts, recording, unit)
    if results.production:
        checks.append(_check_skipped(scenario.pieces.skipped if scenario.pieces else 0, results.production.skipped))
        checks += (
            _check_pieces(scenario.pieces, results.production, results.true_pieces, scenario.is_recorded)
            if scenario.pieces
            else ()
        )
    if scenario.remote:
        checks += _check_accuracy(scenario.remote, recording, unit)
    return checks


def check_reactions(unmet: Iterable[UnmetReaction]) -> list[Check]:
    """The reactions that the scenario requires and that did not happen."""
    return [Check(u.expected, u.actual, False) for u in unmet if u.reaction.required]


def _check_values_at_time(e: AtTime, recording: Recording, scenario: Scenario) -> Iterator[Check]:
    i = int(np.argmin(np.abs(recording.time - e.at)))
    for name, required in e.values.items():
        value = float(recording.columns[name][i])
        text = scenario.columns[name].text
        named = text(required)
        allowed = f" ± {engineering(e.tolerance)}" if named == f"{required:.10g}" else ""
        actual = named if value == required else text(value)
        off = abs(nearest_turn(value, required, scenario.period_of(name)) - required)
        yield Check(f"{name} = {named}{allowed} at {e.at:.10g} s", actual, off <= e.tolerance)


def _check_first_time(e: When, recording: Recording, cycle: float) -> Check:
    """`cycle`: the length of the block's own cycles, in s, or 0.

    An expectation without a tolerance allows one step of the run, or one cycle if that is longer."""
    tolerance = max(float(np.diff(recording.time).max()), cycle) if e.tolerance is None else e.tolerance
    holds = np.asarray(COMPARISONS[e.comparison](recording.columns[e.name], e.value))
    expected = f"first {e.text} at {e.time:.10g} s ± {engineering(tolerance)}"
    if not holds.any():
        return Check(expected, "never", False)
    time = float(recording.time[int(np.argmax(holds))])
    return Check(expected, f"{time:.10g} s", abs(time - e.time) <= tolerance * (1.0 + 1e-9))


def _check_limits(e: Within, recording: Recording, scenario: Scenario) -> Iterator[Check]:
    inside = (recording.time >= e.begin - 1e-9) & (recording.time <= e.end + 1e-9)
    for name, (low, high) in e.limits.items():
        v = scenario.columns[name]
        unit = unit_name(v.declaration.unit, scenario.unit, scenario.slave_unit)
        values = recording.columns[name][inside]
        least, greatest = float(values.min()), float(values.max())
        passed = low - e.tolerance <= least and greatest <= high + e.tolerance
        actual = v.text(least) if least == greatest else f"{v.text(least)} to {v.text(greatest)}"
        expected = f"{name} {_limits_text(v, e.limits[name], e.tolerance, unit)}"
        yield Check(f"{expected}, from {e.begin:.10g} s to {e.end:.10g} s", f"{actual} {unit}".rstrip(), passed)


def _limits_text(v: Variable, limits: tuple[float, float], tolerance: float, unit: str) -> str:
    """What is allowed between two limits: `= false`, `= OFF or HOMING`, `at most 650 mm ± 1e-9 mm`."""
    low, high = limits
    if v.kind == "Boolean" or v.choices:
        allowed = [v.text(value) for value in (v.choices or (0, 1)) if low <= value <= high]
        return f"= {' or '.join(allowed) or 'nothing'}"
    least, greatest = (engineering(limit, digits=10) for limit in limits)
    if low == high:
        text = f"= {least}"
    elif low == -math.inf:
        text = f"at most {greatest}"
    else:
        text = f"at least {least}" if high == math.inf else f"between {least} and {greatest}"
    margin = f" ± {engineering(tolerance, unit)}" if tolerance and v.kind == "Real" else ""
    return f"{text} {unit}".rstrip() + margin


def _check_cuts(spec: CutSpec, cuts: Sequence[Cut], recording: Recording, unit: str) -> Iterator[Check]:
    """`cuts`: the cuts of the run; `unit`: the name of the unit of positions."""
    if spec.count is not None:
        yield Check(f"number of cuts = {spec.count}", f"{len(cuts)}", len(cuts) == spec.count)
    if cuts or spec.count != 0:
        worst = max((abs(c.error) for c in cuts), default=math.inf)
        allowed, length = engineering(spec.tolerance, unit), engineering(spec.length, unit)
        distance = f"at most {engineering(worst, unit, scale=greatest_position(recording), digits=3)} away"
        expected = f"cuts within {allowed} of a mark, one mark each {length}"
        yield Check(expected, distance if cuts else "no cut", worst <= spec.tolerance)


def _check_skipped(expected: int, skipped: int) -> Check:
    """Whether so many cuts were skipped. Each piece of the kind MERGED lacks one at least."""
    return Check(f"number of skipped cuts = {expected}", f"{skipped}", skipped == expected)


def _check_pieces(
    spec: PieceSpec, production: Production, true_pieces: TruePieces | None, is_recorded: bool
) -> Iterator[Check]:
    """`true_pieces`: None if the block knows the true places, or if nobody does: where the line is recorded."""
    if spec.count is not None:
        yield Check(f"number of pieces = {spec.count}", f"{production.cuts}", production.cuts == spec.count)
    if spec.kinds is not None:
        kinds = tuple(piece.name for piece in production.pieces)
        yield Check(
            f"kinds of the pieces = {', '.join(spec.kinds)}", ", ".join(kinds) or "no piece", kinds == spec.kinds
        )
    allowed = engineering(spec.tolerance, production.unit)
    if spec.lengths is not None:
        yield _check_lengths(spec.lengths, spec.tolerance, production)
    elif production.products or (spec.count != 0 and not production.pieces):
        worst = max((abs(piece.error) for piece in production.products), default=math.inf)
        off = f"at most {production.worst_text} off" if production.products else "no piece"
        yield Check(f"products as long as ordered, within {allowed}", off, worst <= spec.tolerance)
    if true_pieces:
        if true_pieces.pieces:
            worst = abs(true_pieces.worst)
            off = f"at most {engineering(worst, production.unit, scale=production.scale, digits=3)} off"
            yield Check(f"true lengths of products as ordered, within {allowed}", off, worst <= spec.tolerance)
    elif (gaps := production.gaps) and not is_recorded:
        distance = f"at most {engineering(max(gaps), production.unit, scale=production.scale, digits=3)} away"
        expected = f"cuts within {allowed} of where they are reported, by the positions of slave and material"
        yield Check(expected, distance, max(gaps) <= spec.tolerance)


def _check_lengths(lengths: tuple[float, ...], tolerance: float, production: Production) -> Check:
    """Whether there are pieces of these lengths, in this order."""
    expected = f"{len(lengths)} lengths, each within {engineering(tolerance, production.unit)}"
    if len(lengths) != len(production.pieces):
        return Check(expected, f"{len(production.pieces)} pieces", False)
    off = [abs(piece.length - length) for piece, length in zip(production.pieces, lengths, strict=True)]
    worst = max(off, default=0.0)
    text = f"at most {engineering(worst, production.unit, scale=production.scale, digits=3)} off"
    if worst > tolerance:
        piece, length = production.pieces[off.index(worst)], lengths[off.index(worst)]
        text = f"piece {piece.number} of {engineering(piece.length)} instead of {engineering(length, production.unit)}"
    return Check(expected, text, worst <= tolerance)


def _check_accuracy(remote: RemoteView, recording: Recording, unit: str) -> Iterator[Check]:
    """`unit`: the name of the unit of positions."""
    allowed = remote.accuracy
    if allowed is None:
        return
    errors = remote_errors(remote, recording)
    inside = errors.time >= allowed.begin - 1e-9
    since = f"from {allowed.begin:.10g} s on"
    if allowed.index is not None:
        width = float(np.ptp(errors.corrected_index[inside]))
        name = remote.names.corrected_index
        expected = f"{name} within {engineering(allowed.index)} cycles of the true index, peak to peak, {since}"
        yield Check(expected, engineering(width, digits=3), width <= allowed.index)
    if allowed.position is not None:
        worst = float(np.abs(errors.corrected_position[inside]).max())
        behind = f", {allowed.behind:g} data cycles behind," if allowed.behind else ""
        expected = f"slave.position within {engineering(allowed.position, unit)} of the true axis{behind} {since}"
        yield Check(expected, f"at most {engineering(worst, unit, digits=3)} away", worst <= allowed.position)
