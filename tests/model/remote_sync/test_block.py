"""RemoteSync, its description sentence by sentence with numbers by hand: beats, the correction, modes, faults.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

import pytest

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Fault, Refusal
from motionsync.remote_sync.interface import Estimator, FallBackMode, Mode, StartUpMode
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.native.batch import simulate_many
from motionsync_fmu.scenario.fmu_instance import FmuError, Host
from tests.conftest import Fmus
from tests.model.remote_sync.harness import Course, Receiver, T, beating

UNIFORM: dict[str, Any] = {"slope1_numerator": 0.5, "slope1_denominator": 0.5}
PHASE: dict[str, Any] = {"estimator": Estimator.PHASE}
BEATING = beating(1400, 500, 1000)
MOVING: dict[str, Any] = {"remote.position": 5.0, "remote.velocity": 40.0, "remote.acceleration": 1000.0}


def run(indices: Iterable[int], values: dict[str, Any] | None = None, **parameters: Any) -> Course:
    """From the first cycle on; `values` have dots in their names."""
    return Receiver({**parameters, **(values or {})}).run(indices)


def close(*values: float, tolerance: float = 1e-12) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def at(course: Course, name: str, *cycles: int) -> tuple[Any, ...]:
    return tuple(course[name][n] for n in cycles)


def offset(course: Course, *cycles: int) -> tuple[float, ...]:
    """c - n."""
    return tuple(course["corrected_cycle_index"][n] - n for n in cycles)


def since(course: Course, name: str) -> int:
    """The first cycle in which a flag is set."""
    return course[name].index(True)


def found(course: Course) -> list[int]:
    """Cycles in which the number of beats grows."""
    beats = course["beats"]
    return [n for n in range(1, len(beats)) if beats[n] > beats[n - 1]]


# --- the index and the difference -------------------------------------------------------------------------------------


def test_the_first_cycle_has_no_step_to_judge() -> None:
    course = run(range(5000, 5003))
    assert at(course, "corrected_cycle_index", 0, 1, 2) == (5000.0, 5001.0, 5002.0)
    assert at(course, "cycle_index_difference", 0, 1, 2) == (0, 1, 1)
    assert (course["error"], course["correction_time"]) == ([False] * 3, [0.0] * 3)
    assert at(course, "local.cycles", 0, 1, 2) == (0, 1, 2)
    standing = run([7, 7])
    assert at(standing, "equal_data_consecutive", 0, 1) == at(standing, "equal_data_total", 0, 1) == (0, 1)


def test_the_index_wraps_at_65535_and_the_corrected_one_never_does() -> None:
    course = run([(65530 + n) % 65536 for n in range(12)])
    assert course["corrected_cycle_index"] == [65530.0 + n for n in range(12)]
    assert course["cycle_index_difference"][1:] == [1] * 11
    assert not any(course["error"])


def test_it_wraps_backwards_too() -> None:
    course = run([1, 0, 65535, 65534])
    assert course["cycle_index_difference"] == [0, -1, -1, -1]
    assert course["correction_time"] == close(0.0, 2 * T, 4 * T, 6 * T)


@pytest.mark.parametrize(
    ("value", "index"), [(65536, 0), (65541, 5), (-1, 65535), (2**31 - 1, 65535), (-(2**31), 0), (-65536 - 3, 65533)]
)
def test_an_index_is_taken_modulo_65536(value: int, index: int) -> None:
    course = run([value, index + 1, value + 2])
    assert course["corrected_cycle_index"] == [index, index + 1.0, index + 2.0]


@pytest.mark.parametrize(
    ("last", "new", "step"),
    [(0, 32767, 32767), (0, 32768, -32768), (0, 32769, -32767), (40000, 0, 25536), (0, 40000, -25536), (9, 9, 0)],
)
def test_a_step_is_the_shorter_way_round(last: int, new: int, step: int) -> None:
    course = run([last, new], max_cycle_index_difference=0)
    assert course["cycle_index_difference"] == [0, step]
    assert course["correction_time"][1] == close((1 - step) * T)


def test_equal_clocks_need_no_correction_and_show_no_beat() -> None:
    """TIME for ever, start_up true, no drift, no fault."""
    course = run(range(100, 1100))
    assert course["corrected_cycle_index"] == [100.0 + n for n in range(1000)]
    assert set(course["correction_time"]) == {0.0}
    assert set(course["state"]) == {Mode.TIME}
    assert (set(course["start_up"]), set(course["synced"]), set(course["error"])) == ({True}, {False}, {False})
    assert (set(course["drift"]), set(course["beats"]), set(course["warning"])) == ({0.0}, {0}, {False})


@pytest.mark.parametrize("estimator", Estimator)
def test_flicker_at_the_border_is_no_beat_however_long_it_lasts(estimator: Estimator) -> None:
    indices = [n + (1 if n % 89 == 0 else 0) for n in range(3000)]
    course = run(indices, estimator=estimator)
    assert set(course["state"]) == {Mode.TIME}
    assert (course["beats"][-1], course["drift"][-1], course["error"][-1]) == (0, 0.0, False)
    assert offset(course, 2999)[0] == (1.0 if estimator == Estimator.BEAT else 1.5)  # the first D, never confirmed


# --- other cycle times ------------------------------------------------------------------------------------------------


def test_two_cycles_an_index() -> None:
    """Odd cycles are half an index on; 500 cycles to a beat of one index in 250 are 4000 ppm."""
    course = run([n // 2 + (n >= 500) + (n >= 1000) for n in range(1400)], data_cycle_time=2 * T, **UNIFORM)
    assert at(course, "corrected_cycle_index", 0, 1, 2, 3) == (0.0, 0.5, 1.0, 1.5)
    assert at(course, "correction_time", 0, 1, 2, 3) == close(0.0, T, 0.0, T)  # half of a data cycle
    assert at(course, "equal_data_consecutive", 0, 1, 2, 3) == (0, 1, 0, 1)
    assert course["equal_data_total"][1399] == 700
    assert (found(course), course["drift"][1090]) == ([590, 1090], 4000.0)
    assert at(course, "corrected_cycle_index", 635, 680, 1180) == close(318.0, 341.0, 592.36)
    assert course["correction_time"][1201] == close(0.902 * 2 * T)


def test_the_difference_is_looked_at_only_where_an_index_is_due() -> None:
    """Telegrams that come in odd cycles: D is 0 in all even ones."""
    course = run([(n + 1) // 2 for n in range(400)], data_cycle_time=2 * T)
    assert set(course["local.difference"]) == {0}
    assert at(course, "corrected_cycle_index", 398, 399) == (199.0, 199.5)
    assert course["correction_time"][399] == close(-T)


@pytest.mark.parametrize(("limit", "first", "second"), [(90, 591, 1092), (91, 594, 1095), (93, 594, 1095)])
def test_three_cycles_an_index(limit: int, first: int, second: int) -> None:
    """D is looked at in every third cycle: a step at 499 is seen at 501, and a quiet stretch in such a cycle only."""
    indices = [n // 3 + (n >= 499) + (n >= 1000) for n in range(1400)]
    course = run(indices, data_cycle_time=3 * T, end_of_transition_limit=limit, **UNIFORM)
    assert found(course) == [first, second]
    assert course["drift"][1399] == close(3e6 / 501.0)
    assert course["corrected_cycle_index"][1300] == close(1300 / 3 + 2 + (1300 - 1002) / 501)


@pytest.mark.parametrize("share", [2, 4])
def test_several_indices_a_cycle(share: int) -> None:
    """c counts indices; the correction is a share of a cycle for each."""
    course = run([share * n + (n >= 500) + (n >= 1000) for n in range(1400)], data_cycle_time=T / share, **UNIFORM)
    assert at(course, "corrected_cycle_index", 1, 499) == (share, 499.0 * share)
    assert at(course, "cycle_index_difference", 1, 500) == (share, share + 1)
    assert course["correction_time"][500] == close(-T / share)
    assert (found(course), course["drift"][1090]) == ([590, 1090], close(2000.0 / share))
    assert course["corrected_cycle_index"][1300] == close(1300 * share + 2.6)


@pytest.mark.parametrize(("ratio", "cycle"), [(1.0, 1156), (0.5, 1153), (0.25, 1146), (2.0, 1125)])
def test_the_threshold_is_a_share_of_the_task_cycle(ratio: float, cycle: int) -> None:
    """x (590 + x) / 45000 - 1, times r, is above -0.05 from x = 66, 63, 56 on. With r = 2 half an index more is in
    every odd cycle: |35 * 625 / 45000 - 1/2| * 2 = 0.028."""
    indices = [math.floor(n / ratio) + (n >= 500) + (n >= 1000) for n in range(1200)]
    assert since(run(indices, data_cycle_time=ratio * T, **UNIFORM), "synced") == cycle


@pytest.mark.parametrize("data", [2 * T * (1 + 9e-7), 2 * T * (1 - 9e-7)])
def test_a_ratio_is_whole_but_for_rounding(data: float) -> None:
    course = run([n // 2 for n in range(10)], data_cycle_time=data)
    assert course["corrected_cycle_index"] == [n / 2 for n in range(10)]
    assert course["correction_time"][9] == T


# --- zones and beats --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("limit", [1, 7, 90])
def test_a_beat_is_identified_once_the_difference_has_been_quiet_for_the_limit(limit: int) -> None:
    assert found(run(BEATING, end_of_transition_limit=limit)) == [500 + limit, 1000 + limit]


def test_a_beat_is_dated_by_the_middle_of_its_zone() -> None:
    """Zones of flicker from 480 to 520 and from 1000 to 1011: N = 505.5, from 90 cycles after their ends on."""
    differences = [0] * 480 + [1, 0] * 20 + [1] * 480 + [2, 1] * 5 + [1] + [2] * 189
    course = run((n + d for n, d in enumerate(differences)), **UNIFORM)
    assert found(course) == [610, 1101]
    assert at(course, "drift", 1100, 1101) == (0.0, close(1e6 / 505.5))
    assert course["local.beat_distance"][1199] == 505.5
    assert at(course, "local.transition", 479, 480, 609, 610, 999, 1000, 1101) == (0, 1, 1, 0, 0, 1, 0)
    assert course["corrected_cycle_index"][1195] == close(1195 + 2 + (1195 - 1005.5) / 505.5)


def test_a_quiet_stretch_at_the_confirmed_difference_closes_the_zone_without_a_beat() -> None:
    indices = [*BEATING]
    indices[300] += 1
    course = run(indices)
    assert at(course, "local.transition", 300, 390, 391) == (True, True, False)
    assert (found(course), course["drift"][-1]) == ([590, 1090], 2000.0)


@pytest.mark.parametrize("values", [UNIFORM, PHASE])
@pytest.mark.parametrize("flicker", [511, 700, 1030, 1250])
def test_a_closed_zone_leaves_the_correction_alone(values: dict[str, Any], flicker: int) -> None:
    """Quiet stretches of 10 cycles: also while a beat before it is still worked off."""
    indices = [*BEATING]
    indices[flicker] += 1
    parameters: dict[str, Any] = {"end_of_transition_limit": 10, **values}
    course, calm = run(indices, **parameters), run(BEATING, **parameters)
    assert at(course, "local.transition", flicker, flicker + 10, flicker + 11) == (True, True, False)
    for name in ("corrected_cycle_index", "drift", "beats", "synced"):
        assert course[name] == calm[name]


def test_flicker_shortly_before_a_step_belongs_to_its_zone() -> None:
    """First 450, last 500: dated 475."""
    indices = [*BEATING]
    indices[450] += 1
    assert run(indices)["drift"][-1] == close(1e6 / 525.0)


def test_the_first_quiet_stretch_confirms_the_difference_without_a_beat() -> None:
    """Where it is the first D, nothing is to be seen; where not, it is worked off as in time mode."""
    course = run(beating(400, 40))
    assert (course["beats"][-1], course["warning"][-1]) == (0, False)
    assert offset(course, 129, 130, 175, 220, 399) == close(0.0, 0.0, 0.5, 1.0, 1.0)
    course = run(beating(400, 40, 60, 61), time_mode_blending_cycles=10, end_of_transition_limit=50)
    assert offset(course, 111, 112, 121, 399) == close(0.0, 3 / 10, 3.0 * 10 / 10, 3.0)
    course = run(beating(800, 40, 500))
    assert found(course) == [590]


def test_n_is_the_mean_of_the_last_distances() -> None:
    """Distances 500, 600, 400: means 550 and 500 of two, 500 of all three."""
    indices = beating(2200, 500, 1000, 1600, 2000)
    course = run(indices, periods_for_mean_drift=2)
    assert at(course, "drift", 1090, 1689, 1690, 2090) == (0.0, 0.0, close(1e6 / 550), close(2000.0))
    assert since(course, "synced") > 1690
    assert at(run(indices, periods_for_mean_drift=3), "drift", 2089, 2090) == (0.0, close(2000.0))
    assert at(run(indices), "drift", 1090, 1690, 2090) == close(2000.0, 1e6 / 600, 2500.0)


def test_up_to_64_distances_are_averaged() -> None:
    """Alternately 10 and 20 cycles, but the first one 500."""
    dates = [100, 600]
    for i in range(70):
        dates.append(dates[-1] + (10 if i % 2 else 20))
    indices = beating(dates[-1] + 10, *dates)
    course = run(indices, periods_for_mean_drift=64, end_of_transition_limit=3, max_cycle_index_difference=0)
    assert course["beats"][-1] == 72
    assert course["drift"][dates[64] + 2] == 0.0
    assert course["drift"][dates[64] + 3] == close(1e6 * 64 / (dates[64] - 100))
    assert course["drift"][-1] == close(1e6 / 15.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_drift_is_negative_if_the_sender_s_cycle_is_longer(sign: int) -> None:
    course = run(beating(1400, 500, 1000, sign=sign, first=10))
    assert at(course, "drift", 1089, 1090, 1399) == (0.0, sign * 2000.0, sign * 2000.0)


# --- the corrected index ----------------------------------------------------------------------------------------------


def test_before_the_drift_is_known_a_beat_is_worked_off_after_it() -> None:
    """w = (n - 590) / 90; the correction steps with each telegram."""
    course = run(BEATING, **UNIFORM)
    assert offset(course, 0, 590, 635, 680, 1000, 1090) == close(0.0, 0.0, 0.5, 1.0, 1.0, 1.0)
    assert at(course, "correction_time", 499, 500, 590, 635, 680) == close(0.0, -T, -T, -0.5 * T, 0.0)


def test_with_uniform_slopes_the_offset_grows_by_one_in_n_cycles() -> None:
    """At 1135 half of 1 and half of 2 + 135/500; at 1000 + 500 all of the beat, and no more after it."""
    course = run(beating(1700, 500, 1000), **UNIFORM)
    assert offset(course, 1135, 1180, 1300, 1399) == close(1.635, 2.36, 2.6, 2.798)
    assert offset(course, 1499, 1500, 1501, 1699) == close(2.998, 3.0, 3.0, 3.0)
    assert at(course, "correction_time", 1135, 1300) == close(-0.365 * T, 0.6 * T)


def test_with_the_default_slopes_95_hundredths_of_a_beat_are_done_in_its_first_half() -> None:
    """g(0.27) = 0.513, g(0.36) = 0.684, g(0.5) = 0.95, g(0.6) = 0.96."""
    course = run(beating(1700, 500, 1000))
    assert offset(course, 1135, 1180, 1250, 1300) == close(0.5 + 0.5 * 2.513, 2.684, 2.95, 2.96)
    assert offset(course, 1500, 1699) == close(3.0, 3.0)


def test_slopes_may_be_any() -> None:
    """Through (0.2, 0.3) and (1, 1): g(0.18) = 0.27, g(0.6) = 0.3 + 0.7 / 2. All in the first fifth: then 1."""
    course = run(BEATING, slope1_numerator=0.3, slope1_denominator=0.2, new_drift_blending_cycles=1)
    assert offset(course, 1090, 1091, 1300) == close(1.0, 2.0 + 0.3 * 91 / 100, 2.65)
    assert offset(run(BEATING, slope1_numerator=1.0, slope1_denominator=0.2), 1180, 1399) == close(3.0, 3.0)


def test_a_new_drift_comes_in_within_its_blending_cycles() -> None:
    """A third beat after 400: N goes from 500 to 400, seen at 1490 where the offset was 2 + 490/500."""
    course = run(beating(1700, 500, 1000, 1400), new_drift_blending_cycles=60, time_mode_blending_cycles=30, **UNIFORM)
    assert offset(course, 605, 620) == close(0.5, 1.0)
    assert offset(course, 1120, 1150) == close(0.5 + 0.5 * (2 + 120 / 500), 2 + 150 / 500)
    assert offset(course, 1490, 1520, 1550) == close(2.98, 0.5 * 2.98 + 0.5 * (3 + 120 / 400), 3 + 150 / 400)


def test_a_slower_sender_is_followed_one_cycle_behind() -> None:
    """The true index between two beats goes from D + 1 to D, c from D to D - 1."""
    course = run(beating(1400, 500, 1000, sign=-1, first=10), **UNIFORM)
    assert offset(course, 680, 1180, 1300) == close(9.0, 8 - 0.36, 8 - 0.6)


def test_a_delay_of_a_data_cycle_takes_that_back() -> None:
    values = {"remote.velocity": 500.0}  # a cycle is 1 u
    receiver = Receiver({**UNIFORM, **values, "delay_time_offset": T})
    for index in beating(1301, 500, 1000, sign=-1, first=10):
        receiver.see(index, {"remote.position": float(index)})
    assert receiver["slave.position"] == close(1300 + 8 - 0.6 + 1.0)


def test_the_corrected_index_is_continuous_where_beats_are_identified() -> None:
    """In the cycle itself the old law holds; its step is no more than the blendings and the drift make it."""
    for course in (run(BEATING), run(beating(2000, 500, 1000, 1400, 1700))):
        c = course["corrected_cycle_index"]
        assert max(abs(b - a - 1.0) for a, b in pairwise(c)) <= 2.0 / 90 + 1.9 / 300


def test_a_second_beat_long_overdue_keeps_the_offset_where_the_beat_is_used_up() -> None:
    course = run(beating(2200, 500, 1000, 1900), **UNIFORM)
    assert offset(course, 1500, 1990) == close(3.0, 3.0)
    assert offset(course, 2080)[0] == close(3 + 180 / 900)


# --- anew: reversal and jump ------------------------------------------------------------------------------------------


def test_a_beat_of_opposite_sign_starts_anew_and_is_the_first_itself() -> None:
    """D is 1 again from 1300 on: seen at 1390, where c - n is 2.78; 0 from 1700 on makes N = 400."""
    indices = [index - (n >= 1300) - (n >= 1700) for n, index in enumerate(beating(2000, 500, 1000))]
    course = run(indices, **UNIFORM)
    assert at(course, "synced", 1389, 1390, 1790) == (True, False, False)
    assert at(course, "beats", 1389, 1390, 1790) == (2, 1, 2)
    assert at(course, "drift", 1389, 1390, 1790) == (2000.0, 0.0, close(-2500.0))
    assert at(course, "warning", 1389, 1390, 1789, 1790) == (False, True, True, False)
    assert at(course, "state", 1389, 1390) == (Mode.SYNC, Mode.TIME)
    assert at(course, "start_up", 1389, 1390) == (False, True)
    assert not any(course["error"])
    assert offset(course, 1390, 1435, 1480) == close(2.78, (2.78 + 1) / 2, 1.0)
    assert since({"synced": course["synced"][1390:]}, "synced") > 400


@pytest.mark.parametrize("change", [2, 3, -2, -5])
def test_a_change_of_two_or_more_starts_anew(change: int) -> None:
    indices = [index + change * (n >= 1300) for n, index in enumerate(beating(1600, 500, 1000))]
    course = run(indices, **UNIFORM)
    assert at(course, "synced", 1389, 1390) == (True, False)
    assert at(course, "beats", 1389, 1390, 1599) == (2, 0, 0)
    assert at(course, "drift", 1389, 1390) == (2000.0, 0.0)
    assert at(course, "warning", 1389, 1390, 1599) == (False, True, True)
    assert at(course, "state", 1389, 1390) == (Mode.SYNC, Mode.TIME)
    assert not any(course["error"])
    assert offset(course, 1390, 1435, 1480) == close(2.78, (2.78 + 2 + change) / 2, 2.0 + change)


def test_a_change_of_two_before_any_beat_is_no_warning() -> None:
    course = run([n + 6 * (n >= 200) for n in range(500)])
    assert (course["beats"][-1], course["warning"][-1], course["error"][-1]) == (0, False, False)
    assert offset(course, 290, 320, 380) == close(0.0, 2.0, 6.0)


def test_a_warning_outlasts_another_change_of_two() -> None:
    course = run([n + (n >= 500) + 3 * (n >= 800) - 2 * (n >= 1100) + (n >= 1400) for n in range(1500)])
    assert at(course, "beats", 889, 890, 1190, 1490) == (1, 0, 0, 1)
    assert at(course, "warning", 889, 890, 1190, 1489, 1490) == (False, True, True, True, False)


def test_a_reversal_of_the_very_first_beat() -> None:
    """It is forgotten, which is a warning; the opposite one is the first."""
    course = run([n + (300 <= n < 700) - (n >= 1200) for n in range(1300)])
    assert at(course, "beats", 390, 790, 1290) == (1, 1, 2)
    assert at(course, "warning", 390, 790, 1290) == (False, True, False)
    assert course["drift"][1290] == close(-2000.0)


@pytest.mark.parametrize(("third", "warned"), [(1599, False), (1600, False), (1601, True), (1400, False), (1399, True)])
def test_a_mean_that_changes_by_more_than_a_fifth_is_a_warning(third: int, warned: bool) -> None:
    course = run(beating(1800, 500, 1000, third))
    assert at(course, "warning", 1090, third + 89, third + 90) == (False, False, warned)


def test_the_warning_stays_until_the_next_beat() -> None:
    course = run(beating(2800, 500, 1000, 1700, 2350))
    assert at(course, "warning", 1789, 1790, 2439, 2440) == (False, True, True, False)
    assert at(course, "synced", 1790, 2440) == (True, True)


def test_the_warning_is_that_of_the_means() -> None:
    """500, 800: from 500 to 650 is three tenths; of two, from 650 of (500, 800) to 700 of (800, 600) is less."""
    indices = beating(2600, 500, 1000, 1800, 2400)
    assert at(run(indices), "warning", 1890, 2490) == (True, True)
    assert at(run(indices, periods_for_mean_drift=2), "warning", 1890, 2490) == (False, False)


# --- synced -----------------------------------------------------------------------------------------------------------


def test_synced_comes_with_a_small_correction_and_stays_with_a_large_one() -> None:
    course = run(beating(1800, 500, 1000), **UNIFORM)
    assert since(course, "synced") == 1156
    assert at(course, "start_up", 1155, 1156) == (True, False)
    assert at(course, "state", 1155, 1156) == (Mode.TIME, Mode.SYNC)
    assert all(course["synced"][1156:])
    assert course["correction_time"][-1] == close(T)  # 20 times the threshold


@pytest.mark.parametrize(("threshold", "cycle"), [(0.5, 1126), (1.0, 1091), (1.1, 1090), (1e12, 1090)])
def test_synced_may_come_with_the_beat_itself(threshold: float, cycle: int) -> None:
    """x (590 + x) / 45000 > 1/2 from x = 36 on; just at the beat the correction is a whole cycle."""
    assert since(run(BEATING, threshold_for_sync=threshold, **UNIFORM), "synced") == cycle


def test_the_delay_does_not_count_for_synced() -> None:
    course = run(BEATING, delay_time_offset=0.1, **UNIFORM)
    assert since(course, "synced") == 1156
    assert course["correction_time"][1300] == close(0.6 * T + 0.1)


def test_forced_time_mode_tells_the_drift_and_does_not_use_it() -> None:
    course = run(BEATING, force_time_mode=True, threshold_for_sync=10.0)
    assert offset(course, 635, 1090, 1135, 1399) == close(0.5, 1.0, 1.5, 2.0)
    assert at(course, "drift", 1089, 1090) == (0.0, 2000.0)
    assert (any(course["synced"]), set(course["state"])) == (False, {Mode.TIME})
    forced = run(BEATING, force_time_mode=True, threshold_for_sync=10.0, **PHASE)
    assert (any(forced["synced"]), set(forced["state"])) == (False, {Mode.TIME})


# --- PHASE ------------------------------------------------------------------------------------------------------------

RHO2, WALK, DRIFT2 = 0.005**2, 2e-15, 3e-4**2
State = tuple[float, float, float, float, float]  # x, d, p11, p12, p22


def updated(state: State, span: float, border: float) -> State:
    """Prediction over a span, then the phase measured there."""
    x, d, p11, p12, p22 = state
    p11, p12, p22 = (
        p11 + 2 * span * p12 + span**2 * p22 + WALK * span**3 / 3,
        p12 + span * p22 + WALK * span**2 / 2,
        p22 + WALK * span,
    )
    g1, g2 = p11 / (p11 + RHO2), p12 / (p11 + RHO2)
    error = border - x - d * span
    return x + d * span + g1 * error, d + g2 * error, (1 - g1) * p11, (1 - g1) * p12, p22 - g2 * p12


def test_the_phase_begins_in_the_middle_of_the_first_difference() -> None:
    course = run(beating(400, first=3), **PHASE)
    assert set(offset(course, *range(400))) == {3.5}
    assert set(course["correction_time"]) == {0.5 * T}


def test_a_beat_dates_the_phase_half_a_cycle_before_its_first_cycle() -> None:
    """Clean steps at 500 and 1000, seen 90 cycles later with 91 cycles counted: b = 499.5 and 999.5."""
    course = run(BEATING, **PHASE)
    state = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    x, d = state[:2]
    assert at(course, "drift", 589, 590) == (0.0, close(1e6 * d, tolerance=1e-9))
    rest = 0.5 - (x + d * 90.5)
    assert offset(course, 590, 635, 680, 1000) == close(
        0.5, x + d * 135.5 + rest / 2, x + d * 180.5, x + d * 500.5, tolerance=1e-10
    )
    before = x + d * (1090 - 499.5)
    x, d = updated(state, 500.0, 2.0)[:2]
    assert course["drift"][1090] == close(1e6 * d, tolerance=1e-9)
    assert d == pytest.approx(2e-3, rel=3e-3)
    rest = before - (x + d * 90.5)
    assert offset(course, 1090, 1117, 1399) == close(
        before, x + d * 117.5 + rest * 63 / 90, x + d * 399.5, tolerance=1e-10
    )
    assert (
        since(course, "synced")
        == since({"synced": [abs(t) < 0.05 * T for t in course["correction_time"][1090:]]}, "synced") + 1090
    )


def test_the_cycles_beyond_are_counted_wherever_in_the_zone_they_are() -> None:
    """Every other one of 480 to 519: as many as with a clean step at 500."""
    clean, zone = BEATING, beating(1400, 520, 1000)
    for n in range(480, 520, 2):
        zone[n] += 1
    a, b = run(clean, **PHASE), run(zone, **PHASE)
    assert found(b) == [610, 1090]
    assert b["drift"][610] == a["drift"][590]
    assert b["drift"][1090] == a["drift"][1090]


def test_a_cycle_counts_once_however_far_beyond_it_is() -> None:
    far = [*BEATING]
    far[500] += 3
    assert run(far, **PHASE)["drift"][1090] == run(BEATING, **PHASE)["drift"][1090]
    back = beating(1400, 499, 1000)  # one cycle short of D in the zone counts for neither
    back[500] -= 2
    assert run(back, **PHASE)["drift"][1090] == run(BEATING, **PHASE)["drift"][1090]


@pytest.mark.parametrize("sign", [1, -1])
def test_phase_follows_either_sender_without_a_lag(sign: int) -> None:
    """The sender's true index: at the border where D steps, half a cycle before; so 2 (or -1) + d (n - 999.5)."""
    course = run(beating(1400, 500, 1000, sign=sign), **PHASE)
    border = 2 if sign > 0 else -1
    expected = border + sign * 0.002 * 399.5
    assert offset(course, 1399)[0] == pytest.approx(expected, abs=5e-3)
    assert course["drift"][1399] == pytest.approx(sign * 2000.0, rel=5e-3)


