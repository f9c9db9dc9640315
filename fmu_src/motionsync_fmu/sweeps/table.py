"""The table of a sweep: the rows in its folder, read when they are asked for.

    rows = Rows(Path("out"))
    len(rows), rows.missing
    rows.to_frame(["length", "late"])  # of pyarrow
    rows.dataset  # what pandas, polars, DuckDB and Dask read from, with their own filters

An error about a damaged part file names the file."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

import pyarrow as pa
import pyarrow.dataset as ds

from ..errors import UserError, choose
from .part_files import NAME, damage
from .result_columns import schema
from .sweep_plan import SweepPlan


class Rows:
    """The rows in the folder of a sweep, in the order of the runs: those that were there when this was made.

    Attributes:
        folder: where the plan and the part files are.
        plan: what the sweep does.
    """

    def __init__(self, folder: Path) -> None:
        """Open a folder.

        Raises:
            UserError: it has no plan, or a damaged one.
        """
        self.folder = folder
        self.plan = SweepPlan.read(folder)
        named = filter(None, (NAME.fullmatch(file.name) for file in folder.iterdir()))
        self._files = dict(sorted((int(name[1]), folder / name[0]) for name in named))

    def __repr__(self) -> str:
        """What was run, how many of its rows are there, and the columns."""
        head = f"{self.plan.variation.scenario.label}: {len(self):,} of {self.plan.runs:,} runs in {self.folder}"
        return f"{head}\ncolumns: {', '.join(self.schema.names)}"

    @property
    def files(self) -> list[Path]:
        """The part files, in the order of the runs."""
        return [*self._files.values()]

    @cached_property
    def schema(self) -> pa.Schema:
        """The columns and their types."""
        return schema(self.plan)

    @cached_property
    def dataset(self) -> ds.Dataset:
        """The part files as one table of pyarrow, which reads no more of them than it is asked for."""
        checked = ds.ParquetFragmentScanOptions(page_checksum_verification=True)
        files = [str(file) for file in self.files]
        return ds.dataset(files, self.schema, ds.ParquetFileFormat(default_fragment_scan_options=checked))

    def __len__(self) -> int:
        """The number of rows that are there."""
        return self._row_count

    @cached_property
    def _row_count(self) -> int:
        with self._name_damaged_part():
            return int(self.dataset.count_rows())

    @property
    def missing(self) -> list[range]:
        """The numbers of the runs that have no row yet."""
        runs = self.plan.runs
        chunk = self.plan.chunk or runs  # not settled yet: nothing has run
        parts = [*self._files, -(-runs // chunk)]
        before = [-1, *self._files]
        gaps = zip(before, parts, strict=True)
        return [range((last + 1) * chunk, min(part * chunk, runs)) for last, part in gaps if part > last + 1]

    def __iter__(self) -> Iterator[pa.RecordBatch]:
        return self.batches()

    def batches(self, columns: Sequence[str] | None = None) -> Iterator[pa.RecordBatch]:
        """The rows, some thousand at a time; `columns`: these alone.

        Raises:
            UserError: there is no such column, or a part file is damaged.
        """
        names = self._names_of(columns)
        with self._name_damaged_part():
            yield from self.dataset.to_batches(columns=names)

    def to_frame(self, columns: Sequence[str] | None = None) -> pa.Table:
        """All rows, in memory; `columns`: these alone.

        Raises:
            UserError: there is no such column, or a part file is damaged.
        """
        names = self._names_of(columns)
        with self._name_damaged_part():
            return self.dataset.to_table(columns=names)

    def column(self, name: str) -> pa.ChunkedArray:
        """One column, in memory; `.to_numpy()` makes it an array.

        Raises:
            UserError: there is no such column, or a part file is damaged.
        """
        return self.to_frame([name]).column(0)

    def _names_of(self, columns: Sequence[str] | None) -> list[str]:
        names = {name: name for name in self.schema.names}
        return [choose(names, name, "column") for name in columns] if columns is not None else [*names]

    @contextmanager
    def _name_damaged_part(self) -> Iterator[None]:
        """Name the damaged part file in the error."""
        try:
            yield
        except (OSError, pa.ArrowException):
            for file in self.files:
                if fault := damage(file):
                    text = f"{file} is damaged ({fault}): delete it, and give the sweep's command again"
                    raise UserError(text) from None
            raise
