"""The Gearing, rule by rule with numbers by hand: engaging, disengaging, edges, ratios, periods, faults."""

import math
from typing import Any

import pytest

from motionsync.gearing.block import Gearing
from motionsync.gearing.curves import gear_in_curve, gear_out_curve
from motionsync.gearing.faults import Fault, Refusal
from motionsync.gearing.interface import StartMode, State, StopMode, Transition
from motionsync.gearing.line import Line, direction_of
from motionsync.grid import first_ahead, nearest
from motionsync.master import MasterInput
from motionsync_fmu.interface.variables import variables
from tests.model.gearing.harness import Gear
from tests.support.harness import grid

NONE, MASTER, TIME = Transition.NONE, Transition.MASTER_BASED, Transition.TIME_BASED
STOPPED, WAITING, GEAR_IN, ACTIVE = State.STOPPED, State.WAITING_FOR_STARTPOSITION, State.GEAR_IN, State.ACTIVE
LEAVING, GEAR_OUT = State.WAITING_FOR_STOPPOSITION, State.GEAR_OUT
INSTANT = 2.0**-40  # s, a step in which nothing moves
CW, CCW, BOTH = (
    StartMode.WITH_CW_REFERENCE_POSITION,
    StartMode.WITH_CCW_REFERENCE_POSITION,
    StartMode.WITH_CW_CCW_REFERENCE_POSITION,
)


def near(*values: float, tolerance: float = 1e-9) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def three_halves(**values: Any) -> dict[str, Any]:
    return {"gearing.numerator": 3, "gearing.denominator": 2, **values}


def in_gear(*, place: float = 0.0, speed: float = 10.0, **values: Any) -> Gear:
    """At once, through (place, 0), 3 : 2; an INSTANT later."""
    gear = Gear(three_halves(**values), place=place, speed=speed)
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=NONE).run(INSTANT)
    assert gear.state == ACTIVE
    return gear


# --- laws -------------------------------------------------------------------------------------------------------------


def test_the_curve_on_to_the_line_and_the_one_off_it() -> None:
    assert gear_in_curve(0.0, 8.0) == (0.0, 0.0, 0.0, 6.0 / 64.0)
    assert gear_in_curve(4.0, 8.0) == (0.75, 0.5, 1.5 / 8.0, 0.0)  # 8 (1/8 - 1/32), 3/4 - 1/4, 6 (1/2 - 1/4)
    assert gear_in_curve(8.0, 8.0) == (4.0, 1.0, 0.0, -6.0 / 64.0)
    assert gear_out_curve(0.0, 8.0) == (0.0, 1.0, 0.0, -6.0 / 64.0)
    assert gear_out_curve(4.0, 8.0) == (3.25, 0.5, -1.5 / 8.0, 0.0)
    assert gear_out_curve(8.0, 8.0) == (4.0, 0.0, 0.0, 6.0 / 64.0)
    assert gear_in_curve(9.0, 8.0)[0] == gear_out_curve(9.0, 8.0)[0] == 4.0
    assert gear_in_curve(-1.0, 8.0)[0] == gear_out_curve(-1.0, 8.0)[0] == 0.0


def test_the_line_reckons_numerator_first() -> None:
    line = Line(7, -3, 1.0, 100.0)
    assert line.at(1.3) == 100.0 + 7 * (1.3 - 1.0) / -3
    assert line.unscaled(line.scaled(6.0)) == 6.0


def test_places_on_a_grid() -> None:
    assert [first_ahead(1.0, 10.0, 1.0, x, True) for x in (1.0, 1.1, 11.0, -8.9)] == [1.0, 11.0, 11.0, 1.0]
    assert [first_ahead(1.0, 10.0, -1.0, x, True) for x in (1.0, 0.9, 11.0, -8.9)] == [1.0, -9.0, 11.0, -9.0]
    assert [first_ahead(1.0, 10.0, way, 1.0, False) for way in (1.0, -1.0)] == [11.0, -9.0]
    assert first_ahead(1.0, 0.0, 1.0, 5.0, True) == 1.0
    assert [nearest(1.0, 10.0, x) for x in (5.9, 6.1, -4.1)] == [1.0, 11.0, -9.0]
    assert nearest(1.0, 0.0, 99.0) == 1.0


def test_a_direction_is_that_of_the_velocity_or_at_standstill_of_the_acceleration() -> None:
    assert [direction_of(v, a) for v, a in [(2.0, -1.0), (-2.0, 1.0), (0.0, 1.0), (0.0, -1.0), (0.0, 0.0)]] == [
        *(1.0, -1.0, 1.0, -1.0, 0.0)
    ]


# --- engaging: reference position -------------------------------------------------------------------------------------


def referred(speed: float = 10.0, place: float = 0.0, mode: StartMode = CW, **values: Any) -> Gear:
    """Waiting for 40 + 10, with a transition of 20; the slave at 7, 3 : 2."""
    gear = Gear(three_halves(**{"slave.initial_position": 7.0}), place=place, speed=speed)
    return gear.start(start_mode=mode, reference_position=40.0, offset=10.0, **{"distance": 20.0, **values})


def test_a_master_based_transition_lies_round_the_reference_position() -> None:
    gear = referred().run(3.9)
    assert gear.state == WAITING
    assert gear["local.trigger_position"] == 40.0
    assert gear["local.line_offset"] == 7.0 - 1.5 * 50.0
    assert gear.slave == (7.0, 0.0, 0.0)
    gear.to(45.0)  # u = 1/4
    assert gear.state == GEAR_IN
    assert gear["local.progress"] == near(0.25)
    assert gear.slave == near(7.0 + 30.0 * (1 / 64 - 1 / 512), 15.0 * (3 / 16 - 2 / 64), 1.5 * (6 / 4 - 6 / 16) * 5.0)
    assert gear["slave.jerk"] == near(1.5 * (6.0 - 3.0) * 1000.0 / 400.0)
    gear.to(59.9)
    assert gear.state == GEAR_IN
    gear.to(61.0)
    assert gear.state == ACTIVE
    assert gear["in_gear"]
    assert gear["local.progress"] == 1.0
    assert gear.slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_without_transition_the_velocity_jumps_where_the_reference_position_is_crossed() -> None:
    gear = referred(transition=NONE).run(4.99)
    assert gear.state == WAITING
    assert gear.slave == (7.0, 0.0, 0.0)
    gear.run(0.02)
    assert gear.state == ACTIVE
    assert gear.slave == near(7.0 + 1.5 * 0.1, 15.0, 0.0)


