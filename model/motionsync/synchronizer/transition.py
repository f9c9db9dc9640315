"""The synchronizer's transition: which way the slave takes between rest and the master, and at which occurrence.

Everything is a function of the master position alone. In mirrored coordinates x = d m, sigma = d s, d the sign of the
phasing, the master rises; sigma0 is the rest position and D the phasing's magnitude.

Source: PAM synchronizer pipe block, "Synchronization curves" (VDI 2143) and "Periodicity". The table of the source
gives the 3-4-5 law for a start only; a stop is its point mirror, so its ramp lies from sigma0 - D to sigma0 + 7/8 D.
"""

from dataclasses import dataclass
from math import sqrt

from ..grid import floor
from ..limits import clamp
from ..var import Enumeration


class Curve(Enumeration):
    """Law of the transition"""

    PARABOLA = 1, "two parabolas: least acceleration, the jerk is an impulse at both ends"
    POLYNOMIAL_3_4_5 = 2, "polynomial 3-4-5: continuous acceleration, bounded jerk"


GENTLE = 7.0 / 8.0  # of D: from the rest position to a 3-4-5 ramp's rest end; to all other ends it is D
PEAK_ACCELERATION = 64.0 / 135.0 * sqrt(3.0)  # of the 3-4-5 law, times v^2 / D
PEAK_JERK = 512.0 / 225.0  # of the 3-4-5 law, times v^3 / D^2, at the ramp's rest end


@dataclass(slots=True)
class Transition:
    """One command under way: a start (from rest to the master) or a stop (from the master to rest).

    `origin` is sigma0 as commanded, `rest`, `begin` and `end` are sigma0, x_b and x_e of the occurrence aimed at, a
    whole number of periods away. `armed`: the ramp begins as soon as x reaches x_b; `ramping`: armed, x_b <= x < x_e.

    The occurrence aimed at is the first one at or ahead of x, so with a period a waiting command is always armed and
    aims anew wherever the master goes. Without one it is armed once x has been at or below x_b.
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
    ramping: bool = False

    def command(self, starting: bool, curve: Curve, phasing: float, rest: float) -> None:
        """`phasing`: with its sign; `rest`: where the slave rests (start) or shall rest (stop)."""
        self.starting = starting
        self.curve = curve
        self.direction = 1.0 if phasing > 0.0 else -1.0
        self.phasing = abs(phasing)
        self.distance = 2.0 * self.phasing if curve == Curve.PARABOLA else (1.0 + GENTLE) * self.phasing
        self.origin = self.direction * rest
        self.armed = False
        self.ramping = False

    def travel(self, begin: float, end: float, period: float) -> bool:
        """The master moves monotonously from `begin` to `end`: whether the transition is complete there."""
        x = self.direction * end
        if not self.ramping:
            self.aim(self.direction * begin, period)
        if self.armed and x >= self.end - self.tolerance(x):
            return True
        if not (self.armed and x >= self.begin):
            self.aim(x, period)
        self.ramping = self.armed and x >= self.begin
        return False

    def aim(self, x: float, period: float) -> None:
        """Choose the occurrence for a master at x, and see whether the command is armed there."""
        steep = self.phasing
        gentle = self.distance - self.phasing
        begin = self.origin - (gentle if self.starting else steep)
        shift = 0.0
        if period > 0.0:
            shift = -floor((begin + self.tolerance(x) - x) / period) * period
        self.rest = self.origin + shift
        self.begin = begin + shift
        self.end = self.rest + (steep if self.starting else gentle)
        self.armed = self.armed or x <= self.begin + self.tolerance(x)

    def tolerance(self, x: float) -> float:
        """Within it a position counts as reached, so that commands may lie edge to edge at any period."""
        return 1e-9 * self.phasing + 1e-15 * abs(x)

    def follow(self, master: float) -> tuple[float, float, float, float]:
        """The slave's position (u) and its first three derivatives with respect to the master (1, 1/u, 1/u2).

        A start is sigma0 + 2 D f((x - x_b) / (2 Dm)), a stop sigma0 - 2 D f((x_e - x) / (2 Dm)): slope 0 at the rest
        end and 1 at the master's end; the 3-4-5 law has curvature 0 at both."""
        side = 1.0 if self.starting else -1.0
        x = self.direction * master
        way = x - self.begin if self.starting else self.end - x
        stretch = 2.0 * self.distance
        f, f1, f2, f3 = half_law(self.curve, clamp(way / stretch, 0.0, 0.5))
        height = 2.0 * self.phasing
        position = self.rest + side * height * f
        curvature = side * height * f2 / stretch / stretch
        return (
            self.direction * position,
            height * f1 / stretch,
            self.direction * curvature,
            height * f3 / stretch / stretch / stretch,
        )

    def progress(self, master: float) -> float:
        """Share of the master's travel along the ramp, 0 to 1; 0 until the command is armed."""
        return clamp((self.direction * master - self.begin) / self.distance, 0.0, 1.0) if self.armed else 0.0

    def distance_to_begin(self, master: float) -> float:
        """Master travel still missing to x_b; a command given too late, without a period, waits for the way back."""
        missing = self.begin - self.direction * master
        return max(missing, 0.0) if self.armed else abs(missing)

    def distance_to_end(self, master: float) -> float:
        """Master travel still missing to x_e, the way back to x_b included where the command is not armed yet."""
        if self.armed:
            return max(self.end - self.direction * master, 0.0)
        return self.distance_to_begin(master) + self.distance

    def peak_acceleration(self) -> float:
        """Greatest |a| / v^2 at constant master speed, 1/u."""
        return (0.5 if self.curve == Curve.PARABOLA else PEAK_ACCELERATION) / self.phasing

    def peak_jerk(self) -> float:
        """Greatest |j| / |v|^3 at constant master speed, 1/u2; 0 for the parabola, whose jerk is an impulse."""
        return 0.0 if self.curve == Curve.PARABOLA else PEAK_JERK / self.phasing / self.phasing


def half_law(curve: Curve, z: float) -> tuple[float, float, float, float]:
    """The doubled rest-to-rest law f and its first three derivatives, of which 0 <= z <= 1/2 is used: f(1/2) = 1/2."""
    if curve == Curve.PARABOLA:
        return 2.0 * z * z, 4.0 * z, 4.0, 0.0
    rest = 1.0 - z
    return (
        z * z * z * (10.0 + z * (6.0 * z - 15.0)),
        30.0 * z * z * rest * rest,
        60.0 * z * rest * (1.0 - 2.0 * z),
        60.0 + 360.0 * z * (z - 1.0),
    )
