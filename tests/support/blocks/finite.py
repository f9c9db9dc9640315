"""Runs a block as an FMU would step it, and checks that none of its numbers is ever NaN or infinite."""

import math
from collections.abc import Iterator
from functools import cache
from itertools import chain
from typing import Any

from motionsync_fmu.interface.recipe import declared_variables
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import cells, step_size_refusal
from tests.support.blocks.runs import BlockRun


def run_finite(block: Any, run: BlockRun, requests: tuple[str, ...] = ()) -> Iterator[Any]:
    """Step a block along a run; yields the block after each step that it accepts.

    All its numbers are finite then, except tunable parameters that the run itself sets to NaN or infinity, and their
    copies in `requests`, parts of the block. A step whose size or inputs an FMU refuses is left out."""
    stepper, names, lists = Stepper(block), *computed(type(block), requests)
    checked = {v.name: v for v in declared_variables(type(block)).values() if v.checked}
    checked_names = tuple(checked)
    stepper.set(run.start)
    assert not block.initialize()
    for h, values in run.steps:
        before = stepper.get(values)
        stepper.set(values)
        inputs = zip(checked.values(), stepper.values(checked_names), strict=True)
        if step_size_refusal(h) or not all(v.allows(value) for v, value in inputs):
            stepper.set(before)
        elif not block.step(h):
            numbers = chain(stepper.values(names), *stepper.values(lists))
            assert all(map(math.isfinite, numbers)), stepper.get((*names, *lists))
            yield block


@cache
def computed(block_type: type, requests: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names of the numbers that a block computes outside of some parts, and those of its lists of numbers."""
    settable = {v.name for v in declared_variables(block_type).values() if v.settable}
    own = [c for c in cells(block_type()) if c.name not in settable and not c.name.startswith(requests)]
    names, lists = (tuple(c.name for c in own if c.type is kind) for kind in (float, list))
    return names, lists
