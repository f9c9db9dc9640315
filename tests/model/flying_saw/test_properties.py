"""The FlyingSaw on random motions: exact meeting, continuity, kept checks, symmetries, step sizes, output rules."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from motionsync.flying_saw.characteristics import Characteristics
from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.master import MasterInput
from tests.model.flying_saw.harness import GROUPS, OUTPUTS, FlyingSawHarness
from tests.support.harness import MOTION, Row
from tests.support.numbers import numbers_in

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
TICK = 2.0**-20  # s
VELOCITY_CHECKS = ("check_overshoot_velocity", "check_undershoot_velocity")
PEAKS = ("check_max_acceleration", "check_max_deceleration", "check_max_jerk")

settings.register_profile("flying saw", derandomize=True, deadline=None, max_examples=100)
repeatable = settings.get_profile("flying saw")
rngs = st.integers(0, 2**32 - 1).map(Random)


def sign(x: float) -> float:
    return math.copysign(1.0, x)


# --- one synchronisation to a position --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Meeting:
    """gear_in_pos to a point `duration` ahead of the master at its `speed`, and `distance` ahead of the slave."""

    speed: float
    ratio: float
    duration: float
    place: float
    position: float
    velocity: float
    distance: float

    @property
    def master_sync(self) -> float:
        return self.place + self.speed * self.duration

    @property
    def slave_sync(self) -> float:
        return self.position + self.distance

    @property
    def length(self) -> float:
        """The manoeuvre's distances are of this size."""
        return max(abs(self.distance), abs(self.speed * self.duration), abs(self.velocity * self.duration))

    def saw(self, *modes: str, mode: MasterInput = START, **values: Any) -> FlyingSawHarness:
        initial = {"axis.initial_position": self.position, "axis.initial_velocity": self.velocity}
        limits = {"axis.max_velocity": 1e6, "axis.max_acceleration": 1e7, "axis.max_jerk": 1e8}
        return FlyingSawHarness(initial | limits | values, place=self.place, speed=self.speed, mode=mode).modes(*modes)

    def order(self, saw: FlyingSawHarness, **values: Any) -> FlyingSawHarness:
        aims = {"master_sync_position": self.master_sync, "slave_sync_position": self.slave_sync}
        return saw.order("gear_in_pos", **aims, ratio_numerator=self.ratio, **values)


@st.composite
def meetings(draw: st.DrawFn) -> Meeting:
    speed = draw(st.floats(10.0, 1000.0)) * draw(st.sampled_from([1.0, -1.0]))
    ratio = draw(st.floats(0.2, 3.0)) * draw(st.sampled_from([1.0, -1.0]))
    duration = draw(st.floats(0.1, 4.0))
    synchronous = ratio * speed
    return Meeting(
        speed=speed,
        ratio=ratio,
        duration=duration,
        place=draw(st.floats(-1e3, 1e3)),
        position=draw(st.floats(-1e3, 1e3)),
        velocity=synchronous * draw(st.sampled_from([0.0, 1.0]) | st.floats(-1.0, 2.0)),
        distance=synchronous * duration * draw(st.floats(0.05, 1.8)),
    )


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
    meeting.order(saw).run(TICK, acceleration=0.3 * meeting.speed / meeting.duration if moved else 0.0)
    assume(not saw["gear_in_pos.error"])
    direction = sign(meeting.speed)
    left = abs(meeting.master_sync - saw.place)
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
        left = abs(meeting.master_sync - saw.place)
    if abs(saw.speed) < 0.01 * abs(meeting.speed):
        duration = left / abs(meeting.speed)
        saw.run(duration, acceleration=direction * left / duration**2)
        left = abs(meeting.master_sync - saw.place)
    duration = left / abs(saw.speed)
    saw.run(duration, cuts=sorted(rng.random() * duration for _ in range(3)))
    scale = meeting.length + 1e-3 * (abs(saw.place) + abs(saw.slave[0]))
    on_line = meeting.slave_sync + meeting.ratio * (saw.place - meeting.master_sync)
    assert saw.slave[0] == pytest.approx(on_line, abs=1e-9 * scale)
    assert saw.slave[1] == pytest.approx(meeting.ratio * saw.speed, abs=1e-9 * scale * abs(saw.speed / meeting.speed))
    for _ in range(4):
        saw.run(0.1 * meeting.duration, acceleration=rng.gauss(0.0, 1.0) * meeting.speed / meeting.duration)
        on_line = meeting.slave_sync + meeting.ratio * (saw.place - meeting.master_sync)
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
        saw.order("move_velocity", velocity=meeting.velocity + rng.uniform(0.2, 1.0) * meeting.ratio * meeting.speed)
        saw.run(rng.uniform(0.01, 0.1) * meeting.duration, acceleration=acceleration)
    before = saw.run(h, acceleration=acceleration).read(MOTION)
    meeting.order(saw)
    begin = saw.twin().run(TICK * h, acceleration=acceleration)
    assume(not begin["gear_in_pos.error"])
    assert begin.slave[2] == pytest.approx(before["slave.acceleration"], abs=1e-6 * steep)
    before = begin.read(MOTION)
    saw.run(2.0 * h, acceleration=acceleration)
    assert_joined(saw, meeting, before, h)
    left = (meeting.master_sync - saw.place) / saw.speed
    before = saw.run(left - h).read(MOTION)
    assert saw.state == State.SYNCHRONIZING
    assert saw.run(2.0 * h).state == State.SYNCHRON
    assert_joined(saw, meeting, before, h)


