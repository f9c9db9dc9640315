"""The plugin of pytest by which scenarios are tests: `pytest --motionsync scenarios/`.

Each file `scenario.toml` below the given folders is a test, and so is each other scenario file that is given by its
path. It fails if the run is not as expected, or not like the reference of the scenario. pytest imports this module
in each of its runs, so that everything else is imported when a scenario runs.
"""

import os
from collections.abc import Generator, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from .errors import UserError

if TYPE_CHECKING:
    from .api.run import RunResult

SCENARIO_FILE = "scenario.toml"
MOST_MESSAGES = 5  # of the FMU, in a failure


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("motionsync", "scenarios of motionsync as tests")
    group.addoption("--motionsync", action="store_true", help="run each scenario.toml as a test")
    group.addoption(
        "--motionsync-output",
        metavar="DIR",
        help="write the results and the report of each scenario to DIR/<FMU>/<scenario>/",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "ScenarioFile | None":
    """The file, if it is a scenario."""
    if not parent.config.getoption("--motionsync"):
        return None
    is_named = file_path.suffix == ".toml" and parent.session.isinitpath(file_path)
    if file_path.name != SCENARIO_FILE and not is_named:
        return None
    file: ScenarioFile = ScenarioFile.from_parent(parent, path=file_path)
    return file


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, Any, Any]:
    """What a folder has, and with it a scenario that is no file, as a link that leads nowhere: pytest leaves it out."""
    report = yield
    file = collector.path / SCENARIO_FILE
    if (
        isinstance(collector, pytest.Directory)
        and collector.config.getoption("--motionsync")
        and os.path.lexists(file)
        and not file.is_file()
    ):
        report.result.append(ScenarioFile.from_parent(collector, path=file))
    return report


class ScenarioFile(pytest.File):
    """A scenario's file, which has one test."""

    def collect(self) -> "Iterable[ScenarioItem]":
        item: ScenarioItem = ScenarioItem.from_parent(self, name=self.path.parent.name)
        return [item]


class ScenarioItem(pytest.Item):
    """The test that a scenario runs as expected."""

    def runtest(self) -> None:
        """Run the scenario.

        Raises:
            UserError: the scenario is not valid, or the FMU refused a value.
            NotAsExpectedError: the run is not as expected.
        """
        from . import run  # noqa: PLC0415 (see above)

        result = run(self.path)
        if folder := self.config.getoption("--motionsync-output"):
            outcome = result.write(Path(folder) / result.scenario.label)
            self.add_report_section("call", "motionsync", f"report: {outcome.report}")
        if not result.passed:
            raise NotAsExpectedError(result)

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        """What was expected and what was found, in place of a traceback."""
        if isinstance(excinfo.value, UserError | NotAsExpectedError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Where the test is, and its name."""
        return self.path, 0, f"scenario {self.name}"


class NotAsExpectedError(Exception):
    """The run of a scenario is not as expected; the text has each expectation that is not met, with what was found."""

    def __init__(self, result: "RunResult") -> None:
        outcome = result.outcome
        lines = [f"{result.scenario.file}: {result.scenario.title}"]
        for check in (c for c in outcome.expectations if not c.passed):
            lines += [f"  expected: {check.expected}", f"  found:    {check.actual}"]
        lines += [f"  reference: {deviation.text}" for deviation in outcome.reference if not deviation.passed]
        lines += [f"  note: {note}" for note in outcome.notes]
        lines += [f"  the FMU logged {message}" for message in outcome.messages[:MOST_MESSAGES]]
        super().__init__("\n".join(lines))
