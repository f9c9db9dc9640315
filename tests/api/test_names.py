"""What `motionsync_fmu` offers: its names, what they cost, and that the command line calls them."""

import inspect
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import motionsync_fmu
from tests import ROOT

FUNCTIONS = ["explore", "run", "scenarios", "search", "simulate_many", "sweep"]
OF_COMMANDS = ["explore", "run", "search", "sweep"]
HEAVY = ["numpy", "fmpy", "matplotlib", "jinja2", "typer", "rich", "scipy", "pyarrow", "distributed"]
SNIPPET = """
from motionsync_fmu import RunResult, UserError, run, sweep

result: RunResult = run("CutToLength/basic_cut", set={"master.velocity": 400.0})
passed: bool = result.passed
length: float = result.pieces[0].length
latest: float = float(result["slave.position"][-1])
result.report("report.html")
rows = sweep("CutToLength/basic_cut", set={"length": [600.0, 800.0, 1000.0]}, output="rows")
rows.to_frame()
"""


def test_all_names_are_there_and_described() -> None:
    assert motionsync_fmu.__all__ == sorted([*FUNCTIONS, "RunResult", "UserError", "__version__"])
    for name in FUNCTIONS:
        function = getattr(motionsync_fmu, name)
        assert inspect.isfunction(function), name  # and no module of the same name
        assert function.__doc__, name


def test_the_names_stay_functions_when_all_modules_are_imported() -> None:
    """A package of the same name would take the function's place as soon as it is imported."""
    folder = Path(motionsync_fmu.__file__).parent
    assert not [name for name in FUNCTIONS if (folder / name).exists() or (folder / f"{name}.py").exists()]


def test_the_import_loads_nothing_heavy() -> None:
    code = f"import sys, motionsync_fmu; print(*[name for name in {HEAVY} if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert loaded.split() == []


@pytest.mark.parametrize("name", OF_COMMANDS)
def test_a_command_has_the_parameters_of_its_function_and_calls_it(name: str) -> None:
    """Beside them it has those that say how it prints; `--set` is a list of texts there."""
    command = import_module(f"motionsync_fmu.commands.{name}").command
    assert f"from ..api.{name} import {name}\n" in inspect.getsource(command)
    called = set(inspect.signature(getattr(motionsync_fmu, name)).parameters)
    renamed = {"setting": "set", "path": "scenario", "measure": "options"}
    own = {renamed.get(p, p) for p in inspect.signature(command).parameters}
    shown = {"as_json", "show", "no_report", "verbose", "yes", "samples", "method", "seed", "output"}
    assert own - shown <= called
    assert called - own <= {"progress", "notify", "report", "options"}


@pytest.mark.slow
def test_a_users_file_has_the_types_that_mypy_wants(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(SNIPPET)
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nstrict = true\n[mypy-pyarrow.*,pythonfmu.*,fmpy.*]\nignore_missing_imports = true\n")
    command = [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir", tmp_path / "cache", file]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
