"""limit_exceeded: a setpoint that the axis cannot do is always reported, whatever sync_mode checks."""

import math
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.interface import State
from motionsync.motion.exceeded_limit import Limit
from motionsync_fmu.interface.recipe import declared_variables
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from motionsync_fmu.interface.variables import LONGEST_STEP
from tests.model.flying_saw.harness import INSTANT, FlyingSawHarness, meeting, near
from tests.model.flying_saw.strategies import STRATEGY
from tests.support.blocks.drawn import drawn
from tests.support.blocks.runs import BlockRun

GENTLE = {"axis.max_velocity": 2000.0, "axis.max_acceleration": 1e5, "axis.max_deceleration": 1e5, "axis.max_jerk": 1e6}


def exceeded(saw: FlyingSawHarness) -> tuple[bool, int, float]:
    return saw["limit_exceeded"], saw["local.exceeded_limit"], saw["local.exceeded_value"]


NOTHING = (False, Limit.NONE, 0.0)


def report(limit: Limit, value: float) -> tuple[bool, int, Any]:
    return True, limit, near(value, tolerance=1e-6)


# --- what is checked at first -----------------------------------------------------------------------------------------


def test_the_limits_of_the_axis_are_checked_at_first_but_for_the_jerk() -> None:
    saw = FlyingSawHarness()
    checked = {name for name in saw.stepper.cells if name.startswith("sync_mode.") and saw[name]}
    limits = ("min_position", "max_position", "max_velocity", "max_acceleration", "max_deceleration")
    assert checked == {f"sync_mode.check_{name}" for name in limits}


# --- what is planned --------------------------------------------------------------------------------------------------

# From rest to 100 u with 100 u/s in 1 s: v = 1800 u^2 - 3200 u^3 + 1500 u^4 has its extreme 151.2 at u = 0.6; a has the
# extremes at u = (16 +- sqrt(76)) / 30, 394.02257 and -194.91146; j is greatest at the start, 3600.
U = [(16.0 - math.sqrt(76.0)) / 30.0, (16.0 + math.sqrt(76.0)) / 30.0]
STEEPEST, SLOWING = (abs(u * (3600.0 - 9600.0 * u + 6000.0 * u * u)) for u in U)
PLAN = [
    ("max_position", Limit.MAX_POSITION, 100.0, 0.999),
    ("max_velocity", Limit.MAX_VELOCITY, 151.2, 0.999),
    ("max_acceleration", Limit.MAX_ACCELERATION, STEEPEST, 0.999),
    ("max_deceleration", Limit.MAX_DECELERATION, SLOWING, 0.999),
    ("max_jerk", Limit.MAX_JERK, 3600.0, 0.999),
]


@pytest.mark.parametrize(("name", "limit", "extreme", "share"), PLAN)
def test_a_plan_beyond_a_limit_is_reported_from_its_edge_until_in_sync(
    name: str, limit: Limit, extreme: float, share: float
) -> None:
    keeping = FlyingSawHarness({**GENTLE, f"axis.{name}": extreme}, speed=100.0).modes()
    broken = FlyingSawHarness({**GENTLE, f"axis.{name}": share * extreme}, speed=100.0).modes()
    for saw, expected in ((keeping, NOTHING), (broken, report(limit, extreme))):
        saw.give("gear_in_pos", master_sync_position=100.0, slave_sync_position=100.0)
        for _ in range(9):
            assert exceeded(saw.run(0.1)) == expected
            assert saw.state == State.SYNCHRONIZING
    assert exceeded(keeping.run(0.1)) == NOTHING
    assert broken.run(0.1).state == State.SYNCHRON
    if limit != Limit.MAX_POSITION:  # in sync it goes on from there
        assert exceeded(broken) == NOTHING
    else:
        assert exceeded(broken) == report(limit, 100.0)


def test_a_plan_below_the_lower_end_position() -> None:
    """From -100 to 100 with 300: T = 1 s; the slave goes to -31.25 and back."""
    for low, expected in ((-31.3, NOTHING), (-31.2, report(Limit.MIN_POSITION, -31.25))):
        saw = FlyingSawHarness({"axis.initial_velocity": -100.0, "axis.min_position": low}, speed=100.0).modes()
        saw.give("gear_in_velo", acceleration=300.0, deceleration=300.0)
        assert exceeded(saw.run(INSTANT)) == expected
        assert saw["local.plan_position_min"] == near(-31.25)
        assert exceeded(saw.run(1.1)) == NOTHING


