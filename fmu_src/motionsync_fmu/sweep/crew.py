"""Who works on the chunks of a sweep: this process, worker processes on this computer, or those of a Dask scheduler.

A crew takes the numbers of chunks, as many at a time as it has places, and gives back their parts. It knows nothing of
what a chunk is: that is the task's own affair."""

import logging
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from operator import methodcaller
from pathlib import Path
from pkgutil import resolve_name
from queue import Empty, SimpleQueue
from tempfile import TemporaryDirectory
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol
from uuid import uuid4

from .. import __version__
from ..errors import UserError

if TYPE_CHECKING:
    from distributed import Client, Future

REACH = 10.0  # s within which a scheduler has to answer
BEAT = 0.2  # s after which waiting looks up
LOOK = 2.0  # s between two looks at who belongs to the crew
AHEAD = 2  # chunks that a thread of a worker has at a time: one that it works on, one that waits
HERE = "127.0.0.1"
MOTIONSYNC = "motionsync_fmu:__version__"


class Task(Protocol):
    """What is to be done with a chunk; it goes to other computers."""

    def __call__(self, number: int) -> bytes:
        """Do it; the contents of the chunk's part, which are empty if it has written the part itself."""

    def is_written(self, number: int) -> bool:
        """Whether the part is there."""


@dataclass(frozen=True)
class Done:
    """A chunk that is done.

    Attributes:
        number: the chunk's number.
        contents: those of its part; empty if the worker has written them.
        lost: whether it ended the workers that had it, again and again, and is not done at all.
    """

    number: int
    contents: bytes
    lost: bool = False


class Crew(Protocol):
    """Who works on chunks."""

    @property
    def places(self) -> int:
        """How many chunks it can be given at a time."""

    def begin(self, number: int) -> None:
        """Give it a chunk."""

    def try_next(self) -> Done | None:
        """Take a chunk that is done; None: there was none for a little while.

        Raises:
            UserError: it cannot go on.
        """


class Alone:
    """This process. A thread works, so that an interruption need not wait for it."""

    places = 1

    def __init__(self, task: Task) -> None:
        self.task = task
        self.results: SimpleQueue[Done | BaseException] = SimpleQueue()

    def begin(self, number: int) -> None:
        Thread(target=self._work, args=(number,), daemon=True).start()

    def _work(self, number: int) -> None:
        try:
            self.results.put(Done(number, self.task(number)))
        except BaseException as e:  # it is raised where the results are taken
            self.results.put(e)

    def try_next(self) -> Done | None:
        try:
            result = self.results.get(timeout=BEAT)
        except Empty:
            return None
        if isinstance(result, BaseException):
            raise result
        return result


@dataclass
class Workers:
    """Worker processes of this computer, one thread each. One that ends is replaced."""

    address: str
    wanted: int
    folder: Path
    running: list[subprocess.Popen[bytes]] = field(default_factory=list)
    lost: int = 0  # since a chunk was done

    def look_after(self) -> None:
        """Start those that are missing.

        Raises:
            UserError: they end again and again, and no chunk is done.
        """
        alive = [process for process in self.running if process.poll() is None]
        self.lost += len(self.running) - len(alive)
        if self.lost > 3 * self.wanted + 3:
            raise UserError(f"the workers end as soon as they are started; the last line of one: {self._last_line()}")
        self.running = alive
        while len(self.running) < self.wanted:
            self.running.append(self._start())

    def _start(self) -> "subprocess.Popen[bytes]":
        """Start a worker, in a session of its own: the Ctrl-C of a terminal is for the command alone."""
        command = [sys.executable, "-P", "-m", "distributed.cli.dask_worker", self.address]
        command += ["--no-nanny", "--nthreads", "1", "--memory-limit", "0", "--host", HERE, "--no-dashboard"]
        command += ["--death-timeout", "60", "--local-directory", str(self.folder)]
        path = os.pathsep.join(filter(None, sys.path))
        windows: Any = {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
        with self._log().open("ab") as log:
            return subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env={**os.environ, "PYTHONPATH": path},
                **(windows if sys.platform == "win32" else {"start_new_session": True}),
            )

    def _log(self) -> Path:
        return self.folder / "workers.log"

    def _last_line(self) -> str:
        lines = self._log().read_text("utf-8", "replace").splitlines()
        return next((line.strip() for line in reversed(lines) if line.strip()), "nothing")

    def end(self) -> None:
        """End them at once, and what they have started; what they were working on is lost."""
        for process in self.running:
            if sys.platform == "win32":
                process.kill()
            else:
                with suppress(ProcessLookupError):  # it has ended by itself
                    os.killpg(process.pid, signal.SIGKILL)
        for process in self.running:
            process.wait()


