"""The limits of the line that are put out: solved again when something on which they depend has changed."""

from dataclasses import dataclass

from .. import var
from ..cutting.material import Material
from ..cutting.piece import UNLIMITED
from ..cutting.settings import CuttingSettings
from .carriage import Carriage
from .homing_motion import FASTER
from .interface import CutToLengthInterface
from .machine_limits import CycleLimit, Machine, approach_distance, cycle

AT_REST = 1e-12  # of the greatest velocity: what rounding leaves of a line that comes to rest


@dataclass(slots=True)
class Predictions:
    """What the limits were solved for last.

    Attributes:
        is_current: the machine has not changed since.
        velocity: the line's, u/s; 0 where it is at rest but for rounding.
        correction: the length correction, u.
        pitch: the smaller one of the piece in progress and of the next one, u of the master.
        pitch_orders: the smallest of these and of all that wait.
        shortest_pitch: what is possible at `velocity`.
        limit: the search for the greatest line velocity.
    """

    is_current: bool = False
    velocity: float = 0.0
    correction: float = 0.0
    pitch: float = 0.0
    pitch_orders: float = 0.0
    shortest_pitch: float = 0.0
    limit: CycleLimit = var.part(CycleLimit)

    def update(self, block: CutToLengthInterface, machine: Machine, material: Material) -> None:
        """Put out the limits at the line velocity of the step's end."""
        velocity = block.master.end_velocity
        if abs(velocity) * machine.coupling < AT_REST * machine.max_velocity:
            velocity = 0.0
        correction = material.demand.correction()
        if not self.is_current or velocity != self.velocity or correction != self.correction:
            self.velocity = velocity
            self.correction = correction
            self.solve_cycle(block, machine, material.settings)
        pitch = material.limiting_pitch(block.running)
        pitch_orders = min(pitch, material.shortest_pitch())
        if not self.is_current or pitch != self.pitch or pitch_orders != self.pitch_orders:
            self.solve_line_velocity(block, machine, pitch, pitch_orders)
        self.is_current = True
        block.limits.reserve = 1.0
        if velocity > 0.0 and block.running and material.piece.pitch < UNLIMITED:
            block.limits.reserve = 1.0 - self.shortest_pitch / material.piece.pitch

    def solve_cycle(self, block: CutToLengthInterface, machine: Machine, settings: CuttingSettings) -> None:
        """The cycle at the line velocity: what a piece and a sensor need."""
        velocity = self.velocity
        limits = block.limits
        limits.cycle_time = 0.0
        limits.min_length = 0.0
        limits.stroke = machine.approach_distance
        distance = machine.approach_distance
        if velocity > 0.0:
            time, distance, stroke = cycle(machine, velocity)
            self.shortest_pitch = velocity * time
            limits.cycle_time = time
            limits.stroke = stroke
            limits.min_length = max(settings.factor * self.shortest_pitch - settings.piece.kerf - self.correction, 0.0)
        block.local.approach_distance = distance
        sensor = (distance - machine.home_position) / machine.coupling + max(velocity, 0.0) * settings.mark.delay
        limits.min_sensor_distance = max(settings.factor * sensor, 0.0)

    def solve_line_velocity(
        self, block: CutToLengthInterface, machine: Machine, pitch: float, pitch_orders: float
    ) -> None:
        """The highest admissible line velocities."""
        self.pitch = pitch
        self.pitch_orders = pitch_orders
        self.limit.solve(machine, pitch)
        block.limits.max_line_velocity = self.limit.max_line_velocity
        if pitch_orders < pitch:
            self.limit.solve(machine, pitch_orders)
        block.limits.max_line_velocity_orders = self.limit.max_line_velocity

    def is_far_from_start(self, block: CutToLengthInterface, carriage: Carriage, cut: float) -> bool:
        """Whether no start can be due on what is left of the section: then no search for one is needed.

        The approach to the cut is no longer than predicted on a line no faster than then, and else than that of a
        faster line."""
        master = block.master
        machine = carriage.machine
        begin = master.begin_velocity
        end = master.end_velocity
        fastest = max(begin, end)
        distance = block.local.approach_distance
        if not self.is_current or fastest > self.velocity:
            distance = approach_distance(machine, fastest + FASTER * (abs(begin) + abs(end)))
        beyond_cut = max(master.distance_beyond(cut, master.path.now), master.distance_beyond(cut, master.path.until))
        return machine.coupling * beyond_cut < carriage.homing.end - distance
