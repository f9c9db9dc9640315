"""A recipe: its variables, and the block that it makes."""

import pytest

from motionsync.blocks import BLOCKS
from motionsync.var import Role, Unit
from motionsync_fmu import describe
from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.roles import remote_axis
from motionsync_fmu.interface.units import BASES, unit_name
from motionsync_fmu.interface.variables import refusals, variables


def test_the_variables_are_those_of_the_block_in_its_order(block: str) -> None:
    names = [v.name for v in variables(BLOCKS[block]())]
    assert list(Recipe(block).variables) == names


def test_every_block_has_the_variables_that_tools_know_by_name(block: str) -> None:
    slave = {f"slave.{name}" for name in ("position", "velocity", "acceleration", "jerk")}
    assert {"state", "state_code", "error", "error_id", *slave} - set(Recipe(block).variables) == set()


def test_codes_and_refusals_name_variables_of_the_block(block: str) -> None:
    """A name that begins with a dot is left out of a message where the group has no such variable."""
    table = Recipe(block).variables
    codes = {code for v in table.values() for code in v.declaration.codes or ()}
    named = {(m.name, name) for m in (*codes, *refusals(BLOCKS[block])) for name in m.names}
    assert [(member, name) for member, name in named if name not in table and not name.startswith(".")] == []


def test_baked_start_values_are_those_of_one_recipe_alone() -> None:
    baked, plain = Recipe("Synchronizer", starts={"rest_value": "12.5"}), Recipe("Synchronizer")
    assert baked.variables["rest_value"].start == 12.5
    assert plain.variables["rest_value"].start == 0.0
    assert baked.block().rest_value == 12.5
    assert plain.block().rest_value == 0.0


def test_a_block_of_the_recipe_is_not_the_one_of_its_variables() -> None:
    recipe = Recipe("Synchronizer")
    block = recipe.block()
    block.rest_value = 99.0
    assert recipe.variables["rest_value"].cell.get() == 0.0


def test_the_variables_cannot_be_replaced() -> None:
    table = Recipe("Synchronizer").variables
    with pytest.raises(TypeError):
        table["rest_value"] = table["curve"]  # type: ignore[index]


def test_what_cannot_be_made_is_refused() -> None:
    for recipe, part in (
        (Recipe("Nope"), "no block is named 'Nope'"),
        (Recipe("Synchronizer", "km"), "no unit is named 'km'"),
        (Recipe("Synchronizer", slave_unit="deg"), "in its master's unit"),
        (Recipe("Synchronizer", starts={"slave.position": "1"}), "parameter or input of Synchronizer"),
    ):
        with pytest.raises(UserError, match=part):
            recipe.block()


def test_a_tool_that_turns_does_so_in_degrees_unless_it_is_said_otherwise(block: str) -> None:
    """Whether it turns is what the block declares: the travel of its slave from cut to cut."""
    table = Recipe(block).variables.values()
    turns = any(v.declaration.role is Role.CUT_SPACING for v in table)
    assert turns or block != "RotaryKnife"
    has_own_unit = any(v.declaration.unit.slave for v in table)
    for unit in BASES:
        position = describe(block, unit=unit).variables["slave.position"]
        assert position.unit == unit_name(Unit.POSITION, "deg" if turns else unit)
        for own in BASES if has_own_unit else ():
            position = describe(block, unit=unit, slave_unit=own).variables["slave.position"]
            assert position.unit == unit_name(Unit.POSITION, own)


def test_one_block_has_a_remote_axis_and_the_others_a_master(block: str) -> None:
    table = Recipe(block).variables
    axis = remote_axis(table.values())
    if axis is None:
        assert "master.position" in table
    else:
        assert "master.position" not in table
        assert axis.wraps_at == 65536
        for name in (axis.cycle_index, axis.task_cycle, axis.data_cycle, axis.delay, axis.corrected_index):
            assert name in table
        assert f"{axis.part}.position" in table
