"""The FlyingSaw, rule by rule with numbers by hand: its profiles, its commands, its errors, its states."""

import math
from itertools import pairwise
from typing import Any

import pytest
from numpy.polynomial import Polynomial

from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.master import MasterInput
from tests.model.flying_saw.harness import GROUPS, OUTPUTS, Saw
from tests.support.harness import grid

START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
INSTANT = 2.0**-20  # s, a step in which hardly anything moves
VELOCITY_CHECKS = ("check_overshoot_velocity", "check_undershoot_velocity")


def near(*values: float, tolerance: float = 1e-9) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def first_example(**values: Any) -> Saw:
    """TS5055, section 4, example 1: T = 3 s, D = 1250, v0 = 250, v_s = 500; not yet ordered."""
    initial = {"axis.initial_position": -250.0, "axis.initial_velocity": 250.0}
    limits = {f"axis.max_{name}": value for name, value in [("acceleration", 2500.0), ("deceleration", 2500.0)]}
    return Saw({**initial, **limits, "axis.max_jerk": 5000.0, **values}, place=-500.0, speed=500.0)


def second_example(**values: Any) -> Saw:
    """Example 2: T = 3 s, D = 1000, v0 = -250, v_s = 750; not yet ordered."""
    initial = {"axis.initial_position": -500.0, "axis.initial_velocity": -250.0}
    return Saw({**initial, "axis.max_jerk": 50000.0, **values}, place=-500.0, speed=500.0)


FIRST: dict[str, float] = {"master_sync_position": 1000.0, "slave_sync_position": 1000.0}
SECOND: dict[str, float] = {"ratio_numerator": 1.5, "master_sync_position": 1000.0, "slave_sync_position": 500.0}


def meeting(  # T = 1 s unless said otherwise; both at 0 at first
    v0: float, vs: float, way: float, *modes: str, vm: float = 100.0, t: float = 1.0, **values: Any
) -> Saw:
    """gear_in_pos given to a slave at 0 with v0, for `way` and `vs` at its end; the master comes from 0 with `vm`."""
    machine = {f"axis.{name}": value for name, value in values.items()}
    saw = Saw({"axis.initial_velocity": v0, **machine}, speed=vm).modes("detailed_error_codes", *modes)
    ratio = {"ratio_numerator": vs / vm}
    return saw.order("gear_in_pos", master_sync_position=vm * t, slave_sync_position=way, **ratio).run(INSTANT)


def standing_master(saw: Saw) -> Saw:
    saw.speed = 0.0
    return saw


# --- known results ----------------------------------------------------------------------------------------------------


def values_of(curve: Polynomial, duration: float) -> tuple[float, float]:
    """Extremes of a polynomial of u in [0, 1]."""
    places = [0.0, 1.0, *(r.real for r in curve.deriv().roots() if abs(r.imag) < 1e-9 and 0.0 < r.real < 1.0)]
    return min(curve(places)), max(curve(places))


@pytest.mark.parametrize(
    ("example", "aims", "curve", "velocity", "acceleration", "jerk", "lowest"),
    [
        # c3 = 10 A - 4 B ..., A = D - v0 T, B = (v_s - v0) T: A 500, B 750; A 1750, B 3000
        (
            *(first_example, FIRST, [-250.0, 750.0, 0.0, 2000.0, -2250.0, 750.0]),
            *((250.0, 506.0), (-15.04601, 175.04601), (-155.556, 444.444), -250.0),
        ),
        (
            *(second_example, SECOND, [-500.0, -750.0, 0.0, 5500.0, -5250.0, 1500.0]),
            *((-250.0, 750.0), (0.0, 568.755), (-411.111, 1222.222), -620.638),
        ),
    ],
)
def test_a_quintic_and_all_its_characteristic_values(
    example: Any, aims: Any, curve: Any, velocity: Any, acceleration: Any, jerk: Any, lowest: float
) -> None:
    saw = example().order("gear_in_pos", **aims).run(1.0)
    found = saw.block.characteristics
    t = 3.0
    s = Polynomial(curve)
    v, a, j = s.deriv() / t, s.deriv(2) / t**2, s.deriv(3) / t**3
    assert found.profile == ProfileKind.P5
    assert saw.slave == near(s(1 / 3), v(1 / 3), a(1 / 3))
    assert saw["slave.jerk"] == near(j(1 / 3))
    assert (found.slave_velocity_min, found.slave_velocity_max) == pytest.approx(velocity, abs=5e-3)
    assert (found.slave_acceleration_min, found.slave_acceleration_max) == pytest.approx(acceleration, abs=5e-4)
    assert (found.slave_jerk_min, found.slave_jerk_max) == pytest.approx(jerk, abs=5e-4)
    assert found.slave_position_min == pytest.approx(lowest, abs=5e-4)
    for name, of in [("position", s), ("velocity", v), ("acceleration", a), ("jerk", j)]:
        low, high = values_of(of, t)
        assert getattr(found, f"slave_{name}_min") == near(low, tolerance=1e-8)
        assert getattr(found, f"slave_{name}_max") == near(high)
    for name, of in [("position", s), ("velocity", v), ("acceleration", a)]:
        for side in ("min", "max"):
            at = (getattr(found, f"master_position_at_slave_{name}_{side}") + 500.0) / 1500.0
            assert of(at) == near(getattr(found, f"slave_{name}_{side}"), tolerance=1e-6)
            if name == "acceleration":
                assert getattr(found, f"slave_velocity_at_slave_acceleration_{side}") == near(v(at), tolerance=1e-6)
    power = values_of(v * a, t)
    assert (found.slave_dynamic_momentum_min, found.slave_dynamic_momentum_max) == near(*power)
    zeros = sorted({0.0, 1.0, *(r.real for r in v.roots() if abs(r.imag) < 1e-9 and 0.0 < r.real < 1.0)})
    ways = [abs(s(last) - s(first)) for first, last in pairwise(zeros)]
    assert found.slave_velocity_mean == near(sum(ways) / t)
    square = (a * a).integ()
    assert found.slave_acceleration_effective == near(math.sqrt(square(1.0) - square(0.0)))
    assert (found.master_velocity_nominal, found.master_position_start, found.master_position_end) == near(
        500.0, -500.0, 1000.0
    )
    assert (found.slave_position_start, found.slave_velocity_start, found.slave_acceleration_start) == near(
        s(0.0), v(0.0), 0.0
    )
    assert (found.slave_position_end, found.slave_velocity_end, found.slave_acceleration_end) == near(
        s(1.0), v(1.0), 0.0
    )
    assert (found.slave_jerk_start, found.slave_jerk_end) == near(j(0.0), j(1.0))


@pytest.mark.parametrize(
    ("example", "aims", "duration", "change", "peak", "jerk"),
    [(first_example, FIRST, 2.0, 250.0, 187.5, 375.0), (second_example, SECOND, 2.5, 1000.0, 600.0, 960.0)],
)
def test_with_velocity_checks_a_ramp_and_then_the_synchronous_velocity(
    example: Any, aims: Any, duration: float, change: float, peak: float, jerk: float
) -> None:
    saw = example().modes(*VELOCITY_CHECKS).order("gear_in_pos", **aims)
    s0, v0 = saw["axis.initial_position"], saw["axis.initial_velocity"]
    saw.run(0.5 * duration)
    found = saw.block.characteristics
    assert found.profile == ProfileKind.P5_P1
    assert saw.slave == near(s0 + duration * (0.5 * v0 + change * (1 / 8 - 1 / 32)), v0 + 0.5 * change, peak)
    assert found.slave_acceleration_max == near(peak)
    assert (found.slave_jerk_min, found.slave_jerk_max) == near(-jerk, jerk)
    assert found.slave_acceleration_effective == near(change * math.sqrt(1.2 / duration / 3.0))
    saw.run(0.5 * duration).run(0.5 * (3.0 - duration))
    assert saw.state == State.SYNCHRONIZING
    assert saw.slave[1:] == near(v0 + change, 0.0)
    saw.run(0.5 * (3.0 - duration) + INSTANT)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(aims["slave_sync_position"] + (v0 + change) * INSTANT, v0 + change, 0.0)


@pytest.mark.parametrize(("modes", "duration"), [((), 0.45), (("check_max_jerk",), math.sqrt(0.9))])
def test_to_the_master_s_velocity_as_fast_as_acceleration_and_jerk_allow(
    modes: tuple[str, ...], duration: float
) -> None:
    """Section 3, example 1: from -250 to 500 with 2500/2500/5000."""
    saw = Saw({"axis.initial_velocity": -250.0}, speed=500.0).modes(*modes)
    saw.order("gear_in_velo", acceleration=2500.0, deceleration=2500.0, jerk=5000.0).run(duration - 1e-6)
    assert saw.state == State.SYNCHRONIZING
    found = saw.block.characteristics
    assert (found.profile, found.slave_acceleration_max) == (ProfileKind.P5, near(1.5 * 750.0 / duration))
    assert found.slave_jerk_max == near(6.0 * 750.0 / duration**2)
    assert (found.master_position_end, found.slave_position_end) == near(500.0 * duration, 125.0 * duration)
    saw.run(2e-6)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(125.0 * duration + 500e-6, 500.0, 0.0, tolerance=1e-8)


def test_cuts_of_the_same_length_again_and_again() -> None:
    """Pieces of 1000; the saw meets each mark at 100, saws 0.3 s, returns, and is ordered anew on the way back."""
    length, x = 1000.0, 100.0
    saw = Saw(speed=500.0)
    saw.order("gear_in_pos", master_sync_position=x, slave_sync_position=x).run(0.2 + INSTANT)
    for n in range(20):
        assert saw.state == State.SYNCHRON
        for _ in range(3):
            assert saw.place - saw.slave[0] == pytest.approx(n * length, abs=1e-9 * max(n, 1))
            saw.run(0.1)
        saw.release("gear_in_pos").order("move_absolute", position=0.0).run(0.35)
        assert 0.0 < saw.slave[0] < x
        assert saw.slave[1] < 0.0
        saw.release("move_absolute")
        saw.order("gear_in_pos", master_sync_position=(n + 1) * length + x, slave_sync_position=x).run(INSTANT)
        assert saw.state == State.SYNCHRONIZING
        saw.run((n + 1) * 2.0 + 0.2 + (n + 2) * INSTANT - saw.time)
    assert saw.state == State.SYNCHRON


