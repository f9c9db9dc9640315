"""Which profile the FlyingSaw's oracle chooses, and which error it gives first."""

import math
import random
from typing import Any

import pytest

from tests.model.flying_saw.oracle_cases import (
    EXAMPLE_3,
    EXAMPLE_4_1,
    EXAMPLE_4_2,
    VELOCITY_CHECKS,
    close,
    limits_of,
    mirrored,
    random_plan,
    values,
)
from tests.oracle.flying_saw_checks import CHECKS
from tests.oracle.flying_saw_plan import (
    P1_P5,
    P5,
    P5_P1,
    P5_P1_P5,
    plan,
)


def backwards(given: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The same with the directions of master and slave reversed."""
    result = given | {name: tuple(-x for x in given[name]) for name in ("master", "slave", "sync")}
    return result | changes


def to_position(v0: float, v1: float, time: float, mean: float, **changes: Any) -> dict[str, Any]:
    """From slave position 0; the master goes at v1 from 0."""
    given = {"mode": "gear_in_pos", "master": (0, v1, 0), "slave": (0, v0, 0), "factor": 1}
    return given | {"limits": (2000, 1e5, 1e5, 1e6), "sync": (v1 * time, mean * time)} | changes


SLOW_DOWN = to_position(600, 500, 2, 700)
LATE = to_position(500, 100, 2, 5)
NOT_FREE = {"master": (-500, 500, -1)}
LESS = {"limits": (505, 2500, 2500, 5000)}


@pytest.mark.parametrize(
    ("code", "check", "given"),
    [
        (0x4372, "check_min_position", EXAMPLE_4_2 | {"ends": (-600, 1e9)}),
        (0x4373, "check_max_position", EXAMPLE_4_1 | {"ends": (-1e9, 999)}),
        (0x4376, "check_undershoot_position", mirrored(LATE)),
        (0x4377, "check_undershoot_position", EXAMPLE_4_2),
        (0x4378, "check_overshoot_position", mirrored(EXAMPLE_4_2)),
        (0x4379, "check_overshoot_position", LATE),
        (0x437A, "check_max_velocity", EXAMPLE_4_1 | NOT_FREE | LESS),
        (0x437B, "check_max_velocity", mirrored(EXAMPLE_4_1, **NOT_FREE, **LESS)),
        (0x437C, "check_overshoot_velocity", EXAMPLE_4_1 | NOT_FREE),
        (0x437D, "check_overshoot_velocity", SLOW_DOWN),
        (0x437E, "check_overshoot_velocity", mirrored(EXAMPLE_4_1, **NOT_FREE)),
        (0x437F, "check_overshoot_velocity", mirrored(SLOW_DOWN)),
        (0x4380, "check_undershoot_velocity", to_position(600, 500, 2, 450)),
        (0x4381, "check_undershoot_velocity", to_position(250, 500, 2, 200)),
        (0x4382, "check_undershoot_velocity", mirrored(to_position(600, 500, 2, 450))),
        (0x4383, "check_undershoot_velocity", mirrored(to_position(250, 500, 2, 200))),
        (0x4384, "check_overshoot_velocity_zero", EXAMPLE_4_1),
        (0x4385, "check_overshoot_velocity_zero", mirrored(backwards(EXAMPLE_4_1))),
        (0x4386, "check_undershoot_velocity_zero", LATE),
        (0x4387, "check_undershoot_velocity_zero", backwards(LATE)),
        (0x4386, "check_undershoot_velocity_zero", EXAMPLE_4_2),  # starts against the synchronous velocity
        (0x4386, "check_undershoot_velocity_zero", mirrored(EXAMPLE_4_2)),
        (0x4388, "check_max_acceleration", EXAMPLE_4_1 | {"limits": (2000, 175, 2500, 5000)}),
        (0x4389, "check_max_deceleration", EXAMPLE_4_1 | {"limits": (2000, 2500, 15, 5000)}),
        (0x438A, "check_max_jerk", EXAMPLE_4_1 | {"limits": (2000, 2500, 2500, 444)}),
        (0x438B, "check_max_jerk", mirrored(EXAMPLE_4_1, limits=(2000, 2500, 2500, 444))),
    ],
)
def test_each_check_has_its_code(code: int, check: str, given: dict[str, Any]) -> None:
    assert plan(**given).error == 0
    assert plan(**given, bits=[check]).error == 0x42DF
    assert plan(**given, bits=[check, "detailed_error_codes"]).error == code
    assert code in CHECKS[check]
    others = [name for name in CHECKS if name != check]
    result = plan(**given, bits=[*others, "detailed_error_codes"])
    assert result.error != code


@pytest.mark.parametrize(
    ("check", "given"),
    [
        ("check_min_position", EXAMPLE_4_2 | {"ends": (-620.64, 1e9)}),
        ("check_max_position", EXAMPLE_4_1 | {"ends": (-1e9, 1000)}),
        ("check_max_acceleration", EXAMPLE_4_1 | {"limits": (2000, 175.05, 2500, 5000)}),
        ("check_max_deceleration", EXAMPLE_4_1 | {"limits": (2000, 2500, 15.05, 5000)}),
        ("check_max_jerk", EXAMPLE_4_1 | {"limits": (2000, 2500, 2500, 444.45)}),
        ("check_undershoot_position", EXAMPLE_4_1),
        ("check_overshoot_position", EXAMPLE_4_1),
        ("check_undershoot_velocity_zero", EXAMPLE_4_1),
        ("check_overshoot_velocity_zero", mirrored(EXAMPLE_4_1)),
    ],
)
def test_a_kept_limit_is_no_error(check: str, given: dict[str, Any]) -> None:
    result = plan(**given, bits=[check])
    assert (result.error, result.profile) == (0, P5)


@pytest.mark.parametrize(
    ("error", "changes"),
    [
        (0x425B, {"factor": 0, "limits": (0, 1, 1, 1)}),
        (0x425B, {"factor": math.inf}),
        (0x42DD, {"limits": (2000, -1, 2500, 5000), "bits": ["time_based"]}),
        (0x42DD, {"limits": (2000, 2500, 2500, math.inf)}),
        (0x42DD, {"limits": (499, 2500, 2500, 5000), "bits": ["check_max_velocity"]}),
        (0x4289, {"limits": (499, 2500, 2500, 5000), "bits": ["time_based"]}),
        (0x4289, {"bits": ["time_based"], "master": (0, 0, 0)}),
        (0x426E, {"master": (0, 0, 1)}),
        (0x42DE, {"sync": (-500, 1000)}),
        (0x42DE, {"sync": (1000, -250)}),
        (0x42DE, {"master": (-500, -500, 0)}),
        (0x42DE, {"factor": -1}),
    ],
)
def test_errors_come_in_their_order(error: int, changes: dict[str, Any]) -> None:
    assert plan(**EXAMPLE_4_1 | changes).error == error


@pytest.mark.parametrize("bits", [(), ("time_based",)])
def test_a_standing_master_takes_a_standing_slave_only(bits: tuple[str, ...]) -> None:
    standing = EXAMPLE_3 | {"master": (0, 0, 0)}
    assert plan(**standing, bits=bits).error == 0x424A
    assert plan(**standing | {"slave": (0, 0, 1)}, bits=bits).error == 0x424A
    assert plan(**standing | {"slave": (0, 0, 0)}, bits=bits).error == 0


def test_first_the_present_velocity_or_first_the_ramp() -> None:
    """Means of 300 and 450 between 250 and 500 in 3 s: T5 = 2·150/250 and 2·150/250."""
    near = plan(**to_position(250, 500, 3, 300), bits=VELOCITY_CHECKS)
    assert (near.profile, float(near.curve.segments[1].length)) == (P1_P5, close(1.2))
    assert values(near, "slave_jerk_start", "slave_jerk_end") == [0.0, close(-6 * 250 / 1.2**2)]
    far = plan(**to_position(250, 500, 3, 450), bits=VELOCITY_CHECKS)
    assert (far.profile, float(far.curve.segments[0].length)) == (P5_P1, close(1.2))
    assert values(far, "master_position_at_slave_velocity_max") == [close(600.0)]
    half = plan(**to_position(250, 500, 3, 375), bits=VELOCITY_CHECKS)
    assert (half.profile, float(half.curve.duration)) == (P5_P1, close(3.0))


def test_a_broken_limit_makes_the_profile_without_overshoot_give_way() -> None:
    """187.5 of P5+P1 against 175.05 of P5, which overshoots."""
    given = EXAMPLE_4_1 | {"limits": (2000, 180, 180, 5000)}
    accepted = plan(**given, bits=["check_undershoot_velocity", "check_max_acceleration"])
    assert (accepted.error, accepted.profile) == (0, P5)
    bits = ["check_overshoot_velocity", "check_max_acceleration", "detailed_error_codes"]
    assert plan(**given, bits=bits).error == 0x437C
    assert plan(**given, bits=["check_overshoot_velocity"]).profile == P5_P1


def test_accelerated_axes_have_p5_only() -> None:
    for changes in (NOT_FREE, {"slave": (-250, 250, 1)}):
        for bits in (["check_undershoot_velocity"], ["prefer_constant_velocity"], ["check_max_velocity"]):
            assert plan(**EXAMPLE_4_1 | changes, bits=bits).profile == P5
    ignored = ["check_undershoot_velocity", "ignore_master_acceleration", "ignore_slave_acceleration"]
    both = EXAMPLE_4_1 | NOT_FREE | {"slave": (-250, 250, 1)}
    assert plan(**both, bits=ignored).profile == P5_P1
    tiny = EXAMPLE_4_1 | {"slave": (-250, 250, 0.9e-9 * 500 / 3)}
    assert plan(**tiny, bits=["check_undershoot_velocity"]).profile == P5_P1


def test_the_start_acceleration_is_that_at_constant_master_velocity() -> None:
    """s'' = (a - s'·a_m)/v_m²: 30 - 250·50/500."""
    given = EXAMPLE_4_1 | {"master": (-500, 500, 50), "slave": (-250, 250, 30)}
    assert values(plan(**given), "slave_acceleration_start") == [close(5.0)]
    assert values(plan(**given, bits=["ignore_master_acceleration"]), "slave_acceleration_start") == [close(30.0)]
    assert values(plan(**given, bits=["ignore_slave_acceleration"]), "slave_acceleration_start") == [close(-25.0)]


def test_the_velocity_limit_becomes_the_constant_velocity() -> None:
    """0 to 500 over 1200 in 2 s at 900: 0.75·(900² + 400²)/(1800 - 1200) = 1212.5."""
    given = to_position(0, 500, 2, 600, limits=(900, 1e5, 1e5, 1e6))
    result = plan(**given, bits=["check_max_velocity"])
    assert (result.error, result.profile) == (0, P5_P1_P5)
    assert limits_of(result, "acceleration") == [close(-1212.5), close(1212.5)]
    assert limits_of(result, "velocity")[1] == close(900.0)
    assert [float(p.length) for p in result.curve.segments] == [
        close(1.5 * 900 / 1212.5),
        close(2 - 1950 / 1212.5),
        close(600 / 1212.5),
    ]
    weak = given | {"limits": (900, 1200, 1e5, 1e6)}
    bits = ["check_max_velocity", "check_max_acceleration", "detailed_error_codes"]
    assert plan(**weak, bits=bits).error == 0x437A
    assert plan(**weak, bits=["check_max_acceleration", "detailed_error_codes"]).error == 0x4388
    back = plan(**mirrored(given), bits=["check_max_velocity"])
    assert (back.profile, limits_of(back, "velocity")[0]) == (P5_P1_P5, close(-900.0))


def test_a_limit_too_near_to_the_mean_is_out_of_reach() -> None:
    given = to_position(0, 500, 2, 600, limits=(600, 1e5, 1e5, 1e6))
    assert plan(**given, bits=["check_max_velocity", "detailed_error_codes"]).error == 0x437A


def test_the_preferred_constant_velocity_by_hand() -> None:
    """100 to 100 over 600 in 4 s with 100 u/s2: 4y - 0.015·y² = 200, c = 100 + 200/3, ramps of 1 s."""
    given = to_position(100, 100, 4, 150, limits=(2000, 100, 100, 1000))
    result = plan(**given, bits=["prefer_constant_velocity"])
    assert (result.profile, limits_of(result, "velocity")[1]) == (P5_P1_P5, close(500 / 3))
    assert [float(p.length) for p in result.curve.segments] == [close(1.0), close(2.0), close(1.0)]
    assert plan(**given | {"limits": (2000, 20, 20, 1000)}, bits=["prefer_constant_velocity"]).profile == P5
    refused = plan(**given, bits=["prefer_constant_velocity", "check_overshoot_velocity", "detailed_error_codes"])
    assert refused.error == 0x437C
    gentle = plan(**given, bits=["prefer_constant_velocity", "check_max_jerk"])
    c = limits_of(gentle, "velocity")[1]
    assert float(gentle.curve.segments[0].length) == close(max(1.5 * (c - 100) / 100, math.sqrt(6 * (c - 100) / 1000)))


def test_a_short_way_asks_for_a_constant_velocity_backwards() -> None:
    result = plan(**to_position(100, 100, 4, 1, limits=(2000, 200, 400, 1000)), bits=["prefer_constant_velocity"])
    c = limits_of(result, "velocity")[0]
    assert (result.profile, c < 0) == (P5_P1_P5, True)
    first, last = (1.5 * (100 - c) / 200 for _ in range(2))  # v·c < 0: the smaller limit
    assert (100 + c) / 2 * first + c * (4 - first - last) + (c + 100) / 2 * last == close(4.0, rel=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_the_distance_rises_with_the_constant_velocity_where_the_ramps_fit(seed: int) -> None:
    """The search for it asserts that only one fits on the side it looks at."""
    chance, result = random.Random(seed), 0
    for _ in range(10):
        given = random_plan(chance, "gear_in_pos", bits=["prefer_constant_velocity", "check_max_jerk"])
        given["master"], given["slave"] = (*given["master"][:2], 0.0), (*given["slave"][:2], 0.0)
        given["limits"] = (1e9, *given["limits"][1:])
        planned = plan(**given)
        result += planned.profile == P5_P1_P5
    assert result