def test_a_limit_of_a_command_above_the_axis_s_is_used_and_reported() -> None:
    """The check looks at the command's limit. The ramp from 0 to 100 with 2000 is over after 0.075 s."""
    saw = FlyingSawHarness({"axis.max_acceleration": 500.0}, speed=100.0).give("gear_in_velo", acceleration=2000.0)
    assert exceeded(saw.run(0.07)) == report(Limit.MAX_ACCELERATION, 2000.0)
    assert exceeded(saw.run(0.01)) == NOTHING


def test_a_refused_command_exceeds_nothing() -> None:
    saw = meeting(0.0, 100.0, 100.0, "check_max_acceleration", max_acceleration=394.0)
    assert saw.results("gear_in_pos") == {"error"}
    assert exceeded(saw) == NOTHING
    assert saw["local.plan_velocity_max"] == near(151.2)


def test_of_several_limits_the_first_is_reported() -> None:
    machine = {"axis.max_velocity": 150.0, "axis.max_acceleration": 300.0, "axis.max_jerk": 3000.0}
    for names, limit in ((3, Limit.MAX_VELOCITY), (2, Limit.MAX_ACCELERATION), (1, Limit.MAX_JERK)):
        saw = FlyingSawHarness({**GENTLE, **dict(list(machine.items())[3 - names :])}, speed=100.0).modes()
        saw.give("gear_in_pos", master_sync_position=100.0, slave_sync_position=100.0).run(INSTANT)
        assert saw["local.exceeded_limit"] == limit


# --- the slave's own motion -------------------------------------------------------------------------------------------


def test_a_move_faster_than_the_axis_is_reported_until_it_is_over() -> None:
    """300 u/s with 1000 u/s2 and 1e5 u/s3: 0.3 + 0.01 s up and down, 907 u of the way at 300: 3.333 s in all."""
    saw = FlyingSawHarness({"axis.max_velocity": 200.0, "axis.max_acceleration": 1000.0})
    saw.give("move_absolute", position=907.0, velocity=300.0)
    duration = 907.0 / 300.0 + 0.31
    for _ in range(3):
        assert exceeded(saw.run(1.0)) == report(Limit.MAX_VELOCITY, 300.0)
    assert exceeded(saw.run(duration - 3.0 - 1e-6)) == report(Limit.MAX_VELOCITY, 300.0)
    assert exceeded(saw.run(2e-6)) == NOTHING


def test_a_change_of_velocity_is_reported_until_it_is_over_and_an_end_position_when_it_is_passed() -> None:
    """From rest to 100 u/s with 1000 u/s2 and 1e5 u/s3 in 0.11 s, 5.5 u on the way."""
    saw = FlyingSawHarness({"axis.max_acceleration": 500.0, "axis.max_position": 50.0})
    saw.give("move_velocity", velocity=100.0, acceleration=1000.0)
    assert exceeded(saw.run(0.109)) == report(Limit.MAX_ACCELERATION, 1000.0)
    assert exceeded(saw.run(0.002)) == NOTHING
    assert exceeded(saw.run(0.443)) == NOTHING  # 49.9 u
    assert exceeded(saw.run(0.002)) == report(Limit.MAX_POSITION, 50.1)


def test_a_halt_that_overruns_an_end_position_is_reported_at_once_and_at_rest() -> None:
    """From 100 u/s with 1000 u/s2 and 1e5 u/s3 the way is v^2 / 2a + v a / 2j = 5.5 u."""
    for high, limit in ((5.4, Limit.MAX_POSITION), (5.6, Limit.NONE)):
        machine = {"axis.initial_velocity": 100.0, "axis.max_acceleration": 1000.0, "axis.max_position": high}
        saw = FlyingSawHarness(machine).give("halt").run(INSTANT)
        assert exceeded(saw) == (report(limit, 5.5) if limit else NOTHING)
        assert exceeded(saw.run(1.0)) == (report(limit, 5.5) if limit else NOTHING)
        assert saw.results("halt") == {"done"}


