"""One cycle of the Follower over the master's position: its parameters, its phases, and what follows sync_out.

No time here. Each piece of the slave's course is the polynomial through its boundary conditions, by elimination: the
closed forms of the specification (jerk ramps, rest-to-rest and through-going quintics) are nowhere written down.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from tests.oracle.flying_saw_curves import ZERO, Curve, Piece, fitted, joined
from tests.oracle.master import Motion, Number, mp

IN_ALARM, IDLE, POSITIONING, WAITING, WAITING_NEXT_CYCLE, FOLLOWING = -1, 1, 2, 3, 4, 5
SYNCHRONIZED, DECEL, HOMING = 8, 9, 10

OUT_OF_ORDER, BAD_K, NO_ROOM = 3, 4, 5

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
class Stand:
    """The slave rests at a position."""

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


Law = Stand | Timed | Cam


def through(begin: Number, end: Number, start: Sequence[Number], finish: Sequence[Number]) -> Cam:
    """The polynomial of lowest order over begin … end with given position, slope and curvature at both ends."""
    conditions = [(order, 0, value) for order, value in enumerate(start)]
    conditions += [(order, 1, value) for order, value in enumerate(finish)]
    length = end - begin
    return Cam(begin, Curve([Piece(ZERO, length, fitted(length, conditions))]))


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
        return 0 if self.cycle > needed else NO_ROOM

    def steady_ramp(self) -> Number | None:
        """M_f of a cyclic slave that stops in park in each cycle, where it is less than 2L/k; else None."""
        if self.linear or not self.stop_in_park:
            return None
        room, way = self.cycle - self.run - self.wait, self.park + self.slave_cycle - self.out
        lift = self.sync - self.park
        return None if room >= 2 * (lift + way) / self.k else room * lift / (lift + way)


@dataclass(frozen=True, slots=True)
class Way:
    """What holds for the way on from sync_out.

    `values`: read there; `old`, `next`: this meeting and the next one (if it is not `known`, one cycle after this one);
    `begin`, `slave`, `slope`: where it begins, over the master.
    """

    values: Values
    old: Number
    next: Number
    known: bool
    begin: Number
    slave: Number
    slope: Number


@dataclass(frozen=True, slots=True)
class Phase:
    """What the slave does until the master comes to `end`.

    `meeting` and `ramp`: Q and M_f of the meeting that the outputs tell of (None: none known); `base`: the turn of a
    cyclic slave, a multiple of its cycle; `reduced`: M_f where sync_out has left no room for 2L/k.
    """

    state: int
    law: Law
    end: Number
    values: Values
    meeting: Number | None
    ramp: Number
    base: Number
    reduced: Number | None = None
    way: Way | None = None
    held: bool = field(default=False)

    @property
    def points(self) -> tuple[Number, Number, Number] | None:
        """The master at start, sync and out of the meeting that the outputs tell of."""
        if self.meeting is None:
            return None
        return self.meeting - self.ramp, self.meeting, self.meeting + self.values.run


def at_park(values: Values, stand: Number, base: Number, reduced: Number | None) -> Phase:
    return Phase(WAITING, Stand(stand), mp.inf, values, None, ZERO, base, reduced)


def following(values: Values, start: Sequence[Number], begin: Number, meeting: Number, base: Number) -> Phase:
    """From a state over the master at `begin` to the meeting."""
    course = through(begin, meeting, start, (base + values.sync, values.k, ZERO))
    return Phase(FOLLOWING, course, meeting, values, meeting, meeting - begin, base)


def synchronized(values: Values, meeting: Number, ramp: Number, base: Number) -> Phase:
    line = Cam(meeting, Curve([Piece(ZERO, values.run, [base + values.sync, values.k])]))
    return Phase(SYNCHRONIZED, line, meeting + values.run, values, meeting, ramp, base)


def connection(way: Way, base: Number) -> Phase | None:
    """A cyclic slave goes on to the next meeting without a stop in park; None if there is no room."""
    values = way.values
    travel, base = way.next - way.begin, base + values.slave_cycle
    target = base + values.sync
    half = (target - way.slave) / 2
    down, up = 2 * half / way.slope, 2 * half / values.k
    if travel <= 0:
        return None
    if travel < down + up - TIE * values.cycle:
        phase = following(values, (way.slave, way.slope, ZERO), way.begin, way.next, base)
    else:
        falling = through(ZERO, down, (ZERO, way.slope, ZERO), (half, ZERO, ZERO))
        rising = through(ZERO, up, (ZERO, ZERO, ZERO), (half, values.k, ZERO))
        rest = max(travel - down - up, ZERO)
        parts = [(down, falling.curve.pieces[0].polynomial), (rest, [ZERO]), (up, rising.curve.pieces[0].polynomial)]
        course = Cam(way.begin, joined(parts, way.slave))
        phase = Phase(FOLLOWING, course, way.next, values, way.next, travel, base)
    return phase


def way_to_park(way: Way, base: Number) -> Phase | None:
    """A cyclic slave on its way to park; None if there is no room."""
    values = way.values
    lift, target = values.sync - values.park, base + values.park + values.slave_cycle
    room, missing = way.next - way.begin - values.wait, target - way.slave
    if room <= 0:
        return None
    ramp, reduced = 2 * lift / values.k, None
    if room >= ramp + 2 * missing / way.slope:
        travel = min(room - ramp, mp.mpf("2.5") * missing / way.slope)
    else:
        reduced = ramp = room * lift / (lift + missing)
        travel = room - ramp
    end = way.begin + travel
    course = through(way.begin, end, (way.slave, way.slope, ZERO), (target, ZERO, ZERO))
    meeting = way.next if way.known else None
    return Phase(HOMING, course, end, values, meeting, ramp, base + values.slave_cycle, reduced, way)


def deceleration(way: Way) -> Phase | None:
    """A linear slave slows down beyond sync_out; None if there is then no travel left to come home."""
    values = way.values
    end = way.begin + 2 * values.space_stop / way.slope
    ramp = 2 * (values.sync - values.park) / values.k
    if way.next - ramp - values.wait <= end:
        return None
    rest = way.slave + values.space_stop
    course = through(way.begin, end, (way.slave, way.slope, ZERO), (rest, ZERO, ZERO))
    meeting = way.next if way.known else None
    return Phase(DECEL, course, end, values, meeting, ramp, ZERO, None, way)


def homing(decel: Phase, begin: Number, end: Number) -> Phase:
    """A linear slave at the end of its stroke comes home, at rest at both ends."""
    way, values = decel.way, decel.values
    assert way
    rest = way.slave + values.space_stop
    course = through(begin, end, (rest, ZERO, ZERO), (values.park, ZERO, ZERO))
    return replace(decel, state=HOMING, law=course, end=end, held=False)


def home_end(decel: Phase) -> Number:
    """Where the homing of a linear slave ends that was not held."""
    assert decel.way
    return decel.way.next - decel.ramp - decel.values.wait


def end_after_hold(decel: Phase, master: Number, variable: bool) -> tuple[Number, Number]:
    """Where the homing ends after a release at `master`, and its meeting: the first start with travel enough."""
    way, values = decel.way, decel.values
    assert way
    undisturbed = way.old + values.cycle - decel.ramp - values.wait - decel.end
    if variable:
        return master + undisturbed, way.next
    missing = undisturbed - (home_end(decel) - master)
    later = max(mp.ceil(missing / values.cycle - TIE), ZERO) * values.cycle
    return home_end(decel) + later, way.next + later


def first_not_before(value: Number, cycle: Number, limit: Number) -> Number:
    """The first value + n·cycle at or after the limit."""
    return value + mp.ceil((limit - value) / cycle - TIE) * cycle
