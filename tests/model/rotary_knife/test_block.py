"""The RotaryKnife, sentence by sentence, with numbers by hand.

The knife has a circumference of 600, one blade, windows of 30 before and after the cut and k = 0.6 degrees per u. A
ramp takes 2 * 162 / 0.6 = 540 of the master. The line runs with 1000 u/s from 0 at 0 s, where `start` is given.
"""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.cutting.faults import NoLength, PieceFault
from motionsync.cutting.interface import ChangeMode, LateMode, PieceKind
from motionsync.rotary_knife.block import RotaryKnife
from motionsync.rotary_knife.faults import KnifeContradiction, Refusal, SkipReason
from motionsync.rotary_knife.interface import State, SyncMode
from tests.model.rotary_knife.harness import RotaryKnifeHarness, started_knife
from tests.support.blocks.drawn import drawn

SYNC = 600.0  # degrees/s, the knife's velocity in sync


def near(*values: float, tolerance: float = 1e-9) -> Any:
    """What equals one number, or a tuple of several, within the tolerance, relative or absolute."""
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


# --- the law ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("length", "in_the_middle"),
    [
        (600.0, 1.0),
        (400.0, 1.0 + 15.0 / 8.0 * 200.0 / 340.0),
        (300.0, 3.34375),
        (900.0, 1.0 - 15.0 / 8.0 * 300.0 / 840.0),
    ],
)
def test_between_two_windows_the_knife_turns_on(length: float, in_the_middle: float) -> None:
    """The first piece is one of 900, which lies 360 behind the ramp's beginning; the next one has the length."""
    knife = started_knife({"length": 900.0}).at(0.1).set({"length": length})
    knife.at(0.9 + 0.5e-3 * length)
    assert knife.state == State.TURNING
    assert knife["slave.velocity"] == near(in_the_middle * SYNC)
    assert knife["slave.position"] == near(180.0)
    assert knife["peaks.velocity"] == near(max(in_the_middle, 1.0) * SYNC)
    knife.at(0.9 + 1e-3 * length + 1e-6)
    assert (knife["slave.velocity"], knife["last.length"]) == near(SYNC, length)
    assert knife["slave.position"] == near(SYNC * 1e-6)


def test_the_knife_rests_on_a_long_piece() -> None:
    """Pieces of 1500: from a cut the ramp down begins 30 later and is 540 long, the ramp up ends 30 before the next."""
    knife = started_knife({"length": 1500.0}).at(1.5 + 0.03 + 0.54 - 1e-6)
    assert knife.state == State.DISENGAGING
    knife.at(1.5 + 0.03 + 0.54)
    assert (knife.state, knife["slave.position"], knife["slave.velocity"]) == (State.WAITING, near(180.0), 0.0)
    knife.at(3.0 - 0.03 - 0.54 - 1e-6)
    assert (knife.state, knife["slave.position"]) == (State.WAITING, near(180.0))
    knife.at(3.0 - 0.03 - 0.54 + 1e-6)
    assert knife.state == State.ENGAGING
    knife.at(3.0)
    assert (knife["statistics.cuts"], knife["slave.velocity"]) == (2, near(SYNC))


def test_the_longest_piece_without_rest_comes_to_rest_in_one_instant() -> None:
    """Z = 15/7 540."""
    longest = 60.0 + 15.0 / 7.0 * 540.0
    knife = started_knife({"length": longest}).at(0.1)
    assert knife["limits.max_length"] == near(longest)
    knife.at(1.5e-3 * longest)
    assert (knife.state, knife["slave.velocity"]) == (State.TURNING, near(0.0, tolerance=1e-6))


def test_two_blades_cut_in_turns() -> None:
    """With two blades 300 is the synchronous length: the knife turns evenly, and the blades cut at 0 and at 180."""
    values = {"knife.blades": 2, "knife.park_angle": 90.0, "length": 300.0}
    knife = started_knife(values).at(0.6)
    assert (knife["slave.position"], knife["slave.velocity"]) == near(0.0, SYNC)
    knife.at(0.9)
    assert (knife["slave.position"], knife["slave.velocity"]) == near(180.0, SYNC)
    knife.at(1.0)
    assert (knife["slave.velocity"], knife["statistics.cuts"]) == (near(SYNC), 3)


