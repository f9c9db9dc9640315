"""What each block is measured in: steps that are all alike, and the longest ones, in which commands are planned.

What is a block's own stands here; the measuring is the same for all."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from motionsync.flying_saw.block import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.master import MasterInput
from motionsync.transition import Curve

VELOCITY = 90.0  # of the master, u/s
H = 1e-3  # s a step

Values = Mapping[str, Any]
Bounds = tuple[float, float]


@dataclass(frozen=True)
class Steady:
    """A motion without events, over a master at constant velocity.

    Attributes:
        start: parameters and inputs at the initialization.
        begin: what is set before the one step that leads there, with the master at 0 unless told.
        first: how long that step is, s.
        holds: what variables are as long as it lasts.
    """

    name: str
    start: Values = field(default_factory=dict)
    begin: Values = field(default_factory=dict)
    first: float = H
    holds: Values = field(default_factory=dict)


@dataclass(frozen=True)
class Worst:
    """Steps at whose beginning commands are given, each from a state that differs from the one before.

    Attributes:
        start: parameters and inputs at the initialization.
        commands: the Booleans that rise at the steps' beginnings.
        velocity: of the master, u/s.
        pause: how long the step between two of them is, s; then the commands are low.
        between: Booleans that are raised in it.
        draws: Real inputs, drawn from these bounds before it.
        ahead: Real inputs, drawn from these bounds after it and added to the variable of that name.
        watch: integers and enumerations that tell after the step whether the command was planned.
        planned: what they are then, one value each; any of these.
    """

    name: str
    commands: tuple[str, ...]
    start: Values = field(default_factory=dict)
    velocity: float = 500.0
    pause: float = H
    between: tuple[str, ...] = ()
    draws: Mapping[str, Bounds] = field(default_factory=dict)
    ahead: Mapping[str, tuple[str, Bounds]] = field(default_factory=dict)
    watch: tuple[str, ...] = ()
    planned: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class Cases:
    """Of a block; the first steady case is the one in which all flavours and hosts are compared."""

    steady: tuple[Steady, ...]
    worst: tuple[Worst, ...]


# --- Synchronizer ---

PERIOD = 360.0
# Enough for both ramps: the longest step plans one, runs it to its end, plans the stacked one and ends that too.
TURNS_A_STEP = 5.0

SYNCHRONIZER = Cases(
    steady=(
        Steady("on the master", holds={"synchronized": True}),
        Steady(
            "in a ramp",
            start={"output_phasing": 1e9},
            begin={"master.position": -2e9, "stop": True},  # no benchmark comes to its end
            holds={"syn_ramp_on": True},
        ),
    ),
    worst=tuple(
        Worst(
            f"start and stop together, {mode.name}, {curve.name}",
            ("start", "stop"),
            start={"master.period": PERIOD, "master.input_mode": mode, "curve": curve},
            velocity=TURNS_A_STEP * PERIOD / H,
            watch=("state_code",),
            planned=((0,),),
        )
        for mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP)
        for curve in Curve
    ),
)


# --- FlyingSaw ---

P5, P5_P1_P5 = ProfileKind.P5, ProfileKind.P5_P1_P5
FAR = 1e9  # no benchmark gets there
LIMITS = {"axis.max_velocity": 2000.0, "axis.max_acceleration": 1e4, "axis.max_deceleration": 1e4, "axis.max_jerk": 1e5}
SETTLED, MOVING = 0.5, 0.05  # s: after move_velocity the slave is without acceleration, or in the midst of it
CHECKS = (
    *("check_min_position", "check_max_position", "check_max_velocity", "check_max_acceleration"),
    *("check_max_deceleration", "check_max_jerk", "check_overshoot_position", "check_undershoot_position"),
    *("check_overshoot_velocity", "check_undershoot_velocity", "check_overshoot_velocity_zero"),
    "check_undershoot_velocity_zero",
)


def sync_mode(*bits: str) -> Values:
    return {f"sync_mode.{bit}": True for bit in bits}


def gear_in_pos(
    name: str,
    kinds: tuple[ProfileKind, ...],
    master: Bounds,
    slave: Bounds,
    *bits: str,
    before: Bounds = (-500.0, 800.0),
    pause: float = SETTLED,
    velocity: float = 500.0,
    limits: Values | None = None,
) -> Worst:
    """To sync positions so far ahead, from a velocity `before` or on the way to it."""
    return Worst(
        f"gear_in_pos, {name}",
        ("gear_in_pos.execute",),
        start=LIMITS | sync_mode(*bits) | (limits or {}),
        velocity=velocity,
        pause=pause,
        between=("move_velocity.execute",),
        draws={"move_velocity.velocity": before},
        ahead={
            "gear_in_pos.master_sync_position": ("master.position", master),
            "gear_in_pos.slave_sync_position": ("slave.position", slave),
        },
        watch=("state_code", "characteristics.profile"),
        planned=tuple((State.SYNCHRONIZING, kind) for kind in kinds),
    )


def gear_in_velo(name: str, kind: ProfileKind, *bits: str) -> Worst:
    return Worst(
        f"gear_in_velo, {name}",
        ("gear_in_velo.execute",),
        start=LIMITS | sync_mode(*bits),
        pause=MOVING,
        between=("move_velocity.execute",),
        draws={"move_velocity.velocity": (-500.0, 800.0), "gear_in_velo.ratio_numerator": (-1.0, 2.0)},
        watch=("state_code", "characteristics.profile"),
        planned=((State.SYNCHRONIZING, kind),),
    )


FLYING_SAW = Cases(
    steady=(
        Steady(
            "in sync",
            start={"axis.initial_velocity": VELOCITY},
            begin={"gear_in_velo.execute": True},
            holds={"state_code": State.SYNCHRON},
        ),
        Steady("standing", holds={"state_code": State.INACTIVE}),
        Steady(
            "own motion, cruising in a long move",
            begin={"move_absolute.position": FAR, "move_absolute.execute": True},
            first=1.0,
            holds={"state_code": State.CONSTANT_VELOCITY},
        ),
        Steady(
            "in the profile",
            begin={
                "gear_in_pos.master_sync_position": FAR,
                "gear_in_pos.slave_sync_position": FAR,
                "gear_in_pos.execute": True,
            },
            holds={"state_code": State.SYNCHRONIZING, "characteristics.profile": P5},
        ),
        Steady(
            "synchronising, time based",
            start={"axis.max_acceleration": 1e-6, "axis.max_deceleration": 1e-6, "sync_mode.time_based": True},
            begin={"gear_in_velo.execute": True},
            holds={"state_code": State.SYNCHRONIZING, "characteristics.profile": ProfileKind.JERK_LIMITED},
        ),
    ),
    worst=(
        gear_in_pos("P5", (P5,), (50.0, 1000.0), (25.0, 1500.0)),
        gear_in_pos(
            "P5 from acceleration, all checks",
            (P5,),
            (-200.0, -190.0),
            (-155.0, -130.0),
            *CHECKS,
            before=(-450.0, 0.0),
            pause=MOVING,
            velocity=-500.0,
            limits={"move_velocity.acceleration": 500.0, "move_velocity.deceleration": 500.0},
        ),
        gear_in_pos(
            "P1+P5 or P5+P1",
            (ProfileKind.P1_P5, ProfileKind.P5_P1),
            (900.0, 1000.0),
            (250.0, 880.0),
            *("check_overshoot_velocity", "check_undershoot_velocity"),
            before=(-500.0, 100.0),
        ),
        gear_in_pos(
            "P5+P1+P5, prefer_constant_velocity, jerk",
            (P5_P1_P5,),
            (400.0, 1000.0),
            (100.0, 1500.0),
            *("prefer_constant_velocity", "check_max_jerk"),
        ),
        gear_in_pos(
            "P5+P1+P5 at the velocity limit",
            (P5_P1_P5,),
            (400.0, 500.0),
            (500.0, 560.0),
            "check_max_velocity",
            before=(0.0, 300.0),
            limits={"gear_in_pos.velocity": 800.0},
        ),
        gear_in_velo("jerk", P5, "check_max_jerk"),
        gear_in_velo("time based", ProfileKind.JERK_LIMITED, "time_based"),
        Worst(
            "move_absolute",
            ("move_absolute.execute",),
            start=LIMITS,
            pause=MOVING,
            between=("move_velocity.execute",),
            draws={"move_velocity.velocity": (-500.0, 800.0)},
            ahead={"move_absolute.position": ("slave.position", (-1000.0, 1000.0))},
            watch=("plcopen_state",),
            planned=((PlcopenState.DISCRETE_MOTION,),),
        ),
    ),
)

CASES: Mapping[str, Cases] = {"Synchronizer": SYNCHRONIZER, "FlyingSaw": FLYING_SAW}
