"""A sweep's runs, chunk by chunk, on whoever is there to work; what was done before is not done again.

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

from .. import __version__
from ..errors import Interrupted, UserError
from .crew import Alone, Crew, Done, cluster
from .parts import Parts

if TYPE_CHECKING:
    import pyarrow as pa

PLAN = "plan.toml"
LEAST, MOST = 1.0, 5.0  # s that a chunk takes: overhead is small above, and little is lost with a worker below
SHARES = 4  # chunks for each worker, at least, if they last long enough
LARGEST = 50_000  # runs: about 100 MB of rows in a worker, before they are written
TRIAL = 0.3  # s of runs that tell how long one takes


class Plan(Protocol):
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


AnyPlan = TypeVar("AnyPlan", bound=Plan)
Rows = Callable[[Any, int, int], "pa.Table"]  # of a plan, from a run on, up to another


@dataclass(frozen=True)
class Task:
    """What a worker does with a chunk: it makes the rows, and writes the part if it sees the sweep's folder.

    The folder is known by a text that this computer has left in it: another computer may have one of the same name."""

    rows: Rows
    plan: Plan
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
        contents = self.parts.encoded(number, self.rows(self.plan, *self.parts.span(number)))
        if not self.parts.holds(self.token):
            return contents
        self.parts.write(number, contents)
        return b""

    def is_written(self, number: int) -> bool:
        """Whether the part is there."""
        return self.parts.file(number).exists()


def go(
    plan: AnyPlan,
    folder: Path,
    rows: Rows,
    *,
    scheduler: str = "",
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda done, runs: None,
    tell: Callable[[str], None] = lambda line: None,
) -> AnyPlan:
    """Make the rows of all runs of a plan that are not in the folder yet.

    Args:
        plan: what to do. If its chunk is 0, the size of a chunk is found by a trial, or is that of the folder's plan.
        folder: where plan and parts lie; it is made if it is missing.
        rows: gives the rows of runs; it goes to the workers by its name.
        scheduler: the address of a Dask scheduler.
        workers: without a scheduler, how many processes of this computer work; by default one for each core. What one
            worker can do, this process does.
        progress: called with the number of runs that are done, and of all.
        tell: called with a line about what the user may want to know meanwhile.

    Returns:
        The plan, with the size of its chunks.

    Raises:
        UserError: the folder has another plan, a damaged part, no space, or cannot be written; the scheduler does not
            answer; a worker has another version; chunks were lost.
        Interrupted: the user broke it off. Here, as in all other cases, the rows that are finished are kept.
    """
    if workers is not None and workers < 1:
        raise UserError(f"workers = {workers} is not allowed: it must be >= 1")
    if scheduler and workers is not None:
        raise UserError(f"workers = {workers} is not allowed with a scheduler, which has workers of its own")
    workers = workers or cpu_count() or 1
    try:
        plan = _settled(plan, _made(folder), rows, workers)
        work = _Work(Parts(folder.resolve(), _digest(folder), plan.runs, plan.chunk), progress)
    except KeyboardInterrupt:
        raise Interrupted("interrupted before the first run") from None
    task = Task(rows, plan, work.parts, uuid4().hex)
    with work.told(), work.parts.marked(task.token), _crew(task, len(work.waiting), scheduler, workers, tell) as crew:
        work.go_on(crew)
    return plan


class _Work:
    """The chunks that are left to do, and how many runs are done.

    Raises:
        UserError: a part that is there is damaged.
    """

    def __init__(self, parts: Parts, progress: Callable[[int, int], None]) -> None:
        self.parts = parts
        self.progress = progress
        done = parts.complete()
        self.waiting = deque(sorted(set(range(len(parts))).difference(done)))
        self.runs = parts.size(done)
        progress(self.runs, parts.runs)

    def go_on(self, crew: Crew) -> None:
        """Give the crew all chunks, a few at a time, and see that their parts are written.

        Raises:
            UserError: chunks are lost, all others being done; or the crew or the folder cannot go on.
        """
        given, lost = 0, []
        while self.waiting or given:
            while self.waiting and given < crew.places:
                crew.begin(self.waiting.popleft())
                given += 1
            if done := crew.try_next():
                given -= 1
                if done.lost:
                    lost.append(done.number)
                else:
                    self._take(done)
        if lost:
            first, last = self.parts.span(min(lost))
            raise UserError(
                f"{len(lost)} of {len(self.parts)} chunks ended every worker that had them, "
                f"the first one with the runs {first} to {last - 1}"
            )
        self.parts.clean()

    def _take(self, done: Done) -> None:
        if done.contents:
            self.parts.write(done.number, done.contents)
        self.runs += self.parts.size([done.number])
        self.progress(self.runs, self.parts.runs)

    @contextmanager
    def told(self) -> Iterator[None]:
        """Add to whatever ends the work how far it has come, and how to go on."""
        try:
            yield
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted: {self._kept()}") from None
        except UserError as e:
            raise UserError(f"{e}; {self._kept()}" if self.runs else str(e)) from None

    def _kept(self) -> str:
        all_of_them = f"{self.runs:,} of {self.parts.runs:,} runs are in {self.parts.folder}"
        return f"{all_of_them}, and the same command goes on with the rest"


@contextmanager
def _crew(task: Task, chunks: int, scheduler: str, workers: int, tell: Callable[[str], None]) -> Iterator[Crew]:
    """Who works on so many chunks: for one worker this process is enough, without the seconds that others take."""
    workers = min(workers, chunks)
    if workers <= 1 and not scheduler:
        yield Alone(task)
        return
    with cluster(task, scheduler, workers, tell) as crew:
        yield crew


def _made(folder: Path) -> Path:
    """The folder, which is made if it is missing.

    Raises:
        UserError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as e:
        raise UserError(f"{folder} cannot be made: {e.strerror or e}") from None
    return folder


