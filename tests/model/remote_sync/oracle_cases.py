"""Telegrams for the RemoteSync's oracle, and what is read of its rows."""

from collections.abc import Iterable
from typing import Any

import pytest

from tests.oracle.remote_sync import RemoteSyncOracle

BYPASS, PT1, SYNC, TIME = 1, 2, 3, 4
BEAT, PHASE = 1, 2
T = 0.002
UNIFORM: dict[str, Any] = {"slope1_numerator": 0.5, "slope1_denominator": 0.5}

Rows = list[dict[str, Any]]


def run(indices: Iterable[int], inputs: dict[str, Any] | None = None, **parameters: Any) -> Rows:
    """The outputs of one cycle an index."""
    oracle = RemoteSyncOracle(parameters, inputs)
    return [oracle.step({"remote.cycle_index": index}, T) for index in indices]


def beating(cycles: int, *dates: int, sign: int = 1, first: int = 0) -> list[int]:
    """Indices of clean beats: D is `first` and steps by `sign` at each date."""
    return [n + first + sign * sum(n >= date for date in dates) for n in range(cycles)]


def column(rows: Rows, name: str) -> list[Any]:
    return [row[name] for row in rows]


def since(rows: Rows, name: str) -> int:
    """The first cycle in which a flag is set."""
    return column(rows, name).index(True)


def close(value: float) -> Any:
    return pytest.approx(value, rel=1e-13, abs=1e-13)
