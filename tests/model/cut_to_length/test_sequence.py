"""The sequence of a cycle up to the way home, point by point, and the carriage's motion in it; numbers by hand.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

from math import sqrt
from typing import Any

import pytest

from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.interface import LateMode, PieceKind
from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import (
    HOME_AGAIN,
    JUST,
    LEAD,
    assert_state,
    idle_machine,
    near,
    started_machine,
)

FEEDBACK: dict[str, Any] = {"tool.mode": ToolMode.FEEDBACK}
PULL = {"gap.distance": 10.0, "gap.travel": 150.0}
EXACT_MODES = [MasterInput.END_OF_STEP, MasterInput.START_OF_STEP]


# --- 1: the start -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", EXACT_MODES)
def test_a_cycle_happens_on_time_whatever_the_step(mode: MasterInput) -> None:
    """One step over all of it: start where m = C - D = 1400, sync at 1600, the cut ends 0.25 s later."""
    saw = started_machine(mode=mode).at(2.8)
    assert saw.state == State.WAITING
    assert saw.cut_counts() == (1, 0)
    assert saw["local.start_time"] == near(1.4)
    assert saw["last.time"] == near(1.6)
    assert saw["tool.command_time"] == near(1.85)
    assert saw["local.home_time"] == near(HOME_AGAIN)
    assert saw["clock"] == near(2.8)
    assert saw.slave == (0.0, 0.0, 0.0)


def test_the_states_of_a_cycle_in_order() -> None:
    """Settling until 1.65, cut until 1.90, clear at 1.94, s = 440; way home 0.5 + (440 - 225) / 1500 = 0.643333."""
    saw = started_machine({"tool.settle_time": 0.05, "tool.retract_time": 0.04})
    assert saw.state == State.OFF
    saw.now()
    assert saw.state == State.WAITING
    assert_state(saw, 1.4, State.WAITING, State.APPROACHING)
    assert_state(saw, 1.6, State.APPROACHING, State.SYNCHRONOUS)
    assert_state(saw, 1.65, State.SYNCHRONOUS, State.CUTTING)
    assert_state(saw, 1.9, State.CUTTING, State.CLEARING)
    assert_state(saw, 1.94, State.CLEARING, State.RETURNING)
    assert_state(saw, 1.94 + 0.5 + 215.0 / 1500.0, State.RETURNING, State.WAITING)
    assert saw["state_code"] == State.WAITING


def test_a_phase_that_takes_no_time_is_passed_through_in_the_same_instant() -> None:
    saw = started_machine({"tool.cut_time": 0.0}).at(1.6 - JUST)
    assert saw.state == State.APPROACHING
    saw.at(1.6 + JUST)
    assert saw.state == State.RETURNING
    assert saw.cut_counts() == (1, 0)
    assert saw["tool.command_time"] == near(1.6)
    assert not saw["tool.command"]


def test_the_factors_of_wheel_and_mitre() -> None:
    """f = 2, alpha = 60 deg: k = 4, so the carriage runs at 1000 on a line of 250. Front end at 20: B = -20 / 4 -
    4 / (2 2) = -6, p = (1500 + 4) / 2 = 752, C = 746; start at k mu = 50 - 100, m = 746 - 12.5 = 733.5, which is at
    t = 2.934; sync at 150 when m = 746 + 37.5."""
    factors = {"material_factor": 2.0, "diagonal_angle": 60.0}
    places = {"home_position": 50.0, "axis.initial_position": 50.0, "front_position": 20.0}
    saw = started_machine({**factors, **places, "kerf": 4.0}, speed=250.0).now()
    assert saw["local.coupling_factor"] == near(4.0)
    assert saw["next_cut.position"] == near(746.0)
    saw.at(3.134 + JUST)
    assert saw["local.start_time"] == near(2.934)
    assert saw.slave == near(150.0 + 1000.0 * JUST, 1000.0, 0.0)
    saw.at(4.0)
    assert saw["last.time"] == near(3.134)
    assert (saw["last.length"], saw["last.error"]) == near(1500.0, 0.0)


@pytest.mark.parametrize(
    ("values", "distance"),
    [
        ({"approach.reserve": 0.1}, sqrt(1.5 * 1100.0**3 / 200000.0)),  # 99.912, > 0.75 1100^2 / 10000 = 90.75
        ({"approach.acceleration": 5000.0}, 150.0),  # 0.75 1000^2 / 5000
        ({"approach.jerk": 50000.0}, sqrt(1.5e9 / 50000.0)),
        ({"approach.distance": 130.0}, 130.0),
        ({"approach.distance": 20.0}, LEAD),
    ],
)
def test_the_approach_is_as_long_as_limits_reserve_and_distance_ask(values: dict[str, Any], distance: float) -> None:
    saw = started_machine({"approach.distance": 0.0, **values}).now()
    assert saw["local.approach_distance"] == near(distance)
    assert saw["local.start_position"] == near(1500.0 - distance)
    saw.at(1.8)
    assert saw["local.start_time"] == near(1.5 - 1e-3 * distance)


@pytest.mark.parametrize(("settle", "is_late"), [(0.475, False), (0.5, True)])
def test_after_the_arrival_the_carriage_rests_before_the_next_start(settle: float, is_late: bool) -> None:
    """Ready at 2.433333 + settle, past 2.9: at 2.908333 D' = 3000 - 2908.333 = 91.667 >= lead, at 2.933333 it is
    66.667 < lead: skipped. The first start needs no rest: home since initialization."""
    saw = started_machine({"homing.settle_time": settle}).at(2.85)
    assert saw["local.start_time"] == near(1.4)
    saw.at(3.05)
    assert saw.cut_counts() == (1, 1 if is_late else 0)
    assert saw["local.start_time"] == near(1.4 if is_late else HOME_AGAIN + 0.475)


def test_a_start_soon_after_initialization_needs_no_rest() -> None:
    saw = started_machine({"homing.settle_time": 0.5, "length": 200.0}).at(0.15)
    assert saw.state == State.APPROACHING
    assert saw["local.start_time"] == near(0.1)


def test_a_start_that_comes_a_little_late_has_a_shorter_approach() -> None:
    """Hold ends at 1.41: D' = 1500 - 1410 = 90 >= lead, so the carriage is in sync at s = 90, m = 1590."""
    saw = started_machine().set({"hold": True}).at(1.41).set({"hold": False}).at(1.59 - JUST)
    assert saw.state == State.APPROACHING
    saw.at(1.59 + JUST)
    assert saw.slave == near(90.0 + 1000.0 * JUST, 1000.0, 0.0)
    assert saw["local.start_time"] == near(1.41)
    saw.at(2.0)
    assert (saw["last.time"], saw["last.length"], saw["statistics.skipped"]) == near(1.59, 1500.0, 0)


