"""Random scripts of the FlyingSaw mirrored, in other units, and with other step sizes."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from tests.model.flying_saw.harness import GROUPS, OUTPUTS, VELOCITY_CHECKS, FlyingSawHarness
from tests.model.flying_saw.random_meetings import END, PEAKS, START, Order, repeatable, rngs, to_velocity
from tests.support.harness import MOTION, Row


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
    master_position: float
    speed: float
    legs: tuple[Leg, ...]
    length: float

    @property
    def stop_time(self) -> float:
        return sum(leg.duration for leg in self.legs)

    def play(
        self, retained: Iterable[float], cuts: Iterable[float] = (), mode: MasterInput = START
    ) -> dict[float, Row]:
        """All outputs at the kept times; steps end there, at the cuts, and at the legs' ends."""
        saw, retained, cuts = (
            FlyingSawHarness(self.start, master_position=self.master_position, speed=self.speed, mode=mode),
            set(retained),
            [*retained, *cuts],
        )
        rows: dict[float, Row] = {}
        for leg in self.legs:
            saw.set(leg.values)
            for group in leg.groups:
                saw.give(group)
            begin, end = saw.time, saw.time + leg.duration
            at, speed = saw.master_position, saw.speed
            inside = sorted({cut for cut in cuts if begin < cut < end} | {end})
            for cut in inside:
                passed = saw.time - begin
                saw.master_position = at + (speed + 0.5 * leg.acceleration * passed) * passed
                saw.speed = speed + leg.acceleration * passed
                saw.run(cut - saw.time, acceleration=leg.acceleration)
                saw.time = cut
                if cut in retained:
                    rows[cut] = saw.read()
            saw.master_position = at + (speed + 0.5 * leg.acceleration * leg.duration) * leg.duration
            saw.speed = speed + leg.acceleration * leg.duration
        return rows


def dyadic(rng: Random, low: float, high: float) -> float:
    return round(rng.uniform(low, high) * 256) / 256


BOTH_WAYS = ("check_max_velocity", *PEAKS, *VELOCITY_CHECKS, "prefer_constant_velocity", "ignore_master_acceleration")
KINDS = ("position", "velocity", "time", "own", "reversal", "time reversal", "distance", "encoder")


def scripted(rng: Random, kind: str) -> Script:
    """A slave in motion, a command, and a master that changes its velocity; then the slave's own motion."""
    length = rng.choice([1.0, 30.0, 500.0])
    speed, master_position = rng.choice([1.0, -1.0]) * length * rng.uniform(0.5, 2.0), length * rng.uniform(-3.0, 3.0)
    limits = {"velocity": 20.0, "acceleration": 60.0, "deceleration": 40.0, "jerk": 900.0}
    start: dict[str, Any] = {f"axis.max_{name}": length * limit for name, limit in limits.items()}
    start["axis.initial_position"] = length * rng.uniform(-1.0, 1.0)
    start["axis.initial_velocity"] = length * rng.choice([0.0, rng.uniform(-0.5, 0.5)])
    start |= {f"sync_mode.{name}": rng.random() < 0.15 for name in BOTH_WAYS}
    start["sync_mode.time_based"] = kind in ("time", "time reversal")
    legs = [Leg(0.25)]
    if kind == "own":
        return Script(start, master_position, speed, (*legs, *own_motions(rng, length), Leg(1.5)), length)
    if rng.random() < 0.3:  # the slave is accelerated when the command comes
        motion = {"velocity": rng.uniform(-1.0, 1.0), "acceleration": 3.0, "jerk": 30.0}
        values = {f"move_velocity.{name}": length * value for name, value in motion.items()}
        legs.append(Leg(dyadic(rng, 0.02, 0.2), 0.0, values, ("move_velocity",)))
    first = master_position + speed * sum(leg.duration for leg in legs)
    second = start["axis.initial_position"] + 0.25 * start["axis.initial_velocity"]
    if kind in ("velocity", "time", "time reversal"):
        command = to_velocity(rng, length, speed)
    else:
        command = to_position(rng, first, second, speed, kind == "distance")
    gain = 0.0
    if kind == "encoder":
        gain = speed * rng.uniform(-0.5, 0.5)
        cycle = rng.choice([0.001, 0.01])
        counts = 0.5 * abs(gain) * cycle**2 * rng.choice([0.5, 2.0])
        start |= {"master.sample_time": cycle, "master.encoder_scaling": counts}
    if kind == "time reversal":  # slow enough that the master turns before sync
        slow = {name: length * rng.uniform(0.3, 1.0) for name in ("acceleration", "deceleration")}
        command[0].update({f"gear_in_velo.{name}": limit for name, limit in slow.items()})
    legs.append(Leg(dyadic(rng, 0.05, 0.5), gain, *command))
    if kind in ("reversal", "time reversal"):
        start |= {f"sync_mode.{name}": rng.random() < 0.5 for name in ("rollback_lock", "instant_stop_on_rollback")}
        legs += reversal(rng, length, speed, legs[-1].duration)
    else:
        for _ in range(rng.randint(1, 4)):
            legs.append(Leg(dyadic(rng, 0.1, 0.6), speed * rng.choice([0.0, rng.uniform(-0.5, 1.0)])))
        legs.append(Leg(1.0))
    last = rng.choice(["gear_out", "halt", "stop", "move_absolute"])
    legs.append(Leg(0.25, length * rng.uniform(-0.3, 0.3), {"move_absolute.position": 0.0}, (last,)))
    return Script(start, master_position, speed, (*legs, Leg(0.75)), length)


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