def test_an_overspeed_pulls_the_piece_away() -> None:
    """5 %: 60 of the material take 63 of the edge; in between 537 are left for 540, so the middle is below the line."""
    knife = started_knife({"sync.overspeed": 0.05, "length": 600.0}).at(1.2)
    assert knife["slave.velocity"] == near(1.05 * SYNC)
    knife.at(1.5)
    assert knife["slave.velocity"] == near(SYNC * (1.05 - 15.0 / 8.0 * 30.0 / 540.0))


def test_along_the_material_the_edge_is_as_fast_as_the_line() -> None:
    """HORIZONTAL, 60 before the cut: the angle's sine is 2 pi 60/600, and cos * speed along the circle = the line's."""
    values = {"sync.mode": SyncMode.HORIZONTAL, "sync.before": 60.0, "sync.after": 60.0, "length": 600.0}
    knife = RotaryKnifeHarness(values, speed=500.0).give("start").at(2.4 - 59.0 / 500.0)
    angle = math.asin(2.0 * math.pi * 59.0 / 600.0)
    assert knife.state == State.SYNCHRONOUS
    assert knife["slave.position"] == near(360.0 - math.degrees(angle))
    assert knife["slave.velocity"] == near(math.degrees(500.0 / (600.0 / (2.0 * math.pi)) / math.cos(angle)))


# --- limits -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("length", "fastest"),
    [(300.0, 1085.767047), (400.0, 1760.765087), (900.0, 3800.184663), (1500.0, 4326.748711)],
)
def test_the_greatest_line_velocity_of_each_format(length: float, fastest: float) -> None:
    knife = RotaryKnifeHarness({"length": length})
    assert knife["limits.max_line_velocity"] == near(fastest, tolerance=1e-9)


@pytest.mark.parametrize(("velocity", "shortest"), [(500.0, 183.312645), (1000.0, 284.730278), (2000.0, 427.567549)])
def test_the_shortest_piece_at_a_line_velocity(velocity: float, shortest: float) -> None:
    assert RotaryKnifeHarness(speed=velocity)["limits.min_length"] == near(shortest, tolerance=1e-8)


@pytest.mark.parametrize("length", [300.0, 400.0, 900.0, 1500.0])
def test_the_greatest_line_velocity_is_sharp(length: float) -> None:
    fastest = RotaryKnifeHarness({"length": length})["limits.max_line_velocity"]
    slow = RotaryKnifeHarness({"length": length}, speed=0.999999 * fastest).give("start")
    fast = RotaryKnifeHarness({"length": length}, speed=1.000001 * fastest).give("start")
    duration = 8.0 * length / fastest
    slow.run(1500.0 / fastest)
    left_out = slow["statistics.skipped"]
    for row in slow.rows(duration, cuts=[i * duration / 500.0 for i in range(500)]).values():
        assert abs(row["slave.velocity"]) <= 3600.0 * (1.0 + 1e-9)
        assert abs(row["slave.acceleration"]) <= 72000.0 * (1.0 + 1e-9)
        assert abs(row["slave.jerk"]) <= 1e6 * (1.0 + 1e-9)
    assert slow["statistics.cuts"] >= 7
    assert slow["statistics.skipped"] == left_out
    assert not slow["warning.any"]
    fast.run(1500.0 / fastest + duration)
    assert fast["warning.line_too_fast"]
    assert fast["statistics.skipped"] > left_out


# --- late cuts --------------------------------------------------------------------------------------------------------


def test_a_cut_whose_ramp_would_have_begun_before_start_is_left_out() -> None:
    """Pieces of 300: the ramp and half a window take 570, so the first cut is that at 600."""
    knife = started_knife({"length": 300.0}).at(0.6)
    assert (knife["statistics.cuts"], knife["statistics.skipped"]) == (1, 1)
    assert (knife["last.length"], knife["last.kind"]) == (near(600.0), PieceKind.MERGED)
    knife.at(0.9)
    assert (knife["last.length"], knife["last.kind"]) == (near(300.0), PieceKind.PRODUCT)


