"""What makes a run fail, and what is a note: two lists, which all ask that evaluate a run.

What a scenario expects is no failure: an [[expect]] expects a value that a variable shows, if it is met by this value
and would not be met without a fault.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from motionsync.var import Role, Unit

from ...interface.roles import find_by_role
from ...interface.units import unit_name
from ...interface.variables import Variable
from ..engineering import engineering
from ..recording import Recording
from ..scenario import AtTime, Expectation, Scenario, When
from .axis_figures import LoadFigures
from .cut_checks import check_lengths, check_missed, check_movement, check_number, orders_left
from .cuts import uncut_text
from .cutting_results import CuttingResults
from .expectations import Check, check_expectations, checked_outputs
from .key_figures import Peak
from .reference_comparison import Deviation
from .time_series import time_series

ALARM, IS_ALARM = "error_id", "error"  # every block has these outputs, and parts of some have them, too
INPUT_WARNING = "master.input_warning"


class Event(NamedTuple):
    """A value other than 0 of a variable with codes, and when it was there first, in s."""

    code: int
    at: float


@dataclass(frozen=True)
class Evidence:
    """What is known of a run.

    Attributes:
        results: its cuts and pieces.
        peaks: the extremes of the slave's motion; without those that exceed no limit, if the caller leaves them out.
        alarms: the alarms of the block, each code once.
        exceeded: the limits of the axis that the block itself reports, each code once.
        reference: how far the run is from its reference.
        load: what the motor has to give; None: this is not known.
    """

    scenario: Scenario
    recording: Recording
    results: CuttingResults
    peaks: Sequence[Peak]
    alarms: Sequence[Event]
    exceeded: Sequence[Event]
    reference: Sequence[Deviation] = ()
    load: LoadFigures | None = None


class Failure(NamedTuple):
    """Something that makes a run fail: a sentence about it, and the checks of it."""

    sentence: str
    find: Callable[[Evidence], Iterable[Check | Deviation]]


class Note(NamedTuple):
    """Something that a reader should know although no run fails by it: a sentence about it, and the notes of a run."""

    sentence: str
    find: Callable[[Evidence], Iterable[str]]


def gather(
    scenario: Scenario,
    recording: Recording,
    results: CuttingResults,
    peaks: Sequence[Peak],
    reference: Sequence[Deviation] = (),
    load: LoadFigures | None = None,
) -> Evidence:
    """The evidence of a run whose alarms and limits were recorded."""
    limits = find_by_role(scenario.recipe.variables.values(), Role.EXCEEDED_LIMIT)
    exceeded = find_events(recording, limits.name) if limits else []
    return Evidence(scenario, recording, results, peaks, find_events(recording, ALARM), exceeded, reference, load)


def find_events(recording: Recording, name: str) -> list[Event]:
    """The values of a variable other than 0, in the sequence in which they were first there; none if it was not
    recorded."""
    values = recording.values.get(name)
    if values is None or not values.any():
        return []
    codes, first = np.unique(values, return_index=True)
    events = sorted(zip(first.tolist(), codes.tolist(), strict=True))
    return [Event(int(code), float(recording.time[i])) for i, code in events if code]


def needed_outputs(scenario: Scenario) -> set[str]:
    """The outputs whose whole course is needed for the checks of a scenario; empty if none are.

    Without those of an alarm or a limit the first one of a run fails it: nothing expects one."""
    names = checked_outputs(scenario)
    if scenario.cuts:
        names |= {scenario.cuts.name, "slave.position"}
    if pieces := scenario.recipe.piece_variables:
        names |= {*pieces.outputs, "slave.position"}
        if scenario.pieces and scenario.pieces.orders_left is not None:
            names.add(pieces.orders)
    if scenario.slave_period and (scenario.cuts or pieces):
        names.add("slave.velocity")  # it unwraps the position
    return names


def find_checks(evidence: Evidence) -> list[Check | Deviation]:
    """All checks of a run."""
    return [check for rule in FAILURES for check in rule.find(evidence)]


def find_notes(evidence: Evidence) -> list[str]:
    """All notes of a run, a sentence each."""
    return [note for rule in NOTES for note in rule.find(evidence)]


# --- what a scenario expects ---


def is_expected(scenario: Scenario, name: str, value: float, *, at_end: bool = False) -> bool:
    """Whether an [[expect]] is met by this value of a variable, and not by 0; `at_end`: one of the end of the run."""
    spans = (_demanded(e, name) for e in scenario.expectations if not at_end or _is_of_end(e, scenario))
    return any(low <= value <= high and not low <= 0.0 <= high for low, high in filter(None, spans))


def _is_of_end(e: Expectation, scenario: Scenario) -> bool:
    return not isinstance(e, When) and (e.at if isinstance(e, AtTime) else e.end) >= scenario.stop_time


def _demanded(e: Expectation, name: str) -> tuple[float, float] | None:
    """The least and the greatest value of a variable by which an expectation is met; None: it does not name it."""
    if name not in e.names:
        return None
    if isinstance(e, AtTime):
        return e.values[name], e.values[name]
    if not isinstance(e, When):
        return e.limits[name]
    spans = {">": (math.nextafter(e.value, math.inf), math.inf), "<": (-math.inf, math.nextafter(e.value, -math.inf))}
    return spans.get(e.comparison, (e.value, e.value))


# --- alarms and limits ---


def check_alarms(scenario: Scenario, alarms: Iterable[Event]) -> Iterator[Check]:
    """Whether nothing but expected alarms came; the first other one is named."""
    variables = scenario.recipe.variables.values()
    coded = [v for v in variables if _last(v) == ALARM]
    flags = [v.name for v in variables if _last(v) == IS_ALARM and v.kind == "Boolean"]
    for code, at in alarms:
        if any(is_expected(scenario, v.name, code) for v in coded):
            continue
        if not any(is_expected(scenario, flag, 1.0) for flag in flags):
            yield Check("no alarm", f"{ALARM} = {code} at {engineering(at, 's')}{_meaning(coded, code)}", False)
            return


def check_limits(scenario: Scenario, peaks: Iterable[Peak], exceeded: Iterable[Event]) -> Iterator[Check]:
    """Whether the setpoint keeps the limits of the axis, but for those that it is expected to exceed."""
    variables = scenario.recipe.variables.values()
    coded, flag = (find_by_role(variables, role) for role in (Role.EXCEEDED_LIMIT, Role.LIMIT_EXCEEDED))
    if flag and is_expected(scenario, flag.name, 1.0):
        return
    beyond = [peak for peak in peaks if peak.exceeded]
    broken = {peak.name: peak.text for peak in beyond}
    expected = {peak.name for peak in beyond if _is_demanded_beyond(scenario, peak)}
    if coded and coded.declaration.codes:
        limited = {int(m): m.name.rpartition("_")[2].lower() for m in coded.declaration.codes}  # MAX_JERK: jerk
        expected |= {what for code, what in limited.items() if is_expected(scenario, coded.name, code)}
        for code, at in exceeded:
            text = f"{coded.name} = {code} at {engineering(at, 's')}{_meaning([coded], code)}"
            broken.setdefault(limited.get(code, f"{code}"), text)
    if unexpected := [text for what, text in broken.items() if what not in expected]:
        yield Check("no limit of the axis exceeded", "; ".join(unexpected), False)


def _is_demanded_beyond(scenario: Scenario, peak: Peak) -> bool:
    """Whether an [[expect]] demands that the slave exceeds the limit of this peak."""
    name = "slave." + peak.name.replace("deceleration", "acceleration")
    most = math.inf if peak.limit is None else peak.limit
    least = (-math.inf if peak.lower is None else peak.lower) if peak.name == "position" else -most
    spans = filter(None, (_demanded(e, name) for e in scenario.expectations))
    return any(low > most or high < least for low, high in spans)


def _last(v: Variable) -> str:
    return v.name.rpartition(".")[2]


def _meaning(coded: Iterable[Variable], code: int) -> str:
    """What a code means, after a colon; empty if nothing states it."""
    members = (m for v in coded for m in v.declaration.codes or () if m == code)
    return next((f": {m.description}" for m in members), "")


# --- notes ---


def _unmet(e: Evidence) -> Iterator[str]:
    return (f"{u.expected}: found {u.actual}" for u in e.recording.unmet if not u.reaction.required)


def _orders(e: Evidence) -> Iterator[str]:
    names, pieces = e.scenario.recipe.piece_variables, e.scenario.pieces
    if not names or (pieces and pieces.orders_left is not None):
        return
    left, lacking = orders_left(e.results), int(e.recording.values[names.remaining][-1])
    counts = ((names.orders, left), (names.remaining, lacking))
    expected = any(is_expected(e.scenario, name, count, at_end=True) for name, count in counts)
    if left and not expected and not time_series(e.scenario, e.recording, names.repeat)[-1]:
        orders = f"{left} order{'s' * (left != 1)} left at the end"
        yield f"{orders}: the active one lacks {lacking} piece{'s' * (lacking != 1)}"


def _line(e: Evidence) -> Iterator[str]:
    if (production := e.results.production) and production.line and production.line.beyond:
        yield f"the line was {production.line_text}"


def _uncut(e: Evidence) -> Iterator[str]:
    missed = e.results.missed_marks
    if before := [mark for mark in e.results.uncut if mark not in missed]:
        yield f"before the first cut {uncut_text(before, unit_name(Unit.POSITION, e.scenario.unit))}"


def _unreported(e: Evidence) -> Iterator[str]:
    production = e.results.production
    if number := production.cuts - len(production.pieces) if production else 0:
        yield f"{number} piece{'s' * (number != 1)} not reported: the step is longer than it takes to make one"


def _input_warnings(e: Evidence) -> Iterator[str]:
    if (v := e.scenario.recipe.variables.get(INPUT_WARNING)) is None:
        return
    for code, at in find_events(e.recording, INPUT_WARNING):
        if not is_expected(e.scenario, INPUT_WARNING, code):
            yield f"{INPUT_WARNING} = {code} at {engineering(at, 's')}{_meaning([v], code)}"


def _unchecked(e: Evidence) -> Iterator[str]:
    s = e.scenario
    has_accuracy = s.remote is not None and s.remote.accuracy is not None
    is_checked = s.expectations or s.cuts or e.results.production or e.reference or has_accuracy
    if not is_checked and not any(r.required for r in s.reactions):
        yield "nothing is checked: the scenario has no [[expect]], no [cuts] and no reference"


FAILURES = (
    Failure(
        "An `[[expect]]` is not met, a reaction that is `required` does not happen, or a remote axis is less accurate "
        "than `[remote.accuracy]` says.",
        lambda e: check_expectations(e.scenario, e.recording),
    ),
    Failure(
        "The number of cuts, pieces or orders left, or the kinds of the pieces, are not those in `[cuts]`.",
        lambda e: check_number(e.results),
    ),
    Failure(
        "A piece is lost, merged or late: a cut is skipped or late, or a mark passes the saw uncut after "
        "its first cut.",
        lambda e: check_missed(e.results),
    ),
    Failure(
        "A length is out of tolerance: as the block reports it, by the positions of slave and material, or, behind an "
        "encoder or a servo, by the tape measure; or a cut is too far from its mark.",
        lambda e: check_lengths(e.results),
    ),
    Failure(
        "The tool moves against the material while it cuts, by more than `movement` in `[cuts]`, or by more than the "
        "tolerance without one.",
        lambda e: check_movement(e.results),
    ),
    Failure("The setpoint exceeds a limit of its axis.", lambda e: check_limits(e.scenario, e.peaks, e.exceeded)),
    Failure("The block raises an alarm, or refuses a command.", lambda e: check_alarms(e.scenario, e.alarms)),
    Failure("The run differs from the scenario's reference.", lambda e: e.reference),
)
NOTES = (
    Note("Orders are left at the end of the run.", _orders),
    Note("The line is faster than the next pieces allow.", _line),
    Note("The block warns of its inputs: `master.input_warning` is not 0.", _input_warnings),
    Note("Marks pass the saw uncut before its first cut.", _uncut),
    Note("Of several pieces that are made in one step only the last one is reported.", _unreported),
    Note("The motor cannot give the force that the axis needs.", lambda e: e.load.beyond_motor if e.load else ()),
    Note("A reaction that is not `required` never happens, or less often than `times`.", _unmet),
    Note("Nothing is checked.", _unchecked),
)
