"""Reference for the Follower (Robox mv_follow2): the true behaviour on the continuous time axis.

An event loop over stretches on which the master moves one way. The phases of a cycle are those of `follower_cycle`,
polynomials over the master's position; positioning and the stop ramp of an alarm are polynomials of time.

A row is what the step that ends at its time puts out: what is set at that time does not show yet. The inputs are those
of START_OF_STEP, taken as exact. Speed and acceleration are judged at the ends of the steps only: the multiples of the
scenario's `step_size` and where something is set, expected, or the master's script breaks; that step shows the alarm
beside the values that broke the limit, and the stop ramp begins there.

Readings of the specification where it leaves something open.

The meeting:
- "Up to the next start" in R means up to the next meeting, less the wait: R = Q' - m_out - wait, for a fixed cycle too
  (the formula for R is that, for an undisturbed cycle). M_f shared out of R at sync_out holds until the next
  sync_out or positioning, also for a start after a skipped one and for a value that comes late; else M_f is 2L/k with
  the values of the start.
- The slave starts from where it stands: a `park_slave` changed meanwhile counts from the next way home (or positioning)
  on. The slope at sync_out is that of the cycle that ends, though k has changed.
- 3, 4, 5 are judged at each start and at each sync_out (5 there also for the next meeting chosen); and at park as soon
  as k or C lets no start be computed. `space_stop_slave` <= 0 (linear) and a negative wait or slave_cycle are 3.
- `master_to_*`: 0 in idle, positioning and alarm, and of a movement without stop in park `master_to_start`. At park
  they go by the parameters of now. A variable value kept in decel or homing is the next meeting known.
- A skipped start stays skipped, should the master come back to it at park; skipped or missed, the state is
  M_WAITING_NEXT_CYCLE until Q + C - M_f - wait even if a new value in reach has come meanwhile.

A variable cycle:
- "Less than C after this one" is judged at sync_out; such a value is lost, not kept for park. "Beyond what the phase
  allows" is a meeting that leaves no room (R <= 0, M <= 0, no travel for homing).
- At park a late value is a missed start, so M_WAITING_NEXT_CYCLE, also right after positioning or homing.
- A value is judged anew at park whenever a parameter changes. The occurrence ahead with a period is that of the value
  (not of the aligned meeting), ahead of the master when the value is set.
- Recovery is tried when the value is set in homing, however far ahead it is, and where it turns out late at park; not
  with skip or assumed set, and not with parameters out of order. If refused in homing the value is kept.

Positioning and alarms:
- Standstill is judged with the master after a jump at that time. Refused in M_IN_ALARM, with the alarm's error_id left.
  Parameters 3, 4, 5 out of order refuse positioning to the cycle (1), as does a limit <= 0 where the slave must move.
- Positioning to the cycle: the undisturbed cycle, in a cyclic one with stop M_f as in every cycle (not 2L/k of the
  first one), whatever is set to skip, assume or hold; of a cyclic slave the nearest turn. With a variable cycle the
  last value counts unless its cycle is over, skipped or missed; a next one is not known.
- `error_id` 1 goes with an accepted positioning or end_synchronism, or with reset in any state but M_IN_ALARM.
- Several edges at once: to park, to cycle, end_synchronism, reset. What is set together with them is known to them.
- 14 is judged at the instant, the slave then standing where the largest value has it: velocity 0.
- Undisturbed travel (after a hold): what the homing would have had at the end of this M_DECEL, not held.
- A limit that is exactly reached is kept, to 1e-12 of it. Where positions decide (a start just ahead, a value exactly C
  later, k·M = 2S, a release with just enough travel) 1e-12·C is none.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from tests.oracle.flying_saw_curves import ZERO
from tests.oracle.flying_saw_motion import move
from tests.oracle.follower_cycle import (
    BAD_K,
    DECEL,
    FOLLOWING,
    HOMING,
    IDLE,
    IN_ALARM,
    NO_ROOM,
    POSITIONING,
    SYNCHRONIZED,
    TIE,
    WAITING,
    WAITING_NEXT_CYCLE,
    Cam,
    Law,
    Phase,
    Rates,
    Stand,
    Timed,
    Values,
    Way,
    at_park,
    connection,
    deceleration,
    end_after_hold,
    first_not_before,
    following,
    home_end,
    homing,
    synchronized,
    way_to_park,
)
from tests.oracle.master import CLOSE, Motion, Number, Stretch, mp, stretches
from tests.oracle.sets import gathered

COLUMNS = (
    "slave.position",
    "slave.velocity",
    "slave.acceleration",
    "slave.jerk",
    "state_code",
    "master_to_start",
    "master_to_sync",
    "master_to_out",
    "cycle",
    "error_id",
)
"""What a scenario's reference holds beside the time."""

