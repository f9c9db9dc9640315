"""A machine that cuts to length, from event to event: what all of them have, whatever carries their blade.

What the specification notices at a step's beginning is noticed where the steps of the script begin.

Readings of the specification that it leaves open:
- What is set where the master jumps acts with the master after the jump.
- A `cut_now` after `stop` or `abort` is refused, though the machine runs until it is at rest.
- `start` clears a `cut_now` that waits; so do `stop`'s arrival, `abort` and a fault.
- A `cut_now` that would leave no piece is refused where it would be carried out, and a late cut that leaves none is
  left out, in LATE, too.
- Marks are no commands: they leave a refusal as it is.
- Any other command that is not refused clears a refusal; `stop` and `abort` of a machine that does not run are none.
"""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from math import isclose
from typing import Any, ClassVar, Protocol, TypeAlias

from tests.oracle.cutting.records import CUT_NOW_REFUSED, TUNABLE, PieceRecords

SKIP, LATE, STOP_LINE = 1, 2, 3
COMMANDS = (
    *("reset", "abort", "stop", "start", "clear_statistics", "calibration.reset", "calibration.execute"),
    *("order.clear", "order.skip", "order.add", "take_sample", "mark.detected", "cut_now"),
)
MOST_EVENTS = 1_000_000

Event: TypeAlias = tuple[float, Callable[[], None]]


class LineSection(Protocol):
    """The master from `begin` to `end` (s), on which it moves in one `direction` or is at rest (0)."""

    @property
    def begin(self) -> float: ...

    @property
    def end(self) -> float: ...

    @property
    def direction(self) -> int: ...

    def at(self, time: float) -> Any:
        """Position, velocity and acceleration."""


