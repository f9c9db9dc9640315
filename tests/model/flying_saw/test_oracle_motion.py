"""The motions in time of the FlyingSaw's oracle against numbers worked out by hand and Ruckig's durations."""

import random

import pytest

from tests.model.flying_saw.oracle_cases import close
from tests.oracle import mp
from tests.oracle.flying_saw_motion import Phases, advanced, move, ramp, run
from tests.oracle.master import Motion
from tests.oracle.mp import Number


def state(p: float, v: float, a: float) -> Motion:
    return Motion(mp.mpf(p), mp.mpf(v), mp.mpf(a))


def numbers(*values: float) -> list[Number]:
    return [mp.mpf(value) for value in values]


def duration(phases: Phases) -> float:
    return float(sum(time for time, _ in phases))


def sampled(start: Motion, phases: Phases, count: int = 400) -> list[Motion]:
    """The states at equal times."""
    total, result = sum(time for time, _ in phases), []
    for i in range(count + 1):
        rest, current = total * i / count, start
        for time, jerk in phases:
            part = min(time, rest)
            current, rest = advanced(current, jerk, part), rest - part
        result.append(current)
    return result


@pytest.mark.parametrize(
    ("v", "a", "target", "time", "distance"),
    [
        (0.0, 0.0, 100.0, 0.7, 35.0),  # v/a + a/j, half the velocity
        (0.0, 0.0, 10.0, 0.2, 1.0),  # peak 100, never the limit 200
        (0.0, 0.0, -100.0, 0.7, -35.0),
        (50.0, 0.0, 150.0, 0.7, 70.0),
        (0.0, 300.0, 100.0, 0.575, None),  # 0.1 s to the limit (25), 55/200 s held, 0.2 s to 0 (20)
        (0.0, 100.0, 5.0, 0.1, 1 / 3),  # straight to 0: t²·50 - t³·1000/6
        (0.0, -200.0, -20.0, 0.2, None),
        (100.0, 0.0, 100.0, 0.0, 0.0),
    ],
)
def test_ramps_by_hand(v: float, a: float, target: float, time: float, distance: float | None) -> None:
    phases = ramp(*numbers(v, a, target, 200.0, 1000.0))
    assert duration(phases) == close(time)
    end = run(state(0.0, v, a), phases)
    assert (float(end.velocity), float(end.acceleration)) == (close(target), close(0.0))
    assert distance is None or float(end.position) == close(distance)


def test_moves_by_hand() -> None:
    limits = numbers(100.0, 200.0, 200.0, 1000.0)
    assert duration(move(state(0.0, 0.0, 0.0), mp.mpf(1000), *limits)) == close(10.7)  # D/v + v/a + a/j
    assert duration(move(state(0.0, 0.0, 0.0), mp.mpf(-1000), *limits)) == close(10.7)
    assert duration(move(state(0.0, 0.0, 0.0), mp.mpf(2), *limits)) == close(4 * 0.1)  # 2·j·t³ with a peak of 100
    assert duration(move(state(0.0, 100.0, 0.0), mp.mpf(135), *limits)) == close(1.0 + 0.7)
    assert duration(move(state(0.0, 100.0, 0.0), mp.mpf(35), *limits)) == close(0.7)
    assert move(state(5.0, 0.0, 0.0), mp.mpf(5), *limits) == []
    unequal = numbers(100.0, 200.0, 250.0, 1000.0)
    assert duration(move(state(0.0, 0.0, 0.0), mp.mpf(1000), *unequal)) == close(0.7 + 0.65 + (1000 - 35 - 32.5) / 100)


@pytest.mark.parametrize("seed", range(5))
def test_ramps_keep_their_limits_and_end_as_requested(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(20):
        v, a, target = (chance.uniform(-3, 3) for _ in range(3))
        limit, jerk = chance.uniform(0.5, 3), chance.uniform(0.5, 10)
        start = state(0.0, v, a)
        phases = ramp(*numbers(v, a, target, limit, jerk))
        end = run(start, phases)
        assert abs(end.velocity - target) < 1e-40
        assert abs(end.acceleration) < 1e-40
        accelerations = [abs(s.acceleration) for s in sampled(start, phases, 100)]
        assert max(accelerations) <= max(limit, abs(a)) * (1 + 1e-15)
        assert all(abs(j) <= jerk for _, j in phases)


def within_limits(chance: random.Random, velocity: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """A state from which the velocity limit can be kept."""
    while True:
        v, a = chance.uniform(-1, 1) * velocity, chance.uniform(-1, 1) * acceleration
        if abs(v + a * abs(a) / (2 * jerk)) <= velocity:
            return v, a


@pytest.mark.parametrize("seed", range(4))
def test_moves_take_as_long_as_the_optimum(seed: int) -> None:
    """With equal acceleration and deceleration, from states from which the limits can be kept: Ruckig's durations."""
    ruckig = pytest.importorskip("ruckig")
    chance = random.Random(seed)
    for _ in range(25):
        velocity, acceleration, jerk = chance.uniform(0.5, 3), chance.uniform(0.5, 3), chance.uniform(0.5, 10)
        v, a = within_limits(chance, velocity, acceleration, jerk)
        target = chance.uniform(-10, 10)
        given = ruckig.InputParameter(1)
        given.current_position, given.current_velocity, given.current_acceleration = [0.0], [v], [a]
        given.target_position = [target]
        given.max_velocity, given.max_acceleration, given.max_jerk = [velocity], [acceleration], [jerk]
        trajectory = ruckig.Trajectory(1)
        ruckig.Ruckig(1).calculate(given, trajectory)
        phases = move(state(0.0, v, a), mp.mpf(target), *numbers(velocity, acceleration, acceleration, jerk))
        assert duration(phases) == pytest.approx(trajectory.duration, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_moves_with_unequal_limits_end_at_rest_at_the_target(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(6):
        velocity, acceleration, deceleration, jerk = (chance.uniform(0.5, 3) for _ in range(4))
        v, a = within_limits(chance, velocity, min(acceleration, deceleration), jerk)
        target, start = mp.mpf(chance.uniform(-5, 5)), state(0.0, v, a)
        phases = move(start, target, *numbers(velocity, acceleration, deceleration, jerk))
        end = run(start, phases)
        assert abs(end.position - target) < 1e-35
        assert abs(end.velocity) < 1e-35
        assert abs(end.acceleration) < 1e-35
        states = sampled(start, phases)
        assert max(abs(s.velocity) for s in states) <= velocity * (1 + 1e-15)
        assert max(abs(s.acceleration) for s in states) <= max(acceleration, deceleration) * (1 + 1e-15)


def test_moving_away_with_little_acceleration_still_comes_back() -> None:
    """Acceleration below deceleration: reversing takes the smaller one, the final stop the greater one."""
    start = state(0.0, 2.0, 0.0)
    phases = move(start, mp.mpf("0.5"), *numbers(3.0, 0.5, 2.0, 5.0))
    assert abs(run(start, phases).position - mp.mpf("0.5")) < 1e-35
