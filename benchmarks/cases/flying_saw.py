"""What the FlyingSaw is measured in."""

from cases.measured import FAR_AWAY, VELOCITY, Bounds, Cases, Steady, Values, Worst
from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.interface import PlcopenState, State
from motionsync.flying_saw.profile import ProfileKind

P5, P5_P1_P5 = ProfileKind.P5, ProfileKind.P5_P1_P5
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
    """To sync positions ahead by `master` and `slave`, while the slave has the velocity `before` or goes to it."""
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


def refused(name: str, faults: tuple[Fault, ...], slave: Bounds, velocity: Bounds, *bits: str) -> Worst:
    """A gear_in_pos for one of these reasons refused, with a message to the host; its numbers have all their digits."""
    return Worst(
        f"gear_in_pos refused, {name}",
        ("gear_in_pos.execute",),
        start={limit: value + 1.0 / 3.0 for limit, value in LIMITS.items()} | sync_mode(*bits),
        pause=MOVING,
        between=("move_velocity.execute",),
        draws={"move_velocity.velocity": (-500.0, 800.0), "gear_in_pos.velocity": velocity},
        ahead={
            "gear_in_pos.master_sync_position": ("master.position", (400.0, 1000.0)),
            "gear_in_pos.slave_sync_position": ("slave.position", slave),
        },
        watch=("gear_in_pos.error_id",),
        planned=tuple((fault,) for fault in faults),
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


CASES = Cases(
    in_each_mode=1,  # the step that leads into the first one does not do so in each mode
    steady=(
        Steady(
            "in sync",
            start={"axis.initial_velocity": VELOCITY},
            begin={"gear_in_velo.execute": True},
            holds={"state_code": State.SYNCHRON},
        ),
        Steady("at rest", holds={"state_code": State.INACTIVE}),
        Steady(
            "own motion, cruising in a long move",
            begin={"move_absolute.position": FAR_AWAY, "move_absolute.execute": True},
            first=1.0,
            holds={"state_code": State.CONSTANT_VELOCITY},
        ),
        Steady(
            "in the profile",
            begin={
                "gear_in_pos.master_sync_position": FAR_AWAY,
                "gear_in_pos.slave_sync_position": FAR_AWAY,
                "gear_in_pos.execute": True,
            },
            holds={"state_code": State.SYNCHRONIZING, "characteristics.profile": P5},
        ),
        Steady(
            "synchronising, time based",
            start={"axis.max_acceleration": 1e-6, "axis.max_position": 1e12, "sync_mode.time_based": True},
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
        refused("its limits are wrong", (Fault.LIMIT,), (100.0, 1500.0), (-2.0, -1.0)),
        refused("a check is broken", (Fault.CHECK,), (1000.0, 9000.0), (0.0, 0.0), *CHECKS),
        refused(
            "the broken check is reported",
            tuple(fault for fault in Fault if fault > Fault.CHECK),
            (1000.0, 9000.0),
            (0.0, 0.0),
            *CHECKS,
            "detailed_error_codes",
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
