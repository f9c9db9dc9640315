"""Marks on the material: which edges are marks, where they are cut, missing marks, and too many marks.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`). The sensor
is 2000 upstream and the cut 25 behind the mark: C = p + 2025, start at m = p + 1925, the cut ends at p + 2375."""

from typing import Any

import pytest

from motionsync.cut_to_length.interface import State
from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import (
    JUST,
    LEAD,
    REFERENCE,
    CutToLengthHarness,
    each,
    idle_machine,
    near,
    started_machine,
)
from tests.model.cut_to_length.machine_results import GREATEST_VELOCITIES

MARKS: dict[str, Any] = {"source": Source.MARK, "mark.sensor_distance": 2000.0, "mark.cut_offset": 25.0}
WINDOW: dict[str, Any] = {"mark.spacing": 1500.0, "mark.window": 10.0}


def detect_mark(saw: CutToLengthHarness, time: float, position: float | None = None) -> CutToLengthHarness:
    """Detect a mark at this time, at this position of the master or where that is; no time passes."""
    saw.at(time)
    return saw.set({"mark.position": saw.master_position if position is None else position}).give("mark.detected").now()


def started_with_marks(values: dict[str, Any] | None = None, **options: Any) -> CutToLengthHarness:
    return started_machine({**MARKS, **(values or {})}, **options).now()


def mark_counts(saw: CutToLengthHarness) -> tuple[int, ...]:
    """Marks, missing ones, and edges outside."""
    return saw.statistics("marks", "marks_missing", "marks_outside")


def test_a_mark_is_cut_where_it_was_latched() -> None:
    """A result that was computed beforehand: mark at 10000, C = 12025, start 12025 - lead(1000)."""
    saw = CutToLengthHarness({**REFERENCE, **MARKS}, speed=1000.0, master_position=9900.0).give("start").now()
    detect_mark(saw, 0.15, 10000.0)
    assert (saw["next_cut.known"], saw["next_cut.position"]) == (True, near(12025.0))
    assert (saw["local.marks_waiting"], mark_counts(saw)) == (1, (1, 0, 0))
    saw.at(2.6)
    assert saw["local.start_time"] == near((12025.0 - LEAD) / 1000.0 - 9.9)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.PRODUCT, near(12025.0 - 9900.0))
    assert (saw["last.error"], saw["last.good"]) == (0.0, True)
    assert saw["local.marks_waiting"] == 0


@pytest.mark.parametrize("mode", [MasterInput.START_OF_STEP, MasterInput.END_OF_STEP])
def test_without_a_latch_the_mark_is_where_the_master_was(mode: MasterInput) -> None:
    """The edge at m = 500 comes 0.01 s late: p = 490."""
    saw = started_with_marks({"mark.latched": False, "mark.delay": 0.01}, mode=mode)
    detect_mark(saw, 0.5, 7.0)
    assert saw["next_cut.position"] == near(490.0 + 2025.0)


def test_a_latched_position_is_taken_in_the_turn_nearest_to_the_master() -> None:
    """P = 700, m = 750: the latched 690 is at 690, not at 690 + 700."""
    saw = started_with_marks({"master.period": 700.0}, master_position=0.0).at(0.4)
    detect_mark(saw, 0.75, 690.0)
    assert saw["next_cut.position"] == near(2715.0 % 700.0)
    saw.at(1.5).at(2.0).at(2.5).at(3.0).at(3.2)
    assert saw["local.start_time"] == near(2.615)


def test_pieces_from_mark_to_mark() -> None:
    """Without a spacing, ordered is 0 and each piece is accepted."""
    saw = started_with_marks()
    for position in (100.0, 1500.0, 2800.0):
        detect_mark(saw, 1e-3 * position)
    assert saw["local.marks_waiting"] == 2
    saw.watched(5.3)
    assert saw.lengths() == each(2125.0, 1400.0, 1300.0)
    assert saw.kinds() == [PieceKind.PRODUCT] * 3
    assert [(piece.error, piece.is_accepted) for piece in saw.pieces] == [(0.0, True)] * 3
    assert not saw["next_cut.known"]


def test_the_spacing_is_what_is_ordered() -> None:
    """spacing every - kerf = 3000 - 4; each second mark from the first on is cut. The second piece is 3001 - 4 long."""
    values = {"mark.spacing": 1500.0, "mark.every": 2, "kerf": 4.0, "length_tolerance": 2.0}
    saw = started_with_marks(values)
    for position in (0.0, 1501.0, 3001.0):
        detect_mark(saw, 1e-3 * position + 0.01, position)
    assert mark_counts(saw)[0] == 3
    saw.watched(5.6)
    assert saw.lengths()[1] == near(2997.0)
    assert (saw.pieces[1].error, saw.pieces[1].is_accepted) == near(1.0, True)


