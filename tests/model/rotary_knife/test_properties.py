"""The RotaryKnife on random knives and lines: continuity, limits, direction, step sizes, state, and finite numbers."""

from collections.abc import Iterator
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.rotary_knife.block import RotaryKnife
from motionsync.rotary_knife.interface import State
from motionsync_fmu.interface.recipe import declared_variables
from tests.model.rotary_knife.harness import RotaryKnifeHarness
from tests.model.rotary_knife.strategies import random_knife, random_window
from tests.support.harness import MOTION
from tests.support.line_phases import (
    COMMANDS,
    DURATION,
    GENERATIONS,
    LENGTH,
    LINE,
    START,
    Phase,
    modes,
    multiples_of,
    rngs,
    run_phase,
)

settings.register_profile("rotary knife", derandomize=True, deadline=None, max_examples=20, phases=GENERATIONS)
repeatable = settings.get_profile("rotary knife")


def knife_values(rng: Random, **values: Any) -> dict[str, Any]:
    """A knife for pieces of about LENGTH on a line of about LINE."""
    start = random_knife(rng, LENGTH, DURATION) | random_window(rng, LENGTH, DURATION)
    start |= {"length": LENGTH * rng.choice((1.0, 0.7, 1.5, 2.8))}
    start |= {"kerf": rng.choice((0.0, 5.0)), "allow_parking": True, "order.length": LENGTH * rng.uniform(0.7, 1.3)}
    return start | {name.replace("__", "."): value for name, value in values.items()}


def speed_for(values: dict[str, Any], share: float) -> float:
    """A line velocity that is this share of what the knife can follow with its length."""
    return share * float(RotaryKnifeHarness(values)["limits.max_line_velocity"])


def random_line(rng: Random, speed: float, phases: int, *, back: bool = True) -> Iterator[Phase]:
    """The line runs, gets faster and slower; `back`: it turns back now and then."""
    present = speed
    for _ in range(phases):
        shares = (1.0, 1.0, 0.9, 0.5, rng.uniform(0.3, 1.0), 0.0, *((-0.3,) if back else ()))
        target = speed * rng.choice(shares)
        duration = DURATION * rng.uniform(0.4, 0.8)
        yield Phase(duration, (target - present) / duration)
        present = target
        yield Phase(DURATION * rng.uniform(0.1, 1.5))


def travel_between(knife: RotaryKnifeHarness, before: float, after: float) -> float:
    """By how much the knife has turned, by less than half a turn."""
    turn = knife["knife.turn"]
    return float((after - before + 0.5 * turn) % turn - 0.5 * turn)


# --- continuity, limits, direction ------------------------------------------------------------------------------------


@settings(repeatable, max_examples=15)
@given(rngs, modes)
def test_position_velocity_and_acceleration_have_no_step(rng: Random, mode: MasterInput) -> None:
    """Each is the next one's integral over every event, to the rule of trapezoids; the acceleration jumps only where
    the line's does."""
    values = knife_values(rng)
    knife = RotaryKnifeHarness(values, speed=speed_for(values, 0.7), mode=mode).give("start")
    speed, line_acceleration = knife.speed, 0.0
    slope = 6.0 * values["knife.turn"] / values["knife.blades"] / LENGTH  # steeper than any curve here
    for phase in random_line(rng, speed, 3):
        knife.give(*(c for c in ("cut_now", "start", "order.add") if rng.random() < 0.15))
        rows = {knife.time: knife.read(MOTION)}
        rows |= knife.rows(phase.duration, acceleration=phase.acceleration, cuts=multiples_of(phase.duration, 0.002))
        jerk = 1.2 * max(values["axis.max_jerk"], *(abs(row["slave.jerk"]) for row in rows.values()))
        for number, ((before, x), (after, y)) in enumerate(pairwise(rows.items())):
            h = after - before
            jump = slope * abs(phase.acceleration - line_acceleration) if number == 0 else 0.0
            gap = abs(y["slave.acceleration"] - x["slave.acceleration"])
            assert gap <= h * jerk + jump + 1e-6 * values["axis.max_acceleration"]
            trapezoid = 0.5 * h * (x["slave.acceleration"] + y["slave.acceleration"])
            allowed = h * h * jerk + h * jump + 1e-9 * values["axis.max_velocity"]
            assert abs(y["slave.velocity"] - x["slave.velocity"] - trapezoid) <= allowed
            trapezoid = 0.5 * h * (x["slave.velocity"] + y["slave.velocity"])
            travel = travel_between(knife, x["slave.position"], y["slave.position"])
            assert abs(travel - trapezoid) <= h * h * h * jerk + h * h * jump + 1e-9 * values["knife.turn"]
        line_acceleration = phase.acceleration


@settings(repeatable, max_examples=20)
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