def test_a_distance_of_0_is_no_transition() -> None:
    assert referred(distance=0.0).run(4.99).state == WAITING
    assert referred(distance=0.0).run(5.01).slave == near(7.15, 15.0, 0.0)


@pytest.mark.parametrize(
    ("mode", "speed", "place", "engages"),
    [
        (CW, 10.0, 0.0, True),
        (CW, -10.0, 100.0, False),
        (CCW, -10.0, 100.0, True),
        (CCW, 10.0, 0.0, False),
        (BOTH, 10.0, 0.0, True),
        (BOTH, -10.0, 100.0, True),
    ],
)
@pytest.mark.parametrize("transition", [NONE, MASTER])
def test_the_master_has_to_cross_in_the_configured_direction(
    mode: StartMode, speed: float, place: float, engages: bool, transition: Transition
) -> None:
    gear = referred(speed, place, mode, transition=transition).run(3.9)
    assert gear.state == WAITING
    gear.run(0.2)
    assert gear.state == (GEAR_IN if engages and transition == MASTER else WAITING)
    gear.run(2.0)
    assert gear.state == (ACTIVE if engages else WAITING)
    if engages:
        assert gear.slave == near(7.0 + 1.5 * (gear.place - 50.0), 1.5 * speed, 0.0)


def test_downwards_the_trigger_lies_above_and_the_curve_leads_down() -> None:
    gear = referred(-10.0, 100.0, BOTH).run(3.9)
    assert gear["local.trigger_position"] == 60.0
    gear.to(55.0)
    assert gear.slave == near(7.0 - 30.0 * (1 / 64 - 1 / 512), -15.0 * (3 / 16 - 2 / 64), -1.5 * (9 / 8) * 5.0)


def test_either_way_the_trigger_that_is_crossed_first_decides() -> None:
    gear = referred(10.0, 41.0, BOTH).run(1.0)  # upwards it is too late; turn above the other trigger
    assert gear.state == WAITING
    gear.run(2.0).put({})
    gear.speed = -10.0
    gear.to(59.0)
    assert gear.state == GEAR_IN


def test_a_missed_window_is_no_fault() -> None:
    gear = referred(10.0, 41.0).run(5.0)
    assert (gear.state, gear["error"]) == (WAITING, False)
    gear.speed = -10.0
    gear.to(39.0)
    gear.speed = 10.0
    gear.to(61.0)
    assert gear.slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_being_on_the_trigger_and_moving_that_way_counts() -> None:
    assert referred(10.0, 40.0).run(INSTANT).state == GEAR_IN
    assert referred(0.0, 40.0).run(1.0).state == WAITING
    assert referred(0.0, 40.0).run(1.0, acceleration=1.0).state == GEAR_IN
    assert referred(0.0, 40.0).run(1.0, acceleration=-1.0).state == WAITING
    assert referred(10.0, 30.0).run(1.0).state == GEAR_IN  # at the step's end


@pytest.mark.parametrize("cuts", [[], [1.0], grid(2.0, 0.25)])
@pytest.mark.parametrize(("place", "speed"), [(35.0, 10.0), (45.0, -10.0)])
def test_turning_exactly_on_the_trigger_does_not_count(cuts: list[float], place: float, speed: float) -> None:
    gear = referred(speed, place).run(2.0, acceleration=-speed, cuts=cuts)
    assert gear.place == place
    assert gear.state == WAITING
    gear.speed = 0.0
    assert gear.run(1.0).state == WAITING


@pytest.mark.parametrize("h", [10.0, 3.0, 0.3, 0.01])
def test_the_whole_transition_may_lie_in_one_step(h: float) -> None:
    gear = referred().run(10.0, cuts=grid(10.0, h))
    assert gear.slave == near(7.0 + 1.5 * 50.0, 15.0, 0.0)


# --- engaging: direct -------------------------------------------------------------------------------------------------


def direct(mode: StartMode, speed: float, **values: Any) -> Gear:
    gear = Gear(three_halves(**{"slave.initial_position": 7.0}), place=5.0, speed=speed)
    return gear.start(start_mode=mode, **{"distance": 20.0, **values})


@pytest.mark.parametrize(
    ("mode", "speed", "state"),
    [
        (StartMode.CW_DIRECT, 10.0, GEAR_IN),
        (StartMode.CW_DIRECT, 0.0, WAITING),
        (StartMode.CW_DIRECT, -10.0, WAITING),
        (StartMode.CCW_DIRECT, -10.0, GEAR_IN),
        (StartMode.CCW_DIRECT, 0.0, WAITING),
        (StartMode.CW_CCW_DIRECT, 10.0, GEAR_IN),
        (StartMode.CW_CCW_DIRECT, -10.0, GEAR_IN),
        (StartMode.CW_CCW_DIRECT, 0.0, GEAR_IN),
    ],
)
def test_direct_begins_at_the_edge_if_the_master_moves_as_it_has_to(
    mode: StartMode, speed: float, state: State
) -> None:
    for transition, reached in [(MASTER, state), (TIME, state), (NONE, ACTIVE if state == GEAR_IN else state)]:
        gear = direct(mode, speed, transition=transition).run(0.01)
        assert gear.state == reached
        assert gear["local.progress"] == near(
            {GEAR_IN: abs(speed) * 0.01 / 20.0, ACTIVE: 1.0, WAITING: 0.0}[reached]
        ) or (transition == TIME)


def test_direct_and_master_based_the_line_is_moved_by_half_the_distance() -> None:
    gear = direct(StartMode.CW_DIRECT, 10.0).run(1.0)
    assert gear["local.trigger_position"] == 5.0
    assert gear["local.line_offset"] == 7.0 - 1.5 * 15.0
    assert gear.slave == near(7.0 + 30.0 * (1 / 8 - 1 / 32), 7.5, 1.5 * 1.5 * 5.0)
    assert gear.run(2.0).slave == near(7.0 + 1.5 * (35.0 - 15.0), 15.0, 0.0)


def test_direct_waits_for_the_master_to_turn() -> None:
    gear = direct(StartMode.CW_DIRECT, -10.0).run(3.0, acceleration=5.0)  # turns after 2 s at 5 - 10
    assert gear.state == GEAR_IN
    assert gear["local.trigger_position"] == near(-5.0)
    u = 2.5 / 20.0
    assert gear.slave[0] == near(7.0 + 30.0 * (u**3 - u**4 / 2))