def test_orders_lengths_and_corrections_are_not_used_with_marks() -> None:
    saw = started_with_marks({"length_correction": 7.0}).order(1200.0).set({"waste": True}).give("take_sample")
    detect_mark(saw, 0.1)
    detect_mark(saw, 1.6)
    saw.set({"length": 0.0}).watched(4.1)
    assert saw.lengths() == each(2125.0, 1500.0)
    assert saw.kinds() == [PieceKind.PRODUCT, PieceKind.PRODUCT]
    assert not saw["warning.no_length"]


def test_marks_count_only_while_the_machine_runs() -> None:
    saw = detect_mark(idle_machine(MARKS), 0.1)
    assert (mark_counts(saw), saw["local.marks_waiting"]) == ((0, 0, 0), 0)


# --- the window -------------------------------------------------------------------------------------------------------


def test_a_mark_within_the_window_is_accepted() -> None:
    saw = detect_mark(detect_mark(started_with_marks(WINDOW), 0.0), 1.509)
    assert (mark_counts(saw), saw["local.marks_waiting"]) == ((2, 0, 0), 2)
    detect_mark(saw, 1.509 + 1.491)
    assert mark_counts(saw) == (3, 0, 0)


def test_an_edge_before_the_window_is_no_mark() -> None:
    saw = detect_mark(detect_mark(started_with_marks(WINDOW), 0.0), 1.489)
    assert (mark_counts(saw), saw["local.marks_waiting"]) == ((1, 0, 1), 1)
    assert (saw["warning.mark_outside"], saw["warning.any"]) == (True, True)
    detect_mark(saw, 1.5)
    assert (mark_counts(saw), saw["warning.mark_outside"]) == ((2, 0, 1), False)


@pytest.mark.parametrize("substitute", [True, False])
def test_a_mark_that_does_not_come_is_replaced_or_not(substitute: bool) -> None:
    """Expected at 1500; missing when m > 1510. Then the next one is expected at 3000."""
    saw = detect_mark(started_with_marks({**WINDOW, "mark.substitute": substitute}), 0.0).at(1.51 - JUST).now()
    assert mark_counts(saw) == (1, 0, 0)
    saw.at(1.51 + JUST).now()
    assert mark_counts(saw) == (1, 1, 0)
    assert saw["warning.mark_missing"]
    assert saw["local.marks_waiting"] == (2 if substitute else 1)
    detect_mark(saw, 3.005)
    assert (mark_counts(saw), saw["warning.mark_missing"]) == ((2, 1, 0), False)
    saw.watched(5.6)
    assert saw.lengths() == each(*([2025.0, 1500.0, 1505.0] if substitute else [2025.0, 3005.0]))


def test_a_mark_may_be_detected_after_missing_ones() -> None:
    """The edge at 3002 comes in the step in which 1500 is counted as missing."""
    saw = detect_mark(detect_mark(started_with_marks(WINDOW), 0.0), 3.002)
    assert (mark_counts(saw), saw["local.marks_waiting"]) == ((2, 1, 0), 2)
    assert not saw["warning.mark_missing"]


def test_an_edge_that_comes_late_is_waited_for() -> None:
    """mark.delay 0.1: the mark at 1500 is missing when m - 100 > 1510."""
    saw = detect_mark(started_with_marks({**WINDOW, "mark.delay": 0.1}), 0.0).at(1.6).now()
    assert mark_counts(saw) == (1, 0, 0)
    detect_mark(saw, 1.605, 1502.0)
    assert mark_counts(saw) == (2, 0, 0)
    saw.at(3.111).now()
    assert mark_counts(saw) == (2, 0, 0)
    saw.at(3.113).now()
    assert mark_counts(saw) == (2, 1, 0)


def test_too_many_marks_missing_in_a_row() -> None:
    """max_missing 1: one, then a mark, then one is allowed; the second in a row is not."""
    saw = detect_mark(started_with_marks({**WINDOW, "mark.max_missing": 1}), 0.0)
    detect_mark(saw.at(1.6).now(), 3.0).at(4.6).now()
    assert (mark_counts(saw), saw["error"]) == ((2, 2, 0), False)
    saw.at(6.011).now()
    assert (saw.state, saw["error_id"], saw["running"]) == (State.FAULT, PieceFault.MARKS_MISSING, False)
    assert saw["line.stop_request"]


