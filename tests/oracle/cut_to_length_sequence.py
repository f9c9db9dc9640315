"""The sequence of a cut-to-length machine on the continuous time axis: from event to event.

Between two events the carriage follows one law (`cut_to_length_carriage`); `cut_to_length_books` says what is made.
What the specification notices at a step's beginning is noticed where the steps of the script begin.

Readings of the specification that it leaves open:
- What is set where the master jumps acts with the master after the jump.
- The way home is not eased where it begins on a line that accelerates: it would be FAST from the next step on.
- `warning.blade_early` is told until the blade begins its next cut in time.
- A `stop` during an eased way home makes it FAST.
- An eased way home that has become FAST stays FAST.
- A `cut_now` after `stop` or `abort` is refused, though the machine runs until it is at home.
- With fault 17 the blade is down for `tool.retract_time` more, though the carriage goes home.
- `start` forgets a `cut_now` that waits; so do `stop`'s arrival, `abort` and a fault.
- Where the line turns back past the start, the cycle goes on, and so does the time spent at home.
- `tool.done` and marks are no commands: they leave a refusal as it is.
- Any other command that is not refused clears a refusal; `stop` and `abort` of a machine that does not run are none.
- A blade that touches less than 1e-9 s before sync touches at sync.
- While a `cut_now` waits for a slower line, the cut that is due is not judged.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isclose
from typing import Any

from tests.oracle.cut_to_length_books import (
    CUT_MISSED,
    CUT_NOW_REFUSED,
    SHORT,
    START_REFUSED,
    STROKE,
    TOOL_TIMEOUT,
    TRIM,
    TUNABLE,
    Books,
    Piece,
)
from tests.oracle.cut_to_length_carriage import (
    Course,
    Law,
    Motion,
    OnLine,
    Over,
    Own,
    Rest,
    State,
    approach,
    at_target,
    eased,
    gap,
    own,
    stopping_place,
)
from tests.oracle.cut_to_length_limits import DISTANCE, FEEDBACK, Saw, change_time, first
from tests.oracle.cut_to_length_tunables import CYCLE, sound

FAULT, OFF, HOMING, WAITING, APPROACHING, SYNCHRONOUS, CUTTING, PULLING, CLEARING, RETURNING = range(-1, 9)
IN_SYNC = (SYNCHRONOUS, CUTTING, PULLING, CLEARING)
SKIP, LATE, STOP_LINE = 1, 2, 3
COMMANDS = (
    *("reset", "abort", "stop", "start", "clear_statistics", "calibration.reset", "calibration.execute"),
    *("order.clear", "order.skip", "order.add", "take_sample", "mark.detected", "cut_now", "tool.done"),
)
LATENESS = 1e-9
FASTER = 1e-9
EARLY = 1e-9

Event = tuple[float, Callable[[], None]]


@dataclass(frozen=True)
class Snapshot:
    """What holds from `time` on; `given`: because of something at a step's beginning, which its end shows first.

    `saw`: the machine as it is set; `cycle`: that of the cycle under way, if there is one; `sync_place`: where the
    carriage comes in sync; `material`: b and Δ as they are set.
    """

    time: float
    given: bool
    state: int
    law: Law
    saw: Saw
    cycle: Saw
    piece: Piece | None
    origin: float
    running: bool
    sync_place: float
    material: tuple[float, float]
    mark_delay: float
    outputs: Mapping[str, float]
    max_velocity: float
    max_velocity_orders: float


class Machine:
    """One run: everything that is known between two events, and the snapshots gone through."""

    def __init__(
        self,
        inputs: dict[str, Any],
        courses: Sequence[Course],
        steps: Sequence[float],
        sets: Mapping[float, Mapping[str, Any]],
        period: float,
        initial_position: float,
    ) -> None:
        self.inputs, self.steps, self.period = inputs, steps, period
        self.books = Books(inputs)
        self.seen = {name: bool(inputs[name]) for name in COMMANDS}
        self.state = OFF
        self.law: Law = Rest(initial_position)
        self.course, self.time, self.given = courses[0], 0.0, False
        self.fault, self.refusal = 0, 0
        self.stopping = self.cut_waits = self.barred = False
        self.cycle = self.books.saw()
        self.ready_at, self.home_time, self.start_time = 0.0, 0.0, 0.0
        self.former_start: float | None = None
        self.spent, self.turned_at = 0.0, 0.0
        self.reserve = 1.0
        self.line, self.sync_place, self.sync_time = 0.0, 0.0, 0.0
        self.on_time: float | None = None
        self.command, self.command_time = False, 0.0
        self.down = self.early = False
        self.cut_begin, self.cut_place, self.clear_end, self.up_at = inf, 0.0, inf, inf
        self.gap_made = False
        self.ease, self.ease_velocity, self.ease_line = 1.0, 0.0, 0.0
        self.edge_of_mark = False
        self.log: list[tuple[float, str]] = []
        self.solved: dict[Any, float] = {}
        self.snapshots: list[Snapshot] = []
        self._note()
        self._run(courses, sets)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, courses: Sequence[Course], sets: Mapping[float, Mapping[str, Any]]) -> None:
        """All courses, interrupted by the sets; what happens by itself at the time of a set comes before it."""
        end = courses[-1].end
        times = sorted({*(c.begin for c in courses), *(t for t in sets if t <= end)})
        begins = {c.begin: c for c in courses}
        for time, until in zip(times, [*times[1:], end], strict=True):
            self.time, self.given = time, True
            if time in begins:
                self.course = begins[time]
            self._begin_step(sets.get(time, {}), first=time == 0)
            self.given = False
            self._until(until)

    def _begin_step(self, values: Mapping[str, Any], *, first: bool = False) -> None:
        """What a step begins with: commands, then what is looked for at each step's beginning."""
        lacking = self.books.running and self.books.piece is None
        if not (values or first or lacking or self._watchful):
            return
        self.inputs |= values
        self.books.settle()
        self.barred = self.barred and not sound(self.inputs, CYCLE)
        rising = [name for name in COMMANDS if self.inputs[name] and not self.seen[name]]
        self.seen = {name: bool(self.inputs[name]) for name in COMMANDS}
        if first and self.inputs["auto_start"] and "start" not in rising:
            rising.append("start")
        for name in COMMANDS:
            if name in rising:
                getattr(self, "_do_" + name.replace(".", "_"))()
        self._look()
        self._note()

    def _look(self) -> None:
        """What is noticed at a step's beginning."""
        books = self.books
        if books.running and books.piece is None:
            books.fix()
        if books.running and books.spoilt:
            self.refusal = TUNABLE
        if books.running:
            books.change(self._start_ahead)
        if books.expects_marks and not self.edge_of_mark:
            m = self._master()
            fault = books.miss_marks(m.position - m.velocity * self.books.inputs["mark.delay"])
            if fault:
                self._fail(fault)
            elif books.piece is None:
                books.fix()
        self.edge_of_mark = False
        if self.ease < 1.0 and self._hurries():
            self._fast()

    def _start_ahead(self, line: float) -> bool:
        """THIS_PIECE: in a state in which the piece may change, the start for a cut at that line is still ahead."""
        if self.state not in (HOMING, WAITING, PULLING, CLEARING, RETURNING):
            return False
        m, saw = self._master(), self.books.saw()
        return saw.home - saw.k * (m.position - line) >= saw.lead(saw.k * m.velocity)

    @property
    def _watchful(self) -> bool:
        """Something is looked for at each step's beginning."""
        return self.ease < 1.0 or self.books.expects_marks or self.books.warnings["change_pending"]

    def _until(self, until: float) -> None:
        """Everything that happens by itself until then."""
        for _ in range(1_000_000):
            limit = until
            if self._watchful:
                i = bisect_right(self.steps, self.time)
                limit = min(until, self.steps[i]) if i < len(self.steps) else until
            event = self._next(limit)
            if event is not None:
                self.time, act = event
                act()
                self._note()
            elif limit >= until:
                self.time = until
                return
            else:
                self.time, self.given = limit, True
                self._begin_step({})
                self.given = False
        raise ArithmeticError(f"no progress at {self.time}")

    def _next(self, until: float) -> Event | None:
        """The first thing that happens until then."""
        found = [event for event in self._events(until) if event[0] <= until]
        return min(found, key=lambda event: event[0]) if found else None

    def _events(self, until: float) -> list[Event]:
        found: list[Event] = []
        if self.state in (HOMING, RETURNING) or (self.state == FAULT and self.clear_end == inf):
            found = [(self._law_end(), self._arrive), (max(self.up_at, self.time), self._up)]
        elif self.state == FAULT:
            found = [(self.clear_end, self._clear)]
        elif self.state == WAITING:
            found = self._waiting(until)
        elif self.state == APPROACHING:
            found = self._approaching(until)
        elif self.state in IN_SYNC:
            found = [event for event in self._working(until) if event[0] <= until]
            found += self._stroke_end(min([until, *(time for time, _ in found)]))
        return found

    def _law_end(self) -> float:
        return max(self.law.end, self.time) if isinstance(self.law, Own) else inf

    # --- present values -------------------------------------------------------------------------------------------

    def _master(self, time: float | None = None) -> Motion:
        return self.course.at(self.time if time is None else time)

    def _carriage(self, time: float | None = None) -> State:
        at = self.time if time is None else time
        return self.law.at(at, self.course.at(at))

    # --- waiting --------------------------------------------------------------------------------------------------

    def _waiting(self, until: float) -> list[Event]:
        if self.stopping:
            return [(self.time, self._off)]
        begin = max(self.time, self.ready_at)
        if begin > until or self.inputs["hold"] or self.barred or self.course.direction < 0:
            return []
        saw, piece, found = self.books.saw(), self.books.piece, []

        def room(time: float) -> float:
            return saw.room(self._master(time).velocity)

        if self.cut_waits:
            at = first(room, begin, until)
            return [] if at is None else [(at, self._cut_at_once)]
        if piece is not None and self.course.direction > 0:

            def past(time: float) -> float:
                m = self._master(time)
                return saw.k * (m.position - piece.line) - saw.home + saw.way(m.velocity)

            trim = piece.kind == TRIM
            at = first(lambda t: min(past(t), room(t)) if trim else past(t), begin, until)
            if at is not None:
                crossed = at > begin and past(begin) < 0
                found.append((at, lambda: self._start_point(saw, crossed)))
        return found

    def _start_point(self, saw: Saw, crossed: bool) -> None:
        """The approach begins, unless the line is too fast or it is too late."""
        m, piece, mode = self._master(), self.books.piece, self.books.inputs["late_mode"]
        assert piece is not None
        if not sound(self.inputs, CYCLE):
            self.barred, self.refusal = True, TUNABLE
            return
        speed = saw.k * m.velocity
        least = m.position - (saw.home - saw.lead(speed)) / saw.k
        way = saw.way(m.velocity) if crossed else saw.home - saw.k * (m.position - piece.line)
        if saw.room(m.velocity) < 0:
            self._fail(STROKE) if mode == STOP_LINE else self.books.skip(least)
        elif way >= saw.lead(speed) * (1 - LATENESS):
            self._approach(saw, way)
        elif piece.kind == TRIM:
            self.books.move_line(least)
            self._approach(saw, saw.lead(speed))
        elif mode == SKIP:
            self.books.skip(least)
        elif mode == LATE:
            self.books.move_line(least, late=True)
            self.books.tally.add("late")
            self._approach(saw, saw.lead(speed))
        else:
            self._fail(CUT_MISSED)

    def _cut_at_once(self) -> None:
        if not sound(self.inputs, CYCLE):
            self.barred, self.refusal = True, TUNABLE
            return
        m, saw = self._master(), self.books.saw()
        lead = saw.lead(saw.k * m.velocity)
        self.cut_waits = False
        self.books.move_line(m.position - (saw.home - lead) / saw.k, SHORT)
        self._approach(saw, lead)

    def _approach(self, saw: Saw, way: float) -> None:
        piece = self.books.piece
        assert piece is not None
        self.log.append((self.time, "start"))
        self.state, self.cycle, self.line, self.sync_place = APPROACHING, saw, piece.line, saw.home + way
        self.start_time, self.on_time = self.time, None
        self.early = self.gap_made = False
        self.reserve = 1.0
        if self.former_start is not None:
            self.spent += self.time - max(self.ready_at, self.turned_at)
            self.reserve = 0.0 if piece.late else self.spent / (self.time - self.former_start)
        if way > 0:
            self.law = approach(saw.k, piece.line, saw.home, way)
        else:
            self._synchronize()

    # --- approach, cut --------------------------------------------------------------------------------------------

    def _approaching(self, until: float) -> list[Event]:
        saw, found = self.cycle, []
        end = self.line + self.sync_place / saw.k
        if (at := self.course.passes(end, 1, self.time, until)) is not None:
            found.append((at, self._synchronize))
        begin = self.line + (2 * saw.home - self.sync_place) / saw.k
        if self.course.direction < 0 and self._master(until).position < begin:
            at = self.course.passes(begin, -1, self.time, until)
            found.append((self.time if at is None else at, self._turn_back))
        early = saw.on_delay - saw.settle
        if early > 0 and self.on_time is None:

            def near(time: float) -> float:
                m = self._master(time)
                return m.position + m.velocity * early - end

            if (at := first(near, self.time, until)) is not None:
                found.append((at, self._command_on))
        return found + self._touching()

    def _touching(self) -> list[Event]:
        if self.on_time is None or self.down:
            return []
        return [(max(self.on_time + self.cycle.on_delay, self.time), self._touch)]

    def _touch(self) -> None:
        self.down = True
        m = self._master()
        missing = self.line + self.sync_place / self.cycle.k - m.position
        if self.state == APPROACHING and missing > EARLY * m.velocity:
            self.early = self.books.warnings["blade_early"] = True
            self.books.tally.add("unsynchronised")

    def _command_on(self) -> None:
        self.on_time = self.time
        self._switch(True)

    def _switch(self, on: bool) -> None:
        if self.command != on:
            self.command, self.command_time = on, self.time

    def _turn_back(self) -> None:
        self.log.append((self.time, "turned back"))
        self.turned_at = self.time
        self.state, self.law, self.down = WAITING, Rest(self.cycle.home), False
        self._switch(False)

    def _synchronize(self) -> None:
        self.log.append((self.time, "sync"))
        self.state, self.law, self.sync_time = SYNCHRONOUS, OnLine(self.cycle.k, self.line), self.time
        if self.on_time is None and self.cycle.on_delay > self.cycle.settle:
            self._command_on()

    def _working(self, until: float) -> list[Event]:
        """What the carriage does in sync, but for the end of its stroke."""
        saw = self.cycle
        match self.state:
            case 4:
                found = self._touching()
                if self.on_time is None:
                    return [(max(self.sync_time + saw.settle - saw.on_delay, self.time), self._command_on)]
                begin = max(self.sync_time + saw.settle, self.on_time + saw.on_delay)
                return found or [(max(begin, self.time), self._begin_cut)]
            case 5:
                return self._cutting(until)
            case 6:
                assert isinstance(self.law, Over)
                end = self.line + self.law.begin + self.law.width
                at = self.course.passes(end, 1, self.time, until)
                return [] if at is None else [(at, self._gap_open)]
            case _:
                return [(self.clear_end, self._clear)]

    def _begin_cut(self) -> None:
        self.state, self.cut_begin = CUTTING, self.time
        self.books.warnings["blade_early"] = self.early
        self.cut_place = self._master().position

    def _cutting(self, until: float) -> list[Event]:
        saw = self.cycle
        if saw.mode == DISTANCE:
            end = self.cut_place + saw.cut_distance / saw.k
            if self._master().position >= end:
                return [(self.time, self._end_cut)]
            at = self.course.passes(end, 1, self.time, until)
            return [] if at is None else [(at, self._end_cut)]
        if saw.mode == FEEDBACK:
            at_last = self.cut_begin + saw.timeout if saw.timeout > 0 else inf
            return [(max(at_last, self.time), lambda: self._fail(TOOL_TIMEOUT))]
        return [(max(self.cut_begin + saw.cut_time, self.time), self._end_cut)]

    def _end_cut(self) -> None:
        """The books are kept; the gap is opened, or the blade leaves the material."""
        self.log.append((self.time, "cut"))
        saw, m = self.cycle, self._master()
        self.books.cut(self.line, self.sync_time, self.reserve)
        self.refusal = TUNABLE if self.books.spoilt else self.refusal
        self.former_start, self.gap_made = self.start_time, False
        if saw.gap > 0 and m.velocity > 0 and saw.gap_fits(m.velocity):
            self.state, self.gap_made = PULLING, True
            self.law = gap(saw.k, self.line, m.position - self.line, saw.gap_travel, saw.gap)
            return
        self.books.warnings["gap_skipped"] = saw.gap > 0
        self._switch(False)
        self.state, self.clear_end = CLEARING, self.time + saw.retract

    def _gap_open(self) -> None:
        self._switch(False)
        self.law = OnLine(self.cycle.k, self.line, self.cycle.gap)
        self.state, self.clear_end = CLEARING, self.time + self.cycle.retract

    def _clear(self) -> None:
        """The blade is clear of the material."""
        self.clear_end, self.down = inf, False
        if self.state != FAULT:
            self.state = RETURNING
        self._go_home()

    # --- the end of the stroke ------------------------------------------------------------------------------------

    def _stroke_end(self, until: float) -> list[Event]:
        saw, now = self.cycle, self.books.saw()
        deceleration, jerk = now.turning, now.homing[3]

        def beyond(time: float) -> float:
            """How far the stop would end beyond the nearer end of the stroke."""
            place = stopping_place(self._carriage(time), deceleration, jerk)
            return max(place - saw.high, saw.low - place)

        at = first(beyond, self.time, until)
        return [] if at is None else [(at, lambda: self._fail(STROKE))]

    # --- the way home ---------------------------------------------------------------------------------------------

    def _homing(self) -> tuple[float, float, float, float]:
        return self.books.saw().homing

    def _go_home(self) -> None:
        """From the present state; eased if that is set and there is time."""
        self.ease = 1.0
        state, home = self._carriage(), self.cycle.home
        if at_target(state, home):
            self._arrive()
        elif self.state == RETURNING and self._easing(state):
            return
        else:
            self.law = own(self.time, state, home, self._homing())

    def _easing(self, state: State) -> bool:
        """The way home is eased: a halt, then a slower move."""
        piece, m, saw = self.books.piece, self._master(), self.books.saw()
        if not self.inputs["homing.ease"] or piece is None or m.velocity <= 0 or not self.books.running:
            return False
        if self.stopping or self.cut_waits or m.acceleration > 0:
            return False
        _, acceleration, deceleration, jerk = saw.homing
        speed = state[1]
        braking = change_time(speed, deceleration, jerk)
        distance = state[0] - self.cycle.home + speed * braking / 2
        shortest = saw.return_time(0.0, distance, acceleration)
        start = piece.line + (saw.home - saw.way(m.velocity)) / saw.k
        ahead = (start - m.position) / m.velocity - saw.settle_home - self.books.inputs["homing.spare_time"]
        if ahead <= braking + shortest:
            return False
        self.ease = max(self.books.inputs["homing.slowest"], shortest / (ahead - braking))
        self.ease_velocity, self.ease_line = m.velocity, piece.line
        self.law = eased(self.time, state, self.cycle.home, saw.homing, self.ease)
        return True

    def _hurries(self) -> bool:
        """At a step's beginning: an eased way home is not good enough any more."""
        m, piece = self._master(), self.books.piece
        faster = m.velocity > self.ease_velocity * (1 + FASTER) or m.acceleration > 0
        return faster or self.cut_waits or self.stopping or piece is None or piece.line != self.ease_line

    def _fast(self) -> None:
        self.ease = 1.0
        self.law = own(self.time, self._carriage(), self.cycle.home, self._homing())

    def _arrive(self) -> None:
        """At rest at home."""
        self.log.append((self.time, "home"))
        self.law, self.ease, self.home_time = Rest(self.cycle.home), 1.0, self.time
        if self.state == FAULT:
            return
        self.ready_at, self.spent = self.time + self.books.inputs["homing.settle_time"], 0.0
        self.state = WAITING
        if self.stopping:
            self._off()

    def _up(self) -> None:
        """The blade is clear, although the carriage has left the material's line."""
        self.down, self.up_at = False, inf

    def _off(self) -> None:
        self.state = OFF
        self.stopping = self.cut_waits = False
        self.books.end()

    def _fail(self, fault: int) -> None:
        self.log.append((self.time, f"fault {fault}"))
        self.fault = fault
        down, clearing = self.down and self.state != APPROACHING, self.state == CLEARING
        if fault == STROKE and self.down:
            self.books.tally.add("unsynchronised")
        self.stopping = self.cut_waits = False
        self.state = FAULT
        self.books.end()
        if fault == STROKE:
            self.up_at = self.clear_end if clearing else self.time + self.cycle.retract
        self._leave(down and fault != STROKE, clearing)

    def _leave(self, down: bool, clearing: bool) -> None:
        """The blade leaves the material, in sync if it is down; then home."""
        self._switch(False)
        if down:
            self.clear_end = self.clear_end if clearing else self.time + self.cycle.retract
            return
        self.clear_end = inf
        self.down = self.down and self.up_at < inf
        fast = isinstance(self.law, Own) and self.ease == 1.0
        if not (fast or isinstance(self.law, Rest)):
            self._go_home()

    # --- commands -------------------------------------------------------------------------------------------------

    def _answer(self, refusal: int = 0) -> None:
        self.refusal = refusal

    def _do_reset(self) -> None:
        self.refusal = 0
        if self.state == FAULT and isinstance(self.law, Rest):
            self.state, self.fault = OFF, 0

    def _do_abort(self) -> None:
        if not self.books.running:
            return
        self._answer()
        down, clearing = self.down and self.state != APPROACHING, self.state == CLEARING
        self.stopping, self.cut_waits = True, False
        if self.state == WAITING:
            self._off()
            return
        self.state = CLEARING if down else RETURNING
        self._leave(down, clearing)

    def _do_stop(self) -> None:
        if not self.books.running:
            return
        self._answer()
        self.stopping = True
        if self.state == WAITING:
            self._off()

    def _do_start(self) -> None:
        books, mode = self.books, self.inputs["start_mode"]
        if self.state != OFF or (mode == 3 and books.last_cut is None):
            self._answer(START_REFUSED)
            return
        read = {2: ("trim_length", "front_position"), 3: ("home_position",)}
        if not sound(self.inputs, ("start_mode", "home_position", "kerf", *read.get(mode, ("front_position",)))):
            self._answer(TUNABLE)
            return
        self._answer()
        saw = books.saw()
        self.cycle, self.former_start = saw, None
        self.cut_waits = self.stopping = False
        books.begin(self._master().position, saw)
        if at_target(self._carriage(), saw.home):
            self.state = WAITING
        else:
            self.state = HOMING
            self._go_home()

    def _do_clear_statistics(self) -> None:
        self._answer()
        self.books.tally = type(self.books.tally)()

    def _do_calibration_reset(self) -> None:
        self._answer()
        self.books.calibration = 1.0

    def _do_calibration_execute(self) -> None:
        self._answer(self.books.calibrate())

    def _do_order_clear(self) -> None:
        self._answer()
        self.books.orders = []

    def _do_order_skip(self) -> None:
        self._answer()
        self.books.orders = self.books.orders[1:]

    def _do_order_add(self) -> None:
        self._answer(self.books.add_order())

    def _do_take_sample(self) -> None:
        self._answer()
        self.books.sample_waits = True

    def _do_mark_detected(self) -> None:
        m = self._master()
        place = m.position - m.velocity * self.books.inputs["mark.delay"]
        if self.inputs["mark.latched"]:
            place = float(self.inputs["mark.position"])
            if self.period > 0:
                place += round((m.position - place) / self.period) * self.period
        self.edge_of_mark = True
        if fault := self.books.mark(place):
            self._fail(fault)

    def _do_cut_now(self) -> None:
        if not self.books.running or self.stopping:
            self._answer(CUT_NOW_REFUSED)
            return
        self._answer()
        self.cut_waits = True

    def _do_tool_done(self) -> None:
        if self.state == CUTTING and self.cycle.mode == FEEDBACK:
            self._end_cut()

    # --- what holds from now on -----------------------------------------------------------------------------------

    def _note(self) -> None:
        books, saw = self.books, self.books.saw()
        one, all_ = books.pitches()
        highest, highest_orders = self._solved(saw, one), self._solved(saw, all_)
        piece, front = books.piece, books.orders[0] if books.orders else None
        wanted, margin = float(self.inputs["line.wanted_velocity"]), float(self.inputs["line.margin"])
        failed = self.state == FAULT
        known = books.running and piece is not None
        cycling = self.state in (APPROACHING, *IN_SYNC)
        outputs = {
            "running": books.running,
            "in_sync": self.state in (SYNCHRONOUS, CUTTING) or (self.state == CLEARING and not self.gap_made),
            "tool.command": self.command,
            "tool.command_time": self.command_time,
            "tool.blade_down": self.down,
            "tool.cutting": self.state == CUTTING,
            "next_cut.known": known,
            "next_cut.position": self._wrapped(piece.line) if known and piece else 0.0,
            "piece.ordered": piece.ordered if piece else 0.0,
            "piece.kind": piece.kind if piece else 0,
            **{f"last.{name}": value for name, value in books.last.items()},
            "order.waiting": len(books.orders),
            "order.length_active": front.length if front else 0.0,
            "order.remaining": front.remaining if front else 0,
            "order.completed": books.completed,
            "limits.max_line_velocity": highest,
            "limits.max_line_velocity_orders": highest_orders,
            "line.velocity_request": 0.0 if failed else min(wanted, (1 - margin) * highest),
            "line.stop_request": failed,
            "calibration.factor": books.calibration,
            **books.tally.shown(),
            "batch_count": books.batch_count,
            "batches": books.batches,
            "batch_done": books.batch_done,
            "error": bool(self.fault or self.refusal),
            "error_id": self.fault or self.refusal,
            **{f"warning.{name}": value for name, value in books.warnings.items()},
            "warning.no_length": books.running and not books.by_marks and piece is None,
            "local.coupling_factor": self.cycle.k if cycling else saw.k,
            "local.ease": self.ease,
            "local.marks_waiting": len(books.marks),
            "local.start_time": self.start_time,
            "local.home_time": self.home_time,
        }
        self.snapshots.append(
            Snapshot(
                self.time,
                self.given,
                self.state,
                self.law,
                saw,
                self.cycle if cycling else saw,
                piece,
                books.origin,
                books.running,
                self.sync_place,
                (books.kerf, books.correction),
                float(self.books.inputs["mark.delay"]),
                {name: float(value) for name, value in outputs.items()},
                highest,
                highest_orders,
            )
        )

    def _solved(self, saw: Saw, pitch: float) -> float:
        if (saw, pitch) not in self.solved:
            self.solved[saw, pitch] = saw.max_line_velocity(pitch)
        return self.solved[saw, pitch]

    def _wrapped(self, position: float) -> float:
        if self.period == 0:
            return position
        found = position % self.period
        return 0.0 if isclose(found, self.period, rel_tol=1e-15) else found
