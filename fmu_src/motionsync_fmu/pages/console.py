"""What the command line prints: the consoles, a block's variables, and the outcome of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.table import groups
from ..interface.units import unit_name
from ..interface.variables import members, summary, variables

if TYPE_CHECKING:  # they load NumPy, which `motionsync list` does not need
    from ..scenario.cuts import Cut
    from ..scenario.judge import Check
    from ..scenario.outcome import Outcome
    from ..scenario.scenario import Scenario

out = Console(highlight=False, soft_wrap=True)
wide = Console(highlight=False, markup=False, width=1000)  # for tables: the terminal wraps long lines
err = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)


def print_variables(
    block: Any, unit: str, slave_unit: str, starts: Mapping[str, str], turned: Mapping[str, str]
) -> None:
    """Print a block's variables, and its enumerations with their members.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`);
    `starts`: start values in place of the block's, as texts by name; `turned`: as for `interface.variables.variables`.
    """
    columns = ("name", "causality", "type", "unit", "start", "allowed_range", "description")
    table = Table(*(column.removeprefix("allowed_") for column in columns), box=None)
    table.columns[0].no_wrap = True
    for i, group in enumerate(groups(block, unit, slave_unit, turned)):
        if i:
            table.add_row()
        for row in group.rows:
            shown = replace(row, start=starts.get(row.name, row.start))
            table.add_row(*(getattr(shown, column) for column in columns))
    wide.print(table)
    for enumeration in dict.fromkeys(v.cell.type for v in variables(block) if v.choices):
        out.print(f"\n{enumeration.__name__}: {summary(enumeration)}")
        for member in members(enumeration):
            out.print(f"  {member.value:3d} {member.name}: {member.description}")


def print_outcome(scenario: "Scenario", outcome: "Outcome") -> None:
    """Print title, expectations, reference, cuts, messages, and where everything is written."""
    print_headline(outcome.title, outcome.scenario, outcome.passed)
    print_checks(outcome.expectations)
    for d in outcome.reference:
        out.print(
            f"  {_verdict(d.passed)}  {d.name}: max |difference| "
            f"{d.greatest:.2g} from the reference, {d.allowed:.2g} allowed"
        )
    if scenario.cuts:
        out.print(f"  {_cuts(outcome.cuts, unit_name(Unit.POSITION, scenario.unit))}")
    for message in outcome.messages:
        out.print(f"  the FMU logged: {escape(message)}")
    out.print(f"  result: {escape(outcome.result)}")
    if outcome.report:
        out.print(f"  report: {escape(outcome.report)}")
    out.print(f"  the same with FMPy alone: {escape(outcome.fmpy)}\n")


def print_headline(title: str, source: str, passed: bool) -> None:
    """Print what was run, from which file or folder, and whether all of it is as expected."""
    mark = "[green]as expected[/]" if passed else "[red]NOT as expected[/]"
    out.print(f"[bold]{escape(title)}[/] ({escape(source)}): {mark}")


def print_checks(checks: "Iterable[Check]") -> None:
    """Print a line for each expectation."""
    for c in checks:
        out.print(f"  {_verdict(c.passed)}  {escape(c.expected)}: found {c.found}")


def _verdict(passed: bool) -> str:
    return "kept  " if passed else "[red]broken[/]"


def _cuts(cuts: "list[Cut]", unit: str) -> str:
    """How many cuts there were, and how far the worst one is from its mark."""
    if not cuts:
        return "cuts: none"
    number, worst = max(enumerate(cuts, 1), key=lambda numbered: abs(numbered[1].error))
    error, mark = f"{abs(worst.error):.2g} {unit}".strip(), f"{worst.mark:.10g} {unit}".strip()
    return f"cuts: {len(cuts)}, the worst {error} from its mark: cut {number}, mark {mark}"
