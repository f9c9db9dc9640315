"""Which profile gear_in_pos chooses, with numbers by hand."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from tests.model.flying_saw.harness import (
    FIRST,
    INSTANT,
    VELOCITY_CHECKS,
    FlyingSawHarness,
    assert_refused,
    first_example,
    meeting,
    near,
)


def profile(saw: FlyingSawHarness) -> ProfileKind:
    assert not saw["error"]
    kind: ProfileKind = saw["characteristics.profile"]
    return kind


def test_the_start_velocity_is_kept_first_if_the_mean_is_nearer_to_it() -> None:
    """The mean velocity is 150, between 100 and 300: T5 = 2 (150 - 100) / 200 = 0.5 s."""
    saw = meeting(100.0, 300.0, 150.0, "check_overshoot_velocity").run(0.5 - INSTANT)
    assert profile(saw) == ProfileKind.P1_P5
    assert saw.slave == near(50.0, 100.0, 0.0)
    saw.run(0.25)
    assert saw.slave == near(50.0 + 0.5 * (50.0 + 200.0 * (1 / 8 - 1 / 32)), 200.0, 600.0)


@pytest.mark.parametrize(
    ("mean", "kind"), [(199.0, ProfileKind.P1_P5), (200.0, ProfileKind.P5_P1), (201.0, ProfileKind.P5_P1)]
)
def test_at_or_beyond_the_middle_the_ramp_comes_first(mean: float, kind: ProfileKind) -> None:
    assert profile(meeting(100.0, 300.0, mean, "check_undershoot_velocity")) == kind


@pytest.mark.parametrize("mean", [100.0, 100.0 + 1e-13, 99.0, 300.0, 300.0 - 1e-13, 301.0])
def test_no_ramp_leads_to_a_mean_velocity_at_or_beyond_those_of_the_ends(mean: float) -> None:
    """Nor to one that differs by rounding: the ramp would have no time, and the velocity would jump."""
    saw = meeting(100.0, 300.0, mean, "check_overshoot_velocity", "check_undershoot_velocity")
    assert saw["gear_in_pos.error_id"] in (0x437C, 0x4381)
    assert profile(meeting(100.0, 300.0, mean)) == ProfileKind.P5


@pytest.mark.parametrize(("check", "limit"), [("acceleration", 187.4), ("jerk", 374.9)])
def test_a_ramp_that_breaks_a_steepness_limit_gives_way_to_the_quintic(check: str, limit: float) -> None:
    """In example 1 the ramp has the peaks 187.5 and 375, the quintic 175.04 and 444.4; the quintic overshoots only."""
    for active, code in [(VELOCITY_CHECKS, 0x437C), (VELOCITY_CHECKS[1:], 0x438A if check == "jerk" else 0)]:
        saw = first_example().modes(f"check_max_{check}", *active, "detailed_error_codes")
        saw.give("gear_in_pos", **FIRST, **{check: limit}).run(INSTANT)
        assert saw["gear_in_pos.error_id"] == code
        assert code != 0 or profile(saw) == ProfileKind.P5
    saw = first_example().modes(f"check_max_{check}", *VELOCITY_CHECKS)
    saw.give("gear_in_pos", **FIRST, **{check: 187.5 if check == "acceleration" else 375.0}).run(INSTANT)
    assert profile(saw) == ProfileKind.P5_P1


def test_a_ramp_that_breaks_another_check_is_refused() -> None:
    saw = first_example(**{"axis.max_position": 999.0}).modes("check_max_position", *VELOCITY_CHECKS)
    assert_refused(saw, "gear_in_pos", 0x42DF, **FIRST)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_the_velocity_limit_where_the_quintic_exceeds_it(sign: float) -> None:
    """T = 2, D = 900, from 0 to 500: the quintic reaches 601; at 510 both ramps have the peak
    0.75 (510^2 + 10^2) / (1020 - 900) = 1626.25."""
    c, peak = 510.0, 0.75 * (510.0**2 + 10.0**2) / 120.0
    rise, fall = 1.5 * c / peak, 1.5 * 10.0 / peak
    saw = meeting(0.0, sign * 500.0, sign * 900.0, "check_max_velocity", vm=sign * 100.0, t=2.0, max_velocity=c)
    assert profile(saw) == ProfileKind.P5_P1_P5
    result = saw.block.characteristics
    fastest = result.slave_velocity_max if sign > 0.0 else -result.slave_velocity_min
    side = "max" if sign > 0.0 else "min"  # of equal values the place is the first one's
    assert saw[f"characteristics.master_position_at_slave_velocity_{side}"] == near(sign * 100.0 * rise)
    assert (fastest, result.slave_acceleration_max, result.slave_acceleration_min) == near(c, peak, -peak)
    assert (result.slave_jerk_max, result.slave_jerk_min) == near(6 * 10.0 / fall**2, -6 * 10.0 / fall**2)
    saw.run(1.0 - INSTANT)
    assert saw.slave == near(sign * (0.5 * c * rise + c * (1.0 - rise)), sign * c, 0.0)
    saw.run(1.0 + INSTANT)
    assert saw.state == State.SYNCHRON
    assert saw.slave[:2] == near(sign * (900.0 + 500.0 * INSTANT), sign * 500.0)


def test_a_profile_at_the_velocity_limit_that_breaks_a_steepness_limit_gives_way_to_the_quintic() -> None:
    modes = ("check_max_velocity", "check_max_acceleration")
    machine = {"t": 2.0, "max_velocity": 510.0}
    assert profile(meeting(0.0, 500.0, 900.0, *modes, max_acceleration=1627.0, **machine)) == ProfileKind.P5_P1_P5
    assert meeting(0.0, 500.0, 900.0, *modes, max_acceleration=1626.0, **machine)["gear_in_pos.error_id"] == 0x437A


def test_a_preferred_constant_velocity_with_ramps_at_the_acceleration_limit() -> None:
    """The velocity is 500 at both ends, the distance 1200 in 3 s, the limit 500: with x = 500 - c,
    3 x - 0.003 x^2 = 300."""
    x = (3.0 - math.sqrt(5.4)) / 0.006
    ramp = 1.5 * x / 500.0
    machine = {"max_acceleration": 500.0, "max_deceleration": 500.0, "max_jerk": 1000.0, "t": 3.0}
    saw = meeting(500.0, 500.0, 1200.0, "prefer_constant_velocity", **machine)
    assert profile(saw) == ProfileKind.P5_P1_P5
    result = saw.block.characteristics
    assert (result.slave_velocity_min, result.slave_acceleration_min) == near(500.0 - x, -500.0)
    saw.run(1.5 - INSTANT)
    assert saw.slave == near(600.0, 500.0 - x, 0.0)
    saw.run(1.5 - ramp).run(0.5 * ramp)
    assert saw.slave[1:] == near(500.0 - 0.5 * x, 500.0)


def test_a_preferred_constant_velocity_with_ramps_at_the_jerk_limit() -> None:
    """With T_a = T_b = sqrt(6 x / 1000) the equation 3 x - x sqrt(6 x / 1000) = 300 is solved by bisection here."""
    low, high = 0.0, 200.0
    for _ in range(200):
        x = 0.5 * (low + high)
        low, high = (x, high) if 3.0 * x - x * math.sqrt(0.006 * x) < 300.0 else (low, x)
    machine = {"max_acceleration": 500.0, "max_deceleration": 500.0, "max_jerk": 1000.0, "t": 3.0}
    saw = meeting(500.0, 500.0, 1200.0, "prefer_constant_velocity", "check_max_jerk", **machine)
    assert profile(saw) == ProfileKind.P5_P1_P5
    result = saw.block.characteristics
    assert (result.slave_velocity_min, result.slave_jerk_max, result.slave_jerk_min) == near(500.0 - x, 1000.0, -1000.0)


def test_a_preferred_constant_velocity_that_is_none_or_breaks_a_check_gives_way() -> None:
    modes = ("prefer_constant_velocity",)
    slow = {"max_acceleration": 100.0, "max_deceleration": 100.0, "t": 3.0}
    assert profile(meeting(500.0, 500.0, 1200.0, *modes, **slow)) == ProfileKind.P5  # 3 x - 0.015 x^2 <= 150
    fast = {"max_acceleration": 500.0, "max_deceleration": 500.0, "t": 3.0}
    assert profile(meeting(100.0, 500.0, 1000.0, *modes, **fast)) == ProfileKind.P5_P1_P5
    # from 500 to 500 a slower constant velocity undershoots, and so does the quintic
    undershot = meeting(500.0, 500.0, 1200.0, *modes, "check_undershoot_velocity", **fast)
    assert undershot["gear_in_pos.error_id"] == 0x4381


@pytest.mark.parametrize("acceleration", [1.0, -1.0])
def test_an_accelerated_master_leaves_only_the_quintic(acceleration: float) -> None:
    """The command acts at the second step's beginning, at -500: a0 = 0, so the profile starts with -v0 a_m / v_m."""
    for modes, kind, code in [
        (VELOCITY_CHECKS, ProfileKind.NONE, 0x42DF),
        (("prefer_constant_velocity",), ProfileKind.P5, 0),
        ((*VELOCITY_CHECKS, "ignore_master_acceleration"), ProfileKind.P5_P1, 0),
    ]:
        saw = first_example().modes(*modes).give("gear_in_pos", **FIRST).run(0.1, acceleration=acceleration)
        assert (saw["gear_in_pos.error_id"], saw["characteristics.profile"]) == (code, kind)
        if kind == ProfileKind.P5:
            assert saw["characteristics.slave_acceleration_start"] == near(-250.0 * acceleration / 500.0)


