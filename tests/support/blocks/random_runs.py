"""Random runs of any registered block, drawn by the strategy in `tests/model/<block>/strategies.py`."""

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

from hypothesis import Phase, given, seed, settings

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from tests.support.blocks.by_block import load_test_module
from tests.support.blocks.runs import BlockRun, Strategy
from tests.support.hosts.wrong_inputs import with_wrong_inputs


def load_strategy(name: str) -> Strategy:
    """The strategy of the block of that name; with a master, also of wrong inputs.

    Raises:
        LookupError: the block has none.
    """
    strategy: Strategy = load_test_module(name, "strategies").STRATEGY
    return with_wrong_inputs(strategy) if "master.input_warning" in Recipe(name).variables else strategy


class _Enough(BaseException):
    """Ends the drawing of examples. Hypothesis lets pass what is no Exception."""


def draw_runs(name: str, steps: int, count: int) -> list[BlockRun]:
    """`count` random runs of `steps` steps, the same at every call."""
    runs: list[BlockRun] = []
    draw_until(name, steps, count, runs.append)
    return runs


def draw_until(name: str, steps: int, count: int, see: Callable[[BlockRun], object]) -> None:
    """Call `see` with each of the runs that `draw_runs` returns, until it returns True."""

    @seed(0)
    @settings(max_examples=count, deadline=None, phases=[Phase.generate])
    @given(load_strategy(name).runs(steps))
    def draw(run: BlockRun) -> None:
        if see(run) is True:
            raise _Enough

    with suppress(_Enough):
        draw()


@cache
def draw_accepted_run(name: str, h: float, steps: int, *, states: int = 1, count: int = 20) -> BlockRun:
    """A run with steps of size h, none of which is refused.

    Of `count` random runs it is the one that shows most states, and of these the one with most observations. If it
    shows fewer than `states`, five times as many are drawn."""
    allows = {v.name: v.allows for v in Recipe(name).variables.values()}
    runs = [
        BlockRun(run.start, [(h, {n: x for n, x in values.items() if allows[n](x)}) for _, values in run.steps])
        for run in draw_runs(name, steps, count)
    ]
    observed = [_count_observations(name, run) for run in runs]
    if max(observed)[0] < states:
        assert count < 1000, f"no run of {name} without a refused step shows {states} states"
        return draw_accepted_run(name, h, steps, states=states, count=5 * count)
    return runs[observed.index(max(observed))]


def _count_observations(name: str, run: BlockRun) -> tuple[int, int]:
    """The number of states that a run shows, and of different observations; 0 and 0 if anything is refused."""
    stepper = Stepper(Recipe(name).block())
    watch = load_strategy(name).watch
    states: set[int] = set()
    observations: set[Any] = set()
    try:
        stepper.initialize(run.start)
        for h, values in run.steps:
            observations |= watch(stepper.step(h, values).block)
            states.add(stepper["state_code"])
    except RefusedError:
        return 0, 0
    return len(states), len(observations)
