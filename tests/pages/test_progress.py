"""What is reported while a task lasts: before it starts, and never with more than two seconds between."""

import io
import subprocess
import sys
import time
from itertools import pairwise

import pytest
from rich.console import Console

from motionsync_fmu.pages import progress

SLOW = """
import time
from motionsync_fmu.pages.progress import report_progress
with report_progress("building a.fmu") as notify:
    time.sleep(2.5)
    notify("compiled for one")
    time.sleep(2.5)
"""


@pytest.mark.slow
def test_on_a_pipe_there_is_a_sign_of_life_every_two_seconds() -> None:
    process = subprocess.Popen([sys.executable, "-c", SLOW], stderr=subprocess.PIPE)
    assert process.stderr
    text, times = b"", []
    while part := process.stderr.read1(1000):
        text += part
        times.append(time.monotonic())
    assert process.wait() == 0
    assert text.decode().splitlines()[0].startswith("building a.fmu ..")
    assert text.decode().splitlines()[1].startswith("  compiled for one ..")
    waits = [b - a for a, b in pairwise(times)]
    assert max(waits) < 2.0 + 1.0  # with what a busy machine may add
    assert sum(waits) > 4.5


@pytest.fixture
def log(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    stream = io.StringIO()
    monkeypatch.setattr(progress, "err", Console(file=stream, highlight=False, soft_wrap=True, markup=False))
    return stream


def test_the_line_is_there_before_the_work_starts(log: io.StringIO) -> None:
    with progress.report_progress("building b.fmu"):
        assert log.getvalue() == "building b.fmu .."
    assert log.getvalue() == "building b.fmu ..\n"


def test_what_is_done_at_once_need_not_be_reported(log: io.StringIO) -> None:
    with progress.report_progress("running c", at_once=False):
        pass
    assert log.getvalue() == ""


def test_what_lasts_is_reported(log: io.StringIO, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE", 0.01)
    with progress.report_progress("running d", at_once=False):
        deadline = time.monotonic() + 10.0
        while not log.getvalue() and time.monotonic() < deadline:
            time.sleep(0.01)
        assert log.getvalue() == "running d .."


def test_an_error_ends_the_line(log: io.StringIO) -> None:
    with pytest.raises(ValueError, match="no"), progress.report_progress("building e.fmu"):
        raise ValueError("no")
    assert log.getvalue() == "building e.fmu ..\n"


def test_a_count_shows_rate_and_time_left(log: io.StringIO, monkeypatch: pytest.MonkeyPatch) -> None:
    """100 of 1100 were done before; 200 more in 4 s are 50 a second, and 800 are left: 16 s."""
    now = 1000.0
    monkeypatch.setattr(progress, "monotonic", lambda: now)
    monkeypatch.setattr(progress, "PATIENCE", 1e3)
    monkeypatch.setattr(progress, "LINE_INTERVAL", 3.0)
    with progress.report_count("sweeping f", "runs") as count:
        count(100, 1100)
        now = 1001.0
        count(150, 1100)  # too early for a line
        now = 1004.0
        count(300, 1100)
        count.notify("a word between")
    assert log.getvalue() == ("sweeping f ..\n  300 of 1,100 runs, 50 runs/s, 16 s left ..\n  a word between ..\n")


def test_on_a_terminal_a_count_is_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=True, width=120, highlight=False, markup=False)
    monkeypatch.setattr(progress, "err", console)
    with progress.report_count("sweeping g", "runs") as count:
        count(0, 40)
        time.sleep(0.01)
        count(10, 40)
        count.notify("a word between")
    assert "10 of 40 runs, " in stream.getvalue()
    assert " s left" in stream.getvalue()
    assert "a word between" in stream.getvalue()


@pytest.mark.parametrize(
    ("time", "text"), [(0.4, "0 s"), (59.6, "1 min 0 s"), (200.0, "3 min 20 s"), (18420.0, "5 h 7 min")]
)
def test_a_duration_has_everyday_units(time: float, text: str) -> None:
    assert progress.duration(time) == text
