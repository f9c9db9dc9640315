"""What each block is measured in: steps that are all alike, and the longest ones, in which commands are planned.

What is a block's own stands here; the measuring is the same for all."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.follower.interface import State as FollowerState
from motionsync.gearing.interface import StartMode, StopMode, Transition
from motionsync.gearing.interface import State as GearingState
from motionsync.master import MasterInput
from motionsync.remote_sync.faults import Fault as RemoteFault
from motionsync.remote_sync.interface import MOST_PERIODS, Estimator, Mode, StartUpMode
from motionsync.synchronizer.interface import Curve

VELOCITY = 90.0  # of the axis that moves, u/s
H = 1e-3  # s a step

Values = Mapping[str, Any]
Bounds = tuple[float, float]


@dataclass(frozen=True)
class Axis:
    """The axis that moves: what is set at each step.

    Attributes:
        group: of position, velocity and acceleration.
        counter: an Integer, the count of the axis' cycles; empty if it has none.
    """

    group: str = "master"
    counter: str = ""

    @property
    def motion(self) -> tuple[str, str, str]:
        return f"{self.group}.position", f"{self.group}.velocity", f"{self.group}.acceleration"


@dataclass(frozen=True)
class Steady:
    """A motion without events, over a master at constant velocity.

    Attributes:
        start: parameters and inputs at the initialization.
        begin: what is set before the one step that leads there, with the master at 0 unless told.
        first: how long that step is, s.
        holds: what variables are as long as it lasts.
        counts: what the axis' counter gains a second.
    """

    name: str
    start: Values = field(default_factory=dict)
    begin: Values = field(default_factory=dict)
    first: float = H
    holds: Values = field(default_factory=dict)
    counts: float = 0.0


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
        counts: what the axis' counter gains a second.
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
    counts: float = 0.0


@dataclass(frozen=True)
class Cases:
    """Of a block; the first steady case is the one in which all flavours and hosts are compared."""

    steady: tuple[Steady, ...]
    worst: tuple[Worst, ...]
    axis: Axis = Axis()


def counted(counts: float, time: float) -> int:
    """The axis' counter at a time. It never steps just where a step of a run begins, for such a time is inexact."""
    return math.floor(counts * time + 0.25)


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


# --- Gearing ---

STRAIGHT_IN = {"gear_in.start_mode": StartMode.CW_CCW_DIRECT, "gear_in.transition": Transition.NONE}
STRAIGHT_OUT = {"gear_out.stop_mode": StopMode.CW_CCW_DIRECT, "gear_out.transition": Transition.NONE}
AT_REFERENCE = {"gear_in.start_mode": StartMode.WITH_CW_CCW_REFERENCE_POSITION}
AT_STOP = {"gear_out.stop_mode": StopMode.WITH_CW_CCW_STOP_POSITION}
SHORT = 0.1  # u and H: a transition within the step that begins it
ROTARY = {"master.period": PERIOD, "slave.period": PERIOD, "gearing.numerator": 7, "gearing.denominator": -3}


def engaged(name: str, transition: Transition, *, velocity: float = 500.0, **start: Any) -> Worst:
    """From rest into gear within a step, through a reference position ahead that is drawn anew each time."""
    own = {"gear_in.transition": transition, "gear_in.distance": SHORT, "gear_in.time": SHORT * H}
    return Worst(
        f"engaged, {name}",
        ("start",),
        start=AT_REFERENCE | STRAIGHT_OUT | own | start,
        velocity=velocity,
        ahead={"gear_in.reference_position": ("master.position", (0.6 * SHORT, 0.3))},
        watch=("state_code",),
        planned=((GearingState.ACTIVE,),),
    )


