"""Random runs of the FlyingSaw, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.flying_saw.saw_master import coupling_acceleration
from motionsync.flying_saw.stage import Stage
from motionsync.flying_saw.sync_mode import SyncMode
from motionsync.master import MasterInput
from motionsync.motion.exceeded_limit import Limit
from tests.support.blocks.masters import INPUT_MODES, WanderingMaster
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy

GROUPS = (
    *("reset", "stop", "halt", "gear_out", "gear_in_velo", "gear_in_pos"),
    *("move_velocity", "move_absolute"),
)
LIMITS = {
    "gear_in_velo": ("velocity", "acceleration", "deceleration", "jerk"),
    "gear_in_pos": ("velocity", "acceleration", "deceleration", "jerk"),
    "halt": ("deceleration", "jerk"),
    "stop": ("deceleration", "jerk"),
    "move_velocity": ("acceleration", "deceleration", "jerk"),
    "move_absolute": ("velocity", "acceleration", "deceleration", "jerk"),
}
MODES = (
    *("time_based", "check_min_position", "check_max_position", "check_max_velocity", "check_max_acceleration"),
    *("check_max_deceleration", "check_max_jerk", "check_overshoot_position", "check_undershoot_position"),
    *("check_overshoot_velocity", "check_undershoot_velocity", "check_overshoot_velocity_zero"),
    *("check_undershoot_velocity_zero", "rollback_lock", "instant_stop_on_rollback", "prefer_constant_velocity"),
    *("ignore_master_acceleration", "ignore_slave_acceleration", "detailed_error_codes"),
)
DYNAMICS = {"velocity": 3.0, "acceleration": 20.0, "deceleration": 30.0, "jerk": 500.0}  # of the length


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-6, 1e6)))
    shortest = max(1e-9, 1e-14 * length)  # a shorter one has too many turns up to the first position
    periods = st.one_of(st.just(0.0), st.floats(0.5, 20.0).map(lambda x: x * length), st.floats(shortest, 1e4))
    scalings = st.one_of(st.sampled_from((0.0, 0.0, 1e12)), st.floats(0.0, 0.1).map(lambda x: x * length))
    start = {
        **draw(INPUT_MODES),
        "master.encoder_scaling": draw(scalings),
        "master.period": draw(periods),
        "master.position": length * draw(st.floats(-3.0, 3.0)),
        "master.velocity": length * draw(st.sampled_from((0.0, 1.0, -1.0, 2.0))),
        "master.acceleration": length * draw(st.sampled_from((0.0, 0.0, 1.0))),
        "axis.initial_position": length * draw(st.floats(-3.0, 3.0)),
        "axis.initial_velocity": length * draw(st.sampled_from((0.0, 0.0, 0.5, -1.5))),
        "diagonal_angle": draw(st.sampled_from((0.0, 0.0, 30.0, -89.0))),
        **{f"axis.max_{name}": length * size for name, size in DYNAMICS.items()},
        "axis.max_deceleration": length * draw(st.sampled_from((0.0, DYNAMICS["deceleration"]))),
        "axis.min_position": draw(st.sampled_from((-1e9, -2.0 * length))),
        "axis.max_position": draw(st.sampled_from((1e9, 2.0 * length))),
        **{f"{group}.execute": draw(st.sampled_from((False, False, True))) for group in GROUPS},
    }
    extreme = draw(st.sampled_from((0.0, 0.0, 0.02)))
    commands = draw(st.sampled_from((0.01, 0.1, 0.4)))
    return BlockRun(
        start, list(_steps(Random(draw(st.integers(0, 2**32 - 1))), start, length, steps, extreme, commands))
    )


def _steps(
    r: Random, start: dict[str, Any], length: float, steps: int, extreme: float, commands: float
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A master that wanders, wrapped or not, and commands; `extreme` and `commands` are probabilities a step."""
    master = WanderingMaster(r, start, length)
    held: set[str] = set()
    for _ in range(steps):
        h, values = master.begin_step()
        for group in sorted(held):
            if r.random() < 0.5:
                values[f"{group}.execute"] = False
        held -= {name.split(".")[0] for name in values}
        if r.random() < commands:
            group = r.choice(GROUPS)
            held.add(group)
            order = _order(r, group, length, master.position, master.velocity)
            values |= {f"{group}.{name}": value for name, value in order.items()}
            values[f"{group}.execute"] = True
            values |= {f"sync_mode.{name}": r.random() < 0.15 for name in MODES}
            if group == "gear_in_velo" and r.random() < 0.5:
                bits = ("time_based", "rollback_lock", "instant_stop_on_rollback")
                values |= {f"sync_mode.{name}": name == "time_based" or r.random() < 0.5 for name in bits}
        if r.random() < extreme:  # the command's values last; the master is set anew in every step
            name = r.choice(
                ("master.position", "master.velocity", "master.acceleration", "gear_in_velo.ratio_numerator")
            )
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            name = r.choice(("gear_in_pos.slave_sync_position", "move_absolute.position", "axis.max_jerk", "halt.jerk"))
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            h = r.choice((0.0, -h, math.nan, math.inf, 1e6, 1.1e6, 5e-324))
        yield h, values
        master.end_step(h)


