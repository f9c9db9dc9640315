"""What an own motion starts from after a coupled one, which no axis could have had: the limits of the axis.

The slave is in sync with a master of 500 u/s at 500 t; for one step, in which the command is given, the master has the
acceleration `spike`. The axis has 2000, 10000, 10000, 100000."""

from random import Random
from typing import Any

import pytest

from motionsync.motion.exceeded_limit import Limit
from tests.model.flying_saw.harness import FlyingSawHarness, near
from tests.oracle.flying_saw import reference

SPEED = 500.0
COMMANDS: dict[str, dict[str, float]] = {
    "halt": {},
    "stop": {},
    "move_velocity": {"velocity": 0.0},
    "move_absolute": {"position": -100.0},
}


def in_sync(**axis: float) -> FlyingSawHarness:
    """At 0.2 s."""
    values = {f"axis.{name}": value for name, value in axis.items()}
    saw = FlyingSawHarness({"axis.initial_velocity": SPEED, **values}, speed=SPEED).modes()
    saw.give("gear_in_velo", acceleration=1e4).run(0.2)
    assert saw["in_sync"]
    return saw


def exceeded(saw: FlyingSawHarness) -> tuple[Limit, float]:
    return Limit(saw["local.exceeded_limit"]), saw["local.exceeded_value"]


@pytest.mark.parametrize("command", COMMANDS)
def test_speeding_up_it_starts_with_the_acceleration(command: str) -> None:
    """From 10000 with -100000: after 0.05 s a = 5000, v = 500 + 500 - 125, s = 100 + 25 + 12.5 - 100000 0.05^3 / 6."""
    saw = in_sync().give(command, **COMMANDS[command]).run(0.05, acceleration=5e4)
    assert saw.slave == near(137.5 - 100000.0 * 0.05**3 / 6.0, 875.0, 5000.0)
    assert exceeded(saw) == (Limit.MAX_ACCELERATION, 5e4)
    assert saw.run(2.0)["limit_exceeded"] is False
    assert saw.slave[1:] == (0.0, 0.0)


@pytest.mark.parametrize(("deceleration", "in_use"), [(10000.0, 10000.0), (8000.0, 8000.0), (0.0, 10000.0)])
def test_slowing_down_it_starts_with_the_deceleration(deceleration: float, in_use: float) -> None:
    """The halt stays at that limit: with 200000 u/s3 its end takes 250 u/s at most."""
    saw = in_sync(max_deceleration=deceleration, max_jerk=2e5).give("halt").run(0.01, acceleration=-5e4)
    assert saw.slave == near(105.0 - 0.5e-4 * in_use, 500.0 - 0.01 * in_use, -in_use)
    assert exceeded(saw) == (Limit.MAX_DECELERATION, 5e4)


def test_within_the_limits_of_the_axis_it_starts_as_the_slave_moves() -> None:
    """9999 is more than the command's own limit, which it comes down to; nothing is exceeded."""
    saw = in_sync().give("halt", deceleration=1000.0).run(0.01, acceleration=9999.0)
    assert saw.slave[1:] == near(500.0 + 99.99 - 5.0, 8999.0)
    assert exceeded(saw) == (Limit.NONE, 0.0)


