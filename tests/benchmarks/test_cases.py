"""A block with cases is measured in them, and does in them what they describe."""

import pytest
from cases import MEASURED, cases_of
from cases.measured import H
from step_cost import LEAD, bare

from motionsync_fmu.interface.recipe import Recipe

pytestmark = pytest.mark.parametrize("block", MEASURED)


def test_every_case_of_a_block_names_its_variables(block: str) -> None:
    cases, variables = cases_of(block), Recipe(block).variables
    assert cases.steady
    assert cases.worst
    named = {*cases.axis.motion, *filter(None, [cases.axis.counter])}
    for steady in cases.steady:
        named |= {*steady.start, *steady.begin, *steady.holds}
    for worst in cases.worst:
        assert worst.planned, f"{worst.name}: no values of {worst.watch} show that the command was planned"
        assert {len(values) for values in worst.planned} == {len(worst.watch)}
        named |= {*worst.commands, *worst.start, *worst.between, *worst.draws, *worst.ahead, *worst.watch}
        named |= {name for name, _ in worst.ahead.values()}
    assert named <= set(variables)


def test_a_block_goes_on_in_its_steady_motions(block: str) -> None:
    """The benchmark itself asserts what holds, after so many steps."""
    cases = cases_of(block)
    for case in cases.steady:
        bare(Recipe(block).block(), case, cases.axis)(LEAD + round(1.0 / H))


def test_the_motion_in_which_input_modes_are_compared_is_there_in_each(block: str) -> None:
    cases = cases_of(block)
    assert len(cases.by_mode) == (4 if "master.input_mode" in Recipe(block).variables else 0)
    for case in cases.by_mode.values():
        bare(Recipe(block).block(), case, cases.axis)(LEAD + round(1.0 / H))