def test_at_rest_either_way_the_first_motion_gives_the_direction() -> None:
    gear = direct(StartMode.CW_CCW_DIRECT, 0.0).run(1.0)
    assert (gear.state, gear["local.progress"], gear.slave) == (GEAR_IN, 0.0, (7.0, 0.0, 0.0))
    gear.run(2.0, acceleration=-5.0)
    assert gear.slave[0] == near(7.0 - 30.0 * (1 / 8 - 1 / 32))
    assert gear["local.line_offset"] == near(7.0 + 1.5 * 5.0)  # through (5 - 10, 7)


def test_direct_without_transition_is_in_gear_at_once_even_at_rest() -> None:
    gear = direct(StartMode.CW_CCW_DIRECT, 0.0, transition=NONE).run(1.0)
    assert (gear.state, gear.slave) == (ACTIVE, (7.0, 0.0, 0.0))
    assert gear.run(1.0, acceleration=2.0).slave == near(8.5, 3.0, 3.0)


# --- engaging: in time ------------------------------------------------------------------------------------------------


def timed(missing: float, speed: float = 10.0, **values: Any) -> Gear:
    """T = 2 s, v T = 20; the reference position is `missing` ahead of the master; 3 : 2."""
    gear = Gear(three_halves(), place=100.0, speed=speed)
    return gear.start(transition=TIME, time=2.0, reference_position=100.0 + missing, **values)


@pytest.mark.parametrize(
    ("share", "coefficients"),
    [(0.7, (-1.0, 2.5, -1.2)), (0.5, (1.0, -0.5, 0.0)), (0.3, (3.0, -3.5, 1.2)), (-0.2, (8.0, -11.0, 4.2))],
)
@pytest.mark.parametrize("u", [0.25, 0.5, 0.75])
def test_in_time_at_constant_speed(share: float, coefficients: tuple[float, ...], u: float) -> None:
    """c3 = 10 A - 4 B, c4 = -15 A + 7 B, c5 = 6 A - 3 B of v T, with A = 1 - share, B = 1."""
    gear = timed(20.0 * share).run(2.0 * u)
    c3, c4, c5 = coefficients
    assert gear.state == GEAR_IN
    assert gear["local.progress"] == u
    assert gear["local.trigger_position"] == 100.0
    assert gear.slave == near(
        30.0 * (c3 * u**3 + c4 * u**4 + c5 * u**5),
        15.0 * (3 * c3 * u**2 + 4 * c4 * u**3 + 5 * c5 * u**4),
        7.5 * (6 * c3 * u + 12 * c4 * u**2 + 20 * c5 * u**3),
    )
    gear.run(2.0 * (1.0 - u) + 1.0)
    assert gear.state == ACTIVE
    assert gear.slave == near(1.5 * (30.0 - 20.0 * share), 15.0, 0.0)


@pytest.mark.parametrize(
    ("share", "backwards", "faster"),
    [(0.61, True, False), (0.6, False, False), (0.5, False, False), (0.4, False, False), (0.39, False, True)],
)
def test_in_time_the_three_shapes(share: float, backwards: bool, faster: bool) -> None:
    rows = timed(20.0 * share).rows(2.0, cuts=grid(2.0, 0.01)).values()
    assert (min(row["slave.velocity"] for row in rows) < -1e-9) == backwards
    assert (max(row["slave.velocity"] for row in rows) > 15.0 + 1e-9) == faster


def test_in_time_it_begins_when_the_master_moves_that_way() -> None:
    assert timed(10.0, 0.0).run(1.0).state == WAITING
    assert timed(10.0, -1.0).run(1.0).state == WAITING
    assert timed(10.0, -1.0, start_mode=CCW).run(1.0).state == GEAR_IN
    assert timed(10.0, 0.0, start_mode=BOTH).run(1.0).state == WAITING
    assert timed(10.0, 0.0, start_mode=BOTH).run(0.1, acceleration=-1.0).state == GEAR_IN
    gear = timed(10.0, -10.0).run(1.75, acceleration=10.0)  # turns after 1 s at 95
    assert gear.state == GEAR_IN
    assert gear["local.trigger_position"] == near(95.0)
    assert gear["local.progress"] == near(0.375)


@pytest.mark.parametrize("acceleration", [0.0, 3.0, -5.0, -15.0])
@pytest.mark.parametrize("missing", [-5.0, 0.0, 10.0])
def test_in_time_the_slave_is_on_the_line_at_the_end_whatever_the_master_does(
    acceleration: float, missing: float
) -> None:
    gear = timed(missing).run(1.0, acceleration=acceleration).run(0.5, acceleration=-acceleration).run(0.6)
    assert gear.state == ACTIVE
    assert gear.slave == near(1.5 * (gear.place - 100.0 - missing), 1.5 * gear.speed, 0.0)


def test_in_time_and_accelerated_it_begins_at_rest() -> None:
    gear = timed(10.0, 10.0).run(INSTANT, acceleration=4.0)
    assert gear.slave == near(0.0, 0.0, 0.0, tolerance=1e-7)


def test_in_time_at_rest_and_direct_either_way_it_begins_at_once() -> None:
    gear = Gear(three_halves()).start(start_mode=StartMode.CW_CCW_DIRECT, transition=TIME, time=2.0).run(0.5)
    assert (gear.state, gear["local.progress"]) == (GEAR_IN, 0.25)
    assert gear.run(1.5).state == ACTIVE


# --- engaging: at the last synchronous point --------------------------------------------------------------------------


def continuing(**values: Any) -> Gear:
    """The slave has left the line through (0, 0) at (0, 0) and rests 1.5 * 10 further, with the master at 20."""
    gear = in_gear().stop(distance=20.0).to(20.0)
    gear.run(INSTANT)
    assert gear.slave == near(15.0, 0.0, 0.0)
    return gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, **{"transition": MASTER, "distance": 4.0, **values})


def test_it_continues_on_the_line_through_the_last_synchronous_point() -> None:
    gear = continuing()
    gear.speed = -10.0
    gear.to(12.5)
    assert gear["local.trigger_position"] == near(12.0)  # the line has the slave at 15 with the master at 10
    assert gear.to(11.0).state == GEAR_IN
    assert gear.to(6.0).slave == near(1.5 * 6.0, -15.0, 0.0)


