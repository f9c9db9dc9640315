"""Samples of ranges: points of the unit cube, by a Latin hypercube or a Sobol sequence (`scipy.stats.qmc`).

Grids are in `factors.py`; `sweep_plan.py` puts both together.
"""

import warnings
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, lru_cache
from importlib.metadata import version
from threading import Lock
from typing import Any

import numpy as np

from ..optional_dependencies import require

Points = np.ndarray[Any, np.dtype[np.float64]]
"""Shares of ranges, from 0 to below 1; shape (samples, ranges)."""

MOST_LATIN = 20_000_000  # numbers of a Latin hypercube: 160 MB
LEAST_BITS = 30  # of a Sobol number: scipy's own choice


class Method(StrEnum):
    """How ranges are sampled."""

    LHS = "lhs"
    SOBOL = "sobol"


@dataclass(frozen=True)
class Samples:
    """The samples of all ranges together.

    Attributes:
        count: how many there are.
        ranges: how many ranges.
        seed: the same seed gives the same samples, as long as scipy has the same version.
    """

    method: Method
    count: int
    ranges: int
    seed: int

    @property
    def refusal(self) -> str:
        """Why there cannot be such samples; empty if there can."""
        if self.method is Method.LHS and self.count * self.ranges > MOST_LATIN:
            return (
                f"a Latin hypercube of {self.count:,} samples does not fit into memory: with {self.ranges} ranges "
                f"at most {MOST_LATIN // self.ranges:,}; Sobol points have no such limit"
            )
        return ""

    def points(self, first: int, last: int) -> Points:
        """The samples with the numbers from `first` to below `last`. They do not depend on what is asked for before.

        Sobol points are computed from `first` on. A Latin hypercube is a whole, and stays in memory."""
        if self.method is Method.LHS:
            return _hypercube(self)[first:last]
        return _sobol(self).points(first, last)


@cache
def sampler() -> str:
    """The version of scipy, on which samples depend.

    Raises:
        UserError: it is not installed.
    """
    require("sweep", "scipy")
    return version("scipy")


@lru_cache(maxsize=2)
def _hypercube(samples: Samples) -> Points:
    from scipy.stats import qmc  # noqa: PLC0415 (an extra; it takes long to load)

    points: Points = qmc.LatinHypercube(samples.ranges, rng=np.random.default_rng(samples.seed)).random(samples.count)
    points.flags.writeable = False
    return points


class _Sobol:
    """A Sobol sequence, scrambled, at any index. To continue is quick; to go back starts again, and passes over some
    10^8 points a second."""

    def __init__(self, samples: Samples) -> None:
        self._samples = samples
        self._lock = Lock()
        self._begin()

    def _begin(self) -> None:
        from scipy.stats import qmc  # noqa: PLC0415 (an extra; it takes long to load)

        bits = max(LEAST_BITS, self._samples.count.bit_length())
        self._engine = qmc.Sobol(self._samples.ranges, bits=bits, rng=np.random.default_rng(self._samples.seed))
        self._next = 0

    def points(self, first: int, last: int) -> Points:
        with self._lock, warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of a count that is no power of 2: the user's choice
            if first < self._next:
                self._begin()
            if first > self._next:
                self._engine.fast_forward(first - self._next)
            self._next = last
            return np.asarray(self._engine.random(last - first))


@lru_cache(maxsize=2)
def _sobol(samples: Samples) -> _Sobol:
    return _Sobol(samples)