# --- refusals ---------------------------------------------------------------------------------------------------------


def refused(saw: Saw, group: str, code: int, **values: Any) -> Saw:
    """The command is refused; but for the errors and what is told of the plan all is as without it, to the last bit.
    An earlier edge of the same block goes on unseen."""
    twin = saw.twin()
    saw.order(group, **values)
    for acceleration in (0.0, 30.0):
        saw.run(0.02, acceleration=acceleration)
        twin.run(0.02, acceleration=acceleration)
        assert saw.results(group) == {"error"}
        assert (saw[f"{group}.error_id"], saw["error"], saw["error_id"]) == (code, True, code)
        for name in OUTPUTS:
            if not name.startswith((f"{group}.", "error", "local.plan_")):
                assert repr(saw[name]) == repr(twin[name]), name
    saw.release(group).run(INSTANT)
    assert saw.results(group) == set()
    assert (saw[f"{group}.error_id"], saw["error"], saw["error_id"]) == (0, True, code)
    return saw


def moving() -> Saw:
    """The slave at constant velocity, the master ahead of nothing."""
    return Saw({"axis.initial_velocity": 20.0}, speed=100.0).run(0.1)


def under_way() -> Saw:
    """gear_in_velo synchronizes it for 0.15 s."""
    saw = Saw(speed=100.0).order("gear_in_velo", acceleration=1000.0).run(0.03).release()
    assert saw.run(INSTANT).state == State.SYNCHRONIZING
    return saw


def coupled() -> Saw:
    saw = under_way().run(0.5)
    assert saw.state == State.SYNCHRON
    return saw


AIMS: dict[str, Any] = {"master_sync_position": 1000.0, "slave_sync_position": 700.0}
ANY_MOTION = pytest.mark.parametrize("begin", [moving, under_way, coupled])


@ANY_MOTION
@pytest.mark.parametrize("group", ["gear_in_velo", "gear_in_pos"])
@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"ratio_numerator": 0.0}, 0x425B),
        ({"ratio_numerator": math.inf}, 0x425B),
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
    refused(begin(), group, code, **((AIMS if group == "gear_in_pos" else {}) | values))


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
    refused(begin(), group, code, **values)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("name", ["max_velocity", "max_acceleration", "max_deceleration", "max_jerk"])
def test_wrong_machine_data_are_judged_by_the_commands_that_read_them(name: str, value: float) -> None:
    saw = moving().put({f"axis.{name}": value})
    limit = name.removeprefix("max_")
    for group, values in [("gear_in_velo", {}), ("gear_in_pos", AIMS), ("move_absolute", {"position": 5.0})]:
        refused(saw, group, 0x42DD, **values)
        accepted = saw.twin().order(group, **values, **{limit: 200.0}).run(INSTANT)
        assert not accepted["error"]
    if limit in ("deceleration", "jerk"):
        refused(saw, "halt", 0x42DD)
        refused(saw, "stop", 0x42DD)
    assert saw.put({f"axis.{name}": 1e4}).order("halt").run(INSTANT).results("halt") == {"busy", "active"}


def test_a_limit_of_0_is_the_axis_s_and_one_above_it_is_used_as_given() -> None:
    """Ramp times 1.5 dv / a with dv = 100: of the axis's 500 0.3 s, of 2000 0.075 s."""
    for limit, duration in [(0.0, 0.3), (250.0, 0.6), (2000.0, 0.075)]:
        saw = Saw({"axis.max_acceleration": 500.0}, speed=100.0).order("gear_in_velo", acceleration=limit)
        assert saw.run(duration - 1e-6).state == State.SYNCHRONIZING
        assert saw.run(2e-6).state == State.SYNCHRON
    saw = Saw({"axis.max_velocity": 90.0}, speed=100.0).modes("check_max_velocity")
    refused(saw, "gear_in_velo", 0x42DD)
    assert saw.order("gear_in_velo", velocity=110.0).run(INSTANT).state == State.SYNCHRONIZING


@ANY_MOTION
def test_time_based_is_for_gear_in_velo_only(begin: Any) -> None:
    refused(begin().modes("time_based"), "gear_in_pos", 0x4289, **AIMS)


@pytest.mark.parametrize("begin", [moving, under_way, coupled])
def test_with_a_standing_master_a_position_is_never_reached(begin: Any) -> None:
    saw = standing_master(begin())
    twin = saw.twin()
    saw.order("gear_in_pos", **AIMS).run(0.01)
    twin.run(0.01)
    assert saw["gear_in_pos.error_id"] == 0x426E
    assert saw.slave == twin.slave


@pytest.mark.parametrize("modes", [(), ("time_based",)])
def test_a_moving_slave_cannot_be_coupled_to_the_velocity_of_a_standing_master(modes: tuple[str, ...]) -> None:
    saw = standing_master(moving()).modes(*modes)
    twin = saw.twin()
    saw.order("gear_in_velo").run(0.01)
    assert saw["gear_in_velo.error_id"] == 0x424A
    assert saw.slave == twin.run(0.01).slave


@pytest.mark.parametrize("modes", [(), ("time_based",)])
def test_both_standing_are_in_sync_at_once(modes: tuple[str, ...]) -> None:
    saw = Saw({"axis.initial_position": 7.0}, place=3.0).modes(*modes)
    saw.order("gear_in_velo", ratio_numerator=-2.0).run(INSTANT)
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
    refused(begin(), "gear_in_pos", 0x42DE, **(AIMS | values))


@pytest.mark.parametrize(
    ("vm", "vs", "way", "code"),
    [
        *((100.0, 50.0, 20.0, 0), (100.0, 50.0, -20.0, 0x42DE), (100.0, 50.0, 0.0, 0x42DE)),
        *((100.0, -50.0, -20.0, 0), (100.0, -50.0, 20.0, 0x42DE)),
        *((-100.0, -50.0, -20.0, 0), (-100.0, -50.0, 20.0, 0x42DE)),
        *((-100.0, 50.0, 20.0, 0), (-100.0, 50.0, -20.0, 0x42DE)),
    ],
)
def test_ahead_is_where_the_coupling_leads(vm: float, vs: float, way: float, code: int) -> None:
    saw = meeting(0.0, vs, way, vm=vm)
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
    refused(begin().order("stop", deceleration=100.0).run(INSTANT), group, 0x42EF, **values)


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
def test_of_two_faults_the_first_in_the_list_is_told(
    group: str, values: dict[str, Any], modes: tuple[str, ...], speed: float, code: int
) -> None:
    saw = Saw({"axis.initial_velocity": 20.0}, speed=speed).modes(*modes, "detailed_error_codes")
    values = (AIMS if group == "gear_in_pos" else {}) | values
    assert saw.twin().order(group, **values).run(INSTANT)[f"{group}.error_id"] == code
    locked = saw.order("stop", deceleration=1.0).run(INSTANT).order(group, **values).run(INSTANT)
    assert locked[f"{group}.error_id"] == 0x42EF


ROWS = [
    # code, v0, v_s, way, master velocity, check, what else; T = 1 s
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
    # P5 from 100 to 200 with way 150: a = 600 u (1 - u), 150 at most; j = 600 (1 - 2 u)
    (0x4388, 100.0, 200.0, 150.0, 100.0, "check_max_acceleration", {"max_acceleration": 149.9}),
    (0x4388, -100.0, -200.0, -150.0, 100.0, "check_max_acceleration", {"max_acceleration": 149.9}),
    (0x4389, 200.0, 100.0, 150.0, 100.0, "check_max_deceleration", {"max_deceleration": 149.9}),
    (0x438A, 100.0, 200.0, 150.0, 100.0, "check_max_jerk", {"max_jerk": 599.9}),
    # j = 6 c3 + 24 c4 u + 60 c5 u^2 with c3 -800, c4 700, c5 -200: from -4800 up to 1080
    (0x438B, 0.0, -200.0, -200.0, 100.0, "check_max_jerk", {"max_jerk": 4799.0}),
]


@pytest.mark.parametrize(("code", "v0", "vs", "way", "vm", "check", "machine"), ROWS)
def test_broken_checks_and_their_codes(
    code: int, v0: float, vs: float, way: float, vm: float, check: str, machine: dict[str, float]
) -> None:
    saw = Saw({"axis.initial_velocity": v0, **{f"axis.{k}": x for k, x in machine.items()}}, speed=vm)
    aims = {"master_sync_position": vm, "slave_sync_position": way, "ratio_numerator": vs / vm}
    free = saw.twin().order("gear_in_pos", **aims).run(INSTANT)
    assert free.state == State.SYNCHRONIZING  # unchecked
    refused(saw.twin().modes(check), "gear_in_pos", 0x42DF, **aims)
    refused(saw.modes(check, "detailed_error_codes"), "gear_in_pos", code, **aims)


