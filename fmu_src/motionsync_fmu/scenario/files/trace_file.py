"""A recorded line: the file that the table [master] of a scenario names, CSV or Parquet with time and position."""

import csv
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NoReturn

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
    "rise. The table has no other key then.",
    (text(KEY, "the file", value="path from the folder of the scenario"),),
)
COLUMNS = ("time", "position")
SEPARATORS = ",;\t"
MOST = 1e12  # u, as of the block's inputs
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
        times, positions = _read_rows(file, status.st_mtime_ns, status.st_size)
    except OSError as error:
        table.fail(KEY, f"{name!r} cannot be read: {error.strerror}")
    if (span := times[-1] - times[0]) < stop_time * (1.0 - ROUNDING):
        table.fail(KEY, f"{name} has {span:g} s, and stop_time = {stop_time:g} is later")
    return Trace(times, positions, period)


@lru_cache(maxsize=8)
def _read_rows(file: Path, _changed: int, _size: int) -> tuple[Reals, Reals]:
    """Times and positions in a file, each of shape (rows,); they cannot be changed. A sweep reads the file once."""
    rows = _parquet_rows(file) if file.suffix == ".parquet" else _csv_rows(file)
    times: list[float] = []
    positions: list[float] = []
    for place, time, position in rows:
        for name, value in zip(COLUMNS, (time, position), strict=True):
            if not math.isfinite(value):
                _fail(place, f"{name} = {value} is not allowed: it must be finite")
        if abs(position) > MOST:
            _fail(place, f"position = {position:g} is not allowed: it must be {-MOST:g} to {MOST:g}")
        if times and time <= times[-1]:
            _fail(
                place, f"time = {time:.10g} is not allowed: it must be > {times[-1]:.10g}, the time of the row before"
            )
        times.append(time)
        positions.append(position)
    if len(times) < 2:
        raise UserError(f"{file}: a recorded line has at least two rows, not {len(times)}")
    result = np.array(times), np.array(positions)
    for column in result:
        column.setflags(write=False)
    return result


def _csv_rows(file: Path) -> Iterator[tuple[str, float, float]]:
    """The rows of a CSV file, each with its place. The first line may have the names of the columns."""
    try:
        lines = file.read_text("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise UserError(f"{file}: not a text in UTF-8") from None
    separator = max(SEPARATORS, key=lines[0].count) if lines else ","
    columns: tuple[int, int] | None = None
    for number, line in enumerate(lines, 1):
        place, cells = f"{file}:{number}", next(csv.reader([line], delimiter=separator), [])
        if not any(cell.strip() for cell in cells):
            continue
        if columns is None:
            has_names = _number(cells[0]) is None
            columns = _find_columns([cell.strip() for cell in cells] if has_names else [""] * len(cells), place)
            if has_names:
                continue
        texts = [cells[i] if i < len(cells) else "" for i in columns]
        time, position = map(_number, texts)
        if time is None or position is None:
            wrong = 0 if time is None else 1
            _fail(place, f"{COLUMNS[wrong]}: {texts[wrong].strip()!r} is not a number")
        yield place, time, position


def _parquet_rows(file: Path) -> Iterator[tuple[str, float, float]]:
    """The rows of a Parquet file, each with its place."""
    require("sweep", "pyarrow")
    import pyarrow as pa  # noqa: PLC0415 (part of an extra)
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        with pq.ParquetFile(file) as parquet:
            columns = _find_columns(parquet.schema_arrow.names, str(file))
            table = parquet.read()
        pair = [table.column(i).cast(pa.float64()).to_pylist() for i in columns]
    except pa.ArrowException as error:
        raise UserError(f"{file}: not a Parquet file of numbers: {error}") from None
    for number, values in enumerate(zip(*pair, strict=True), 1):
        time, position = (math.nan if value is None else value for value in values)
        yield f"{file}: row {number}", time, position


def _find_columns(names: Sequence[str], place: str) -> tuple[int, int]:
    """Where time and position are: by their names, or in a file with two columns by their places."""
    if all(name in names for name in COLUMNS):
        return names.index(COLUMNS[0]), names.index(COLUMNS[1])
    if len(names) != 2:
        there = f"the columns {', '.join(names)}" if any(names) else f"{len(names)} columns without names"
        _fail(place, f"there must be the columns time and position, not {there}")
    return 0, 1


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _fail(place: str, message: str) -> NoReturn:
    raise UserError(f"{place}: {message}")
