"""A block, step by step: the example of the page, and a refused step."""

import re
from typing import Any

import pytest

from motionsync import CutToLength
from motionsync_fmu import RefusedError, Stepper
from tests import ROOT

PAGE = ROOT / "docs" / "how_to" / "python.md"


def test_the_example_of_the_page_cuts_six_pieces() -> None:
    """As README's FMU does with the same saw: a piece each 804 mm, and the sixth cut before 5000 mm."""
    (code,) = [text for text in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.S) if "Stepper" in text]
    names: dict[str, Any] = {}
    exec(code, names)
    assert names["cuts"] == 6
    assert names["saw"]["last.length"] == pytest.approx(800.0, abs=1e-9)


def test_a_refused_step_changes_nothing() -> None:
    """A line that jumps by 100,000 km in a millisecond passes too many pieces."""
    saw = Stepper(CutToLength()).initialize({"length": 800.0, "auto_start": True})
    saw.step(1e-3, {"master.position": 0.5, "master.velocity": 500.0})
    before = saw.get(saw.cells)
    with pytest.raises(
        RefusedError, match=r"CutToLength refuses step\(0.001\): the master must not travel .*, set master\.period "
    ):
        saw.step(1e-3, {"master.position": 1e11})
    after = saw.get(saw.cells)
    assert {name for name in before if before[name] != after[name]} == {"master.position"}


def test_a_refused_start_value_is_named() -> None:
    with pytest.raises(RefusedError, match="home_position = 900"):
        Stepper(CutToLength()).initialize({"home_position": 900.0, "axis.max_position": 650.0})
