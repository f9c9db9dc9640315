"""gear_in_velo along a profile in time."""

import math

from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from tests.model.flying_saw.harness import INSTANT, FlyingSawHarness, assert_refused, near


def test_time_based_to_a_constant_master() -> None:
    """From 0 to 100 with 1000 and 10000 it takes 0.2 s and 10 u; the master travels 20 meanwhile."""
    saw = (
        FlyingSawHarness(speed=100.0)
        .modes("time_based")
        .give("gear_in_velo", acceleration=1000.0, jerk=10000.0)
        .run(0.1)
    )
    assert (saw.state, saw.slave) == (State.SYNCHRONIZING, near(10.0 / 6.0, 50.0, 1000.0))
    result = saw.block.characteristics
    assert (result.profile, result.master_position_end, result.slave_position_end) == (
        ProfileKind.JERK_LIMITED,
        near(20.0),
        near(10.0),
    )
    assert (result.slave_acceleration_max, result.slave_jerk_max, result.slave_velocity_mean) == near(1e3, 1e4, 50.0)
    last = math.sqrt(1.0 / 150.0)  # s before the end, where v a = (100 - 5000 r^2) 10000 r is greatest
    assert result.slave_dynamic_momentum_max == near((100.0 - 5000.0 * last**2) * 10000.0 * last)
    assert result.slave_acceleration_effective == near(math.sqrt(1e6 / 3.0))
    saw.run(0.1 + INSTANT)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}
    saw.run(1.0, acceleration=-50.0).run(1.0, acceleration=500.0)
    assert saw.slave == near(saw.master_position - 10.0, saw.speed, 500.0)


def test_time_based_to_an_accelerated_master() -> None:
    """The velocity lacks 100, and a_m = 100 adds to that: w' goes from -100 to 900 in 0.1 s, stays there, and goes to 0
    in 0.09 s. The jerk's triangles make (2 * 900^2 - 100^2) / 20000 = 80.5, the plateau makes the other 19.5."""
    saw = FlyingSawHarness(speed=100.0).modes("time_based").give("gear_in_velo", acceleration=1000.0, jerk=10000.0)
    duration = 0.1 + 19.5 / 900.0 + 0.09
    saw.run(0.1 + 0.5 * 19.5 / 900.0, acceleration=100.0)
    assert saw.slave[2] == near(1000.0)
    saw.run(duration - saw.time - 1e-6, acceleration=100.0)
    assert saw.state == State.SYNCHRONIZING
    saw.run(2e-6, acceleration=100.0)
    assert saw.state == State.SYNCHRON
    assert saw.slave[1:] == near(100.0 + 100.0 * (duration + 1e-6), 100.0)


def test_time_based_beyond_the_velocity_limit() -> None:
    """Refused at the edge; a master that becomes too fast later is followed at the limit until it is slower again."""
    saw = FlyingSawHarness(speed=100.0).modes("time_based")
    assert_refused(saw, "gear_in_velo", 0x42DD, velocity=99.0)
    saw = FlyingSawHarness(speed=100.0).modes("time_based")
    saw.give("gear_in_velo", velocity=120.0, acceleration=100.0, deceleration=100.0, jerk=1000.0)
    saw.run(0.5, acceleration=80.0)  # 140 at its end
    saw.run(3.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRONIZING, near(120.0, 0.0))
    saw.run(1.0, acceleration=-30.0)
    saw.run(3.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(110.0, 0.0))


def test_time_based_the_reversal_table_applies_only_in_sync() -> None:
    saw = FlyingSawHarness(speed=100.0).modes("time_based", "rollback_lock", "instant_stop_on_rollback")
    saw.give("gear_in_velo", acceleration=100.0, deceleration=100.0, jerk=1000.0).run(0.1)
    saw.speed = -100.0
    saw.run(0.5)
    assert (saw.state, saw.slave[2] < 0.0) == (State.SYNCHRONIZING, True)
    saw.run(5.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(-100.0, 0.0))
