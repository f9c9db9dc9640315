"""The Gearing on random motions: continuity, the line at each end, step sizes, mirrored axes, periods, numbers."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from motionsync.gearing.block import Gearing
from motionsync.gearing.interface import StartMode, State, StopMode, Transition
from motionsync.master import MasterInput
from tests.model.gearing.harness import GearingHarness
from tests.model.gearing.strategies import runs
from tests.support.finite import run_finite
from tests.support.harness import MOTION, Row, advance
from tests.support.runs import BlockRun

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
NONE, MASTER, TIME = Transition.NONE, Transition.MASTER_BASED, Transition.TIME_BASED
TICK = 2.0**-20  # s

settings.register_profile("gearing", derandomize=True, deadline=None, max_examples=100)
repeatable = settings.get_profile("gearing")
rngs = st.integers(0, 2**32 - 1).map(Random)
modes = st.sampled_from([START, END])


@dataclass(frozen=True)
class Phase:
    """A time of constant acceleration of the master, and what is set at its beginning."""

    values: dict[str, Any]
    duration: float
    acceleration: float


def ratios(rng: Random) -> dict[str, int]:
    return {
        "gearing.numerator": rng.choice([1, 3, -2, 7]),
        "gearing.denominator": rng.choice([1, 2, -5]),
    }


def order(rng: Random, engage: bool, master_position: float, length: float, *, smooth: bool = False) -> dict[str, Any]:
    """A random edge of start; `smooth`: without a jump of the velocity."""
    group = "gear_in" if engage else "gear_out"
    values = {
        f"{group}.transition": rng.choice([MASTER, TIME] if smooth else list(Transition)),
        f"{group}.distance": length * rng.uniform(0.2, 1.0),
        f"{group}.time": rng.uniform(0.2, 1.5),
        "start": engage,
    }
    if engage:
        values["gear_in.start_mode"] = rng.choice(list(StartMode))
        values["gear_in.reference_position"] = master_position + length * rng.uniform(-1.0, 1.0)
    else:
        values["gear_out.stop_mode"] = rng.choice(list(StopMode))
        values["gear_out.stop_position"] = length * rng.uniform(-2.0, 2.0)
    return values


def random_phases(
    rng: Random, length: float, *, count: int = 12, smooth: bool = False, ratio: bool = True
) -> list[Phase]:
    """A master that wanders to and fro over the length, stops and turns, and edges of start meanwhile."""
    phases = []
    master_position, speed, engaged = 0.0, 0.0, False
    for _ in range(count):
        values: dict[str, Any] = {}
        if rng.random() < 0.5:
            engaged = not engaged
            values |= order(rng, engaged, master_position, length, smooth=smooth)
        if ratio and rng.random() < 0.1:
            values |= ratios(rng)
        if not smooth and rng.random() < 0.1:
            values["activate"] = rng.random() < 0.7
        duration = rng.uniform(0.1, 1.0)
        target = (
            length * rng.choice([0.0, 1.0, 1.0, -1.0, rng.gauss(0.0, 1.0)])
            if master_position * speed <= 0.0
            else -speed
        )
        change = target - speed
        acceleration = rng.choice([0.0, change / duration]) if abs(change) > 1e-9 * length else 0.0
        phases.append(Phase(values, duration, acceleration))
        master_position, speed = advance(master_position, speed, acceleration, duration)
    return phases


def run_phases(gear: GearingHarness, phases: list[Phase], rng: Random, cuts: int) -> Iterator[dict[float, Row]]:
    """Run the phases, each in steps of random sizes; the rows of each phase."""
    for phase in phases:
        gear.set(phase.values)
        times = [rng.random() * phase.duration for _ in range(rng.randint(0, cuts))]
        yield gear.rows(phase.duration, acceleration=phase.acceleration, cuts=times)


def scales(phases: list[Phase], speed: float, length: float) -> tuple[float, ...]:
    """Of position, velocity and acceleration, and jerk, in the master's terms."""
    v, a = abs(speed), 0.0
    for phase in phases:
        a = max(a, abs(phase.acceleration))
        v = max(v, abs(speed) + abs(phase.acceleration) * phase.duration)
        speed += phase.acceleration * phase.duration
    least = 0.2 * length  # a transition's
    return length, v, a + v * v / least, v**3 / least**2 + 3.0 * v * a / least


