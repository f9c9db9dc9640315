"""What `motionsync line` prints of a line."""

from rich.markup import escape
from rich.table import Table

from motionsync.var import Unit

from ..interface.units import unit_name
from ..pages.console import out, print_checks, print_headline, wide
from ..scenario.engineering import engineering
from .evaluation import VariantErrors
from .line import ProductionLine
from .outcome import LineOutcome


def print_line(line: ProductionLine, outcome: LineOutcome) -> None:
    """Print the checks, errors and files of a line."""
    unit = unit_name(Unit.POSITION, line.unit)
    print_headline(outcome.title, outcome.line, outcome.passed)
    print_checks(outcome.expectations)
    _print_errors("before", outcome.before, unit)
    if outcome.settled is not None:
        _print_errors(f"in sync, from {outcome.settled:.5g} s on", outcome.in_sync, unit)
    files = {"ssp": outcome.ssp, "osp": outcome.osp, "result": outcome.result, "report": outcome.report}
    for name, file in files.items():
        if file:
            out.print(f"  {name}: {escape(file)}")
    out.print()


def _print_errors(title: str, rows: list[VariantErrors], unit: str) -> None:
    """Print a table with a row for each variant; a column that would be empty is left out."""
    columns = {
        "cuts": [f"{f.cuts}" if f.cuts else "" for f in rows],
        "missed": ["" if f.missed is None else f"{f.missed}" for f in rows],
        "worst": [_length(f.worst, unit) for f in rows],
        "mean": [_length(f.mean, unit) for f in rows],
        "spread": [_length(f.spread, unit) for f in rows],
        "worst as recorded": [_length(f.recorded, unit) for f in rows],
        "worst switch": [_length(f.switches, unit) for f in rows],
        "slave, worst": [_length(f.deviation, unit) for f in rows],
        "jump in a step": [_length(f.jump, unit) for f in rows],
        "index, spread": [_length(f.index, "cycles") for f in rows],
    }
    shown = {heading: texts for heading, texts in columns.items() if any(texts)}
    table = Table(f"  {title}", *shown, box=None)
    for i, f in enumerate(rows):
        table.add_row(f"  {f.name}", *(texts[i] for texts in shown.values()))
    wide.print(table)


def _length(value: float | None, unit: str) -> str:
    return "" if value is None else engineering(value, unit, digits=2)
