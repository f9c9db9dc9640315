"""The sequence of a cut-to-length machine on the continuous time axis: from event to event.

Between two events the carriage follows one law (`cut_to_length_carriage`); `piece_records` records the pieces.

Readings of the specification that it leaves open, beside those of `piece_machine`:
- The way home is not eased where it starts on a line that accelerates: it would be FAST from the next step on.
- `warning.blade_early` holds until the blade starts its next cut in time.
- A `stop` during an eased way home makes it FAST.
- An eased way home that has become FAST stays FAST.
- With fault 17 the blade is down for `tool.retract_time` more, though the carriage goes home.
- Where the line turns back past the start, the cycle goes on, and so does the time spent at home.
- `tool.done` is no command: it leaves a refusal as it is.
- A blade that touches less than 1e-9 s before sync touches at sync.
- While a `cut_now` waits for a slower line, it is not checked whether the cut that is due can be reached.
"""

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from tests.oracle.cut_to_length.carriage import (
    CurveOverMaster,
    InSync,
    MasterSection,
    approach_curve,
    begin_of_return,
    gap_curve,
    plan_eased_return,
    stop_position,
)
from tests.oracle.cut_to_length.limits import DISTANCE, FEEDBACK, Saw, change_time
from tests.oracle.cut_to_length.parameters import CYCLE, RANGES
from tests.oracle.cut_to_length.records import STROKE, TOOL_TIMEOUT
from tests.oracle.cut_to_length.state import (
    APPROACHING,
    CLEARING,
    CUTTING,
    FAULT,
    HOMING,
    IN_SYNC,
    OFF,
    PULLING,
    RETURNING,
    SYNCHRONOUS,
    WAITING,
    MachineState,
)
from tests.oracle.cutting.machine import LATE, SKIP, STOP_LINE, Event
from tests.oracle.cutting.records import CUT_MISSED, CUT_NOW_REFUSED, SHORT, START_REFUSED, TRIM, TUNABLE
from tests.oracle.numerics.root_search import find_first_root
from tests.oracle.timed_motion import AxisState, Rest, TimedMotion, is_at_target, plan_move

LATENESS = FASTER = EARLY = 1e-9