@drawn(anew=True)
@given(st.floats(100.0, 2000.0), st.floats(0.0, 0.2), st.floats(0.05, 1.3), st.booleans())
def test_a_cut_that_is_skipped_for_its_ramp_says_how_much_is_missing(
    circumference: float, window: float, length: float, is_fast: bool
) -> None:
    """All in circumferences: the ramp from park, at half a turn, takes 2 (1/2 - before), and the cut is `before` behind
    it. So 1 - before has to be ahead of it at start; a line that is too fast for the ramp is another reason."""
    values = dict.fromkeys(("sync.before", "sync.after"), window * circumference)
    values |= {"knife.circumference": circumference, "length": length * circumference}
    speed = 0.9 * RotaryKnifeHarness({**values, "length": 1e5}, speed=1.0).run(0.01)["limits.max_line_velocity"]
    knife = started_knife(values, speed=speed * (1.5 if is_fast else 1.0)).run(1e-9)
    missing = 1.0 - window - length
    if is_fast and missing > 0.0:
        assert knife["local.skip_reason"] == SkipReason.LATE
    elif missing > 1e-6:
        assert knife["local.skip_reason"] == SkipReason.RAMP
        assert knife["local.missing_distance"] == pytest.approx(missing * circumference, rel=1e-6)
    elif missing < -1e-6:
        assert knife["local.skip_reason"] == SkipReason.NONE


def test_what_becomes_of_a_cut_that_is_too_near() -> None:
    """At 1200 u/s the piece of 300 is too short: SKIP cuts 600, LATE as soon as possible, STOP_LINE stops the line."""
    skip, late, stop = (started_knife({"length": 300.0, "late_mode": mode}, speed=1200.0).at(1.65) for mode in LateMode)
    assert (skip["last.length"], skip["last.kind"]) == (near(600.0), PieceKind.MERGED)
    assert late["statistics.late"] > 0
    assert late["last.length"] == near(late["limits.min_length"])
    assert (stop.state, stop["error_id"], stop["line.stop_request"]) == (State.FAULT, PieceFault.CUT_MISSED, True)
    assert stop["line.velocity_request"] == 0.0


def test_a_pitch_of_no_more_than_the_window_is_late_on_any_line() -> None:
    knife = started_knife({"length": 60.0}, speed=1.0).at(10.0)
    assert knife["limits.max_line_velocity"] == 0.0
    assert knife["warning.line_too_fast"]


def test_pieces_that_need_a_rest_count_as_no_length_where_the_knife_must_not_park() -> None:
    knife = started_knife({"length": 1300.0, "allow_parking": False}).at(0.5)
    assert (knife["warning.no_length"], knife["error_id"]) == (True, PieceFault.TUNABLE)
    assert knife["local.no_length"] == NoLength.TOO_LONG
    assert knife.set({"length": 1200.0}).at(0.6)["warning.no_length"] is False


# --- commands ---------------------------------------------------------------------------------------------------------


def test_stop_finishes_the_cut_under_way() -> None:
    """Given between the cuts at 600 and 1200: this one is made, and the ramp down ends 570 behind it."""
    knife = started_knife({"length": 600.0}).at(0.8).give("stop").at(1.77 - 1e-6)
    assert (knife["statistics.cuts"], knife.state, knife["running"]) == (2, State.DISENGAGING, True)
    knife.at(1.77 + 1e-6)
    assert (knife.state, knife["running"], knife["slave.position"]) == (State.OFF, False, near(180.0))


def test_abort_parks_at_once_and_does_not_turn_back() -> None:
    knife = started_knife({"length": 600.0}).at(0.8).give("abort")
    rows = knife.rows(1.0, cuts=[i / 1000.0 for i in range(1000)])
    assert all(row["slave.velocity"] >= -1e-9 for row in rows.values())
    assert all(abs(row["slave.jerk"]) <= 1e6 * (1.0 + 1e-9) for row in rows.values())
    assert (knife.state, knife["slave.position"], knife["statistics.cuts"]) == (State.OFF, near(180.0), 1)


def test_a_blade_that_passes_its_cut_on_the_way_to_park_is_counted() -> None:
    """Aborted 20 before a cut at 1000 u/s: the way to stop from 600 degrees/s is longer than these 12 degrees."""
    knife = started_knife({"length": 600.0}).at(1.18).give("abort").at(3.0)
    assert (knife["statistics.unsynchronised"], knife["statistics.cuts"]) == (1, 1)