def test_the_first_two_beats_far_apart_give_the_drift_of_the_line_through_both() -> None:
    """25000 cycles are 40 ppm."""
    course = run(beating(26000, 500, 25500), **PHASE)
    assert course["drift"][25590] == close(40.0)
    assert offset(course, 25900)[0] == close(2 + 40e-6 * (25900 - 25499.5))


def joined(span: float) -> State:
    """After the first two beats, at the second one, which is at the border 2."""
    return 2.0, 1 / span, RHO2, RHO2 / span, 2 * RHO2 / span**2


def test_later_beats_far_apart_go_through_the_filter() -> None:
    """25910 cycles are 38.6 ppm in the mean; a drift that walks there from 40 is as far beyond again by half."""
    course = run(beating(51600, 500, 25500, 51500 - 90), **PHASE)
    x, d, *_ = updated(joined(25000.0), 25910.0, 3.0)
    assert course["drift"][51500] == close(1e6 * d, tolerance=1e-9)
    assert course["drift"][51500] == pytest.approx(40 - 1.5 * (40 - 1e6 / 25910), abs=0.1)
    assert offset(course, 51599)[0] == close(x + d * 189.5, tolerance=1e-9)


def test_a_first_beat_back_far_away_goes_through_the_filter() -> None:
    """There and back over the same border: no line leads through both."""
    course = run([n + (500 <= n < 25500) for n in range(25700)], **PHASE)
    first = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    assert first[0] + first[1] * 25000 > 2.05  # so it was held in its count: the drift is what is left of it
    held = (2.05 - first[0]) / (25499 - 499.5)
    assert course["drift"][25499] == close(1e6 * held, tolerance=1e-9)
    x, d, *_ = updated((first[0], held, *first[2:]), 25000.0, 1.0)
    assert course["drift"][25590] == close(1e6 * d, tolerance=1e-9)
    assert offset(course, 25690)[0] == close(x + d * 190.5, tolerance=1e-9)


