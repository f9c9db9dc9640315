"""Reference for the Gearing (SEW MOVIKIT): the true behaviour on the continuous time axis.

An event loop over stretches on which the master moves one way. Between two events the slave follows one of the laws of
`gearing_laws`. Triggers are not taken from the specification's formulas but from what they are for: the one of an
engagement is where the curve must begin to end on the line, the one of a stop where it must begin to end at the stop
position.

A row is what the step that ends at its time puts out: what is set at that time does not show yet.

Readings of the specification that it leaves open:
- What is set at one time acts so: a new ratio, then the edges of activate, start, reset, set_master, set_slave.
- Reaching a position with a velocity counts there and then, even if the velocity jumps just there. A master that comes
  to rest on a trigger has not crossed it; it does when it goes on the same way. The end of a transition is reached even
  by a master that turns or stops exactly on it; below a trigger is strictly below.
- In 1 a new ratio acts at once; a line through the synchronous point keeps that point (m_a is computed anew, as it is
  after falling back). In 2 the time-based line turns about its own point at the present master. In 5 a new ratio,
  0 too, is not looked at before the next engagement: not in 4 after falling back nor by the rising edge that leads from
  there to 3. A ratio of 0 sets the error in 1 to 4; in 0 and while not active only the next rising edge judges it.
- Distance < 0 is a fault with every transition. A falling edge judges time and distance of gear_out, not the ratio, and
  nothing in state 1. In 2 a falling edge, in 5 a rising edge, that has to wait is judged twice: at the edge and when it
  acts; the values of the second time are taken.
- Ignored edges (start already so, start while not active) leave `error` as it is; so do activate and a new ratio. A
  return from 4 to 3, set_master and set_slave are accepted commands. A waiting edge clears again when it acts.
- The signal is a level: in 2 a rising edge takes back a falling edge that waits, in 5 a falling edge a rising one.
- Falling back from 5 with a rising edge that waits: state 3, as by a rising edge in 4.
- In 2, "direct without transition" rests and "time-based out" begins whatever the master's direction.
- A direct transition that fell back keeps trigger and direction, in 1 (there with all occurrences by the master's
  period) and, by analogy, in 4. Otherwise after falling back both triggers are watched again.
- A direct master-based gear-out at rest (CW_CCW) begins at once with u = 0, its direction that of the first motion.
- A stop position without transition that the slave already rests on is not reached before the master moves.
- A stop time-based from 2 aims by the master's present direction as well. Of two occurrences equally near the one
  above is taken.
- Not active: the state stays as it was until reset or activation, in_gear with it. Only state 3 saves the pair: in 4
  the pair is that of leaving 3, even if the line was turned since.
- Already on the line by the synchronous point: judged at the edge only; then the slave takes the line's own position.
- `local.progress` is 1 in 3 and 0 in 0, 1 and 4; not active it stays. `local.line_offset` is that of the last line,
  through (0, initial position) at first, unwrapped. `local.trigger_position`: where it began; while waiting for a
  crossing the next one in the master's present direction (or the last one, or CW), of a direct one that waits the last
  one; 0 at first; wrapped by the master's period.
- The jerk of the slave takes the master's jerk as 0, as far as a unit can know.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tests.oracle.gearing_laws import (
    DRAWN_IN,
    DRAWN_OUT,
    ZERO,
    Curve,
    Law,
    Line,
    Rest,
    Series,
    Timed,
    series,
    timed,
    zero_of,
)
from tests.oracle.master import CLOSE, Motion, Number, Stretch, mp, stretches
from tests.oracle.sets import gathered

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "slave.jerk",
    "state_code",
    "in_gear",
    "error_id",
    "local.progress",
)
"""What a scenario's reference holds beside the time."""

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a change makes two rows."""

STANDING = mp.mpf("1e-30")
"""Velocity (u/s) below which a master stands, at the end of a stretch."""

STOPPED, WAITING_FOR_STARTPOSITION, GEAR_IN, ACTIVE, WAITING_FOR_STOPPOSITION, GEAR_OUT = range(6)
STATES = ("STOPPED", "WAITING_FOR_STARTPOSITION", "GEAR_IN", "ACTIVE", "WAITING_FOR_STOPPOSITION", "GEAR_OUT")
NONE, MASTER_BASED, TIME_BASED = 1, 2, 3
DIRECTIONS = {1: (1,), 2: (-1,), 3: (1, -1), 4: (1,), 5: (-1,), 6: (1, -1), 7: (1, -1)}
LAST_DIRECT, CONTINUE_SYNCHRONIZED = 3, 7
DIRECTIONS_NAMED = ("CW", "CCW", "CW_CCW")
MEMBERS: dict[str, tuple[str, ...]] = {
    "gear_in.start_mode": (
        *(f"{d}_DIRECT" for d in DIRECTIONS_NAMED),
        *(f"WITH_{d}_REFERENCE_POSITION" for d in DIRECTIONS_NAMED),
        "CONTINUE_SYNCHRONIZED",
    ),
    "gear_out.stop_mode": (
        *(f"{d}_DIRECT" for d in DIRECTIONS_NAMED),
        *(f"WITH_{d}_STOP_POSITION" for d in DIRECTIONS_NAMED),
    ),
    "gear_in.transition": ("NONE", "MASTER_BASED", "TIME_BASED"),
    "gear_out.transition": ("NONE", "MASTER_BASED", "TIME_BASED"),
}
"""The names of enumerations' members, from 1 on; scripts hold numbers or names."""
RATIO = ("gearing.numerator", "gearing.denominator")

