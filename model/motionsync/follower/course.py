"""The cycle of the follower: where on the master its phases lie, and which law each has.

Source: Robox mv_follow2. Q is the master position of a meeting, M_f the master travel of the way to it; master
positions and travels in M, slave positions in S, ratios k in S/M.
"""

from dataclasses import dataclass

from .. import var
from ..grid import floor
from ..limits import MOST, usable
from ..var import Enumeration
from .faults import Fault
from .leg import Leg

LEAST_LENGTH = 1e-9  # least length, M or S, that a phase's law is laid over
SAME_PLACE = 1e-9  # of the master's cycle: places that differ by less are the same
ROUNDING = 1e-12  # of the master's cycle: no room but for rounding
LONGEST_HOMING = 2.5  # times S_h / k: a longer quintic with the slope k at its beginning would run past the park


class Stage(Enumeration):
    """What drives the slave; the state that is put out is coarser"""

    IDLE = 0, "standing, before any positioning"
    TO_PARK = 1, "a motion in time to the park"
    TO_CYCLE = 2, "a motion in time to where the cycle has the slave"
    PARKED = 3, "standing at the park"
    FOLLOWING = 4, "on the way to the meeting"
    SLOWING = 5, "cyclic slave that does not park: ramp down to an intermediate stop"
    PAUSING = 6, "cyclic slave that does not park: the intermediate stop"
    SYNCHRONIZED = 7, "running with the master"
    DECEL = 8, "linear slave: ramp down after the synchronized phase"
    HOLDING = 9, "linear slave: held at the end of the forward stroke"
    HOMING = 10, "back to the park"
    BRAKING = 11, "an alarm's stop ramp in time, then rest"


@dataclass(slots=True)
class Settings:
    """The cycle's parameters as they are read at one instant: `cycle` is C, `turn` the cyclic slave's advance (0: a
    linear slave), `park`, `sync`, `out` the slave's positions, `stop` the braking space, `wait` the master travel spent
    at the park, `ratio` is k."""

    cycle: float = 0.0
    turn: float = 0.0
    park: float = 0.0
    sync: float = 0.0
    out: float = 0.0
    stop: float = 0.0
    wait: float = 0.0
    ratio: float = 1.0

    def fault(self, park: float) -> Fault:
        """3, 4, 5 or none, for a slave that stands at `park`; what is not finite or beyond 1e12 is out of order."""
        if not self.ordered(park):
            return Fault.ORDER
        if not usable(self.ratio):
            return Fault.RATIO
        if not LEAST_LENGTH <= self.cycle <= MOST or not self.room(park) > ROUNDING * self.cycle:
            return Fault.NO_ROOM
        return Fault.NONE

    def startable(self) -> bool:
        """Whether it can be told where a cycle starts, be it a good one or not."""
        known = usable(self.ratio) and LEAST_LENGTH <= self.cycle <= MOST
        return known and bounded(self.sync) and bounded(self.out)

    def waiting(self) -> float:
        """The wait; one that is out of its range counts as 0 until it is judged."""
        return self.wait if 0.0 <= self.wait <= MOST else 0.0

    def ordered(self, park: float) -> bool:
        """park < sync < out, of a cyclic slave < park + turn, and the spaces in their ranges."""
        if not (bounded(park) and bounded(self.sync) and bounded(self.out) and 0.0 <= self.wait <= MOST):
            return False
        if not (self.sync - park >= LEAST_LENGTH and self.out > self.sync):
            return False
        if self.turn > 0.0:
            return park + self.turn - self.out >= LEAST_LENGTH
        return LEAST_LENGTH <= self.stop <= MOST

    def room(self, park: float) -> float:
        """Master travel of a cycle that is left for the way home of a linear slave, and for that and the way to the
        meeting (R) of a cyclic one."""
        room = self.cycle - (self.out - self.sync) / self.ratio - self.wait
        return room if self.turn > 0.0 else room - self.reach(park) - 2.0 * self.stop / self.ratio

    def reach(self, park: float) -> float:
        """M_f of the simple jerk ramp: the master travels twice the slave's way."""
        return 2.0 * (self.sync - park) / self.ratio

    def steady_reach(self) -> float:
        """M_f when one cycle follows another: shorter where a cyclic slave that parks has no room for more."""
        way = self.sync - self.park
        back = self.park + self.turn - self.out
        if self.turn == 0.0 or self.room(self.park) >= 2.0 * (way + back) / self.ratio * (1.0 - SAME_PLACE):
            return self.reach(self.park)
        return self.room(self.park) * (way / (way + back))

    def half(self) -> float:
        """Half the master travel of the synchronized phase."""
        return 0.5 * (self.out - self.sync) / self.ratio