def disengaged(name: str, transition: Transition) -> Worst:
    """Out of gear, into which the step between leads, and to rest within a step: `start` falls at its beginning."""
    own = {"gear_out.transition": transition, "gear_out.distance": SHORT, "gear_out.time": SHORT * H}
    return Worst(
        f"disengaged, {name}",
        ("reset",),
        start=STRAIGHT_IN | AT_STOP | own,
        between=("start",),
        ahead={"gear_out.stop_position": ("slave.position", (0.6 * SHORT, 0.3))},
        watch=("state_code",),
        planned=((GearingState.STOPPED,),),
    )


GEARING = Cases(
    steady=(
        Steady("in gear", start=STRAIGHT_IN, begin={"start": True}, holds={"state_code": GearingState.ACTIVE}),
        Steady(
            "waiting for the reference position",
            begin={"start": True, "gear_in.reference_position": FAR},
            holds={"state_code": GearingState.WAITING_FOR_STARTPOSITION},
        ),
        Steady(
            "in a master-based transition",
            start=STRAIGHT_IN | {"gear_in.transition": Transition.MASTER_BASED, "gear_in.distance": FAR},
            begin={"start": True},
            holds={"state_code": GearingState.GEAR_IN},
        ),
        Steady(
            "in a time-based transition",
            start=STRAIGHT_IN | {"gear_in.transition": Transition.TIME_BASED, "gear_in.time": FAR},
            begin={"start": True},
            holds={"state_code": GearingState.GEAR_IN},
        ),
    ),
    worst=(
        engaged("master-based", Transition.MASTER_BASED),
        engaged("time-based", Transition.TIME_BASED),
        engaged("master-based, rotary axes", Transition.MASTER_BASED, **ROTARY),
        engaged("master-based, many turns", Transition.MASTER_BASED, velocity=TURNS_A_STEP * PERIOD / H, **ROTARY),
        disengaged("master-based", Transition.MASTER_BASED),
        disengaged("time-based", Transition.TIME_BASED),
    ),
)


# --- Follower ---

CYCLES_A_STEP = 5.0
LONG_CYCLE = {"master_cycle": 1e12}
TO_PARK = {"position_to_park": True}  # at standstill on the park: the slave is there at once
LATE = {"variable_cycle": True, "recover_late_sync": True, "stop_in_park": False, "slave_cycle": 500.0}


def passed(
    name: str, state: FollowerState, sync_slave: float, sync_out: float, sync_master: float, first: float
) -> Steady:
    """One way of a cycle that lasts longer than any benchmark; the first step passes what is before it."""
    return Steady(
        name,
        start=LONG_CYCLE
        | {"sync_slave": sync_slave, "sync_out": sync_out, "space_stop_slave": 1.0, "sync_master": sync_master},
        begin=TO_PARK,
        first=first,
        holds={"state_code": state},
    )


FOLLOWER = Cases(
    steady=(
        passed("with the master", FollowerState.M_SYNCHRONIZED, 1.0, FAR, 10.0, 1.0),
        passed("waiting at the park", FollowerState.M_WAITING, 1.0, 2.0, FAR, H),
        passed("on the way to the meeting", FollowerState.M_FOLLOWING, FAR, 2.0 * FAR, 2.0 * FAR + 10.0, 1.0),
        passed("on the way home", FollowerState.M_HOMING, 1.0, 2.0, 10.0, 1.0),
        Steady(
            "in a positioning, cruising",
            start={"slave.initial_position": FAR},
            begin=TO_PARK,
            first=1.0,
            holds={"state_code": FollowerState.M_POSITIONING},
        ),
    ),
    worst=(
        Worst(
            "position_to_park",
            ("position_to_park",),
            start=LONG_CYCLE | {"sync_master": 0.9e12},
            pause=10.0,
            draws={"park_slave": (-1000.0, 90.0)},
            watch=("state_code",),
            planned=((FollowerState.M_POSITIONING,),),
        ),
        *(
            Worst(
                f"position_to_cycle, {name}",
                ("position_to_cycle",),
                start=start,
                velocity=0.0,
                pause=10.0,
                draws={"sync_master": (0.0, 1000.0)},
                watch=("state_code",),
                planned=((FollowerState.M_POSITIONING,),),
            )
            for name, start in (
                ("linear", {}),
                ("cyclic", {"slave_cycle": 500.0}),
                ("cyclic without parking", {"slave_cycle": 500.0, "stop_in_park": False}),
            )
        ),
        *(
            Worst(
                f"{CYCLES_A_STEP:.0f} cycles in the step, {name}",
                ("reset",),
                start=start,
                velocity=CYCLES_A_STEP * 1000.0 / H,
                between=("position_to_park",),
                watch=("state_code",),
                planned=tuple((state,) for state in FollowerState if state >= FollowerState.M_WAITING),
            )
            for name, start in (
                ("linear", {}),
                ("cyclic", {"slave_cycle": 500.0}),
                ("cyclic without parking", {"slave_cycle": 500.0, "stop_in_park": False}),
            )
        ),
        Worst(
            "a late meeting is joined, limits checked",
            ("reset",),
            start=LATE | {"max_speed": 1e5, "max_acceleration": 1e9},
            pause=10.0,
            between=("position_to_park",),
            ahead={"sync_master": ("master.position", (20.0, 190.0))},
            watch=("state_code",),
            planned=((FollowerState.M_FOLLOWING,),),
        ),
    ),
)


