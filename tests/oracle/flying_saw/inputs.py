"""The inputs of the FlyingSaw's oracle with their start values, the limits in use, and the request of a coupling."""

from collections.abc import Mapping
from typing import Any

from tests.oracle.flying_saw.checks import CHECKS
from tests.oracle.flying_saw.commands import GROUPS
from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.flying_saw.period import next_occurrence
from tests.oracle.flying_saw.request import GEAR_IN_POS, Limits, Request
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

BITS = (
    "time_based",
    *CHECKS,
    "rollback_lock",
    "instant_stop_on_rollback",
    "prefer_constant_velocity",
    "ignore_master_acceleration",
    "ignore_slave_acceleration",
    "detailed_error_codes",
)
CHECKED_AT_FIRST = (
    "check_min_position",
    "check_max_position",
    "check_max_velocity",
    "check_max_acceleration",
    "check_max_deceleration",
)
LIMITS = ("velocity", "acceleration", "deceleration", "jerk")
SMALLEST, LARGEST = 1e-12, 1e12
"""The least and the greatest magnitude of a ratio's numerator."""
GEAR = ("ratio_numerator", "ratio_denominator", *LIMITS)
INPUTS = {
    "gear_in_velo": GEAR,
    "gear_in_pos": (*GEAR, "master_sync_position", "slave_sync_position", "master_start_distance"),
    "halt": ("deceleration", "jerk"),
    "stop": ("deceleration", "jerk"),
    "move_velocity": LIMITS,
    "move_absolute": ("position", *LIMITS),
    "gear_out": (),
    "reset": (),
}
DEFAULTS: dict[str, Any] = {
    "axis.max_velocity": 2000.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 0.0,
    "axis.max_jerk": 100000.0,
    "axis.min_position": -1e9,
    "axis.max_position": 1e9,
    **{f"sync_mode.{bit}": bit in CHECKED_AT_FIRST for bit in BITS},
    **{f"{group}.{name}": 1 if name.startswith("ratio") else 0.0 for group in GROUPS for name in INPUTS[group]},
    **{f"{group}.execute": False for group in GROUPS},
}
"""What may be set while the block runs, with the start values."""


def command_limit(inputs: Mapping[str, Any], group: str, name: str) -> Number:
    """A limit of a command; 0 means the axis's."""
    limit = inputs[f"{group}.{name}"]
    return mp.mpf(limit) if limit != 0 else axis_limit(inputs, name)


def axis_limit(inputs: Mapping[str, Any], name: str) -> Number:
    """A limit of the axis; a deceleration of 0 means the acceleration."""
    limit = inputs[f"axis.max_{name}"]
    return mp.mpf(inputs["axis.max_acceleration"] if name == "deceleration" and limit == 0 else limit)


def are_valid(*limits: Number) -> bool:
    return all(mp.isfinite(limit) and limit > 0 for limit in limits)


def read_request(
    inputs: Mapping[str, Any], group: str, master: Motion, slave: Motion, period: Number, cosine: Number
) -> tuple[Request | None, Number]:
    """What the edge of a gear-in command asks for, and the start distance (u); None if there is no factor."""
    numerator, denominator = (mp.mpf(inputs[f"{group}.ratio_{name}"]) for name in ("numerator", "denominator"))
    if not (denominator > 0 and SMALLEST <= abs(numerator) <= LARGEST):
        return None, ZERO
    factor = numerator / denominator / cosine
    sync, distance = None, ZERO
    if group == GEAR_IN_POS:
        sync_master, sync_slave = (mp.mpf(inputs[f"{group}.{name}_sync_position"]) for name in ("master", "slave"))
        sync = (next_occurrence(sync_master, master, period), sync_slave)
        distance = mp.mpf(inputs[f"{group}.master_start_distance"])
    bits = frozenset(bit for bit in BITS if inputs[f"sync_mode.{bit}"])
    ends = mp.mpf(inputs["axis.min_position"]), mp.mpf(inputs["axis.max_position"])
    limits = Limits(*(command_limit(inputs, group, name) for name in LIMITS))
    return Request(group, master, slave, factor, limits, bits, ends, sync), distance
