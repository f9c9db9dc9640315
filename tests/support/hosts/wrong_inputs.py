"""Random runs whose master has wrong inputs at first: each block with a master reports each thing that can be wrong."""

import math
from collections.abc import Iterator
from dataclasses import replace
from statistics import median
from typing import Any

from hypothesis import strategies as st

from motionsync.input_watch import InputWarning
from motionsync.master import MasterInput
from tests.support.blocks.runs import BlockRun, Strategy

STEPS = 200  # of a run are wrong, if it has more than twice as many


def with_wrong_inputs(strategy: Strategy) -> Strategy:
    """The strategy of a block with a master; a third of its longer runs begins with wrong inputs."""
    wrong = [warning for warning in InputWarning if warning != InputWarning.NONE]
    kinds = st.sampled_from([InputWarning.NONE] * 2 * len(wrong) + wrong)

    def watch(block: Any) -> set[Any]:
        return strategy.watch(block) | {("input warning", block.master.input_warning)}

    return replace(
        strategy,
        runs=lambda steps: st.builds(_spoiled, strategy.runs(steps), kinds),
        watch=watch,
        required_features=strategy.required_features | {("input warning", warning) for warning in InputWarning},
    )


def _spoiled(run: BlockRun, kind: InputWarning) -> BlockRun:
    if kind == InputWarning.NONE or len(run.steps) <= 2 * STEPS:
        return run
    steps = [(h, {**values, **wrong}) for (_, values), (h, wrong) in zip(run.steps, _line(run, kind), strict=False)]
    mode = run.start["master.input_mode"]
    if kind != InputWarning.JUMP and mode > MasterInput.END_OF_STEP:
        mode = MasterInput.START_OF_STEP  # it sees all of them
    start = {**run.start, "master.period": 0.0, "master.input_mode": int(mode)}
    return BlockRun(start, steps + run.steps[STEPS:])


def _line(run: BlockRun, kind: InputWarning) -> Iterator[tuple[float, dict[str, float]]]:
    """STEPS step sizes and inputs: a line of constant velocity, as fast as the run's, of which one thing is wrong."""
    h = median(h for h, _ in run.steps if 0.0 < h < 1e3)
    speeds = [abs(values.get("master.velocity", 0.0)) for _, values in run.steps]
    velocity = median([v for v in speeds if 0.0 < v < 1e9] or [1.0])
    first, change = run.start["master.position"], velocity * h
    for n in range(STEPS):
        travel, shown = change * n, velocity
        match kind:
            case InputWarning.COUNTS:
                travel = math.floor(n / 0.3) * 0.3 * change
            case InputWarning.JUMP:
                travel -= 20.0 * change * (n >= 60)
            case InputWarning.VELOCITY:
                shown = velocity / 60.0
            case InputWarning.FROZEN:
                travel = change * min(n, 40)
        yield h, {"master.position": first + travel, "master.velocity": shown, "master.acceleration": 0.0}
