"""gear_in_velo along a profile in time."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from tests.model.flying_saw.harness import AIMS, INSTANT, FlyingSawHarness, assert_refused, near


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


def reversed_early(*modes: str, side: float = 1.0, back: float = 0.1, jerk: float = 1000.0) -> FlyingSawHarness:
    """Time based; the master, which comes back at its velocity after the time `back`, is at the coupling position again
    after twice that time.

    With t = `back` and j = `jerk` the slave gets to j t, j t^2 / 2 and j t^3 / 6 until the master comes back. From then
    on the target is -100, so its acceleration falls by j: at the coupling position it has none, the velocity j t^2, and
    the position j t^3 (10 and 1 with the values above)."""
    saw = FlyingSawHarness(speed=100.0 * side).modes("time_based", *modes)
    saw.give("gear_in_velo", acceleration=1000.0, deceleration=100.0, jerk=jerk).run(back, cuts=[0.4 * back])
    saw.speed = -100.0 * side
    return saw.run(back, cuts=[0.7 * back])


def test_time_based_without_a_bit_of_the_reversal_the_ramp_goes_on() -> None:
    saw = reversed_early()
    assert (saw.state, saw.slave) == (State.SYNCHRONIZING, near(1.0, 10.0, 0.0))
    saw.run(0.05)
    assert (saw.state, saw.slave[2] < 0.0) == (State.SYNCHRONIZING, True)
    saw.run(5.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(-100.0, 0.0))


ROLLBACK = [("rollback_lock",), ("instant_stop_on_rollback",), ("rollback_lock", "instant_stop_on_rollback")]


@pytest.mark.parametrize("modes", ROLLBACK)
@given(st.sampled_from([1.0, -1.0]), st.floats(0.02, 0.1), st.floats(100.0, 1000.0), st.floats(0.01, 0.99))
def test_time_based_the_slave_rests_beyond_the_coupling_position(
    modes: tuple[str, ...], side: float, back: float, jerk: float, cut: float
) -> None:
    """At once, or along the ramp with a deceleration of 100: T = 1.5 v / 100, s = v T / 2. Forwards again it is planned
    anew, in time: from rest to 100 with 1000 u/s2, which the jerk does not let it reach: 2 sqrt(100 / j) s."""
    saw = reversed_early(*modes, side=side, back=back, jerk=jerk)
    velocity, position = jerk * back**2, jerk * back**3
    halt = 0.0 if "instant_stop_on_rollback" in modes else 1.5 * velocity / 100.0
    rest = side * (position + 0.5 * velocity * halt)
    if halt:
        saw.run(0.5 * halt, cuts=[cut * 0.5 * halt])
        assert saw.slave[1:] == near(0.5 * side * velocity, -100.0 * side)
    else:
        saw.run(INSTANT)
    assert (saw.state, saw["coupled"]) == (State.PREPHASE, True)
    assert saw.results("gear_in_velo") == {"busy", "active"}
    saw.run(0.5 * halt + 0.25, cuts=[cut * 0.25])
    assert (saw.state, saw.slave) == (State.PREPHASE, near(rest, 0.0, 0.0))
    saw.speed = 100.0 * side
    assert saw.to(-1e-3 * side).state == State.PREPHASE
    ramp = 2.0 * math.sqrt(100.0 / jerk)
    saw.run(1e-5 + 0.5 * ramp, cuts=[cut * 0.5 * ramp])
    assert (saw.state, saw.slave[1]) == (State.SYNCHRONIZING, near(50.0 * side))
    assert saw["characteristics.profile"] == ProfileKind.JERK_LIMITED
    saw.run(0.5 * ramp + INSTANT)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}
    assert saw.slave == near(rest + side * (50.0 * ramp + 100.0 * INSTANT), 100.0 * side, 0.0)


def test_time_based_a_command_that_waits_keeps_the_slave_parked() -> None:
    """gear_in_pos waits for the master at 100: nothing is planned anew where it passes the coupling position."""
    saw = FlyingSawHarness(speed=100.0).modes("time_based", "rollback_lock").give("gear_in_velo", jerk=1000.0).run(0.05)
    saw.modes().give("gear_in_pos", **AIMS, master_start_distance=AIMS["master_sync_position"] - 100.0).run(0.05)
    assert (saw.state, saw.slave[1] > 0.0) == (State.PREPHASE, True)
    saw.speed = -100.0
    assert saw.run(1.0).slave[1:] == near(0.0, 0.0)
    saw.speed = 100.0
    assert saw.to(99.0).slave[1:] == near(0.0, 0.0)
    assert saw.run(0.5).state == State.SYNCHRONIZING