# --- checks -----------------------------------------------------------------------------------------------------------


def samples(saw: FlyingSawHarness, duration: float, number: int = 60) -> list[Row]:
    rows = saw.rows(duration, cuts=[i / number * duration for i in range(1, number)])
    return list(rows.values())


CHECKS = (
    *("check_min_position", "check_max_position", "check_max_velocity", *PEAKS),
    *("check_overshoot_position", "check_undershoot_position", *VELOCITY_CHECKS),
    *("check_overshoot_velocity_zero", "check_undershoot_velocity_zero"),
)


def assert_within_characteristics(found: Characteristics, rows: list[Row], sizes: Mapping[str, float]) -> None:
    """No row exceeds the extremes of a quantity, but for 1e-9 of its size."""
    for name, size in sizes.items():
        values = [row[f"slave.{name}"] for row in rows]
        least, most = getattr(found, f"slave_{name}_min"), getattr(found, f"slave_{name}_max")
        assert min(values) >= least - 1e-9 * size
        assert max(values) <= most + 1e-9 * size


def assert_dynamics_kept(rows: list[Row], modes: Iterable[str], limits: Mapping[str, float]) -> None:
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
        saw.order("gear_in_velo", ratio_numerator=meeting.ratio, **limits)
    else:
        meeting.order(saw, **limits)
    saw.run(TICK)
    assume(not saw[f"{group}.error"])
    found = saw.block.characteristics
    t = (found.master_position_end - found.master_position_start) / meeting.speed
    assume(t > 3 * TICK)
    rows = [saw.read(MOTION), *samples(saw, t - 2 * TICK)]
    assert saw.state == State.SYNCHRONIZING
    sizes = {name: max(abs(row[f"slave.{name}"]) for row in rows) for name in ("velocity", "acceleration", "jerk")}
    sizes["position"] = found.slave_position_max - found.slave_position_min + 1e-3 * abs(meeting.position)
    assert_within_characteristics(found, rows, sizes)
    assert_dynamics_kept(rows, modes, limits)
    positions, velocities = ([row[f"slave.{name}"] for row in rows] for name in ("position", "velocity"))
    place, speed = 1e-8 * sizes["position"], 1e-8 * sizes["velocity"]
    start, end = sorted((meeting.position, found.slave_position_end))
    mirrored = [sign(vs) * v for v in velocities]
    first, last = sign(vs) * meeting.velocity, abs(vs)
    kept = {
        "check_min_position": min(positions) >= low - place,
        "check_max_position": max(positions) <= high + place,
        "check_max_velocity": max(abs(v) for v in velocities) <= limits["velocity"] + speed,
        "check_overshoot_position": max(positions) <= end + place,
        "check_undershoot_position": min(positions) >= start - place,
        "check_overshoot_velocity": max(mirrored) <= max(first, last) + speed,
        "check_undershoot_velocity": min(mirrored) >= min(first, last) - speed,
        "check_overshoot_velocity_zero": max(velocities) <= speed,
        "check_undershoot_velocity_zero": first < 0.0 or min(mirrored) >= -speed,
    }
    assert [name for name in modes if not kept.get(name, True)] == []


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
    saw.order("gear_in_pos", **aims, ratio_numerator=meeting.ratio, acceleration=limit, deceleration=limit)
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
    found = [by_acceleration]
    for lean in (4.0 * along, 2.0 * along):
        for limited in (jerk, -jerk):
            inside = lean * lean + 24.0 * change * limited
            if inside >= 0.0:
                roots = [(lean + side * math.sqrt(inside)) / (12.0 * change) for side in (1.0, -1.0)]
                found += [1.0 / x for x in roots if x > 0.0]

    def kept(t: float) -> bool:
        ends = abs(6.0 * change / t**2 - 4.0 * along / t), abs(6.0 * change / t**2 - 2.0 * along / t)
        return t >= by_acceleration * (1.0 - 1e-12) and max(ends) <= jerk * (1.0 + 1e-9)

    return min(t for t in found if kept(t))