class PieceMachine(ABC):
    """All that is known of a machine at one instant.

    `inputs`: as they are set at present; `steps`: where the script's steps begin; `period`: of the master, or 0.
    `log`: time and name of each event up to now.
    """

    commands: ClassVar[Sequence[str]] = COMMANDS
    read_by_cycle: ClassVar[Sequence[str]] = ()
    """The variables without which no cycle begins, unless they are within their ranges."""

    def __init__(
        self, inputs: dict[str, Any], records: PieceRecords, section: LineSection, steps: Sequence[float], period: float
    ) -> None:
        self.inputs, self.records, self.steps, self.period = inputs, records, steps, period
        self.command_levels = {name: bool(inputs[name]) for name in self.commands}
        self.section, self.time, self.at_step_begin = section, 0.0, False
        self.fault, self.refusal = 0, 0
        self.is_stopping = self.is_cut_requested = self.is_blocked = False
        self.has_mark_edge = False
        self.log: list[tuple[float, str]] = []

    # --- what a machine adds --------------------------------------------------------------------------------------

    @abstractmethod
    def add_snapshot(self) -> None:
        """Add what holds from now on."""

    @abstractmethod
    def _events(self, until: float) -> list[Event]:
        """What happens by itself, some of it perhaps later than `until`."""

    @abstractmethod
    def _can_still_reach(self, cut_position: float) -> bool:
        """THIS_PIECE: whether the piece may be changed now, so that its cut is at that position."""

    @abstractmethod
    def _fail(self, fault: int) -> None: ...

    @abstractmethod
    def _check_cycle(self) -> None:
        """Check what a cycle under way notices at a step's beginning."""

    # --- from event to event --------------------------------------------------------------------------------------

    def run(self, sections: Sequence[LineSection], sets: Mapping[float, Mapping[str, Any]]) -> None:
        """All sections, interrupted by the sets; what happens by itself at the time of a set comes before it."""
        end = sections[-1].end
        times = sorted({*(c.begin for c in sections), *(t for t in sets if t <= end)})
        section_of, step_begins = {c.begin: c for c in sections}, frozenset(self.steps)
        for time, until in zip(times, [*times[1:], end], strict=True):
            self.time, self.at_step_begin = time, time in step_begins
            if time in section_of:
                self.section = section_of[time]
            if self.at_step_begin:  # where the master only turns back no step begins
                self._begin_step(sets.get(time, {}), first_step=time == 0)
            self.at_step_begin = False
            self._run_until(until)

    def _begin_step(self, values: Mapping[str, Any], *, first_step: bool = False) -> None:
        """What a step starts with: commands, then what is checked at each step's beginning."""
        lacks_piece = self.records.is_running and self.records.piece is None
        if not (values or first_step or lacks_piece or self._needs_each_step):
            return
        self.inputs |= values
        self.records.accept_settings()
        self.is_blocked = self.is_blocked and not self.records.ranges.are_valid(self.inputs, self.read_by_cycle)
        rising = [name for name in self.commands if self.inputs[name] and not self.command_levels[name]]
        self.command_levels = {name: bool(self.inputs[name]) for name in self.commands}
        if first_step and self.inputs["auto_start"] and "start" not in rising:
            rising.append("start")
        for name in self.commands:
            if name in rising:
                getattr(self, "_do_" + name.replace(".", "_"))()
        self._check_at_step_begin()
        self.add_snapshot()

    def _check_at_step_begin(self) -> None:
        """Check what is noticed at a step's beginning only."""
        records = self.records
        if records.is_running and records.piece is None:
            records.fix_piece()
            self.refusal = TUNABLE if records.has_invalid_settings else self.refusal
        if records.is_running:
            records.change_piece(self._can_still_reach)
        if records.are_marks_expected and not self.has_mark_edge:
            m = self.section.at(self.time)
            fault = records.count_missing_marks(m.position - m.velocity * records.inputs["mark.delay"])
            if fault:
                self._fail(fault)
            elif records.piece is None:
                records.fix_piece()
        self.has_mark_edge = False
        self._check_cycle()

    @property
    def _needs_each_step(self) -> bool:
        """Something is checked at each step's beginning."""
        return self.records.are_marks_expected or self.records.warnings["change_pending"]

    def _run_until(self, until: float) -> None:
        """Everything that happens by itself until then."""
        for _ in range(MOST_EVENTS):
            limit = until
            if self._needs_each_step:
                i = bisect_right(self.steps, self.time)
                limit = min(until, self.steps[i]) if i < len(self.steps) else until
            event = self._next_event(limit)
            if event is not None:
                self.time, act = event
                act()
                self.add_snapshot()
            elif limit >= until:
                self.time = until
                return
            else:
                self.time, self.at_step_begin = limit, True
                self._begin_step({})
                self.at_step_begin = False
        raise ArithmeticError(f"no progress at {self.time}")

    def _next_event(self, until: float) -> Event | None:
        """The first thing that happens until then."""
        events = [event for event in self._events(until) if event[0] <= until]
        return min(events, key=lambda event: event[0], default=None)

    # --- commands that move nothing -------------------------------------------------------------------------------

    def _answer_command(self, refusal: int = 0) -> None:
        self.refusal = refusal

    def _do_clear_statistics(self) -> None:
        self._answer_command()
        self.records.statistics = type(self.records.statistics)()

    def _do_calibration_reset(self) -> None:
        self._answer_command()
        self.records.calibration = 1.0

    def _do_calibration_execute(self) -> None:
        self._answer_command(self.records.calibrate())

    def _do_order_clear(self) -> None:
        self._answer_command()
        self.records.orders = []

    def _do_order_skip(self) -> None:
        self._answer_command()
        self.records.orders = self.records.orders[1:]

    def _do_order_add(self) -> None:
        self._answer_command(self.records.add_order())

    def _do_take_sample(self) -> None:
        self._answer_command()
        self.records.sample_requested = True

    def _do_mark_detected(self) -> None:
        m = self.section.at(self.time)
        position = m.position - m.velocity * self.records.inputs["mark.delay"]
        if self.inputs["mark.latched"]:
            position = float(self.inputs["mark.position"])
            if self.period > 0:
                position += round((m.position - position) / self.period) * self.period
        self.has_mark_edge = True
        if fault := self.records.detect_mark(position, float(m.position)):
            self._fail(fault)

    def _do_cut_now(self) -> None:
        if not self.records.is_running or self.is_stopping:
            self._answer_command(CUT_NOW_REFUSED)
            return
        self._answer_command()
        self.is_cut_requested = True

    # --- what is shown --------------------------------------------------------------------------------------------

    def outputs(self, highest: float, *, failed: bool) -> dict[str, float | bool]:
        """What is shown of the machine, where `highest` is the line's greatest admissible velocity."""
        piece, margin = self.records.piece, float(self.inputs["line.margin"])
        has_next_cut = self.records.is_running and piece is not None
        requested_velocity = min(float(self.inputs["line.wanted_velocity"]), (1 - margin) * highest)
        return self.records.outputs() | {
            "next_cut.known": has_next_cut,
            "next_cut.position": self._wrap(piece.cut_position) if has_next_cut and piece else 0.0,
            "line.velocity_request": 0.0 if failed else requested_velocity,
            "line.stop_request": failed,
            "error": bool(self.fault or self.refusal),
            "error_id": self.fault or self.refusal,
        }

    def _wrap(self, position: float) -> float:
        """The position within the master's period."""
        if self.period == 0:
            return position
        wrapped = position % self.period
        return 0.0 if isclose(wrapped, self.period, rel_tol=1e-15) else wrapped