# --- step sizes -------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=250)
@given(rngs, st.sampled_from([1.0, 100.0]), modes, modes, st.sampled_from([0.0, 2.7]), st.sampled_from([0.0, 1.3]))
def test_any_two_step_sizes_and_input_modes_agree(
    rng: Random, length: float, one: MasterInput, other: MasterInput, turn: float, slave_turn: float
) -> None:
    """At the phases' ends, and in state."""
    speed = length * rng.choice([0.0, 1.0, -1.0])
    values = {
        **ratios(rng),
        "master.period": turn * length,
        "slave.period": slave_turn * length,
        "slave.initial_position": length * rng.uniform(-1.0, 1.0),
    }
    phases = random_phases(rng, length)
    a = GearingHarness(values, speed=speed, mode=one)
    b = GearingHarness(values, speed=speed, mode=other)
    sizes = scales(phases, speed, length)
    for first, second in zip(run_phases(a, phases, rng, 0), run_phases(b, phases, rng, 6), strict=True):
        x, y = (list(rows.values())[-1] for rows in (first, second))
        assert x["state_code"] == y["state_code"]
        for name, size in zip(MOTION, sizes, strict=True):
            allowed = 1e-9 * 7.0 * 10.0 * size
            gap = x[name] - y[name]
            if name == "slave.position" and slave_turn:
                gap = math.remainder(gap, slave_turn * length)
            assert abs(gap) <= allowed, (name, x["state_code"])


@repeatable
@given(rngs)
def test_turns_of_the_axes_do_not_matter(rng: Random) -> None:
    """An unwrapped input and a wrapped one, whole turns away, give the same."""
    length = 3.0
    values = {**ratios(rng), "master.period": 4.0, "slave.period": 1.5}
    phases = random_phases(rng, length)
    a = GearingHarness(values, speed=1.0)
    b = GearingHarness(values, speed=1.0, master_position=4.0 * rng.randint(-1000, 1000))
    for first, second in zip(run_phases(a, phases, rng, 3), run_phases(b, phases, rng, 3), strict=True):
        x, y = (list(rows.values())[-1] for rows in (first, second))
        assert x["state_code"] == y["state_code"]
        assert math.remainder(x["slave.position"] - y["slave.position"], 1.5) == pytest.approx(0.0, abs=1e-7)


# --- continuity -------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=150)
@given(rngs, modes)
def test_the_position_never_jumps(rng: Random, mode: MasterInput) -> None:
    """Over a short step it changes by the velocity at most; where that jumps, by the greater of the two."""
    length, h = 10.0, 1e-7
    phases = random_phases(rng, length)
    values = {**ratios(rng), "slave.initial_position": rng.uniform(-5.0, 5.0)}
    gear = GearingHarness(values, speed=length * rng.choice([0.0, 1.0, -1.0]), mode=mode)
    for phase in phases:
        gear.set(phase.values)
        for _ in range(5):
            position, velocity = gear["slave.position"], gear["slave.velocity"]
            gear.run(h, acceleration=phase.acceleration)
            greatest = max(abs(velocity), abs(gear["slave.velocity"]))
            assert abs(gear["slave.position"] - position) <= greatest * h + 1e-9
            gear.run(phase.duration / 5 - h, acceleration=phase.acceleration)