def test_a_cut_that_is_lost_on_the_way_to_park_is_reported_once() -> None:
    """The knife is 10.2 degrees before the place, at 600 degrees/s, and takes more than that to stop. It goes on to the
    next park angle and is no slower at first: it passes the place in less than 10.2/600 = 0.017 s, the second step."""
    knife = started_knife({"length": 600.0}).at(1.183).give("abort")
    reasons = [knife.at(1.183 + 0.01 * n)["local.skip_reason"] for n in range(1, 100)]
    assert [reason for reason in reasons if reason] == [SkipReason.PARKING]
    assert reasons.index(SkipReason.PARKING) == 1
    clear = started_knife({"length": 600.0}).at(0.8).give("abort")
    assert not any(clear.at(0.8 + 0.01 * n)["local.skip_reason"] for n in range(1, 100))


def test_cut_now_at_rest_cuts_after_the_ramp() -> None:
    """Given at 100, with 570 for ramp and window: the piece is as long as the material that has passed."""
    knife = started_knife({"length": 5000.0}).at(0.1).give("cut_now").at(0.67 + 1e-6)
    assert (knife["last.kind"], knife["last.length"]) == (PieceKind.SHORT, near(670.0))


@pytest.mark.parametrize("speed", [90.7, 53.9, 311.3, 0.7])
@pytest.mark.parametrize("step", [0.007, 0.0123])
def test_cut_now_waits_for_a_line_that_runs_back(speed: float, step: float) -> None:
    """In 30 steps, whose positions are rounded forwards; the cut is 570 after where the line turns."""
    knife = started_knife({"length": 5000.0}).at(0.4)
    knife.speed = -speed
    knife.give("cut_now")
    for _ in range(30):
        knife.master_position = math.nextafter(knife.master_position, math.inf)
        assert (knife.run(step).state, knife["piece.kind"]) == (State.WAITING, PieceKind.PRODUCT)
    knife.speed = 1000.0
    knife.run(0.57 + 1e-6)
    assert (knife["last.kind"], knife["last.length"]) == (PieceKind.SHORT, near(970.0 - 30.0 * step * speed))


def test_cut_now_on_a_curve_gains_what_the_limits_allow_or_warns() -> None:
    """400 of 1200 have passed at 500 u/s: the cut is made long before it is due. Where the axis is at its limit, which
    rounding may exceed by 1e-9, nothing is gained."""
    knife = started_knife({"length": 1200.0}, speed=500.0).at(3.2).give("cut_now").at(4.0)
    assert (knife["statistics.cuts"], knife["last.kind"]) == (2, PieceKind.SHORT)
    assert 400.0 < knife["last.length"] < 700.0
    late = started_knife({"length": 600.0, "axis.max_velocity": SYNC * (1.0 - 5e-10)}).at(1.0).give("cut_now").at(1.1)
    assert late["warning.change_pending"]
    assert not late.at(1.201)["warning.change_pending"]
    assert late["last.length"] == near(600.0)


def test_hold_keeps_the_knife_at_rest_and_its_end_lets_it_go_on() -> None:
    knife = started_knife({"length": 600.0}).at(0.8).set({"hold": True}).at(2.5)
    assert (knife.state, knife["statistics.cuts"], knife["running"]) == (State.WAITING, 2, True)
    knife.set({"hold": False}).at(4.0)
    assert knife["statistics.cuts"] > 2


def test_a_new_length_is_for_the_next_piece_or_for_this_one() -> None:
    """600 becomes 900 while the second piece is made: it is cut at 1200, or at 1500."""
    for mode, cuts in ((ChangeMode.NEXT_PIECE, 2), (ChangeMode.THIS_PIECE, 1)):
        knife = started_knife({"length": 600.0, "change_mode": mode}).at(0.7).set({"length": 900.0}).at(1.4)
        assert (knife["statistics.cuts"], knife["warning.change_pending"]) == (cuts, False)
    assert knife.at(1.51)["last.length"] == near(900.0)


def test_a_change_that_cannot_be_made_any_more_waits() -> None:
    """600 becomes 300 when 250 of it have passed."""
    knife = started_knife({"length": 600.0, "change_mode": ChangeMode.THIS_PIECE}).at(0.85).set({"length": 300.0})
    assert knife.at(0.9)["warning.change_pending"]
    assert knife.at(1.21)["last.length"] == near(600.0)
    assert not knife["warning.change_pending"]


