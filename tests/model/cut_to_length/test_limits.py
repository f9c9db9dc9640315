"""What a machine can do, predicted: hand-computed results (`machine_results.py`), a solution in mpmath from phases of
constant jerk, and laws."""

import math
from collections.abc import Callable
from dataclasses import fields, replace
from random import Random

import mpmath
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mpf

from motionsync.cut_to_length.machine_limits import (
    Machine,
    approach_distance,
    change_time,
    cycle_time,
    gap_time,
    is_admissible,
    lead,
    return_time,
    shortest_pitch,
    stroke,
    way_out,
)
from motionsync.motion.jerk_limited import Motion
from motionsync_fmu.plan.saw import max_line_velocity
from tests.model.cut_to_length.harness import machine_data
from tests.model.cut_to_length.machine_results import EACH_RESULT, MACHINES, Result, pitch_without_jerk, to
from tests.support.blocks.drawn import drawn

repeatable = drawn(150)

REFERENCE = machine_data()


def cut_travel(machine: Machine, velocity: float) -> float:
    """S, in u."""
    travel, _, _ = way_out(machine, velocity)
    return travel


def time_in_sync(machine: Machine, velocity: float) -> float:
    """t_s, in s."""
    _, _, time = way_out(machine, velocity)
    return time


# --- results computed by hand -----------------------------------------------------------------------------------------


def way_home(machine: Machine, velocity: float) -> float:
    """T_r, in s."""
    turning = min(machine.homing_acceleration, machine.homing_deceleration)
    return return_time(machine, machine.coupling * velocity, cut_travel(machine, velocity), turning)


QUANTITIES: dict[str, Callable[[Machine, float], float]] = {
    "coupling": lambda machine, _: machine.coupling,
    "approach_distance": approach_distance,
    "approach_time": lambda machine, v: 2.0 * approach_distance(machine, v) / (machine.coupling * v),
    "cut_travel": cut_travel,
    "return_time": way_home,
    "cycle_time": cycle_time,
    "shortest_pitch": shortest_pitch,
    "stroke": stroke,
    "max_line_velocity": max_line_velocity,
}


@EACH_RESULT
def test_what_a_machine_can_do(result: Result) -> None:
    machine = machine_data(MACHINES[result.machine])
    assert QUANTITIES[result.quantity](machine, result.at) == to(result.digits, result.value)


def test_a_reserve_of_the_approach_does_not_change_its_lead() -> None:
    assert lead(machine_data(MACHINES["reserve"]), 1000.0) == lead(REFERENCE, 1000.0)
    assert lead(REFERENCE, 1000.0) == approach_distance(REFERENCE, 1000.0)
    assert time_in_sync(REFERENCE, 1000.0) == 0.25


def test_a_delay_of_the_tool_longer_than_the_approach_waits_in_sync() -> None:
    """At 1000 the approach takes 0.173205 s: of a delay of 0.3 s, 0.126795 s is waited in sync."""
    machine = replace(REFERENCE, on_delay=0.3, settle_time=0.1)
    assert time_in_sync(machine, 1000.0) == to(9, 0.126794919 + 0.25)
    assert time_in_sync(replace(machine, settle_time=0.2), 1000.0) == 0.2 + 0.25


def test_a_cut_by_distance_takes_less_time_on_a_faster_line() -> None:
    machine = replace(REFERENCE, by_distance=True, cut_distance=200.0)
    assert time_in_sync(machine, 1000.0) == 0.2
    assert time_in_sync(machine, 500.0) == 0.4


def test_the_gap_takes_its_travel_and_moves_the_carriage_farther() -> None:
    machine = replace(REFERENCE, gap_distance=10.0, gap_travel=150.0)
    assert gap_time(machine, 1000.0) == 0.15
    assert cut_travel(machine, 1000.0) == pytest.approx(cut_travel(REFERENCE, 1000.0) + 160.0, abs=1e-9)
    assert gap_time(REFERENCE, 1000.0) == 0.0


@pytest.mark.parametrize("velocity", [0.0, -3.0])
def test_a_line_at_rest_or_running_backwards_needs_no_cycle(velocity: float) -> None:
    machine = replace(REFERENCE, approach_distance=150.0, gap_distance=10.0)
    assert cycle_time(machine, velocity) == 0.0
    assert shortest_pitch(machine, velocity) == 0.0
    assert stroke(machine, velocity) == 150.0
    assert is_admissible(machine, velocity)


