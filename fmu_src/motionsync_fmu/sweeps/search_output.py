"""The output of a search: its rows on the console, as JSON, as CSV."""

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.table import Table

from ..pages.console import out, print_table
from ..paths import replace_file
from ..scenario.engineering import engineering

if TYPE_CHECKING:
    import pyarrow as pa

SHOWN = 40  # rows on the console; of more the first ones
DIGITS = 9  # of a number there
CSV = "boundaries.csv"


def records(boundaries: "pa.Table") -> list[dict[str, Any]]:
    """The rows, as JSON has them: what is missing is None."""
    return [{name: _number(value) for name, value in row.items()} for row in boundaries.to_pylist()]


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_csv(boundaries: "pa.Table", folder: Path) -> Path:
    """Write the rows to a file of the folder; what is missing is empty.

    Raises:
        OSError: it cannot be written.
    """
    file = folder / CSV
    with replace_file(file) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(boundaries.schema.names)
        writer.writerows(row.values() for row in records(boundaries))
    return file


def print_boundaries(boundaries: "pa.Table") -> None:
    """Print the rows as a table, and how many of which kind there are."""
    names = [
        name
        for name in boundaries.schema.names
        if any(boundaries[name].to_pylist()) or name == boundaries.schema.names[0]
    ]
    table = Table(*names, box=None)
    for row in records(boundaries.slice(0, SHOWN)):
        table.add_row(*(_text(row[name]) for name in names))
    print_table(table)
    for line in _notes(boundaries):
        out.print(line)


def _notes(boundaries: "pa.Table") -> Iterator[str]:
    runs = sum(boundaries["runs"].to_pylist())
    if boundaries.num_rows > SHOWN:
        yield f"... and {boundaries.num_rows - SHOWN:,} rows more"
    yield f"{boundaries.num_rows:,} point{'s' * (boundaries.num_rows != 1)}, {runs:,} runs"


def _text(value: Any) -> str:
    if value is None:
        return ""
    return engineering(value, digits=DIGITS) if isinstance(value, float) else str(value)
