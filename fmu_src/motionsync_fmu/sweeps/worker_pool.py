"""The worker pools of a sweep: this process, worker processes on this computer, or those of a Dask scheduler.

A pool takes the numbers of chunks, as many at a time as its capacity, and returns their parts. Only the task knows what
a chunk is."""

import logging
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from operator import methodcaller
from pathlib import Path
from pkgutil import resolve_name
from queue import Empty, SimpleQueue
from tempfile import TemporaryDirectory
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol
from uuid import uuid4

from ..about import __version__
from ..errors import UserError

if TYPE_CHECKING:
    from distributed import Client, Future

REACH_TIME = 10.0  # s within which a scheduler has to answer
POLL_TIME = 0.2  # s after which waiting looks up
CHECK_INTERVAL = 2.0  # s between two checks of which workers there are
CHUNKS_PER_THREAD = 2  # chunks that a thread of a worker has at a time: one that it works on, one that waits
LOCALHOST = "127.0.0.1"
MOTIONSYNC = "motionsync_fmu:__version__"


class ChunkTask(Protocol):
    """What is to be done with a chunk; it goes to other computers."""

    def __call__(self, number: int) -> bytes:
        """Do it; the contents of the chunk's part, which are empty if it has written the part itself."""

    def is_written(self, number: int) -> bool:
        """Whether the part is there."""


@dataclass(frozen=True)
class FinishedChunk:
    """A chunk that is done.

    Attributes:
        number: the chunk's number.
        contents: those of its part; empty if the worker has written them.
        lost: whether it ended the workers that had it, again and again, and is not done at all.
    """

    number: int
    contents: bytes
    lost: bool = False


class WorkerPool(Protocol):
    """Processes that work on chunks."""

    @property
    def capacity(self) -> int:
        """How many chunks it can be given at a time."""

    def give_chunk(self, number: int) -> None:
        """Give it a chunk."""

    def try_take_finished(self) -> FinishedChunk | None:
        """Take a chunk that is done; None: there was none for a little while.

        Raises:
            UserError: it cannot go on.
        """


class ThisProcess:
    """This process. A thread works, so that an interruption need not wait for it."""

    capacity = 1

    def __init__(self, task: ChunkTask) -> None:
        self.task = task
        self.results: SimpleQueue[FinishedChunk | BaseException] = SimpleQueue()

    def give_chunk(self, number: int) -> None:
        Thread(target=self._work, args=(number,), daemon=True).start()

    def _work(self, number: int) -> None:
        try:
            self.results.put(FinishedChunk(number, self.task(number)))
        except BaseException as e:  # it is raised where the results are taken
            self.results.put(e)

    def try_take_finished(self) -> FinishedChunk | None:
        try:
            result = self.results.get(timeout=POLL_TIME)
        except Empty:
            return None
        if isinstance(result, BaseException):
            raise result
        return result


class Workers:
    """Worker processes of this computer, one thread each. Dask's own process for them replaces one that ends."""

    def __init__(self, address: str, number: int, folder: Path) -> None:
        """Start them, in a session of their own: the Ctrl-C of a terminal is for the command alone."""
        command = [sys.executable, "-P", "-m", "distributed.cli.dask_worker", address]
        command += ["--nworkers", str(number), "--nthreads", "1", "--memory-limit", "0", "--host", LOCALHOST]
        command += ["--death-timeout", "60", "--local-directory", str(folder)]
        command += ["--no-dashboard", "--dashboard-address", f"{LOCALHOST}:0"]  # its HTTP server is there anyway
        path = os.pathsep.join(filter(None, sys.path))
        windows: Any = {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
        self.log = folder / "workers.log"
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env={**os.environ, "PYTHONPATH": path},
                **(windows if sys.platform == "win32" else {"start_new_session": True}),
            )

    def check(self) -> None:
        """Check that they have not ended for good.

        Raises:
            UserError: they have.
        """
        if self.process.poll() is not None:
            lines = self.log.read_text("utf-8", "replace").strip().splitlines() or ["nothing"]
            raise UserError(f"the workers have ended; their last line: {lines[-1].strip()}")

    def end(self) -> None:
        """End them at once, and what they have started; what they were working on is lost."""
        import psutil  # noqa: PLC0415 (it comes with Dask)

        with suppress(psutil.NoSuchProcess):  # it has ended by itself
            parent = psutil.Process(self.process.pid)
            for process in (*parent.children(recursive=True), parent)[::-1]:  # first the one that replaces the others
                with suppress(psutil.NoSuchProcess):
                    process.kill()
        self.process.wait()


