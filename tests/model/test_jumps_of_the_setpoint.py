"""A setpoint that jumps exceeds the greatest velocity, whatever moves it; and no state of a machine hides that."""

import math
from collections import Counter

import pytest

from motionsync.master import Master
from motionsync.motion.axis_limits import AxisLimits
from motionsync.motion.exceeded_limit import ExceededLimit, Limit
from motionsync.slave import Slave
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from motionsync_fmu.interface.variables import LONGEST_STEP
from tests.support.blocks.random_runs import draw_runs

MACHINES = ["CutToLength", "RotaryKnife", "FlyingSaw"]
AXIS = AxisLimits(max_velocity=200.0)


def check(
    before: float, slave: Slave, *, h: float = 1e-3, turn: float = 0.0, master: Master | None = None
) -> ExceededLimit:
    """What the way of a step exceeds, and nothing else."""
    exceeded = ExceededLimit()
    exceeded.check_way(AXIS, slave, before, turn, h, master or Master())
    return exceeded


def test_the_mean_velocity_of_the_step_counts() -> None:
    """0.2 is what 200 u/s take in a millisecond; a millionth more is rounding."""
    assert check(5.0, Slave(position=5.2)).limit == Limit.NONE
    assert check(5.0, Slave(position=5.2 + 1.5e-7)).limit == Limit.NONE
    assert check(5.0, Slave(position=5.2 + 3e-7)).limit == Limit.MAX_VELOCITY
    back = check(5.0, Slave(position=4.6))
    assert (back.limit, back.value) == (Limit.MAX_VELOCITY, pytest.approx(400.0))


@pytest.mark.parametrize(
    ("before", "after", "speed"), [(359.95, 0.15, 0.0), (0.1, 359.8, 300.0), (10.0, 190.5, 179500.0)]
)
def test_an_axis_that_turns_goes_the_shorter_way(before: float, after: float, speed: float) -> None:
    """0.2 forwards over the end of the turn; 0.3 back; 180.5 forwards is taken for 179.5 back."""
    exceeded = check(before, Slave(position=after), turn=360.0)
    assert exceeded.value == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("limit", [Limit.MIN_POSITION, Limit.MAX_POSITION])
def test_an_end_position_comes_first(limit: Limit) -> None:
    exceeded = ExceededLimit(limit, 7.0)
    exceeded.check_way(AXIS, Slave(position=9.0), 0.0, 0.0, 1e-3, Master())
    assert (exceeded.limit, exceeded.value) == (limit, 7.0)


def test_it_comes_before_an_acceleration_and_is_the_worse_velocity() -> None:
    for former in (ExceededLimit(Limit.MAX_JERK, 1e9), ExceededLimit(Limit.MAX_VELOCITY, 300.0)):
        former.check_way(AXIS, Slave(position=9.0), 0.0, 0.0, 1e-3, Master())
        assert (former.limit, former.value) == (Limit.MAX_VELOCITY, 9000.0)
    worse = ExceededLimit(Limit.MAX_VELOCITY, 1e5)
    worse.check_way(AXIS, Slave(position=9.0), 0.0, 0.0, 1e-3, Master())
    assert worse.value == 1e5


def test_rounding_in_a_very_short_step_is_no_jump() -> None:
    """A position of 1e6 changes by 1.2e-10 at least, and so does that of a slave that follows a master there."""
    far = math.nextafter(1e6, 2e6)
    assert check(1e6, Slave(position=far), h=1e-15).limit == Limit.NONE
    master = Master(end=1e6, end_velocity=100.0)
    follows = Slave(position=3.0 + (far - 1e6), velocity=100.0)
    assert check(3.0, follows, h=1e-15, master=master).limit == Limit.NONE
    assert check(3.0, follows, h=1e-15).limit == Limit.MAX_VELOCITY


@pytest.mark.parametrize("limit", [0.0, -1.0, math.nan, math.inf])
def test_a_limit_that_is_none_is_not_exceeded(limit: float) -> None:
    exceeded = ExceededLimit()
    exceeded.check_way(AxisLimits(max_velocity=limit), Slave(position=9.0), 0.0, 0.0, 1e-3, Master())
    assert exceeded.limit == Limit.NONE


@pytest.mark.parametrize("name", MACHINES)
def test_no_random_run_has_a_jump_in_silence(name: str) -> None:
    """The way of each step is measured here, from its two setpoints; steps in which rounding matters are left out."""
    jumps: Counter[int] = Counter()
    allows = {v.name: v.allows for v in Recipe(name).variables.values()}
    for run in draw_runs(name, 400, 25):
        stepper = Stepper(Recipe(name).block())
        try:
            stepper.initialize(run.start)
        except RefusedError:
            continue
        for h, values in run.steps:
            if not 0.0 < h <= LONGEST_STEP or not all(allows[n](x) for n, x in values.items()):
                continue
            before = stepper["slave.position"]
            try:
                stepper.step(h, values)
            except RefusedError:
                break
            way = stepper["slave.position"] - before
            if name == "RotaryKnife":
                way = math.remainder(way, stepper.block.knife_data.turn)
            greatest = stepper["axis.max_velocity"]
            if h < 1e-6 or not 0.0 < greatest < math.inf or not abs(way) > 1.001 * greatest * h:
                continue
            jumps[stepper["state_code"]] += 1
            exceeded = "limit_exceeded" if name == "FlyingSaw" else "warning.limit_exceeded"
            assert stepper[exceeded], (h, values)
            assert stepper["local.exceeded_limit"] in (Limit.MIN_POSITION, Limit.MAX_POSITION, Limit.MAX_VELOCITY)
    assert len(jumps) >= 3


def test_a_carriage_that_is_at_home_at_once_is_reported_though_it_rests() -> None:
    """The line is set back by 100 in the middle of an approach: so the carriage is at home again, at rest."""
    saw = Stepper(Recipe("CutToLength").block())
    line = 510.0
    saw.initialize({"master.velocity": line, "auto_start": True, "length": 800.0})
    position = 0.0
    while saw["slave.position"] < 12.0:
        saw.step(1e-3, {"master.position": position, "master.velocity": line})
        position += line * 1e-3
    assert not saw["warning.any"]
    before = saw["slave.position"]
    saw.step(1e-3, {"master.position": position - 100.0})
    assert (saw["slave.position"], saw["slave.velocity"]) == (0.0, 0.0)
    assert saw["warning.limit_exceeded"]
    assert (saw["local.exceeded_limit"], saw["local.exceeded_value"]) == (
        Limit.MAX_VELOCITY,
        pytest.approx(before / 1e-3),
    )
    saw.step(1e-3, {"master.position": position - 100.0 + line * 1e-3})
    assert not saw["warning.limit_exceeded"]