def test_phase_sets_the_middle_of_a_first_difference_that_does_not_stay() -> None:
    course = run(beating(300, 40), **PHASE)
    assert offset(course, 130, 175, 220, 299) == close(0.5, 1.0, 1.5, 1.5)
    assert course["beats"][-1] == 0


def test_between_beats_the_phase_stays_in_its_count_but_for_a_slack() -> None:
    """The sender keeps step after two beats of 2000 ppm: it stops at 3.05, and the drift fades."""
    course = run(beating(4000, 500, 1000), **PHASE)
    assert offset(course, 3000, 3999) == close(3.05, 3.05)
    assert max(offset(course, *range(4000))) <= 3.05 + 1e-12
    x, d, *_ = updated(updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0), 500.0, 2.0)
    assert x + d * (1520 - 999.5) < 3.05 < x + d * (1530 - 999.5)
    assert course["drift"][3999] == close(1e6 * (3.05 - x) / (3999 - 999.5), tolerance=1e-6)
    assert course["synced"][-1]


def test_a_closed_zone_lets_the_phase_be_held_again_without_a_jump() -> None:
    """A flicker at 1500 keeps the zone open until 1591, where the phase is 0.13 beyond; that is worked off."""
    indices = beating(1800, 500, 1000)
    indices[1500] += 1
    course = run(indices, **PHASE)
    beyond = offset(course, 1591)[0]
    assert beyond == pytest.approx(2 + 0.002 * 591.5, abs=5e-3)
    assert offset(course, 1636, 1681, 1799) == close(3.05 + (beyond - 3.05) / 2, 3.05, 3.05, tolerance=1e-9)
    assert max(abs(b - a) for a, b in pairwise(offset(course, *range(1200, 1800)))) < 0.0021


