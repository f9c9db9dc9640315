"""The FlyingSaw's oracle against numbers worked out by hand, the specification's closed forms, Ruckig and sampling."""

import math
import random
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tests.oracle.flying_saw import events, reference
from tests.oracle.flying_saw_curves import Curve, real_roots
from tests.oracle.flying_saw_motion import Phases, advanced, move, ramp, run
from tests.oracle.flying_saw_plan import (
    CHECKS,
    JERK_LIMITED,
    NONE,
    P1_P5,
    P5,
    P5_P1,
    P5_P1_P5,
    Plan,
    plan,
    velocity_ramp,
)
from tests.oracle.master import Motion, Number, mp, stretches

INACTIVE, CONSTANT_VELOCITY, ACCELERATING, DECELERATING = 0.0, 3.0, 4.0, 5.0
PREPHASE, SYNCHRONIZING, SYNCHRON = 11.0, 12.0, 13.0
STANDSTILL, DISCRETE_MOTION, CONTINUOUS_MOTION, SYNCHRONIZED_MOTION, STOPPING = 1.0, 2.0, 3.0, 4.0, 5.0


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


# --- own motion -------------------------------------------------------------------------------------------------------


def state(p: float, v: float, a: float) -> Motion:
    return Motion(mp.mpf(p), mp.mpf(v), mp.mpf(a))


def numbers(*values: float) -> list[Number]:
    return [mp.mpf(value) for value in values]


def duration(phases: Phases) -> float:
    return float(sum(time for time, _ in phases))


def sampled(start: Motion, phases: Phases, count: int = 400) -> list[Motion]:
    """The states at equal times."""
    total, found = sum(time for time, _ in phases), []
    for i in range(count + 1):
        rest, here = total * i / count, start
        for time, jerk in phases:
            part = min(time, rest)
            here, rest = advanced(here, jerk, part), rest - part
        found.append(here)
    return found


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
def test_ramps_keep_their_limits_and_end_as_told(seed: int) -> None:
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
    """Acceleration below deceleration: turning round takes the smaller one, the final stop the greater one."""
    start = state(0.0, 2.0, 0.0)
    phases = move(start, mp.mpf("0.5"), *numbers(3.0, 0.5, 2.0, 5.0))
    assert abs(run(start, phases).position - mp.mpf("0.5")) < 1e-35


# --- known results of plans -------------------------------------------------------------------------------------------

EXAMPLE_4_1: dict[str, Any] = {
    "mode": "gear_in_pos",
    "master": (-500, 500, 0),
    "slave": (-250, 250, 0),
    "factor": 1,
    "limits": (2000, 2500, 2500, 5000),
    "sync": (1000, 1000),
}
EXAMPLE_4_2: dict[str, Any] = {
    "mode": "gear_in_pos",
    "master": (-500, 500, 0),
    "slave": (-500, -250, 0),
    "factor": 1.5,
    "limits": (2000, 10000, 10000, 50000),
    "sync": (1000, 500),
}
EXAMPLE_3: dict[str, Any] = {
    "mode": "gear_in_velo",
    "master": (0, 500, 0),
    "slave": (0, -250, 0),
    "factor": 1,
    "limits": (2000, 2500, 2500, 5000),
}
VELOCITY_CHECKS = ("check_overshoot_velocity", "check_undershoot_velocity")


def values(planned: Plan, *names: str) -> list[float]:
    found = planned.characteristics
    return [float(found[name]) for name in names]


def limits_of(planned: Plan, quantity: str) -> list[float]:
    return values(planned, f"slave_{quantity}_min", f"slave_{quantity}_max")


def test_section_4_example_1() -> None:
    smooth = plan(**EXAMPLE_4_1)
    assert (smooth.error, smooth.profile, float(smooth.curve.duration)) == (0, P5, 3.0)
    assert limits_of(smooth, "velocity") == [close(250.0), close(506.0)]
    assert limits_of(smooth, "acceleration") == [pytest.approx(-15.04601, abs=5e-6), pytest.approx(175.04601, abs=5e-6)]
    assert limits_of(smooth, "jerk") == [close(-1400 / 9), close(4000 / 9)]
    direct = plan(**EXAMPLE_4_1, bits=VELOCITY_CHECKS)
    assert (direct.error, direct.profile) == (0, P5_P1)
    assert float(direct.curve.pieces[0].length) == close(2.0)
    assert limits_of(direct, "acceleration") == [close(0.0), close(187.5)]
    assert limits_of(direct, "jerk") == [close(-375.0), close(375.0)]


def test_section_4_example_2() -> None:
    smooth = plan(**EXAMPLE_4_2)
    assert (smooth.error, smooth.profile) == (0, P5)
    assert limits_of(smooth, "velocity") == [close(-250.0), close(750.0)]
    assert limits_of(smooth, "acceleration") == [close(0.0), pytest.approx(568.755, abs=5e-4)]
    assert limits_of(smooth, "jerk") == [close(-3700 / 9), close(11000 / 9)]
    assert values(smooth, "slave_position_min") == [pytest.approx(-620.638, abs=5e-4)]
    direct = plan(**EXAMPLE_4_2, bits=VELOCITY_CHECKS)
    assert (direct.profile, float(direct.curve.pieces[0].length)) == (P5_P1, close(2.5))
    assert limits_of(direct, "acceleration")[1] == close(600.0)
    assert limits_of(direct, "jerk")[1] == close(960.0)


def test_section_3_example_1() -> None:
    assert float(plan(**EXAMPLE_3).curve.duration) == close(0.45)
    assert float(plan(**EXAMPLE_3, bits=["check_max_jerk"]).curve.duration) == close(math.sqrt(0.9))
    timed = plan(**EXAMPLE_3, bits=["time_based"])
    assert timed.profile == JERK_LIMITED
    assert float(timed.curve.duration) == close(2 * math.sqrt(750 / 5000))


def test_all_characteristic_values_of_a_ramp_by_hand() -> None:
    """From rest to 100 in T = 1.5 s with a peak of 100: v = 100·(3u² - 2u³), a = 400·u·(1 - u), j = 800/3·(1 - 2u)."""
    found = plan("gear_in_velo", (10, 50, 0), (7, 0, 0), 2, (500, 100, 300, 1e9))
    a_rms = math.sqrt(400**2 / 30)
    u = (20 - math.sqrt(40)) / 20  # v·a rises with 3u³ - 5u⁴ + 2u⁵, until 9 - 20u + 10u² = 0
    expected = {
        "profile": P5,
        "master_velocity_nominal": 50.0,
        "master_position_start": 10.0,
        "slave_position_start": 7.0,
        "slave_velocity_start": 0.0,
        "slave_acceleration_start": 0.0,
        "slave_jerk_start": 800 / 3,
        "master_position_end": 85.0,
        "slave_position_end": 82.0,
        "slave_velocity_end": 100.0,
        "slave_acceleration_end": 0.0,
        "slave_jerk_end": -800 / 3,
        "slave_position_min": 7.0,
        "master_position_at_slave_position_min": 10.0,
        "slave_position_max": 82.0,
        "master_position_at_slave_position_max": 85.0,
        "slave_velocity_min": 0.0,
        "master_position_at_slave_velocity_min": 10.0,
        "slave_velocity_max": 100.0,
        "master_position_at_slave_velocity_max": 85.0,
        "slave_acceleration_min": 0.0,
        "master_position_at_slave_acceleration_min": 10.0,
        "slave_acceleration_max": 100.0,
        "master_position_at_slave_acceleration_max": 47.5,
        "slave_velocity_at_slave_acceleration_min": 0.0,
        "slave_velocity_at_slave_acceleration_max": 50.0,
        "slave_jerk_min": -800 / 3,
        "slave_jerk_max": 800 / 3,
        "slave_dynamic_momentum_min": 0.0,
        "slave_dynamic_momentum_max": 100 * (3 * u**2 - 2 * u**3) * 400 * u * (1 - u),
        "slave_velocity_mean": 50.0,
        "slave_acceleration_effective": a_rms,
    }
    assert {name: float(value) for name, value in found.characteristics.items()} == {
        name: close(value) for name, value in expected.items()
    }


def test_in_sync_at_once_start_is_end() -> None:
    for master, slave, velocity in (((3, 0, 0), (4, 0, 0), 0.0), ((3, -20, 0), (4, -10, 0), -10.0)):
        found = plan("gear_in_velo", master, slave, 0.5, (500, 100, 300, 1e9))
        assert (found.error, found.profile, float(found.curve.duration)) == (0, NONE, 0.0)
        names = ("master_position_start", "master_position_end", "slave_position_start", "slave_position_end")
        assert values(found, *names) == [3.0, 3.0, 4.0, 4.0]
        assert limits_of(found, "velocity") == [velocity, velocity]
        assert values(found, "slave_velocity_mean", "slave_acceleration_effective") == [abs(velocity), 0.0]


