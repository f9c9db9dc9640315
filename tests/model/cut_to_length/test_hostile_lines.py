"""The CutToLength on lines that no axis could follow: a coarse encoder, spikes of an input, jumps of the master.

In contact the carriage follows its line exactly, whatever that does. Any motion of its own starts from what the axis
could have had, so that it never goes beyond an end of the stroke by more than a stop from the greatest velocity takes:
v/2 (v/a + a/j) with the limits of the machine."""

from contextlib import suppress
from math import floor
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.master import MasterInput
from motionsync.motion.exceeded_limit import Limit
from motionsync_fmu.interface.stepper import RefusedError
from tests.model.cut_to_length.harness import CutToLengthHarness, near, started_machine
from tests.model.cut_to_length.scripted_runs import differences
from tests.support.blocks.drawn import drawn

LINE = 503.7
MACHINE: dict[str, Any] = {
    "axis.min_position": -50.0,
    "axis.max_position": 1000.0,
    "axis.max_velocity": 2000.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 10000.0,
    "axis.max_jerk": 100000.0,
    "length": 1000.0,
}
STOP = 1000.0 * (2000.0 / 10000.0 + 10000.0 / 100000.0)  # u: from 2000 u/s with 10000 u/s2 and 100000 u/s3
LOWEST, HIGHEST = -50.0 - STOP, 1000.0 + STOP


class HostileLine(CutToLengthHarness):
    """Notes the extremes of the setpoint, and what is reported of exceeded limits."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.lowest = self.highest = 0.0
        self.exceeded: set[Limit] = set()
        super().__init__(*arguments, **options)

    def after_step(self) -> None:
        super().after_step()
        self.lowest = min(self.lowest, self.block.slave.position)
        self.highest = max(self.highest, self.block.slave.position)
        if self["warning.limit_exceeded"]:
            self.exceeded.add(Limit(self["local.exceeded_limit"]))

    def input(self, step: float, position: float, velocity: float = 0.0, acceleration: float = 0.0) -> None:
        """One step with the master's inputs as given."""
        master = self.block.master
        master.position, master.velocity, master.acceleration = position, velocity, acceleration
        self.stepper.step(step)
        self.time += step
        self.after_step()


@pytest.mark.parametrize("resolution", [0.05, 0.1])
def test_a_coarse_encoder_does_not_let_the_carriage_run_away(resolution: float) -> None:
    """Differences of floored positions at 1 ms give accelerations of 50000 and 100000 u/s2."""
    saw = HostileLine(MACHINE, mode=MasterInput.POSITION_ONLY).give("start")
    for i in range(4500):
        saw.input(0.001, floor(LINE * 0.001 * i / resolution) * resolution)
    assert saw.lowest >= -50.0
    assert saw.highest <= 1000.0
    assert saw["statistics.cuts"] == 2
    assert Limit.MAX_ACCELERATION in saw.exceeded


@pytest.mark.parametrize("spike", [5e4, -5e4])
def test_a_spike_of_the_acceleration_does_not_carry_the_carriage_away(spike: float) -> None:
    """One step of 1 ms of the line's acceleration, at 130 instants of a cycle. What is reported is not lost."""
    saw = HostileLine({**MACHINE, "tool.cut_time": 0.1}, speed=LINE).give("start").at(1.88)
    states = set()
    for i in range(130):
        saw.run(0.005)
        saved = saw.save()
        states.add(saw.state)
        saw.lowest, saw.highest = 0.0, 0.0
        saw.exceeded.clear()
        saw.input(0.001, saw.master_position, LINE, spike)
        assert saw.exceeded or saw.state in (State.WAITING, State.APPROACHING, State.RETURNING)
        saw.master_position += 0.001 * LINE
        for _ in range(60):
            saw.run(0.01)
        assert saw.lowest >= -20.0, i
        assert saw.highest <= 250.0, i  # 135 without a spike
        saw.restore(saved)
    assert states >= {State.WAITING, State.APPROACHING, State.CUTTING, State.RETURNING}


