"""The Follower, sentence by sentence with numbers by hand: its phases, its commands, its faults.

Unless said otherwise: a linear slave from its park at 0 to sync at 100, out at 300, braking over 100, k = 1; the master
comes with 100 from 0 and has a cycle of 1000. So the way to the meeting at 1000 begins at 800, the synchronized phase
ends at 1200, the stroke at 1400, and the way home at 1800.
"""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description

from motionsync.follower.block import Follower, State
from motionsync.follower.faults import Fault, Refusal
from motionsync.follower.leg import Leg, Peaks
from motionsync.master import MasterInput
from motionsync.var import Unit
from motionsync_fmu.build import build_python
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.units import axis_label, unit_name
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.pages.report import plots
from motionsync_fmu.scenario.fmu_instance import FmuError, FmuInstance
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.recording import Recording
from tests import ROOT
from tests.model.follower.harness import Pusher

START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
CYCLIC = {"slave_cycle": 400.0}  # S_h = 100, L = 100
PASSING: dict[str, Any] = {**CYCLIC, "stop_in_park": False}
VARIABLE: dict[str, Any] = {"variable_cycle": True, "sync_master": 1000.0}
RECOVERING: dict[str, Any] = {**PASSING, **VARIABLE, "recover_late_sync": True}


def near(*values: float, tolerance: float = 1e-9) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def parked(place: float = 0.0, speed: float = 100.0, mode: MasterInput = START, **values: Any) -> Pusher:
    """Positioned to its park, where it stands already."""
    names = {name.replace("__", "."): value for name, value in values.items()}
    return Pusher(names, place=place, speed=speed, mode=mode).give("position_to_park").run(2.0**-20)


def refused(**values: Any) -> Refusal:
    """What `initialize` answers."""
    block = Follower()
    for name, value in values.items():
        setattr(block, name, value)
    return block.initialize()


# --- a linear slave ---------------------------------------------------------------------------------------------------


def test_without_a_positioning_nothing_moves() -> None:
    pusher = Pusher({"slave.initial_position": 7.0}, speed=100.0)
    assert (pusher.state, pusher["state_code"], pusher.slave) == (State.M_IDLE, 1, (7.0, 0.0, 0.0))
    pusher.to(5000.0)
    assert (pusher.state, pusher.slave, pusher["cycle"]) == (State.M_IDLE, (7.0, 0.0, 0.0), 0)


@pytest.mark.parametrize("steps", [1, 7, 1000])
@pytest.mark.parametrize(
    ("place", "state", "position", "slope", "curvature"),
    [
        (799.0, State.M_WAITING, 0.0, 0.0, 0.0),
        (900.0, State.M_FOLLOWING, 18.75, 0.5, 0.0075),  # 200 q(1/2), q = 3/32, q' = 1/2, q'' = 3/2
        (1000.0, State.M_SYNCHRONIZED, 100.0, 1.0, 0.0),
        (1100.0, State.M_SYNCHRONIZED, 200.0, 1.0, 0.0),
        (1200.0, State.M_DECEL, 300.0, 1.0, 0.0),
        (1300.0, State.M_DECEL, 381.25, 0.5, -0.0075),  # 300 + 200 (1/2 - 3/32)
        (1400.0, State.M_HOMING, 400.0, 0.0, 0.0),
        (1500.0, State.M_HOMING, 400.0 * (1.0 - 53.0 / 512.0), -135.0 / 128.0, -9.0 / 640.0),  # u = 1/4
        (1600.0, State.M_HOMING, 200.0, -1.875, 0.0),
        (1900.0, State.M_FOLLOWING, 18.75, 0.5, 0.0075),
        (10600.0, State.M_HOMING, 200.0, -1.875, 0.0),
    ],
)
def test_the_cycle_of_a_linear_slave(
    place: float, state: State, position: float, slope: float, curvature: float, steps: int
) -> None:
    pusher = parked().to(place, steps)
    assert pusher.state == state
    assert pusher.slave == near(position, 100.0 * slope, 1e4 * curvature, tolerance=1e-8)
    assert pusher["cycle"] == max(0, int((place - 200.0) // 1000.0))


@pytest.mark.parametrize("mode", [START, END])
def test_velocity_and_acceleration_follow_the_chain_rule(mode: MasterInput) -> None:
    """u = 1/2: s' = 1/2, s'' = 3/2/200, s''' = 0; then 3 s'' v a is the jerk."""
    pusher = parked(mode=mode).to(800.0).run(1.0, acceleration=-20.0, cuts=[0.3]).run(10.0 / 80.0)
    assert pusher.place == near(900.0)
    pusher.run(2.0**-30, acceleration=-20.0)
    assert pusher.slave == near(18.75, 40.0, 0.5 * -20.0 + 0.0075 * 6400.0, tolerance=1e-6)
    assert pusher["slave.jerk"] == near(3.0 * 0.0075 * 80.0 * -20.0, tolerance=1e-6)


def test_the_ratio_scales_the_master_travels() -> None:
    """k = 1/2: M_f = 400, synchronized 400, M_d = 400."""
    pusher = parked(k_slave_master=0.5, master_cycle=2000.0, sync_master=1000.0)
    assert pusher.missing == near(600.0, 1000.0, 1400.0, tolerance=1e-3)
    assert pusher.to(800.0).slave == near(18.75, 25.0, 0.5 * 0.0075 * 1e4 * 0.5)
    assert pusher.to(1200.0).slave == near(200.0, 50.0, 0.0)
    assert pusher.to(1600.0).slave == near(381.25, 25.0, -0.5 * 0.0075 * 1e4 * 0.5)


def test_the_first_meeting_may_be_a_negative_number_of_cycles_away() -> None:
    pusher = parked(place=-5000.0, sync_master=30.0)
    assert pusher.missing == near(830.0, 1030.0, 1230.0, tolerance=1e-3)
    pusher.to(-4970.0 + 900.0)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(18.75))


def test_the_wait_in_the_park_shortens_the_way_home() -> None:
    pusher = parked(space_wait_in_park=100.0).to(1550.0)  # 1400 to 1700
    assert pusher.slave == near(200.0, -400.0 / 300.0 * 1.875 * 100.0, 0.0)
    assert (pusher.to(1700.0).state, pusher.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))
    assert pusher.to(1800.0).state == State.M_FOLLOWING


def test_the_master_may_stand_anywhere() -> None:
    pusher = parked().to(900.0).run(1.0, acceleration=-100.0)
    assert pusher.place == 950.0
    here = pusher.slave
    assert here[1] == 0.0
    pusher.run(100.0)
    assert pusher.slave == (here[0], 0.0, 0.0)
    pusher.run(1.0, acceleration=100.0)
    assert pusher.state == State.M_SYNCHRONIZED
    assert pusher.slave == near(100.0, 100.0, 100.0)


@pytest.mark.parametrize("at_center", [False, True])
def test_the_middle_of_the_synchronized_phase_can_be_aligned(at_center: bool) -> None:
    pusher = parked(align_center=at_center, k_slave_master=0.8, master_cycle=2000.0)
    meeting = 2000.0 - (125.0 if at_center else 0.0)
    assert pusher.to(100.0)["master_to_sync"] == near(meeting - 100.0)
    assert pusher.to(2000.0).position == near(200.0 if at_center else 100.0)


