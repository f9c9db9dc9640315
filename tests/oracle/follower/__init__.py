"""Reference for the Follower (Robox mv_follow2): the true behaviour on the continuous time axis.

An event loop over stretches on which the master moves one way. The phases of a cycle are those of `follower_cycle`,
polynomials over the master's position; positioning and the stop ramp of an alarm are polynomials of time.

A row is what the step that ends at its time puts out: what is set at that time does not show yet. The inputs are those
of START_OF_STEP, taken as exact. Speed and acceleration are checked at the ends of the steps only: the multiples of the
scenario's `step_size` and where something is set, expected, or the master's script breaks; that step shows the alarm
with the values that broke the limit, and the stop ramp starts there.

Readings of the specification where it leaves something open.

The meeting:
- "Up to the next start" in R means up to the next meeting, less the wait: R = Q' - m_out - wait, for a fixed cycle too
  (the formula for R is that, for an undisturbed cycle). M_f shared out of R at sync_out holds until the next
  sync_out or positioning, also for a start after a skipped one and for a value that comes late; else M_f is 2L/k with
  the values of the start.
- The slave starts from where it is: a `park_slave` changed meanwhile counts from the next way home (or positioning)
  on. The slope at sync_out is that of the cycle that ends, though k has changed.
- 3, 4, 5 are checked at each start and at each sync_out (5 there also for the next meeting chosen); and at park as soon
  as k or C lets no start be computed. `space_stop_slave` <= 0 (linear) and a negative wait or slave_cycle are 3.
- `master_to_*`: 0 in idle, positioning and alarm, and of a movement without stop in park `master_to_start`. At park
  they go by the parameters of now. A variable value given in decel or homing is the next meeting.
- A skipped cycle stays skipped, should the master come back to its start at park, or sync_master change: as after a
  synchronized phase, a meeting belongs to the cycle whose meeting is the nearest. Skipped or missed, the state is
  M_WAITING_NEXT_CYCLE until Q + C - M_f - wait even if a new value in reach has come meanwhile.
- Too late for this cycle (fixed): the start to its meeting is behind the master. That meeting is the next one ahead of
  the master (not the one where it is) or, where one was expected already, the one nearest to that. M_WAITING_NEXT_CYCLE
  then lasts up to the next start, less the wait.

A variable cycle:
- "Less than C after this one" is checked at sync_out, and where a value that came later would be met; such a value is
  lost. "Beyond what the phase
  allows" is a meeting that leaves no travel (R <= 0, M <= 0, no travel for homing).
- At park a late value is a missed start, so M_WAITING_NEXT_CYCLE, also right after positioning or homing.
- A value is checked again at park whenever a parameter changes. The occurrence ahead with a period is that of the value
  (not of the aligned meeting), ahead of the master when the value is set.
- Recovery is tried when the value is set in homing, however far ahead it is, and where it turns out late at park; not
  with skip or assumed set, and not with parameters out of order. If refused in homing the value stays.
- "In a cycle of the minimum duration" a recovery from where the slave is leads to the meeting C after the one before:
  to an earlier one it would be faster. So the values that count late are those that count in time. A later one may be
  faster, too, since the slave carries its curvature on: then it is held for park, where it is in time.

Positioning and alarms:
- Standstill is checked with the master after a jump at that time. Refused in M_IN_ALARM; the alarm's error_id stays.
  Parameters 3, 4, 5 out of order refuse positioning to the cycle (1), as does a limit <= 0 where the slave must move.
- Positioning to the cycle: the undisturbed cycle, in a cyclic one with stop M_f as in every cycle (not 2L/k of the
  first one), whatever is set to skip, assume or hold; of a cyclic slave the nearest turn. With a variable cycle the
  last value counts unless its cycle is over, skipped or missed; there is no next one.
- `error_id` 1 goes with an accepted positioning or end_synchronism, or with reset in any state but M_IN_ALARM.
- Several edges at once: to park, to cycle, end_synchronism, reset. They see what is set together with them.
- 14 is checked at the instant, the slave then being at rest where the largest value has it: velocity 0.
- Undisturbed travel (after a hold): what the homing would have had at the end of this M_DECEL, not held.
- A limit that is exactly reached is no fault, to 1e-12 of it. Where positions decide (a start just ahead, a value
  exactly C later, k·M = 2S, a release with just enough travel) 1e-12·C is none.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from tests.oracle.event_run import Event, EventRun, events_of, rows_of
from tests.oracle.flying_saw.curves import ZERO
from tests.oracle.flying_saw.motion import move
from tests.oracle.follower.cycle import (
    BAD_K,
    DECEL,
    FOLLOWING,
    HOMING,
    IDLE,
    IN_ALARM,
    POSITIONING,
    SYNCHRONIZED,
    TIE,
    TOO_SHORT,
    WAITING,
    WAITING_NEXT_CYCLE,
    Cam,
    Law,
    Phase,
    Rates,
    Standstill,
    SyncExit,
    Timed,
    Values,
    at_park,
    end_after_hold,
    first_not_before,
    following,
    home_end,
    homing,
    nearest_turn,
    onward_from,
    parked,
    synchronized,
    undisturbed,
)
from tests.oracle.follower.inputs import EDGES, FIXED, SETTABLE, STILL, has_limits, snapped, step_ends
from tests.oracle.follower.master import CYCLE, MOVED, MasterCrossings, wrapped_start
from tests.oracle.follower.outputs import FollowerRows, FollowerSnapshot
from tests.oracle.master import Motion, Stretch, stretches
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
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
"""What a scenario's reference has in addition to the time."""

