"""The RotaryKnife on random knives and lines: the limits of the axis, and its direction."""

from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.rotary_knife.interface import State
from tests.model.rotary_knife.harness import RotaryKnifeHarness
from tests.model.rotary_knife.strategies import random_knife, random_window
from tests.support.blocks.drawn import drawn
from tests.support.blocks.harness import MOTION
from tests.support.blocks.line_phases import (
    COMMANDS,
    DURATION,
    LENGTH,
    START,
    Phase,
    modes,
    multiples_of,
    rngs,
)

repeatable = drawn(20, shrink=False)


def knife_values(rng: Random, **values: Any) -> dict[str, Any]:
    """A knife for pieces of about LENGTH on a line of about LINE."""
    start = random_knife(rng, LENGTH, DURATION) | random_window(rng, LENGTH, DURATION)
    start |= {"length": LENGTH * rng.choice((1.0, 0.7, 1.5, 2.8))}
    start |= {"kerf": rng.choice((0.0, 5.0)), "allow_parking": True, "order.length": LENGTH * rng.uniform(0.7, 1.3)}
    return start | {name.replace("__", "."): value for name, value in values.items()}


def speed_for(values: dict[str, Any], share: float) -> float:
    """A line velocity that is this share of what the knife can follow with its length."""
    return share * float(RotaryKnifeHarness(values)["limits.max_line_velocity"])


def random_line(rng: Random, speed: float, phases: int) -> Iterator[Phase]:
    """The line runs, gets faster and slower, and turns back now and then."""
    present = speed
    for _ in range(phases):
        shares = (1.0, 1.0, 0.9, 0.5, rng.uniform(0.3, 1.0), 0.0, -0.3)
        target = speed * rng.choice(shares)
        duration = DURATION * rng.uniform(0.4, 0.8)
        yield Phase(duration, (target - present) / duration)
        present = target
        yield Phase(DURATION * rng.uniform(0.1, 1.5))


@drawn(20, shrink=False)
@given(rngs, st.floats(0.2, 1.0), modes)
def test_on_a_line_of_constant_velocity_no_limit_is_exceeded(rng: Random, share: float, mode: MasterInput) -> None:
    """Not even by 1e-9 of it, with the commands that a knife has."""
    values = knife_values(rng)
    knife = RotaryKnifeHarness(values, speed=speed_for(values, share), mode=mode).give("start")
    bounds = [values[f"axis.max_{name}"] for name in ("velocity", "acceleration", "jerk")]
    for _ in range(6):
        knife.give(*(c for c in ("cut_now", "order.add", "take_sample") if rng.random() < 0.3))
        duration = LENGTH / knife.speed * rng.uniform(0.3, 1.5)
        for row in knife.rows(duration, cuts=multiples_of(duration, duration / 100.0)).values():
            for name, bound in zip(MOTION[1:], bounds, strict=True):
                assert abs(row[name]) <= bound * (1.0 + 2e-9), name
    assert knife["statistics.cuts"] > 0
    assert not knife["warning.limit_exceeded"]


@repeatable
@given(rngs, modes)
def test_a_limit_that_is_exceeded_is_reported(rng: Random, mode: MasterInput) -> None:
    """On a line that speeds up and brakes, with new windows, stops and aborts."""
    values = knife_values(rng)
    knife = RotaryKnifeHarness(values, speed=speed_for(values, 0.9), mode=mode).give("start")
    bounds = [values[f"axis.max_{name}"] for name in ("velocity", "acceleration", "jerk")]
    for phase in random_line(rng, knife.speed, 5):
        knife.set(random_window(rng, LENGTH, DURATION) if rng.random() < 0.2 else {})
        knife.give(*(c for c in COMMANDS if rng.random() < 0.1))
        for row in knife.rows(
            phase.duration, acceleration=phase.acceleration, cuts=multiples_of(phase.duration, 0.01)
        ).values():
            for name, bound in zip(MOTION[1:], bounds, strict=True):
                assert row["warning.limit_exceeded"] or abs(row[name]) <= bound * (1.0 + 2e-6), name


@repeatable
@given(rngs, modes)
def test_only_on_a_line_that_turns_back_the_knife_turns_back(rng: Random, mode: MasterInput) -> None:
    """On a hostile line, which stops, turns back, and jumps in velocity, and with all commands."""
    values = knife_values(rng, late_mode=rng.choice((1, 2, 3)))
    knife = RotaryKnifeHarness(values, speed=speed_for(values, 0.9), mode=mode).give("start")
    for phase in random_line(rng, knife.speed, 6):
        if rng.random() < 0.2 and mode == START:
            knife.speed *= rng.choice((0.0, 0.3, 1.5))
        knife.give(*(c for c in (*COMMANDS, "reset") if rng.random() < 0.1))
        for _ in range(max(int(phase.duration / 0.02), 1)):
            forwards = knife.speed >= 0.0
            before = knife["slave.velocity"]
            (row,) = knife.rows(0.02, acceleration=phase.acceleration).values()
            forwards = forwards and knife.speed >= 0.0
            is_parking = knife.state in (State.PARKING, State.FAULT) and before < 0.0  # it was turning back
            assert not forwards or is_parking or row["slave.velocity"] >= -1e-9 * values["axis.max_velocity"]