def test_phase_needs_no_new_start_for_a_reversal() -> None:
    """Two beats back, 500 apart, after two there: the second one is seen at 2090."""
    indices = [index - (n >= 1500) - (n >= 2000) for n, index in enumerate(beating(2400, 500, 1000))]
    course = run(indices, **PHASE)
    assert all(course["synced"][since(course, "synced") :])
    assert at(course, "beats", 1090, 1590, 2090) == (2, 3, 4)
    assert at(course, "warning", 1589, 1590, 2090) == (False, True, False)
    assert course["drift"][2090] < 0.0


def test_phase_forgets_its_beats_with_a_change_of_two_or_more() -> None:
    """The phase is the middle of the new count; the drift stays."""
    indices = [index + 4 * (n >= 1300) for n, index in enumerate(beating(1600, 500, 1000))]
    course = run(indices, **PHASE)
    assert at(course, "synced", 1389, 1390) == (True, False)
    assert at(course, "beats", 1389, 1390) == (2, 0)
    assert at(course, "warning", 1389, 1390) == (False, True)
    before = offset(course, 1390)[0]
    assert before == pytest.approx(2 + 0.002 * 390.5, abs=5e-3)
    d = course["drift"][1390] * 1e-6
    assert d == pytest.approx(0.002, rel=5e-3)
    assert offset(course, 1435, 1480) == close((before + 6.5) / 2 + 45 * d, 6.5 + 90 * d)