@settings(repeatable, max_examples=300)
@given(rngs, st.booleans(), st.booleans())
def test_a_synchronisation_to_velocity_is_the_shortest_ramp(rng: Random, checked: bool, ignored: bool) -> None:
    """From an accelerated slave and to an accelerated master: the profile's own acceleration is a0 - v0 a_m / v_m."""
    speed, ratio = rng.uniform(50.0, 200.0) * rng.choice([1.0, -1.0]), rng.uniform(-2.0, 2.0)
    saw = FlyingSawHarness({"axis.initial_velocity": rng.gauss(0.0, 100.0), "axis.max_jerk": 2e4}, speed=speed)
    saw.order("move_velocity", velocity=rng.gauss(0.0, 150.0)).run(rng.uniform(0.0, 0.15))
    saw.modes(*["check_max_jerk"] * checked, *["ignore_slave_acceleration", "ignore_master_acceleration"] * ignored)
    _, velocity, a0 = saw.slave
    gain = rng.choice([0.0, rng.gauss(0.0, 100.0)])
    limits = {"acceleration": rng.uniform(300.0, 3000.0), "deceleration": rng.uniform(300.0, 3000.0)}
    limits["jerk"] = 10.0 ** rng.uniform(3.0, 6.0)
    saw.order("gear_in_velo", ratio_numerator=ratio, **limits).run(TICK, acceleration=gain)
    end = ratio * speed
    change = end - velocity
    along = 0.0 if ignored else (a0 - velocity * gain / speed) * sign(change)
    if velocity * end < 0.0:
        limit = min(limits["acceleration"], limits["deceleration"])
    else:
        limit = limits["acceleration" if abs(end) > abs(velocity) else "deceleration"]
    duration = shortest(abs(change), along, limit, limits["jerk"] if checked else 0.0)
    found = saw.block.characteristics
    assert (found.master_position_end - found.master_position_start) / speed == pytest.approx(duration, rel=1e-9)
    assert found.slave_acceleration_start * sign(change) == pytest.approx(along, rel=1e-9, abs=1e-9)
    most = max(abs(found.slave_acceleration_min), abs(found.slave_acceleration_max))
    assert most <= max(limit, abs(along)) * (1 + 1e-9)
    if not checked:
        assert most == pytest.approx(max(limit, abs(along)), rel=1e-9)
    u = saw.speed * TICK / (speed * duration)  # the master is here by constant acceleration: nearly at v_m
    assert saw.slave[1] == pytest.approx(velocity + along * sign(change) * u * duration, rel=1e-3, abs=0.1)


# --- scripts: symmetries and step sizes -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Leg:
    """The master's acceleration for a time, and what is set before; `groups` get an edge."""

    duration: float
    acceleration: float = 0.0
    values: Mapping[str, Any] = field(default_factory=dict)
    groups: tuple[str, ...] = ()


