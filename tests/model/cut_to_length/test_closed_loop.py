"""A line that follows line.velocity_request with a lag of first order, and the machine that cuts its material.

At each scan, 0.01 s, the line takes the request u; until the next one it has the constant acceleration
(u - v)(1 - exp(-0.01/T))/0.01, so that at the scans it has the velocities of a lag with the time constant T.
"""

import math
from dataclasses import dataclass
from typing import Any

from hypothesis import example, given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from tests.model.cut_to_length.harness import REFERENCE, CutToLengthHarness
from tests.support.blocks.drawn import drawn

SCAN = 0.01  # s
LAG = 0.3  # s, the time constant of the line
# The reference machine with the usual reserve; it cuts orders alone.
MACHINE: dict[str, Any] = {**REFERENCE, "approach.reserve": 0.02, "length": 0.0}
LENGTHS = st.lists(st.floats(300.0, 3000.0), min_size=2, max_size=7)
# After a long piece a middling one, and a short one that has to be made by a line that is still slowing down.
STEEP = [1063.0, 717.0, 317.0, 2950.0]


@dataclass(frozen=True)
class Production:
    """What was made of the orders: cuts, accepted pieces, missed cuts; excused ones were missed after the line had been
    too fast since the carriage last left home."""

    cuts: int
    accepted: int
    missed: int
    excused: int
    error: float


def produce(
    lengths: list[float], values: dict[str, Any], *, lag: float = LAG, speed: float = 0.0, mode: MasterInput
) -> Production:
    """Cut all orders, each one piece, from a line that has this speed at first."""
    saw = CutToLengthHarness({**MACHINE, **values}, mode=mode)
    for length in lengths:
        saw.order(length).now().now()
    saw.speed = speed
    saw.give("start").now()
    fast, last_start, missed, excused = False, 0.0, 0, 0
    while saw["order.completed"] < len(lengths):
        assert saw.time < 20.0 * len(lengths)
        requested = saw["line.velocity_request"]
        saw.run(SCAN, acceleration=(requested - saw.speed) * (1.0 - math.exp(-SCAN / lag)) / SCAN)
        more = saw["statistics.skipped"] - missed
        missed, excused = missed + more, excused + more * fast
        if saw["local.start_time"] > last_start:
            last_start, fast = saw["local.start_time"], False
        fast = fast or saw["warning.line_too_fast"]
    accepted, error = saw["statistics.pieces_good"], saw["statistics.error_worst"]
    return Production(saw["statistics.cuts"], accepted, missed, excused, error)


@given(LENGTHS, st.sampled_from([MasterInput.START_OF_STEP, MasterInput.END_OF_STEP]))
@drawn(15, anew=True)
@example(STEEP, MasterInput.START_OF_STEP)
def test_no_cut_is_missed_by_a_line_that_follows_the_request(lengths: list[float], mode: MasterInput) -> None:
    """Whatever is ordered. The line is asked to stay 5 % below its limit; why the usual 2 % are not enough for a lag of
    0.3 s is explained below."""
    production = produce(lengths, {"line.margin": 0.05}, mode=mode)
    assert (production.cuts, production.accepted, production.missed) == (len(lengths), len(lengths), 0)
    assert production.error <= 1e-9


@given(LENGTHS, st.floats(0.05, 0.2), st.sampled_from([MasterInput.START_OF_STEP, MasterInput.END_OF_STEP]))
@drawn(15, anew=True)
@example(STEEP, 0.2, MasterInput.START_OF_STEP)
def test_the_usual_margin_is_enough_for_a_line_that_follows_soon(
    lengths: list[float], lag: float, mode: MasterInput
) -> None:
    production = produce(lengths, {}, lag=lag, mode=mode)
    assert (production.cuts, production.accepted, production.missed) == (len(lengths), len(lengths), 0)
    assert production.error <= 1e-9


@given(LENGTHS, st.floats(0.1, 2.0), st.floats(0.0, 1400.0), st.sampled_from([0.0, 0.02]))
@drawn(15, anew=True)
@example(STEEP, LAG, 0.0, 0.02)
@example([300.0, 3000.0, 300.0], 2.0, 1400.0, 0.0)
def test_a_cut_is_missed_only_if_the_line_was_above_its_limit(
    lengths: list[float], lag: float, speed: float, reserve: float
) -> None:
    """However slowly the line follows, and however fast it runs at first: that the line is too fast was reported in
    the cycle before the cut, from the start of the carriage on. All orders are made in the end."""
    production = produce(lengths, {"approach.reserve": reserve}, lag=lag, speed=speed, mode=MasterInput.START_OF_STEP)
    assert production.accepted == len(lengths)
    assert production.missed == production.excused


def test_a_steep_descent_of_lengths_needs_more_than_the_usual_margin() -> None:
    """The request falls from 781 to 432, for a limit of 441, when 717 starts, and 717 takes 1.15 s: exp(-1.15/0.3) of
    the difference are left then, 7.5 mm/s, less than the margin of 9. But the saw has just gone along with a line that
    was faster than its limit, and is too far from home for 317."""
    usual, wider = (produce(STEEP, {"line.margin": m}, mode=MasterInput.START_OF_STEP) for m in (0.02, 0.03))
    assert (usual.missed, usual.accepted, usual.cuts) == (1, 4, 5)
    assert (wider.missed, wider.accepted, wider.cuts) == (0, 4, 4)
