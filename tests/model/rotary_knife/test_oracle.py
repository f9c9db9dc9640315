"""The sequence of the RotaryKnife's oracle on lines of constant velocity: cuts, pieces, late cuts, and rest."""

from math import pi, remainder, sin

import pytest

from tests.model.rotary_knife.knife_scripts import (
    DISENGAGING,
    ENGAGING,
    FAULT,
    HORIZONTAL,
    LATE,
    MERGED,
    OFF,
    PARKING,
    PRODUCT,
    SKIP,
    STOP_LINE,
    SYNCHRONOUS,
    TURNING,
    WAITING,
    jumps,
    lengths,
    near,
    row_at,
    rows,
    script,
    steady,
    times,
)
from tests.oracle.rotary_knife import COLUMNS, reference

# --- cycles -----------------------------------------------------------------------------------------------------------


def test_pieces_of_the_synchronous_length() -> None:
    """B = 200 at 0.2 s: the first cut at 800, its window from 770, its ramp from 230; then a uniform turn of 600."""
    run = steady(1000.0, 3.0, length=600.0)
    assert times(run, "start") == [near(0.23)]
    assert times(run, "sync") == [near(x) for x in (0.77, 1.37, 1.97, 2.57)]
    assert times(run, "cut") == [near(x) for x in (0.8, 1.4, 2.0, 2.6)]
    assert lengths(run) == [near(600.0)] * 4
    states = {0.1: OFF, 0.21: WAITING, 0.5: ENGAGING, 0.78: SYNCHRONOUS, 0.82: SYNCHRONOUS, 0.84: TURNING}
    assert {time: row_at(run, time)["state_code"] for time in states} == states
    for row in rows(run, 0.01, 0.8):
        assert row["slave.velocity"] == near(600.0)
        assert row["slave.acceleration"] == near(0.0, 1e-6)
        assert row["local.unwrapped_position"] == near(360.0 + 600.0 * (row["time"] - 0.8))
        assert remainder(row["slave.position"] - row["local.unwrapped_position"], 360.0) == near(0.0)


@pytest.mark.parametrize(
    ("piece", "first", "fastest", "middle"),
    [(400.0, 800.0, 2.102941, 2.102941), (300.0, 600.0, 3.343750, 3.343750), (900.0, 900.0, 1.0, 0.330357)],
)
def test_shorter_and_longer_pieces(piece: float, first: float, fastest: float, middle: float) -> None:
    """The ramp of the first place begins 570 before it: where that is before `start`, the place is left out."""
    run = steady(1000.0, 4.0, length=piece)
    cuts = times(run, "cut")
    assert cuts[0] == near(0.2 + first / 1000)
    assert lengths(run) == [near(first), *[near(piece)] * (len(cuts) - 1)]
    assert row_at(run, 3.9)["statistics.skipped"] == (first - piece) / piece
    turning = [row["slave.velocity"] / 600 for row in rows(run, piece / 1000 / 64, cuts[0], cuts[1])]
    assert max(turning) == pytest.approx(fastest, rel=1e-6)
    assert row_at(run, (cuts[0] + cuts[1]) / 2)["slave.velocity"] / 600 == pytest.approx(middle, abs=1e-6)
    assert row_at(run, (cuts[0] + cuts[1]) / 2)["local.unwrapped_position"] == near(540.0)


def test_a_piece_of_1500_parks() -> None:
    """Ramps of 540 each, 30 from the cuts; rest for 360."""
    run = steady(1000.0, 5.0, length=1500.0)
    assert times(run, "cut") == [near(x) for x in (1.7, 3.2, 4.7)]
    assert times(run, "rest") == [near(x) for x in (2.27, 3.77)]
    assert times(run, "start") == [near(x) for x in (1.13, 2.63, 4.13)]
    row = row_at(run, 2.4)
    assert (row["state_code"], row["slave.position"], row["slave.velocity"]) == (WAITING, near(180.0), 0.0)
    assert row_at(run, 2.0)["state_code"] == DISENGAGING
    assert row_at(run, 3.2)["last.reserve"] == near(360 / 1500)
    peak = max(abs(row["slave.acceleration"]) for row in rows(run, 0.001, 1.7, 2.3))
    assert peak == near(1666.666667, 1e-5)
    assert row_at(run, 2.0)["peaks.acceleration"] == near(1666.666667)


