"""The transition of a Synchronizer: the curve between rest and the master, and the turn of the master that it belongs
to.

Everything is a function of the master's position m alone. With the sign d of the phasing, the mirrored positions of
master and slave are x = d m and sigma = d s, so that the master always rises. sigma0 is the mirrored rest position and
D the magnitude of the phasing.

Source: PAM synchronizer pipe block, "Synchronization curves" (VDI 2143) and "Periodicity". The table of the source
gives the 3-4-5 law for a start only; a stop is its point mirror, so its ramp goes from sigma0 - D to sigma0 + 7/8 D.
"""

from dataclasses import dataclass

from ..motion.laws import (
    PARABOLA_PEAK_ACCELERATION,
    PARABOLA_TRAVEL,
    POLYNOMIAL_3_4_5_PEAK_ACCELERATION,
    POLYNOMIAL_3_4_5_PEAK_JERK,
    POLYNOMIAL_3_4_5_TRAVEL,
    parabola,
    polynomial_3_4_5,
)
from ..numerics.computable_range import clamp
from ..numerics.grid import first_on_grid_from
from .interface import Curve


@dataclass(slots=True)
class PhasingTransition:
    """One command under way: a start (from rest to the master) or a stop (from the master to rest).

    `origin` is sigma0 as commanded. `rest`, `begin` and `end` are sigma0, x_b and x_e of the occurrence aimed at, a
    whole number of periods away from the commanded one. `armed`: the ramp starts as soon as x reaches x_b.

    The occurrence aimed at is the first one at or ahead of x. With a period a waiting command is therefore always armed
    and aims anew wherever the master goes. Without a period it is armed once x has been at or below x_b.
    """

    curve: Curve = Curve.POLYNOMIAL_3_4_5
    starting: bool = False
    direction: float = 1.0
    phasing: float = 1.0
    distance: float = 0.0
    origin: float = 0.0
    rest: float = 0.0
    begin: float = 0.0
    end: float = 0.0
    armed: bool = False

    def command(self, starting: bool, curve: Curve, phasing: float, rest: float) -> None:
        """`phasing`: with its sign; `rest`: where the slave rests (start) or shall rest (stop)."""
        self.starting = starting
        self.curve = curve
        self.direction = 1.0 if phasing > 0.0 else -1.0
        self.phasing = abs(phasing)
        self.distance = (PARABOLA_TRAVEL if curve == Curve.PARABOLA else POLYNOMIAL_3_4_5_TRAVEL) * self.phasing
        self.origin = self.direction * rest
        self.armed = False

    def commanded_rest(self) -> float:
        """Where the slave rests as commanded, u."""
        return self.direction * self.origin

    def aim(self, master: float, period: float) -> None:
        """Choose the occurrence for a master at this position, and arm the command if it is in time there."""
        x = self.direction * master
        steep = self.phasing
        gentle = self.distance - self.phasing
        begin = self.origin - (gentle if self.starting else steep)
        shift = first_on_grid_from(0.0, period, x - (begin + self.tolerance(x)))
        self.rest = self.origin + shift
        self.begin = begin + shift
        self.end = self.rest + (steep if self.starting else gentle)
        self.armed = self.armed or x <= self.begin + self.tolerance(x)

    def tolerance(self, x: float) -> float:
        """Within it a position counts as reached, so that commands may be edge to edge at any period."""
        return 1e-9 * self.phasing + 1e-15 * abs(x)

    def is_complete_at(self, master: float) -> bool:
        """Whether a master that has risen to this position has passed the end of the ramp."""
        x = self.direction * master
        return self.armed and x >= self.end - self.tolerance(x)

    def is_on_ramp_at(self, master: float, uncertain: float) -> bool:
        """Whether a master that has not reached the end of the ramp is at its beginning or farther on, or before it by
        what is uncertain of its travel, u."""
        return self.armed and self.direction * master >= self.begin - uncertain

    def follow(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position (u) and its first three derivatives by the master's position (1, 1/u, 1/u2).

        A start is sigma0 + 2 D f((x - x_b) / (2 Dm)), Dm being the ramp's `distance`; a stop is the point mirror
        sigma0 - 2 D f((x_e - x) / (2 Dm)). The first derivative is 0 at the rest end and 1 at the master's end; the
        second derivative of the 3-4-5 law is 0 at both."""
        side = 1.0 if self.starting else -1.0
        x = self.direction * master
        travel = x - self.begin if self.starting else self.end - x
        stretch = 2.0 * self.distance
        f, f1, f2, f3 = half_law(self.curve, clamp(travel / stretch, 0.0, 0.5))
        height = 2.0 * self.phasing
        position = self.rest + side * height * f
        d2 = side * height * f2 / stretch / stretch
        return (
            self.direction * position,
            height * f1 / stretch,
            self.direction * d2,
            height * f3 / stretch / stretch / stretch,
        )

    def progress(self, master: float) -> float:
        """Share of the ramp's distance that the master has travelled, 0 to 1; 0 until the command is armed."""
        return clamp((self.direction * master - self.begin) / self.distance, 0.0, 1.0) if self.armed else 0.0

    def distance_to_begin(self, master: float) -> float:
        """Master travel still missing to x_b, u; for a command that came too late, without period, the travel back."""
        missing = self.begin - self.direction * master
        return max(missing, 0.0) if self.armed else abs(missing)

    def distance_to_end(self, master: float) -> float:
        """Master travel still missing to x_e, u; until the command is armed, the travel back to x_b is part of it."""
        if self.armed:
            return max(self.end - self.direction * master, 0.0)
        return self.distance_to_begin(master) + self.distance

    def peak_acceleration(self) -> float:
        """Greatest |a| / v^2 at constant master speed, 1/u."""
        if self.curve == Curve.PARABOLA:
            return PARABOLA_PEAK_ACCELERATION / self.phasing
        return POLYNOMIAL_3_4_5_PEAK_ACCELERATION / self.phasing

    def peak_jerk(self) -> float:
        """Greatest |j| / |v|^3 at constant master speed, 1/u2; 0 for the parabola, whose jerk is an impulse."""
        return 0.0 if self.curve == Curve.PARABOLA else POLYNOMIAL_3_4_5_PEAK_JERK / self.phasing / self.phasing


def half_law(curve: Curve, z: float) -> tuple[float, float, float, float]:
    """First half, 0 <= z <= 1/2, of the chosen law: the ramp is this half, doubled in height and stretched by two."""
    if curve == Curve.PARABOLA:
        return parabola(z)
    return polynomial_3_4_5(z)
