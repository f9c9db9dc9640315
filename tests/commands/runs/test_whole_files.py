"""Every file that a command writes is whole, or as it was before, wherever the process ends."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu import new, plan_line, run, search
from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.fmus.zip import write_zip
from motionsync_fmu.paths import PART, replace_files
from motionsync_fmu.sweeps.search_output import write_csv
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.support.blocks.drawn import drawn
from tests.support.project.command_line import Command
from tests.support.project.workshop import PYTHON, STOP, scenario

resource = pytest.importorskip("resource", reason="Windows has no limit of the size of files")
SEARCH = ("search", "CutToLength/any_length", "--vary", "length=50..6000", "--until", "passed")
OF_A_FOLDER = (".lock", ".token")  # which say that a sweep is at work there

# --- what each command opens ---


class Opened:
    """The files that this process opens to write them, while it listens. A hook stays until the process ends."""

    def __init__(self) -> None:
        self.paths: list[str] = []
        self.listens = False
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self.listens and event == "open" and isinstance(arguments[0], str | bytes):
            flags = arguments[2] if isinstance(arguments[2], int) else 0
            if flags & (os.O_WRONLY | os.O_RDWR):
                self.paths.append(os.fsdecode(arguments[0]))

    @contextmanager
    def listening(self) -> Iterator[list[str]]:
        self.paths, self.listens = [], True
        try:
            yield self.paths
        finally:
            self.listens = False


@pytest.fixture(scope="module")
def opened() -> Opened:
    return Opened()


@pytest.mark.parametrize(
    "command",
    [
        ("build", "Synchronizer", *PYTHON, "--output", "out"),
        ("run", "own", *PYTHON, "--output", "out"),
        ("run", "own", *PYTHON, "--set", "rest_value=31", "--output", "out"),
        ("new", "Gearing", "out"),
        ("explore", "own", "--output", "out/page.html"),
        ("plan-line", "--length", "1000", "--output", "out"),
        ("sweep", "own", "--set", "rest_value=30,31", "--output", "out", "--workers", "1"),
        (*SEARCH, "--output", "out", "--workers", "1"),
    ],
)
def test_a_command_opens_no_file_under_its_own_name(
    command: tuple[str, ...], opened: Opened, motionsync: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scenario("own", STOP)
    out = tmp_path / "out"
    with opened.listening() as paths:
        outcome = motionsync(*command)
    assert outcome.status in (0, 1), outcome.err
    written = [file for file in out.rglob("*") if file.is_file() and file.name not in OF_A_FOLDER]
    assert written
    below = [Path(path).absolute() for path in paths]
    names = [p.name for p in below if p.is_relative_to(out) and p.suffix != ".log" and not p.is_dir()]
    assert [name for name in names if not name.endswith(PART) and name not in OF_A_FOLDER] == []
    assert {name.rsplit(".", 2)[0] for name in names} >= {
        file.name for file in written if file.suffix in (".csv", ".html")
    }


# --- the process is killed in the middle ---


def killed_after(size: int, write: Callable[[], object]) -> bool:
    """Whether a process that writes is killed where one of its files becomes longer than a size, in bytes."""
    if not (child := os.fork()):
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        write()
        os._exit(0)
    status = os.waitpid(child, 0)[1]
    assert status in (0, signal.SIGXFSZ), status
    return status != 0


def contents(folder: Path) -> dict[str, bytes]:
    """The contents of all files below a folder but those that are being written, by path."""
    files = (file for file in folder.rglob("*") if file.is_file() and not file.name.endswith(PART))
    return {str(file.relative_to(folder)): file.read_bytes() for file in files}


def write_several(folder: Path, sizes: tuple[int, ...]) -> None:
    with replace_files(folder) as part:
        for i, size in enumerate(sizes):
            part(str(i)).write_bytes(bytes([i]) * size)


@pytest.fixture(scope="module")
def writers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Callable[[], object]]]:
    """What writes into a folder, by name; the results that it writes are computed once."""
    own = scenario(str(tmp_path_factory.mktemp("own")))
    result, plan = run(own, flavour=Flavour.PYTHON), plan_line(length="1000")
    boundaries = search("CutToLength/any_length", vary="length=50..6000", until="passed", workers=1)
    data = Random(1).randbytes(10**5)
    several = {"several files": (10_000, 0, 70_000), "a file": (9_000,)}
    by_name: dict[str, Callable[[Path], object]] = {
        **{name: partial(write_several, sizes=sizes) for name, sizes in several.items()},
        "results": result.write,
        "a report": lambda folder: result.report(folder / "report.html"),
        "a plan": lambda folder: plan.report(folder / "report.html"),
        "boundaries": partial(write_csv, boundaries),
        "an FMU": lambda folder: write_zip(folder / "a.fmu", {"a": data}),
        "a new scenario": lambda folder: new("Gearing", folder),
        "a sweep's plan": SweepPlan.of(own, ["rest_value=30,31"]).write,
    }
    folders = {name: tmp_path_factory.mktemp("writes") for name in by_name}
    return {name: (folders[name], partial(write, folders[name])) for name, write in by_name.items()} | {
        "a reference": (own.parent, result.write_reference)
    }


WRITERS = ["several files", "a file", "results", "a report", "a plan", "boundaries", "an FMU", "a new scenario"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the process that is killed is a copy of this one")
@pytest.mark.parametrize("name", [*WRITERS, "a sweep's plan", "a reference"])
@drawn(10, anew=True)
@given(share=st.floats(0.0, 1.2), before=st.booleans())
def test_a_file_is_whole_or_as_it_was_wherever_the_process_is_killed(
    writers: dict[str, tuple[Path, Callable[[], object]]], name: str, share: float, before: bool
) -> None:
    """Killed where a file gets longer than a share of the longest; the files were there before, or were not."""
    folder, write = writers[name]
    remove_written(folder)
    inputs = contents(folder)
    write()
    whole = contents(folder)
    before &= name != "a new scenario"  # which replaces none
    if not before:
        remove_written(folder)
    longest = max(len(whole[file]) for file in whole.keys() - inputs.keys())
    was_killed = killed_after(int(share * longest), write)
    assert was_killed == (share < 1.0)
    left = contents(folder)
    sizes, whole_sizes = ({file: (len(text), text[-100:]) for file, text in each.items()} for each in (left, whole))
    assert sizes.items() <= whole_sizes.items()  # a report has the time
    assert len(left) == len(whole) or (was_killed and not before)


def remove_written(folder: Path) -> None:
    """Remove all files but a scenario of which a reference is written."""
    for file in folder.iterdir():
        if file.read_bytes() != STOP.encode():
            file.unlink()
