"""The pieces: where their cuts are, what they are measured from, which length counts, late cuts, orders, records.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

from math import sqrt
from typing import Any

import pytest

from motionsync.cut_to_length.faults import SkipReason
from motionsync.cut_to_length.interface import State
from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import ChangeMode, LateMode, PieceKind, StartMode
from tests.model.cut_to_length.harness import (
    HOME_AGAIN,
    JUST,
    LEAD,
    REFERENCE,
    CutToLengthHarness,
    each,
    idle_machine,
    near,
    started_machine,
)
from tests.model.cut_to_length.machine_results import BASIC_CUT, GREATEST_VELOCITIES, result_of

PRODUCT, SAMPLE, WASTE = PieceKind.PRODUCT, PieceKind.SAMPLE, PieceKind.WASTE
TRIM, SHORT, MERGED = PieceKind.TRIM, PieceKind.SHORT, PieceKind.MERGED
LATE: dict[str, Any] = {"late_mode": LateMode.LATE}
CROP: dict[str, Any] = {"start_mode": StartMode.TRIM}
CONTINUE: dict[str, Any] = {"start_mode": StartMode.CONTINUE}
WHOLE_CYCLE = result_of("reference", "shortest_pitch", 1310.0)  # what passes at 1310 u/s in a cycle
THIS: dict[str, Any] = {"change_mode": ChangeMode.THIS_PIECE}


def piece_counts(saw: CutToLengthHarness) -> tuple[int, ...]:
    """Good, bad, sample and waste pieces."""
    return saw.statistics("pieces_good", "pieces_bad", "pieces_sample", "pieces_waste")


# --- geometry ---------------------------------------------------------------------------------------------------------


def test_the_basic_cut() -> None:
    saw = CutToLengthHarness({**REFERENCE, "length": 1500.0, "kerf": 4.0}, speed=1000.0).at(0.2).give("start").at(3.0)
    instants = {"start": "local.start_time", "sync": "last.time", "cut": "tool.command_time", "home": "local.home_time"}
    assert {name: saw[shown] for name, shown in instants.items()} == {name: near(t) for name, t in BASIC_CUT.items()}
    assert saw["local.start_position"] == near(1000.0 * BASIC_CUT["start"] + 1504.0)
    assert (saw["last.length"], saw["last.error"], saw["last.good"]) == near(1500.0, 0.0, True)


def test_the_kerf_and_the_wheel_make_the_pitch() -> None:
    """(1500 + 4) / 1.02 = 1474.509804 of the master; k = 1.02."""
    saw = started_machine({"kerf": 4.0, "material_factor": 1.02}, speed=900.0).watched(8.0)
    first = -2.0 / 1.02 + 1504.0 / 1.02
    assert saw["next_cut.position"] == near(first + len(saw.pieces) * 1474.5098039215686)
    assert saw.lengths() == each(*[1500.0] * 4)
    assert [piece.time for piece in saw.pieces] == near(
        *[(first + i * 1474.5098039215686 + 100.0 / 1.02) / 900.0 for i in range(4)]
    )


def test_the_front_end_counts_as_a_cut() -> None:
    """At 30 when start is given at m = 200: B = 200 - 30, C = 1670."""
    saw = idle_machine({"front_position": 30.0}).at(0.2).give("start").now()
    assert saw["next_cut.position"] == near(1670.0)


def test_the_correction_is_added_to_the_measured_length() -> None:
    """L + delta + b = 1503: what is cut 1503 apart counts as 1500 long."""
    saw = started_machine({"length_correction": 3.0}).watched(3.5)
    assert saw.lengths() == each(1500.0, 1500.0)
    assert saw["next_cut.position"] == near(3.0 * 1503.0)


def test_what_belongs_to_a_piece_is_read_when_it_is_fixed() -> None:
    """Kerf 4 and wheel 1.1 from t = 0.5 on: the first piece keeps B = 0, C = 1500, length 1500; the second is 1504 /
    1.1 of the master long."""
    saw = started_machine().at(0.5).set({"kerf": 4.0, "material_factor": 1.1, "length_correction": 0.0}).at(1.9)
    assert saw["last.length"] == near(1500.0)
    assert saw["next_cut.position"] == near(1500.0 + 1504.0 / 1.1)
    saw.at(3.4)
    assert (saw["statistics.cuts"], saw["last.length"]) == near(2, 1500.0)


def test_a_cycle_keeps_the_values_it_began_with() -> None:
    """The wheel's factor 1.1 comes during the approach: the carriage is still in sync with k = 1."""
    saw = started_machine().at(1.5).set({"material_factor": 1.1, "tool.cut_time": 0.1}).at(1.7)
    assert saw.slave == near(200.0, 1000.0, 0.0)
    saw.at(1.85 + JUST)
    assert saw["tool.command_time"] == near(1.85)


