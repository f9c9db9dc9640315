"""`pytest --motionsync`: scenarios as tests in a user's own project."""

import os
import shutil
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from motionsync_fmu import run
from tests.support.project.workshop import STOP, scenario

pytest_plugins = ["pytester"]

NAME = "motionsync_fmu.pytest_plugin"
INSTALLED = [entry.value for entry in entry_points(group="pytest11")]
PLUGIN = [] if NAME in INSTALLED else ["-p", NAME]


@pytest.fixture
def project(pytester: pytest.Pytester, built: Path) -> pytest.Pytester:
    """A user's project: two scenarios that are as expected, one that is not, one with a mistake, and another test."""
    shutil.copytree(built, "build")
    scenario("scenarios/good")
    scenario("scenarios/late", STOP.replace("= 27.5", "= 27.6").replace("time = 0.4", "time = 0.3"))
    scenario("scenarios/wrong", STOP.replace("rest_value", "rest_values"))
    Path("other.toml").write_text(STOP, "utf-8")
    Path("scenarios/test_own.py").write_text("def test_own():\n    pass\n")
    return pytester


def test_each_scenario_is_a_test_with_a_readable_failure(project: pytest.Pytester) -> None:
    """Half way to the end of the stop the slave is at 27.5, and it is out of sync at 0.4 s (workshop.py)."""
    options = (*PLUGIN, "-p", "no:cacheprovider", "--motionsync", "--motionsync-output", "results", "-v", "-rA")
    result = project.runpytest_subprocess(*options, "scenarios", "other.toml")
    result.assert_outcomes(passed=3, failed=2)
    result.stdout.fnmatch_lines(
        [
            "scenarios/good/scenario.toml::good PASSED*",
            "*scenario late*",
            "*scenarios/late/scenario.toml: A stop along a parabola",
            "  expected: slave.position = 27.6 ± 1e-9 at 0.3 s",
            "  found:    27.5",
            "  expected: first synchronized == false at 0.3 s*",
            "  found:    0.4 s",
            "*scenarios/wrong/scenario.toml:*: rest_values: Synchronizer has no variable 'rest_values'; *'rest_value'?",
        ]
    )
    output = result.stdout.str()
    assert "Traceback" not in output
    assert "pytest_plugin.py" not in output
    assert Path("results/Synchronizer/late/report.html").is_file()
    assert Path("results/Synchronizer/good/Synchronizer_out.csv").is_file()


@pytest.mark.parametrize("kind", ["a link to nothing", "a link to itself", "a folder", "a pipe"])
def test_a_scenario_that_is_no_file_fails(project: pytest.Pytester, kind: str) -> None:
    file = Path("scenarios/gone/scenario.toml")
    file.parent.mkdir()
    if kind == "a folder":
        file.mkdir()
    elif kind == "a pipe":
        os.mkfifo(file)
    else:
        file.symlink_to(file.name if kind == "a link to itself" else "nothing.toml")
    shutil.rmtree("scenarios/late")
    shutil.rmtree("scenarios/wrong")
    for folder in ("scenarios", "scenarios/gone"):
        result = project.runpytest_subprocess(*PLUGIN, "-p", "no:cacheprovider", "--motionsync", folder)
        result.assert_outcomes(passed=2 if folder == "scenarios" else 0, failed=1)
        result.stdout.fnmatch_lines(["*scenario gone*", "*scenarios/gone/scenario.toml*: no*"])
        assert "Traceback" not in result.stdout.str()


def test_without_the_option_no_scenario_is_a_test_and_nothing_is_loaded(project: pytest.Pytester) -> None:
    Path("scenarios/test_own.py").write_text(
        "import sys\n\ndef test_own():\n    assert 'motionsync_fmu.pytest_plugin' in sys.modules\n"
        "    assert not {'numpy', 'fmpy', 'typer', 'motionsync'} & {*sys.modules}\n"
    )
    command = [sys.executable, "-m", "pytest", *PLUGIN, "-p", "no:cacheprovider", "-q", "scenarios"]
    result = project.run(*command)
    result.assert_outcomes(passed=1)


def test_a_run_can_be_the_reference_of_later_ones(project: pytest.Pytester) -> None:
    """The parabola's acceleration depends on the phasing: another one is another trajectory."""
    file = Path("scenarios/good/scenario.toml")
    first = run(file)
    assert first.outcome.reference == []
    assert first.write_reference("slave.position", "slave.velocity") == file.with_name("Synchronizer_ref.csv")
    again = run(file)
    assert again.passed
    assert [deviation.name for deviation in again.outcome.reference] == ["slave.position", "slave.velocity"]
    file.write_text(STOP.replace("output_phasing = 10.0", "output_phasing = 10.1"), "utf-8")
    result = project.runpytest_subprocess(*PLUGIN, "-p", "no:cacheprovider", "--motionsync", "scenarios/good")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["  reference: slave.position: * from the reference at * s, * allowed"])
