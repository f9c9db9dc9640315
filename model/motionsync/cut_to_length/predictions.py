"""What the machine can do, put out: solved again where something has changed on which it depends."""

from dataclasses import dataclass

from .. import var
from .interface import CutToLengthInterface
from .limits import Machine, cycle, max_line_velocity
from .material import Material, correction_of
from .piece import UNLIMITED
from .settings import Settings

STANDING = 1e-12  # of the greatest velocity: what rounding leaves of a line that comes to a stand


@dataclass(slots=True)
class Predictions:
    """The machine, and what its limits were solved for last.

    Attributes:
        velocity: the line's, u/s; 0 where it stands but for rounding.
        correction: the length correction, u.
        pitch: the smaller one of the piece in progress and of the next one, u of the master.
        pitch_orders: the smallest of these and of all that wait.
        shortest_pitch: what is possible at `velocity`.
    """

    machine: Machine = var.part(Machine)
    solved: bool = False
    velocity: float = 0.0
    correction: float = 0.0
    pitch: float = 0.0
    pitch_orders: float = 0.0
    shortest_pitch: float = 0.0

    def put(self, block: CutToLengthInterface, settings: Settings, material: Material) -> None:
        """Put out the limits at the line velocity of the step's end."""
        velocity = block.master.end_velocity
        if abs(velocity) * self.machine.coupling < STANDING * self.machine.max_velocity:
            velocity = 0.0
        correction = correction_of(block)
        if not self.solved or velocity != self.velocity or correction != self.correction:
            self.velocity = velocity
            self.correction = correction
            self.solve_cycle(block, settings)
        pitch = material.limiting_pitch(block, settings)
        pitch_orders = min(pitch, material.shortest_pitch(block, settings))
        if not self.solved or pitch != self.pitch or pitch_orders != self.pitch_orders:
            self.solve_line_velocity(block, pitch, pitch_orders)
        self.solved = True
        block.limits.reserve = 1.0
        if velocity > 0.0 and block.running and material.piece.pitch < UNLIMITED:
            block.limits.reserve = 1.0 - self.shortest_pitch / material.piece.pitch

    def solve_cycle(self, block: CutToLengthInterface, settings: Settings) -> None:
        """The cycle at the line velocity: what a piece and a sensor need."""
        velocity = self.velocity
        machine = self.machine
        limits = block.limits
        limits.cycle_time = 0.0
        limits.min_length = 0.0
        limits.stroke = machine.approach_distance
        distance = machine.approach_distance
        if velocity > 0.0:
            time, distance, way = cycle(machine, velocity)
            self.shortest_pitch = velocity * time
            limits.cycle_time = time
            limits.stroke = way
            limits.min_length = max(settings.factor * self.shortest_pitch - settings.kerf - self.correction, 0.0)
        block.local.approach_distance = distance
        sensor = (distance - machine.home_position) / machine.coupling + max(velocity, 0.0) * settings.mark.delay
        limits.min_sensor_distance = max(settings.factor * sensor, 0.0)

    def solve_line_velocity(self, block: CutToLengthInterface, pitch: float, pitch_orders: float) -> None:
        """The highest admissible line velocities."""
        self.pitch = pitch
        self.pitch_orders = pitch_orders
        block.limits.max_line_velocity = max_line_velocity(self.machine, pitch)
        block.limits.max_line_velocity_orders = block.limits.max_line_velocity
        if pitch_orders < pitch:
            block.limits.max_line_velocity_orders = max_line_velocity(self.machine, pitch_orders)
