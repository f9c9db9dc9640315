"""Every scenario in this process, without an FMU: its expectations hold, its reference is met, and its run in compiled
code has the same bits."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.evaluate.key_figures import OWN_PEAKS, compute_key_figures
from motionsync_fmu.scenario.evaluate.reference_comparison import compare_with_reference
from motionsync_fmu.scenario.evaluate.verdict import needed_outputs
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario, When
from tests import ROOT
from tests.regenerate import examples
from tests.support.blocks.harness import MOTION
from tests.support.scenarios.recordings import assert_same, run_compiled
from tests.support.scenarios.verdicts import checks_of

SCENARIOS = pytest.mark.parametrize(
    "file",
    [
        *(pytest.param(file, id="/".join(file.parts[-3:-1])) for file in find_files(ROOT / "scenarios")),
        *(pytest.param(file, id=f"{name}/example") for name, file in zip(BLOCKS, examples(), strict=True)),
    ],
)
SMOOTHED = ("measured_line", "recorded_line", "counter_wraps")  # the master, by the step size


def at_its_place(scenario: Scenario, recording: Recording) -> bool:
    """Whether each piece is as long as the block reports it, by the positions of slave and master while the tool cuts,
    and the tool stays at its place on the material. A block that reports no pieces has none that could be wrong; of one
    that does not see the true line, the true lengths are expected within the scenario's tolerance."""
    if scenario.encoder:
        return True
    result = find_pieces(scenario, recording)
    off = [piece.measured - piece.length for piece in result if piece.measured is not None]
    return max([*map(abs, off), *(piece.wander for piece in result)], default=0.0) <= 1e-9


@SCENARIOS
def test_the_block_does_what_its_scenario_expects(file: Path, all_parts: bool) -> None:
    scenario = load_scenario(file)
    recording = recorded_compiled(scenario)
    assert_as_expected(scenario, recording)
    assert scenario.expectations or file in examples()
    deviations = compare_with_reference(scenario, recording)
    assert deviations, f"{file.parent} has no reference: `make references` writes it"
    assert min(d.points for d in deviations) >= 100
    if not all_parts:
        return
    assert_same(run_in_process(scenario, scenario.step_size), recording)
    shown = {v.name for v in scenario.recipe.variables.values() if v.declaration.role in OWN_PEAKS.values()}
    names = sorted(needed_outputs(scenario) | shown | {*MOTION})
    narrow = recorded_compiled(scenario, names)
    assert checks_of(scenario, narrow) == checks_of(scenario, recording)
    assert compute_key_figures(scenario, narrow) == compute_key_figures(scenario, recording)


@pytest.mark.slow
@SCENARIOS
@pytest.mark.parametrize("step_size", [0.007, 0.0471])
def test_a_scenario_means_the_same_at_other_step_sizes_or_says_why_not(file: Path, step_size: float) -> None:
    """In compiled code; at one of them it is compared with Python, too. A scenario that has to have its own step size
    runs within its cycles, or shows its events later."""
    scenario = load_scenario(file)
    if reason := scenario.step_refusal(step_size):
        cycles = f"{scenario.recipe.name} works in cycles of " if scenario.remote else scenario.step_bound
        assert cycles
        assert reason.startswith(cycles)
        if step_size == 0.007 and scenario.name not in SMOOTHED:
            assert_as_expected_late(scenario, 0.1 * step_size if scenario.remote else step_size)
        return
    recording = recorded_compiled(replace(scenario, step_size=step_size))
    assert_as_expected(scenario, recording, has_its_limits=step_size == scenario.step_size)
    if step_size == 0.0471:
        assert_same(run_in_process(scenario, step_size), recording)


def recorded_compiled(scenario: Scenario, names: Sequence[str] | None = None) -> Recording:
    (run,) = run_compiled(scenario, names=names)
    assert run.recording, run.failure
    return run.recording


def assert_as_expected(scenario: Scenario, recording: Recording, *, has_its_limits: bool = True) -> None:
    """`has_its_limits`: by how much a line that ramps makes the setpoint exceed a limit depends on the step."""
    result = [*checks_of(scenario, recording), *compare_with_reference(scenario, recording)]
    assert result
    broken = [check.text for check in result if not check.passed]
    assert [text for text in broken if has_its_limits or not text.startswith("no limit of the axis exceeded")] == []
    assert at_its_place(scenario, recording)
    is_reported = recording.values.get("master.input_warning", np.zeros(1)).any()
    assert is_reported == (scenario.name == "counter_wraps")


def assert_as_expected_late(scenario: Scenario, step_size: float) -> None:
    """An event shows at the first communication point after it, so its time is known to one step, of either run."""
    recording = recorded_compiled(replace(scenario, step_size=step_size))
    step = max(step_size, scenario.step_size)
    widened = [
        replace(e, tolerance=(e.tolerance or 0.0) + step) if isinstance(e, When) else e for e in scenario.expectations
    ]
    assert_as_expected(replace(scenario, expectations=tuple(widened)), recording)
    assert min(d.points for d in compare_with_reference(scenario, recording)) >= 5


def test_few_scenarios_are_bound_to_their_step_size() -> None:
    """Those whose block sees something at communication points alone: its limits, or a master without a velocity."""
    bound = [load_scenario(file) for file in find_files(ROOT / "scenarios")]
    assert {s.name for s in bound if s.step_bound} == {
        "alarm_positioning",
        "alarm_speed",
        "alarm_speed_in_each_phase",
        "alarm_acceleration_in_each_phase",
        "limits_not_checked",
        "position_to_cycle_variable",
        "position_only_input",
        "recorded_line",
        "measured_line",
        "counter_wraps",
    }


def test_a_cyclic_block_runs_at_steps_up_to_its_cycle() -> None:
    scenario = load_scenario(ROOT / "scenarios/RemoteSync/accelerating_axis/scenario.toml")
    assert scenario.step_refusal(0.002) == scenario.step_refusal(0.0013) == ""
    reason = "RemoteSync works in cycles of 0.002 s, and a step of 0.007 s is longer"
    assert scenario.step_refusal(0.007) == reason