def test_a_line_that_has_stopped_past_the_start_point_starts_the_carriage_when_it_moves_again() -> None:
    """It rests at 1450: D' = 50 is enough, since lead(0) = 0. It moves on with 500: m = 1450 + 250 t^2, so mu = 50 is
    reached after sqrt(100 / 250) s, at 500 sqrt(0.4) = 316.228."""
    saw = started_machine().set({"hold": True}).at(1.45)
    saw.speed = 0.0
    saw.run(0.3).set({"hold": False}).run(0.25)
    assert (saw.state, saw["local.start_time"]) == (State.WAITING, 0.0)
    saw.run(sqrt(0.4) - JUST, acceleration=500.0)
    assert (saw.state, saw["local.start_time"]) == (State.APPROACHING, near(2.0))
    saw.run(2.0 * JUST, acceleration=500.0)
    assert saw.state == State.CUTTING
    assert saw.slave == near(50.0, 500.0 * sqrt(0.4), 500.0, tolerance=1e-3)
    saw.run(0.4)
    assert (saw["last.length"], saw["statistics.skipped"]) == near(1500.0, 0)


def test_no_start_while_the_line_runs_backwards() -> None:
    """Though it is past the start point 1400: hold ends at 1450, and at 1410 the line goes on."""
    saw = started_machine().set({"hold": True}).at(1.45).set({"hold": False})
    saw.speed = -1000.0
    saw.run(0.04)
    assert saw.state == State.WAITING
    saw.speed = 1000.0
    saw.run(0.001)
    assert (saw.state, saw["local.start_time"]) == (State.APPROACHING, near(1.49))


