"""The greatest and least values of a synchronisation profile at constant master velocity, exact: nothing is sampled.

An extremum is at an end of a segment, or inside it where the derivative is 0; integrals are in closed form.
Source: TS5055, "Characteristic values". TwinCAT reserves momentum, mean and effective value but never computes them.
"""

from dataclasses import dataclass
from math import inf, sqrt

from .. import var
from ..motion.axis_limits import AxisLimits
from ..motion.exceeded_limit import PLAN_TOLERANCE, ExceededLimit
from ..numerics.polynomial import ROUNDING, Polynomial
from .profile import TERMS, Profile

SAME_EXTREME = 1e-12  # of the greatest magnitude: values that differ by less are equal, and the first one counts
END = 0  # kind of a row: an end of a segment; n > 0: a root of the position's n-th derivative inside it


@dataclass(slots=True)
class Extremes:
    """The extreme values of a profile, each with the nominal time (s) at which it occurs first in travel order.

    Positions (u) are absolute, velocities in u/s, accelerations in u/s2, jerks in u/s3. Where two segments meet, the
    acceleration and the jerk of both sides count.

    Attributes:
        acceleration_peak, deceleration_peak: greatest |a| where v a > 0 and where v a < 0; 0 where that is nowhere.
        momentum_min, momentum_max: of v a, u2/s3.
        velocity_mean: of |v| over time.
        acceleration_effective: root mean square over time.
        rows: how many instants there are at which something may be extreme; the lists hold them in travel order.
        shares: each row's u within its segment.
        kinds: what each row is: END, or the order of the derivative of which it is a root.
        times, positions, velocities, accelerations, jerks: each row's nominal time, and the slave there.
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
    shares: list[float] = var.array(48)
    kinds: list[float] = var.array(48)
    times: list[float] = var.array(48)
    positions: list[float] = var.array(48)
    velocities: list[float] = var.array(48)
    accelerations: list[float] = var.array(48)
    jerks: list[float] = var.array(48)

    def measure(self, profile: Profile) -> None:
        """Find all values except those of `integrate`, for a profile with at least one segment."""
        self.rows = 0
        self.acceleration_peak = 0.0
        self.deceleration_peak = 0.0
        for i in range(profile.segments):
            self.add_segment_rows(profile, i)
        low, first = self.find_extreme(self.positions, 1, -1.0)
        high, last = self.find_extreme(self.positions, 1, 1.0)
        self.position_min = low
        self.position_min_time = self.times[first]
        self.position_max = high
        self.position_max_time = self.times[last]
        low, first = self.find_extreme(self.velocities, 2, -1.0)
        high, last = self.find_extreme(self.velocities, 2, 1.0)
        self.velocity_min = low
        self.velocity_min_time = self.times[first]
        self.velocity_max = high
        self.velocity_max_time = self.times[last]
        low, first = self.find_extreme(self.accelerations, 3, -1.0)
        high, last = self.find_extreme(self.accelerations, 3, 1.0)
        self.acceleration_min = low
        self.acceleration_min_time = self.times[first]
        self.velocity_at_acceleration_min = self.velocities[first]
        self.acceleration_max = high
        self.acceleration_max_time = self.times[last]
        self.velocity_at_acceleration_max = self.velocities[last]
        low, first = self.find_extreme(self.jerks, 4, -1.0)
        high, last = self.find_extreme(self.jerks, 4, 1.0)
        self.jerk_min = low
        self.jerk_max = high

    def check_limits(self, axis: AxisLimits, exceeded: ExceededLimit) -> None:
        """Find the limit of the axis that the profile, all of which is ahead, exceeds."""
        exceeded.check_extremes(
            axis,
            PLAN_TOLERANCE,
            self.position_min,
            self.position_max,
            max(self.velocity_max, -self.velocity_min),
            self.acceleration_peak,
            self.deceleration_peak,
            max(self.jerk_max, -self.jerk_min),
        )

    def add_segment_rows(self, profile: Profile, i: int) -> None:
        """Add the rows of one segment, and its greatest acceleration and deceleration."""
        d = profile.durations[i]
        begin = self.rows
        self.insert_row(begin, 0.0, END)
        self.insert_row(begin, 1.0, END)
        f = self.polynomial
        set_position_polynomial(f, profile, i)
        small_velocity = 0.0
        small_acceleration = 0.0
        for derivative in range(1, 5):
            f.differentiate()
            if derivative == 1:
                small_velocity = ROUNDING * f.coefficient_sum() / d
            elif derivative == 2:
                small_acceleration = ROUNDING * f.coefficient_sum() / d / d
            f.solve()
            for n in range(f.root_count):
                self.insert_row(begin, f.roots[n], derivative)
        for row in range(begin, self.rows):
            position, velocity, acceleration, jerk = profile.segment_state(i, self.shares[row])
            self.times[row] = profile.start_times[i] + self.shares[row] * d
            self.positions[row] = position
            self.velocities[row] = velocity
            self.accelerations[row] = acceleration
            self.jerks[row] = jerk
            if row > begin:
                self.update_peaks(row, small_velocity, small_acceleration)

    def insert_row(self, begin: int, share: float, kind: int) -> None:
        """Insert a row among those of its segment, which start at row `begin`."""
        row = self.rows
        while row > begin and self.shares[row - 1] > share:
            self.shares[row] = self.shares[row - 1]
            self.kinds[row] = self.kinds[row - 1]
            row -= 1
        self.shares[row] = share
        self.kinds[row] = float(kind)
        self.rows += 1

    def update_peaks(self, row: int, small_velocity: float, small_acceleration: float) -> None:
        """Update the peaks of acceleration and deceleration with the stretch that ends at this row.

        Between two rows v and a are monotone and keep their signs, so both have their greatest magnitudes at one of the
        two rows. Equal signs make it an acceleration, unequal ones a deceleration. A stretch on which v or a is 0 but
        for rounding is neither."""
        velocity = greater_magnitude(self.velocities[row - 1], self.velocities[row])
        acceleration = greater_magnitude(self.accelerations[row - 1], self.accelerations[row])
        if abs(velocity) > small_velocity and abs(acceleration) > small_acceleration:
            if (velocity > 0.0) == (acceleration > 0.0):
                self.acceleration_peak = max(self.acceleration_peak, abs(acceleration))
            else:
                self.deceleration_peak = max(self.deceleration_peak, abs(acceleration))

    def find_extreme(self, values: list[float], kind: int, sign: float) -> tuple[float, int]:
        """The greatest (sign 1) or least (sign -1) value at the rows of that kind and at the ends, and the first row at
        which it is reached."""
        best = -inf
        size = 0.0
        for row in range(self.rows):
            if self.kinds[row] in (END, kind):
                best = max(best, sign * values[row])
                size = max(size, abs(values[row]))
        for row in range(self.rows):
            if self.kinds[row] in (END, kind) and sign * values[row] >= best - SAME_EXTREME * size:
                return sign * best, row
        return sign * best, 0

    def integrate(self, profile: Profile) -> None:
        """Find the extremes of the momentum, the mean speed and the effective acceleration of a measured profile."""
        self.momentum_min = inf
        self.momentum_max = -inf
        distance = 0.0
        power = 0.0
        for i in range(profile.segments):
            self.add_momentum(profile, i)
            distance += self.path_length(profile, i)
            power += integrate_squared_acceleration(profile, i)
        self.velocity_mean = distance / profile.duration()
        self.acceleration_effective = sqrt(power / profile.duration())

    def add_momentum(self, profile: Profile, i: int) -> None:
        """Add a segment to the extremes of v a, which are at its ends and where a^2 + v j is 0.

        That derivative has degree 6 at most. With v = sum of v_n u^n and a = sum of a_n u^n its coefficients are
        (n + 1) times the sum over k of v_k a_(n + 1 - k)."""
        f = self.polynomial
        f.degree = 6
        for n in range(7):
            f.coefficients[n] = 0.0
        for k in range(TERMS - 1):
            velocity = (k + 1.0) * profile.coefficients[TERMS * i + k + 1]
            for m in range(TERMS - 2):
                acceleration = (m + 1.0) * (m + 2.0) * profile.coefficients[TERMS * i + m + 2]
                if k + m > 0:
                    f.coefficients[k + m - 1] += (k + m) * velocity * acceleration
        f.solve()
        for n in range(-1, f.root_count + 1):
            share = 0.0 if n < 0 else f.roots[n] if n < f.root_count else 1.0
            _, velocity, acceleration, _ = profile.segment_state(i, share)
            self.momentum_min = min(self.momentum_min, velocity * acceleration)
            self.momentum_max = max(self.momentum_max, velocity * acceleration)

    def path_length(self, profile: Profile, i: int) -> float:
        """The integral of |v| over a segment: the sum of the distances between its turning points."""
        f = self.polynomial
        set_position_polynomial(f, profile, i)
        f.differentiate()
        f.solve()
        total = 0.0
        before = 0.0
        for n in range(f.root_count + 1):
            after = profile.segment_distance(i, f.roots[n] if n < f.root_count else 1.0)
            total += abs(after - before)
            before = after
        return total


def set_position_polynomial(f: Polynomial, profile: Profile, i: int) -> None:
    """Set f to the position in a segment, as a polynomial in u."""
    f.degree = TERMS - 1
    for n in range(TERMS):
        f.coefficients[n] = profile.coefficients[TERMS * i + n]


def integrate_squared_acceleration(profile: Profile, i: int) -> float:
    """The integral of a^2 over a segment, d times the sum of l_n^2 / (2 n + 1), n = 0 to 3.

    l_n are the coefficients of a in Legendre's polynomials over the segment, which are orthogonal. The terms of this
    sum are squares, so they do not cancel."""
    d = profile.durations[i]
    a0 = 2.0 * profile.coefficients[TERMS * i + 2]
    a1 = 6.0 * profile.coefficients[TERMS * i + 3]
    a2 = 12.0 * profile.coefficients[TERMS * i + 4]
    a3 = 20.0 * profile.coefficients[TERMS * i + 5]
    l0 = (a0 + a1 / 2.0 + a2 / 3.0 + a3 / 4.0) / d / d
    l1 = (a1 / 2.0 + a2 / 2.0 + 9.0 / 20.0 * a3) / d / d
    l2 = (a2 / 6.0 + a3 / 4.0) / d / d
    l3 = a3 / 20.0 / d / d
    return d * (l0 * l0 + l1 * l1 / 3.0 + l2 * l2 / 5.0 + l3 * l3 / 7.0)


def greater_magnitude(a: float, b: float) -> float:
    """The one of both that has the greater magnitude."""
    return a if abs(a) >= abs(b) else b
