"""Runs a block as an FMU would step it, and checks that none of its numbers is ever NaN or infinite."""

import math
from collections.abc import Iterator
from typing import Any

from motionsync_fmu.interface.variables import cells, step_size_refusal, variables
from tests.support.runs import BlockRun


def run_finite(block: Any, run: BlockRun) -> Iterator[Any]:
    """Step a block along a run; yields the block after each step that it accepts.

    All its numbers are finite then, except tunable parameters that the run itself sets to NaN or infinity. A step
    whose size or inputs an FMU refuses is left out."""
    by_name = {c.name: c for c in cells(block)}
    checked = [v for v in variables(block) if v.checked]
    settable = {v.name for v in variables(block) if v.settable}
    computed = [c for c in by_name.values() if c.name not in settable and c.type in (float, list)]
    for name, value in run.start.items():
        by_name[name].set(value)
    assert not block.initialize()
    for h, values in run.steps:
        before = {name: by_name[name].get() for name in values}
        for name, value in values.items():
            by_name[name].set(value)
        if step_size_refusal(h) or any(v.refusal(v.cell.get()) for v in checked):
            for name, value in before.items():
                by_name[name].set(value)
        elif not block.step(h):
            for cell in computed:
                numbers = cell.get() if cell.type is list else [cell.get()]
                assert all(map(math.isfinite, numbers)), f"{cell.name} = {cell.get()}"
            yield block