# --- records ----------------------------------------------------------------------------------------------------------


@repeatable
@given(rngs, modes)
def test_all_material_is_recorded(rng: Random, mode: MasterInput) -> None:
    """Pieces, kerfs and corrections are the material from the front end to the last cut, whatever is ordered."""
    values = knife_values(rng, length_correction=-2.0, late_mode=rng.choice((1, 2)), length_tolerance=1e9)
    knife = RotaryKnifeHarness(values, speed=speed_for(values, 0.8), mode=mode).give("start")
    lengths: list[float] = []
    for phase in random_line(rng, knife.speed, 6, back=False):
        knife.set({"order.length": LENGTH * rng.uniform(0.6, 2.0), "waste": rng.random() < 0.2})
        knife.give(*(c for c in ("cut_now", "take_sample", "order.add", "order.skip") if rng.random() < 0.2))
        for _ in range(max(int(phase.duration / 0.02), 1)):
            cuts = knife["statistics.cuts"]
            knife.run(0.02, acceleration=phase.acceleration)
            if knife["statistics.cuts"] > cuts:
                assert knife["statistics.cuts"] == cuts + 1
                lengths.append(knife["last.length"])
    removed = len(lengths) * (values["kerf"] + values["length_correction"])
    front = -0.5 * values["kerf"]
    passed = values["material_factor"] * knife.block.material.last_cut - front
    if lengths:
        assert sum(lengths) + removed == pytest.approx(passed, rel=1e-9)
    counts = [knife[f"statistics.pieces_{kind}"] for kind in ("good", "bad", "sample", "waste")]
    assert sum(counts) == knife["statistics.cuts"] == len(lengths)


# --- step sizes and input modes ---------------------------------------------------------------------------------------

SCALES = {"POSITION": LENGTH, "VELOCITY": LINE, "TIME": DURATION}
OF_KNIFE = ("slave", "peaks")
COMPARED = {  # each with its scale
    v.name: SCALES.get(v.declaration.unit.name, 1.0) if v.kind == "Real" else 0.0
    for v in declared_variables(RotaryKnife).values()
    if v.causality in ("output", "local") and v.name not in ("local.skip_reason", "slave.position")
}


def read_outputs(knife: RotaryKnifeHarness, values: dict[str, Any]) -> dict[str, tuple[Any, float]]:
    """All outputs and locals with their scales; 0: they must be equal."""
    outputs = {}
    for name, value in knife.read(COMPARED).items():
        group, _, quantity = name.partition(".")
        outputs[name] = (value, values[f"axis.max_{quantity}"] if group in OF_KNIFE else COMPARED[name])
    return outputs


def assert_same_outputs(one: RotaryKnifeHarness, other: RotaryKnifeHarness, values: dict[str, Any]) -> None:
    second = read_outputs(other, values)
    assert [
        (name, value, second[name][0])
        for name, (value, scale) in read_outputs(one, values).items()
        if abs(value - second[name][0]) > 1e-9 * scale * max(1.0, abs(value) / LENGTH)
    ] == []
    assert abs(travel_between(one, one["slave.position"], other["slave.position"])) <= 1e-9 * values["knife.turn"]


@settings(repeatable, max_examples=20)
@given(rngs, st.sampled_from([0.001, 0.007, None]), modes, modes, st.sampled_from([0.0, 0.7 * LENGTH, 4.0 * LENGTH]))
def test_any_two_step_sizes_and_input_modes_agree(
    rng: Random, step: float | None, one: MasterInput, other: MasterInput, period: float
) -> None:
    """In all outputs, where the line's acceleration changes: as few steps as there can be, and steps of 1 ms, 7 ms or
    random ones."""
    values = knife_values(rng, late_mode=rng.choice((1, 2, 3)), master__period=period, change_mode=rng.choice((1, 2)))
    speed = speed_for(values, rng.choice((0.7, 0.9, 1.2)))
    few, many = (RotaryKnifeHarness(values, speed=speed, mode=mode).give("start") for mode in (one, other))
    for phase in random_line(rng, speed, 2 if step == 0.001 else 5):
        new = {"hold": rng.random() < 0.05} | ({"length": LENGTH * rng.uniform(0.6, 2.5)} if rng.random() < 0.3 else {})
        now = Phase(phase.duration, phase.acceleration, new, tuple(c for c in COMMANDS if rng.random() < 0.05))
        fewest = multiples_of(phase.duration, 0.2 * LENGTH / LINE) if period else []
        cuts = multiples_of(phase.duration, step) if step else [rng.random() * phase.duration for _ in range(20)]
        run_phase(few, now, fewest)
        run_phase(many, now, [*cuts, *fewest])
        assert_same_outputs(few, many, values)


# --- numbers ----------------------------------------------------------------------------------------------------------
