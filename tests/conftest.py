"""What all tests have in common: the built FMUs, and the rule that CI accepts no skipped test."""

import gc
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import is_hypothesis_test
from hypothesis.internal.conjecture import providers

from motionsync.blocks import BLOCKS
from motionsync_fmu import cli, paths
from motionsync_fmu.pages import progress
from tests.support.blocks.by_block import block_folder
from tests.support.blocks.drawn import draw_times
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.project.command_line import Command, Outcome

SOAK = 10  # as many random examples in the long form

FOLDER = Path(__file__).parent
OWN_FOLDERS = {FOLDER / "model" / block_folder(name) for name in BLOCKS}


# Hypothesis mixes numbers from the project's loaded modules into what it draws; there is no option for that. Without
# them random runs depend neither on which tests run together nor on the source.
providers._get_local_constants = lambda: providers._local_constants


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--no-skips", action="store_true", help="a skipped test fails the run: for machines that have all")
    parser.addoption("--quick", action="store_true", help="no FMU, no slow test, a tenth of the random examples")
    parser.addoption("--soak", action="store_true", help="the tests with random examples alone, in their long form")
    parser.addoption("--block", metavar="FOLDER", help="the tests of one block that need no FMU: gearing, say")
    parser.addoption("--registered", metavar="NAME", help="the tests that concern a registered block: Gearing, say")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """One process more than processors: a process often waits, for a browser, an emulator or another one's build."""
    return (os.cpu_count() or 1) + 1


def pytest_configure(config: pytest.Config) -> None:
    draw_times(1 / 10 if config.getoption("--quick") else SOAK if config.getoption("--soak") else 1)
    for package in sorted(path.parent.name for path in FOLDER.glob("*/__init__.py")):
        config.addinivalue_line("markers", f"{package}: a test in tests/{package}")
    gc.disable()  # modules and tests stay until the end: to look for garbage among them takes a third of the collection


def pytest_collection_finish() -> None:
    gc.freeze()
    gc.set_threshold(5_000, 20, 20)  # garbage is rare: looking for it as often as by default takes twice the time
    gc.enable()


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """With --registered: the folders of the other blocks, whose tests are about that block alone."""
    name = config.getoption("--registered")
    return True if name and collection_path in OWN_FOLDERS - {FOLDER / "model" / block_folder(name)} else None


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.parent != FOLDER:
            item.add_marker(item.path.relative_to(FOLDER).parts[0])
    selected = list(items)
    if config.getoption("--quick"):
        selected = [item for item in selected if not is_slow(item) and not needs_fmu(item)]
    if config.getoption("--soak"):
        selected = [item for item in selected if has_long_form(item)]
    if block := config.getoption("--block"):
        folders = {block_folder(name): name for name in BLOCKS}
        if block not in folders:
            raise pytest.UsageError(f"no block has the folder {block!r}: choose one of {', '.join(sorted(folders))}")
        selected = [item for item in selected if belongs_to_block(item, block, folders[block]) and not needs_fmu(item)]
    if name := config.getoption("--registered"):
        if name not in BLOCKS:
            raise pytest.UsageError(f"no block has the name {name!r}: choose one of {', '.join(sorted(BLOCKS))}")
        selected = [item for item in selected if concerns_block(item, name)]
    if hasattr(config, "workerinput"):  # several processes: slow tests come first, so that none runs alone at the end
        selected.sort(key=lambda item: item.get_closest_marker("slow") is None)
    remaining = set(selected)
    config.hook.pytest_deselected(items=[item for item in items if item not in remaining])
    items[:] = selected


def is_slow(item: pytest.Item) -> bool:
    return item.get_closest_marker("slow") is not None


def needs_fmu(item: pytest.Item) -> bool:
    return "shared" in getattr(item, "fixturenames", ())


def belongs_to_block(item: pytest.Item, block: str, name: str) -> bool:
    """Whether a test belongs to this block: it is in the block's folder, or has the block's name as a parameter."""
    return item.path.parent == FOLDER / "model" / block or re.search(rf"\[.*\b{name}\b", item.name) is not None


