"""The part files of a sweep: the rows of each chunk of runs in a Parquet file of its own, beside the sweep's plan.

A part has the number of its chunk in its name. It is written under a temporary name in the same folder and then
renamed, so a file with the name of a part is a whole one. What happens to it later is found out: its pages have
checksums, and it says of which plan it is."""

import os
import re
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

from ..errors import UserError

if TYPE_CHECKING:
    import pyarrow as pa

NAME = re.compile(r"part-(\d{6,})\.parquet")
UNFINISHED = "part-*.tmp"
TOKEN = ".token"
OF_PLAN = b"motionsync.plan"  # the key of the plan's hash in the metadata of a part


@dataclass(frozen=True)
class Parts:
    """The parts of one sweep.

    Attributes:
        folder: where they lie; absolute, since other computers may look for it.
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

    def encoded(self, number: int, table: "pa.Table") -> bytes:
        """The contents of a part's file, from its rows."""
        import pyarrow as pa  # noqa: PLC0415 (part of an extra)
        import pyarrow.parquet as pq  # noqa: PLC0415

        first, last = self.span(number)
        assert table.num_rows == last - first, f"{table.num_rows} rows of the runs {first} to {last - 1}"
        said = {**(table.schema.metadata or {}), OF_PLAN: self.plan.encode()}
        sink = pa.BufferOutputStream()
        pq.write_table(table.replace_schema_metadata(said), sink, compression="zstd", write_page_checksum=True)
        return bytes(sink.getvalue())

    def write(self, number: int, contents: bytes) -> None:
        """Write a part's file; it is there as a whole, or not at all.

        Raises:
            UserError: it cannot be written.
        """
        file = self.file(number)
        unfinished = file.with_name(f"{file.name}.{uuid4().hex}.tmp")
        try:
            with unfinished.open("xb") as stream:
                stream.write(contents)
                stream.flush()
                os.fsync(stream.fileno())  # a disk across a network may only now tell that it is full
            unfinished.replace(file)
        except OSError as e:
            with suppress(OSError):
                unfinished.unlink()
            raise UserError(f"{file} cannot be written: {e.strerror or e}") from None

    def complete(self) -> list[int]:
        """The numbers of the parts that are there, in order; all of them are read.

        Raises:
            UserError: one of them is damaged, or of another plan; the message says what to do.
        """
        numbers = sorted(self._named())
        with ThreadPoolExecutor() as readers:
            for number, fault in zip(numbers, readers.map(self._fault, numbers), strict=True):
                if fault:
                    raise UserError(f"{self.file(number)} {fault}: delete this file, and give the same command again")
        return numbers

    def _named(self) -> Iterator[int]:
        for entry in self.folder.iterdir():
            if (match := NAME.fullmatch(entry.name)) and self.file(int(match[1])) == entry:
                yield int(match[1])

    def _fault(self, number: int) -> str:
        """What is wrong with a part, as the end of a sentence; empty if nothing is."""
        import pyarrow.parquet as pq  # noqa: PLC0415

        file = self.file(number)
        first, last = self.span(number)
        if number >= len(self):
            return f"is none of the sweep's {len(self)} parts"
        if text := damage(file):
            return f"is damaged ({text})"
        part = pq.read_metadata(file)
        if (part.metadata or {}).get(OF_PLAN, b"") != self.plan.encode():
            return "belongs to another sweep"
        return "" if part.num_rows == last - first else f"is damaged ({part.num_rows} of {last - first} rows)"

    def clean(self) -> None:
        """Remove what was never finished, by a worker that was killed."""
        for file in self.folder.glob(UNFINISHED):
            with suppress(OSError):
                file.unlink()

    @contextmanager
    def marked(self, token: str) -> Iterator[None]:
        """Leave a text in the folder for a while, so that whoever reads it there knows that this is the folder.

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

    def holds(self, token: str) -> bool:
        """Whether the folder of this name, as this computer sees it, is the one in which the text was left."""
        try:
            return (self.folder / TOKEN).read_text("utf-8") == token
        except (OSError, UnicodeDecodeError):
            return False


def damage(file: Path) -> str:
    """What pyarrow says of a Parquet file that is damaged; empty if all of it can be read."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    try:
        with pq.ParquetFile(file, page_checksum_verification=True) as part:
            for _ in part.iter_batches():
                pass
    except (OSError, pa.ArrowException) as e:
        return str(e).partition(". ")[0].strip() or type(e).__name__
    return ""