class MachineRun(MachineState):
    """One run of a machine, simulated when it is made: see `log` and `snapshots`."""

    read_by_cycle = CYCLE

    def __init__(
        self,
        inputs: dict[str, Any],
        sections: Sequence[MasterSection],
        steps: Sequence[float],
        sets: Mapping[float, Mapping[str, Any]],
        period: float,
        initial_position: float,
    ) -> None:
        super().__init__(inputs, sections[0], steps, period, initial_position)
        self.add_snapshot()
        self.run(sections, sets)

    # --- what is checked, and what happens ------------------------------------------------------------------------

    def _check_cycle(self) -> None:
        if self.ease < 1.0 and self._must_hurry():
            self._hurry_home()

    def _can_still_reach(self, cut_position: float) -> bool:
        """In a state in which the piece may change, the start for a cut at that position is still ahead."""
        if self.state not in (HOMING, WAITING, PULLING, CLEARING, RETURNING):
            return False
        m, saw = self.master(), self.records.saw()
        return saw.home - saw.k * (m.position - cut_position) >= saw.lead(saw.k * m.velocity)

    @property
    def _needs_each_step(self) -> bool:
        return self.ease < 1.0 or super()._needs_each_step

    def _events(self, until: float) -> list[Event]:
        events: list[Event] = []
        if self.state in (HOMING, RETURNING) or (self.state == FAULT and self.clear_time == inf):
            events = [(self.motion_end(), self._arrive), (max(self.blade_up_time, self.time), self._finish_retracting)]
        elif self.state == FAULT:
            events = [(self.clear_time, self._finish_clearing)]
        elif self.state == WAITING:
            events = self._events_while_waiting(until)
        elif self.state == APPROACHING:
            events = self._events_of_approach(until)
        elif self.state in IN_SYNC:
            events = [event for event in self._events_in_sync(until) if event[0] <= until]
            events += self._events_of_stroke_end(min([until, *(time for time, _ in events)]))
        return events

    # --- waiting --------------------------------------------------------------------------------------------------

    def _events_while_waiting(self, until: float) -> list[Event]:
        if self.is_stopping:
            return [(self.time, self._switch_off)]
        begin = max(self.time, self.ready_time)
        if begin > until or self.inputs["hold"] or self.is_blocked or self.section.direction < 0:
            return []
        saw, piece, events = self.records.saw(), self.records.piece, []

        def stroke_margin(time: float) -> float:
            return saw.stroke_margin(self.master(time).velocity)

        if self.is_cut_requested:
            at = find_first_root(stroke_margin, begin, until)
            return [] if at is None else [(at, self._start_requested_cut)]
        if piece is not None and self.section.direction > 0:

            def past_start(time: float) -> float:
                m = self.master(time)
                return saw.k * (m.position - piece.cut_position) - saw.home + saw.approach_distance(m.velocity)

            trim = piece.kind == TRIM
            at = find_first_root(
                lambda t: min(past_start(t), stroke_margin(t)) if trim else past_start(t), begin, until
            )
            if at is not None:
                crossed = at > begin and past_start(begin) < 0
                events.append((at, lambda: self._pass_start_point(saw, crossed)))
        return events

    def _pass_start_point(self, saw: Saw, crossed: bool) -> None:
        """The approach starts, unless the line is too fast or it is too late."""
        m, piece, mode = self.master(), self.records.piece, self.records.inputs["late_mode"]
        assert piece is not None
        if not RANGES.are_valid(self.inputs, CYCLE):
            self.is_blocked, self.refusal = True, TUNABLE
            return
        speed = saw.k * m.velocity
        from_position = m.position - (saw.home - saw.lead(speed)) / saw.k
        left = saw.home - saw.k * (m.position - piece.cut_position)
        distance = saw.approach_distance(m.velocity) if crossed else left
        if saw.stroke_margin(m.velocity) < 0:
            self._fail(STROKE) if mode == STOP_LINE else self.records.skip_cut(from_position)
        elif distance >= saw.lead(speed) * (1 - LATENESS) and self.records.leaves_length(piece.cut_position):
            self._start_approach(saw, distance)
        elif piece.kind == TRIM:
            self.records.move_cut(from_position)
            self._start_approach(saw, saw.lead(speed))
        elif mode == SKIP or (mode == LATE and not self.records.leaves_length(from_position)):
            self.records.skip_cut(from_position)
        elif mode == LATE:
            self.records.move_cut(from_position, late=True)
            self.records.statistics.add("late")
            self._start_approach(saw, saw.lead(speed))
        else:
            self._fail(CUT_MISSED)

    def _start_requested_cut(self) -> None:
        if not RANGES.are_valid(self.inputs, CYCLE):
            self.is_blocked, self.refusal = True, TUNABLE
            return
        m, saw = self.master(), self.records.saw()
        lead = saw.lead(saw.k * m.velocity)
        self.is_cut_requested = False
        cut_position = m.position - (saw.home - lead) / saw.k
        if not self.records.leaves_length(cut_position):
            self._answer_command(CUT_NOW_REFUSED)
            return
        self.records.move_cut(cut_position, SHORT)
        self._start_approach(saw, lead)

    def _start_approach(self, saw: Saw, distance: float) -> None:
        piece = self.records.piece
        assert piece is not None
        self.log.append((self.time, "start"))
        self.state, self.cycle = APPROACHING, saw
        self.cut_position, self.sync_position = piece.cut_position, saw.home + distance
        self.start_time, self.command_on_time = self.time, None
        self.touched_early = self.has_gap = False
        self.reserve = 1.0
        if self.previous_start_time is not None:
            self.time_at_home += self.time - max(self.ready_time, self.turn_back_time)
            self.reserve = 0.0 if piece.late else self.time_at_home / (self.time - self.previous_start_time)
        if distance > 0:
            self.law = approach_curve(saw.k, piece.cut_position, saw.home, distance)
        else:
            self._synchronize()

    # --- approach, cut --------------------------------------------------------------------------------------------

    def _events_of_approach(self, until: float) -> list[Event]:
        saw, events = self.cycle, []
        end = self.cut_position + self.sync_position / saw.k
        if (at := self.section.passes(end, 1, self.time, until)) is not None:
            events.append((at, self._synchronize))
        begin = self.cut_position + (2 * saw.home - self.sync_position) / saw.k
        if self.section.direction < 0 and self.master(until).position < begin:
            at = self.section.passes(begin, -1, self.time, until)
            events.append((self.time if at is None else at, self._turn_back))
        lead_time = saw.on_delay - saw.settle
        if lead_time > 0 and self.command_on_time is None:

            def distance_at_switching(time: float) -> float:
                m = self.master(time)
                return m.position + m.velocity * lead_time - end

            if (at := find_first_root(distance_at_switching, self.time, until)) is not None:
                events.append((at, self._switch_tool_on))
        return events + self._events_of_touch()

    def _events_of_touch(self) -> list[Event]:
        if self.command_on_time is None or self.is_blade_down:
            return []
        return [(max(self.command_on_time + self.cycle.on_delay, self.time), self._touch_material)]

    def _touch_material(self) -> None:
        self.is_blade_down = True
        m = self.master()
        missing = self.cut_position + self.sync_position / self.cycle.k - m.position
        if self.state == APPROACHING and missing > EARLY * m.velocity:
            self.touched_early = self.records.warnings["blade_early"] = True
            self.records.statistics.add("unsynchronised")

    def _switch_tool_on(self) -> None:
        self.command_on_time = self.time
        self.switch_tool(True)

    def _turn_back(self) -> None:
        self.log.append((self.time, "turned back"))
        self.turn_back_time = self.time
        self.state, self.law, self.is_blade_down = WAITING, Rest(self.cycle.home), False
        self.switch_tool(False)

    def _synchronize(self) -> None:
        self.log.append((self.time, "sync"))
        self.state, self.law, self.sync_time = SYNCHRONOUS, InSync(self.cycle.k, self.cut_position), self.time
        if self.command_on_time is None and self.cycle.on_delay > self.cycle.settle:
            self._switch_tool_on()

    def _events_in_sync(self, until: float) -> list[Event]:
        """What the carriage does in sync, but for the end of its stroke."""
        saw = self.cycle
        if self.state == SYNCHRONOUS:
            if self.command_on_time is None:
                return [(max(self.sync_time + saw.settle - saw.on_delay, self.time), self._switch_tool_on)]
            begin = max(self.sync_time + saw.settle, self.command_on_time + saw.on_delay)
            return self._events_of_touch() or [(max(begin, self.time), self._begin_cut)]
        if self.state == CUTTING:
            return self._events_of_cut(until)
        if self.state == PULLING:
            assert isinstance(self.law, CurveOverMaster)
            end = self.cut_position + self.law.begin + self.law.width
            at = self.section.passes(end, 1, self.time, until)
            return [] if at is None else [(at, self._finish_gap)]
        return [(self.clear_time, self._finish_clearing)]

    def _begin_cut(self) -> None:
        self.state, self.cut_begin_time = CUTTING, self.time
        self.records.warnings["blade_early"] = self.touched_early
        self.cut_begin_position = self.master().position

    def _events_of_cut(self, until: float) -> list[Event]:
        saw = self.cycle
        if saw.mode == DISTANCE:
            end = self.cut_begin_position + saw.cut_distance / saw.k
            if self.master().position >= end:
                return [(self.time, self._end_cut)]
            at = self.section.passes(end, 1, self.time, until)
            return [] if at is None else [(at, self._end_cut)]
        if saw.mode == FEEDBACK:
            at_last = self.cut_begin_time + saw.timeout if saw.timeout > 0 else inf
            return [(max(at_last, self.time), lambda: self._fail(TOOL_TIMEOUT))]
        return [(max(self.cut_begin_time + saw.cut_time, self.time), self._end_cut)]

    def _end_cut(self) -> None:
        """The piece is recorded; the gap is opened, or the blade leaves the material."""
        self.log.append((self.time, "cut"))
        saw, m = self.cycle, self.master()
        self.records.record_cut(self.cut_position, self.sync_time, self.reserve)
        self.refusal = TUNABLE if self.records.has_invalid_settings else self.refusal
        self.previous_start_time, self.has_gap = self.start_time, False
        if saw.gap > 0 and m.velocity > 0 and saw.can_open_gap(m.velocity):
            self.state, self.has_gap = PULLING, True
            self.law = gap_curve(saw.k, self.cut_position, m.position - self.cut_position, saw.gap_travel, saw.gap)
            return
        self.records.warnings["gap_skipped"] = saw.gap > 0
        self.switch_tool(False)
        self.state, self.clear_time = CLEARING, self.time + saw.retract

    def _finish_gap(self) -> None:
        self.switch_tool(False)
        self.law = InSync(self.cycle.k, self.cut_position, self.cycle.gap)
        self.state, self.clear_time = CLEARING, self.time + self.cycle.retract

    def _finish_clearing(self) -> None:
        """The blade is clear of the material."""
        self.clear_time, self.is_blade_down = inf, False
        if self.state != FAULT:
            self.state = RETURNING
        self._go_home()

    # --- the end of the stroke ------------------------------------------------------------------------------------

    def _events_of_stroke_end(self, until: float) -> list[Event]:
        saw, now = self.cycle, self.records.saw()

        def beyond(time: float) -> float:
            """How far the stop would end beyond the nearer end of the stroke."""
            position = stop_position(self.carriage(time), now)
            return max(position - saw.high, saw.low - position)

        at = find_first_root(beyond, self.time, until)
        return [] if at is None else [(at, lambda: self._fail(STROKE))]

    # --- the way home ---------------------------------------------------------------------------------------------

    def _go_home(self) -> None:
        """From the present state; eased if that is set and there is time."""
        self.ease = 1.0
        saw, home = self.records.saw(), self.cycle.home
        state = begin_of_return(self.carriage(), saw)
        if is_at_target(state, home):
            self._arrive()
        elif self.state == RETURNING and self._plan_eased_return(state):
            return
        else:
            self.law = plan_move(self.time, state, home, saw.homing)

    def _plan_eased_return(self, state: AxisState) -> bool:
        """The way home is eased: a halt, then a slower move."""
        piece, m, saw = self.records.piece, self.master(), self.records.saw()
        if not self.inputs["homing.ease"] or piece is None or m.velocity <= 0 or not self.records.is_running:
            return False
        if self.is_stopping or self.is_cut_requested or m.acceleration > 0:
            return False
        _, acceleration, deceleration, jerk = saw.homing
        speed = state[1]
        braking = change_time(speed, deceleration, jerk)
        distance = state[0] - self.cycle.home + speed * braking / 2
        shortest = saw.return_time(0.0, distance, acceleration)
        start = piece.cut_position + (saw.home - saw.approach_distance(m.velocity)) / saw.k
        time_left = (start - m.position) / m.velocity - saw.settle_home - self.records.inputs["homing.spare_time"]
        if time_left <= braking + shortest:
            return False
        self.ease = max(self.records.inputs["homing.slowest"], shortest / (time_left - braking))
        self.ease_velocity, self.ease_cut_position = m.velocity, piece.cut_position
        self.law = plan_eased_return(self.time, state, self.cycle.home, saw.homing, self.ease)
        return True

    def _must_hurry(self) -> bool:
        """At a step's beginning: an eased way home is too slow by now."""
        m, piece = self.master(), self.records.piece
        if m.velocity > self.ease_velocity * (1 + FASTER) or m.acceleration > 0:
            return True
        if self.is_cut_requested or self.is_stopping:
            return True
        return piece is None or piece.cut_position != self.ease_cut_position

    def _hurry_home(self) -> None:
        self.ease, saw = 1.0, self.records.saw()
        self.law = plan_move(self.time, begin_of_return(self.carriage(), saw), self.cycle.home, saw.homing)

    def _arrive(self) -> None:
        """At rest at home."""
        self.log.append((self.time, "home"))
        self.law, self.ease, self.home_time = Rest(self.cycle.home), 1.0, self.time
        if self.state == FAULT:
            return
        self.ready_time, self.time_at_home = self.time + self.records.inputs["homing.settle_time"], 0.0
        self.state = WAITING
        if self.is_stopping:
            self._switch_off()

    def _finish_retracting(self) -> None:
        """The blade is clear, although the carriage is not in sync any more."""
        self.is_blade_down, self.blade_up_time = False, inf

    def _switch_off(self) -> None:
        self.state = OFF
        self.is_stopping = self.is_cut_requested = False
        self.records.stop()

    def _fail(self, fault: int) -> None:
        self.log.append((self.time, f"fault {fault}"))
        self.fault = fault
        is_cutting, is_clearing = self.is_blade_down and self.state != APPROACHING, self.state == CLEARING
        if fault == STROKE and self.is_blade_down:
            self.records.statistics.add("unsynchronised")
        self.is_stopping = self.is_cut_requested = False
        self.state = FAULT
        self.records.stop()
        if fault == STROKE:
            self.blade_up_time = self.clear_time if is_clearing else self.time + self.cycle.retract
        self._leave_material(is_cutting and fault != STROKE, is_clearing)

    def _leave_material(self, is_cutting: bool, is_clearing: bool) -> None:
        """The blade leaves the material, in sync if it is down; then home."""
        self.switch_tool(False)
        if is_cutting:
            self.clear_time = self.clear_time if is_clearing else self.time + self.cycle.retract
            return
        self.clear_time = inf
        self.is_blade_down = self.is_blade_down and self.blade_up_time < inf
        fast = isinstance(self.law, TimedMotion) and self.ease == 1.0
        if not (fast or isinstance(self.law, Rest)):
            self._go_home()

    # --- commands -------------------------------------------------------------------------------------------------

    def _do_reset(self) -> None:
        self.refusal = 0
        if self.state == FAULT and isinstance(self.law, Rest):
            self.state, self.fault = OFF, 0

    def _do_abort(self) -> None:
        if not self.records.is_running:
            return
        self._answer_command()
        is_cutting, is_clearing = self.is_blade_down and self.state != APPROACHING, self.state == CLEARING
        self.is_stopping, self.is_cut_requested = True, False
        if self.state == WAITING:
            self._switch_off()
            return
        self.state = CLEARING if is_cutting else RETURNING
        self._leave_material(is_cutting, is_clearing)

    def _do_stop(self) -> None:
        if not self.records.is_running:
            return
        self._answer_command()
        self.is_stopping = True
        if self.state == WAITING:
            self._switch_off()

    def _do_start(self) -> None:
        records, mode = self.records, self.inputs["start_mode"]
        if self.state != OFF or (mode == 3 and records.last_cut is None):
            self._answer_command(START_REFUSED)
            return
        read = {2: ("trim_length", "front_position"), 3: ("home_position",)}
        if not RANGES.are_valid(
            self.inputs, ("start_mode", "home_position", "kerf", *read.get(mode, ("front_position",)))
        ):
            self._answer_command(TUNABLE)
            return
        self._answer_command()
        saw = records.saw()
        self.cycle, self.previous_start_time = saw, None
        self.is_cut_requested = self.is_stopping = False
        records.start(self.master().position, saw.k)
        if is_at_target(self.carriage(), saw.home):
            self.state = WAITING
        else:
            self.state = HOMING
            self._go_home()

    def _do_tool_done(self) -> None:
        if self.state == CUTTING and self.cycle.mode == FEEDBACK:
            self._end_cut()