@given(st.floats(1e-4, 10.0), st.floats(1e-3, 0.1), st.booleans(), st.floats(-2.0, 2.0), st.integers(0, 2))
def test_an_acceleration_within_the_resolution_of_an_encoder_does_not_count(
    counts: float, cycle: float, sampled: bool, share: float, planned: int
) -> None:
    """Up to below 2 q / c^2 in whatever makes a plan: an edge, the start distance, the master that comes forwards anew.
    c is master.sample_time, whatever the step, or else the step. What counts makes a profile start with
    -v0 a_m / v_m; the slave follows the true master, and a plan in time takes its true acceleration."""
    assume(abs(abs(share) - 1.0) > 1e-6)
    acceleration = share * 2.0 * counts / cycle**2
    assume(abs(acceleration) < 1e5)
    step = cycle if not sampled else 0.37 * cycle
    short = min(step, 1e-3 / (1.0 + abs(acceleration)))  # hardly anything changes up to where it is planned
    assume(sampled or planned == 0)
    assume(planned > 0 or 1000.0 + acceleration * step > 0.0)  # it does not come back to where the profile starts
    values = {"master.encoder_scaling": counts, "master.sample_time": cycle if sampled else 0.0}
    saw = FlyingSawHarness({**values, "axis.initial_velocity": 250.0}, master_position=-500.0, speed=500.0)
    saw.modes("ignore_slave_acceleration")  # the halt that planning anew ends has one
    if planned == 0:
        saw.give("gear_in_velo", ratio_numerator=2.0).run(step, acceleration=acceleration)
    elif planned == 1:
        aims = {"master_sync_position": 1000.0, "slave_sync_position": 900.0}
        saw.give("gear_in_pos", **aims, master_start_distance=1500.0 - 1e-6).run(short, acceleration=acceleration)
    else:
        saw.give("gear_in_pos", master_sync_position=1000.0, slave_sync_position=900.0).run(INSTANT)
        saw.master_position = -501.0
        assert saw.run(INSTANT).state == State.PREPHASE
        saw.master_position, saw.speed = -500.0 - 1e-6, 500.0
        saw.run(short, acceleration=acceleration)
    assert saw.state in (State.SYNCHRONIZING, State.SYNCHRON)
    result = saw.block.characteristics
    expected = -result.slave_velocity_start * acceleration / result.master_velocity_nominal
    assert result.slave_acceleration_start == near(0.0 if abs(share) < 1.0 else expected)


