"""The sequence of a cycle, point by point, and the carriage's motion in it; numbers by hand.

Where nothing else is said the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

from math import sqrt
from typing import Any

import pytest

from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import LateMode, PieceKind, State, ToolMode
from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import (
    HOME_AGAIN,
    JUST,
    LEAD,
    REFERENCE,
    CutToLengthHarness,
    assert_state,
    near,
    ready,
    started,
)

FEEDBACK: dict[str, Any] = {"tool.mode": ToolMode.FEEDBACK}
PULL = {"gap.distance": 10.0, "gap.travel": 150.0}
OTHER_MODES = [MasterInput.END_OF_STEP, MasterInput.START_OF_STEP]


def cut(saw: CutToLengthHarness) -> tuple[int, int]:
    """How many cuts were made, and how many skipped."""
    return saw.block.statistics.cuts, saw.block.statistics.skipped


# --- 1: the start -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", OTHER_MODES)
def test_a_cycle_happens_when_it_has_to_whatever_the_step(mode: MasterInput) -> None:
    """One step over all of it: start where m = C - D = 1400, sync at 1600, the cut ends 0.25 s later."""
    saw = started(mode=mode).at(2.8)
    assert saw.state == State.WAITING
    assert cut(saw) == (1, 0)
    assert saw["local.start_time"] == near(1.4)
    assert saw["last.time"] == near(1.6)
    assert saw["tool.command_time"] == near(1.85)
    assert saw["local.home_time"] == near(HOME_AGAIN)
    assert saw["clock"] == near(2.8)
    assert saw.slave == (0.0, 0.0, 0.0)


def test_the_states_of_a_cycle_in_order() -> None:
    """Settling until 1.65, cut until 1.90, clear at 1.94, s = 440; way home 0.5 + (440 - 225) / 1500 = 0.643333."""
    saw = started({"tool.settle_time": 0.05, "tool.retract_time": 0.04})
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
    saw = started({"tool.cut_time": 0.0}).at(1.6 - JUST)
    assert saw.state == State.APPROACHING
    saw.at(1.6 + JUST)
    assert saw.state == State.RETURNING
    assert cut(saw) == (1, 0)
    assert saw["tool.command_time"] == near(1.6)
    assert not saw["tool.command"]


def test_the_factors_of_wheel_and_mitre() -> None:
    """f = 2, alpha = 60 deg: k = 4, so the carriage runs at 1000 on a line of 250. Front end at 20: B = -20 / 4 -
    4 / (2 2) = -6, p = (1500 + 4) / 2 = 752, C = 746; start at k mu = 50 - 100, m = 746 - 12.5 = 733.5, which is at
    t = 2.934; sync at 150 when m = 746 + 37.5."""
    factors = {"material_factor": 2.0, "diagonal_angle": 60.0}
    places = {"home_position": 50.0, "axis.initial_position": 50.0, "front_position": 20.0}
    saw = started({**factors, **places, "kerf": 4.0}, speed=250.0).now()
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
    saw = started({"approach.distance": 0.0, **values}).now()
    assert saw["local.approach_distance"] == near(distance)
    assert saw["local.start_position"] == near(1500.0 - distance)
    saw.at(1.8)
    assert saw["local.start_time"] == near(1.5 - 1e-3 * distance)


@pytest.mark.parametrize(("settle", "late"), [(0.475, False), (0.5, True)])
def test_after_the_arrival_the_carriage_rests_before_the_next_start(settle: float, late: bool) -> None:
    """Ready at 2.433333 + settle, past 2.9: at 2.908333 D' = 3000 - 2908.333 = 91.667 >= lead, at 2.933333 it is
    66.667 < lead: skipped. The first start needs no rest: home since initialization."""
    saw = started({"homing.settle_time": settle}).at(2.85)
    assert saw["local.start_time"] == near(1.4)
    saw.at(3.05)
    assert cut(saw) == (1, 1 if late else 0)
    assert saw["local.start_time"] == near(1.4 if late else HOME_AGAIN + 0.475)


def test_a_start_soon_after_initialization_needs_no_rest() -> None:
    saw = started({"homing.settle_time": 0.5, "length": 200.0}).at(0.15)
    assert saw.state == State.APPROACHING
    assert saw["local.start_time"] == near(0.1)


def test_a_start_that_comes_a_little_late_has_a_shorter_approach() -> None:
    """Hold ends at 1.41: D' = 1500 - 1410 = 90 >= lead, so the carriage is in sync at s = 90, m = 1590."""
    saw = started().put({"hold": True}).at(1.41).put({"hold": False}).at(1.59 - JUST)
    assert saw.state == State.APPROACHING
    saw.at(1.59 + JUST)
    assert saw.slave == near(90.0 + 1000.0 * JUST, 1000.0, 0.0)
    assert saw["local.start_time"] == near(1.41)
    saw.at(2.0)
    assert (saw["last.time"], saw["last.length"], saw["statistics.skipped"]) == near(1.59, 1500.0, 0)


