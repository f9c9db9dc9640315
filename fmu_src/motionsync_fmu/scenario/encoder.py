"""An encoder between the true master and the inputs of the block: resolution, noise, delay, slip, runout, sampling.

Times are s from the start, positions u. Without a sample time a sample is taken at each multiple of the step size. The
noise belongs to the samples: at a time between two of them it is that of the earlier one. It depends on the seed and
the number of the sample alone, whatever came before.

Sources of the noise: Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014 (SplitMix64), of
whose outputs each gives two uniform numbers; twelve of them less 6 are nearly Gaussian.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from motionsync.numerics.cosine import cosine

from .script import Script

SAMPLE_ROUNDING = 1e-9  # of the interval of samples: a time that is before a sample by less has it already
GREATEST_NOISE = 4.0  # sigma
GAMMA = 0x9E3779B97F4A7C15  # 2^64 over the golden ratio, made odd
BLOCK = 1024  # samples of the noise that are made at a time
LARGEST_SEED = 2**32 - 1


@dataclass(frozen=True)
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
        seed: of the noise, 0 to LARGEST_SEED.
    """

    resolution: float = 0.0
    noise: float = 0.0
    delay: float = 0.0
    scale: float = 1.0
    runout_amplitude: float = 0.0
    runout_length: float = 1.0
    sample_time: float = 0.0
    seed: int = 0

    def inputs(self, line: Script, t: float, step_size: float, period: float) -> tuple[float, float, float]:
        """What the block is given at t: the position, wrapped if there is a period, the velocity and the acceleration.

        The velocity is the difference of the latest two samples over their distance, and the acceleration is 0; with
        the first sample, both are those of the line at the start. `step_size`: that of the run."""
        interval = self.sample_time or step_size
        n = int(t / interval + SAMPLE_ROUNDING)
        latest = self._measure(line, n * interval, n)
        position = self._measure(line, t, n) if not self.sample_time and t != n * interval else latest
        if n > 0:
            velocity, acceleration = (latest - self._measure(line, (n - 1) * interval, n - 1)) / interval, 0.0
        else:
            velocity, acceleration = self.start_motion(line)
        return _wrap(position, period) if period else position, velocity, acceleration

    def start_motion(self, line: Script) -> tuple[float, float]:
        """Velocity and acceleration with which the measured line starts, u/s and u/s2."""
        start = line.start_motion(self.delay)
        return start.velocity * self.scale, start.acceleration * self.scale

    def _measure(self, line: Script, t: float, n: int) -> float:
        """The position that is measured at t, unwrapped, with the noise of sample n."""
        true = line.before(t - self.delay).position
        measured = true * self.scale
        if self.runout_amplitude:
            measured += self.runout_amplitude * sine(true / self.runout_length)
        if self.noise:
            measured += self.noise * noise_sample(self.seed, n)
        return measured / self.resolution // 1.0 * self.resolution if self.resolution else measured


def sine(turns: float) -> float:
    """sin(2 pi turns), with the same bits on every machine."""
    part = turns - (turns + 0.5) // 1.0  # -0.5 to 0.5
    magnitude = cosine(360.0 * abs(part) - 90.0)
    return magnitude if part > 0.0 else -magnitude


def noise_sample(seed: int, n: int) -> float:
    """Sample n of the noise, from 0, in sigma."""
    return _noise_block(seed, n // BLOCK)[n % BLOCK]


@lru_cache(maxsize=64)
def _noise_block(seed: int, i: int) -> list[float]:
    """The samples from i * BLOCK to below (i + 1) * BLOCK."""
    first = np.uint64(((seed << 32) + 6 * BLOCK * i) % 2**64)
    outputs = _mix((first + np.arange(6 * BLOCK, dtype=np.uint64)) * np.uint64(GAMMA))
    halves = (outputs >> np.uint64(32)) + (outputs & np.uint64(2**32 - 1))
    totals = halves.reshape(BLOCK, 6).sum(axis=1).astype(np.float64)
    samples: list[float] = np.clip(totals / 2.0**32 - 6.0, -GREATEST_NOISE, GREATEST_NOISE).tolist()
    return samples


def _mix(state: Any) -> Any:
    """The output of SplitMix64 for each of these states."""
    z = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def _wrap(position: float, period: float) -> float:
    """The position in its turn, from 0 to below the period."""
    rest = position % period
    return 0.0 if rest == period else rest  # a position just below 0 is rounded to the period