@dataclass(frozen=True)
class Script:
    start: Mapping[str, Any]
    place: float
    speed: float
    legs: tuple[Leg, ...]
    length: float

    @property
    def stop_time(self) -> float:
        return sum(leg.duration for leg in self.legs)

    def play(self, kept: Iterable[float], cuts: Iterable[float] = (), mode: MasterInput = START) -> dict[float, Row]:
        """All outputs at the kept times; steps end there, at the cuts, and at the legs' ends."""
        saw, kept, cuts = (
            FlyingSawHarness(self.start, place=self.place, speed=self.speed, mode=mode),
            set(kept),
            [*kept, *cuts],
        )
        rows: dict[float, Row] = {}
        for leg in self.legs:
            saw.put(leg.values)
            for group in leg.groups:
                saw.order(group)
            begin, end = saw.time, saw.time + leg.duration
            at, speed = saw.place, saw.speed
            inside = sorted({cut for cut in cuts if begin < cut < end} | {end})
            for cut in inside:
                passed = saw.time - begin
                saw.place = at + (speed + 0.5 * leg.acceleration * passed) * passed
                saw.speed = speed + leg.acceleration * passed
                saw.run(cut - saw.time, acceleration=leg.acceleration)
                saw.time = cut
                if cut in kept:
                    rows[cut] = saw.read()
            saw.place = at + (speed + 0.5 * leg.acceleration * leg.duration) * leg.duration
            saw.speed = speed + leg.acceleration * leg.duration
        return rows


def dyadic(rng: Random, low: float, high: float) -> float:
    return round(rng.uniform(low, high) * 256) / 256


BOTH_WAYS = ("check_max_velocity", *PEAKS, *VELOCITY_CHECKS, "prefer_constant_velocity", "ignore_master_acceleration")
KINDS = ("position", "velocity", "time", "own", "reversal", "distance")


def scripted(rng: Random, kind: str) -> Script:
    """A slave in motion, a command, and a master that changes its velocity; then the slave's own motion."""
    length = rng.choice([1.0, 30.0, 500.0])
    speed, place = rng.choice([1.0, -1.0]) * length * rng.uniform(0.5, 2.0), length * rng.uniform(-3.0, 3.0)
    limits = {"velocity": 20.0, "acceleration": 60.0, "deceleration": 40.0, "jerk": 900.0}
    start: dict[str, Any] = {f"axis.max_{name}": length * limit for name, limit in limits.items()}
    start["axis.initial_position"] = length * rng.uniform(-1.0, 1.0)
    start["axis.initial_velocity"] = length * rng.choice([0.0, rng.uniform(-0.5, 0.5)])
    start |= {f"sync_mode.{name}": rng.random() < 0.15 for name in BOTH_WAYS}
    start["sync_mode.time_based"] = kind == "time"
    legs = [Leg(0.25)]
    if kind == "own":
        return Script(start, place, speed, (*legs, *own_motions(rng, length), Leg(1.5)), length)
    if rng.random() < 0.3:  # the slave is accelerated when the command comes
        motion = {"velocity": rng.uniform(-1.0, 1.0), "acceleration": 3.0, "jerk": 30.0}
        values = {f"move_velocity.{name}": length * value for name, value in motion.items()}
        legs.append(Leg(dyadic(rng, 0.02, 0.2), 0.0, values, ("move_velocity",)))
    first = place + speed * sum(leg.duration for leg in legs)
    second = start["axis.initial_position"] + 0.25 * start["axis.initial_velocity"]
    if kind in ("velocity", "time"):
        command = to_velocity(rng, length, speed)
    else:
        command = to_position(rng, first, second, speed, kind == "distance")
    legs.append(Leg(dyadic(rng, 0.05, 0.5), 0.0, *command))
    if kind == "reversal":
        start |= {f"sync_mode.{name}": rng.random() < 0.5 for name in ("rollback_lock", "instant_stop_on_rollback")}
        legs += reversal(rng, length, speed, legs[-1].duration)
    else:
        for _ in range(rng.randint(1, 4)):
            legs.append(Leg(dyadic(rng, 0.1, 0.6), speed * rng.choice([0.0, rng.uniform(-0.5, 1.0)])))
        legs.append(Leg(1.0))
    last = rng.choice(["gear_out", "halt", "stop", "move_absolute"])
    legs.append(Leg(0.25, length * rng.uniform(-0.3, 0.3), {"move_absolute.position": 0.0}, (last,)))
    return Script(start, place, speed, (*legs, Leg(0.75)), length)