@pytest.mark.parametrize(
    ("v0", "vs", "way", "vm", "check", "machine"),
    [
        # nothing is broken where the limit is just kept, or the case is another one's
        (-100.0, 100.0, 20.0, 100.0, "check_overshoot_position", {}),
        (100.0, -100.0, -20.0, -100.0, "check_undershoot_position", {}),
        (0.0, -500.0, -250.0, 100.0, "check_overshoot_velocity_zero", {}),
        (0.0, -500.0, -250.0, -100.0, "check_overshoot_velocity_zero", {}),
        (-250.0, 750.0, 300.0, 100.0, "check_undershoot_velocity_zero", {}),  # begins below zero
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
    v0: float, vs: float, way: float, vm: float, check: str, machine: dict[str, float]
) -> None:
    assert meeting(v0, vs, way, check, vm=vm, **machine).state == State.SYNCHRONIZING


def test_of_several_broken_checks_the_lowest_code_is_told() -> None:
    """From -100 with 300 at its end: below its start, below zero, up to 1500 u/s2 and more."""
    modes = ["check_max_jerk", "check_max_acceleration", "check_undershoot_position", "check_min_position"]
    for code, machine in [(0x438A, 3), (0x4388, 2), (0x4377, 1), (0x4372, 0)]:
        active = modes[: 4 - machine]
        limits = {"min_position": -1.0, "max_acceleration": 10.0, "max_jerk": 10.0}
        assert meeting(-100.0, 300.0, 200.0, *active, **limits)["gear_in_pos.error_id"] == code


@pytest.mark.parametrize("modes", [(), ("check_max_jerk",)])
def test_a_velocity_so_low_that_no_time_can_be_told_is_refused(modes: tuple[str, ...]) -> None:
    """The ramp to it would take 8e-322 u/s / 1e4 u/s2: 0 s, as a number."""
    saw = Saw(speed=-5e-324).modes(*modes)
    saw.order("gear_in_velo", ratio_numerator=-161.0, jerk=100.0).run(0.05)
    assert saw.results("gear_in_velo") == {"error"}
    assert saw["gear_in_velo.error_id"] == 0x42DE


def test_checks_of_gear_in_velo_are_those_of_its_ramp() -> None:
    """From -100 to 100 with 300: T = 1 s, v = -100 + 200 (3 u^2 - 2 u^3), down to -31.25 and back to 0."""
    for check, code, machine in [
        ("check_min_position", 0x4372, {"axis.min_position": -31.2}),
        ("check_undershoot_position", 0x4377, {}),
        ("check_overshoot_velocity_zero", 0x4384, {}),
    ]:
        saw = Saw({"axis.initial_velocity": -100.0, **machine}, speed=100.0).modes(check, "detailed_error_codes")
        if code != 0x4377:
            refused(saw, "gear_in_velo", code, acceleration=300.0, deceleration=300.0)
        else:  # the slave ends where it has begun, but for rounding: below both or below the start
            saw.order("gear_in_velo", acceleration=300.0, deceleration=300.0).run(INSTANT)
            assert saw["gear_in_velo.error_id"] in (0x4376, 0x4377)
    saw = Saw({"axis.initial_velocity": -100.0, "axis.min_position": -31.3}, speed=100.0).modes("check_min_position")
    assert not saw.order("gear_in_velo", acceleration=300.0, deceleration=300.0).run(INSTANT)["error"]


# --- choice of the profile --------------------------------------------------------------------------------------------


def profile(saw: Saw) -> ProfileKind:
    assert not saw["error"]
    kind: ProfileKind = saw["characteristics.profile"]
    return kind


def test_the_start_velocity_is_kept_first_if_the_mean_is_nearer_to_it() -> None:
    """Mean 150 of 100 and 300: T5 = 2 (150 - 100) / 200 = 0.5 s."""
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


@pytest.mark.parametrize("mean", [100.0, 99.0, 300.0, 301.0])
def test_no_ramp_leads_to_a_mean_velocity_at_or_beyond_those_of_the_ends(mean: float) -> None:
    saw = meeting(100.0, 300.0, mean, "check_overshoot_velocity", "check_undershoot_velocity")
    assert saw["gear_in_pos.error_id"] in (0x437C, 0x4381)
    assert profile(meeting(100.0, 300.0, mean)) == ProfileKind.P5


@pytest.mark.parametrize(("check", "limit"), [("acceleration", 187.4), ("jerk", 374.9)])
def test_a_ramp_that_breaks_a_steepness_limit_gives_way_to_the_quintic(check: str, limit: float) -> None:
    """Example 1: the ramp has 187.5 and 375, the quintic 175.04 and 444.4; this overshoots, but does not undershoot."""
    for active, code in [(VELOCITY_CHECKS, 0x437C), (VELOCITY_CHECKS[1:], 0x438A if check == "jerk" else 0)]:
        saw = first_example().modes(f"check_max_{check}", *active, "detailed_error_codes")
        saw.order("gear_in_pos", **FIRST, **{check: limit}).run(INSTANT)
        assert saw["gear_in_pos.error_id"] == code
        assert code != 0 or profile(saw) == ProfileKind.P5
    saw = first_example().modes(f"check_max_{check}", *VELOCITY_CHECKS)
    saw.order("gear_in_pos", **FIRST, **{check: 187.5 if check == "acceleration" else 375.0}).run(INSTANT)
    assert profile(saw) == ProfileKind.P5_P1


def test_a_ramp_that_breaks_another_check_is_refused() -> None:
    saw = first_example(**{"axis.max_position": 999.0}).modes("check_max_position", *VELOCITY_CHECKS)
    refused(saw, "gear_in_pos", 0x42DF, **FIRST)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_the_velocity_limit_where_the_quintic_exceeds_it(sign: float) -> None:
    """T = 2, D = 900, from 0 to 500: up to 601; at 510 peaks of 0.75 (510^2 + 10^2) / (1020 - 900) = 1626.25."""
    c, peak = 510.0, 0.75 * (510.0**2 + 10.0**2) / 120.0
    rise, fall = 1.5 * c / peak, 1.5 * 10.0 / peak
    saw = meeting(0.0, sign * 500.0, sign * 900.0, "check_max_velocity", vm=sign * 100.0, t=2.0, max_velocity=c)
    assert profile(saw) == ProfileKind.P5_P1_P5
    found = saw.block.characteristics
    fastest = found.slave_velocity_max if sign > 0.0 else -found.slave_velocity_min
    side = "max" if sign > 0.0 else "min"  # of equal values the place is the first one's
    assert saw[f"characteristics.master_position_at_slave_velocity_{side}"] == near(sign * 100.0 * rise)
    assert (fastest, found.slave_acceleration_max, found.slave_acceleration_min) == near(c, peak, -peak)
    assert (found.slave_jerk_max, found.slave_jerk_min) == near(6 * 10.0 / fall**2, -6 * 10.0 / fall**2)
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
    """500 at both ends, way 1200 in 3 s, a 500: x = 500 - c, 3 x - 0.003 x^2 = 300."""
    x = (3.0 - math.sqrt(5.4)) / 0.006
    ramp = 1.5 * x / 500.0
    machine = {"max_acceleration": 500.0, "max_deceleration": 500.0, "max_jerk": 1000.0, "t": 3.0}
    saw = meeting(500.0, 500.0, 1200.0, "prefer_constant_velocity", **machine)
    assert profile(saw) == ProfileKind.P5_P1_P5
    found = saw.block.characteristics
    assert (found.slave_velocity_min, found.slave_acceleration_min) == near(500.0 - x, -500.0)
    saw.run(1.5 - INSTANT)
    assert saw.slave == near(600.0, 500.0 - x, 0.0)
    saw.run(1.5 - ramp).run(0.5 * ramp)
    assert saw.slave[1:] == near(500.0 - 0.5 * x, 500.0)


def test_a_preferred_constant_velocity_with_ramps_at_the_jerk_limit() -> None:
    """With T_a = T_b = sqrt(6 x / 1000): 3 x - x sqrt(6 x / 1000) = 300; bracketed here."""
    low, high = 0.0, 200.0
    for _ in range(200):
        x = 0.5 * (low + high)
        low, high = (x, high) if 3.0 * x - x * math.sqrt(0.006 * x) < 300.0 else (low, x)
    machine = {"max_acceleration": 500.0, "max_deceleration": 500.0, "max_jerk": 1000.0, "t": 3.0}
    saw = meeting(500.0, 500.0, 1200.0, "prefer_constant_velocity", "check_max_jerk", **machine)
    assert profile(saw) == ProfileKind.P5_P1_P5
    found = saw.block.characteristics
    assert (found.slave_velocity_min, found.slave_jerk_max, found.slave_jerk_min) == near(500.0 - x, 1000.0, -1000.0)


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
    """Given at the beginning of the second step, at -500 again: from a0 = 0 and thus ~a0 = -v0 a_m / v_m."""
    for modes, kind, code in [
        (VELOCITY_CHECKS, ProfileKind.NONE, 0x42DF),
        (("prefer_constant_velocity",), ProfileKind.P5, 0),
        ((*VELOCITY_CHECKS, "ignore_master_acceleration"), ProfileKind.P5_P1, 0),
    ]:
        saw = first_example().modes(*modes).order("gear_in_pos", **FIRST).run(0.1, acceleration=acceleration)
        assert (saw["gear_in_pos.error_id"], saw["characteristics.profile"]) == (code, kind)
        if kind == ProfileKind.P5:
            assert saw["characteristics.slave_acceleration_start"] == near(-250.0 * acceleration / 500.0)


def test_an_accelerated_slave_leaves_only_the_quintic_unless_ignored() -> None:
    for modes, kind, acceleration in [
        (("prefer_constant_velocity",), ProfileKind.P5, 100.0),
        (("prefer_constant_velocity", "ignore_slave_acceleration"), ProfileKind.P5_P1_P5, 0.0),
        (("ignore_slave_acceleration",), ProfileKind.P5, 0.0),
    ]:
        saw = Saw({"axis.max_jerk": 1000.0}, speed=200.0).order("move_velocity", velocity=200.0).run(0.1)
        assert saw.slave == near(1 / 6, 5.0, 100.0)
        saw.modes(*modes).order("gear_in_pos", master_sync_position=400.0, slave_sync_position=250.0).run(INSTANT)
        assert profile(saw) == kind
        assert saw["characteristics.slave_acceleration_start"] == near(acceleration)
        assert saw.slave[2] == pytest.approx(acceleration, abs=5.0)


def test_an_acceleration_that_changes_the_velocity_by_less_than_1e_9_is_none() -> None:
    """T = 3 s, v_m = 500: |a_m| up to 500e-9 / 3."""
    for acceleration, kind in [(1.6e-7, ProfileKind.P5_P1), (1.7e-7, ProfileKind.NONE)]:
        saw = first_example().modes(*VELOCITY_CHECKS).order("gear_in_pos", **FIRST)
        assert saw.run(0.1, acceleration=acceleration)["characteristics.profile"] == kind


# --- start distance ---------------------------------------------------------------------------------------------------


def waiting(sign: float = 1.0, **values: Any) -> Saw:
    """The master from 0 with 100 to 1000; the slave is to start 300 before, at 700, and meets it at 150."""
    saw = Saw({"axis.initial_position": 0.0, **values}, speed=sign * 100.0)
    aims = {"master_sync_position": sign * 1000.0, "slave_sync_position": sign * 150.0, "ratio_numerator": 0.5}
    return saw.order("gear_in_pos", **aims, master_start_distance=300.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_slave_waits_for_the_start_distance(sign: float) -> None:
    """From 0 to 150 in 3 s with 50 at its end: the quintic with A = B = 150."""
    saw = waiting(sign).run(7.0 - INSTANT)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") == {"busy", "active"}
    assert (saw["plcopen_state"], saw["coupled"]) == (PlcopenState.SYNCHRONIZED_MOTION, True)
    assert saw.slave == (0.0, 0.0, 0.0)
    saw.run(1.5)
    assert saw.state == State.SYNCHRONIZING
    assert saw.results("gear_in_pos") == {"start_sync", "busy", "active"}
    curve = Polynomial([0.0, 0.0, 0.0, 6.0, -8.0, 3.0]) * 150.0 * sign
    u = 0.5 - INSTANT / 3.0
    assert saw.slave == near(curve(u), curve.deriv()(u) / 3.0, curve.deriv(2)(u) / 9.0)
    assert saw["characteristics.master_position_start"] == near(sign * 700.0)
    saw.run(2.0 + INSTANT)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(sign * 175.0, sign * 50.0, 0.0))


def test_a_start_already_passed_is_now() -> None:
    saw = waiting()
    saw.place = 800.0
    assert saw.run(0.5).state == State.SYNCHRONIZING
    assert saw["characteristics.master_position_start"] == near(800.0)
    assert saw.run(2.0).slave[0] == near(150.0 + 0.5 * 50.0)


def test_only_forwards_the_start_is_passed() -> None:
    """Up to 650 at 0 + 6.5 s, back, and up again."""
    saw = waiting().run(6.5)
    saw.speed = -100.0
    saw.run(8.0)
    saw.speed = 50.0
    assert saw.run(16.9).state == State.PREPHASE
    assert saw.run(0.2).state == State.SYNCHRONIZING
    assert saw["characteristics.master_velocity_nominal"] == near(50.0)
    saw.run(7.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(150.0 + 0.5 * (saw.place - 1000.0), 25.0, 0.0))


def test_meanwhile_the_slave_s_own_motion_goes_on() -> None:
    saw = waiting(**{"axis.max_jerk": 1000.0, "axis.max_acceleration": 100.0}).release("gear_in_pos")
    twin = saw.twin()
    for each in (saw, twin):
        each.order("move_absolute", position=60.0, velocity=30.0).run(1.0)
    saw.put({"gear_in_pos.execute": True}).run(1.0)
    assert saw.results("move_absolute") == {"command_aborted"}
    assert saw.slave == twin.run(1.0).slave
    assert saw.run(3.0).state == State.PREPHASE
    assert saw.slave == twin.run(3.0).slave == (60.0, 0.0, 0.0)


@pytest.mark.parametrize("group", ["gear_out", "halt", "stop"])
def test_the_waiting_is_cancelled(group: str) -> None:
    saw = waiting(**{"axis.initial_velocity": 5.0}).run(2.0)
    twin = Saw({"axis.initial_velocity": 5.0}).run(2.0)
    for each in (saw, twin):
        each.order(group, **({} if group == "gear_out" else {"deceleration": 20.0})).run(0.125)
    assert saw.results("gear_in_pos") == {"command_aborted"}
    assert saw.slave == twin.slave
    assert saw.run(20.0).slave == twin.run(20.0).slave
    assert saw.state == twin.state == (State.CONSTANT_VELOCITY if group == "gear_out" else State.INACTIVE)


def test_a_start_that_is_refused_when_it_comes() -> None:
    """At 30 u/s the slave has passed 150 by then."""
    saw = waiting(**{"axis.initial_velocity": 30.0}).run(6.9)
    assert saw.results("gear_in_pos") == {"busy", "active"}
    saw.run(0.2)
    assert saw.results("gear_in_pos") == {"error"}
    assert (saw["gear_in_pos.error_id"], saw["error_id"]) == (0x42DE, 0x42DE)
    assert (saw.state, saw.slave) == (State.CONSTANT_VELOCITY, near(213.0, 30.0, 0.0))


def test_the_values_are_those_of_the_edge_when_the_start_comes() -> None:
    saw = waiting().run(1.0).modes("check_max_acceleration")
    saw.put({"gear_in_pos.slave_sync_position": 1.0, "gear_in_pos.ratio_numerator": 9.0, "axis.max_acceleration": 1.0})
    saw.run(10.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(200.0, 50.0, 0.0))


@pytest.mark.parametrize(("position", "code"), [(400.0, 0), (20.0, 0x42DE)])
def test_a_coupled_slave_waits_for_the_start_distance_too(position: float, code: int) -> None:
    """In sync with 100 from 0.3 s on; the start comes 2 s later, where the slave has passed 20 already."""
    saw = coupled()
    aims = {"master_sync_position": saw.place + 500.0, "slave_sync_position": position}
    saw.order("gear_in_pos", **aims, master_start_distance=300.0).run(1.9)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") == {"busy", "active"}
    assert saw.results("gear_in_velo") == {"command_aborted"}  # in this step
    before = saw.slave[0]
    saw.run(0.2)
    assert saw["gear_in_pos.error_id"] == code
    if code:
        assert (saw.state, saw.slave) == (State.CONSTANT_VELOCITY, near(before + 20.0, 100.0, 0.0))
    else:
        assert saw.run(3.0).results("gear_in_pos") == {"start_sync", "in_sync"}
        assert saw.slave == near(400.0 + 10.0, 100.0, 0.0)


# --- reversal of the master -------------------------------------------------------------------------------------------


def turned_back(*modes: str, sync: bool = False, v0: float = 250.0, back: float = -300.0, **values: Any) -> Saw:
    """Example 1, in sync or not, then backwards with a constant velocity just up to the coupling position -500."""
    saw = first_example(**{"axis.initial_velocity": v0, **values}).modes(*modes)
    saw.order("gear_in_pos", **FIRST).run(3.5 if sync else 1.0)
    saw.speed = back
    return saw.run((saw.place + 500.0) / -back)


def test_in_sync_without_the_lock_the_slave_runs_back_too() -> None:
    for modes in [(), ("instant_stop_on_rollback",)]:
        saw = turned_back(*modes, sync=True).run(1.0)
        assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
        assert (saw.state, saw.slave) == (State.SYNCHRON, near(-800.0, -300.0, 0.0))


HALT = 1.5 * 150.0 / 2500.0  # from -150 to 0


@pytest.mark.parametrize("modes", [(), ("rollback_lock",)])
def test_not_in_sync_the_slave_halts_along_a_ramp_in_time(modes: tuple[str, ...]) -> None:
    """At -250 with -150, half the master's velocity; T = 1.5 * 150 / 2500, half of 150 T further on it stands."""
    saw = turned_back(*modes)
    assert saw.slave == near(-250.0, -150.0, 0.0)
    assert saw.state == State.SYNCHRONIZING
    saw.run(0.5 * HALT)
    assert saw.state == State.PREPHASE
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert saw.slave == near(-250.0 - HALT * (75.0 - 150.0 * (1 / 8 - 1 / 32)), -75.0, 2500.0)
    saw.run(0.6 * HALT)
    assert saw.slave == near(-250.0 - 75.0 * HALT, 0.0, 0.0)
    assert (saw.state, saw["in_sync"], saw["coupled"]) == (State.PREPHASE, False, True)
    assert saw["plcopen_state"] == PlcopenState.SYNCHRONIZED_MOTION


def test_the_halt_keeps_the_jerk_limit_if_it_is_checked() -> None:
    """T = sqrt(6 * 150 / 5000) = 0.424 s."""
    halt = math.sqrt(0.18)
    saw = turned_back("check_max_jerk").run(0.5 * halt)
    assert saw.slave[1:] == near(-75.0, 225.0 / halt)
    assert saw.run(0.51 * halt).slave == near(-250.0 - 75.0 * halt, 0.0, 0.0)


@pytest.mark.parametrize("modes", [("instant_stop_on_rollback",), ("rollback_lock", "instant_stop_on_rollback")])
def test_not_in_sync_with_the_instant_stop_the_slave_stands_at_once(modes: tuple[str, ...]) -> None:
    saw = turned_back(*modes).run(0.25)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(-250.0, 0.0, 0.0))
    assert saw.results("gear_in_pos") >= {"busy", "active"}