# --- which length -----------------------------------------------------------------------------------------------------


def test_a_new_length_applies_to_the_next_piece() -> None:
    saw = started_machine().at(1.0).set({"length": 1200.0})
    saw.watched(3.5)
    assert saw.lengths() == each(1500.0, 1200.0)
    assert not saw["warning.change_pending"]


def test_a_new_length_applies_to_this_piece_if_its_start_is_still_ahead() -> None:
    """At m = 1000: 1300 - 1000 >= lead. 1050 - 1000 is not."""
    saw = started_machine(THIS).at(1.0).set({"length": 1300.0}).now()
    assert (saw["next_cut.position"], saw["piece.ordered"], saw["warning.change_pending"]) == (
        near(1300.0),
        1300.0,
        False,
    )
    saw.set({"length": 1050.0}).at(1.5)
    assert (saw["next_cut.position"], saw["warning.change_pending"]) == (near(1300.0), True)
    saw.at(1.66)  # cut from 1.4 to 1.65
    assert (saw["last.length"], saw["warning.change_pending"]) == near(1300.0, False)
    assert saw["next_cut.position"] == near(2350.0)


def test_a_change_on_the_way_to_the_cut_waits_for_the_next_piece() -> None:
    saw = started_machine(THIS).at(1.5).set({"length": 1400.0}).at(1.8)
    assert (saw["warning.change_pending"], saw["next_cut.position"]) == (True, near(1500.0))
    saw.at(1.9)
    assert (saw["last.length"], saw["next_cut.position"]) == near(1500.0, 2900.0)


def test_an_order_may_change_the_present_piece() -> None:
    saw = started_machine(THIS).at(0.5).order(1200.0).now()
    assert saw["next_cut.position"] == near(1200.0)


def test_samples_and_waste_do_not_change_the_present_piece() -> None:
    saw = started_machine({**THIS, "sample_length": 1100.0}).at(0.5).set({"waste": True}).give("take_sample").now()
    assert (saw["next_cut.position"], saw["piece.kind"]) == (near(1500.0), PRODUCT)


def test_waste_goes_before_a_sample_that_before_an_order_and_that_before_the_length() -> None:
    """All are given during the first piece; the waste ends during the second."""
    values = {"waste_length": 1100.0, "sample_length": 1200.0}
    saw = started_machine(values).at(0.5).set({"waste": True}).give("take_sample").order(1300.0).watched(2.0)
    saw.set({"waste": False}).watched(9.0)
    assert saw.kinds() == [PRODUCT, WASTE, SAMPLE, PRODUCT, PRODUCT, PRODUCT]
    assert saw.lengths() == each(1500.0, 1100.0, 1200.0, 1300.0, 1500.0, 1500.0)
    assert [piece.is_accepted for piece in saw.pieces] == [True, False, False, True, True, True]
    assert piece_counts(saw) == (4, 0, 1, 1)
    assert saw["statistics.length_good"] == near(5800.0)
    assert saw["statistics.length_waste"] == near(1100.0)
    assert saw["order.completed"] == 1


@pytest.mark.parametrize("no_length", [{"length": 0.0}, {"length": -5.0}, {"length": 2.0, "length_correction": -2.0}])
def test_without_a_length_the_machine_waits_for_one(no_length: dict[str, float]) -> None:
    """It comes at m = 500; the piece is measured from B = 0 all the same."""
    saw = started_machine(no_length).at(0.5)
    assert (saw.state, saw["warning.no_length"], saw["next_cut.known"]) == (State.WAITING, True, False)
    assert (saw["piece.kind"], saw["next_cut.distance"]) == (PieceKind.NONE, 0.0)
    saw.set({"length": 1500.0, "length_correction": 0.0}).now()
    assert (saw["warning.no_length"], saw["next_cut.position"]) == (False, near(1500.0))


# --- what the first piece is measured from ----------------------------------------------------------------------------