# --- too much, too late -----------------------------------------------------------------------------------------------


def test_the_65th_mark_is_a_fault_and_64_wait() -> None:
    saw = started_with_marks({"mark.sensor_distance": 1e6})
    for i in range(64):
        detect_mark(saw, 0.01 * (i + 1))
    assert (saw["local.marks_waiting"], saw["error"]) == (64, False)
    detect_mark(saw, 0.7)
    assert (saw.state, saw["error_id"], saw["local.marks_waiting"]) == (State.FAULT, PieceFault.MARKS_FULL, 64)


def test_late_marks_are_dropped_until_one_can_be_reached() -> None:
    """Marks at 0, 800 and 1600: C = 2025, 2825, 3625. The carriage is back at m = 1925 + 1033.333, past 2825."""
    saw = started_with_marks()
    for time in (0.0, 0.8, 1.6):
        detect_mark(saw, time)
    saw.watched(4.2)
    assert saw.kinds() == [PieceKind.PRODUCT, PieceKind.MERGED]
    assert saw.lengths() == each(2025.0, 1600.0)
    assert saw["statistics.skipped"] == 1


def test_a_late_mark_may_be_cut_late() -> None:
    """C = 2958.333 + lead instead of 2825; the next mark is cut in its place, 5025."""
    saw = started_with_marks({"late_mode": LateMode.LATE})
    for time in (0.0, 0.8, 3.0):
        detect_mark(saw, time)
    saw.watched(5.5)
    late = 1925.0 + 1033.3333333333333 + LEAD
    assert saw.lengths() == each(2025.0, late - 2025.0, 5025.0 - late)
    assert (saw["statistics.late"], saw["statistics.skipped"]) == (1, 0)


@pytest.mark.parametrize(("position", "is_refused"), [(-3000.0, True), (-2025.0, True), (-2024.99, False)])
def test_a_mark_whose_cut_is_not_beyond_the_front_end_is_refused(position: float, is_refused: bool) -> None:
    """The front end is at 0: of the last one the cut is at 0.01, which is late."""
    saw = detect_mark(started_with_marks(), 0.1, position).now()
    assert saw.statistics("marks", "marks_refused", "skipped") == ((0, 1, 0) if is_refused else (1, 0, 1))
    assert saw["warning.mark_refused"] == is_refused
    assert (saw.state, saw["local.marks_waiting"]) == (State.WAITING, 0)


def test_a_short_cut_leaves_the_marks() -> None:
    """cut_now at m = 700; the mark's cut at 2125 follows."""
    saw = detect_mark(started_with_marks(), 0.1).at(0.7).give("cut_now").watched(2.6)
    assert saw.kinds() == [PieceKind.SHORT, PieceKind.PRODUCT]
    assert saw.lengths() == each(700.0 + LEAD, 2125.0 - 700.0 - LEAD)


def test_start_clears_the_marks_unless_it_continues() -> None:
    for mode, remaining in [(StartMode.FRONT, 0), (StartMode.CONTINUE, 1)]:
        saw = detect_mark(detect_mark(started_with_marks(), 0.1), 1.7).watched(2.6)
        assert (len(saw.pieces), saw["local.marks_waiting"]) == (1, 1)
        saw.give("stop").at(3.4).set({"start_mode": mode}).give("start").now()
        assert saw["local.marks_waiting"] == remaining


def test_the_least_distance_of_the_sensor() -> None:
    """f ((D - h) / k + v delay) = (100 - 20) + 1000 0.01."""
    values = {"mark.delay": 0.01, "home_position": 20.0, "axis.initial_position": 20.0}
    saw = started_with_marks(values).at(0.1)
    assert saw["limits.min_sensor_distance"] == near(90.0)


def test_the_distances_of_marks_limit_the_line() -> None:
    """Of the piece in progress and of the first two that wait; without marks the spacing counts."""
    saw = CutToLengthHarness({**REFERENCE, **MARKS, "mark.spacing": 1000.0, "mark.every": 2}, speed=500.0)
    assert saw.give("start").now()["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[2000.0])  # 2000
    saw.set({"mark.every": 1}).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1000.0])
    detect_mark(detect_mark(saw, 0.1), 0.1 + 1.504 * 2.0)
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1504.0])
