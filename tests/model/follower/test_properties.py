"""The Follower on random machines and masters: exact meetings, continuity, step sizes, limits, no NaN."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from motionsync.follower.faults import DropReason, Fault
from motionsync.follower.interface import State
from motionsync.master import MasterInput
from tests.model.follower.harness import FollowerHarness
from tests.support.harness import MOTION

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
TICK = 2.0**-20  # s

settings.register_profile("follower", derandomize=True, deadline=None, max_examples=50)
repeatable = settings.get_profile("follower")
rngs = st.integers(0, 2**32 - 1).map(Random)


@dataclass(frozen=True)
class Machine:
    """`cyclic`: "" for a linear slave, "stops" or "passes" at its park for a cyclic one; lengths of the slave in S."""

    cyclic: str
    ratio: float
    park: float
    to_sync: float
    to_out: float
    stop: float
    spare: float  # of the cycle, over what is needed at least
    wait: float  # share of the remaining travel
    sync_master: float

    @property
    def least(self) -> float:
        if self.cyclic:
            return self.to_out / self.ratio
        return (2.0 * self.to_sync + self.to_out + 2.0 * self.stop) / self.ratio

    @property
    def cycle(self) -> float:
        return self.least * (1.0 + self.spare)

    @property
    def sync(self) -> float:
        return self.park + self.to_sync

    @property
    def out(self) -> float:
        return self.sync + self.to_out

    @property
    def length(self) -> float:
        """The greatest length of a manoeuvre; its travels are about as long in master units times the ratio."""
        return self.to_sync + self.to_out + self.stop + abs(self.park) + self.cycle * self.ratio

    @property
    def values(self) -> dict[str, Any]:
        return {
            "master_cycle": self.cycle,
            "sync_master": self.sync_master * self.cycle,
            "slave_cycle": self.to_sync + self.to_out + self.stop if self.cyclic else 0.0,
            "park_slave": self.park,
            "slave.initial_position": self.park,
            "sync_slave": self.sync,
            "sync_out": self.out,
            "space_stop_slave": self.stop,
            "space_wait_in_park": self.wait * (self.cycle - self.least),
            "k_slave_master": self.ratio,
            "stop_in_park": self.cyclic != "passes",
        }

    def follower(self, *, master_position: float = 0.0, mode: MasterInput = START, **more: Any) -> FollowerHarness:
        """Positioned to its park, the master standing."""
        values = self.values | {name.replace("__", "."): value for name, value in more.items()}
        follower = (
            FollowerHarness(values, master_position=master_position, mode=mode).give("position_to_park").run(TICK)
        )
        assert follower["state_code"] in (3, 4, 5)  # it waits, or the approach starts just here
        return follower

    def wrapped(self, position: float) -> float:
        turn = self.values["slave_cycle"]
        return position % turn if turn else position

    def apart(self, a: float, b: float) -> float:
        """How far two positions are from each other, of a cyclic slave around the shorter side."""
        turn = self.values["slave_cycle"]
        return abs(math.remainder(a - b, turn)) if turn else abs(a - b)


@st.composite
def machines(draw: st.DrawFn, kinds: tuple[str, ...] = ("", "stops", "passes")) -> Machine:
    length = draw(st.sampled_from((1.0, 100.0, 1e-3, 1e5)))
    part = st.floats(0.1, 3.0)
    cyclic = draw(st.sampled_from(kinds))
    return Machine(
        cyclic=cyclic,
        ratio=draw(st.sampled_from((1.0, 0.25)) | st.floats(0.05, 20.0)),
        park=length * draw(st.sampled_from((0.0, -2.0)) | st.floats(-3.0, 3.0)),
        to_sync=length * draw(part),
        to_out=length * draw(part),
        stop=length * draw(part),
        spare=draw(st.floats(0.1, 3.0)) * (3.0 if cyclic else 1.0),
        wait=draw(st.sampled_from((0.0, 0.2, 0.5))),
        sync_master=draw(st.floats(0.0, 1.0)),
    )


def drive(follower: FollowerHarness, cycle: float, rng: Random, count: int) -> list[tuple[float, float]]:
    """What a master does that only goes forwards: durations and accelerations, each of one run."""
    speed = follower.speed
    segments = []
    for _ in range(count):
        target = cycle * rng.choice((0.0, 0.5, 1.0, rng.uniform(0.0, 2.0)))
        duration = 10.0 ** rng.uniform(-2.0, -0.3)
        segments.append((duration, (target - speed) / duration))
        speed += segments[-1][1] * duration
        if speed < 1e-9 * cycle:
            speed = 0.0
    return segments


def follow(
    follower: FollowerHarness, duration: float, acceleration: float, cycle: float, cuts: list[float]
) -> FollowerHarness:
    follower.run(duration, acceleration=acceleration, cuts=cuts)
    if follower.speed < 1e-9 * cycle:
        follower.speed = 0.0
    return follower


@repeatable
@given(machines(), rngs, st.sampled_from([START, END]), st.sampled_from([0.0, 1.0, 3.0]))
def test_whatever_the_master_does_the_slave_is_on_its_line_or_at_its_park(
    machine: Machine, rng: Random, mode: MasterInput, turns: float
) -> None:
    """Between sync_slave and sync_out on the line, to 1e-9; while it waits, exactly at the park."""
    follower = machine.follower(mode=mode, master__period=turns * machine.cycle)
    cycle = machine.cycle
    first = follower.block.sequence.current.meeting
    synchronized = machine.to_out / machine.ratio
    for duration, acceleration in drive(follower, cycle, rng, 40):
        follow(follower, duration, acceleration, cycle, [rng.random() * duration])
        number = math.floor((follower.master_position - first) / cycle)
        travel = follower.master_position - first - number * cycle
        near_border = min(abs(travel), abs(travel - synchronized), abs(cycle - travel)) < 1e-9 * cycle
        if number >= 0 and travel <= synchronized and not near_border:
            assert follower.state == State.M_SYNCHRONIZED
            assert follower["cycle"] == number
            assert machine.apart(follower.position, machine.sync + machine.ratio * travel) <= 1e-9 * machine.length
            assert follower.slave[1] == pytest.approx(
                machine.ratio * follower.speed, rel=1e-9, abs=1e-9 * machine.length
            )
        elif not near_border:
            assert follower.state != State.M_SYNCHRONIZED
        if follower.state == State.M_WAITING:
            assert machine.apart(follower.position, machine.park) <= 1e-12 * machine.length
            assert follower.slave[1:] == (0.0, 0.0)
        if follower.speed == 0.0:
            assert abs(follower.slave[1]) <= 1e-12 * machine.length
    assert follower.fault == Fault.NONE


@repeatable
@given(machines(), rngs)
def test_the_position_is_a_function_of_the_masters(machine: Machine, rng: Random) -> None:
    """Whatever its velocity is: the same position at another speed, and after a rest."""
    master_positions = sorted(rng.uniform(0.0, 4.0) * machine.cycle for _ in range(30))
    slow, fast = machine.follower(), machine.follower()
    for master_position in master_positions:
        slow.speed, fast.speed = 0.1 * machine.cycle, machine.cycle * rng.uniform(0.2, 5.0)
        slow.to(master_position)
        fast.to(master_position)
        assert machine.apart(slow.position, fast.position) <= 1e-9 * machine.length
        scale = 1e-8 * machine.length / machine.cycle * (1.0 + abs(slow.slave[1]) / machine.length * machine.cycle)
        assert slow.slave[1] / slow.speed == pytest.approx(fast.slave[1] / fast.speed, rel=1e-8, abs=scale)
        fast.speed = 0.0
        before = fast.run(TICK).slave
        assert before[1] == 0.0
        assert fast.run(rng.uniform(0.1, 10.0)).slave == before


def jumps(machine: Machine, rows: list[tuple[float, dict[str, float]]]) -> tuple[float, float]:
    """The greatest change of position and of velocity from one row to the next that the accelerations in between do not
    explain; rows are a time apart in which an acceleration hardly changes, unless it jumps."""
    greatest = max(abs(row["slave.acceleration"]) for _, row in rows)
    position = velocity = 0.0
    for (t0, before), (t1, after) in pairwise(rows):
        h = t1 - t0
        mean = 0.5 * (before["slave.velocity"] + after["slave.velocity"])
        lacking = machine.apart(after["slave.position"], before["slave.position"] + mean * h)
        position = max(position, lacking - greatest * h * h)
        change = abs(after["slave.velocity"] - before["slave.velocity"])
        velocity = max(velocity, change - 1.5 * greatest * h)
    return position, velocity


@repeatable
@given(machines(), rngs, st.booleans())
def test_position_and_velocity_are_continuous_at_every_change_of_phase(
    machine: Machine, rng: Random, shortened: bool
) -> None:
    """Over two cycles in which commands come; steps are much finer where the state changes."""
    follower = machine.follower()
    follower.speed = machine.cycle
    rows = [(follower.time, follower.read(MOTION))]
    for i in range(400):
        if follower.state == State.M_SYNCHRONIZED and shortened and rng.random() < 0.1:
            follower.give("end_synchronism")
        if i % 60 == 0:
            follower.set({"stop_after_forward": rng.random() < 0.3, "skip_next_cycle": rng.random() < 0.2})
        before, state, stage = follower.save(), follower.state, follower.block.sequence.current.stage
        follower.run(0.005)
        if (follower.state, follower.block.sequence.current.stage) != (state, stage):
            after, early, late = follower.save(), 0.0, 0.005  # bisect the instant of the change
            for _ in range(30):
                middle = 0.5 * (early + late)
                if follower.restore(before).run(middle).block.sequence.current.stage == stage:
                    early = middle
                else:
                    late = middle
            rows += follower.restore(before).rows(0.005, cuts=[early, late]).items()
            follower.restore(after)
        else:
            rows.append((follower.time, follower.read(MOTION)))
    assert follower.fault == Fault.NONE
    position, velocity = jumps(machine, rows)
    assert position <= 1e-9 * machine.length
    assert velocity <= 1e-9 * machine.length


@repeatable
@given(machines(), rngs, st.sampled_from([START, END]), st.sampled_from([0.0, 1.0, 0.7]))
def test_two_runs_with_different_step_sizes_agree(
    machine: Machine, rng: Random, mode: MasterInput, turns: float
) -> None:
    """Relative to the lengths and the master's greatest velocity and acceleration."""
    start = {"mode": mode, "master__period": turns * machine.cycle, "slave__initial_position": machine.park + 0.3}
    followers = [FollowerHarness(machine.values, mode=mode), FollowerHarness(machine.values, mode=mode)]
    for follower in followers:
        follower.set(
            {"master.period": start["master__period"], "slave.initial_position": start["slave__initial_position"]}
        )
        limits = zip(("velocity", "acceleration", "jerk"), (1.0, 10.0, 100.0), strict=True)
        follower.set({f"positioning.{name}": size * machine.length for name, size in limits})
        follower.block.initialize()
        follower.give("position_to_park")
    coarse, fine = followers
    length, cycle = machine.length, machine.cycle
    speeds = accelerations = 0.0
    for duration, acceleration in drive(coarse, cycle, rng, 25):
        if rng.random() < 0.2:
            name = rng.choice(("skip_next_cycle", "stop_after_forward", "sync_assumed"))
            value = rng.random() < 0.3
            coarse.set({name: value})
            fine.set({name: value})
        if rng.random() < 0.1:
            coarse.give("end_synchronism")
            fine.give("end_synchronism")
        follow(coarse, duration, acceleration, cycle, [])
        follow(fine, duration, acceleration, cycle, [rng.random() * duration for _ in range(rng.randint(1, 12))])
        fine.master_position, fine.speed = coarse.master_position, coarse.speed
        speeds = max(speeds, coarse.speed * machine.ratio, length)
        accelerations = max(accelerations, abs(acceleration) * machine.ratio)
        v2 = speeds * speeds / min(machine.to_sync, machine.stop, machine.to_out, length)
        assert coarse.state == fine.state or _at_a_border(coarse)
        assert machine.apart(coarse.position, fine.position) <= 1e-9 * length
        assert abs(coarse.slave[1] - fine.slave[1]) <= 1e-8 * (speeds + v2 * duration)
        if not _at_a_border(coarse):
            assert abs(coarse.slave[2] - fine.slave[2]) <= 1e-7 * (accelerations + v2) * 10.0
    assert coarse["cycle"] == fine["cycle"] or _at_a_border(coarse)