def test_in_sync_the_backstop_halts_along_a_ramp_in_time() -> None:
    """The line lies at -500 where the synchronisation started; T = 1.5 * 300 / 2500."""
    saw = turned_back("rollback_lock", sync=True)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(-500.0, -300.0, 0.0))
    saw.run(0.09)
    assert (saw.state, saw.slave[1:]) == (State.PREPHASE, near(-150.0, 2500.0))
    assert "in_sync" not in saw.results("gear_in_pos")
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert saw.run(0.1).slave == near(-500.0 - 27.0, 0.0, 0.0)


def test_in_sync_the_backstop_with_the_instant_stop() -> None:
    saw = turned_back("rollback_lock", "instant_stop_on_rollback", sync=True).run(0.25)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(-500.0, 0.0, 0.0))
    assert saw.results("gear_in_pos") >= {"busy", "active"}
    assert not saw["in_sync"]


@pytest.mark.parametrize("modes", [(), ("rollback_lock",), ("instant_stop_on_rollback",)])
def test_forwards_again_the_synchronisation_is_planned_anew(modes: tuple[str, ...]) -> None:
    """Parked it meets the master at 1000/1000 again; and the coupling position stays where it was."""
    saw = turned_back(*modes).run(1.0)
    rest = saw.slave[0]
    saw.speed = 600.0
    assert saw.run(0.5).state == State.PREPHASE  # at the coupling position
    saw.run(0.01)
    assert saw.state == State.SYNCHRONIZING
    found = saw.block.characteristics
    assert (found.master_velocity_nominal, found.master_position_start, found.master_position_end) == near(
        600.0, -500.0, 1000.0
    )
    assert (found.slave_position_start, found.slave_velocity_start, found.slave_velocity_end) == near(rest, 0.0, 600.0)
    saw.run(2.49 + INSTANT)
    assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
    assert saw.slave == near(1000.0 + 600.0 * INSTANT, 600.0, 0.0)
    saw.speed = -600.0
    saw.run(2.5 + 2 * INSTANT + 0.1)
    assert saw.state == (State.PREPHASE if "rollback_lock" in modes else State.SYNCHRON)