class Cluster:
    """The workers of a Dask scheduler, on this computer or others.

    The scheduler need not have motionsync: it sees the task as bytes, which the worker unpacks. They go with each
    chunk. If a worker had them from another one, it would wait for that one, which may be lost."""

    def __init__(self, client: "Client", task: Task, own: Workers | None, tell: Callable[[str], None]) -> None:
        self.client = client
        self.own = own
        self.tell = tell
        self.known: set[str] = set()
        self.threads = 0
        self.looked = -LOOK
        self.batch = uuid4().hex
        self.task = task
        self.packed = pickle.loads, pickle.dumps(task)
        self.numbers: dict[Future, int] = {}
        self.results: SimpleQueue[Future] = SimpleQueue()

    @property
    def places(self) -> int:
        return AHEAD * self.threads

    def begin(self, number: int) -> None:
        key = f"chunk-{self.batch}-{number}"
        (future,) = self.client.get({key: (methodcaller("__call__", number), self.packed)}, [key], sync=False)
        self.numbers[future] = number
        future.add_done_callback(self.results.put)

    def try_next(self) -> Done | None:
        if not self.threads or monotonic() - self.looked > LOOK:
            self.look_after()
        try:
            future = self.results.get(timeout=BEAT)
        except Empty:
            return None
        if self.own:
            self.own.lost = 0
        return self._done(self.numbers.pop(future), future)

    def _done(self, number: int, future: "Future") -> Done:
        from distributed import CancelledError, KilledWorker  # noqa: PLC0415 (part of an extra)

        if future.status == "finished" and self.task.is_written(number):
            return Done(number, b"")  # without asking for the result, since the worker that has it may be lost
        try:
            return Done(number, future.result())
        except KilledWorker:
            return Done(number, b"", lost=True)
        except CancelledError:
            raise UserError(f"the scheduler {self.client.scheduler.address} is gone") from None

    def look_after(self) -> None:
        """See which workers there are; who is new has to have this version of motionsync.

        Raises:
            UserError: a worker has another one, or cannot be started.
        """
        if self.own:
            self.own.look_after()
        threads: dict[str, int] = self.client.nthreads()
        if not threads and not self.own and self.looked < 0.0:
            self.tell(f"waiting for the first worker of {self.client.scheduler.address}")
        if new := [address for address in threads if address not in self.known]:
            check_versions(self.client.run(resolve_name, MOTIONSYNC, workers=new, on_error="return"))
        self.known = set(threads)
        self.threads = sum(threads.values())
        self.looked = monotonic()


def check_versions(found: "dict[str, str | BaseException]") -> None:
    """Check what workers, by their addresses, have told to be their version of motionsync.

    Raises:
        UserError: one has another version than this computer, or none; the message has both.
    """
    for address, version in found.items():
        if isinstance(version, ImportError):
            raise UserError(f"the worker {address} has no motionsync, and this computer has {__version__}")
        if isinstance(version, str) and version != __version__:
            raise UserError(f"the worker {address} has motionsync {version}, and this computer has {__version__}")


@contextmanager
def cluster(task: Task, scheduler: str, workers: int, tell: Callable[[str], None]) -> "Iterator[Cluster]":
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
            local = LocalCluster(n_workers=0, host=HERE, dashboard_address=f"{HERE}:0", silence_logs=logging.CRITICAL)
            last.callback(_close, local)
            address = local.scheduler_address
            own = Workers(address, workers, folder)
            last.callback(own.end)
        client = _client(address)
        last.callback(_close, client)
        tell(f"dashboard: {client.dashboard_link}")
        yield Cluster(client, task, own, tell)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep from the console what Dask logs meanwhile: what matters of it is told in one sentence."""
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
    """A client of the scheduler at an address.

    Raises:
        UserError: nothing answers there, or no scheduler, or the address is none.
    """
    from distributed import Client  # noqa: PLC0415

    try:
        _greet(address)
        return Client(address, timeout=REACH, set_as_default=False)
    except ValueError as e:
        raise UserError(f"{address} is no address of a scheduler, such as tcp://10.0.0.5:8786: {e}") from None
    except OSError:  # Dask's word for a time that is up
        raise UserError(f"no scheduler answers at {address}, for {REACH:g} s") from None
    except (MemoryError, RuntimeError):  # an answer that Dask takes for the length of another
        raise UserError(f"what answers at {address} is no scheduler of Dask") from None


def _greet(address: str) -> None:
    """See whether a scheduler answers. A client that fails would leave threads behind, and their errors."""
    from distributed.comm import connect  # noqa: PLC0415
    from distributed.security import Security  # noqa: PLC0415
    from distributed.utils import LoopRunner, sync  # noqa: PLC0415

    async def greet() -> None:
        answer = await connect(address, timeout=REACH, **Security().get_connection_args("client"))
        await answer.close()

    runner = LoopRunner()
    runner.start()
    try:
        sync(runner.loop, greet, callback_timeout=REACH + 1.0)
    finally:
        runner.stop()


def _close(what: Any) -> None:
    with suppress(Exception):  # the scheduler may be gone; what was done is kept anyway
        what.close(timeout=1.0)