DEFAULTS: dict[str, Any] = {
    "activate": True,
    "start": False,
    "reset": False,
    "gearing.numerator": 1,
    "gearing.denominator": 1,
    "gear_in.start_mode": 4,
    "gear_in.transition": MASTER_BASED,
    "gear_in.reference_position": 0.0,
    "gear_in.offset": 0.0,
    "gear_in.distance": 100.0,
    "gear_in.time": 1.0,
    "gear_out.stop_mode": 3,
    "gear_out.transition": MASTER_BASED,
    "gear_out.distance": 100.0,
    "gear_out.time": 1.0,
    "gear_out.stop_position": 0.0,
    "set_master.execute": False,
    "set_master.value": 0.0,
    "set_slave.execute": False,
    "set_slave.value": 0.0,
}
"""What may be set while the block runs, with the start values."""


@dataclass(frozen=True, slots=True)
class Request:
    """What an edge read: the directions that count, and how. `position`: m_a of a gear-in, the stop position."""

    directions: tuple[int, ...]
    direct: bool
    transition: int
    distance: Number
    time: Number
    position: Number
    continued: bool = False

    @property
    def immediate(self) -> bool:
        """It begins by the master's direction, not at a position."""
        return self.direct or self.transition == TIME_BASED

    def met(self, direction: int, at_rest: bool) -> bool:
        """The condition of an immediate one; `at_rest`: both directions include rest."""
        return direction in self.directions or (at_rest and len(self.directions) == 2)


@dataclass(frozen=True, slots=True)
class Aim:
    """The trigger by direction, each again every `spacing` (u; 0: only once)."""

    triggers: Mapping[int, Number]
    spacing: Number

    def following(self, master: Number, direction: int) -> Number:
        """The first occurrence at or ahead of the master in that direction; the only one may lie behind."""
        x = self.triggers[direction]
        return first_ahead(x, self.spacing, master, direction)

    def shown(self, master: Number, direction: int) -> tuple[Number, Number]:
        """The next occurrence for a master that moves so, and how far it is from the first one given."""
        d = direction if direction in self.triggers else next(iter(self.triggers))
        x = self.following(master, d)
        return x, x - self.triggers[d]


