"""What all tests share: the built FMUs, and the rule that CI accepts no skipped test."""

from pathlib import Path

import pytest

from motionsync_fmu.build import Recipe, build_native, build_python


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
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Synchronizer's FMU, python flavour, positions in mm."""
    return build_python(Recipe("Synchronizer"), tmp_path_factory.mktemp("fmus") / "Synchronizer.fmu")


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, native flavour."""
    return build_native(Recipe("Synchronizer"), tmp_path_factory.mktemp("native") / "Synchronizer.fmu")