def test_a_line_that_has_stopped_past_the_start_point_starts_the_carriage_when_it_moves_again() -> None:
    """It stands at 1450: D' = 50 is enough, since lead(0) = 0. It moves on with 500: m = 1450 + 250 t^2, so mu = 50 is
    reached after sqrt(100 / 250) s, at 500 sqrt(0.4) = 316.228."""
    saw = started().put({"hold": True}).at(1.45)
    saw.speed = 0.0
    saw.run(0.3).put({"hold": False}).run(0.25)
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
    saw = started().put({"hold": True}).at(1.45).put({"hold": False})
    saw.speed = -1000.0
    saw.run(0.04)
    assert saw.state == State.WAITING
    saw.speed = 1000.0
    saw.run(0.001)
    assert (saw.state, saw["local.start_time"]) == (State.APPROACHING, near(1.49))


@pytest.mark.parametrize(("reserve", "late"), [(0.0, True), (0.02, False)])
def test_an_input_that_jumps_past_the_start(reserve: float, late: bool) -> None:
    """By 0.05. D(1000) with the reserve is 1.02^1.5 lead = 89.213564; D' = 89.163564 is 1.0296 lead: on time, and the
    start is at the step's beginning. Without a reserve D' = lead - 0.05: the cut is skipped."""
    distance = LEAD * 1.02**1.5 if reserve else LEAD
    saw = started({"approach.distance": 0.0, "approach.reserve": reserve}).at(1.4)
    saw.place = 1500.0 - distance + 0.05
    saw.run(0.01)
    assert cut(saw) == (0, 1 if late else 0)
    assert saw.state == (State.WAITING if late else State.APPROACHING)
    if not late:
        assert saw["local.start_time"] == near(1.4)
        assert (distance - 0.05) / LEAD == near(1.0296, tolerance=1e-4)
        saw.to(1500.0 + distance - 0.05 + 1e-3)
        assert saw.slave == near(distance - 0.05 + 1e-3, 1000.0, 0.0)


def test_what_the_input_jumps_over_happens_before_the_commands() -> None:
    """The start point 1400 is jumped over in the step in which stop is given: the carriage has started, it cuts."""
    saw = started().at(1.39)
    saw.place = 1401.0
    saw.give("stop").run(0.01)
    assert saw.state == State.APPROACHING
    assert saw["local.start_time"] == near(1.39)


@pytest.mark.parametrize("late_mode", list(LateMode))
def test_a_cut_that_the_machine_cannot_follow(late_mode: LateMode) -> None:
    """1600 > max_velocity 1500: no approach, whatever late_mode says; with STOP_LINE fault 17, else each is skipped.
    D(1600) = lead = 0.75 1600^2 / 10000 = 192: starts would be at m = 1308, 2808."""
    saw = started({"late_mode": late_mode}, speed=1600.0).at(1300.0 / 1600.0)
    assert saw["warning.velocity"]
    assert cut(saw) == (0, 0)
    saw.at(2900.0 / 1600.0)
    if late_mode == LateMode.STOP_LINE:
        assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)
    else:
        assert (saw.state, saw["statistics.skipped"], saw["statistics.late"]) == (State.WAITING, 2, 0)
        assert saw["piece.kind"] == PieceKind.MERGED


