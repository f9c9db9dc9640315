"""How RemoteSync finds beats: transition zones, quiet stretches, the mean distance, the drift.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

from typing import Any

import pytest

from tests.model.remote_sync.harness import (
    BEATING,
    PHASE,
    UNIFORM,
    at,
    beat_cycles,
    beating,
    close,
    offset,
    run,
    since,
)


@pytest.mark.parametrize("limit", [1, 7, 90])
def test_a_beat_is_identified_once_the_difference_has_been_quiet_for_the_limit(limit: int) -> None:
    assert beat_cycles(run(BEATING, end_of_transition_limit=limit)) == [500 + limit, 1000 + limit]


def test_a_beat_is_dated_by_the_middle_of_its_zone() -> None:
    """Zones of flicker from 480 to 520 and from 1000 to 1011: N = 505.5, from 90 cycles after their ends on."""
    differences = [0] * 480 + [1, 0] * 20 + [1] * 480 + [2, 1] * 5 + [1] + [2] * 189
    recording = run((n + d for n, d in enumerate(differences)), **UNIFORM)
    assert beat_cycles(recording) == [610, 1101]
    assert at(recording, "drift", 1100, 1101) == (0.0, close(1e6 / 505.5))
    assert recording["local.beat_distance"][1199] == 505.5
    assert at(recording, "local.transition", 479, 480, 609, 610, 999, 1000, 1101) == (0, 1, 1, 0, 0, 1, 0)
    assert recording["corrected_cycle_index"][1195] == close(1195 + 2 + (1195 - 1005.5) / 505.5)


def test_a_quiet_stretch_at_the_confirmed_difference_closes_the_zone_without_a_beat() -> None:
    indices = [*BEATING]
    indices[300] += 1
    recording = run(indices)
    assert at(recording, "local.transition", 300, 390, 391) == (True, True, False)
    assert (beat_cycles(recording), recording["drift"][-1]) == ([590, 1090], 2000.0)


@pytest.mark.parametrize("values", [UNIFORM, PHASE])
@pytest.mark.parametrize("flicker", [511, 700, 1030, 1250])
def test_a_closed_zone_leaves_the_correction_alone(values: dict[str, Any], flicker: int) -> None:
    """Quiet stretches of 10 cycles: also while a beat before it is still worked off."""
    indices = [*BEATING]
    indices[flicker] += 1
    parameters: dict[str, Any] = {"end_of_transition_limit": 10, **values}
    recording, calm = run(indices, **parameters), run(BEATING, **parameters)
    assert at(recording, "local.transition", flicker, flicker + 10, flicker + 11) == (True, True, False)
    for name in ("corrected_cycle_index", "drift", "beats", "synced"):
        assert recording[name] == calm[name]


def test_flicker_shortly_before_a_step_belongs_to_its_zone() -> None:
    """First 450, last 500: dated 475."""
    indices = [*BEATING]
    indices[450] += 1
    assert run(indices)["drift"][-1] == close(1e6 / 525.0)


def test_the_first_quiet_stretch_confirms_the_difference_without_a_beat() -> None:
    """Where it is the first D, nothing is to be seen; where not, it is worked off as in time mode."""
    recording = run(beating(400, 40))
    assert (recording["beats"][-1], recording["warning"][-1]) == (0, False)
    assert offset(recording, 129, 130, 175, 220, 399) == close(0.0, 0.0, 0.5, 1.0, 1.0)
    recording = run(beating(400, 40, 60, 61), time_mode_blending_cycles=10, end_of_transition_limit=50)
    assert offset(recording, 111, 112, 121, 399) == close(0.0, 3 / 10, 3.0 * 10 / 10, 3.0)
    recording = run(beating(800, 40, 500))
    assert beat_cycles(recording) == [590]


def test_n_is_the_mean_of_the_last_distances() -> None:
    """Distances 500, 600, 400: means 550 and 500 of two, 500 of all three."""
    indices = beating(2200, 500, 1000, 1600, 2000)
    recording = run(indices, periods_for_mean_drift=2)
    assert at(recording, "drift", 1090, 1689, 1690, 2090) == (0.0, 0.0, close(1e6 / 550), close(2000.0))
    assert since(recording, "synced") > 1690
    assert at(run(indices, periods_for_mean_drift=3), "drift", 2089, 2090) == (0.0, close(2000.0))
    assert at(run(indices), "drift", 1090, 1690, 2090) == close(2000.0, 1e6 / 600, 2500.0)


def test_up_to_64_distances_are_averaged() -> None:
    """Alternately 10 and 20 cycles, but the first one 500."""
    dates = [100, 600]
    for i in range(70):
        dates.append(dates[-1] + (10 if i % 2 else 20))
    indices = beating(dates[-1] + 10, *dates)
    recording = run(indices, periods_for_mean_drift=64, end_of_transition_limit=3, max_cycle_index_difference=0)
    assert recording["beats"][-1] == 72
    assert recording["drift"][dates[64] + 2] == 0.0
    assert recording["drift"][dates[64] + 3] == close(1e6 * 64 / (dates[64] - 100))
    assert recording["drift"][-1] == close(1e6 / 15.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_drift_is_negative_if_the_sender_s_cycle_is_longer(sign: int) -> None:
    recording = run(beating(1400, 500, 1000, sign=sign, first=10))
    assert at(recording, "drift", 1089, 1090, 1399) == (0.0, sign * 2000.0, sign * 2000.0)
