"""A recorded line: the file that the table [master] of a scenario names, CSV or Parquet with time and position.

NumPy and pyarrow read whole columns. Where they refuse a CSV file, or a value is not allowed, the file is read line by
line, which finds the place of the mistake, and reads what NumPy does not."""

import csv
import math
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path
from stat import S_ISREG
from typing import NoReturn, TextIO
from warnings import catch_warnings, simplefilter

import numpy as np

from ...errors import UserError
from ...optional_dependencies import require
from ..recording import Reals
from ..trace import Trace
from .keys import TableKeys, text
from .toml_tables import TomlTable

KEY = "file"
RECORDED = TableKeys(
    "[master], a recorded line",
    "Positions that an encoder has given: a CSV or Parquet file with the columns time, in s, and position. The times "
    "rise. In a CSV file with semicolons between its cells a comma may be the decimal sign. The table has no other key "
    "then.",
    (text(KEY, "the file", value="path from the folder of the scenario"),),
)
COLUMNS = ("time", "position")
MOST = 1e12  # s and u, as of the block's inputs
SHORTEST = 1e-9  # s, between two rows: less is rounding
ROUNDING = 1e-12  # of the stop time: the times of the rows may be rounded


def read_trace(table: TomlTable, period: float, stop_time: float) -> Trace:
    """The line in the file that a table [master] names, relative to the folder of the scenario.

    `period`: the master's, u; `stop_time`: of the scenario, s.

    Raises:
        UserError: the first mistake in the table or in the file, with its line.
    """
    for key in table.values:
        if key != KEY:
            table.fail(key, "a line that is recorded in a file has nothing else")
    name = RECORDED.value(table, KEY)
    file = table.file.parent / name
    try:
        status = file.stat()
        if not S_ISREG(status.st_mode):
            table.fail(KEY, f"{name!r} cannot be read: it is no file")
        times, positions = _read_columns(file, status.st_mtime_ns, status.st_size)
    except OSError as error:
        table.fail(KEY, f"{name!r} cannot be read: {error.strerror or error}")
    except ValueError as error:  # a name with a NUL
        table.fail(KEY, f"{name!r} cannot be read: {error}")
    if (span := times[-1] - times[0]) < stop_time * (1.0 - ROUNDING):
        table.fail(KEY, f"{name} has {span:g} s, and stop_time = {stop_time:g} is later")
    return Trace(times, positions, period)


@lru_cache(maxsize=8)
def _read_columns(file: Path, _changed: int, _size: int) -> tuple[Reals, Reals]:
    """Times and positions in a file, each of shape (rows,); they cannot be changed. A sweep reads the file once."""
    if file.suffix == ".parquet":
        times, positions = _read_parquet(file)
        _check(times, positions, lambda row: f"{file}: row {row + 1}")
    else:
        times, positions = _read_csv(file)
    if len(times) < 2:
        raise UserError(f"{file}: a recorded line has at least two rows, not {len(times)}")
    for column in (times, positions):
        column.setflags(write=False)
    return times, positions


def _check(times: Reals, positions: Reals, place: Callable[[int], str]) -> None:
    """Refuse the first value that is not allowed; `place`: of a row, from 0, for the message."""
    with np.errstate(over="ignore", invalid="ignore"):  # of times that are not allowed
        rises = np.diff(times, prepend=-math.inf) >= SHORTEST  # NaN is not
    allowed = rises & (np.abs(times) <= MOST) & (np.abs(positions) <= MOST)
    if allowed.all():
        return
    row = int(np.argmin(allowed))
    for name, value in zip(COLUMNS, (times[row], positions[row]), strict=True):
        if not math.isfinite(value):
            _fail(place(row), f"{name} = {value} is not allowed: it must be finite")
        if abs(value) > MOST:
            _fail(place(row), f"{name} = {value:g} is not allowed: it must be {-MOST:g} to {MOST:g}")
    time, before = times[row], times[row - 1]
    more = f" + {SHORTEST:g}" if time > before else ""
    _fail(
        place(row), f"time = {time:.10g} is not allowed: it must be > {before:.10g}{more}, the time of the row before"
    )


@dataclass(frozen=True)
class _Layout:
    """How a CSV file is written.

    Attributes:
        skipped: how many lines are before the first row.
        separator: of the cells.
        width: how many cells the first line has.
        columns: where time and position are.
        has_comma: whether a comma is the decimal sign.
    """

    skipped: int
    separator: str
    width: int
    columns: tuple[int, int]
    has_comma: bool

    def line(self, line: str) -> str:
        """A line with points as decimal signs; a point of another meaning becomes no number."""
        return line.translate(COMMAS) if self.has_comma else line

    def number(self, cell: str) -> float | None:
        """The number in a cell; None: it is none."""
        try:
            return float(self.line(cell))
        except ValueError:
            return None


COMMAS = str.maketrans(",.", ".?")


def _read_csv(file: Path) -> tuple[Reals, Reals]:
    """Times and positions in a CSV file. The first line may have the names of the columns."""
    try:
        with file.open(encoding="utf-8-sig") as lines:
            layout = _find_layout(file, lines)
        if not layout:
            return np.empty(0), np.empty(0)
        try:
            columns = _with_numpy(file, layout)
            _check(*columns, lambda row: f"row {row}")
            return columns
        except (ValueError, UserError):
            return _line_by_line(file, layout)
    except UnicodeDecodeError:
        raise UserError(f"{file}: not a text in UTF-8") from None


