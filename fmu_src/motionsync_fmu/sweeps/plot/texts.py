"""The texts of a page about a sweep: titles, sentences, figures, and what is left out."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...about import __version__
from ...pages.report.origin import current_time, describe_platform
from ...pages.style import with_unit
from ...scenario.variation.values import is_seed
from ..conditions import RowCondition
from ..database import Column, ColumnKind
from ..sweep_plan import SweepPlan
from .cells import Axis
from .charts import NO_VALUE, OTHER, TEXTS
from .curves import PASSED
from .view import View

SPACE = "\N{NARROW NO-BREAK SPACE}"


def counted(runs: int) -> str:
    """A number of runs: `1 000 000 runs`."""
    return f"{runs:,} run{'' if runs == 1 else 's'}".replace(",", SPACE)


def title(view: View) -> str:
    """The title of the page: what is asked."""
    return f"{view.y.name} over {view.x.column.name}"


def passing(condition: RowCondition | None) -> str:
    """What makes a run pass. `condition`: None: the expectations of its scenario."""
    expected = "all expectations of its scenario are met, and nothing is refused"
    return f"A run passes if {condition.text if condition else expected}."


def run_figures(counts: Mapping[str, int]) -> list[tuple[str, str, str]]:
    """How many runs there are, and how many of them passed: names, values and notes."""
    runs, passed = counts["runs"], counts["passed"]
    refused = f"{counted(counts['refused'])} refused" if counts["refused"] else "none refused"
    return [("runs", f"{runs:,}".replace(",", SPACE), refused), ("passed", _share(passed, runs), counted(passed))]


def figures(view: View) -> list[tuple[str, str, str]]:
    """Names, values and notes: the sweep at a glance."""
    rows = run_figures(view.runs)
    if view.overall:
        x, y = view.x, view.y
        surely = view.overall.points["surely"]
        passing_indices = np.flatnonzero(np.isfinite(surely))
        if len(passing_indices):
            first, last = passing_indices[0], passing_indices[-1]
            middle = x.middle[view.overall.points["cx"].astype(int)]
            value = f"{surely[first]:.5g} to {surely[last]:.5g} {y.unit}".rstrip()
            over = f"{x.column.name} from {middle[first]:.5g} to {middle[last]:.5g} {x.column.unit}".rstrip()
            rows.append((_outermost(view), value, over))
    if view.front is not None:
        rows.append(("Pareto front", counted(view.front_size), _better_results(view)))
    return rows


def _share(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.4g} %"


def _outermost(view: View) -> str:
    """The boundary in words: least length with which all runs pass."""
    which = "least" if view.overall and view.overall.above else "greatest"
    return f"{which} {view.y.name} that passes"


def of_boundary(view: View) -> tuple[str, str, str]:
    """The title of the boundary's chart, what it shows, and what a point of it is."""
    assert view.boundary
    x, y = view.x.column.name, view.y.name
    which, side, other = ("least", "above", "below") if view.boundary.above else ("greatest", "below", "above")
    surely, partly = view.boundary.points["surely"], view.boundary.points["partly"]
    text = f"At each {x}, every run on the line and {side} it passed."
    if np.any(np.abs(partly - surely) > 0.0):
        text += " In the band some passed and others did not;"
        text += f" {other} the band none did."
    else:
        text += f" No run {other} it did."
    if not np.all(np.isfinite(surely)):
        text += f" Where a line has a gap or ends, no {y} of the sweep is enough for every run."
    text += _comparison_note(view)
    return f"The {which} {y} that passes, over {x}{_each(view.groups)}", text, f"{which} {y} from which on all pass "


def of_curves(view: View) -> tuple[str, str, str]:
    """The title of the chart with curves, what it shows, and what a point of it is."""
    assert view.curved
    x = view.x.column.name
    if view.curved.kind is ColumnKind.TRUTH:
        text = f"The line is the share of the runs {_true(view.curved.name)}, 1 being all of them."
    else:
        text = f"The line is the mean of the runs at a {x}; the band is from the least to the greatest of them."
    if view.curved == view.y:
        text += _comparison_note(view)
    return f"{view.curved.name} over {x}{_each(view.curve_groups)}", text, f"{view.curved.name} "


def _comparison_note(view: View) -> str:
    names = " and of ".join(column.name for column, _ in view.lines)
    return f" The broken lines are the means of {names}." if names else ""


def of_map(view: View) -> tuple[str, str]:
    """The title of the map, and what it shows."""
    x, y = view.x.column.name, view.y.name
    statistic = view.statistic
    name = statistic.column.name if statistic.column else ""
    what = {
        "share": f"the share of the runs {_true(name)}",
        "count": "how many runs there are",
        "most": f"the most frequent {name}",
    }.get(statistic.name, f"the {LONG.get(statistic.name, statistic.name)} of {name}")
    text = f"The colour of a cell is {what} in it."
    if view.overall:
        side = "above" if view.overall.above else "below"
        text += f" On the line and {side} it every run passed."
    if view.front is not None:
        which = "run that passed" if view.runs["passed"] else "run"
        text += f" The circles are the Pareto front ({_better_results(view)}):"
        text += f" no {which} is better in one of them and as good in the other."
    heading = what[0].upper() + what[1:]
    return f"{heading}, over {x} and {y}", text


