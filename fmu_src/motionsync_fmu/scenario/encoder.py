"""An encoder between the true master and the inputs of the block: resolution, noise, delay, slip, runout, sampling.

`runner/encoder.py` says what it shows. Times are s from the start, positions u."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from typing import TypeAlias

from motionsync.numerics.grid import wrap

from ..runner import encoder as runner
from .script import Script

LARGEST_SEED = 2**32 - 1
Reading: TypeAlias = tuple[float, float, float]


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

    def set(self, encoder: runner.Encoder, step_size: float) -> None:
        """Set these numbers in the encoder of a run; `step_size`: that of the run."""
        for f in fields(self):
            setattr(encoder, f.name, getattr(self, f.name))
        encoder.interval = self.sample_time or step_size

    def readings(self, line: Script, times: Iterable[float], step_size: float, period: float) -> Iterator[Reading]:
        """What the block is given at these times: the position, wrapped if there is a period, the velocity and the
        acceleration. `step_size`: that of the run."""
        encoder, axis = runner.Encoder(), line.axis()
        self.set(encoder, step_size)
        encoder.begin(axis)
        for t in times:
            encoder.show(axis, t)
            yield wrap(encoder.position, period), encoder.velocity, encoder.acceleration