def test_where_the_current_meeting_and_after_it_the_next_one_is() -> None:
    pusher = parked(space_wait_in_park=100.0)
    assert pusher.to(300.0).missing == near(500.0, 700.0, 900.0)
    assert pusher.to(900.0).missing == near(0.0, 100.0, 300.0)
    assert pusher.to(1100.0).missing == near(0.0, 0.0, 100.0)
    assert pusher.to(1300.0).missing == near(500.0, 700.0, 900.0)
    assert pusher.to(1500.0).missing == near(300.0, 500.0, 700.0)
    assert pusher.to(1750.0).missing == near(50.0, 250.0, 450.0)


def test_the_locals_tell_where_the_meeting_is_and_how_far_the_phase_has_come() -> None:
    pusher = parked(master__period=300.0).to(850.0)
    names = ("meeting_known", "meeting_position", "start_position", "following_travel", "progress")
    assert [pusher[f"local.{name}"] for name in names] == near(1.0, 100.0, 200.0, 200.0, 0.25)
    assert pusher.to(1600.0)["local.progress"] == near(0.5)


# --- when parameters are read -----------------------------------------------------------------------------------------


def test_parameters_are_not_read_inside_a_phase() -> None:
    changed = {"sync_slave": 90.0, "sync_out": 400.0, "k_slave_master": 1.5, "park_slave": 1.0, "master_cycle": 3000.0}
    pusher = parked().to(850.0).put(changed).to(900.0)
    assert pusher.position == near(18.75)
    assert pusher.to(1100.0).position == near(200.0)
    assert pusher.put({"sync_out": 300.0}).to(1300.0).position == near(381.25)


def test_the_way_home_is_read_where_the_synchronized_phase_ends() -> None:
    """M_f = 2 (120 - 20) / 1.25 = 160, next meeting 2040: home from 1200 + 2 * 150 up to 2040 - 160 - 80."""
    pusher = parked().to(1100.0)
    pusher.put({"park_slave": 20.0, "sync_slave": 120.0, "k_slave_master": 1.25, "space_stop_slave": 150.0})
    pusher.put({"sync_master": 40.0, "space_wait_in_park": 80.0}).to(1250.0)
    pusher.put({"park_slave": 0.0, "space_stop_slave": 10.0, "space_wait_in_park": 0.0})
    assert pusher.missing == near(630.0, 790.0, 790.0 + 180.0 / 1.25)
    assert pusher.to(1500.0).slave == near(450.0, 0.0, 0.0)
    assert pusher.to(1650.0).position == near(235.0)
    assert (pusher.to(1800.0).state, pusher.position) == (State.M_WAITING, near(20.0))
    assert pusher.to(1960.0).slave == near(20.0 + 100.0 * 3.0 / 16.0, 62.5, 1.25 * 1.5 / 160.0 * 1e4)  # u = 1/2
    assert pusher.to(2050.0).slave == near(132.5, 125.0, 0.0)


@pytest.mark.parametrize(
    ("value", "meeting"),
    [(30.0, 2030.0), (-30.0, 1970.0), (-499.0, 1501.0 + 1000.0), (-400.0, 1600.0), (600.0, 1600.0)],
)
def test_the_next_meeting_is_the_first_one_that_is_half_a_cycle_ahead(value: float, meeting: float) -> None:
    values = {} if meeting != 1600.0 else {"sync_out": 110.0, "space_stop_slave": 10.0}
    pusher = parked(**values).to(1005.0).put({"sync_master": value}).to(1250.0)
    if value == -499.0:  # 1501 - 200 is before the end of the stroke
        assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.NO_ROOM)
    else:
        assert pusher["master_to_sync"] == near(meeting - 1250.0)
        assert pusher.to(meeting).position == near(100.0)


def test_at_the_park_the_meeting_is_chosen_anew() -> None:
    pusher = parked().to(700.0).put({"sync_master": 50.0}).run(0.01)
    assert pusher["master_to_sync"] == near(349.0)
    pusher.put({"sync_master": -50.0, "sync_slave": 50.0}).run(0.01)
    assert pusher.missing == near(148.0, 248.0, 498.0)
    assert pusher.to(900.0).position == near(50.0 * 3.0 / 16.0)


def test_a_start_that_a_change_moves_behind_the_master_is_left_for_the_next_one() -> None:
    pusher = parked(space_wait_in_park=100.0).to(700.0).put({"sync_master": -150.0}).run(0.01)
    assert (pusher.state, pusher["master_to_sync"]) == (State.M_WAITING, near(1149.0))
    assert pusher.to(1750.0).position == near(18.75)


def test_a_new_park_is_taken_on_the_way_home_only() -> None:
    pusher = parked().put({"park_slave": 10.0}).to(900.0)
    assert pusher.position == near(18.75)
    assert pusher.to(1820.0).slave == near(10.0, 0.0, 0.0)  # 2000 - 2 * 90
    assert pusher.to(1910.0).position == near(10.0 + 90.0 * 3.0 / 16.0)


# --- commands in the cycle --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_start_is_not_carried_out_while_a_level_is_set(name: str) -> None:
    pusher = parked(space_wait_in_park=100.0).to(790.0).put({name: True}).to(801.0).put({name: False})
    assert (pusher.state, pusher["cycle"], pusher.missing) == (
        State.M_WAITING_NEXT_CYCLE,
        0,
        near(999.0, 1199.0, 1399.0),
    )
    assert pusher.to(1699.0).state == State.M_WAITING_NEXT_CYCLE
    assert pusher.to(1701.0).state == State.M_WAITING
    assert pusher.to(1900.0).slave == near(18.75, 50.0, 75.0)


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_level_set_after_the_start_does_not_matter_to_this_cycle(name: str) -> None:
    pusher = parked().to(801.0).put({name: True}).to(1100.0)
    assert (pusher.state, pusher.position) == (State.M_SYNCHRONIZED, near(200.0))
    assert pusher.to(1790.0).state == State.M_HOMING
    assert pusher.to(1810.0).state == State.M_WAITING_NEXT_CYCLE
    assert pusher.to(4790.0, 3).position == 0.0
    assert pusher.put({name: False}).to(4900.0).position == near(18.75)


@pytest.mark.parametrize("steps", [1, 10])
def test_ending_the_synchronism_puts_the_end_where_the_slave_is(steps: int) -> None:
    pusher = parked().to(1100.0).give("end_synchronism").to(1200.0, steps)
    assert (pusher.state, pusher["cycle"]) == (State.M_DECEL, 1)
    assert pusher.slave == near(281.25, 50.0, -75.0)  # from 200 over 100
    assert pusher.to(1300.0).slave == near(300.0, 0.0, 0.0)
    assert pusher.to(1550.0).position == near(150.0)  # home from 1300 to 1800
    assert pusher.to(2150.0).position == near(250.0)  # this cycle only


def test_ending_the_synchronism_elsewhere_is_lost() -> None:
    pusher = parked().to(900.0).give("end_synchronism").to(1100.0)
    assert pusher.state == State.M_SYNCHRONIZED
    assert pusher.to(1250.0).give("end_synchronism").to(1300.0).position == near(381.25)


def test_the_slave_is_held_at_the_end_of_its_stroke_until_a_full_travel_home_is_left() -> None:
    """Undisturbed 400. Released at 1500: 1800 is too near, so home from 1500 to 2800."""
    pusher = parked().put({"stop_after_forward": True}).to(1500.0)
    assert (pusher.state, pusher.slave) == (State.M_DECEL, (near(400.0), 0.0, 0.0))
    pusher.put({"stop_after_forward": False}).to(2150.0)
    assert (pusher.state, pusher.position, pusher["master_to_sync"]) == (State.M_HOMING, near(200.0), near(850.0))
    assert pusher.to(2900.0).position == near(18.75)


