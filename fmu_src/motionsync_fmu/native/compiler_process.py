"""The processes of C compilers: each has limited time, and none outlives the command that started it."""

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any
from weakref import WeakSet

from ..errors import UserError

TIME_LIMIT = 900.0  # s, of one library: the first one on a slow machine takes a minute

_running: set["subprocess.Popen[str]"] = set()
_pools: WeakSet["CompilerPool"] = WeakSet()


class CompilerPool(ThreadPoolExecutor):
    """As many threads as there are cores, which wait for compilers. Leaving it after an error starts no further
    compiler, and after an interruption ends those that run."""

    def __init__(self) -> None:
        super().__init__(os.cpu_count())
        _pools.add(self)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool | None:
        if kind is not None:
            self.shutdown(wait=False, cancel_futures=True)
            if not issubclass(kind, Exception):
                end_compilers()
        return super().__exit__(kind, error, trace)


def run_compiler(
    command: Sequence[str], folder: Path, time_limit: float = TIME_LIMIT
) -> "subprocess.CompletedProcess[str]":
    """Run a compiler in a folder, and wait for it.

    Raises:
        UserError: it takes longer than the time limit, in s.
    """
    windows: Any = {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
    process = subprocess.Popen(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        **(windows if sys.platform == "win32" else {"start_new_session": True}),
    )
    _running.add(process)
    try:
        output, errors = process.communicate(timeout=time_limit)
    except subprocess.TimeoutExpired:
        raise UserError(f"{Path(command[0]).name} has not ended after {time_limit:g} s") from None
    finally:
        _end(process)
        _running.discard(process)
    return subprocess.CompletedProcess(list(command), process.returncode, output, errors)


def end_compilers() -> None:
    """End all compilers that run, with all that they have started, and start none that waits for its turn."""
    for pool in list(_pools):
        pool.shutdown(wait=False, cancel_futures=True)
    for process in list(_running):
        _end(process)


def _end(process: "subprocess.Popen[str]") -> None:
    """End a compiler and what it has started, if it still runs."""
    if process.poll() is not None:
        return
    if sys.platform == "win32":
        process.kill()
    else:
        with suppress(ProcessLookupError):  # it has ended by itself
            os.killpg(process.pid, signal.SIGKILL)
    process.wait()