@pytest.mark.parametrize(("reserve", "is_late"), [(0.0, True), (0.02, False)])
def test_an_input_that_jumps_past_the_start(reserve: float, is_late: bool) -> None:
    """By 0.05. D(1000) with the reserve is 1.02^1.5 lead = 89.213564; D' = 89.163564 is 1.0296 lead: on time, and the
    start is at the step's beginning. Without a reserve D' = lead - 0.05: the cut is skipped."""
    distance = LEAD * 1.02**1.5 if reserve else LEAD
    saw = started_machine({"approach.distance": 0.0, "approach.reserve": reserve}).at(1.4)
    saw.master_position = 1500.0 - distance + 0.05
    saw.run(0.01)
    assert saw.cut_counts() == (0, 1 if is_late else 0)
    assert saw.state == (State.WAITING if is_late else State.APPROACHING)
    if not is_late:
        assert saw["local.start_time"] == near(1.4)
        assert (distance - 0.05) / LEAD == near(1.0296, tolerance=1e-4)
        saw.to(1500.0 + distance - 0.05 + 1e-3)
        assert saw.slave == near(distance - 0.05 + 1e-3, 1000.0, 0.0)


def test_what_the_input_jumps_over_happens_before_the_commands() -> None:
    """The start point 1400 is jumped over in the step in which stop is given: the carriage has started, it cuts."""
    saw = started_machine().at(1.39)
    saw.master_position = 1401.0
    saw.give("stop").run(0.01)
    assert saw.state == State.APPROACHING
    assert saw["local.start_time"] == near(1.39)


@pytest.mark.parametrize("late_mode", list(LateMode))
def test_a_cut_that_the_machine_cannot_follow(late_mode: LateMode) -> None:
    """1600 > max_velocity 1500: no approach, whatever late_mode is; with STOP_LINE fault 17, else each is skipped.
    D(1600) = lead = 0.75 1600^2 / 10000 = 192: starts would be at m = 1308, 2808."""
    saw = started_machine({"late_mode": late_mode}, speed=1600.0).at(1300.0 / 1600.0)
    assert saw["warning.velocity"]
    assert saw.cut_counts() == (0, 0)
    saw.at(2900.0 / 1600.0)
    if late_mode == LateMode.STOP_LINE:
        assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)
    else:
        assert (saw.state, saw["statistics.skipped"], saw["statistics.late"]) == (State.WAITING, 2, 0)
        assert saw["piece.kind"] == PieceKind.MERGED


def test_a_cycle_that_would_not_fit_into_the_stroke_does_not_start() -> None:
    """stroke = 425 > 424.9; at 425.1 it fits."""
    for end, skipped in [(425.1, 0), (424.9, 1)]:
        saw = started_machine({"axis.max_position": end}).at(1.5)
        assert saw["statistics.skipped"] == skipped
        assert saw["warning.stroke"] == (skipped == 1)
        assert saw["limits.stroke"] == near(425.0)


# --- 2: the approach --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("time", "setpoint"),
    [  # M = 200, s = 200 (u^3 - u^4 / 2), v = 1000 (3 u^2 - 2 u^3), a = 1e6 6 (u - u^2) / 200, j = 1e9 (6 - 12 u) / 4e4
        (1.45, (2.734375, 156.25, 5625.0, 75000.0)),  # u = 1/4
        (1.5, (18.75, 500.0, 7500.0, 0.0)),  # u = 1/2
        (1.55, (52.734375, 843.75, 5625.0, -75000.0)),  # u = 3/4: 200 (0.421875 - 0.158203125)
    ],
)
def test_the_ramp_over_the_master(time: float, setpoint: tuple[float, ...]) -> None:
    saw = started_machine().at(time)
    assert (*saw.slave, saw["slave.jerk"]) == near(*setpoint)
    assert saw["local.progress"] == near((time - 1.4) / 0.2)
    assert not saw["in_sync"]


