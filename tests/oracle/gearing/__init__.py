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
  there to 3. A ratio of 0 sets the error in 1 to 4; in 0 and while not active the next rising edge checks it.
- Distance < 0 is a fault with every transition. A falling edge checks time and distance of gear_out, not the ratio, and
  nothing in state 1. In 2 a falling edge, in 5 a rising edge, that has to wait is checked twice: at the edge and when
  it acts; the values of the second time are taken.
- Ignored edges (start already so, start while not active) leave `error` as it is; so do activate and a new ratio. A
  return from 4 to 3, set_master and set_slave are accepted commands. A waiting edge clears again when it acts.
- The signal is a level: in 2 a rising edge takes back a falling edge that waits, in 5 a falling edge a rising one.
- Falling back from 5 with a rising edge that waits: state 3, as by a rising edge in 4.
- In 2, "direct without transition" rests and "time-based out" starts whatever the master's direction.
- A direct transition that fell back keeps trigger and direction, in 1 (there with all occurrences by the master's
  period) and, by analogy, in 4. Otherwise after falling back both triggers are watched again.
- A direct master-based gear-out at rest (CW_CCW) starts at once with u = 0, its direction that of the first motion.
- A stop position without transition that the slave already rests on is not reached before the master moves.
- A stop time-based from 2 aims by the master's present direction as well. Of two occurrences equally near the one
  above is taken.
- Not active: the state stays as it was until reset or activation, in_gear with it. Only state 3 saves the pair: in 4
  the pair is that of leaving 3, even if the line was turned since.
- Already on the line by the synchronous point: checked at the edge only; then the slave takes the line's own position.
- `local.progress` is 1 in 3 and 0 in 0, 1 and 4; not active it stays. `local.line_offset` is that of the last line,
  through (0, initial position) at first, unwrapped. `local.trigger_position`: where it began; while waiting for a
  crossing the next one in the master's present direction (or the last one, or CW), of a direct one that waits the last
  one; 0 at first; wrapped by the master's period.
- The jerk of the slave takes the master's jerk as 0, as far as a unit can know.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from tests.oracle.event_run import Event, EventRun, events_of, rows_of
from tests.oracle.gearing.inputs import (
    ACTIVE,
    DEFAULTS,
    GEAR_IN,
    GEAR_OUT,
    MASTER_BASED,
    NONE,
    RATIO,
    STATES,
    STOPPED,
    TIME_BASED,
    WAITING_FOR_STARTPOSITION,
    WAITING_FOR_STOPPOSITION,
    GearRequest,
    Triggers,
    fault,
    first_ahead,
    number,
)
from tests.oracle.gearing.laws import (
    DRAWN_IN,
    DRAWN_OUT,
    ZERO,
    Law,
    RatioLine,
    Rest,
    Series,
    Timed,
    TransitionCurve,
    series,
    timed,
    zero_of,
)
from tests.oracle.gearing.outputs import GearingRows, GearingSnapshot, progress_of
from tests.oracle.master import CLOSE, Motion, Stretch, stretches
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
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
"""What a scenario's reference has in addition to the time."""

REST_VELOCITY = mp.mpf("1e-30")
"""Velocity (u/s) below which a master is at rest, at the end of a stretch."""


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows, just before and
    just after, where something but a set changes a column within 1e-9 s of a time. Raises ValueError as `events` does.
    """
    return rows_of(GearingRun, script, times)


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order; the name of each new state, commands, refusals.

    Raises ValueError for start values that are refused, for a set at or before 0 and for a set of something that is
    neither an input nor tunable.
    """
    return events_of(GearingRun, script)