def test_forwards_again_even_in_the_halt() -> None:
    """Half through the halt the master jumps to +300, is back at once, and the plan starts with -75 and 2500."""
    saw = turned_back().run(0.5 * HALT)
    position = saw.slave[0]
    saw.place, saw.speed = -499.0, 300.0  # the seam passes the coupling position
    saw.run(INSTANT)
    found = saw.block.characteristics
    assert saw.state == State.SYNCHRONIZING
    assert (found.slave_position_start, found.slave_velocity_start) == near(position, -75.0)
    assert found.slave_acceleration_start == near(2500.0)
    saw.run(1499.0 / 300.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(300.0, 0.0))


@pytest.mark.parametrize("in_halt", [False, True])
def test_a_refused_new_plan_leaves_the_axis_uncoupled_and_standing(in_halt: bool) -> None:
    """At 600 the limit of 550 is broken already by the synchronous velocity. What is left of a halt is no faster."""
    saw = turned_back("check_max_velocity", **{"axis.max_velocity": 550.0}).run(0.5 * HALT if in_halt else 1.0)
    saw.place, saw.speed = -500.0, 600.0
    fastest = abs(saw.slave[1])
    for _ in range(100):
        assert abs(saw.run(0.005).slave[1]) <= fastest
    assert saw.results("gear_in_pos") == {"error"}
    assert (saw["gear_in_pos.error_id"], saw["error_id"], saw["coupled"]) == (0x42DD, 0x42DD, False)
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)
    assert saw.slave[1:] == (0.0, 0.0)
    saw.release("gear_in_pos").order("move_absolute", position=0.0).run(5.0)
    assert saw.slave == (0.0, 0.0, 0.0)


def test_gear_in_velo_is_planned_anew_too() -> None:
    """From -100 to 100 with 400: 0.75 s; after 0.15 s back past 0 with v = v0 v_m' / v_m = 50 -> halted with 400."""
    saw = Saw({"axis.initial_velocity": -100.0}, speed=100.0)
    saw.order("gear_in_velo", acceleration=400.0, deceleration=400.0).run(0.15)
    saw.speed = -50.0
    saw.run(0.3)
    assert (saw.state, saw.slave) == (State.SYNCHRONIZING, near(0.0, 50.0, 0.0))
    saw.run(1.0)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(25.0 * 1.5 * 50.0 / 400.0, 0.0, 0.0))
    saw.speed = 200.0
    assert saw.run(0.25 + 0.75 - INSTANT).state == State.SYNCHRONIZING
    assert saw.run(2 * INSTANT).state == State.SYNCHRON
    assert saw.slave[1:] == near(200.0, 0.0)


def test_gear_in_velo_may_be_refused_when_planned_anew() -> None:
    saw = Saw(speed=100.0).modes("check_max_velocity").order("gear_in_velo", velocity=150.0, acceleration=100.0)
    saw.run(0.1).speed = -100.0
    assert saw.run(0.5).state == State.PREPHASE
    saw.speed = 200.0
    saw.run(1.0)
    assert (saw.results("gear_in_velo"), saw["error_id"]) == ({"error"}, 0x42DD)
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_coupling_to_a_standing_master_takes_its_direction_from_the_first_motion(sign: float) -> None:
    saw = Saw(place=5.0).modes("rollback_lock", "instant_stop_on_rollback").order("gear_in_velo").run(1.0)
    saw.speed = sign * 10.0
    saw.run(1.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(sign * 10.0, sign * 10.0, 0.0))
    saw.speed = -sign * 10.0
    saw.run(1.5)
    assert (saw.state, saw.slave) == (State.PREPHASE, near(0.0, 0.0, 0.0))
    assert saw.results("gear_in_velo") >= {"busy", "active"}
    saw.speed = sign * 10.0
    saw.run(1.5)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}


# --- stop -------------------------------------------------------------------------------------------------------------


def stopping(**values: Any) -> Saw:
    """From 100 with 1000 and 10000: the triangle of 0.2 s and 10 u."""
    saw = Saw({"axis.initial_velocity": 100.0, **values}, speed=100.0)
    return saw.order("stop", deceleration=1000.0, jerk=10000.0)


