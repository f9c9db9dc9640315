"""What is refused, why, and that a refused command leaves everything else as it is."""

import math
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.flying_saw.faults import Refusal
from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from motionsync_fmu.interface.stepper import RefusedError
from tests.model.flying_saw.harness import (
    AIMS,
    INSTANT,
    FlyingSawHarness,
    assert_refused,
    coupled,
    meeting,
    moving,
    near,
    under_way,
)


def standing_master(saw: FlyingSawHarness) -> FlyingSawHarness:
    saw.speed = 0.0
    return saw


ANY_MOTION = pytest.mark.parametrize("begin", [moving, under_way, coupled])


@ANY_MOTION
@pytest.mark.parametrize("group", ["gear_in_velo", "gear_in_pos"])
@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"ratio_numerator": 0.0}, 0x425B),
        ({"ratio_numerator": math.inf}, 0x425B),
        ({"ratio_numerator": math.nan}, 0x425B),
        ({"ratio_numerator": 1e-300}, 0x425B),
        ({"ratio_numerator": -1e-50}, 0x425B),
        ({"ratio_numerator": 0.99e-12}, 0x425B),
        ({"ratio_numerator": -1.01e12}, 0x425B),
        ({"ratio_denominator": 0}, 0x425B),
        ({"ratio_denominator": -3}, 0x425B),
        ({"velocity": -1.0}, 0x42DD),
        ({"acceleration": -1.0}, 0x42DD),
        ({"deceleration": -1.0}, 0x42DD),
        ({"jerk": -1.0}, 0x42DD),
        ({"jerk": math.inf}, 0x42DD),
        ({"velocity": -1.0, "ratio_denominator": 0}, 0x425B),
    ],
)
def test_wrong_factors_and_limits(begin: Any, group: str, values: dict[str, Any], code: int) -> None:
    assert_refused(begin(), group, code, **((AIMS if group == "gear_in_pos" else {}) | values))


@pytest.mark.parametrize("numerator", [1e-12, -1e-12, 1e12, -1e12])
def test_the_whole_range_of_the_numerator_is_accepted(numerator: float) -> None:
    """The master is at rest, so the slave is in sync at once."""
    saw = FlyingSawHarness().give("gear_in_velo", ratio_numerator=numerator).run(0.1)
    assert (saw.results("gear_in_velo"), saw["coupling_factor"]) == ({"start_sync", "in_sync"}, numerator)


@ANY_MOTION
@pytest.mark.parametrize(
    ("group", "values", "code"),
    [
        *((group, {name: -1.0}, 0x42DD) for group in ("halt", "stop") for name in ("deceleration", "jerk")),
        *(
            (group, {name: -1.0}, 0x42DD)
            for group in ("move_velocity", "move_absolute")
            for name in ("acceleration", "deceleration", "jerk")
        ),
        ("move_absolute", {"velocity": -1.0}, 0x42DD),
        ("move_velocity", {"velocity": 2000.5}, 0x42DD),
        ("move_velocity", {"velocity": -2000.5}, 0x42DD),
        ("move_absolute", {"position": -1.1e9}, 0x4372),
        ("move_absolute", {"position": 1.1e9}, 0x4373),
    ],
)
def test_wrong_values_of_own_motions(begin: Any, group: str, values: dict[str, Any], code: int) -> None:
    assert_refused(begin(), group, code, **values)


WRONG_MACHINE_DATA = [
    (name, value)
    for name in ("max_velocity", "max_acceleration", "max_deceleration", "max_jerk")
    for value in (0.0, -1.0, math.nan, math.inf)
    if (name, value) != ("max_deceleration", 0.0)  # this one means: as the acceleration
]


@pytest.mark.parametrize(("name", "value"), WRONG_MACHINE_DATA)
def test_wrong_machine_data_are_checked_by_the_commands_that_read_them(name: str, value: float) -> None:
    saw = moving().set({"axis.max_deceleration": 1e4, f"axis.{name}": value})
    limit = name.removeprefix("max_")
    for group, values in [("gear_in_velo", {}), ("gear_in_pos", AIMS), ("move_absolute", {"position": 5.0})]:
        assert_refused(saw, group, 0x42DD, **values)
        accepted = saw.twin().give(group, **values, **{limit: 200.0}).run(INSTANT)
        assert not accepted["error"]
    if limit in ("deceleration", "jerk"):
        assert_refused(saw, "halt", 0x42DD)
        assert_refused(saw, "stop", 0x42DD)
    assert saw.set({f"axis.{name}": 1e4}).give("halt").run(INSTANT).results("halt") == {"busy", "active"}