def test_released_just_at_the_end_of_the_stroke_nothing_is_lost() -> None:
    pusher = parked().put({"stop_after_forward": True}).to(1400.0).put({"stop_after_forward": False}).to(1600.0)
    assert (pusher.position, pusher["master_to_sync"]) == (near(200.0), near(400.0))


def test_held_for_several_cycles() -> None:
    pusher = parked(space_wait_in_park=100.0).put({"stop_after_forward": True}).to(5350.0)
    pusher.put({"stop_after_forward": False}).to(5525.0)  # undisturbed 300: 5350 to 5700
    assert pusher.position == near(200.0)


def test_a_hold_that_is_gone_when_the_stroke_ends_does_not_matter() -> None:
    pusher = parked().put({"stop_after_forward": True}).to(1390.0).put({"stop_after_forward": False}).to(1410.0)
    assert pusher.state == State.M_HOMING
    assert pusher.put({"stop_after_forward": True}).to(1600.0).position == near(200.0)


def test_in_a_variable_cycle_the_slave_goes_home_over_the_undisturbed_travel() -> None:
    pusher = parked(**VARIABLE).put({"stop_after_forward": True}).to(1510.0)
    pusher.put({"stop_after_forward": False}).to(1710.0)
    assert (pusher.state, pusher.position) == (State.M_HOMING, near(200.0))
    assert pusher.to(1911.0).state == State.M_WAITING


# --- a cyclic slave ---------------------------------------------------------------------------------------------------


def quintic(length: float, position: float, slope: float, target: float, end_slope: float, x: float) -> float:
    """By Hermite's functions, not by the coefficients the block uses."""
    u = x / length
    h0, h1 = 1.0 - u**3 * (10.0 - 15.0 * u + 6.0 * u * u), u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    g0, g1 = u - u**3 * (6.0 - 8.0 * u + 3.0 * u * u), -(u**3) * (4.0 - 7.0 * u + 3.0 * u * u)
    return position * h0 + slope * length * g0 + target * h1 + end_slope * length * g1


