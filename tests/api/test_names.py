"""What `motionsync_fmu` offers: its names, what they cost, and that the command line calls them."""

import inspect
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import motionsync_fmu
from motionsync_fmu import UserError
from motionsync_fmu.commands.app import COMMANDS
from tests import ROOT
from tests.support.project.command_line import Command, assert_one_line
from tests.support.project.mypy_cache import copied_cache

SCENARIO = "Synchronizer/polynomial"
CALLS = {  # each command, with arguments that are accepted
    "build": ["Synchronizer"],
    "describe": ["Synchronizer"],
    "error": ["17118"],
    "explore": ["Synchronizer"],
    "line": ["line/line.toml"],
    "list": [],
    "plan-line": [],
    "new": ["Synchronizer", "mine"],
    "run": [SCENARIO, "--no-report"],
    "search": [SCENARIO, "--vary", "rest_value=1..2", "--until", "passed"],
    "sweep": [SCENARIO, "--set", "rest_value=1", "--output", "rows"],
    "sweep-plot": ["rows", "--x", "rest_value"],
}
OTHER_NAMES = {"list": "scenarios"}  # `list` is a name of Python's own
FUNCTIONS = sorted(OTHER_NAMES.get(name, name.replace("-", "_")) for name in CALLS)
TYPES = ["BuiltFmu", "Description", "RefusedError", "RunResult", "Stepper", "UserError", "__version__"]
HEAVY = ["numpy", "fmpy", "matplotlib", "jinja2", "typer", "rich", "scipy", "pyarrow", "distributed", "motionsync"]
SNIPPET = """
from pathlib import Path

from motionsync_fmu import BuiltFmu, RunResult, UserError, build, describe, new, plan_line, run, sweep

result: RunResult = run("CutToLength/basic_cut", set={"master.velocity": "24 m/min", "kerf": 4.0})
passed: bool = result.passed
length: float = result.pieces[0].length
latest: float = float(result["slave.position"][-1])
result.report("report.html")
rows = sweep("CutToLength/basic_cut", set={"length": [600.0, 800.0, 1000.0]}, output="rows")
rows.to_frame()
fmus: list[BuiltFmu] = build("CutToLength", flavour="native", start={"kerf": 4.0})
size: int = fmus[0].path.stat().st_size
unit: str = describe("CutToLength").variables["kerf"].unit
file: Path = new("CutToLength", "mine", length=6000.0, line_speed="40 m/min")
confirmed: bool = plan_line(file, length=[600.0], set={"kerf": 4}).is_confirmed
try:
    run(file)
except UserError as error:
    print(error)
"""


def test_all_names_are_there_and_described() -> None:
    assert motionsync_fmu.__all__ == sorted([*FUNCTIONS, "simulate_many", *TYPES])
    for name in FUNCTIONS:
        function = getattr(motionsync_fmu, name)
        assert inspect.isfunction(function), name  # and no module of the same name
        assert function.__doc__, name


@pytest.mark.parametrize("name", [*FUNCTIONS, "simulate_many"])
def test_a_signature_shows_the_types_as_they_are_written(name: str) -> None:
    """Without `from __future__ import annotations` an ArrayLike fills a line with NumPy's own types."""
    text = str(inspect.signature(getattr(motionsync_fmu, name)))
    assert "numpy." not in text
    assert "collections.abc." not in text
    assert "Union[" not in text


def test_the_names_stay_functions_when_all_modules_are_imported() -> None:
    """A package of the same name would take the function's place as soon as it is imported."""
    folder = Path(motionsync_fmu.__file__).parent
    assert not [name for name in FUNCTIONS if (folder / name).exists() or (folder / f"{name}.py").exists()]


def test_the_import_loads_nothing_heavy() -> None:
    code = f"import sys, motionsync_fmu; print(*[name for name in {HEAVY} if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert loaded.split() == []


def test_each_command_has_a_function() -> None:
    assert set(COMMANDS) == set(CALLS)


@pytest.mark.parametrize("command", CALLS)
def test_a_command_calls_its_function_and_reports_its_error(
    motionsync: Command, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    def refuse(*_arguments: Any, **_options: Any) -> Any:
        raise UserError(f"{command} was called")

    name = OTHER_NAMES.get(command, command.replace("-", "_"))
    monkeypatch.setattr(import_module(f"motionsync_fmu.api.{name}"), name, refuse)
    monkeypatch.setattr("motionsync_fmu.commands.run.prepare_fmus", lambda *_: [])
    assert_one_line(motionsync(command, *CALLS[command]), f"motionsync: {command} was called")


@pytest.mark.parametrize("command", sorted({*CALLS} - {"list"}))
def test_a_command_has_the_parameters_of_its_function(command: str) -> None:
    """Beside them it has those that say how it prints; `--set` and `--measure` are lists of texts there."""
    name = command.replace("-", "_")
    function = getattr(motionsync_fmu, name)
    called = set(inspect.signature(function).parameters)
    if "options" in called:
        called |= {"samples", "method", "seed", "measures", "yes"}
    renamed = {"setting": "set", "path": "line" if name == "line" else "scenario", "measure": "measures"}
    own = {
        renamed.get(p, p)
        for p in inspect.signature(import_module(f"motionsync_fmu.commands.{name}").command).parameters
    }
    shown = {"as_json", "show", "no_report", "verbose"} | ({"output"} if command in ("plan-line", "run") else set())
    assert own - shown <= called
    assert called - own <= {"progress", "notify", "report", "finished", "options", "page"}


@pytest.mark.slow
def test_a_users_file_has_the_types_that_mypy_wants(tmp_path: Path) -> None:
    """Strictly, as pyproject.toml says. The folder is not the project's, so that mypy takes the installed package."""
    file = tmp_path / "mine.py"
    file.write_text(SNIPPET)
    options = ["--config-file", ROOT / "pyproject.toml", "--cache-dir", copied_cache(tmp_path)]
    command = [sys.executable, "-m", "mypy", *options, file]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