def test_a_carriage_slower_than_the_line_is_not_admissible() -> None:
    assert is_admissible(replace(REFERENCE, max_position=1e9), 1500.0)
    assert not is_admissible(replace(REFERENCE, max_position=1e9), 1500.000001)
    assert max_line_velocity(replace(REFERENCE, max_position=1e9), 1e300) == 1500.0
    assert not is_admissible(REFERENCE, 1431.797781)


def test_nothing_is_admissible_without_stroke_or_pitch() -> None:
    assert max_line_velocity(replace(REFERENCE, home_position=650.0), 1000.0) < 1e-12  # 650 + its stroke rounds to 650
    assert max_line_velocity(replace(REFERENCE, approach_distance=150.0), 299.9) == 0.0  # 2D is travelled at least
    assert max_line_velocity(replace(REFERENCE, approach_distance=150.0), 300.1) > 0.0
    assert max_line_velocity(REFERENCE, 0.0) == 0.0
    assert max_line_velocity(REFERENCE, -1.0) == 0.0


# --- laws -------------------------------------------------------------------------------------------------------------

scales = st.floats(-1.0, 1.0).map(lambda exponent: 10.0**exponent)  # two decades about 1
times = st.sampled_from((0.0, 0.02, 0.1, 0.5, 2.0))
machines = st.builds(
    Machine,
    coupling=scales,
    home_position=st.just(0.0),
    max_position=st.sampled_from((1.0, 10.0, 1e9)),
    max_velocity=scales,
    approach_distance=st.sampled_from((0.0, 0.0, 0.1, 3.0)),
    approach_reserve=st.sampled_from((0.0, 0.02, 0.5)),
    approach_acceleration=scales,
    approach_jerk=scales,
    homing_velocity=scales,
    homing_acceleration=scales,
    homing_deceleration=scales,
    homing_jerk=scales,
    homing_settle_time=times,
    by_distance=st.booleans(),
    cut_time=times,
    cut_distance=scales,
    settle_time=times,
    on_delay=times,
    retract_time=times,
    gap_distance=st.sampled_from((0.0, 0.0, 0.1)),
    gap_travel=scales,
)


@repeatable
@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.0, 2.0))
def test_without_a_jerk_limit_the_shortest_pitch_is_a_closed_form(v: float, a: float, t: float) -> None:
    fast = 1e12
    machine = Machine(
        max_velocity=fast,
        approach_reserve=0.0,
        approach_acceleration=a,
        approach_jerk=fast,
        homing_velocity=fast,
        homing_acceleration=a,
        homing_deceleration=a,
        homing_jerk=fast,
        cut_time=t,
    )
    assert shortest_pitch(machine, v) == pytest.approx(pitch_without_jerk(v, a, t), rel=1e-9)


@repeatable
@given(scales, st.floats(0.0, 50.0), scales, scales, scales, scales)
def test_the_way_home_takes_as_long_as_the_carriage_s_own_motion(
    velocity: float, distance: float, acceleration: float, deceleration: float, jerk: float, speed: float
) -> None:
    motion = Motion()
    motion.start(distance, velocity, 0.0)
    motion.move(0.0, speed, acceleration, deceleration, jerk)
    assume(distance > 0.0 or velocity > 0.0)
    machine = Machine(homing_velocity=speed, homing_deceleration=deceleration, homing_jerk=jerk)
    computed = return_time(machine, velocity, distance, min(acceleration, deceleration))
    assert computed == pytest.approx(motion.end_time(), rel=1e-12)


@pytest.mark.parametrize("more", [-1e-2, -1e-8, -1e-9, -1e-10, 0.0, 1e-10, 1e-9, 1e-8, 1e-2])
def test_a_way_home_that_just_leads_to_the_full_speed(more: float) -> None:
    """From rest at once at the peak w, then braked with 1: w2/2 is covered in w. From 1/2 on w is the speed, 1, at
    which the rest is covered."""
    distance = 0.5 * (1.0 + more)
    expected = math.sqrt(1.0 + more) if more < 0.0 else 1.0 + 0.5 * more
    machine = Machine(homing_velocity=1.0, homing_deceleration=1.0, homing_jerk=1e30)
    assert return_time(machine, 0.0, distance, 1e12) == pytest.approx(expected, rel=1e-11)