def first_ahead(x: Number, spacing: Number, here: Number, direction: int) -> Number:
    """The first x + n·spacing with direction·(x + n·spacing - here) >= 0, to rounding; x itself without spacing."""
    if spacing == 0:
        return x
    turns = (here - x) * direction / spacing
    margin = CLOSE * (1 + (abs(x) + abs(here)) / spacing)
    return x + direction * mp.ceil(turns - margin) * spacing


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What holds from a time on; `given`: because of something set at that time.

    `slope`: by which the line moves with the occurrence that it waits for.
    """

    time: Number
    given: bool
    code: int
    law: Law
    line_offset: Number
    slope: Number
    trigger: Number | Aim
    error_id: int
    held_progress: Number | None


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows, just before and
    just after, where something but a set changes a column within 1e-9 s of a time. Raises ValueError as `events` does.
    """
    wanted = sorted(set(times))
    run = _Run(script, mp.mpf(max([script["stop_time"], *wanted])) + WINDOW)
    return [row for time in wanted for row in run.rows(time)]


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order; the name of each new state, commands, refusals.

    Raises ValueError for start values that are refused, for a set at or before 0 and for a set of something that is
    neither an input nor tunable.
    """
    run = _Run(script, mp.mpf(script["stop_time"]))
    return [(float(time), name) for time, name in run.log]


def fault(inputs: Mapping[str, Any], group: str, *, ratio: bool) -> int:
    """The first fault of a group's values, 0 if there is none."""
    if ratio and inputs["gearing.denominator"] == 0:
        return 1
    if ratio and inputs["gearing.numerator"] == 0:
        return 2
    if inputs[f"{group}.transition"] == TIME_BASED and not inputs[f"{group}.time"] > 0:
        return 3
    return 0 if inputs[f"{group}.distance"] >= 0 else 4


