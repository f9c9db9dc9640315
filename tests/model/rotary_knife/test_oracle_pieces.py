"""The RotaryKnife's oracle where pieces change: orders, formats on the fly, cuts on command, marks, calibration."""

from itertools import pairwise
from math import inf
from random import Random
from typing import Any

import pytest

from tests.model.rotary_knife.knife_scripts import (
    DISENGAGING,
    ENGAGING,
    FAULT,
    PARKING,
    PRODUCT,
    SAMPLE,
    SHORT,
    TRIM,
    TURNING,
    WAITING,
    WASTE,
    jumps,
    lengths,
    near,
    row_at,
    rows,
    script,
    steady,
    times,
)
from tests.oracle.rotary_knife import events, reference


def order(at: float, length: float, quantity: int) -> list[dict[str, Any]]:
    """An order, and its edge taken back."""
    return [
        {"at": at, "order__add": True, "order__length": length, "order__quantity": quantity},
        {"at": at + 0.005, "order__add": False},
    ]


# --- formats on the fly -----------------------------------------------------------------------------------------------


def test_orders_of_all_formats() -> None:
    """Two each of 900, 300, 1500, 400: the first cut at 1.1 s, each piece right, whatever the one before was."""
    formats = (900.0, 300.0, 1500.0, 400.0)
    sets = [table for i, piece in enumerate(formats) for table in order(0.02 + 0.02 * i, piece, 2)]
    run = steady(1000.0, 8.0, *sets, length=600.0)
    expected = [900.0] * 2 + [300.0] * 2 + [1500.0] * 2 + [400.0] * 2 + [600.0] * 2
    assert lengths(run)[:10] == [near(piece) for piece in expected[: len(lengths(run))]]
    cuts = times(run, "cut")
    assert len(cuts) >= 9
    row = row_at(run, cuts[3])
    assert (row["order.completed"], row["order.waiting"], row["order.length_active"]) == (2.0, 2.0, 1500.0)
    assert row_at(run, cuts[4])["order.remaining"] == 1.0
    assert row_at(run, cuts[-1])["order.completed"] == 4.0
    assert row_at(run, cuts[-1])["statistics.skipped"] == 0.0
    for name, size in (("local.unwrapped_position", 1), ("slave.velocity", 1e3), ("slave.acceleration", 1e5)):
        assert jumps(run, name) < 1e-9 * size


def test_the_limits_know_the_next_format() -> None:
    """One piece of 900, then one of 300: while 900 is made, 1085.77 is asked for; 400 waits behind them."""
    sets = [*order(0.02, 900.0, 1), *order(0.04, 300.0, 1), *order(0.06, 400.0, 1)]
    run = steady(800.0, 2.5, *sets, length=1500.0)
    cuts = times(run, "cut")
    assert row_at(run, cuts[0] - 0.1)["limits.max_line_velocity"] == near(1085.767047)
    assert row_at(run, cuts[1])["limits.max_line_velocity"] == near(1760.765087)
    assert row_at(run, cuts[2] - 0.1)["limits.max_line_velocity"] == near(1760.765087)
    assert row_at(run, cuts[2])["limits.max_line_velocity"] == near(4326.748711)


def test_windows_of_two_sizes() -> None:
    """before and after are read when a piece is fixed: 30 and 30 for the cut at 1.4 s, 10 and 50 from 2.0 s on."""
    run = steady(1000.0, 3.5, {"at": 1.0, "sync__before": 10.0, "sync__after": 50.0}, length=600.0)
    cuts, syncs = times(run, "cut"), times(run, "sync")
    assert [cut - sync for cut, sync in zip(cuts, syncs, strict=True)] == [
        near(x) for x in (0.03, 0.03, 0.01, 0.01, 0.01)
    ]
    assert row_at(run, cuts[1] + 0.029)["in_sync"] == 1.0
    assert row_at(run, cuts[1] + 0.031)["in_sync"] == 0.0
    assert row_at(run, cuts[2] + 0.049)["in_sync"] == 1.0
    assert row_at(run, cuts[2] + 0.051)["in_sync"] == 0.0


def test_a_window_without_a_way_is_refused() -> None:
    """±300 leave no way: the piece after the one of then is not fixed, and the knife parks."""
    run = steady(1000.0, 3.0, {"at": 1.0, "sync__before": 300.0, "sync__after": 300.0}, length=600.0)
    assert times(run, "cut") == [near(0.8), near(1.4)]
    row = row_at(run, 2.9)
    assert (row["error_id"], row["warning.no_length"], row["state_code"]) == (5.0, 1.0, WAITING)