def _at_a_border(follower: FollowerHarness) -> bool:
    """A phase has just begun or is about to end, but for rounding."""
    section = follower.block.sequence.current.cam_section
    master_position = follower.block.master.end
    return (
        min(abs(master_position - section.begin), abs(master_position - section.end)) < 1e-9 * follower["master_cycle"]
    )


@repeatable
@given(machines(kinds=("passes",)), rngs, st.booleans())
def test_a_late_meeting_is_joined_without_a_jump_and_met_exactly(machine: Machine, rng: Random, home: bool) -> None:
    assume(machine.spare > 1.0)
    values = {"variable_cycle": True, "recover_late_sync": True, "sync_master": 2.0 * machine.cycle}
    follower = machine.follower(**values)
    follower.speed = machine.cycle
    end = (2.0 + 1e-6) * machine.cycle + machine.to_out / machine.ratio  # just after the synchronized phase
    follower.to(end)
    travel = follower.block.sequence.current.cam_section.end - end
    follower.to(end + travel * rng.uniform(0.05, 0.95) if home else 3.0 * machine.cycle)
    assert follower.state == (State.M_HOMING if home else State.M_WAITING)
    before = follower.twin()
    meeting = (3.0 + rng.uniform(0.0, 0.5)) * machine.cycle
    if not home:
        meeting = follower.master_position + rng.uniform(0.1, 0.95) * follower.block.sequence.current.approach_travel
    follower.set({"sync_master": meeting})
    rows = [(0.0, before.read(MOTION)), (TICK, follower.run(TICK).read(MOTION))]
    assume(follower["local.drop_reason"] != DropReason.TOO_FAST)
    assert follower.state == State.M_FOLLOWING
    h = TICK
    change = abs(rows[1][1]["slave.velocity"] - rows[0][1]["slave.velocity"])
    curved = max(abs(row["slave.acceleration"]) for _, row in rows)
    assert change <= 2.0 * curved * h + 1e-3 * machine.length * h + 1e-9 * machine.length
    assert machine.apart(rows[1][1]["slave.position"], rows[0][1]["slave.position"]) <= 1e3 * machine.length * h
    if home:  # the acceleration joins too
        assert rows[1][1]["slave.acceleration"] == pytest.approx(
            rows[0][1]["slave.acceleration"],
            abs=1e-2 * machine.length / (meeting - follower.master_position) ** 2 * machine.cycle**2,
        )
    follower.to(meeting + 0.5 * machine.to_out / machine.ratio)
    assert machine.apart(follower.position, machine.sync + 0.5 * machine.to_out) <= 1e-9 * machine.length


