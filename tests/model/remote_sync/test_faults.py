"""The faults of RemoteSync: their limits, their order, what they keep, the fall back and the new start.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

import math
from typing import Any

import pytest

from motionsync.remote_sync.interface import FallBackMode, Mode, StartUpMode
from tests.model.remote_sync.harness import (
    BEATING,
    MOVING,
    UNIFORM,
    RemoteSyncHarness,
    T,
    at,
    beating,
    close,
    held,
    run,
)


def losing(lost: int) -> list[int]:
    """The telegrams from 50 on are lost, so many of them."""
    return [49 if 50 <= n < 50 + lost else n for n in range(100)]


def test_six_lost_telegrams_are_tolerated() -> None:
    recording = run(losing(6))
    assert not any(recording["error"])
    assert at(recording, "equal_data_consecutive", 49, 50, 55, 56) == (0, 1, 6, 0)
    assert at(recording, "equal_data_total", 55, 56, 99) == (6, 6, 6)
    assert at(recording, "cycle_index_difference", 55, 56, 57) == (0, 7, 1)
    assert at(recording, "correction_time", 49, 50, 55, 56) == close(0.0, T, 6 * T, 0.0)


def test_the_seventh_lost_one_lets_the_index_step_too_far() -> None:
    recording = run(losing(7))
    assert held(recording, 57, 0x4B51)
    assert at(recording, "cycle_index_difference", 56, 57, 99) == (0, 8, 8)
    assert at(recording, "correction_time", 56, 99) == close(7 * T, 7 * T)
    assert recording["corrected_cycle_index"][99] == 56.0


@pytest.mark.parametrize(("limit", "step", "error_id"), [(7, 8, 0x4B51), (7, -8, 0x4B51), (7, 7, 0), (7, -7, 0)])
def test_an_index_step_beyond_the_limit_is_a_fault(limit: int, step: int, error_id: int) -> None:
    receiver = RemoteSyncHarness({"max_cycle_index_difference": limit})
    receiver.run(range(100, 150))
    receiver.see(149 + step)
    assert (receiver["error_id"], receiver["error"], receiver["cycle_index_difference"]) == (
        error_id,
        error_id != 0,
        step,
    )


@pytest.mark.parametrize(("limit", "cycle"), [(7, 57), (1, 51), (30, 80)])
def test_an_index_that_does_not_change_for_too_long_is_a_fault(limit: int, cycle: int) -> None:
    """Without a limit of the difference the correction may grow as it likes."""
    recording = run(losing(49), age_of_data_limit=limit, max_cycle_index_difference=0)
    assert held(recording, cycle, 0x4B52)
    assert at(recording, "equal_data_consecutive", cycle - 1, cycle, 98) == (limit, limit + 1, limit + 1)
    assert recording["correction_time"][99] == close(limit * T)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_corrected_index_too_far_from_the_received_one_is_a_fault(sign: int) -> None:
    """c - k is 9 away at 51, which is just allowed, and 10 at 52."""
    indices = [100 + n + sign * (6 * (n >= 50) + 3 * (n >= 51) + (n >= 52)) for n in range(60)]
    recording = run(indices, age_of_data_limit=0)
    assert held(recording, 52, 0x4B53)
    assert recording["correction_time"][52] == close(-sign * 9 * T)
    assert not any(run(indices, age_of_data_limit=0, max_cycle_index_difference=8)["error"])


def test_a_limit_of_0_is_none() -> None:
    recording = run([*range(50), *[49] * 50, *range(9000, 9050)], max_cycle_index_difference=0, age_of_data_limit=0)
    assert not any(recording["error"])
    assert at(recording, "equal_data_consecutive", 99, 100) == (50, 0)
    assert recording["cycle_index_difference"][100] == 8951


@pytest.mark.parametrize(
    ("name", "value", "error_id"),
    [
        ("delay_time_offset", math.nan, 0x4B56),
        ("delay_time_offset", math.inf, 0x4B56),
        ("delay_time_offset", -math.inf, 0x4B56),
        ("delay_time_offset", 1.1e6, 0x4B56),
        ("delay_time_offset", -1.1e6, 0x4B56),
        ("delay_time_offset", -1e6, 0),
        ("max_position_difference", math.nan, 0x4B56),
        ("max_position_difference", math.inf, 0x4B56),
        ("max_position_difference", -1e-9, 0x4B56),
        ("max_position_difference", 1.1e12, 0x4B56),
        ("max_position_difference", 1e12, 0),
    ],
)
def test_a_bad_tunable_is_a_fault_of_the_cycle_that_reads_it(name: str, value: float, error_id: int) -> None:
    receiver = RemoteSyncHarness({"delay_time_offset": 0.25})
    receiver.run(range(10))
    receiver.step(T / 2, {"remote.cycle_index": 10})
    receiver.step(T / 4, {name: value})  # no cycle is in here
    assert receiver["error_id"] == 0
    receiver.step(T / 4)
    receiver.see(11)
    assert receiver["error_id"] == error_id
    if error_id:
        assert (receiver["correction_time"], receiver["state"]) == (0.25, Mode.PT1)
        assert receiver.see(12, {name: 0.0})["error_id"] == error_id


@pytest.mark.parametrize(
    ("mode", "error_id"), [(StartUpMode.TIME, 0x4B59), (StartUpMode.PT1, 0), (StartUpMode.BYPASS, 0)]
)
def test_a_position_shifted_too_far_is_a_fault_where_it_is_shifted(mode: StartUpMode, error_id: int) -> None:
    """A cycle with 100 u/s is 0.2 u."""
    values = {"remote.velocity": 100.0, "start_up_mode": mode}
    recording = run(losing(1), {**values, "max_position_difference": 0.19})
    assert recording["error_id"][50] == error_id
    assert recording["correction_time"][50] == close(0.0 if error_id else T)
    assert not any(run(losing(1), {**values, "max_position_difference": 0.21})["error"])
    if error_id:
        assert held(recording, 50, error_id)


def test_in_sync_too_the_shift_of_the_position_is_limited() -> None:
    """0.8 of 0.2 u from 1400 on."""
    values = {"remote.velocity": -100.0, "start_up_mode": StartUpMode.BYPASS, **UNIFORM}
    recording = run(beating(1500, 500, 1000), {**values, "max_position_difference": 0.16 - 1e-9})
    assert held(recording, 1400, 0x4B59)


@pytest.mark.parametrize(("use", "error_id"), [(True, 0x4B59), (False, 0)])
def test_the_limit_is_that_of_the_shift_as_it_is(use: bool, error_id: int) -> None:
    """40 * 0.01 alone is below, 1000 * 0.01^2 / 2 more is above."""
    receiver = RemoteSyncHarness(
        {**MOVING, "delay_time_offset": 0.01, "use_acceleration": use, "max_position_difference": 0.42}
    )
    assert receiver.see(0)["error_id"] == error_id


@pytest.mark.parametrize(
    ("index", "values", "error_id"),
    [
        (70, {"delay_time_offset": math.nan}, 0x4B51),
        (56, {"delay_time_offset": math.nan, "max_position_difference": 0.1}, 0x4B53),
        (50, {"max_position_difference": math.nan, "delay_time_offset": 1.0}, 0x4B56),
        (50, {"max_position_difference": 0.1, "delay_time_offset": 1.0}, 0x4B59),
    ],
)
def test_of_several_faults_the_least_is_shown(index: int, values: dict[str, Any], error_id: int) -> None:
    """At 56 the index is ten too far, with the four of the cycle before; 100 u/s are 100 u in the delay."""
    receiver = RemoteSyncHarness({"remote.velocity": 100.0})
    receiver.run([*range(49), 53] if index == 56 else range(50))
    assert receiver.see(index + (4 if index == 56 else 0), values)["error_id"] == error_id


def test_what_a_faulty_cycle_has_estimated_is_not_taken() -> None:
    receiver = RemoteSyncHarness()
    receiver.run(BEATING[:1090])
    recording = receiver.run(BEATING[1090:1100], {"delay_time_offset": math.nan})
    assert (set(recording["beats"]), set(recording["drift"]), set(recording["corrected_cycle_index"])) == (
        {1},
        {0.0},
        {1090.0},
    )


def test_a_fault_in_sync_keeps_the_correction_and_blends_to_the_fall_back_mode() -> None:
    """0.798 cycles of 0.2 u at 1399, with a telegram that stays; then the axis is at rest as received."""
    receiver = RemoteSyncHarness({"remote.velocity": 100.0, "fall_back_mode": FallBackMode.BYPASS, **UNIFORM})
    receiver.run(BEATING)
    recording = receiver.run([9000] * 40)
    assert recording["correction_time"] == close(*[0.798 * T] * 40)
    assert recording["slave.position"] == close(*(0.1596 * max(0.0, 1 - n / 30) for n in range(40)))
    assert set(recording["state"]) == {Mode.BYPASS}


def test_automatic_reinit_makes_the_next_cycle_a_first_one() -> None:
    recording = run([*BEATING, *range(9000, 9010)], automatic_reinit=True)
    assert at(recording, "error_id", 1399, 1400, 1401) == (0, 0x4B51, 0)
    assert at(recording, "error", 1399, 1400, 1401) == (False, True, False)
    assert at(recording, "start_up", 1400, 1401) == (False, True)
    assert at(recording, "state", 1399, 1400, 1401) == (Mode.SYNC, Mode.PT1, Mode.TIME)
    assert at(recording, "corrected_cycle_index", 1401, 1402) == (9001.0, 9002.0)
    assert at(recording, "cycle_index_difference", 1400, 1401) == (7599, 0)
    assert at(recording, "beats", 1400, 1401) == (2, 0)
    assert at(recording, "drift", 1400, 1401) == (2000.0, 0.0)


def test_otherwise_a_fault_stays_until_enable_goes_and_comes() -> None:
    receiver = RemoteSyncHarness()
    receiver.run([*range(60), *range(560, 600)])
    assert (receiver["error_id"], receiver["cycle_index_difference"]) == (0x4B51, 501)
    receiver.see(600, {"enable": False})
    assert (receiver["error_id"], receiver["error"], receiver["state"]) == (0, False, Mode.BYPASS)
    receiver.see(601, {"enable": True})
    assert (receiver["error_id"], receiver["start_up"], receiver["corrected_cycle_index"]) == (0, True, 601.0)


def test_equal_data_are_counted_since_the_initialization() -> None:
    receiver = RemoteSyncHarness()
    receiver.run([*losing(6), 900, 901])
    receiver.see(902, {"enable": False})
    receiver.run([5, 5, 5], {"enable": True})
    assert (receiver["equal_data_total"], receiver["equal_data_consecutive"]) == (8, 2)
