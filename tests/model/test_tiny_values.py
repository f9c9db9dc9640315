"""Numbers next to 0 lead to no number that is none, and to no arithmetic error, in any block."""

from random import Random
from typing import Any

import pytest

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from motionsync_fmu.interface.variables import Variable
from tests.support.blocks.finite import run_finite
from tests.support.blocks.numbers import TINY
from tests.support.blocks.random_runs import draw_runs
from tests.support.blocks.runs import BlockRun


def thinned(run: BlockRun, reals: dict[str, Variable], r: Random) -> BlockRun:
    """The run with some of its Reals next to 0: all of one size, or each of its own."""
    share, size = r.choice((0.05, 0.3)), r.choice((0.0, r.choice(TINY)))
    # Of positions alone the master's velocity is computed: one that is 0 in some steps goes a million cycles in others.
    alike = {"master.position"} if run.start.get("master.input_mode") == MasterInput.POSITION_ONLY else set()
    always = {name for name in alike if r.random() < share}

    def some(values: dict[str, Any]) -> dict[str, Any]:
        chosen = [name for name in values if name in always or (name not in alike and r.random() < share)]
        changed = {name: r.choice((1.0, -1.0)) * (size or r.choice(TINY)) for name in chosen}
        return values | {name: x for name, x in changed.items() if name in reals and reals[name].allows(x)}

    return BlockRun(some(run.start), [(h, some(values)) for h, values in run.steps])


@pytest.mark.slow
def test_no_number_next_to_0_does_harm(block: str) -> None:
    reals = {v.name: v for v in Recipe(block).variables.values() if v.settable and v.kind == "Real"}
    r, steps = Random(1), 0
    for run in draw_runs(block, 30, 60):
        tiny = thinned(run, reals, r)
        try:
            Stepper(BLOCKS[block]()).initialize(tiny.start)
        except RefusedError:
            continue
        steps += sum(1 for _ in run_finite(BLOCKS[block](), tiny))
    assert steps > 1000
