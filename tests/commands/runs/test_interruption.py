"""Ctrl-C: its message at every instant, no traceback, nothing half done, no compiler left behind."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.support.project.workshop import STOP, scenario

# A shell that runs the tests in its background has switched the signal off.
LISTEN = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
START = f"{LISTEN} print('started', flush=True); from motionsync_fmu.cli import main; main()"
AGAIN = 6.0  # s, after which a user would press Ctrl-C again
LONG = STOP.replace("stop_time = 0.5", "stop_time = 5000.0")  # a run that takes more than a minute

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a process of Windows gets no signal of its own")


def interrupted(
    folder: Path, instant: float, *arguments: str, after: Callable[[], bool] = lambda: True, **environment: str
) -> tuple[int, str, float]:
    """Exit status and error stream of a command that gets SIGINT at an instant after its start, or after what is waited
    for, and the time that it then takes, both in s. None of the processes that it had at this instant is left."""
    process = subprocess.Popen(
        [sys.executable, "-c", START, *arguments],
        cwd=folder,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout
    assert process.stdout.readline() == "started\n"
    latest = time.monotonic() + 60.0
    while not after():
        assert time.monotonic() < latest
        time.sleep(0.02)
    time.sleep(instant)
    children = psutil.Process(process.pid).children(recursive=True)
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    try:
        _, err = process.communicate(timeout=AGAIN)
    except subprocess.TimeoutExpired:  # it came while lxml was imported, whose C drops it
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    took = time.monotonic() - begin
    assert not any(child.is_running() and child.status() != psutil.STATUS_ZOMBIE for child in children)
    return process.returncode, err, took


@pytest.mark.parametrize("instant", [0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.1])
def test_an_interruption_is_one_message_at_every_instant(built: Path, tmp_path: Path, instant: float) -> None:
    run_is_interrupted(built, tmp_path, instant)


IN_A_CALLBACK = """\
import time
from motionsync_fmu import cli
from motionsync_fmu.commands import app

class Dropping:
    def __del__(self):
        raise KeyboardInterrupt

def run_command():
    Dropping()
    while True:
        time.sleep(0.01)

app.run_command = run_command
cli.main()
"""


def test_an_interruption_that_python_drops_comes_again() -> None:
    """As when it comes in the callback that ends an import's lock: without a traceback, and the command ends."""
    done = subprocess.run(
        [sys.executable, "-c", LISTEN + IN_A_CALLBACK], capture_output=True, text=True, timeout=20, check=False
    )
    assert (done.returncode, done.stderr) == (130, "motionsync: interrupted\n")


IN_AN_IMPORT = """\
import importlib, os, signal, sys, time
from motionsync_fmu import cli
from motionsync_fmu.commands import app

def run_command():
    importlib.import_module("fragile")
    end = time.monotonic() + 10.0
    while time.monotonic() < end:
        time.sleep(0.01)
    return 0

app.run_command = run_command
cli.main()
"""
FRAGILE = {
    "another error": "raise ImportError('initialization failed') from None",
    "an error of the interpreter": "raise SystemError('initialization of fragile failed') from None",
    "an exit": "raise SystemExit(3) from None",
    "nothing": "pass",
}


@pytest.mark.parametrize("answer", FRAGILE)
@pytest.mark.parametrize("depth", [1, 3])
@pytest.mark.parametrize("times", [1, 5])
def test_an_interruption_of_an_import_is_one_message_whatever_the_import_makes_of_it(
    tmp_path: Path, answer: str, depth: int, times: int
) -> None:
    """As a library in C may do while it is loaded: it raises another error, or drops the interruption."""
    fragile = f"""\
import os, signal, time
for _ in range({times}):
    try:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.02)
    except KeyboardInterrupt:
        {FRAGILE[answer]}
"""
    for i in range(1, depth):
        (tmp_path / f"{'fragile' if i == 1 else f'outer{i}'}.py").write_text(f"import outer{i + 1}\n")
    (tmp_path / f"{'fragile' if depth == 1 else f'outer{depth}'}.py").write_text(fragile)
    done = subprocess.run(
        [sys.executable, "-c", LISTEN + IN_AN_IMPORT],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (130, "motionsync: interrupted\n")


@pytest.mark.parametrize("instant", [0.0, 0.4])
def test_an_interruption_of_the_fmu_s_run_is_one_message(built: Path, tmp_path: Path, instant: float) -> None:
    """However long the start takes: the FMU's files are there, and so the run is about to start or goes on."""
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    run_is_interrupted(built, tmp_path, instant, after=lambda: any(temporary.rglob("binaries")), TMPDIR=str(temporary))


def run_is_interrupted(built: Path, tmp_path: Path, instant: float, **options: Any) -> None:
    (tmp_path / "build").symlink_to(built)
    scenario(str(tmp_path / "long"), LONG)
    status, err, _ = interrupted(tmp_path, instant, "run", "long", "--output", "out", **options)
    assert status == 130, err
    assert err.splitlines()[-1] in ("motionsync: interrupted", "motionsync: interrupted after 0 of 1")
    assert "Traceback" not in err
    assert not [file for file in (tmp_path / "out").rglob("*") if file.is_file()]


@pytest.mark.parametrize(
    "command", [("build", "Synchronizer", "--flavour", "native", "--output"), ("line", "--output")]
)
@pytest.mark.parametrize("instant", [1.0, 2.0])
def test_an_interruption_ends_the_compiler_and_leaves_no_file(
    tmp_path: Path, instant: float, command: tuple[str, ...]
) -> None:
    """An empty cache of zig makes the compilation last."""
    status, err, took = interrupted(tmp_path, instant, *command, "out", ZIG_GLOBAL_CACHE_DIR=str(tmp_path / "zig"))
    assert (status, err.splitlines()[-1]) == (130, "motionsync: interrupted")
    assert "Traceback" not in err
    assert took < 10.0
    assert not [path for path in (tmp_path / "out").rglob("*") if path.name != "native"]