# --- RemoteSync ---

RATE = 1.0 / H  # of a sender whose cycle is H, 1/s
FAST = 1.002 * RATE  # its clock fast by 2000 ppm: a beat every 500 cycles
BEATING = 1.5 * RATE  # a beat every 2 cycles: with a limit of 1 it is identified in the second one
EQUAL = {"task_cycle_time": H}
AT_ONCE = {"end_of_transition_limit": 1, "new_drift_blending_cycles": 1, "time_mode_blending_cycles": 1}
TEN_CYCLES = {"task_cycle_time": 0.1 * H, "data_cycle_time": H, "age_of_data_limit": 0}


def receiving(name: str, mode: Mode, counts: float = RATE, begin: Values | None = None, **start: Any) -> Steady:
    holds = {"state_code": mode, "error": False}
    return Steady(name, start=EQUAL | start, begin=begin or {}, holds=holds, counts=counts)


def identified(name: str, cycles: Values, estimator: Estimator, periods: int = 1) -> Worst:
    """A beat in each step: only as long as each is identified the values stay in sync."""
    own = {"estimator": estimator, "periods_for_mean_drift": periods, "threshold_for_sync": 10.0}
    return Worst(
        name,
        (),
        start=cycles | own | AT_ONCE,
        watch=("state_code", "error_id"),
        planned=((Mode.SYNC, RemoteFault.NONE),),
        counts=BEATING,
    )


REMOTE_SYNC = Cases(
    steady=(
        receiving("TIME, clocks alike", Mode.TIME),
        receiving("BYPASS, disabled", Mode.BYPASS, begin={"enable": False}),
        receiving("PT1, clocks alike", Mode.PT1, start_up_mode=StartUpMode.PT1),
        receiving("SYNC by BEAT", Mode.SYNC, FAST),
        receiving("SYNC by PHASE", Mode.SYNC, FAST, estimator=Estimator.PHASE),
        Steady("after a fault", start=EQUAL, holds={"state_code": Mode.PT1, "error_id": RemoteFault.AGE_OF_DATA}),
    ),
    worst=(
        identified("a beat identified by BEAT", EQUAL, Estimator.BEAT, MOST_PERIODS),
        identified("a beat identified by PHASE", EQUAL, Estimator.PHASE),
        identified("the same by BEAT, 10 cycles in the step", TEN_CYCLES, Estimator.BEAT, MOST_PERIODS),
    ),
    axis=Axis("remote", "remote.cycle_index"),
)


CASES: Mapping[str, Cases] = {
    "Synchronizer": SYNCHRONIZER,
    "FlyingSaw": FLYING_SAW,
    "Gearing": GEARING,
    "Follower": FOLLOWER,
    "RemoteSync": REMOTE_SYNC,
}