def test_a_ramp_in_time_takes_the_true_acceleration_of_an_encoder() -> None:
    """From 0 to 100 with a_m = 100, as without an encoder (test_time_based.py): in sync after 0.211667 s."""
    duration = 0.1 + 19.5 / 900.0 + 0.09
    saw = FlyingSawHarness({"master.encoder_scaling": 1e3}, speed=100.0).modes("time_based")
    saw.give("gear_in_velo", acceleration=1000.0, jerk=10000.0).run(duration - 1e-6, acceleration=100.0)
    assert saw.state == State.SYNCHRONIZING
    assert saw.run(2e-6, acceleration=100.0).state == State.SYNCHRON


def test_the_slave_follows_the_true_acceleration_of_an_encoder() -> None:
    """Example 1 at the edge: a = 250 / 500 * 30, although 30 does not count up to 2 * 0.0016 / 0.01^2 = 32."""
    for counts, kind, acceleration in [(0.0016, ProfileKind.P5_P1, 15.0), (0.0014, ProfileKind.NONE, 0.0)]:
        saw = first_example(**{"master.encoder_scaling": counts, "master.sample_time": 0.01}).modes(*VELOCITY_CHECKS)
        saw.give("gear_in_pos", **FIRST).run(INSTANT, acceleration=30.0)
        assert (saw["characteristics.profile"], saw["gear_in_pos.error_id"]) == (kind, 0 if kind else 0x42DF)
        assert saw.slave[2] == near(acceleration, tolerance=1e-3)


def test_an_accelerated_slave_leaves_only_the_quintic_unless_ignored() -> None:
    for modes, kind, acceleration in [
        (("prefer_constant_velocity",), ProfileKind.P5, 100.0),
        (("prefer_constant_velocity", "ignore_slave_acceleration"), ProfileKind.P5_P1_P5, 0.0),
        (("ignore_slave_acceleration",), ProfileKind.P5, 0.0),
    ]:
        saw = FlyingSawHarness({"axis.max_jerk": 1000.0}, speed=200.0).give("move_velocity", velocity=200.0).run(0.1)
        assert saw.slave == near(1 / 6, 5.0, 100.0)
        saw.modes(*modes).give("gear_in_pos", master_sync_position=400.0, slave_sync_position=250.0).run(INSTANT)
        assert profile(saw) == kind
        assert saw["characteristics.slave_acceleration_start"] == near(acceleration)
        assert saw.slave[2] == pytest.approx(acceleration, abs=5.0)


def test_an_acceleration_that_changes_the_velocity_by_less_than_1e_9_is_none() -> None:
    """With T = 3 s and v_m = 500 that is |a_m| up to 500e-9 / 3."""
    for acceleration, kind in [(1.6e-7, ProfileKind.P5_P1), (1.7e-7, ProfileKind.NONE)]:
        saw = first_example().modes(*VELOCITY_CHECKS).give("gear_in_pos", **FIRST)
        assert saw.run(0.1, acceleration=acceleration)["characteristics.profile"] == kind
