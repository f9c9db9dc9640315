"""What a Follower shows to the outside. Source: Robox mv_follow2, whose own names are in brackets."""

from dataclasses import dataclass

from .. import var
from ..master import Master
from ..numerics.computable_range import LARGEST, is_usable
from ..slave import Slave
from ..var import Enumeration, Report, Role, Unit
from .faults import DropReason, Fault

LEAST_LENGTH = 1e-9  # M or S: the least length of a phase's law


class State(Enumeration):
    """What the slave does (the source's phases; -1, 1, 9 and 10 are motionsync's own numbers)"""

    M_IN_ALARM = -1, "it stops or has stopped because of a fault"
    M_IDLE = 1, "it is at rest, and waits for a positioning"
    M_POSITIONING = 2, "it moves to the park or into the cycle"
    M_WAITING = 3, "at the park, until the way to the next meeting starts"
    M_WAITING_NEXT_CYCLE = 4, "at the park, after a start that was missed or not carried out"
    M_FOLLOWING = 5, "on the way to the meeting"
    M_SYNCHRONIZED = 8, "it runs with the master"
    M_DECEL = 9, "linear slave: it slows down after the synchronized phase, or is held there"
    M_HOMING = 10, "back to the park"


@dataclass(slots=True)
class FollowerSlave(Slave):
    """The slave's setpoint at the end of the step, in slave units."""

    initial_position: float = var.parameter(
        0.0, "where the slave is at first", Unit.POSITION, min=-LARGEST, max=LARGEST
    )


@dataclass(slots=True)
class Positioning:
    """Limits of the time-optimal move to the park or into the cycle; read at its command."""

    velocity: float = var.limit(
        500.0, "velocity limit; 0 only if the slave is already at the target (velPositSlave)", Unit.VELOCITY
    )
    acceleration: float = var.limit(
        5000.0,
        "acceleration limit, also of an alarm's stop without max_acceleration; 0 as for velocity (accPositSlave)",
        Unit.ACCELERATION,
    )
    jerk: float = var.limit(50000.0, "jerk limit; 0 as for velocity (jerkPositSlave)", Unit.JERK)

    def limits_usable(self) -> bool:
        """Whether a move can be planned with these limits."""
        return is_usable(self.velocity) and is_usable(self.acceleration) and is_usable(self.jerk)


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    meeting_known: bool = var.local(False, "there is a meeting under way or ahead")
    meeting_position: float = var.snapshot(0.0, "master position of that meeting; 0: none", Unit.POSITION)
    start_position: float = var.snapshot(
        0.0, "master position where the way to that meeting starts; 0: none", Unit.POSITION
    )
    following_travel: float = var.snapshot(0.0, "master travel of the way to that meeting; 0: none", Unit.POSITION)
    progress: float = var.local(0.0, "share of the present phase that is done", min=0.0, max=1.0)
    drop_reason: int = var.local(
        0,
        "why a value of sync_master was dropped, or not joined late, in the last step; 0: none was",
        codes=DropReason,
        report=Report.STEPS,
    )