def test_after_a_change_of_two_or_more_the_phase_is_as_uncertain_as_at_the_start() -> None:
    """D is 5 from 800 on, seen at 890, and 6 from 1400 on: dated 509.5 later. The drift's variance goes on."""
    course = run([n + (n >= 500) + 4 * (n >= 800) + (n >= 1400) for n in range(1700)], **PHASE)
    _, d, _, _, p22 = updated((0.5, 0.0, 1 / 12, 0.0, DRIFT2), 499.5, 1.0)
    x, d, *_ = updated((5.5, d, 1 / 12, 0.0, p22), 1399.5 - 890.0, 6.0)
    assert course["drift"][1490] == close(1e6 * d, tolerance=1e-9)
    assert offset(course, 1580, 1699) == close(x + d * 180.5, x + d * 299.5, tolerance=1e-9)


def test_phase_warns_of_a_distance_that_differs_by_more_than_a_fifth() -> None:
    assert run(beating(1800, 500, 1000, 1600), **PHASE)["warning"][1690] is False
    assert run(beating(1800, 500, 1000, 1601), **PHASE)["warning"][1691] is True
    assert run(beating(1800, 500, 1000, 1399), **PHASE)["warning"][1489] is True


# --- the axis values --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start_up", StartUpMode)
@pytest.mark.parametrize("fall_back", FallBackMode)
def test_the_state_is_the_start_up_mode_then_sync_then_the_fall_back_mode(
    start_up: StartUpMode, fall_back: FallBackMode
) -> None:
    receiver = Receiver({"start_up_mode": start_up, "fall_back_mode": fall_back, **UNIFORM})
    assert (receiver["state"], receiver["state_code"], receiver["start_up"]) == (start_up, start_up, True)
    course = receiver.run([*BEATING, 9000])
    assert at(course, "state", 0, 1155, 1156, 1399, 1400) == (start_up, start_up, Mode.SYNC, Mode.SYNC, fall_back)
    assert course["state_code"] == [int(state) for state in course["state"]]


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
    receiver = Receiver(values)
    receiver.run(BEATING[: 1301 if synced else 11])
    time, acceleration = (0.0112 if synced else 0.01), (1000.0 if use else 0.0)
    assert (receiver["synced"], receiver["correction_time"]) == (synced, close(time))
    shifted = 5 + 40 * time + acceleration * time**2 / 2
    assert receiver.slave == close(shifted, 40 + acceleration * time, acceleration)
    assert receiver["slave.jerk"] == 0.0


def test_bypass_is_what_was_received() -> None:
    """Acceleration too, whether it is used for the shift or not."""
    receiver = Receiver({"start_up_mode": StartUpMode.BYPASS, "use_acceleration": False, **MOVING})
    receiver.run([0, 1, 2, 2], {"delay_time_offset": 0.01})
    assert receiver.slave == (5.0, 40.0, 1000.0)
    assert receiver["correction_time"] == close(0.01 + T)


def test_pt1_takes_a_share_of_what_is_missing_in_each_cycle() -> None:
    """A quarter with the factor 3, a half with 1; it begins at the first value."""
    receiver = Receiver({"start_up_mode": StartUpMode.PT1, "pt1_factor_velocity": 1.0, "remote.position": 2.0})
    assert receiver.see(0).slave == (2.0, 0.0, 0.0)
    values = {"remote.position": 6.0, "remote.velocity": 8.0, "remote.acceleration": 7.0}
    rows = [receiver.see(index, values).slave for index in (1, 2, 3)]
    assert rows == [(3.0, 4.0, 7.0), (3.75, 6.0, 7.0), (4.3125, 7.0, 7.0)]


def test_pt1_runs_in_every_cycle_and_mode_from_the_very_first_one() -> None:
    """Disabled, in TIME and through a new start: 1 - (3/4)^n of the step."""
    receiver = Receiver({"blending_time": 0.0, "enable": False})
    receiver.see(0)
    receiver.see(1, {"remote.position": 64.0})
    receiver.see(2, {"enable": True})
    receiver.see(3)
    receiver.see(900)
    assert (receiver["state"], receiver["slave.position"]) == (Mode.PT1, close(64 * (1 - 0.75**4)))


def test_the_shift_leads_to_the_next_cycle_if_asked() -> None:
    """With a delay of a task cycle the values are those at the step's end."""
    receiver = Receiver({"delay_time_offset": T})
    for n in range(5):
        t = n * T
        receiver.see(n, {"remote.position": 3 + 50 * t + 100 * t * t, "remote.velocity": 50 + 200 * t})
        receiver.put({"remote.acceleration": 200.0})
    t = 5 * T
    assert receiver.slave == close(3 + 50 * t + 100 * t * t, 50 + 200 * t, 200.0)


# From the first telegram, at 0, on the PT1 stands nearly still; then what was received is 5, and 0.8 more if shifted.
THREE: dict[str, Any] = {"delay_time_offset": 0.02, "pt1_factor_position": 1e12, "use_acceleration": False}
AT_FIVE: dict[str, Any] = {"remote.position": 5.0, "remote.velocity": 40.0}


def three_ways(**values: Any) -> Receiver:
    receiver = Receiver({**THREE, **values})
    receiver.see(0)
    receiver.run(range(1, 50), AT_FIVE)
    return receiver


def test_a_change_of_mode_is_blended_over_the_blending_time() -> None:
    """30 cycles from TIME to BYPASS: the change only begins in the first one."""
    receiver = three_ways()
    assert receiver["slave.position"] == close(5.8)
    course = receiver.run(range(50, 90), {"enable": False})
    assert course["slave.position"] == close(*(5.0 + 0.8 * max(0.0, 1 - n / 30) for n in range(40)))
    assert set(course["state"]) == {Mode.BYPASS}


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
    course = receiver.run(range(52, 54), {"enable": False})
    assert course["slave.acceleration"] == [7.0, 7.0]
    assert receiver.see(54, {"enable": True})["slave.acceleration"] == 0.0


def test_without_a_blending_time_a_mode_changes_at_once() -> None:
    receiver = three_ways(blending_time=0.0)
    assert receiver.see(50, {"enable": False})["slave.position"] == 5.0
    assert receiver.see(51, {"enable": True})["slave.position"] == close(5.8)
    assert receiver.see(900)["slave.position"] == close(0.0, tolerance=1e-8)


def test_a_blending_time_may_be_no_whole_number_of_cycles() -> None:
    course = three_ways(blending_time=2.5 * T).run(range(50, 54), {"enable": False})
    assert course["slave.position"] == close(5.8, 5 + 0.8 * 0.6, 5 + 0.8 * 0.2, 5.0)


def test_a_change_from_time_to_sync_leaves_the_values_alone() -> None:
    """Both are the shifted ones: 0.2 u a cycle, and the index goes on evenly."""
    receiver = Receiver({"remote.velocity": 100.0, **UNIFORM})
    positions: list[float] = []
    for index in BEATING:
        receiver.see(index, {"remote.position": 0.2 * index})
        positions.append(receiver["slave.position"] / 0.2 - len(positions))
    assert (positions[1156], positions[1157]) == close(1 + 66 * 656 / 45000, 1 + 67 * 657 / 45000)