def test_this_piece_in_turning_is_laid_anew() -> None:
    """At 1.1 s, 300 after the cut, 600 becomes 700: the cut is at 1.5 s, by one more curve over 370."""
    run = steady(1000.0, 3.0, {"at": 1.1, "length": 700.0}, length=600.0, change_mode=2)
    assert times(run, "cut")[:3] == [near(0.8), near(1.5), near(2.2)]
    assert lengths(run)[1] == near(700.0)
    row = row_at(run, 1.11)
    assert (row["warning.change_pending"], row["state_code"], row["next_cut.distance"]) == (0.0, TURNING, near(360.0))
    before, after = reference(run, [1.1 - 1e-8])[0], reference(run, [1.1 + 1e-8])[0]
    assert after["local.unwrapped_position"] == near(before["local.unwrapped_position"], 1e-7)
    assert after["slave.velocity"] == near(before["slave.velocity"], 1e-6)
    assert row_at(run, 1.5)["local.unwrapped_position"] == near(720.0)
    assert row_at(run, 1.49)["slave.velocity"] == near(600.0)


def test_this_piece_becomes_much_longer() -> None:
    """At 0.9 s, 100 after the cut at 60° of a uniform turn, 600 becomes 1500: down to 180° over 2 · 120/0.6 = 400."""
    run = steady(1000.0, 3.0, {"at": 0.9, "length": 1500.0}, length=600.0, change_mode=2)
    assert times(run, "cut") == [near(0.8), near(2.3)]
    assert row_at(run, 1.0)["state_code"] == DISENGAGING
    assert times(run, "rest")[0] == near(1.3)
    assert row_at(run, 1.4)["slave.position"] == near(180.0)


def test_this_piece_beyond_the_park_angle_waits() -> None:
    """At 1.2 s, at 240°, there is no park place before the cut, and no curve of 1100 that does not turn back."""
    run = steady(1000.0, 4.0, {"at": 1.2, "length": 1500.0}, length=600.0, change_mode=2)
    assert row_at(run, 1.25)["warning.change_pending"] == 1.0
    assert times(run, "cut") == [near(0.8), near(1.4), near(2.9)]
    assert row_at(run, 1.45)["warning.change_pending"] == 0.0


def test_this_piece_too_short_for_the_limits_waits() -> None:
    """At 1.1 s, 300 after the cut, 600 becomes 350: 20 to the window are too few."""
    run = steady(1000.0, 3.0, {"at": 1.1, "length": 350.0}, length=600.0, change_mode=2)
    assert row_at(run, 1.2)["warning.change_pending"] == 1.0
    assert times(run, "cut")[:3] == [near(0.8), near(1.4), near(1.75)]


def test_this_piece_in_the_window_changes_at_its_end() -> None:
    run = steady(1000.0, 2.0, {"at": 0.81, "length": 500.0}, length=600.0, change_mode=2)
    assert row_at(run, 0.82)["warning.change_pending"] == 1.0
    assert row_at(run, 0.84)["warning.change_pending"] == 0.0
    assert times(run, "cut")[:3] == [near(0.8), near(1.3), near(1.8)]


def test_this_piece_on_a_line_at_rest_waits() -> None:
    segments = [{"duration": 1.0}, {"duration": 0.5, "velocity": 0.0}, {"duration": 1.0, "velocity": 1000.0}]
    sets = ({"at": 0.2, "start": True}, {"at": 1.2, "length": 700.0})
    run = script(segments, *sets, velocity=1000.0, length=600.0, change_mode=2)
    assert row_at(run, 1.4)["warning.change_pending"] == 1.0
    assert times(run, "cut")[1] == near(2.0)  # 1500 at 2.0 s: the line moves again at the beginning of that step


# --- cuts on command --------------------------------------------------------------------------------------------------


def test_cut_now_at_rest() -> None:
    """From parking at once: the ramp up and the window begin, 570 before the cut."""
    run = steady(1000.0, 2.5, {"at": 0.5, "cut_now": True}, length=1500.0)
    assert times(run, "start")[0] == near(0.5)
    assert times(run, "cut")[0] == near(1.07)
    row = row_at(run, 1.08)
    assert (row["last.kind"], row["last.length"], row["last.good"]) == (SHORT, near(870.0), 0.0)
    assert row["next_cut.position"] == near(2570.0)