def test_trimming() -> None:
    """C = 600, then 2100."""
    saw = started_machine({**CROP, "trim_length": 600.0}).watched(2.0)
    assert saw.kinds() == [TRIM]
    assert saw.lengths() == each(600.0)
    assert saw["next_cut.position"] == near(2100.0)
    assert piece_counts(saw) == (0, 0, 0, 1)
    assert saw["statistics.length_waste"] == near(600.0)


def test_trimming_as_little_as_possible() -> None:
    """trim_length 0: C = 0 + lead, start at once; that is not counted as late."""
    saw = started_machine(CROP).watched(1.0)
    assert saw.kinds() == [TRIM]
    assert saw.lengths() == each(LEAD)
    assert saw.pieces[0].time == near(2e-3 * LEAD)
    assert (saw["statistics.late"], saw["statistics.skipped"]) == (0, 0)
    assert saw["next_cut.position"] == near(LEAD + 1500.0)


def test_continuing_from_the_last_cut() -> None:
    """Stopped after the first cut at 1500 and started again at m = 2600: C = 3000."""
    saw = started_machine().at(2.0).give("stop").at(2.6)
    assert saw.state == State.OFF
    saw.set(CONTINUE).give("start").now()
    assert saw["next_cut.position"] == near(3000.0)
    saw.at(3.5)
    assert saw["last.length"] == near(1500.0)


def test_the_carriage_comes_home_before_it_waits() -> None:
    """From 300: 1500 R(1500) = 300, so it takes 2 R(1500) = 0.4 s. B is that of the edge."""
    saw = started_machine({"axis.initial_position": 300.0}).at(0.4 - JUST)
    assert (saw.state, saw["running"]) == (State.HOMING, True)
    saw.at(0.4 + JUST)
    assert (saw.state, saw["local.home_time"]) == (State.WAITING, near(0.4))
    assert saw["next_cut.position"] == near(1500.0)


# --- late cuts --------------------------------------------------------------------------------------------------------
# L = 1000: the first cut at C = 1000 leaves at 900; home at m = 1933.333, past 2000 - lead.

SOON: dict[str, Any] = {"length": 1000.0}
HOME_TIME = HOME_AGAIN - 0.5  # s, when the first cycle is over


def test_a_cut_that_cannot_be_reached_is_skipped() -> None:
    saw = started_machine(SOON).watched(3.5)
    assert saw.kinds() == [PRODUCT, MERGED]
    assert saw.lengths() == each(1000.0, 2000.0)
    assert saw.pieces[1].error == near(1000.0)
    assert saw.pieces[1].reserve == near((2.9 - HOME_TIME) / 2.0)
    assert (saw["statistics.skipped"], saw["statistics.late"]) == (1, 0)
    assert piece_counts(saw) == (1, 1, 0, 0)
    assert saw["statistics.length_waste"] == near(2000.0)


def test_why_a_cut_is_skipped_is_shown_in_the_step_in_which_it_is() -> None:
    """C = 2000, home at m = 1933.333: 66.667 are left of the way, which takes LEAD."""
    saw = started_machine(SOON).at(HOME_TIME - 1e-3)
    assert saw["local.skip_reason"] == SkipReason.NONE
    saw.at(HOME_TIME + 1e-3)
    assert saw["local.skip_reason"] == SkipReason.LATE
    assert saw["local.skipped_cut"] == near(2000.0)
    assert saw["local.missing_distance"] == near(LEAD - (2000.0 - 1000.0 * HOME_TIME))
    assert saw["local.line_velocity"] == near(1000.0)
    saw.at(HOME_TIME + 2e-3)
    assert saw["local.skip_reason"] == SkipReason.NONE
    assert saw["local.skipped_cut"] == near(2000.0)


def test_as_many_cuts_are_skipped_as_cannot_be_reached() -> None:
    """L = 300: home at m = 200 + 1033.333; 600 + 300 n - 1233.333 >= lead from n = 3 on: C = 1500. Then home at
    2433.333; 1800 + 300 n - 2433.333 >= lead from n = 3 on."""
    saw = started_machine({"length": 300.0}).watched(3.2)
    assert saw.lengths() == each(300.0, 1200.0, 1200.0)
    assert saw["statistics.skipped"] == 6
    assert saw["warning.line_too_fast"]