@drawn(60, shrink=False)
@given(st.integers(0, 2**32 - 1).map(Random), st.sampled_from(list(MasterInput)))
def test_no_setpoint_is_beyond_the_stroke_by_more_than_one_stop(rng: Random, mode: MasterInput) -> None:
    """Whatever the line's inputs: noise, spikes and jumps of each of them, in any state."""
    values = {**MACHINE, "tool.mode": rng.choice(list(ToolMode)), "tool.cut_time": rng.choice((0.05, 0.6))}
    values |= {"home_position": rng.choice((0.0, -50.0)), "tool.retract_time": rng.choice((0.0, 0.05))}
    values |= {"tool.on_delay": rng.choice((0.0, 0.2)), "homing.ease": rng.random() < 0.3, "length": 800.0}
    values |= {"gap.distance": rng.choice((0.0, 10.0))}
    saw = HostileLine(values, speed=LINE, mode=mode).give("start")
    position = 0.0
    for _ in range(400):
        step = rng.choice((0.001, 0.01, 0.01))
        position += LINE * step
        velocity, acceleration = LINE, 0.0
        if rng.random() < 0.05:
            saw.give(rng.choice(("start", "abort", "stop", "cut_now", "reset", "tool.done")))
        if rng.random() < 0.08:
            velocity *= rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(-1.0, 5.0)
        if rng.random() < 0.08:
            acceleration = rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(2.0, 9.0)
        if rng.random() < 0.03:
            position += rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(-3.0, 3.7)
        with suppress(RefusedError):  # too much travel in one step
            saw.input(step, position, velocity, acceleration)
        assert saw.lowest >= LOWEST
        assert saw.highest <= HIGHEST


# --- the carriage leaves such a line ----------------------------------------------------------------------------------

# The round machine: in sync from 1.6 s on with s = 1000 (t - 1.5), 10000 u/s2, 200000 u/s3, stroke -250 to 650.
IN_SYNC: dict[str, Any] = {"tool.settle_time": 0.2, "homing.velocity": 1500.0}


def aborted_in_a_spike(spike: float, **values: float) -> CutToLengthHarness:
    """At 1.7 s, s = 200, the line has this acceleration in the step in which abort is given; then 0.05 s pass."""
    machine = started_machine({**IN_SYNC, **{f"axis.{name}": value for name, value in values.items()}}).at(1.7)
    machine.give("abort").run(0.05, acceleration=spike)
    return machine


@pytest.mark.parametrize(
    ("spike", "values", "begins", "limit"),
    [
        (9000.0, {}, 9000.0, Limit.NONE),
        (50000.0, {}, 10000.0, Limit.MAX_ACCELERATION),
        (50000.0, {"max_deceleration": 8000.0}, 10000.0, Limit.MAX_ACCELERATION),
        (-50000.0, {}, -10000.0, Limit.MAX_DECELERATION),
        (-50000.0, {"max_deceleration": 8000.0}, -8000.0, Limit.MAX_DECELERATION),
        (-50000.0, {"max_deceleration": 0.0, "max_acceleration": 9000.0}, -9000.0, Limit.MAX_DECELERATION),
    ],
)
def test_the_way_home_begins_with_what_the_axis_can_have(
    spike: float, values: dict[str, float], begins: float, limit: Limit
) -> None:
    """200000 u/s3 down to the limit towards home, for the time t: v = 1000 + a t - 100000 t^2, ..."""
    machine = aborted_in_a_spike(spike, **values)
    lowest = -min(values.get("max_deceleration") or 1e9, values.get("max_acceleration", 10000.0))
    t = min(0.05, (begins - lowest) / 200000.0)
    rest = 0.05 - t
    velocity = 1000.0 + begins * t - 1e5 * t * t
    position = 200.0 + 1000.0 * t + 0.5 * begins * t * t - 1e5 / 3.0 * t * t * t
    acceleration = begins - 200000.0 * t
    expected = (position + velocity * rest + 0.5 * acceleration * rest * rest, velocity + acceleration * rest)
    assert machine.slave == near(*expected, acceleration, tolerance=1e-8)
    assert machine["local.exceeded_limit"] == limit
    assert machine["local.exceeded_value"] == (abs(spike) if limit != Limit.NONE else 0.0)
    machine.run(1.0)
    assert (machine.slave, machine["warning.limit_exceeded"]) == ((0.0, 0.0, 0.0), False)


