"""Python and native code give the same bits: in this process, through both FMUs, and on every available platform.

tests/scenario/files/test_scenario_files.py compares both FMUs with this process in scenarios that have together all
that any has; tests/explorer/test_bits.py the native one in every scenario.
"""

from itertools import count
from pathlib import Path
from typing import Any

import fmpy
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync import var
from motionsync.blocks import BLOCKS
from motionsync_fmu.batch.library import library
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import LONGEST_STEP
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.blocks.drawn import drawn
from tests.support.blocks.random_runs import draw_runs, draw_until, load_strategy
from tests.support.blocks.runs import BlockRun
from tests.support.compiler.compiled import Compiled, equal
from tests.support.hosts.importers import bits
from tests.support.hosts.replay import TARGETS, orders, replayed, tried

WRAPPER = "Fatal py exception encountered"  # a line that PythonFMU itself adds to a refused initialization
# Long runs: a failing one is reported as generated, since shrinking it would take minutes.


class Pair:
    """A block in Python and in compiled code, driven as the FMU's slave drives it."""

    def __init__(self, name: str, start: dict[str, Any]) -> None:
        recipe = Recipe(name)
        self.stepper = Stepper(recipe.block())
        self.block = self.stepper.block
        self.inputs = {v.name: v for v in recipe.variables.values() if v.causality == "input"}
        self.compiled = Compiled(self.block)
        self.set(start)
        assert not any(v.refusal(self.stepper[v.name]) for v in self.inputs.values())
        assert self.compiled.initialize() == self.block.initialize()
        assert equal(self.block, self.compiled)
        self._begin = recipe.block(), self.compiled.memory.copy()
        var.copy(self._begin[0], self.block)

    def restart(self) -> None:
        """Go back to the initialized state."""
        var.copy(self.block, self._begin[0])
        self.compiled.memory[...] = self._begin[1]
        assert equal(self.block, self.compiled)

    def set(self, values: dict[str, Any]) -> None:
        self.stepper.set(values)
        for name, value in values.items():
            self.compiled.set(name, value)

    def step(self, h: float, values: dict[str, Any]) -> int | None:
        """The refusal of the block; None if an input or the step size is not allowed, so that there is no step."""
        allowed = (self.inputs[name].allows(value) for name, value in values.items() if name in self.inputs)
        if not 0.0 < h <= LONGEST_STEP or not all(allowed):
            return None
        self.set(values)
        before = self.compiled.memory.tobytes()
        refusal = self.block.step(h)
        assert self.compiled.step(h) == refusal
        assert equal(self.block, self.compiled), (h, values)
        assert refusal == 0 or self.compiled.memory.tobytes() == before, "a refused step changes the block"
        assert self.block.state_code == self.block.state
        return int(refusal)


@drawn(10, anew=True, shrink=False)
@given(data=st.data())
def test_compiled_code_gives_the_bits_of_python_in_every_field(block: str, data: st.DataObject) -> None:
    """Other runs each time; the test below compares at least 30 that are always the same."""
    strategy = load_strategy(block)
    library(BLOCKS[block])  # compiled before a run is drawn, which would be printed with each broken rule
    run = data.draw(strategy.runs(500))
    pair = Pair(block, run.start)
    for h, values in run.steps:
        if pair.step(h, values):
            pair.restart()


@pytest.mark.all_blocks
def test_every_block_has_random_runs() -> None:
    assert all(load_strategy(name).required_features for name in BLOCKS)


@pytest.mark.slow
def test_the_drawn_runs_meet_all_that_can_happen(block: str) -> None:
    """The random runs reach all features of their strategy, within a few runs. At least 30 are compared."""
    strategy, numbers = load_strategy(block), count(1)
    missing: set[Any] = {*strategy.required_features, "refused"}

    def compare(run: BlockRun) -> bool:
        pair = Pair(block, run.start)
        for h, values in run.steps:
            refusal = pair.step(h, values)
            if refusal != 0:
                missing.discard("refused")
            if refusal:
                pair.restart()
            missing.difference_update(strategy.watch(pair.block))
        return next(numbers) >= 30 and not missing

    draw_until(block, 500, 400, compare)
    assert not missing


def test_compiled_code_gives_the_bits_of_python_over_20_000_cycles_in_one_step() -> None:
    """Longer than any limit of cycles that a run can have; the random runs have at most 300 in a step."""
    for run in draw_runs("RemoteSync", 100, 2):
        pair = Pair("RemoteSync", run.start)
        for h, values in run.steps:
            if pair.step(h, values):
                pair.restart()
        assert pair.step(20_000 * run.start["task_cycle_time"], {}) == 0


@drawn(6, anew=True, shrink=False)
@given(data=st.data())
def test_both_fmus_give_the_same_bits_and_log_the_same(
    block: str, block_fmu: Path, block_native: Path, data: st.DataObject
) -> None:
    run = data.draw(load_strategy(block).runs(500))
    with FmuInstance(block_fmu) as a, FmuInstance(block_native) as b:
        refused = tried(a.initialize, run.start)
        assert tried(b.initialize, run.start) == refused
        for h, values in [] if refused else run.steps:
            assert tried(b.step, h, values) == tried(a.step, h, values)
            assert bits(b.get()) == bits(a.get())
        assert b.messages == [text for text in a.messages if not text.startswith(WRAPPER)]


# --- a host in C, without any Python ---


@pytest.fixture(scope="module")
def expected(block: str, block_fmu: Path) -> list[tuple[str, str]]:
    """A few runs through the python flavour."""
    commands: list[tuple[str, str]] = []
    for run in draw_runs(block, 300, 6):
        with FmuInstance(block_fmu) as host:
            commands.extend(orders(host, run))
    return commands


@pytest.mark.parametrize("target", TARGETS)
def test_a_host_in_c_without_python_gets_the_same_bits(
    target: str, block: str, block_native: Path, expected: list[tuple[str, str]], tmp_path: Path
) -> None:
    folder = Path(fmpy.extract(str(block_native), unzipdir=str(tmp_path / "fmu")))
    answers = replayed(target, folder, [order for order, _ in expected], tmp_path)
    for (order, answer), result in zip(expected, answers, strict=True):
        assert result == answer, order
