"""The variables of RemoteSync, their limits, and the start values that are refused."""

import math
from typing import Any

import pytest

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Fault, Refusal
from motionsync_fmu.interface.variables import variables
from tests.model.remote_sync.harness import CONTRADICTIONS, RemoteSyncHarness

FIXED: dict[str, Any] = {
    "task_cycle_time": 0.002,
    "data_cycle_time": 0.0,
    "estimator": 1,
    "threshold_for_sync": 0.05,
    "max_cycle_index_difference": 7,
    "age_of_data_limit": 7,
    "periods_for_mean_drift": 1,
    "slope1_numerator": 0.95,
    "slope1_denominator": 0.5,
    "end_of_transition_limit": 90,
    "new_drift_blending_cycles": 90,
    "time_mode_blending_cycles": 90,
    "force_time_mode": False,
    "automatic_reinit": False,
    "start_up_mode": 4,
    "fall_back_mode": 2,
    "use_acceleration": True,
    "pt1_factor_position": 3.0,
    "pt1_factor_velocity": 3.0,
    "blending_time": 0.06,
}
TUNABLE = {"delay_time_offset": 0.0, "max_position_difference": 0.0}
INPUTS = {
    "enable": True,
    "remote.cycle_index": 0,
    "remote.position": 0.0,
    "remote.velocity": 0.0,
    "remote.acceleration": 0.0,
}
OUTPUTS = {
    *("correction_time", "corrected_cycle_index", "drift", "synced", "start_up", "warning"),
    *("state", "state_code", "error", "error_id"),
}
WATCHED = {
    *("cycle_index_difference", "equal_data_total", "equal_data_consecutive", "beats"),
    *("local.cycles", "local.difference", "local.transition", "local.beat_distance"),
}


def test_variables_are_those_of_the_description() -> None:
    block = RemoteSync()
    declared = variables(block)

    def of(causality: str, variability: str) -> dict[str, Any]:
        return {v.name: v.start for v in declared if (v.causality, v.variability) == (causality, variability)}

    assert of("parameter", "fixed") == FIXED
    assert of("parameter", "tunable") == TUNABLE
    assert of("input", "discrete") == INPUTS
    assert of("input", "continuous") == {}
    assert set(of("output", "discrete")) == OUTPUTS
    assert set(of("local", "discrete")) == WATCHED
    motion = {f"slave.{name}" for name in ("position", "velocity", "acceleration", "jerk")}
    assert set(of("output", "continuous")) == motion
    assert not hasattr(block, "master")


AGREEING: list[dict[str, Any]] = [
    {},
    {"data_cycle_time": 0.002, "estimator": 2},
    {"data_cycle_time": 0.014},
    {"data_cycle_time": 0.016, "age_of_data_limit": 0},
    {"data_cycle_time": 0.016, "age_of_data_limit": 8},
    {"data_cycle_time": 0.002 / 7},
    {"data_cycle_time": 0.00025, "max_cycle_index_difference": 0},
    {"data_cycle_time": 20.0, "age_of_data_limit": 0},
    {"age_of_data_limit": 1, "max_cycle_index_difference": 1},
]


@pytest.mark.parametrize(("values", "refusal", "_"), CONTRADICTIONS)
def test_parameters_that_contradict_one_another_are_refused(values: Any, refusal: Refusal, _: str) -> None:
    block = RemoteSync()
    for name, value in values.items():
        setattr(block, name, value)
    assert block.initialize() == refusal


@pytest.mark.parametrize("values", AGREEING)
def test_parameters_that_just_agree_are_taken(values: dict[str, Any]) -> None:
    assert RemoteSyncHarness(values)["error"] is False


BAD: dict[str, tuple[Any, ...]] = {
    "task_cycle_time": (0.0, -0.002, math.nan, math.inf, 1e-10, 1.1e6),
    "data_cycle_time": (-0.002, math.nan, math.inf, 1.1e6),
    "estimator": (0, 3),
    "threshold_for_sync": (0.0, -0.05, math.nan, math.inf),
    "max_cycle_index_difference": (-1,),
    "age_of_data_limit": (-1,),
    "periods_for_mean_drift": (0, -1, 65),
    "delay_time_offset": (math.nan, math.inf, 1.1e6),
    "slope1_numerator": (0.0, -0.1, 1.0000001, math.nan),
    "slope1_denominator": (0.0, 1.0, -0.5, math.nan),
    "end_of_transition_limit": (0, -90),
    "new_drift_blending_cycles": (0, -1),
    "time_mode_blending_cycles": (0, -1),
    "start_up_mode": (0, 3, 5),
    "fall_back_mode": (0, 3, 4),
    "max_position_difference": (-0.1, math.nan, math.inf),
    "pt1_factor_position": (0.0, -3.0, math.nan),
    "pt1_factor_velocity": (0.0, -3.0, math.inf),
    "blending_time": (-0.06, math.nan, math.inf),
    "remote.position": (math.nan, math.inf, 1.1e12),
    "remote.velocity": (math.nan, -1.1e12),
    "remote.acceleration": (math.nan, -math.inf),
}


@pytest.mark.parametrize("name", BAD)
def test_values_out_of_range_are_named_with_the_range(name: str) -> None:
    (variable,) = (v for v in variables(RemoteSync()) if v.name == name)
    for value in BAD[name]:
        assert variable.refusal(value).startswith(f"{name} = ")
        assert "is not allowed: it must be " in variable.refusal(value)
    assert variable.allows(variable.start)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("slope1_numerator", (1.0, 1e-9)),
        ("slope1_denominator", (1e-9, 0.999999)),
        ("periods_for_mean_drift", (1, 64)),
        ("end_of_transition_limit", (1, 2**31 - 1)),
        ("blending_time", (0.0, 1e6)),
        ("data_cycle_time", (0.0, 1e-9)),
        ("start_up_mode", (1, 2, 4)),
        ("fall_back_mode", (1, 2)),
    ],
)
def test_values_at_the_edge_of_their_range_are_taken(name: str, values: tuple[Any, ...]) -> None:
    (variable,) = (v for v in variables(RemoteSync()) if v.name == name)
    assert all(variable.allows(value) for value in values)


def test_faults_and_refusals_speak_of_variables_of_the_block() -> None:
    names = {v.name for v in variables(RemoteSync())}
    refusals = [refusal for refusal in Refusal if refusal != Refusal.NONE]
    assert len(refusals) == 5
    assert all({*choice.names} <= names for choice in (*refusals, *Fault))
    assert [int(fault) for fault in Fault] == [0, 0x4B51, 0x4B52, 0x4B53, 0x4B56, 0x4B59]
