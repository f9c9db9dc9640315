"""The received index of RemoteSync, its steps and wraps, and the difference of the indices."""

import pytest

from motionsync.remote_sync.interface import Estimator, Mode
from tests.model.remote_sync.harness import T, at, close, offset, run


def test_the_first_cycle_has_no_step_of_the_index() -> None:
    recording = run(range(5000, 5003))
    assert at(recording, "corrected_cycle_index", 0, 1, 2) == (5000.0, 5001.0, 5002.0)
    assert at(recording, "cycle_index_difference", 0, 1, 2) == (0, 1, 1)
    assert (recording["error"], recording["correction_time"]) == ([False] * 3, [0.0] * 3)
    assert at(recording, "local.cycles", 0, 1, 2) == (0, 1, 2)
    standing = run([7, 7])
    assert at(standing, "equal_data_consecutive", 0, 1) == at(standing, "equal_data_total", 0, 1) == (0, 1)


def test_the_index_wraps_at_65535_and_the_corrected_one_never_does() -> None:
    recording = run([(65530 + n) % 65536 for n in range(12)])
    assert recording["corrected_cycle_index"] == [65530.0 + n for n in range(12)]
    assert recording["cycle_index_difference"][1:] == [1] * 11
    assert not any(recording["error"])


def test_it_wraps_backwards_too() -> None:
    recording = run([1, 0, 65535, 65534])
    assert recording["cycle_index_difference"] == [0, -1, -1, -1]
    assert recording["correction_time"] == close(0.0, 2 * T, 4 * T, 6 * T)


@pytest.mark.parametrize(
    ("value", "index"), [(65536, 0), (65541, 5), (-1, 65535), (2**31 - 1, 65535), (-(2**31), 0), (-65536 - 3, 65533)]
)
def test_an_index_is_taken_modulo_65536(value: int, index: int) -> None:
    recording = run([value, index + 1, value + 2])
    assert recording["corrected_cycle_index"] == [index, index + 1.0, index + 2.0]


@pytest.mark.parametrize(
    ("last", "new", "step"),
    [(0, 32767, 32767), (0, 32768, -32768), (0, 32769, -32767), (40000, 0, 25536), (0, 40000, -25536), (9, 9, 0)],
)
def test_a_step_is_the_shorter_way_round(last: int, new: int, step: int) -> None:
    recording = run([last, new], max_cycle_index_difference=0)
    assert recording["cycle_index_difference"] == [0, step]
    assert recording["correction_time"][1] == close((1 - step) * T)


def test_equal_clocks_need_no_correction_and_show_no_beat() -> None:
    """TIME for ever, start_up true, no drift, no fault."""
    recording = run(range(100, 1100))
    assert recording["corrected_cycle_index"] == [100.0 + n for n in range(1000)]
    assert set(recording["correction_time"]) == {0.0}
    assert set(recording["state"]) == {Mode.TIME}
    assert (set(recording["start_up"]), set(recording["synced"]), set(recording["error"])) == ({True}, {False}, {False})
    assert (set(recording["drift"]), set(recording["beats"]), set(recording["warning"])) == ({0.0}, {0}, {False})


@pytest.mark.parametrize("estimator", Estimator)
def test_flicker_at_the_border_is_no_beat_however_long_it_lasts(estimator: Estimator) -> None:
    indices = [n + (1 if n % 89 == 0 else 0) for n in range(3000)]
    recording = run(indices, estimator=estimator)
    assert set(recording["state"]) == {Mode.TIME}
    assert (recording["beats"][-1], recording["drift"][-1], recording["error"][-1]) == (0, 0.0, False)
    assert offset(recording, 2999)[0] == (1.0 if estimator == Estimator.BEAT else 1.5)  # the first D, never confirmed