@dataclass(slots=True)
class Course:
    """The cycle under way: the stage, its law, and the meeting that is aimed at or under way.

    `known`: there is such a meeting, at `place` (Q), reached over `reach` (M_f) from the rest at `park`, with `ratio`,
    `sync` and `out`. From the end of a synchronized phase on it is the next one; where that is not known, `place` is
    where it is assumed for the pace of the way home.

    `tight`: `reach` is one that left room for the way home. `pace`: the undisturbed travel of the way home (linear
    slave), `cycle` and `wait` as read at its beginning. `slack`: the master may fall so much behind its greatest
    position since the slave has left the park. That is `given` up to the present input, `peak` within the present
    step: where a prediction was too great, the next input shows it, and the master has not fallen. `largest` holds
    predictions too.
    """

    stage: Stage = Stage.IDLE
    leg: Leg = var.part(Leg)
    known: bool = False
    place: float = 0.0
    reach: float = 0.0
    tight: bool = False
    park: float = 0.0
    ratio: float = 1.0
    sync: float = 0.0
    out: float = 0.0
    pace: float = 0.0
    cycle: float = 0.0
    wait: float = 0.0
    slack: float = 0.0
    largest: float = 0.0
    given: float = 0.0
    peak: float = 0.0

    def start(self) -> float:
        """Where the way to the meeting begins."""
        return self.place - self.reach

    def synchronous(self) -> float:
        """Master travel of the synchronized phase."""
        return (self.out - self.sync) / self.ratio

    def aim(self, settings: Settings, place: float, reach: float) -> None:
        """At a meeting, with the settings of this instant; where the slave parks is another matter."""
        self.known = True
        self.place = place
        self.reach = reach
        self.ratio = settings.ratio
        self.sync = settings.sync
        self.out = settings.out
        self.cycle = settings.cycle
        self.slack = SAME_PLACE * settings.cycle

    # --- the phases, each from its boundary's own numbers ---

    def wait_at(self, park: float) -> None:
        """Rest at the park, without a meeting."""
        self.stage = Stage.PARKED
        self.park = park
        self.known = False
        self.tight = False

    def follow(self) -> None:
        """From the rest at the park to (Q, sync), slope k: a simple jerk ramp, or a quintic where room is short."""
        self.stage = Stage.FOLLOWING
        if self.tight:
            self.leg.curve(self.start(), self.place, self.reach, self.park, 0.0, 0.0, self.sync, self.ratio)
        else:
            self.leg.ramp_up(self.place, self.park, self.sync - self.park, self.ratio)
        self.watch(self.leg.begin)

    def join(self, settings: Settings, master: float, place: float) -> None:
        """From the rest at the park, or from the way home, to (Q, sync), slope k: a quintic."""
        position = self.park
        slope = 0.0
        curvature = 0.0
        sync = settings.sync
        if self.stage == Stage.HOMING:
            position, slope, curvature, _ = self.leg.at(master)
            sync += settings.turn
        travel = place - master
        self.stage = Stage.FOLLOWING
        self.tight = False
        self.aim(settings, place, travel)
        self.leg.curve(master, place, travel, position, slope, curvature, sync, self.ratio)
        self.watch(master)

    def meet(self) -> None:
        """At Q: sync + k (m - Q) up to `out`."""
        self.stage = Stage.SYNCHRONIZED
        self.leg.line(self.place, self.place + self.synchronous(), self.sync, self.ratio)

    def shorten(self, master: float) -> None:
        """The synchronized phase ends here: the present position takes the place of `out`."""
        position, _, _, _ = self.leg.at(master)
        self.out = position
        self.leg.end = master

    def leave(self, settings: Settings, place: float, known: bool, home: bool) -> Fault:
        """From the end of the synchronized phase, towards the next meeting at `place`; settings as read there. A fault
        leaves everything as it was.

        `home`: to the park; else a cyclic slave goes on to the meeting in one movement."""
        if settings.turn == 0.0:
            return self.decelerate(settings, place, known)
        if home:
            return self.go_home(settings, place, known)
        return self.go_on(settings, place)

    def decelerate(self, settings: Settings, place: float, known: bool) -> Fault:
        """A linear slave: ramp down; `pace` is what then remains up to the next start, less the wait."""
        begin = self.leg.end
        pace = place - settings.reach(settings.park) - settings.wait - (begin + 2.0 * settings.stop / self.ratio)
        if not pace > ROUNDING * settings.cycle:
            return Fault.NO_ROOM
        self.stage = Stage.DECEL
        self.leg.ramp_down(begin, self.out, settings.stop, self.ratio)
        self.retarget(settings, place, known, settings.reach(settings.park), False)
        self.pace = pace
        return Fault.NONE

    def go_home(self, settings: Settings, place: float, known: bool) -> Fault:
        """A cyclic slave, to rest at park + turn: with R up to the next meeting less the wait, M_f and the travel home
        M_h share R as the ways do where that is too short for simple ramps."""
        begin = self.leg.end
        way = settings.sync - settings.park
        back = settings.park + settings.turn - self.out
        room = place - begin - settings.wait
        if not back >= LEAST_LENGTH:
            return Fault.ORDER
        if not room > ROUNDING * settings.cycle:
            return Fault.NO_ROOM
        tight = room < (settings.reach(settings.park) + 2.0 * back / self.ratio) * (1.0 - SAME_PLACE)
        reach = room * (way / (way + back)) if tight else settings.reach(settings.park)
        travel = room * (back / (way + back)) if tight else min(room - reach, LONGEST_HOMING * back / self.ratio)
        self.stage = Stage.HOMING
        end = settings.park + settings.turn
        self.leg.curve(begin, begin + travel, travel, self.out, self.ratio, 0.0, end, 0.0)
        self.retarget(settings, place, known, reach, tight)
        return Fault.NONE

    def go_on(self, settings: Settings, place: float) -> Fault:
        """A cyclic slave, to the next meeting without parking: where there is twice the travel it needs, over an
        intermediate stop halfway; else a quintic that is k steep and not curved at both ends."""
        begin = self.leg.end
        way = settings.sync + settings.turn - self.out
        travel = place - begin
        if not way >= LEAST_LENGTH:
            return Fault.ORDER
        if not travel > ROUNDING * settings.cycle:
            return Fault.NO_ROOM
        if travel >= (way / self.ratio + way / settings.ratio) * (1.0 - SAME_PLACE):
            self.stage = Stage.SLOWING
            self.leg.ramp_down(begin, self.out, 0.5 * way, self.ratio)
        else:
            self.stage = Stage.FOLLOWING
            end = settings.sync + settings.turn
            self.leg.curve(begin, place, travel, self.out, self.ratio, 0.0, end, settings.ratio)
        self.retarget(settings, place, True, travel, False)
        return Fault.NONE

    def retarget(self, settings: Settings, place: float, known: bool, reach: float, tight: bool) -> None:
        """The next meeting takes this one's place."""
        self.aim(settings, place, reach)
        self.known = known
        self.tight = tight
        self.park = settings.park
        self.wait = settings.wait

    def pause(self) -> None:
        """Half of the way is done: rest until the ramp up."""
        self.stage = Stage.PAUSING
        position = self.leg.position + self.leg.space
        self.leg.rest(self.leg.end, self.place - 2.0 * self.leg.space / self.ratio, position)

    def speed_up(self, turn: float) -> None:
        """The second half of the way, up to the meeting."""
        self.stage = Stage.FOLLOWING
        self.leg.ramp_up(self.place, self.leg.position, self.sync + turn - self.leg.position, self.ratio)

    def hold(self) -> None:
        """Stay at the end of the forward stroke."""
        self.stage = Stage.HOLDING
        self.leg.rest_for_ever(self.leg.end, self.leg.position + self.leg.space)

    def return_home(self, begin: float, travel: float) -> None:
        """A linear slave, rest to rest, from the end of its stroke to the park."""
        self.stage = Stage.HOMING
        position, _, _, _ = self.leg.at(begin)
        self.leg.curve(begin, begin + travel, travel, position, 0.0, 0.0, self.park, 0.0)

    def release(self, master: float, variable: bool) -> None:
        """From the hold: home to the first start, less the wait, that leaves the undisturbed travel; a variable cycle,
        whose starts are not known, takes just that."""
        travel = self.pace
        if not variable:
            travel = self.start() - self.wait - master
            lacking = self.pace - SAME_PLACE * self.cycle - travel
            if lacking > 0.0:
                later = -floor(-lacking / self.cycle) * self.cycle
                self.place += later
                travel += later
        self.return_home(master, travel)

    # --- the rest ---

    def locate(self, settings: Settings, master: float, stops: bool, variable: bool) -> None:
        """Go through the undisturbed cycle, whose meeting is aimed at, up to the phase in which the master is."""
        if self.stage == Stage.FOLLOWING and master < self.leg.begin:
            self.stage = Stage.PARKED
        for _ in range(6):
            if self.stage == Stage.PARKED or master < self.leg.end:
                break
            match self.stage:
                case Stage.FOLLOWING:
                    self.meet()
                case Stage.SYNCHRONIZED:
                    self.leave(settings, self.place + settings.cycle, not variable, stops or variable)
                case Stage.DECEL:
                    self.return_home(self.leg.end, self.pace)
                case Stage.SLOWING:
                    self.pause()
                case Stage.PAUSING:
                    self.speed_up(settings.turn)
                case _:
                    self.stage = Stage.PARKED

    def watch(self, master: float) -> None:
        """The master must not fall behind this place from now on."""
        self.largest = master
        self.given = master
        self.peak = master

    def see(self, master: float) -> None:
        """The master's present input."""
        self.given = max(self.given, master)
        self.peak = self.given

    def shift(self, turned: float) -> None:
        """The master's positions count from elsewhere."""
        self.leg.shift(turned)
        self.place -= turned
        self.largest -= turned
        self.given -= turned
        self.peak -= turned

    def take(self, other: "Course") -> None:
        """Become a copy of the other."""
        self.stage = other.stage
        self.leg.take(other.leg)
        self.known = other.known
        self.place = other.place
        self.reach = other.reach
        self.tight = other.tight
        self.park = other.park
        self.ratio = other.ratio
        self.sync = other.sync
        self.out = other.out
        self.pace = other.pace
        self.cycle = other.cycle
        self.wait = other.wait
        self.slack = other.slack
        self.largest = other.largest
        self.given = other.given
        self.peak = other.peak


def bounded(position: float) -> bool:
    return abs(position) <= MOST
