"""Marks on the material, and a start that goes on from the last cut, with numbers by hand.

The knife has a circumference of 600, one blade and windows of 30 before and after the cut. Ramp and half a window take
540 + 30 = 570 of the material. Unless stated otherwise the line runs with 1000 u/s from 0 at 0 s, where `start` is
given. The sensor is 2000 upstream and the cut 25 behind the mark: a mark at p is cut at C = p + 2025."""

from typing import Any

import pytest

from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.rotary_knife.interface import State
from tests.model.rotary_knife.harness import RotaryKnifeHarness, started_knife

MARKS: dict[str, Any] = {"source": Source.MARK, "mark.sensor_distance": 2000.0, "mark.cut_offset": 25.0}
WINDOW: dict[str, Any] = {"mark.spacing": 600.0, "mark.window": 10.0}
SHORTLY = 1e-6  # s


def near(value: float) -> Any:
    return pytest.approx(value, rel=1e-9, abs=1e-9)


def detect(knife: RotaryKnifeHarness, *positions: float) -> RotaryKnifeHarness:
    """Detect a mark at each of these positions of the master, where it is then."""
    for position in positions:
        knife.at(1e-3 * position).set({"mark.position": position}).give("mark.detected").at(1e-3 * position + 1e-9)
    return knife


def with_marks(*positions: float, **values: Any) -> RotaryKnifeHarness:
    """A started knife that has detected these marks; of `values` a name has `__` for a dot."""
    given = {name.replace("__", "."): value for name, value in values.items()}
    return detect(started_knife(MARKS | given).at(1e-6), *positions)


def lengths_until(knife: RotaryKnifeHarness, time: float, step: float = 0.01) -> list[tuple[float, PieceKind]]:
    """Run until this time; the lengths and kinds of the pieces that are cut until then."""
    pieces, cuts = [], knife["statistics.cuts"]
    while knife.time < time - 1e-9:
        knife.at(min(knife.time + step, time))
        if knife["statistics.cuts"] > cuts:
            cuts = knife["statistics.cuts"]
            pieces.append((knife["last.length"], knife["last.kind"]))
    return pieces


def each(*lengths: float, kind: PieceKind = PieceKind.PRODUCT) -> list[tuple[Any, PieceKind]]:
    return [(near(length), kind) for length in lengths]


# --- where a mark is cut ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("offset", [25.0, 0.0, -40.0])
def test_a_mark_is_cut_so_far_behind_it(offset: float) -> None:
    """A mark at 100: C = 2100 + offset. The ramp up begins 570 before it; the blade cuts at 0, as fast as the line."""
    cut = 2100.0 + offset
    knife = with_marks(100.0, mark__cut_offset=offset)
    assert (knife["next_cut.known"], knife["next_cut.position"]) == (True, near(cut))
    assert knife.at(1e-3 * (cut - 570.0) - SHORTLY).state == State.WAITING
    assert knife.at(1e-3 * (cut - 570.0) + SHORTLY).state == State.ENGAGING
    knife.at(1e-3 * cut)
    assert (knife["slave.position"] + 180.0) % 360.0 == near(180.0)
    assert knife["slave.velocity"] == near(600.0)
    knife.at(1e-3 * cut + SHORTLY)
    assert (knife["last.length"], knife["last.kind"], knife["last.error"]) == (near(cut), PieceKind.PRODUCT, 0.0)
    assert not knife["next_cut.known"]


def test_without_a_latch_the_mark_is_where_the_master_was() -> None:
    """The edge at m = 500 comes 0.01 s late: p = 490."""
    knife = started_knife(MARKS | {"mark.latched": False, "mark.delay": 0.01}).at(0.5)
    knife.set({"mark.position": 7.0}).give("mark.detected").at(0.5 + 1e-9)
    assert knife["next_cut.position"] == near(490.0 + 2025.0)


