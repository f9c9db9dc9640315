"""Two computers for sweeps, on the loopback of this one: a scheduler, and workers that share nothing but that."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

LOCALHOST = "127.0.0.1"
ROOT = Path(__file__).parents[2]
FAR = """\
import sys

def refuse(event, arguments):
    if event.startswith(("open", "os.")) and {folder!r} in str(arguments[0]):
        raise FileNotFoundError(2, "No such file or directory", {folder!r})

sys.addaudithook(refuse)  # for this process, the folder does not exist
"""


@dataclass(frozen=True)
class Computers:
    """A scheduler with two workers.

    Attributes:
        address: the scheduler's.
        seen: a folder that only one of the workers sees.
        caches: the user's caches of the two, for motionsync.
    """

    address: str
    seen: Path
    caches: tuple[Path, Path]


@pytest.fixture(scope="module")
def computers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Computers]:
    from distributed import Client, LocalCluster  # noqa: PLC0415 (a second that other tests need not wait)

    homes = tmp_path_factory.mktemp("near"), tmp_path_factory.mktemp("far")
    seen = tmp_path_factory.mktemp("seen")
    hidden = homes[1] / "hidden.py"
    hidden.write_text(FAR.format(folder=str(seen)), "utf-8")
    with LocalCluster(n_workers=0, host=LOCALHOST, dashboard_address=f"{LOCALHOST}:0") as cluster:
        address = cluster.scheduler_address
        with worker(address, homes[0]), worker(address, homes[1], "--preload", str(hidden)):
            with Client(cluster) as client:
                client.wait_for_workers(2, timeout=60)
            yield Computers(address, seen, (homes[0] / "cache", homes[1] / "cache"))


@contextmanager
def worker(scheduler: str, home: Path, *options: str) -> Iterator[None]:
    """A worker of a scheduler for a while, with a home of its own."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", scheduler, "--no-nanny", "--nthreads", "1"]
    command += ["--no-dashboard", "--host", LOCALHOST, "--local-directory", str(home), *options]
    path = os.pathsep.join([str(ROOT / "model"), str(ROOT / "fmu_src"), str(ROOT)])
    own = {"PYTHONPATH": path, "XDG_CACHE_HOME": str(home / "cache"), "LOCALAPPDATA": str(home / "cache")}
    with (home / "log").open("ab") as log:
        process = subprocess.Popen(command, cwd=home, env={**os.environ, **own}, stdout=log, stderr=log)
    try:
        yield
    finally:
        process.kill()
        process.wait()