@pytest.mark.parametrize("limit", [10000.0, 7777.7, 0.3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_is_beyond_the_limit_by_rounding_is_not_reported(limit: float, sign: float) -> None:
    """The README: a setpoint counts as beyond a limit if it exceeds it by more than 1e-6 of it."""
    code = Limit.MAX_ACCELERATION if sign > 0.0 else Limit.MAX_DECELERATION
    for beyond, reported in ((2.0**-52, Limit.NONE), (1e-9, Limit.NONE), (9e-7, Limit.NONE), (1.1e-6, code)):
        saw = FlyingSawHarness({"axis.initial_velocity": SPEED, "axis.max_acceleration": limit}, speed=SPEED).modes()
        saw.set({"axis.max_deceleration": limit}).give("gear_in_velo").run(0.2)
        saw.give("halt").run(0.001, acceleration=sign * limit * (1.0 + beyond))
        assert exceeded(saw)[0] == reported


def test_at_rest_the_greater_limit_counts() -> None:
    """A standing slave neither speeds up nor slows down."""
    saw = FlyingSawHarness({"axis.max_deceleration": 12000.0}, speed=0.0).modes().give("gear_in_velo").run(0.1)
    saw.give("halt").run(0.001, acceleration=5e4)
    assert saw.slave[1:] == near(12.0 - 0.05, 11900.0)


def test_a_limit_that_is_not_above_0_limits_nothing() -> None:
    saw = in_sync().set({"axis.max_acceleration": 0.0}).give("halt", deceleration=1e4).run(0.01, acceleration=5e4)
    assert saw.slave[2] == near(49000.0)


def test_the_velocity_stays_while_a_stop_ends_where_it_may() -> None:
    """3000 u/s, more than the axis's: a stop takes 1500 (0.3 + 0.1) = 600 u, one from 2000 takes 300."""
    for highest, velocity in ((100.0 + 300.1, 3000.0), (100.0 + 299.9, 2000.0)):
        saw = in_sync(max_position=highest)
        saw.speed = 3000.0
        saw.give("halt").run(0.1)
        assert saw.slave == near(100.0 + 0.1 * velocity - 1e5 * 1e-3 / 6.0, velocity - 500.0, -10000.0)
        assert exceeded(saw) == (Limit.MAX_POSITION, near(700.0 if velocity == 3000.0 else 400.0))


def test_after_gear_out_nothing_is_reported_of_a_former_start() -> None:
    saw = in_sync().give("halt").run(0.001, acceleration=5e4)
    saw.release().run(1.0)
    saw.speed = SPEED
    saw.give("gear_in_velo").run(3.0).give("gear_out").run(0.1)
    assert exceeded(saw) == (Limit.NONE, 0.0)
    assert saw.slave[1:] == near(SPEED, 0.0)


@pytest.mark.parametrize("seed", range(12))
def test_after_a_spike_the_slave_moves_as_the_oracle_says(seed: int) -> None:
    """Whatever the command and the limits, with end positions near or far."""
    rng = Random(seed)
    command = rng.choice(list(COMMANDS))
    spike = rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(3.5, 6.0)
    start: dict[str, Any] = {
        "axis.initial_velocity": SPEED,
        "axis.max_deceleration": rng.choice((0.0, 7000.0, 13000.0)),
    }
    start |= {"axis.max_position": rng.choice((300.0, 1e9)), "axis.max_velocity": rng.choice((700.0, 2000.0))}
    start |= {f"sync_mode.{name}": False for name in ("check_max_velocity", "check_max_position")}
    given = {f"{command}.{name}": value for name, value in COMMANDS[command].items()}
    given |= {"move_absolute.position": 200.0, f"{command}.deceleration": rng.choice((0.0, 3000.0))}
    segments = [{"duration": 0.2}, {"duration": 0.002, "acceleration": spike}, {"duration": 3.0, "velocity": SPEED}]
    script: dict[str, Any] = {
        "stop_time": 1.2,
        "step_size": 0.01,
        "start": {**start, "gear_in_velo.execute": False},
        "master": {"velocity": SPEED, "segments": segments},
        "set": [{"at": 0.1, "gear_in_velo.execute": True}, {"at": 0.201, f"{command}.execute": True, **given}],
    }
    times = [0.21 + 0.03 * i for i in range(30)]
    saw = FlyingSawHarness(start, speed=SPEED).run(0.1).give("gear_in_velo").run(0.1)
    saw.run(0.001, acceleration=spike).set(given).give(command).run(0.001, acceleration=spike)
    saw.speed = SPEED
    for row in reference(script, times):
        if row["time"] > saw.time:
            saw.run(row["time"] - saw.time)
        expected = (row[f"slave.{name}"] for name in ("position", "velocity", "acceleration"))
        assert saw.slave == near(*expected, tolerance=1e-8)
        assert saw["local.exceeded_limit"] == row["local.exceeded_limit"]
