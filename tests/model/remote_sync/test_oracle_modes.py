"""The RemoteSync's oracle against numbers worked out by hand: faults, modes and axis values, cycles, refusals."""

import math
import random
from fractions import Fraction

import pytest

from tests.model.remote_sync.oracle_cases import (
    BEAT,
    BYPASS,
    PHASE,
    PT1,
    TIME,
    UNIFORM,
    T,
    beating,
    close,
    column,
    run,
    since,
)
from tests.oracle.remote_sync import RemoteSyncOracle, refusal
from tests.oracle.remote_sync_estimators import whole_ratio

# --- faults -----------------------------------------------------------------------------------------------------------


def losing(lost: int) -> list[int]:
    """Telegrams 50 … 49 + lost do not arrive."""
    return [49 if 50 <= n < 50 + lost else n for n in range(100)]


def test_six_lost_telegrams_are_tolerated() -> None:
    rows = run(losing(6))
    assert not any(column(rows, "error"))
    assert (rows[55]["equal_data_consecutive"], rows[56]["cycle_index_difference"]) == (6, 7)
    assert (rows[56]["equal_data_consecutive"], rows[56]["equal_data_total"]) == (0, 6)
    assert rows[55]["correction_time"] == close(6 * T)


def test_a_step_beyond_the_limit_is_a_fault() -> None:
    rows = run(losing(7))
    assert (since(rows, "error"), rows[57]["error_id"], rows[57]["cycle_index_difference"]) == (57, 0x4B51, 8)
    assert (rows[57]["state"], rows[57]["start_up"]) == (PT1, False)
    assert rows[-1]["correction_time"] == rows[56]["correction_time"] == close(7 * T)
    assert rows[-1]["corrected_cycle_index"] == 56.0
    backwards = run([*range(100, 150), 141, 142])
    assert (backwards[50]["error_id"], backwards[50]["cycle_index_difference"]) == (0x4B51, -8)


def test_data_that_stand_too_long_are_a_fault() -> None:
    rows = run(losing(20))
    assert (since(rows, "error"), rows[57]["error_id"], rows[57]["equal_data_consecutive"]) == (57, 0x4B52, 8)


def test_a_correction_beyond_the_limit_is_a_fault() -> None:
    indices = [n + 6 * (n >= 50) + 3 * (n >= 51) + (n >= 52) for n in range(60)]
    rows = run(indices)
    assert (since(rows, "error"), rows[52]["error_id"]) == (52, 0x4B53)
    assert rows[52]["correction_time"] == close(-9 * T)


def test_zero_takes_the_limits_away() -> None:
    rows = run([*range(50), *[49] * 50, *range(400, 450)], max_cycle_index_difference=0, age_of_data_limit=0)
    assert not any(column(rows, "error"))
    assert rows[99]["equal_data_consecutive"] == 50


def test_a_bad_tunable_is_a_fault_of_the_cycle_that_reads_it() -> None:
    oracle = RemoteSyncOracle()
    oracle.step({}, T)
    assert oracle.step({"remote.cycle_index": 1, "delay_time_offset": math.nan}, T)["error_id"] == 0x4B56
    assert oracle.outputs["correction_time"] == 0.0
    oracle = RemoteSyncOracle()
    assert oracle.step({"max_position_difference": -1.0}, T)["error_id"] == 0x4B56


@pytest.mark.parametrize(("mode", "error_id"), [(TIME, 0x4B59), (PT1, 0), (BYPASS, 0)])
def test_a_position_shifted_too_far_is_a_fault_where_it_is_shifted(mode: int, error_id: int) -> None:
    """One cycle at 100 u/s is 0.2 u."""
    rows = run(losing(1), {"remote.velocity": 100.0}, max_position_difference=0.19, start_up_mode=mode)
    assert rows[50]["error_id"] == error_id
    assert rows[50]["correction_time"] == close(0.0 if error_id else T)
    rows = run(losing(1), {"remote.velocity": 100.0}, max_position_difference=0.21, start_up_mode=mode)
    assert rows[50]["error_id"] == 0


def test_automatic_reinit_makes_the_next_cycle_a_first_one() -> None:
    rows = run([*range(60), *range(560, 600)], automatic_reinit=True)
    assert column(rows, "error_id")[59:62] == [0, 0x4B51, 0]
    assert rows[61]["corrected_cycle_index"] == 561.0
    assert (rows[61]["state"], rows[61]["cycle_index_difference"]) == (TIME, 0)
    assert column(rows, "start_up")[59:62] == [True, False, True]


def test_a_fault_stays_until_enable_goes_and_comes() -> None:
    oracle = RemoteSyncOracle()
    for index in [*range(60), *range(560, 600)]:
        oracle.step({"remote.cycle_index": index}, T)
    assert (oracle.outputs["error_id"], oracle.outputs["start_up"]) == (0x4B51, False)
    off = oracle.step({"enable": False, "remote.cycle_index": 600}, T)
    assert (off["state"], off["error"], off["error_id"], off["synced"], off["start_up"]) == (
        BYPASS,
        False,
        0,
        False,
        False,
    )
    on = oracle.step({"enable": True, "remote.cycle_index": 601}, T)
    assert (on["state"], on["start_up"], on["corrected_cycle_index"]) == (TIME, True, 601.0)