def test_it_continues_in_time_on_that_line() -> None:
    gear = continuing(transition=TIME, time=1.0).run(1.5)
    assert gear.slave == near(1.5 * gear.place, 15.0, 0.0)


def test_it_continues_at_once_where_the_slave_is_on_the_line_already() -> None:
    gear = Gear({"slave.initial_position": 7.0})
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert (gear.state, gear.slave) == (ACTIVE, (7.0, 0.0, 0.0))  # at rest; initially (0, initial_position)
    near_by = Gear(place=1e-10).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert near_by.state == ACTIVE
    far = Gear(place=1e-8).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert far.state == WAITING
    waits = Gear().start(start_mode=StartMode.CONTINUE_SYNCHRONIZED).run(1.0)
    assert waits.state == WAITING


def test_both_halves_of_the_synchronous_point_can_be_set_while_inactive() -> None:
    gear = Gear(three_halves(activate=False), speed=10.0)
    gear.put({"set_master.execute": True, "set_master.value": 40.0, "set_slave.execute": True, "set_slave.value": 6.0})
    gear.run(0.1)
    assert gear.slave == (6.0, 0.0, 0.0)
    gear.put({"set_slave.execute": False}).run(0.1).put({"set_slave.execute": True, "set_slave.value": 9.0}).run(0.1)
    gear.put({"set_master.value": 70.0, "activate": True}).run(0.1)
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, distance=20.0).run(0.1)
    assert gear["local.trigger_position"] == near(30.0)
    assert gear.to(60.0).slave == near(9.0 + 1.5 * 20.0, 15.0, 0.0)


def test_the_synchronous_point_is_not_set_while_active() -> None:
    gear = Gear().put({"set_slave.execute": True, "set_slave.value": 6.0}).run(0.1)
    assert gear.slave[0] == 0.0
    assert gear.put({"activate": False}).run(0.1).slave[0] == 0.0  # no edge


# --- master and slave with periods ------------------------------------------------------------------------------------


def rotary(place: float, speed: float, **values: Any) -> Gear:
    return Gear(three_halves(**{"master.period": 360.0, **values}), place=place, speed=speed)


@pytest.mark.parametrize(("place", "trigger"), [(30.0, 40.0), (41.0, 400.0), (700.0, 760.0), (-500.0, -320.0)])
def test_each_occurrence_of_the_reference_position_counts(place: float, trigger: float) -> None:
    gear = rotary(place, 10.0).start(reference_position=50.0, distance=20.0).run(INSTANT)
    assert gear["local.trigger_position"] == near(40.0)
    gear.to(trigger - 0.1)
    assert gear.state == WAITING
    gear.to(trigger + 0.1)
    assert gear.state == GEAR_IN
    assert gear.to(trigger + 30.0).slave == near(1.5 * 20.0, 15.0, 0.0)


@pytest.mark.parametrize(("place", "missing"), [(30.0, 20.0), (50.0, 0.0), (51.0, 359.0), (-311.0, 1.0)])
def test_in_time_the_next_occurrence_is_meant(place: float, missing: float) -> None:
    gear = rotary(place, 10.0).start(reference_position=50.0, transition=TIME, time=1.0).run(2.0)
    assert gear.slave == near(1.5 * (20.0 - missing), 15.0, 0.0)


def test_the_synchronous_point_recurs_too() -> None:
    gear = rotary(0.0, 10.0).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, distance=20.0).run(INSTANT)
    assert gear.to(349.0).state == WAITING
    assert gear.to(380.0).slave == near(30.0, 15.0, 0.0)
    at_once = rotary(720.0, 0.0).start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(1.0)
    assert at_once.state == ACTIVE


def test_a_slave_with_a_period_is_put_out_in_it() -> None:
    gear = rotary(0.0, 100.0, **{"slave.period": 90.0, "slave.initial_position": 100.0})
    assert gear.slave[0] == 10.0
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(40.0, cuts=grid(40.0, 0.7))
    assert gear.slave == near((10.0 + 6000.0) % 90.0, 150.0, 0.0)


def test_over_many_turns_nothing_is_lost() -> None:
    """400000 turns of the master, 3 to 4: the last bit of 1/8 is still there."""
    gear = rotary(0.125, 36000.0, **{"slave.period": 90.0, "gearing.denominator": 4})
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(4000.0, cuts=grid(4000.0, 0.5))
    assert gear.slave[0] == 0.0
    assert gear["local.line_offset"] == -0.09375


def test_a_stop_position_means_any_occurrence_that_is_ahead() -> None:
    gear = in_gear(**{"slave.period": 90.0})
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=10.0, distance=20.0).run(0.1)
    assert gear["local.trigger_position"] == near(10.0 / 1.5 - 10.0 + 60.0)
    gear.to(80.0)
    assert gear.state == STOPPED
    assert gear.slave == (10.0, 0.0, 0.0)


@pytest.mark.parametrize(("speed", "travel"), [(10.0, 85.0), (-10.0, -5.0)])
def test_in_time_a_stop_position_is_the_next_one_ahead(speed: float, travel: float) -> None:
    gear = in_gear(speed=speed, **{"slave.period": 90.0, "slave.initial_position": 15.0})
    gear.stop(stop_mode=StopMode.WITH_CW_CCW_STOP_POSITION, transition=TIME, time=8.0, stop_position=100.0)
    rows = gear.rows(8.0, cuts=grid(8.0, 0.1))
    assert gear.slave == near(10.0, 0.0, 0.0)
    unwrapped = 15.0
    for row in rows.values():
        unwrapped += (row["slave.position"] - unwrapped + 45.0) % 90.0 - 45.0
    assert unwrapped == near(15.0 + travel)


@pytest.mark.parametrize(("begin", "travel"), [(60.0, 40.0), (50.0, -40.0)])
def test_in_time_and_at_rest_the_nearest_stop_position_is_meant(begin: float, travel: float) -> None:
    gear = in_gear(speed=0.0, **{"slave.period": 90.0, "slave.initial_position": begin})
    gear.stop(stop_mode=StopMode.WITH_CW_CCW_STOP_POSITION, transition=TIME, time=2.0, stop_position=10.0).run(1.0)
    assert gear.slave[0] == near((begin + travel / 2) % 90.0)


