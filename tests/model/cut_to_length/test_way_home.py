"""The way home, fast or eased, and the ends of the stroke; numbers by hand.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

from math import sqrt
from typing import Any

import pytest

from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import State, ToolMode
from tests.model.cut_to_length.harness import (
    JUST,
    REFERENCE,
    CutToLengthHarness,
    assert_state,
    near,
    started_machine,
)

FEEDBACK: dict[str, Any] = {"tool.mode": ToolMode.FEEDBACK}


# --- the way home -----------------------------------------------------------------------------------------------------


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
    saw = started_machine().at(time)
    assert saw.state == State.RETURNING
    assert saw.slave == near(*setpoint, tolerance=1e-8)


def test_the_way_home_has_limits_of_its_own() -> None:
    """600 u/s, 5000 and 8000 u/s2, 100000 u/s3: R(1600; 5000) = 0.37; R(600; 8000) = 2 sqrt(600 / 100000) = r, since
    600 < 8000^2 / 100000. G = -200 0.37 + 300 r, T_r = 0.37 + r + (350 - G) / 600."""
    r = 2.0 * sqrt(0.006)
    way = 0.37 + r + (350.0 + 74.0 - 300.0 * r) / 600.0
    limits = {"velocity": 600.0, "acceleration": 5000.0, "deceleration": 8000.0, "jerk": 100000.0}
    saw = started_machine({f"homing.{name}": value for name, value in limits.items()}).at(3.05)
    assert saw["local.home_time"] == near(1.85 + way)
    assert saw["limits.cycle_time"] == near(0.45 + way)


@pytest.mark.parametrize(("deceleration", "in_use"), [(None, 4000.0), (0.0, 4000.0), (6000.0, 6000.0)])
def test_a_deceleration_that_nobody_sets_is_the_acceleration(deceleration: float | None, in_use: float) -> None:
    """The carriage brakes with it in front of home."""
    values: dict[str, Any] = {"length": 2500.0, "axis.max_velocity": 1500.0, "axis.max_acceleration": 4000.0}
    if deceleration is not None:
        values["axis.max_deceleration"] = deceleration
    saw = CutToLengthHarness(values, speed=1000.0).give("start").at(2.6)
    rows = saw.rows(1.5, cuts=[0.005 * i for i in range(300)]).values()
    assert max(row["slave.acceleration"] for row in rows if row["slave.velocity"] < 0.0) == near(in_use)
    assert not saw["warning.limit_exceeded"]


EASE: dict[str, Any] = {"homing.ease": True, "length": 3000.0}
# L = 3000, cut ends at 3.35, s = 350. T_b = R(1000) = 0.15, S_b = 425, T_0 = 2 R(1500) + (425 - 300) / 1500 = 0.483333.
# A = 5.9 - 3.35 - 0.02 = 2.53: sigma = T_0 / (A - T_b) = 0.203081; peak 1500 sigma.
SHARE = (0.4 + 125.0 / 1500.0) / 2.38


def test_an_eased_way_home_arrives_just_in_time() -> None:
    saw = started_machine(EASE).at(3.5)
    assert saw.slave == near(425.0, 0.0, 0.0)
    assert saw["local.ease"] == near(SHARE)
    saw.at(3.5 + 0.2 / SHARE)  # the acceleration, R(1500) = 0.2 s, takes so much longer
    assert saw.slave == near(275.0, -1500.0 * SHARE, 0.0)
    assert_state(saw, 5.88, State.RETURNING, State.WAITING)
    assert saw["local.home_time"] == near(5.88)
    saw.at(6.5)
    assert (saw["last.length"], saw.cut_counts()) == (near(3000.0), (2, 0))


def test_an_eased_way_home_is_no_slower_than_the_slowest() -> None:
    """At least half of the limits: home 0.483333 / 0.5 s after 3.5."""
    saw = started_machine({**EASE, "homing.slowest": 0.5}).at(4.6)
    assert saw["local.home_time"] == near(3.5 + 2.0 * (0.4 + 125.0 / 1500.0))


@pytest.mark.parametrize(
    ("name", "value", "home"),
    [
        ("homing.slowest", 0.5, 3.5 + 2.0 * (0.4 + 125.0 / 1500.0)),
        ("homing.spare_time", 0.12, 5.78),
        ("homing.settle_time", 0.1, 5.78),
        ("homing.ease", False, 3.35 + 0.5 + 125.0 / 1500.0),
    ],
)
def test_what_is_tuned_of_the_way_home_alone_is_taken_over(name: str, value: Any, home: float) -> None:
    """While the piece is cut; nothing else is tuned."""
    saw = started_machine(EASE).at(3.2).set({name: value}).at(5.89)
    assert saw["local.home_time"] == near(home)


def test_without_time_to_spare_the_way_home_is_the_fast_one() -> None:
    """L = 1100: A = (2100 - 1450) / 1000 - 0.02 = 0.63 < T_b + T_0 = 0.633333."""
    saw = started_machine({**EASE, "length": 1100.0}).at(2.1)
    assert saw["local.home_time"] == near(1.45 + 0.583333333333)
    assert saw["local.ease"] == 1.0


@pytest.mark.parametrize("why", ["speed", "acceleration", "length", "cut_now"])
def test_an_eased_way_home_ends_when_there_is_no_longer_time(why: str) -> None:
    saw = started_machine({**EASE, "change_mode": 2}).at(3.8)
    assert saw["local.ease"] == near(SHARE)
    position = saw.slave[0]
    if why == "speed":
        saw.speed = 1001.0
    elif why == "length":
        saw.set({"length": 2900.0})
    elif why == "cut_now":
        saw.give("cut_now")
    saw.run(0.2, acceleration=10.0 if why == "acceleration" else 0.0)
    assert saw["local.ease"] == 1.0
    assert saw.slave[1] < -1000.0
    assert saw.slave[0] < position


def test_a_line_that_slows_down_leaves_the_eased_way_home_as_it_is() -> None:
    saw = started_machine(EASE).at(3.8).run(0.5, acceleration=-100.0)
    assert saw["local.ease"] == near(SHARE)
    saw.at(5.9)
    assert saw["local.home_time"] == near(5.88)


def test_after_stop_the_way_home_is_not_eased() -> None:
    saw = started_machine(EASE).at(3.0).give("stop").at(4.0)
    assert saw["local.home_time"] == near(3.35 + 0.583333333333)


# --- the ends of the stroke -------------------------------------------------------------------------------------------


def test_the_end_of_the_stroke() -> None:
    """The tool never reports the end of the cut. The stop from 1000 takes 500 R(1000) = 75: at s = 575, t = 2.075, the
    carriage reverses. It would stop at 650; since it goes on backwards at once, it turns at 575 + 50 - 4.1667 +
    750^2 / 20000 = 648.96."""
    saw = started_machine(FEEDBACK).at(2.075 - JUST)
    assert (saw.state, saw["error"]) == (State.CUTTING, False)
    saw.at(2.075 + JUST)
    assert (saw.state, saw["error_id"], saw["running"]) == (State.FAULT, Fault.STROKE, False)
    assert (saw["tool.command"], saw["statistics.unsynchronised"], saw.cut_counts()) == (False, 1, (0, 0))
    assert saw["line.stop_request"]
    assert saw["line.velocity_request"] == 0.0
    saw.at(2.075 + 0.05 + 0.075)
    assert saw.slave == near(575.0 + 50.0 - 200000.0 * 0.05**3 / 6.0 + 28.125, 0.0, -10000.0, tolerance=1e-8)
    saw.at(3.0)
    assert saw.slave == (0.0, 0.0, 0.0)
    assert saw.state == State.FAULT


def test_the_lower_end_of_the_stroke() -> None:
    """The line takes the carriage back with 500: 250 R(500) = 25, so it reverses at -225."""
    values: dict[str, Any] = {"tool.mode": ToolMode.DISTANCE, "tool.cut_distance": 200.0}
    saw = started_machine(values).at(1.7)
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
