"""A random run of a block, and the strategy that draws such runs."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

EXTREMES = (0.0, -0.0, 5e-324, -1e-300, 1e12, -1e12, 1e15, math.nan, math.inf)


@dataclass(frozen=True)
class BlockRun:
    """Start values of parameters and inputs, and for each step its size and what is set before it."""

    start: dict[str, Any]
    steps: list[tuple[float, dict[str, Any]]]


@dataclass(frozen=True)
class Strategy:
    """Random runs of a block, and the states that they have to reach.

    Attributes:
        runs: draws runs of a given number of steps: ordinary runs, and runs at the limits of the inputs and beyond.
            Start values are within their limits.
        watch: the remarkable features of a block's present state.
        required_features: the features that a few runs have to reach; these also contain a refused step.
        check: asserts what belongs together in each state of the block.
        requests: the parts of the block that hold what a command asks for, valid or not.
    """

    runs: Callable[[int], st.SearchStrategy[BlockRun]]
    watch: Callable[[Any], set[Any]]
    required_features: frozenset[Any]
    check: Callable[[Any], None] = lambda block: None
    requests: tuple[str, ...] = ()