def test_the_ramp_goes_by_the_master_also_when_that_speeds_up() -> None:
    """By 200 from m = 1400 on: v^2 = 1e6 + 2 200 100 at u = 1/2, after (v - 1000) / 200 s. s = 18.75, s' = 1/2, s'' =
    1.5 / 200: velocity v / 2, acceleration s'' v^2 + 200 s' = 7800 + 100."""
    saw = started_machine().at(1.4)
    speed = sqrt(1.04e6)
    saw.run((speed - 1000.0) / 200.0, acceleration=200.0)
    assert saw.slave == near(18.75, 0.5 * speed, 7900.0)


def test_a_line_that_turns_back_past_the_start_takes_the_carriage_home() -> None:
    """From 1450 on (t = 1.45) it brakes with 20000: stop at 1475 after 0.05 s; back at 1400 where -50 = 1000 t - 10000
    t^2, t = (1000 + sqrt(3e6)) / 20000. The tool was commanded at mu + 0.16 v = 100, m = 1440; it is taken back before
    it touches at 1.6."""
    saw = started_machine({"tool.on_delay": 0.16}).at(1.45)
    assert saw["tool.command"]
    assert saw["tool.command_time"] == near(1.44)
    back = (1000.0 + sqrt(3e6)) / 20000.0
    saw.run(back - JUST, acceleration=-20000.0)
    assert saw.state == State.APPROACHING
    saw.run(0.145 - back + JUST, acceleration=-20000.0)
    assert (saw.state, saw.slave) == (State.WAITING, (0.0, 0.0, 0.0))
    assert not saw["tool.command"]
    assert saw["tool.command_time"] == near(1.45 + back)
    assert saw["statistics.unsynchronised"] == 0
    saw.speed = 1000.0
    saw.to(1500.0)
    assert saw.slave == near(18.75, 500.0, 7500.0)
    saw.to(2000.0)
    assert (saw["last.length"], saw.cut_counts()) == (near(1500.0), (1, 0))


def test_a_blade_that_touched_early_is_clear_when_the_line_has_turned_back() -> None:
    """Commanded 0.1 s before sync, at 1.5 s; from there the line has 100 u/s, and the blade touches at m = 1510. With
    -1000 from 1.62 s, m = 1512, the carriage is at home at m = 1400: out of the material before it has retracted."""
    saw = started_machine({"tool.on_delay": 0.1, "tool.retract_time": 0.1}).at(1.5)
    saw.speed = 100.0
    saw.at(1.62)
    assert (saw["tool.blade_down"], saw["warning.blade_early"], saw.state) == (True, True, State.APPROACHING)
    saw.speed = -1000.0
    assert_state(saw, 1.62 + 0.112, State.APPROACHING, State.WAITING)
    assert (saw["tool.command"], saw["tool.blade_down"]) == (False, False)


def test_rounding_of_the_inputs_is_no_turning_back() -> None:
    saw = started_machine().at(1.4 + 1e-12)
    assert saw.state == State.APPROACHING
    saw.master_position = 1400.0 - 1e-9
    saw.run(1e-15)
    assert saw.state == State.APPROACHING
    saw.to(1500.0)
    assert saw["local.start_time"] == near(1.4)
    assert saw.slave == near(18.75, 500.0, 7500.0)


# --- 3: the tool ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("settle", "delay", "command", "begin"),
    [
        (0.0, 0.0, 1.6, 1.6),
        (0.05, 0.0, 1.65, 1.65),
        (0.05, 0.02, 1.63, 1.65),
        (0.03, 0.08, 1.55, 1.63),  # mu + 1000 (0.08 - 0.03) = 100 at m = 1550
    ],
)
def test_the_tool_is_commanded_so_that_it_touches_after_settling(
    settle: float, delay: float, command: float, begin: float
) -> None:
    saw = started_machine({"tool.settle_time": settle, "tool.on_delay": delay}).at(command - JUST)
    assert not saw["tool.command"]
    saw.at(command + JUST)
    assert saw["tool.command"]
    assert saw["tool.command_time"] == near(command)
    if delay:
        saw.at(command + delay - JUST)
        assert not saw["tool.blade_down"]
    saw.at(begin + 2.0 * JUST)
    assert saw["tool.blade_down"]
    assert saw["tool.cutting"]
    saw.at(begin + 0.25 - JUST)
    assert (saw["tool.command"], saw["tool.cutting"], saw.cut_counts()) == (True, True, (0, 0))
    saw.at(begin + 0.25 + JUST)
    assert (saw["tool.command"], saw["tool.cutting"], saw.cut_counts()) == (False, False, (1, 0))
    assert saw["tool.command_time"] == near(begin + 0.25)
    assert saw["last.time"] == near(1.6)
    assert not saw["warning.any"]