# --- plans against sampling and closed forms --------------------------------------------------------------------------


def curve_numbers(curve: Curve, count: int = 4000) -> tuple[np.ndarray[Any, Any], ...]:
    """Times, positions, velocities, accelerations, jerks, from the coefficients in double precision."""
    columns: list[list[Any]] = [[], [], [], [], []]
    for piece in curve.pieces:
        x = np.linspace(0.0, float(piece.length), count)
        p = np.polynomial.Polynomial([float(c) for c in piece.polynomial])
        for column, part in zip(
            columns, (x + float(piece.begin), p(x), *(p.deriv(k)(x) for k in (1, 2, 3))), strict=True
        ):
            column.append(part)
    return tuple(np.concatenate(column) for column in columns)


def random_plan(chance: random.Random, mode: str, **changes: Any) -> dict[str, Any]:
    """A plan of any state, mostly accepted; gear_in_pos meets ahead."""
    direction, factor = chance.choice([1, -1]), chance.choice([1, -1]) * 10 ** chance.uniform(-1, 1)
    velocity, time = direction * 10 ** chance.uniform(1, 3), 10 ** chance.uniform(-0.5, 1)
    accelerated = chance.random() < 0.5
    master = (chance.uniform(-500, 500), velocity, chance.uniform(-1, 1) * 0.2 * abs(velocity) if accelerated else 0.0)
    slow = chance.uniform(-1.5, 1.5) * factor * velocity
    slave = (chance.uniform(-500, 500), slow, chance.uniform(-1, 1) * abs(slow) if accelerated else 0.0)
    sync = (master[0] + velocity * time, slave[0] + factor * velocity * time * chance.uniform(0.2, 1.5))
    scale = abs(factor * velocity)
    limits = tuple(scale * 10 ** chance.uniform(*ends) for ends in ((0.2, 0.6), (-0.3, 1), (-0.3, 1), (0, 2)))
    given = {"mode": mode, "master": master, "slave": slave, "factor": factor, "limits": limits, "sync": sync}
    return given | changes


@pytest.mark.parametrize(
    ("mode", "bits"),
    [
        ("gear_in_pos", ()),
        ("gear_in_pos", ("prefer_constant_velocity",)),
        ("gear_in_velo", ()),
        ("gear_in_velo", ("time_based",)),
    ],
)
def test_characteristic_values_are_those_of_dense_samples(mode: str, bits: tuple[str, ...]) -> None:
    chance = random.Random(1)
    for _ in range(12):
        found = plan(**random_plan(chance, mode, bits=bits))
        if found.error:
            continue
        master, slave = found.request.master, found.request.slave
        t, s, v, a, j = curve_numbers(found.curve)
        duration_ = float(found.curve.duration)
        for name, column in (("position", s), ("velocity", v), ("acceleration", a)):
            span = max(float(np.ptp(column)), 1e-6)
            assert limits_of(found, name) == pytest.approx([column.min(), column.max()], abs=1e-5 * span)
            for side in ("min", "max"):
                place = values(found, f"master_position_at_slave_{name}_{side}")[0]
                there = found.at(place)[("position", "velocity", "acceleration").index(name)]
                assert float(there) == pytest.approx(values(found, f"slave_{name}_{side}")[0], abs=1e-9 * span + 1e-9)
        assert limits_of(found, "jerk") == pytest.approx([j.min(), j.max()], abs=1e-6 * abs(j).max())
        momentum = v * a
        expected = [momentum.min(), momentum.max()]
        assert limits_of(found, "dynamic_momentum") == pytest.approx(expected, abs=1e-5 * abs(momentum).max())
        mean, effective = values(found, "slave_velocity_mean", "slave_acceleration_effective")
        assert mean == pytest.approx(np.trapezoid(abs(v), t) / duration_, rel=1e-4)
        assert effective == pytest.approx(math.sqrt(np.trapezoid(a * a, t) / duration_), rel=1e-4)
        assert v[0] == pytest.approx(float(slave.velocity), rel=1e-12)
        assert v[-1] == pytest.approx(float(found.request.synchronous_velocity), rel=1e-9)
        assert abs(a[-1]) <= 1e-9 * abs(a).max()
        if mode == "gear_in_pos":
            assert s[-1] == pytest.approx(float(found.request.sync[1]), rel=1e-12, abs=1e-9)
            assert float(found.master_end) == pytest.approx(float(found.request.sync[0]), rel=1e-12)
        if "time_based" not in bits:
            tilted = float(slave.acceleration - slave.velocity * master.acceleration / master.velocity)
            assert a[0] == pytest.approx(tilted, rel=1e-9, abs=1e-9 * abs(a).max())


def test_pieces_join_with_continuous_acceleration() -> None:
    chance, joints = random.Random(2), 0
    for bits in (("prefer_constant_velocity",), VELOCITY_CHECKS, ("check_max_velocity",)) * 8:
        given = random_plan(chance, "gear_in_pos", bits=bits)
        given["master"], given["slave"] = (*given["master"][:2], 0.0), (*given["slave"][:2], 0.0)
        pieces = plan(**given).curve.pieces
        for before, after in pairwise(pieces):
            joints += 1
            for left, right in zip(Curve([before]).finish()[:3], Curve([after]).at(after.begin)[:3], strict=True):
                assert abs(left - right) < 1e-40 * (1 + abs(left)) * 1e6
    assert joints > 10


def closed_form(change: Number, a: Number, limit: Number, jerk: Number | None) -> Number:
    """T of gear_in_velo as the specification writes it."""
    most = max(limit, abs(a))
    b = 2 * most - a + 2 * mp.sqrt(most**2 - most * a)
    least = 6 * change / (b + 3 * a)
    candidates = [least]
    for linear in (4 * a, 2 * a):
        for level in (jerk, -jerk) if jerk else ():
            root = mp.sqrt(max(linear**2 + 24 * change * level, 0))
            candidates += [12 * change / x for x in (linear + root, linear - root) if x > 0 and root > 0]

    def keeps(time: Number) -> bool:
        ends = (6 * change / time**2 - 4 * a / time, 6 * change / time**2 - 2 * a / time)
        return jerk is None or all(abs(end) <= jerk * (1 + mp.mpf("1e-9")) for end in ends)

    return min(time for time in candidates if time >= least * (1 - mp.mpf("1e-25")) and keeps(time))