def test_a_limit_of_0_is_the_axis_s_and_one_above_it_is_used_as_given() -> None:
    """The ramp takes 1.5 dv / a with dv = 100: 0.3 s with the axis's 500, 0.075 s with 2000."""
    for limit, duration in [(0.0, 0.3), (250.0, 0.6), (2000.0, 0.075)]:
        saw = FlyingSawHarness({"axis.max_acceleration": 500.0}, speed=100.0).give("gear_in_velo", acceleration=limit)
        assert saw.run(duration - 1e-6).state == State.SYNCHRONIZING
        assert saw.run(2e-6).state == State.SYNCHRON
    saw = FlyingSawHarness({"axis.max_velocity": 90.0}, speed=100.0).modes("check_max_velocity")
    assert_refused(saw, "gear_in_velo", 0x42DD)
    assert saw.give("gear_in_velo", velocity=110.0).run(INSTANT).state == State.SYNCHRONIZING


def test_a_deceleration_limit_of_0_is_the_acceleration_limit() -> None:
    """From 200 to 100 the ramp takes 1.5 dv / a: 0.3 s with 500, 0.6 s with 250. The first is what it is at first."""
    for values, duration in [({}, 0.3), ({"max_deceleration": 0.0}, 0.3), ({"max_deceleration": 250.0}, 0.6)]:
        machine = {"axis.initial_velocity": 200.0, "axis.max_acceleration": 500.0}
        machine |= {f"axis.{name}": value for name, value in values.items()}
        saw = FlyingSawHarness(machine, speed=100.0).give("gear_in_velo")
        assert saw.run(duration - 1e-6).state == State.SYNCHRONIZING
        assert saw.run(2e-6).state == State.SYNCHRON


def test_end_positions_in_the_wrong_order_refuse_the_initialization() -> None:
    with pytest.raises(RefusedError, match=r"axis.min_position = 10, axis.max_position = 9\.5") as caught:
        FlyingSawHarness({"axis.min_position": 10.0, "axis.max_position": 9.5})
    assert caught.value.refusal == Refusal.END_POSITIONS
    assert FlyingSawHarness({"axis.min_position": 10.0, "axis.max_position": 10.0}).state == State.INACTIVE


@ANY_MOTION
def test_time_based_is_for_gear_in_velo_only(begin: Any) -> None:
    assert_refused(begin().modes("time_based"), "gear_in_pos", 0x4289, **AIMS)


@pytest.mark.parametrize("begin", [moving, under_way, coupled])
def test_with_a_standing_master_a_position_is_never_reached(begin: Any) -> None:
    saw = standing_master(begin())
    twin = saw.twin()
    saw.give("gear_in_pos", **AIMS).run(0.01)
    twin.run(0.01)
    assert saw["gear_in_pos.error_id"] == 0x426E
    assert saw.slave == twin.slave


@pytest.mark.parametrize("modes", [(), ("time_based",)])
def test_a_moving_slave_cannot_be_coupled_to_the_velocity_of_a_standing_master(modes: tuple[str, ...]) -> None:
    saw = standing_master(moving()).modes(*modes)
    twin = saw.twin()
    saw.give("gear_in_velo").run(0.01)
    assert saw["gear_in_velo.error_id"] == 0x424A
    assert saw.slave == twin.run(0.01).slave


@pytest.mark.parametrize("modes", [(), ("time_based",)])
def test_both_standing_are_in_sync_at_once(modes: tuple[str, ...]) -> None:
    saw = FlyingSawHarness({"axis.initial_position": 7.0}, master_position=3.0).modes(*modes)
    saw.give("gear_in_velo", ratio_numerator=-2.0).run(INSTANT)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}
    assert saw.block.characteristics.profile == ProfileKind.NONE
    saw.run(1.0, acceleration=10.0)
    assert saw.slave == near(7.0 - 2.0 * 5.0, -20.0, -20.0)


@ANY_MOTION
@pytest.mark.parametrize(
    "values",
    [
        {"master_sync_position": -1.0},
        {"slave_sync_position": -1.0},
        {"master_start_distance": -1.0},
        {"ratio_numerator": -1.0},  # then the slave must go down
    ],
)
def test_sync_positions_lie_ahead(begin: Any, values: dict[str, float]) -> None:
    assert_refused(begin(), "gear_in_pos", 0x42DE, **(AIMS | values))