@settings(repeatable, max_examples=40)
@given(rngs, modes)
def test_position_velocity_and_acceleration_have_no_step_at_constant_speed(rng: Random, mode: MasterInput) -> None:
    """Each is the next one's integral, over all events, to the rule of trapezoids; the acceleration's change is bounded
    by the greatest jerk."""
    length, h = 10.0, 1e-3
    gear = GearingHarness(ratios(rng), speed=length * rng.choice([1.0, -1.0]), mode=mode)
    rows = [gear.read(MOTION)]
    met = set()
    for engage in (True, False, True, False):
        gear.set(order(rng, engage, gear.master_position, length, smooth=True))
        for _ in range(rng.randint(200, 1500)):
            gear.run(h)
            rows.append(gear.read(MOTION))
            met.add(gear.state)
    assert State.GEAR_IN in met or State.WAITING_FOR_STARTPOSITION in met
    velocity, acceleration, jerk = (max(abs(row[name]) for row in rows) for name in MOTION[1:])
    for x, y in pairwise(rows):
        assert abs(y["slave.acceleration"] - x["slave.acceleration"]) <= 1.2 * h * jerk + 1e-9
        trapezoid = 0.5 * h * (x["slave.acceleration"] + y["slave.acceleration"])
        assert abs(y["slave.velocity"] - x["slave.velocity"] - trapezoid) <= h * h * jerk + 1e-9
        trapezoid = 0.5 * h * (x["slave.velocity"] + y["slave.velocity"])
        assert abs(y["slave.position"] - x["slave.position"] - trapezoid) <= h * h * acceleration + 1e-9
        assert abs(y["slave.position"] - x["slave.position"]) <= 1.2 * h * velocity + 1e-9


@settings(repeatable, max_examples=40)
@given(rngs, st.sampled_from([MASTER, TIME]), modes)
def test_the_engagement_joins_exactly_at_both_ends(rng: Random, transition: Transition, mode: MasterInput) -> None:
    """From the tick before to the tick after, with the accelerating master that comes there."""
    length, speed = 10.0, rng.uniform(8.0, 20.0)
    acceleration = rng.uniform(-1.0, 2.0)
    gear = GearingHarness(ratios(rng), speed=speed, mode=mode)
    gear.start(transition=transition, distance=length, time=0.8, reference_position=rng.uniform(6.0, 9.0))
    gear.run(TICK, acceleration=acceleration)
    rate = abs(gear["gearing.numerator"] / gear["gearing.denominator"])
    for target in (State.GEAR_IN, State.ACTIVE):
        low, high = 0.0, 4.0  # bisect the time of the event
        while high - low > TICK:
            middle = 0.5 * (low + high)
            there = gear.twin().run(middle, acceleration=acceleration).state
            low, high = (middle, high) if there < target else (low, middle)
        before = gear.twin().run(low, acceleration=acceleration) if low > 0.0 else gear
        after = gear.twin().run(high, acceleration=acceleration)
        assert after.state == target
        h = high - low
        steep = rate * (speed + 2.0) ** 2 * 100.0
        assert after.slave[2] == pytest.approx(before.slave[2], abs=100.0 * steep * h)
        gap = after.slave[1] - before.slave[1] - 0.5 * h * (after.slave[2] + before.slave[2])
        assert abs(gap) <= 100.0 * steep * h * h + 1e-9
        gap = after.slave[0] - before.slave[0] - 0.5 * h * (after.slave[1] + before.slave[1])
        assert abs(gap) <= 1e-9


# --- the line ---------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=200)
@given(rngs, st.sampled_from(list(Transition)), modes)
def test_in_gear_the_slave_is_on_the_line_through_the_reference_position(
    rng: Random, transition: Transition, mode: MasterInput
) -> None:
    """Whatever the master does before and after; and after a stop it rests at exactly the stop position."""
    length, s_a = 10.0, rng.uniform(-5.0, 5.0)
    gear = GearingHarness({**ratios(rng), "slave.initial_position": s_a}, mode=mode, speed=rng.uniform(-10.0, 10.0))
    m_a = rng.uniform(-5.0, 5.0)
    gear.start(
        start_mode=StartMode.WITH_CW_CCW_REFERENCE_POSITION,
        transition=transition,
        distance=length * rng.uniform(0.0, 1.0),
        time=rng.uniform(0.1, 2.0),
        reference_position=m_a,
    )
    rate = gear["gearing.numerator"] / gear["gearing.denominator"]
    met = False
    for phase in random_phases(rng, length, count=10, ratio=False):
        gear.rows(phase.duration, acceleration=phase.acceleration, cuts=[rng.random() * phase.duration])
        if gear.state == State.ACTIVE:
            met = True
            assert gear.slave[0] == pytest.approx(s_a + rate * (gear.master_position - m_a), abs=1e-7)
            assert gear.slave[1] == pytest.approx(rate * gear.speed, abs=1e-8)
    if not met:
        return
    stop = rng.uniform(-5.0, 5.0)
    gear.stop(
        stop_mode=StopMode.WITH_CW_CCW_STOP_POSITION,
        transition=transition,
        distance=length * rng.uniform(0.0, 1.0),
        time=rng.uniform(0.1, 2.0),
        stop_position=stop,
    )
    for phase in random_phases(rng, length, count=10, ratio=False):
        gear.rows(phase.duration, acceleration=phase.acceleration, cuts=[rng.random() * phase.duration])
        if gear.state == State.STOPPED:
            assert gear.slave == (stop, 0.0, 0.0)


