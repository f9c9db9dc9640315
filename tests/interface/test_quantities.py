"""Numbers with a unit: what they are in another one, by hand."""

import math

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.quantities import convert, is_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("40 m/min", "mm/s", 40_000 / 60),
        ("6 m", "mm", 6000.0),
        ("6m", "m", 6.0),
        ("4 m/s2", "mm/s2", 4000.0),
        ("4 m/s^2", "mm/s2", 4000.0),
        ("-0.5 m/s³", "mm/s3", -500.0),
        ("600 rpm", "deg/s", 3600.0),
        ("2 rev", "deg", 720.0),
        ("180 deg", "rad", math.pi),
        ("2 rad/s", "deg/s", 2 * 180 / math.pi),
        ("250 ms", "s", 0.25),
        ("1e2 mm", "m", 0.1),
        ("10 ft", "in", 120.0),
        ("3 inch", "mm", 76.2),
        ('7.5"', "mm", 190.5),
        ("2'", "in", 24.0),
        ("100 fpm", "mm/s", 508.0),
        ("90ipm", "mm/s", 38.1),
        ("5 ft 6 in", "mm", 1676.4),
        ("11' 3\"", "in", 135.0),
        ("-5ft-6.5in", "in", -66.5),
        ("5 1/min", "1/s", 5 / 60),
    ],
)
def test_a_quantity_in_another_unit(text: str, unit: str, value: float) -> None:
    assert is_quantity(text)
    assert convert(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "message"),
    [
        ("5 kg", "mm", "'kg' is no unit; there is um, mm"),
        ("5 s", "mm", "'5 s' is in s: it must be in mm"),
        ("5 m/min", "mm", "it must be in mm"),
        ("5 mm", "", "it must be in no unit"),
        ("5 MM", "mm", "'MM' is no unit"),
        ("5 m/", "mm", "'m/' is no unit"),
        ("5 ft 6", "mm", "it must be in mm"),
        ("5' 6 mm", "mm", "is no unit"),
        ("5 ft 6 in", "mm/s", "it must be in mm/s"),
    ],
)
def test_what_measures_something_else_is_refused(text: str, unit: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        convert(text, unit)


@pytest.mark.parametrize("text", ["12", "1e5", "-3.5", "POSITION_ONLY", "51/s", "master.velocity", ""])
def test_other_texts_are_no_quantities(text: str) -> None:
    assert not is_quantity(text)