# --- the line ---------------------------------------------------------------------------------------------------------


def test_only_on_a_line_that_turns_back_the_knife_turns_back() -> None:
    """Over the second piece and back before the first: the knife is where the material has it, down to park."""
    knife = started_knife({"length": 600.0}).at(1.5)
    forwards = {}
    for i in range(100):
        master = 1500.0 - 15.0 * i
        forwards[master] = started_knife({"length": 600.0}).at(max(master, 1e-9) / 1000.0)["slave.position"]
    for i in range(1, 100):
        master = 1500.0 - 15.0 * i
        knife.speed = -1000.0
        knife.run(0.015)
        assert knife["slave.position"] == near(forwards[master], tolerance=1e-7) or (
            abs(knife["slave.position"] - forwards[master]) > 359.999999
        )
    assert knife["statistics.cuts"] == 2


def test_far_back_the_knife_rests_as_if_it_had_started_there() -> None:
    """The line runs back over ten pieces: the knife comes to rest, and cuts on where it left off."""
    knife = started_knife({"length": 600.0}).at(6.5)
    knife.speed = -1000.0
    rows = knife.rows(6.5, cuts=[i / 100.0 for i in range(650)])
    assert all(-SYNC * 2.5 <= row["slave.velocity"] <= 0.0 for row in rows.values())
    assert (knife["slave.velocity"], knife["slave.position"]) == near(0.0, 180.0)
    knife.speed = 1000.0
    knife.run(7.3, cuts=[i / 100.0 for i in range(730)])
    assert (knife["statistics.cuts"], knife["last.length"]) == (12, near(600.0))


# --- invalid values ---------------------------------------------------------------------------------------------------


def refused(**values: Any) -> tuple[Refusal, float, float]:
    """Of a knife with these start values, and which values it would allow; a name has `__` for a dot."""
    block = RotaryKnife()
    for name, value in values.items():
        group, _, leaf = name.partition("__")
        setattr(getattr(block, group) if leaf else block, leaf or group, value)
    return block.initialize(), block.local.allowed_from, block.local.allowed_to


ACCEPTED = (Refusal.NONE, 0.0, 0.0)


def test_windows_without_a_way_between_them_are_refused() -> None:
    """The park angle of 180 lies behind a window of 301, and before one that begins 301 before the next cut: either
    half may have 300. Edges of 600 mm in 360 degrees go 12 degrees in 20 mm; 14 blades are 42.9 mm apart, 15 are 40."""
    assert refused() == refused(sync__after=299.0) == refused(knife__blades=2) == refused(knife__blades=14) == ACCEPTED
    assert refused(sync__after=301.0) == (Refusal.SYNC_AFTER, 0.0, near(300.0, tolerance=1e-6))
    assert refused(sync__before=301.0) == (Refusal.SYNC_BEFORE, 0.0, near(300.0, tolerance=1e-6))
    assert refused(knife__blades=15) == (Refusal.BLADES, 1.0, 14.0)
    assert refused(knife__blades=2, knife__park_angle=180.0) == (
        Refusal.PARK_ANGLE,
        near(12.0, tolerance=1e-6),
        near(168.0, tolerance=1e-6),
    )
    assert refused(knife__blades=2, knife__park_angle=90.0) == ACCEPTED
    assert refused(sync__mode=SyncMode.HORIZONTAL, sync__before=91.0) == (Refusal.SYNC_BEFORE, 0.0, near(90.0))
    assert refused(mark__spacing=100.0, mark__window=50.0)[0] == Refusal.MARK_WINDOW


