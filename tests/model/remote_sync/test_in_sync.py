"""When RemoteSync is in sync, and what the drift is used for.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

import pytest

from motionsync.remote_sync.interface import Mode
from tests.model.remote_sync.harness import BEATING, PHASE, UNIFORM, T, at, beating, close, offset, run, since


def test_synced_comes_with_a_small_correction_and_stays_with_a_large_one() -> None:
    recording = run(beating(1800, 500, 1000), **UNIFORM)
    assert since(recording, "synced") == 1156
    assert at(recording, "start_up", 1155, 1156) == (True, False)
    assert at(recording, "state", 1155, 1156) == (Mode.TIME, Mode.SYNC)
    assert all(recording["synced"][1156:])
    assert recording["correction_time"][-1] == close(T)  # 20 times the threshold


@pytest.mark.parametrize(("threshold", "cycle"), [(0.5, 1126), (1.0, 1091), (1.1, 1090), (1e12, 1090)])
def test_synced_may_come_with_the_beat_itself(threshold: float, cycle: int) -> None:
    """x (590 + x) / 45000 > 1/2 from x = 36 on; just at the beat the correction is a whole cycle."""
    assert since(run(BEATING, threshold_for_sync=threshold, **UNIFORM), "synced") == cycle


def test_the_delay_does_not_count_for_synced() -> None:
    recording = run(BEATING, delay_time_offset=0.1, **UNIFORM)
    assert since(recording, "synced") == 1156
    assert recording["correction_time"][1300] == close(0.6 * T + 0.1)


def test_forced_time_mode_shows_the_drift_and_does_not_use_it() -> None:
    recording = run(BEATING, force_time_mode=True, threshold_for_sync=10.0)
    assert offset(recording, 635, 1090, 1135, 1399) == close(0.5, 1.0, 1.5, 2.0)
    assert at(recording, "drift", 1089, 1090) == (0.0, 2000.0)
    assert (any(recording["synced"]), set(recording["state"])) == (False, {Mode.TIME})
    forced = run(BEATING, force_time_mode=True, threshold_for_sync=10.0, **PHASE)
    assert (any(forced["synced"]), set(forced["state"])) == (False, {Mode.TIME})