@pytest.mark.parametrize(
    ("vm", "vs", "distance", "code"),
    [
        *((100.0, 50.0, 20.0, 0), (100.0, 50.0, -20.0, 0x42DE), (100.0, 50.0, 0.0, 0x42DE)),
        *((100.0, -50.0, -20.0, 0), (100.0, -50.0, 20.0, 0x42DE)),
        *((-100.0, -50.0, -20.0, 0), (-100.0, -50.0, 20.0, 0x42DE)),
        *((-100.0, 50.0, 20.0, 0), (-100.0, 50.0, -20.0, 0x42DE)),
    ],
)
def test_ahead_is_where_the_coupling_leads(vm: float, vs: float, distance: float, code: int) -> None:
    saw = meeting(0.0, vs, distance, vm=vm)
    assert saw["gear_in_pos.error_id"] == code


@ANY_MOTION
@pytest.mark.parametrize(
    ("group", "values"),
    [
        *(("gear_in_velo", {}), ("gear_in_pos", AIMS), ("gear_out", {}), ("halt", {})),
        *(("move_velocity", {}), ("move_absolute", {"position": 5.0})),
    ],
)
def test_stop_locks_the_axis(begin: Any, group: str, values: dict[str, Any]) -> None:
    assert_refused(begin().give("stop", deceleration=100.0).run(INSTANT), group, 0x42EF, **values)


@pytest.mark.parametrize(
    ("group", "values", "modes", "speed", "code"),
    [
        # two faults each: the one that is looked for first
        ("gear_in_pos", {"ratio_numerator": 0.0, "jerk": -1.0}, ("time_based",), 100.0, 0x425B),
        ("gear_in_pos", {"jerk": -1.0}, ("time_based",), 100.0, 0x42DD),
        ("gear_in_pos", {"ratio_numerator": 30.0}, ("time_based", "check_max_velocity"), 100.0, 0x42DD),
        ("gear_in_pos", {}, ("time_based",), 0.0, 0x4289),
        ("gear_in_pos", {"master_sync_position": -1.0}, (), 0.0, 0x426E),
        ("gear_in_pos", {"master_start_distance": -1.0}, (), 0.0, 0x426E),
        ("gear_in_pos", {"jerk": -1.0}, (), 0.0, 0x42DD),
        ("gear_in_velo", {"jerk": -1.0}, (), 0.0, 0x42DD),
        ("gear_in_pos", {"slave_sync_position": -1.0, "acceleration": 1e-3}, ("check_max_acceleration",), 1.0, 0x42DE),
        ("gear_in_pos", {"master_sync_position": -1.0, "velocity": 1.0}, ("check_max_velocity",), 100.0, 0x42DD),
        ("move_absolute", {"position": 2e9, "jerk": -1.0}, (), 100.0, 0x42DD),
    ],
)
def test_of_two_faults_the_first_in_the_list_is_shown(
    group: str, values: dict[str, Any], modes: tuple[str, ...], speed: float, code: int
) -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": 20.0}, speed=speed).modes(*modes, "detailed_error_codes")
    values = (AIMS if group == "gear_in_pos" else {}) | values
    assert saw.twin().give(group, **values).run(INSTANT)[f"{group}.error_id"] == code
    locked = saw.give("stop", deceleration=1.0).run(INSTANT).give(group, **values).run(INSTANT)
    assert locked[f"{group}.error_id"] == 0x42EF