def test_peaks_of_the_cycle() -> None:
    row = row_at(steady(1000.0, 2.0, length=400.0), 1.2)
    assert row["peaks.velocity"] == near(2.102941 * 600, 1e-6)
    assert row["peaks.acceleration"] == near(5993.3, 1e-5)
    assert row["peaks.jerk"] == near(183187.0, 1e-5)


@pytest.mark.parametrize("piece", [300.0, 600.0, 700.0, 1500.0])
def test_position_velocity_and_acceleration_join(piece: float) -> None:
    for values in (
        {},
        {"sync__overspeed": 0.05},
        {"sync__mode": HORIZONTAL, "sync__before": 60.0, "sync__after": 40.0},
    ):
        run = steady(800.0, 4.0, length=piece, **values)
        assert len(times(run, "cut")) > 1
        for name, size in (("local.unwrapped_position", 1), ("slave.velocity", 1e3), ("slave.acceleration", 1e5)):
            assert jumps(run, name) < 1e-9 * size


def test_the_edge_of_a_horizontal_knife_moves_as_the_material() -> None:
    """Its place along the material, C/(2π) · sin of the angle, is the material's travel since the cut."""
    run = steady(1000.0, 3.0, length=600.0, sync__mode=HORIZONTAL, sync__before=60.0, sync__after=60.0)
    for cut in times(run, "cut"):
        for row in rows(run, 0.005, cut - 0.06, cut + 0.06):
            assert 600 / (2 * pi) * sin(2 * pi * row["slave.position"] / 360) == near(1000 * (row["time"] - cut), 1e-7)
    entry = row_at(run, times(run, "sync")[1])
    assert entry["slave.position"] == near(360 - 38.926175447)
    assert entry["slave.velocity"] / 600 == near(1.285419437)


def test_overspeed_in_the_window() -> None:
    """The mean velocity is 600: in the window 1.05 of it, in the middle 1.05 - 15/8 · 30/540 = 0.945833."""
    run = steady(1000.0, 3.0, length=600.0, sync__overspeed=0.05)
    cut = times(run, "cut")[0]
    assert {round(row["slave.velocity"], 6) for row in rows(run, 0.005, cut - 0.031, cut + 0.029)} == {630.0}
    assert row_at(run, cut + 0.3)["slave.velocity"] == near(600 * 0.9458333333)
    assert lengths(run) == [near(600.0)] * len(times(run, "cut"))


def test_two_blades() -> None:
    """300 is the synchronous length: two cuts a turn. The ramp is 2 (90 - 18)/0.6 = 240, from 270 before the cut on."""
    run = steady(1000.0, 2.0, length=300.0, knife__blades=2, knife__park_angle=90.0)
    assert times(run, "start") == [near(0.23)]
    assert times(run, "cut") == [near(0.5 + 0.3 * i) for i in range(5)]
    for i, cut in enumerate(times(run, "cut")):
        assert row_at(run, cut)["local.unwrapped_position"] == near(180.0 * (i + 1))
    assert {round(row["slave.velocity"], 6) for row in rows(run, 0.01, 0.5)} == {600.0}


def test_whole_turns_count_the_cuts_and_skipped_ones_are_none() -> None:
    run = steady(1000.0, 5.0, length=300.0)
    cuts = times(run, "cut")
    assert row_at(run, cuts[-1])["local.unwrapped_position"] == near(360.0 * len(cuts))
    assert row_at(run, cuts[-1])["statistics.skipped"] == 1.0


# --- limits -----------------------------------------------------------------------------------------------------------


def test_limits_that_are_shown() -> None:
    for piece, fastest in ((300, 1085.767047), (400, 1760.765087), (600, 6000.0), (900, 3800.184663)):
        row = row_at(steady(1000.0, 2.0, length=float(piece)), 1.95)
        assert row["limits.max_line_velocity"] == near(fastest)
        assert row["line.velocity_request"] == near(0.98 * fastest)
        assert row["limits.max_length"] == pytest.approx(1217.142857, abs=5e-7)
        assert row["limits.min_length"] == pytest.approx(284.730278, abs=5e-7)
    row = row_at(steady(1000.0, 1.0, length=600.0), 0.1)
    assert (row["state_code"], row["limits.max_line_velocity"]) == (OFF, near(4326.748711))


