"""Compares recordings bit by bit."""

from collections.abc import Sequence

from motionsync_fmu.errors import UserError
from motionsync_fmu.native.loop.scripted import ScriptedRun, run_scenarios
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run import run_in_process
from motionsync_fmu.scenario.scenario import Scenario


def outputs(scenario: Scenario) -> list[str]:
    """All outputs and local variables of the block."""
    return [v.name for v in scenario.recipe.variables.values() if not v.settable]


def compiled(*scenarios: Scenario, names: Sequence[str] | None = None, threads: int = 1) -> list[ScriptedRun]:
    """Runs in compiled code; `names`: what is recorded, all outputs and locals if not given."""
    return run_scenarios(scenarios, outputs(scenarios[0]) if names is None else names, threads=threads)


def interpreted(scenario: Scenario) -> tuple[Recording | None, str]:
    """The recording of a run in Python, or why it failed, without the name of the file."""
    try:
        return run_in_process(scenario, scenario.step_size), ""
    except UserError as e:
        return None, str(e).removeprefix(f"{scenario.file}: ")


def assert_same(one: Recording, other: Recording) -> None:
    """Both have the same points, values, axis, settings and unmet reactions, to the last bit."""
    assert one.time.tobytes() == other.time.tobytes()
    assert one.values.keys() == other.values.keys()
    for name, values in one.values.items():
        assert values.tobytes() == other.values[name].tobytes(), name
    assert one.master.tobytes() == other.master.tobytes()
    assert list(one.settings) == list(other.settings)
    assert list(one.unmet) == list(other.unmet)
    assert one.script
    assert other.script
    assert (one.script.breaks, one.script.motions) == (other.script.breaks, other.script.motions)


def assert_as_in_python(scenario: Scenario) -> ScriptedRun:
    """The run in compiled code has the bits of that in Python, or fails in the same words."""
    recording, failure = interpreted(scenario)
    (run,) = compiled(scenario)
    assert run.failure == failure
    assert (run.recording is None) == (recording is None)
    if recording and run.recording:
        assert_same(recording, run.recording)
    return run
