"""Compares pictures."""

import re
from pathlib import Path

import numpy as np

NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?"


def assert_same_picture(made: bytes, shipped: Path) -> None:
    """The same but for rounding: two processors may differ in the last digit that is written."""
    texts = made.decode(), shipped.read_text("utf-8")
    assert re.sub(NUMBER, "#", texts[0]) == re.sub(NUMBER, "#", texts[1])
    a, b = (np.array([float(x) for x in re.findall(NUMBER, text)]) for text in texts)
    assert np.abs(a - b).max() < 0.02