REFUSED, MASTER_MOVED, FELL_BACK = 1, 2, 14
LIMIT_FAULTS = {state: (6 + number, 10 + number) for number, state in enumerate(CYCLE)} | {POSITIONING: (15, 16)}
NAMES = dict(zip(CYCLE, ("following", "synchronized", "decel", "homing"), strict=True))


def reference(script: Mapping[str, Any], times: Sequence[float]) -> list[dict[str, float]]:
    """The block's outputs at each of `times` (s, in rising order, each once), enumerations and Booleans as numbers.

    The script has `stop_time`, `step_size`, `[start]` values, the `[master]` script and `[[set]]` tables. Two rows,
    just before and just after, where the motion jumps or changes its state within 1e-9 s of a time.
    """
    return rows_of(FollowerRun, script, times)


def events(script: Mapping[str, Any]) -> list[tuple[float, str]]:
    """What happens until `stop_time`: (time, name), in order.

    Raises ValueError for a set at or before 0, for a set of something that is neither an input nor tunable, and for
    parameters with which the block does not initialize (faults 3, 4, 5).
    """
    return events_of(FollowerRun, script)


class FollowerRun(MasterCrossings, EventRun):
    """One run of the block: everything that it knows between two events, and the snapshots it has gone through.

    `phase`: the cycle's, None in idle and alarm; in positioning the one aimed at. `aimed_at`: the master's position
    during positioning to the cycle. `largest`: that of the master since leaving park. `pending`: a variable value that
    no cycle has used yet, `used`: that of the cycle that runs. `last_meeting`: that of the last synchronized phase.
    `earliest`: no meeting before it, since that of the cycle that was skipped is nearer; `window`: up to where
    M_WAITING_NEXT_CYCLE lasts.
    """

    def __init__(self, script: Mapping[str, Any], horizon: Number) -> None:
        start = script.get("start", {})
        self.inputs = {name: start.get(name, default) for name, default in {**SETTABLE, **FIXED}.items()}
        self.variable, self.period = bool(self.inputs["variable_cycle"]), mp.mpf(self.inputs["master.period"])
        if fault := Values.read(self.inputs).fault:
            raise ValueError(f"fault {fault} at the end of initialization")
        self.master = wrapped_start(stretches(script["master"], horizon), self.period)
        self.begin_times = [stretch.begin for stretch in self.master]
        self.stretch, self.time = self.master[0], ZERO
        self.state = IDLE
        self.law: Law = Standstill(mp.mpf(self.inputs["slave.initial_position"]))
        self.phase: Phase | None = None
        self.moves: list[tuple[Number, Number]] = []
        self.timed_end = mp.inf
        self.aimed_at: Number | None = None
        self.largest = self.earliest = self.last_meeting = -mp.inf
        self.window: Number | None = None
        self.used: Number | None = None
        self.pending: Number | None = self._occurrence() if self.variable else None
        self.cycle, self.error_id = 0, 0
        self.given = False
        self.log: list[tuple[Number, str]] = []
        self.outputs = FollowerRows(self.master, self.begin_times, mp.mpf(self.inputs["slave_cycle"]))
        self.time = -mp.inf
        self._note()
        self._run(script, horizon)

    # --- the course of events -------------------------------------------------------------------------------------

    def _run(self, script: Mapping[str, Any], horizon: Number) -> None:
        """All stretches, step by step; what the path does at the time of a set comes before it."""
        tables = gathered(script.get("set", ()), SETTABLE)
        sets = {snapped(mp.mpf(at), self.begin_times): values for at, values in tables.items()}
        points = step_ends(script, horizon) if has_limits(script) else []
        grid = sorted({snapped(point, self.begin_times) for point in points} | sets.keys())
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
        self.outputs.snapshots.append(
            FollowerSnapshot(self.time, self.given, self.law, self.state, self.cycle, self.error_id, shown),
        )
        if name:
            self.log.append((self.time, name))

    def _enter(self, stretch: Stretch) -> None:
        """The master goes on by another stretch: what it has reached is its largest value so far."""
        self.stretch, self.time = stretch, stretch.begin
        if self.state in CYCLE:
            self.largest = max(self.largest, self._master_position())
            self.law = self._floored(self.law)
        self._note()

    def _next(self, until: Number) -> Event | None:
        """The first thing that happens until then."""
        possible: list[tuple[Number | None, Callable[[], None]]] = []
        if self.timed_end <= until:
            possible.append((self.timed_end, self._timed_over))
        if self.aimed_at is not None:
            possible.append((self._leaves(self.aimed_at, until), lambda: self._alarm(MASTER_MOVED)))
        phase = self.phase
        if phase and self.state in CYCLE:
            allowed = self.largest - MOVED * phase.values.cycle
            possible.append((self._falls(allowed, until), lambda: self._alarm(FELL_BACK)))
            if not phase.held:
                possible.append((self._reaches(phase.end, until), self._phase_over))
        elif phase and self.state in (WAITING, WAITING_NEXT_CYCLE):
            possible += self._park_events(phase, until)
        happening = [(at, act) for at, act in possible if at is not None]
        return min(happening, key=lambda event: event[0]) if happening else None

    def _park_events(self, phase: Phase, until: Number) -> list[tuple[Number | None, Callable[[], None]]]:
        possible: list[tuple[Number | None, Callable[[], None]]] = []
        if self.window is not None:
            possible.append((self._reaches(self.window, until), self._window_over))
        if phase.points:
            start = phase.points[0]
            if self.stretch.direction >= 0:
                possible.append((self._reaches(start, until), self._start))
            cycle = phase.values.cycle
            if not self.variable and phase.points[1] - cycle >= self.earliest:
                possible.append((self._falls(start - cycle, until, touching=True), self._choose))
        return possible

    # --- present values -------------------------------------------------------------------------------------------

    def _slave(self) -> Rates:
        return self.law.at(self.time, self.stretch.at(self.time))

    def _floored(self, law: Law) -> Law:
        return replace(law, floor=self.largest) if isinstance(law, Cam) else law

    def _occurrence(self) -> Number:
        """The value of sync_master, with a period its first occurrence ahead of the master."""
        value = mp.mpf(self.inputs["sync_master"])
        return first_not_before(value, self.period, self._master_position()) if self.period else value

    def _enter_phase(self, phase: Phase) -> None:
        """The next phase of the cycle."""
        self.phase, self.state, self.law = phase, phase.state, self._floored(phase.law)
        self._note(NAMES[phase.state])

    # --- at park --------------------------------------------------------------------------------------------------

    def _rest_at_park(self, phase: Phase) -> None:
        """The slave has reached park, by positioning or homing."""
        self.phase, self.state, self.law = phase, WAITING, phase.law
        self.used, self.window = None, None
        self.earliest = self.largest = -mp.inf
        self.log.append((self.time, "at park"))
        self._choose()

    def _choose(self) -> None:
        """The meeting that the slave waits for, by the parameters of now; a value that is too late is missed."""
        phase, values = self.phase, Values.read(self.inputs)
        assert phase
        if values.k <= 0 or values.cycle <= 0:
            self._alarm(BAD_K if values.k <= 0 else TOO_SHORT)
            return
        ramp, tolerance = self._ramp(phase, values), TIE * values.cycle
        meeting: Number | None = None
        if not self.variable:
            value = mp.mpf(self.inputs["sync_master"]) - values.shift
            meeting = first_not_before(value, values.cycle, max(self._master_position() + ramp, self.earliest))
            lowest = self._master_position() + 2 * tolerance
            if phase.meeting is not None:
                lowest = phase.meeting - values.cycle / 2
            present = first_not_before(value, values.cycle, lowest)
            if present - ramp < self._master_position() - tolerance:
                self.log.append((self.time, "start missed"))
                self._wait_for_next(meeting - ramp - values.wait)
        elif self.pending is not None:
            meeting = self.pending - values.shift
            if self._is_too_soon(meeting, values):
                meeting = None
            elif meeting - ramp < self._master_position() - tolerance:
                if self._recovered(meeting):
                    return
                self.log.append((self.time, "start missed"))
                self._wait_for_next(meeting + values.cycle - ramp - values.wait)
                self.pending = meeting = None
        self.phase = replace(phase, values=values, meeting=meeting, ramp=ramp)
        self._note()

    def _ramp(self, phase: Phase, values: Values) -> Number:
        """M_f from where the slave is."""
        park = phase.law.at(ZERO, Motion(ZERO, ZERO, ZERO))[0]
        return 2 * (phase.base + values.sync - park) / values.k if phase.reduced is None else phase.reduced

    def _wait_for_next(self, window: Number) -> None:
        if self._master_position() < window:
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
            self.earliest, self.pending = meeting + values.cycle / 2, None
            self._wait_for_next(begin + values.cycle - values.wait)
            self._choose()
        elif values.fault:
            self._alarm(values.fault)
        else:
            self.used, self.pending = self.pending, None
            self.largest, self.window = begin, None
            self._enter_phase(following(values, (self._slave()[0], ZERO, ZERO), begin, meeting, phase.base))

    def _to_skip(self) -> bool:
        return bool(self.inputs["skip_next_cycle"] or self.inputs["sync_assumed"])

    def _is_too_soon(self, meeting: Number, values: Values) -> bool:
        """Whether a value is lost, since its meeting is less than C after the one before."""
        is_too_soon = bool(meeting < self.last_meeting + values.cycle * (1 - TIE))
        if is_too_soon:
            self.log.append((self.time, "value too soon"))
            self.pending = None
        return is_too_soon

    def _recovered(self, meeting: Number) -> bool:
        """A late value is met on the fly, if that is allowed and keeps the limits."""
        phase, values, begin = self.phase, Values.read(self.inputs), self._reached()
        assert phase
        is_allowed = self.inputs["recover_late_sync"] and not (values.linear or values.stop_in_park or self._to_skip())
        if not is_allowed or values.fault or meeting <= begin:
            return False
        if self._is_too_soon(meeting, values):
            return False
        rates = self.law.over(begin)[:3] if isinstance(self.law, Cam) else (self._slave()[0], ZERO, ZERO)
        joining = following(values, rates, begin, meeting, phase.base)
        earliest, slack = self.last_meeting + values.cycle, TIE * values.cycle
        if begin + slack < earliest < meeting - slack:
            fastest = following(values, rates, begin, earliest, phase.base)
            if _greatest(joining, 1) > _greatest(fastest, 1) * (1 + TIE):
                self.log.append((self.time, "recovery too fast"))
                return False
        velocity = self.stretch.at(self.time).velocity
        for order, kind in ((1, "speed"), (2, "acceleration")):
            greatest = _greatest(joining, order)
            limit = self._limit(kind)
            if limit is not None and greatest * abs(velocity) ** order > limit:
                self.log.append((self.time, "recovery refused"))
                return False
        self.used, self.pending, self.window = self.pending, None, None
        self.largest = max(self.largest, begin)
        self.log.append((self.time, "recovered"))
        self._enter_phase(joining)
        return True

    # --- the cycle ------------------------------------------------------------------------------------------------

    def _phase_over(self) -> None:
        """The master has reached the end of the phase."""
        phase = self.phase
        assert phase
        if phase.state == FOLLOWING:
            assert phase.meeting is not None
            self._enter_phase(synchronized(phase.values, phase.meeting, phase.ramp, phase.base))
        elif phase.state == SYNCHRONIZED:
            self._synchronized_over(phase.end, phase.base + phase.values.out)
        elif phase.state == HOMING:
            self._rest_at_park(parked(phase))
        elif self.inputs["stop_after_forward"]:
            assert isinstance(phase.law, Cam)
            rest = Standstill(phase.law.over(phase.end)[0])
            self.phase, self.law = replace(phase, held=True, law=rest), rest
            self._note("held")
        else:
            self._enter_phase(homing(phase, phase.end, home_end(phase)))

    def _synchronized_over(self, begin: Number, slave: Number) -> None:
        """The end of M_SYNCHRONIZED: the next meeting and the way there, with the parameters of now."""
        phase, values = self.phase, Values.read(self.inputs)
        assert phase
        assert phase.meeting is not None
        self.cycle += 1
        self.last_meeting = phase.meeting
        if values.fault:
            self._alarm(values.fault)
            return
        next_, is_given = self._next_meeting(phase.meeting, values)
        sync_exit = SyncExit(values, phase.meeting, next_, is_given, begin, slave, phase.values.k)
        to_park = values.stop_in_park or self._to_skip()
        onward = onward_from(sync_exit, phase.base, to_park)
        if onward is None and self.variable:
            sync_exit = replace(sync_exit, next=sync_exit.meeting + values.cycle, is_given=False)
            onward = onward_from(sync_exit, phase.base, to_park)
        if self.variable and not sync_exit.is_given:
            self.pending = None
        if onward is None:
            self._alarm(TOO_SHORT)
            return
        if onward.state == FOLLOWING:
            self.used, self.pending = self.pending, None
        self._enter_phase(onward)

    def _next_meeting(self, meeting_before: Number, values: Values) -> tuple[Number, bool]:
        if not self.variable:
            value = mp.mpf(self.inputs["sync_master"]) - values.shift
            return first_not_before(value, values.cycle, meeting_before + values.cycle / 2), True
        if self.pending is not None and self.pending - values.shift >= meeting_before + values.cycle * (1 - TIE):
            return self.pending - values.shift, True
        return meeting_before + values.cycle, False

    def _released(self) -> None:
        """The end of a hold after the forward stroke."""
        phase = self.phase
        assert phase
        begin = self._reached()
        end, meeting = end_after_hold(phase, begin, self.variable)
        shown = meeting if not self.variable else phase.meeting
        self._enter_phase(replace(homing(phase, begin, end), meeting=shown))

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
        self.aimed_at = self._master_position() if to_cycle else None
        if to_cycle and self.variable:
            value = self.used if self.pending is None else self.pending
            waiting_for_it = goal.meeting is not None and goal.state == WAITING
            self.pending, self.used = (value, None) if waiting_for_it else (None, value)
        self.log.append((self.time, "positioning to cycle" if to_cycle else "positioning to park"))
        if moves:
            self.state, self.law = POSITIONING, Standstill(slave[0])
            self._next_move()
        else:
            self._positioned()

    def _refuse(self) -> None:
        if self.state != IN_ALARM:
            self.error_id = REFUSED
        self._note("positioning refused")

    def _moves(self, position: Number, goal: Phase) -> list[tuple[Number, Number]] | None:
        """The phases of the move to where the goal starts; none if the slave is there, None if it cannot move."""
        target = goal.law.at(self.time, self.stretch.at(self.time))[0]
        if abs(target - position) <= STILL * (1 + abs(target)):
            return []
        v, a, j = (mp.mpf(self.inputs[f"positioning.{name}"]) for name in ("velocity", "acceleration", "jerk"))
        if min(v, a, j) <= 0:
            return None
        return list(move(Motion(position, ZERO, ZERO), target, v, a, a, j))

    def _park_goal(self, position: Number) -> Phase:
        values = Values.read(self.inputs)
        base = nearest_turn(position - values.park, values.slave_cycle)
        return at_park(values, base + values.park, base, None)

    def _cycle_goal(self, position: Number) -> Phase | None:
        """The phase of an undisturbed cycle with the master where it is; None if there is none."""
        values = Values.read(self.inputs)
        value = mp.mpf(self.inputs["sync_master"])
        if self.variable:
            value = self.used if self.pending is None else self.pending
        if values.fault or value is None:
            return None
        meeting, master = value - values.shift, self._master_position()
        goal = undisturbed(values, meeting, ZERO, master, is_variable=self.variable)
        target = goal.law.at(self.time, self.stretch.at(self.time))[0]
        base = nearest_turn(position - target, values.slave_cycle)
        return undisturbed(values, meeting, base, master, is_variable=self.variable)

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
            self.law = Standstill(self._slave()[0])
            self._note("stopped")
        elif self.moves:
            self._next_move()
        else:
            self._positioned()

    def _positioned(self) -> None:
        goal, aimed_at = self.phase, self.aimed_at
        assert goal
        self.aimed_at, self.moves, self.timed_end = None, [], mp.inf
        self.last_meeting = goal.sync_exit.meeting if goal.sync_exit else -mp.inf
        if goal.state == WAITING:
            self._rest_at_park(goal)
        else:
            self.earliest, self.window, self.largest = -mp.inf, None, aimed_at
            self._enter_phase(goal)

    # --- faults ---------------------------------------------------------------------------------------------------

    def _limit(self, kind: str) -> Number | None:
        """The limit of speed or acceleration; None if it is not checked."""
        limit = mp.mpf(self.inputs[f"max_{kind}"])
        return limit * (1 + TIE) if self.inputs[f"check_{kind}"] and limit > 0 else None

    def _check_limits(self) -> None:
        """At the end of a step: the values about to be output, with those of the master up to this time."""
        if self.state not in LIMIT_FAULTS:
            return
        _, v, a, _ = self._slave()
        for value, kind, fault in zip((v, a), ("speed", "acceleration"), LIMIT_FAULTS[self.state], strict=True):
            limit = self._limit(kind)
            if limit is not None and abs(value) > limit:
                self.error_id, self.state, self.phase = fault, IN_ALARM, None
                self._note()
                self.given = True
                self._alarm(fault)
                self.given = False
                return

    def _alarm(self, fault: int) -> None:
        """The stop ramp from now on."""
        s, v, *_ = self._slave()
        limit = mp.mpf(self.inputs["max_acceleration"])
        stop_deceleration = limit if limit > 0 else mp.mpf(self.inputs["positioning.acceleration"])
        self.state, self.error_id, self.phase = IN_ALARM, fault, None
        self.aimed_at, self.moves, self.window = None, [], None
        if v == 0 or stop_deceleration <= 0:
            self.law, self.timed_end = Standstill(s), mp.inf
        else:
            self.law = Timed(self.time, Motion(s, v, -mp.sign(v) * stop_deceleration))
            self.timed_end = self.time + abs(v) / stop_deceleration
        self._note(f"alarm {fault}")

    # --- inputs ---------------------------------------------------------------------------------------------------

    def _set(self, values: Mapping[str, Any]) -> None:
        """Everything set at one time: first what it is, then the edges, then what the levels and settings change."""
        if not values:
            return
        before, self.inputs = self.inputs, {**self.inputs, **values}
        self.given = True
        is_new = self.variable and self.inputs["sync_master"] != before["sync_master"]
        if is_new:
            self.pending = self._occurrence()
        for name in EDGES:
            if self.inputs[name] and not before[name]:
                self._command(name)
        self._settle(is_new)
        self.given = False

    def _command(self, name: str) -> None:
        match name:
            case "end_synchronism":
                self._end_synchronism()
            case "reset":
                self._reset()
            case _:
                self._position(name == "position_to_cycle")

    def _settle(self, is_new: bool) -> None:
        """What changes for the slave at its present position."""
        phase = self.phase
        if phase is None:
            return
        if phase.held and not self.inputs["stop_after_forward"]:
            self._released()
        if self.state in (WAITING, WAITING_NEXT_CYCLE):
            self._choose()
        elif is_new and self.pending is not None and self.state in (DECEL, HOMING):
            if self.state == HOMING and self._recovered(self.pending - Values.read(self.inputs).shift):
                return
            phase = self.phase
            assert phase
            self.phase = replace(phase, meeting=None if self.pending is None else self.pending - phase.values.shift)
            self._note()

    def _end_synchronism(self) -> None:
        if self.state == SYNCHRONIZED:
            self.error_id = 0
            self._synchronized_over(self._reached(), self._slave()[0])

    def _reset(self) -> None:
        if self.state != IN_ALARM:
            self.error_id = 0
            self._note("reset")
        elif isinstance(self.law, Standstill):
            self.error_id, self.state = 0, IDLE
            self._note("reset")


def _greatest(phase: Phase, order: int) -> Number:
    """The greatest magnitude of a derivative over the master, anywhere in the phase."""
    assert isinstance(phase.law, Cam)
    return max(abs(extremum.value) for extremum in phase.law.curve.extrema(order))