def test_kerf_and_correction_shorten_the_limits() -> None:
    """600 between the cuts are a piece of 600 - 4 - 2."""
    run = steady(1000.0, 2.0, length=594.0, kerf=4.0, length_correction=2.0)
    assert times(run, "cut")[1] - times(run, "cut")[0] == near(0.6)
    row = row_at(run, 1.9)
    assert row["last.length"] == near(594.0)
    assert row["limits.max_length"] == pytest.approx(1217.142857 - 6, abs=5e-7)
    assert row["limits.min_length"] == pytest.approx(284.730278 - 6, abs=5e-7)


@pytest.mark.parametrize(("piece", "fastest"), [(300.0, 1085.767047), (400.0, 1760.765087), (900.0, 3800.184663)])
@pytest.mark.parametrize(("share", "met"), [(0.999999, True), (1.000001, False)])
def test_the_greatest_velocity_is_sharp(piece: float, fastest: float, share: float, met: bool) -> None:
    velocity = share * fastest
    run = steady(velocity, 8000 / velocity, length=piece)
    made = lengths(run)[1:]
    assert len(made) >= 3
    assert made == [near(piece if met else 2 * piece)] * len(made)
    row = row_at(run, 7900 / velocity)
    assert row["warning.line_too_fast"] == (not met)
    if met:
        limits = {"slave.velocity": 3600, "slave.acceleration": 72000, "slave.jerk": 1e6}
        for row in rows(run, 13 / velocity):
            assert all(abs(row[name]) <= limit for name, limit in limits.items())


def test_a_piece_that_parks_is_sharp() -> None:
    """1500: 4326.748711. Above it no ramp can be run: the cuts are left out, once for each place."""
    for share, cuts in ((0.999999, 4), (1.000001, 0)):
        velocity = share * 4326.748711
        run = steady(velocity, 0.2 + 6700 / velocity, length=1500.0)
        assert len(times(run, "cut")) == cuts
        assert row_at(run, run["stop_time"])["statistics.skipped"] == (0 if cuts else 4)


def test_a_horizontal_window_is_sharp() -> None:
    values = {"sync__mode": HORIZONTAL, "sync__before": 60.0, "sync__after": 60.0, "length": 600.0}
    fastest = 1342.5783401
    assert len(times(steady(0.999999 * fastest, 3.0, **values), "cut")) == 6
    assert times(steady(1.000001 * fastest, 3.0, **values), "cut") == []


def test_windows_that_overlap_leave_no_way() -> None:
    """A pitch of 60 is before + after: no line is slow enough, each such cut is late; SKIP takes each second one."""
    run = steady(10.0, 90.0, length=60.0)
    row = row_at(run, 80.0)
    assert (row["limits.max_line_velocity"], row["warning.line_too_fast"]) == (0.0, 1.0)
    assert lengths(run)[1:] == [near(120.0)] * (len(lengths(run)) - 1)
    assert len(lengths(run)) > 1


# --- late cuts --------------------------------------------------------------------------------------------------------


def test_a_late_cut_is_skipped() -> None:
    """900 at 3900: only 1800 can be made, parking. The first cut is out of rest."""
    run = steady(3900.0, 2.0, length=900.0, late_mode=SKIP)
    made = lengths(run)
    assert made == [near(900.0), *[near(1800.0)] * (len(made) - 1)]
    row = row_at(run, times(run, "cut")[2])
    assert (row["statistics.skipped"], row["last.kind"], row["last.good"]) == (2.0, MERGED, 0.0)
    assert (row["statistics.pieces_bad"], row["statistics.length_waste"]) == (2.0, near(3600.0))


def test_a_late_cut_is_made_later_where_the_knife_turns() -> None:
    """300 at 1200: the jerk needs 36 (540 - Z) 1200³ = 1e6 Z³, so Z³ + 62208 Z = 62208 · 540: Z = 259.38..."""
    run = steady(1200.0, 1.6, length=300.0, late_mode=LATE)
    made = lengths(run)
    z = made[1] - 60
    assert z**3 + 62208 * z == near(62208 * 540)
    assert made[1:] == [near(made[1])] * (len(made) - 1)
    assert row_at(run, times(run, "cut")[-1])["statistics.late"] == len(made)
    assert row_at(run, times(run, "cut")[-1])["limits.min_length"] == near(made[1])
    assert made[0] == near(570.0)


