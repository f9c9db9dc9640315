"""The registered blocks: one entry each under its class's name, with the run that the block's documentation shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .flying_saw.block import FlyingSaw
from .synchronizer import Synchronizer


@dataclass(frozen=True)
class Example:
    """A run with a master at constant velocity that shows what the block is for.

    Attributes:
        caption: what the picture of the run shows.
        velocity: the master's, in u/s; it begins at position 0.
        duration: in s.
        start: start values of parameters and inputs.
        inputs: what is set when: (time in s, values).
        unit: of positions, in the picture that shows the numbers as they are here.
        shaded: a Boolean output; the picture is shaded where it is true. Empty: nothing is.
    """

    caption: str
    velocity: float
    duration: float
    start: Mapping[str, Any]
    inputs: tuple[tuple[float, Mapping[str, Any]], ...]
    unit: str = "mm"
    shaded: str = ""


@dataclass(frozen=True)
class Registered:
    """A block and what its documentation shows.

    Attributes:
        guide: how to use it, step by step; `code` in backticks.
        names: what the source system calls something, and what it is here.
    """

    type: type[Any]
    example: Example
    guide: tuple[str, ...]
    names: tuple[tuple[str, str], ...] = ()


BLOCKS: Mapping[str, Registered] = {
    "Synchronizer": Registered(
        Synchronizer,
        Example(
            "One turn is 360. A stop at rest_value 180, then a start: the slave leaves the master at 90 and rests at "
            "180; it leaves its rest at 101.25 of the next turn and is back on the master at 270.",
            velocity=180.0,
            duration=4.0,
            start={"master.period": 360.0, "master.velocity": 180.0, "rest_value": 180.0},
            inputs=((0.2, {"stop": True}), (1.8, {"start": True})),
            unit="deg",
        ),
        guide=(
            "Connect the master; for a rotary axis set `master.period`.",
            "`output_phasing` is the slave's travel during a transition. Its sign is the direction in which the master "
            "travels when commands shall be executed. It is read at the edge of either command.",
            "A rising edge of `stop` brings the slave to rest at exactly `rest_value`, read at the edge; one of "
            "`start` "
            "takes it from there back on to the master.",
            "Give a command before the master reaches the ramp (`local.ramp_begin`). Given too late, it waits for "
            "the next "
            "turn.",
        ),
    ),
    "FlyingSaw": Registered(
        FlyingSaw,
        Example(
            "The material comes at 250 mm/s; a cut is due every 500 mm. The saw, at rest at 0, meets the mark where it "
            "passes 100 (shaded: in sync), is sent home at 1.6 s, and on its way back gets the order for the next cut.",
            velocity=250.0,
            duration=4.4,
            start={
                "master.velocity": 250.0,
                "gear_in_pos.master_sync_position": 250.0,
                "gear_in_pos.slave_sync_position": 100.0,
                "move_absolute.velocity": 600.0,
                "axis.max_acceleration": 2500.0,
                "axis.max_deceleration": 2500.0,
                "axis.max_jerk": 25000.0,
            },
            inputs=(
                (0.2, {"gear_in_pos.execute": True}),
                (1.6, {"gear_in_pos.execute": False, "move_absolute.execute": True}),
                (
                    2.35,
                    {
                        "gear_in_pos.master_sync_position": 750.0,
                        "gear_in_pos.execute": True,
                        "move_absolute.execute": False,
                    },
                ),
                (3.6, {"gear_in_pos.execute": False, "move_absolute.execute": True}),
            ),
            shaded="in_sync",
        ),
        guide=(
            "Say what the axis can do: `axis.max_velocity`, `axis.max_acceleration`, `axis.max_deceleration`, "
            "`axis.max_jerk`, and where it starts: `axis.initial_position`.",
            "Order a cut: set `gear_in_pos.master_sync_position` (where the material's mark is) and "
            "`gear_in_pos.slave_sync_position` (where the saw is) of the instant from which both shall be in sync, "
            "then "
            "give a rising edge of `gear_in_pos.execute`. Both positions must lie ahead, and the master must move. "
            "`gear_in_velo` instead takes the saw to the material's velocity as fast as the limits allow.",
            "While `in_sync` holds, slave = slave_sync_position + factor (master - master_sync_position), exactly: "
            "cut.",
            "Send the saw home: a rising edge of `move_absolute.execute` uncouples it and moves it to "
            "`move_absolute.position`. (`gear_out` only uncouples: the saw then runs on at its velocity for ever.)",
            "Order the next cut on the way back, as soon as the saw is before its next sync position.",
            "The profile into sync is free unless `sync_mode` asks for more: each check has the limits of the "
            "command (0: "
            "the axis's) kept, by another profile or by refusing the command. `gear_in_pos.error_id` tells why; with "
            "`sync_mode.detailed_error_codes`, which check; `local.plan_*`, by how much.",
            "`characteristics.*` tell in advance, at the edge, what the whole way into sync will be like: extremes "
            "and where "
            "they are, mean velocity, effective acceleration.",
            "A diagonal saw: `diagonal_angle`; the slave then travels 1 / cos(angle) of the master's way. A negative "
            "ratio: "
            "`ratio_numerator`. A master that may come back: `sync_mode.rollback_lock`.",
        ),
        names=(
            ("MC_GearInVelo, MC_GearInPos", "`gear_in_velo.*`, `gear_in_pos.*`"),
            ("MC_GearOut", "`gear_out.*`"),
            ("MC_Halt, MC_Stop, MC_Reset", "`halt.*`, `stop.*`, `reset.*`"),
            ("MC_MoveVelocity, MC_MoveAbsolute", "`move_velocity.*`, `move_absolute.*`"),
            ("Execute, Busy, Active, Done", "`.execute`, `.busy`, `.active`, `.done`"),
            ("CommandAborted, Error, ErrorID", "`.command_aborted`, `.error`, `.error_id`"),
            ("StartSync, InSync, InVelocity", "`.start_sync`, `.in_sync`, `.in_velocity`"),
            ("RatioNumerator, RatioDenominator", "`.ratio_numerator`, `.ratio_denominator`"),
            ("Velocity, Acceleration, Deceleration, Jerk", "`.velocity`, `.acceleration`, `.deceleration`, `.jerk`"),
            ("MasterSyncPosition, SlaveSyncPosition", "`.master_sync_position`, `.slave_sync_position`"),
            ("MasterStartDistance (not implemented there)", "`gear_in_pos.master_start_distance`"),
            ("ST_SyncMode: GEARINSYNCMODE_TIMEBASED", "`sync_mode.time_based`"),
            ("GearInSync_CheckMask_MinPos, _MaxPos", "`sync_mode.check_min_position`, `check_max_position`"),
            (
                "..._MaxVelo, _MaxAcc, _MaxDec, _MaxJerk",
                "`sync_mode.check_max_velocity`, `check_max_acceleration`, ...",
            ),
            ("..._OvershootPos, _UndershootPos", "`sync_mode.check_overshoot_position`, `check_undershoot_position`"),
            ("..._OvershootVelo, _UndershootVelo", "`sync_mode.check_overshoot_velocity`, `check_undershoot_velocity`"),
            (
                "..._OvershootVeloZero, _UndershootVeloZero",
                "`sync_mode.check_overshoot_velocity_zero`, `check_undershoot_velocity_zero`",
            ),
            (
                "GearInSync_OpMask_RollbackLock, _InstantStopOnRollback",
                "`sync_mode.rollback_lock`, `instant_stop_on_rollback`",
            ),
            ("..._PreferConstVelo", "`sync_mode.prefer_constant_velocity`"),
            (
                "..._IgnoreMasterAcc, _IgnoreSlaveAcc",
                "`sync_mode.ignore_master_acceleration`, `ignore_slave_acceleration`",
            ),
            ("..._DetailedErrorCodes", "`sync_mode.detailed_error_codes`"),
            ("MC_ReadFlyingSawCharacteristics: fSlaveVeloMax, ...", "`characteristics.slave_velocity_max`, ..."),
            ("nAxisState", "`state`, as a plain integer `state_code`"),
            (
                "software end positions, maximum velocity, ...",
                "`axis.min_position`, `axis.max_position`, `axis.max_velocity`",
            ),
        ),
    ),
}
