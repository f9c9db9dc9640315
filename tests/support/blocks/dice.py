"""Random numbers for many instances at once."""

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Bools = NDArray[np.bool_]


class Dice:
    """Random numbers, one for each instance; half of the instances are wild."""

    def __init__(self, seed: int, number: int) -> None:
        self.r = np.random.default_rng(seed)
        self.number = number
        self.wild = self.seldom(0.5)

    def seldom(self, share: float) -> Bools:
        return self.r.random(self.number) < share

    def powers(self, low: float, high: float) -> Reals:
        """From 10**low to 10**high."""
        return 10.0 ** self.r.uniform(low, high, self.number)

    def uniform(self, low: float, high: float) -> Reals:
        return self.r.uniform(low, high, self.number)

    def normal(self, size: float = 1.0) -> Reals:
        return self.r.normal(0.0, size, self.number)

    def choice(self, *values: float) -> Reals:
        return self.r.choice(values, self.number)

    def either(self, realistic: Reals, other: Reals) -> Reals:
        return np.where(self.wild, other, realistic)