def test_a_late_cut_of_a_long_piece() -> None:
    """900 at 3900: the jerk 36 (Z - 540) v³/Z³ is greatest for Z = 810, and for 977.86 again as much as is allowed."""
    run = steady(3900.0, 1.5, length=900.0, late_mode=LATE)
    z = lengths(run)[1] - 60
    assert z > 840
    assert z**3 == near(36 * 3900**3 / 1e6 * (z - 540))
    assert lengths(run)[1:] == [near(z + 60)] * (len(times(run, "cut")) - 1)


def test_a_late_cut_is_made_later_where_the_knife_parks() -> None:
    """At 4200 no piece is turned on that is longer than 900: at most 4116.15 is for the longest, 1217.142857."""
    run = steady(4200.0, 1.5, length=900.0, late_mode=LATE)
    assert lengths(run)[1:4] == [pytest.approx(1217.142857, abs=5e-7)] * 3
    assert len(times(run, "rest")) >= 3


def test_a_late_cut_stops_the_line() -> None:
    run = steady(3900.0, 2.0, length=900.0, late_mode=STOP_LINE)
    assert len(times(run, "cut")) == 1
    cut = times(run, "cut")[0]
    assert times(run, "fault 16") == [near(cut + 30 / 3900)]
    row = row_at(run, 1.9)
    assert (row["state_code"], row["error_id"], row["line.stop_request"]) == (FAULT, 16.0, 1.0)
    assert (row["slave.velocity"], row["slave.position"], row["running"]) == (0.0, near(180.0), 0.0)


def test_a_line_too_fast_for_the_ramp_leaves_each_place_out() -> None:
    """At 4400 the places from 1480 on, each 600, with their ramps from 910 on: six begin before 4400."""
    for mode in (SKIP, LATE):
        run = steady(4400.0, 1.0, length=600.0, late_mode=mode)
        row = row_at(run, 1.0)
        assert (row["statistics.cuts"], row["statistics.skipped"], row["state_code"]) == (0.0, 6.0, WAITING)


# --- rest -------------------------------------------------------------------------------------------------------------


def test_stop_parks_after_the_cut_under_way() -> None:
    """`stop` in TURNING: that cut, at 1.4 s, is made; the ramp down takes 540 from 1.43 s on."""
    run = steady(1000.0, 3.0, {"at": 1.1, "stop": True}, length=600.0)
    assert times(run, "cut") == [near(0.8), near(1.4)]
    assert (row_at(run, 1.96)["running"], row_at(run, 1.96)["state_code"]) == (1.0, DISENGAGING)
    row = row_at(run, 1.98)
    assert (row["running"], row["state_code"], row["slave.position"]) == (0.0, OFF, near(180.0))


@pytest.mark.parametrize(("time", "cuts"), [(0.5, 1), (0.79, 1), (0.81, 1), (0.21, 0)])
def test_stop_in_other_states(time: float, cuts: int) -> None:
    """On the ramp up and before the cut it is made, after it no other one; at rest the knife is off at once."""
    run = steady(1000.0, 2.0, {"at": time, "stop": True}, length=600.0)
    assert len(times(run, "cut")) == cuts
    assert row_at(run, 1.9)["state_code"] == OFF
    if not cuts:
        assert row_at(run, 0.22)["state_code"] == OFF


def test_a_ramp_down_beyond_the_limits_is_run() -> None:
    """The line speeds up to 5000, which turning on admits and a ramp does not."""
    segments = [{"duration": 0.5}, {"duration": 0.25, "acceleration": 4000.0}, {"duration": 1.5}]
    sets = ({"at": 0.05, "start": True}, {"at": 1.5, "stop": True})
    run = script(segments, *sets, velocity=4000.0, length=600.0)
    assert row_at(run, 1.4)["warning.limit_exceeded"] == 0.0
    assert row_at(run, 1.4)["statistics.skipped"] == 0.0
    down = [row for row in rows(run, 0.01, 1.5) if row["state_code"] == DISENGAGING]
    assert down
    assert {row["warning.limit_exceeded"] for row in down} == {1.0}
    assert row_at(run, 2.2)["state_code"] == OFF