def own_motions(rng: Random, length: float) -> list[Leg]:
    legs = []
    for group in rng.sample(["move_absolute", "move_velocity", "halt", "stop"], rng.randint(1, 4)):
        values = {
            "move_absolute.position": length * rng.uniform(-4.0, 4.0),
            "move_absolute.velocity": length * rng.uniform(0.5, 6.0),
            "move_absolute.jerk": length * rng.uniform(30.0, 900.0),
            "move_velocity.velocity": length * rng.uniform(-4.0, 4.0),
        }
        legs.append(Leg(dyadic(rng, 0.02, 1.0), length * rng.gauss(0.0, 1.0), values, (group,)))
    return legs


Order = tuple[dict[str, Any], tuple[str, ...]]


def to_velocity(rng: Random, length: float, speed: float) -> Order:
    ratio = rng.choice([1.0, 0.5, rng.uniform(0.3, 2.0)])
    values = {
        "ratio_numerator": ratio,
        "acceleration": length * rng.uniform(2.0, 20.0),
        "deceleration": length * rng.uniform(2.0, 20.0),
        "jerk": length * rng.uniform(20.0, 200.0),
        "velocity": rng.choice([0.0, 0.0, abs(ratio * speed) * rng.uniform(1.0, 1.3)]),
    }
    return {f"gear_in_velo.{name}": value for name, value in values.items()}, ("gear_in_velo",)


def to_position(rng: Random, master: float, slave: float, speed: float, later: bool) -> Order:
    """From about there to a point 0.5 to 1.5 s ahead, `later`: with a start distance."""
    ratio, ahead = rng.choice([1.0, 0.5, rng.uniform(0.3, 2.0)]), speed * rng.uniform(0.5, 1.5)
    values = {
        "ratio_numerator": ratio,
        "master_sync_position": master + ahead,
        "slave_sync_position": slave + ratio * ahead * rng.uniform(0.4, 1.5),
        "master_start_distance": abs(ahead) * rng.uniform(0.2, 0.8) if later else 0.0,
    }
    return {f"gear_in_pos.{name}": value for name, value in values.items()}, ("gear_in_pos",)


def reversal(rng: Random, length: float, speed: float, gone: float) -> list[Leg]:
    """After some time on, the master turns, goes back beyond where it came from, turns again and comes by."""
    on, turning = dyadic(rng, 0.01, 2.0), dyadic(rng, 0.3, 0.8)
    gain = -speed / turning * rng.uniform(1.5, 2.0)
    distance, back = abs(speed) * (gone + on + 0.5), max(abs(speed + gain * turning), 0.1 * length)
    legs = [Leg(on), Leg(turning, gain), Leg(dyadic(rng, 0.1, 1.0) + math.ceil(4.0 * distance / back) / 4.0)]
    return [*legs, Leg(2.0 * turning, -gain * rng.uniform(0.5, 1.0)), Leg(4.0)]


POWERS = {"position": 0, "distance": 0, "velocity": 1, "acceleration": 2, "deceleration": 2, "jerk": 3}


def converted(script: Script, lengths: float, times: float) -> Script:
    """The same in other units; negative lengths: mirrored."""

    def scaled(name: str, value: Any) -> Any:
        kind = name.replace(".", "_").rsplit("_", 1)[-1]
        if isinstance(value, bool) or kind not in POWERS:
            return value
        signed = kind == "position" or name in ("axis.initial_velocity", "move_velocity.velocity")
        return value * (lengths if signed else abs(lengths)) / times ** POWERS[kind]

    legs = tuple(
        Leg(
            leg.duration * times,
            leg.acceleration * lengths / times**2,
            {name: scaled(name, value) for name, value in leg.values.items()},
            leg.groups,
        )
        for leg in script.legs
    )
    start = {name: scaled(name, value) for name, value in script.start.items()}
    return Script(start, script.place * lengths, script.speed * lengths / times, legs, script.length * abs(lengths))


