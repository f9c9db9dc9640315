"""The commands: start, stop, abort, reset, hold, cut_now, calibration, and which goes before which.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

from typing import Any

import pytest

from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, StartMode
from tests.model.cut_to_length.harness import (
    HOME_AGAIN,
    JUST,
    LEAD,
    REFERENCE,
    CutToLengthHarness,
    assert_state,
    each,
    idle_machine,
    near,
    started_machine,
)

CONTINUE: dict[str, Any] = {"start_mode": StartMode.CONTINUE}
SLOW: dict[str, Any] = {"tool.retract_time": 0.04}


# --- start ------------------------------------------------------------------------------------------------------------


def test_the_first_level_of_start_is_no_edge() -> None:
    saw = idle_machine({"start": True}).at(0.5)
    assert (saw.state, saw["running"]) == (State.OFF, False)
    saw.set({"start": False}).now().set({"start": True}).now()
    assert (saw.state, saw["running"]) == (State.WAITING, True)


def test_a_machine_that_starts_by_itself() -> None:
    saw = idle_machine({"auto_start": True})
    assert not saw["running"]
    saw.at(2.0)
    assert (saw["running"], saw["statistics.cuts"], saw["last.length"]) == (True, 1, near(1500.0))


@pytest.mark.parametrize("time", [0.5, 1.5, 1.7, 2.0])
def test_start_is_refused_while_the_machine_runs(time: float) -> None:
    saw, twin = started_machine().at(time), started_machine().at(time)
    saw.give("start").at(2.8)
    twin.at(2.8)
    assert (saw["error"], saw["error_id"]) == (True, PieceFault.START)
    assert saw.slave == twin.slave
    assert (saw["statistics.cuts"], saw["last.length"]) == near(1, 1500.0)
    saw.give("reset").now()
    assert (saw["error"], saw["error_id"]) == (False, 0)


def test_start_is_refused_while_the_machine_stops() -> None:
    saw = started_machine().at(2.0).give("stop").at(2.1).give("start").now()
    assert saw["error_id"] == PieceFault.START
    saw.at(3.0)
    assert (saw.state, saw["running"]) == (State.OFF, False)


def test_there_must_be_a_cut_to_continue_from() -> None:
    saw = idle_machine(CONTINUE).give("start").now()
    assert (saw.state, saw["error_id"]) == (State.OFF, PieceFault.START)
    saw.set({"start_mode": StartMode.FRONT}).give("start").now()
    assert (saw.state, saw["error_id"]) == (State.WAITING, 0)


# --- stop -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time", [1.5, 1.7])
def test_stop_finishes_the_cut(time: float) -> None:
    saw = started_machine().at(time).give("stop").at(HOME_AGAIN - JUST)
    assert (saw.state, saw["running"], saw["last.length"]) == (State.RETURNING, True, near(1500.0))
    saw.at(HOME_AGAIN + JUST)
    assert (saw.state, saw["running"], saw["piece.kind"]) == (State.OFF, False, PieceKind.NONE)
    saw.at(4.0)
    assert (saw["statistics.cuts"], saw.slave) == (1, (0.0, 0.0, 0.0))


def test_stop_on_the_way_home() -> None:
    saw = started_machine().at(2.0).give("stop")
    assert_state(saw, HOME_AGAIN, State.RETURNING, State.OFF)


def test_stop_at_home_ends_the_run_at_once() -> None:
    saw = started_machine().at(1.0).give("stop").now()
    assert (saw.state, saw["running"], saw["next_cut.known"]) == (State.OFF, False, False)


# --- abort ------------------------------------------------------------------------------------------------------------


def test_abort_on_the_approach() -> None:
    """The valve is taken back before the blade touches at 1.63."""
    saw = started_machine({"tool.on_delay": 0.08, "tool.settle_time": 0.03}).at(1.57)
    assert saw["tool.command"]
    saw.give("abort").now()
    assert (saw.state, saw["tool.command"], saw["running"]) == (State.RETURNING, False, True)
    assert saw["tool.command_time"] == near(1.57)
    saw.at(3.0)
    assert (saw.state, saw["running"], saw.slave) == (State.OFF, False, (0.0, 0.0, 0.0))
    assert (saw["statistics.cuts"], saw["statistics.unsynchronised"]) == (0, 0)


@pytest.mark.parametrize(("time", "clear", "cuts"), [(1.7, 1.74, 0), (1.87, 1.89, 1)])
def test_abort_with_the_blade_down_clears_first(time: float, clear: float, cuts: int) -> None:
    """Retract_time from the abort on, or what is left of it. The way home of S = 1000 (clear - 1.5) u starts then."""
    saw = started_machine(SLOW).at(time).give("abort").now()
    assert (saw.state, saw["tool.command"], saw["running"]) == (State.CLEARING, False, True)
    assert saw["tool.command_time"] == near(min(time, 1.85))
    saw.at(clear - JUST)
    assert saw.slave == near(1000.0 * (clear - JUST - 1.5), 1000.0, 0.0)
    assert saw["tool.blade_down"]
    assert_state(saw, clear, State.CLEARING, State.RETURNING)
    assert not saw["tool.blade_down"]
    saw.at(3.0)
    assert (saw.state, saw["statistics.cuts"]) == (State.OFF, cuts)
    assert saw["statistics.unsynchronised"] == 0


def test_abort_while_settling_with_the_blade_up() -> None:
    saw = started_machine({**SLOW, "tool.settle_time": 0.1}).at(1.65).give("abort").now()
    assert saw.state == State.RETURNING


def test_abort_with_a_gap_half_open_stays_on_the_curve() -> None:
    """At 1.925: s = 430, v = 1125. After 0.04 s more w = (0.075 + 0.04) / 0.15 = 0.7667."""
    saw = started_machine({**SLOW, "gap.distance": 10.0, "gap.travel": 150.0}).at(1.925).give("abort").at(1.965 - 1e-9)
    w = 0.115 / 0.15
    assert saw.state == State.CLEARING
    assert saw.slave[0] == near(465.0 + 10.0 * w * w * w * (10.0 - 15.0 * w + 6.0 * w * w), tolerance=1e-7)
    saw.at(1.966)
    assert saw.state == State.RETURNING


def test_abort_at_home_and_on_the_way_there() -> None:
    saw = started_machine().at(1.0).give("abort").now()
    assert (saw.state, saw["running"]) == (State.OFF, False)
    saw = started_machine().at(2.0).give("abort")
    assert_state(saw, HOME_AGAIN, State.RETURNING, State.OFF)


def test_an_aborted_piece_stays_uncut_and_may_be_continued() -> None:
    """Aborted in the second cut (C = 3000) at 3.2. Continued at 4.0 from B = 1500: 3000 has passed, 4500 is next."""
    saw = started_machine().at(3.2).give("abort").at(4.0)
    assert (saw.state, saw["statistics.cuts"]) == (State.OFF, 1)
    saw.set(CONTINUE).give("start").now()
    assert saw["next_cut.position"] == near(4500.0)
    saw.watched(5.0)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.MERGED, near(3000.0))


# --- reset ------------------------------------------------------------------------------------------------------------


def test_a_fault_is_left_at_rest_at_home() -> None:
    """End of the stroke at 2.075 (feedback never comes)."""
    saw = started_machine({"tool.mode": ToolMode.FEEDBACK}).at(2.1).give("reset").now()
    assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)
    saw.give("start").now()
    assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)
    saw.at(3.0)
    assert (saw.state, saw["error_id"], saw["line.stop_request"]) == (State.FAULT, Fault.STROKE, True)
    saw.give("reset").now()
    assert (saw.state, saw["error"], saw["error_id"]) == (State.OFF, False, 0)
    assert (saw["line.stop_request"], saw["running"]) == (False, False)
    assert saw["line.velocity_request"] > 0.0
    saw.give("start").now()
    assert (saw.state, saw["error_id"]) == (State.WAITING, 0)


def test_an_accepted_command_clears_a_refusal() -> None:
    saw = started_machine().order(-1.0).now()
    assert saw["error_id"] == PieceFault.ORDER
    saw.order(1200.0).now()
    assert (saw["error"], saw["error_id"]) == (False, 0)


# --- hold and cut_now -------------------------------------------------------------------------------------------------


def test_no_approach_begins_while_held() -> None:
    """Until 1.45: the cut at 1500 has passed, the piece ends at 3000."""
    saw = started_machine().set({"hold": True}).at(1.45)
    assert (saw.state, saw["statistics.skipped"]) == (State.WAITING, 0)
    saw.set({"hold": False}).watched(3.5)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.MERGED, near(3000.0))


def test_hold_does_not_touch_a_cut_under_way() -> None:
    saw = started_machine().at(1.45).set({"hold": True}).at(2.8)
    assert (saw["last.length"], saw["statistics.cuts"]) == near(1500.0, 1)


def test_cutting_now() -> None:
    """At m = 700: C = 700 + lead, in sync 2 lead later. The next piece is a full one."""
    saw = started_machine().at(0.7).give("cut_now").watched(1.3)
    assert saw["last.kind"] == PieceKind.SHORT
    assert (saw["last.length"], saw["last.time"]) == near(700.0 + LEAD, 0.7 + 2e-3 * LEAD)
    assert saw["next_cut.position"] == near(2200.0 + LEAD)
    assert (saw["statistics.pieces_bad"], saw["statistics.length_waste"]) == near(1, 700.0 + LEAD)


def test_cutting_now_waits_for_home() -> None:
    """Given during a cut: C = 1000 HOME_AGAIN + lead."""
    saw = started_machine().at(1.7).give("cut_now").at(2.4)
    assert saw["next_cut.position"] == near(3000.0)
    saw.watched(3.2)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.SHORT, near(1000.0 * HOME_AGAIN + LEAD - 1500.0))


def test_cutting_now_waits_for_rest_and_hold() -> None:
    saw = started_machine({"homing.settle_time": 0.1}).at(1.7).give("cut_now").set({"hold": True}).at(2.6)
    assert saw.state == State.WAITING
    saw.set({"hold": False}).watched(3.2)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.SHORT, near(2600.0 + LEAD - 1500.0))


def test_cutting_now_without_a_length() -> None:
    saw = started_machine({"length": 0.0}).at(0.7).give("cut_now").watched(1.3)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.SHORT, near(700.0 + LEAD))


def test_cutting_now_waits_until_the_machine_can_follow() -> None:
    """1600 is beyond max_velocity; the line slows down to 1000 at m = 640."""
    saw = started_machine({"length": 1e5}, speed=1600.0).give("cut_now").at(0.4)
    assert (saw.state, saw["error"]) == (State.WAITING, False)
    saw.speed = 1000.0
    saw.watched(1.2)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.SHORT, near(640.0 + LEAD))


def test_a_cropped_piece_waits_until_the_machine_can_follow() -> None:
    values: dict[str, Any] = {"start_mode": StartMode.TRIM, "late_mode": LateMode.SKIP}
    saw = started_machine(values, speed=1600.0).at(0.4)
    assert (saw.state, saw["statistics.skipped"]) == (State.WAITING, 0)
    saw.speed = 1000.0
    saw.watched(1.2)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.TRIM, near(640.0 + LEAD))


@pytest.mark.parametrize("running", [False, True])
def test_cutting_now_needs_a_running_machine(running: bool) -> None:
    saw = idle_machine().at(0.1)
    if running:
        saw.give("start").now()
    saw.give("cut_now").now()
    assert saw["error_id"] == (0 if running else PieceFault.CUT_NOW)


# --- calibration ------------------------------------------------------------------------------------------------------


def test_calibration() -> None:
    """(1512 + 4) / (1500 + 4). The second piece is fixed with the old factor, C = 1502 + 1504; the third is 1504 times
    its reciprocal of the master long."""
    saw = (
        started_machine({"kerf": 4.0})
        .at(2.0)
        .set({"calibration.measured_length": 1512.0})
        .give("calibration.execute")
        .now()
    )
    assert saw["calibration.factor"] == near(1516.0 / 1504.0)
    assert saw["next_cut.position"] == near(3006.0)
    saw.watched(3.5)
    assert saw["next_cut.position"] == near(3006.0 + 1504.0 * 1504.0 / 1516.0)
    saw.watched(5.0)
    assert saw.lengths() == each(1500.0, 1500.0, 1500.0)
    assert saw["local.coupling_factor"] == near(1516.0 / 1504.0)
    saw.give("calibration.reset").now()
    assert saw["calibration.factor"] == 1.0


def test_calibration_goes_by_the_piece_that_was_measured() -> None:
    """Its kerf 4 and correction 3, not the later ones: (1512 + 4) / (1500 + 4 + 3)."""
    saw = started_machine({"kerf": 4.0, "length_correction": 3.0}).at(2.0).set({"kerf": 1.0, "length_correction": 0.0})
    saw.set({"calibration.measured_length": 1512.0}).give("calibration.execute").now()
    assert saw["calibration.factor"] == near(1516.0 / 1507.0)


@pytest.mark.parametrize("measured", [0.0, -1.0, float("nan")])
def test_a_calibration_that_is_refused(measured: float) -> None:
    saw = started_machine().at(1.0).set({"calibration.measured_length": 1512.0}).give("calibration.execute").now()
    assert (saw["error_id"], saw["calibration.factor"]) == (PieceFault.CALIBRATION, 1.0)
    saw.at(2.0).set({"calibration.measured_length": measured}).give("calibration.execute").now()
    assert saw["error_id"] in (PieceFault.CALIBRATION, PieceFault.TUNABLE)
    assert saw["calibration.factor"] == 1.0


# --- simultaneous edges -----------------------------------------------------------------------------------------------


def test_stop_goes_before_start() -> None:
    saw = started_machine().at(1.0).give("stop", "start").now()
    assert (saw.state, saw["error_id"]) == (State.WAITING, 0)
    assert saw["next_cut.position"] == near(2500.0)


def test_reset_goes_before_start() -> None:
    saw = CutToLengthHarness({**REFERENCE, "late_mode": LateMode.STOP_LINE, "length": 1500.0}, speed=1310.0)
    saw.give("start").at(2.9)
    assert (saw.state, saw["error_id"]) == (State.FAULT, PieceFault.CUT_MISSED)
    saw.give("reset", "start").now()
    assert (saw.state, saw["error_id"]) == (State.WAITING, 0)


def test_abort_goes_before_stop() -> None:
    saw = started_machine().at(1.7).give("abort", "stop").now()
    assert saw.state == State.RETURNING
    saw.at(3.0)
    assert (saw.state, saw["statistics.cuts"]) == (State.OFF, 0)


def test_orders_are_forgotten_before_one_is_appended() -> None:
    saw = idle_machine().order(1200.0).now().order(1300.0).give("order.clear", "order.skip").now()
    assert (saw["order.waiting"], saw["order.length_active"]) == (1, 1300.0)


def test_calibration_is_forgotten_before_a_new_one() -> None:
    saw = started_machine().at(2.0).set({"calibration.measured_length": 1515.0}).give("calibration.execute").now()
    saw.set({"calibration.measured_length": 1530.0}).give("calibration.execute", "calibration.reset").now()
    assert saw["calibration.factor"] == near(1.02)
