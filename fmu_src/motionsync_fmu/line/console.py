"""What `motionsync line` prints of a line."""

from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.console import out, print_checks, print_headline, wide
from ..scenario.amounts import engineering
from .judge import Figures
from .line import Line
from .outcome import LineOutcome


def print_line(line: Line, outcome: LineOutcome, settled: float) -> None:
    """Print the checks, errors and files of a line; `settled`: the time from which on it is in sync, in s."""
    unit = unit_name(Unit.POSITION, line.unit)
    print_headline(outcome.title, outcome.line, outcome.passed)
    print_checks(outcome.expectations)
    if outcome.libcosim_missing:
        out.print(f"  [red]not run in libcosim[/]: {escape(outcome.libcosim_missing)}")
    _print_figures("before", outcome.before, unit)
    _print_figures(f"in sync, from {settled:.5g} s on", outcome.in_sync, unit)
    files = {"ssp": outcome.ssp, "osp": outcome.osp, "result": outcome.result, "report": outcome.report}
    for name, file in files.items():
        if file:
            out.print(f"  {name}: {escape(file)}")
    out.print()


def _print_figures(title: str, rows: list[Figures], unit: str) -> None:
    """Print a table with a row for each variant; a column that would be empty is left out."""
    columns = {
        "cuts": [f"{f.cuts}" if f.cuts else "" for f in rows],
        "missed": ["" if f.missed is None else f"{f.missed}" for f in rows],
        "worst": [_length(f.worst, unit) for f in rows],
        "mean": [_length(f.mean, unit) for f in rows],
        "spread": [_length(f.spread, unit) for f in rows],
        "worst by the books": [_length(f.told, unit) for f in rows],
        "worst switch": [_length(f.switches, unit) for f in rows],
        "slave, worst": [_length(f.away, unit) for f in rows],
        "jump in a step": [_length(f.jump, unit) for f in rows],
        "index, spread": [_length(f.index, "cycles") for f in rows],
    }
    kept = {heading: texts for heading, texts in columns.items() if any(texts)}
    table = Table(f"  {title}", *kept, box=None)
    for i, f in enumerate(rows):
        table.add_row(f"  {f.name}", *(texts[i] for texts in kept.values()))
    wide.print(table)


def _length(value: float | None, unit: str) -> str:
    return "" if value is None else engineering(value, unit, digits=2)