@drawn(anew=True)
@given(
    blades=st.integers(1, 64),
    park=st.sampled_from([0.0, 0.0, 0.1, 0.4, 0.9]),
    before=st.floats(0.0, 0.2),
    after=st.floats(0.0, 0.2),
    overspeed=st.sampled_from([-0.2, 0.0, 0.5]),
    mode=st.sampled_from(SyncMode),
    turn=st.sampled_from([1.0, 360.0, 6.283185307179586]),
)
def test_what_is_refused_is_accepted_in_the_range_that_is_named(
    blades: int, park: float, before: float, after: float, overspeed: float, mode: SyncMode, turn: float
) -> None:
    """Windows in circumferences, the park angle in turns; outside of the range it is still refused."""
    values: dict[str, Any] = {"knife__turn": turn, "knife__blades": blades, "knife__park_angle": park * turn}
    values |= {"sync__before": before * 600.0, "sync__after": after * 600.0}
    values |= {"sync__overspeed": overspeed, "sync__mode": mode}
    reason, low, high = refused(**values)
    name = {
        Refusal.BLADES: "knife__blades",
        Refusal.PARK_ANGLE: "knife__park_angle",
        Refusal.SYNC_BEFORE: "sync__before",
        Refusal.SYNC_AFTER: "sync__after",
    }.get(reason)
    if name is None:
        assert (reason, low, high) == ACCEPTED
        return
    assert not low <= values[name] <= high
    inside = high if name == "knife__blades" else low + 0.999 * (high - low)
    other = refused(**values | {name: int(inside) if name == "knife__blades" else inside})[0]
    assert other != reason
    assert other == Refusal.NONE or name in ("sync__before", "sync__after", "knife__blades")


@pytest.mark.parametrize("blades", [1, 2, 3, 7])
@pytest.mark.parametrize("turn", [360.0, 1.0, 25.0])
def test_without_a_park_angle_the_knife_rests_half_way_between_two_blades(blades: int, turn: float) -> None:
    """The same as with that angle, through a piece on which it parks."""
    values = {"knife.blades": blades, "knife.turn": turn, "length": 3000.0 / blades, "knife.park_angle": 0.0}
    values |= {f"sync.{half}": 10.0 for half in ("before", "after")}
    half = turn / blades / 2.0
    knives = [started_knife(values | {"knife.park_angle": angle}, speed=100.0) for angle in (0.0, half)]
    assert [knife["slave.position"] for knife in knives] == near(half, half)
    rows = [knife.rows(40.0, cuts=[i / 10.0 for i in range(400)]) for knife in knives]
    assert rows[0] == rows[1]
    assert knives[0]["statistics.cuts"] > 0


@pytest.mark.parametrize(
    ("name", "value", "parameter"),
    [("sync.before", 301.0, KnifeContradiction.BEFORE), ("sync.after", 301.0, KnifeContradiction.AFTER)],
)
def test_a_window_that_leaves_no_way_is_named_and_a_start_refused(
    name: str, value: Any, parameter: KnifeContradiction
) -> None:
    knife = RotaryKnifeHarness({"length": 600.0}, speed=1000.0).run(0.01).set({name: value}).give("start").run(0.01)
    assert (knife["local.refused_parameter"], knife["error_id"]) == (parameter, PieceFault.TUNABLE)
    assert knife.state == State.OFF


def test_a_piece_is_not_fixed_with_a_window_that_the_knife_cannot_have() -> None:
    knife = started_knife({"length": 600.0}).at(0.3).set({"sync.before": 301.0}).at(0.65)
    assert (knife["statistics.cuts"], knife["warning.no_length"], knife["error_id"]) == (1, True, PieceFault.TUNABLE)
    knife.set({"sync.before": 30.0}).at(0.66)
    assert not knife["warning.no_length"]


@pytest.mark.parametrize("factor", [1e7, 1e8, 1e10])
@pytest.mark.parametrize("front", [0.0, 1e12])
def test_a_cut_now_whose_ramp_is_hidden_by_rounding_is_refused(factor: float, front: float) -> None:
    """At 1e12 neighbouring numbers are 1.2e-4 apart; the ramp takes 540/factor of the master. With `front` there is no
    lack of material. The machine goes on: at 0 the same command cuts after 570/factor."""
    values = {"material_factor": factor, "length": 1e9, "front_position": front}
    knife = RotaryKnifeHarness(values, master_position=1e12, speed=0.0).give("start").run(0.01)
    knife.give("cut_now").run(0.01)
    assert (knife["error_id"], knife.state, knife["statistics.cuts"]) == (PieceFault.CUT_NOW, State.WAITING, 0)
    knife.give("stop").run(0.01).set({"front_position": 1e4})
    knife.master_position = 0.0
    knife.run(0.01).give("start").run(0.01).give("cut_now").run(0.01)
    assert (knife["error_id"], knife.state) == (PieceFault.NONE, State.ENGAGING)
    assert knife["next_cut.position"] == pytest.approx(570.0 / factor)
