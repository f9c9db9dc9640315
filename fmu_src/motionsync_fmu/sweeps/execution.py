"""Executes a sweep's runs, chunk by chunk, in a worker pool; chunks that are done already are not done again.

It knows little of what a run is: a plan says how many there are, and a function gives the rows of some of them."""

import json
import tomllib
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from hashlib import sha256
from math import ceil
from os import cpu_count
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar
from uuid import uuid4

from ..about import __version__
from ..errors import Interrupted, UserError
from .part_files import Parts, lock_folder
from .worker_pool import FinishedChunk, ThisProcess, WorkerPool, cluster

if TYPE_CHECKING:
    import pyarrow as pa

PLAN = "plan.toml"
SHORTEST, LONGEST = 1.0, 5.0  # s that a chunk takes: overhead is small above, and little is lost with a worker below
CHUNKS_PER_WORKER = 4  # chunks for each worker, at least, if they last long enough
MOST_RUNS_IN_CHUNK = 50_000  # runs: about 100 MB of rows in a worker, before they are written
TRIAL_TIME = 0.3  # s of runs that show how long one takes


class ChunkedPlan(Protocol):
    """What a sweep does, as far as it has to be known here. It is a frozen dataclass, and goes to other computers."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def runs(self) -> int:
        """How many runs there are."""

    @property
    def chunk(self) -> int:
        """How many runs a chunk has; 0: as many as take some seconds."""

    @classmethod
    def read(cls, folder: Path) -> Self:
        """The plan in a folder."""

    def write(self, folder: Path) -> None:
        """Write the plan to a folder, as plan.toml."""

    def differs(self, other: Self) -> str:
        """What this plan has otherwise than the other one; empty if both give the same rows."""


AnyChunkedPlan = TypeVar("AnyChunkedPlan", bound=ChunkedPlan)
Rows = Callable[[Any, int, int], "pa.Table"]  # of a plan, from a run on, up to another


@dataclass(frozen=True)
class SweepTask:
    """What a worker does with a chunk: it makes the rows, and writes the part if it sees the sweep's folder.

    The folder is known by a text that this computer has left in it: another computer may have one of the same name."""

    rows: Rows
    plan: ChunkedPlan
    parts: Parts
    token: str
    version: str = __version__

    def __call__(self, number: int) -> bytes:
        """The contents of the part; empty if it is written.

        Raises:
            UserError: the worker has another version than who gave the task.
        """
        if self.version != __version__:
            raise UserError(f"a worker has motionsync {__version__}, and this computer has {self.version}")
        contents = self.parts.encode(number, self.rows(self.plan, *self.parts.span(number)))
        if not self.parts.has_token(self.token):
            return contents
        self.parts.write(number, contents)
        return b""

    def is_written(self, number: int) -> bool:
        """Whether the part is there."""
        return self.parts.file(number).exists()


def execute(
    plan: AnyChunkedPlan,
    folder: Path,
    rows: Rows,
    *,
    scheduler: str = "",
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, runs: None,
    notify: Callable[[str], None] = lambda line: None,
) -> AnyChunkedPlan:
    """Make the rows of all runs of a plan that are not in the folder yet, and return the plan with its chunks' size.

    `plan`: if its chunk is 0, a trial gives the size of a chunk, or the folder's plan; `folder`: is made if it is
    missing; `rows`: goes to the workers by its name; the others as in `sweep`. One worker is this process.

    Raises:
        UserError: the folder has another plan, a damaged part, no space, or cannot be written; another sweep is at
            work in it; the scheduler does not answer; a worker has another version; chunks were lost.
        Interrupted: the user broke it off. Here, as in all other cases, the rows that are finished are kept.
    """
    if workers is not None and workers < 1:
        raise UserError(f"workers = {workers} is not allowed: it must be >= 1")
    if scheduler and workers is not None:
        raise UserError(f"workers = {workers} is not allowed with a scheduler, which has workers of its own")
    workers = workers or cpu_count() or 1
    with lock_folder(_make_folder(folder)):
        try:
            plan = _set_chunk_size(plan, folder, rows, workers)
            work = _RemainingChunks(Parts(folder.resolve(), _digest(folder), plan.runs, plan.chunk), progress)
        except KeyboardInterrupt:
            raise Interrupted("interrupted before any run was started; the same command starts them") from None
        if work.remaining:
            task = SweepTask(rows, plan, work.parts, uuid4().hex)
            with (
                work.describe_interruption(),
                work.parts.mark_folder(task.token),
                _worker_pool(task, len(work.remaining), scheduler, workers, notify) as pool,
            ):
                work.work_through(pool)
    return plan


class _RemainingChunks:
    """The chunks that are left to do, and how many runs are done.

    Raises:
        UserError: a part that is there is damaged.
    """

    def __init__(self, parts: Parts, progress: Callable[[int, int], None]) -> None:
        self.parts = parts
        self.progress = progress
        done = parts.check_complete()
        self.remaining = deque(sorted(set(range(len(parts))).difference(done)))
        self.runs = parts.size(done)
        progress(self.runs, parts.runs)

    def work_through(self, pool: WorkerPool) -> None:
        """Give the pool all chunks, a few at a time, and write their parts; those that are lost are an error."""
        given, lost = 0, []
        while self.remaining or given:
            while self.remaining and given < pool.capacity:
                pool.give_chunk(self.remaining.popleft())
                given += 1
            if done := pool.try_take_finished():
                given -= 1
                if done.lost:
                    lost.append(done.number)
                else:
                    self._record(done)
        if lost:
            first, last = self.parts.span(min(lost))
            raise UserError(
                f"{len(lost)} of {len(self.parts)} chunks ended every worker that had them, "
                f"the first one with the runs {first} to {last - 1}"
            )
        self.parts.clean()

    def _record(self, done: FinishedChunk) -> None:
        if done.contents:
            self.parts.write(done.number, done.contents)
        self.runs += self.parts.size([done.number])
        self.progress(self.runs, self.parts.runs)

    @contextmanager
    def describe_interruption(self) -> Iterator[None]:
        """Add to whatever ends the work how far it has come, and how to go on."""
        try:
            yield
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted: {self._progress_so_far()}") from None
        except UserError as e:
            raise UserError(f"{e}; {self._progress_so_far()}" if self.runs else str(e)) from None

    def _progress_so_far(self) -> str:
        all_of_them = f"{self.runs:,} of {self.parts.runs:,} runs are in {self.parts.folder}"
        return f"{all_of_them}, and the same command goes on with the rest"


@contextmanager
def _worker_pool(
    task: SweepTask, chunks: int, scheduler: str, workers: int, notify: Callable[[str], None]
) -> Iterator[WorkerPool]:
    """Who works on so many chunks: for one worker this process is enough, without the seconds that others take."""
    workers = min(workers, chunks)
    if workers == 1 and not scheduler:
        yield ThisProcess(task)
        return
    with cluster(task, scheduler, workers, notify) as pool:
        yield pool


def _make_folder(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as e:
        raise UserError(f"{folder} cannot be made: {e.strerror or e}") from None
    return folder


def _set_chunk_size(plan: AnyChunkedPlan, folder: Path, rows: Rows, workers: int) -> AnyChunkedPlan:
    """The plan with the size of its chunks: that of the plan in the folder, or else a measured one, then written."""
    if (folder / PLAN).exists():
        written = type(plan).read(folder)
        if differs := plan.differs(written):
            raise UserError(f"{folder} has another sweep: {differs}; choose another folder")
        if plan.chunk not in (0, written.chunk):
            raise UserError(f"{folder} has chunks of {written.chunk} runs, not {plan.chunk}; choose another folder")
        return replace(plan, chunk=written.chunk)
    if any(folder.glob("part-*.parquet")):
        raise UserError(f"{folder} has parts of a sweep, but no {PLAN}: choose another folder")
    plan = plan if plan.chunk else replace(plan, chunk=_measure_chunk_size(plan, rows, workers))
    plan.write(folder)
    return plan


def _digest(folder: Path) -> str:
    """A hash of the contents of the plan's file."""
    contents = tomllib.loads((folder / PLAN).read_text("utf-8"))
    return sha256(json.dumps(contents, sort_keys=True, default=str).encode()).hexdigest()


def _measure_chunk_size(plan: ChunkedPlan, rows: Rows, workers: int) -> int:
    """How many runs a chunk is to have: they last some seconds. A trial shows how long one run takes."""
    rows(plan, 0, 1)  # it loads and compiles
    number, took = 1, 0.0
    while took < TRIAL_TIME and number < plan.runs:
        number = min(2 * number, plan.runs)
        start = perf_counter()
        rows(plan, 0, number)
        took = perf_counter() - start
    return _chunk_size(took / number, plan.runs, workers)


def _chunk_size(run_time: float, runs: int, workers: int) -> int:
    """How many runs a chunk is to have if one of them lasts `one` (s)."""
    share = ceil(runs / (CHUNKS_PER_WORKER * workers))
    seconds = min(max(share * run_time, SHORTEST), LONGEST)
    return max(1, min(runs, MOST_RUNS_IN_CHUNK, round(seconds / run_time) if run_time else MOST_RUNS_IN_CHUNK))
