"""A master that is measured: a filter for the encoder's values, which makes up for their age.

Each measurement corrects an estimate of the line's motion by the fading-memory filter of three states, also called
critically damped g-h-k filter: all its poles are at theta = exp(-T/tau), and it has no lag at constant acceleration.
The estimate's position jumps with each correction, which no slave can follow. So the master's path is led on to the
estimate, by an acceleration that brings position and velocity there with a double pole at theta.

Source: E. Brookner, Tracking and Kalman Filtering Made Easy, 1998, chapter 1, for the filter. The way to the estimate
is motionsync's own.
"""

from dataclasses import dataclass

from . import var
from .clock import Clock
from .numerics.computable_range import clamp
from .numerics.grid import floor
from .var import LARGEST_INPUT

EQUAL = 1e-9  # of an interval; a difference up to it is the rounding of the importer's clock
SAMPLE_ROUNDING = 1e-9  # of the sample time: a step that begins so little before a multiple of it begins at it
LARGEST_FREQUENCY = 1e100  # 1/s: the reciprocal of a very short time is not infinite, nor are products with it


@dataclass(slots=True)
class EncoderFilter:
    """The estimate of the line's motion at the instant of the latest measurement, in u, u/s and u/s2, and the
    acceleration of the path that leads to it, in u/s2.

    All else is that of the start of the coming step: `age` is the time since the latest measurement, `sample_clock` the
    time since the latest multiple of the sample time, both in s; a measurement `is_due` then or not; where it is
    expected, and with which velocity. `share` and `frequency` are those of `interval`, the age of the latest estimate
    that was corrected: while measurements come at equal distances, nothing is divided.
    """

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    path_acceleration: float = 0.0
    age: float = 0.0
    sample_clock: Clock = var.part(Clock)
    is_due: bool = False
    expected_position: float = 0.0
    expected_velocity: float = 0.0
    interval: float = 0.0
    share: float = 0.0
    frequency: float = 0.0

    def corrected(self, measured: float) -> tuple[float, float, float]:
        """The estimate after a measurement at the start of the coming step."""
        error = measured - self.expected_position
        share = self.share
        theta = 1.0 - share
        rate = share * share * self.frequency * error
        velocity = self.expected_velocity + 1.5 * (1.0 + theta) * rate
        acceleration = self.acceleration + share * self.frequency * rate
        return (
            self.expected_position + (1.0 - theta * theta * theta) * error,
            clamp(velocity, -LARGEST_INPUT, LARGEST_INPUT),
            clamp(acceleration, -LARGEST_INPUT, LARGEST_INPUT),
        )

    def set(self, position: float, velocity: float, acceleration: float, path_acceleration: float) -> None:
        """Take over an estimate of the start of the coming step."""
        self.position = position
        self.velocity = velocity
        self.acceleration = acceleration
        self.path_acceleration = path_acceleration
        self.age = 0.0

    def advance(self, h: float, smoothing_time: float, sample_time: float) -> None:
        """Go on to the end of a step of h seconds."""
        if sample_time > 0.0:
            passed = floor(self.sample_clock.time / sample_time + SAMPLE_ROUNDING)
            self.sample_clock.advance(-passed * sample_time)
            self.sample_clock.advance(h)
        self.is_due = self.sample_clock.time >= (1.0 - SAMPLE_ROUNDING) * sample_time
        self.age += h
        self.expect()
        if self.is_due and not self.has_interval(self.age):
            share, frequency = correction(self.age, smoothing_time)
            self.interval = self.age
            self.share = share
            self.frequency = frequency

    def has_interval(self, interval: float) -> bool:
        """Whether share and frequency are those of an interval, s."""
        return abs(interval - self.interval) <= EQUAL * interval

    def expect(self) -> None:
        """Where the estimate leads to at the start of the coming step."""
        self.expected_position = self.position + (self.velocity + 0.5 * self.acceleration * self.age) * self.age
        self.expected_velocity = self.velocity + self.acceleration * self.age

    def rebase(self, turns: float) -> None:
        """Drop whole turns, u."""
        self.position -= turns
        self.expect()


def leading_acceleration(
    missing: float, missing_velocity: float, acceleration: float, share: float, frequency: float
) -> float:
    """The acceleration, u/s2, that leads to a motion with this acceleration, from a position and a velocity to which so
    much is missing, if it is chosen anew after each interval, of which share and frequency are given."""
    rate = 0.5 * share * (4.0 - share) * missing_velocity + share * share * frequency * missing
    return clamp(acceleration + frequency * rate, -LARGEST_INPUT, LARGEST_INPUT)


def correction(interval: float, smoothing_time: float) -> tuple[float, float]:
    """The share of an error that is corrected after an interval, s, and the interval's reciprocal, 1/s."""
    return correction_share(interval, smoothing_time), min(1.0 / interval, LARGEST_FREQUENCY)


def correction_share(interval: float, smoothing_time: float) -> float:
    """1 - theta: the share of an error that a pole at theta corrects in an interval, both in s.

    theta is 1 / (1 + x (1 + x/2 (1 + x/3))) at x = interval / smoothing_time: nearly exp(-x), and the same bits on all
    platforms. Without a smoothing time theta is 0."""
    if smoothing_time == 0.0:
        return 1.0
    x = interval / smoothing_time
    growth = x * (1.0 + 0.5 * x * (1.0 + x / 3.0))  # 1 / theta - 1
    return growth / (1.0 + growth) if growth < 1e300 else 1.0
