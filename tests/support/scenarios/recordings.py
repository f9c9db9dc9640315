"""Compares recordings bit by bit."""

from collections.abc import Sequence

from motionsync_fmu.batch.scripted_runs import ScriptedRun, run_scenarios
from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario


def output_names(scenario: Scenario) -> list[str]:
    """All outputs and local variables of the block."""
    return [v.name for v in scenario.recipe.variables.values() if not v.settable]


def run_compiled(*scenarios: Scenario, names: Sequence[str] | None = None, threads: int = 1) -> list[ScriptedRun]:
    """Run scenarios in compiled code; `names`: of what is recorded, by default all outputs and locals."""
    return run_scenarios(scenarios, output_names(scenarios[0]) if names is None else names, threads=threads)


def run_interpreted(scenario: Scenario) -> tuple[Recording | None, str]:
    """The recording of a run in Python, or why it failed, without the name of the file."""
    try:
        return run_in_process(scenario, scenario.step_size), ""
    except UserError as error:
        return None, str(error).removeprefix(f"{scenario.file}: ")


def assert_same(first: Recording, second: Recording) -> None:
    """Both have the same points, values, axis, settings and unmet reactions, to the last bit."""
    assert first.time.tobytes() == second.time.tobytes()
    assert first.columns.keys() == second.columns.keys()
    for name, values in first.columns.items():
        assert values.tobytes() == second.columns[name].tobytes(), name
    assert first.master.tobytes() == second.master.tobytes()
    assert list(first.settings) == list(second.settings)
    assert list(first.unmet) == list(second.unmet)
    assert first.script
    assert second.script
    assert (list(first.script.breaks), first.script.motions) == (list(second.script.breaks), second.script.motions)


def assert_as_in_python(scenario: Scenario) -> ScriptedRun:
    """The run in compiled code has the bits of that in Python, or fails in the same words."""
    recording, failure = run_interpreted(scenario)
    (run,) = run_compiled(scenario)
    assert run.failure == failure
    assert (run.recording is None) == (recording is None)
    if recording and run.recording:
        assert_same(recording, run.recording)
    return run
