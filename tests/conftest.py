"""What all tests have in common: the built FMUs, and the rule that CI accepts no skipped test."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import is_hypothesis_test, settings
from hypothesis.internal.conjecture import providers

from motionsync.blocks import BLOCKS
from motionsync_fmu import cli
from motionsync_fmu.pages import progress
from tests.support.by_block import folder
from tests.support.command_line import Command, Outcome
from tests.support.fmus import Fmus, Shared

HERE = Path(__file__).parent


# Hypothesis mixes numbers from the project's loaded modules into what it draws. Without them, runs that are drawn the
# same every time depend neither on which tests run together nor on the numbers in the source.
providers._get_local_constants = lambda: providers._local_constants


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--no-skips", action="store_true", help="a skipped test fails the run: for machines that have all")
    parser.addoption("--quick", action="store_true", help="no FMU, no slow test, a tenth of the random examples")
    parser.addoption("--block", metavar="FOLDER", help="the tests of one block that need no FMU: gearing, say")


def pytest_configure(config: pytest.Config) -> None:
    for room in sorted(path.parent.name for path in HERE.glob("*/__init__.py")):
        config.addinivalue_line("markers", f"{room}: a test in tests/{room}")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        item.add_marker(item.path.relative_to(HERE).parts[0])
    chosen = items
    if config.getoption("--quick"):
        chosen = [item for item in chosen if not slow(item) and not needs_fmu(item)]
        for item in chosen:
            fewer_examples(item)
    if block := config.getoption("--block"):
        named = {folder(name): name for name in BLOCKS}
        if block not in named:
            raise pytest.UsageError(f"no block has the folder {block!r}: choose one of {', '.join(sorted(named))}")
        chosen = [item for item in chosen if belongs(item, block, named[block]) and not needs_fmu(item)]
    chosen = sorted(chosen, key=lambda item: item.get_closest_marker("slow") is None)  # none of them is left to the end
    kept = set(chosen)
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = chosen


def slow(item: pytest.Item) -> bool:
    """Whether a test is marked slow, or tests an oracle, on which a change of a block has no effect."""
    return item.get_closest_marker("slow") is not None or item.path.name == "test_oracle.py"


def needs_fmu(item: pytest.Item) -> bool:
    return "shared" in getattr(item, "fixturenames", ())


def belongs(item: pytest.Item, block: str, name: str) -> bool:
    """Whether a test belongs to this block: it stands in the block's folder, or has the block's name as a parameter."""
    return item.path.parent == HERE / "model" / block or re.search(rf"\[.*\b{name}\b", item.name) is not None


def fewer_examples(item: pytest.Item) -> None:
    """Run a tenth of the random examples, at least 5. A profile of Hypothesis would not change a test's own number."""
    test = getattr(item, "obj", None)
    if is_hypothesis_test(test):
        full = test._hypothesis_internal_use_settings
        test._hypothesis_internal_use_settings = settings(full, max_examples=max(full.max_examples // 10, 5))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.getoption("--no-skips") and terminalreporter.stats.get("skipped"):
        terminalreporter.write_line("skipped tests are not allowed here (--no-skips)", red=True)


def pytest_sessionfinish(session: pytest.Session) -> None:
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("--no-skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(scope="session")
def shared(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Shared:
    """What the processes of pytest-xdist share: each of them has its temporary folder in that of the whole run."""
    own = tmp_path_factory.getbasetemp()
    return Shared((own.parent if hasattr(request.config, "workerinput") else own) / "shared")


@pytest.fixture(scope="session")
def fmus(shared: Shared) -> Fmus:
    return Fmus(shared)


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
        except SystemExit as e:
            status = e.code or 0
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return call
