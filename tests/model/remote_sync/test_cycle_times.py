"""RemoteSync with a sender whose cycles are a whole multiple or part of the receiver's."""

import math

import pytest

from tests.model.remote_sync.harness import UNIFORM, T, at, beat_cycles, close, run, since


def test_two_cycles_an_index() -> None:
    """Odd cycles are half an index on; 500 cycles to a beat of one index in 250 are 4000 ppm."""
    recording = run([n // 2 + (n >= 500) + (n >= 1000) for n in range(1400)], data_cycle_time=2 * T, **UNIFORM)
    assert at(recording, "corrected_cycle_index", 0, 1, 2, 3) == (0.0, 0.5, 1.0, 1.5)
    assert at(recording, "correction_time", 0, 1, 2, 3) == close(0.0, T, 0.0, T)  # half of a data cycle
    assert at(recording, "equal_data_consecutive", 0, 1, 2, 3) == (0, 1, 0, 1)
    assert recording["equal_data_total"][1399] == 700
    assert (beat_cycles(recording), recording["drift"][1090]) == ([590, 1090], 4000.0)
    assert at(recording, "corrected_cycle_index", 635, 680, 1180) == close(318.0, 341.0, 592.36)
    assert recording["correction_time"][1201] == close(0.902 * 2 * T)


def test_the_difference_is_looked_at_only_where_an_index_is_due() -> None:
    """Telegrams that come in odd cycles: D is 0 in all even ones."""
    recording = run([(n + 1) // 2 for n in range(400)], data_cycle_time=2 * T)
    assert set(recording["local.difference"]) == {0}
    assert at(recording, "corrected_cycle_index", 398, 399) == (199.0, 199.5)
    assert recording["correction_time"][399] == close(-T)


@pytest.mark.parametrize(("limit", "first", "second"), [(90, 591, 1092), (91, 594, 1095), (93, 594, 1095)])
def test_three_cycles_an_index(limit: int, first: int, second: int) -> None:
    """D is looked at in every third cycle: a step at 499 is seen at 501, and a quiet stretch in such a cycle only."""
    indices = [n // 3 + (n >= 499) + (n >= 1000) for n in range(1400)]
    recording = run(indices, data_cycle_time=3 * T, end_of_transition_limit=limit, **UNIFORM)
    assert beat_cycles(recording) == [first, second]
    assert recording["drift"][1399] == close(3e6 / 501.0)
    assert recording["corrected_cycle_index"][1300] == close(1300 / 3 + 2 + (1300 - 1002) / 501)


@pytest.mark.parametrize("share", [2, 4])
def test_several_indices_a_cycle(share: int) -> None:
    """c counts indices; the correction is a share of a cycle for each."""
    recording = run([share * n + (n >= 500) + (n >= 1000) for n in range(1400)], data_cycle_time=T / share, **UNIFORM)
    assert at(recording, "corrected_cycle_index", 1, 499) == (share, 499.0 * share)
    assert at(recording, "cycle_index_difference", 1, 500) == (share, share + 1)
    assert recording["correction_time"][500] == close(-T / share)
    assert (beat_cycles(recording), recording["drift"][1090]) == ([590, 1090], close(2000.0 / share))
    assert recording["corrected_cycle_index"][1300] == close(1300 * share + 2.6)


@pytest.mark.parametrize(("ratio", "cycle"), [(1.0, 1156), (0.5, 1153), (0.25, 1146), (2.0, 1125)])
def test_the_threshold_is_a_share_of_the_task_cycle(ratio: float, cycle: int) -> None:
    """x (590 + x) / 45000 - 1, times r, is above -0.05 from x = 66, 63, 56 on. With r = 2 half an index more is in
    every odd cycle: |35 * 625 / 45000 - 1/2| * 2 = 0.028."""
    indices = [math.floor(n / ratio) + (n >= 500) + (n >= 1000) for n in range(1200)]
    assert since(run(indices, data_cycle_time=ratio * T, **UNIFORM), "synced") == cycle


@pytest.mark.parametrize("data", [2 * T * (1 + 9e-7), 2 * T * (1 - 9e-7)])
def test_a_ratio_is_whole_but_for_rounding(data: float) -> None:
    recording = run([n // 2 for n in range(10)], data_cycle_time=data)
    assert recording["corrected_cycle_index"] == [n / 2 for n in range(10)]
    assert recording["correction_time"][9] == T