def test_pieces_from_mark_to_mark() -> None:
    """600 is the synchronous length, on which the knife turns evenly; in the middle of the next 400 it is 2.102941
    times as fast."""
    knife = with_marks(100.0, 700.0, 1100.0)
    assert knife["local.marks_waiting"] == 3
    assert lengths_until(knife, 2.425) == each(2125.0)
    assert (knife.state, knife["slave.velocity"]) == (State.TURNING, near(600.0))
    assert lengths_until(knife, 2.925) == each(600.0)
    assert knife["slave.velocity"] == near((1.0 + 15.0 / 8.0 * 200.0 / 340.0) * 600.0)
    assert lengths_until(knife, 3.2) == each(400.0)
    assert knife["local.marks_waiting"] == 0


def test_the_distances_of_marks_limit_the_line() -> None:
    """300 between two marks: 1085.767047, as for pieces of this length."""
    knife = with_marks(100.0, 400.0)
    assert knife["limits.max_line_velocity_orders"] == pytest.approx(1085.767047, abs=5e-7)


# --- marks that are expected ------------------------------------------------------------------------------------------


def test_a_mark_takes_the_place_at_which_it_was_expected() -> None:
    """At 608 instead of 600: the cut is at 608 + 2025, and the next mark is expected at 1208."""
    knife = with_marks(0.0, 608.0, 1200.0, **WINDOW)
    assert (knife["statistics.marks"], knife["statistics.marks_missing"], knife["statistics.marks_outside"]) == (
        3,
        0,
        0,
    )
    assert lengths_until(knife, 3.3) == each(2025.0, 608.0, 592.0)


def test_an_edge_outside_the_window_is_no_mark() -> None:
    """580 is not within 10 of 600; the mark at 600 is."""
    knife = with_marks(0.0, 580.0, **WINDOW)
    assert (knife["statistics.marks"], knife["statistics.marks_outside"]) == (1, 1)
    assert (knife["warning.mark_outside"], knife["local.marks_waiting"]) == (True, 1)
    detect(knife, 600.0)
    assert (knife["statistics.marks"], knife["warning.mark_outside"]) == (2, False)
    assert lengths_until(knife, 2.7) == each(2025.0, 600.0)


@pytest.mark.parametrize("substitute", [True, False])
def test_a_mark_that_does_not_come_is_replaced_or_not(substitute: bool) -> None:
    """Expected at 600, missing beyond 610; the next one, expected at 1200, comes at 1205. Without a substitute the
    piece between the marks is 1205 long, on which the knife comes nearly to rest."""
    knife = with_marks(0.0, mark__substitute=substitute, **WINDOW).at(0.61 - SHORTLY).at(0.61)
    assert knife["statistics.marks_missing"] == 0
    knife.at(0.61 + SHORTLY).at(0.61 + 2 * SHORTLY)
    assert (knife["statistics.marks_missing"], knife["warning.mark_missing"]) == (1, True)
    assert knife["local.marks_waiting"] == (2 if substitute else 1)
    detect(knife, 1205.0)
    assert (knife["statistics.marks_missing"], knife["warning.mark_missing"]) == (1, False)
    assert lengths_until(knife, 3.3) == each(*([2025.0, 600.0, 605.0] if substitute else [2025.0, 1205.0]))


def test_too_many_marks_missing_in_a_row_stop_the_line() -> None:
    """Two in a row, expected at 600 and 1200, where one may miss: the second is missing beyond 1210."""
    knife = with_marks(0.0, mark__max_missing=1, **WINDOW).at(1.21 - SHORTLY).at(1.21)
    assert (knife["statistics.marks_missing"], knife["error"]) == (1, False)
    knife.at(1.21 + SHORTLY).at(1.21 + 2 * SHORTLY)
    assert (knife.state, knife["error_id"], knife["running"]) == (State.FAULT, PieceFault.MARKS_MISSING, False)
    assert knife["line.stop_request"]


# --- marks that come too late -----------------------------------------------------------------------------------------


def test_a_mark_that_leaves_no_way_for_the_ramp_is_skipped() -> None:
    """The sensor is 570 before the cut, which is just what the ramp needs; with less the cut is skipped."""
    for distance, skipped in ((570.0 + 1e-6, 0), (570.0 - 1e-3, 1)):
        knife = with_marks(1000.0, mark__sensor_distance=distance, mark__cut_offset=0.0).at(1.0 + 1e-6).at(2.0)
        assert (knife["statistics.skipped"], knife["statistics.cuts"]) == (skipped, 1 - skipped)