def concerns_block(item: pytest.Item, name: str) -> bool:
    """Whether a test concerns a registered block: it belongs to the block, or it goes over all blocks by itself."""
    goes_over_all = item.get_closest_marker("all_blocks") or "blocks" in getattr(item, "fixturenames", ())
    return belongs_to_block(item, block_folder(name), name) or (
        goes_over_all and not any(other in item.name for other in BLOCKS)
    )


def has_long_form(item: pytest.Item) -> bool:
    """Whether a test draws random examples, or asks how many runs, calls or numbers it has to try."""
    return is_hypothesis_test(getattr(item, "obj", None)) or "soak" in getattr(item, "fixturenames", ())


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.getoption("--no-skips") and terminalreporter.stats.get("skipped"):
        terminalreporter.write_line("skipped tests are not allowed (--no-skips)", red=True)


def pytest_sessionfinish(session: pytest.Session) -> None:
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("--no-skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(scope="session")
def soak(request: pytest.FixtureRequest) -> Callable[[int, int], int]:
    """`soak(short, long)`: how many runs, calls or numbers a test tries that draws without Hypothesis; `long` with the
    option --soak."""
    is_long = bool(request.config.getoption("--soak"))
    return lambda short, long: long if is_long else short


@pytest.fixture(scope="session")
def all_parts(request: pytest.FixtureRequest) -> bool:
    """Whether a test does all that it can: `make quick` has no time for it; with the option --block there is."""
    return not request.config.getoption("--quick") or bool(request.config.getoption("--block"))


@pytest.fixture(scope="session")
def shared(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Shared:
    """What the processes of pytest-xdist share: each of them has its temporary folder in that of the whole run."""
    own = tmp_path_factory.getbasetemp()
    return Shared((own.parent if hasattr(request.config, "workerinput") else own) / "shared")


@pytest.fixture(scope="session")
def fmus(shared: Shared) -> Fmus:
    return Fmus(shared)


@pytest.fixture(scope="session")
def blocks(request: pytest.FixtureRequest) -> list[str]:
    """All registered blocks, for a test that needs them together; with --registered that one alone."""
    registered = request.config.getoption("--registered")
    return [name for name in BLOCKS if registered in (None, name)]


@pytest.fixture(params=["a file is in its place", "the user has no home"])
def no_cache(request: pytest.FixtureRequest, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The user's cache cannot be used. `cache` is a module's own fixture: a folder of a test in place of the user's."""

    def raise_no_home() -> Path:
        raise RuntimeError("the user has no home")

    if "file" in request.param:
        paths.cache_folder().touch()
    else:
        monkeypatch.setattr(paths, "cache_folder", raise_no_home)


@pytest.fixture(scope="session", params=BLOCKS)
def block(request: pytest.FixtureRequest) -> str:
    """The name of each registered block in turn."""
    return str(request.param)


@pytest.fixture(scope="session")
def block_fmu(fmus: Fmus, block: str) -> Path:
    """The FMU of each block in turn, python flavour."""
    return fmus.python(block)


@pytest.fixture(scope="session")
def block_native(fmus: Fmus, block: str) -> Path:
    """The FMU of each block in turn, native flavour."""
    return fmus.native(block)


@pytest.fixture(scope="session")
def fmu(fmus: Fmus) -> Path:
    """The Synchronizer's FMU, python flavour: for tests that serve for all blocks but need names of variables."""
    return fmus.python("Synchronizer")


@pytest.fixture(scope="session")
def native(fmus: Fmus) -> Path:
    """The Synchronizer's FMU, native flavour."""
    return fmus.native("Synchronizer")


@pytest.fixture
def motionsync(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The console script's function, in an empty folder and in this process: a process of its own takes a second."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(progress, "PATIENCE", 1e3)  # a busy machine makes no difference

    def call(*arguments: str | Path) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["motionsync", *map(str, arguments)])
        capsys.readouterr()
        status: Any = 0
        try:
            cli.main()
        except SystemExit as exit_:
            status = exit_.code or 0
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return call
