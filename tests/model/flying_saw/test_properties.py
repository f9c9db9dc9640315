"""Properties of the FlyingSaw on random runs: synchronisations, their checks, and motions of the axis itself."""

import math
from collections.abc import Iterable, Mapping
from itertools import pairwise
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from motionsync.flying_saw.characteristics import Characteristics
from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.master import MasterInput
from tests.model.flying_saw.harness import OUTPUTS, VELOCITY_CHECKS, FlyingSawHarness
from tests.model.flying_saw.random_meetings import (
    END,
    PEAKS,
    START,
    TICK,
    Meeting,
    meetings,
    repeatable,
    rngs,
    samples,
    sign,
)
from tests.support.harness import MOTION, Row

# --- one synchronisation to a position --------------------------------------------------------------------------------


PROFILES = [(), VELOCITY_CHECKS, VELOCITY_CHECKS[:1], ("prefer_constant_velocity",)]


profiles = st.sampled_from(PROFILES)


@repeatable
@given(meetings(), profiles, rngs, st.sampled_from([START, END]), st.booleans())
def test_whatever_the_master_does_on_the_way_the_sync_point_is_met_exactly(
    meeting: Meeting, modes: tuple[str, ...], rng: Random, mode: MasterInput, moved: bool
) -> None:
    """The master gets faster, slower, stops and goes on; then it comes to its sync position at the end of a step."""
    saw = meeting.saw(*modes, mode=mode)
    if moved:  # the master has an acceleration at the edge
        saw.run(TICK, acceleration=0.3 * meeting.speed / meeting.duration)
    meeting.give(saw).run(TICK, acceleration=0.3 * meeting.speed / meeting.duration if moved else 0.0)
    assume(not saw["gear_in_pos.error"])
    direction = sign(meeting.speed)
    left = abs(meeting.master_sync - saw.master_position)
    for _ in range(rng.randint(0, 5)):
        target = meeting.speed * rng.choice([0.0, 0.2, 1.0, 2.0, rng.uniform(0.0, 2.0)])
        duration = rng.uniform(0.02, 0.3) * meeting.duration
        if 0.5 * abs(saw.speed + target) * duration > 0.3 * left:
            break
        saw.run(duration, acceleration=(target - saw.speed) / duration, cuts=[rng.random() * duration])
        assert saw.state == State.SYNCHRONIZING
        if target == 0.0:
            before = saw.slave[0]
            saw.speed = 0.0
            saw.run(rng.uniform(0.1, 1.0))
            assert saw.slave == pytest.approx((before, 0.0, 0.0), abs=1e-12 * max(1.0, abs(before)))
        left = abs(meeting.master_sync - saw.master_position)
    if abs(saw.speed) < 0.01 * abs(meeting.speed):
        duration = left / abs(meeting.speed)
        saw.run(duration, acceleration=direction * left / duration**2)
        left = abs(meeting.master_sync - saw.master_position)
    duration = left / abs(saw.speed)
    saw.run(duration, cuts=sorted(rng.random() * duration for _ in range(3)))
    scale = meeting.length + 1e-3 * (abs(saw.master_position) + abs(saw.slave[0]))
    on_line = meeting.slave_sync + meeting.ratio * (saw.master_position - meeting.master_sync)
    assert saw.slave[0] == pytest.approx(on_line, abs=1e-9 * scale)
    assert saw.slave[1] == pytest.approx(meeting.ratio * saw.speed, abs=1e-9 * scale * abs(saw.speed / meeting.speed))
    for _ in range(4):
        saw.run(0.1 * meeting.duration, acceleration=rng.gauss(0.0, 1.0) * meeting.speed / meeting.duration)
        on_line = meeting.slave_sync + meeting.ratio * (saw.master_position - meeting.master_sync)
        assert saw.state == State.SYNCHRON
        assert saw.slave[0] == pytest.approx(on_line, abs=1e-9 * scale)
        assert saw.slave[1] == pytest.approx(meeting.ratio * saw.speed, rel=1e-12)


