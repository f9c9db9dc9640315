"""The corrected index of the BEAT estimator, with numbers by hand.

Unless said otherwise: equal cycles of 2 ms, the limits and blendings of 90 cycles, and D, the received index less the
cycles, steps in the cycles 500 and 1000. So beats are identified in the cycles 590 and 1090, and N is 500. With uniform
slopes c - n is then 1 + x (590 + x) / 45000 in the cycle 1090 + x up to 1180, and after it 2 + (n - 1000) / 500.
"""

from itertools import pairwise

from tests.model.remote_sync.harness import BEATING, UNIFORM, RemoteSyncHarness, T, at, beating, close, offset, run


def test_before_the_drift_is_determined_a_beat_is_worked_off_after_it() -> None:
    """w = (n - 590) / 90; the correction steps with each telegram."""
    recording = run(BEATING, **UNIFORM)
    assert offset(recording, 0, 590, 635, 680, 1000, 1090) == close(0.0, 0.0, 0.5, 1.0, 1.0, 1.0)
    assert at(recording, "correction_time", 499, 500, 590, 635, 680) == close(0.0, -T, -T, -0.5 * T, 0.0)


def test_with_uniform_slopes_the_offset_grows_by_one_in_n_cycles() -> None:
    """At 1135 half of 1 and half of 2 + 135/500; at 1000 + 500 all of the beat, and no more after it."""
    recording = run(beating(1700, 500, 1000), **UNIFORM)
    assert offset(recording, 1135, 1180, 1300, 1399) == close(1.635, 2.36, 2.6, 2.798)
    assert offset(recording, 1499, 1500, 1501, 1699) == close(2.998, 3.0, 3.0, 3.0)
    assert at(recording, "correction_time", 1135, 1300) == close(-0.365 * T, 0.6 * T)


def test_with_the_default_slopes_95_hundredths_of_a_beat_are_done_in_its_first_half() -> None:
    """g(0.27) = 0.513, g(0.36) = 0.684, g(0.5) = 0.95, g(0.6) = 0.96."""
    recording = run(beating(1700, 500, 1000))
    assert offset(recording, 1135, 1180, 1250, 1300) == close(0.5 + 0.5 * 2.513, 2.684, 2.95, 2.96)
    assert offset(recording, 1500, 1699) == close(3.0, 3.0)


def test_slopes_may_be_any() -> None:
    """Through (0.2, 0.3) and (1, 1): g(0.18) = 0.27, g(0.6) = 0.3 + 0.7 / 2. All in the first fifth: then 1."""
    recording = run(BEATING, slope1_numerator=0.3, slope1_denominator=0.2, new_drift_blending_cycles=1)
    assert offset(recording, 1090, 1091, 1300) == close(1.0, 2.0 + 0.3 * 91 / 100, 2.65)
    assert offset(run(BEATING, slope1_numerator=1.0, slope1_denominator=0.2), 1180, 1399) == close(3.0, 3.0)


def test_a_new_drift_comes_in_within_its_blending_cycles() -> None:
    """A third beat after 400: N goes from 500 to 400, seen at 1490 where the offset was 2 + 490/500."""
    recording = run(
        beating(1700, 500, 1000, 1400), new_drift_blending_cycles=60, time_mode_blending_cycles=30, **UNIFORM
    )
    assert offset(recording, 605, 620) == close(0.5, 1.0)
    assert offset(recording, 1120, 1150) == close(0.5 + 0.5 * (2 + 120 / 500), 2 + 150 / 500)
    assert offset(recording, 1490, 1520, 1550) == close(2.98, 0.5 * 2.98 + 0.5 * (3 + 120 / 400), 3 + 150 / 400)


def test_a_slower_sender_is_followed_one_cycle_behind() -> None:
    """The true index between two beats goes from D + 1 to D, c from D to D - 1."""
    recording = run(beating(1400, 500, 1000, sign=-1, first=10), **UNIFORM)
    assert offset(recording, 680, 1180, 1300) == close(9.0, 8 - 0.36, 8 - 0.6)


def test_a_delay_of_a_data_cycle_takes_that_back() -> None:
    values = {"remote.velocity": 500.0}  # a cycle is 1 u
    receiver = RemoteSyncHarness({**UNIFORM, **values, "delay_time_offset": T})
    for index in beating(1301, 500, 1000, sign=-1, first=10):
        receiver.see(index, {"remote.position": float(index)})
    assert receiver["slave.position"] == close(1300 + 8 - 0.6 + 1.0)


def test_the_corrected_index_is_continuous_where_beats_are_identified() -> None:
    """In the cycle itself the old law holds; its step is no more than the blendings and the drift make it."""
    for recording in (run(BEATING), run(beating(2000, 500, 1000, 1400, 1700))):
        c = recording["corrected_cycle_index"]
        assert max(abs(b - a - 1.0) for a, b in pairwise(c)) <= 2.0 / 90 + 1.9 / 300


def test_a_second_beat_long_overdue_keeps_the_offset_where_the_beat_is_used_up() -> None:
    recording = run(beating(2200, 500, 1000, 1900), **UNIFORM)
    assert offset(recording, 1500, 1990) == close(3.0, 3.0)
    assert offset(recording, 2080)[0] == close(3 + 180 / 900)