def test_a_blade_that_touches_before_sync_is_reported_and_counted() -> None:
    """Commanded at mu + 0.08 v = 100, m = 1520; the line slows down to 500: in sync after 80 / 500 = 0.16 s, the blade
    touches after 0.08 s. The cut starts in sync, at 1.68."""
    saw = started_machine({"tool.on_delay": 0.08}).at(1.52 + JUST)
    saw.speed = 500.0
    saw.at(1.6 - JUST)
    assert (saw["tool.command"], saw["tool.blade_down"], saw["warning.blade_early"]) == (True, False, False)
    saw.at(1.6 + JUST)
    assert (saw.state, saw["tool.blade_down"], saw["warning.blade_early"]) == (State.APPROACHING, True, True)
    assert saw["statistics.unsynchronised"] == 1
    assert saw["warning.any"]
    saw.at(1.92)
    assert saw.state == State.CUTTING
    saw.at(1.94)
    assert saw.state == State.RETURNING
    assert saw["last.time"] == near(1.68, tolerance=1e-5)
    saw.at(6.0)
    assert saw.cut_counts() == (2, 0)
    assert (saw["warning.blade_early"], saw["statistics.unsynchronised"]) == (False, 1)


def test_a_blade_that_touches_later_than_sync_is_waited_for() -> None:
    """Commanded at m = 1520, t = 1.52, while the line speeds up to 1250: in sync at 1.52 + 80 / 1250 = 1.584, but the
    blade touches at 1.6."""
    saw = started_machine({"tool.on_delay": 0.08}).at(1.52 + 1e-9)
    saw.speed = 1250.0
    assert_state(saw, 1.584, State.APPROACHING, State.SYNCHRONOUS)
    assert_state(saw, 1.6, State.SYNCHRONOUS, State.CUTTING)
    assert_state(saw, 1.85, State.CUTTING, State.RETURNING)
    assert saw["last.time"] == near(1.584, tolerance=1e-8)


# --- 4: the end of the cut --------------------------------------------------------------------------------------------


def test_the_cut_ends_by_distance() -> None:
    """200 at 1000 take 0.2 s. The line rests for 1 s in between: the cut goes on with it."""
    values: dict[str, Any] = {"tool.mode": ToolMode.DISTANCE, "tool.cut_distance": 200.0}
    saw = started_machine(values).at(1.7)
    saw.speed = 0.0
    saw.run(1.0)
    assert saw.state == State.CUTTING
    saw.speed = 1000.0
    assert_state(saw, 2.8, State.CUTTING, State.RETURNING)
    assert saw["last.length"] == near(1500.0)
    assert saw["tool.command_time"] == near(2.8)


def test_the_distance_counts_from_the_beginning_of_the_cut() -> None:
    """The line turns back in the cut, beyond where it began: the carriage follows, and 200 are those from s = 100."""
    values: dict[str, Any] = {"tool.mode": ToolMode.DISTANCE, "tool.cut_distance": 200.0}
    saw = started_machine(values).at(1.65)
    saw.speed = -1000.0
    saw.run(0.1)
    assert saw.state == State.CUTTING
    assert saw.slave == near(50.0, -1000.0, 0.0)
    saw.speed = 1000.0
    assert_state(saw, 2.0, State.CUTTING, State.RETURNING)  # from m = 1550 to 1800
    assert saw["last.length"] == near(1500.0)


def test_the_time_of_a_cut_goes_on_while_the_line_is_at_rest() -> None:
    saw = started_machine().at(1.7)
    saw.speed = 0.0
    assert_state(saw, 1.85, State.CUTTING, State.RETURNING)
    assert saw["last.length"] == near(1500.0)