def test_the_synchronous_point_outlives_the_slaves_turns() -> None:
    gear = in_gear(**{"slave.period": 90.0}).to(100.0)  # the line runs through (0, 0)
    gear.stop(transition=NONE, stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=30.0).to(150.0)  # at m = 140
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE)
    gear.speed = -10.0
    gear.to(139.0)
    assert gear.state == ACTIVE
    assert gear.slave == near(30.0 - 1.5, -15.0, 0.0)


# --- the master turns round -------------------------------------------------------------------------------------------


def test_the_slave_goes_back_along_the_curve_and_rests_below_the_trigger() -> None:
    gear = referred().to(45.0)
    forwards = gear.slave
    gear.to(55.0)
    gear.speed = -10.0
    gear.to(45.0)
    assert gear.slave == near(forwards[0], -forwards[1], forwards[2])
    gear.to(39.0)
    assert (gear.state, gear.slave) == (WAITING, (7.0, 0.0, 0.0))
    gear.speed = 10.0
    assert gear.to(61.0).slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)


def test_a_direct_transition_keeps_its_trigger() -> None:
    gear = direct(StartMode.CW_CCW_DIRECT, 10.0).run(1.0)
    gear.speed = -10.0
    assert gear.to(-20.0).state == WAITING
    assert gear["local.trigger_position"] == 5.0
    gear.speed = 10.0
    assert gear.to(30.0).slave == near(7.0 + 1.5 * 15.0, 15.0, 0.0)


def test_completion_is_final() -> None:
    gear = referred().to(60.5)
    gear.speed = -10.0
    assert gear.to(30.0).state == ACTIVE
    assert gear.slave == near(7.0 - 1.5 * 20.0, -15.0, 0.0)


# --- edges ------------------------------------------------------------------------------------------------------------


def test_a_falling_edge_while_waiting_ends_it() -> None:
    gear = referred().run(1.0).stop().run(9.0)
    assert (gear.state, gear.slave) == (STOPPED, (7.0, 0.0, 0.0))


def test_a_falling_edge_in_gear_in_direct_without_transition_is_rest_at_once() -> None:
    gear = referred().to(50.0).stop(transition=NONE).run(1.0)
    assert gear.state == STOPPED
    assert gear.slave == near(7.0 + 30.0 * 3 / 32, 0.0, 0.0)


def test_a_falling_edge_in_gear_in_to_stop_in_time_acts_at_once() -> None:
    gear = referred().to(50.0)
    s, v, a = gear.slave
    gear.stop(transition=TIME, time=2.0).run(INSTANT)
    assert gear.state == GEAR_OUT
    assert gear.slave == near(s, v, a, tolerance=1e-6)
    assert gear.run(2.0).slave == near(s, 0.0, 0.0)
    aimed = referred().to(50.0)
    aimed.stop(transition=TIME, time=2.0, stop_mode=StopMode.WITH_CCW_STOP_POSITION, stop_position=-3.0).run(2.0)
    assert aimed.slave == near(-3.0, 0.0, 0.0)


def test_a_falling_edge_in_gear_in_else_waits_for_its_end() -> None:
    gear = referred().to(45.0).stop(distance=20.0).to(59.0)
    assert gear.state == GEAR_IN
    gear.to(70.0)  # u = 1/2 from 60 on
    assert gear.state == GEAR_OUT
    assert gear.slave == near(7.0 + 15.0 + 30.0 * (1 / 2 - 3 / 32), 7.5, -1.5 * 1.5 * 5.0)
    assert gear.to(90.0).slave == near(7.0 + 15.0 + 15.0, 0.0, 0.0)
    stopped = referred().to(45.0).stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, transition=NONE, stop_position=52.0)
    assert stopped.to(79.0).state == LEAVING
    assert stopped.to(81.0).slave == (52.0, 0.0, 0.0)


def test_a_falling_edge_that_waits_ends_with_the_master_below_the_trigger() -> None:
    gear = referred().to(45.0).stop()
    gear.speed = -10.0
    gear.to(39.0)
    assert gear.state == STOPPED
    gear.speed = 10.0
    assert gear.to(99.0).state == STOPPED


def test_a_falling_edge_that_waits_is_taken_back_by_a_rising_one() -> None:
    gear = referred().to(45.0).stop(distance=20.0).to(50.0).start(distance=5.0).to(70.0)
    assert gear.state == ACTIVE
    assert gear.slave == near(7.0 + 1.5 * 20.0, 15.0, 0.0)


def test_an_edge_that_has_waited_is_judged_and_read_when_it_acts() -> None:
    gear = referred().to(45.0).stop(distance=20.0).to(50.0).put({"gear_out.distance": 10.0}).to(71.0)
    assert gear.slave == near(7.0 + 15.0 + 7.5, 0.0, 0.0)
    gear = referred().to(45.0).stop(distance=20.0).to(50.0).put({"gear_out.distance": -1.0}).to(71.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, Fault.DISTANCE)
    gear = in_gear().stop(distance=20.0).to(10.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(0.1)
    refused = gear.twin().put(ratio(0, 1)).to(30.0)
    assert (refused.state, refused["error_id"]) == (STOPPED, Fault.NUMERATOR)
    assert gear.put(ratio(1, 1)).to(30.0).slave == near(15.0 + 10.0, 10.0, 0.0)


def test_a_rising_edge_while_leaving_returns() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=150.0).run(1.0)
    assert (gear.state, gear["in_gear"]) == (LEAVING, False)
    gear.start().run(1.0)
    assert (gear.state, gear["in_gear"]) == (ACTIVE, True)
    assert gear.to(200.0).slave == near(300.0, 15.0, 0.0)


def test_a_rising_edge_in_gear_out_in_time_acts_at_once() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0)
    s, v, a = gear.slave
    gear.start(start_mode=CW, reference_position=25.0, transition=TIME, time=2.0).run(INSTANT)
    assert gear.state == GEAR_IN
    assert gear.slave == near(s, v, a, tolerance=1e-6)
    assert gear.run(2.5).slave == near(s + 1.5 * (gear.place - 25.0), 15.0, 0.0)


@pytest.mark.parametrize(
    "order",
    [
        {"start_mode": StartMode.CW_CCW_DIRECT, "transition": NONE},
        {"start_mode": CCW, "transition": TIME},
    ],
)
def test_a_rising_edge_in_gear_out_else_waits_for_the_rest(order: dict[str, Any]) -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).start(**order).to(19.0)
    assert gear.state == GEAR_OUT
    gear.to(30.0)
    if order["transition"] == NONE:
        assert gear.state == ACTIVE
        assert gear.slave == near(15.0 + 1.5 * 10.0, 15.0, 0.0)
    else:
        assert (gear.state, gear.slave[0]) == (WAITING, near(15.0))