def test_a_cycle_that_would_not_fit_into_the_stroke_is_not_begun() -> None:
    """stroke = 425 > 424.9; at 425.1 it fits."""
    for end, skipped in [(425.1, 0), (424.9, 1)]:
        saw = started({"axis.max_position": end}).at(1.5)
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
    saw = started().at(time)
    assert (*saw.slave, saw["slave.jerk"]) == near(*setpoint)
    assert saw["local.progress"] == near((time - 1.4) / 0.2)
    assert not saw["in_sync"]


def test_the_ramp_goes_by_the_master_also_when_that_speeds_up() -> None:
    """By 200 from m = 1400 on: v^2 = 1e6 + 2 200 100 at u = 1/2, after (v - 1000) / 200 s. s = 18.75, s' = 1/2, s'' =
    1.5 / 200: velocity v / 2, acceleration s'' v^2 + 200 s' = 7800 + 100."""
    saw = started().at(1.4)
    speed = sqrt(1.04e6)
    saw.run((speed - 1000.0) / 200.0, acceleration=200.0)
    assert saw.slave == near(18.75, 0.5 * speed, 7900.0)


def test_a_line_that_turns_back_past_the_start_takes_the_carriage_home() -> None:
    """From 1450 on (t = 1.45) it brakes with 20000: stop at 1475 after 0.05 s; back at 1400 where -50 = 1000 t - 10000
    t^2, t = (1000 + sqrt(3e6)) / 20000. The tool was commanded at mu + 0.16 v = 100, m = 1440; it is taken back before
    it touches at 1.6."""
    saw = started({"tool.on_delay": 0.16}).at(1.45)
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
    assert (saw["last.length"], cut(saw)) == (near(1500.0), (1, 0))


def test_rounding_of_the_inputs_is_no_turning_back() -> None:
    saw = started().at(1.4 + 1e-12)
    assert saw.state == State.APPROACHING
    saw.place = 1400.0 - 1e-9
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
    saw = started({"tool.settle_time": settle, "tool.on_delay": delay}).at(command - JUST)
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
    assert (saw["tool.command"], saw["tool.cutting"], cut(saw)) == (True, True, (0, 0))
    saw.at(begin + 0.25 + JUST)
    assert (saw["tool.command"], saw["tool.cutting"], cut(saw)) == (False, False, (1, 0))
    assert saw["tool.command_time"] == near(begin + 0.25)
    assert saw["last.time"] == near(1.6)
    assert not saw["warning.any"]


def test_a_blade_that_touches_before_sync_is_told_and_counted() -> None:
    """Commanded at mu + 0.08 v = 100, m = 1520; the line slows down to 500: in sync after 80 / 500 = 0.16 s, the blade
    touches after 0.08 s. The cut begins in sync, at 1.68."""
    saw = started({"tool.on_delay": 0.08}).at(1.52 + JUST)
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
    assert cut(saw) == (2, 0)
    assert (saw["warning.blade_early"], saw["statistics.unsynchronised"]) == (False, 1)


def test_a_blade_that_touches_later_than_sync_is_waited_for() -> None:
    """Commanded at m = 1520, t = 1.52, while the line speeds up to 1250: in sync at 1.52 + 80 / 1250 = 1.584, but the
    blade touches at 1.6."""
    saw = started({"tool.on_delay": 0.08}).at(1.52 + 1e-9)
    saw.speed = 1250.0
    assert_state(saw, 1.584, State.APPROACHING, State.SYNCHRONOUS)
    assert_state(saw, 1.6, State.SYNCHRONOUS, State.CUTTING)
    assert_state(saw, 1.85, State.CUTTING, State.RETURNING)
    assert saw["last.time"] == near(1.584, tolerance=1e-8)


# --- 4: the end of the cut --------------------------------------------------------------------------------------------


def test_the_cut_ends_by_distance() -> None:
    """200 at 1000 take 0.2 s. The line stands for 1 s in between: the cut goes on with it."""
    values: dict[str, Any] = {"tool.mode": ToolMode.DISTANCE, "tool.cut_distance": 200.0}
    saw = started(values).at(1.7)
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
    saw = started(values).at(1.65)
    saw.speed = -1000.0
    saw.run(0.1)
    assert saw.state == State.CUTTING
    assert saw.slave == near(50.0, -1000.0, 0.0)
    saw.speed = 1000.0
    assert_state(saw, 2.0, State.CUTTING, State.RETURNING)  # from m = 1550 to 1800
    assert saw["last.length"] == near(1500.0)


