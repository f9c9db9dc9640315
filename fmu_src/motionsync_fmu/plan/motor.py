"""What the slave's motor has to give, from a run of the block through one cycle.

The slave follows its setpoint exactly here. After its cycle it rests until the line has moved by a pitch since the
cycle began."""

import numpy as np

from ..scenario.evaluate.axis_figures import force_unit, integral, share
from ..scenario.load import Load
from .machine import Machine
from .prediction import MotorUse

STEPS = 400  # of the run of a cycle
BELOW = 1e-9  # relative: an admissible velocity, rounded or not


def predict_motor_use(machine: Machine, load: Load, length: float, velocity: float) -> MotorUse:
    """What the motor has to give for pieces of this length, in u of true material, at an admissible line velocity."""
    run = machine.simulate_cycle(length, velocity * (1.0 - BELOW), STEPS)
    force = load.force(run[:, 2], run[:, 3])
    rms = float(np.sqrt(integral(run[:, 0], force * force) / (machine.pitch(length) / velocity)))
    peak = float(np.abs(force).max())
    return MotorUse(rms, peak, share(rms, load.continuous_force), share(peak, load.peak_force), force_unit(load))
