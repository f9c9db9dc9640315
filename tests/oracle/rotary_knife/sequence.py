"""The sequence of a rotary knife on the continuous time axis: from event to event.

Readings of the specification that it leaves open, beside those of `piece_machine`, `piece_records`,
`rotary_knife_records` and `rotary_knife_ways`:
- `front_position` is counted in travel of the material from the cut's place, as the window is.
- However far the line runs back, the knife follows its sections back; `state` is that of the section. Back at rest
  before a ramp up, it waits as before, and the ramp is checked again.
- A stop, `hold` or a missing length ends in the ramp down; a piece that becomes known meanwhile is checked at rest.
- `last.time` is the time of the cut. `last.reserve` is the share of the time since the cut before in which the knife
  was at rest with its motion over: in WAITING.
- `cut_now` while turning or on a ramp down is answered at once: it moves the cut or warns until the next cut. With
  `hold`, on a ramp down, it waits. In the first half of a window, as in ENGAGING, it is that cut; in the second half it
  is answered at the window's end. It may be given where no length is known.
- A cut that a `cut_now` or TRIM sets out to from rest waits for a line that is slow enough.
- SKIP out of rest: the places are left out whose ramp up has begun, and at least one; the velocity is checked again at
  that ramp's beginning.
- `hold` during a ramp down keeps the knife at rest, also where a ramp up would follow at once.
- A change in THIS_PIECE that comes after the cut, in the window, is checked at the window's end with that whole cycle.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tests.oracle.cutting.machine import LATE, SKIP, Event
from tests.oracle.cutting.records import CUT_MISSED, CUT_NOW_REFUSED, SHORT, START_REFUSED, TRIM, TUNABLE
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.numerics.root_search import find_first_root
from tests.oracle.rotary_knife.curves import ZERO, Cut, Extremes, Rest, greatest
from tests.oracle.rotary_knife.limits import Way, ramp_velocity
from tests.oracle.rotary_knife.line import ExactSection
from tests.oracle.rotary_knife.parking import ParkingKnife
from tests.oracle.rotary_knife.records import RANGES
from tests.oracle.rotary_knife.state import (
    DISENGAGING,
    ENGAGING,
    FAULT,
    OFF,
    ON_A_CURVE,
    SYNCHRONOUS,
    TURNING,
    WAITING,
    PathSection,
)
from tests.oracle.rotary_knife.ways import LATENESS, Departure

ROUNDING = mp.mpf("1e-12")
"""Of a ramp's width: how far from its beginning it may be laid because an event's time is a float."""


class KnifeRun(ParkingKnife):
    """One run of a knife, simulated when it is made: see `log` and `snapshots`."""

    read_by_cycle = ("late_mode",)

    def __init__(
        self,
        inputs: dict[str, Any],
        sections: Sequence[ExactSection],
        steps: Sequence[float],
        sets: Mapping[float, Mapping[str, Any]],
        period: float,
    ) -> None:
        super().__init__(inputs, sections[0], steps, period)
        self.replacement: tuple[Cut, Way] | None = None
        self.add_snapshot()
        self.run(sections, sets)

    def _events(self, until: float) -> list[Event]:
        if self.timed is not None:
            return self._events_in_time()
        if self.state in (OFF, FAULT):
            return []
        events: list[Event] = []
        if self.index > 0 and self.section.direction < 0:
            at = self.section.passes(self.path[self.index].begin, -1, self.time, until)
            if at is not None:
                events.append((at, lambda: self._enter(self.index - 1)))
        if self.index + 1 < len(self.path):
            at = self.section.passes(self.path[self.index + 1].begin, 1, self.time, until)
            return events if at is None else [*events, (at, lambda: self._enter(self.index + 1))]
        if self.state == WAITING:
            return events + self._events_while_waiting(until)
        assert self.state == SYNCHRONOUS
        assert self.cut is not None
        place, act = (self.cut.end, self._leave_window) if self.is_cut_made else (self.cut.place, self._make_cut)
        at = self.section.passes(place, 1, self.time, until)
        return events if at is None else [*events, (at, act)]

    def _enter(self, index: int) -> None:
        """Another section of the path."""
        forwards = index > self.index
        if self.state == WAITING:
            self.rest_time += self.time - self.rest_begin
        self.index, self.state = index, self.path[index].state
        if self.state == SYNCHRONOUS and forwards:
            self.log.append((self.time, "sync"))
        if self.state != WAITING:
            return
        self.rest_begin = self.time
        if self.is_stopping:
            self._switch_off()
        elif not forwards or self.inputs["hold"]:
            self.log.append((self.time, "rest" if forwards else "turned back"))
            self._cut_off_path()
        else:
            self.log.append((self.time, "rest"))

    def _cut_off_path(self) -> None:
        """What was laid after the present section holds no more."""
        del self.path[self.index + 1 :]

    # --- at rest ----------------------------------------------------------------------------------------------------

    def _events_while_waiting(self, until: float) -> list[Event]:
        records = self.records
        if self.is_stopping:
            return [(self.time, self._switch_off)]
        if self.inputs["hold"] or self.is_blocked or self.section.direction < 0:
            return []
        window = records.window if records.piece else records.window_as_set()
        limit = ramp_velocity(self.knife, window) * (1 + LATENESS)

        def margin(time: float) -> float:
            return float(limit - self.master(time).velocity)

        if self.is_cut_requested:
            at = find_first_root(margin, self.time, until)
            return [] if at is None else [(at, self._start_requested_cut)]
        if records.piece is None or self.section.direction == 0:
            return []
        begin = self.knife.ramp_up(self.next_cut(records.piece.cut_position, window)).begin
        at = self.section.passes(begin, 1, self.time, until)
        if at is not None and records.piece.kind == TRIM:
            at = find_first_root(margin, at, until)
        return [] if at is None else [(at, self._begin_ramp)]

    def _begin_ramp(self) -> None:
        """The ramp up begins, unless the line is too fast or it is too late."""
        records, piece, m = self.records, self.records.piece, self.master()
        assert piece is not None
        if not RANGES.are_valid(self.inputs, self.read_by_cycle):
            self.is_blocked, self.refusal = True, TUNABLE
            return
        ramp = self.knife.ramp_up(self.next_cut(piece.cut_position, records.window))
        is_slow = m.velocity <= ramp_velocity(self.knife, records.window) * (1 + LATENESS)
        earliest = m.position + ramp.width + records.window.before
        leaves_length = records.leaves_length(piece.cut_position)
        if m.position <= ramp.begin + LATENESS * ramp.width and is_slow and leaves_length:
            self._plan_ramp_up(ramp.begin if m.position <= ramp.begin + ROUNDING * ramp.width else m.position)
        elif piece.kind == TRIM:
            records.move_cut(earliest)
            self._plan_ramp_up(m.position)
        elif records.inputs["late_mode"] == LATE and is_slow and records.leaves_length(earliest):
            records.move_cut(earliest, late=True)
            records.statistics.add("late")
            self._plan_ramp_up(m.position)
        elif records.inputs["late_mode"] in (SKIP, LATE):
            records.skip_cut(earliest - LATENESS * ramp.width)
        else:
            self._fail(CUT_MISSED)

    def _start_requested_cut(self) -> None:
        """A `cut_now` at rest."""
        records, m = self.records, self.master()
        self.is_cut_requested = False
        if records.piece is None:
            records.window = records.window_as_set()
        ramp = self.knife.ramp_up(self.next_cut(ZERO, records.window))
        cut_position = m.position + ramp.width + records.window.before
        if not records.leaves_length(cut_position):
            self._answer_command(CUT_NOW_REFUSED)
            return
        records.move_cut(cut_position, SHORT)
        self._plan_ramp_up(m.position)

    def _plan_ramp_up(self, begin: Number) -> None:
        piece = self.records.piece
        assert piece is not None
        self.log.append((self.time, "start"))
        cut = self.next_cut(piece.cut_position, self.records.window)
        self._cut_off_path()
        self.extremes = self._append([PathSection(begin, ENGAGING, self.knife.ramp_up(cut, begin))], cut)
        self._enter(self.index + 1)

    def _append(self, sections: Sequence[PathSection], cut: Cut | None) -> Extremes:
        """Append sections, and the window of the cut they lead to; the extremes of both."""
        self.path += sections
        curves = [s.curve.extremes() for s in sections if not isinstance(s.curve, Cut | Rest)]
        if cut is None:
            return greatest(*curves)
        self.path.append(PathSection(cut.begin, SYNCHRONOUS, cut))
        self.cut, self.is_cut_made = cut, False
        return greatest(*curves, cut.window.extremes(-cut.window.before))

    # --- the cut ----------------------------------------------------------------------------------------------------

    def _make_cut(self) -> None:
        """The piece is recorded, and the next one is fixed."""
        piece, cut = self.records.piece, self.cut
        assert piece is not None
        assert cut is not None
        self.log.append((self.time, "cut"))
        reserve = 1.0
        if self.last_cut_time is not None:
            reserve = 0.0 if piece.late else self.rest_time / (self.time - self.last_cut_time)
        self.last_cut_time, self.rest_time = self.time, 0.0
        self.last_position, self.last_window, self.is_cut_made = cut.position, cut.window, True
        self.has_no_earlier_cut = False
        self.records.record_cut(cut.place, self.time, reserve)
        self.refusal = TUNABLE if self.records.has_invalid_settings else self.refusal

    def _leave_window(self) -> None:
        """The window's end: the way to the next cut is laid, or the ramp down."""
        assert self.cut is not None
        records, cut = self.records, self.cut
        departure = Departure(self.knife, cut.end, cut.at(cut.end), self.master().velocity, cut.window)
        rests = self.is_stopping or bool(self.inputs["hold"])
        if not rests:
            records.change_piece(
                lambda place: departure.admissible_way(self.next_cut(place, records.window_as_set())) is not None
            )
            if self.is_cut_requested:
                self.is_cut_requested = False
                if self._plan_earliest_cut(departure):
                    return
        if rests or records.piece is None:
            self._plan_ramp_down(departure)
            return
        following = self.next_cut(records.piece.cut_position, records.window)
        way = departure.admissible_way(following) if records.leaves_length(records.piece.cut_position) else None
        if way:
            self._plan_way(departure, way, following)
            return
        mode = records.inputs["late_mode"]
        if mode not in (SKIP, LATE):
            self._fail(CUT_MISSED)
        elif not (mode == LATE and self._delay_cut(departure, following)) and not self._skip_cut(departure):
            self._plan_ramp_down(departure)

    def _delay_cut(self, departure: Departure, late: Cut) -> bool:
        """LATE: the cut is made as early as it can be."""

        def cut_after(z: Number) -> Cut:
            return self.next_cut(departure.place + z + late.window.before, late.window)

        longest = departure.longest_turning(cut_after)
        least = max(late.begin, self.records.least_end() - late.window.before) - departure.place
        reached = departure.earliest(cut_after, least, longest) if least < longest else None
        reached = reached or departure.earliest_parking(cut_after, max(least, longest))
        if reached is None:
            return False
        cut, way = reached
        self.records.move_cut(cut.place, late=True)
        self.records.statistics.add("late")
        self._plan_way(departure, way, cut)
        return True

    def _skip_cut(self, departure: Departure) -> bool:
        """SKIP: the next place is taken that can be reached."""
        piece, records = self.records.piece, self.records
        assert piece is not None

        marks = [place for place in records.marks[1:] if records.leaves_length(place)]

        def places() -> Iterator[Number]:
            if records.is_by_marks:
                yield from marks
                return
            place = mp.mpf(piece.cut_position)
            while True:
                place += piece.pitch
                yield place

        reached = departure.first_of(self.next_cut(place, records.window) for place in places())
        if reached is None:
            return False
        number, cut, way = reached
        records.skip_cut(marks[number - 1] if records.is_by_marks else cut.place - mp.mpf(piece.pitch) / 2)
        self._plan_way(departure, way, cut)
        return True

    def _plan_way(self, departure: Departure, way: Way, cut: Cut) -> None:
        self._cut_off_path()
        before = self.cut.window if departure.leaving and self.cut else None
        if not way.parks:
            sections = [PathSection(departure.place, TURNING, way.curves[0])]
            extremes = self._append(sections, cut)
        else:
            down, up = way.curves
            rest = PathSection(down.end, WAITING, Rest(down.at(down.end)[0]))
            sections = [PathSection(departure.place, DISENGAGING, down), rest]
            is_shortened = up.begin <= down.end + ROUNDING * down.width
            if is_shortened:
                sections.append(PathSection(up.begin, ENGAGING, up))
            extremes = self._append(sections, cut if is_shortened else None)
            extremes = greatest(extremes, up.extremes(), cut.window.extremes(-cut.window.before))
        self.extremes = greatest(extremes, before.extremes(before.after)) if before else extremes
        self._enter(self.index + 1)

    def _plan_ramp_down(self, departure: Departure) -> None:
        down = self.knife.ramp_down(departure.place, departure.state, self.last_position + self.knife.spacing)
        assert down is not None
        if departure.velocity > self.knife.velocity_for(down.extremes()) * (1 + LATENESS):
            self.records.warnings["limit_exceeded"] = True
        self._cut_off_path()
        rest = PathSection(down.end, WAITING, Rest(down.at(down.end)[0]))
        extremes = self._append([PathSection(departure.place, DISENGAGING, down), rest], None)
        self.extremes = (
            greatest(extremes, departure.leaving.extremes(departure.leaving.after)) if departure.leaving else extremes
        )
        self._enter(self.index + 1)

    # --- a curve laid anew ------------------------------------------------------------------------------------------

    def _departure(self) -> Departure:
        m = self.master()
        return Departure(self.knife, m.position, self.derivatives(), m.velocity, None)

    def _can_still_reach(self, cut_position: float) -> bool:
        records, m = self.records, self.master()
        cut = self.next_cut(cut_position, records.window_as_set())
        if not self.knife.may_park and cut.place - records.origin > records.longest_pitch():
            return False
        if self.state == WAITING:
            ramp = self.knife.ramp_up(cut)
            return bool(m.position <= ramp.begin + LATENESS * ramp.width)
        is_held = self.state == DISENGAGING and (self.is_stopping or bool(self.inputs["hold"]))
        if self.state not in ON_A_CURVE or m.velocity <= 0 or is_held:
            return False
        way = self._departure().admissible_way(cut, shortened=False)
        self.replacement = (cut, way) if way else None
        return way is not None

    def _check_cycle(self) -> None:
        if self.replacement is not None:
            cut, way = self.replacement
            self.replacement = None
            self._plan_way(self._departure(), way, cut)

    def _plan_earliest_cut(self, departure: Departure) -> bool:
        """A `cut_now` where the knife turns: the window is moved forward as far as the limits allow, if that gains."""
        records, piece = self.records, self.records.piece
        window = records.window if piece else records.window_as_set()

        def cut_after(z: Number) -> Cut:
            return self.next_cut(departure.place + z + window.before, window)

        if departure.velocity > 0:
            longest = departure.longest_turning(cut_after)
            if piece is not None:
                longest = min(longest, mp.mpf(piece.cut_position) - window.before - departure.place)
            least = max(ZERO, records.least_end() - window.before - departure.place)
            reached = departure.earliest(cut_after, least, longest) if longest > least else None
            if reached is not None and (piece is None or reached[0].place < piece.cut_position):
                cut, way = reached
                records.window = window
                records.move_cut(cut.place, SHORT)
                self._plan_way(departure, way, cut)
                return True
        self.has_no_earlier_cut = True
        return False

    # --- commands ---------------------------------------------------------------------------------------------------

    def _do_start(self) -> None:
        records, mode = self.records, self.inputs["start_mode"]
        if self.state != OFF or (mode == 3 and records.last_cut is None):
            self._answer_command(START_REFUSED)
            return
        read = {2: ("trim_length", "front_position"), 3: ()}.get(mode, ("front_position",))
        is_valid = RANGES.are_valid(self.inputs, ("start_mode", "kerf", *read))
        if not is_valid or (mode == 2 and not records.has_valid_window):
            self._answer_command(TUNABLE)
            return
        self._answer_command()
        self.is_cut_requested = self.is_stopping = False
        self.last_cut_time, self.rest_begin, self.rest_time = None, self.time, 0.0
        self.rest_at(self.derivatives()[0], WAITING)
        records.start(self.master().position, records.f)

    def _do_cut_now(self) -> None:
        super()._do_cut_now()
        if not self.is_cut_requested or self.state == WAITING:
            return
        is_last = self.index == len(self.path) - 1
        if self.state == DISENGAGING and self.inputs["hold"]:
            return
        if self.state == SYNCHRONOUS and self.is_cut_made and is_last:
            return
        self.is_cut_requested = False
        if self.state in (TURNING, DISENGAGING) and not self.inputs["hold"]:
            self._plan_earliest_cut(self._departure())
        elif self.state in (TURNING, DISENGAGING):
            self.has_no_earlier_cut = True