@repeatable
@given(machines(), rngs, st.floats(0.3, 3.0), st.floats(0.3, 3.0))
def test_limits_hold_or_the_slave_is_in_alarm(machine: Machine, rng: Random, speed: float, force: float) -> None:
    """A limit is exceeded in the one step whose end shows it; the stop has the limit as its deceleration."""
    max_speed = speed * machine.ratio * machine.cycle
    max_acceleration = force * 10.0 * machine.ratio * machine.cycle
    follower = machine.follower(max_speed=max_speed, max_acceleration=max_acceleration)
    for duration, acceleration in drive(follower, machine.cycle, rng, 30):
        was = follower.state
        follow(follower, duration, acceleration, machine.cycle, [])
        if follower.state != State.M_IN_ALARM:
            assert abs(follower.slave[1]) <= max_speed * (1.0 + 1e-8)
            assert abs(follower.slave[2]) <= max_acceleration * (1.0 + 1e-8)
        elif was == State.M_IN_ALARM:
            assert abs(follower.slave[2]) in (0.0, max_acceleration)
            assert Fault.SPEED_FOLLOWING <= follower.fault <= Fault.ACCELERATION_HOMING


@repeatable
@given(machines(), rngs, st.floats(-5.0, 5.0))
def test_a_positioning_keeps_its_limits_and_ends_exactly(machine: Machine, rng: Random, distance: float) -> None:
    limits = {"velocity": machine.length * 2.0, "acceleration": machine.length * 20.0, "jerk": machine.length * 500.0}
    initial = {"slave.initial_position": machine.park + distance * machine.to_sync}
    master_position = machine.cycle * rng.uniform(-3.0, 3.0)
    follower = FollowerHarness(
        {**machine.values, **initial, **{f"positioning.{n}": x for n, x in limits.items()}},
        master_position=master_position,
    )
    follower.give(rng.choice(("position_to_park", "position_to_cycle")))
    for _ in range(100):
        follower.run(rng.uniform(0.0, 0.2) + TICK)
        assert follower.state != State.M_IN_ALARM
        for name, size in zip(MOTION[1:], limits.values(), strict=True):
            assert abs(follower[name]) <= size * (1.0 + 1e-9)
    assert follower.state not in (State.M_POSITIONING, State.M_IDLE)
    assert follower.slave[1:] == (0.0, 0.0)


@repeatable
@given(machines(), rngs, st.floats(0.01, 100.0))
def test_the_unit_of_the_slave_does_not_matter(machine: Machine, rng: Random, factor: float) -> None:
    """All of the slave's lengths, k and limits times a factor: its motion too."""
    ways = {name: getattr(machine, name) * factor for name in ("ratio", "park", "to_sync", "to_out", "stop")}
    one, other = machine.follower(), replace(machine, **ways).follower()
    assume(one["master_cycle"] == pytest.approx(other["master_cycle"], rel=1e-12))
    one.speed = other.speed = machine.cycle
    for _ in range(30):
        duration = rng.uniform(0.001, 0.3)
        one.run(duration)
        other.run(duration)
        assert factor * machine.apart(other.position / factor, one.position) <= 1e-9 * factor * machine.length
        assert other.slave[1] == pytest.approx(factor * one.slave[1], rel=1e-7, abs=1e-8 * factor * machine.length)