@repeatable
@given(machines, st.floats(0.0, 5.0), st.floats(0.0, 0.5))
def test_pitch_and_stroke_rise_with_the_line_velocity(machine: Machine, velocity: float, more: float) -> None:
    assert shortest_pitch(machine, velocity + more) >= shortest_pitch(machine, velocity) * (1.0 - 1e-14)
    assert stroke(machine, velocity + more) >= stroke(machine, velocity) * (1.0 - 1e-14)


@repeatable
@given(machines, st.floats(-3.0, 3.0).map(lambda exponent: 10.0**exponent))
def test_the_greatest_line_velocity_is_sharp(machine: Machine, pitch: float) -> None:
    """At it nothing is exceeded; faster by 1e-12 the pitch, the stroke or the carriage's velocity is.

    A pitch or a stroke that the slowest line needs to the last bit allows no velocity: what a greater one adds is lost
    in rounding at first."""
    slowest = 1e-99
    assume(shortest_pitch(machine, slowest) != pitch)
    assume(machine.home_position + stroke(machine, slowest) != machine.max_position)
    velocity = max_line_velocity(machine, pitch)
    assert velocity == 0.0 or is_admissible(machine, velocity)
    assert shortest_pitch(machine, velocity) <= pitch
    more = velocity * (1.0 + 1e-12) if velocity > 0.0 else slowest
    assert not is_admissible(machine, more) or shortest_pitch(machine, more) > pitch


@repeatable
@given(machines, scales)
def test_where_the_pitch_limits_the_cycle_is_as_long_as_the_pitch(machine: Machine, velocity: float) -> None:
    free = replace(machine, max_velocity=1e6, max_position=1e9)
    pitch = shortest_pitch(free, velocity)
    greatest = max_line_velocity(free, pitch)
    assert shortest_pitch(free, greatest) == pytest.approx(pitch, rel=1e-12)
    assert greatest == pytest.approx(velocity, rel=1e-11)


EXTREMES = (1e-12, 1e-6, 1.0, 1e6, 1e12)
VELOCITIES = (-1e12, -1.0, 0.0, 1e-300, 1e-12, 1.0, 1e12)
PITCHES = (-1.0, 0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e12, 1e300)


def extreme(rng: Random) -> Machine:
    """A machine whose values are anything that is declared as possible; times from 0."""
    values = {f.name: rng.choice(EXTREMES) for f in fields(Machine) if f.name != "by_distance"}
    for name in ("approach_distance", "approach_reserve", "homing_settle_time", "cut_time", "settle_time", "on_delay"):
        values[name] = rng.choice((0.0, *EXTREMES))
    return Machine(**values, by_distance=rng.random() < 0.5)  # type: ignore[arg-type]


def test_nothing_overflows_whatever_the_machine() -> None:
    rng = Random(1)
    for _ in range(600):
        machine, velocity, pitch = extreme(rng), rng.choice(VELOCITIES), rng.choice(PITCHES)
        greatest = max_line_velocity(machine, pitch)
        values = (cycle_time(machine, velocity), shortest_pitch(machine, velocity), stroke(machine, velocity), greatest)
        assert all(math.isfinite(x) and x >= 0.0 for x in values), (machine, velocity, pitch, values)
        if greatest > 0.0:
            assert is_admissible(machine, greatest)
            assert shortest_pitch(machine, greatest) <= pitch


# --- against a solution from phases of constant jerk ------------------------------------------------------------------

JerkPhase = tuple[mpf, mpf]  # a time and a jerk


def ramp(change: mpf, acceleration: mpf, jerk: mpf) -> list[JerkPhase]:
    """The fastest change of a velocity, from and to an acceleration of 0: jerk, constant acceleration, jerk."""
    rise = min(acceleration / jerk, mpmath.sqrt(abs(change) / jerk))
    flat = abs(change) / (rise * jerk) - rise if change else mpf(0)
    sign = mpmath.sign(change)
    return [(rise, sign * jerk), (flat, mpf(0)), (rise, -sign * jerk)]