@pytest.mark.parametrize(
    ("cycle", "place", "state", "position"),
    [
        (1000.0, 900.0, State.M_FOLLOWING, 18.75),
        (1000.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (1000.0, 1325.0, State.M_HOMING, 389.0625),  # over 2.5 * 100, though 600 are left
        (1000.0, 1451.0, State.M_WAITING, 0.0),
        (1000.0, 1900.0, State.M_FOLLOWING, 18.75),
        (600.0, 575.0, State.M_FOLLOWING, 200.0 * (0.875**3 - 0.5 * 0.875**4)),
        (600.0, 900.0, State.M_HOMING, quintic(200.0, 300.0, 1.0, 400.0, 0.0, 100.0)),  # R = 400: just 2 (L + S_h)
        (600.0, 1000.0, State.M_FOLLOWING, 0.0),
        (500.0, 400.0, State.M_FOLLOWING, 18.75),  # the first one from the park: always 200
        (500.0, 775.0, State.M_HOMING, quintic(150.0, 300.0, 1.0, 400.0, 0.0, 75.0)),  # R = 300: 150 each
        (500.0, 925.0, State.M_FOLLOWING, 26.5625),
        (500.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (300.0, 175.0, State.M_FOLLOWING, 200.0 * (0.375**3 - 0.5 * 0.375**4)),
        (300.0, 525.0, State.M_HOMING, quintic(50.0, 300.0, 1.0, 400.0, 0.0, 25.0)),
        (300.0, 575.0, State.M_FOLLOWING, quintic(50.0, 0.0, 0.0, 100.0, 1.0, 25.0)),
    ],
)
def test_a_cyclic_slave_that_rests_at_its_park(cycle: float, place: float, state: State, position: float) -> None:
    pusher = parked(**CYCLIC, master_cycle=cycle).to(place)
    assert (pusher.state, pusher.position) == (state, near(position))


def test_the_wait_counts_in_what_is_left_of_the_cycle() -> None:
    """R = 1000 - 200 - 550 = 250: 125 each; home at 1325, rest up to 1875."""
    pusher = parked(**CYCLIC, space_wait_in_park=550.0).to(1262.5)
    assert pusher.position == near(quintic(125.0, 300.0, 1.0, 400.0, 0.0, 62.5))
    assert (pusher.to(1326.0).state, pusher.position) == (State.M_WAITING, 0.0)
    assert (pusher.to(1874.0).state, pusher.position) == (State.M_WAITING, 0.0)
    assert pusher.to(1937.5).position == near(quintic(125.0, 0.0, 0.0, 100.0, 1.0, 62.5))


def test_a_meeting_that_moves_between_two_cycles_is_met_by_a_cyclic_slave_too() -> None:
    """R = 280 instead of 300: 140 each."""
    pusher = parked(**CYCLIC, master_cycle=500.0).to(650.0).put({"sync_master": -20.0}).to(770.0)
    assert pusher.position == near(quintic(140.0, 300.0, 1.0, 400.0, 0.0, 70.0))
    assert pusher.to(910.0).position == near(quintic(140.0, 0.0, 0.0, 100.0, 1.0, 70.0))
    assert pusher.to(1080.0).position == near(200.0)


@pytest.mark.parametrize(
    ("cycle", "place", "state", "position"),
    [
        (500.0, 850.0, State.M_FOLLOWING, 0.0),  # M = 300 < 2 S = 400
        (500.0, 775.0, State.M_FOLLOWING, quintic(300.0, 300.0, 1.0, 500.0, 1.0, 75.0)),
        (500.0, 1100.0, State.M_SYNCHRONIZED, 200.0),
        (1500.0, 1800.0, State.M_FOLLOWING, 381.25),  # M = 1300: down over 100, rest, up over 100
        (1500.0, 1900.0, State.M_FOLLOWING, 0.0),
        (1500.0, 2800.0, State.M_FOLLOWING, 0.0),
        (1500.0, 2900.0, State.M_FOLLOWING, 18.75),
        (1500.0, 3100.0, State.M_SYNCHRONIZED, 200.0),
        (600.0, 900.0, State.M_FOLLOWING, 381.25),  # M = 400, just 2 S
        (600.0, 1100.0, State.M_FOLLOWING, 18.75),
    ],
)
def test_a_cyclic_slave_that_does_not_rest_at_its_park(
    cycle: float, place: float, state: State, position: float
) -> None:
    pusher = parked(**PASSING, master_cycle=cycle).to(place)
    assert (pusher.state, pusher.position) == (state, near(position))


def test_the_intermediate_stop_may_be_elsewhere_than_the_park() -> None:
    pusher = parked(**PASSING, park_slave=-20.0, master_cycle=1500.0).to(2200.0)
    assert (pusher.state, pusher.slave) == (State.M_FOLLOWING, (near(0.0), 0.0, 0.0))


@pytest.mark.parametrize("name", ["skip_next_cycle", "sync_assumed"])
def test_a_slave_that_passes_its_park_stops_there_if_the_level_is_set_at_the_end_of_the_phase(name: str) -> None:
    pusher = parked(**PASSING).to(1199.0).put({name: True}).to(1325.0)
    assert (pusher.state, pusher.position) == (State.M_HOMING, near(389.0625))
    assert (pusher.put({name: False}).to(1790.0).state, pusher.position) == (State.M_WAITING, 0.0)
    assert pusher.to(1900.0).position == near(18.75)  # read again at the start
    pusher.put({name: True}).to(2810.0)
    assert pusher.state == State.M_WAITING_NEXT_CYCLE


def test_ending_the_synchronism_of_a_cyclic_slave() -> None:
    """At 200: S_h = 200, R = 900, home over 2.5 * 200."""
    pusher = parked(**CYCLIC).to(1100.0).give("end_synchronism").to(1350.0)
    assert (pusher.state, pusher.position) == (State.M_HOMING, near(quintic(500.0, 200.0, 1.0, 400.0, 0.0, 250.0)))


def test_the_position_of_a_cyclic_slave_lies_in_its_cycle() -> None:
    pusher = parked(**CYCLIC, master_cycle=500.0, park_slave=-30.0, slave__initial_position=-30.0)
    assert pusher.position == 370.0
    positions = [pusher.to(pusher.place + 7.3).position for _ in range(300)]
    assert all(0.0 <= position < 400.0 for position in positions)


# --- a variable cycle -------------------------------------------------------------------------------------------------


def test_each_new_value_is_one_meeting() -> None:
    pusher = parked(**VARIABLE).to(900.0)
    assert pusher.position == near(18.75)
    pusher.put({"sync_master": 2300.0}).to(1750.0)  # home from 1400 to 2100
    assert (pusher.position, pusher["master_to_sync"]) == (near(200.0), near(550.0))
    assert pusher.to(2200.0).position == near(18.75)
    assert pusher.to(3000.0).missing == (0.0, 0.0, 0.0)  # none known: home as if it were 3300
    assert pusher.position == near(400.0 * (1.0 - quintic(400.0, 0.0, 0.0, 1.0, 0.0, 300.0)))
    assert (pusher.to(9000.0).state, pusher.position, pusher["cycle"]) == (State.M_WAITING, 0.0, 2)


def test_the_last_value_counts() -> None:
    pusher = parked(**VARIABLE).to(850.0).put({"sync_master": 2300.0}).to(1050.0).put({"sync_master": 2100.0})
    assert pusher.to(1650.0).position == near(200.0)
    assert pusher.to(2000.0).position == near(18.75)


@pytest.mark.parametrize("meeting", [1999.0, 1200.0, -5.0])
def test_a_value_less_than_a_cycle_ahead_sends_the_slave_to_its_park(meeting: float) -> None:
    pusher = parked(**VARIABLE).to(1050.0).put({"sync_master": meeting}).to(1600.0)
    assert (pusher.state, pusher.position, pusher.missing) == (State.M_HOMING, near(200.0), (0.0, 0.0, 0.0))
    assert (pusher.to(5000.0).state, pusher["cycle"]) == (State.M_WAITING, 1)


def test_a_value_just_a_cycle_ahead_is_in_time_whatever_its_last_digit() -> None:
    pusher = parked(**{**VARIABLE, "sync_master": 1000.1}).to(1050.0).put({"sync_master": 0.1 + 2000.0}).to(2100.0)
    assert pusher.position == near(199.9)


@pytest.mark.parametrize(("meeting", "used"), [(2100.0, True), (2000.0, True), (1990.0, False), (1500.0, False)])
def test_a_value_set_on_the_way_home_is_used_at_the_park_if_it_is_not_too_late(meeting: float, used: bool) -> None:
    pusher = parked(**VARIABLE).to(1300.0).put({"sync_master": meeting}).to(1799.0)
    assert (pusher.state, pusher["master_to_sync"]) == (State.M_HOMING, near(max(meeting - 1799.0, 0.0)))
    if used:
        assert pusher.to(meeting + 50.0).position == near(150.0)
    else:
        assert pusher.to(1801.0).state == State.M_WAITING_NEXT_CYCLE
        assert pusher.to(meeting + 799.0).state in (State.M_WAITING_NEXT_CYCLE, State.M_WAITING)
        assert pusher.to(meeting + 1801.0).state == State.M_WAITING  # from meeting + C - M_f on


def test_a_value_at_the_park() -> None:
    pusher = parked(**VARIABLE).to(3000.0).put({"sync_master": 3100.0}).run(0.01)
    assert pusher.state == State.M_WAITING_NEXT_CYCLE  # 2900 is behind
    pusher.put({"sync_master": 3300.0}).run(0.01)
    assert (pusher.state, pusher["master_to_start"]) == (State.M_WAITING_NEXT_CYCLE, near(98.0))
    assert pusher.to(3200.0).position == near(18.75)


def test_the_value_at_the_initialization_counts_as_the_first() -> None:
    assert parked(**{**VARIABLE, "sync_master": 5000.0}).missing == near(4800.0, 5000.0, 5200.0, tolerance=1e-3)
    assert parked(**{**VARIABLE, "sync_master": 100.0}).state == State.M_WAITING_NEXT_CYCLE


def test_a_value_whose_start_is_skipped_is_used_up() -> None:
    pusher = parked(**VARIABLE).put({"sync_assumed": True}).to(810.0)
    assert (pusher.state, pusher.missing) == (State.M_WAITING_NEXT_CYCLE, (0.0, 0.0, 0.0))
    pusher.put({"sync_assumed": False}).to(3000.0)
    assert (pusher.state, pusher.position) == (State.M_WAITING, 0.0)


def test_a_value_that_does_not_change_is_none() -> None:
    pusher = parked(**VARIABLE).to(1300.0).put({"sync_master": 1000.0}).to(9000.0)
    assert (pusher.state, pusher["cycle"]) == (State.M_WAITING, 1)


def test_with_a_period_a_value_is_its_first_occurrence_ahead() -> None:
    pusher = parked(**VARIABLE, master__period=5000.0).to(1100.0).put({"sync_master": 900.0}).to(1250.0)
    assert pusher["master_to_sync"] == near(4650.0)  # 5900
    assert pusher.to(5950.0, 20).position == near(150.0)
    pusher.put({"sync_master": 2000.0}).to(7050.0, 3)
    assert pusher.position == near(150.0)


def test_in_a_variable_cycle_too_the_meetings_of_a_passing_slave_are_joined() -> None:
    pusher = parked(**PASSING, **VARIABLE).to(900.0).put({"sync_master": 2000.0}).to(1300.0)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(381.25))
    assert pusher.to(2350.0).position == near(quintic(250.0, 300.0, 1.0, 400.0, 0.0, 150.0))  # none: to the park


# --- late values are met ----------------------------------------------------------------------------------------------


def test_a_late_value_is_met_from_the_way_home() -> None:
    """Home from 1200 to 1450; at 1300 the slave is at s, s', s'' of that quintic and has 300 to the meeting."""
    pusher = parked(**RECOVERING).to(1300.0)
    before = pusher.slave
    pusher.put({"sync_master": 1600.0}).run(2.0**-20)
    assert (pusher.state, pusher.slave) == (State.M_FOLLOWING, near(*before, tolerance=1e-4))
    assert pusher.missing == near(0.0, 300.0, 500.0, tolerance=1e-5)
    leg = Leg()
    leg.curve(0.0, 250.0, 250.0, 300.0, 1.0, 0.0, 400.0, 0.0)
    s, slope, curvature, _ = leg.at(100.0)
    u, t = 0.5, 300.0
    h = 0.5 * u * u * (1.0 - u) ** 3  # Hermite's function of the curvature
    expected = quintic(t, s, slope, 500.0, 1.0, 150.0) + curvature * t * t * h
    assert pusher.to(1450.0).position == near(expected % 400.0)
    assert pusher.to(1700.0).slave == near(200.0, 100.0, 0.0)
    assert pusher["cycle"] == 1


def test_a_late_value_is_met_from_the_park() -> None:
    pusher = parked(**RECOVERING).to(2000.0).put({"sync_master": 2150.0}).to(2075.0)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(quintic(150.0, 0.0, 0.0, 100.0, 1.0, 75.0)))
    assert pusher.to(2200.0).slave == near(150.0, 100.0, 0.0)