@repeatable
@given(rngs, modes)
def test_a_direct_engagement_in_time_ends_on_the_line_through_its_beginning(rng: Random, mode: MasterInput) -> None:
    length = 10.0
    gear = GearingHarness(ratios(rng), speed=rng.uniform(-10.0, 10.0), mode=mode)
    rate = gear["gearing.numerator"] / gear["gearing.denominator"]
    gear.start(start_mode=StartMode.CW_CCW_DIRECT, transition=TIME, time=rng.uniform(0.1, 3.0))
    for phase in random_phases(rng, length, ratio=False):
        gear.rows(phase.duration, acceleration=phase.acceleration, cuts=[rng.random() * phase.duration])
    if gear.state == State.ACTIVE:
        assert gear.slave[0] == pytest.approx(rate * gear.master_position, abs=1e-8)


# --- symmetries -------------------------------------------------------------------------------------------------------

MIRRORED = {
    "gear_in.start_mode": {1: 2, 2: 1, 3: 3, 4: 5, 5: 4, 6: 6, 7: 7},
    "gear_out.stop_mode": {1: 2, 2: 1, 3: 3, 4: 5, 5: 4, 6: 6},
}
REVERSED = ("gear_in.reference_position", "gear_in.offset", "slave.initial_position", "gear_out.stop_position")


def mirrored(values: dict[str, Any]) -> dict[str, Any]:
    reversed_values = {name: -x if name in REVERSED else x for name, x in values.items()}
    return {name: MIRRORED[name][x] if name in MIRRORED else x for name, x in reversed_values.items()}


@settings(repeatable, max_examples=200)
@given(rngs, modes)
def test_mirrored_axes_do_the_mirrored(rng: Random, mode: MasterInput) -> None:
    length, speed = 10.0, rng.choice([0.0, 10.0, -10.0])
    values = {**ratios(rng), "slave.initial_position": rng.uniform(-5.0, 5.0)}
    defaults = {"gear_in.start_mode": StartMode.WITH_CW_REFERENCE_POSITION}
    phases = random_phases(rng, length)
    reversed_phases = [Phase(mirrored(p.values), p.duration, -p.acceleration) for p in phases]
    a = GearingHarness({**defaults, **values}, speed=speed, mode=mode)
    b = GearingHarness(mirrored({**defaults, **values}), speed=-speed, mode=mode)
    seed = rng.random()
    for first, second in zip(
        run_phases(a, phases, Random(seed), 3), run_phases(b, reversed_phases, Random(seed), 3), strict=True
    ):
        for x, y in zip(first.values(), second.values(), strict=True):
            assert x["state_code"] == y["state_code"]
            assert [x[name] for name in MOTION] == [-y[name] for name in MOTION]


# --- numbers ----------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=25, suppress_health_check=list(HealthCheck))
@given(runs(steps=300))
def test_whatever_comes_all_numbers_are_finite(run: BlockRun) -> None:
    for block in run_finite(Gearing(), run):
        assert 0.0 <= block.local.progress <= 1.0
        assert block.state_code == block.state
        assert block.in_gear == (block.state == State.ACTIVE)
        assert block.error == (block.error_id != 0)


@repeatable
@given(rngs)
def test_many_small_steps_end_a_transition_on_time(rng: Random) -> None:
    gear = GearingHarness(speed=10.0).start(start_mode=StartMode.CW_CCW_DIRECT, transition=TIME, time=1.0)
    n = rng.choice([10, 100, 1000])
    gear.run(1.0, cuts=[i / n for i in range(1, n)])
    assert gear.state == State.ACTIVE
    states = [row["state_code"] for row in gear.rows(0.1).values()]
    assert all(a == b for a, b in pairwise(states))
