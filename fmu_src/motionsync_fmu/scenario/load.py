"""The load of a scenario: what the slave's axis moves, and what its motor can give."""

from dataclasses import dataclass

import numpy as np

from ..interface.units import BASES
from .recording import Reals

STANDSTILL = 1e-6  # m/s or rad/s: an axis that needs more than a second for a micrometre is at rest: no friction


@dataclass(frozen=True)
class Load:
    """What an axis moves. Forces are in N, or torques in N m where the axis turns.

    Attributes:
        mass: in kg, or an inertia in kg m2.
        friction: the Coulomb friction.
        unit: the unit of the axis's positions, a key of BASES.
        peak_force: what the motor can give for moments; None: not known.
        continuous_force: what the motor can give for ever, as the root of the mean square; None: not known.
    """

    mass: float
    friction: float
    unit: str
    peak_force: float | None = None
    continuous_force: float | None = None

    @property
    def turns(self) -> bool:
        """Whether the axis turns: its load is an inertia, and its forces are torques."""
        return BASES[self.unit][0] == "rad"

    def force(self, velocity: Reals, acceleration: Reals) -> Reals:
        """The motor's force for a motion, in u/s and u/s2."""
        size = BASES[self.unit][1]
        direction = np.where(np.abs(velocity) * size < STANDSTILL, 0.0, np.sign(velocity))
        return np.asarray(self.mass * size * acceleration + self.friction * direction)

    def power(self, force: Reals, velocity: Reals) -> Reals:
        """The motor's power in W, for a force and a velocity in u/s: negative where it brakes."""
        return np.asarray(force * (BASES[self.unit][1] * velocity))