def test_a_value_that_is_not_late_is_met_from_the_park_as_ever() -> None:
    pusher = parked(**RECOVERING).to(2000.0).put({"sync_master": 2300.0}).to(2200.0)
    assert pusher.position == near(18.75)


@pytest.mark.parametrize("values", [{"sync_assumed": True}, {"skip_next_cycle": True}])
def test_a_value_is_not_joined_while_it_would_not_be_carried_out(values: dict[str, Any]) -> None:
    pusher = parked(**RECOVERING).to(2000.0).put({"sync_master": 2150.0, **values}).to(2075.0)
    assert (pusher.state, pusher.position) == (State.M_WAITING_NEXT_CYCLE, 0.0)


@pytest.mark.parametrize(
    ("limits", "joined"),
    [
        # from rest over 150 to 100 and slope 1: s' up to 1.024, s'' up to 0.0140
        ({"max_speed": 103.0}, True),
        ({"max_speed": 102.0}, False),
        ({"max_speed": 102.0, "check_speed": False}, True),
        ({"max_acceleration": 150.0}, True),
        ({"max_acceleration": 130.0}, False),
        ({"max_acceleration": 130.0, "check_acceleration": False}, True),
    ],
)
def test_a_late_value_is_met_within_the_limits_only(limits: dict[str, Any], joined: bool) -> None:
    positions = [quintic(150.0, 0.0, 0.0, 100.0, 1.0, i / 8.0) for i in range(1201)]
    slopes = [(after - before) * 8.0 for before, after in pairwise(positions)]
    assert 1.02 < max(slopes) < 1.03
    pusher = parked(**RECOVERING).to(2000.0).put({"sync_master": 2150.0, **limits}).run(0.01)
    assert pusher.state == (State.M_FOLLOWING if joined else State.M_WAITING_NEXT_CYCLE)
    assert pusher.fault == Fault.NONE


def test_a_late_value_that_is_refused_on_the_way_home_is_kept_for_the_park() -> None:
    pusher = parked(**RECOVERING).to(1300.0).put({"sync_master": 1700.0, "max_speed": 99.0}).run(0.01)
    assert pusher.state == State.M_HOMING
    pusher.put({"max_speed": 0.0})
    assert pusher.to(1600.0).position == near(18.75)


@pytest.mark.parametrize(
    "values", [{"recover_late_sync": False}, {"stop_in_park": True}, {"slave_cycle": 0.0}, {"sync_master": 1290.0}]
)
def test_nothing_else_is_joined(values: dict[str, Any]) -> None:
    late = {"sync_master": values.pop("sync_master", 1600.0)}
    pusher = parked(**{**RECOVERING, **values}).to(1300.0)
    before = pusher.state
    assert pusher.put(late).to(1400.0).state == (State.M_HOMING if before == State.M_DECEL else before)


def test_peaks_of_a_quintic() -> None:
    leg, peaks = Leg(), Peaks()
    leg.curve(0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0)  # 10 u^3 - 15 u^4 + 6 u^5
    peaks.measure(leg.quintic)
    assert (peaks.slope, peaks.curvature) == near(1.875 / 2.0, 10.0 / math.sqrt(3.0) / 4.0)


# --- positioning ------------------------------------------------------------------------------------------------------


def test_the_move_to_the_park_is_time_optimal() -> None:
    """From 500: v 500, a 5000, j 50000: ramps of 0.2 s and 50 each, 400 at 500: 1.2 s."""
    pusher = Pusher({"slave.initial_position": 500.0}).give("position_to_park").run(0.1)
    assert pusher.state == State.M_POSITIONING
    assert pusher.slave == near(500.0 - 50000.0 * 0.001 / 6.0, -250.0, -5000.0)
    assert pusher.run(0.5).slave == near(250.0, -500.0, 0.0)
    assert pusher.run(0.599).state == State.M_POSITIONING
    assert (pusher.run(0.002).state, pusher.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))


def test_what_the_master_does_during_the_move_to_the_park_does_not_matter() -> None:
    """The move ends after 1.2 s, when the master is at 120."""
    pusher = Pusher({"slave.initial_position": 500.0}, speed=100.0).give("position_to_park").run(9.0)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(18.75))
    pusher = Pusher({"slave.initial_position": 500.0}, speed=-100.0, place=700.0).give("position_to_park").run(1.0)
    pusher.speed = 100.0
    pusher.run(0.1).run(0.1)
    assert (pusher.state, pusher.fault, pusher["master_to_start"]) == (State.M_WAITING, Fault.NONE, near(180.0))


@pytest.mark.parametrize(("initial", "first"), [(390.0, 1.0), (10.0, -1.0), (-30.0, 1.0), (599.0, -1.0), (601.0, 1.0)])
def test_a_cyclic_slave_goes_to_the_nearest_turn_of_its_park(initial: float, first: float) -> None:
    pusher = Pusher({**CYCLIC, "slave.initial_position": initial}).give("position_to_park").run(0.02)
    assert math.copysign(1.0, pusher.slave[1]) == first
    assert (pusher.run(5.0).state, pusher.slave) == (State.M_WAITING, (0.0, 0.0, 0.0))


def test_a_slave_that_stands_right_is_positioned_at_once_and_needs_no_limits() -> None:
    limits = {f"positioning.{name}": 0.0 for name in ("velocity", "acceleration", "jerk")}
    pusher = Pusher(limits, speed=100.0).give("position_to_park").to(900.0)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(18.75))
    pusher = Pusher({**limits, "slave.initial_position": 1.0}).give("position_to_park").run(1.0)
    assert (pusher.state, pusher.fault, pusher.position) == (State.M_IDLE, Fault.POSITIONING, 1.0)


def test_a_positioning_is_refused_while_the_slave_moves() -> None:
    pusher = parked().to(1100.0).give("position_to_park").to(1150.0)
    assert (pusher.state, pusher.fault, pusher["error"]) == (State.M_SYNCHRONIZED, Fault.POSITIONING, True)
    assert pusher.position == near(250.0)
    pusher.give("reset").to(1160.0)
    assert (pusher.state, pusher.fault, pusher["error"]) == (State.M_SYNCHRONIZED, Fault.NONE, False)


def test_the_next_accepted_command_clears_a_refusal() -> None:
    pusher = parked().to(1050.0).give("position_to_cycle").run(0.01)
    assert pusher.fault == Fault.POSITIONING
    assert pusher.give("end_synchronism").run(0.01).fault == Fault.NONE


def test_where_the_master_stands_the_slave_can_be_positioned_to_its_park_in_the_middle_of_a_cycle() -> None:
    pusher = parked().to(1100.0)
    pusher.speed = 0.0
    pusher.run(0.1).give("position_to_park").run(3.0)
    assert (pusher.state, pusher.position, pusher["master_to_sync"]) == (State.M_WAITING, 0.0, near(900.0))