def assert_joined(saw: FlyingSawHarness, meeting: Meeting, before: Row, h: float) -> None:
    """Two steps of h after `before`, with a transition between them: the next derivative accounts for the time."""
    after, t = saw.read(MOTION), meeting.duration
    values = saw.read(name for name in OUTPUTS if name.startswith("characteristics.slave_"))
    speed, gain, jerk = (
        max(abs(value) for name, value in values.items() if f"slave_{kind}" in name)
        for kind in ("velocity", "acceleration", "jerk")
    )
    jerk += abs(before["slave.jerk"]) + 3.0 * gain / t
    allowed = {
        "slave.position": 1e-9 * meeting.length + 1e-14 * abs(after["slave.position"]),
        "slave.velocity": 1e-9 * (speed + gain * t) + 4.0 * h * h * jerk,
        "slave.acceleration": 1e-9 * (gain + speed / t) + 4.0 * h * jerk,
    }
    for name, rate in pairwise(MOTION):
        gap = after[name] - before[name]
        if name != "slave.acceleration":
            gap -= h * (after[rate] + before[rate])
        assert abs(gap) <= allowed[name], name


@repeatable
@given(meetings(), profiles, rngs, st.booleans(), st.booleans())
def test_position_velocity_and_acceleration_join_at_start_and_in_sync(
    meeting: Meeting, modes: tuple[str, ...], rng: Random, accelerated: bool, master_accelerated: bool
) -> None:
    """From an accelerated state the quintic takes up the acceleration; the other profiles begin without."""
    steep = abs(meeting.ratio * meeting.speed) / meeting.duration
    limits = {"axis.max_acceleration": 10.0 * steep, "axis.max_deceleration": 10.0 * steep}
    saw = meeting.saw(*modes, **limits, **{"axis.max_jerk": 100.0 * steep / meeting.duration})
    acceleration = rng.uniform(-0.3, 0.3) * meeting.speed / meeting.duration if master_accelerated else 0.0
    h = 1e-6 * meeting.duration
    if accelerated:
        saw.give("move_velocity", velocity=meeting.velocity + rng.uniform(0.2, 1.0) * meeting.ratio * meeting.speed)
        saw.run(rng.uniform(0.01, 0.1) * meeting.duration, acceleration=acceleration)
    before = saw.run(h, acceleration=acceleration).read(MOTION)
    meeting.give(saw)
    begin = saw.twin().run(TICK * h, acceleration=acceleration)
    assume(not begin["gear_in_pos.error"])
    risen = TICK * h * begin["slave.jerk"]
    assert begin.slave[2] == pytest.approx(before["slave.acceleration"] + risen, abs=1e-6 * steep)
    before = begin.read(MOTION)
    saw.run(2.0 * h, acceleration=acceleration)
    assert_joined(saw, meeting, before, h)
    left = (meeting.master_sync - saw.master_position) / saw.speed
    before = saw.run(left - h).read(MOTION)
    assert saw.state == State.SYNCHRONIZING
    assert saw.run(2.0 * h).state == State.SYNCHRON
    assert_joined(saw, meeting, before, h)


# --- checks -----------------------------------------------------------------------------------------------------------


CHECKS = (
    *("check_min_position", "check_max_position", "check_max_velocity", *PEAKS),
    *("check_overshoot_position", "check_undershoot_position", *VELOCITY_CHECKS),
    *("check_overshoot_velocity_zero", "check_undershoot_velocity_zero"),
)


def assert_within_characteristics(result: Characteristics, rows: list[Row], sizes: Mapping[str, float]) -> None:
    """No row exceeds the extremes of a quantity, but for 1e-9 of its size."""
    for name, size in sizes.items():
        values = [row[f"slave.{name}"] for row in rows]
        least, most = getattr(result, f"slave_{name}_min"), getattr(result, f"slave_{name}_max")
        assert min(values) >= least - 1e-9 * size
        assert max(values) <= most + 1e-9 * size


def assert_within_limits(rows: list[Row], modes: Iterable[str], limits: Mapping[str, float]) -> None:
    """Every row keeps the limits of acceleration, deceleration and jerk that these modes check."""
    for row in rows:
        v, a, j = row["slave.velocity"], row["slave.acceleration"], row["slave.jerk"]
        if "check_max_acceleration" in modes and v * a > 0.0:
            assert abs(a) <= limits["acceleration"] * (1 + 1e-8)
        if "check_max_deceleration" in modes and v * a < 0.0:
            assert abs(a) <= limits["deceleration"] * (1 + 1e-8)
        if "check_max_jerk" in modes:
            assert abs(j) <= limits["jerk"] * (1 + 1e-8)


