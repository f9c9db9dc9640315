"""Random runs of each block, whatever their inputs: all numbers are finite, and what a block shows belongs together."""

from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from tests.support.blocks.drawn import drawn
from tests.support.blocks.finite import run_finite
from tests.support.blocks.random_runs import load_strategy


@drawn(25)
@given(data=st.data())
def test_all_numbers_are_finite_and_belong_together(block: str, data: st.DataObject) -> None:
    strategy = load_strategy(block)
    for it in run_finite(BLOCKS[block](), data.draw(strategy.runs(300)), strategy.requests):
        assert it.state_code == it.state
        assert it.error == (it.error_id != 0)
        strategy.check(it)
