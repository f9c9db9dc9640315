"""A cut-to-length machine between two events: where its cycle is, and what it shows from then on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isclose
from typing import Any

from tests.oracle.cut_to_length_carriage import CarriageState, MasterSection, Motion, MotionLaw, Rest, TimedMotion
from tests.oracle.cut_to_length_limits import Saw
from tests.oracle.cut_to_length_records import Piece, PieceRecords

FAULT, OFF, HOMING, WAITING, APPROACHING, SYNCHRONOUS, CUTTING, PULLING, CLEARING, RETURNING = range(-1, 9)
IN_SYNC = (SYNCHRONOUS, CUTTING, PULLING, CLEARING)
SKIP, LATE, STOP_LINE = 1, 2, 3
COMMANDS = (
    *("reset", "abort", "stop", "start", "clear_statistics", "calibration.reset", "calibration.execute"),
    *("order.clear", "order.skip", "order.add", "take_sample", "mark.detected", "cut_now", "tool.done"),
)


@dataclass(frozen=True)
class Snapshot:
    """What holds from `time` on.

    `at_step_begin`: because of something that is noticed at a step's beginning; the step's end shows it first.
    `saw`: the machine as it is set; `cycle`: that of the cycle under way, if there is one.
    `sync_position`: where the carriage comes in sync; `material`: b and Δ as they are set.
    """

    time: float
    at_step_begin: bool
    state: int
    law: MotionLaw
    saw: Saw
    cycle: Saw
    piece: Piece | None
    origin: float
    is_running: bool
    sync_position: float
    material: tuple[float, float]
    mark_delay: float
    outputs: Mapping[str, float]
    max_velocity: float
    max_velocity_orders: float


class MachineState:
    """All that is known of a machine at one instant, and the snapshots up to it.

    `inputs`: as they are set at present; `steps`: where the script's steps begin; `period`: of the master, or 0.
    `cycle`: the machine as it was set when the cycle under way began; `cut_position`: of the cycle's cut.
    `log`: time and name of each event up to now.
    """

    def __init__(
        self,
        inputs: dict[str, Any],
        section: MasterSection,
        steps: Sequence[float],
        period: float,
        initial_position: float,
    ) -> None:
        self.inputs, self.steps, self.period = inputs, steps, period
        self.records = PieceRecords(inputs)
        self.command_levels = {name: bool(inputs[name]) for name in COMMANDS}
        self.state = OFF
        self.law: MotionLaw = Rest(initial_position)
        self.section, self.time, self.at_step_begin = section, 0.0, False
        self.fault, self.refusal = 0, 0
        self.is_stopping = self.is_cut_requested = self.is_blocked = False
        self.cycle = self.records.saw()
        self.ready_time, self.home_time, self.start_time = 0.0, 0.0, 0.0
        self.previous_start_time: float | None = None
        self.time_at_home, self.turn_back_time = 0.0, 0.0
        self.reserve = 1.0
        self.cut_position, self.sync_position, self.sync_time = 0.0, 0.0, 0.0
        self.command_on_time: float | None = None
        self.command, self.command_time = False, 0.0
        self.is_blade_down = self.touched_early = False
        self.cut_begin_time, self.cut_begin_position, self.clear_time, self.blade_up_time = inf, 0.0, inf, inf
        self.has_gap = False
        self.ease, self.ease_velocity, self.ease_cut_position = 1.0, 0.0, 0.0
        self.has_mark_edge = False
        self.log: list[tuple[float, str]] = []
        self.solved_velocities: dict[Any, float] = {}
        self.snapshots: list[Snapshot] = []

    def master(self, time: float | None = None) -> Motion:
        """The master now, or at another time in its present section."""
        return self.section.at(self.time if time is None else time)

    def carriage(self, time: float | None = None) -> CarriageState:
        """The carriage now, or at another time while its law holds."""
        at = self.time if time is None else time
        return self.law.at(at, self.section.at(at))

    def switch_tool(self, on: bool) -> None:
        """Set the tool's command, and note when it changes."""
        if self.command != on:
            self.command, self.command_time = on, self.time

    def motion_end(self) -> float:
        """When a motion in time ends; infinite for any other."""
        return max(self.law.end, self.time) if isinstance(self.law, TimedMotion) else inf

    def add_snapshot(self) -> None:
        """Add what holds from now on."""
        records, saw = self.records, self.records.saw()
        pitch, pitch_of_orders = records.pitches()
        highest, highest_orders = self._solve_line_velocity(saw, pitch), self._solve_line_velocity(saw, pitch_of_orders)
        piece, front = records.piece, records.orders[0] if records.orders else None
        requested_velocity, margin = float(self.inputs["line.wanted_velocity"]), float(self.inputs["line.margin"])
        failed = self.state == FAULT
        has_next_cut = records.is_running and piece is not None
        cycling = self.state in (APPROACHING, *IN_SYNC)
        outputs = {
            "running": records.is_running,
            "in_sync": self.state in (SYNCHRONOUS, CUTTING) or (self.state == CLEARING and not self.has_gap),
            "tool.command": self.command,
            "tool.command_time": self.command_time,
            "tool.blade_down": self.is_blade_down,
            "tool.cutting": self.state == CUTTING,
            "next_cut.known": has_next_cut,
            "next_cut.position": self._wrap(piece.cut_position) if has_next_cut and piece else 0.0,
            "piece.ordered": piece.ordered if piece else 0.0,
            "piece.kind": piece.kind if piece else 0,
            **{f"last.{name}": value for name, value in records.last.items()},
            "order.waiting": len(records.orders),
            "order.length_active": front.length if front else 0.0,
            "order.remaining": front.remaining if front else 0,
            "order.completed": records.completed,
            "limits.max_line_velocity": highest,
            "limits.max_line_velocity_orders": highest_orders,
            "line.velocity_request": 0.0 if failed else min(requested_velocity, (1 - margin) * highest),
            "line.stop_request": failed,
            "calibration.factor": records.calibration,
            **records.statistics.outputs(),
            "batch_count": records.batch_count,
            "batches": records.batches,
            "batch_done": records.batch_done,
            "error": bool(self.fault or self.refusal),
            "error_id": self.fault or self.refusal,
            **{f"warning.{name}": value for name, value in records.warnings.items()},
            "warning.no_length": records.is_running and not records.is_by_marks and piece is None,
            "local.coupling_factor": self.cycle.k if cycling else saw.k,
            "local.ease": self.ease,
            "local.marks_waiting": len(records.marks),
            "local.start_time": self.start_time,
            "local.home_time": self.home_time,
        }
        self.snapshots.append(
            Snapshot(
                self.time,
                self.at_step_begin,
                self.state,
                self.law,
                saw,
                self.cycle if cycling else saw,
                piece,
                records.origin,
                records.is_running,
                self.sync_position,
                (records.kerf, records.correction),
                float(self.records.inputs["mark.delay"]),
                {name: float(value) for name, value in outputs.items()},
                highest,
                highest_orders,
            )
        )

    def _solve_line_velocity(self, saw: Saw, pitch: float) -> float:
        if (saw, pitch) not in self.solved_velocities:
            self.solved_velocities[saw, pitch] = saw.max_line_velocity(pitch)
        return self.solved_velocities[saw, pitch]

    def _wrap(self, position: float) -> float:
        """The position within the master's period."""
        if self.period == 0:
            return position
        wrapped = position % self.period
        return 0.0 if isclose(wrapped, self.period, rel_tol=1e-15) else wrapped