def test_the_cut_ends_by_feedback() -> None:
    """An edge before the cut is lost."""
    saw = started_machine(FEEDBACK).at(1.5).give("tool.done").at(1.7)
    assert saw.state == State.CUTTING
    saw.give("tool.done").now()
    assert saw.state == State.RETURNING
    assert saw["tool.command_time"] == near(1.7)
    assert saw["last.time"] == near(1.6)


def test_a_piece_is_recorded_when_its_cut_ends() -> None:
    saw = started_machine({"tool.retract_time": 0.1}).at(1.85 - JUST)
    assert (saw["next_cut.position"], saw.cut_counts()) == (near(1500.0), (0, 0))
    assert saw["last.kind"] == PieceKind.NONE
    saw.at(1.85 + JUST)
    assert (saw["next_cut.position"], saw.cut_counts()) == (near(3000.0), (1, 0))
    assert (saw["last.kind"], saw["last.good"]) == (PieceKind.PRODUCT, True)
    assert (saw["last.length"], saw["last.error"]) == near(1500.0, 0.0)
    assert saw["last.reserve"] == 1.0
    assert saw["statistics.length_good"] == near(1500.0)


def test_the_reserve_of_a_cycle() -> None:
    """From 1.4 to 2.9 the carriage is at home and ready since 2.433333 + 0.1: (2.9 - 2.533333) / 1.5."""
    saw = started_machine({"homing.settle_time": 0.1}).at(3.5)
    assert saw["last.reserve"] == near((2.9 - HOME_AGAIN - 0.1) / 1.5)
    assert saw["statistics.reserve_worst"] == near((2.9 - HOME_AGAIN - 0.1) / 1.5)


# --- 5: the gap -------------------------------------------------------------------------------------------------------


def test_the_carriage_pulls_a_gap() -> None:
    """T = 150 / 1000 = 0.15 s; half way s = 350 + 75 + 5, v = 1000 + 1.875 10 / 0.15 = 1125; ahead by 10 at 2.0, s =
    510; still so in CLEARING. The way home is 0.5 + (560 - 225) / 1500."""
    saw = started_machine({**PULL, "tool.retract_time": 0.05}).at(1.85 + JUST)
    assert (saw.state, saw["tool.command"], saw.cut_counts()) == (State.PULLING, True, (1, 0))
    assert not saw["in_sync"]
    saw.at(1.925)
    assert saw.slave == near(430.0, 1125.0, 0.0)
    assert saw["slave.jerk"] == near(-30.0 * 10.0 / 0.15**3)  # g (60 - 360 w + 360 w^2) / T^3
    assert_state(saw, 2.0, State.PULLING, State.CLEARING)
    assert saw["tool.command_time"] == near(2.0)
    assert not saw["tool.command"]
    assert not saw["in_sync"]
    saw.at(2.04)
    assert saw.slave == near(550.0, 1000.0, 0.0)
    assert_state(saw, 2.05, State.CLEARING, State.RETURNING)
    saw.at(2.8)
    assert saw["local.home_time"] == near(2.05 + 0.5 + 335.0 / 1500.0)
    assert not saw["warning.any"]


def test_a_gap_that_the_axis_cannot_pull_is_left_out() -> None:
    """Over 140, T = 0.14 s: jerk 60 10 / 0.14^3 = 218659 > 200000."""
    saw = started_machine({**PULL, "gap.travel": 140.0}).at(1.86)
    assert (saw.state, saw["warning.gap_skipped"], saw["tool.command"]) == (State.RETURNING, True, False)
    assert saw["tool.command_time"] == near(1.85)
    saw.at(3.34)
    assert saw["warning.gap_skipped"]
    saw.set({"gap.distance": 0.0}).at(4.9)  # a cycle keeps the values that it began with: the next has none
    assert not saw["warning.gap_skipped"]


