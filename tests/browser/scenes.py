"""Compares what the machine is drawn from: by a report, from a recording, and by a page that runs the block itself."""

from bisect import bisect_right
from typing import Any

import numpy as np
import pytest


def assert_same_scene(expected: Any, actual: Any, where: str, stop: float) -> None:
    """Both have the same numbers, texts, and signals at any time up to `stop`, in s."""
    if isinstance(expected, dict) and "t" in expected:
        if "v" not in expected:
            _assert_same_signal(expected, actual, where, stop)
    elif isinstance(expected, dict):
        assert expected.keys() == actual.keys(), where
        for key in expected:
            assert_same_scene(expected[key], actual[key], f"{where}.{key}", stop)
    elif isinstance(expected, list | tuple):
        assert len(expected) == len(actual), where
        for i, pair in enumerate(zip(expected, actual, strict=True)):
            assert_same_scene(*pair, f"{where}[{i}]", stop)
    elif isinstance(expected, float):
        assert actual == pytest.approx(expected, rel=1e-6, abs=1e-6), where
    else:
        assert actual == expected, where


def _assert_same_signal(expected: Any, actual: Any, where: str, stop: float) -> None:
    for t in np.linspace(0.0, stop, 97).tolist():
        values = [s["x"][max(bisect_right(s["t"], t) - 1, 0)] for s in (expected, actual)]
        assert values[1] == pytest.approx(values[0], rel=1e-3, abs=1e-6), f"{where} at {t}"
