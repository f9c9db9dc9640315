"""The plans of the FlyingSaw's oracle against the specification's numbers, sampling and closed forms."""

import math
import random
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tests.model.flying_saw.oracle_cases import (
    EXAMPLE_3,
    EXAMPLE_4_1,
    EXAMPLE_4_2,
    VELOCITY_CHECKS,
    close,
    limits_of,
    random_plan,
    values,
)
from tests.oracle import mp
from tests.oracle.flying_saw_curves import Curve, real_roots
from tests.oracle.flying_saw_plan import (
    JERK_LIMITED,
    NONE,
    P5,
    P5_P1,
    plan,
    velocity_ramp,
)
from tests.oracle.mp import Number

# --- known results of plans -------------------------------------------------------------------------------------------


def test_section_4_example_1() -> None:
    smooth = plan(**EXAMPLE_4_1)
    assert (smooth.error, smooth.profile, float(smooth.curve.duration)) == (0, P5, 3.0)
    assert limits_of(smooth, "velocity") == [close(250.0), close(506.0)]
    assert limits_of(smooth, "acceleration") == [pytest.approx(-15.04601, abs=5e-6), pytest.approx(175.04601, abs=5e-6)]
    assert limits_of(smooth, "jerk") == [close(-1400 / 9), close(4000 / 9)]
    direct = plan(**EXAMPLE_4_1, bits=VELOCITY_CHECKS)
    assert (direct.error, direct.profile) == (0, P5_P1)
    assert float(direct.curve.segments[0].length) == close(2.0)
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
    assert (direct.profile, float(direct.curve.segments[0].length)) == (P5_P1, close(2.5))
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
    result = plan("gear_in_velo", (10, 50, 0), (7, 0, 0), 2, (500, 100, 300, 1e9))
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
    assert {name: float(value) for name, value in result.characteristics.items()} == {
        name: close(value) for name, value in expected.items()
    }


def test_in_sync_at_once_start_is_end() -> None:
    for master, slave, velocity in (((3, 0, 0), (4, 0, 0), 0.0), ((3, -20, 0), (4, -10, 0), -10.0)):
        result = plan("gear_in_velo", master, slave, 0.5, (500, 100, 300, 1e9))
        assert (result.error, result.profile, float(result.curve.duration)) == (0, NONE, 0.0)
        names = ("master_position_start", "master_position_end", "slave_position_start", "slave_position_end")
        assert values(result, *names) == [3.0, 3.0, 4.0, 4.0]
        assert limits_of(result, "velocity") == [velocity, velocity]
        assert values(result, "slave_velocity_mean", "slave_acceleration_effective") == [abs(velocity), 0.0]


# --- plans against sampling and closed forms --------------------------------------------------------------------------


def curve_numbers(curve: Curve, count: int = 4000) -> tuple[np.ndarray[Any, Any], ...]:
    """Times, positions, velocities, accelerations, jerks, from the coefficients in double precision."""
    columns: list[list[Any]] = [[], [], [], [], []]
    for segment in curve.segments:
        x = np.linspace(0.0, float(segment.length), count)
        p = np.polynomial.Polynomial([float(c) for c in segment.polynomial])
        for column, part in zip(
            columns, (x + float(segment.begin), p(x), *(p.deriv(k)(x) for k in (1, 2, 3))), strict=True
        ):
            column.append(part)
    return tuple(np.concatenate(column) for column in columns)


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
        result = plan(**random_plan(chance, mode, bits=bits))
        if result.error:
            continue
        master, slave = result.request.master, result.request.slave
        t, s, v, a, j = curve_numbers(result.curve)
        duration_ = float(result.curve.duration)
        for name, column in (("position", s), ("velocity", v), ("acceleration", a)):
            span = max(float(np.ptp(column)), 1e-6)
            assert limits_of(result, name) == pytest.approx([column.min(), column.max()], abs=1e-5 * span)
            for side in ("min", "max"):
                place = values(result, f"master_position_at_slave_{name}_{side}")[0]
                there = result.at(place)[("position", "velocity", "acceleration").index(name)]
                assert float(there) == pytest.approx(values(result, f"slave_{name}_{side}")[0], abs=1e-9 * span + 1e-9)
        assert limits_of(result, "jerk") == pytest.approx([j.min(), j.max()], abs=1e-6 * abs(j).max())
        momentum = v * a
        expected = [momentum.min(), momentum.max()]
        assert limits_of(result, "dynamic_momentum") == pytest.approx(expected, abs=1e-5 * abs(momentum).max())
        mean, effective = values(result, "slave_velocity_mean", "slave_acceleration_effective")
        assert mean == pytest.approx(np.trapezoid(abs(v), t) / duration_, rel=1e-4)
        assert effective == pytest.approx(math.sqrt(np.trapezoid(a * a, t) / duration_), rel=1e-4)
        assert v[0] == pytest.approx(float(slave.velocity), rel=1e-12)
        assert v[-1] == pytest.approx(float(result.request.synchronous_velocity), rel=1e-9)
        assert abs(a[-1]) <= 1e-9 * abs(a).max()
        if mode == "gear_in_pos":
            assert s[-1] == pytest.approx(float(result.request.sync[1]), rel=1e-12, abs=1e-9)
            assert float(result.master_end) == pytest.approx(float(result.request.sync[0]), rel=1e-12)
        if "time_based" not in bits:
            tilted = float(slave.acceleration - slave.velocity * master.acceleration / master.velocity)
            assert a[0] == pytest.approx(tilted, rel=1e-9, abs=1e-9 * abs(a).max())


def test_pieces_join_with_continuous_acceleration() -> None:
    chance, joints = random.Random(2), 0
    for bits in (("prefer_constant_velocity",), VELOCITY_CHECKS, ("check_max_velocity",)) * 8:
        given = random_plan(chance, "gear_in_pos", bits=bits)
        given["master"], given["slave"] = (*given["master"][:2], 0.0), (*given["slave"][:2], 0.0)
        segments = plan(**given).curve.segments
        for before, after in pairwise(segments):
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