def test_a_rising_edge_that_waits_is_taken_back_by_a_falling_one() -> None:
    gear = in_gear().stop(distance=20.0).to(5.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).to(10.0)
    assert gear.stop().to(50.0).state == STOPPED


def test_values_are_read_at_the_edges() -> None:
    gear = referred().run(0.1)
    gear.put({"gear_in.reference_position": 0.0, "gear_in.offset": 99.0, "gear_in.distance": 1.0})
    gear.put({"gear_in.transition": NONE, "gear_in.start_mode": CCW})
    assert gear.to(61.0).slave == near(7.0 + 1.5 * 11.0, 15.0, 0.0)
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=52.0, distance=20.0).run(0.1)
    gear.put({"gear_out.stop_position": 0.0, "gear_out.distance": 1.0, "gear_out.transition": TIME})
    assert gear.to(99.0).slave == (52.0, 0.0, 0.0)


def test_the_first_value_of_start_is_no_edge() -> None:
    gear = Gear({"start": True}, speed=10.0).run(50.0)
    assert gear.state == STOPPED


# --- the ratio --------------------------------------------------------------------------------------------------------


def ratio(numerator: int, denominator: int) -> dict[str, int]:
    return {"gearing.numerator": numerator, "gearing.denominator": denominator}


def test_in_gear_the_line_turns_about_the_present_point() -> None:
    gear = in_gear().to(20.0).put(ratio(-1, 4)).to(60.0)
    assert gear.slave == near(30.0 - 10.0, -2.5, 0.0)
    assert gear["local.line_offset"] == near(30.0 + 5.0)
    gear.stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=0.0, transition=NONE).run(0.1)
    gear.put(ratio(-1, 2)).run(3.9)
    assert gear.slave[0] == near(20.0 - 0.25 - 0.5 * 39.0)
    assert gear.to(101.0).slave == (0.0, 0.0, 0.0)


def test_in_time_the_line_turns_and_what_lacks_to_it_stays() -> None:
    gear = timed(10.0).run(0.5)
    position, at = gear.slave[0], 1.5 * (105.0 - 110.0)
    gear.put(ratio(3, 1)).run(INSTANT)
    assert gear.slave[0] == near(position, tolerance=1e-6)
    assert gear.run(2.0).slave == near(at + 3.0 * (gear.place - 105.0), 30.0, 0.0)


def test_in_a_master_based_transition_the_curve_turns_about_the_present_point() -> None:
    gear = referred().to(50.0)
    position = gear.slave[0]
    gear.put(ratio(3, 1)).run(INSTANT)
    assert gear.slave[0] == near(position, tolerance=1e-6)
    s_a = 7.0 + (1.5 - 3.0) * 20.0 * 3 / 32
    gear.to(55.0)
    assert gear.slave[0] == near(s_a + 60.0 * (27 / 64 - 81 / 512))
    assert gear.to(70.0).slave == near(s_a + 3.0 * 20.0, 30.0, 0.0)
    gear = referred().to(50.0).put(ratio(3, 1))
    gear.speed = -10.0
    assert gear.to(30.0).slave == near(s_a, 0.0, 0.0)


def test_in_gear_out_it_takes_effect_at_the_next_engagement() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).put(ratio(1, 1)).to(30.0)
    assert gear.slave == near(15.0, 0.0, 0.0)
    gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).to(40.0)
    assert gear.slave == near(25.0, 10.0, 0.0)
    back = in_gear().stop(distance=20.0).to(10.0).put(ratio(1, 1)).run(0.1)
    back.speed = -10.0
    assert back.to(-10.0).slave == near(-15.0, -15.0, 0.0)
    assert back.start().run(1.0).slave == near(-30.0, -15.0, 0.0)


def test_while_waiting_the_synchronous_line_turns() -> None:
    gear = continuing(transition=NONE).run(0.1).put(ratio(1, 2))
    gear.to(31.0)  # through (0, 0): at 15 with the master at 30
    assert gear.slave == near(15.5, 5.0, 0.0)


@pytest.mark.parametrize(("numerator", "denominator", "fault"), [(0, 1, 2), (1, 0, 1), (0, 0, 1)])
def test_a_ratio_of_0_while_running_is_refused(numerator: int, denominator: int, fault: int) -> None:
    gear = in_gear().put(ratio(numerator, denominator)).to(20.0)
    assert (gear["error"], gear["error_id"]) == (True, fault)
    assert gear.slave == near(30.0, 15.0, 0.0)
    gear.put({"reset": True}).run(0.1)
    assert (gear["error"], gear["error_id"]) == (False, 0)


# --- disengaging ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mode", "speed", "met"),
    [
        (StopMode.CW_DIRECT, 10.0, True),
        (StopMode.CW_DIRECT, -10.0, False),
        (StopMode.CW_DIRECT, 0.0, False),
        (StopMode.CCW_DIRECT, -10.0, True),
        (StopMode.CCW_DIRECT, 10.0, False),
        (StopMode.CW_CCW_DIRECT, 10.0, True),
        (StopMode.CW_CCW_DIRECT, -10.0, True),
        (StopMode.CW_CCW_DIRECT, 0.0, True),
    ],
)
def test_direct_disengaging_begins_at_the_edge_if_the_master_moves_as_it_has_to(
    mode: StopMode, speed: float, met: bool
) -> None:
    for transition, reached in [(NONE, STOPPED), (MASTER, GEAR_OUT), (TIME, GEAR_OUT)]:
        gear = in_gear(speed=speed).stop(stop_mode=mode, transition=transition).run(0.5)
        assert gear.state == (reached if met else LEAVING)
        assert not gear["in_gear"]
        if not met:
            assert gear.slave == near(0.75 * speed, 1.5 * speed, 0.0, tolerance=1e-7)


def test_master_based_it_travels_half_the_distance() -> None:
    gear = in_gear().stop(distance=20.0).to(5.0)
    assert gear["local.progress"] == near(0.25)
    assert gear.slave == near(30.0 * (1 / 4 - 1 / 64 + 1 / 512), 15.0 * (1 - 3 / 16 + 2 / 64), -1.5 * (9 / 8) * 5.0)
    assert gear.to(25.0).slave == near(15.0, 0.0, 0.0)
    assert gear.state == STOPPED


