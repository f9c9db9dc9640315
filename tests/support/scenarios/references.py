"""Compares the outputs of an importer with a reference that is next to an FMU or in it."""

from typing import Any

import numpy as np

Table = np.ndarray[Any, np.dtype[Any]]  # structured; its first column is the time, in s


def assert_met(reference: Table, result: Table, tolerance: float) -> None:
    """Each variable of the reference, at each of its times; between both values where there are two.

    `tolerance`: relative to the greatest magnitude of the variable, at least 1."""
    for name in reference.dtype.names[1:]:
        allowed = tolerance * max(1.0, np.abs(reference[name]).max())
        for time in np.unique(reference["time"]):
            values = reference[name][reference["time"] == time]
            (at,) = np.flatnonzero(np.abs(result["time"] - time) < 1e-6)
            assert values.min() - allowed <= result[name][at] <= values.max() + allowed, (name, time)