def test_the_time_of_a_cut_goes_on_while_the_line_stands() -> None:
    saw = started().at(1.7)
    saw.speed = 0.0
    assert_state(saw, 1.85, State.CUTTING, State.RETURNING)
    assert saw["last.length"] == near(1500.0)


def test_the_cut_ends_by_feedback() -> None:
    """An edge before the cut is lost."""
    saw = started(FEEDBACK).at(1.5).give("tool.done").at(1.7)
    assert saw.state == State.CUTTING
    saw.give("tool.done").now()
    assert saw.state == State.RETURNING
    assert saw["tool.command_time"] == near(1.7)
    assert saw["last.time"] == near(1.6)


def test_the_books_are_kept_when_the_cut_ends() -> None:
    saw = started({"tool.retract_time": 0.1}).at(1.85 - JUST)
    assert (saw["next_cut.position"], cut(saw)) == (near(1500.0), (0, 0))
    assert saw["last.kind"] == PieceKind.NONE
    saw.at(1.85 + JUST)
    assert (saw["next_cut.position"], cut(saw)) == (near(3000.0), (1, 0))
    assert (saw["last.kind"], saw["last.good"]) == (PieceKind.PRODUCT, True)
    assert (saw["last.length"], saw["last.error"]) == near(1500.0, 0.0)
    assert saw["last.reserve"] == 1.0
    assert saw["statistics.length_good"] == near(1500.0)


def test_the_reserve_of_a_cycle() -> None:
    """From 1.4 to 2.9 the carriage is at home and ready since 2.433333 + 0.1: (2.9 - 2.533333) / 1.5."""
    saw = started({"homing.settle_time": 0.1}).at(3.5)
    assert saw["last.reserve"] == near((2.9 - HOME_AGAIN - 0.1) / 1.5)
    assert saw["statistics.reserve_worst"] == near((2.9 - HOME_AGAIN - 0.1) / 1.5)


# --- 5: the gap -------------------------------------------------------------------------------------------------------


def test_the_carriage_pulls_a_gap() -> None:
    """T = 150 / 1000 = 0.15 s; half way s = 350 + 75 + 5, v = 1000 + 1.875 10 / 0.15 = 1125; ahead by 10 at 2.0, s =
    510; still so in CLEARING. The way home is 0.5 + (560 - 225) / 1500."""
    saw = started({**PULL, "tool.retract_time": 0.05}).at(1.85 + JUST)
    assert (saw.state, saw["tool.command"], cut(saw)) == (State.PULLING, True, (1, 0))
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
    saw = started({**PULL, "gap.travel": 140.0}).at(1.86)
    assert (saw.state, saw["warning.gap_skipped"], saw["tool.command"]) == (State.RETURNING, True, False)
    assert saw["tool.command_time"] == near(1.85)
    saw.at(3.34)
    assert saw["warning.gap_skipped"]
    saw.put({"gap.distance": 0.0}).at(4.9)  # a cycle keeps the values that it began with: the next has none
    assert not saw["warning.gap_skipped"]


def test_no_gap_is_pulled_while_the_line_stands() -> None:
    saw = started(PULL).at(1.8)
    saw.speed = 0.0
    saw.at(1.86)
    assert (saw.state, saw["warning.gap_skipped"]) == (State.RETURNING, True)


# --- 6 and 7: the way home --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("time", "setpoint"),
    [
        (1.9, (350.0 + 50.0 - 200000.0 * 0.05**3 / 6.0, 750.0, -10000.0)),  # jerk -200000 for 0.05 s
        (2.15, (275.0, -1500.0, 0.0)),  # after R(2500) = 0.3 s: 350 - 250 0.3
        (2.2, (200.0, -1500.0, 0.0)),
        (2.2333333333333333, (150.0, -1500.0, 0.0)),  # 750 R(1500) before home
    ],
)
def test_the_way_home_is_the_fastest_move(time: float, setpoint: tuple[float, ...]) -> None:
    saw = started().at(time)
    assert saw.state == State.RETURNING
    assert saw.slave == near(*setpoint, tolerance=1e-8)


