"""What the carriage's motor has to give, from a run of the block through one cycle.

The carriage follows its setpoint exactly here. After its way home it rests until the line has moved by a pitch since
the cycle began."""

from dataclasses import dataclass

import numpy as np

from ..scenario.evaluate.axis_figures import force_unit, integral, share
from ..scenario.load import Load
from .machine_data import MachineData
from .simulation import simulate_cycle

STEPS = 1000  # of the run of a cycle
BELOW = 1e-9  # relative: an admissible velocity, rounded or not


@dataclass(frozen=True)
class MotorUse:
    """Forces in N, or torques in N m where the carriage turns.

    Attributes:
        rms: the root of the mean square over a cycle and the rest at home.
        peak: the greatest magnitude.
        rms_share, peak_share: of what the motor can give; None: this is not known.
        unit: the unit of forces.
    """

    rms: float
    peak: float
    rms_share: float | None
    peak_share: float | None
    unit: str


def predict_motor_use(data: MachineData, load: Load, length: float, velocity: float) -> MotorUse:
    """What the motor has to give for pieces of this length, in u of true material, at an admissible line velocity."""
    run = simulate_cycle(data, velocity * (1.0 - BELOW), STEPS)
    force = load.force(run[:, 2], run[:, 3])
    rms = float(np.sqrt(integral(run[:, 0], force * force) / (data.pitch(length) / velocity)))
    peak = float(np.abs(force).max())
    return MotorUse(rms, peak, share(rms, load.continuous_force), share(peak, load.peak_force), force_unit(load))