class Cluster:
    """The workers of a Dask scheduler, on this computer or others.

    The scheduler need not have motionsync: it sees the task as bytes, which the worker unpacks. They go with each
    chunk. If a worker had them from another one, it would wait for that one, which may be lost."""

    def __init__(self, client: "Client", task: ChunkTask, own: Workers | None, notify: Callable[[str], None]) -> None:
        self.client = client
        self.own = own
        self.notify = notify
        self.checked_workers: set[str] = set()
        self.threads = 0
        self.looked = -CHECK_INTERVAL
        self.batch = uuid4().hex
        self.task = task
        self.packed = pickle.loads, pickle.dumps(task)
        self.numbers: dict[Future, int] = {}
        self.results: SimpleQueue[Future] = SimpleQueue()

    @property
    def capacity(self) -> int:
        return CHUNKS_PER_THREAD * self.threads

    def give_chunk(self, number: int) -> None:
        key = f"chunk-{self.batch}-{number}"
        (future,) = self.client.get({key: (methodcaller("__call__", number), self.packed)}, [key], sync=False)
        self.numbers[future] = number
        future.add_done_callback(self.results.put)

    def try_take_finished(self) -> FinishedChunk | None:
        if not self.threads or monotonic() - self.looked > CHECK_INTERVAL:
            self.look()
        try:
            future = self.results.get(timeout=POLL_TIME)
        except Empty:
            return None
        return self._done(self.numbers.pop(future), future)

    def _done(self, number: int, future: "Future") -> FinishedChunk:
        from distributed import CancelledError, KilledWorker  # noqa: PLC0415 (part of an extra)

        if future.status == "finished" and self.task.is_written(number):
            return FinishedChunk(number, b"")  # without asking for the result, since the worker that has it may be lost
        try:
            return FinishedChunk(number, future.result())
        except KilledWorker:
            return FinishedChunk(number, b"", lost=True)
        except CancelledError:
            raise UserError(f"the scheduler {self.client.scheduler.address} is gone") from None

    def look(self) -> None:
        """See which workers there are; who is new has to have this version of motionsync.

        Raises:
            UserError: a worker has another one, or those of this computer have ended.
        """
        if self.own:
            self.own.check()
        threads: dict[str, int] = self.client.nthreads()
        if not threads and not self.own and self.looked < 0.0:
            self.notify(f"waiting for the first worker of {self.client.scheduler.address}")
        if new := [address for address in threads if address not in self.checked_workers]:
            check_versions(self.client.run(resolve_name, MOTIONSYNC, workers=new, on_error="return"))
        self.checked_workers = set(threads)
        self.threads = sum(threads.values())
        self.looked = monotonic()


def check_versions(versions: "dict[str, str | BaseException]") -> None:
    """Check what workers, by their addresses, have reported to be their version of motionsync.

    Raises:
        UserError: one has another version than this computer, or none; the message has both.
    """
    for address, version in versions.items():
        if isinstance(version, ImportError):
            raise UserError(f"the worker {address} has no motionsync, and this computer has {__version__}")
        if isinstance(version, str) and version != __version__:
            raise UserError(f"the worker {address} has motionsync {version}, and this computer has {__version__}")


@contextmanager
def cluster(task: ChunkTask, scheduler: str, workers: int, notify: Callable[[str], None]) -> "Iterator[Cluster]":
    """The workers of the scheduler at an address; without one, so many worker processes on this computer.

    Raises:
        UserError: the scheduler does not answer, or Dask is not installed.
    """
    from distributed import LocalCluster  # noqa: PLC0415

    with _quiet(), ExitStack() as last:
        own = None
        address = scheduler
        if not scheduler:
            folder = Path(last.enter_context(TemporaryDirectory(ignore_cleanup_errors=True)))
            local = LocalCluster(
                n_workers=0, host=LOCALHOST, dashboard_address=f"{LOCALHOST}:0", silence_logs=logging.CRITICAL
            )
            last.callback(_close, local)
            address = local.scheduler_address
            own = Workers(address, workers, folder)
            last.callback(own.end)
        client = _client(address)
        last.callback(_close, client)
        notify(f"dashboard: {client.dashboard_link}")
        yield Cluster(client, task, own, notify)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Dask's log off the console: an error of motionsync names what matters of it."""
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] == "distributed"]
    levels = {name: logging.getLogger(name).level for name in names}
    for name in names:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for name, level in levels.items():
            logging.getLogger(name).setLevel(level)


def _client(address: str) -> "Client":
    """A client of the scheduler at an address."""
    from distributed import Client  # noqa: PLC0415

    try:
        _greet(address)
        return Client(address, timeout=REACH_TIME, set_as_default=False)
    except ValueError as e:
        raise UserError(f"{address} is no address of a scheduler, such as tcp://10.0.0.5:8786: {e}") from None
    except OSError:  # Dask's word for a time that is up
        raise UserError(f"no scheduler answers at {address}, for {REACH_TIME:g} s") from None
    except (MemoryError, RuntimeError):  # an answer that Dask takes for the length of another
        raise UserError(f"what answers at {address} is no scheduler of Dask") from None


def _greet(address: str) -> None:
    """See whether a scheduler answers. A client that fails would leave threads behind, and their errors."""
    from distributed.comm import connect  # noqa: PLC0415
    from distributed.security import Security  # noqa: PLC0415
    from distributed.utils import LoopRunner, sync  # noqa: PLC0415

    async def greet() -> None:
        answer = await connect(address, timeout=REACH_TIME, **Security().get_connection_args("client"))
        await answer.close()

    runner = LoopRunner()
    runner.start()
    try:
        sync(runner.loop, greet, callback_timeout=REACH_TIME + 1.0)
    finally:
        runner.stop()


def _close(what: Any) -> None:
    with suppress(Exception):  # the scheduler may be gone; what was done is kept anyway
        what.close(timeout=1.0)
