"""The units in which a block states motion."""

import pytest

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.units import unit_name

MOTION = ("position", "velocity", "acceleration", "jerk")


@pytest.mark.parametrize(("unit", "slave_unit"), [("mm", ""), ("deg", ""), ("mm", "deg")])
def test_each_derivative_of_a_position_is_per_second_once_more(block: str, unit: str, slave_unit: str) -> None:
    """A slave unit of its own is for blocks that take one."""
    table = Recipe(block).variables
    if slave_unit and not any(v.declaration.unit.slave for v in table.values()):
        slave_unit = ""
    for axis, own in (("master", unit), ("slave", slave_unit or unit)):
        units = {
            name: unit_name(table[f"{axis}.{name}"].declaration.unit, unit, slave_unit)
            for name in MOTION
            if f"{axis}.{name}" in table
        }
        expected = dict(zip(MOTION, (own, f"{own}/s", f"{own}/s2", f"{own}/s3"), strict=True))
        assert units == {name: expected[name] for name in units}
        assert axis == "master" or units.keys() == expected.keys()