def _settled(plan: AnyPlan, folder: Path, rows: Rows, workers: int) -> AnyPlan:
    """The plan with the size of its chunks: that of the plan in the folder, or else one that is found out and written.

    Raises:
        UserError: there is another plan, or parts without one; or the plan cannot be written.
    """
    if (folder / PLAN).exists():
        there = type(plan).read(folder)
        if differs := plan.differs(there):
            raise UserError(f"{folder} has another sweep: {differs}; choose another folder")
        if plan.chunk not in (0, there.chunk):
            raise UserError(f"{folder} has chunks of {there.chunk} runs, not {plan.chunk}; choose another folder")
        return replace(plan, chunk=there.chunk)
    if any(folder.glob("part-*.parquet")):
        raise UserError(f"{folder} has parts of a sweep, but no {PLAN}: choose another folder")
    plan = plan if plan.chunk else replace(plan, chunk=_size(plan, rows, workers))
    plan.write(folder)
    return plan


def _digest(folder: Path) -> str:
    """A hash of what the plan's file says."""
    said = tomllib.loads((folder / PLAN).read_text("utf-8"))
    return sha256(json.dumps(said, sort_keys=True, default=str).encode()).hexdigest()


def _size(plan: Plan, rows: Rows, workers: int) -> int:
    """How many runs a chunk is to have: they last some seconds. A trial tells how long one takes."""
    rows(plan, 0, 1)  # it loads and compiles
    number, took = 1, 0.0
    while took < TRIAL and number < plan.runs:
        number = min(2 * number, plan.runs)
        begin = perf_counter()
        rows(plan, 0, number)
        took = perf_counter() - begin
    return _fitting(took / number, plan.runs, workers)


def _fitting(one: float, runs: int, workers: int) -> int:
    """How many runs a chunk is to have if one of them lasts `one` (s)."""
    share = ceil(runs / (SHARES * workers))
    seconds = min(max(share * one, LEAST), MOST)
    return max(1, min(runs, LARGEST, round(seconds / one) if one else LARGEST))
