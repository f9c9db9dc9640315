"""The slave's values of RemoteSync: the modes, the shift in time, the lag, the blending.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

from typing import Any

import pytest

from motionsync.remote_sync.interface import Estimator, FallBackMode, Mode, StartUpMode
from tests.model.remote_sync.harness import BEATING, MOVING, UNIFORM, RemoteSyncHarness, T, at, close


@pytest.mark.parametrize("start_up", StartUpMode)
@pytest.mark.parametrize("fall_back", FallBackMode)
def test_the_state_is_the_start_up_mode_then_sync_then_the_fall_back_mode(
    start_up: StartUpMode, fall_back: FallBackMode
) -> None:
    receiver = RemoteSyncHarness({"start_up_mode": start_up, "fall_back_mode": fall_back, **UNIFORM})
    assert (receiver["state"], receiver["state_code"], receiver["start_up"]) == (start_up, start_up, True)
    recording = receiver.run([*BEATING, 9000])
    assert at(recording, "state", 0, 1155, 1156, 1399, 1400) == (start_up, start_up, Mode.SYNC, Mode.SYNC, fall_back)
    assert recording["state_code"] == [int(state) for state in recording["state"]]


def test_the_states_have_the_numbers_of_the_source() -> None:
    assert {mode.name: int(mode) for mode in Mode} == {"BYPASS": 1, "PT1": 2, "SYNC": 3, "TIME": 4}
    assert {mode.name: int(mode) for mode in StartUpMode} == {"BYPASS": 1, "PT1": 2, "TIME": 4}
    assert {mode.name: int(mode) for mode in FallBackMode} == {"BYPASS": 1, "PT1": 2}
    assert {kind.name: int(kind) for kind in Estimator} == {"BEAT": 1, "PHASE": 2}


@pytest.mark.parametrize("use", [True, False])
@pytest.mark.parametrize("synced", [True, False])
def test_position_and_velocity_are_shifted_by_the_correction_time(synced: bool, use: bool) -> None:
    """At 1300 the correction is 0.6 cycles, at 10 it is 0: 10 ms more each. a 0.01^2 / 2 = 0.05."""
    values = {"delay_time_offset": 0.01, "use_acceleration": use, "blending_time": 0.0, **UNIFORM, **MOVING}
    receiver = RemoteSyncHarness(values)
    receiver.run(BEATING[: 1301 if synced else 11])
    time, acceleration = (0.0112 if synced else 0.01), (1000.0 if use else 0.0)
    assert (receiver["synced"], receiver["correction_time"]) == (synced, close(time))
    shifted = 5 + 40 * time + acceleration * time**2 / 2
    assert receiver.slave == close(shifted, 40 + acceleration * time, acceleration)
    assert receiver["slave.jerk"] == 0.0


def test_bypass_is_what_was_received() -> None:
    """Acceleration too, whether it is used for the shift or not."""
    receiver = RemoteSyncHarness({"start_up_mode": StartUpMode.BYPASS, "use_acceleration": False, **MOVING})
    receiver.run([0, 1, 2, 2], {"delay_time_offset": 0.01})
    assert receiver.slave == (5.0, 40.0, 1000.0)
    assert receiver["correction_time"] == close(0.01 + T)


def test_pt1_takes_a_share_of_what_is_missing_in_each_cycle() -> None:
    """A quarter with the factor 3, a half with 1; it starts at the first value."""
    receiver = RemoteSyncHarness({"start_up_mode": StartUpMode.PT1, "pt1_factor_velocity": 1.0, "remote.position": 2.0})
    assert receiver.see(0).slave == (2.0, 0.0, 0.0)
    values = {"remote.position": 6.0, "remote.velocity": 8.0, "remote.acceleration": 7.0}
    rows = [receiver.see(index, values).slave for index in (1, 2, 3)]
    assert rows == [(3.0, 4.0, 7.0), (3.75, 6.0, 7.0), (4.3125, 7.0, 7.0)]


def test_pt1_runs_in_every_cycle_and_mode_from_the_very_first_one() -> None:
    """Disabled, in TIME and through a new start: 1 - (3/4)^n of the step."""
    receiver = RemoteSyncHarness({"blending_time": 0.0, "enable": False})
    receiver.see(0)
    receiver.see(1, {"remote.position": 64.0})
    receiver.see(2, {"enable": True})
    receiver.see(3)
    receiver.see(900)
    assert (receiver["state"], receiver["slave.position"]) == (Mode.PT1, close(64 * (1 - 0.75**4)))


def test_the_shift_leads_to_the_next_cycle_if_asked() -> None:
    """With a delay of a task cycle the values are those at the step's end."""
    receiver = RemoteSyncHarness({"delay_time_offset": T})
    for n in range(5):
        t = n * T
        receiver.see(n, {"remote.position": 3 + 50 * t + 100 * t * t, "remote.velocity": 50 + 200 * t})
        receiver.put({"remote.acceleration": 200.0})
    t = 5 * T
    assert receiver.slave == close(3 + 50 * t + 100 * t * t, 50 + 200 * t, 200.0)