def test_without_transition_the_slave_rests_where_it_is() -> None:
    gear = in_gear().to(10.0).stop(transition=NONE).run(1.0)
    assert gear.slave == near(15.0, 0.0, 0.0)


def test_in_time_it_overruns_and_comes_back() -> None:
    gear = in_gear().stop(transition=TIME, time=3.0).run(1.0)
    assert gear.slave == near(0.19753086419753085 * 15.0 * 3.0, 0.0, -15.0 / 3.0 * 32.0 / 9.0, tolerance=1e-6)
    assert gear.run(2.0).slave == near(0.0, 0.0, 0.0, tolerance=1e-6)
    assert gear.state == STOPPED


def test_direct_disengaging_waits_for_the_master_to_turn() -> None:
    gear = in_gear().stop(stop_mode=StopMode.CCW_DIRECT, distance=20.0).run(3.0, acceleration=-5.0)  # turns at 10
    assert gear.state == GEAR_OUT
    assert gear["local.trigger_position"] == near(10.0)
    u = 2.5 / 20.0
    assert gear.slave[0] == near(15.0 - 30.0 * (u - u**3 + u**4 / 2), tolerance=1e-7)


@pytest.mark.parametrize(
    ("mode", "speed"), [(StopMode.WITH_CW_STOP_POSITION, 10.0), (StopMode.WITH_CCW_STOP_POSITION, -10.0)]
)
@pytest.mark.parametrize("either", [False, True])
def test_a_stop_position_is_met_exactly(mode: StopMode, speed: float, either: bool) -> None:
    side = speed / 10.0
    chosen = StopMode.WITH_CW_CCW_STOP_POSITION if either else mode
    gear = in_gear(speed=speed).stop(stop_mode=chosen, stop_position=45.7 * side, distance=20.0)
    gear.to(side * (45.7 / 1.5 - 10.1))
    assert gear.state == LEAVING
    assert gear["local.trigger_position"] == near(side * (45.7 / 1.5 - 10.0))
    gear.to(side * 45.7 / 1.5)
    assert gear.state == GEAR_OUT
    assert gear.slave[0] == near(side * (45.7 - 15.0 + 30.0 * (1 / 2 - 3 / 32)), tolerance=1e-7)
    gear.to(side * 60.0)
    assert (gear.state, gear.slave) == (STOPPED, (45.7 * side, 0.0, 0.0))


def test_without_transition_it_stops_where_the_line_reaches_the_stop_position() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=45.0, transition=NONE).to(29.9)
    assert gear.state == LEAVING
    assert gear.to(30.1).slave == (45.0, 0.0, 0.0)
    assert gear.state == STOPPED


def test_a_stop_position_that_is_behind_is_met_when_the_master_comes_again() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=-45.0, distance=20.0).run(1.0)
    assert gear.state == LEAVING
    gear.speed = -10.0
    assert gear.to(-50.0).state == LEAVING
    gear.speed = 10.0
    assert gear.to(0.0).slave == (-45.0, 0.0, 0.0)


def test_in_time_to_a_stop_position() -> None:
    gear = in_gear().stop(stop_mode=StopMode.WITH_CW_STOP_POSITION, stop_position=-45.0, transition=TIME, time=2.0)
    assert gear.run(1.0).state == GEAR_OUT
    assert gear.run(1.0).slave == (-45.0, 0.0, 0.0)


@pytest.mark.parametrize(("mode", "triggered"), [(StopMode.CW_CCW_DIRECT, 0.0), (StopMode.WITH_CW_STOP_POSITION, 10.0)])
def test_a_disengagement_falls_back_on_to_the_line(mode: StopMode, triggered: float) -> None:
    gear = in_gear().stop(stop_mode=mode, stop_position=30.0, distance=20.0).to(triggered + 10.0)
    assert gear.state == GEAR_OUT
    gear.speed = -10.0
    gear.to(triggered - 5.0)
    assert gear.state == LEAVING
    assert gear.slave == near(1.5 * (triggered - 5.0), -15.0, 0.0, tolerance=1e-7)
    gear.speed = 10.0
    gear.to(triggered + 20.5)
    assert gear.state == STOPPED
    assert gear.slave == near(1.5 * triggered + 15.0, 0.0, 0.0, tolerance=1e-7)


def test_a_rising_edge_that_waits_acts_on_the_line_if_the_disengagement_falls_back() -> None:
    gear = in_gear().stop(distance=20.0).to(10.0).start(start_mode=CW, distance=5.0)
    gear.speed = -10.0
    assert gear.to(-5.0).state == ACTIVE


# --- activate and reset -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", [30.0, 50.0, 70.0])
def test_deactivated_the_slave_stops_at_its_last_setpoint(place: float) -> None:
    gear = referred().to(place)
    position = gear.slave[0]
    gear.put({"activate": False}).run(1.0)
    assert gear.slave == near(position, 0.0, 0.0)
    assert gear.state == {30.0: WAITING, 50.0: GEAR_IN, 70.0: ACTIVE}[place]
    reset = gear.twin().put({"reset": True}).run(1.0)
    assert (reset.state, reset.slave) == (STOPPED, near(position, 0.0, 0.0))
    gear.put({"activate": True}).run(10.0)
    assert (gear.state, gear.slave) == (STOPPED, near(position, 0.0, 0.0))


def test_edges_are_lost_while_inactive() -> None:
    gear = Gear({"activate": False}, speed=10.0).start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(1.0)
    assert gear.put({"activate": True}).run(1.0).state == STOPPED
    assert gear.stop().run(1.0).start().run(1.0).state == ACTIVE


def test_deactivating_saves_the_synchronous_point() -> None:
    gear = in_gear().to(20.0).put({"activate": False}).to(40.0)
    gear.put({"activate": True, "start": False}).run(INSTANT)
    gear.start(start_mode=StartMode.CONTINUE_SYNCHRONIZED, transition=NONE).run(INSTANT)
    assert gear.state == WAITING
    gear.speed = -10.0
    assert gear.to(10.0).slave == near(15.0, -15.0, 0.0, tolerance=1e-7)


def test_a_new_edge_together_with_activate_counts() -> None:
    gear = Gear({"activate": False}, speed=10.0).run(1.0).put({"activate": True})
    assert gear.start(start_mode=StartMode.CW_DIRECT, transition=NONE).run(1.0).state == ACTIVE