@settings(repeatable, max_examples=400)
@given(meetings(), rngs, st.booleans())
def test_no_check_that_has_passed_is_broken_at_constant_master_velocity(
    meeting: Meeting, rng: Random, to_velocity: bool
) -> None:
    """No characteristic value is exceeded either."""
    group = "gear_in_velo" if to_velocity else "gear_in_pos"
    t, vs = meeting.duration, meeting.ratio * meeting.speed
    modes = [name for name in CHECKS if rng.random() < 0.2]
    modes += ["prefer_constant_velocity"] * (rng.random() < 0.4)
    limits = {
        "velocity": abs(vs) * rng.uniform(1.0, 2.0),
        "acceleration": abs(vs) / t * 10.0 ** rng.uniform(0.0, 1.5),
        "deceleration": abs(vs) / t * 10.0 ** rng.uniform(0.0, 1.5),
        "jerk": abs(vs) / t**2 * 10.0 ** rng.uniform(0.8, 2.5),
    }
    low = min(meeting.position, meeting.slave_sync) - rng.uniform(0.0, 0.3) * abs(meeting.distance)
    high = max(meeting.position, meeting.slave_sync) + rng.uniform(0.0, 0.3) * abs(meeting.distance)
    saw = meeting.saw(*modes, **{"axis.min_position": low, "axis.max_position": high})
    if to_velocity:
        saw.give("gear_in_velo", ratio_numerator=meeting.ratio, **limits)
    else:
        meeting.give(saw, **limits)
    saw.run(TICK)
    assume(not saw[f"{group}.error"])
    result = saw.block.characteristics
    t = (result.master_position_end - result.master_position_start) / meeting.speed
    assume(t > 3 * TICK)
    rows = [saw.read(MOTION), *samples(saw, t - 2 * TICK)]
    assert saw.state == State.SYNCHRONIZING
    sizes = {name: max(abs(row[f"slave.{name}"]) for row in rows) for name in ("velocity", "acceleration", "jerk")}
    sizes["position"] = result.slave_position_max - result.slave_position_min + 1e-3 * abs(meeting.position)
    assert_within_characteristics(result, rows, sizes)
    assert_within_limits(rows, modes, limits)
    positions, velocities = ([row[f"slave.{name}"] for row in rows] for name in ("position", "velocity"))
    position_tolerance, velocity_tolerance = 1e-8 * sizes["position"], 1e-8 * sizes["velocity"]
    start, end = sorted((meeting.position, result.slave_position_end))
    mirrored = [sign(vs) * v for v in velocities]
    first, last = sign(vs) * meeting.velocity, abs(vs)
    retained = {
        "check_min_position": min(positions) >= low - position_tolerance,
        "check_max_position": max(positions) <= high + position_tolerance,
        "check_max_velocity": max(abs(v) for v in velocities) <= limits["velocity"] + velocity_tolerance,
        "check_overshoot_position": max(positions) <= end + position_tolerance,
        "check_undershoot_position": min(positions) >= start - position_tolerance,
        "check_overshoot_velocity": max(mirrored) <= max(first, last) + velocity_tolerance,
        "check_undershoot_velocity": min(mirrored) >= min(first, last) - velocity_tolerance,
        "check_overshoot_velocity_zero": max(velocities) <= velocity_tolerance,
        "check_undershoot_velocity_zero": min(mirrored) >= -velocity_tolerance,
    }
    assert [name for name in modes if not retained.get(name, True)] == []


@repeatable
@given(meetings(), rngs)
def test_a_constant_velocity_is_found_wherever_there_is_one(meeting: Meeting, rng: Random) -> None:
    """A constant velocity is chosen first; the distance that belongs to it is then asked for."""
    t, v0, vs = meeting.duration, meeting.velocity, meeting.ratio * meeting.speed
    limit = (abs(v0) + abs(vs)) / t * 10.0 ** rng.uniform(0.0, 1.5)
    c = vs * rng.uniform(0.0, 2.0)
    rise, fall = 1.5 * abs(c - v0) / limit, 1.5 * abs(vs - c) / limit
    distance = c * t - 0.5 * (c - v0) * rise - 0.5 * (c - vs) * fall
    assume(rise + fall <= t and distance * sign(vs) > 1e-3 * abs(vs) * t)
    saw = meeting.saw("prefer_constant_velocity")
    aims = {"master_sync_position": meeting.master_sync, "slave_sync_position": meeting.position + distance}
    saw.give("gear_in_pos", **aims, ratio_numerator=meeting.ratio, acceleration=limit, deceleration=limit)
    saw.run(TICK)
    assert saw["characteristics.profile"] == ProfileKind.P5_P1_P5
    middle = rise + 0.5 * (t - rise - fall)
    assume(middle > 2 * TICK and t - rise - fall > 1e-3 * t)
    assert saw.run(middle - TICK).slave[1:] == pytest.approx((c, 0.0), abs=1e-6 * (abs(c) + abs(vs)))


