"""What the slave of a flying saw follows between two events: a polynomial of the time, or a planned curve."""

from collections.abc import Sequence
from dataclasses import dataclass

from tests.oracle.event_run import WINDOW
from tests.oracle.flying_saw.curves import ZERO, value
from tests.oracle.flying_saw.curves import derivative as derived
from tests.oracle.flying_saw.plan import Plan
from tests.oracle.master import Motion
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number


@dataclass(frozen=True, slots=True)
class Law:
    """Slave position: a polynomial of the time since `begin`, plus `factor` times the master's travel from `origin`."""

    begin: Number
    polynomial: Sequence[Number]
    factor: Number = ZERO
    origin: Number = ZERO

    def at(self, time: Number, master: Motion, side: int = 0) -> tuple[Number, Number, Number, Number]:
        """Position, velocity, acceleration, jerk; they do not depend on the `side` of the time."""
        x = time - self.begin
        s, v, a, j = (value(derived(self.polynomial, order), x) for order in range(4))
        k = self.factor
        return s + k * (master.position - self.origin), v + k * master.velocity, a + k * master.acceleration, j


@dataclass(frozen=True, slots=True)
class Follow:
    """A planned curve over the master's position; velocity, acceleration and jerk by the chain rule."""

    plan: Plan

    def at(self, time: Number, master: Motion, side: int = 0) -> tuple[Number, Number, Number, Number]:
        """Just before the time (`side` -1), at it, or just after it (1)."""
        nominal = self.plan.request.master.velocity
        rate, change = master.velocity / nominal, master.acceleration / nominal
        travelled = (master.position - self.plan.request.master.position) / nominal
        s, v, a, j = self.plan.curve.at(travelled, side * mp.sign(rate) * WINDOW)
        return s, v * rate, a * rate**2 + v * change, j * rate**3 + 3 * a * rate * change