# --- faults -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"gearing.denominator": 0, "gearing.numerator": 0}, Fault.DENOMINATOR),
        ({"gearing.numerator": 0, "gear_in.distance": -1.0}, Fault.NUMERATOR),
        ({"gear_in.transition": TIME, "gear_in.time": 0.0, "gear_in.distance": -1.0}, Fault.TIME),
        ({"gear_in.transition": TIME, "gear_in.time": float("nan")}, Fault.TIME),
        ({"gear_in.distance": -1.0}, Fault.DISTANCE),
        ({"gear_in.distance": float("nan")}, Fault.DISTANCE),
        ({"gear_in.start_mode": 8}, Fault.CHOICE),
        ({"gear_in.transition": 0}, Fault.CHOICE),
        ({"gear_in.time": 0.0, "gear_in.transition": MASTER, "gear_out.distance": -1.0}, Fault.NONE),
    ],
)
def test_gear_in_values_are_checked_at_the_rising_edge(values: dict[str, Any], fault: Fault) -> None:
    gear = Gear(speed=10.0).put(values).start().run(1.0)
    assert gear.state == (WAITING if fault == Fault.NONE else STOPPED)
    assert (gear["error"], gear["error_id"]) == (fault != Fault.NONE, fault)
    gear.put({"reset": True}).run(1.0)
    assert gear["error_id"] == 0


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"transition": TIME, "time": -1.0, "distance": -1.0}, Fault.TIME),
        ({"distance": -1.0}, Fault.DISTANCE),
        ({"stop_mode": 7}, Fault.CHOICE),
        ({"transition": TIME, "time": 1.0, "distance": -1.0}, Fault.DISTANCE),
    ],
)
def test_gear_out_values_are_checked_at_the_falling_edge(values: dict[str, Any], fault: Fault) -> None:
    gear = in_gear().stop(**values).run(1.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, fault)
    gear.start().run(1.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, fault)  # ignored
    gear.stop(transition=NONE, distance=0.0, stop_mode=StopMode.CW_CCW_DIRECT).run(1.0)
    assert (gear.state, gear["error_id"]) == (STOPPED, 0)


@pytest.mark.parametrize(
    ("values", "refusal"),
    [
        ({"gearing.denominator": 0}, Refusal.DENOMINATOR),
        ({"gearing.numerator": 0}, Refusal.NUMERATOR),
        ({"gear_in.transition": TIME, "gear_in.time": 0.0}, Refusal.GEAR_IN_TIME),
        ({"gear_out.transition": TIME, "gear_out.time": -1.0}, Refusal.GEAR_OUT_TIME),
        ({"gear_out.time": -1.0}, Refusal.NONE),
        ({"master.period": 1.0, "master.position": 2e15}, Refusal.MASTER_TURNS),
    ],
)
def test_bad_parameters_are_refused_at_the_initialization(values: dict[str, Any], refusal: Refusal) -> None:
    block = Gearing()
    by_name = {v.name: v for v in variables(block)}
    for name, value in values.items():
        by_name[name].cell.set(value)
    assert block.initialize() == refusal
    assert set(refusal.names) <= set(by_name)


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        ("gear_in.distance", [0.0, 1e-9, 1e12], [-1.0, 1e-10, float("nan"), 2e12]),
        ("gear_out.distance", [0.0, 1e-9, 1e12], [-1.0, 1e-10, float("nan"), 2e12]),
        ("slave.period", [0.0, 1e-9], [-1.0, 1e-10, float("inf")]),
        ("slave.initial_position", [-1e12], [2e12, float("nan")]),
        ("gear_in.time", [-1.0, 0.0, 1e12], [float("nan"), float("inf")]),
        ("gear_in.start_mode", [1, 7], [0, 8]),
        ("gear_out.stop_mode", [1, 6], [0, 7]),
        ("gear_in.transition", [1, 3], [0, 4]),
    ],
)
def test_the_limits_that_are_declared(name: str, good: list[Any], bad: list[Any]) -> None:
    allows = next(v.allows for v in variables(Gearing()) if v.name == name)
    assert all(allows(x) for x in good)
    assert not any(allows(x) for x in bad)


def test_each_fault_and_each_dependency_names_variables_of_the_block() -> None:
    known = {v.name for v in variables(Gearing())}
    assert all(set(fault.names) <= known for fault in Fault)
    told = {v.name: v.depends for v in variables(Gearing()) if v.depends}
    assert told == {"slave.position": ("slave.initial_position", "slave.period")}


# --- the other input modes --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("transition", Transition)
def test_end_of_step_inputs_give_the_same(transition: Transition) -> None:
    def course(mode: MasterInput) -> list[tuple[float, float, float]]:
        gear = Gear(three_halves(), speed=10.0, mode=mode)
        gear.start(reference_position=30.0, transition=transition, distance=20.0).run(1.0)
        found = [gear.run(0.7, acceleration=a).slave for a in (0.0, 3.0, 0.0, -2.0, 5.0, 0.0)]
        gear.stop(transition=transition, distance=20.0)
        return found + [gear.run(0.7, acceleration=a).slave for a in (0.0, -3.0, 4.0, 1.0)]

    for a, b in zip(course(MasterInput.START_OF_STEP), course(MasterInput.END_OF_STEP), strict=True):
        assert a == near(*b)


def test_position_only_inputs_lead_on_to_the_line() -> None:
    gear = Gear(three_halves(), speed=10.0, mode=MasterInput.POSITION_ONLY)
    gear.start(reference_position=30.0, distance=20.0).run(6.0, cuts=grid(6.0, 0.1))
    assert gear.state == ACTIVE
    assert gear.slave == near(1.5 * 30.0, 15.0, 0.0, tolerance=1e-6)


def test_a_step_too_short_to_divide_by_leaves_nothing_infinite() -> None:
    gear = Gear(speed=10.0, mode=MasterInput.END_OF_STEP)
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=Transition.NONE).run(1.0)
    gear.stop(stop_mode=StopMode.CW_CCW_DIRECT, transition=Transition.TIME_BASED, time=1.0).put(
        {"master.velocity": -20.0}
    )
    assert gear.block.step(5e-324) == Refusal.NONE
    gear.speed = -20.0
    for motion in gear.rows(1.0, cuts=[0.25, 0.5]).values():
        assert all(map(math.isfinite, motion.values()))
    assert gear.state == State.STOPPED