@pytest.mark.parametrize("kind", [SAMPLE, WASTE])
def test_a_sample_or_waste_that_is_skipped_is_a_merged_piece(kind: PieceKind) -> None:
    saw = started_machine({"sample_length": 1000.0, "waste_length": 1000.0}).at(1.0)
    saw.give("take_sample").set({"waste": kind == WASTE}).at(2.0).set({"waste": False}).watched(4.0)
    assert saw.kinds() == [PRODUCT, MERGED]
    assert saw.lengths() == each(1500.0, 2000.0)
    assert piece_counts(saw) == (1, 1, 0, 0)


def test_a_late_cut_makes_its_piece_longer() -> None:
    """C = m + lead at m = 1933.333; the next is measured from it."""
    saw = started_machine({**SOON, **LATE}).at(HOME_TIME + 1e-3)
    assert saw["next_cut.position"] == near(1000.0 * HOME_TIME + LEAD)
    assert saw.state == State.APPROACHING
    saw.watched(2.5)
    assert saw.kinds() == [PRODUCT, PRODUCT]
    assert saw.pieces[1].length == near(1000.0 * HOME_TIME + LEAD - 1000.0)
    assert saw.pieces[1].error == near(1000.0 * HOME_TIME + LEAD - 2000.0)
    assert (saw.pieces[1].is_accepted, saw.pieces[1].reserve) == (False, 0.0)
    assert (saw["statistics.skipped"], saw["statistics.late"]) == (0, 1)
    assert saw["next_cut.position"] == near(1000.0 * HOME_TIME + LEAD + 1000.0)


def test_a_late_cut_that_must_not_happen_stops_the_line() -> None:
    saw = started_machine({**SOON, "late_mode": LateMode.STOP_LINE}).at(HOME_TIME - JUST)
    assert not saw["error"]
    saw.at(HOME_TIME + JUST)
    assert (saw.state, saw["error_id"], saw["line.stop_request"]) == (State.FAULT, PieceFault.CUT_MISSED, True)
    assert (saw["running"], saw["line.velocity_request"]) == (False, 0.0)
    assert saw.slave == (0.0, 0.0, 0.0)
    saw.at(2.5)
    assert saw.slave == (0.0, 0.0, 0.0)


def test_a_length_that_comes_late_may_be_cut_late() -> None:
    """At m = 1200 a length of 1100 is past already: C = 1200 + lead."""
    saw = started_machine({"length": 0.0, **LATE}).at(1.2).set({"length": 1100.0}).now()
    assert (saw.state, saw["next_cut.position"]) == (State.APPROACHING, near(1200.0 + LEAD))


@pytest.mark.parametrize(
    ("mode", "lengths"),
    [(LateMode.LATE, [1500.0, WHOLE_CYCLE, WHOLE_CYCLE]), (LateMode.SKIP, [1500.0, 3000.0, 3000.0])],
)
def test_a_line_that_is_too_fast_for_ever(mode: LateMode, lengths: list[float]) -> None:
    """The reference machine at 1310, L = 1500: v T_c."""
    saw = CutToLengthHarness({**REFERENCE, "length": 1500.0, "late_mode": mode}, speed=1310.0)
    saw.give("start").watched((sum(lengths) + 500.0) / 1310.0)
    assert saw.lengths() == each(*lengths)
    assert saw["warning.line_too_fast"]


# --- tolerance and statistics -----------------------------------------------------------------------------------------


def test_a_piece_within_the_tolerance_is_accepted() -> None:
    saw = started_machine({**SOON, **LATE, "length_tolerance": 20.0}).watched(2.5)
    assert [piece.is_accepted for piece in saw.pieces] == [True, True]
    assert saw["statistics.length_good"] == near(1000.0 * HOME_TIME + LEAD)