def test_cut_now_while_turning() -> None:
    """400 at 1000, asked for when the window ends: as early as the jerk allows, as limits.min_length says."""
    run = steady(1000.0, 2.0, {"at": 1.01, "cut_now": True}, length=400.0)
    shortest = row_at(run, 1.2)["limits.min_length"]
    assert shortest == pytest.approx(284.730278, abs=5e-7)
    assert times(run, "cut")[:2] == [near(1.0), near(1.0 + shortest / 1000)]
    assert row_at(run, times(run, "cut")[1])["last.kind"] == SHORT


def test_cut_now_on_a_line_at_rest_changes_nothing() -> None:
    segments = [{"duration": 1.0}, {"duration": 0.5, "velocity": 0.0}, {"duration": 1.0, "velocity": 1000.0}]
    sets = ({"at": 0.2, "start": True}, {"at": 1.2, "cut_now": True})
    run = script(segments, *sets, velocity=1000.0, length=600.0)
    assert times(run, "cut")[:2] == [near(0.8), near(1.9)]
    assert (row_at(run, 1.3)["warning.change_pending"], row_at(run, 1.95)["warning.change_pending"]) == (1.0, 0.0)


def test_cut_now_on_the_ramp_up_is_that_cut() -> None:
    run = steady(1000.0, 1.5, {"at": 0.5, "cut_now": True}, length=600.0)
    assert times(run, "cut")[:2] == [near(0.8), near(1.4)]
    assert row_at(run, 0.81)["last.kind"] == PRODUCT


def test_cut_now_on_the_ramp_down() -> None:
    """1500 at 1000: at 1.9 s, on the ramp down, the cut comes before the one that the rest would have led to."""
    run = steady(1000.0, 4.0, {"at": 1.9, "cut_now": True}, length=1500.0)
    cuts = times(run, "cut")
    assert cuts[0] == near(1.7)
    assert 1.99 < cuts[1] < 2.2
    made = [*rows(run, 0.001, 1.9, cuts[1]), *(row_at(run, time) for time in (1.9 + 1e-7, cuts[1] - 0.03 - 1e-7))]
    assert min(row["slave.velocity"] for row in made) >= 0
    assert max(abs(row["slave.jerk"]) for row in made) <= 1e6 * (1 + 1e-9)
    limited = (
        max(row["slave.velocity"] for row in made) / 3600,
        max(abs(row["slave.acceleration"]) for row in made) / 72000,
        max(abs(row["slave.jerk"]) for row in made) / 1e6,
    )
    assert max(limited) == near(1.0, 1e-5)
    assert cuts[2] - cuts[1] == near(1.5)


def test_cut_now_is_refused_while_the_knife_does_not_run() -> None:
    run = steady(1000.0, 1.0, {"at": 0.1, "cut_now": True}, length=600.0)
    assert row_at(run, 0.15)["error_id"] == 6.0
    assert row_at(run, 0.25)["error_id"] == 0.0


# --- the kinds of pieces ----------------------------------------------------------------------------------------------


def test_waste_samples_and_batches() -> None:
    sets = [
        {"at": 1.0, "take_sample": True},
        {"at": 1.5, "waste": True},
        {"at": 2.2, "waste": False},
    ]
    run = steady(1000.0, 4.0, *sets, length=600.0, sample_length=500.0, waste_length=400.0, batch_size=2)
    cuts = times(run, "cut")
    assert lengths(run)[:6] == [near(x) for x in (600, 600, 500, 400, 600, 600)]
    kinds = [row_at(run, cut)["last.kind"] for cut in cuts[:6]]
    assert kinds == [PRODUCT, PRODUCT, SAMPLE, WASTE, PRODUCT, PRODUCT]
    row = row_at(run, cuts[5])
    assert (row["statistics.pieces_good"], row["batches"], row["batch_done"]) == (4.0, 2.0, 1.0)
    assert (row["statistics.pieces_sample"], row["statistics.pieces_waste"]) == (1.0, 1.0)
    assert row["statistics.length_waste"] == near(400.0)


