"""The numbers of a plan: lists, ranges, and units of their own."""

import pytest

from motionsync_fmu.plan.reader import read_option
from tests.plan.machines import REFERENCE, machine


@pytest.mark.parametrize(
    ("name", "text", "numbers"),
    [
        ("length", "1500,500", [500.0, 1500.0]),
        ("length", "6 m, 250", [250.0, 6000.0]),
        ("velocity", "40 m/min", [2000.0 / 3.0]),
        ("velocity", "0.5 m/s", [500.0]),
    ],
)
def test_a_number_may_have_a_unit_of_its_own(name: str, text: str, numbers: list[float]) -> None:
    assert read_option(name, text, machine(REFERENCE)) == numbers


def test_a_range_in_another_unit_is_that_in_the_machine_s_own() -> None:
    in_mm, in_m = machine(REFERENCE), machine(REFERENCE).with_units("m")
    assert read_option("length", "1 m..3 m", in_mm) == read_option("length", "1000..3000", in_mm)
    assert read_option("length", "1 m..3 m", in_m) == read_option("length", "1..3", in_m)
