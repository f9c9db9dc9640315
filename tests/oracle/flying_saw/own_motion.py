"""The commands by which a flying saw moves without its master: stop, halt, move_velocity and move_absolute."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.flying_saw.inputs import LIMITS, are_valid, command_limit
from tests.oracle.flying_saw.motion import Phases, limit_towards, move, ramp, stop
from tests.oracle.flying_saw.plan import BAD_LIMIT
from tests.oracle.flying_saw.rows import CONTINUOUS_MOTION, DISCRETE_MOTION
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

BELOW_MINIMUM, ABOVE_MAXIMUM = 0x4372, 0x4373


@dataclass(frozen=True, slots=True)
class OwnMotion:
    """What a command asks for.

    `plan`: the phases from a state of the slave; `end`: the velocity, and for a move the position, that it reaches
    exactly; `state`: that of PLCopen meanwhile; `deceleration`, `jerk`: the limits of its stop.
    """

    plan: Callable[[Motion], Phases]
    end: Motion
    state: int
    deceleration: Number
    jerk: Number


def read_own_motion(inputs: Mapping[str, Any], group: str) -> OwnMotion | int:
    """The motion of a command, or the error_id with which it is refused."""
    match group:
        case "move_velocity":
            return _velocity(inputs)
        case "move_absolute":
            return _position(inputs)
        case _:
            return _rest(inputs, group)


def _rest(inputs: Mapping[str, Any], group: str) -> OwnMotion | int:
    """That of stop and halt."""
    deceleration, jerk = (command_limit(inputs, group, name) for name in ("deceleration", "jerk"))
    if not are_valid(deceleration, jerk):
        return BAD_LIMIT
    end = Motion(None, ZERO, ZERO)
    return OwnMotion(lambda slave: stop(slave, deceleration, jerk), end, DISCRETE_MOTION, deceleration, jerk)


def _velocity(inputs: Mapping[str, Any]) -> OwnMotion | int:
    target = mp.mpf(inputs["move_velocity.velocity"])
    greatest = mp.mpf(inputs["axis.max_velocity"])
    acceleration, deceleration, jerk = (command_limit(inputs, "move_velocity", name) for name in LIMITS[1:])
    if not are_valid(greatest, acceleration, deceleration, jerk) or not abs(target) <= greatest:
        return BAD_LIMIT

    def plan(slave: Motion) -> Phases:
        limit = limit_towards(slave.velocity, target, acceleration, deceleration)
        return ramp(slave.velocity, slave.acceleration, target, limit, jerk)

    return OwnMotion(plan, Motion(None, target, ZERO), CONTINUOUS_MOTION, deceleration, jerk)


def _position(inputs: Mapping[str, Any]) -> OwnMotion | int:
    target = mp.mpf(inputs["move_absolute.position"])
    limits: list[Number] = [command_limit(inputs, "move_absolute", name) for name in LIMITS]
    if not are_valid(*limits):
        return BAD_LIMIT
    if not target >= mp.mpf(inputs["axis.min_position"]):
        return BELOW_MINIMUM
    if not target <= mp.mpf(inputs["axis.max_position"]):
        return ABOVE_MAXIMUM
    end = Motion(target, ZERO, ZERO)
    return OwnMotion(lambda slave: move(slave, target, *limits), end, DISCRETE_MOTION, *limits[2:])
