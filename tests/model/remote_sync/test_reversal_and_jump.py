"""Where RemoteSync's estimate starts anew: a beat of opposite sign, a jump of the difference; and its warning."""

import pytest

from motionsync.remote_sync.interface import Mode
from tests.model.remote_sync.harness import UNIFORM, at, beating, close, offset, run, since


def test_a_beat_of_opposite_sign_starts_anew_and_is_the_first_itself() -> None:
    """D is 1 again from 1300 on: seen at 1390, where c - n is 2.78; 0 from 1700 on makes N = 400."""
    indices = [index - (n >= 1300) - (n >= 1700) for n, index in enumerate(beating(2000, 500, 1000))]
    recording = run(indices, **UNIFORM)
    assert at(recording, "synced", 1389, 1390, 1790) == (True, False, False)
    assert at(recording, "beats", 1389, 1390, 1790) == (2, 1, 2)
    assert at(recording, "drift", 1389, 1390, 1790) == (2000.0, 0.0, close(-2500.0))
    assert at(recording, "warning", 1389, 1390, 1789, 1790) == (False, True, True, False)
    assert at(recording, "state", 1389, 1390) == (Mode.SYNC, Mode.TIME)
    assert at(recording, "start_up", 1389, 1390) == (False, True)
    assert not any(recording["error"])
    assert offset(recording, 1390, 1435, 1480) == close(2.78, (2.78 + 1) / 2, 1.0)
    assert since({"synced": recording["synced"][1390:]}, "synced") > 400


@pytest.mark.parametrize("change", [2, 3, -2, -5])
def test_a_change_of_two_or_more_starts_anew(change: int) -> None:
    indices = [index + change * (n >= 1300) for n, index in enumerate(beating(1600, 500, 1000))]
    recording = run(indices, **UNIFORM)
    assert at(recording, "synced", 1389, 1390) == (True, False)
    assert at(recording, "beats", 1389, 1390, 1599) == (2, 0, 0)
    assert at(recording, "drift", 1389, 1390) == (2000.0, 0.0)
    assert at(recording, "warning", 1389, 1390, 1599) == (False, True, True)
    assert at(recording, "state", 1389, 1390) == (Mode.SYNC, Mode.TIME)
    assert not any(recording["error"])
    assert offset(recording, 1390, 1435, 1480) == close(2.78, (2.78 + 2 + change) / 2, 2.0 + change)


def test_a_change_of_two_before_any_beat_is_no_warning() -> None:
    recording = run([n + 6 * (n >= 200) for n in range(500)])
    assert (recording["beats"][-1], recording["warning"][-1], recording["error"][-1]) == (0, False, False)
    assert offset(recording, 290, 320, 380) == close(0.0, 2.0, 6.0)


def test_a_warning_outlasts_another_change_of_two() -> None:
    recording = run([n + (n >= 500) + 3 * (n >= 800) - 2 * (n >= 1100) + (n >= 1400) for n in range(1500)])
    assert at(recording, "beats", 889, 890, 1190, 1490) == (1, 0, 0, 1)
    assert at(recording, "warning", 889, 890, 1190, 1489, 1490) == (False, True, True, True, False)


def test_a_reversal_of_the_very_first_beat() -> None:
    """It is forgotten, which is a warning; the opposite one is the first."""
    recording = run([n + (300 <= n < 700) - (n >= 1200) for n in range(1300)])
    assert at(recording, "beats", 390, 790, 1290) == (1, 1, 2)
    assert at(recording, "warning", 390, 790, 1290) == (False, True, False)
    assert recording["drift"][1290] == close(-2000.0)


@pytest.mark.parametrize(("third", "warned"), [(1599, False), (1600, False), (1601, True), (1400, False), (1399, True)])
def test_a_mean_that_changes_by_more_than_a_fifth_is_a_warning(third: int, warned: bool) -> None:
    recording = run(beating(1800, 500, 1000, third))
    assert at(recording, "warning", 1090, third + 89, third + 90) == (False, False, warned)


def test_the_warning_stays_until_the_next_beat() -> None:
    recording = run(beating(2800, 500, 1000, 1700, 2350))
    assert at(recording, "warning", 1789, 1790, 2439, 2440) == (False, True, True, False)
    assert at(recording, "synced", 1790, 2440) == (True, True)


def test_the_warning_is_that_of_the_means() -> None:
    """500, 800: from 500 to 650 is three tenths; of two, from 650 of (500, 800) to 700 of (800, 600) is less."""
    indices = beating(2600, 500, 1000, 1800, 2400)
    assert at(run(indices), "warning", 1890, 2490) == (True, True)
    assert at(run(indices, periods_for_mean_drift=2), "warning", 1890, 2490) == (False, False)