def test_stop_leads_to_rest_and_locks_until_execute_is_false() -> None:
    saw = stopping().run(0.1)
    assert (saw.state, saw["plcopen_state"]) == (State.DECELERATING, PlcopenState.STOPPING)
    assert saw.results("stop") == {"busy", "active"}
    assert saw.slave == near(100.0 * 0.1 - 10000.0 * 0.1**3 / 6.0, 50.0, -1000.0)
    saw.run(0.1 + INSTANT)
    assert saw.slave == near(10.0, 0.0, 0.0)
    assert saw.results("stop") == {"done"}
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STOPPING)
    saw.run(5.0)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)
    refused(saw, "move_absolute", 0x42EF, position=5.0)
    saw.release("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == (set(), PlcopenState.STANDSTILL)
    assert saw.order("move_absolute", position=5.0).run(1.0).slave == (5.0, 0.0, 0.0)


def test_the_lock_lasts_until_standstill_though_execute_is_false() -> None:
    saw = stopping().run(0.05).release("stop").run(0.05)
    assert saw.results("stop") == {"busy", "active"}
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    refused(saw, "halt", 0x42EF)
    saw.run(0.2 - saw.time - INSTANT)
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    saw.run(2 * INSTANT)
    assert saw.results("stop") == {"done"}  # for exactly this step
    assert saw["plcopen_state"] == PlcopenState.STANDSTILL
    saw.run(INSTANT)
    assert saw.results("stop") == set()
    assert saw.order("move_velocity", velocity=1.0).run(INSTANT).results("move_velocity") >= {"busy"}


def test_execute_that_falls_with_another_command_s_edge_releases_it() -> None:
    saw = stopping().run(1.0).release("stop").order("move_absolute", position=7.0).run(1.0)
    assert saw.slave == (7.0, 0.0, 0.0)


def test_reset_does_not_release_the_lock_but_clears_the_error() -> None:
    saw = refused(stopping().run(0.05), "halt", 0x42EF).order("reset").run(INSTANT)
    assert (saw["error"], saw["error_id"], saw.results("reset")) == (False, 0, {"done"})
    refused(saw, "halt", 0x42EF)


def test_a_second_stop_edge_is_accepted() -> None:
    """A gentler stop: 0.1 s with jerk 10000, then from 50 with -1000 down with 200."""
    saw = stopping().run(0.1).release("stop").run(INSTANT).order("stop", deceleration=2000.0, jerk=1e6).run(INSTANT)
    assert saw.results("stop") == {"busy", "active"}
    saw.run(0.06)
    assert saw.slave[1:] == (0.0, 0.0)
    assert saw["plcopen_state"] == PlcopenState.STOPPING
    saw.release("stop").run(INSTANT).order("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)


def test_a_stop_at_standstill_is_done_and_locks() -> None:
    saw = Saw().order("stop").run(INSTANT)
    assert (saw.results("stop"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STOPPING)
    refused(saw, "gear_in_velo", 0x42EF)


@pytest.mark.parametrize("group", ["gear_in_velo", "move_velocity", "halt", "move_absolute"])
def test_stop_aborts_what_runs(group: str) -> None:
    saw = Saw({"axis.initial_velocity": 50.0}, speed=100.0)
    saw.order(group, **({"velocity": 30.0} if group == "move_velocity" else {})).run(0.005)
    assert saw.results(group) >= {"busy"}
    saw.order("stop").run(INSTANT)
    assert saw.results(group) == {"command_aborted"}


# --- the axis's own motions -------------------------------------------------------------------------------------------


def test_halt_is_not_locked() -> None:
    saw = Saw({"axis.initial_velocity": 100.0}).order("halt", deceleration=1000.0, jerk=10000.0).run(0.1)
    assert (saw.results("halt"), saw["plcopen_state"]) == ({"busy", "active"}, PlcopenState.DISCRETE_MOTION)
    assert saw.slave == near(10.0 - 10.0 / 6.0, 50.0, -1000.0)
    other = saw.twin().order("move_velocity", velocity=10.0).run(1.0)
    assert (other.results("halt"), other.slave[1:]) == ({"command_aborted"}, (10.0, 0.0))
    saw.run(0.1 + INSTANT)
    assert (saw.results("halt"), saw["plcopen_state"]) == ({"done"}, PlcopenState.STANDSTILL)
    assert saw.slave == near(10.0, 0.0, 0.0)


def test_a_long_halt_keeps_the_deceleration() -> None:
    """From 300 with 1000 and 10000: 0.1 s of jerk, 0.2 s at -1000, 0.1 s of jerk; 300 * 0.4 / 2 u."""
    saw = Saw({"axis.initial_velocity": 300.0}).order("halt", deceleration=1000.0, jerk=10000.0).run(0.2)
    assert saw.slave[1:] == near(150.0, -1000.0)
    assert saw.run(0.2 + INSTANT).slave == near(60.0, 0.0, 0.0)


def test_move_velocity_and_its_result() -> None:
    """100 u/s with 1000 and 10000: 0.2 s and 10 u; then it goes on."""
    saw = Saw().order("move_velocity", velocity=100.0, acceleration=1000.0, jerk=10000.0).run(0.1)
    assert (saw.state, saw["plcopen_state"]) == (State.ACCELERATING, PlcopenState.CONTINUOUS_MOTION)
    assert (saw.results("move_velocity"), saw.slave) == ({"busy", "active"}, near(10.0 / 6.0, 50.0, 1000.0))
    saw.run(0.1 + INSTANT)
    assert (saw.results("move_velocity"), saw.state) == ({"in_velocity"}, State.CONSTANT_VELOCITY)
    saw.run(0.8 - INSTANT)
    assert (saw.slave, saw["plcopen_state"]) == (near(90.0, 100.0, 0.0), PlcopenState.CONTINUOUS_MOTION)
    saw.order("halt").run(INSTANT)
    assert saw.results("move_velocity") == {"command_aborted"}


def test_move_velocity_through_zero_takes_the_lower_limit() -> None:
    """From 100 to -100 with min(4000, 2000) and much jerk: at 2000 0.1 s and a little."""
    saw = Saw({"axis.initial_velocity": 100.0})
    saw.order("move_velocity", velocity=-100.0, acceleration=4000.0, deceleration=2000.0, jerk=1e9).run(0.05)
    assert saw.slave[2] == -2000.0
    saw.run(0.05 + 3e-6)
    assert (saw.slave[1:], saw["slave.position"]) == (near(-100.0, 0.0), pytest.approx(0.0, abs=1e-3))


@pytest.mark.parametrize(("target", "limit"), [(200.0, 4000.0), (50.0, 2000.0)])
def test_faster_takes_the_acceleration_slower_the_deceleration(target: float, limit: float) -> None:
    saw = Saw({"axis.initial_velocity": 100.0})
    saw.order("move_velocity", velocity=target, acceleration=4000.0, deceleration=2000.0, jerk=1e9).run(0.01)
    assert abs(saw.slave[2]) == limit


def test_move_velocity_to_0_is_standstill() -> None:
    saw = Saw({"axis.initial_velocity": 100.0}).order("move_velocity", velocity=0.0).run(1.0)
    assert (saw.results("move_velocity"), saw.state) == ({"in_velocity"}, State.INACTIVE)
    assert saw["plcopen_state"] == PlcopenState.STANDSTILL


def test_the_velocity_limit_itself_is_allowed() -> None:
    for velocity in (2000.0, -2000.0):
        assert Saw().order("move_velocity", velocity=velocity).run(1.0).slave[1:] == (velocity, 0.0)


def test_move_absolute_along_seven_pieces() -> None:
    """v 100, a 1000, j 10000: 0.2 s and 10 u up, 80 u in 0.8 s, the same down."""
    saw = Saw({"axis.initial_position": 5.0})
    saw.order("move_absolute", position=105.0, velocity=100.0, acceleration=1000.0, deceleration=1000.0, jerk=10000.0)
    assert saw.run(0.1).slave == near(5.0 + 10.0 / 6.0, 50.0, 1000.0)
    assert (saw.state, saw["plcopen_state"]) == (State.ACCELERATING, PlcopenState.DISCRETE_MOTION)
    assert saw.run(0.5).slave == near(55.0, 100.0, 0.0)
    assert saw.state == State.CONSTANT_VELOCITY
    assert saw.run(0.5).slave == near(105.0 - 10.0 / 6.0, 50.0, -1000.0)
    assert saw.results("move_absolute") == {"busy", "active"}
    saw.run(0.1 + INSTANT)
    assert (saw.slave, saw.results("move_absolute")) == ((105.0, 0.0, 0.0), {"done"})
    assert (saw.state, saw["plcopen_state"]) == (State.INACTIVE, PlcopenState.STANDSTILL)


def stopped_half() -> Saw:
    return Saw({"axis.initial_velocity": 500.0}, speed=3.0).order("halt").run(0.03)


@pytest.mark.parametrize("begin", [moving, under_way, coupled, stopped_half])
@pytest.mark.parametrize("target", [-300.0, 0.0, 1e-3, 400.0])
def test_move_absolute_ends_just_at_its_target_from_any_motion(begin: Any, target: float) -> None:
    saw = begin().release().order("move_absolute", position=target).run(3.0)
    assert (saw.slave, saw.results("move_absolute")) == ((target, 0.0, 0.0), {"done"})


def test_move_absolute_to_an_end_position_and_not_beyond() -> None:
    saw = Saw({"axis.min_position": -10.0, "axis.max_position": 20.0})
    refused(saw, "move_absolute", 0x4373, position=20.0 + 1e-9)
    refused(saw, "move_absolute", 0x4372, position=-10.0 - 1e-9)
    assert saw.order("move_absolute", position=20.0).run(2.0).slave == (20.0, 0.0, 0.0)
    assert saw.release().run(INSTANT).order("move_absolute", position=-10.0).run(2.0).slave == (-10.0, 0.0, 0.0)


def test_where_it_stands_already_move_absolute_is_done() -> None:
    saw = Saw({"axis.initial_position": 7.0}).order("move_absolute", position=7.0).run(INSTANT)
    assert (saw.results("move_absolute"), saw.slave) == ({"done"}, (7.0, 0.0, 0.0))


# --- uncoupling -------------------------------------------------------------------------------------------------------


def test_gear_out_takes_the_acceleration_away_at_once() -> None:
    saw = under_way()
    position, velocity, acceleration = saw.slave
    assert acceleration > 100.0
    saw.order("gear_out").run(0.5)
    assert saw.results("gear_out") == {"done"}
    assert (saw.state, saw["plcopen_state"]) == (State.CONSTANT_VELOCITY, PlcopenState.CONTINUOUS_MOTION)
    assert saw.slave == near(position + 0.5 * velocity, velocity, 0.0)
    assert saw.run(1000.0).slave == near(position + 1000.5 * velocity, velocity, 0.0)


@pytest.mark.parametrize("sync", [False, True])
@pytest.mark.parametrize("group", ["gear_out", "halt", "stop", "move_velocity", "move_absolute"])
def test_uncoupled_the_gear_in_block_shows_that_it_is_aborted(group: str, sync: bool) -> None:
    saw = Saw(speed=100.0).order("gear_in_velo", acceleration=1000.0).run(1.0 if sync else 0.1)
    assert saw.results("gear_in_velo") == ({"start_sync", "in_sync"} if sync else {"start_sync", "busy", "active"})
    before = saw.slave
    saw.order(group).run(INSTANT)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert (saw["coupled"], saw["in_sync"]) == (False, False)
    assert saw.slave[:2] == near(*before[:2], tolerance=2e-3)
    assert saw.slave[2] == (0.0 if group == "gear_out" else pytest.approx(before[2], abs=0.5))


def test_gear_out_of_an_uncoupled_axis_is_done_and_does_nothing() -> None:
    for begin in (Saw, moving, stopped_half):
        saw = begin()
        twin = saw.twin()
        saw.order("gear_out").run(0.01)
        twin.run(0.01)
        assert saw.results("gear_out") == {"done"}
        assert all(saw[name] == twin[name] for name in OUTPUTS if name != "gear_out.done")
        assert saw.run(1.0).results("gear_out") == {"done"}
        assert saw.release().run(INSTANT).results("gear_out") == set()


def test_a_gear_in_on_a_coupled_axis_plans_anew_from_the_present_motion() -> None:
    """In sync with 100; then from 1 to 2 times the master's velocity with 1.5 * 100 / 1000 = 0.15 s."""
    saw = coupled()
    saw.order("gear_in_velo", ratio_numerator=2.0, acceleration=1000.0).run(0.075)
    assert saw.results("gear_in_velo") == {"start_sync", "busy", "active"}
    assert saw.slave[1:] == near(150.0, 1000.0)
    assert saw["coupling_factor"] == 2.0
    position, _, _ = saw.run(0.075 + INSTANT).slave
    assert saw.slave[1:] == near(200.0, 0.0)
    saw.order("gear_in_pos", master_sync_position=saw.place + 100.0, slave_sync_position=position + 150.0)
    saw.run(1.0 + INSTANT)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert saw.results("gear_in_pos") == {"start_sync", "in_sync"}
    assert saw.slave == near(position + 150.0 + 100.0 * INSTANT, 100.0, 0.0)


# --- several commands -------------------------------------------------------------------------------------------------


def test_simultaneous_edges_act_in_the_documented_order() -> None:
    """The last one, move_absolute, moves the axis; those before it are aborted, gear_out is done."""
    saw = Saw({"axis.initial_velocity": 50.0}, speed=100.0)
    saw.order("halt").order("gear_out").order("gear_in_velo").order("gear_in_pos", **AIMS)
    saw.order("move_velocity", velocity=3.0).order("move_absolute", position=9.0).run(INSTANT)
    shown = {group: saw.results(group) - {"start_sync"} for group in GROUPS}
    assert shown.pop("move_absolute") == {"busy", "active"}
    assert shown.pop("gear_out") == {"done"}
    assert shown.pop("stop") == shown.pop("reset") == set()
    assert all(value == {"command_aborted"} for value in shown.values())
    assert saw.run(2.0).slave == (9.0, 0.0, 0.0)


def test_a_stop_together_with_others_refuses_them() -> None:
    saw = Saw({"axis.initial_velocity": 50.0}, speed=100.0).order("reset").order("stop").order("halt").order("gear_out")
    saw.order("gear_in_velo").order("move_absolute", position=9.0).run(INSTANT)
    assert (saw.results("stop"), saw.results("reset")) == ({"busy", "active"}, {"done"})
    for group in ("halt", "gear_out", "gear_in_velo", "move_absolute"):
        assert (saw.results(group), saw[f"{group}.error_id"]) == ({"error"}, 0x42EF)
    assert saw["error_id"] == 0x42EF


def test_the_first_value_seen_is_no_edge() -> None:
    values = {f"{group}.execute": True for group in GROUPS}
    saw = Saw({"axis.initial_velocity": 50.0, **values}, speed=100.0).run(1.0)
    assert all(saw.results(group) == set() for group in GROUPS)
    assert saw.slave == near(50.0, 50.0, 0.0)


def test_a_result_after_the_falling_edge_is_shown_for_one_step() -> None:
    for group, values, result in [
        ("gear_in_velo", {"acceleration": 1000.0}, "in_sync"),
        ("gear_in_pos", AIMS, "in_sync"),
        ("halt", {}, "done"),
        ("move_velocity", {"velocity": 7.0}, "in_velocity"),
        ("move_absolute", {"position": 7.0}, "done"),
    ]:
        saw = Saw({"axis.initial_velocity": 50.0}, speed=100.0).order(group, **values).run(0.001)
        saw.release().run(0.001)
        assert saw.results(group) - {"start_sync"} == {"busy", "active"}, group
        saw.run(20.0)
        assert saw.results(group) - {"start_sync"} == {result}, group
        saw.run(INSTANT)
        assert saw.results(group) - {"start_sync"} == set(), group


def test_an_abortion_after_the_falling_edge_is_shown_for_one_step() -> None:
    saw = Saw({"axis.initial_velocity": 50.0}).order("move_absolute", position=700.0).run(0.1)
    saw.release().run(0.1).order("halt").run(0.01)
    assert saw.results("move_absolute") == {"command_aborted"}
    assert saw.run(0.01).results("move_absolute") == set()


def test_done_and_error_stay_but_in_sync_and_in_velocity_are_aborted() -> None:
    saw = (
        Saw(speed=100.0).order("move_absolute", position=1.0).run(1.0).order("gear_in_velo", acceleration=1e3).run(1.0)
    )
    assert saw.results("move_absolute") == {"done"}
    saw.order("move_velocity", velocity=-1.0).run(1.0)
    assert saw.results("gear_in_velo") - {"start_sync"} == {"command_aborted"}
    assert saw.results("move_velocity") == {"in_velocity"}
    saw.order("gear_in_pos", **(AIMS | {"slave_sync_position": -1e6})).run(INSTANT)
    assert (saw.results("gear_in_pos"), saw.results("move_velocity")) == ({"error"}, {"in_velocity"})
    saw.order("halt").run(1.0)
    assert (saw.results("gear_in_pos"), saw.results("move_velocity")) == ({"error"}, {"command_aborted"})
    assert (saw.results("move_absolute"), saw.results("halt")) == ({"done"}, {"done"})


def test_errors_last_until_reset_or_the_next_accepted_command() -> None:
    saw = refused(moving(), "gear_in_velo", 0x425B, ratio_numerator=0.0)
    refused(saw, "move_velocity", 0x42DD, velocity=1e9)
    reset = saw.twin().order("reset").run(INSTANT)
    assert (reset["error"], reset["error_id"], reset.results("reset")) == (False, 0, {"done"})
    assert reset.run(INSTANT).results("reset") == {"done"}
    assert reset.release().run(INSTANT).results("reset") == set()
    saw.order("move_velocity", velocity=5.0).run(INSTANT)
    assert (saw["error"], saw["error_id"]) == (False, 0)


def test_reset_aborts_nothing() -> None:
    saw = under_way()
    twin = saw.twin().run(0.01)
    saw.order("reset").run(0.01)
    assert all(saw[name] == twin[name] for name in OUTPUTS if name != "reset.done")


def test_sync_mode_and_values_are_read_at_the_edge() -> None:
    saw = first_example().order("gear_in_pos", **FIRST).run(1.0).modes("check_max_acceleration", "rollback_lock")
    saw.put({"gear_in_pos.slave_sync_position": 0.0, "gear_in_pos.ratio_numerator": 7.0, "gear_in_pos.velocity": 1.0})
    saw.run(3.0)
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(1500.0, 500.0, 0.0))


# --- factor, angle, direction, period, input modes --------------------------------------------------------------------


def test_the_factor_is_numerator_by_denominator_by_the_cosine_of_the_angle() -> None:
    saw = Saw({"diagonal_angle": 60.0}, speed=10.0).order("gear_in_velo", ratio_numerator=-3.0, ratio_denominator=4)
    saw.run(2.0)
    assert saw["coupling_factor"] == near(-1.5, tolerance=1e-15)
    assert saw.slave[1:] == near(-15.0, 0.0)


@pytest.mark.parametrize("ratio", [0.8, -0.8])
@pytest.mark.parametrize("vm", [100.0, -100.0])
def test_in_sync_the_slave_lies_on_its_line(ratio: float, vm: float) -> None:
    """Through (2 v_m, ratio * 2 v_m + 3), however the master moves then."""
    saw = Saw({"axis.initial_position": 3.0}, speed=vm)
    point = 2.0 * vm, ratio * 2.0 * vm * 0.5 + 3.0
    saw.order("gear_in_pos", ratio_numerator=ratio, master_sync_position=point[0], slave_sync_position=point[1])
    saw.run(2.5)
    for acceleration in (0.0, 40.0, -90.0, 250.0):
        saw.run(0.7, acceleration=acceleration)
        expected = point[1] + ratio * (saw.place - point[0])
        assert (saw.state, saw.slave) == (State.SYNCHRON, near(expected, ratio * saw.speed, ratio * acceleration))


@pytest.mark.parametrize(
    ("speed", "position", "ahead"),
    [
        *((10.0, 80.0, 50.0), (10.0, 20.0, 90.0), (10.0, 0.0, 70.0), (10.0, 30.0, 100.0)),
        *((-10.0, 20.0, 10.0), (-10.0, 80.0, 50.0), (-10.0, 0.0, 30.0), (-10.0, 30.0, 100.0)),
        *((10.0, 100.0, 70.0), (10.0, 230.0, 200.0), (-10.0, -30.0, 60.0), (-10.0, -270.0, 300.0)),
    ],
)
def test_with_a_period_a_sync_position_in_it_is_the_next_one_ahead_and_others_are_literal(
    speed: float, position: float, ahead: float
) -> None:
    """The master at 30 of 100; the slave from 0 meets it a quarter of `ahead` further, at its velocity."""
    saw = Saw({"master.period": 100.0}, place=30.0, speed=speed)
    aims = {"master_sync_position": position, "slave_sync_position": 0.25 * math.copysign(ahead, speed)}
    saw.order("gear_in_pos", **aims).run(ahead / 10.0 - 1e-3)
    assert saw.state == State.SYNCHRONIZING
    saw.run(2e-3)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(0.25 * math.copysign(ahead, speed) + 1e-3 * speed, speed, 0.0)
    for _ in range(30):
        saw.run(1.7)
    whole = 51.0 + 1e-3
    assert saw.slave[0] == near(0.25 * math.copysign(ahead, speed) + whole * speed)  # never wrapped


@pytest.mark.parametrize(("speed", "position"), [(10.0, 130.0 - 100.0 * 2), (-10.0, 130.0)])
def test_with_a_period_a_literal_position_behind_is_refused(speed: float, position: float) -> None:
    saw = Saw({"master.period": 100.0}, place=30.0, speed=speed)
    saw.order("gear_in_pos", master_sync_position=position, slave_sync_position=math.copysign(9.0, speed))
    assert saw.run(INSTANT)["gear_in_pos.error_id"] == 0x42DE


def test_with_a_period_the_start_distance_may_be_longer_than_it() -> None:
    """Sync at 90 of the turn the master is in: a start 250 before it is passed already."""
    saw = Saw({"master.period": 100.0}, place=30.0, speed=10.0)
    saw.order("gear_in_pos", master_sync_position=90.0, slave_sync_position=15.0, master_start_distance=250.0)
    assert saw.run(INSTANT).state == State.SYNCHRONIZING
    other = Saw({"master.period": 100.0}, place=30.0, speed=10.0)
    other.order("gear_in_pos", master_sync_position=20.0, slave_sync_position=15.0, master_start_distance=40.0)
    assert other.run(4.9).state == State.PREPHASE
    assert other.run(0.2).state == State.SYNCHRONIZING
    assert other.run(4.0).slave == near(15.0 + 1.0, 10.0, 0.0)


def test_with_a_period_the_coupling_position_is_a_place_not_one_of_every_turn() -> None:
    """From 30 two turns and a half back, wrapped, and forwards again: only at 30 of the same turn."""
    saw = Saw({"master.period": 100.0}, place=30.0, speed=50.0).modes("rollback_lock", "instant_stop_on_rollback")
    saw.order("gear_in_velo").run(1.0)
    start = saw.slave[0] - 50.0
    saw.speed = -45.0
    for _ in range(8):
        saw.run(0.9)
    assert (saw.state, saw.place) == (State.PREPHASE, near(80.0 - 324.0))
    saw.speed = 45.0
    for _ in range(6):
        assert saw.run(1.0).state == State.PREPHASE
    assert saw.slave == near(start, 0.0, 0.0)
    saw.run(0.2)
    assert saw.state == State.SYNCHRON
    assert saw["local.coupling_position"] == near(30.0)


def test_the_seam_between_prediction_and_input_belongs_to_the_path() -> None:
    """Predicted up to 999.5, then at 1000.5: the sync position is passed in between."""
    saw = first_example().order("gear_in_pos", **FIRST).run(2.999)
    assert saw.state == State.SYNCHRONIZING
    saw.place = 1000.5
    saw.release().order("gear_out").run(INSTANT)
    assert saw.slave == near(1000.5 + 500.0 * INSTANT, 500.0, 0.0)
    assert saw.results("gear_in_pos") >= {"command_aborted"}


def test_with_inputs_of_the_step_s_end_a_command_acts_with_the_master_of_the_call_before() -> None:
    saw = Saw({"axis.initial_position": -250.0, "axis.initial_velocity": 250.0}, place=-500.0, speed=500.0, mode=END)
    saw.order("gear_in_pos", **FIRST).run(1.0)
    assert saw["characteristics.master_position_start"] == -500.0
    other = first_example().order("gear_in_pos", **FIRST).run(1.0)
    assert saw.slave == near(*other.slave)
    saw.run(1.0, acceleration=-30.0).run(2.0, acceleration=40.0)
    other.run(1.0, acceleration=-30.0).run(2.0, acceleration=40.0)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(*other.slave)


def test_with_positions_only_the_master_s_motion_is_estimated() -> None:
    saw = Saw({"axis.initial_position": -250.0, "axis.initial_velocity": 250.0}, place=-550.0, speed=500.0, mode=ONLY)
    saw.put({"axis.initial_position": -275.0})
    assert saw.block.initialize() == 0
    saw.run(0.1, cuts=grid(0.1, 0.02))
    assert saw.slave == near(-250.0, 250.0, 0.0)
    saw.order("gear_in_pos", **FIRST).run(3.1, cuts=grid(3.1, 0.02))
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(1050.0, 500.0, 0.0, tolerance=1e-8))
    assert saw["characteristics.slave_velocity_max"] == pytest.approx(506.0, abs=5e-3)


def test_with_positions_only_the_master_stands_at_first() -> None:
    saw = Saw(speed=100.0, mode=ONLY)
    assert saw.order("gear_in_pos", **AIMS).run(0.1)["gear_in_pos.error_id"] == 0x426E
    saw.release().run(0.1).run(0.1)
    assert saw.order("gear_in_pos", **AIMS).run(0.1)["gear_in_pos.error_id"] == 0


# --- time based -------------------------------------------------------------------------------------------------------


def test_time_based_to_a_constant_master() -> None:
    """From 0 to 100 with 1000 and 10000: 0.2 s, 10 u; the master has gone 20."""
    saw = Saw(speed=100.0).modes("time_based").order("gear_in_velo", acceleration=1000.0, jerk=10000.0).run(0.1)
    assert (saw.state, saw.slave) == (State.SYNCHRONIZING, near(10.0 / 6.0, 50.0, 1000.0))
    found = saw.block.characteristics
    assert (found.profile, found.master_position_end, found.slave_position_end) == (
        ProfileKind.JERK_LIMITED,
        near(20.0),
        near(10.0),
    )
    assert (found.slave_acceleration_max, found.slave_jerk_max, found.slave_velocity_mean) == near(1e3, 1e4, 50.0)
    last = math.sqrt(1.0 / 150.0)  # s before the end, where v a = (100 - 5000 r^2) 10000 r is greatest
    assert found.slave_dynamic_momentum_max == near((100.0 - 5000.0 * last**2) * 10000.0 * last)
    assert found.slave_acceleration_effective == near(math.sqrt(1e6 / 3.0))
    saw.run(0.1 + INSTANT)
    assert saw.results("gear_in_velo") == {"start_sync", "in_sync"}
    saw.run(1.0, acceleration=-50.0).run(1.0, acceleration=500.0)
    assert saw.slave == near(saw.place - 10.0, saw.speed, 500.0)


def test_time_based_to_an_accelerated_master() -> None:
    """What lacks is 100, and grows with a_m = 100: w' goes from -100 to 900 in 0.1 s, stays, and is 0 after 0.09 s;
    the jerk's triangles make (2 * 900^2 - 100^2) / 20000 = 80.5, the plateau the other 19.5."""
    saw = Saw(speed=100.0).modes("time_based").order("gear_in_velo", acceleration=1000.0, jerk=10000.0)
    duration = 0.1 + 19.5 / 900.0 + 0.09
    saw.run(0.1 + 0.5 * 19.5 / 900.0, acceleration=100.0)
    assert saw.slave[2] == near(1000.0)
    saw.run(duration - saw.time - 1e-6, acceleration=100.0)
    assert saw.state == State.SYNCHRONIZING
    saw.run(2e-6, acceleration=100.0)
    assert saw.state == State.SYNCHRON
    assert saw.slave[1:] == near(100.0 + 100.0 * (duration + 1e-6), 100.0)


def test_time_based_beyond_the_velocity_limit() -> None:
    """Refused at the edge; later held at the limit, in sync once the master is back below it."""
    saw = Saw(speed=100.0).modes("time_based")
    refused(saw, "gear_in_velo", 0x42DD, velocity=99.0)
    saw = Saw(speed=100.0).modes("time_based")
    saw.order("gear_in_velo", velocity=120.0, acceleration=100.0, deceleration=100.0, jerk=1000.0)
    saw.run(0.5, acceleration=80.0)  # 140 at its end
    saw.run(3.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRONIZING, near(120.0, 0.0))
    saw.run(1.0, acceleration=-30.0)
    saw.run(3.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(110.0, 0.0))


def test_time_based_the_reversal_table_applies_only_in_sync() -> None:
    saw = Saw(speed=100.0).modes("time_based", "rollback_lock", "instant_stop_on_rollback")
    saw.order("gear_in_velo", acceleration=100.0, deceleration=100.0, jerk=1000.0).run(0.1)
    saw.speed = -100.0
    saw.run(0.5)
    assert (saw.state, saw.slave[2] < 0.0) == (State.SYNCHRONIZING, True)
    saw.run(5.0)
    assert (saw.state, saw.slave[1:]) == (State.SYNCHRON, near(-100.0, 0.0))


# --- states -----------------------------------------------------------------------------------------------------------


def test_states_through_a_cycle() -> None:
    """Waits up to 100, meets at 200; then a halt of 0.2 s, and a return with 0.2 s ramps and 0.4 s between."""
    saw = Saw(speed=100.0)
    limits = {"velocity": 100.0, "acceleration": 1000.0, "deceleration": 1000.0, "jerk": 10000.0}
    start = {"master_sync_position": 200.0, "slave_sync_position": 50.0, "master_start_distance": 100.0}
    for group, values, duration, state, plcopen in [
        ("reset", {}, 0.1, "INACTIVE", "STANDSTILL"),
        ("gear_in_pos", start, 0.5, "PREPHASE", "SYNCHRONIZED_MOTION"),
        ("", {}, 1.0, "SYNCHRONIZING", "SYNCHRONIZED_MOTION"),
        ("", {}, 0.5, "SYNCHRON", "SYNCHRONIZED_MOTION"),
        ("gear_out", {}, 0.1, "CONSTANT_VELOCITY", "CONTINUOUS_MOTION"),
        ("halt", {"deceleration": 1000.0, "jerk": 10000.0}, 0.1, "DECELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.2, "INACTIVE", "STANDSTILL"),
        ("move_absolute", {"position": 20.0, **limits}, 0.1, "ACCELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.15, "CONSTANT_VELOCITY", "DISCRETE_MOTION"),
        ("", {}, 0.45, "DECELERATING", "DISCRETE_MOTION"),
        ("", {}, 0.5, "INACTIVE", "STANDSTILL"),
        ("move_velocity", limits | {"velocity": -100.0}, 0.1, "ACCELERATING", "CONTINUOUS_MOTION"),
        ("stop", {"deceleration": 1000.0, "jerk": 10000.0}, 0.15, "DECELERATING", "STOPPING"),
        ("", {}, 0.2, "INACTIVE", "STOPPING"),
    ]:
        if group:
            saw.order(group, **values)
        saw.run(duration)
        assert (saw.state.name, saw["plcopen_state"].name) == (state, plcopen)
        assert saw["state_code"] == int(saw.state)
        assert saw["coupled"] == (plcopen == "SYNCHRONIZED_MOTION")
        assert saw["in_sync"] == (state == "SYNCHRON")


def test_an_axis_may_start_in_motion() -> None:
    saw = Saw({"axis.initial_position": 3.0, "axis.initial_velocity": -2.0})
    assert (saw.state, saw["plcopen_state"]) == (State.CONSTANT_VELOCITY, PlcopenState.CONTINUOUS_MOTION)
    assert saw.slave == (3.0, -2.0, 0.0)
    assert saw.run(2.0).slave == (-1.0, -2.0, 0.0)


def test_at_the_master_s_velocity_already_it_is_in_sync_at_once() -> None:
    """Nothing to do: start and end are the same."""
    saw = Saw({"axis.initial_position": 9.0, "axis.initial_velocity": 50.0}, place=4.0, speed=100.0)
    saw.order("gear_in_velo", ratio_denominator=2).run(0.1)
    assert (saw.results("gear_in_velo"), saw.state) == ({"start_sync", "in_sync"}, State.SYNCHRON)
    found = saw.block.characteristics
    assert (found.profile, found.master_velocity_nominal) == (ProfileKind.NONE, 100.0)
    assert (found.master_position_start, found.master_position_end) == (4.0, 4.0)
    assert (found.slave_position_start, found.slave_position_end) == (9.0, 9.0)
    assert (found.slave_position_min, found.slave_position_max) == (9.0, 9.0)
    assert (found.slave_velocity_start, found.slave_velocity_end, found.slave_velocity_mean) == (50.0, 50.0, 50.0)
    assert (found.slave_acceleration_start, found.slave_acceleration_effective, found.slave_jerk_max) == (0.0, 0.0, 0.0)


def test_characteristic_values_stay_when_uncoupled_and_when_a_command_is_refused() -> None:
    saw = first_example().order("gear_in_pos", **FIRST).run(4.0).order("gear_out").run(1.0)
    before = saw.read(name for name in OUTPUTS if name.startswith("characteristics."))
    saw.release().run(INSTANT)
    refused(saw, "gear_in_pos", 0x42DE, master_sync_position=-9e3)
    assert saw.read(before) == before
    assert before["characteristics.slave_velocity_max"] == pytest.approx(506.0, abs=5e-3)