def test_the_statistics_of_the_errors() -> None:
    """0, e, e: mean 2 e / 3, squares (4 + 1 + 1) e^2 / 9, deviation sqrt(e^2 2 / 3 / 2)."""
    saw = CutToLengthHarness({**REFERENCE, "length": 1500.0, **LATE}, speed=1310.0).give("start").watched(3.9)
    error = WHOLE_CYCLE - 1500.0
    assert len(saw.pieces) == 3
    assert saw["statistics.error_mean"] == near(2.0 * error / 3.0, tolerance=1e-7)
    assert saw["statistics.error_deviation"] == near(error / sqrt(3.0), tolerance=1e-7)
    assert saw["statistics.error_worst"] == near(error, tolerance=1e-7)
    assert saw["statistics.reserve_worst"] == 0.0
    assert saw["statistics.late"] == 2
    saw.give("clear_statistics").now()
    assert saw.statistics("cuts", "late", "pieces_good", "pieces_bad") == (0, 0, 0, 0)
    assert saw.statistics("length_good", "length_waste") == (0.0, 0.0)
    assert saw.statistics("error_worst", "error_mean", "error_deviation", "reserve_worst") == (0.0, 0.0, 0.0, 1.0)
    saw.watched(5.2)
    assert saw["statistics.cuts"] == 1
    assert saw["statistics.error_mean"] == near(error, tolerance=1e-7)
    assert saw["statistics.error_deviation"] == 0.0


def test_batches() -> None:
    """Of two good pieces; a piece of waste between them does not count."""
    saw = started_machine({"batch_size": 2, "waste_length": 1200.0}).at(1.9)
    assert (saw["batch_count"], saw["batches"], saw["batch_done"]) == (1, 0, False)
    saw.at(3.0).set({"waste": True}).at(3.4)
    assert (saw["batch_count"], saw["batches"], saw["batch_done"]) == (0, 1, True)
    saw.set({"waste": False}).at(4.5)
    assert saw["batch_done"]
    saw.at(4.6)  # the waste's cut at C = 4200 ends at 4.55
    assert (saw["batch_count"], saw["batches"], saw["batch_done"]) == (0, 1, False)
    saw.at(6.1)
    assert (saw["batch_count"], saw["batches"]) == (1, 1)


# --- orders -----------------------------------------------------------------------------------------------------------


def test_orders_are_made_one_after_the_other_and_then_the_length() -> None:
    saw = idle_machine().order(1200.0, 2).now().order(1300.0).now()
    assert (saw["order.waiting"], saw["order.length_active"], saw["order.remaining"]) == (2, 1200.0, 2)
    saw.give("start").watched(1.6)
    assert (saw["order.waiting"], saw["order.remaining"], saw["order.completed"]) == (2, 1, 0)
    saw.watched(2.8)
    assert (saw["order.waiting"], saw["order.length_active"], saw["order.remaining"]) == (1, 1300.0, 1)
    saw.watched(6.0)
    assert (saw["order.waiting"], saw["order.length_active"], saw["order.remaining"]) == (0, 0.0, 0)
    assert saw["order.completed"] == 2
    assert saw.lengths() == each(1200.0, 1200.0, 1300.0, 1500.0)


def test_an_order_that_is_repeated() -> None:
    saw = idle_machine({"order.repeat": True}).order(1200.0, 2).now().order(1300.0).now().give("start").watched(8.0)
    assert saw.lengths() == each(1200.0, 1200.0, 1300.0, 1200.0, 1200.0, 1300.0)
    assert (saw["order.waiting"], saw["order.completed"]) == (2, 4)
    assert (saw["order.length_active"], saw["order.remaining"]) == (1200.0, 2)


def test_a_spoilt_piece_is_made_again() -> None:
    """The second of two pieces is ended by cut_now."""
    saw = idle_machine().order(1200.0, 2).now().give("start").watched(2.2).give("cut_now").watched(5.0)
    assert saw.kinds() == [PRODUCT, SHORT, PRODUCT]
    assert saw.lengths()[::2] == each(1200.0, 1200.0)
    assert saw["order.completed"] == 1


def test_a_skipped_order_is_neither_completed_nor_repeated() -> None:
    """The piece in progress is cut as it was fixed, and counts for none."""
    saw = idle_machine({"order.repeat": True}).order(1200.0, 2).now().order(1300.0, 2).now().give("start").at(0.5)
    saw.give("order.skip").now()
    assert (saw["order.waiting"], saw["order.length_active"], saw["order.remaining"]) == (1, 1300.0, 2)
    assert saw["next_cut.position"] == near(1200.0, tolerance=1e-8)
    saw.watched(3.0)
    assert saw.lengths() == each(1200.0, 1300.0)
    assert (saw["order.remaining"], saw["order.completed"], saw["statistics.pieces_good"]) == (1, 0, 2)