def _find_layout(file: Path, lines: TextIO) -> _Layout | None:
    """How a file is written; None: it has no line but empty ones."""
    numbered = ((number, line) for number, line in enumerate(lines) if line.strip())
    number, first = next(numbered, (0, ""))
    if not first:
        return None
    separator = next((sign for sign in "\t;" if sign in first), ",")
    place = f"{file}:{number + 1}"
    cells = _cells(first, separator, place)
    may_have_comma = separator == ";"
    has_names = _Layout(0, separator, 0, (0, 1), may_have_comma and "," in cells[0]).number(cells[0]) is None
    columns = _find_columns([cell.strip() for cell in cells] if has_names else [""] * len(cells), place)
    rows = (_cells(line, separator, place) for _, line in numbered if "," in line) if may_have_comma else iter(())
    has_comma = any("," in cell for cells in rows for cell in _pair(cells, columns))
    has_comma |= may_have_comma and not has_names and any("," in cell for cell in _pair(cells, columns))
    return _Layout(number + has_names, separator, len(cells), columns, has_comma)


def _with_numpy(file: Path, layout: _Layout) -> tuple[Reals, Reals]:
    """Times and positions, as NumPy reads them.

    Raises:
        ValueError: it does not, or a row is not as wide as the first line.
    """
    with file.open(encoding="utf-8-sig") as lines, catch_warnings():
        simplefilter("ignore")  # there may be no row
        rows = _as_wide(islice(lines, layout.skipped, None), layout)
        columns = np.loadtxt(
            map(layout.line, rows) if layout.has_comma else rows,
            delimiter=layout.separator,
            usecols=layout.columns,
            comments=None,
            quotechar='"',
            ndmin=2,
        )
    times, positions = columns.T.copy()
    return times, positions


def _as_wide(lines: Iterable[str], layout: _Layout) -> Iterator[str]:
    """The lines, as long as each has as many cells as the first one; NumPy would not notice.

    Raises:
        ValueError: a line has not.
    """
    for line in lines:
        if line.count(layout.separator) != layout.width - 1 and line.strip():
            raise ValueError(line)
        yield line


def _line_by_line(file: Path, layout: _Layout) -> tuple[Reals, Reals]:
    """Times and positions.

    Raises:
        UserError: the first mistake, with its line.
    """
    columns, numbers = (array("d"), array("d")), array("q")
    with file.open(encoding="utf-8-sig") as lines:
        for number, line in islice(enumerate(lines, 1), layout.skipped, None):
            place = f"{file}:{number}"
            cells = _cells(line, layout.separator, place)
            if not any(cell.strip() for cell in cells):
                continue
            if any(cell.strip() for cell in cells[layout.width :]):
                hint = "; with a comma as the decimal sign there are semicolons between the cells"
                more = hint if layout.separator == "," else ""
                _fail(place, f"{len(cells)} cells, where the first line has {layout.width}{more}")
            for name, column, cell in zip(COLUMNS, columns, _pair(cells, layout.columns), strict=True):
                value = layout.number(cell)
                if value is None:
                    hint = "; a comma is the decimal sign in this file" if layout.has_comma and "." in cell else ""
                    _fail(place, f"{name}: {cell.strip()!r} is not a number{hint}")
                column.append(value)
            numbers.append(number)
    times, positions = map(np.array, columns)
    _check(times, positions, lambda row: f"{file}:{numbers[row]}")
    return times, positions


def _cells(line: str, separator: str, place: str) -> list[str]:
    try:
        return next(csv.reader([line.rstrip("\n")], delimiter=separator), [])
    except csv.Error as error:  # a cell that is too long
        _fail(place, str(error))


def _pair(cells: Sequence[str], columns: tuple[int, int]) -> Iterator[str]:
    """Time and position in a line."""
    return (cells[i] if i < len(cells) else "" for i in columns)


def _read_parquet(file: Path) -> tuple[Reals, Reals]:
    """Times and positions in a Parquet file; a missing value is NaN."""
    require("sweep", "pyarrow")
    import pyarrow as pa  # noqa: PLC0415 (part of an extra)
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        with pq.ParquetFile(file) as parquet:
            names = parquet.schema_arrow.names
            columns = _find_columns(names, str(file))
            table = parquet.read(columns=[names[i] for i in columns])
        times, positions = (np.array(table[names[i]].cast(pa.float64()).to_numpy()) for i in columns)
        return times, positions
    except (pa.ArrowException, OSError) as error:
        raise UserError(f"{file}: not a Parquet file of numbers: {error}") from None


def _find_columns(names: Sequence[str], place: str) -> tuple[int, int]:
    """Where time and position are: by their names, or in a file with two columns by their places."""
    if doubled := [name for name in names if name and names.count(name) > 1]:
        _fail(place, f"there are several columns {doubled[0]!r}")
    if all(name in names for name in COLUMNS):
        return names.index(COLUMNS[0]), names.index(COLUMNS[1])
    if len(names) != 2:
        there = f"the columns {', '.join(names)}" if any(names) else f"{len(names)} columns without names"
        _fail(place, f"there must be the columns time and position, not {there}")
    return 0, 1


def _fail(place: str, message: str) -> NoReturn:
    raise UserError(f"{place}: {message}")