def test_ordinary_moves_up_to_the_limits_exceed_nothing() -> None:
    saw = FlyingSawHarness({"axis.min_position": 0.0, "axis.max_position": 600.0, "axis.max_deceleration": 3000.0})
    for target in (600.0, 0.0, 599.0, 0.3, 600.0):
        saw.give("move_absolute", position=target)
        for _ in range(60):
            assert exceeded(saw.run(0.017)) == NOTHING
        saw.release().run(INSTANT)


def test_an_axis_that_starts_beyond_its_limits_is_reported_from_the_first_step_on() -> None:
    saw = FlyingSawHarness({"axis.initial_position": 5.0, "axis.max_position": 4.0})
    assert exceeded(saw) == NOTHING
    assert exceeded(saw.run(0.1)) == report(Limit.MAX_POSITION, 5.0)
    saw = FlyingSawHarness({"axis.initial_velocity": -5.0, "axis.max_velocity": 4.0})
    assert exceeded(saw.run(0.1)) == report(Limit.MAX_VELOCITY, 5.0)


# --- in sync ----------------------------------------------------------------------------------------------------------


def in_sync(**machine: float) -> FlyingSawHarness:
    """Master and slave at 100 u/s, the slave twice as fast as the master."""
    saw = FlyingSawHarness({f"axis.{name}": value for name, value in machine.items()}, speed=50.0)
    saw.give("gear_in_velo", ratio_numerator=2.0).run(1.0)
    assert saw.state == State.SYNCHRON
    assert exceeded(saw) == NOTHING
    return saw


def test_a_master_that_takes_the_slave_beyond_its_velocity_is_reported_while_it_does() -> None:
    saw = in_sync(max_velocity=120.0)
    assert exceeded(saw.run(0.95, acceleration=10.0)) == NOTHING  # 119
    assert exceeded(saw.run(0.1, acceleration=10.0)) == report(Limit.MAX_VELOCITY, 121.0)
    assert exceeded(saw.run(1.0)) == report(Limit.MAX_VELOCITY, 121.0)
    assert exceeded(saw.run(0.1, acceleration=-10.0)) == NOTHING


def test_a_master_that_takes_the_slave_beyond_its_end_positions_is_reported_while_it_does() -> None:
    saw = in_sync(min_position=-10.0, max_position=300.0)
    left = (300.0 - saw.slave[0]) / 100.0
    assert exceeded(saw.run(left - 0.01)) == NOTHING
    assert exceeded(saw.run(0.02)) == report(Limit.MAX_POSITION, 301.0)
    saw.speed = -50.0
    assert exceeded(saw.run(0.02)) == NOTHING
    assert exceeded(saw.run(3.11)) == report(Limit.MIN_POSITION, -12.0)


def test_accelerations_of_the_master_are_reported_speeding_up_and_slowing_down() -> None:
    saw = in_sync(max_acceleration=200.0, max_deceleration=300.0)
    assert exceeded(saw.run(0.1, acceleration=99.0)) == NOTHING
    assert exceeded(saw.run(0.1, acceleration=101.0)) == report(Limit.MAX_ACCELERATION, 202.0)
    assert exceeded(saw.run(0.1, acceleration=-149.0)) == NOTHING
    assert exceeded(saw.run(0.1, acceleration=-151.0)) == report(Limit.MAX_DECELERATION, 302.0)
    assert exceeded(saw.run(0.1)) == NOTHING


def test_a_profile_that_a_faster_master_takes_beyond_a_limit_is_reported_then() -> None:
    """The plan reaches 151.2; with twice the master's velocity the slave is twice as fast on the same curve."""
    saw = FlyingSawHarness({**GENTLE, "axis.max_velocity": 200.0}, speed=100.0).modes()
    saw.give("gear_in_pos", master_sync_position=100.0, slave_sync_position=100.0)
    assert exceeded(saw.run(0.55)) == NOTHING
    saw.speed = 200.0
    assert exceeded(saw.run(0.025)) == report(Limit.MAX_VELOCITY, 302.4)
    saw.speed = 100.0
    assert exceeded(saw.run(0.01)) == NOTHING