def test_trim() -> None:
    """At least 100 are cropped: late at `start`, so the ramp begins at once and 570 are."""
    run = steady(1000.0, 2.0, length=600.0, start_mode=2, trim_length=100.0)
    assert times(run, "cut")[:2] == [near(0.77), near(1.37)]
    row = row_at(run, 0.78)
    assert (row["last.kind"], row["last.length"], row["statistics.late"]) == (TRIM, near(570.0), 0.0)


def test_the_front_is_given_along_the_material() -> None:
    """The front is 100 past the cut's place, and counts as a cut b/2 = 2 ahead of it: B = 200 - 100 - 2."""
    run = steady(1000.0, 2.0, length=796.0, kerf=4.0, front_position=100.0)
    assert times(run, "cut")[0] == near((98 + 800) / 1000)
    assert lengths(run)[0] == near(796.0)


def test_the_knife_goes_on_after_stop() -> None:
    """CONTINUE: the piece after the last cut, at 1400, is one of 1800 then."""
    sets = ({"at": 1.1, "stop": True}, {"at": 2.2, "start": False}, {"at": 2.3, "start": True, "start_mode": 3})
    run = steady(1000.0, 3.5, *sets, {"at": 2.25, "length": 1800.0}, length=600.0)
    assert times(run, "cut") == [near(0.8), near(1.4), near(3.2)]
    assert lengths(run)[-1] == near(1800.0)


# --- calibration and marks --------------------------------------------------------------------------------------------


def test_calibration_by_a_measured_piece() -> None:
    """(1512 + 4)/(1500 + 4) = 1.007978723, in force from the piece fixed next; k grows with it."""
    measured = {"at": 2.5, "calibration__execute": True, "calibration__measured_length": 1512.0}
    run = steady(1000.0, 5.5, measured, length=1500.0, kerf=4.0)
    assert row_at(run, 2.6)["calibration.factor"] == near(1.007978723)
    cuts = times(run, "cut")
    assert cuts[1] - cuts[0] == near(1.504)
    assert cuts[2] - cuts[1] == near(1.504 / 1.007978723)
    assert row_at(run, cuts[2] - 0.001)["slave.velocity"] == near(600.0 * 1.007978723)
    assert row_at(run, cuts[1] + 0.001)["slave.velocity"] == near(600.0)


def mark(at: float, position: float) -> list[dict[str, Any]]:
    return [{"at": at, "mark__detected": True, "mark__position": position}, {"at": at + 0.005, "mark__detected": False}]


def test_marks_decide_where_the_cuts_are() -> None:
    """Marks at 400, 1010, 1590, 2200; the sensor is 1500 upstream, the cut 25 behind the mark."""
    places = (400.0, 1010.0, 1590.0, 2200.0)
    sets = [table for place in places for table in mark(place / 1000, place)]
    run = steady(1000.0, 4.2, *sets, source=2, mark__sensor_distance=1500.0, mark__cut_offset=25.0, length=0.0)
    assert times(run, "cut") == [near((place + 1525) / 1000) for place in places]
    assert lengths(run)[1:] == [near(x) for x in (610, 580, 610)]
    assert row_at(run, 0.3)["next_cut.known"] == 0.0
    assert row_at(run, 0.5)["next_cut.position"] == near(1925.0)
    row = row_at(run, 4.1)
    assert (row["statistics.marks"], row["statistics.pieces_good"], row["state_code"]) == (4.0, 4.0, DISENGAGING)


def test_a_missing_mark_is_replaced() -> None:
    """Marks each 600 ± 20; the third is missing: it counts at 1600, and is cut at 3125."""
    sets = [table for place in (400.0, 1000.0, 2195.0) for table in mark(place / 1000, place)]
    values = {"mark__sensor_distance": 1500.0, "mark__cut_offset": 25.0, "mark__spacing": 600.0, "mark__window": 20.0}
    run = steady(1000.0, 4.0, *sets, source=2, **values)
    assert times(run, "cut") == [near(x / 1000) for x in (1925, 2525, 3125, 3720)]
    row = row_at(run, 2.5)
    assert (row["statistics.marks"], row["statistics.marks_missing"]) == (3.0, 1.0)
    row = row_at(run, 3.75)
    assert row["last.error"] == near(-5.0)
    assert row["last.good"] == 0.0