@pytest.mark.parametrize(("share", "is_skipped"), [(1.0 - 1e-9, True), (1.0 + 1e-9, False)])
@pytest.mark.parametrize("name", ["max_velocity", "max_acceleration", "max_deceleration", "max_jerk"])
def test_the_limits_of_a_gap_are_sharp(name: str, share: float, is_skipped: bool) -> None:
    """T = 0.15 s: 1125 u/s, 10/sqrt(3) 10 / T^2, 60 10 / T^3. Approach and way home have limits of their own."""
    greatest = {"max_velocity": 1125.0, "max_jerk": 600.0 / 0.15**3}
    limits = {f"homing.{limit}": 10000.0 for limit in ("acceleration", "deceleration")}
    limits |= {"approach.acceleration": 10000.0, "approach.jerk": 200000.0, "homing.jerk": 200000.0}
    limits[f"axis.{name}"] = share * greatest.get(name, 100.0 / sqrt(3.0) / 0.15**2)
    saw = started_machine({**PULL, **limits}).at(1.86)
    assert (saw.state == State.RETURNING, saw["warning.gap_skipped"]) == (is_skipped, is_skipped)


def test_no_gap_is_pulled_while_the_line_is_at_rest() -> None:
    saw = started_machine(PULL).at(1.8)
    saw.speed = 0.0
    saw.at(1.86)
    assert (saw.state, saw["warning.gap_skipped"]) == (State.RETURNING, True)


# --- 6: a line at rest ------------------------------------------------------------------------------------------------


def test_a_line_at_rest_is_cut_where_it_is() -> None:
    """m = 500, h = 20: C = 480, in sync at once; the piece from B = 0 is 480 long."""
    saw = started_machine({"home_position": 20.0, "axis.initial_position": 20.0}).at(0.5)
    saw.speed = 0.0
    saw.run(0.1).give("cut_now").now()
    assert (saw.state, saw["in_sync"], saw["tool.command"]) == (State.CUTTING, True, True)
    assert saw.slave == (20.0, 0.0, 0.0)
    saw.at(0.85 + JUST)
    assert saw["last.kind"] == PieceKind.SHORT
    assert saw["last.length"] == near(480.0)
    assert saw["last.time"] == near(0.6)
    assert saw.state in (State.RETURNING, State.WAITING)


# --- outputs during a cycle -------------------------------------------------------------------------------------------


def test_how_far_it_is_to_the_next_cut() -> None:
    """C = 1500, sync at m = 1600."""
    saw = idle_machine()
    assert (saw["next_cut.known"], saw["next_cut.distance"], saw["piece.kind"]) == (False, 0.0, PieceKind.NONE)
    saw.give("start").at(1.0)
    assert (saw["next_cut.known"], saw["next_cut.position"]) == (True, near(1500.0))
    assert saw["next_cut.distance"] == near(600.0)
    assert (saw["piece.length"], saw["piece.ordered"], saw["piece.kind"]) == (near(1000.0), 1500.0, PieceKind.PRODUCT)
    saw.at(1.5)
    assert saw["next_cut.distance"] == near(100.0)
    assert saw["piece.length"] == near(1500.0 - 18.75)
    saw.at(1.7)
    assert (saw["next_cut.distance"], saw["in_sync"]) == (0.0, True)
    assert saw["piece.length"] == near(1500.0)
    saw.at(1.9)
    assert saw["next_cut.distance"] == near(3100.0 - 1900.0)
    saw.give("stop").at(2.0)
    assert (saw["next_cut.known"], saw["next_cut.distance"]) == (True, near(3100.0 - 2000.0))
    saw.at(2.5)  # at home, OFF
    assert (saw["next_cut.known"], saw["next_cut.distance"], saw["next_cut.position"]) == (False, 0.0, 0.0)
    assert (saw["piece.kind"], saw["piece.ordered"], saw["piece.length"]) == (PieceKind.NONE, 0.0, 0.0)


def test_positions_wrap_with_the_masters_period() -> None:
    """P = 700: C = 1500 is 100; start at 1400, which is 0."""
    saw = started_machine({"master.period": 700.0}).at(0.4)
    assert saw["next_cut.position"] == near(100.0)
    for i in range(1, 30):
        saw.at(0.4 + 0.1 * i)
    assert saw["local.start_time"] == near(2.9)
    assert saw["last.length"] == near(1500.0)
    assert saw["last.time"] == near(1.6)
    assert saw["next_cut.position"] == near(3000.0 - 4.0 * 700.0)
