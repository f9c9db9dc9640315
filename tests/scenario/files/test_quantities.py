"""Numbers with a unit in scenario files, and in `set` of a run."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.files.reader import read_scenario_text

TEXT = """\
title = "Units"
fmu = "RotaryKnife"
slave_unit = "deg"
stop_time = "1 min"
step_size = "10 ms"

[start]
length = "0.6 m"
"axis.max_velocity" = "600 rpm"

[master]
position = "-2 m"
velocity = "60 m/min"
segments = [{ duration = "500 ms", acceleration = "1 m/s2" }]

[[set]]
at = "100 ms"
start = true

[[on]]
when = "in_sync"
after = "20 ms"
set = { length = "40 cm" }

[[expect]]
at = "2 s"
"slave.position" = "0.5 rev"

[cuts]
tolerance = "100 um"
"""


def test_each_number_may_have_a_unit_of_its_own() -> None:
    s = read_scenario_text(TEXT, Path("scenario.toml"))
    assert (s.stop_time, s.step_size) == (60.0, 0.01)
    assert s.start == {"length": 600.0, "axis.max_velocity": 3600.0}
    first, after = s.master.at(0.0), s.master.at(0.5)
    assert (first.position, first.velocity, first.acceleration) == (-2000.0, 1000.0, 1000.0)
    assert after.velocity == 1500.0
    assert s.settings[0].at == 0.1
    assert (s.reactions[0].after, s.reactions[0].set) == (0.02, {"length": 400.0})
    expected: Any = s.expectations[0]
    assert (expected.at, expected.values) == (2.0, {"slave.position": 180.0})
    assert s.pieces
    assert s.pieces.tolerance == pytest.approx(0.1, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"60 m/min"', '"60 m/minute"', r"scenario.toml:13: velocity: 'm/minute' is no unit"),
        ('"60 m/min"', '"60 rpm"', r"scenario.toml:13: velocity: '60 rpm' is in rpm: it must be in mm/s"),
        ('"600 rpm"', '"600 m"', r"scenario.toml:9: axis.max_velocity: '600 m' is in m: it must be in deg/s"),
        ('"1 m/s2"', '"1 m"', r"scenario.toml:14: acceleration: '1 m' is in m: it must be in mm/s2"),
        ('"100 ms"', '"100 mm"', r"scenario.toml:17: at: '100 mm' is in mm: it must be in s"),
        ('"60 m/min"', '"fast"', r"scenario.toml:13: velocity: 'fast' is not a number"),
    ],
)
def test_a_wrong_unit_is_named_with_file_line_and_key(old: str, new: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        read_scenario_text(TEXT.replace(old, new), Path("scenario.toml"))


def test_set_takes_a_number_with_a_unit() -> None:
    """At 24 m/min a line makes 400 mm/s; the stroke of 900 mm is 0.9 m."""
    scenario = load("CutToLength/basic_cut", set={"master.velocity": "24 m/min", "axis.max_position": "0.9 m"})
    assert scenario.master.at(1.0).velocity == 400.0
    assert scenario.start["axis.max_position"] == 900.0
    assert scenario.overrides == {"master.velocity": "24 m/min", "axis.max_position": "0.9 m"}


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("24 m", "--set: master.velocity=24 m: '24 m' is in m: it must be in mm/s"),
        ("fast", "--set: master.velocity=fast: 'fast' is not allowed: it must be a number"),
    ],
)
def test_a_wrong_value_of_set_is_named(value: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        load("CutToLength/basic_cut", set={"master.velocity": value})


def test_a_file_with_units_takes_other_values() -> None:
    scenario = load(tomllib.loads(TEXT), set={"master.velocity": 500.0, "set.0.at": "0.2 s"})
    assert scenario.master.at(0.0).velocity == 500.0
    assert scenario.settings[0].at == 0.2