def test_too_many_missing_marks_stop_the_line() -> None:
    values = {"mark__sensor_distance": 500.0, "mark__spacing": 100.0, "mark__window": 20.0, "mark__max_missing": 1}
    run = steady(1000.0, 2.0, *mark(0.4, 400.0), source=2, **values)
    assert times(run, "fault 18") == [near(0.63)]  # the first step's beginning more than 20 past 600
    assert row_at(run, 1.9)["state_code"] == FAULT


def test_marks_too_close_are_skipped() -> None:
    """100 after another no cut can be made: that mark is dropped."""
    sets = [table for place in (400.0, 1000.0, 1100.0, 1600.0) for table in mark(place / 1000, place)]
    run = steady(1000.0, 3.3, *sets, source=2, mark__sensor_distance=1500.0)
    assert times(run, "cut") == [near(x / 1000) for x in (1900, 2500, 3100)]
    assert row_at(run, 3.2)["statistics.skipped"] == 1.0


# --- the records ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_the_records_balance(seed: int) -> None:
    """All lengths and kerfs are the material that has passed, for orders at random on a line that brakes."""
    random = Random(seed)
    sets = [t for i in range(6) for t in order(0.01 + 0.01 * i, random.uniform(250, 1800), random.randint(1, 2))]
    segments = [
        {"duration": 2.0},
        {"duration": 0.5, "acceleration": -random.uniform(200, 1500)},
        {"duration": 0.5, "acceleration": random.uniform(200, 2000)},
        {"duration": 2.0},
    ]
    run = script(
        segments,
        {"at": 0.1, "start": True},
        *sets,
        velocity=random.uniform(400, 1000),
        kerf=3.0,
        material_factor=1.01,
        late_mode=random.choice([1, 2]),
        knife__blades=random.choice([1, 2]),
        knife__park_angle=90.0,
    )
    cuts = times(run, "cut")
    assert len(cuts) > 2
    made = [row_at(run, cut) for cut in cuts]
    for a, b in pairwise(made):
        assert b["statistics.cuts"] == a["statistics.cuts"] + 1
        assert b["slave.position"] % 180.0 == near(0.0, 1e-7) or b["slave.position"] % 180.0 == near(180.0)
    ends = reference(run, [cuts[0], cuts[-1]])
    passed = [row["next_cut.position"] - (row["piece.ordered"] + 3.0) / 1.01 for row in (ends[1], ends[-1])]
    assert sum(lengths(run)[1:]) + 3.0 * (len(cuts) - 1) == near(1.01 * (passed[1] - passed[0]))
    for name, size in (("local.unwrapped_position", 1), ("slave.velocity", 1e3)):
        assert jumps(run, name) < 1e-8 * size
    assert all(-inf < row["slave.acceleration"] < inf for row in made)
    assert {name for _, name in events(run)} <= {"start", "sync", "cut", "rest", "turned back"}
    assert row_at(run, cuts[0])["state_code"] not in (ENGAGING, WAITING)


COMMANDS = ("stop", "abort", "cut_now", "hold", "take_sample", "waste", "reset")


@pytest.mark.parametrize("seed", range(4))
def test_a_knife_under_commands_at_random(seed: int) -> None:
    """Whatever comes: it moves steadily, turns back on no line that runs forwards, and rests at its park angle."""
    random = Random(seed)
    sets: list[dict[str, Any]] = [{"at": 0.1, "start": True}, {"at": 2.0, "start": False}, {"at": 3.0, "start": True}]
    for _ in range(6):
        time = round(random.uniform(0.6, 4.5), 2) + 0.003
        sets.append({"at": time, "length": random.choice([250.0, 400.0, 800.0, 1700.0])})
        name = random.choice(COMMANDS)
        sets += [{"at": time + 0.1, name: True}, {"at": time + 0.2, name: False}]
    segments = [{"duration": 4.0}, {"duration": 0.5, "acceleration": random.uniform(-1000, 500)}, {"duration": 0.5}]
    run = script(segments, *sets, velocity=1300.0, length=600.0, change_mode=2, late_mode=random.choice([1, 2]))
    assert times(run, "cut")
    assert jumps(run, "local.unwrapped_position") < 1e-8
    assert jumps(run, "slave.velocity") < 1e-5
    for row in rows(run, 0.04):
        assert row["slave.velocity"] >= -1e-9
        if row["state_code"] in (FAULT, PARKING):
            assert abs(row["slave.acceleration"]) <= 72000 * (1 + 1e-9)
        if row["slave.velocity"] == 0:
            assert row["slave.position"] == near(180.0)