def kept_times(rng: Random, script: Script, number: int) -> list[float]:
    return sorted({round(rng.uniform(0.0, script.stop_time) * 65536 + 0.5) / 65536 for _ in range(number)})


@repeatable
@given(rngs, st.sampled_from(KINDS), st.sampled_from([START, END]))
def test_mirrored_inputs_give_mirrored_outputs(rng: Random, kind: str, mode: MasterInput) -> None:
    script = scripted(rng, kind)
    times = kept_times(rng, script, 20)
    ours, theirs = (each.play(times, mode=mode) for each in (script, converted(script, -1.0, 1.0)))
    for time, row in ours.items():
        other = theirs[time]
        for power, name in enumerate(MOTION):
            size = script.length + abs(row["slave.position"]) if power == 0 else abs(row[name])
            assert row[name] == pytest.approx(-other[name], abs=1e-9 * max(size, script.length)), (name, time)
        for name in ("state", "plcopen_state", "in_sync", "error", "characteristics.profile"):
            assert row[name] == other[name], (name, time)
        for group in GROUPS:
            assert row[f"{group}.error"] == other[f"{group}.error"]
        for name in ("position", "velocity", "acceleration", "jerk"):
            low, high = f"characteristics.slave_{name}_min", f"characteristics.slave_{name}_max"
            size = max(abs(row[low]), abs(row[high]), script.length)
            assert (row[low], row[high]) == pytest.approx((-other[high], -other[low]), abs=1e-9 * size)
        for name in ("slave_velocity_mean", "slave_acceleration_effective"):
            assert row[f"characteristics.{name}"] == pytest.approx(other[f"characteristics.{name}"], rel=1e-9)


@repeatable
@given(
    rngs,
    st.sampled_from(KINDS),
    st.sampled_from([START, END]),
    st.sampled_from([2.0**-10, 0.25, 4.0]),
    st.sampled_from([2.0**-6, 0.5, 8.0, 32.0]),
)
def test_in_other_units_all_is_the_same(
    rng: Random, kind: str, mode: MasterInput, lengths: float, times: float
) -> None:
    """Of powers of two, so that nothing rounds differently."""
    script = scripted(rng, kind)
    at = kept_times(rng, script, 20)
    ours = script.play(at, mode=mode)
    theirs = converted(script, lengths, times).play([time * times for time in at], mode=mode)
    for time, row in ours.items():
        other = theirs[time * times]
        for power, name in enumerate(MOTION):
            assert row[name] * lengths / times**power == other[name], (name, time)
        for name in OUTPUTS:
            if not isinstance(row[name], float):
                assert row[name] == other[name], (name, time)