class GearingRun(EventRun):
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through."""

    outputs: GearingRows

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: number(name, start.get(name, default)) for name, default in DEFAULTS.items()}
        for group in ("gear_in", "gear_out"):
            if error := fault(self.inputs, group, ratio=True):
                raise ValueError(f"the start values are refused: fault {error} of {group}")
        self.period = mp.mpf(start.get("master.period", 0))
        self.slave_period = mp.mpf(start.get("slave.period", 0))
        self.master = _wrapped_start(stretches(script["master"], horizon), self.period)
        self.begin_times = [stretch.begin for stretch in self.master]
        self.stretch, self.time = self.master[0], ZERO
        self.active = bool(self.inputs["activate"])
        self.error_id = 0
        self.ratio = self._set_ratio()
        initial = mp.mpf(start.get("slave.initial_position", 0))
        self.synchronous = ZERO, initial
        self.code = STOPPED
        self.law: Law = Rest(initial)
        self.line = RatioLine(ZERO, initial, self.ratio)
        self.request: GearRequest | None = None
        self.triggers: Triggers | None = None
        self.undecided = False
        self.waiting_edge = False
        self.trigger = ZERO
        self.held_progress: Number | None = None
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.outputs = GearingRows(self.master, self.begin_times, self.period, self.slave_period)
        self._note()
        self.outputs.snapshots[0] = replace(self.outputs.snapshots[0], time=-mp.inf)
        sets = gathered(script.get("set", ()), DEFAULTS, number)
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
        self.outputs.snapshots.append(
            GearingSnapshot(
                self.time,
                self.given,
                self.code,
                self.law,
                self.line.value(ZERO),
                self.ratio if self.code == WAITING_FOR_STARTPOSITION else ZERO,
                self.triggers or self.trigger,
                self.error_id,
                self.held_progress,
            )
        )
        if name:
            self.log.append((self.time, name))

    def _become(self, code: int, law: Law, triggers: Triggers | None = None) -> None:
        """A new state, its law, and what it waits for."""
        entered = STATES[code] if code != self.code else ""
        self.code, self.law, self.triggers = code, law, triggers
        self._note(entered)

    def _next(self, until: Number) -> Event | None:
        """The next thing that happens by itself, None if there is none until then."""
        match self.code:
            case _ if not self.active:
                return None
            case _ if self.code in (WAITING_FOR_STARTPOSITION, WAITING_FOR_STOPPOSITION):
                return self._next_waiting(until)
            case _ if self.code not in (GEAR_IN, GEAR_OUT):
                return None
        direction = self.stretch.direction
        if self.undecided:
            return (self.time, lambda: self._start_transition(direction)) if direction else None
        if isinstance(self.law, Timed):
            return (self.law.end, self._over) if self.law.end <= until else None
        assert isinstance(self.law, TransitionCurve)
        towards = self.law.end if direction == self.law.direction else self.law.trigger
        act = self._over if direction == self.law.direction else self._back
        at = self._passes(towards, until, beyond=act == self._back) if direction else None
        return None if at is None else (at, act)

    def _next_waiting(self, until: Number) -> Event | None:
        direction, request = self.stretch.direction, self.request
        assert request
        if self.triggers is None:
            may_start = request.met(direction, at_rest=False)
            return (self.time, lambda: self._start_transition(direction)) if may_start else None
        if direction not in self.triggers.by_direction:
            return None
        x = self.triggers.following(self._master().position, direction)
        at = self._passes(x, until, moving=True)
        return None if at is None else (at, lambda: self._start_transition(direction, x))

    def _passes(self, x: Number, until: Number, *, moving: bool = False, beyond: bool = False) -> Number | None:
        """When the master, which moves, comes to x, now if it is at it; None if it does not until then.

        `moving`: not if it is already past it, nor where it is at rest as soon as it is there; `beyond`: if it goes on.
        """
        now, then = (self.stretch.at(time) for time in (self.time, until))
        d, margin = self.stretch.direction, CLOSE * (1 + abs(x))
        missing, left = (now.position - x) * d, (then.position - x) * d
        if left < (margin if beyond else -margin):
            return None
        if moving and (missing > margin or (left < margin and then.velocity * d < REST_VELOCITY)):
            return None
        return self.time if missing >= -margin else self.stretch.when(x, self.time, until)

    # --- present values -------------------------------------------------------------------------------------------

    def _master(self) -> Motion:
        return self.stretch.at(self.time)

    def _slave(self) -> Series:
        """The slave's position, and its velocity and half its acceleration, now."""
        return self.law.at(self.time, series(self._master()))

    def _set_ratio(self) -> Number:
        return mp.mpf(self.inputs["gearing.numerator"]) / mp.mpf(self.inputs["gearing.denominator"])

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
            if rises("start"):
                self._rise()
            elif before["start"] and not self.inputs["start"]:
                self._fall()
            if rises("reset"):
                self.error_id = 0
                self._note("reset")
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
        if isinstance(self.triggers, Triggers):
            self.trigger, _ = self.triggers.shown(master, self.outputs.latest_direction(self.time))
        self.held_progress = progress_of(self.code, self.law, self.time, master)
        self.active, self.waiting_edge, self.undecided, self.triggers = False, False, False, None
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
                request = GearRequest.read(self.inputs, "gear_in")
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
                self._gear_out(GearRequest.read(self.inputs, "gear_out"))
            case 5 if self.waiting_edge:
                self.error_id, self.waiting_edge = 0, False
                self._note("start taken back")
            case _:
                self._note("stop ignored")

    def _gear_in(self, request: GearRequest) -> None:
        """The edge acts: begin, or wait."""
        self.ratio, self.request, self.undecided = self._set_ratio(), request, False
        if request.continued:
            through = RatioLine(*self.synchronous, self.ratio)
            if request.transition == NONE and (on := self._moved_onto(through)):
                self.trigger, self.line = on.master, on
                self._become(ACTIVE, on)
                return
        if not request.direct:
            self.line = self._line_to_wait_for()
        if request.immediate and request.met(self.stretch.direction, request.direct):
            self._start_transition(self.stretch.direction)
        else:
            self._become(WAITING_FOR_STARTPOSITION, self.law, None if request.immediate else self._start_triggers())

    def _gear_out(self, request: GearRequest) -> None:
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
            triggers = None if request.immediate else self._stop_triggers()
            self._become(WAITING_FOR_STOPPOSITION, self.line, triggers)

    # --- lines and triggers ---------------------------------------------------------------------------------------

    def _line_to_wait_for(self) -> RatioLine:
        """Through the slave's position at m_a; m_a where the line through the synchronous point has that position."""
        assert self.request
        slave, anchor = self._slave()[0], self.request.position
        if self.request.continued:
            through = RatioLine(*self.synchronous, self.ratio)
            anchor = zero_of(lambda m: through.value(m) - slave)
            self.request = replace(self.request, position=anchor)
        return RatioLine(anchor, slave, self.ratio)

    def _moved_onto(self, through: RatioLine) -> RatioLine | None:
        """The occurrence of the line that the pair of axes is on, to 1e-9."""
        master, slave = self._master().position, self._slave()[0]
        anchor = zero_of(lambda m: through.value(m) - slave)
        turns = mp.nint((master - anchor) / self.period) * self.period if self.period else ZERO
        if abs(master - anchor - turns) > mp.mpf(1e-9) * max(1, abs(master)):
            return None
        return replace(through, master=through.master + turns)

    def _curve(self, trigger: Number, direction: int) -> TransitionCurve:
        """The curve of the engagement from the slave's position."""
        assert self.request
        return TransitionCurve(DRAWN_IN, trigger, direction, self.request.distance, self._slave()[0], self.ratio)

    def _start_triggers(self) -> Triggers:
        """Where the curve must begin to end on the line."""
        assert self.request
        triggers = dict.fromkeys(self.request.directions, self.line.master)
        if self.request.transition == MASTER_BASED:
            for d in self.request.directions:

                def gap(x: Number, d: int = d) -> Number:
                    curve = self._curve(x, d)
                    return curve.value(curve.end) - self.line.value(curve.end)

                triggers[d] = zero_of(gap)
        return Triggers(triggers, self.period)

    def _stop_triggers(self) -> Triggers:
        """Where the line must be left to come to rest at the stop position."""
        request, triggers = self.request, {}
        assert request
        for d in request.directions:
            end = request.position - d * self.ratio * request.distance * sum(DRAWN_OUT, ZERO)

            def gap(x: Number, end: Number = end) -> Number:
                return self.line.value(x) - end

            triggers[d] = zero_of(gap)
        return Triggers(triggers, self.slave_period / abs(self.ratio))

    # --- transitions ----------------------------------------------------------------------------------------------

    def _start_transition(self, direction: int, trigger: Number | None = None) -> None:
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
                self.line = RatioLine(x, slave[0], self.ratio)
                self._become(ACTIVE, self.line)
            case 2:
                self.undecided = direction == 0
                law: Law = Rest(slave[0])
                self.line = RatioLine(x, slave[0], self.ratio)
                if direction:
                    law = curve = self._curve(x, direction)
                    self.line = curve.line
                self._become(GEAR_IN, law)
            case 3:
                anchor = x if request.direct else first_ahead(request.position, self.period, x, direction)
                self.line = RatioLine(anchor, slave[0], self.ratio)
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
                    law = TransitionCurve(DRAWN_OUT, x, direction, request.distance, self.line.value(x), self.ratio)
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
            self._stop(law.value(law.end) if isinstance(law, TransitionCurve) else self._slave()[0])
            return
        self._become(ACTIVE, self.line)
        if self.waiting_edge:
            self.waiting_edge = False
            self._fall()

    def _back(self) -> None:
        """The master falls back below the trigger of a master-based transition."""
        curve, request, waited = self.law, self.request, self.waiting_edge
        assert isinstance(curve, TransitionCurve)
        assert request
        self.waiting_edge = False
        own_trigger = {curve.direction: curve.trigger}
        if self.code == GEAR_OUT:
            if waited:
                self._become(ACTIVE, self.line)
            else:
                triggers = Triggers(own_trigger, ZERO) if request.direct else self._stop_triggers()
                self._become(WAITING_FOR_STOPPOSITION, self.line, triggers)
            return
        self.law = Rest(curve.start)
        if waited:
            self._become(STOPPED, self.law)
            return
        if not request.direct:
            self.line = self._line_to_wait_for()
        triggers = Triggers(own_trigger, self.period) if request.direct else self._start_triggers()
        self._become(WAITING_FOR_STARTPOSITION, self.law, triggers)

    def _new_ratio(self) -> None:
        """Numerator or denominator are others than before."""
        if self.code in (STOPPED, GEAR_OUT):
            return
        if 0 in (self.inputs[name] for name in RATIO):
            self._refuse("ratio", 1 if self.inputs["gearing.denominator"] == 0 else 2)
            return
        self.ratio = self._set_ratio()
        master, slave, request = self._master().position, self._slave()[0], self.request
        assert request
        match self.law:
            case RatioLine():
                self.law = self.line = RatioLine(master, slave, self.ratio)
            case Timed():
                self.line = RatioLine(master, self.line.value(master), self.ratio)
                self.law = replace(self.law, base=self.line)
            case TransitionCurve():
                new_line = replace(self.law, ratio=self.ratio)
                self.law = curve = replace(new_line, start=self.law.start + slave - new_line.value(master))
                self.line = curve.line
            case Rest() if self.undecided:
                self.line = replace(self.line, ratio=self.ratio)
        self._update_triggers(request)
        self._note("new ratio")

    def _update_triggers(self, request: GearRequest) -> None:
        """While waiting, by a new ratio."""
        if self.code == WAITING_FOR_STARTPOSITION and not request.direct:
            self.line = self._line_to_wait_for()
            self.triggers = self._start_triggers() if self.triggers else None
        elif self.code == WAITING_FOR_STARTPOSITION and self.triggers:
            self.line = next(self._curve(x, d).line for d, x in self.triggers.by_direction.items())
        elif self.code == WAITING_FOR_STOPPOSITION and self.triggers and not request.direct:
            self.triggers = self._stop_triggers()


def _wrapped_start(pieces: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return pieces
    shift = mp.floor(pieces[0].start.position / period) * period
    return [replace(p, start=replace(p.start, position=p.start.position - shift)) for p in pieces]
