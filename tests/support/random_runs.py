"""Random runs of any registered block, drawn by the strategy in `tests/model/<block>/strategies.py`."""

from functools import cache
from typing import Any

from hypothesis import Phase, given, settings

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import RefusedError, Stepper
from tests.support.by_block import own
from tests.support.runs import Run, Strategy


def strategy(name: str) -> Strategy:
    """The strategy of the block of that name.

    Raises:
        LookupError: the block has none.
    """
    found: Strategy = own(name, "strategies").STRATEGY
    return found


def drawn(name: str, steps: int, count: int) -> list[Run]:
    """`count` random runs of `steps` steps, the same at every call."""
    found: list[Run] = []

    @settings(max_examples=count, derandomize=True, database=None, deadline=None, phases=[Phase.generate])
    @given(strategy(name).runs(steps))
    def draw(run: Run) -> None:
        found.append(run)

    draw()
    return found


@cache
def calm(name: str, h: float, steps: int, *, states: int = 1, count: int = 20) -> Run:
    """A run with steps of size h, none of which is refused: of `count` drawn runs, the one that shows most
    states, and of these the one that meets most. If it shows fewer than `states`, five times as many are drawn."""
    allows = {v.name: v.allows for v in Recipe(name).variables.values()}
    runs = [
        Run(run.start, [(h, {n: x for n, x in values.items() if allows[n](x)}) for _, values in run.steps])
        for run in drawn(name, steps, count)
    ]
    met = [_met(name, run) for run in runs]
    if max(met)[0] < states:
        assert count < 1000, f"no run of {name} without a refused step shows {states} states"
        return calm(name, h, steps, states=states, count=5 * count)
    return runs[met.index(max(met))]


def _met(name: str, run: Run) -> tuple[int, int]:
    """How many states a run shows, and how many different things it meets; 0 and 0 if anything is refused."""
    stepper = Stepper(Recipe(name).block())
    watch = strategy(name).watch
    states: set[int] = set()
    seen: set[Any] = set()
    try:
        stepper.initialize(run.start)
        for h, values in run.steps:
            seen |= watch(stepper.step(h, values).block)
            states.add(stepper["state_code"])
    except RefusedError:
        return 0, 0
    return len(states), len(seen)