@pytest.mark.parametrize(
    ("place", "values", "state", "position"),
    [
        (500.0, {}, State.M_HOMING, 400.0 * (1.0 - quintic(400.0, 0.0, 0.0, 1.0, 0.0, 100.0))),
        (500.0, {"space_wait_in_park": 300.0, "master_cycle": 2000.0, "sync_master": 2000.0}, State.M_HOMING, None),
        (1700.0, {"space_wait_in_park": 300.0}, State.M_WAITING, 0.0),
        (900.0, {}, State.M_FOLLOWING, 18.75),
        (1100.0, {}, State.M_SYNCHRONIZED, 200.0),
        (1300.0, {}, State.M_DECEL, 381.25),
        (1100.0, {"align_center": True}, State.M_DECEL, 300.0),
        (-700.0, {}, State.M_DECEL, 381.25),
        (1325.0, CYCLIC, State.M_HOMING, 389.0625),
        (1500.0, CYCLIC, State.M_WAITING, 0.0),
        (925.0, {**CYCLIC, "master_cycle": 500.0}, State.M_FOLLOWING, 26.5625),  # the undisturbed cycle's way
        (775.0, {**PASSING, "master_cycle": 500.0}, State.M_FOLLOWING, quintic(300.0, 300.0, 1.0, 500.0, 1.0, 75.0)),
        (2000.0, {**PASSING, "master_cycle": 1500.0}, State.M_FOLLOWING, 0.0),
        (2900.0, {**PASSING, "master_cycle": 1500.0}, State.M_FOLLOWING, 18.75),
        (700.0, VARIABLE, State.M_WAITING, 0.0),
        (900.0, VARIABLE, State.M_FOLLOWING, 18.75),
        (1600.0, VARIABLE, State.M_HOMING, 200.0),
        (1900.0, VARIABLE, State.M_WAITING, 0.0),
        (1325.0, {**PASSING, **VARIABLE}, State.M_HOMING, 389.0625),
    ],
)
def test_a_positioning_to_the_cycle_leads_to_where_the_cycle_has_the_slave(
    place: float, values: dict[str, Any], state: State, position: float | None
) -> None:
    pusher = Pusher({**values, "slave.initial_position": 20.0}, place=place).give("position_to_cycle").run(0.01)
    assert pusher.state == State.M_POSITIONING
    pusher.run(3.0)
    assert pusher.state == state
    if position is not None:
        assert pusher.slave == near(position, 0.0, 0.0)
    if values in ({}, CYCLIC):  # then it goes on as one that has never done anything else
        pusher.speed = 100.0
        other = parked(place=place - 2000.0, **values).to(place + 333.0, 100)
        assert pusher.to(place + 333.0).slave == near(*other.slave, tolerance=1e-8)


def test_in_a_variable_cycle_without_a_value_there_is_no_cycle_to_be_positioned_to() -> None:
    pusher = parked(**VARIABLE).to(3000.0)
    pusher.speed = 0.0
    pusher.give("position_to_cycle").run(1.0)
    assert (pusher.state, pusher.fault) == (State.M_WAITING, Fault.POSITIONING)


def test_the_master_must_not_move_during_the_positioning_to_the_cycle() -> None:
    """1e-6 is passed after 0.1 s at 1e-5; the slave has then 250 and slows down with 5000."""
    pusher = Pusher({"slave.initial_position": 20.0}, place=1600.0, speed=1e-5).give("position_to_cycle").run(0.0999)
    assert pusher.state == State.M_POSITIONING
    pusher.run(0.0011)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.MASTER_MOVED)
    assert pusher.slave[1] == near(250.0 - 5.0, tolerance=1e-5)
    assert pusher.slave[2] == -5000.0


def test_the_master_may_move_a_little() -> None:
    pusher = Pusher({"slave.initial_position": 20.0}, place=1600.0, speed=1e-7).give("position_to_cycle").run(3.0)
    assert (pusher.state, pusher.position) == (State.M_HOMING, near(200.0, tolerance=1e-6))


# --- faults -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "refusal"),
    [
        ({}, Refusal.NONE),
        ({"sync_slave": 0.0}, Refusal.ORDER),
        ({"sync_out": 100.0}, Refusal.ORDER),
        ({"slave_cycle": 300.0}, Refusal.ORDER),
        ({"slave_cycle": 300.1}, Refusal.NONE),
        ({"master_cycle": 600.0}, Refusal.ROOM_LINEAR),  # 200 + 200 + 200
        ({"master_cycle": 600.1}, Refusal.NONE),
        ({"master_cycle": 1000.0, "space_wait_in_park": 400.0}, Refusal.ROOM_LINEAR),
        ({"master_cycle": 200.0, "slave_cycle": 400.0}, Refusal.ROOM_CYCLIC),
        ({"master_cycle": 200.1, "slave_cycle": 400.0}, Refusal.NONE),
        ({"master_cycle": 300.0, "slave_cycle": 400.0, "space_wait_in_park": 100.0}, Refusal.ROOM_CYCLIC),
    ],
)
def test_parameters_that_are_out_of_order_or_leave_no_room_are_refused(values: Any, refusal: Refusal) -> None:
    assert refused(**values) == refusal


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"sync_slave": math.nan}, Fault.ORDER),
        ({"k_slave_master": 0.0}, Fault.RATIO),
        ({"k_slave_master": -1.0}, Fault.RATIO),
        ({"master_cycle": 0.0}, Fault.NO_ROOM),
    ],
)
def test_at_the_park_they_are_judged_as_soon_as_no_start_can_be_told(changed: dict[str, Any], fault: Fault) -> None:
    pusher = parked().to(100.0).put(changed).run(0.01)
    assert (pusher.state, pusher.fault, pusher.slave) == (State.M_IN_ALARM, fault, (0.0, 0.0, 0.0))


def test_a_start_that_is_not_carried_out_is_not_judged() -> None:
    pusher = parked().to(790.0).put({"sync_out": 90.0, "skip_next_cycle": True}).to(810.0)
    assert pusher.state == State.M_WAITING_NEXT_CYCLE
    assert pusher.put({"sync_out": 300.0, "skip_next_cycle": False}).to(1900.0).position == near(18.75)


@pytest.mark.parametrize(
    ("changed", "fault"),
    [
        ({"sync_out": 90.0}, Fault.ORDER),
        ({"space_wait_in_park": -1.0}, Fault.ORDER),
        ({"space_stop_slave": 0.0}, Fault.ORDER),
        ({"master_cycle": 500.0}, Fault.NO_ROOM),  # the meeting stays at 1000
        ({"space_wait_in_park": 500.0}, Fault.NO_ROOM),
    ],
)
def test_later_they_are_judged_when_a_cycle_starts(changed: dict[str, Any], fault: Fault) -> None:
    pusher = parked().to(400.0).put(changed).to(799.0)
    assert (pusher.state, pusher.fault) == (State.M_WAITING, Fault.NONE)
    pusher.to(810.0)
    assert (pusher.state, pusher["state_code"], pusher.fault, pusher["error"]) == (State.M_IN_ALARM, -1, fault, True)
    assert pusher.slave == (0.0, 0.0, 0.0)


def test_the_way_home_is_judged_where_it_is_read() -> None:
    """The slave runs with 100 at 1200; it stops over 1 of it with 5000."""
    pusher = parked().to(1100.0).put({"master_cycle": 500.0}).run(1.0 + 0.01)
    assert (pusher.state, pusher.fault, pusher["cycle"]) == (State.M_IN_ALARM, Fault.NO_ROOM, 1)
    assert pusher.slave == near(300.0 + 1.0 - 0.25, 50.0, -5000.0)
    assert pusher.run(1.0).slave == near(301.0, 0.0, 0.0)


