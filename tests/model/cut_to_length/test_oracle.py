"""CutToLength on random machines, lines and commands is its oracle: all outputs, to 1e-9 of the machine's size."""

from random import Random

import pytest

from motionsync.master import MasterInput
from tests.model.cut_to_length.scripted_runs import NOT_COMPARED, find_differences, random_script, simulate
from tests.oracle.cut_to_length import reference

SHOWN = [name for name in reference(random_script(Random(0), 1.0, None), [0.5])[-1] if name not in NOT_COMPARED]
DURATION = 5.0
START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP


@pytest.mark.parametrize(("step", "stride", "runs"), [(0.007, 3, 24), (0.0471, 3, 24), (0.001, 25, 3)])
def test_the_block_is_its_oracle(step: float, stride: int, runs: int) -> None:
    for seed in range(runs):
        script = random_script(Random(seed), DURATION, step)
        ends = [i * step for i in range(int(script["stop_time"] / step) + 1)]
        assert find_differences(script, simulate(script, ends, SHOWN, START, stride)) == [], seed


@pytest.mark.parametrize("mode", [START, END])
def test_the_block_is_its_oracle_at_random_steps(mode: MasterInput) -> None:
    for seed in range(10, 22):
        r = Random(seed)
        script = random_script(r, DURATION, None, jumps=mode == START)
        ends = [r.uniform(0.0, script["stop_time"]) for _ in range(r.choice([20, 100, 400]))]
        assert find_differences(script, simulate(script, ends, SHOWN, mode, stride=3)) == [], seed