def test_abort_parks_in_time_at_the_next_park_place() -> None:
    """From 600 °/s a stop takes 2 sqrt(600/1e6) s and 14.697°: from 120° it ends before 180°, from 170° at 540°."""
    for angle, place, passed in ((120.0, 180.0, 0), (170.0, 180.0, 1)):
        time = 0.8 + angle / 600
        run = steady(1000.0, 3.0, {"at": time, "abort": True}, length=600.0)
        assert row_at(run, time + 0.01)["state_code"] == PARKING
        assert times(run, "cut") == [near(0.8)]
        assert times(run, "parked")
        row = row_at(run, 2.9)
        assert (row["state_code"], row["slave.position"], row["running"]) == (OFF, near(place), 0.0)
        assert row["statistics.unsynchronised"] == passed
        assert row["local.unwrapped_position"] == near(360.0 + place + 360.0 * passed)
        moving = rows(run, 0.002, time, times(run, "parked")[0])
        assert min(row["slave.velocity"] for row in moving) >= 0
        assert max(abs(row["slave.acceleration"]) for row in moving) <= 72000


def test_abort_on_a_steep_ramp_down_does_not_turn_back() -> None:
    """At 4000 the ramp down ends with a deceleration that no stop needs: it is taken back first."""
    for part in (0.3, 0.6, 0.9, 0.97):
        time = 0.2 + 1530 / 4000 + part * 540 / 4000
        run = steady(4000.0, 2.0, {"at": time, "abort": True}, length=1500.0)
        before = row_at(run, time - 1e-7)
        assert before["state_code"] == DISENGAGING
        assert before["slave.acceleration"] < 0
        assert min(row["slave.velocity"] for row in rows(run, 0.0005, time, time + 0.3)) >= -1e-9
        assert row_at(run, 1.9)["slave.position"] == near(180.0)
        assert jumps(run, "slave.velocity") < 1e-6


def test_abort_at_rest() -> None:
    run = steady(1000.0, 1.0, {"at": 0.21, "abort": True}, length=1500.0)
    assert (row_at(run, 0.22)["state_code"], row_at(run, 0.22)["slave.position"]) == (OFF, 180.0)


def test_hold_parks() -> None:
    """On hold from 1.1 s to 2.5 s: the cut at 1.4 s is made; the next one with its ramp ahead is at 3.2 s."""
    run = steady(1000.0, 4.0, {"at": 1.1, "hold": True}, {"at": 2.5, "hold": False}, length=600.0)
    assert times(run, "cut") == [near(x) for x in (0.8, 1.4, 3.2, 3.8)]
    assert row_at(run, 2.4)["state_code"] == WAITING
    assert row_at(run, 3.9)["statistics.skipped"] == 2.0


def test_a_missing_length_parks() -> None:
    run = steady(1000.0, 3.0, {"at": 1.0, "length": 0.0}, {"at": 2.2, "length": 1700.0}, length=600.0)
    assert times(run, "cut") == [near(x) for x in (0.8, 1.4)]
    assert row_at(run, 1.9)["warning.no_length"] == 1.0
    row = row_at(run, 2.3)
    assert (row["state_code"], row["warning.no_length"], row["next_cut.position"]) == (WAITING, 0.0, near(3100.0))


def test_without_parking_a_long_piece_is_not_taken() -> None:
    run = steady(1000.0, 4.0, {"at": 1.9, "length": 1300.0}, length=1200.0, allow_parking=False)
    assert times(run, "cut") == [near(1.4), near(2.6)]
    row = row_at(run, 3.5)
    assert (row["error_id"], row["warning.no_length"], row["state_code"]) == (5.0, 1.0, WAITING)


# --- a line that is not steady ----------------------------------------------------------------------------------------