def test_enable_false_ends_the_synchronization() -> None:
    oracle = RemoteSyncOracle(UNIFORM)
    for index in beating(1400, 500, 1000):
        oracle.step({"remote.cycle_index": index}, T)
    assert oracle.outputs["synced"]
    off = oracle.step({"enable": False, "remote.cycle_index": 1402}, T)
    assert (off["synced"], off["state"], off["correction_time"]) == (False, BYPASS, close(0.798 * T))
    on = oracle.step({"enable": True, "remote.cycle_index": 1403}, T)
    assert (on["synced"], on["drift"], on["beats"], on["corrected_cycle_index"]) == (False, 0.0, 0, 1403.0)


@pytest.mark.parametrize("name", ["remote.position", "remote.velocity", "remote.acceleration"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -1.1e12])
def test_an_input_out_of_range_changes_nothing(name: str, value: float) -> None:
    oracle, other = RemoteSyncOracle(), RemoteSyncOracle()
    with pytest.raises(ValueError, match=name):
        oracle.step({name: value, "remote.cycle_index": 77}, T)
    assert oracle.step({}, T) == other.step({}, T)


@pytest.mark.parametrize("h", [0.0, -T, math.nan, math.inf, 1.1e6, 2.1e3])
def test_a_step_out_of_range_is_refused(h: float) -> None:
    """2100 s are more than 10⁶ cycles."""
    with pytest.raises(ValueError, match="step size"):
        RemoteSyncOracle().step({}, h)


# --- modes and axis values --------------------------------------------------------------------------------------------

MOVING = {"remote.position": 5.0, "remote.velocity": 40.0, "remote.acceleration": 1000.0}


@pytest.mark.parametrize("use", [True, False])
def test_the_axis_is_shifted_by_the_correction_time(use: bool) -> None:
    (row,) = run([0], MOVING, delay_time_offset=0.01, use_acceleration=use)
    a = 1000.0 if use else 0.0
    assert row["correction_time"] == 0.01
    assert row["slave.position"] == close(5 + 0.4 + a * 0.01**2 / 2)
    assert (row["slave.velocity"], row["slave.acceleration"]) == (close(40 + a * 0.01), a)
    assert row["slave.jerk"] == 0.0


def test_bypass_passes_the_axis_on() -> None:
    (row,) = run([0], MOVING, delay_time_offset=0.01, start_up_mode=BYPASS, use_acceleration=False)
    assert [row[f"slave.{name}"] for name in ("position", "velocity", "acceleration")] == [5.0, 40.0, 1000.0]


def test_pt1_takes_a_quarter_of_what_is_missing_in_each_cycle() -> None:
    oracle = RemoteSyncOracle({"start_up_mode": PT1, "pt1_factor_velocity": 1.0})
    assert oracle.step({}, T)["slave.position"] == 0.0
    positions, velocities = [], []
    for index in (1, 2, 3):
        row = oracle.step({"remote.cycle_index": index, "remote.position": 4.0, "remote.velocity": 8.0}, T)
        positions.append(row["slave.position"])
        velocities.append(row["slave.velocity"])
    assert positions == [1.0, 1.75, 2.3125]
    assert velocities == [4.0, 6.0, 7.0]


def test_modes_are_blended_over_the_blending_time() -> None:
    """From TIME, 0.02 s ahead at 40 u/s, to BYPASS within 30 cycles; reversed_row back halfway."""
    parameters = {"delay_time_offset": 0.02, "use_acceleration": False}
    oracle = RemoteSyncOracle(parameters, {"remote.velocity": 40.0})
    position = [oracle.step({"remote.cycle_index": n}, T)["slave.position"] for n in range(5)]
    assert position == [close(0.8)] * 5
    position = [oracle.step({"enable": False}, T)["slave.position"] for _ in range(15)]
    assert position == [close(0.8 * (1 - n / 30)) for n in range(15)]
    position = [oracle.step({"enable": True, "remote.cycle_index": n}, T)["slave.position"] for n in range(40)]
    assert position == [close(0.4 + 0.4 * min(n, 30) / 30) for n in range(40)]


def test_without_a_blending_time_the_mode_changes_at_once() -> None:
    oracle = RemoteSyncOracle({"delay_time_offset": 0.02, "blending_time": 0.0}, {"remote.velocity": 40.0})
    assert oracle.step({}, T)["slave.position"] == close(0.8)
    assert oracle.step({"enable": False}, T)["slave.position"] == 0.0


def test_before_the_first_cycle_the_axis_is_as_received() -> None:
    outputs = RemoteSyncOracle({"delay_time_offset": 0.02}, MOVING).outputs
    assert (outputs["slave.position"], outputs["correction_time"], outputs["state"]) == (5.0, 0.0, TIME)
    assert outputs["start_up"]
    off = RemoteSyncOracle(None, {"enable": False}).outputs
    assert (off["state"], off["start_up"]) == (BYPASS, False)


