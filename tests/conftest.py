"""What all tests have in common: the built FMUs, and the rule that CI accepts no skipped test."""

import os
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from tests.support.fmus import Fmus, Shared


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--no-skips", action="store_true", help="a skipped test fails the run: for machines that have all")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.getoption("--no-skips") and terminalreporter.stats.get("skipped"):
        terminalreporter.write_line("skipped tests are not allowed here (--no-skips)", red=True)


def pytest_sessionfinish(session: pytest.Session) -> None:
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("--no-skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Shared:
    """What the processes of pytest-xdist share: each of them has its temporary folder in that of the whole run."""
    own = tmp_path_factory.getbasetemp()
    return Shared((own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "shared")


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
    """The same, native flavour."""
    return fmus.native(block)


@pytest.fixture(scope="session")
def fmu(fmus: Fmus) -> Path:
    """The Synchronizer's, python flavour: for tests of what is the same for every block, but speaks of variables."""
    return fmus.python("Synchronizer")


@pytest.fixture(scope="session")
def native(fmus: Fmus) -> Path:
    """The same, native flavour."""
    return fmus.native("Synchronizer")
