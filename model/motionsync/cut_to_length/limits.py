"""What a machine can do, at a line velocity and for a pitch of the cuts: pure functions, computed before any cut is made.

A cycle leads from the start of one approach to the earliest start of the next: approach, cut, way home, rest at home.
"""

from dataclasses import dataclass


@dataclass(slots=True)
class Machine:
    """What a cycle is computed from. All limits are those in use: none is 0.

    Attributes:
        coupling: k, carriage velocity per line velocity in sync.
        home_position: h, where the carriage waits, u.
        max_position: the upper end position, u.
        max_velocity: of the carriage, u/s.
        approach_distance: the least way from home to the sync position, u; 0: as short as the limits allow.
        approach_reserve: the approach is laid out for a line faster by this share.
        approach_acceleration, approach_jerk: limits of the approach, u/s2 and u/s3.
        homing_velocity, homing_acceleration, homing_deceleration, homing_jerk: limits of the way home.
        homing_settle_time: rest at home before the next start, s.
        by_distance: the cut lasts for the carriage's travel cut_distance, u; else for the time cut_time, s.
        settle_time: in sync before the blade may touch, s.
        on_delay: from the tool's command until the blade touches, s.
        retract_time: from the end of the cut until the blade is clear, s.
        gap_distance, gap_travel: the carriage pulls ahead of the material by so much while it travels so far, u; a
            distance of 0: it does not.
    """

    coupling: float = 1.0
    home_position: float = 0.0
    max_position: float = 1e9
    max_velocity: float = 2000.0
    approach_distance: float = 0.0
    approach_reserve: float = 0.02
    approach_acceleration: float = 10000.0
    approach_jerk: float = 100000.0
    homing_velocity: float = 2000.0
    homing_acceleration: float = 10000.0
    homing_deceleration: float = 10000.0
    homing_jerk: float = 100000.0
    homing_settle_time: float = 0.0
    by_distance: bool = False
    cut_time: float = 0.25
    cut_distance: float = 100.0
    settle_time: float = 0.0
    on_delay: float = 0.0
    retract_time: float = 0.0
    gap_distance: float = 0.0
    gap_travel: float = 100.0