POWERS = {"position": 0, "distance": 0, "scaling": 0, "velocity": 1, "acceleration": 2, "deceleration": 2, "jerk": 3}


def converted(script: Script, lengths: float, times: float) -> Script:
    """The same in other units; negative lengths: mirrored."""

    def scaled(name: str, value: Any) -> Any:
        kind = name.replace(".", "_").rsplit("_", 1)[-1]
        if name == "master.sample_time":
            return value * times
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
    return Script(
        start, script.master_position * lengths, script.speed * lengths / times, legs, script.length * abs(lengths)
    )


def exact_times(rng: Random, script: Script, number: int) -> list[float]:
    return sorted({round(rng.uniform(0.0, script.stop_time) * 65536 + 0.5) / 65536 for _ in range(number)})


@repeatable
@given(rngs, st.sampled_from(KINDS), st.sampled_from([START, END]))
def test_mirrored_inputs_give_mirrored_outputs(rng: Random, kind: str, mode: MasterInput) -> None:
    script = scripted(rng, kind)
    times = exact_times(rng, script, 20)
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
    at = exact_times(rng, script, 20)
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
    at = exact_times(rng, script, 12)
    stop = script.stop_time
    begin = rng.uniform(0.0, max(stop - 0.5, 0.0))
    grids = [
        [],
        [i * 0.007 for i in range(int(stop / 0.007))],
        [rng.uniform(0.0, stop) for _ in range(60)],
        [begin + i * 0.001 for i in range(500)],
    ]
    requested, *runs = [script.play(at, cuts, mode) for cuts in grids]
    length = script.length
    speed = max([abs(row["slave.velocity"]) for row in requested.values()] + [abs(script.speed)])
    gain = max([abs(row["slave.acceleration"]) for row in requested.values()])
    gain = max([gain, *(abs(leg.acceleration) for leg in script.legs)]) + speed**2 / length
    steep = max(
        [abs(row["slave.jerk"]) for row in requested.values()] + [speed**3 / length**2 + 3 * speed * gain / length]
    )
    sizes = dict(zip(MOTION, (length + 1e-4 * abs(script.master_position), speed, gain, steep), strict=True))
    for run in runs:
        for time, row in requested.items():
            for name in OUTPUTS:
                value, other = row[name], run[time][name]
                if name in sizes:
                    assert other == pytest.approx(value, abs=1e-9 * sizes[name]), (name, time)
                elif not isinstance(value, float):
                    assert other == value, (name, time)
