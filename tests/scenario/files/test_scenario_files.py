"""The scenarios through built FMUs, their references, FMPy's command line, and what their settings mean."""

import csv
import shlex
import shutil
import subprocess
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput
from motionsync_fmu.fmus.zip import zip_bytes
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.evaluate.csv_files import command_line, inputs_csv
from motionsync_fmu.scenario.evaluate.expectations import check_expectations
from motionsync_fmu.scenario.evaluate.reference_comparison import (
    ARCHIVE,
    compare_with_reference,
    find_reference,
    reference_file,
)
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run import simulation
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from motionsync_fmu.scenario.run.simulation import run_in_process, scheduled_steps, simulate
from tests import ROOT, regenerate
from tests.support.blocks.varied import few_with_all, kinds_of
from tests.support.compiler.calls import calls
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.recordings import assert_same, run_compiled
from tests.support.scenarios.scenario_texts import SEGMENTS, VALID
from tests.support.scenarios.stored_references import keep

SCENARIOS = ROOT / "scenarios"
FOLDERS = sorted(file.parent for file in SCENARIOS.rglob("scenario.toml"))
INPUTS = ("start", "master", "remote", "encoder", "drive", "set", "on", "cuts")  # tables of a scenario


def named(folder: Path) -> str:
    return folder.relative_to(SCENARIOS).as_posix()


# --- the scenarios that are there ---


def features(block: str) -> dict[str, set[Any]]:
    """By scenario of a block its kinds of inputs, and the states, faults and flags that it shows."""
    scenarios = [load_scenario(file) for file in find_files(SCENARIOS / block)]
    outputs = [v for v in Recipe(block).variables.values() if not v.settable]
    names = [v.name for v in outputs if v.kind == "Boolean" or v.name in ("state_code", "error_id")]
    result: dict[str, set[Any]] = {}
    for scenario, run in zip(scenarios, run_compiled(*scenarios, names=names), strict=True):
        assert run.recording
        raw = tomllib.loads(scenario.file.read_text("utf-8"))
        shown = {(name, x) for name in names for x in np.unique(run.recording.values[name]).tolist()}
        result[str(scenario.file)] = shown.union(kinds_of({key: raw[key] for key in INPUTS if key in raw}))
    return result


def test_a_scenario_is_kept_by_both_flavours_with_the_same_bits(block: str, fmus: Fmus) -> None:
    """The bits of compiled code in this process, which tests/model/test_scenarios.py checks in all scenarios; here few
    of them have together all inputs, states, faults and flags of all."""
    for file in few_with_all(features(block)):
        scenario = load_scenario(Path(file))
        (run,) = run_compiled(scenario)
        assert run.recording
        python, native = (
            simulate(scenario, fmu, scenario.step_size) for fmu in (fmus.python(block), fmus.native(block))
        )
        for recording in (python, native):
            assert_same(recording, run.recording)
        assert native.messages == python.messages


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_the_reference_is_that_of_the_oracle(folder: Path) -> None:
    assert {f.name for f in folder.iterdir()} - {"trace.csv"} == {"scenario.toml"}
    assert_reference_is_made(folder / "scenario.toml")


def assert_reference_is_made(file: Path) -> None:
    scenario, text = regenerate.with_reference(file, keep)
    reference = find_reference(scenario)
    assert reference
    assert reference.read_text("utf-8") == text, "the reference is not what `make references` writes"


@pytest.mark.parametrize("file", regenerate.examples(), ids=list(BLOCKS))
def test_the_reference_of_an_example_is_that_of_the_oracle(file: Path) -> None:
    assert_reference_is_made(file)


def test_an_archive_holds_the_references_of_its_scenarios_alone(block: str) -> None:
    files = [reference_file(load_scenario(file)) for file in find_files(SCENARIOS / block)]
    names = [file.relative_to(SCENARIOS / block).as_posix() for file in files]
    assert list(regenerate.archived(SCENARIOS / block / ARCHIVE)) == sorted(names)


