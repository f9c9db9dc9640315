"""The greatest and least values of a synchronisation profile at constant master velocity, exact: nothing is sampled.

An extremum lies at an end of a piece or where the derivative is 0 inside it; integrals are in closed form. Source:
TS5055, "Characteristic values"; momentum, mean and effective value are those that TwinCAT reserves but never computes.
"""

from dataclasses import dataclass
from math import inf, sqrt

from .. import var
from ..polynomial import ROUNDING, Polynomial
from .profile import ORDER, Profile

EQUAL = 1e-12  # of the greatest magnitude: values that differ by less are equal, and the first one counts
END = 0  # kind of a place: an end of a piece; n > 0: a root of the position's n-th derivative inside it


@dataclass(slots=True)
class Extremes:
    """The extreme values of a profile, each with the nominal time (s) at which it occurs first in travel order.

    Positions (u) are absolute, velocities in u/s, accelerations in u/s2, jerks in u/s3. At the joint of two pieces the
    acceleration and the jerk of both sides count.

    Attributes:
        acceleration_peak, deceleration_peak: greatest |a| where v a > 0 and where v a < 0; 0 where that is nowhere.
        momentum_min, momentum_max: of v a, u2/s3.
        velocity_mean: of |v| over time.
        acceleration_effective: root mean square over time.
        places: of the `rows` places at which something may be extreme, in travel order: u within the piece; with them
            what they are, their times and the position and its derivatives there.
    """

    position_min: float = 0.0
    position_min_time: float = 0.0
    position_max: float = 0.0
    position_max_time: float = 0.0
    velocity_min: float = 0.0
    velocity_min_time: float = 0.0
    velocity_max: float = 0.0
    velocity_max_time: float = 0.0
    acceleration_min: float = 0.0
    acceleration_min_time: float = 0.0
    acceleration_max: float = 0.0
    acceleration_max_time: float = 0.0
    velocity_at_acceleration_min: float = 0.0
    velocity_at_acceleration_max: float = 0.0
    jerk_min: float = 0.0
    jerk_max: float = 0.0
    acceleration_peak: float = 0.0
    deceleration_peak: float = 0.0
    momentum_min: float = 0.0
    momentum_max: float = 0.0
    velocity_mean: float = 0.0
    acceleration_effective: float = 0.0
    polynomial: Polynomial = var.part(Polynomial)
    rows: int = 0
    places: list[float] = var.ring(48)
    kinds: list[float] = var.ring(48)
    times: list[float] = var.ring(48)
    positions: list[float] = var.ring(48)
    velocities: list[float] = var.ring(48)
    accelerations: list[float] = var.ring(48)
    jerks: list[float] = var.ring(48)

    def measure(self, profile: Profile) -> None:
        """All but the last four, of a profile with at least one piece."""
        self.rows = 0
        self.acceleration_peak = 0.0
        self.deceleration_peak = 0.0
        for i in range(profile.pieces):
            self.visit(profile, i)
        low, first = self.extreme(self.positions, 1, -1.0)
        high, last = self.extreme(self.positions, 1, 1.0)
        self.position_min = low
        self.position_min_time = self.times[first]
        self.position_max = high
        self.position_max_time = self.times[last]
        low, first = self.extreme(self.velocities, 2, -1.0)
        high, last = self.extreme(self.velocities, 2, 1.0)
        self.velocity_min = low
        self.velocity_min_time = self.times[first]
        self.velocity_max = high
        self.velocity_max_time = self.times[last]
        low, first = self.extreme(self.accelerations, 3, -1.0)
        high, last = self.extreme(self.accelerations, 3, 1.0)
        self.acceleration_min = low
        self.acceleration_min_time = self.times[first]
        self.velocity_at_acceleration_min = self.velocities[first]
        self.acceleration_max = high
        self.acceleration_max_time = self.times[last]
        self.velocity_at_acceleration_max = self.velocities[last]
        low, first = self.extreme(self.jerks, 4, -1.0)
        high, last = self.extreme(self.jerks, 4, 1.0)
        self.jerk_min = low
        self.jerk_max = high

    def visit(self, profile: Profile, i: int) -> None:
        """One piece: its places, the values there, and the greatest acceleration and deceleration between them."""
        d = profile.durations[i]
        begin = self.rows
        self.insert(begin, 0.0, END)
        self.insert(begin, 1.0, END)
        f = self.polynomial
        take(f, profile, i)
        small_velocity = 0.0
        small_acceleration = 0.0
        for derivative in range(1, 5):
            f.differentiate()
            if derivative == 1:
                small_velocity = ROUNDING * f.size() / d
            elif derivative == 2:
                small_acceleration = ROUNDING * f.size() / d / d
            f.solve()
            for n in range(f.count):
                self.insert(begin, f.roots[n], derivative)
        for row in range(begin, self.rows):
            position, velocity, acceleration, jerk = profile.within(i, self.places[row])
            self.times[row] = profile.begins[i] + self.places[row] * d
            self.positions[row] = position
            self.velocities[row] = velocity
            self.accelerations[row] = acceleration
            self.jerks[row] = jerk
            if row > begin:
                self.judge(row, small_velocity, small_acceleration)

    def insert(self, begin: int, place: float, kind: int) -> None:
        """One more place, at its rank among those of the piece, which begin at row `begin`."""
        row = self.rows
        while row > begin and self.places[row - 1] > place:
            self.places[row] = self.places[row - 1]
            self.kinds[row] = self.kinds[row - 1]
            row -= 1
        self.places[row] = place
        self.kinds[row] = float(kind)
        self.rows += 1

    def judge(self, row: int, small_velocity: float, small_acceleration: float) -> None:
        """From the place before this one to it v and a are monotone and keep their signs: both are greatest at one of
        the two, and there it is an acceleration or a deceleration. Where v or a is 0 but for rounding it is neither."""
        velocity = greater(self.velocities[row - 1], self.velocities[row])
        acceleration = greater(self.accelerations[row - 1], self.accelerations[row])
        if abs(velocity) > small_velocity and abs(acceleration) > small_acceleration:
            if (velocity > 0.0) == (acceleration > 0.0):
                self.acceleration_peak = max(self.acceleration_peak, abs(acceleration))
            else:
                self.deceleration_peak = max(self.deceleration_peak, abs(acceleration))

    def extreme(self, values: list[float], kind: int, sign: float) -> tuple[float, int]:
        """The greatest (sign 1) or least (-1) value at the places of that kind and at the ends; the first row at which
        it is reached."""
        best = -inf
        size = 0.0
        for row in range(self.rows):
            if self.kinds[row] in (END, kind):
                best = max(best, sign * values[row])
                size = max(size, abs(values[row]))
        for row in range(self.rows):
            if self.kinds[row] in (END, kind) and sign * values[row] >= best - EQUAL * size:
                return sign * best, row
        return sign * best, 0

    def integrate(self, profile: Profile) -> None:
        """The last four, of a profile with at least one piece."""
        self.momentum_min = inf
        self.momentum_max = -inf
        way = 0.0
        power = 0.0
        for i in range(profile.pieces):
            self.weigh(profile, i)
            way += self.travel(profile, i)
            power += square(profile, i)
        self.velocity_mean = way / profile.duration()
        self.acceleration_effective = sqrt(power / profile.duration())

    def weigh(self, profile: Profile, i: int) -> None:
        """The extremes of v a: at the ends and where a^2 + v j, of degree 6 at most, is 0. With v = sum v_n u^n and
        a = sum a_n u^n that derivative has the coefficients (n + 1) sum over k of v_k a_(n + 1 - k)."""
        f = self.polynomial
        f.degree = 6
        for n in range(7):
            f.coefficients[n] = 0.0
        for k in range(ORDER - 1):
            velocity = (k + 1.0) * profile.coefficients[ORDER * i + k + 1]
            for m in range(ORDER - 2):
                acceleration = (m + 1.0) * (m + 2.0) * profile.coefficients[ORDER * i + m + 2]
                if k + m > 0:
                    f.coefficients[k + m - 1] += (k + m) * velocity * acceleration
        f.solve()
        for n in range(-1, f.count + 1):
            place = 0.0 if n < 0 else f.roots[n] if n < f.count else 1.0
            _, velocity, acceleration, _ = profile.within(i, place)
            self.momentum_min = min(self.momentum_min, velocity * acceleration)
            self.momentum_max = max(self.momentum_max, velocity * acceleration)

    def travel(self, profile: Profile, i: int) -> float:
        """The integral of |v| over a piece: the ways between the turning points, all taken as positive."""
        f = self.polynomial
        take(f, profile, i)
        f.differentiate()
        f.solve()
        total = 0.0
        before = 0.0
        for n in range(f.count + 1):
            after = profile.passed(i, f.roots[n] if n < f.count else 1.0)
            total += abs(after - before)
            before = after
        return total


