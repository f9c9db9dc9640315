"""What `enable` of RemoteSync does: as received, and a new start.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

import math

import pytest

from motionsync.remote_sync.interface import Estimator, Mode
from tests.model.remote_sync.harness import BEATING, MOVING, UNIFORM, RemoteSyncHarness, T, beat_cycles, beating, run


def test_disabled_all_is_as_received_and_nothing_is_wrong() -> None:
    """What was estimated stays, for the values that blend out."""
    receiver = RemoteSyncHarness({**UNIFORM, **MOVING, "blending_time": 0.0})
    receiver.run(BEATING)
    last = receiver.shown()
    receiver.see(9999, {"enable": False, "delay_time_offset": math.nan})
    assert (receiver["state"], receiver["state_code"], receiver.slave) == (Mode.BYPASS, 1, (5.0, 40.0, 1000.0))
    assert [receiver[name] for name in ("synced", "start_up", "error", "error_id")] == [False, False, False, 0]
    for name in ("correction_time", "corrected_cycle_index", "drift", "beats", "cycle_index_difference"):
        assert receiver[name] == last[name]


def test_a_rising_edge_of_enable_is_a_new_start() -> None:
    receiver = RemoteSyncHarness(UNIFORM)
    receiver.run(BEATING)
    receiver.see(1402, {"enable": False})
    receiver.see(9999, {"enable": True})
    assert (receiver["corrected_cycle_index"], receiver["correction_time"]) == (9999.0, 0.0)
    assert [receiver[name] for name in ("synced", "start_up", "drift", "beats", "warning")] == [False, True, 0.0, 0, 0]
    assert (receiver["state"], receiver["cycle_index_difference"], receiver["error"]) == (Mode.TIME, 0, False)
    assert beat_cycles(receiver.run(range(10000, 10400))) == []


@pytest.mark.parametrize("estimator", Estimator)
@pytest.mark.parametrize("worked", [120, 1120, 1400])
def test_a_new_start_is_as_the_first_one(estimator: Estimator, worked: int) -> None:
    """Whatever went on before, in the midst of a zone, of what is worked off, or in sync."""
    receiver = RemoteSyncHarness({"estimator": estimator})
    receiver.run(beating(1400, 100, 500, 1000)[:worked])
    receiver.see(9, {"enable": False})
    again, first = receiver.run(BEATING, {"enable": True}), run(BEATING, estimator=estimator)
    assert all(again[name] == first[name] for name in first if not name.startswith("slave"))


def test_a_pulse_between_two_cycles_is_a_new_start_in_the_next_one() -> None:
    receiver = RemoteSyncHarness(UNIFORM)
    receiver.run(BEATING)
    receiver.step(T / 4, {"remote.cycle_index": 1402})
    last = receiver.shown()
    receiver.step(T / 4, {"enable": False})
    assert receiver.shown() == last
    receiver.step(T / 2, {"enable": True})
    assert receiver.shown() == last
    receiver.see(1403)
    assert [receiver[name] for name in ("synced", "start_up", "drift", "beats")] == [False, True, 0.0, 0]
    assert receiver["corrected_cycle_index"] == 1403.0


def test_enabled_later_the_first_cycle_is_the_first_with_enable() -> None:
    receiver = RemoteSyncHarness({"enable": False})
    assert (receiver["state"], receiver["start_up"]) == (Mode.BYPASS, False)
    recording = receiver.run([5, 900, 33])
    assert (set(recording["state"]), any(recording["start_up"]), any(recording["error"])) == (
        {Mode.BYPASS},
        False,
        False,
    )
    recording = receiver.run([7, 8], {"enable": True})
    assert (recording["corrected_cycle_index"], recording["start_up"]) == ([7.0, 8.0], [True, True])


def test_before_the_first_cycle_the_outputs_are_as_received() -> None:
    receiver = RemoteSyncHarness({**MOVING, "remote.cycle_index": 65540, "delay_time_offset": 0.01})
    assert receiver.slave == (5.0, 40.0, 1000.0)
    assert (receiver["corrected_cycle_index"], receiver["correction_time"], receiver["error"]) == (4.0, 0.0, False)
