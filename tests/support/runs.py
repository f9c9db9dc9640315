"""What the random runs of all blocks have in common."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

EXTREMES = (0.0, -0.0, 5e-324, -1e-300, 1e12, -1e12, 1e15, math.nan, math.inf)


@dataclass(frozen=True)
class Run:
    """Start values of parameters and inputs, and for each step its size and what is set before it."""

    start: dict[str, Any]
    steps: list[tuple[float, dict[str, Any]]]


@dataclass(frozen=True)
class Strategy:
    """How a block is run at random.

    Attributes:
        runs: draws runs of a given number of steps: ordinary runs, and runs at the limits of the inputs and beyond.
            Start values are within their limits.
        watch: the things in a block's present state that are worth meeting.
        meets: the things of these that a few runs have to meet; they have to meet a refused step as well.
    """

    runs: Callable[[int], st.SearchStrategy[Run]]
    watch: Callable[[Any], set[Any]]
    meets: frozenset[Any]