def test_the_way_home_has_limits_of_its_own() -> None:
    """600 u/s, 5000 and 8000 u/s2, 100000 u/s3: R(1600; 5000) = 0.37; R(600; 8000) = 2 sqrt(600 / 100000) = r, since
    600 < 8000^2 / 100000. G = -200 0.37 + 300 r, T_r = 0.37 + r + (350 - G) / 600."""
    r = 2.0 * sqrt(0.006)
    way = 0.37 + r + (350.0 + 74.0 - 300.0 * r) / 600.0
    limits = {"velocity": 600.0, "acceleration": 5000.0, "deceleration": 8000.0, "jerk": 100000.0}
    saw = started({f"homing.{name}": value for name, value in limits.items()}).at(3.05)
    assert saw["local.home_time"] == near(1.85 + way)
    assert saw["limits.cycle_time"] == near(0.45 + way)


EASE: dict[str, Any] = {"homing.ease": True, "length": 3000.0}
# L = 3000, cut ends at 3.35, s = 350. T_b = R(1000) = 0.15, S_b = 425, T_0 = 2 R(1500) + (425 - 300) / 1500 = 0.483333.
# A = 5.9 - 3.35 - 0.02 = 2.53: sigma = T_0 / (A - T_b) = 0.203081; peak 1500 sigma.
SHARE = (0.4 + 125.0 / 1500.0) / 2.38


def test_an_eased_way_home_arrives_just_in_time() -> None:
    saw = started(EASE).at(3.5)
    assert saw.slave == near(425.0, 0.0, 0.0)
    assert saw["local.ease"] == near(SHARE)
    saw.at(3.5 + 0.2 / SHARE)  # the acceleration, R(1500) = 0.2 s, takes so much longer
    assert saw.slave == near(275.0, -1500.0 * SHARE, 0.0)
    assert_state(saw, 5.88, State.RETURNING, State.WAITING)
    assert saw["local.home_time"] == near(5.88)
    saw.at(6.5)
    assert (saw["last.length"], cut(saw)) == (near(3000.0), (2, 0))


def test_an_eased_way_home_is_no_slower_than_the_slowest() -> None:
    """At least half of the limits: home 0.483333 / 0.5 s after 3.5."""
    saw = started({**EASE, "homing.slowest": 0.5}).at(4.6)
    assert saw["local.home_time"] == near(3.5 + 2.0 * (0.4 + 125.0 / 1500.0))


def test_without_time_to_spare_the_way_home_is_the_fast_one() -> None:
    """L = 1100: A = (2100 - 1450) / 1000 - 0.02 = 0.63 < T_b + T_0 = 0.633333."""
    saw = started({**EASE, "length": 1100.0}).at(2.1)
    assert saw["local.home_time"] == near(1.45 + 0.583333333333)
    assert saw["local.ease"] == 1.0


@pytest.mark.parametrize("why", ["speed", "acceleration", "length", "cut_now"])
def test_an_eased_way_home_ends_when_there_is_no_longer_time(why: str) -> None:
    saw = started({**EASE, "change_mode": 2}).at(3.8)
    assert saw["local.ease"] == near(SHARE)
    position = saw.slave[0]
    if why == "speed":
        saw.speed = 1001.0
    elif why == "length":
        saw.put({"length": 2900.0})
    elif why == "cut_now":
        saw.give("cut_now")
    saw.run(0.2, acceleration=10.0 if why == "acceleration" else 0.0)
    assert saw["local.ease"] == 1.0
    assert saw.slave[1] < -1000.0
    assert saw.slave[0] < position


def test_a_line_that_slows_down_leaves_the_eased_way_home_as_it_is() -> None:
    saw = started(EASE).at(3.8).run(0.5, acceleration=-100.0)
    assert saw["local.ease"] == near(SHARE)
    saw.at(5.9)
    assert saw["local.home_time"] == near(5.88)


def test_after_stop_the_way_home_is_not_eased() -> None:
    saw = started(EASE).at(3.0).give("stop").at(4.0)
    assert saw["local.home_time"] == near(3.35 + 0.583333333333)


# --- 8: the ends of the stroke ----------------------------------------------------------------------------------------