WINDOW = mp.mpf("1e-9")
"""Time (s) around a requested one within which a jump makes two rows."""

STILL = mp.mpf("1e-12")
"""Velocity, acceleration (u/s, u/s2) and, relatively, distance from a target below which they are 0."""

MOVED = mp.mpf(1e-9)
"""Of the master's cycle: how far it may be from where it was (2) or back from its largest value (14)."""

REFUSED, MASTER_MOVED, FELL_BACK = 1, 2, 14
CYCLE = (FOLLOWING, SYNCHRONIZED, DECEL, HOMING)
NAMES = dict(zip(CYCLE, ("following", "synchronized", "decel", "homing"), strict=True))

TUNABLE = {
    "master_cycle": 1000.0,
    "park_slave": 0.0,
    "sync_slave": 100.0,
    "sync_out": 300.0,
    "space_stop_slave": 100.0,
    "space_wait_in_park": 0.0,
    "k_slave_master": 1.0,
    "max_speed": 0.0,
    "max_acceleration": 0.0,
    "check_speed": True,
    "check_acceleration": True,
    "positioning.velocity": 500.0,
    "positioning.acceleration": 5000.0,
    "positioning.jerk": 50000.0,
}
EDGES = ("position_to_park", "position_to_cycle", "end_synchronism", "reset")
LEVELS = ("skip_next_cycle", "stop_after_forward", "sync_assumed")
SETTABLE: dict[str, Any] = {**TUNABLE, "sync_master": 0.0, **dict.fromkeys((*EDGES, *LEVELS), False)}
FIXED: dict[str, Any] = {
    "variable_cycle": False,
    "slave_cycle": 0.0,
    "align_center": False,
    "stop_in_park": True,
    "recover_late_sync": False,
    "slave.initial_position": 0.0,
    "master.period": 0.0,
}


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What holds from a time on; `given`: because of something set at that time, or after the end of that step."""

    time: Number
    given: bool
    law: Law
    state: int
    cycle: int
    error_id: int
    points: tuple[Number, Number, Number] | None


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `step_size`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows,
    just before and just after, where the motion jumps or changes its state within 1e-9 s of a time.
    """
    wanted = sorted(set(times))
    run = _Run(script, mp.mpf(max([script["stop_time"], *wanted])) + WINDOW)
    return [row for time in wanted for row in run.rows(time)]


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order.

    Raises ValueError for a set at or before 0, for a set of something that is neither an input nor tunable, and for
    parameters with which the block does not initialize (faults 3, 4, 5).
    """
    run = _Run(script, mp.mpf(script["stop_time"]))
    return [(float(time), name) for time, name in run.log]


class _Run:
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through.

    `phase`: the cycle's, None in idle and alarm; in positioning the one aimed at. `aimed_at`: the master's position
    during positioning to the cycle. `largest`: that of the master since leaving park. `pending`: a variable value that
    no cycle has used yet, `used`: that of the cycle that runs. `skipped`: the last start not carried out, `window`: up
    to where M_WAITING_NEXT_CYCLE lasts.
    """

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: start.get(name, default) for name, default in {**SETTABLE, **FIXED}.items()}
        self.variable, self.period = bool(self.inputs["variable_cycle"]), mp.mpf(self.inputs["master.period"])
        if fault := Values.read(self.inputs).fault:
            raise ValueError(f"fault {fault} at the end of initialization")
        self.master = _wrapped_start(stretches(script["master"], horizon), self.period)
        self.begins = [stretch.begin for stretch in self.master]
        self.stretch, self.time = self.master[0], ZERO
        self.state = IDLE
        self.law: Law = Stand(mp.mpf(self.inputs["slave.initial_position"]))
        self.phase: Phase | None = None
        self.moves: list[tuple[Number, Number]] = []
        self.timed_end = mp.inf
        self.aimed_at: Number | None = None
        self.largest = self.skipped = -mp.inf
        self.window: Number | None = None
        self.used: Number | None = None
        self.pending: Number | None = self._occurrence() if self.variable else None
        self.cycle, self.error_id = 0, 0
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.snapshots: list[Snapshot] = []
        self.time = -mp.inf
        self._note()
        self._run(script, horizon)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, script: Mapping[str, Any], horizon: Number) -> None:
        """All stretches, step by step; what the path does at the time of a set comes before it."""
        known = gathered(script.get("set", ()), SETTABLE)
        sets = {_snapped(mp.mpf(at), self.begins): values for at, values in known.items()}
        points = _points(script, horizon) if _limited(script) else []
        grid = sorted({_snapped(point, self.begins) for point in points} | sets.keys())
        for stretch in self.master[1:]:
            self._enter(stretch)
            self._set(sets.get(stretch.begin, {}))
            for point in grid[bisect_right(grid, stretch.begin) : bisect_right(grid, stretch.end)]:
                self._until(point)
                self._check_limits()
                if point < stretch.end:
                    self._set(sets.get(point, {}))
            self._until(stretch.end)
        self._set(sets.get(horizon, {}))

    def _note(self, name: str = "") -> None:
        """What is now holds from now on."""
        shown = self.phase.points if self.phase and self.state != POSITIONING else None
        self.snapshots.append(
            Snapshot(self.time, self.given, self.law, self.state, self.cycle, self.error_id, shown),
        )
        if name:
            self.log.append((self.time, name))

    def _enter(self, stretch: Stretch) -> None:
        """The master goes on by another stretch: what it has reached is its largest value so far."""
        self.stretch, self.time = stretch, stretch.begin
        if self.state in CYCLE:
            self.largest = max(self.largest, self._here())
            self.law = self._floored(self.law)
        self._note()

    def _until(self, until: Number) -> None:
        """Everything that happens by itself until then."""
        for _ in range(100_000):
            event = self._next(until)
            if event is None:
                self.time = until
                return
            self.time, act = event
            act()
        raise ArithmeticError(f"no progress at {self.time}")

    def _next(self, until: Number) -> tuple[Number, Callable[[], None]] | None:
        """The first thing that happens until then."""
        found: list[tuple[Number | None, Callable[[], None]]] = []
        if self.timed_end <= until:
            found.append((self.timed_end, self._timed_over))
        if self.aimed_at is not None:
            found.append((self._leaves(self.aimed_at, until), lambda: self._alarm(MASTER_MOVED)))
        phase = self.phase
        if phase and self.state in CYCLE:
            allowed = self.largest - MOVED * phase.values.cycle
            found.append((self._falls(allowed, until), lambda: self._alarm(FELL_BACK)))
            if not phase.held:
                found.append((self._reaches(phase.end, until), self._phase_over))
        elif phase and self.state in (WAITING, WAITING_NEXT_CYCLE):
            found += self._park_events(phase, until)
        happening = [(at, act) for at, act in found if at is not None]
        return min(happening, key=lambda event: event[0]) if happening else None

    def _park_events(self, phase: Phase, until: Number) -> list[tuple[Number | None, Callable[[], None]]]:
        found: list[tuple[Number | None, Callable[[], None]]] = []
        if self.window is not None:
            found.append((self._reaches(self.window, until), self._window_over))
        if phase.points:
            start = phase.points[0]
            if self.stretch.direction >= 0:
                found.append((self._reaches(start, until), self._start))
            earlier, near = start - phase.values.cycle, TIE * phase.values.cycle
            if not self.variable and earlier > self.skipped + near:
                found.append((self._falls(earlier, until, touching=True), self._choose))
        return found

    def _here(self) -> Number:
        return self.stretch.at(self.time).position

    def _reached(self) -> Number:
        """The master's position in the cycle's sense: back by rounding it is still where it was."""
        return max(self._here(), self.largest) if self.state in CYCLE else self._here()

    def _reaches(self, position: Number, until: Number) -> Number | None:
        """When the master comes to a position from below; now if it is there."""
        margin = CLOSE * (1 + abs(position))
        if self._reached() >= position - margin:
            return self.time
        if self.stretch.direction <= 0 or self.stretch.at(until).position < position - margin:
            return None
        return self.stretch.when(position, self.time, until)

    def _falls(self, position: Number, until: Number, *, touching: bool = False) -> Number | None:
        """When the master, on its way back, comes to a position (touching) or goes below it."""
        margin = CLOSE * (1 + abs(position)) * (1 if touching else -1)
        if self.stretch.direction >= 0 or self.stretch.at(until).position > position + margin:
            return None
        return self.time if self._here() <= position else self.stretch.when(position, self.time, until)

    def _leaves(self, position: Number, until: Number) -> Number | None:
        """When the master is further away from a position than it may be."""
        phase, direction = self.phase, self.stretch.direction
        assert phase
        allowed = MOVED * phase.values.cycle
        if abs(self.stretch.at(until).position - position) <= allowed:
            return None
        if abs(self._here() - position) > allowed:
            return self.time
        return self.stretch.when(position + direction * allowed, self.time, until)

    # --- present values -------------------------------------------------------------------------------------------

    def _slave(self) -> Rates:
        return self.law.at(self.time, self.stretch.at(self.time))

    def _floored(self, law: Law) -> Law:
        return replace(law, floor=self.largest) if isinstance(law, Cam) else law

    def _occurrence(self) -> Number:
        """The value of sync_master, with a period its first occurrence ahead of the master."""
        value = mp.mpf(self.inputs["sync_master"])
        return first_not_before(value, self.period, self._here()) if self.period else value

    def _go(self, phase: Phase) -> None:
        """The next phase of the cycle."""
        self.phase, self.state, self.law = phase, phase.state, self._floored(phase.law)
        self._note(NAMES[phase.state])

    # --- at park --------------------------------------------------------------------------------------------------

    def _rest_at_park(self, phase: Phase) -> None:
        """The slave has come to park, by positioning or homing."""
        self.phase, self.state, self.law = phase, WAITING, phase.law
        self.used, self.window = None, None
        self.skipped = self.largest = -mp.inf
        self.log.append((self.time, "at park"))
        self._choose()

    def _choose(self) -> None:
        """The meeting that the slave waits for, by the parameters of now; a value that is too late is missed."""
        phase, values = self.phase, Values.read(self.inputs)
        assert phase
        if values.k <= 0 or values.cycle <= 0:
            self._alarm(BAD_K if values.k <= 0 else NO_ROOM)
            return
        ramp, near = self._ramp(phase, values), TIE * values.cycle
        meeting: Number | None = None
        if not self.variable:
            value = mp.mpf(self.inputs["sync_master"]) - values.shift
            meeting = first_not_before(value, values.cycle, self._here() + ramp)
            while meeting - ramp <= self.skipped + near:
                meeting += values.cycle
        elif self.pending is not None:
            meeting = self.pending - values.shift
            if meeting - ramp < self._here() - near:
                if self._recovered(meeting):
                    return
                self.log.append((self.time, "start missed"))
                self._wait_for_next(meeting + values.cycle - ramp - values.wait)
                self.pending = meeting = None
        self.phase = replace(phase, values=values, meeting=meeting, ramp=ramp)
        self._note()

    def _ramp(self, phase: Phase, values: Values) -> Number:
        """M_f from where the slave stands."""
        stand = phase.law.at(ZERO, Motion(ZERO, ZERO, ZERO))[0]
        return 2 * (phase.base + values.sync - stand) / values.k if phase.reduced is None else phase.reduced

    def _wait_for_next(self, window: Number) -> None:
        if self._here() < window:
            self.state, self.window = WAITING_NEXT_CYCLE, window

    def _window_over(self) -> None:
        self.state, self.window = WAITING, None
        self._note("waiting")

    def _start(self) -> None:
        """The master is at Q - M_f."""
        phase = self.phase
        assert phase
        assert phase.points
        assert phase.meeting is not None
        values, (begin, meeting, _) = phase.values, phase.points
        if self._to_skip():
            self.log.append((self.time, "start skipped"))
            self.skipped, self.pending = begin, None
            self._wait_for_next(begin + values.cycle - values.wait)
            self._choose()
        elif values.fault:
            self._alarm(values.fault)
        else:
            self.used, self.pending = self.pending, None
            self.largest, self.window = begin, None
            self._go(following(values, (self._slave()[0], ZERO, ZERO), begin, meeting, phase.base))

    def _to_skip(self) -> bool:
        return bool(self.inputs["skip_next_cycle"] or self.inputs["sync_assumed"])

    def _recovered(self, meeting: Number) -> bool:
        """A late value is met on the fly, if that is wanted and keeps the limits."""
        phase, values, here = self.phase, Values.read(self.inputs), self._reached()
        assert phase
        wanted = self.inputs["recover_late_sync"] and not (values.linear or values.stop_in_park or self._to_skip())
        if not wanted or values.fault or meeting <= here:
            return False
        rates = self.law.over(here)[:3] if isinstance(self.law, Cam) else (self._slave()[0], ZERO, ZERO)
        joining = following(values, rates, here, meeting, phase.base)
        assert isinstance(joining.law, Cam)
        velocity = self.stretch.at(self.time).velocity
        for order, kind in ((1, "speed"), (2, "acceleration")):
            greatest = max(abs(extremum.value) for extremum in joining.law.curve.extrema(order))
            limit = self._limit(kind)
            if limit is not None and greatest * abs(velocity) ** order > limit:
                self.log.append((self.time, "recovery refused"))
                return False
        self.used, self.pending, self.window = self.pending, None, None
        self.largest = max(self.largest, here)
        self.log.append((self.time, "recovered"))
        self._go(joining)
        return True

    # --- the cycle ------------------------------------------------------------------------------------------------

    def _phase_over(self) -> None:
        """The master has come to the end of the phase."""
        phase = self.phase
        assert phase
        if phase.state == FOLLOWING:
            assert phase.meeting is not None
            self._go(synchronized(phase.values, phase.meeting, phase.ramp, phase.base))
        elif phase.state == SYNCHRONIZED:
            self._synchronized_over(phase.end, phase.base + phase.values.out)
        elif phase.state == HOMING:
            self._rest_at_park(_parked(phase))
        elif self.inputs["stop_after_forward"]:
            rest = Stand(self._slave_at_end(phase))
            self.phase, self.law = replace(phase, held=True, law=rest), rest
            self._note("held")
        else:
            self._go(homing(phase, phase.end, home_end(phase)))

    @staticmethod
    def _slave_at_end(phase: Phase) -> Number:
        assert isinstance(phase.law, Cam)
        return phase.law.over(phase.end)[0]

    def _synchronized_over(self, begin: Number, slave: Number) -> None:
        """The end of M_SYNCHRONIZED: the next meeting and the way there, with the parameters of now."""
        phase, values = self.phase, Values.read(self.inputs)
        assert phase
        assert phase.meeting is not None
        self.cycle += 1
        if values.fault:
            self._alarm(values.fault)
            return
        next_, known = self._next_meeting(phase.meeting, values)
        way = Way(values, phase.meeting, next_, known, begin, slave, phase.values.k)
        to_park = values.stop_in_park or self._to_skip()
        onward = _onward(way, phase.base, to_park)
        if onward is None and self.variable:
            way = replace(way, next=way.old + values.cycle, known=False)
            onward = _onward(way, phase.base, to_park)
        if self.variable and not way.known:
            self.pending = None
        if onward is None:
            self._alarm(NO_ROOM)
            return
        if onward.state == FOLLOWING:
            self.used, self.pending = self.pending, None
        self._go(onward)

    def _next_meeting(self, old: Number, values: Values) -> tuple[Number, bool]:
        if not self.variable:
            value = mp.mpf(self.inputs["sync_master"]) - values.shift
            return first_not_before(value, values.cycle, old + values.cycle / 2), True
        if self.pending is not None and self.pending - values.shift >= old + values.cycle * (1 - TIE):
            return self.pending - values.shift, True
        return old + values.cycle, False

    def _released(self) -> None:
        """The end of a hold after the forward stroke."""
        phase = self.phase
        assert phase
        here = self._reached()
        end, meeting = end_after_hold(phase, here, self.variable)
        shown = meeting if not self.variable else phase.meeting
        self._go(replace(homing(phase, here, end), meeting=shown))

    # --- positioning ----------------------------------------------------------------------------------------------

    def _position(self, to_cycle: bool) -> None:
        """An edge of position_to_park or position_to_cycle."""
        slave = self._slave()
        still = abs(slave[1]) <= STILL and abs(slave[2]) <= STILL
        goal = (self._cycle_goal(slave[0]) if to_cycle else self._park_goal(slave[0])) if still else None
        moves = self._moves(slave[0], goal) if goal else None
        if self.state == IN_ALARM or goal is None or moves is None:
            self._refuse()
            return
        self.error_id, self.phase, self.moves = 0, goal, moves
        self.aimed_at = self._here() if to_cycle else None
        if to_cycle and self.variable:
            value = self.used if self.pending is None else self.pending
            waiting_for_it = goal.meeting is not None and goal.state == WAITING
            self.pending, self.used = (value, None) if waiting_for_it else (None, value)
        self.log.append((self.time, "positioning to cycle" if to_cycle else "positioning to park"))
        if moves:
            self.state, self.law = POSITIONING, Stand(slave[0])
            self._next_move()
        else:
            self._positioned()

    def _refuse(self) -> None:
        if self.state != IN_ALARM:
            self.error_id = REFUSED
        self._note("positioning refused")

    def _moves(self, position: Number, goal: Phase) -> list[tuple[Number, Number]] | None:
        """The phases of the move to where the goal begins; none if the slave is there, None if it cannot move."""
        target = goal.law.at(self.time, self.stretch.at(self.time))[0]
        if abs(target - position) <= STILL * (1 + abs(target)):
            return []
        v, a, j = (mp.mpf(self.inputs[f"positioning.{name}"]) for name in ("velocity", "acceleration", "jerk"))
        if min(v, a, j) <= 0:
            return None
        return list(move(Motion(position, ZERO, ZERO), target, v, a, a, j))

    def _park_goal(self, position: Number) -> Phase:
        values = Values.read(self.inputs)
        base = _nearest_turn(position - values.park, values.slave_cycle)
        return at_park(values, base + values.park, base, None)

    def _cycle_goal(self, position: Number) -> Phase | None:
        """The phase of an undisturbed cycle with the master where it is; None if there is none."""
        values = Values.read(self.inputs)
        value = mp.mpf(self.inputs["sync_master"])
        if self.variable:
            value = self.used if self.pending is None else self.pending
        if values.fault or value is None:
            return None
        goal = self._undisturbed(values, value - values.shift, ZERO)
        target = goal.law.at(self.time, self.stretch.at(self.time))[0]
        base = _nearest_turn(position - target, values.slave_cycle)
        return self._undisturbed(values, value - values.shift, base)

    def _undisturbed(self, values: Values, meeting: Number, base: Number) -> Phase:
        """From the beginning of a cycle up to the master's position, phase by phase."""
        here, near = self._here(), TIE * values.cycle
        on_and_on = not self.variable and not values.linear and not values.stop_in_park
        reduced = None if self.variable else values.steady_ramp()
        ramp = 2 * (values.sync - values.park) / values.k if reduced is None else reduced
        if not self.variable:
            begin = meeting if on_and_on else meeting - ramp
            meeting += mp.floor((here - begin) / values.cycle + TIE) * values.cycle
        elif here < meeting - ramp - near:
            return replace(at_park(values, base + values.park, base, None), meeting=meeting, ramp=ramp)
        phase = following(values, (base + values.park, ZERO, ZERO), meeting - ramp, meeting, base)
        if on_and_on:
            phase = synchronized(values, meeting, ramp, base)
        while phase.end <= here + near:
            if phase.state == FOLLOWING:
                phase = synchronized(values, meeting, ramp, base)
            elif phase.state == SYNCHRONIZED:
                out = phase.base + values.out
                way = Way(values, meeting, meeting + values.cycle, not self.variable, phase.end, out, values.k)
                onward = _onward(way, phase.base, values.stop_in_park)
                assert onward
                phase = onward
            else:
                phase = homing(phase, phase.end, home_end(phase)) if phase.state == DECEL else _parked(phase)
        return phase

    def _next_move(self) -> None:
        """The next piece of the move."""
        duration, jerk = self.moves.pop(0)
        s, v, a, _ = self._slave()
        self.law, self.timed_end = Timed(self.time, Motion(s, v, a), jerk), self.time + duration
        self._note()

    def _timed_over(self) -> None:
        """A piece of the move is over, or the stop ramp of an alarm."""
        self.timed_end = mp.inf
        if self.state == IN_ALARM:
            self.law = Stand(self._slave()[0])
            self._note("stopped")
        elif self.moves:
            self._next_move()
        else:
            self._positioned()

    def _positioned(self) -> None:
        goal, aimed_at = self.phase, self.aimed_at
        assert goal
        self.aimed_at, self.moves, self.timed_end = None, [], mp.inf
        if goal.state == WAITING:
            self._rest_at_park(goal)
        else:
            self.skipped, self.window, self.largest = -mp.inf, None, aimed_at
            self._go(goal)

    # --- faults ---------------------------------------------------------------------------------------------------

    def _limit(self, kind: str) -> Number | None:
        """The limit of speed or acceleration; None if it is not checked."""
        limit = mp.mpf(self.inputs[f"max_{kind}"])
        return limit * (1 + TIE) if self.inputs[f"check_{kind}"] and limit > 0 else None

    def _check_limits(self) -> None:
        """At the end of a step: the values about to be output, with those of the master up to here."""
        if self.state not in CYCLE:
            return
        _, v, a, _ = self._slave()
        for value, kind, first in ((v, "speed", 6), (a, "acceleration", 10)):
            limit = self._limit(kind)
            if limit is not None and abs(value) > limit:
                fault = first + CYCLE.index(self.state)
                self.error_id, self.state, self.phase = fault, IN_ALARM, None
                self._note()
                self.given = True
                self._alarm(fault)
                self.given = False
                return

    def _alarm(self, fault: int) -> None:
        """The stop ramp from here on."""
        s, v, *_ = self._slave()
        most = mp.mpf(self.inputs["max_acceleration"])
        most = most if most > 0 else mp.mpf(self.inputs["positioning.acceleration"])
        self.state, self.error_id, self.phase = IN_ALARM, fault, None
        self.aimed_at, self.moves, self.window = None, [], None
        if v == 0 or most <= 0:
            self.law, self.timed_end = Stand(s), mp.inf
        else:
            self.law = Timed(self.time, Motion(s, v, -mp.sign(v) * most))
            self.timed_end = self.time + abs(v) / most
        self._note(f"alarm {fault}")

    # --- inputs ---------------------------------------------------------------------------------------------------

    def _set(self, values: Mapping[str, Any]) -> None:
        """Everything set at one time: first what it is, then the edges, then what the levels and settings change."""
        if not values:
            return
        before, self.inputs = self.inputs, {**self.inputs, **values}
        self.given = True
        new = self.variable and self.inputs["sync_master"] != before["sync_master"]
        if new:
            self.pending = self._occurrence()
        for name in EDGES:
            if self.inputs[name] and not before[name]:
                self._command(name)
        self._settle(new)
        self.given = False

    def _command(self, name: str) -> None:
        match name:
            case "end_synchronism":
                self._end_synchronism()
            case "reset":
                self._reset()
            case _:
                self._position(name == "position_to_cycle")

    def _settle(self, new: bool) -> None:
        """What the slave at its present place makes of what is set."""
        phase = self.phase
        if phase is None:
            return
        if phase.held and not self.inputs["stop_after_forward"]:
            self._released()
        if self.state in (WAITING, WAITING_NEXT_CYCLE):
            self._choose()
        elif new and self.pending is not None and self.state in (DECEL, HOMING):
            if self.state == HOMING and self._recovered(self.pending - Values.read(self.inputs).shift):
                return
            phase = self.phase
            assert phase
            self.phase = replace(phase, meeting=self.pending - phase.values.shift)
            self._note()

    def _end_synchronism(self) -> None:
        if self.state == SYNCHRONIZED:
            self.error_id = 0
            self._synchronized_over(self._reached(), self._slave()[0])

    def _reset(self) -> None:
        if self.state != IN_ALARM:
            self.error_id = 0
            self._note("reset")
        elif isinstance(self.law, Stand):
            self.error_id, self.state = 0, IDLE
            self._note("reset")

    # --- outputs --------------------------------------------------------------------------------------------------

    def rows(self, time: float) -> list[dict[str, float]]:
        """One row for `time`, or two if the motion changes a column within the window around it."""
        t = mp.mpf(time)
        first = bisect_left(self.snapshots, t - WINDOW, key=lambda s: s.time) - 1
        last = bisect_right(self.snapshots, t + WINDOW, key=lambda s: s.time)
        latest = max(first, 0)
        while latest + 1 < last and not self.snapshots[latest + 1].given:
            latest += 1
        early = self._row(t, self.snapshots[max(first, 0)], -1)
        late = self._row(t, self.snapshots[latest], +1) if time > 0 else early
        return [early] if early == late else [early, late]

    def _row(self, t: Number, snapshot: Snapshot, side: int) -> dict[str, float]:
        """The outputs of a snapshot at `t`, with the master's velocity on one side (-1 or 1) of it."""
        stretch = self.master[bisect_right(self.begins, t + side * WINDOW) - 1]
        position = self.master[bisect_right(self.begins, t) - 1].at(t).position
        s, v, a, j = snapshot.law.at(t, replace(stretch.at(t), position=position), side, WINDOW)
        points = snapshot.points or (position, position, position)
        to_start, to_sync, to_out = (max(float(point - position), 0.0) for point in points)
        return {
            "time": float(t),
            "slave.position": self._wrapped(s, v, side),
            "slave.velocity": float(v) + 0.0,
            "slave.acceleration": float(a) + 0.0,
            "slave.jerk": float(j) + 0.0,
            "state": float(snapshot.state),
            "state_code": float(snapshot.state),
            "cycle": float(snapshot.cycle),
            "master_to_start": to_start,
            "master_to_sync": to_sync,
            "master_to_out": to_out,
            "error": float(snapshot.error_id != 0),
            "error_id": float(snapshot.error_id),
        }

    def _wrapped(self, s: Number, v: Number, side: int) -> float:
        """The position in the slave's cycle; a slave that just passes its end is at both ends, one on each side."""
        cycle = mp.mpf(self.inputs["slave_cycle"])
        if cycle == 0:
            return float(s) + 0.0
        turn = mp.nint(s / cycle)
        if abs(s - turn * cycle) <= WINDOW * abs(v):
            return float(cycle) if side * v < 0 else 0.0
        result = float(s - mp.floor(s / cycle) * cycle)
        return 0.0 if result >= float(cycle) else result