def test_a_velocity_that_carries_beyond_the_stroke_is_that_of_the_axis() -> None:
    """At 1.7 s the line has 20000 u/s: from s = 200 a stop would take 20000^2 / 20000 u. From 1500 it takes
    750 R(1500) = 150 u; the move home turns after 0.05 s of jerk and (1500 - 250) / 10000 s."""
    machine = started_machine(IN_SYNC).at(1.7)
    machine.speed = 20000.0
    machine.run(0.05)
    assert machine["error_id"] == Fault.STROKE
    assert machine.slave == near(200.0 + 75.0 - 200000.0 * 0.05**3 / 6.0, 1250.0, -10000.0, tolerance=1e-8)
    assert (machine["local.exceeded_limit"], machine["local.exceeded_value"]) == (Limit.MAX_VELOCITY, 20000.0)


def test_a_velocity_from_which_the_carriage_stops_in_its_stroke_stays() -> None:
    """1600 u/s, more than the axis's 1500, at s = 200: the stop takes 800 R(1600) = 168 u."""
    machine = started_machine(IN_SYNC).at(1.7)
    machine.speed = 1600.0
    machine.give("abort").run(0.05)
    assert machine.slave == near(200.0 + 80.0 - 200000.0 * 0.05**3 / 6.0, 1350.0, -10000.0, tolerance=1e-8)


@pytest.mark.parametrize(("jump", "end"), [(5000.0, 650.0), (-5000.0, -250.0)])
def test_a_line_that_jumps_takes_the_carriage_to_the_end_of_its_stroke(jump: float, end: float) -> None:
    """And not to s = 5200 or -4800."""
    machine = started_machine(IN_SYNC).at(1.7)
    machine.master_position += jump
    machine.run(1e-9)
    assert machine["error_id"] == Fault.STROKE
    assert machine.slave[:2] == near(end, 1000.0, tolerance=1e-5)
    limit = Limit.MAX_POSITION if jump > 0.0 else Limit.MIN_POSITION
    assert (machine["local.exceeded_limit"], machine["local.exceeded_value"]) == (limit, near(200.0 + jump))


@pytest.mark.parametrize("seed", range(6))
def test_in_a_spike_the_carriage_moves_as_the_oracle_says(seed: int) -> None:
    """One step of acceleration, in which abort is given, or in which the stroke ends."""
    rng = Random(seed)
    values = {**MACHINE, "tool.settle_time": 0.3, "axis.max_position": 400.0 + 30.0 * (seed % 4), "length": 800.0}
    values |= {
        "tool.cut_time": 0.05,
        "axis.max_deceleration": rng.choice((0.0, 6000.0, 14000.0)),
        "homing.jerk": rng.choice((0.0, 8e4)),
    }
    at = rng.uniform(1.4, 1.6) if seed < 4 else 1.66
    spike = (-1.0 if seed in (2, 3) else 1.0) * 10.0 ** rng.uniform(4.0, 5.0)
    segments = [{"duration": at}, {"duration": 0.002, "acceleration": spike}, {"duration": 1.5, "velocity": 700.0}]
    sets = [{"at": 0.1, "start": True}, {"at": at + 0.001, "abort": seed < 4}]
    master = {"velocity": 700.0, "segments": segments}
    script = {"stop_time": at + 1.5, "step_size": 0.01, "start": values, "master": master, "set": sets}
    assert differences(script, [0.01 * i for i in range(400)]) == []
