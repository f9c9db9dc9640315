"""Codes in plain Integers: each one that a block can show has a text, and the log has it where the block reports it."""

from math import inf
from typing import Any

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import members, refusals, variables
from motionsync_fmu.python.slave import BlockSlave
from tests.support.blocks.random_runs import draw_runs


def slave_of(block: str) -> Any:
    """The python flavour of a block, in this process; its `texts` are what it has logged."""

    class Slave(BlockSlave):
        block_type = BLOCKS[block]
        build = "0"
        starts: dict[str, Any] = {}  # noqa: RUF012

        def log_message(self, text: str, _status: Any) -> None:
            texts.append(text)

    texts: list[str] = []
    slave = Slave(instance_name=block)
    slave.texts = texts
    return slave


def test_each_code_has_a_text_of_its_own_which_reaches_the_log(block: str) -> None:
    for carrier in (v for v in variables(BLOCKS[block]()) if v.declaration.codes):
        codes = [code for code in members(carrier.declaration.codes) if code != 0]
        assert len({code.description for code in codes}) == len({int(code) for code in codes}) == len(codes)
        for code in codes:
            slave = slave_of(block)
            slave.by_name[carrier.name].cell.set(int(code))
            slave.log_codes((0,) * len(slave.codes), slave.read_codes(slave.block), 1.0)
            slave.end_episodes(inf)
            assert [code.description in text for text in slave.texts] == [True], (carrier.name, code)


def test_each_refusal_has_a_text(block: str) -> None:
    assert all(refusal.description for refusal in refusals(BLOCKS[block]))


def test_a_random_run_shows_no_code_without_a_text(block: str) -> None:
    coded = {
        v.name: {int(code) for code in members(v.declaration.codes)}
        for v in Recipe(block).variables.values()
        if v.declaration.codes
    }
    for run in draw_runs(block, 300, 25):
        stepper = Stepper(Recipe(block).block())
        inputs = [v for v in Recipe(block).variables.values() if v.checked]
        stepper.initialize(run.start)
        for h, values in run.steps:
            before = stepper.get(values)
            stepper.set(values)
            if not 0.0 < h <= 1e6 or not all(v.allows(stepper[v.name]) for v in inputs) or stepper.block.step(h) != 0:
                stepper.set(before)
                continue
            for name, numbers in coded.items():
                assert stepper[name] in numbers | {0}, name