def shortest(change: float, along: float, limit: float, jerk: float) -> float:
    """Duration of gear_in_velo's ramp, by the specification's list of candidates; `jerk` 0: not checked."""
    peak = max(limit, abs(along))
    b = 2.0 * peak - along + 2.0 * math.sqrt(max(peak * peak - peak * along, 0.0))
    by_acceleration = 6.0 * change / (b + 3.0 * along)
    if jerk == 0.0:
        return by_acceleration
    result = [by_acceleration]
    for lean in (4.0 * along, 2.0 * along):
        for limited in (jerk, -jerk):
            inside = lean * lean + 24.0 * change * limited
            if inside >= 0.0:
                roots = [(lean + side * math.sqrt(inside)) / (12.0 * change) for side in (1.0, -1.0)]
                result += [1.0 / x for x in roots if x > 0.0]

    def keeps_limits(t: float) -> bool:
        ends = abs(6.0 * change / t**2 - 4.0 * along / t), abs(6.0 * change / t**2 - 2.0 * along / t)
        return t >= by_acceleration * (1.0 - 1e-12) and max(ends) <= jerk * (1.0 + 1e-9)

    return min(t for t in result if keeps_limits(t))


@settings(repeatable, max_examples=300)
@given(rngs, st.booleans(), st.booleans())
def test_a_synchronisation_to_velocity_is_the_shortest_ramp(rng: Random, checked: bool, ignored: bool) -> None:
    """From an accelerated slave and to an accelerated master: the profile's own acceleration is a0 - v0 a_m / v_m."""
    speed, ratio = rng.uniform(50.0, 200.0) * rng.choice([1.0, -1.0]), rng.uniform(-2.0, 2.0)
    saw = FlyingSawHarness({"axis.initial_velocity": rng.gauss(0.0, 100.0), "axis.max_jerk": 2e4}, speed=speed)
    saw.give("move_velocity", velocity=rng.gauss(0.0, 150.0)).run(rng.uniform(0.0, 0.15))
    saw.modes(*["check_max_jerk"] * checked, *["ignore_slave_acceleration", "ignore_master_acceleration"] * ignored)
    _, velocity, a0 = saw.slave
    gain = rng.choice([0.0, rng.gauss(0.0, 100.0)])
    limits = {"acceleration": rng.uniform(300.0, 3000.0), "deceleration": rng.uniform(300.0, 3000.0)}
    limits["jerk"] = 10.0 ** rng.uniform(3.0, 6.0)
    saw.give("gear_in_velo", ratio_numerator=ratio, **limits).run(TICK, acceleration=gain)
    end = ratio * speed
    change = end - velocity
    along = 0.0 if ignored else (a0 - velocity * gain / speed) * sign(change)
    if velocity * end < 0.0:
        limit = min(limits["acceleration"], limits["deceleration"])
    else:
        limit = limits["acceleration" if abs(end) > abs(velocity) else "deceleration"]
    duration = shortest(abs(change), along, limit, limits["jerk"] if checked else 0.0)
    result = saw.block.characteristics
    assert (result.master_position_end - result.master_position_start) / speed == pytest.approx(duration, rel=1e-9)
    assert result.slave_acceleration_start * sign(change) == pytest.approx(along, rel=1e-9, abs=1e-9)
    most = max(abs(result.slave_acceleration_min), abs(result.slave_acceleration_max))
    assert most <= max(limit, abs(along)) * (1 + 1e-9)
    if not checked:
        assert most == pytest.approx(max(limit, abs(along)), rel=1e-9)
    u = saw.speed * TICK / (speed * duration)  # the master is here by constant acceleration: nearly at v_m
    assert saw.slave[1] == pytest.approx(velocity + along * sign(change) * u * duration, rel=1e-3, abs=0.1)


