"""Measured lines of many runs: positions of shape (runs, steps), at the starts of steps of 1 ms."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.master import MasterInput

Reals = NDArray[np.float64]

STEP = 1e-3  # s
SEEDS = 100
MEASURED: dict[str, Any] = {"master.input_mode": MasterInput.MEASURED}
POSITION_SIGMA, VELOCITY_SIGMA = 0.2655, 15.97  # of the path, u and u/s, for noise of 1 u, 20 ms and steps of 1 ms


def times(duration: float) -> Reals:
    return np.arange(round(duration / STEP)) * STEP


def noisy(line: Reals, sigma: float, runs: int = SEEDS) -> Reals:
    """White Gaussian noise, clipped at 4 sigma, of its own for each run; `line` is (steps,) or (runs, steps)."""
    r = np.random.default_rng(5)
    return line + sigma * np.clip(r.standard_normal((runs, line.shape[-1])), -4.0, 4.0)


def counted(line: Reals, resolution: float) -> Reals:
    """As an encoder of that resolution counts."""
    return np.asarray(np.floor(line / resolution) * resolution)


def halting(rest: NDArray[Any], velocity: float, acceleration: float, pause: float, t: Reals) -> Reals:
    """Lines that run, brake to rest at these positions (runs, 1), pause for a time, and run on."""
    ramp = velocity / acceleration
    brakes = rest / velocity - 0.5 * ramp

    def ran(begin: Reals) -> Reals:
        """The way of a ramp up that begins then, and of the run after it."""
        in_ramp = np.clip(t - begin, 0.0, ramp)
        return 0.5 * acceleration * in_ramp**2 + velocity * np.maximum(t - begin - ramp, 0.0)

    return velocity * t - ran(brakes) + ran(brakes + ramp + pause)


def changes(values: Reals) -> NDArray[np.intp]:
    """How often a value changes in each run."""
    return np.count_nonzero(np.diff(values, axis=1), axis=1)