# --- cycles and steps -------------------------------------------------------------------------------------------------


def test_shorter_steps_hold_the_outputs() -> None:
    oracle = RemoteSyncOracle()
    seen = [oracle.step({"remote.cycle_index": n}, T / 4)["corrected_cycle_index"] for n in range(9)]
    assert seen == [0.0] * 4 + [1.0] * 4 + [2.0]  # D = 3 at 4 is not worked off yet
    assert oracle.outputs["cycle_index_difference"] == 4


def test_longer_steps_repeat_the_inputs() -> None:
    oracle = RemoteSyncOracle()
    oracle.step({}, T)
    row = oracle.step({"remote.cycle_index": 5}, 5 * T)
    assert (row["equal_data_consecutive"], row["equal_data_total"], row["corrected_cycle_index"]) == (4, 4, 5.0)
    other = RemoteSyncOracle()
    for index in (0, 5, 5, 5, 5, 5):
        other.step({"remote.cycle_index": index}, T)
    assert other.outputs == row


@pytest.mark.parametrize(("share", "cycles"), [(1 + 5e-7, 1), (1 + 2e-6, 2), (1 - 5e-7, 1)])
def test_a_cycle_at_the_end_of_a_step_is_the_next_ones(share: float, cycles: int) -> None:
    oracle = RemoteSyncOracle()
    oracle.step({"remote.cycle_index": 3}, share * T)
    assert oracle.outputs["equal_data_total"] == cycles - 1
    oracle.step({"remote.cycle_index": 4}, (2 - share) * T)
    assert oracle.outputs["equal_data_total"] == cycles - 1


@pytest.mark.parametrize("seed", range(6))
def test_whatever_is_received_the_outputs_are_numbers(seed: int) -> None:
    noise = random.Random(seed)
    parameters = {
        "estimator": noise.choice((BEAT, PHASE)),
        "end_of_transition_limit": noise.choice((1, 3, 20)),
        "new_drift_blending_cycles": noise.choice((1, 10)),
        "automatic_reinit": True,
    }
    oracle, index = RemoteSyncOracle(parameters), 0
    for _ in range(400):
        index += noise.choice((1,) * 20 + (0, 2, 3, -1, 9))
        inputs = {"remote.cycle_index": index, "enable": noise.random() < 0.99, "remote.velocity": noise.gauss(0, 9)}
        row = oracle.step(inputs, T * noise.choice((1, 1, 1, 0.3, 2.5)))
        assert all(math.isfinite(value) for value in row.values())
        assert row["start_up"] + row["synced"] + row["error"] + (row["state"] == BYPASS) == 1


# --- refusals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("task_cycle_time", (0.0, -1.0, math.nan, math.inf)),
        ("data_cycle_time", (-0.002, 0.003, 0.0007, math.nan)),
        ("estimator", (0, 3)),
        ("threshold_for_sync", (0.0, math.nan)),
        ("max_cycle_index_difference", (-1,)),
        ("age_of_data_limit", (-1,)),
        ("periods_for_mean_drift", (0, 65)),
        ("delay_time_offset", (math.nan, math.inf)),
        ("slope1_numerator", (0.0, 1.01)),
        ("slope1_denominator", (0.0, 1.0)),
        ("end_of_transition_limit", (0,)),
        ("new_drift_blending_cycles", (0,)),
        ("time_mode_blending_cycles", (0,)),
        ("start_up_mode", (0, 3, 5)),
        ("fall_back_mode", (3, 4)),
        ("max_position_difference", (-0.1, math.nan)),
        ("pt1_factor_position", (0.0,)),
        ("pt1_factor_velocity", (-3.0,)),
        ("blending_time", (-0.06, math.inf)),
    ],
)
def test_bad_parameters_are_named(name: str, values: tuple[float, ...]) -> None:
    assert [refusal({name: value}) for value in values] == [name] * len(values)
    with pytest.raises(ValueError, match=name):
        RemoteSyncOracle({name: values[0]})


def test_contradictions_are_refused() -> None:
    assert refusal({"data_cycle_time": 0.016, "age_of_data_limit": 7}) == "age_of_data_limit"
    assert refusal({"data_cycle_time": 0.016, "age_of_data_limit": 8}) is None
    assert refusal({"data_cycle_time": 0.016, "age_of_data_limit": 0}) is None
    assert refusal({"data_cycle_time": 0.004, "estimator": PHASE}) == "estimator"
    assert refusal({"data_cycle_time": 0.002, "estimator": PHASE}) is None
    assert refusal({}) is None


@pytest.mark.parametrize(("data", "ratio"), [(0.0, 1), (0.006, 3), (0.0002, Fraction(1, 10)), (0.005, None)])
def test_the_ratio_is_a_whole_number_or_the_inverse_of_one(data: float, ratio: Fraction | None) -> None:
    assert whole_ratio(0.002, data) == ratio