# --- time based -------------------------------------------------------------------------------------------------------


@repeatable
@given(rngs)
def test_time_based_it_comes_in_sync_and_keeps_its_limits(rng: Random) -> None:
    speed, ratio = rng.choice([1.0, -1.0]) * rng.uniform(50.0, 200.0), rng.uniform(0.3, 2.0)
    limits = {
        "velocity": abs(ratio * speed) * rng.choice([1.1, 5.0]),
        "acceleration": rng.uniform(500.0, 3000.0),
        "deceleration": rng.uniform(500.0, 3000.0),
        "jerk": 10.0 ** rng.uniform(3.5, 5.0),
    }
    saw = FlyingSawHarness({"axis.initial_velocity": rng.uniform(-1.0, 1.0) * limits["velocity"]}, speed=speed).modes(
        "time_based"
    )
    saw.give("gear_in_velo", ratio_numerator=ratio, **limits)
    h = 1.0 / 256.0
    steepest = max(limits["acceleration"], limits["deceleration"])
    for _ in range(rng.randint(1, 5)):
        gain = rng.choice([0.0, rng.uniform(-0.5, 0.5) * min(limits["acceleration"], limits["deceleration"]) / ratio])
        for row in saw.rows(24 * h, acceleration=gain, cuts=[i * h for i in range(24)]).values():
            if saw.state == State.SYNCHRONIZING:
                assert abs(row["slave.acceleration"]) <= steepest * (1 + 1e-9)
                assert abs(row["slave.jerk"]) <= limits["jerk"] * (1 + 1e-9)
    within = abs(ratio * saw.speed) <= limits["velocity"]
    saw.run(8.0)
    assert (saw.state == State.SYNCHRON) or not within
    if saw.state == State.SYNCHRON:
        offset = saw.slave[0] - ratio * saw.master_position
        assert saw.slave[1:] == pytest.approx((ratio * saw.speed, 0.0), rel=1e-12)
        saw.run(0.3, acceleration=1e4).run(0.3, acceleration=-3e4)
        assert saw.slave[0] - ratio * saw.master_position == pytest.approx(
            offset, abs=1e-9 * (1 + abs(saw.master_position))
        )
    else:
        assert saw.slave[1:] == pytest.approx((math.copysign(limits["velocity"], ratio * saw.speed), 0.0), rel=1e-9)


# --- own motion -------------------------------------------------------------------------------------------------------


@repeatable
@given(rngs)
def test_own_motions_keep_their_limits_and_come_to_their_ends(rng: Random) -> None:
    limits = {"acceleration": rng.uniform(100.0, 3000.0), "deceleration": rng.uniform(100.0, 3000.0)}
    limits["jerk"] = 10.0 ** rng.uniform(3.0, 5.0)
    velocity = rng.uniform(20.0, 300.0)
    saw = FlyingSawHarness({f"axis.max_{name}": limit for name, limit in {**limits, "velocity": velocity}.items()})
    steepest = max(limits["acceleration"], limits["deceleration"])
    for _ in range(rng.randint(1, 6)):
        group = rng.choice(["move_absolute", "move_absolute", "move_velocity", "halt"])
        values = {"position": rng.uniform(-100.0, 100.0), "velocity": rng.uniform(-1.0, 1.0) * velocity}
        names = {"move_absolute": ["position"], "move_velocity": ["velocity"], "halt": []}[group]
        saw.release().run(TICK).give(group, **{name: values[name] for name in names})
        duration = 10.0 ** rng.uniform(-2.0, 0.3)
        for row in samples(saw, duration, 40):
            assert abs(row["slave.velocity"]) <= velocity * (1 + 1e-9)
            assert abs(row["slave.acceleration"]) <= steepest * (1 + 1e-9)
            assert abs(row["slave.jerk"]) <= limits["jerk"] * (1 + 1e-9)
    saw.run(60.0)
    requested = {"move_absolute": (values["position"], 0.0, 0.0), "halt": (saw.slave[0], 0.0, 0.0)}
    assert saw.slave == requested.get(group, (saw.slave[0], values["velocity"], 0.0))
    assert saw.results(group) == {"in_velocity" if group == "move_velocity" else "done"}