def test_references_are_written_where_they_have_changed_and_their_differences_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A number that is 1e-6 greater, columns that are others, a scenario that is new and one that is no more."""
    folder = tmp_path / "Synchronizer"
    for name in ("polynomial", "falling_polynomial", "reversal_in_ramp"):
        shutil.copytree(SCENARIOS / "Synchronizer" / name, folder / name)
    (example,) = regenerate.examples(["Synchronizer"])
    copied = shutil.copytree(example.parent, tmp_path / "block") / example.name
    monkeypatch.setattr(regenerate, "SCENARIOS", tmp_path)
    monkeypatch.setattr(regenerate, "examples", lambda _: [copied])
    assert len([*regenerate.write_references("Synchronizer")]) == 3
    archive = folder / ARCHIVE
    whole, first = archive.read_bytes(), regenerate.archived(archive)
    assert [*regenerate.write_references("Synchronizer")] == []
    numbers, columns = (f"{name}/Synchronizer_ref.csv" for name in ("polynomial", "falling_polynomial"))
    header, start, *rows = first[numbers].decode().splitlines()
    cells = start.split(",")
    cells[1] = repr(float(cells[1]) + 1e-6)
    before = {
        numbers: "\n".join([header, ",".join(cells), *rows]).encode(),
        columns: first[columns].replace(b"slave.position", b"slave.other"),
        "gone/Synchronizer_ref.csv": first[columns],
    }
    archive.write_bytes(zip_bytes(before, time.gmtime()))
    changes = [*regenerate.write_references("Synchronizer")]
    assert sorted(changes) == [
        "Synchronizer/falling_polynomial: the reference has other columns or times",
        "Synchronizer/gone: the reference is no more",
        "Synchronizer/polynomial: slave.position differs by 1e-06 at 0.0 s",
        "Synchronizer/reversal_in_ramp: the reference is new",
    ]
    assert archive.read_bytes() == whole


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("reversal_in_ramp", 0),
        ("phasing_changed_while_executing", 0),
        ("position_only_input", 0),
        ("end_of_step_inputs", 1),  # FMPy initializes with the first step's inputs, here the master at its end
    ],
)
def test_fmpy_alone_runs_a_scenario_from_its_inputs(name: str, first: int, native: Path, tmp_path: Path) -> None:
    """The command line that `motionsync run` prints, and the variables of the reference."""
    scenario = load_scenario(SCENARIOS / "Synchronizer" / name / "scenario.toml")
    inputs = tmp_path / "inputs.csv"
    inputs.write_text(inputs_csv(scenario))
    words = shlex.split(command_line(scenario, native, inputs))
    assert words[:3] == ["fmpy", "simulate", str(native)]
    names = [d.name for d in compare_with_reference(scenario, simulate(scenario, native, scenario.step_size))]
    call = [str(Path(sys.executable).with_name("fmpy")), *words[1:], "--output-variables", *names]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with (tmp_path / "Synchronizer_out.csv").open(newline="") as f:
        header, *rows = list(csv.reader(f))
    table = np.array([[float({"True": 1.0, "False": 0.0}.get(x, x)) for x in row] for row in rows[first:]])
    assert table[-1, 0] == pytest.approx(scenario.stop_time, abs=1e-9)
    recording = Recording(table[:, 0], dict(zip(header[1:], table.T[1:], strict=True)), np.empty((0, 3)), [])
    deviations = compare_with_reference(scenario, recording)
    assert [d.name for d in deviations] == names
    assert [(d.name, d.greatest, d.at) for d in deviations if not d.passed] == []
    assert min(d.points for d in deviations) >= 100


def test_the_command_line_for_fmpy_quotes_paths_and_keeps_all_digits(tmp_path: Path) -> None:
    file = tmp_path / "a folder (1)" / "scenario.toml"
    file.parent.mkdir()
    file.write_text(VALID.replace("stop_time = 4.0", "stop_time = 4.0000001").replace("0.01", "0.0123456789"))
    scenario = load_scenario(file)
    inputs = file.with_name("inputs.csv")
    words = shlex.split(command_line(scenario, tmp_path / "an FMU.fmu", inputs))
    assert words[2] == str(tmp_path / "an FMU.fmu")
    options = dict(zip(words[3::2], words[4::2], strict=False))
    assert float(options["--stop-time"]) == 4.0000001
    assert float(options["--output-interval"]) == 0.0123456789
    assert str(inputs) in words


# --- many settings ---

MANY = 'title = "many"\nfmu = "Synchronizer"\nstop_time = 200.0\nstep_size = 100.0\n[master]\nvelocity = 1.0\n'


def many(folder: Path, count: int) -> Path:
    """A scenario with so many tables [[set]], each at a time of its own."""
    tables = [f"[[set]]\nat = {1.0 + 100.0 * i / count:.6f}\nrest_value = {i}.0\n" for i in range(count)]
    file = folder / f"{count}.toml"
    file.write_text(MANY + "".join(tables), "utf-8")
    return file


@pytest.mark.parametrize(
    "act",
    [
        load_scenario,
        lambda file: run_in_process(load_scenario(file), 100.0),
        lambda file: inputs_csv(load_scenario(file)),
    ],
)
def test_twice_the_settings_are_at_most_twice_the_work(act: Callable[[Path], object], tmp_path: Path) -> None:
    few, more = many(tmp_path, 200), many(tmp_path, 1600)
    act(few)  # what is read once for all scenarios
    assert calls(lambda: act(more)) <= 8 * calls(lambda: act(few))


def test_a_step_sets_and_gets_all_variables_of_a_type_in_one_call(fmu: Path, tmp_path: Path) -> None:
    """Of the master alone three Reals are set in each step, and one more that changes."""
    file = many(tmp_path, 50)
    scenario = load_scenario(file)
    points = len(list(scheduled_steps(scenario, 100.0)))
    called: Counter[str] = Counter()

    class Counted(FmuInstance):
        def call(self, function: Any, *arguments: Any, **options: Any) -> Any:
            called[function.__name__] += 1
            return super().call(function, *arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulation, "FmuInstance", Counted)
        simulate(scenario, fmu, 100.0)
    initial = 1
    assert called["fmi2SetReal"] == points + initial
    assert called["doStep"] == points
    assert called["fmi2GetReal"] == called["fmi2GetInteger"] == called["fmi2GetBoolean"] == points + initial


# --- what a scenario means between its points ---


def test_limits_hold_at_points_of_their_own_interval(fmu: Path, tmp_path: Path) -> None:
    """However short it is, and however long the steps: at least at both its ends."""
    file = tmp_path / "scenario.toml"
    file.write_text(
        VALID.replace("from = 0.0\nto = 1.0", "from = 0.301\nto = 0.302").replace("max = 90.0", "max = 90.3015")
    )
    scenario = load_scenario(file)
    recording = simulate(scenario, fmu, scenario.step_size)
    *_, limits = check_expectations(scenario, recording)
    assert limits.actual == "90.301 to 90.302 deg/s"
    assert not limits.passed


def test_the_inputs_at_the_end_of_a_step_are_those_before_a_jump(tmp_path: Path) -> None:
    """Also where the durations do not add up to the last bit of what is set: 0.1 + 0.7 < 0.8."""
    assert 0.1 + 0.7 < 0.8
    segments = "segments = [{ duration = 0.1 }, { duration = 0.7 }, { duration = 1.0, velocity = 10.0 }]"
    file = tmp_path / "scenario.toml"
    file.write_text(VALID.replace(SEGMENTS, segments).replace("at = 0.5", "at = 0.8"))
    scenario = load_scenario(file)
    for mode in MasterInput.START_OF_STEP, MasterInput.END_OF_STEP:
        running = replace(scenario, start={**scenario.start, "master.input_mode": mode})
        steps = {round(t, 6): values for t, _, values in scheduled_steps(running, 0.01)}
        assert steps[0.79]["master.velocity"] == 90.0
        assert steps[0.8]["master.velocity"] == 10.0
        assert "stop" not in steps[0.79]
        assert steps[0.8]["stop"] is True
