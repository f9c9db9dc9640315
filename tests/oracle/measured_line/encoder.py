"""An encoder between the true master and `master.position`, exact, on the doubles given. Times are s, positions u.

Where the description may be read in two ways, this is the reading:
- The start is at 0. With `sample_time` the value at t is that of t' = n * sample_time, n the greatest whole number with
  n <= t / sample_time + 1e-9, so that t' may be later than t by that little. The true position is that of t' - delay.
- The runout is a sine of the true travel, and is not scaled. True positions are not wrapped, and the scale acts on the
  position itself: at the start an encoder is off by what the slip is on the way from position 0.
- Without `sample_time`, at a point that the script adds between communication points, the noise is the one of the
  communication point before; the position is that of the time itself.
- The count is floor((q + noise) / resolution), without a tolerance. Where the exact quotient is a whole number or very
  near to one, which a line with a round velocity meets all the time, floating-point numbers may count one less or more:
  `continuous` shows how near it is.
- Wrapping comes last: with a period that is no multiple of the resolution, the values are none of it either.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from tests.oracle.master import stretches
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number
from tests.oracle.numerics.splitmix64 import noise_sample

Line: TypeAlias = Callable[[Number], Number]
"""The true, unwrapped position over time, also before the start."""
TOLERANCE = mp.mpf(10) ** -9


@dataclass(frozen=True)
class Encoder:
    """`resolution`, `noise` (one sigma), `runout_amplitude` and `period` in u, 0: none; `scale` measured per true."""

    resolution: Number = 0.0
    noise: Number = 0.0
    delay: Number = 0.0
    scale: Number = 1.0
    runout_amplitude: Number = 0.0
    runout_length: Number = 1.0
    sample_time: Number = 0.0
    seed: int = 0
    period: Number = 0.0

    def sample_number(self, t: Number) -> int:
        """The number of the sample that the input has at t, from 0; only with a `sample_time`."""
        return int(mp.floor(mp.mpf(t) / self.sample_time + TOLERANCE))

    def reading(self, t: Number, n: int, line: Line) -> Number:
        """The value of `master.position` at t: sample n, of `sample_time`, or else of the communication points.

        Raises ValueError if n is not the number of the sample at t, with `sample_time`.
        """
        counted = self.unwrapped(t, n, line)
        return counted % self.period if self.period else counted

    def unwrapped(self, t: Number, n: int, line: Line) -> Number:
        """The reading before it is wrapped."""
        q = self.continuous(t, n, line)
        return mp.floor(q / self.resolution) * self.resolution if self.resolution else q

    def continuous(self, t: Number, n: int, line: Line) -> Number:
        """The reading before it is rounded down: where it is nearly a multiple of the resolution, either is right."""
        t = mp.mpf(t)
        if self.sample_time:
            if n != self.sample_number(t):
                raise ValueError(f"the sample at {t} s is number {self.sample_number(t)}, not {n}")
            t = n * mp.mpf(self.sample_time)
        true = mp.mpf(line(t - self.delay))
        runout = self.runout_amplitude * mp.sin(2 * mp.pi * true / self.runout_length)
        return true * self.scale + runout + mp.mpf(self.noise) * noise_sample(self.seed, n)


def scripted_line(script: Mapping[str, Any], horizon: Number) -> Line:
    """The true position of a scripted master until `horizon` (s); before 0 its initial motion carried on backwards."""
    pieces = stretches(script, mp.mpf(horizon))

    def position(t: Number) -> Number:
        return next(piece for piece in reversed(pieces) if piece.begin <= t or piece is pieces[0]).at(t).position

    return position