# From the first telegram, at 0, on the PT1 is nearly at rest; then what was received is 5, and 0.8 more if shifted.
THREE: dict[str, Any] = {"delay_time_offset": 0.02, "pt1_factor_position": 1e12, "use_acceleration": False}
AT_FIVE: dict[str, Any] = {"remote.position": 5.0, "remote.velocity": 40.0}


def three_ways(**values: Any) -> RemoteSyncHarness:
    receiver = RemoteSyncHarness({**THREE, **values})
    receiver.see(0)
    receiver.run(range(1, 50), AT_FIVE)
    return receiver


def test_a_change_of_mode_is_blended_over_the_blending_time() -> None:
    """30 cycles from TIME to BYPASS: the change only starts in the first one."""
    receiver = three_ways()
    assert receiver["slave.position"] == close(5.8)
    recording = receiver.run(range(50, 90), {"enable": False})
    assert recording["slave.position"] == close(*(5.0 + 0.8 * max(0.0, 1 - n / 30) for n in range(40)))
    assert set(recording["state"]) == {Mode.BYPASS}


def test_a_change_in_the_middle_of_a_blending_begins_at_the_weights_there() -> None:
    """TIME to PT1 with a fault; halfway, at 2.9, disabled: to BYPASS. After 10 of 30 cycles on to TIME again."""
    receiver = three_ways()
    falling = receiver.run(range(600, 615))["slave.position"]
    assert falling == close(*(5.8 * (1 - n / 30) for n in range(15)), tolerance=1e-8)
    rising = receiver.run(range(615, 625), {"enable": False})["slave.position"]
    assert rising == close(*(2.9 + (5.0 - 2.9) * n / 30 for n in range(10)), tolerance=1e-8)
    there = 2.9 + 2.1 / 3
    again = receiver.run(range(625, 670), {"enable": True})["slave.position"]
    assert again == close(*(there + (5.8 - there) * min(1.0, n / 30) for n in range(45)), tolerance=1e-8)


def test_velocities_are_blended_with_the_same_weights() -> None:
    receiver = three_ways(pt1_factor_velocity=1e12, use_acceleration=True)
    receiver.run(range(50, 52), {"remote.acceleration": 100.0})
    assert receiver["slave.velocity"] == close(42.0)
    velocity = receiver.run(range(600, 640))["slave.velocity"]
    assert velocity == close(*(42.0 * max(0.0, 1 - n / 30) for n in range(40)), tolerance=1e-8)


def test_the_acceleration_is_not_blended() -> None:
    receiver = three_ways()
    receiver.run(range(50, 52), {"remote.acceleration": 7.0})
    assert receiver["slave.acceleration"] == 0.0
    recording = receiver.run(range(52, 54), {"enable": False})
    assert recording["slave.acceleration"] == [7.0, 7.0]
    assert receiver.see(54, {"enable": True})["slave.acceleration"] == 0.0


def test_without_a_blending_time_a_mode_changes_at_once() -> None:
    receiver = three_ways(blending_time=0.0)
    assert receiver.see(50, {"enable": False})["slave.position"] == 5.0
    assert receiver.see(51, {"enable": True})["slave.position"] == close(5.8)
    assert receiver.see(900)["slave.position"] == close(0.0, tolerance=1e-8)


def test_a_blending_time_may_be_no_whole_number_of_cycles() -> None:
    recording = three_ways(blending_time=2.5 * T).run(range(50, 54), {"enable": False})
    assert recording["slave.position"] == close(5.8, 5 + 0.8 * 0.6, 5 + 0.8 * 0.2, 5.0)


def test_a_change_from_time_to_sync_leaves_the_values_alone() -> None:
    """Both are the shifted ones: 0.2 u a cycle, and the index goes on evenly."""
    receiver = RemoteSyncHarness({"remote.velocity": 100.0, **UNIFORM})
    positions: list[float] = []
    for index in BEATING:
        receiver.see(index, {"remote.position": 0.2 * index})
        positions.append(receiver["slave.position"] / 0.2 - len(positions))
    assert (positions[1156], positions[1157]) == close(1 + 66 * 656 / 45000, 1 + 67 * 657 / 45000)