# --- enable -----------------------------------------------------------------------------------------------------------


def test_disabled_all_is_as_received_and_nothing_is_wrong() -> None:
    """What was estimated stays, for the values that blend out."""
    receiver = Receiver({**UNIFORM, **MOVING, "blending_time": 0.0})
    receiver.run(BEATING)
    last = receiver.shown()
    receiver.see(9999, {"enable": False, "delay_time_offset": math.nan})
    assert (receiver["state"], receiver["state_code"], receiver.slave) == (Mode.BYPASS, 1, (5.0, 40.0, 1000.0))
    assert [receiver[name] for name in ("synced", "start_up", "error", "error_id")] == [False, False, False, 0]
    for name in ("correction_time", "corrected_cycle_index", "drift", "beats", "cycle_index_difference"):
        assert receiver[name] == last[name]


def test_a_rising_edge_of_enable_is_a_new_start() -> None:
    receiver = Receiver(UNIFORM)
    receiver.run(BEATING)
    receiver.see(1402, {"enable": False})
    receiver.see(9999, {"enable": True})
    assert (receiver["corrected_cycle_index"], receiver["correction_time"]) == (9999.0, 0.0)
    assert [receiver[name] for name in ("synced", "start_up", "drift", "beats", "warning")] == [False, True, 0.0, 0, 0]
    assert (receiver["state"], receiver["cycle_index_difference"], receiver["error"]) == (Mode.TIME, 0, False)
    assert found(receiver.run(range(10000, 10400))) == []


@pytest.mark.parametrize("estimator", Estimator)
@pytest.mark.parametrize("worked", [120, 1120, 1400])
def test_a_new_start_is_as_the_first_one(estimator: Estimator, worked: int) -> None:
    """Whatever went on before, in the midst of a zone, of what is worked off, or in sync."""
    receiver = Receiver({"estimator": estimator})
    receiver.run(beating(1400, 100, 500, 1000)[:worked])
    receiver.see(9, {"enable": False})
    again, first = receiver.run(BEATING, {"enable": True}), run(BEATING, estimator=estimator)
    assert all(again[name] == first[name] for name in first if not name.startswith("slave"))


def test_a_pulse_between_two_cycles_is_a_new_start_in_the_next_one() -> None:
    receiver = Receiver(UNIFORM)
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
    receiver = Receiver({"enable": False})
    assert (receiver["state"], receiver["start_up"]) == (Mode.BYPASS, False)
    course = receiver.run([5, 900, 33])
    assert (set(course["state"]), any(course["start_up"]), any(course["error"])) == ({Mode.BYPASS}, False, False)
    course = receiver.run([7, 8], {"enable": True})
    assert (course["corrected_cycle_index"], course["start_up"]) == ([7.0, 8.0], [True, True])


def test_before_the_first_cycle_the_outputs_are_as_received() -> None:
    receiver = Receiver({**MOVING, "remote.cycle_index": 65540, "delay_time_offset": 0.01})
    assert receiver.slave == (5.0, 40.0, 1000.0)
    assert (receiver["corrected_cycle_index"], receiver["correction_time"], receiver["error"]) == (4.0, 0.0, False)


# --- faults -----------------------------------------------------------------------------------------------------------


def losing(lost: int) -> list[int]:
    """The telegrams from 50 on are lost, so many of them."""
    return [49 if 50 <= n < 50 + lost else n for n in range(100)]


def held(course: Course, cycle: int, error_id: int, mode: Mode = Mode.PT1) -> bool:
    """From this cycle on a fault: latched, the estimate as in the cycle before, the fall-back mode."""
    names = ("correction_time", "corrected_cycle_index", "drift", "beats", "warning")
    assert (since(course, "error"), set(course["error_id"][cycle:])) == (cycle, {error_id})
    assert all(course["error"][cycle:])
    assert (set(course["state"][cycle:]), any(course["synced"][cycle:])) == ({mode}, False)
    assert not any(course["start_up"][cycle:])
    return all(set(course[name][cycle - 1 :]) == {course[name][cycle - 1]} for name in names)


def test_six_lost_telegrams_are_tolerated() -> None:
    course = run(losing(6))
    assert not any(course["error"])
    assert at(course, "equal_data_consecutive", 49, 50, 55, 56) == (0, 1, 6, 0)
    assert at(course, "equal_data_total", 55, 56, 99) == (6, 6, 6)
    assert at(course, "cycle_index_difference", 55, 56, 57) == (0, 7, 1)
    assert at(course, "correction_time", 49, 50, 55, 56) == close(0.0, T, 6 * T, 0.0)


def test_the_seventh_lost_one_lets_the_index_step_too_far() -> None:
    course = run(losing(7))
    assert held(course, 57, 0x4B51)
    assert at(course, "cycle_index_difference", 56, 57, 99) == (0, 8, 8)
    assert at(course, "correction_time", 56, 99) == close(7 * T, 7 * T)
    assert course["corrected_cycle_index"][99] == 56.0


@pytest.mark.parametrize(("limit", "step", "error_id"), [(7, 8, 0x4B51), (7, -8, 0x4B51), (7, 7, 0), (7, -7, 0)])
def test_an_index_step_beyond_the_limit_is_a_fault(limit: int, step: int, error_id: int) -> None:
    receiver = Receiver({"max_cycle_index_difference": limit})
    receiver.run(range(100, 150))
    receiver.see(149 + step)
    assert (receiver["error_id"], receiver["error"], receiver["cycle_index_difference"]) == (
        error_id,
        error_id != 0,
        step,
    )


@pytest.mark.parametrize(("limit", "cycle"), [(7, 57), (1, 51), (30, 80)])
def test_an_index_that_stands_still_for_too_long_is_a_fault(limit: int, cycle: int) -> None:
    """Without a limit of the difference the correction may grow as it likes."""
    course = run(losing(49), age_of_data_limit=limit, max_cycle_index_difference=0)
    assert held(course, cycle, 0x4B52)
    assert at(course, "equal_data_consecutive", cycle - 1, cycle, 98) == (limit, limit + 1, limit + 1)
    assert course["correction_time"][99] == close(limit * T)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_corrected_index_too_far_from_the_received_one_is_a_fault(sign: int) -> None:
    """c - k is 9 away at 51, which is just allowed, and 10 at 52."""
    indices = [100 + n + sign * (6 * (n >= 50) + 3 * (n >= 51) + (n >= 52)) for n in range(60)]
    course = run(indices, age_of_data_limit=0)
    assert held(course, 52, 0x4B53)
    assert course["correction_time"][52] == close(-sign * 9 * T)
    assert not any(run(indices, age_of_data_limit=0, max_cycle_index_difference=8)["error"])


def test_a_limit_of_0_is_none() -> None:
    course = run([*range(50), *[49] * 50, *range(9000, 9050)], max_cycle_index_difference=0, age_of_data_limit=0)
    assert not any(course["error"])
    assert at(course, "equal_data_consecutive", 99, 100) == (50, 0)
    assert course["cycle_index_difference"][100] == 8951


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
    receiver = Receiver({"delay_time_offset": 0.25})
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
    course = run(losing(1), {**values, "max_position_difference": 0.19})
    assert course["error_id"][50] == error_id
    assert course["correction_time"][50] == close(0.0 if error_id else T)
    assert not any(run(losing(1), {**values, "max_position_difference": 0.21})["error"])
    if error_id:
        assert held(course, 50, error_id)


def test_in_sync_too_the_shift_of_the_position_is_limited() -> None:
    """0.8 of 0.2 u from 1400 on."""
    values = {"remote.velocity": -100.0, "start_up_mode": StartUpMode.BYPASS, **UNIFORM}
    course = run(beating(1500, 500, 1000), {**values, "max_position_difference": 0.16 - 1e-9})
    assert held(course, 1400, 0x4B59)


