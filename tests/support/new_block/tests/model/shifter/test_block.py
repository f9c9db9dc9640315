"""The Shifter, with numbers by hand and against its oracle."""

from hypothesis import given
from hypothesis import strategies as st

from motionsync.shifter.block import Shifter
from motionsync.shifter.faults import Fault, Refusal
from tests.oracle.shifter import slave_position


def shifted(position: float, offset: float, period: float = 0.0) -> Shifter:
    """A Shifter that has been given an offset with its master at rest there."""
    block = Shifter()
    block.master.position, block.master.period, block.offset = position, period, offset
    assert block.initialize() == Refusal.NONE
    block.apply = True
    assert block.step(0.01) == Refusal.NONE
    return block


def test_an_offset_that_is_too_great_is_refused_and_moves_nothing() -> None:
    block = shifted(10.0, 100.5)
    assert (block.slave.position, block.error, block.error_id) == (10.0, True, Fault.OFFSET)


def test_limits_in_the_wrong_order_are_refused() -> None:
    assert Shifter(least_offset=1.0, greatest_offset=0.0).initialize() == Refusal.RANGE


@given(st.floats(0.0, 359.0), st.floats(-100.0, 100.0), st.sampled_from((0.0, 360.0)))
def test_the_slave_is_where_the_oracle_says(position: float, offset: float, period: float) -> None:
    slave = shifted(position, offset, period).slave.position
    assert abs(slave - slave_position(position, offset, period)) % (period or 1e9) < 1e-9