@dataclass(slots=True)
class FollowerInterface:
    """All variables of a Follower; what it does with them is in `Follower`."""

    master: Master = var.part(Master)
    sync_master: float = var.input(
        0.0,
        "where master and slave meet: within the cycle; with variable_cycle absolute (qSyncMaster)",
        Unit.POSITION,
        discrete=True,
    )
    position_to_park: bool = var.command(False, "rising edge, at standstill: move to the park (command bit 1)")
    position_to_cycle: bool = var.command(
        False, "rising edge, at standstill: move to where the cycle has the slave, and go on (command bit 2)"
    )
    end_synchronism: bool = var.command(
        False, "rising edge in M_SYNCHRONIZED: the present position is this cycle's sync_out (command bit 3)"
    )
    skip_next_cycle: bool = var.input(False, "while set the slave stays at the park (command bit 0)")
    stop_after_forward: bool = var.input(
        False, "while set a linear slave stays at the end of its forward stroke (command bit 4)"
    )
    sync_assumed: bool = var.input(
        False, "while set sync_master is only assumed: the next meeting is not carried out (command bit 5)"
    )
    reset: bool = var.command(False, "rising edge, at standstill: leave M_IN_ALARM and clear the error")
    slave: FollowerSlave = var.part(
        FollowerSlave,
        depends={"position": ("slave.initial_position", "slave_cycle")},
        periods={"position": "slave_cycle"},
        slave_unit=True,
    )
    state: State = var.output(State.M_IDLE, "what the slave does")
    state_code: int = var.output(1, "the state as a plain integer")
    master_to_start: float = var.output(
        0.0, "master travel missing to the start of the way to the meeting; 0: passed, or no meeting", Unit.POSITION
    )
    master_to_sync: float = var.output(0.0, "master travel missing to the meeting; 0: as above", Unit.POSITION)
    master_to_out: float = var.output(
        0.0, "master travel missing to the end of the synchronized phase; 0: as above", Unit.POSITION
    )
    cycle: int = var.output(0, "cycles completed: counted at the end of the synchronized phase")
    error: bool = var.output(False, "a positioning was refused, or the slave is in M_IN_ALARM")
    error_id: int = var.output(0, "why: 1 positioning refused; 2 to 16 alarms", codes=Fault)
    master_cycle: float = var.length(
        1000.0,
        "length C of the master's cycle, not 0; of a variable one the least length (masterCycle)",
        smallest=LEAST_LENGTH,
        zero=False,
    )
    variable_cycle: bool = var.parameter(
        False, "each new value of sync_master is the next meeting (command bit 16); else one meeting a master_cycle"
    )
    slave_cycle: float = var.parameter(
        0.0,
        "0: a linear slave; else a cyclic one's advance in a cycle (slaveCycle)",
        Unit.SLAVE_POSITION,
        min=0.0,
        max=LARGEST,
        smallest=LEAST_LENGTH,
    )
    park_slave: float = var.position(0.0, "where the slave parks (qParkSlave)", Unit.SLAVE_POSITION)
    sync_slave: float = var.position(
        100.0, "where the slave is at the meeting, beyond park_slave (qSyncSlave)", Unit.SLAVE_POSITION
    )
    sync_out: float = var.position(
        300.0,
        "where the synchronized phase ends, beyond sync_slave; cyclic: before park_slave + slave_cycle (qSyncOut)",
        Unit.SLAVE_POSITION,
    )
    space_stop_slave: float = var.length(
        100.0,
        "braking space of a linear slave after sync_out, not 0 (spaceStopSlave)",
        Unit.SLAVE_POSITION,
        smallest=LEAST_LENGTH,
        zero=False,
    )
    space_wait_in_park: float = var.length(0.0, "master travel spent at the park (spaceWaitInPark)")
    k_slave_master: float = var.limit(
        1.0, "slave over master velocity while synchronized, not 0 (kSlaveMaster)", Unit.SLAVE_PER_MASTER, zero=False
    )
    align_center: bool = var.parameter(
        False, "sync_master belongs to the middle between sync_slave and sync_out (command bit 19)"
    )
    stop_in_park: bool = var.parameter(True, "a cyclic slave rests at the park in each cycle (command bit 20)")
    recover_late_sync: bool = var.parameter(
        False,
        "a sync_master set too late is met by joining the running motion, if that is no faster than in a cycle of "
        "master_cycle, and limits allow it (command bit 21)",
    )
    max_speed: float = var.parameter(
        0.0,
        "speed limit; 0: none (maxSpe)",
        Unit.SLAVE_VELOCITY,
        tunable=True,
        min=0.0,
        max=LARGEST,
        role=Role.MAX_VELOCITY,
    )
    max_acceleration: float = var.limit(
        0.0,
        "acceleration limit, and the deceleration of an alarm's stop; 0: none, and positioning.acceleration (maxAcc)",
        Unit.SLAVE_ACCELERATION,
        role=Role.MAX_ACCELERATION,
    )
    check_speed: bool = var.switch(True, "max_speed is checked (not command bit 17)")
    check_acceleration: bool = var.switch(True, "max_acceleration is checked (not command bit 18)")
    positioning: Positioning = var.part(Positioning, slave_unit=True)
    local: Local = var.part(Local)
