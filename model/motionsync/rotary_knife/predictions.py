"""The limits of the line that are put out: solved again when something on which they depend has changed."""

from dataclasses import dataclass

from .. import var
from ..cutting.interface import Source
from ..cutting.material import Material, limiting_distance
from ..cutting.piece import UNLIMITED
from .interface import RotaryKnifeInterface
from .knife import Knife
from .limits import NO_LENGTH, CycleLimit, LengthLimits
from .window import Window

AT_REST = 1e-12  # of the greatest velocity: what rounding leaves of a line that comes to rest


@dataclass(slots=True)
class Predictions:
    """What the limits were solved for last.

    Attributes:
        are_lengths_current, is_cycle_current, are_queues_current: nothing that the limits of lengths, those of the
            piece in progress, or those of all that waits depend on has changed since.
        window: as it is set at present.
        lengths: the pitches that are possible with this window.
        ramp_up: out of rest into this window.
        velocity: of the line, u/s, for which the shortest pitch was solved; 0: for none.
        pitch, expected_pitch: of the piece in progress and of the next one, u of the master; 0: none is in progress.
        pitch_orders: the smallest of these and of all that wait.
        counts_ramp_up: the next cut is reached out of rest.
        queue_first, queue_waiting, allowance: the queue that was solved, and kerf and correction of its pieces, u.
        queue_velocity: the greatest line velocity for all that waits, u/s.
    """

    are_lengths_current: bool = False
    is_cycle_current: bool = False
    are_queues_current: bool = False
    window: Window = var.part(Window)
    lengths: LengthLimits = var.part(LengthLimits)
    ramp_up: CycleLimit = var.part(CycleLimit)
    cycle: CycleLimit = var.part(CycleLimit)
    velocity: float = 0.0
    pitch: float = 0.0
    expected_pitch: float = 0.0
    pitch_orders: float = 0.0
    counts_ramp_up: bool = False
    queue_first: int = 0
    queue_waiting: int = 0
    allowance: float = 0.0
    queue_velocity: float = 0.0

    def describe(self, knife: Knife) -> None:
        """The window has been set anew."""
        self.lengths.prepare(knife, self.window)
        self.ramp_up.solve_ramp_up(knife, self.window)
        self.are_lengths_current = False
        self.is_cycle_current = False
        self.are_queues_current = False

    def update(
        self,
        block: RotaryKnifeInterface,
        knife: Knife,
        material: Material,
        leaving: Window,
        entering: Window,
        counts_ramp_up: bool,
    ) -> None:
        """Put out the limits at the line velocity of the step's end.

        The piece in progress is from a cut in the window `leaving` to one in `entering`."""
        velocity = block.master.end_velocity
        if abs(velocity) * self.window.slope < AT_REST * knife.max_velocity:
            velocity = 0.0
        self.update_lengths(block, knife, material, velocity)
        pitch = material.piece.pitch if block.running and material.piece.is_fixed else 0.0
        expected = material.expected_pitch(block.running)
        if not self.is_cycle_current or (
            pitch != self.pitch or expected != self.expected_pitch or counts_ramp_up != self.counts_ramp_up
        ):
            self.is_cycle_current = True
            self.pitch = pitch
            self.expected_pitch = expected
            self.counts_ramp_up = counts_ramp_up
            block.limits.max_line_velocity = self.cycle_velocity(knife, leaving, entering)
        self.update_queues(knife, material)
        self.pitch_orders = min(expected, material.shortest_pitch())
        if pitch > 0.0:
            self.pitch_orders = min(self.pitch_orders, pitch)
        block.limits.max_line_velocity_orders = min(block.limits.max_line_velocity, self.queue_velocity)
        block.limits.reserve = 1.0
        if velocity > 0.0 and pitch > 0.0 and pitch < UNLIMITED:
            block.limits.reserve = 1.0 - self.lengths.shortest / pitch

    def update_lengths(self, block: RotaryKnifeInterface, knife: Knife, material: Material, velocity: float) -> None:
        """What a piece and a sensor need at a line velocity, u/s."""
        limits = block.limits
        if not self.are_lengths_current or velocity != self.velocity:
            self.velocity = velocity
            if velocity > 0.0:
                self.lengths.solve_shortest(knife, self.window, velocity)
        self.are_lengths_current = True
        factor = material.settings.factor
        allowance = material.settings.piece.kerf + material.demand.correction()
        limits.max_length = factor * self.lengths.longest - allowance
        limits.cycle_time = 0.0
        limits.min_length = 0.0
        if velocity > 0.0:
            limits.cycle_time = self.lengths.shortest / velocity
            limits.min_length = NO_LENGTH
            if self.lengths.shortest < NO_LENGTH:
                limits.min_length = max(factor * self.lengths.shortest - allowance, 0.0)
        delayed = max(block.master.end_velocity, 0.0) * material.settings.mark.delay
        limits.min_sensor_distance = factor * (delayed - self.ramp_up.way.ramp_up.begin)

    def cycle_velocity(self, knife: Knife, leaving: Window, entering: Window) -> float:
        """The highest admissible line velocity for the piece in progress and the next one."""
        self.cycle.solve_piece(knife, entering, self.window, self.expected_pitch)
        fastest = self.cycle.max_line_velocity
        if self.pitch > 0.0:
            self.cycle.solve_piece(knife, leaving, entering, self.pitch)
            fastest = min(fastest, self.cycle.max_line_velocity)
        if self.counts_ramp_up:
            self.cycle.solve_ramp_up(knife, entering)
            fastest = min(fastest, self.cycle.max_line_velocity)
        return fastest

    def update_queues(self, knife: Knife, material: Material) -> None:
        """The highest admissible line velocity for all orders, or for all marks."""
        by_marks = material.demand.source == Source.MARK
        first = material.marks.first if by_marks else material.orders.first
        waiting = material.marks.waiting if by_marks else material.orders.waiting
        allowance = material.settings.piece.kerf + material.demand.length_correction
        if (
            self.are_queues_current
            and first == self.queue_first
            and waiting == self.queue_waiting
            and allowance == self.allowance
        ):
            return
        self.are_queues_current = True
        self.queue_first = first
        self.queue_waiting = waiting
        self.allowance = allowance
        self.queue_velocity = UNLIMITED
        for index in range(waiting):
            pitch = UNLIMITED
            if not by_marks:
                pitch = material.pitch_of(material.orders.length(index))
            elif index > 0:
                pitch = limiting_distance(material.marks.position(index) - material.marks.position(index - 1))
            if index > 0 or not by_marks:
                self.cycle.solve_piece(knife, self.window, self.window, pitch)
                self.queue_velocity = min(self.queue_velocity, self.cycle.max_line_velocity)
