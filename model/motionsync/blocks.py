"""The registered blocks: one entry each under its class's name, with the run that the block's documentation shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .flying_saw.block import FlyingSaw
from .follower.block import Follower
from .gearing.block import Gearing
from .remote_sync.block import RemoteSync
from .synchronizer.block import Synchronizer


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
class RemoteExample:
    """A run with an axis at constant velocity on another controller, known by its telegrams.

    Attributes:
        caption: what the picture of the run shows.
        velocity: the axis', in u/s; it begins at position 0.
        sender_cycle: of the controller that sends the telegrams, s.
        duration: in s.
        start: start values of parameters.
        variants: runs that are shown beside one another: what each is called, and further start values.
        unit: of positions, in the picture that shows the numbers as they are here.
    """

    caption: str
    velocity: float
    sender_cycle: float
    duration: float
    start: Mapping[str, Any]
    variants: Mapping[str, Mapping[str, Any]]
    unit: str = "mm"


@dataclass(frozen=True)
class Registered:
    """A block and what its documentation shows.

    Attributes:
        guide: how to use it, step by step; `code` in backticks.
        names: what the source system calls something, and what it is here.
    """

    type: type[Any]
    example: Example | RemoteExample
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
    "Gearing": Registered(
        Gearing,
        Example(
            "Engaged at 0.2 s, the slave comes on to the line through the reference position 150 while the master "
            "passes 100 to 200 (shaded: in gear). Told at 3 s to disengage, it rests at exactly 300. At 5.5 s it is "
            "engaged again, in 1.5 s and through 595: to get there it has to be faster than the master for a while.",
            velocity=100.0,
            duration=8.0,
            start={
                "master.velocity": 100.0,
                "gear_in.reference_position": 150.0,
                "gear_out.stop_mode": 4,
                "gear_out.stop_position": 300.0,
            },
            inputs=(
                (0.2, {"start": True}),
                (3.0, {"start": False}),
                (
                    5.5,
                    {
                        "gear_in.reference_position": 595.0,
                        "gear_in.transition": 3,
                        "gear_in.time": 1.5,
                        "start": True,
                    },
                ),
            ),
            shaded="in_gear",
        ),
        guide=(
            "Say how far the slave travels per master, as a ratio of whole numbers: `gearing.numerator`, "
            "`gearing.denominator`. A rotary axis has a `master.period` or `slave.period`.",
            "Choose through which point the line of both axes runs: with a reference position (`gear_in.start_mode` 4 "
            "to 6) the slave's present position belongs to the master's `gear_in.reference_position` + "
            "`gear_in.offset`; direct (1 to 3) it belongs to where the master is; 7 continues on the former line.",
            "Choose the transition: none, over a `gear_in.distance` of the master (it begins half of that before the "
            "reference position, at `local.trigger_position`), or within a `gear_in.time`.",
            "A rising edge of `start` engages. `state` tells what the slave does, `in_gear` that it is on the line.",
            "A falling edge of `start` disengages, anywhere or at `gear_out.stop_position`, with a transition of its "
            "own: `gear_out.stop_mode`, `gear_out.transition`.",
            "What a transition needs is read at the edge and kept to its end; a change of the ratio takes effect at "
            "once, without a jump in position.",
            "`activate` false stops the slave where it is. Meanwhile `set_master` and `set_slave` lay the synchronous "
            "point on which `gear_in.start_mode` 7 continues.",
        ),
        names=(
            ("xStart", "`start`"),
            ("eGearingState", "`state`, as a plain integer `state_code`"),
            ("lrGearInReferencePosition", "`gear_in.reference_position`"),
            ("lrGearInDistance", "`gear_in.distance`"),
            ("lrGearInTime", "`gear_in.time`"),
            ("configured direction", "CW or CCW in `gear_in.start_mode`, `gear_out.stop_mode`"),
            ("attachment point of the lines", "the reference position, with the slave's position at the edge"),
            ("trigger position", "`local.trigger_position`"),
        ),
    ),
    "Follower": Registered(
        Follower,
        Example(
            "One cycle of the master is 1000. The slave is positioned to its park at 0 and leaves it where the master "
            "passes 200; it meets the master at 400, the slave being at 100, runs with it up to 300, brakes over 100, "
            "and is back at its park where the next way begins.",
            velocity=250.0,
            duration=10.0,
            start={"master.period": 1000.0, "master.velocity": 250.0, "sync_master": 400.0},
            inputs=((0.2, {"position_to_park": True}),),
        ),
        guide=(
            "Connect the master; for a rotary one set `master.period`. It must move forwards; it may stop at any time.",
            "Say where the slave is: `park_slave`, where it rests; `sync_slave`, where it meets the master; "
            "`sync_out`, where the synchronized phase ends. `slave_cycle` 0 is a linear slave, which brakes over "
            "`space_stop_slave` and comes back; else a cyclic one, which goes on to its park, or past it without a "
            "stop if `stop_in_park` is false.",
            "Say where the master is: a meeting lies at `sync_master` in each `master_cycle`; `align_center` puts the "
            "middle of the synchronized phase there. With `variable_cycle` each new value of `sync_master` is one "
            "meeting: set it while the cycle before is in M_FOLLOWING or M_SYNCHRONIZED, at least `master_cycle` after "
            "that one's meeting.",
            "Give a rising edge of `position_to_park`: the slave moves to its park and waits for the next start. After "
            "an interruption in the middle of a cycle whose master stands, `position_to_cycle` takes it to where the "
            "cycle has it.",
            "`k_slave_master` is the slave's velocity over the master's in sync. Other units for the slave, degrees "
            "say: build with `--slave-unit deg`; then it is in deg/mm.",
            "In the cycle: `end_synchronism` ends the synchronized phase here and now; `skip_next_cycle` and "
            "`sync_assumed` keep the slave at its park at the next start; `stop_after_forward` holds a linear slave at "
            "the end of its stroke.",
            "`max_speed` and `max_acceleration` are watched: beyond them, or with parameters that leave no room, the "
            "slave stops along a ramp in M_IN_ALARM and `error_id` tells why. Then a rising edge of `reset` and a new "
            "positioning.",
        ),
        names=(
            ("masterCycle, qSyncMaster", "`master_cycle`, `sync_master`"),
            ("slaveCycle, qParkSlave, qSyncSlave, qSyncOut", "`slave_cycle`, `park_slave`, `sync_slave`, `sync_out`"),
            ("spaceStopSlave, spaceWaitInPark", "`space_stop_slave`, `space_wait_in_park`"),
            ("kSlaveMaster", "`k_slave_master`"),
            ("maxSpe, maxAcc", "`max_speed`, `max_acceleration`"),
            ("velPositSlave, accPositSlave, jerkPositSlave", "`positioning.velocity`, `.acceleration`, `.jerk`"),
            ("command bit 0", "`skip_next_cycle`"),
            ("command bits 1, 2", "`position_to_park`, `position_to_cycle`"),
            ("command bit 3", "`end_synchronism`"),
            ("command bit 4", "`stop_after_forward`"),
            ("command bit 5", "`sync_assumed`"),
            ("command bit 16", "`variable_cycle`"),
            ("command bits 17, 18", "not `check_speed`, not `check_acceleration`"),
            ("command bit 19", "`align_center`"),
            ("command bit 20", "`stop_in_park`"),
            ("command bit 21", "`recover_late_sync`"),
            ("the function's result, errorCode", "`state`, as a plain integer `state_code`; `error_id`"),
        ),
    ),
    "RemoteSync": Registered(
        RemoteSync,
        RemoteExample(
            "An axis moves with 1000 mm/s on a controller whose clock runs 2000 ppm fast; telegrams come every 2 ms. "
            "As received, its position is up to 2 mm old, and jumps at each beat. Once two beats have been seen the "
            "drift is known, and both estimators follow the axis: BEAT anew from beat to beat, PHASE evenly.",
            velocity=1000.0,
            sender_cycle=0.002 / 1.002,
            duration=4.5,
            start={"task_cycle_time": 0.002, "slope1_numerator": 0.5},
            variants={"BEAT": {"estimator": 1}, "PHASE": {"estimator": 2}},
        ),
        guide=(
            "Wire the telegram: `remote.cycle_index`, the sender's cycle counter of 16 bits, and `remote.position`, "
            "`remote.velocity`, `remote.acceleration` of that cycle. Say how long the cycles are: `task_cycle_time`, "
            "the receiver's; `data_cycle_time`, the sender's nominal one, if it is another.",
            "Wire `slave.position`, `slave.velocity`, `slave.acceleration` to the master of whatever follows the "
            "remote axis. They belong to the cycle's instant; `delay_time_offset` = `task_cycle_time` gives those of "
            "the step's end, which a follower sees one step later in a parallel co-simulation (START_OF_STEP), at "
            "once in a sequential one (END_OF_STEP).",
            "Choose the `estimator`. BEAT does what the source does, its corrected index swings by up to half a cycle "
            "with the default slopes; `slope1_numerator` 0.5 with `slope1_denominator` 0.5 is uniform and more even. "
            "PHASE stays within a few hundredths of a cycle, for equal cycle times.",
            "Until two beats have been seen (`start_up`), values are as `start_up_mode` says; then `synced` holds and "
            "`drift` tells the clocks' difference in ppm: a beat comes every 1e6 / drift cycles. Without any drift "
            "there is no beat, and TIME is as good.",
            "For a slower sender BEAT's values are one data cycle old, as the source's are: add `data_cycle_time` to "
            "`delay_time_offset`.",
            "A connection that is lost for more than `age_of_data_limit` cycles, or an index that steps by more than "
            "`max_cycle_index_difference`, leads to `fall_back_mode` over `blending_time`, and `error_id` tells why. A "
            "rising edge of `enable`, or `automatic_reinit`, begins anew.",
        ),
        names=(
            ("bEnable", "`enable`"),
            ("iCycleIndex", "`remote.cycle_index`"),
            ("fTaskCycleTime, fDataCycleTime", "`task_cycle_time`, `data_cycle_time`"),
            ("fThresholdForSync", "`threshold_for_sync`"),
            ("iNoOfPeriodsForMeanDrift", "`periods_for_mean_drift`"),
            ("fDelayTimeOffset", "`delay_time_offset`"),
            ("iEndOfTransitionLimit", "`end_of_transition_limit`"),
            ("iNewDriftBendingCycles", "`new_drift_blending_cycles`"),
            ("iTimeModeBlendingCycles", "`time_mode_blending_cycles`"),
            ("bUseAccForExtrapolation", "`use_acceleration`"),
            ("fBlendingTime", "`blending_time`"),
            ("fCorrectionTime", "`correction_time`"),
            ("bSynced, bStartUp", "`synced`, `start_up`"),
        ),
    ),
}
