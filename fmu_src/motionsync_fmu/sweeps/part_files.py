"""The part files of a sweep: the rows of each chunk of runs in a Parquet file of its own, beside the sweep's plan.

A part has the number of its chunk in its name. It is written under a temporary name in the same folder and then
renamed, so a file with the name of a part is a whole one. What happens to it later is found out: its pages have
checksums, it has the hash of its plan, and its first column has the numbers of its runs."""

import re
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError
from ..paths import PART, replace_file

if TYPE_CHECKING:
    import pyarrow as pa

NAME = re.compile(r"part-(\d{6,})\.parquet")
UNFINISHED = f"part-*{PART}"
TOKEN = ".token"
LOCK = ".lock"
OF_PLAN = b"motionsync.plan"  # the key of the plan's hash in the metadata of a part


@dataclass(frozen=True)
class Parts:
    """The parts of one sweep.

    Attributes:
        folder: where they are; absolute, since other computers may look for it.
        plan: the hash of the sweep's plan.
        runs: how many runs the sweep has.
        chunk: how many runs a part has; the last one may have fewer.
    """

    folder: Path
    plan: str
    runs: int
    chunk: int

    def __len__(self) -> int:
        """The number of parts that the whole sweep has."""
        return ceil(self.runs / self.chunk)

    def span(self, number: int) -> tuple[int, int]:
        """The first run of a part, and the one after its last."""
        return number * self.chunk, min((number + 1) * self.chunk, self.runs)

    def size(self, numbers: Iterable[int]) -> int:
        """How many runs these parts have together."""
        return sum(last - first for first, last in map(self.span, numbers))

    def file(self, number: int) -> Path:
        """The file of a part."""
        return self.folder / f"part-{number:06}.parquet"

    def encode(self, number: int, table: "pa.Table") -> bytes:
        """The contents of a part's file, from its rows."""
        import pyarrow as pa  # noqa: PLC0415 (part of an extra)
        import pyarrow.parquet as pq  # noqa: PLC0415

        first, last = self.span(number)
        assert table.num_rows == last - first, f"{table.num_rows} rows of the runs {first} to {last - 1}"
        metadata = {**(table.schema.metadata or {}), OF_PLAN: self.plan.encode()}
        sink = pa.BufferOutputStream()
        pq.write_table(table.replace_schema_metadata(metadata), sink, compression="zstd", write_page_checksum=True)
        return bytes(sink.getvalue())

    def write(self, number: int, contents: bytes) -> None:
        """Write a part's file; it is there as a whole, or not at all.

        Raises:
            UserError: it cannot be written.
        """
        file = self.file(number)
        try:
            with replace_file(file) as part:
                part.write_bytes(contents)
        except OSError as e:
            raise UserError(f"{file} cannot be written: {e.strerror or e}") from None

    def check_complete(self) -> list[int]:
        """The numbers of the parts that are there, in order; all of them are read.

        Raises:
            UserError: one of them is damaged, or of another plan; the message has what to do.
        """
        numbers = sorted(self._numbers())
        with ThreadPoolExecutor() as readers:
            for number, fault in zip(numbers, readers.map(self._fault, numbers), strict=True):
                if fault:
                    raise UserError(f"{self.file(number)} {fault}: delete this file, and give the same command again")
        return numbers

    def _numbers(self) -> Iterator[int]:
        for entry in self.folder.iterdir():
            if (match := NAME.fullmatch(entry.name)) and self.file(int(match[1])) == entry:
                yield int(match[1])

    def _fault(self, number: int) -> str:
        """What is wrong with a part, as the end of a sentence; empty if nothing is."""
        import pyarrow as pa  # noqa: PLC0415

        file = self.file(number)
        first, last = self.span(number)
        if number >= len(self):
            return f"is none of the sweep's {len(self)} parts"
        try:
            plan, runs = _read(file)
        except (OSError, pa.ArrowException) as error:
            return f"is damaged ({_reason(error)})"
        if plan != self.plan:
            return "belongs to another sweep"
        if len(runs) != last - first:
            return f"is damaged ({len(runs)} of {last - first} rows)"
        return "" if runs == list(range(first, last)) else f"is damaged (its runs are not {first} to {last - 1})"

    def clean(self) -> None:
        """Remove what was never finished, by a worker that was killed."""
        for file in self.folder.glob(UNFINISHED):
            with suppress(OSError):
                file.unlink()

    @contextmanager
    def mark_folder(self, token: str) -> Iterator[None]:
        """Write a token into the folder for a while: a worker that reads it there sees the same folder.

        Raises:
            UserError: the folder cannot be written.
        """
        file = self.folder / TOKEN
        try:
            file.write_text(token, "utf-8")
        except OSError as e:
            raise UserError(f"{self.folder} cannot be written: {e.strerror or e}") from None
        try:
            yield
        finally:
            with suppress(OSError):
                file.unlink()

    def has_token(self, token: str) -> bool:
        """Whether the folder of this name, as this computer sees it, is the one in which the text was left."""
        try:
            return (self.folder / TOKEN).read_text("utf-8") == token
        except (OSError, UnicodeDecodeError):
            return False


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keep other sweeps out of a folder. The system frees the lock of a process that ends, however it does.

    Raises:
        UserError: another sweep is at work in the folder, or it cannot be written.
    """
    from filelock import FileLock, Timeout  # noqa: PLC0415 (part of an extra)

    lock = FileLock(folder / LOCK)
    try:
        lock.acquire(timeout=0.0)
    except Timeout:
        raise UserError(f"{folder}: another sweep is at work in this folder; wait for it, or choose another") from None
    except OSError as e:
        raise UserError(f"{folder} cannot be written: {e.strerror or e}") from None
    try:
        yield
    finally:
        lock.release()


def damage(file: Path) -> str:
    """Why pyarrow cannot read a Parquet file; empty if it can."""
    import pyarrow as pa  # noqa: PLC0415

    try:
        _read(file)
    except (OSError, pa.ArrowException) as error:
        return _reason(error)
    return ""


def _read(file: Path) -> tuple[str, list[int]]:
    """The hash of a part's plan and the numbers of its runs; every page of the file is read."""
    import pyarrow.parquet as pq  # noqa: PLC0415

    with pq.ParquetFile(file, page_checksum_verification=True) as part:
        plan = (part.metadata.metadata or {}).get(OF_PLAN, b"").decode()
        return plan, [run for batch in part.iter_batches() for run in batch.column(0).to_pylist()]


def _reason(error: Exception) -> str:
    return str(error).partition(". ")[0].strip() or type(error).__name__