def test_the_end_of_the_stroke() -> None:
    """Nobody says that the cut is through. The stop from 1000 takes 500 R(1000) = 75: at s = 575, t = 2.075, the
    carriage turns round. It would stop at 650; since it goes on backwards at once, it turns at 575 + 50 - 4.1667 +
    750^2 / 20000 = 648.96."""
    saw = started(FEEDBACK).at(2.075 - JUST)
    assert (saw.state, saw["error"]) == (State.CUTTING, False)
    saw.at(2.075 + JUST)
    assert (saw.state, saw["error_id"], saw["running"]) == (State.FAULT, Fault.STROKE, False)
    assert (saw["tool.command"], saw["statistics.unsynchronised"], cut(saw)) == (False, 1, (0, 0))
    assert saw["line.stop_request"]
    assert saw["line.velocity_request"] == 0.0
    saw.at(2.075 + 0.05 + 0.075)
    assert saw.slave == near(575.0 + 50.0 - 200000.0 * 0.05**3 / 6.0 + 28.125, 0.0, -10000.0, tolerance=1e-8)
    saw.at(3.0)
    assert saw.slave == (0.0, 0.0, 0.0)
    assert saw.state == State.FAULT


def test_the_lower_end_of_the_stroke() -> None:
    """The line takes the carriage back with 500: 250 R(500) = 25, so it turns round at -225."""
    values: dict[str, Any] = {"tool.mode": ToolMode.DISTANCE, "tool.cut_distance": 200.0}
    saw = started(values).at(1.7)
    saw.speed = -500.0
    saw.at(1.7 + (200.0 + 225.0) / 500.0 - JUST)
    assert saw.state == State.CUTTING
    saw.run(2.0 * JUST)
    assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)
    lowest = min(row["slave.position"] for row in saw.rows(1.0, cuts=[0.01 * i for i in range(1, 100)]).values())
    assert -250.0 <= lowest < -240.0


def test_the_end_of_the_stroke_on_a_line_that_speeds_up() -> None:
    """The reference machine, cut_time 0.45, 400 u/s2 from 1.75 s on, start at 0.2 s."""
    saw = CutToLengthHarness({**REFERENCE, "tool.cut_time": 0.45, "length": 1500.0}, speed=1000.0)
    saw.at(0.2).give("start").at(1.75)
    rows = saw.rows(1.5, acceleration=400.0, cuts=[0.01 * i for i in range(1, 150)])
    assert saw["error_id"] == Fault.STROKE
    assert 600.0 < max(row["slave.position"] for row in rows.values()) <= 650.0


# --- 9: a line that stands --------------------------------------------------------------------------------------------


def test_a_standing_line_is_cut_where_it_stands() -> None:
    """m = 500, h = 20: C = 480, in sync at once; the piece from B = 0 is 480 long."""
    saw = started({"home_position": 20.0, "axis.initial_position": 20.0}).at(0.5)
    saw.speed = 0.0
    saw.run(0.1).give("cut_now").now()
    assert (saw.state, saw["in_sync"], saw["tool.command"]) == (State.CUTTING, True, True)
    assert saw.slave == (20.0, 0.0, 0.0)
    saw.at(0.85 + JUST)
    assert saw["last.kind"] == PieceKind.SHORT
    assert saw["last.length"] == near(480.0)
    assert saw["last.time"] == near(0.6)
    assert saw.state in (State.RETURNING, State.WAITING)


# --- what is shown meanwhile ------------------------------------------------------------------------------------------


def test_how_far_it_is_to_the_next_cut() -> None:
    """C = 1500, sync at m = 1600."""
    saw = ready()
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


def test_positions_wrap_with_the_masters_period() -> None:
    """P = 700: C = 1500 is 100; start at 1400, which is 0."""
    saw = started({"master.period": 700.0}).at(0.4)
    assert saw["next_cut.position"] == near(100.0)
    for i in range(1, 30):
        saw.at(0.4 + 0.1 * i)
    assert saw["local.start_time"] == near(2.9)
    assert saw["last.length"] == near(1500.0)
    assert saw["last.time"] == near(1.6)
    assert saw["next_cut.position"] == near(3000.0 - 4.0 * 700.0)