def take(f: Polynomial, profile: Profile, i: int) -> None:
    """The position in a piece as a polynomial."""
    f.degree = ORDER - 1
    for n in range(ORDER):
        f.coefficients[n] = profile.coefficients[ORDER * i + n]


def square(profile: Profile, i: int) -> float:
    """The integral of a^2 over a piece, d sum of l_n^2 / (2 n + 1), n = 0 to 3: l_n are the coefficients of a in
    Legendre's polynomials over the piece, which are orthogonal. A sum of squares, so it does not cancel."""
    d = profile.durations[i]
    at = ORDER * i
    a0 = 2.0 * profile.coefficients[at + 2]
    a1 = 6.0 * profile.coefficients[at + 3]
    a2 = 12.0 * profile.coefficients[at + 4]
    a3 = 20.0 * profile.coefficients[at + 5]
    l0 = (a0 + a1 / 2.0 + a2 / 3.0 + a3 / 4.0) / d / d
    l1 = (a1 / 2.0 + a2 / 2.0 + 9.0 / 20.0 * a3) / d / d
    l2 = (a2 / 6.0 + a3 / 4.0) / d / d
    l3 = a3 / 20.0 / d / d
    return d * (l0 * l0 + l1 * l1 / 3.0 + l2 * l2 / 5.0 + l3 * l3 / 7.0)


def greater(a: float, b: float) -> float:
    """The one of greater magnitude."""
    return a if abs(a) >= abs(b) else b
