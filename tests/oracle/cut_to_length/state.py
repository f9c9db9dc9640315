"""A cut-to-length machine between two events: where its cycle is, and what it shows from then on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from tests.oracle.cut_to_length.carriage import MasterSection, MotionLaw
from tests.oracle.cut_to_length.limits import Saw
from tests.oracle.cut_to_length.records import SawRecords
from tests.oracle.cutting.machine import COMMANDS, PieceMachine
from tests.oracle.cutting.records import Piece
from tests.oracle.timed_motion import AxisState, Motion, Rest, TimedMotion

FAULT, OFF, HOMING, WAITING, APPROACHING, SYNCHRONOUS, CUTTING, PULLING, CLEARING, RETURNING = range(-1, 9)
IN_SYNC = (SYNCHRONOUS, CUTTING, PULLING, CLEARING)
SAW_COMMANDS = (*COMMANDS, "tool.done")


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


class MachineState(PieceMachine):
    """All that is known of a machine at one instant, and the snapshots up to it.

    `cycle`: the machine as it was set when the cycle under way began; `cut_position`: of the cycle's cut.
    """

    commands = SAW_COMMANDS
    records: SawRecords
    section: MasterSection

    def __init__(
        self,
        inputs: dict[str, Any],
        section: MasterSection,
        steps: Sequence[float],
        period: float,
        initial_position: float,
    ) -> None:
        super().__init__(inputs, SawRecords(inputs), section, steps, period)
        self.state = OFF
        self.law: MotionLaw = Rest(initial_position)
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
        self.solved_velocities: dict[Any, float] = {}
        self.snapshots: list[Snapshot] = []

    def master(self, time: float | None = None) -> Motion:
        """The master now, or at another time in its present section."""
        return self.section.at(self.time if time is None else time)

    def carriage(self, time: float | None = None) -> AxisState:
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
        present, following, waiting = records.pitches()
        pitch = min(present, following)
        pitch_of_orders = min([pitch, *waiting])
        highest, highest_orders = self._solve_line_velocity(saw, pitch), self._solve_line_velocity(saw, pitch_of_orders)
        cycling = self.state in (APPROACHING, *IN_SYNC)
        outputs = self.outputs(highest, failed=self.state == FAULT) | {
            "in_sync": self.state in (SYNCHRONOUS, CUTTING) or (self.state == CLEARING and not self.has_gap),
            "tool.command": self.command,
            "tool.command_time": self.command_time,
            "tool.blade_down": self.is_blade_down,
            "tool.cutting": self.state == CUTTING,
            "limits.max_line_velocity": highest,
            "limits.max_line_velocity_orders": highest_orders,
            "local.coupling_factor": self.cycle.k if cycling else saw.k,
            "local.ease": self.ease,
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
                records.piece,
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
