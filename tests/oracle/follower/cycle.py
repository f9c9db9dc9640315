"""One cycle of the Follower over the master's position: its parameters, its phases, and what follows sync_out.

No time here. Each segment of the slave's course is the polynomial through its boundary conditions, by elimination: the
closed forms of the specification (jerk ramps, rest-to-rest and through-going quintics) are nowhere written down.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from tests.oracle.flying_saw.curves import ZERO, Curve, CurveSegment, fitted, joined
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

IN_ALARM, IDLE, POSITIONING, WAITING, WAITING_NEXT_CYCLE, FOLLOWING = -1, 1, 2, 3, 4, 5
SYNCHRONIZED, DECEL, HOMING = 8, 9, 10

OUT_OF_ORDER, BAD_K, TOO_SHORT = 3, 4, 5

TIE = mp.mpf("1e-12")
"""Of the master's cycle: positions nearer to one another are one, since the scripts' numbers are rounded."""

PARAMETERS = {
    "cycle": "master_cycle",
    "slave_cycle": "slave_cycle",
    "park": "park_slave",
    "sync": "sync_slave",
    "out": "sync_out",
    "space_stop": "space_stop_slave",
    "wait": "space_wait_in_park",
    "k": "k_slave_master",
}
"""The numbers that make a cycle, with their FMI names."""

Rates = tuple[Number, Number, Number, Number]
"""Position and its first three derivatives."""


@dataclass(frozen=True, slots=True)
class Standstill:
    """The slave is at rest at a position."""

    position: Number

    def at(self, time: Number, master: Motion, side: int = 0, window: Number = ZERO) -> Rates:
        return self.position, ZERO, ZERO, ZERO


@dataclass(frozen=True, slots=True)
class Timed:
    """Position, velocity, acceleration and a constant jerk from the time `begin` (s) on."""

    begin: Number
    start: Motion
    jerk: Number = ZERO

    def at(self, time: Number, master: Motion, side: int = 0, window: Number = ZERO) -> Rates:
        x, p, v, a = time - self.begin, self.start.position, self.start.velocity, self.start.acceleration
        velocity, acceleration = v + x * (a + x * self.jerk / 2), a + x * self.jerk
        return p + x * (v + x * (a / 2 + x * self.jerk / 6)), velocity, acceleration, self.jerk


@dataclass(frozen=True, slots=True)
class Cam:
    """The slave as a function of the master's position, from `origin` on; a master below `floor` counts as at it."""

    origin: Number
    curve: Curve
    floor: Number = -mp.inf

    def over(self, position: Number, lean: Number = ZERO) -> Rates:
        """The slave and its first three derivatives by the master's position."""
        return self.curve.at(max(position, self.floor) - self.origin, lean)

    def at(self, time: Number, master: Motion, side: int = 0, window: Number = ZERO) -> Rates:
        """Chain rule; the master's jerk counts as 0. `window` (s): how near a joint is one, taken from the `side`."""
        v, a = master.velocity, master.acceleration
        s, first, second, third = self.over(master.position, side * window * abs(v))
        if master.position < self.floor or (master.position == self.floor and v < 0):
            return s, ZERO, ZERO, ZERO
        return s, first * v, second * v**2 + first * a, third * v**3 + 3 * second * v * a


Law = Standstill | Timed | Cam


def through(begin: Number, end: Number, start: Sequence[Number], finish: Sequence[Number]) -> Cam:
    """The polynomial of lowest order over begin … end with given position, slope and curvature at both ends."""
    conditions = [(order, 0, value) for order, value in enumerate(start)]
    conditions += [(order, 1, value) for order, value in enumerate(finish)]
    length = end - begin
    return Cam(begin, Curve([CurveSegment(ZERO, length, fitted(length, conditions))]))


@dataclass(frozen=True, slots=True)
class Values:
    """The parameters of one instant; `slave_cycle` 0: a linear slave."""

    cycle: Number
    slave_cycle: Number
    park: Number
    sync: Number
    out: Number
    space_stop: Number
    wait: Number
    k: Number
    align_center: bool
    stop_in_park: bool

    @classmethod
    def read(cls, inputs: Mapping[str, Any]) -> "Values":
        numbers = {field: mp.mpf(inputs[name]) for field, name in PARAMETERS.items()}
        return cls(**numbers, align_center=bool(inputs["align_center"]), stop_in_park=bool(inputs["stop_in_park"]))

    @property
    def linear(self) -> bool:
        return bool(self.slave_cycle == 0)

    @property
    def run(self) -> Number:
        """The master's travel while synchronized; 0 where no k makes one."""
        return (self.out - self.sync) / self.k if self.k else ZERO

    @property
    def shift(self) -> Number:
        """How far before the value of sync_master the meeting is."""
        return self.run / 2 if self.align_center else ZERO

    @property
    def fault(self) -> int:
        """3, 4 or 5, the first that holds; 0 if a cycle can be run."""
        ordered = self.park < self.sync < self.out and self.wait >= 0 and self.slave_cycle >= 0
        ordered = ordered and (self.space_stop > 0 if self.linear else self.out < self.park + self.slave_cycle)
        if not ordered:
            return OUT_OF_ORDER
        if self.k <= 0:
            return BAD_K
        needed = self.run + self.wait
        if self.linear:
            needed += 2 * (self.sync - self.park) / self.k + 2 * self.space_stop / self.k
        return 0 if self.cycle > needed else TOO_SHORT

    def steady_ramp(self) -> Number | None:
        """M_f of a cyclic slave that stops in park in each cycle, where it is less than 2L/k; else None."""
        if self.linear or not self.stop_in_park:
            return None
        available, distance = self.cycle - self.run - self.wait, self.park + self.slave_cycle - self.out
        lift = self.sync - self.park
        return None if available >= 2 * (lift + distance) / self.k else available * lift / (lift + distance)