@settings(repeatable, max_examples=24)
@pytest.mark.parametrize("mode", [START, END])
@pytest.mark.parametrize("kind", KINDS)
@given(rng=rngs)
def test_the_step_size_changes_nothing(rng: Random, kind: str, mode: MasterInput) -> None:
    """Steps of 7 ms, of any size, and of 1 ms in half a second agree with few large ones."""
    script = scripted(rng, kind)
    at = kept_times(rng, script, 12)
    stop = script.stop_time
    begin = rng.uniform(0.0, max(stop - 0.5, 0.0))
    grids = [
        [],
        [i * 0.007 for i in range(int(stop / 0.007))],
        [rng.uniform(0.0, stop) for _ in range(60)],
        [begin + i * 0.001 for i in range(500)],
    ]
    wanted, *runs = [script.play(at, cuts, mode) for cuts in grids]
    length = script.length
    speed = max([abs(row["slave.velocity"]) for row in wanted.values()] + [abs(script.speed)])
    gain = max([abs(row["slave.acceleration"]) for row in wanted.values()])
    gain = max([gain, *(abs(leg.acceleration) for leg in script.legs)]) + speed**2 / length
    steep = max(
        [abs(row["slave.jerk"]) for row in wanted.values()] + [speed**3 / length**2 + 3 * speed * gain / length]
    )
    sizes = dict(zip(MOTION, (length + 1e-4 * abs(script.place), speed, gain, steep), strict=True))
    for run in runs:
        for time, row in wanted.items():
            for name in OUTPUTS:
                value, other = row[name], run[time][name]
                if name in sizes:
                    assert other == pytest.approx(value, abs=1e-9 * sizes[name]), (name, time)
                elif not isinstance(value, float):
                    assert other == value, (name, time)


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
    saw.order("gear_in_velo", ratio_numerator=ratio, **limits)
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
        offset = saw.slave[0] - ratio * saw.place
        assert saw.slave[1:] == pytest.approx((ratio * saw.speed, 0.0), rel=1e-12)
        saw.run(0.3, acceleration=1e4).run(0.3, acceleration=-3e4)
        assert saw.slave[0] - ratio * saw.place == pytest.approx(offset, abs=1e-9 * (1 + abs(saw.place)))
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
        saw.release().run(TICK).order(group, **{name: values[name] for name in names})
        duration = 10.0 ** rng.uniform(-2.0, 0.3)
        for row in samples(saw, duration, 40):
            assert abs(row["slave.velocity"]) <= velocity * (1 + 1e-9)
            assert abs(row["slave.acceleration"]) <= steepest * (1 + 1e-9)
            assert abs(row["slave.jerk"]) <= limits["jerk"] * (1 + 1e-9)
    saw.run(60.0)
    wanted = {"move_absolute": (values["position"], 0.0, 0.0), "halt": (saw.slave[0], 0.0, 0.0)}
    assert saw.slave == wanted.get(group, (saw.slave[0], values["velocity"], 0.0))
    assert saw.results(group) == {"in_velocity" if group == "move_velocity" else "done"}


# --- random commands --------------------------------------------------------------------------------------------------


RESULT = {"gear_in_velo": "in_sync", "gear_in_pos": "in_sync", "move_velocity": "in_velocity"}
MODES = [name.removeprefix("sync_mode.") for name in FlyingSawHarness().stepper.cells if name.startswith("sync_mode.")]


def commanded(saw: FlyingSawHarness, rng: Random, group: str) -> dict[str, Any]:
    """Mostly feasible values for a command given now; lengths are of the size of 100."""
    values: dict[str, Any] = {}
    if group.startswith("gear_in"):
        values = {"ratio_numerator": rng.choice([1.0, 0.5, -1.0, 0.0]), "acceleration": rng.choice([0.0, 500.0, -1.0])}
    if group == "gear_in_pos":
        ahead = saw.speed * rng.uniform(0.2, 1.0)
        values["master_sync_position"] = saw.place + ahead
        values["slave_sync_position"] = saw.slave[0] + values["ratio_numerator"] * ahead * rng.uniform(0.1, 1.2)
        values["master_start_distance"] = abs(ahead) * rng.choice([0.0, 0.0, 0.5])
    if group == "move_velocity":
        values["velocity"] = rng.choice([0.0, rng.gauss(0.0, 100.0), 3e3])
    if group == "move_absolute":
        values["position"] = rng.choice([rng.gauss(0.0, 100.0), rng.gauss(0.0, 100.0), 2e9])
    return values


def random_step(saw: FlyingSawHarness, rng: Random, groups: Iterable[str] = GROUPS) -> None:
    """Perhaps falling edges, perhaps commands, then a step of a wandering master."""
    for group in sorted(saw.held):
        if rng.random() < 0.3:
            saw.release(group)
    free = [group for group in groups if group not in saw.held]
    if rng.random() < 0.35 and free:
        saw.modes(*(name for name in MODES if rng.random() < 0.12))
        for group in rng.sample(free, min(len(free), rng.choice([1, 1, 1, 2]))):
            if group != "stop" or rng.random() < 0.3:
                saw.order(group, **commanded(saw, rng, group))
    if rng.random() < 0.1:
        saw.speed = rng.choice([0.0, -saw.speed, rng.gauss(0.0, 100.0)])
    saw.run(10.0 ** rng.uniform(-3.0, -0.2), acceleration=rng.choice([0.0, 0.0, rng.gauss(0.0, 200.0)]))