def _onward(way: Way, base: Number, to_park: bool) -> Phase | None:
    """The phase after M_SYNCHRONIZED; None if there is no room for it."""
    if way.values.linear:
        return deceleration(way)
    return way_to_park(way, base) if to_park or not way.known else connection(way, base)


def _parked(phase: Phase) -> Phase:
    """After homing."""
    return at_park(phase.values, phase.base + phase.values.park, phase.base, phase.reduced)


def _nearest_turn(distance: Number, cycle: Number) -> Number:
    """The multiple of the slave's cycle nearest to a distance; forwards where two are."""
    return mp.floor(distance / cycle + mp.mpf(0.5)) * cycle if cycle else ZERO


def _wrapped_start(pieces: list[Stretch], period: Number) -> list[Stretch]:
    """The stretches with the first position within the period."""
    if period == 0:
        return pieces
    shift = mp.floor(pieces[0].start.position / period) * period
    return [replace(p, start=replace(p.start, position=p.start.position - shift)) for p in pieces]


def _snapped(time: Number, breaks: Sequence[Number]) -> Number:
    """The break of the master's script that is meant by a time, else the time itself."""
    return next((b for b in breaks if abs(b - time) <= STILL * (1 + time)), time)


def _limited(script: Mapping[str, Any]) -> bool:
    """Whether there is ever a limit to be judged at the ends of the steps."""
    tables = (script.get("start", {}), *script.get("set", ()))
    return any(table.get(name) for table in tables for name in ("max_speed", "max_acceleration"))


def _points(script: Mapping[str, Any], horizon: Number) -> list[Number]:
    """The ends of the steps up to the scenario's end."""
    stop, step = float(script["stop_time"]), float(script["step_size"])
    points = [i * step for i in range(1, int(stop / step * (1 + 1e-12)) + 1)]
    points += [float(table[key]) for table in script.get("expect", ()) for key in ("at", "from", "to") if key in table]
    breaks = accumulate(mp.mpf(segment["duration"]) for segment in script["master"].get("segments", ()))
    return [end for end in {*(mp.mpf(point) for point in {*points, stop}), *breaks} if 0 < end <= horizon]