def test_the_least_distance_of_the_sensor() -> None:
    """570, and what passes in 0.01 s."""
    knife = started_knife(MARKS | {"mark.delay": 0.01}).at(0.1)
    assert knife["limits.min_sensor_distance"] == near(580.0)


def test_of_marks_that_are_too_near_one_is_cut() -> None:
    """Marks at 100, 300 and 900: pieces of 200 cannot be cut at 1000 u/s (the shortest is 284.730278). That cut is left
    out, and the piece ends with the next mark."""
    knife = with_marks(100.0, 300.0, 900.0)
    assert lengths_until(knife, 3.0) == [*each(2125.0), *each(800.0, kind=PieceKind.MERGED)]
    assert knife["statistics.skipped"] == 1


def test_a_late_mark_may_be_cut_late() -> None:
    """The piece of 200 is as long as the shortest one; the mark at 900 is cut where it is, 2925 - 2409.730278 later."""
    knife = with_marks(100.0, 300.0, 900.0, late_mode=LateMode.LATE)
    pieces = lengths_until(knife, 3.0)
    assert [length for length, _ in pieces] == pytest.approx([2125.0, 284.730278, 515.269722], abs=5e-7)
    assert (knife["statistics.late"], knife["statistics.skipped"]) == (1, 0)


# --- a start that goes on from the last cut ---------------------------------------------------------------------------


def test_a_start_that_continues_measures_from_the_last_cut() -> None:
    """Cuts at 900 and 1800; stop at 1900: the cut at 2700 is still made, from which the ramp down ends 30 + 540 later,
    at 3270. Started at 3400, the cut at 3600 cannot be made any more, whose ramp would begin at 3030. The piece ends at
    4500, after 1800."""
    knife = started_knife({"length": 900.0}).at(1.9).give("stop").at(3.27 - SHORTLY)
    assert (knife.state, knife["statistics.cuts"]) == (State.DISENGAGING, 3)
    assert knife.at(3.27 + SHORTLY).state == State.OFF
    knife.at(3.4).set({"start_mode": StartMode.CONTINUE}).give("start").at(3.4 + SHORTLY)
    assert knife["piece.length"] == near(700.0 + 1e-3)
    assert (knife["statistics.skipped"], knife["next_cut.position"]) == (1, near(4500.0))
    assert lengths_until(knife, 4.51) == each(1800.0, kind=PieceKind.MERGED)


def test_a_start_that_continues_in_time_loses_no_piece() -> None:
    """With pieces of 1500, cut at 1500: stop at 1600 ends at 2070. The ramp to 3000 begins at 2430; start at 2400."""
    knife = started_knife({"length": 1500.0}).at(1.6).give("stop").at(2.4)
    assert knife.state == State.OFF
    knife.set({"start_mode": StartMode.CONTINUE}).give("start").at(2.43 - SHORTLY)
    assert (knife.state, knife["next_cut.position"]) == (State.WAITING, near(3000.0))
    assert lengths_until(knife, 3.01) == each(1500.0)
    assert knife["statistics.skipped"] == 0


def test_a_start_that_continues_needs_a_cut_to_go_on_from() -> None:
    knife = started_knife({"start_mode": StartMode.CONTINUE}).at(0.1)
    assert (knife.state, knife["error_id"], knife["running"]) == (State.OFF, PieceFault.START, False)


@pytest.mark.parametrize(("mode", "waiting"), [(StartMode.FRONT, 0), (StartMode.CONTINUE, 1)])
def test_only_a_start_that_continues_keeps_the_marks(mode: StartMode, waiting: int) -> None:
    """Marks at 100 and 1700 are cut at 2125 and 3725. Stop after the first cut: the knife rests at 2125 + 570, and the
    ramp to the second one begins at 3155."""
    knife = with_marks(100.0, 1700.0).at(2.2).give("stop").at(2.8)
    assert (knife.state, knife["local.marks_waiting"]) == (State.OFF, 1)
    knife.set({"start_mode": mode}).give("start").at(2.8 + SHORTLY)
    assert knife["local.marks_waiting"] == waiting
    assert lengths_until(knife, 3.8) == each(*[1600.0] * waiting)