@pytest.mark.parametrize(("use", "error_id"), [(True, 0x4B59), (False, 0)])
def test_the_limit_is_that_of_the_shift_as_it_is(use: bool, error_id: int) -> None:
    """40 * 0.01 alone is below, 1000 * 0.01^2 / 2 more is above."""
    receiver = Receiver({**MOVING, "delay_time_offset": 0.01, "use_acceleration": use, "max_position_difference": 0.42})
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
def test_of_several_faults_the_least_is_told(index: int, values: dict[str, Any], error_id: int) -> None:
    """At 56 the index is ten too far, with the four of the cycle before; 100 u/s are 100 u in the delay."""
    receiver = Receiver({"remote.velocity": 100.0})
    receiver.run([*range(49), 53] if index == 56 else range(50))
    assert receiver.see(index + (4 if index == 56 else 0), values)["error_id"] == error_id


def test_what_a_faulty_cycle_has_found_is_not_taken() -> None:
    receiver = Receiver()
    receiver.run(BEATING[:1090])
    course = receiver.run(BEATING[1090:1100], {"delay_time_offset": math.nan})
    assert (set(course["beats"]), set(course["drift"]), set(course["corrected_cycle_index"])) == ({1}, {0.0}, {1090.0})


def test_a_fault_in_sync_keeps_the_correction_and_blends_to_the_fall_back_mode() -> None:
    """0.798 cycles of 0.2 u at 1399, with a telegram that stays; then the axis stands as received."""
    receiver = Receiver({"remote.velocity": 100.0, "fall_back_mode": FallBackMode.BYPASS, **UNIFORM})
    receiver.run(BEATING)
    course = receiver.run([9000] * 40)
    assert course["correction_time"] == close(*[0.798 * T] * 40)
    assert course["slave.position"] == close(*(0.1596 * max(0.0, 1 - n / 30) for n in range(40)))
    assert set(course["state"]) == {Mode.BYPASS}


def test_automatic_reinit_makes_the_next_cycle_a_first_one() -> None:
    course = run([*BEATING, *range(9000, 9010)], automatic_reinit=True)
    assert at(course, "error_id", 1399, 1400, 1401) == (0, 0x4B51, 0)
    assert at(course, "error", 1399, 1400, 1401) == (False, True, False)
    assert at(course, "start_up", 1400, 1401) == (False, True)
    assert at(course, "state", 1399, 1400, 1401) == (Mode.SYNC, Mode.PT1, Mode.TIME)
    assert at(course, "corrected_cycle_index", 1401, 1402) == (9001.0, 9002.0)
    assert at(course, "cycle_index_difference", 1400, 1401) == (7599, 0)
    assert at(course, "beats", 1400, 1401) == (2, 0)
    assert at(course, "drift", 1400, 1401) == (2000.0, 0.0)


def test_otherwise_a_fault_stays_until_enable_goes_and_comes() -> None:
    receiver = Receiver()
    receiver.run([*range(60), *range(560, 600)])
    assert (receiver["error_id"], receiver["cycle_index_difference"]) == (0x4B51, 501)
    receiver.see(600, {"enable": False})
    assert (receiver["error_id"], receiver["error"], receiver["state"]) == (0, False, Mode.BYPASS)
    receiver.see(601, {"enable": True})
    assert (receiver["error_id"], receiver["start_up"], receiver["corrected_cycle_index"]) == (0, True, 601.0)


def test_equal_data_are_counted_since_the_initialization() -> None:
    receiver = Receiver()
    receiver.run([*losing(6), 900, 901])
    receiver.see(902, {"enable": False})
    receiver.run([5, 5, 5], {"enable": True})
    assert (receiver["equal_data_total"], receiver["equal_data_consecutive"]) == (8, 2)


# --- cycles and steps -------------------------------------------------------------------------------------------------


def test_a_step_within_a_cycle_holds_the_outputs() -> None:
    receiver = Receiver()
    seen = []
    for n in range(9):
        receiver.step(T / 4, {"remote.cycle_index": n})
        seen.append(receiver["cycle_index_difference"])
    assert seen == [0] * 4 + [4] * 4 + [4]
    assert receiver["local.cycles"] == 2


def test_a_longer_step_repeats_its_inputs() -> None:
    receiver, other = Receiver(), Receiver()
    receiver.see(0).step(5 * T, {"remote.cycle_index": 5})
    other.run([0, 5, 5, 5, 5, 5])
    assert receiver.shown() == other.shown()
    assert (receiver["equal_data_total"], receiver["local.cycles"]) == (4, 5)


def test_cycles_keep_their_instants_with_any_step_size() -> None:
    """Steps of 0.7 cycles: 0, 0.7, 1.4, 2.1, 2.8 ... the one from 2.1 to 2.8 has no cycle in it."""
    receiver = Receiver()
    seen = []
    for n in range(8):
        receiver.step(0.7 * T, {"remote.cycle_index": n})
        seen.append((receiver["local.cycles"], receiver["cycle_index_difference"]))
    assert seen == [(0, 0), (1, 1), (2, 1), (2, 1), (3, 2), (4, 1), (4, 1), (5, 2)]


@pytest.mark.parametrize(("share", "cycles"), [(1 + 5e-7, 1), (1 + 2e-6, 2), (1 - 5e-7, 1), (1 - 2e-6, 1)])
def test_a_cycle_just_at_the_end_of_a_step_is_the_next_step_s(share: float, cycles: int) -> None:
    receiver = Receiver()
    receiver.step(share * T)
    assert receiver["local.cycles"] == cycles - 1
    receiver.step((2.0 - share) * T)
    assert receiver["local.cycles"] == 1


@pytest.mark.parametrize("part", [3, 7, 10])
def test_instants_do_not_wander_with_rounding(part: int) -> None:
    receiver = Receiver({"age_of_data_limit": 0, "max_cycle_index_difference": 0})
    for _ in range(part * 3000):
        receiver.block.step(T / part)
    assert receiver["local.cycles"] == 2999
    receiver.block.step(T / part)
    assert receiver["local.cycles"] == 3000


def test_a_step_of_more_than_a_million_cycles_is_refused_and_changes_nothing() -> None:
    receiver = Receiver()
    receiver.run(range(20))
    last = receiver.shown()
    twin = receiver.twin()
    assert receiver.put({"remote.cycle_index": 77}).block.step(2000.1) == Refusal.CYCLES
    assert receiver.shown() == last
    assert receiver.see(20).shown() == twin.see(20).shown()


def test_a_million_cycles_are_not_too_many() -> None:
    """No more and no less in 2000 s: the index stands still in all but the first."""
    start = {"age_of_data_limit": 0, "max_cycle_index_difference": 0}
    names = ["equal_data_total", "correction_time"]
    one = simulate_many("RemoteSync", 2000.0, {}, names, start=start, steps=1)
    assert not one.failures
    assert one.values[0, 0].tolist() == [999999.0, close(999999 * T)]


# --- what is declared and refused -------------------------------------------------------------------------------------

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
    *("correction_time", "corrected_cycle_index", "drift", "synced", "start_up", "warning", "cycle_index_difference"),
    *("equal_data_total", "equal_data_consecutive", "beats", "state", "state_code", "error", "error_id"),
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
    motion = {f"slave.{name}" for name in ("position", "velocity", "acceleration", "jerk")}
    assert set(of("output", "continuous")) == motion
    assert not hasattr(block, "master")


CONTRADICTIONS: list[tuple[dict[str, Any], Refusal, str]] = [
    ({"data_cycle_time": 0.003}, Refusal.RATIO, "a whole multiple or a whole part of task_cycle_time"),
    ({"data_cycle_time": 0.0015}, Refusal.RATIO, "data_cycle_time = 0.0015, task_cycle_time = 0.002"),
    ({"data_cycle_time": 0.002 * (1 + 2e-6)}, Refusal.RATIO, "data_cycle_time"),
    ({"data_cycle_time": 21.0, "age_of_data_limit": 0}, Refusal.RATIO, "at most 10000"),
    ({"data_cycle_time": 0.004, "estimator": 2}, Refusal.PHASE, "the PHASE estimator is for equal cycle times"),
    ({"data_cycle_time": 0.001, "estimator": 2}, Refusal.PHASE, "estimator = 2, data_cycle_time = 0.001"),
    ({"data_cycle_time": 0.016}, Refusal.AGE, "age_of_data_limit = 7, data_cycle_time = 0.016"),
    ({"data_cycle_time": 0.004, "age_of_data_limit": 1}, Refusal.AGE, "age_of_data_limit must be 0 or at least"),
    ({"data_cycle_time": 0.00025}, Refusal.STEP, "max_cycle_index_difference = 7, data_cycle_time = 0.00025"),
    (
        {"data_cycle_time": 0.001, "max_cycle_index_difference": 1},
        Refusal.STEP,
        "max_cycle_index_difference must be 0 or at least task_cycle_time / data_cycle_time",
    ),
]
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
    assert Receiver(values)["error"] is False


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