def test_a_line_that_runs_back_takes_the_knife_along() -> None:
    """In TURNING at 1000, back to 700 through the cut at 800, and on again: the cut counts once."""
    segments = [{"duration": 1.0}, {"duration": 0.3, "velocity": -1000.0}, {"duration": 1.2, "velocity": 1000.0}]
    run = script(segments, {"at": 0.2, "start": True}, velocity=1000.0, length=600.0)
    for there in (0.82, 0.9, 0.78, 0.75):
        first, back, again = (row_at(run, time) for time in (there, 2.0 - there, 0.6 + there))
        assert back["local.unwrapped_position"] == near(first["local.unwrapped_position"])
        assert again["local.unwrapped_position"] == near(first["local.unwrapped_position"])
        assert back["slave.velocity"] == near(-first["slave.velocity"])
        assert back["state_code"] == first["state_code"]
    assert times(run, "cut") == [near(0.8), near(2.0)]
    assert row_at(run, 2.4)["statistics.cuts"] == 2.0


def test_a_line_that_runs_back_to_rest() -> None:
    """The ramp up begins at 230: from 500 back to 100 the knife is at rest again, and sets out anew."""
    segments = [{"duration": 0.5}, {"duration": 0.4, "velocity": -1000.0}, {"duration": 1.0, "velocity": 1000.0}]
    run = script(segments, {"at": 0.2, "start": True}, velocity=1000.0, length=600.0)
    assert times(run, "turned back") == [near(0.77)]
    row = row_at(run, 0.85)
    assert (row["state_code"], row["slave.position"], row["slave.velocity"]) == (WAITING, near(180.0), 0.0)
    assert times(run, "start") == [near(0.23), near(0.9 + 0.13)]
    assert times(run, "cut") == [near(0.9 + 0.7)]


def test_a_line_at_rest_in_the_window() -> None:
    segments = [{"duration": 0.79}, {"duration": 1.0, "velocity": 0.0}, {"duration": 1.0, "velocity": 1000.0}]
    run = script(segments, {"at": 0.2, "start": True}, velocity=1000.0, length=600.0)
    row = row_at(run, 1.5)
    assert (row["state_code"], row["slave.velocity"], row["slave.position"]) == (SYNCHRONOUS, 0.0, near(354.0))
    assert times(run, "cut") == [near(1.8), near(2.4)]


def test_a_line_that_speeds_up() -> None:
    """Over the master all is as at constant velocity; the chain rule gives a = s''v² + s'a."""
    segments = [{"duration": 0.5}, {"duration": 2.0, "acceleration": 300.0}]
    run = script(segments, {"at": 0.1, "start": True}, velocity=600.0, length=500.0)
    steady_run = script([{"duration": 4.0}], {"at": 0.1, "start": True}, velocity=600.0, length=500.0)
    made = times(run, "cut")
    assert lengths(run)[1:] == [near(500.0)] * (len(made) - 1)
    master = 600 * 1.7 + 150 * 1.2**2
    there, same = row_at(run, 1.7), row_at(steady_run, master / 600)
    assert there["slave.position"] == near(same["slave.position"])
    assert there["slave.velocity"] / 960 == near(same["slave.velocity"] / 600)
    slope = same["slave.velocity"] / 600
    assert there["slave.acceleration"] == near(same["slave.acceleration"] / 600**2 * 960**2 + slope * 300, 1e-7)


def test_a_master_with_a_period() -> None:
    run = steady(1000.0, 2.0, length=600.0, master__period=700.0)
    assert row_at(run, 1.0)["next_cut.position"] == near(1400.0 % 700.0)
    assert row_at(run, 0.5)["next_cut.position"] == near(100.0)
    assert times(run, "cut")[:2] == [near(0.8), near(1.4)]


def test_material_that_moves_more_than_its_master() -> None:
    """f = 1.02: the pitch is (812 + 4)/1.02 = 800 of the master, k is 0.6 · 1.02 in the window."""
    run = steady(1000.0, 3.0, length=812.0, kerf=4.0, material_factor=1.02)
    cuts = times(run, "cut")
    assert cuts[1] - cuts[0] == near(0.8)
    assert lengths(run)[1] == near(812.0)
    assert row_at(run, cuts[1])["slave.velocity"] == near(612.0)
    assert cuts[1] - times(run, "sync")[1] == near(30 / 1020)


def test_all_columns_are_there() -> None:
    (row,) = reference(steady(1000.0, 1.0), [0.5])
    assert set(COLUMNS) <= set(row)
    assert row["piece.kind"] == PRODUCT