def test_a_limit_that_is_no_number_above_0_limits_nothing() -> None:
    for value in (math.nan, math.inf, 0.0, -1.0):
        for name in ("max_velocity", "max_acceleration", "max_jerk"):
            saw = in_sync().set({f"axis.{name}": value})
            assert exceeded(saw.run(0.1, acceleration=10.0)) == NOTHING


# --- the backstop -----------------------------------------------------------------------------------------------------


def reversed_before_sync(**values: Any) -> FlyingSawHarness:
    """The master reverses on the way and passes the coupling position backwards, with the slave at its velocity."""
    saw = FlyingSawHarness({"axis.initial_velocity": 100.0, **values}, speed=100.0)
    saw.give("gear_in_pos", master_sync_position=300.0, slave_sync_position=300.0, deceleration=250.0).run(0.5)
    saw.speed = -100.0
    return saw.run(0.6)


def test_a_stop_at_once_is_reported_while_the_slave_is_parked() -> None:
    saw = reversed_before_sync(**{"sync_mode.instant_stop_on_rollback": True})
    assert (saw.state, saw.slave[1]) == (State.PREPHASE, 0.0)
    assert exceeded(saw) == report(Limit.INSTANT_STOP, 100.0)
    saw.speed = 100.0
    assert exceeded(saw.run(0.5)) == NOTHING


def test_the_halt_of_the_backstop_is_reported_until_the_slave_is_at_rest() -> None:
    """The ramp from 100 with 250 takes 0.6 s; 0.1 s of it have passed."""
    saw = reversed_before_sync(**{"axis.max_deceleration": 200.0})
    assert exceeded(saw) == report(Limit.MAX_DECELERATION, 250.0)
    assert exceeded(saw.run(0.499)) == report(Limit.MAX_DECELERATION, 250.0)
    assert exceeded(saw.run(0.002)) == NOTHING
    assert exceeded(reversed_before_sync(**{"axis.max_deceleration": 251.0})) == NOTHING


# --- random runs ------------------------------------------------------------------------------------------------------


def breaks(stepper: Stepper, margin: float) -> bool:
    """Whether the setpoint is beyond a limit of the axis by more than this share of it."""
    s, v, a, j = (stepper[f"slave.{name}"] for name in ("position", "velocity", "acceleration", "jerk"))
    low, high, speed, up, down, jerk = (
        stepper[f"axis.{name}"]
        for name in ("min_position", "max_position", "max_velocity", "max_acceleration", "max_deceleration", "max_jerk")
    )
    down = down if down != 0.0 else up
    near_by = margin * (abs(s) + speed)
    if s < low - near_by or s > high + near_by or abs(v) > speed * (1.0 + margin) or abs(j) > jerk * (1.0 + margin):
        return True
    along = up if v * a > 0.0 else down
    if abs(v) < 2e-6 * speed:
        along = max(up, down)
    return bool(abs(a) > along * (1.0 + margin))


@drawn(150)
@given(STRATEGY.runs(120), st.integers(0, 2**32 - 1))
def test_whatever_is_output_beyond_a_limit_is_reported(run: BlockRun, seed: int) -> None:
    """In random runs, whose axis is given limits that are now and then too tight."""
    r = Random(seed)
    span = 10.0 ** r.uniform(-1.0, 2.0) * (1.0 + abs(run.start["axis.initial_position"]))
    start = {name: x * (10.0 ** r.uniform(-1.5, 1.0) if "axis.max_" in name else 1) for name, x in run.start.items()}
    middle = run.start["axis.initial_position"]
    start |= {"axis.min_position": middle - span * r.random(), "axis.max_position": middle + span * r.random()}
    stepper = Stepper(FlyingSaw()).initialize(start)
    inputs = {v.name: v for v in declared_variables(FlyingSaw).values() if v.causality == "input"}
    for h, drawn_values in run.steps:
        values = {name: x for name, x in drawn_values.items() if name != "axis.max_jerk"}
        if not 0.0 < h <= LONGEST_STEP or any(inputs[n].refusal(x) for n, x in values.items() if n in inputs):
            continue
        try:
            stepper.step(h, values)
        except RefusedError:
            continue
        assert stepper["limit_exceeded"] == (stepper["local.exceeded_limit"] != 0)
        if breaks(stepper, 3e-6):
            assert stepper["limit_exceeded"]