# --- the FMU ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "text"),
    [
        *((values, text) for values, _, text in CONTRADICTIONS),
        ({"task_cycle_time": 0.0}, "task_cycle_time = 0 is not allowed: it must be 1e-09 to 1e+06"),
        ({"data_cycle_time": -0.002}, "data_cycle_time = -0.002 is not allowed: it must be 0, or 1e-09 to 1e+06"),
        ({"estimator": 3}, "estimator = 3 is not allowed: it must be 1 BEAT, 2 PHASE"),
        ({"threshold_for_sync": 0.0}, "threshold_for_sync = 0 is not allowed: it must be > 0 and <= 1e+12"),
        ({"periods_for_mean_drift": 0}, "periods_for_mean_drift = 0 is not allowed: it must be 1 to 64"),
        ({"periods_for_mean_drift": 65}, "periods_for_mean_drift = 65 is not allowed: it must be 1 to 64"),
        ({"max_cycle_index_difference": -1}, "max_cycle_index_difference = -1 is not allowed: it must be >= 0"),
        ({"age_of_data_limit": -1}, "age_of_data_limit = -1 is not allowed: it must be >= 0"),
        ({"slope1_numerator": 1.5}, "slope1_numerator = 1.5 is not allowed: it must be > 0 and <= 1"),
        ({"slope1_denominator": 1.0}, "slope1_denominator = 1 is not allowed: it must be >= 1e-09 and < 1"),
        ({"end_of_transition_limit": 0}, "end_of_transition_limit = 0 is not allowed: it must be >= 1"),
        ({"new_drift_blending_cycles": 0}, "new_drift_blending_cycles = 0 is not allowed: it must be >= 1"),
        ({"time_mode_blending_cycles": 0}, "time_mode_blending_cycles = 0 is not allowed: it must be >= 1"),
        ({"start_up_mode": 3}, "start_up_mode = 3 is not allowed: it must be 1 BYPASS, 2 PT1, 4 TIME"),
        ({"fall_back_mode": 4}, "fall_back_mode = 4 is not allowed: it must be 1 BYPASS, 2 PT1"),
        ({"pt1_factor_position": 0.0}, "pt1_factor_position = 0 is not allowed: it must be > 0 and <= 1e+12"),
        ({"pt1_factor_velocity": -1.0}, "pt1_factor_velocity = -1 is not allowed: it must be > 0 and <= 1e+12"),
        ({"blending_time": math.inf}, "blending_time = inf is not allowed: it must be 0 to 1e+06"),
        ({"delay_time_offset": math.nan}, "delay_time_offset = nan is not allowed: it must be -1e+06 to 1e+06"),
        ({"max_position_difference": -0.5}, "max_position_difference = -0.5 is not allowed: it must be 0 to 1e+12"),
    ],
)
def test_a_refused_initialization_is_logged(fmus: Fmus, values: dict[str, Any], text: str) -> None:
    with Host(fmus.python("RemoteSync")) as host, pytest.raises(FmuError) as told:
        host.initialize(values)
    assert text in str(told.value)


@pytest.mark.parametrize(
    ("indices", "values", "fault", "text"),
    [
        (
            [0, 1, 10],
            {},
            Fault.INDEX_STEP,
            "the cycle index has stepped by more than max_cycle_index_difference (cycle_index_difference = 9, "
            "max_cycle_index_difference = 7, remote.cycle_index = 10)",
        ),
        (
            [5] * 9,
            {},
            Fault.AGE_OF_DATA,
            "the cycle index has stood still for more than age_of_data_limit cycles (equal_data_consecutive = 8, "
            "age_of_data_limit = 7, remote.cycle_index = 5)",
        ),
        (
            [0, 7, 14],
            {},
            Fault.INDEX_CORRECTION,
            "the corrected cycle index is more than max_cycle_index_difference + 2 away from the received one "
            "(max_cycle_index_difference = 7, remote.cycle_index = 14)",
        ),
        (
            [0, 1],
            {"delay_time_offset": 2e6},
            Fault.TUNABLE,
            "delay_time_offset must be within 1e6 s, max_position_difference 0 to 1e12 (delay_time_offset = 2e+06, "
            "max_position_difference = 0)",
        ),
        (
            [0, 1],
            {"max_position_difference": 0.5, "delay_time_offset": 0.01, "remote.velocity": 60.0},
            Fault.POSITION_DIFFERENCE,
            "the correction would shift the position by more than max_position_difference (max_position_difference = "
            "0.5, remote.position = 0, remote.velocity = 60, remote.acceleration = 0)",
        ),
    ],
)
def test_a_fault_is_logged_when_it_comes_and_not_again(
    fmus: Fmus, indices: list[int], values: dict[str, Any], fault: Fault, text: str
) -> None:
    with Host(fmus.python("RemoteSync")) as host:
        host.initialize()
        for index in indices[:-1]:
            host.step(T, {"remote.cycle_index": index})
        assert host.messages == []
        host.step(T, {"remote.cycle_index": indices[-1], **values})
        assert host.messages == [text]
        assert host.get(["error", "error_id", "state"]) == {"error": True, "error_id": fault, "state": Mode.PT1}
        for _ in range(3):
            host.step(T)
        assert host.messages == [text]
        host.step(T, {"enable": False})
        assert host.messages == [text]


def test_each_fault_of_a_block_that_starts_anew_is_logged(fmus: Fmus) -> None:
    with Host(fmus.python("RemoteSync")) as host:
        host.initialize({"automatic_reinit": True})
        for index in (0, 1, 900, 901, 902, 300):
            host.step(T, {"remote.cycle_index": index})
        assert ["cycle_index_difference = 899" in text for text in host.messages] == [True, False]


@pytest.mark.parametrize(
    ("h", "values", "text"),
    [
        (2000.1, {}, "a step must have at most 1e6 cycles (task_cycle_time = 0.002)"),
        (0.0, {}, "step size = 0 is not allowed"),
        (T, {"remote.position": math.nan}, "remote.position = nan is not allowed"),
        (T, {"remote.velocity": math.inf}, "remote.velocity = inf is not allowed"),
        (T, {"remote.acceleration": -2e12}, "remote.acceleration = -2e+12 is not allowed"),
    ],
)
def test_a_refused_step_is_logged_and_the_next_one_goes_on(
    fmus: Fmus, h: float, values: dict[str, float], text: str
) -> None:
    with Host(fmus.python("RemoteSync")) as host:
        host.initialize()
        host.step(T, {"remote.cycle_index": 3})
        names = [v.name for v in variables(RemoteSync()) if not v.settable]
        before = host.get(names)
        with pytest.raises(FmuError) as told:
            host.step(h, {"remote.cycle_index": 99, **values})
        assert text in str(told.value)
        assert host.get(names) == before
        host.step(T, {"remote.cycle_index": 4, **dict.fromkeys(values, 0.0)})
        assert host.get(["corrected_cycle_index", "error_id"]) == {"corrected_cycle_index": 4.0, "error_id": 0}


def test_faults_and_refusals_speak_of_variables_of_the_block() -> None:
    names = {v.name for v in variables(RemoteSync())}
    refusals = [refusal for refusal in Refusal if refusal not in (Refusal.NONE, getattr(Refusal, "MASTER_TURNS", None))]
    assert len(refusals) == 5
    assert all({*choice.names} <= names for choice in (*refusals, *Fault))
    assert [int(fault) for fault in Fault] == [0, 0x4B51, 0x4B52, 0x4B53, 0x4B56, 0x4B59]
