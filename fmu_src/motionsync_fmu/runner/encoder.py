"""An encoder between the true master and the inputs of the block: resolution, noise, delay, slip, runout, sampling.

Times are s from the start, positions u. Without a sample time a sample is taken at each multiple of the step size. The
noise belongs to the samples: at a time between two of them it is that of the earlier one."""

from dataclasses import dataclass
from math import floor

from motionsync.numerics.cosine import cosine

from .axis import Axis, velocity_after
from .noise import sample

SAMPLE_ROUNDING = 1e-9  # of the interval of samples: a time that is before a sample by less has it already


@dataclass(slots=True)
class Encoder:
    """What is measured of the master.

    Attributes:
        resolution: the position is rounded down to a multiple of it, u; 0: it is not.
        noise: one sigma, u; white, Gaussian, and clipped at 4 sigma.
        delay: how old a position is, s.
        scale: the measured travel over the true one.
        runout_amplitude: of the wheel, u; a sine of the true travel.
        runout_length: the travel in one turn of the wheel, u.
        sample_time: how often a sample is taken, s; in between it is held. 0: the position is always a fresh one.
        interval: of the samples, s: the sample time, or else the step size.
        seed: of the noise, 0 to 2^32 - 1.
        start_velocity, start_acceleration: with which the measured line starts, u/s and u/s2.
        number: of the latest sample; -1: there is none yet.
        latest, former: the latest two samples.
        section: of the axis, where it is measured.
        position, velocity, acceleration: what is shown, the position without wrapping.
    """

    resolution: float = 0.0
    noise: float = 0.0
    delay: float = 0.0
    scale: float = 1.0
    runout_amplitude: float = 0.0
    runout_length: float = 1.0
    sample_time: float = 0.0
    interval: float = 0.0
    seed: int = 0
    start_velocity: float = 0.0
    start_acceleration: float = 0.0
    number: int = -1
    latest: float = 0.0
    former: float = 0.0
    section: int = 0
    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def begin(self, axis: Axis) -> None:
        """Take the motion of a line before its start; that of a recorded one is the mean motion of its beginning, since
        neighbouring positions alone would show their rounding."""
        delay = 0.0 if axis.is_recorded else self.delay
        velocity = velocity_after(-delay, axis.start_velocity, axis.start_acceleration, 0.0)
        acceleration = axis.start_acceleration
        if delay == 0.0 and not axis.is_recorded:
            axis.go_to(0.0)
            velocity = axis.velocity
            acceleration = axis.acceleration
        self.start_velocity = velocity * self.scale
        self.start_acceleration = acceleration * self.scale

    def show(self, axis: Axis, t: float) -> None:
        """Show what the encoder knows at t: the velocity is the difference of the latest two samples over their
        distance, and the acceleration is 0; with the first sample, both are those of the line at the start."""
        n = int(t / self.interval + SAMPLE_ROUNDING)
        if n != self.number:
            self.section = axis.section_at(t - self.delay, self.section)
            if n > 0:
                self.former = self.latest if n == self.number + 1 else self.sampled(axis, n - 1)
            self.latest = self.sampled(axis, n)
            self.number = n
        is_between = self.sample_time == 0.0 and t != float(n) * self.interval
        self.position = self.measured(axis, t, n) if is_between else self.latest
        if n == 0:
            self.velocity = self.start_velocity
            self.acceleration = self.start_acceleration
        else:
            self.velocity = (self.latest - self.former) / self.interval
            self.acceleration = 0.0

    def sampled(self, axis: Axis, n: int) -> float:
        """Sample n."""
        return self.measured(axis, float(n) * self.interval, n)

    def measured(self, axis: Axis, t: float, n: int) -> float:
        """The position that is measured at t, unwrapped, with the noise of sample n."""
        true = axis.true_position(t - self.delay, self.section)
        position = true * self.scale
        if self.runout_amplitude != 0.0:
            position += self.runout_amplitude * sine(true / self.runout_length)
        if self.noise != 0.0:
            position += self.noise * sample(self.seed, n)
        return floor(position / self.resolution) * self.resolution if self.resolution != 0.0 else position


def sine(turns: float) -> float:
    """sin(2 pi turns), with the same bits on every machine."""
    part = turns - floor(turns + 0.5)  # -0.5 to 0.5
    magnitude = cosine(360.0 * abs(part) - 90.0)
    return magnitude if part > 0.0 else -magnitude