ROWS = [
    # code, v0, v_s, distance, master velocity, check, what else; T = 1 s
    (0x4372, -100.0, 300.0, 200.0, 100.0, "check_min_position", {"min_position": -10.0}),
    (0x4373, 0.0, 100.0, 50.0, 100.0, "check_max_position", {"max_position": 49.0}),
    (0x4376, -2000.0, -100.0, -100.0, -100.0, "check_undershoot_position", {}),
    (0x4377, -100.0, 100.0, 20.0, 100.0, "check_undershoot_position", {}),
    (0x4378, 100.0, -100.0, -20.0, -100.0, "check_overshoot_position", {}),
    (0x4379, 2000.0, 100.0, 100.0, 100.0, "check_overshoot_position", {}),
    (0x437A, 0.0, 400.0, 700.0, 100.0, "check_max_velocity", {"max_velocity": 500.0}),
    (0x437B, 0.0, -400.0, -700.0, 100.0, "check_max_velocity", {"max_velocity": 500.0}),
    (0x437C, 0.0, 500.0, 700.0, 100.0, "check_overshoot_velocity", {}),
    (0x437D, 600.0, 500.0, 700.0, 100.0, "check_overshoot_velocity", {}),
    (0x437E, 0.0, -500.0, -700.0, 100.0, "check_overshoot_velocity", {}),
    (0x437F, -600.0, -500.0, -700.0, 100.0, "check_overshoot_velocity", {}),
    (0x4380, 600.0, 500.0, 400.0, 100.0, "check_undershoot_velocity", {}),
    (0x4381, 400.0, 500.0, 200.0, 100.0, "check_undershoot_velocity", {}),
    (0x4382, -600.0, -500.0, -400.0, 100.0, "check_undershoot_velocity", {}),
    (0x4383, -400.0, -500.0, -200.0, 100.0, "check_undershoot_velocity", {}),
    (0x4384, 0.0, 500.0, 250.0, 100.0, "check_overshoot_velocity_zero", {}),
    (0x4385, 0.0, 500.0, 250.0, -100.0, "check_overshoot_velocity_zero", {}),
    (0x4386, 0.0, 500.0, 100.0, 100.0, "check_undershoot_velocity_zero", {}),
    (0x4387, 0.0, 500.0, 100.0, -100.0, "check_undershoot_velocity_zero", {}),
    (0x4386, 0.0, -500.0, -100.0, 100.0, "check_undershoot_velocity_zero", {}),
    (
        0x4386,
        -250.0,
        750.0,
        300.0,
        100.0,
        "check_undershoot_velocity_zero",
        {},
    ),  # it starts against the synchronous one
    (0x4387, 100.0, -500.0, -200.0, -100.0, "check_undershoot_velocity_zero", {}),
    # P5 from 100 to 200 with distance 150: a = 600 u (1 - u), 150 at most; j = 600 (1 - 2 u)
    (0x4388, 100.0, 200.0, 150.0, 100.0, "check_max_acceleration", {"max_acceleration": 149.9}),
    (0x4388, -100.0, -200.0, -150.0, 100.0, "check_max_acceleration", {"max_acceleration": 149.9}),
    (0x4389, 200.0, 100.0, 150.0, 100.0, "check_max_deceleration", {"max_deceleration": 149.9}),
    (0x438A, 100.0, 200.0, 150.0, 100.0, "check_max_jerk", {"max_jerk": 599.9}),
    # j = 6 c3 + 24 c4 u + 60 c5 u^2 with c3 -800, c4 700, c5 -200: from -4800 up to 1080
    (0x438B, 0.0, -200.0, -200.0, 100.0, "check_max_jerk", {"max_jerk": 4799.0}),
]


@pytest.mark.parametrize(("code", "v0", "vs", "distance", "vm", "check", "machine"), ROWS)
def test_broken_checks_and_their_codes(
    code: int, v0: float, vs: float, distance: float, vm: float, check: str, machine: dict[str, float]
) -> None:
    saw = FlyingSawHarness({"axis.initial_velocity": v0, **{f"axis.{k}": x for k, x in machine.items()}}, speed=vm)
    aims = {"master_sync_position": vm, "slave_sync_position": distance, "ratio_numerator": vs / vm}
    free = saw.twin().modes().give("gear_in_pos", **aims).run(INSTANT)
    assert free.state == State.SYNCHRONIZING  # unchecked
    assert_refused(saw.twin().modes(check), "gear_in_pos", 0x42DF, **aims)
    assert_refused(saw.modes(check, "detailed_error_codes"), "gear_in_pos", code, **aims)


@pytest.mark.parametrize(
    ("v0", "vs", "distance", "vm", "check", "machine"),
    [
        # nothing is broken where the limit is just kept, or the case is another one's
        (-100.0, 100.0, 20.0, 100.0, "check_overshoot_position", {}),
        (100.0, -100.0, -20.0, -100.0, "check_undershoot_position", {}),
        (0.0, -500.0, -250.0, 100.0, "check_overshoot_velocity_zero", {}),
        (0.0, -500.0, -250.0, -100.0, "check_overshoot_velocity_zero", {}),
        (250.0, 750.0, 500.0, 100.0, "check_undershoot_velocity_zero", {}),
        (-250.0, -750.0, -500.0, 100.0, "check_undershoot_velocity_zero", {}),
        (0.0, -500.0, -250.0, 100.0, "check_undershoot_velocity_zero", {}),
        (100.0, 200.0, 150.0, 100.0, "check_max_acceleration", {"max_acceleration": 150.0}),
        (200.0, 100.0, 150.0, 100.0, "check_max_acceleration", {"max_acceleration": 1.0}),
        (200.0, 100.0, 150.0, 100.0, "check_max_deceleration", {"max_deceleration": 150.0}),
        (100.0, 200.0, 150.0, 100.0, "check_max_deceleration", {"max_deceleration": 1.0}),
        (100.0, 200.0, 150.0, 100.0, "check_max_jerk", {"max_jerk": 600.0}),
        (0.0, 100.0, 50.0, 100.0, "check_max_position", {"max_position": 50.0}),
        (0.0, 100.0, 50.0, 100.0, "check_min_position", {"min_position": 0.0}),
        (0.0, 100.0, 50.0, 100.0, "check_max_velocity", {"max_velocity": 100.0}),
    ],
)
def test_checks_that_are_kept(
    v0: float, vs: float, distance: float, vm: float, check: str, machine: dict[str, float]
) -> None:
    assert meeting(v0, vs, distance, check, vm=vm, **machine).state == State.SYNCHRONIZING