LONG = {"min": "least", "max": "greatest"}


def scale(view: View) -> str:
    """What is written above the scale of colours."""
    statistic = view.statistic
    if statistic.column is None:
        return "runs in a cell"
    if statistic.name == "share":
        return f"share of the runs {_true(statistic.column.name)}"
    return with_unit(f"{LONG.get(statistic.name, statistic.name)} of {statistic.column.name}", statistic.column.unit)


def _true(name: str) -> str:
    """What holds for a run in whose row a column is true."""
    return "that passed" if name == PASSED else f"with {name}"


def map_key(view: View, paint: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names and colours of what the scale does not have."""
    assert view.cells is not None
    listed = list(zip(paint.get("texts", ()), TEXTS, strict=False))
    values = view.cells["value"]
    if view.statistic.name == "most":
        texts = {t for t in values.tolist() if t}
        more = len(texts) - len(listed)
        listed += [(f"{more} other texts", OTHER)] if more else []
        return listed + (
            [(f"no {view.statistic.column.name}", NO_VALUE)]
            if any(not t for t in values.tolist()) and view.statistic.column
            else []
        )
    return [("no run in the cell has a value", NO_VALUE)] if not np.all(np.isfinite(values.astype(float))) else []


def _each(groups: Axis | None) -> str:
    return f", for each {groups.column.name}" if groups else ""


def _better_results(view: View) -> str:
    return ", ".join(
        f"{'less' if view.better[key] == 'min' else 'more'} {name}"
        for key, name in (("x", view.x.column.name), ("y", view.y.name))
    )


def left_out(plan: SweepPlan, view: View) -> list[str]:
    """What the page does not show, and what is put together, a sentence each."""
    return [*missing_runs(plan, view.runs), *_without(view), *_together(view)]


def left_out_of_distribution(plan: SweepPlan, column: Column, counts: Mapping[str, int]) -> list[str]:
    """What a page of one column does not show, and what is put together. `counts`: of the runs, `without` a value."""
    sentences = [*missing_runs(plan, counts)]
    if counts["without"]:
        sentences.append(
            f"{counted(counts['without'])} without a value of {column.name}: they are not in the histogram."
        )
    if others := [factor.name for factor in plan.factors if not is_seed(factor.name) and factor.name != column.name]:
        sample = (
            " C_pk and its interval take them for samples of one process." if column.kind is ColumnKind.LIST else ""
        )
        names = " and ".join(others)
        sentences.append(f"The values of all runs are counted together, whatever their {names} is.{sample}")
    return [*sentences, "A bar shows one of its runs: the one whose value is farthest from the mean."]


def missing_runs(plan: SweepPlan, runs: Mapping[str, int]) -> Iterator[str]:
    """What is not there of a sweep, a sentence each."""
    if plan.version != __version__:
        yield f"The rows are of motionsync {plan.version}, and this is {__version__}: its runs may differ from them."
    if (missing := plan.runs - runs["runs"]) > 0:
        yield f"The sweep is not finished: {counted(missing)} of {counted(plan.runs)} have no row yet."
    if runs["refused"]:
        yield f"{_were(runs['refused'])} refused; a refused run counts as one that did not pass."


def _without(view: View) -> Iterator[str]:
    for key, column in (("no_x", view.x.column), ("no_y", view.y), ("no_value", view.statistic.column)):
        if column and view.runs[key]:
            yield f"{counted(view.runs[key])} without a value of {column.name}: no curve and no mean has them."


def _were(runs: int) -> str:
    return f"{counted(runs)} {'was' if runs == 1 else 'were'}"


def _together(view: View) -> Iterator[str]:
    for axis in (view.x, view.map_y):
        if axis and not axis.single:
            name, cells = axis.column.name, len(axis)
            yield f"The values of {name} are put together to {cells} cells; a point is in the middle of its cell."
    if view.x.column.varied and view.y.varied and not view.boundary:
        which = {0: "No run passed (--passed takes another condition)", view.runs["runs"]: "Every run passed"}
        why = which.get(view.runs["passed"], f"At no {view.x.column.name} does {view.y.name} decide which runs pass")
        yield f"{why}: there is no boundary between those that passed and the others."
    if view.front is not None and (drawn := len(view.front["run"])) < view.front_size:
        yield f"Of the {counted(view.front_size)} of the Pareto front {drawn} are drawn."
    yield "A cell or point shows one of its runs: the one nearest to the value shown, or one that did not pass."


def origin(plan: SweepPlan, scenario: str) -> list[tuple[str, str]]:
    """Where the rows come from, by name."""
    sampled = (
        [("samples", f"{plan.samples} ({plan.method}, seed {plan.seed}, scipy {plan.sampler})")] if plan.samples else []
    )
    return [
        ("scenario", f"{scenario}: {plan.variation.scenario.title}"),
        ("block", plan.variation.scenario.recipe.name),
        ("runs", counted(plan.runs)),
        *sampled,
        ("motionsync", plan.version),
        ("GUID", plan.guid),
        ("page made", f"{current_time()}, {describe_platform()}"),
    ]
