"""What all tests share: the built FMUs, and the rule that CI accepts no skipped test."""

from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.build import Flavour, build, fmu_path
from motionsync_fmu.interface.recipe import Recipe


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--no-skips", action="store_true", help="a skipped test fails the run: for machines that have all")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if config.getoption("--no-skips") and terminalreporter.stats.get("skipped"):
        terminalreporter.write_line("skipped tests are not allowed here (--no-skips)", red=True)


def pytest_sessionfinish(session: pytest.Session) -> None:
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("--no-skips") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


class Fmus:
    """The FMUs of all blocks, positions in mm; each is built when it is first asked for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def python(self, name: str) -> Path:
        return self._built(Flavour.PYTHON, name)

    def native(self, name: str) -> Path:
        return self._built(Flavour.NATIVE, name)

    def _built(self, flavour: Flavour, name: str) -> Path:
        target = fmu_path(Recipe(name), self.folder, flavour)
        return target if target.exists() else build(flavour, Recipe(name), target)


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Fmus:
    return Fmus(tmp_path_factory.mktemp("fmus"))


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
