"""A rotary knife between two events: where on its path it is, and what it shows from then on.

The path is a list of sections over the master, each valid from its `begin` to that of the next one. However far the
line runs back, the knife is where the sections have it: it depends on the master's place alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from tests.oracle.cutting.machine import PieceMachine
from tests.oracle.cutting.records import Piece
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.rotary_knife.curves import NO_EXTREMES, ZERO, Cut, Derivatives, Extremes, Quintic, Rest, Window
from tests.oracle.rotary_knife.limits import Knife, cycle_velocity, ramp_velocity
from tests.oracle.rotary_knife.line import ExactSection
from tests.oracle.rotary_knife.records import KnifeRecords
from tests.oracle.timed_motion import TimedMotion

FAULT, OFF, PARKING, WAITING, ENGAGING, SYNCHRONOUS, TURNING, DISENGAGING = range(-1, 7)
ON_A_CURVE = (ENGAGING, TURNING, DISENGAGING)
OUT_OF_REST = (OFF, WAITING, ENGAGING)
"""The states in which the ramp up counts among the limits."""

Curve: TypeAlias = Rest | Cut | Quintic


@dataclass(frozen=True, slots=True)
class PathSection:
    begin: Number
    state: int
    curve: Curve


@dataclass(frozen=True)
class Snapshot:
    """What holds from `time` on.

    `at_step_begin`: because of something that is noticed at a step's beginning; the step's end shows it first.
    `window`: as it is set; `sync_place`: where the next window begins, if a cut is known; `extremes`: of the cycle;
    `material`: f, b and Δ of the piece, or as they are set; `allowance`: b + Δ as they are set.
    """

    time: float
    at_step_begin: bool
    state: int
    law: Curve | TimedMotion
    window: Window
    piece: Piece | None
    sync_place: Number | None
    origin: Number
    is_running: bool
    extremes: Extremes
    f: float
    material: tuple[float, float, float]
    allowance: float
    mark_delay: float
    outputs: Mapping[str, float]
    max_velocity: float
    max_velocity_orders: float


class KnifeState(PieceMachine):
    """All that is known of a knife at one instant, and the snapshots up to it.

    `cut`: the latest one on the path, not yet made or made; `last_position`: the slave's, where a blade cut last.
    """

    records: KnifeRecords
    section: ExactSection

    def __init__(self, inputs: dict[str, Any], section: ExactSection, steps: Sequence[float], period: float) -> None:
        self.knife = Knife.of(inputs)
        super().__init__(inputs, KnifeRecords(inputs, self.knife), section, steps, period)
        self.state = OFF
        self.last_position = ZERO
        self.path: list[PathSection] = []
        self.index = 0
        self.rest_at(self.knife.park_angle, OFF)
        self.timed: TimedMotion | None = None
        self.cut: Cut | None = None
        self.is_cut_made = True
        self.last_window: Window | None = None
        self.extremes: Extremes = NO_EXTREMES
        self.last_cut_time: float | None = None
        self.rest_begin, self.rest_time = 0.0, 0.0
        self.has_no_earlier_cut = False
        self.snapshots: list[Snapshot] = []

    def rest_at(self, position: Number, state: int) -> None:
        """At rest from now on, wherever the master is."""
        self.path, self.index, self.state = [PathSection(-mp.inf, state, Rest(position))], 0, state

    def master(self, time: float | None = None) -> Motion:
        """The master now, or at another time in its present section."""
        return self.section.at(self.time if time is None else time)

    def derivatives(self) -> Derivatives:
        """The knife now, over the master."""
        return self.path[self.index].curve.at(self.master().position)

    def next_cut(self, place: Number, window: Window) -> Cut:
        """The cut of the next blade, with the master at `place`."""
        return Cut(window, mp.mpf(place), self.last_position + self.knife.spacing)

    # --- what is shown --------------------------------------------------------------------------------------------

    def add_snapshot(self) -> None:
        records, window = self.records, self.records.window_as_set()
        piece = records.piece
        highest, highest_orders = (float(v) for v in self._highest_velocities(window))
        is_in_window = self.state == SYNCHRONOUS
        outputs = self.outputs(highest, failed=self.state == FAULT) | {
            "in_sync": is_in_window,
            "knife.in_window": is_in_window,
            "limits.max_line_velocity": highest,
            "limits.max_line_velocity_orders": highest_orders,
        }
        outputs["warning.change_pending"] = outputs["warning.change_pending"] or self.has_no_earlier_cut
        sync_place = None
        if records.is_running and piece is not None:
            sync_place = mp.mpf(piece.cut_position) - records.window.before
            if is_in_window and not self.is_cut_made and self.index == len(self.path) - 1:
                sync_place = mp.inf
        material = (records.f, records.kerf, records.correction)
        self.snapshots.append(
            Snapshot(
                self.time,
                self.at_step_begin,
                self.state,
                self.timed or self.path[self.index].curve,
                window,
                piece,
                sync_place,
                records.origin,
                records.is_running,
                self.extremes,
                records.f,
                (piece.f, piece.kerf, piece.correction) if piece else material,
                records.kerf + records.correction,
                float(records.inputs["mark.delay"]),
                {name: float(value) for name, value in outputs.items()},
                highest,
                highest_orders,
            )
        )

    def _highest_velocities(self, window: Window) -> tuple[Number, Number]:
        """The line's, for the piece in progress and the one expected after it; and for all that waits, too."""
        records, knife = self.records, self.knife
        present, following, waiting = records.pitches()
        entering = records.window if records.piece else window
        velocities = [cycle_velocity(knife, entering, window, following)]
        if records.piece:
            velocities.append(cycle_velocity(knife, self.last_window or window, entering, present))
        if self.state in OUT_OF_REST:
            velocities.append(ramp_velocity(knife, entering))
        highest = min(velocities)
        return highest, min([highest, *(cycle_velocity(knife, window, window, pitch) for pitch in waiting)])