@dataclass(frozen=True, slots=True)
class SyncExit:
    """The end of the synchronous part of a cycle, from which the slave goes on.

    `values`: read there; `meeting`, `next`: this meeting and the next one (if none `is_given`, one cycle after this);
    `begin`, `slave`, `slope`: where it starts, over the master.
    """

    values: Values
    meeting: Number
    next: Number
    is_given: bool
    begin: Number
    slave: Number
    slope: Number


@dataclass(frozen=True, slots=True)
class Phase:
    """What the slave does until the master comes to `end`.

    `meeting` and `ramp`: Q and M_f of the meeting that the outputs show (None: there is none); `base`: the turn of a
    cyclic slave, a multiple of its cycle; `reduced`: M_f where sync_out has left less than 2L/k.
    """

    state: int
    law: Law
    end: Number
    values: Values
    meeting: Number | None
    ramp: Number
    base: Number
    reduced: Number | None = None
    sync_exit: SyncExit | None = None
    held: bool = field(default=False)

    @property
    def points(self) -> tuple[Number, Number, Number] | None:
        """The master at start, sync and out of the meeting that the outputs show."""
        if self.meeting is None:
            return None
        return self.meeting - self.ramp, self.meeting, self.meeting + self.values.run


def at_park(values: Values, position: Number, base: Number, reduced: Number | None) -> Phase:
    return Phase(WAITING, Standstill(position), mp.inf, values, None, ZERO, base, reduced)


def following(values: Values, start: Sequence[Number], begin: Number, meeting: Number, base: Number) -> Phase:
    """From a state over the master at `begin` to the meeting."""
    course = through(begin, meeting, start, (base + values.sync, values.k, ZERO))
    return Phase(FOLLOWING, course, meeting, values, meeting, meeting - begin, base)


def synchronized(values: Values, meeting: Number, ramp: Number, base: Number) -> Phase:
    line = Cam(meeting, Curve([CurveSegment(ZERO, values.run, [base + values.sync, values.k])]))
    return Phase(SYNCHRONIZED, line, meeting + values.run, values, meeting, ramp, base)


def connection(sync_exit: SyncExit, base: Number) -> Phase | None:
    """A cyclic slave goes on to the next meeting without a stop in park; None if the travel does not suffice."""
    values = sync_exit.values
    travel, base = sync_exit.next - sync_exit.begin, base + values.slave_cycle
    target = base + values.sync
    half = (target - sync_exit.slave) / 2
    down, up = 2 * half / sync_exit.slope, 2 * half / values.k
    if travel <= 0:
        return None
    if travel < down + up - TIE * values.cycle:
        phase = following(values, (sync_exit.slave, sync_exit.slope, ZERO), sync_exit.begin, sync_exit.next, base)
    else:
        falling = through(ZERO, down, (ZERO, sync_exit.slope, ZERO), (half, ZERO, ZERO))
        rising = through(ZERO, up, (ZERO, ZERO, ZERO), (half, values.k, ZERO))
        rest = max(travel - down - up, ZERO)
        parts = [
            (down, falling.curve.segments[0].polynomial),
            (rest, [ZERO]),
            (up, rising.curve.segments[0].polynomial),
        ]
        course = Cam(sync_exit.begin, joined(parts, sync_exit.slave))
        phase = Phase(FOLLOWING, course, sync_exit.next, values, sync_exit.next, travel, base)
    return phase


def way_to_park(sync_exit: SyncExit, base: Number) -> Phase | None:
    """A cyclic slave on its way to park; None if the travel does not suffice."""
    values = sync_exit.values
    lift, target = values.sync - values.park, base + values.park + values.slave_cycle
    available, missing = sync_exit.next - sync_exit.begin - values.wait, target - sync_exit.slave
    if available <= 0:
        return None
    ramp, reduced = 2 * lift / values.k, None
    if available >= ramp + 2 * missing / sync_exit.slope:
        travel = min(available - ramp, mp.mpf("2.5") * missing / sync_exit.slope)
    else:
        reduced = ramp = available * lift / (lift + missing)
        travel = available - ramp
    end = sync_exit.begin + travel
    course = through(sync_exit.begin, end, (sync_exit.slave, sync_exit.slope, ZERO), (target, ZERO, ZERO))
    meeting = sync_exit.next if sync_exit.is_given else None
    return Phase(HOMING, course, end, values, meeting, ramp, base + values.slave_cycle, reduced, sync_exit)