@pytest.mark.parametrize("seed", range(4))
def test_the_shortest_ramp_is_the_specified_one_and_none_is_shorter(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(25):
        change, limit = 10 ** chance.uniform(-1, 3), 10 ** chance.uniform(1, 4)
        a = chance.choice([0.0, chance.uniform(-1, 1) * 10 ** chance.uniform(0, 4)])
        jerk = chance.choice([None, 10 ** chance.uniform(1, 5)])
        side = chance.choice([1, -1])
        exact = [mp.mpf(10), mp.mpf(side * a), mp.mpf(10) + side * mp.mpf(change), mp.mpf(limit)]
        curve = velocity_ramp(mp.mpf(0), *exact, mp.mpf(jerk) if jerk else None)
        expected = closed_form(mp.mpf(change), mp.mpf(a), mp.mpf(limit), mp.mpf(jerk) if jerk else None)
        assert float(curve.duration) == close(float(expected), rel=1e-14)
        for time in float(curve.duration) * np.linspace(0.05, 0.999, 60):
            b = 6 * change / time - 3 * a
            u = np.append(np.linspace(0.0, 1.0, 101), min(max((b - a) / (2 * b), 0.0), 1.0))
            acceleration = (1 - u) * (a + b * u)
            slope = (b - a - 2 * b * u) / time
            too_fast = abs(acceleration).max() > max(limit, abs(a)) * (1 + 1e-9)
            assert too_fast or (jerk and abs(slope).max() > jerk * (1 + 1e-9))


@pytest.mark.parametrize("seed", range(3))
def test_a_mirrored_slave_has_the_mirrored_plan(seed: int) -> None:
    chance = random.Random(seed)
    for mode in ("gear_in_pos", "gear_in_velo"):
        for bits in ((), ("prefer_constant_velocity",), VELOCITY_CHECKS, ("check_max_velocity",), ("check_max_jerk",)):
            given = random_plan(chance, mode, bits=bits)
            mirrored = given | {"slave": tuple(-x for x in given["slave"]), "factor": -given["factor"]}
            mirrored["sync"] = (given["sync"][0], -given["sync"][1])
            one, other = plan(**given), plan(**mirrored)
            assert (one.error, one.profile) == (other.error, other.profile)
            if not one.error:
                assert [-float(x) for x in reversed(limits_of(one, "velocity"))] == limits_of(other, "velocity")


def test_roots_are_found_even_if_they_touch() -> None:
    touching = [mp.mpf(c) for c in (0.25, -1, 1)]  # (x - 1/2)²
    assert [float(root) for root in real_roots(touching, mp.mpf(1))] == [close(0.5), close(0.5)]
    assert real_roots([mp.mpf(3)], mp.mpf(1)) == []
    assert real_roots([mp.mpf(0), mp.mpf(0)], mp.mpf(1)) == []


# --- errors and the order of choice -----------------------------------------------------------------------------------


def mirrored(given: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The same with the slave's direction reversed."""
    result = given | {"slave": tuple(-x for x in given["slave"]), "factor": -given["factor"]} | changes
    return result | {"sync": (given["sync"][0], -given["sync"][1])}


def backwards(given: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The same with the directions of master and slave reversed."""
    result = given | {name: tuple(-x for x in given[name]) for name in ("master", "slave", "sync")}
    return result | changes


def to_position(v0: float, v1: float, time: float, mean: float, **changes: Any) -> dict[str, Any]:
    """From slave position 0; the master goes at v1 from 0."""
    given = {"mode": "gear_in_pos", "master": (0, v1, 0), "slave": (0, v0, 0), "factor": 1}
    return given | {"limits": (2000, 1e5, 1e5, 1e6), "sync": (v1 * time, mean * time)} | changes


SLOW_DOWN = to_position(600, 500, 2, 700)
LATE = to_position(500, 100, 2, 5)
NOT_FREE = {"master": (-500, 500, -1)}
LESS = {"limits": (505, 2500, 2500, 5000)}


@pytest.mark.parametrize(
    ("code", "check", "given"),
    [
        (0x4372, "check_min_position", EXAMPLE_4_2 | {"ends": (-600, 1e9)}),
        (0x4373, "check_max_position", EXAMPLE_4_1 | {"ends": (-1e9, 999)}),
        (0x4376, "check_undershoot_position", mirrored(LATE)),
        (0x4377, "check_undershoot_position", EXAMPLE_4_2),
        (0x4378, "check_overshoot_position", mirrored(EXAMPLE_4_2)),
        (0x4379, "check_overshoot_position", LATE),
        (0x437A, "check_max_velocity", EXAMPLE_4_1 | NOT_FREE | LESS),
        (0x437B, "check_max_velocity", mirrored(EXAMPLE_4_1, **NOT_FREE, **LESS)),
        (0x437C, "check_overshoot_velocity", EXAMPLE_4_1 | NOT_FREE),
        (0x437D, "check_overshoot_velocity", SLOW_DOWN),
        (0x437E, "check_overshoot_velocity", mirrored(EXAMPLE_4_1, **NOT_FREE)),
        (0x437F, "check_overshoot_velocity", mirrored(SLOW_DOWN)),
        (0x4380, "check_undershoot_velocity", to_position(600, 500, 2, 450)),
        (0x4381, "check_undershoot_velocity", to_position(250, 500, 2, 200)),
        (0x4382, "check_undershoot_velocity", mirrored(to_position(600, 500, 2, 450))),
        (0x4383, "check_undershoot_velocity", mirrored(to_position(250, 500, 2, 200))),
        (0x4384, "check_overshoot_velocity_zero", EXAMPLE_4_1),
        (0x4385, "check_overshoot_velocity_zero", mirrored(backwards(EXAMPLE_4_1))),
        (0x4386, "check_undershoot_velocity_zero", LATE),
        (0x4387, "check_undershoot_velocity_zero", backwards(LATE)),
        (0x4388, "check_max_acceleration", EXAMPLE_4_1 | {"limits": (2000, 175, 2500, 5000)}),
        (0x4389, "check_max_deceleration", EXAMPLE_4_1 | {"limits": (2000, 2500, 15, 5000)}),
        (0x438A, "check_max_jerk", EXAMPLE_4_1 | {"limits": (2000, 2500, 2500, 444)}),
        (0x438B, "check_max_jerk", mirrored(EXAMPLE_4_1, limits=(2000, 2500, 2500, 444))),
    ],
)
def test_each_check_has_its_code(code: int, check: str, given: dict[str, Any]) -> None:
    assert plan(**given).error == 0
    assert plan(**given, bits=[check]).error == 0x42DF
    assert plan(**given, bits=[check, "detailed_error_codes"]).error == code
    assert code in CHECKS[check]
    others = [name for name in CHECKS if name != check]
    found = plan(**given, bits=[*others, "detailed_error_codes"])
    assert found.error != code


@pytest.mark.parametrize(
    ("check", "given"),
    [
        ("check_min_position", EXAMPLE_4_2 | {"ends": (-620.64, 1e9)}),
        ("check_max_position", EXAMPLE_4_1 | {"ends": (-1e9, 1000)}),
        ("check_max_acceleration", EXAMPLE_4_1 | {"limits": (2000, 175.05, 2500, 5000)}),
        ("check_max_deceleration", EXAMPLE_4_1 | {"limits": (2000, 2500, 15.05, 5000)}),
        ("check_max_jerk", EXAMPLE_4_1 | {"limits": (2000, 2500, 2500, 444.45)}),
        ("check_undershoot_position", EXAMPLE_4_1),
        ("check_overshoot_position", EXAMPLE_4_1),
        ("check_undershoot_velocity_zero", EXAMPLE_4_2),  # starts below zero
        ("check_overshoot_velocity_zero", mirrored(EXAMPLE_4_1)),
    ],
)
def test_a_kept_limit_is_no_error(check: str, given: dict[str, Any]) -> None:
    found = plan(**given, bits=[check])
    assert (found.error, found.profile) == (0, P5)


@pytest.mark.parametrize(
    ("error", "changes"),
    [
        (0x425B, {"factor": 0, "limits": (0, 1, 1, 1)}),
        (0x425B, {"factor": math.inf}),
        (0x42DD, {"limits": (2000, -1, 2500, 5000), "bits": ["time_based"]}),
        (0x42DD, {"limits": (2000, 2500, 2500, math.inf)}),
        (0x42DD, {"limits": (499, 2500, 2500, 5000), "bits": ["check_max_velocity"]}),
        (0x4289, {"limits": (499, 2500, 2500, 5000), "bits": ["time_based"]}),
        (0x4289, {"bits": ["time_based"], "master": (0, 0, 0)}),
        (0x426E, {"master": (0, 0, 1)}),
        (0x42DE, {"sync": (-500, 1000)}),
        (0x42DE, {"sync": (1000, -250)}),
        (0x42DE, {"master": (-500, -500, 0)}),
        (0x42DE, {"factor": -1}),
    ],
)
def test_errors_come_in_their_order(error: int, changes: dict[str, Any]) -> None:
    assert plan(**EXAMPLE_4_1 | changes).error == error


@pytest.mark.parametrize("bits", [(), ("time_based",)])
def test_a_standing_master_takes_a_standing_slave_only(bits: tuple[str, ...]) -> None:
    standing = EXAMPLE_3 | {"master": (0, 0, 0)}
    assert plan(**standing, bits=bits).error == 0x424A
    assert plan(**standing | {"slave": (0, 0, 1)}, bits=bits).error == 0x424A
    assert plan(**standing | {"slave": (0, 0, 0)}, bits=bits).error == 0


def test_first_the_present_velocity_or_first_the_ramp() -> None:
    """Means of 300 and 450 between 250 and 500 in 3 s: T5 = 2·150/250 and 2·150/250."""
    near = plan(**to_position(250, 500, 3, 300), bits=VELOCITY_CHECKS)
    assert (near.profile, float(near.curve.pieces[1].length)) == (P1_P5, close(1.2))
    assert values(near, "slave_jerk_start", "slave_jerk_end") == [0.0, close(-6 * 250 / 1.2**2)]
    far = plan(**to_position(250, 500, 3, 450), bits=VELOCITY_CHECKS)
    assert (far.profile, float(far.curve.pieces[0].length)) == (P5_P1, close(1.2))
    assert values(far, "master_position_at_slave_velocity_max") == [close(600.0)]
    half = plan(**to_position(250, 500, 3, 375), bits=VELOCITY_CHECKS)
    assert (half.profile, float(half.curve.duration)) == (P5_P1, close(3.0))


def test_a_broken_limit_makes_the_profile_without_overshoot_give_way() -> None:
    """187.5 of P5+P1 against 175.05 of P5, which overshoots."""
    given = EXAMPLE_4_1 | {"limits": (2000, 180, 180, 5000)}
    accepted = plan(**given, bits=["check_undershoot_velocity", "check_max_acceleration"])
    assert (accepted.error, accepted.profile) == (0, P5)
    bits = ["check_overshoot_velocity", "check_max_acceleration", "detailed_error_codes"]
    assert plan(**given, bits=bits).error == 0x437C
    assert plan(**given, bits=["check_overshoot_velocity"]).profile == P5_P1


def test_accelerated_axes_have_p5_only() -> None:
    for changes in (NOT_FREE, {"slave": (-250, 250, 1)}):
        for bits in (["check_undershoot_velocity"], ["prefer_constant_velocity"], ["check_max_velocity"]):
            assert plan(**EXAMPLE_4_1 | changes, bits=bits).profile == P5
    ignored = ["check_undershoot_velocity", "ignore_master_acceleration", "ignore_slave_acceleration"]
    both = EXAMPLE_4_1 | NOT_FREE | {"slave": (-250, 250, 1)}
    assert plan(**both, bits=ignored).profile == P5_P1
    tiny = EXAMPLE_4_1 | {"slave": (-250, 250, 0.9e-9 * 500 / 3)}
    assert plan(**tiny, bits=["check_undershoot_velocity"]).profile == P5_P1


def test_the_start_acceleration_is_that_at_constant_master_velocity() -> None:
    """s'' = (a - s'·a_m)/v_m²: 30 - 250·50/500."""
    given = EXAMPLE_4_1 | {"master": (-500, 500, 50), "slave": (-250, 250, 30)}
    assert values(plan(**given), "slave_acceleration_start") == [close(5.0)]
    assert values(plan(**given, bits=["ignore_master_acceleration"]), "slave_acceleration_start") == [close(30.0)]
    assert values(plan(**given, bits=["ignore_slave_acceleration"]), "slave_acceleration_start") == [close(-25.0)]


def test_the_velocity_limit_becomes_the_constant_velocity() -> None:
    """0 to 500 over 1200 in 2 s at 900: 0.75·(900² + 400²)/(1800 - 1200) = 1212.5."""
    given = to_position(0, 500, 2, 600, limits=(900, 1e5, 1e5, 1e6))
    found = plan(**given, bits=["check_max_velocity"])
    assert (found.error, found.profile) == (0, P5_P1_P5)
    assert limits_of(found, "acceleration") == [close(-1212.5), close(1212.5)]
    assert limits_of(found, "velocity")[1] == close(900.0)
    assert [float(p.length) for p in found.curve.pieces] == [
        close(1.5 * 900 / 1212.5),
        close(2 - 1950 / 1212.5),
        close(600 / 1212.5),
    ]
    weak = given | {"limits": (900, 1200, 1e5, 1e6)}
    bits = ["check_max_velocity", "check_max_acceleration", "detailed_error_codes"]
    assert plan(**weak, bits=bits).error == 0x437A
    assert plan(**weak, bits=["check_max_acceleration", "detailed_error_codes"]).error == 0x4388
    back = plan(**mirrored(given), bits=["check_max_velocity"])
    assert (back.profile, limits_of(back, "velocity")[0]) == (P5_P1_P5, close(-900.0))


def test_a_limit_too_near_to_the_mean_is_out_of_reach() -> None:
    given = to_position(0, 500, 2, 600, limits=(600, 1e5, 1e5, 1e6))
    assert plan(**given, bits=["check_max_velocity", "detailed_error_codes"]).error == 0x437A


def test_the_preferred_constant_velocity_by_hand() -> None:
    """100 to 100 over 600 in 4 s with 100 u/s2: 4y - 0.015·y² = 200, c = 100 + 200/3, ramps of 1 s."""
    given = to_position(100, 100, 4, 150, limits=(2000, 100, 100, 1000))
    found = plan(**given, bits=["prefer_constant_velocity"])
    assert (found.profile, limits_of(found, "velocity")[1]) == (P5_P1_P5, close(500 / 3))
    assert [float(p.length) for p in found.curve.pieces] == [close(1.0), close(2.0), close(1.0)]
    assert plan(**given | {"limits": (2000, 20, 20, 1000)}, bits=["prefer_constant_velocity"]).profile == P5
    refused = plan(**given, bits=["prefer_constant_velocity", "check_overshoot_velocity", "detailed_error_codes"])
    assert refused.error == 0x437C
    gentle = plan(**given, bits=["prefer_constant_velocity", "check_max_jerk"])
    c = limits_of(gentle, "velocity")[1]
    assert float(gentle.curve.pieces[0].length) == close(max(1.5 * (c - 100) / 100, math.sqrt(6 * (c - 100) / 1000)))


def test_a_short_way_asks_for_a_constant_velocity_backwards() -> None:
    found = plan(**to_position(100, 100, 4, 1, limits=(2000, 200, 400, 1000)), bits=["prefer_constant_velocity"])
    c = limits_of(found, "velocity")[0]
    assert (found.profile, c < 0) == (P5_P1_P5, True)
    first, last = (1.5 * (100 - c) / 200 for _ in range(2))  # v·c < 0: the smaller limit
    assert (100 + c) / 2 * first + c * (4 - first - last) + (c + 100) / 2 * last == close(4.0, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_the_distance_rises_with_the_constant_velocity_where_the_ramps_fit(seed: int) -> None:
    """The search for it asserts that only one fits on the side it looks at."""
    chance, found = random.Random(seed), 0
    for _ in range(10):
        given = random_plan(chance, "gear_in_pos", bits=["prefer_constant_velocity", "check_max_jerk"])
        given["master"], given["slave"] = (*given["master"][:2], 0.0), (*given["slave"][:2], 0.0)
        given["limits"] = (1e9, *given["limits"][1:])
        planned = plan(**given)
        found += planned.profile == P5_P1_P5
    assert found


# --- scenarios --------------------------------------------------------------------------------------------------------


def scenario(
    segments: list[dict[str, float]], *sets: dict[str, Any], position: float = 0.0, **start: Any
) -> dict[str, Any]:
    """A scenario of the segments' length; names in `start` and in the sets have `__` for a dot."""
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": {name.replace("__", "."): value for name, value in start.items()},
        "master": {"position": position, "velocity": segments[0].get("velocity", 0.0), "segments": segments},
        "set": [{name.replace("__", "."): value for name, value in one.items()} for one in sets],
    }


def steady(velocity: float, duration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    return scenario([{"duration": duration, "velocity": velocity}], *sets, **options)


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`, but for what is set then."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float]:
    return row["slave.position"], row["slave.velocity"], row["slave.acceleration"]


def shows(row: dict[str, float], group: str) -> set[str]:
    """The Boolean outputs of a group that are true."""
    names = (name for name in row if name.startswith(f"{group}.") and not name.endswith("error_id"))
    return {name.partition(".")[2] for name in names if row[name]}


def named(given: dict[str, Any], name: str) -> list[float]:
    return [time for time, event in events(given) if event == name]


MEET = {"gear_in_pos__master_sync_position": 1000.0, "gear_in_pos__slave_sync_position": 1000.0}
MOVING = {"axis__initial_position": -375.0, "axis__initial_velocity": 250.0}


def example(*sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """TS5055 section 4 example 1: gear_in_pos at 0.5 s, in sync at 3.5 s."""
    first = {"at": 0.5, "gear_in_pos__execute": True}
    return steady(500.0, 6.0, first, *sets, **{"position": -750.0} | MOVING | MEET | options)


def test_synchronisation_to_a_position_from_start_to_end() -> None:
    given = example({"at": 4.5, "gear_out__execute": True}, {"at": 5.0, "gear_in_pos__execute": False})
    early = at(given, 0.5)
    assert motion(early) == (-250.0, 250.0, 0.0)
    assert (early["state_code"], early["plcopen_state"]) == (CONSTANT_VELOCITY, CONTINUOUS_MOTION)
    assert (early["coupled"], early["coupling_factor"], shows(early, "gear_in_pos")) == (0.0, 0.0, set())
    assert early["characteristics.profile"] == 0.0
    middle = at(given, 2.3)  # master at 400: 0.6 of the way
    assert (middle["state_code"], middle["plcopen_state"]) == (SYNCHRONIZING, SYNCHRONIZED_MOTION)
    assert (middle["coupled"], middle["coupling_factor"], middle["in_sync"]) == (1.0, 1.0, 0.0)
    assert shows(middle, "gear_in_pos") == {"start_sync", "busy", "active"}
    assert middle["characteristics.slave_velocity_max"] == close(506.0)
    before, after = reference(given, [3.5])
    assert (before["state_code"], after["state_code"], after["in_sync"]) == (SYNCHRONIZING, SYNCHRON, 1.0)
    assert (before["slave.jerk"], after["slave.jerk"]) == (close(1000 / 9), 0.0)
    assert motion(after) == (1000.0, 500.0, 0.0)
    assert shows(after, "gear_in_pos") == {"start_sync", "in_sync"}
    assert at(given, 4.0)["slave.position"] == 1250.0
    aborted = at(given, 4.51)
    assert (shows(aborted, "gear_in_pos"), shows(aborted, "gear_out")) == ({"command_aborted"}, {"done"})
    assert motion(aborted) == (close(1505.0), 500.0, 0.0)
    assert (aborted["state_code"], aborted["plcopen_state"]) == (CONSTANT_VELOCITY, CONTINUOUS_MOTION)
    assert (aborted["coupled"], aborted["coupling_factor"]) == (0.0, 0.0)
    assert aborted["characteristics.slave_velocity_max"] == close(506.0)
    assert shows(at(given, 5.0), "gear_in_pos") == {"command_aborted"}
    assert shows(at(given, 5.01), "gear_in_pos") == set()


def test_a_set_shows_from_the_next_row_on_and_makes_no_second_row() -> None:
    given = example({"at": 4.0, "gear_out__execute": True})
    rows = reference(given, [0.5, 4.0])
    assert [(row["time"], row["state_code"]) for row in rows] == [(0.5, CONSTANT_VELOCITY), (4.0, SYNCHRON)]


def test_uncoupled_while_accelerating_the_slave_keeps_its_velocity() -> None:
    given = example({"at": 1.5, "gear_out__execute": True})
    before, after = at(given, 1.5), at(given, 2.0)
    assert before["slave.acceleration"] > 100.0
    assert after["slave.velocity"] == before["slave.velocity"]
    assert after["slave.acceleration"] == 0.0
    assert after["slave.position"] == close(before["slave.position"] + 0.5 * before["slave.velocity"])


def test_the_slave_follows_the_curve_of_a_master_that_changes_speed() -> None:
    """The position depends on the master's alone; velocity, acceleration and jerk are its derivatives."""
    segments = [{"duration": 1.5, "velocity": 500.0}, {"duration": 1.0, "acceleration": -300.0}]
    segments += [{"duration": 2.0, "acceleration": 0.0}, {"duration": 3.0, "acceleration": 400.0}]
    options = {"position": -750.0} | MOVING | MEET
    given = scenario(segments, {"at": 0.5, "gear_in_pos__execute": True}, **options)
    still = example()
    assert at(given, 2.5)["slave.position"] == close(at(still, 1.5 + 0.7)["slave.position"])  # master at 350
    assert at(given, 3.0)["slave.velocity"] == close(at(still, 2.4)["slave.velocity"] * 0.4)
    for time in (1.2, 2.1, 3.3, 5.1):
        early, row, late = (at(given, time + shift) for shift in (-1e-4, 0.0, 1e-4))
        for name, rate in (("position", "velocity"), ("velocity", "acceleration"), ("acceleration", "jerk")):
            difference = (late[f"slave.{name}"] - early[f"slave.{name}"]) / 2e-4
            assert difference == pytest.approx(row[f"slave.{rate}"], rel=1e-5, abs=1e-3)


# --- own motion and the rules of the function blocks ------------------------------------------------------------------

AXIS = {
    "axis__max_velocity": 100.0,
    "axis__max_acceleration": 200.0,
    "axis__max_deceleration": 200.0,
    "axis__max_jerk": 1000.0,
}


def alone(duration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    return steady(0.0, duration, *sets, **AXIS | options)


def test_move_absolute_from_rest() -> None:
    given = alone(12.0, {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 1000.0})
    assert named(given, "move_absolute done") == [close(10.8)]
    speeding, cruising, slowing, done = (at(given, time) for time in (0.5, 5.0, 10.5, 11.0))
    assert [row["state_code"] for row in (speeding, cruising, slowing, done)] == [
        ACCELERATING,
        CONSTANT_VELOCITY,
        DECELERATING,
        INACTIVE,
    ]
    assert cruising["slave.velocity"] == 100.0
    assert [row["plcopen_state"] for row in (speeding, done)] == [DISCRETE_MOTION, STANDSTILL]
    assert (shows(slowing, "move_absolute"), shows(done, "move_absolute")) == ({"busy", "active"}, {"done"})
    assert motion(done) == (1000.0, 0.0, 0.0)


def test_a_result_after_the_falling_edge_shows_for_one_step() -> None:
    """From 0.105 s, over 2 in 0.4 s."""
    sets = {"at": 0.105, "move_absolute__execute": True, "move_absolute__position": 2.0}
    given = alone(1.0, sets, {"at": 0.2, "move_absolute__execute": False})
    found = [shows(at(given, time), "move_absolute") for time in (0.3, 0.5, 0.51, 0.52)]
    assert found == [{"busy", "active"}, {"busy", "active"}, {"done"}, set()]
    coarse = given | {"step_size": 0.05}
    assert [shows(at(coarse, time), "move_absolute") for time in (0.5, 0.55, 0.6)] == [
        {"busy", "active"},
        {"done"},
        set(),
    ]


def test_simultaneous_edges_act_in_their_order() -> None:
    sets = {"at": 0.5, "move_velocity__execute": True, "move_velocity__velocity": 50.0, "halt__execute": True}
    given = alone(2.0, sets, axis__initial_velocity=30.0)
    row = at(given, 1.5)
    assert (shows(row, "halt"), shows(row, "move_velocity")) == ({"command_aborted"}, {"in_velocity"})
    assert named(given, "halt accepted") == named(given, "move_velocity accepted") == [0.5]


def test_in_velocity_turns_into_command_aborted_and_done_does_not() -> None:
    sets = (
        {"at": 0.1, "move_velocity__execute": True, "move_velocity__velocity": -50.0},
        {"at": 2.0, "halt__execute": True},
        {"at": 4.0, "move_absolute__execute": True},
    )
    given = alone(5.0, *sets)
    assert shows(at(given, 0.3), "move_velocity") == {"busy", "active"}
    assert at(given, 0.3)["plcopen_state"] == CONTINUOUS_MOTION
    assert shows(at(given, 1.0), "move_velocity") == {"in_velocity"}
    assert at(given, 1.0)["slave.velocity"] == -50.0
    halting = at(given, 2.1)
    assert (shows(halting, "move_velocity"), shows(halting, "halt")) == ({"command_aborted"}, {"busy", "active"})
    assert (halting["state_code"], halting["plcopen_state"]) == (DECELERATING, DISCRETE_MOTION)
    assert shows(at(given, 3.0), "halt") == {"done"}
    assert shows(at(given, 4.1), "halt") == {"done"}


def test_an_abortion_after_the_falling_edge_shows_for_one_step() -> None:
    sets = (
        {"at": 0.1, "move_velocity__execute": True, "move_velocity__velocity": 50.0},
        {"at": 1.0, "move_velocity__execute": False},
        {"at": 2.0, "halt__execute": True},
    )
    given = alone(3.0, *sets)
    found = [shows(at(given, time), "move_velocity") for time in (1.0, 1.01, 2.0, 2.01, 2.02)]
    assert found == [{"in_velocity"}, set(), set(), {"command_aborted"}, set()]
    together = alone(3.0, sets[0], {"at": 2.0, "halt__execute": True, "move_velocity__execute": False})
    found = [shows(at(together, time), "move_velocity") for time in (2.0, 2.01, 2.02)]
    assert found == [{"in_velocity"}, {"command_aborted"}, set()]


def test_a_velocity_of_zero_is_standstill() -> None:
    given = alone(3.0, {"at": 0.1, "move_velocity__execute": True}, axis__initial_velocity=30.0)
    row = at(given, 2.0)
    assert (row["plcopen_state"], row["state_code"], shows(row, "move_velocity")) == (
        STANDSTILL,
        INACTIVE,
        {"in_velocity"},
    )


def test_stop_locks_until_standstill_and_until_execute_falls() -> None:
    sets = (
        {"at": 1.0, "stop__execute": True, "halt__execute": True},
        {"at": 1.1, "move_absolute__execute": True, "reset__execute": True},
        {"at": 2.5, "gear_out__execute": True},
        {"at": 3.0, "stop__execute": False, "move_absolute__execute": False},
        {"at": 3.5, "move_absolute__execute": True, "move_absolute__position": 100.0},
    )
    given = alone(5.0, *sets, axis__initial_velocity=100.0)
    locked = at(given, 1.01)
    assert (shows(locked, "stop"), shows(locked, "halt")) == ({"busy", "active"}, {"error"})
    assert (locked["halt.error_id"], locked["error_id"], locked["error"]) == (0x42EF, 0x42EF, 1.0)
    assert named(given, "reset done") == [1.1]
    assert at(given, 1.2)["move_absolute.error_id"] == 0x42EF
    assert named(given, "stop done") == [close(1.7)]
    still = at(given, 2.0)
    assert (still["plcopen_state"], still["state_code"], shows(still, "stop")) == (STOPPING, INACTIVE, {"done"})
    assert shows(at(given, 2.6), "gear_out") == {"error"}
    free = at(given, 3.01)
    assert (free["plcopen_state"], shows(free, "stop"), free["error_id"]) == (STANDSTILL, set(), 0x42EF)
    assert (at(given, 3.6)["plcopen_state"], at(given, 3.6)["error"]) == (DISCRETE_MOTION, 0.0)


def test_a_stop_whose_execute_has_fallen_unlocks_at_standstill() -> None:
    sets = ({"at": 1.005, "stop__execute": True}, {"at": 1.2, "stop__execute": False})
    given = alone(3.0, *sets, axis__initial_velocity=100.0)
    assert [at(given, time)["plcopen_state"] for time in (1.5, 1.7, 1.71)] == [STOPPING, STOPPING, STANDSTILL]
    assert [shows(at(given, time), "stop") for time in (1.7, 1.71, 1.72)] == [{"busy", "active"}, {"done"}, set()]


def test_a_second_stop_edge_is_accepted() -> None:
    sets = (
        {"at": 1.0, "stop__execute": True, "stop__deceleration": 10.0},
        {"at": 1.5, "stop__execute": False},
        {"at": 2.0, "stop__execute": True, "stop__deceleration": 400.0},
    )
    given = alone(3.0, *sets, axis__initial_velocity=100.0)
    assert at(given, 2.9)["state_code"] == INACTIVE
    assert shows(at(given, 2.9), "stop") == {"done"}


@pytest.mark.parametrize(
    ("group", "values_", "error"),
    [
        ("move_velocity", {"velocity": 100.1}, 0x42DD),
        ("move_velocity", {"velocity": 50.0, "acceleration": -1.0}, 0x42DD),
        ("move_absolute", {"position": -1001.0}, 0x4372),
        ("move_absolute", {"position": 1001.0}, 0x4373),
        ("move_absolute", {"position": 1001.0, "jerk": -1.0}, 0x42DD),
        ("halt", {"deceleration": -1.0}, 0x42DD),
        ("stop", {"jerk": -1.0}, 0x42DD),
        ("gear_in_velo", {"ratio_denominator": 0}, 0x425B),
        ("gear_in_velo", {"ratio_numerator": 0.0, "velocity": -1.0}, 0x425B),
        ("gear_in_velo", {"velocity": -1.0}, 0x42DD),
        ("gear_in_velo", {}, 0x424A),
        ("gear_in_pos", {"master_start_distance": -1.0}, 0x426E),
    ],
)
def test_a_refused_command_leaves_the_slave_alone(group: str, values_: dict[str, float], error: int) -> None:
    inputs = {f"{group}__{name}": value for name, value in values_.items()} | {f"{group}__execute": True}
    sets = ({"at": 1.0, **inputs}, {"at": 2.0, f"{group}__execute": False}, {"at": 3.0, "reset__execute": True})
    limits = {"axis__min_position": -1000.0, "axis__max_position": 1000.0}
    given = alone(4.0, *sets, axis__initial_velocity=30.0, **limits)
    row, later = at(given, 1.5), at(given, 2.5)
    assert motion(row) == (close(45.0), 30.0, 0.0)
    assert (row[f"{group}.error_id"], row["error_id"], shows(row, group)) == (error, error, {"error"})
    assert (later[f"{group}.error_id"], later["error_id"], shows(later, group)) == (0.0, error, set())
    assert (at(given, 3.5)["error"], shows(at(given, 3.5), "reset")) == (0.0, {"done"})


def test_a_refused_command_does_not_abort_and_an_accepted_one_clears_the_error() -> None:
    sets = (
        {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 500.0},
        {"at": 1.0, "move_velocity__execute": True, "move_velocity__velocity": 1e6},
        {"at": 2.0, "gear_out__execute": True},
    )
    given = alone(8.0, *sets)
    assert shows(at(given, 1.5), "move_absolute") == {"busy", "active"}
    assert [at(given, time)["error"] for time in (1.5, 2.5)] == [1.0, 0.0]
    assert at(given, 7.0)["slave.position"] == 500.0


def test_a_command_refused_in_the_block_of_a_running_one_leaves_it_without_a_block() -> None:
    sets = (
        {"at": 0.1, "move_absolute__execute": True, "move_absolute__position": 100.0},
        {"at": 0.2, "move_absolute__execute": False},
        {"at": 0.3, "move_absolute__execute": True, "move_absolute__position": 1e10},
        {"at": 0.5, "move_absolute__execute": False},
    )
    given = alone(4.0, *sets)
    assert shows(at(given, 0.4), "move_absolute") == {"error"}
    assert shows(at(given, 0.6), "move_absolute") == set()
    assert at(given, 3.0)["slave.position"] == 100.0
    assert named(given, "move_absolute done") == []


def test_own_commands_uncouple_and_start_from_the_present_motion() -> None:
    given = example({"at": 2.0, "halt__execute": True, "halt__deceleration": 1000.0, "halt__jerk": 10000.0})
    before, after = at(given, 2.0), at(given, 2.0 + 1e-6)
    for name in ("position", "velocity", "acceleration"):
        assert after[f"slave.{name}"] == pytest.approx(before[f"slave.{name}"], abs=0.02)
    assert after["slave.jerk"] == -10000.0
    assert (after["coupled"], after["plcopen_state"]) == (0.0, DISCRETE_MOTION)
    assert (shows(after, "gear_in_pos"), shows(after, "halt")) == ({"command_aborted"}, {"busy", "active"})
    assert at(given, 3.5)["plcopen_state"] == STANDSTILL


# --- coupling to a velocity -------------------------------------------------------------------------------------------


def test_gear_in_velo_of_two_standing_axes_is_in_sync_at_once() -> None:
    segments = [{"duration": 1.0, "velocity": 0.0}, {"duration": 1.0, "acceleration": 100.0}]
    sets = {"at": 0.5, "gear_in_velo__execute": True}
    options = {"gear_in_velo__ratio_numerator": 3.0, "gear_in_velo__ratio_denominator": 2}
    given = scenario(segments, sets, **AXIS | options, axis__initial_position=5.0)
    row = at(given, 0.51)
    assert (row["state_code"], row["in_sync"], row["coupling_factor"]) == (SYNCHRON, 1.0, 1.5)
    assert shows(row, "gear_in_velo") == {"start_sync", "in_sync"}
    assert row["characteristics.profile"] == NONE
    assert motion(at(given, 1.5)) == (close(5.0 + 12.5 * 1.5), close(75.0), close(150.0))


def test_the_diagonal_saw_is_faster_by_the_cosine() -> None:
    given = steady(100.0, 2.0, {"at": 0.5, "gear_in_velo__execute": True}, diagonal_angle=60.0)
    row = at(given, 1.5)
    assert (row["coupling_factor"], row["slave.velocity"]) == (close(2.0), close(200.0))


TURN = [
    {"duration": 1.0, "velocity": 100.0},
    {"duration": 2.0, "velocity": -100.0},
    {"duration": 2.0, "velocity": 100.0},
]


def reversing(acceleration: float, *sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """gear_in_velo at 0.5 s (master at 50) from 20 u/s; up to 100 at 1 s, through 50 at 1.5 s and, after 3 s, 4.5 s.

    The ramp takes 1.5·80/acceleration.
    """
    limits = {"gear_in_velo__acceleration": acceleration, "gear_in_velo__deceleration": 100.0}
    given = {"axis__initial_velocity": 20.0, "axis__max_jerk": 1e9} | limits | options
    return scenario(TURN, {"at": 0.5, "gear_in_velo__execute": True}, *sets, **given)


LOCK, INSTANT = {"sync_mode__rollback_lock": True}, {"sync_mode__instant_stop_on_rollback": True}


@pytest.mark.parametrize("bits", [{}, INSTANT])
def test_without_the_lock_a_synchronous_slave_runs_back(bits: dict[str, bool]) -> None:
    """Cases 1 and 4: in sync after 0.3 s (master at 80, slave at 10 + 18)."""
    given = reversing(400.0, **bits)
    assert named(given, "in sync") == [close(0.8)]
    for time, position in ((1.4, 60.0), (2.5, -50.0), (4.9, 90.0)):
        assert motion(at(given, time)) == (close(28.0 + position - 80.0), -100.0 if time < 3 else 100.0, 0.0)
        assert at(given, time)["state_code"] == SYNCHRON


@pytest.mark.parametrize("lock", [{}, LOCK])
def test_before_sync_a_reversal_halts_smoothly(lock: dict[str, bool]) -> None:
    """Case 2 and 5: through 50 the slave has -20; T = 1.5·20/100 = 0.3 s, 3 further back."""
    given = reversing(100.0, **lock)
    back = at(given, 1.4)
    assert (back["state_code"], back["slave.velocity"] < 0) == (SYNCHRONIZING, True)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(10.0), close(-20.0), close(0.0))
    assert (before["state_code"], after["state_code"]) == (SYNCHRONIZING, PREPHASE)
    halting = at(given, 1.65)
    assert motion(halting) == (close(10 - 6 * 13 / 32), close(-10.0), close(100.0))
    assert shows(halting, "gear_in_velo") == {"busy", "active"}
    assert (halting["coupled"], halting["plcopen_state"], halting["in_sync"]) == (1.0, SYNCHRONIZED_MOTION, 0.0)
    parked = at(given, 2.5)
    assert motion(parked) == (close(7.0), 0.0, 0.0)
    assert (parked["state_code"], shows(parked, "gear_in_velo")) == (PREPHASE, {"busy", "active"})
    again = at(given, 4.6)
    assert (again["state_code"], shows(again, "gear_in_velo")) == (SYNCHRONIZING, {"start_sync", "busy", "active"})
    assert again["characteristics.master_position_start"] == close(50.0)
    assert again["characteristics.slave_position_start"] == close(7.0)
    assert again["characteristics.slave_velocity_start"] == 0.0


@pytest.mark.parametrize("lock", [{}, LOCK])
def test_before_sync_a_reversal_stops_at_once(lock: dict[str, bool]) -> None:
    """Cases 3 and 7."""
    given = reversing(100.0, **lock, **INSTANT)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(10.0), close(-20.0), close(0.0))
    assert motion(after) == (close(10.0), 0.0, 0.0)
    assert after["state_code"] == PREPHASE


def test_the_backstop_halts_a_synchronous_slave() -> None:
    """Case 6: at 1.5 s the slave is at 28 - 30 with -100; T = 1.5 s, 75 further back; again at 4.5 s."""
    given = reversing(400.0, **LOCK)
    before, after = reference(given, [1.5])
    assert motion(before) == (close(-2.0), -100.0, 0.0)
    assert (before["state_code"], after["state_code"], after["in_sync"]) == (SYNCHRON, PREPHASE, 0.0)
    assert shows(after, "gear_in_velo") == {"busy", "active"}
    assert motion(at(given, 2.25)) == (close(-2 - 75 * 13 / 16), close(-50.0), close(100.0))
    assert motion(at(given, 3.2)) == (close(-77.0), 0.0, 0.0)
    assert named(given, "in sync") == [close(0.8), close(4.5 + 1.5 * 100 / 400)]
    assert shows(at(given, 4.95), "gear_in_velo") == {"start_sync", "in_sync"}


def test_the_backstop_stops_a_synchronous_slave_at_once() -> None:
    """Case 8."""
    given = reversing(400.0, **LOCK, **INSTANT)
    assert motion(reference(given, [1.5])[1]) == (close(-2.0), 0.0, 0.0)
    assert motion(at(given, 4.0)) == (close(-2.0), 0.0, 0.0)


def test_a_master_that_turns_round_early_is_followed_out_of_the_halt() -> None:
    """Forwards through 50 again at 1.7 s, in the halt of 1.5 s."""
    segments = [{"duration": 1.0, "velocity": 100.0}, {"duration": 0.6, "velocity": -100.0}]
    segments.append({"duration": 2.0, "velocity": 100.0})
    given = reversing(400.0, **LOCK)
    given["master"]["segments"] = segments
    before, after = reference(given, [1.7])
    assert (before["state_code"], after["state_code"]) == (PREPHASE, SYNCHRONIZING)
    assert -100.0 < after["slave.velocity"] < 0.0
    for index, name in enumerate(("position", "velocity", "acceleration")):
        assert motion(after)[index] == close(motion(before)[index])
        assert after[f"characteristics.slave_{name}_start"] == close(motion(before)[index])


def test_a_refused_new_start_leaves_the_slave_standing() -> None:
    """In sync with the factor 2 below 500 u/s; parked, the master comes back with 300 u/s: 600."""
    segments = [
        {"duration": 2.0, "velocity": 100.0},
        {"duration": 3.0, "velocity": -100.0},
        {"duration": 3.0, "velocity": 300.0},
    ]
    limits = {"gear_in_pos__velocity": 500.0, "sync_mode__check_max_velocity": True, "axis__max_deceleration": 1000.0}
    options = {"gear_in_pos__ratio_numerator": 2.0, "gear_in_pos__master_sync_position": 100.0}
    options |= {"gear_in_pos__slave_sync_position": 100.0, **limits, **LOCK}
    given = scenario(
        segments, {"at": 0.5, "gear_in_pos__execute": True}, {"at": 3.0, "gear_in_pos__execute": False}, **options
    )
    assert named(given, "parked") == [close(3.5)]
    assert named(given, "gear_in_pos refused 0x42dd") == [close(5 + 150 / 300)]
    parked, refused = at(given, 5.3), at(given, 5.51)
    assert (parked["state_code"], refused["state_code"], refused["plcopen_state"]) == (PREPHASE, INACTIVE, STANDSTILL)
    assert (refused["error_id"], refused["coupled"]) == (0x42DD, 0.0)
    shown = [(shows(row, "gear_in_pos"), row["gear_in_pos.error_id"]) for row in (at(given, 5.5), at(given, 5.52))]
    assert shown[1] == (set(), 0.0)
    assert shows(at(given, 5.45), "gear_in_pos") == {"busy", "active"}


def test_a_coupling_is_planned_anew_from_the_present_motion() -> None:
    sets = {"at": 2.0, "gear_in_velo__execute": True, "gear_in_velo__ratio_numerator": 0.5}
    given = example(sets, gear_in_velo__acceleration=500.0, gear_in_velo__deceleration=500.0)
    before, after = at(given, 2.0), at(given, 2.01)
    assert after["characteristics.slave_position_start"] == close(before["slave.position"])
    assert after["characteristics.slave_acceleration_start"] == close(before["slave.acceleration"])
    assert (shows(after, "gear_in_pos"), after["state_code"]) == ({"command_aborted"}, SYNCHRONIZING)
    late = at(given, 5.9)
    assert (late["state_code"], late["slave.velocity"], late["coupling_factor"]) == (SYNCHRON, 250.0, 0.5)


# --- time based -------------------------------------------------------------------------------------------------------

TIMED = {"sync_mode__time_based": True, "gear_in_velo__acceleration": 500.0, "gear_in_velo__deceleration": 500.0}


def timed(segments: list[dict[str, float]], **options: Any) -> dict[str, Any]:
    """gear_in_velo at 0.5 s from rest."""
    return scenario(
        segments, {"at": 0.5, "gear_in_velo__execute": True}, **TIMED | {"gear_in_velo__jerk": 5000.0} | options
    )


def test_time_based_at_constant_velocity() -> None:
    """0 to 200 with 500 and 5000: 0.4 + 0.1 s over 50; the master then at 100 + 100."""
    given = timed([{"duration": 3.0, "velocity": 200.0}])
    assert named(given, "in sync") == [close(1.0)]
    assert motion(reference(given, [1.0])[1]) == (close(50.0), 200.0, 0.0)
    assert at(given, 2.0)["slave.position"] == close(250.0)
    assert at(given, 0.8)["characteristics.profile"] == JERK_LIMITED
    assert at(given, 0.8)["characteristics.master_position_end"] == close(200.0)


def test_time_based_catches_up_with_an_accelerating_master() -> None:
    given = timed([{"duration": 0.6, "velocity": 100.0}, {"duration": 2.4, "acceleration": 100.0}, {"duration": 3.0}])
    synchronous = named(given, "in sync")
    assert len(synchronous) == 1
    rows = reference(given, [0.5 + 0.01 * i for i in range(300)])
    assert max(row["slave.acceleration"] for row in rows) <= 500.0 + 1e-9
    assert 0.8 < synchronous[0] < 1.2
    late = at(given, synchronous[0] + 0.01)
    assert (late["slave.acceleration"], late["state_code"]) == (100.0, SYNCHRON)
    for before, after in pairwise(rows):
        step = after["time"] - before["time"]
        mean = (before["slave.velocity"] + after["slave.velocity"]) / 2
        assert after["slave.position"] - before["slave.position"] == pytest.approx(mean * step, abs=5000 * step**3)
        assert abs(after["slave.velocity"] - before["slave.velocity"]) <= 500.0 * step + 1e-9
    early, late = at(given, 0.6 - 1e-7), at(given, 0.6 + 1e-7)
    assert late["slave.acceleration"] == pytest.approx(early["slave.acceleration"], abs=1e-2)


def test_time_based_starts_anew_where_the_master_jumps() -> None:
    given = timed([{"duration": 0.7, "velocity": 200.0}, {"duration": 3.0, "velocity": -50.0}])
    before, after = at(given, 0.7), at(given, 0.7 + 1e-7)
    assert motion(after) == pytest.approx(motion(before), rel=1e-5)
    assert at(given, 3.0)["slave.velocity"] == -50.0
    assert len(named(given, "in sync")) == 1


def test_a_target_beyond_the_velocity_limit_is_waited_for() -> None:
    """The master rises from 100 at 0.6 s to 300 and falls again: beyond 150 from 0.85 s to 2.35 s."""
    segments = [{"duration": 0.6, "velocity": 100.0}, {"duration": 1.0, "acceleration": 200.0}]
    segments += [{"duration": 1.2, "acceleration": -200.0}, {"duration": 1.0}]
    given = timed(segments, gear_in_velo__velocity=150.0, gear_in_velo__acceleration=250.0)
    beyond = at(given, 2.3)
    assert (beyond["slave.velocity"], beyond["slave.acceleration"], beyond["state_code"]) == (150.0, 0.0, SYNCHRONIZING)
    assert max(row["slave.velocity"] for row in reference(given, [0.02 * i for i in range(190)])) <= 150.0 + 1e-9
    synchronous = named(given, "in sync")
    assert len(synchronous) == 1
    assert synchronous[0] > 2.35
    row = at(given, 3.7)
    assert (row["slave.velocity"], row["state_code"]) == (close(60.0), SYNCHRON)


# --- waiting, periods, cuts -------------------------------------------------------------------------------------------


def waiting(*sets: dict[str, Any], **options: Any) -> dict[str, Any]:
    """gear_in_pos at 0.5 s; it starts when the master passes 1000 - 800, at 1.9 s; meanwhile a move to 60."""
    move_ = {
        "at": 0.2,
        "move_absolute__execute": True,
        "move_absolute__position": 60.0,
        "move_absolute__velocity": 50.0,
    }
    options = {"position": -750.0, "gear_in_pos__master_start_distance": 800.0} | MEET | options
    return steady(500.0, 6.0, move_, {"at": 0.5, "gear_in_pos__execute": True}, *sets, **options)


def test_waiting_for_the_start_distance_the_own_motion_goes_on() -> None:
    given = waiting()
    row = at(given, 1.0)
    assert (row["state_code"], row["plcopen_state"], row["coupled"]) == (PREPHASE, SYNCHRONIZED_MOTION, 1.0)
    assert (shows(row, "gear_in_pos"), shows(row, "move_absolute")) == ({"busy", "active"}, {"command_aborted"})
    assert row["slave.velocity"] == 50.0
    assert motion(at(given, 1.89)) == (60.0, 0.0, 0.0)
    assert row["characteristics.profile"] == NONE
    started = at(given, 2.0)
    assert (started["state_code"], shows(started, "gear_in_pos")) == (SYNCHRONIZING, {"start_sync", "busy", "active"})
    assert started["characteristics.master_position_start"] == close(200.0)
    assert at(given, 4.0)["slave.position"] == close(1250.0)


def test_a_start_distance_already_passed_starts_at_once() -> None:
    given = waiting(gear_in_pos__master_start_distance=2000.0)
    assert at(given, 0.51)["state_code"] == SYNCHRONIZING
    refused = waiting(gear_in_pos__master_start_distance=-1.0)
    assert at(refused, 0.51)["gear_in_pos.error_id"] == 0x42DE
    assert shows(at(refused, 0.51), "move_absolute") == {"busy", "active"}


@pytest.mark.parametrize("group", ["gear_out", "halt", "stop"])
def test_waiting_ends_by_command(group: str) -> None:
    given = waiting({"at": 0.8, f"{group}__execute": True})
    row = at(given, 2.5)
    assert (row["coupled"], shows(row, "gear_in_pos")) == (0.0, {"command_aborted"})
    assert row["slave.velocity"] == (50.0 if group == "gear_out" else 0.0)


def test_a_start_refused_after_waiting_leaves_the_own_motion() -> None:
    given = waiting(gear_in_pos__slave_sync_position=50.0)
    assert shows(at(given, 1.5), "gear_in_pos") == {"busy", "active"}
    row = at(given, 2.0)
    assert (row["gear_in_pos.error_id"], row["error_id"], row["coupled"]) == (0x42DE, 0x42DE, 0.0)
    assert motion(row) == (60.0, 0.0, 0.0)


@pytest.mark.parametrize(("velocity", "travel"), [(100.0, 10.0), (-100.0, 330.0)])
def test_a_sync_position_within_the_period_is_the_next_one_ahead(velocity: float, travel: float) -> None:
    """The master at 360 or 340 at 0.1 s, 10 being meant: 370 forwards, 10 backwards."""
    slave = math.copysign(20.0, velocity)
    sync = {"gear_in_pos__master_sync_position": 10.0, "gear_in_pos__slave_sync_position": slave}
    given = steady(
        velocity, 4.0, {"at": 0.1, "gear_in_pos__execute": True}, position=710.0, master__period=360.0, **sync
    )
    assert named(given, "in sync") == [close(0.1 + travel / 100)]
    row = at(given, 0.15)
    assert row["characteristics.master_position_start"] == close(0.0 if velocity > 0 else 340.0)
    assert row["characteristics.master_position_end"] == close(10.0)
    assert at(given, 3.9)["slave.position"] == close(slave + math.copysign(380.0 - travel, velocity))


def test_a_sync_position_outside_the_period_is_meant_literally() -> None:
    sync = {"gear_in_pos__master_sync_position": 800.0, "gear_in_pos__slave_sync_position": 100.0}
    given = steady(100.0, 6.0, {"at": 0.1, "gear_in_pos__execute": True}, position=710.0, master__period=360.0, **sync)
    assert named(given, "in sync") == [close(0.1 + (800 - 360) / 100)]


def test_twenty_cuts_lie_one_length_apart() -> None:
    """Each synchronisation is commanded in the return travel; while in sync m - s = n·L. The master changes speed."""
    length, x, sets = 1000.0, 300.0, []
    for n in range(20):
        begin = 2.0 * n + 0.1
        sync = {"gear_in_pos__master_sync_position": n * length + x, "gear_in_pos__slave_sync_position": x}
        sets += [
            {"at": begin, "gear_in_pos__execute": True, "move_absolute__execute": False, "gear_out__execute": False}
            | sync,
            {"at": begin + 1.2, "gear_out__execute": True, "gear_in_pos__execute": False},
            {"at": begin + 1.25, "move_absolute__execute": True},
        ]
    segments = [{"duration": 20.0, "velocity": 500.0}, {"duration": 2.0, "acceleration": 20.0}]
    segments += [{"duration": 2.0, "acceleration": -20.0}, {"duration": 16.0, "velocity": 500.0}]
    given = scenario(segments, *sets, position=-200.0, axis__max_velocity=3000.0)
    rows = reference(given, [0.2 * i for i in range(200)])
    assert sum(after["in_sync"] > before["in_sync"] for before, after in pairwise(rows)) == 20
    master = stretches(given["master"], mp.mpf(40))
    for row in rows:
        if row["in_sync"]:
            here = next(s for s in reversed(master) if s.begin <= row["time"]).at(mp.mpf(row["time"])).position
            cuts = float(here - mp.mpf(row["slave.position"])) / length
            assert cuts == pytest.approx(round(cuts), abs=1e-12)


def test_a_wrong_script_is_refused() -> None:
    with pytest.raises(ValueError, match="never an edge"):
        events(alone(1.0, {"at": 0.0, "halt__execute": True}))
    with pytest.raises(ValueError, match="exekute"):
        events(alone(1.0, {"at": 0.5, "halt__exekute": True}))
    with pytest.raises(ValueError, match="constant in each segment"):
        events(timed([{"duration": 0.6, "velocity": 100.0}, {"duration": 1.0, "jerk": 100.0}]))