def test_all_orders_are_cleared() -> None:
    saw = idle_machine().order(1200.0, 2).now().order(1300.0).now().give("start").at(0.5).give("order.clear").now()
    assert (saw["order.waiting"], saw["order.length_active"], saw["order.remaining"]) == (0, 0.0, 0)
    saw.watched(3.2)
    assert saw.lengths() == each(1200.0, 1500.0)
    assert saw["order.completed"] == 0


# --- limits -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("length", "velocity"),
    [*((pitch, v) for pitch, v in GREATEST_VELOCITIES.items() if pitch < 2000.0), (0.0, GREATEST_VELOCITIES[2000.0])],
)
def test_the_highest_line_velocity_for_a_length(length: float, velocity: float) -> None:
    saw = CutToLengthHarness({**REFERENCE, "length": length}, speed=100.0).now()
    assert saw["limits.max_line_velocity"] == near(velocity)
    assert saw["line.velocity_request"] == near(0.98 * velocity)


def test_the_limits_at_the_present_velocity() -> None:
    """T_c = 1.033333, p_min = 1033.333, stroke 425; delta 3 and kerf 2 leave 1028.333; the reserve is that of the pitch
    in progress: 1 - 1033.333 / 1505."""
    saw = started_machine({"kerf": 2.0, "length_correction": 3.0}).at(0.2)
    assert saw["limits.cycle_time"] == near(1.033333333333)
    assert saw["limits.min_length"] == near(1028.333333333)
    assert saw["limits.stroke"] == near(425.0)
    assert saw["limits.reserve"] == near(1.0 - 1.033333333333 / 1.505)
    saw.speed = 0.0
    saw.run(0.1)
    assert (saw["limits.cycle_time"], saw["limits.min_length"], saw["limits.reserve"]) == (0.0, 0.0, 1.0)
    assert saw["limits.stroke"] == 100.0


def test_the_piece_in_progress_and_the_next_one_limit_the_line() -> None:
    saw = CutToLengthHarness({**REFERENCE, "length": 1500.0}, speed=500.0).give("start").now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1500.0])
    saw.order(2000.0).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1500.0])  # of the piece in progress
    saw.order(1000.0).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1500.0])  # 1000 comes only after 2000
    assert saw["limits.max_line_velocity_orders"] == near(GREATEST_VELOCITIES[1000.0])
    saw.give("order.clear").order(1000.0).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1000.0])
    saw.give("order.clear").now().set({"waste_length": 500.0, "waste": True}).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[500.0])
    saw.set({"waste": False, "sample_length": 1000.0}).give("take_sample").now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1000.0])


def test_a_cropped_piece_does_not_limit_the_line() -> None:
    saw = CutToLengthHarness({**REFERENCE, **CROP, "trim_length": 100.0, "length": 1500.0}, speed=500.0)
    saw.give("start").now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1500.0])
    assert saw["limits.reserve"] == 1.0


def test_an_order_that_ends_with_the_present_piece_does_not_limit_the_next() -> None:
    saw = CutToLengthHarness({**REFERENCE, "length": 2500.0}, speed=500.0).order(2400.0).now()
    saw.give("start").now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[2000.0])
    saw.order(1000.0).now()
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[1000.0])


def test_the_request_to_the_line() -> None:
    saw = CutToLengthHarness({**REFERENCE, "length": 1500.0, "line.margin": 0.1}, speed=500.0).give("start").now()
    assert saw["line.velocity_request"] == near(0.9 * GREATEST_VELOCITIES[1500.0])
    saw.set({"line.wanted_velocity": 700.0}).now()
    assert saw["line.velocity_request"] == 700.0


def test_a_length_shorter_than_possible_is_reported_and_nothing_is_lost() -> None:
    """Pieces of 100 at 1000 u/s: all material is in the pieces, each a multiple of 100."""
    saw = started_machine({"length": 100.0}).now()
    assert saw["warning.line_too_fast"]
    assert saw["limits.min_length"] == near(1033.333333333)
    saw.watched(6.0)
    assert all(piece.length / 100.0 == near(round(piece.length / 100.0)) for piece in saw.pieces)
    counts = {PRODUCT: saw.kinds().count(PRODUCT), MERGED: saw.kinds().count(MERGED)}
    assert counts[PRODUCT] <= 1 < counts[MERGED]
    assert saw["statistics.skipped"] >= sum(saw.lengths()) / 100.0 - len(saw.pieces)
    recorded = saw["statistics.length_good"] + saw["statistics.length_waste"]
    assert recorded == near(sum(saw.lengths()))