def deceleration(sync_exit: SyncExit) -> Phase | None:
    """A linear slave slows down beyond sync_out; None if there is then no travel left to return home."""
    values = sync_exit.values
    end = sync_exit.begin + 2 * values.space_stop / sync_exit.slope
    ramp = 2 * (values.sync - values.park) / values.k
    if sync_exit.next - ramp - values.wait <= end:
        return None
    rest = sync_exit.slave + values.space_stop
    course = through(sync_exit.begin, end, (sync_exit.slave, sync_exit.slope, ZERO), (rest, ZERO, ZERO))
    meeting = sync_exit.next if sync_exit.is_given else None
    return Phase(DECEL, course, end, values, meeting, ramp, ZERO, None, sync_exit)


def homing(decel: Phase, begin: Number, end: Number) -> Phase:
    """A linear slave at the end of its stroke returns home, at rest at both ends."""
    sync_exit, values = decel.sync_exit, decel.values
    assert sync_exit
    rest = sync_exit.slave + values.space_stop
    course = through(begin, end, (rest, ZERO, ZERO), (values.park, ZERO, ZERO))
    return replace(decel, state=HOMING, law=course, end=end, held=False)


def home_end(decel: Phase) -> Number:
    """Where the homing of a linear slave ends that was not held."""
    assert decel.sync_exit
    return decel.sync_exit.next - decel.ramp - decel.values.wait


def end_after_hold(decel: Phase, master: Number, variable: bool) -> tuple[Number, Number]:
    """Where the homing ends after a release at `master`, and its meeting: the first start with travel enough."""
    sync_exit, values = decel.sync_exit, decel.values
    assert sync_exit
    undisturbed = sync_exit.meeting + values.cycle - decel.ramp - values.wait - decel.end
    if variable:
        return master + undisturbed, sync_exit.next
    missing = undisturbed - (home_end(decel) - master)
    later = max(mp.ceil(missing / values.cycle - TIE), ZERO) * values.cycle
    return home_end(decel) + later, sync_exit.next + later


def first_not_before(value: Number, cycle: Number, limit: Number) -> Number:
    """The first value + n·cycle at or after the limit."""
    return value + mp.ceil((limit - value) / cycle - TIE) * cycle


def onward_from(sync_exit: SyncExit, base: Number, to_park: bool) -> Phase | None:
    """The phase after M_SYNCHRONIZED; None if the travel does not suffice for it."""
    if sync_exit.values.linear:
        return deceleration(sync_exit)
    return way_to_park(sync_exit, base) if to_park or not sync_exit.is_given else connection(sync_exit, base)


def parked(phase: Phase) -> Phase:
    """After homing, waiting for the meeting that the way was paced for."""
    rest = at_park(phase.values, phase.base + phase.values.park, phase.base, phase.reduced)
    return replace(rest, meeting=phase.meeting, ramp=phase.ramp, sync_exit=phase.sync_exit)


def nearest_turn(distance: Number, cycle: Number) -> Number:
    """The multiple of the slave's cycle nearest to a distance; forwards where two are."""
    return mp.floor(distance / cycle + mp.mpf(0.5)) * cycle if cycle else ZERO


def undisturbed(values: Values, meeting: Number, base: Number, master: Number, *, is_variable: bool) -> Phase:
    """From the beginning of a cycle up to the master's position, phase by phase."""
    tolerance = TIE * values.cycle
    on_and_on = not is_variable and not values.linear and not values.stop_in_park
    reduced = None if is_variable else values.steady_ramp()
    ramp = 2 * (values.sync - values.park) / values.k if reduced is None else reduced
    if not is_variable:
        begin = meeting if on_and_on else meeting - ramp
        meeting += mp.floor((master - begin) / values.cycle + TIE) * values.cycle
    elif master < meeting - ramp - tolerance:
        return replace(at_park(values, base + values.park, base, None), meeting=meeting, ramp=ramp)
    phase = following(values, (base + values.park, ZERO, ZERO), meeting - ramp, meeting, base)
    if on_and_on:
        phase = synchronized(values, meeting, ramp, base)
    while phase.end <= master + tolerance:
        if phase.state == FOLLOWING:
            phase = synchronized(values, meeting, ramp, base)
        elif phase.state == SYNCHRONIZED:
            out = phase.base + values.out
            sync_exit = SyncExit(values, meeting, meeting + values.cycle, not is_variable, phase.end, out, values.k)
            onward = onward_from(sync_exit, phase.base, values.stop_in_park)
            assert onward
            phase = onward
        else:
            phase = homing(phase, phase.end, home_end(phase)) if phase.state == DECEL else parked(phase)
    return phase