class _Run:
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through."""

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: _number(name, start.get(name, default)) for name, default in DEFAULTS.items()}
        for group in ("gear_in", "gear_out"):
            if error := fault(self.inputs, group, ratio=True):
                raise ValueError(f"the start values are refused: fault {error} of {group}")
        self.period = mp.mpf(start.get("master.period", 0))
        self.slave_period = mp.mpf(start.get("slave.period", 0))
        self.master = _wrapped_start(stretches(script["master"], horizon), self.period)
        self.begins = [stretch.begin for stretch in self.master]
        self.stretch, self.time = self.master[0], ZERO
        self.active = bool(self.inputs["activate"])
        self.error_id = 0
        self.ratio = self._wanted_ratio()
        initial = mp.mpf(start.get("slave.initial_position", 0))
        self.synchronous = ZERO, initial
        self.code = STOPPED
        self.law: Law = Rest(initial)
        self.line = Line(ZERO, initial, self.ratio)
        self.request: Request | None = None
        self.aim: Aim | None = None
        self.undecided = False
        self.waiting_edge = False
        self.trigger = ZERO
        self.held_progress: Number | None = None
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.snapshots: list[Snapshot] = []
        self._note()
        self.snapshots[0] = replace(self.snapshots[0], time=-mp.inf)
        sets = gathered(script.get("set", ()), DEFAULTS, _number)
        self._run([(mp.mpf(at), values) for at, values in sets.items()], horizon)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, sets: list[tuple[Number, dict[str, Any]]], horizon: Number) -> None:
        """All stretches, interrupted by the sets.

        What the path up to a set does comes before it; what the master does from there on, after it.
        """
        last = len(self.master) - 1
        for index, stretch in enumerate(self.master[1:], start=1):
            self.stretch, self.time = stretch, stretch.begin
            while sets and (sets[0][0] < stretch.end or (index == last and sets[0][0] <= horizon)):
                at, values = sets.pop(0)
                if at > stretch.begin:
                    self._until(at)
                self.given = True
                self._set(values)
                self.given = False
            self._until(stretch.end)

    def _note(self, name: str = "") -> None:
        """The present state holds from now on."""
        self.snapshots.append(
            Snapshot(
                self.time,
                self.given,
                self.code,
                self.law,
                self.line.value(ZERO),
                self.ratio if self.code == WAITING_FOR_STARTPOSITION else ZERO,
                self.aim or self.trigger,
                self.error_id,
                self.held_progress,
            )
        )
        if name:
            self.log.append((self.time, name))

    def _become(self, code: int, law: Law, aim: Aim | None = None) -> None:
        """A new state, its law, and what it waits for."""
        entered = STATES[code] if code != self.code else ""
        self.code, self.law, self.aim = code, law, aim
        self._note(entered)

    def _until(self, until: Number) -> None:
        """Everything that happens by itself until then."""
        for _ in range(100_000):
            event = self._next(until) if self.active else None
            if event is None:
                self.time = until
                return
            self.time, act = event
            act()
        raise ArithmeticError(f"no progress at {self.time}")

    def _next(self, until: Number) -> tuple[Number, Callable[[], None]] | None:
        """The next thing that happens by itself, None if there is none until then."""
        match self.code:
            case _ if self.code in (WAITING_FOR_STARTPOSITION, WAITING_FOR_STOPPOSITION):
                return self._next_waiting(until)
            case _ if self.code not in (GEAR_IN, GEAR_OUT):
                return None
        direction = self.stretch.direction
        if self.undecided:
            return (self.time, lambda: self._begin(direction)) if direction else None
        if isinstance(self.law, Timed):
            return (self.law.end, self._over) if self.law.end <= until else None
        assert isinstance(self.law, Curve)
        towards = self.law.end if direction == self.law.direction else self.law.trigger
        act = self._over if direction == self.law.direction else self._back
        at = self._passes(towards, until, beyond=act == self._back) if direction else None
        return None if at is None else (at, act)

    def _next_waiting(self, until: Number) -> tuple[Number, Callable[[], None]] | None:
        direction, request = self.stretch.direction, self.request
        assert request
        if self.aim is None:
            return (self.time, lambda: self._begin(direction)) if request.met(direction, at_rest=False) else None
        if direction not in self.aim.triggers:
            return None
        x = self.aim.following(self._master().position, direction)
        at = self._passes(x, until, moving=True)
        return None if at is None else (at, lambda: self._begin(direction, x))

    def _passes(self, x: Number, until: Number, *, moving: bool = False, beyond: bool = False) -> Number | None:
        """When the master, which moves, comes to x, now if it is at it; None if it does not until then.

        `moving`: not if it is already past it, nor where it stands as soon as it is there; `beyond`: if it goes on.
        """
        here, there = (self.stretch.at(time) for time in (self.time, until))
        d, margin = self.stretch.direction, CLOSE * (1 + abs(x))
        missing, left = (here.position - x) * d, (there.position - x) * d
        if left < (margin if beyond else -margin):
            return None
        if moving and (missing > margin or (left < margin and there.velocity * d < STANDING)):
            return None
        return self.time if missing >= -margin else self.stretch.when(x, self.time, until)

    # --- present values -------------------------------------------------------------------------------------------

    def _master(self) -> Motion:
        return self.stretch.at(self.time)

    def _slave(self) -> Series:
        """The slave's position, and its velocity and half its acceleration, now."""
        return self.law.at(self.time, series(self._master()))

    def _wanted_ratio(self) -> Number:
        return mp.mpf(self.inputs["gearing.numerator"]) / mp.mpf(self.inputs["gearing.denominator"])

    def _read(self, group: str) -> Request:
        mode = self.inputs["gear_in.start_mode" if group == "gear_in" else "gear_out.stop_mode"]
        position = mp.mpf(self.inputs["gear_out.stop_position"])
        if group == "gear_in":
            position = mp.mpf(self.inputs["gear_in.reference_position"]) + mp.mpf(self.inputs["gear_in.offset"])
        distance, transition = mp.mpf(self.inputs[f"{group}.distance"]), int(self.inputs[f"{group}.transition"])
        if transition == NONE or (transition == MASTER_BASED and distance == 0):
            transition, distance = NONE, ZERO
        return Request(
            DIRECTIONS[int(mode)],
            int(mode) <= LAST_DIRECT,
            transition,
            distance,
            mp.mpf(self.inputs[f"{group}.time"]),
            position,
            group == "gear_in" and int(mode) == CONTINUE_SYNCHRONIZED,
        )

    # --- commands -------------------------------------------------------------------------------------------------

    def _set(self, values: Mapping[str, Any]) -> None:
        """The inputs set now: the ratio, then the edges in the order of the specification."""
        before, self.inputs = self.inputs, {**self.inputs, **values}
        if self.active and any(self.inputs[name] != before[name] for name in RATIO):
            self._new_ratio()

        def rises(name: str) -> bool:
            return bool(self.inputs[name]) and not before[name]

        if rises("activate"):
            self._activate()
        elif before["activate"] and not self.inputs["activate"]:
            self._freeze()
        if self.active:
            if rises("reset"):
                self.error_id = 0
                self._note("reset")
            if rises("start"):
                self._rise()
            elif before["start"] and not self.inputs["start"]:
                self._fall()
        else:
            self._while_not_active(*(rises(name) for name in ("reset", "set_master.execute", "set_slave.execute")))

    def _activate(self) -> None:
        self.active, self.held_progress = True, None
        self._note("active")
        self._become(STOPPED, self.law)

    def _freeze(self) -> None:
        master, slave = self._master().position, self._slave()[0]
        if self.code == ACTIVE:
            self.synchronous = master, slave
        if isinstance(self.aim, Aim):
            self.trigger, _ = self.aim.shown(master, self._latest_direction(self.time))
        self.held_progress = _progress(self.code, self.law, self.time, master)
        self.active, self.waiting_edge, self.undecided, self.aim = False, False, False, None
        self.law = Rest(slave)
        self._note("not active")

    def _while_not_active(self, reset: bool, set_master: bool, set_slave: bool) -> None:
        if reset:
            self.error_id, self.code, self.held_progress = 0, STOPPED, None
            self._note("reset")
        if set_master:
            value = mp.mpf(self.inputs["set_master.value"])
            self.error_id = 0
            self.synchronous = value, self.synchronous[1]
            self._note("set_master")
        if set_slave:
            value = mp.mpf(self.inputs["set_slave.value"])
            self.error_id = 0
            self.synchronous, self.law = (self.synchronous[0], value), Rest(value)
            self._note("set_slave")

    def _refuse(self, what: str, error_id: int) -> None:
        self.error_id = error_id
        self._note(f"{what} refused {error_id}")

    def _rise(self) -> None:
        """A rising edge of start."""
        match self.code:
            case 0 | 5:
                if error_id := fault(self.inputs, "gear_in", ratio=True):
                    self._refuse("start", error_id)
                    return
                self.error_id = 0
                request = self._read("gear_in")
                at_once = request.transition == TIME_BASED and request.met(self.stretch.direction, request.direct)
                if self.code == STOPPED or at_once:
                    self._gear_in(request)
                else:
                    self.waiting_edge = True
                    self._note("start waits")
            case 2 if self.waiting_edge:
                self.error_id, self.waiting_edge = 0, False
                self._note("stop taken back")
            case 4:
                self.error_id = 0
                self._become(ACTIVE, self.line)
            case _:
                self._note("start ignored")

    def _fall(self) -> None:
        """A falling edge of start."""
        match self.code:
            case 1:
                self.error_id = 0
                self._become(STOPPED, self.law)
            case 2 | 3:
                if error_id := fault(self.inputs, "gear_out", ratio=False):
                    self._refuse("stop", error_id)
                    return
                self.error_id = 0
                self._gear_out(self._read("gear_out"))
            case 5 if self.waiting_edge:
                self.error_id, self.waiting_edge = 0, False
                self._note("start taken back")
            case _:
                self._note("stop ignored")

    def _gear_in(self, request: Request) -> None:
        """The edge acts: begin, or wait."""
        self.ratio, self.request, self.undecided = self._wanted_ratio(), request, False
        if request.continued:
            through = Line(*self.synchronous, self.ratio)
            if request.transition == NONE and (on := self._moved_onto(through)):
                self.trigger, self.line = on.master, on
                self._become(ACTIVE, on)
                return
        if not request.direct:
            self.line = self._line_to_wait_for()
        if request.immediate and request.met(self.stretch.direction, request.direct):
            self._begin(self.stretch.direction)
        else:
            self._become(WAITING_FOR_STARTPOSITION, self.law, None if request.immediate else self._start_aim())

    def _gear_out(self, request: Request) -> None:
        """The edge acts in 2 or 3."""
        direction = self.stretch.direction
        if self.code == GEAR_IN:
            if not (request.transition == TIME_BASED or (request.transition == NONE and request.direct)):
                self.waiting_edge = True
                self._note("stop waits")
                return
            self.request, self.undecided = request, False
            self._begin_out(direction, self._master().position)
            return
        self.synchronous = self._master().position, self._slave()[0]
        self.request = request
        if request.immediate and request.met(direction, at_rest=True):
            self._begin_out(direction, self._master().position)
        else:
            aim = None if request.immediate else self._stop_aim()
            self._become(WAITING_FOR_STOPPOSITION, self.line, aim)

    # --- lines and triggers ---------------------------------------------------------------------------------------

    def _line_to_wait_for(self) -> Line:
        """Through the slave's position at m_a; m_a where the line through the synchronous point has that position."""
        assert self.request
        slave, anchor = self._slave()[0], self.request.position
        if self.request.continued:
            through = Line(*self.synchronous, self.ratio)
            anchor = zero_of(lambda m: through.value(m) - slave)
            self.request = replace(self.request, position=anchor)
        return Line(anchor, slave, self.ratio)

    def _moved_onto(self, through: Line) -> Line | None:
        """The occurrence of the line that the pair of axes is on, to 1e-9."""
        master, slave = self._master().position, self._slave()[0]
        anchor = zero_of(lambda m: through.value(m) - slave)
        turns = mp.nint((master - anchor) / self.period) * self.period if self.period else ZERO
        if abs(master - anchor - turns) > mp.mpf(1e-9) * max(1, abs(master)):
            return None
        return replace(through, master=through.master + turns)

    def _curve(self, trigger: Number, direction: int) -> Curve:
        """The curve of the engagement from the slave's position."""
        assert self.request
        return Curve(DRAWN_IN, trigger, direction, self.request.distance, self._slave()[0], self.ratio)

    def _start_aim(self) -> Aim:
        """Where the curve must begin to end on the line."""
        assert self.request
        triggers = dict.fromkeys(self.request.directions, self.line.master)
        if self.request.transition == MASTER_BASED:
            for d in self.request.directions:

                def gap(x: Number, d: int = d) -> Number:
                    curve = self._curve(x, d)
                    return curve.value(curve.end) - self.line.value(curve.end)

                triggers[d] = zero_of(gap)
        return Aim(triggers, self.period)

    def _stop_aim(self) -> Aim:
        """Where the line must be left to come to rest at the stop position."""
        request, triggers = self.request, {}
        assert request
        for d in request.directions:
            end = request.position - d * self.ratio * request.distance * sum(DRAWN_OUT, ZERO)

            def gap(x: Number, end: Number = end) -> Number:
                return self.line.value(x) - end

            triggers[d] = zero_of(gap)
        return Aim(triggers, self.slave_period / abs(self.ratio))

    # --- transitions ----------------------------------------------------------------------------------------------

    def _begin(self, direction: int, trigger: Number | None = None) -> None:
        """The condition is met; at the `trigger` that is crossed, or where the master is."""
        x = self._master().position if trigger is None else trigger
        if self.code in (WAITING_FOR_STOPPOSITION, ACTIVE) or (self.code == GEAR_OUT and self.undecided):
            self._begin_out(direction, x)
        else:
            self._begin_in(direction, x)

    def _begin_in(self, direction: int, x: Number) -> None:
        request, slave = self.request, self._slave()
        assert request
        self.trigger, self.undecided = x, False
        match request.transition:
            case 1:
                self.line = Line(x, slave[0], self.ratio)
                self._become(ACTIVE, self.line)
            case 2:
                self.undecided = direction == 0
                law: Law = Rest(slave[0])
                self.line = Line(x, slave[0], self.ratio)
                if direction:
                    law = curve = self._curve(x, direction)
                    self.line = curve.line
                self._become(GEAR_IN, law)
            case 3:
                anchor = x if request.direct else first_ahead(request.position, self.period, x, direction)
                self.line = Line(anchor, slave[0], self.ratio)
                self._become(GEAR_IN, timed(self.time, request.time, slave, self.line, series(self._master())))

    def _begin_out(self, direction: int, x: Number) -> None:
        request, slave = self.request, self._slave()
        assert request
        self.trigger, self.undecided = x, False
        match request.transition:
            case 1:
                self._stop(slave[0] if request.direct else self.line.value(x))
            case 2:
                self.undecided = direction == 0
                law: Law = Rest(slave[0])
                if direction:
                    law = Curve(DRAWN_OUT, x, direction, request.distance, self.line.value(x), self.ratio)
                self._become(GEAR_OUT, law)
            case 3:
                target = Rest(slave[0] if request.direct else self._stop_target(slave[0], direction))
                self._become(GEAR_OUT, timed(self.time, request.time, slave, target, series(self._master())))

    def _stop_target(self, slave: Number, direction: int) -> Number:
        """The stop position, or that occurrence of it that is ahead, at rest the nearest."""
        assert self.request
        stop, period = self.request.position, self.slave_period
        if period and direction == 0:
            return stop + mp.floor((slave - stop) / period + mp.mpf("0.5")) * period
        return first_ahead(stop, period, slave, direction * int(mp.sign(self.ratio)))

    def _stop(self, position: Number) -> None:
        """At rest; a rising edge that waited acts."""
        self._become(STOPPED, Rest(position))
        if self.waiting_edge:
            self.waiting_edge = False
            self._rise()

    def _over(self) -> None:
        """The transition is complete; an edge that waited acts."""
        if self.code == GEAR_OUT:
            law = self.law
            self._stop(law.value(law.end) if isinstance(law, Curve) else self._slave()[0])
            return
        self._become(ACTIVE, self.line)
        if self.waiting_edge:
            self.waiting_edge = False
            self._fall()

    def _back(self) -> None:
        """The master falls back below the trigger of a master-based transition."""
        curve, request, waited = self.law, self.request, self.waiting_edge
        assert isinstance(curve, Curve)
        assert request
        self.waiting_edge = False
        kept = {curve.direction: curve.trigger}
        if self.code == GEAR_OUT:
            if waited:
                self._become(ACTIVE, self.line)
            else:
                aim = Aim(kept, ZERO) if request.direct else self._stop_aim()
                self._become(WAITING_FOR_STOPPOSITION, self.line, aim)
            return
        self.law = Rest(curve.start)
        if waited:
            self._become(STOPPED, self.law)
            return
        if not request.direct:
            self.line = self._line_to_wait_for()
        aim = Aim(kept, self.period) if request.direct else self._start_aim()
        self._become(WAITING_FOR_STARTPOSITION, self.law, aim)

    def _new_ratio(self) -> None:
        """Numerator or denominator are others than before."""
        if self.code in (STOPPED, GEAR_OUT):
            return
        if 0 in (self.inputs[name] for name in RATIO):
            self._refuse("ratio", 1 if self.inputs["gearing.denominator"] == 0 else 2)
            return
        self.ratio = self._wanted_ratio()
        master, slave, request = self._master().position, self._slave()[0], self.request
        assert request
        match self.law:
            case Line():
                self.law = self.line = Line(master, slave, self.ratio)
            case Timed():
                self.line = Line(master, self.line.value(master), self.ratio)
                self.law = replace(self.law, base=self.line)
            case Curve():
                there = replace(self.law, ratio=self.ratio)
                self.law = turned = replace(there, start=self.law.start + slave - there.value(master))
                self.line = turned.line
            case Rest() if self.undecided:
                self.line = replace(self.line, ratio=self.ratio)
        self._aim_anew(request)
        self._note("new ratio")

    def _aim_anew(self, request: Request) -> None:
        """While waiting, by a new ratio."""
        if self.code == WAITING_FOR_STARTPOSITION and not request.direct:
            self.line = self._line_to_wait_for()
            self.aim = self._start_aim() if self.aim else None
        elif self.code == WAITING_FOR_STARTPOSITION and self.aim:
            self.line = next(self._curve(x, d).line for d, x in self.aim.triggers.items())
        elif self.code == WAITING_FOR_STOPPOSITION and self.aim and not request.direct:
            self.aim = self._stop_aim()

    # --- outputs --------------------------------------------------------------------------------------------------

    def rows(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if something but a set changes a column within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.snapshots, t - WINDOW, key=lambda s: s.time) - 1
        last = bisect_right(self.snapshots, t + WINDOW, key=lambda s: s.time)
        latest = first
        while latest + 1 < last and not self.snapshots[latest + 1].given:
            latest += 1
        early = self._row(t, self.snapshots[first], -1)
        late = self._row(t, self.snapshots[latest], +1) if time > 0 else early
        return [early] if early == late else [early, late]

    def _latest_direction(self, time: Number) -> int:
        """In which the master moves or last moved; 0 before it did."""
        passed = self.master[: bisect_right(self.begins, time)]
        return next((s.direction for s in reversed(passed) if s.direction), 0)

    def _row(self, t: Number, snapshot: Snapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        beside = self.master[bisect_right(self.begins, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begins, t) - 1].at(t).position
        master = replace(beside.at(t), position=position)
        s, v, half_a, sixth_j = snapshot.law.at(t, series(master))
        progress, trigger, offset = snapshot.held_progress, snapshot.trigger, snapshot.line_offset
        if isinstance(trigger, Aim):
            trigger, shifted = trigger.shown(position, self._latest_direction(t + side * WINDOW))
            offset -= snapshot.slope * shifted
        if progress is None:
            progress = _progress(snapshot.code, snapshot.law, t, position)
        turns_side = side if t >= WINDOW else max(side, 0)  # nothing was before 0
        return {
            "time": float(t),
            "slave.position": _turned(s, v, turns_side, self.slave_period),
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(2 * half_a) + 0.0,
            "slave.jerk": float(6 * sixth_j) + 0.0,
            "state": float(snapshot.code),
            "state_code": float(snapshot.code),
            "in_gear": float(snapshot.code == ACTIVE),
            "error": float(snapshot.error_id != 0),
            "error_id": float(snapshot.error_id),
            "local.trigger_position": _turned(trigger, ZERO, 0, self.period),
            "local.line_offset": float(offset) + 0.0,
            "local.progress": float(progress) + 0.0,
        }


def _progress(code: int, law: Law, time: Number, master: Number) -> Number:
    """u or t/T in a transition, 1 in gear, else 0."""
    match law:
        case Curve():
            part = law.progress(master)
        case Timed():
            part = law.progress(time)
        case _:
            part = mp.mpf(code == ACTIVE)
    return min(max(part, ZERO), mp.mpf(1))


def _turned(position: Number, velocity: Number, side: int, period: Number) -> float:
    """`position` modulo the period, with the turns counted on one side of this time, or just at it (0)."""
    if period == 0:
        return float(position) + 0.0
    turns = mp.floor((position + side * velocity * WINDOW) / period)
    wrapped = float(position - turns * period)
    if wrapped >= period:
        beyond = position - turns * period >= period
        return math.nextafter(float(period), 0.0) if beyond else 0.0
    return max(wrapped, 0.0) + 0.0


def _wrapped_start(pieces: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return pieces
    shift = mp.floor(pieces[0].start.position / period) * period
    return [replace(p, start=replace(p.start, position=p.start.position - shift)) for p in pieces]


def _number(name: str, value: Any) -> Any:
    """A member's number for its name; other values as they are."""
    return MEMBERS[name].index(value) + 1 if isinstance(value, str) else value