def follow_phases(phases: list[JerkPhase], velocity: mpf) -> tuple[mpf, mpf]:
    """Time and travel of a sequence of phases that starts at a velocity, without acceleration."""
    time = way = a = mpf(0)
    for t, j in phases:
        way += velocity * t + a * t**2 / 2 + j * t**3 / 6
        velocity += a * t + j * t**2 / 2
        a += j * t
        time += t
    return time, way


def bisect(above: mpf, is_above: Callable[[mpf], bool]) -> mpf:
    """The point of [0, above] from which on `is_above` holds, by bisection to 45 digits."""
    low, high = mpf(0), above
    for _ in range(160):
        middle = (low + high) / 2
        if is_above(middle):
            high = middle
        else:
            low = middle
    return low


def home_time(velocity: mpf, distance: mpf, turn: mpf, down: mpf, jerk: mpf, speed: mpf) -> mpf:
    """The time from a velocity away from home to rest at home: the fastest that its limits allow."""

    def way_back(peak: mpf) -> tuple[mpf, mpf]:
        time, way = follow_phases([*ramp(-(velocity + peak), turn, jerk), *ramp(peak, down, jerk)], velocity)
        return time, -way

    time, way = way_back(speed)
    if way <= distance:
        return time + (distance - way) / speed
    return way_back(bisect(speed, lambda peak: way_back(peak)[1] > distance))[0]


def solve_cycle(machine: Machine, line: float) -> tuple[mpf, mpf, mpf]:
    """Cycle time, shortest pitch and stroke of a machine without a gap, from its phases of constant jerk."""
    m = {f.name: mpf(getattr(machine, f.name)) for f in fields(Machine)}
    v = m["coupling"] * mpf(line)
    faster = v * (1 + m["approach_reserve"])
    # the ramp over the master, k M (u3 - u4/2) with M = 2D/k, at u = v t/M: s'' = 6 (u - u2) V2/(2D), s''' at u = 0
    by_acceleration = mpf(6) / 4 * faster**2 / 2 / m["approach_acceleration"]
    by_jerk = mpmath.sqrt(mpf(6) * faster**3 / 4 / m["approach_jerk"])
    distance = max(m["approach_distance"], by_acceleration, by_jerk)
    cut = m["cut_distance"] / v if machine.by_distance else m["cut_time"]
    touch = max(m["settle_time"], m["on_delay"] - 2 * distance / v, mpf(0))  # after sync
    sync = touch + cut + m["retract_time"]
    farthest = distance + v * sync
    turn = min(m["homing_acceleration"], m["homing_deceleration"])
    home = home_time(v, farthest, turn, m["homing_deceleration"], m["homing_jerk"], m["homing_velocity"])
    cycle = 2 * distance / v + sync + home + m["homing_settle_time"]
    return cycle, cycle * mpf(line), farthest + follow_phases(ramp(-v, turn, m["homing_jerk"]), v)[1]


@drawn(60)
@given(machines, scales)
def test_predictions_agree_with_phases_of_constant_jerk(machine: Machine, velocity: float) -> None:
    without_gap = replace(machine, gap_distance=0.0)
    with mpmath.workdps(50):
        time, pitch, farthest = solve_cycle(without_gap, velocity)
    assert cycle_time(without_gap, velocity) == pytest.approx(float(time), rel=1e-13)
    assert shortest_pitch(without_gap, velocity) == pytest.approx(float(pitch), rel=1e-13)
    assert stroke(without_gap, velocity) == pytest.approx(float(farthest), rel=1e-13)


def test_a_change_of_velocity_takes_as_long_as_its_phases() -> None:
    """Below a2/j = 20 the acceleration is a triangle, 2 sqrt(5/0.05) = 20; from there a trapezium, 60/1 + 1/0.05."""
    assert change_time(5.0, 1.0, 0.05) == 20.0
    assert change_time(60.0, 1.0, 0.05) == 80.0
    assert change_time(0.0, 1.0, 0.05) == 0.0
    time, _ = follow_phases(ramp(mpf(20), mpf(1), mpf(0.05)), mpf(0))
    assert change_time(20.0, 1.0, 0.05) == pytest.approx(float(time))
