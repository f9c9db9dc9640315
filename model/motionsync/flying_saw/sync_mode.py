"""What a synchronisation has to keep to, and how it behaves: TwinCAT's bit mask SyncMode, one Boolean for each bit.

Source: TS5055, sections 5 and 12.3.1.
"""

from dataclasses import dataclass

from .. import var


@dataclass(slots=True)
class SyncMode:
    """Read at the edge of gear_in_velo or gear_in_pos. In TwinCAT all bits are false at first."""

    time_based: bool = var.switch(
        False,
        "synchronise along a profile in time, whatever the master does (GEARINSYNCMODE_TIMEBASED; gear_in_velo only)",
    )
    check_min_position: bool = var.switch(
        True, "refuse a profile below axis.min_position (GEARINSYNC_CHECKMASK_MINPOS, 0x1)"
    )
    check_max_position: bool = var.switch(
        True, "refuse a profile above axis.max_position (GEARINSYNC_CHECKMASK_MAXPOS, 0x2)"
    )
    check_max_velocity: bool = var.switch(True, "keep the velocity limit or refuse (GEARINSYNC_CHECKMASK_MAXVELO, 0x4)")
    check_max_acceleration: bool = var.switch(
        True, "keep the acceleration limit or refuse (GEARINSYNC_CHECKMASK_MAXACC, 0x8)"
    )
    check_max_deceleration: bool = var.switch(
        True, "keep the deceleration limit or refuse (GEARINSYNC_CHECKMASK_MAXDEC, 0x10)"
    )
    check_max_jerk: bool = var.switch(False, "keep the jerk limit or refuse (GEARINSYNC_CHECKMASK_MAXJERK, 0x20)")
    check_overshoot_position: bool = var.switch(
        False, "refuse a position beyond start and sync position (GEARINSYNC_CHECKMASK_OVERSHOOTPOS, 0x100)"
    )
    check_undershoot_position: bool = var.switch(
        False, "refuse a position short of start and sync position (GEARINSYNC_CHECKMASK_UNDERSHOOTPOS, 0x200)"
    )
    check_overshoot_velocity: bool = var.switch(
        False, "no velocity beyond start and synchronous one (GEARINSYNC_CHECKMASK_OVERSHOOTVELO, 0x400)"
    )
    check_undershoot_velocity: bool = var.switch(
        False, "no velocity short of start and synchronous one (GEARINSYNC_CHECKMASK_UNDERSHOOTVELO, 0x800)"
    )
    check_overshoot_velocity_zero: bool = var.switch(
        False,
        "refuse a velocity above zero, at the start too (GEARINSYNC_CHECKMASK_OVERSHOOTVELOZERO, 0x1000)",
    )
    check_undershoot_velocity_zero: bool = var.switch(
        False,
        "refuse a velocity against the synchronous one, at the start too "
        "(GEARINSYNC_CHECKMASK_UNDERSHOOTVELOZERO, 0x2000)",
    )
    rollback_lock: bool = var.switch(
        False,
        "backstop: rest when the master passes the coupling position back (GEARINSYNC_OPMASK_ROLLBACKLOCK, 0x10000)",
    )
    instant_stop_on_rollback: bool = var.switch(
        False, "such a rest is reached at once, not along a ramp (GEARINSYNC_OPMASK_INSTANTSTOPONROLLBACK, 0x20000)"
    )
    prefer_constant_velocity: bool = var.switch(
        False, "a phase of constant velocity between two ramps (GEARINSYNC_OPMASK_PREFERCONSTVELO, 0x100000)"
    )
    ignore_master_acceleration: bool = var.switch(
        False, "plan as if the master had no acceleration (GEARINSYNC_OPMASK_IGNOREMASTERACC, 0x200000)"
    )
    ignore_slave_acceleration: bool = var.switch(
        False, "plan as if the slave had no acceleration (GEARINSYNC_OPMASK_IGNORESLAVEACC, 0x400000)"
    )
    detailed_error_codes: bool = var.switch(
        False, "show which check is broken (GEARINSYNC_OPMASK_DETAILEDERRORCODES, 0x800000)"
    )
