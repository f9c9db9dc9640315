"""The slave axis's machine data, and the limits that a command takes from it."""

from dataclasses import dataclass
from math import isfinite

from .. import var
from ..limits import LEAST_LIMIT, MOST
from ..var import Role, Unit


@dataclass(slots=True)
class AxisLimits:
    """The slave axis's machine data: where it starts, and its limits."""

    initial_position: float = var.parameter(0.0, "where the axis is at first", Unit.POSITION, min=-MOST, max=MOST)
    initial_velocity: float = var.parameter(
        0.0, "its velocity at first, with which it goes on for ever", Unit.VELOCITY, min=-MOST, max=MOST
    )
    max_velocity: float = var.parameter(
        2000.0,
        "velocity limit, not 0",
        Unit.VELOCITY,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
        zero=False,
        role=Role.MAX_VELOCITY,
    )
    max_acceleration: float = var.parameter(
        10000.0,
        "acceleration limit, not 0",
        Unit.ACCELERATION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
        zero=False,
        role=Role.MAX_ACCELERATION,
    )
    max_deceleration: float = var.parameter(
        10000.0,
        "deceleration limit, not 0",
        Unit.ACCELERATION,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
        zero=False,
        role=Role.MAX_DECELERATION,
    )
    max_jerk: float = var.parameter(
        100000.0,
        "jerk limit, not 0",
        Unit.JERK,
        tunable=True,
        min=0.0,
        max=MOST,
        smallest=LEAST_LIMIT,
        zero=False,
        role=Role.MAX_JERK,
    )
    min_position: float = var.parameter(
        -1e9, "lower software end position", Unit.POSITION, tunable=True, min=-MOST, max=MOST, role=Role.MIN_POSITION
    )
    max_position: float = var.parameter(
        1e9, "upper software end position", Unit.POSITION, tunable=True, min=-MOST, max=MOST, role=Role.MAX_POSITION
    )


def limit_in_use(limit: float, axis_limit: float) -> float:
    """The limit that a command goes by: its own, or the axis's if its own is 0."""
    return axis_limit if limit == 0.0 else limit


def are_finite(lowest: float, highest: float) -> bool:
    """Whether both software end positions are finite; tunable parameters are judged by the command that reads them."""
    return isfinite(lowest) and isfinite(highest)