def stopping(phase: float, **limits: Any) -> Pusher:
    """Just before the place of the phase; then the limits come to act."""
    return parked(check_speed=False, check_acceleration=False, **limits).to(phase - 1.0)


@pytest.mark.parametrize(
    ("place", "speed", "acceleration"),
    [
        (900.0, Fault.SPEED_FOLLOWING, Fault.ACCELERATION_FOLLOWING),
        (1100.0, Fault.SPEED_SYNCHRONIZED, Fault.ACCELERATION_SYNCHRONIZED),
        (1300.0, Fault.SPEED_DECEL, Fault.ACCELERATION_DECEL),
        (1500.0, Fault.SPEED_HOMING, Fault.ACCELERATION_HOMING),
    ],
)
def test_limits_are_checked_in_each_phase(place: float, speed: Fault, acceleration: Fault) -> None:
    for fault, name in ((speed, "speed"), (acceleration, "acceleration")):
        pusher = stopping(place, max_speed=1.0, max_acceleration=1.0).put({f"check_{name}": True})
        pusher.run(0.01, acceleration=2.0)
        assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, fault)
        assert stopping(place, max_speed=1.0, max_acceleration=1.0).run(0.01, acceleration=2.0).fault == Fault.NONE


def test_a_limit_that_is_just_reached_or_0_is_kept() -> None:
    assert parked(max_speed=100.0).to(1300.0, 500).fault == Fault.NONE
    assert parked(max_speed=99.99).to(1300.0, 500).fault in (Fault.SPEED_FOLLOWING, Fault.SPEED_SYNCHRONIZED)
    assert parked(max_acceleration=75.0).to(1300.0, 500).fault == Fault.NONE  # s'' = 0.0075 at most
    assert parked(max_acceleration=74.9).to(1300.0, 500).fault == Fault.ACCELERATION_FOLLOWING


def test_what_exceeds_a_limit_is_still_put_out_then_a_linear_ramp_stops_the_slave() -> None:
    pusher = stopping(1100.0, max_speed=50.0, max_acceleration=200.0).put({"check_speed": True}).run(0.01)
    assert (pusher.state, pusher.slave) == (State.M_IN_ALARM, near(200.0, 100.0, 0.0))
    assert pusher.run(0.25).slave == near(200.0 + 25.0 - 6.25, 50.0, -200.0)
    assert pusher["slave.jerk"] == 0.0
    assert pusher.run(0.25).slave == near(225.0, 0.0, 0.0)
    assert pusher.run(9.0).slave == near(225.0, 0.0, 0.0)


def test_without_any_deceleration_the_slave_stops_at_once() -> None:
    pusher = stopping(1100.0, max_speed=50.0, positioning__acceleration=0.0).put({"check_speed": True}).run(0.01)
    assert pusher.run(0.01).slave == near(200.0, 0.0, 0.0)


def test_a_reset_leads_out_of_the_alarm_at_standstill_only() -> None:
    pusher = stopping(1100.0, max_speed=50.0, max_acceleration=200.0).put({"check_speed": True}).run(0.01)
    pusher.give("reset").run(0.1)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.SPEED_SYNCHRONIZED)
    pusher.run(1.0).give("position_to_park").run(0.1)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.SPEED_SYNCHRONIZED)
    pusher.give("reset").run(0.1)
    assert (pusher.state, pusher.fault, pusher["error"], pusher.position) == (
        State.M_IDLE,
        Fault.NONE,
        False,
        near(225.0),
    )
    pusher.run(10.0)
    assert pusher.state == State.M_IDLE
    assert pusher.give("position_to_park").run(3.0).state in (State.M_WAITING, State.M_FOLLOWING)


def test_the_slave_that_was_interrupted_can_be_positioned_to_the_cycle() -> None:
    pusher = stopping(1100.0, max_speed=50.0).put({"check_speed": True}).run(0.01)
    pusher.put({"check_speed": False})
    pusher.speed = 0.0
    pusher.run(1.0).give("reset").run(0.1).give("position_to_cycle").run(1.0)
    assert (pusher.state, pusher.position) == (State.M_SYNCHRONIZED, near(200.0))
    pusher.speed = 100.0
    assert pusher.to(1300.0).position == near(381.25)


@pytest.mark.parametrize(
    ("place", "alarm"), [(900.0, True), (1100.0, True), (1300.0, True), (1500.0, True), (700.0, False)]
)
def test_the_master_must_not_turn_back_in_a_cycle(place: float, alarm: bool) -> None:
    pusher = parked().to(place)
    pusher.speed = 0.0
    pusher.run(0.1)
    before = pusher.slave
    pusher.place -= 0.9e-6
    assert pusher.run(0.1).slave == before  # within 1e-9 of the cycle
    pusher.place += 0.9e-6
    assert pusher.run(0.1).fault == Fault.NONE
    pusher.place -= 1.1e-6
    pusher.run(0.1)
    assert pusher.state == (State.M_IN_ALARM if alarm else State.M_WAITING)
    assert pusher.fault == (Fault.MASTER_BACKWARDS if alarm else Fault.NONE)
    assert pusher.slave == before


def test_a_master_that_turns_back_inside_a_step_stops_the_slave_where_it_turns() -> None:
    pusher = parked().to(1050.0).run(1.0 + 0.1, acceleration=-100.0)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.MASTER_BACKWARDS)
    assert pusher.slave == near(200.0, 0.0, 0.0)


def test_back_and_forth_at_the_park_the_meeting_is_chosen_anew() -> None:
    pusher = parked().to(700.0)
    pusher.speed = -100.0
    assert pusher.to(-700.0).missing == near(500.0, 700.0, 900.0)
    pusher.speed = 100.0
    assert pusher.to(-100.0).position == near(18.75)


@pytest.mark.parametrize("mode", [START, END, ONLY])
def test_a_step_over_too_many_cycles_is_refused(mode: MasterInput) -> None:
    pusher = parked(**CYCLIC, mode=mode).to(100.0).to(200.0)
    before = [cell.get() for cell in pusher.stepper.cells.values()]
    last = dict(pusher.read(("master.position", "master.velocity")))
    pusher.put({"master.position": 1.1e9, "master.velocity": 1.1e9})
    assert pusher.block.step(1.0) == Refusal.CYCLES
    assert [cell.get() for cell in pusher.put(last).stepper.cells.values()] == before
    assert pusher.to(900.0).position == near(18.75)


def test_with_wrong_parameters_a_positioning_to_the_cycle_is_refused() -> None:
    pusher = Pusher().put({"k_slave_master": 0.0}).give("position_to_cycle").run(5.0)
    assert (pusher.state, pusher.fault) == (State.M_IDLE, Fault.POSITIONING)
    pusher = Pusher({"slave.initial_position": 10.0}).put({"k_slave_master": 0.0}).give("position_to_park").run(5.0)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.RATIO)  # at the park