@given(
    st.floats(-500.0, 500.0),
    st.floats(10.0, 500.0),
    st.sampled_from([1.0, -1.0]),
    st.sampled_from([100.0, -70.0]),
    st.sampled_from([("gear_in_velo",), ("gear_in_velo", "time_based"), ("gear_in_pos",)]),
)
def test_a_velocity_against_the_synchronous_one_is_refused_wherever_it_is(
    v0: float, speed: float, side: float, vm: float, command: tuple[str, ...]
) -> None:
    """A slave that is free of acceleration goes from v0 to vs without leaving what is between them: by gear_in_velo of
    both kinds, and by gear_in_pos if it asks for the mean of both (P5 is 3 u^2 - 2 u^3 then). So its velocity is
    against vs if v0 is. The mean has to lead forwards: gear_in_pos is left out where it does not."""
    vs = side * speed
    group, *modes = command
    saw = FlyingSawHarness({"axis.initial_velocity": v0}, speed=vm)
    saw.modes(*modes, "check_undershoot_velocity_zero", "detailed_error_codes")
    aims = {"master_sync_position": vm, "slave_sync_position": 0.5 * (v0 + vs)} if group == "gear_in_pos" else {}
    assume(group == "gear_in_velo" or (v0 + vs) * side > 1e-3)
    assume(v0 == 0.0 or abs(v0) > 1e-3)
    saw.give(group, ratio_numerator=vs / vm, **aims).run(INSTANT)
    code = 0x4386 if vm > 0.0 else 0x4387
    assert saw[f"{group}.error_id"] == (code if v0 * vs < 0.0 else 0)


def test_of_several_broken_checks_the_lowest_code_is_shown() -> None:
    """The velocity goes from -100 to 300: below the start, below zero, with 1500 u/s2 and more."""
    modes = ["check_max_jerk", "check_max_acceleration", "check_undershoot_position", "check_min_position"]
    for code, machine in [(0x438A, 3), (0x4388, 2), (0x4377, 1), (0x4372, 0)]:
        active = modes[: 4 - machine]
        limits = {"min_position": -1.0, "max_acceleration": 10.0, "max_jerk": 10.0}
        assert meeting(-100.0, 300.0, 200.0, *active, **limits)["gear_in_pos.error_id"] == code


def test_checks_of_gear_in_velo_are_those_of_its_ramp() -> None:
    """From -100 to 100 with 300: T = 1 s, v = -100 + 200 (3 u^2 - 2 u^3); the slave goes to -31.25 and back to 0."""
    for check, code, machine in [
        ("check_min_position", 0x4372, {"axis.min_position": -31.2}),
        ("check_undershoot_position", 0x4377, {}),
        ("check_overshoot_velocity_zero", 0x4384, {}),
    ]:
        saw = FlyingSawHarness({"axis.initial_velocity": -100.0, **machine}, speed=100.0).modes(
            check, "detailed_error_codes"
        )
        if code != 0x4377:
            assert_refused(saw, "gear_in_velo", code, acceleration=300.0, deceleration=300.0)
        else:  # the slave ends where it has begun, but for rounding: below both or below the start
            saw.give("gear_in_velo", acceleration=300.0, deceleration=300.0).run(INSTANT)
            assert saw["gear_in_velo.error_id"] in (0x4376, 0x4377)
    saw = FlyingSawHarness({"axis.initial_velocity": -100.0, "axis.min_position": -31.3}, speed=100.0).modes(
        "check_min_position"
    )
    assert not saw.give("gear_in_velo", acceleration=300.0, deceleration=300.0).run(INSTANT)["error"]
