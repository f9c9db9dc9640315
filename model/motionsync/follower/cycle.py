"""The cycle of the slave. Source: Robox mv_follow2.

Q is the master position of a meeting, M_f the master's travel on the approach to it. Master positions and travels are
in M, slave positions in S, ratios k in S/M.
"""

from dataclasses import dataclass

from .. import var
from ..numerics.grid import floor
from .cam_section import FAR, CamSection
from .faults import Fault
from .interface import LEAST_LENGTH, FollowerInterface
from .parameters import POSITION_TOLERANCE, ROUNDING, ramp_travel
from .stages import Stage

LONGEST_HOMING = 2.5  # times S_h / k: a longer quintic that starts with d1 = k would run past the park


@dataclass(slots=True)
class CycleState:
    """The stage, its cam section, and the meeting that is ahead or under way.

    `has_meeting`: there is such a meeting, at `meeting` (Q). The slave reaches it over the master's travel
    `approach_travel` (M_f) from its rest at `park`; there it is at `sync_slave`, and the synchronized phase with
    `ratio` (k) ends at `sync_out`. From the end of a synchronized phase on, all this belongs to the next meeting; where
    there is none, `meeting` is the position that the way home is paced for.

    `is_approach_shortened`: so that the master's travel suffices for the way home, too. `return_travel`: the
    undisturbed master travel of a linear slave's way home. `cycle_length` and `wait` are C and space_wait_in_park as
    read for this cycle.

    `last_meeting` is that of the last synchronized phase since a positioning; -FAR: there was none.

    `backward_tolerance`: how far the master may be behind its highest position since the slave has left the park.
    `highest_input` is that position from the inputs alone, `highest_in_step` includes the path inside the present
    step: a prediction that was too high is corrected by the next input, which is no backward travel. `highest` includes
    all predictions; the slave does not go back behind it.

    At the park, no meeting of a fixed cycle is chosen before `earliest_next_meeting`: one before it belongs to the
    cycle that was skipped last. WAITING_NEXT_CYCLE ends where the master is at `next_cycle_from`.
    """

    stage: Stage = Stage.IDLE
    cam_section: CamSection = var.part(CamSection)
    has_meeting: bool = False
    meeting: float = 0.0
    approach_travel: float = 0.0
    is_approach_shortened: bool = False
    park: float = 0.0
    ratio: float = 1.0
    sync_slave: float = 0.0
    sync_out: float = 0.0
    return_travel: float = 0.0
    cycle_length: float = 0.0
    wait: float = 0.0
    last_meeting: float = -FAR
    backward_tolerance: float = 0.0
    highest: float = 0.0
    highest_input: float = 0.0
    highest_in_step: float = 0.0
    earliest_next_meeting: float = -FAR
    next_cycle_from: float = 0.0

    def is_parked(self) -> bool:
        """Whether the slave rests at the park."""
        return self.stage in (Stage.WAITING, Stage.WAITING_NEXT_CYCLE)

    def start(self) -> float:
        """The master's position where the approach to the meeting starts."""
        return self.meeting - self.approach_travel

    def synchronous_travel(self) -> float:
        """The master's travel in the synchronized phase."""
        return (self.sync_out - self.sync_slave) / self.ratio

    def set_meeting(self, parameters: FollowerInterface, meeting: float, approach_travel: float) -> None:
        """Go to that meeting, with the parameters of this instant."""
        self.has_meeting = True
        self.meeting = meeting
        self.approach_travel = approach_travel
        self.ratio = parameters.k_slave_master
        self.sync_slave = parameters.sync_slave
        self.sync_out = parameters.sync_out
        self.cycle_length = parameters.master_cycle
        self.backward_tolerance = POSITION_TOLERANCE * parameters.master_cycle

    # --- the stages: where several laws lead through one stage, the caller sets the law ---

    def enter_idle(self, position: float) -> None:
        """Rest at a position, which need not be the park."""
        self.stage = Stage.IDLE
        self.park = position

    def enter_to_park(self, park: float) -> None:
        self.stage = Stage.TO_PARK
        self.park = park
        self.has_meeting = False

    def enter_to_cycle(self) -> None:
        self.stage = Stage.TO_CYCLE

    def enter_cycle(self, stage: Stage) -> None:
        """TO_CYCLE is over: the cycle goes on in the stage for which it was planned."""
        self.stage = stage

    def enter_waiting(self) -> None:
        self.stage = Stage.WAITING

    def enter_waiting_next_cycle(self, until: float) -> None:
        self.stage = Stage.WAITING_NEXT_CYCLE
        self.next_cycle_from = until

    def enter_following(self) -> None:
        self.stage = Stage.FOLLOWING

    def enter_slowing(self, begin: float, stroke: float) -> None:
        """The ramp down from sync_out to an intermediate stop."""
        self.stage = Stage.SLOWING
        self.cam_section.set_ramp_down(begin, self.sync_out, stroke, self.ratio)

    def enter_pausing(self) -> None:
        """Half of the slave's travel is done: rest until the ramp up starts."""
        self.stage = Stage.PAUSING
        position = self.cam_section.position + self.cam_section.stroke
        end = self.meeting - 2.0 * self.cam_section.stroke / self.ratio
        self.cam_section.set_rest(self.cam_section.end, end, position)

    def enter_synchronized(self) -> None:
        """From the meeting on: sync_slave + k (m - Q), up to sync_out."""
        self.stage = Stage.SYNCHRONIZED
        self.cam_section.set_line(self.meeting, self.meeting + self.synchronous_travel(), self.sync_slave, self.ratio)

    def enter_decel(self, begin: float, stroke: float) -> None:
        """The ramp down from sync_out to the end of the forward stroke."""
        self.stage = Stage.DECEL
        self.cam_section.set_ramp_down(begin, self.sync_out, stroke, self.ratio)

    def enter_holding(self) -> None:
        """Rest at the end of the forward stroke until a command ends it."""
        self.stage = Stage.HOLDING
        self.cam_section.set_rest(self.cam_section.end, FAR, self.cam_section.position + self.cam_section.stroke)

    def enter_homing(self) -> None:
        self.stage = Stage.HOMING

    def enter_braking(self) -> None:
        self.stage = Stage.BRAKING
        self.has_meeting = False

    # --- the way to the meeting ---

    def rest_at(self, park: float) -> None:
        """Rest at the park, without a meeting."""
        self.enter_waiting()
        self.park = park
        self.has_meeting = False
        self.is_approach_shortened = False
        self.last_meeting = -FAR
        self.earliest_next_meeting = -FAR

    def start_approach(self) -> None:
        """From the park to (Q, sync_slave) with d1 = k: a simple jerk ramp; a shorter approach is a quintic."""
        self.enter_following()
        if self.is_approach_shortened:
            begin = self.start()
            travel = self.approach_travel
            self.cam_section.set_quintic(begin, self.meeting, travel, self.park, 0.0, 0.0, self.sync_slave, self.ratio)
        else:
            self.cam_section.set_ramp_up(self.meeting, self.park, self.sync_slave - self.park, self.ratio)
        self.watch_from(self.cam_section.begin)

    def join(self, parameters: FollowerInterface, master: float, meeting: float) -> None:
        """From the rest at the park, or from the way home, to (Q, sync_slave) with d1 = k: a quintic."""
        position = self.park
        d1 = 0.0
        d2 = 0.0
        sync_slave = parameters.sync_slave
        if self.stage == Stage.HOMING:
            position, d1, d2, _ = self.cam_section.at(master)
            sync_slave += parameters.slave_cycle
        travel = meeting - master
        self.enter_following()
        self.is_approach_shortened = False
        self.set_meeting(parameters, meeting, travel)
        self.cam_section.set_quintic(master, meeting, travel, position, d1, d2, sync_slave, self.ratio)
        self.watch_from(master)

    def speed_up(self, slave_cycle: float) -> None:
        """From the intermediate stop to the meeting: the second half of the slave's travel."""
        self.enter_following()
        stop = self.cam_section.position
        self.cam_section.set_ramp_up(self.meeting, stop, self.sync_slave + slave_cycle - stop, self.ratio)

    def end_synchronized_at(self, master: float) -> None:
        """The synchronized phase ends now: the present position replaces sync_out."""
        position, _, _, _ = self.cam_section.at(master)
        self.sync_out = position
        self.cam_section.end = master

    # --- from the end of the synchronized phase on; a fault leaves everything as it was ---

    def try_leave(self, parameters: FollowerInterface, meeting: float, has_meeting: bool, parks: bool) -> Fault:
        """Go on towards the next meeting. `parks`: a cyclic slave goes to its park, else to the meeting at once."""
        if parameters.slave_cycle == 0.0:
            return self.try_decelerate(parameters, meeting, has_meeting)
        if parks:
            return self.try_go_home(parameters, meeting, has_meeting)
        return self.try_go_on(parameters, meeting)

    def try_decelerate(self, parameters: FollowerInterface, meeting: float, has_meeting: bool) -> Fault:
        """A linear slave ramps down. Its way home then takes the travel up to the next start, less the wait."""
        begin = self.cam_section.end
        approach = ramp_travel(parameters, parameters.park_slave)
        stroke = parameters.space_stop_slave
        travel = meeting - approach - parameters.space_wait_in_park - (begin + 2.0 * stroke / self.ratio)
        if not travel > ROUNDING * parameters.master_cycle:
            return Fault.CYCLE_TOO_SHORT
        self.enter_decel(begin, stroke)
        self.retarget(parameters, meeting, has_meeting, approach)
        self.return_travel = travel
        return Fault.NONE

    def try_go_home(self, parameters: FollowerInterface, meeting: float, has_meeting: bool) -> Fault:
        """A cyclic slave goes to its rest at park_slave + slave_cycle. Where the master's travel up to the next meeting
        is too short for simple ramps, way home and approach share it in proportion to the slave's travels."""
        begin = self.cam_section.end
        approach_stroke = parameters.sync_slave - parameters.park_slave
        homing_stroke = parameters.park_slave + parameters.slave_cycle - self.sync_out
        available = meeting - begin - parameters.space_wait_in_park
        if not homing_stroke >= LEAST_LENGTH:
            return Fault.ORDER
        if not available > ROUNDING * parameters.master_cycle:
            return Fault.CYCLE_TOO_SHORT
        ramp = ramp_travel(parameters, parameters.park_slave)
        is_shortened = available < (ramp + 2.0 * homing_stroke / self.ratio) * (1.0 - POSITION_TOLERANCE)
        if is_shortened:
            approach = available * (approach_stroke / (approach_stroke + homing_stroke))
            travel = available * (homing_stroke / (approach_stroke + homing_stroke))
        else:
            approach = ramp
            travel = min(available - approach, LONGEST_HOMING * homing_stroke / self.ratio)
        self.enter_homing()
        end = parameters.park_slave + parameters.slave_cycle
        self.cam_section.set_quintic(begin, begin + travel, travel, self.sync_out, self.ratio, 0.0, end, 0.0)
        self.retarget(parameters, meeting, has_meeting, approach)
        self.is_approach_shortened = is_shortened
        return Fault.NONE

    def try_go_on(self, parameters: FollowerInterface, meeting: float) -> Fault:
        """A cyclic slave goes to the next meeting without parking: with an intermediate stop halfway if the master's
        travel is at least twice what the slave needs, else by a quintic with d1 = k and d2 = 0 at both ends."""
        begin = self.cam_section.end
        distance = parameters.sync_slave + parameters.slave_cycle - self.sync_out
        travel = meeting - begin
        if not distance >= LEAST_LENGTH:
            return Fault.ORDER
        if not travel > ROUNDING * parameters.master_cycle:
            return Fault.CYCLE_TOO_SHORT
        if travel >= (distance / self.ratio + distance / parameters.k_slave_master) * (1.0 - POSITION_TOLERANCE):
            self.enter_slowing(begin, 0.5 * distance)
        else:
            self.enter_following()
            end = parameters.sync_slave + parameters.slave_cycle
            end_ratio = parameters.k_slave_master
            self.cam_section.set_quintic(begin, meeting, travel, self.sync_out, self.ratio, 0.0, end, end_ratio)
        self.retarget(parameters, meeting, True, travel)
        return Fault.NONE

    def retarget(self, parameters: FollowerInterface, meeting: float, has_meeting: bool, approach: float) -> None:
        """The next meeting replaces this one."""
        self.last_meeting = self.meeting
        self.set_meeting(parameters, meeting, approach)
        self.has_meeting = has_meeting
        self.is_approach_shortened = False
        self.park = parameters.park_slave
        self.wait = parameters.space_wait_in_park

    def return_home(self, begin: float, travel: float) -> None:
        """A linear slave goes from rest at the end of its stroke to rest at the park."""
        self.enter_homing()
        position, _, _, _ = self.cam_section.at(begin)
        self.cam_section.set_quintic(begin, begin + travel, travel, position, 0.0, 0.0, self.park, 0.0)

    def release(self, master: float, variable_cycle: bool) -> None:
        """A slave that was held at the end of its stroke returns home, for the first start (earlier by the wait) that
        leaves at least the undisturbed travel. In a variable cycle it takes exactly that travel."""
        travel = self.return_travel
        if not variable_cycle:
            travel = self.start() - self.wait - master
            lacking = self.return_travel - POSITION_TOLERANCE * self.cycle_length - travel
            if lacking > 0.0:
                later = -floor(-lacking / self.cycle_length) * self.cycle_length
                self.meeting += later
                travel += later
        self.return_home(master, travel)

    # --- the undisturbed cycle ---

    def advance_to(self, parameters: FollowerInterface, master: float) -> None:
        """Go through the undisturbed cycle, whose meeting is chosen, up to the stage in which the master is."""
        if self.stage == Stage.FOLLOWING and master < self.cam_section.begin:
            self.enter_waiting()
        for _ in range(6):
            if self.stage == Stage.WAITING or master < self.cam_section.end:
                break
            match self.stage:
                case Stage.FOLLOWING:
                    self.enter_synchronized()
                case Stage.SYNCHRONIZED:
                    variable = parameters.variable_cycle
                    parks = parameters.stop_in_park or variable
                    self.try_leave(parameters, self.meeting + parameters.master_cycle, not variable, parks)
                case Stage.DECEL:
                    self.return_home(self.cam_section.end, self.return_travel)
                case Stage.SLOWING:
                    self.enter_pausing()
                case Stage.PAUSING:
                    self.speed_up(parameters.slave_cycle)
                case _:
                    self.enter_waiting()

    # --- the master's positions ---

    def watch_from(self, master: float) -> None:
        """From now on the master must not fall behind this position."""
        self.highest = master
        self.highest_input = master
        self.highest_in_step = master

    def record_input(self, master: float) -> None:
        """The master's present input counts, and the former step's predictions no longer do."""
        self.highest_input = max(self.highest_input, master)
        self.highest_in_step = self.highest_input

    def shift(self, dropped: float) -> None:
        """The master's positions are from now on smaller by `dropped`."""
        self.cam_section.shift(dropped)
        self.meeting -= dropped
        self.last_meeting -= dropped
        self.highest -= dropped
        self.highest_input -= dropped
        self.highest_in_step -= dropped
        self.earliest_next_meeting -= dropped
        self.next_cycle_from -= dropped