def test_a_variable_meeting_without_room_is_dropped() -> None:
    """M_f = 2 * 350 with sync_slave 350: home would take up to 2000 - 700 from 1400, which is behind."""
    changed = {"sync_slave": 350.0, "sync_out": 360.0, "space_wait_in_park": 80.0, "sync_master": 2000.0}
    pusher = parked(**VARIABLE).to(1100.0).put({**changed, "master_cycle": 1000.0}).to(1199.0)
    pusher.put({"master_cycle": 995.0}).to(1250.0)
    assert (pusher.state, pusher.fault) == (State.M_IN_ALARM, Fault.NO_ROOM)
    pusher = parked(**VARIABLE, slave_cycle=600.0).to(1100.0).put({"sync_master": 2000.0}).to(1250.0)
    assert (pusher.state, pusher["master_to_sync"]) == (State.M_HOMING, near(750.0))


def test_the_value_of_an_interrupted_cycle_still_counts() -> None:
    pusher = stopping(1100.0, max_speed=50.0, **VARIABLE).put({"check_speed": True}).run(0.01)
    pusher.put({"check_speed": False})
    pusher.speed = 0.0
    pusher.run(1.0).give("reset").run(0.1).give("position_to_cycle").run(1.0)
    assert (pusher.state, pusher.position) == (State.M_SYNCHRONIZED, near(200.0))
    pusher.speed = 100.0
    assert pusher.put({"sync_master": 2300.0}).to(1750.0).position == near(200.0)
    assert pusher.to(2200.0).position == near(18.75)


# --- the master -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", [START, END, ONLY])
@pytest.mark.parametrize("period", [0.0, 1000.0, 3000.0, 700.0, 5000.0])
@pytest.mark.parametrize("values", [{}, {**PASSING, "master_cycle": 500.0}, {**CYCLIC, "master_cycle": 400.0}])
def test_a_period_of_the_master_changes_nothing(mode: MasterInput, period: float, values: dict[str, Any]) -> None:
    pusher, other = (parked(**values, mode=mode, master__period=p) for p in (0.0, period))
    for _ in range(100):
        place = pusher.place + 93.7
        assert other.to(place).slave == near(*pusher.to(place).slave, tolerance=1e-8)
        assert other.missing == near(*pusher.missing, tolerance=1e-8)


def test_positions_count_from_the_present_turn() -> None:
    """So they keep their last bits over any number of turns."""
    pusher = parked(master__period=1000.0)
    for _ in range(50):
        pusher.to(pusher.place + 7083.7)
        course = pusher.block.course
        assert max(abs(x) for x in (pusher.block.master.end, course.place, course.leg.begin, course.leg.end)) < 3000.0
    assert pusher["cycle"] == 353  # 354185 - 1200


def test_the_seam_may_hold_a_start() -> None:
    """The master jumps over it between two steps."""
    pusher = parked().to(790.0)
    pusher.place = 900.0
    pusher.run(2.0**-30)
    assert (pusher.state, pusher.position) == (State.M_FOLLOWING, near(18.75, tolerance=1e-6))


# --- the FMU ----------------------------------------------------------------------------------------------------------


def test_the_log_names_variables_and_values(tmp_path: Path) -> None:
    fmu = build_python(Recipe("Follower"), tmp_path / "Follower.fmu")
    with (
        FmuInstance(fmu) as host,
        pytest.raises(FmuError, match=r"master_cycle must be greater .*master_cycle = 500, .*"),
    ):
        host.initialize({"master_cycle": 500.0})
    with FmuInstance(fmu) as host, pytest.raises(FmuError, match="k_slave_master = 0 is not allowed"):
        host.initialize({"k_slave_master": 0.0})
    with FmuInstance(fmu) as host:
        host.initialize({"slave.initial_position": 10.0})
        host.step(0.1, {"position_to_park": True, "positioning.jerk": 0.0})
        assert any("positioning refused" in text and "positioning.jerk = 0" in text for text in host.messages)


def test_refusals_and_faults_speak_of_variables_of_the_block() -> None:
    names = {v.name for v in variables(Follower())}
    refusals = [refusal for refusal in Refusal if refusal not in (Refusal.NONE, getattr(Refusal, "MASTER_TURNS", None))]
    assert refusals
    assert all({*choice.names} <= names for choice in (*refusals, *Fault))


UNITS = {
    "master_cycle": "mm",
    "sync_master": "mm",
    "space_wait_in_park": "mm",
    "master_to_sync": "mm",
    "master.velocity": "mm/s",
    "slave_cycle": "deg",
    "sync_out": "deg",
    "max_speed": "deg/s",
    "positioning.jerk": "deg/s3",
    "slave.initial_position": "deg",
    "slave.position": "deg",
    "slave.acceleration": "deg/s2",
    "k_slave_master": "deg/mm",
    "local.meeting_position": "mm",
    "local.progress": None,
}


def units_of(fmu: Path) -> dict[str, str | None]:
    found = read_model_description(str(fmu))
    return {v.name: v.declaredType.unit if v.declaredType else None for v in found.modelVariables if v.type == "Real"}


def test_the_slave_may_be_in_a_unit_of_its_own(tmp_path: Path) -> None:
    own = Recipe("Follower", "mm", {}, "deg")
    found = units_of(build_python(own, tmp_path / "own.fmu"))
    assert {name: found[name] for name in UNITS} == UNITS
    assert own.guid() != Recipe("Follower", "mm").guid()
    same = units_of(build_python(Recipe("Follower", "m"), tmp_path / "same.fmu"))
    assert (same["slave.position"], same["positioning.velocity"], same["k_slave_master"]) == ("m", "m/s", "1")
    with pytest.raises(UserError, match="the slave of Synchronizer is in its master's unit"):
        Recipe("Synchronizer", "mm", {}, "deg").block()
    with pytest.raises(UserError, match="slave unit"):
        Recipe("Follower", "mm", {}, "km").block()


@pytest.mark.parametrize(
    ("kind", "unit", "slave_unit", "name"),
    [
        (Unit.SLAVE_PER_MASTER, "mm", "m", "m/mm"),
        (Unit.SLAVE_PER_MASTER, "1", "deg", "deg"),
        (Unit.SLAVE_PER_MASTER, "rad", "1", "1/rad"),
        (Unit.SLAVE_PER_MASTER, "deg", "deg", "1"),
        (Unit.SLAVE_JERK, "deg", "mm", "mm/s3"),
        (Unit.SLAVE_JERK, "deg", "", "deg/s3"),
    ],
)
def test_names_of_units(kind: Unit, unit: str, slave_unit: str, name: str) -> None:
    assert unit_name(kind, unit, slave_unit) == name


def test_the_states_have_the_numbers_of_the_source() -> None:
    assert [int(state) for state in State] == [-1, 1, 2, 3, 4, 5, 8, 9, 10]


def test_the_report_tells_the_units_of_both_axes() -> None:
    assert axis_label(Unit.VELOCITY, "mm", "deg") == "mm/s, slave deg/s"
    assert axis_label(Unit.VELOCITY, "mm") == axis_label(Unit.VELOCITY, "mm", "mm") == "mm/s"
    scenario = load(ROOT / "scenarios" / "Follower" / "cyclic_through" / "scenario.toml")
    assert (scenario.unit, scenario.slave_unit) == ("mm", "deg")
    times = np.array([0.0, 1.0])
    by_name = {v.name: v for v in variables(Follower())}
    outputs = [v.name for v in by_name.values() if v.causality in ("output", "local")]
    course = Recording(times, {name: np.zeros(2) for name in outputs}, np.zeros((2, 4)), [])
    titles = [axis.title.text for axis in plots(scenario, course, by_name).select_yaxes()]
    assert titles[:2] == ["position<br>mm, slave deg", "velocity<br>mm/s, slave deg/s"]
