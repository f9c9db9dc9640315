"""CutToLength on random machines and lines: the greatest velocity, limits of the axis, ends of the stroke."""

from random import Random
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import CutToLengthHarness
from tests.model.cut_to_length.strategies import random_machine, random_tool
from tests.support.blocks.drawn import drawn
from tests.support.blocks.harness import MOTION
from tests.support.blocks.line_phases import (
    DURATION,
    LENGTH,
    modes,
    multiples_of,
    rngs,
)

IN_CONTACT = (State.SYNCHRONOUS, State.CUTTING, State.PULLING, State.CLEARING)

repeatable = drawn(25, shrink=False)


def long_stroke_machine(rng: Random, **values: Any) -> dict[str, Any]:
    """For pieces of about LENGTH on a line of about LINE, with a long stroke; it is at home."""
    start = random_machine(rng, LENGTH, DURATION) | random_tool(rng, LENGTH, DURATION)
    start |= {"axis.initial_position": start["home_position"], "axis.max_position": 1e5, "axis.min_position": -1e5}
    start |= {"kerf": rng.choice((0.0, 5.0)), "length_correction": rng.choice((0.0, -2.0)), "homing.ease": False}
    start |= {"tool.mode": rng.choice((ToolMode.TIME, ToolMode.DISTANCE)), "length": LENGTH}
    return start | {name.replace("__", "."): value for name, value in values.items()}


def speed_for(values: dict[str, Any], share: float) -> float:
    """A line velocity that is this share of what the machine can follow with its length."""
    saw = CutToLengthHarness(values, speed=1.0).now()
    return share * float(saw["limits.max_line_velocity"])


# --- sharpness --------------------------------------------------------------------------------------------------------


@drawn(40, shrink=False)
@given(rngs, modes)
def test_the_highest_line_velocity_is_sharp(rng: Random, mode: MasterInput) -> None:
    """At 0.999999 of it every cut is on time, at 1.000001 the warning holds from the beginning and a cut is missed,
    unless the gap that the limit includes is left out."""
    values = long_stroke_machine(rng, approach__reserve=0.0, approach__distance=0.0, gap__distance=0.0)
    if rng.random() < 0.3:  # a gap that the axis can pull at any velocity that it has: jerk 60 g / T^3
        duration = values["gap.travel"] / values["axis.max_velocity"]
        values["gap.distance"] = 0.9 * values["axis.max_jerk"] * duration**3 / 60.0
    values["axis.max_position"] = values["home_position"] + LENGTH * rng.choice((0.6, 1.0, 100.0))
    for share in (0.999999, 1.000001):
        saw = CutToLengthHarness(values, speed=speed_for(values, share), mode=mode).give("start")
        duration = (values["length"] + 10.0) / values["material_factor"] / saw.speed
        saw.run(0.2 * duration)
        assert saw["warning.line_too_fast"] == (share > 1.0)
        assert saw["statistics.skipped"] == 0
        for _ in range(12):
            saw.run(0.5 * duration)
        assert (saw["statistics.skipped"] > 0) == (share > 1.0 and not saw["warning.gap_skipped"])
        assert saw["statistics.late"] == 0
        if share < 1.0:
            assert saw["statistics.cuts"] >= 4
            assert saw["statistics.pieces_good"] == saw["statistics.cuts"]


# --- limits and ends --------------------------------------------------------------------------------------------------


@drawn(25, shrink=False)
@given(rngs, st.floats(0.2, 1.0), modes, st.booleans())
def test_on_a_line_of_constant_velocity_no_limit_is_exceeded(
    rng: Random, share: float, mode: MasterInput, ease: bool
) -> None:
    values = long_stroke_machine(rng, homing__ease=ease)
    saw = CutToLengthHarness(values, speed=speed_for(values, share), mode=mode).give("start")
    acceleration, jerk = values["axis.max_acceleration"], values["axis.max_jerk"]
    bounds = (values["axis.max_velocity"], acceleration, jerk)
    for row in saw.rows(3.5 * LENGTH / saw.speed, cuts=multiples_of(3.5 * LENGTH / saw.speed, 0.0131)).values():
        for name, bound in zip(MOTION[1:], bounds, strict=True):
            assert abs(row[name]) <= bound * (1.0 + 1e-6), name
    assert saw["statistics.cuts"] > 0
    assert not saw["warning.limit_exceeded"]


@drawn(30, shrink=False)
@given(rngs, modes)
def test_the_ends_of_the_stroke_are_never_passed(rng: Random, mode: MasterInput) -> None:
    """The line speeds up or turns back in the cuts, the tool may never answer: the carriage stops in time."""
    values = long_stroke_machine(rng, tool__timeout=0.0, gap__distance=0.0)
    values["tool.mode"] = rng.choice(list(ToolMode))
    home = values["home_position"]
    values |= {"axis.min_position": home - 50.0, "axis.max_position": home + LENGTH}
    speed = speed_for(values, 0.7)
    values["axis.max_position"] = home + 1.3 * CutToLengthHarness(values, speed=speed).now()["limits.stroke"]
    saw = CutToLengthHarness(values, speed=speed, mode=mode).give("start")
    low, high = values["axis.min_position"], values["axis.max_position"]
    change = 0.0
    for _ in range(500):
        if saw.state not in IN_CONTACT:  # in contact the acceleration stays: a jump of it is a jump of the stopping way
            change = speed * rng.choice((-2.0, 0.3, 1.0)) / rng.uniform(0.4, 0.8)
        approached = saw.state in IN_CONTACT
        (row,) = saw.rows(0.02, acceleration=change if approached else (speed - saw.speed) / 0.02).values()
        assert low - 1e-6 <= row["slave.position"] <= high + 1e-6
        if saw.state == State.FAULT:
            break
    for row in saw.rows(1.5, cuts=multiples_of(1.5, 0.01)).values():
        assert low - 1e-6 <= row["slave.position"] <= high + 1e-6