MACHINE = {"axis.max_acceleration": 2000.0, "axis.max_deceleration": 1500.0, "axis.max_jerk": 20000.0}


@settings(repeatable, max_examples=150)
@given(rngs, st.sampled_from([START, END, MasterInput.POSITION_ONLY]), st.sampled_from([0.0, 0.0, 70.0]))
def test_plcopen_s_rules_hold_and_nothing_is_ever_nan(rng: Random, mode: MasterInput, period: float) -> None:
    saw = FlyingSawHarness({**MACHINE, "master.period": period}, speed=rng.choice([100.0, -40.0, 0.0]), mode=mode)
    ordered: set[str] = set()  # groups that have had an edge since `execute` was false
    shown: dict[str, set[str]] = {group: set() for group in GROUPS}
    for _ in range(40):
        held = set(saw.held)
        random_step(saw, rng)
        ordered = (ordered | (saw.held - held)) & saw.held
        for group in GROUPS:
            now = saw.results(group)
            results = now & {RESULT.get(group, "done"), "command_aborted", "error"}
            assert ("busy" in now) == ("active" in now) or group in ("gear_out", "reset")
            assert len(results) + ("busy" in now) == 1 or group not in ordered
            assert len(results) + ("busy" in now) <= 1
            assert saw[f"{group}.error"] == (saw[f"{group}.error_id"] != 0)
            if group not in saw.held:
                assert not results & shown[group], "a result is shown again after the falling edge"
            shown[group] = results
        assert sum("busy" in saw.results(group) for group in GROUPS) <= 1
        for group in ("gear_in_velo", "gear_in_pos"):
            assert "in_sync" not in saw.results(group) or saw.state == State.SYNCHRON
        assert saw["error"] == (saw["error_id"] != 0)
        assert saw["in_sync"] == (saw.state == State.SYNCHRON)
        assert saw["state_code"] == int(saw.state)
        assert saw["coupled"] == (saw.state in (State.PREPHASE, State.SYNCHRONIZING, State.SYNCHRON))
        assert saw["coupled"] == (saw["plcopen_state"] == PlcopenState.SYNCHRONIZED_MOTION)
        _, v, a = saw.slave
        if not saw["coupled"]:
            moves = State.CONSTANT_VELOCITY if a == 0.0 else State.DECELERATING if v * a < 0.0 else State.ACCELERATING
            assert saw.state == (State.INACTIVE if v == a == 0.0 else moves)
        assert all(math.isfinite(x) for x in numbers_in(saw.block))
        assert 0.0 <= saw["local.progress"] <= 1.0


WRONG: dict[str, dict[str, Any]] = {
    "gear_in_pos": {"ratio_numerator": 0.0},
    "move_absolute": {"position": 3e9},
    "halt": {"deceleration": -1.0},
}


@settings(repeatable, max_examples=60)
@given(rngs)
def test_refused_commands_leave_everything_else_as_it_is_to_the_last_bit(rng: Random) -> None:
    """A run with commands, and the same with refused ones of other groups among them."""
    good = ("gear_in_velo", "gear_out", "move_velocity", "reset")
    saw = FlyingSawHarness(MACHINE, speed=rng.choice([100.0, -40.0, 0.0]))
    twin, seed = saw.twin(), rng.randint(0, 2**32)
    ours, theirs = Random(seed), Random(seed)
    for _ in range(40):
        for group, values in WRONG.items():
            if group in saw.held:
                saw.release(group)
            elif rng.random() < 0.3:
                saw.order(group, **values)
        held = {group for group in saw.held if group in WRONG}
        saw.held -= held
        random_step(saw, ours, good)
        random_step(twin, theirs, good)
        for name in OUTPUTS:
            if not name.startswith((*(f"{group}." for group in WRONG), "error", "local.plan_")):
                assert repr(saw[name]) == repr(twin[name]), name
        for group in WRONG:
            assert saw.results(group) == ({"error"} if group in saw.held else set())
