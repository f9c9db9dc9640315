"""The Gearing engages within a time: the curve, when it starts, where it ends."""

import pytest

from motionsync.gearing.interface import StartMode
from tests.model.gearing.harness import (
    ACTIVE,
    BOTH,
    CCW,
    GEAR_IN,
    INSTANT,
    TIME,
    WAITING_FOR_START,
    GearingHarness,
    engaging_in_time,
    near,
    three_halves,
)
from tests.support.blocks.harness import grid


@pytest.mark.parametrize(
    ("share", "coefficients"),
    [(0.7, (-1.0, 2.5, -1.2)), (0.5, (1.0, -0.5, 0.0)), (0.3, (3.0, -3.5, 1.2)), (-0.2, (8.0, -11.0, 4.2))],
)
@pytest.mark.parametrize("u", [0.25, 0.5, 0.75])
def test_in_time_at_constant_speed(share: float, coefficients: tuple[float, ...], u: float) -> None:
    """c3 = 10 A - 4 B, c4 = -15 A + 7 B, c5 = 6 A - 3 B of v T, with A = 1 - share, B = 1."""
    gear = engaging_in_time(20.0 * share).run(2.0 * u)
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
    rows = engaging_in_time(20.0 * share).rows(2.0, cuts=grid(2.0, 0.01)).values()
    assert (min(row["slave.velocity"] for row in rows) < -1e-9) == backwards
    assert (max(row["slave.velocity"] for row in rows) > 15.0 + 1e-9) == faster


def test_in_time_it_begins_when_the_master_moves_in_that_direction() -> None:
    assert engaging_in_time(10.0, 0.0).run(1.0).state == WAITING_FOR_START
    assert engaging_in_time(10.0, -1.0).run(1.0).state == WAITING_FOR_START
    assert engaging_in_time(10.0, -1.0, start_mode=CCW).run(1.0).state == GEAR_IN
    assert engaging_in_time(10.0, 0.0, start_mode=BOTH).run(1.0).state == WAITING_FOR_START
    assert engaging_in_time(10.0, 0.0, start_mode=BOTH).run(0.1, acceleration=-1.0).state == GEAR_IN
    gear = engaging_in_time(10.0, -10.0).run(1.75, acceleration=10.0)  # turns after 1 s at 95
    assert gear.state == GEAR_IN
    assert gear["local.trigger_position"] == near(95.0)
    assert gear["local.progress"] == near(0.375)


@pytest.mark.parametrize("acceleration", [0.0, 3.0, -5.0, -15.0])
@pytest.mark.parametrize("missing", [-5.0, 0.0, 10.0])
def test_in_time_the_slave_is_on_the_line_at_the_end_whatever_the_master_does(
    acceleration: float, missing: float
) -> None:
    gear = engaging_in_time(missing).run(1.0, acceleration=acceleration).run(0.5, acceleration=-acceleration).run(0.6)
    assert gear.state == ACTIVE
    assert gear.slave == near(1.5 * (gear.master_position - 100.0 - missing), 1.5 * gear.speed, 0.0)


def test_in_time_and_accelerated_it_begins_at_rest() -> None:
    gear = engaging_in_time(10.0, 10.0).run(INSTANT, acceleration=4.0)
    assert gear.slave == near(0.0, 0.0, 0.0, tolerance=1e-7)


def test_in_time_at_rest_and_direct_in_either_direction_it_begins_at_once() -> None:
    gear = GearingHarness(three_halves()).start(start_mode=StartMode.CW_CCW_DIRECT, transition=TIME, time=2.0).run(0.5)
    assert (gear.state, gear["local.progress"]) == (GEAR_IN, 0.25)
    assert gear.run(1.5).state == ACTIVE


@pytest.mark.parametrize("steps", [10, 100, 1000])
def test_many_small_steps_end_a_transition_on_time(steps: int) -> None:
    gear = GearingHarness(speed=10.0).start(start_mode=StartMode.CW_CCW_DIRECT, transition=TIME, time=1.0)
    assert gear.run(1.0, cuts=[i / steps for i in range(1, steps)]).state == ACTIVE
