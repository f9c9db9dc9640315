"""The limits in use: those that were set, those that nobody has set, and those that stand for another one."""

from typing import Any

import pytest

from motionsync_fmu.interface.limits_in_use import find_limits_in_use
from motionsync_fmu.interface.recipe import Recipe


def limits(block: str, **start: float) -> dict[str, tuple[float, str]]:
    given = {name.replace("__", "."): value for name, value in start.items()}
    return {
        limit.variable.name: (limit.value, limit.reason) for limit in find_limits_in_use(Recipe(block).variables, given)
    }


def test_the_limits_of_a_machine_of_which_the_acceleration_is_set() -> None:
    assert limits("CutToLength", axis__max_acceleration=4000.0, homing__velocity=500.0) == {
        "axis.max_velocity": (2000.0, "start value"),
        "axis.max_acceleration": (4000.0, "set"),
        "axis.max_deceleration": (4000.0, "as axis.max_acceleration"),
        "axis.max_jerk": (100000.0, "start value"),
        "approach.acceleration": (4000.0, "as axis.max_acceleration"),
        "approach.jerk": (100000.0, "as axis.max_jerk"),
        "homing.velocity": (500.0, "set"),
        "homing.acceleration": (4000.0, "as axis.max_acceleration"),
        "homing.deceleration": (4000.0, "as axis.max_deceleration"),
        "homing.jerk": (100000.0, "as axis.max_jerk"),
    }


def test_the_limits_of_commands_are_none_of_the_axis() -> None:
    assert list(limits("FlyingSaw", axis__max_deceleration=7.0).items()) == [
        ("axis.max_velocity", (2000.0, "start value")),
        ("axis.max_acceleration", (10000.0, "start value")),
        ("axis.max_deceleration", (7.0, "set")),
        ("axis.max_jerk", (100000.0, "start value")),
    ]


@pytest.mark.parametrize("block", ["Synchronizer", "Gearing", "RemoteSync"])
def test_a_block_without_limits_has_none(block: Any) -> None:
    assert limits(block) == {}