def _order(r: Random, group: str, length: float, position: float, velocity: float) -> dict[str, Any]:
    """The values of a command: mostly feasible ones, now and then a wrong one."""
    values: dict[str, Any] = {}
    for name in LIMITS.get(group, ()):
        if r.random() < 0.5:
            values[name] = length * DYNAMICS[name] * r.choice((0.0, 0.3, 1.0, 10.0, 1e-3))
    wrong = r.random() < 0.05
    if group in ("gear_in_velo", "gear_in_pos"):
        values["ratio_numerator"] = 0.0 if wrong else r.choice((1.0, 0.5, -1.0, r.gauss(0.0, 1.0)))
        values["ratio_denominator"] = r.choice((1, 1, 2, 7))
    if group == "gear_in_pos":
        ahead = math.copysign(length, velocity)
        values["master_sync_position"] = position + ahead * r.choice((0.5, 1.0, 3.0, -0.1))
        values["slave_sync_position"] = length * r.gauss(0.0, 5.0)
        values["master_start_distance"] = length * r.choice((0.0, 0.0, 0.3, 1.0, -0.1 if wrong else 2.0))
    if group == "move_velocity":
        values["velocity"] = length * (r.choice((0.0, 1.0, -1.0, r.gauss(0.0, 1.0))) if not wrong else 10.0)
    if group == "move_absolute":
        values["position"] = length * r.gauss(0.0, 3.0) if not wrong else 2e9
    return values


def watch(block: FlyingSaw) -> set[Any]:
    """What is worth meeting of the block's present state."""
    acceleration = block.master.begin_acceleration
    counts = coupling_acceleration(block.master, acceleration) == acceleration
    return {
        ("state", block.state),
        ("PLCopen", block.plcopen_state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("profile", block.characteristics.profile),
        ("limit", block.local.exceeded_limit),
        *([("master's acceleration counts", counts)] if block.stage == Stage.PROFILE else []),
        *([("parked", _time_based_before_sync(block.active_request.mode))] if block.stage == Stage.PARKED else []),
    }


def _time_based_before_sync(mode: SyncMode) -> bool:
    """Whether a saw that is parked was surely on a time-based way into sync: in sync the lock alone would park it."""
    return mode.time_based and not mode.rollback_lock


# The faults that are not rare: the shapes that break the other checks have tests of their own.
OFTEN = (
    Fault.NONE,
    Fault.SLAVE_MOVING,
    Fault.FACTOR,
    Fault.MASTER_STANDING,
    Fault.TIME_BASED,
    Fault.LIMIT,
    Fault.NOT_AHEAD,
    Fault.CHECK,
    Fault.LOCKED,
)
STRATEGY = Strategy(
    runs,
    watch,
    frozenset(
        {
            *(("state", state) for state in State),
            *(("PLCopen", state) for state in PlcopenState),
            *(("mode", mode) for mode in MasterInput),
            *(("fault", fault) for fault in OFTEN),
            *(("limit", limit) for limit in Limit if limit != Limit.INSTANT_STOP),
            *(("master's acceleration counts", counts) for counts in (False, True)),
            *(("parked", time_based_before_sync) for time_based_before_sync in (False, True)),
            *(("profile", kind) for kind in (ProfileKind.NONE, ProfileKind.P5, ProfileKind.JERK_LIMITED)),
        }
    ),
    requests=("motion_request.", "new_request."),
)
