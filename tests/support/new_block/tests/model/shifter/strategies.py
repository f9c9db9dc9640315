"""Random runs of the Shifter."""

from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.shifter.block import Shifter
from motionsync.shifter.faults import Fault
from motionsync.shifter.interface import State
from motionsync_fmu.interface.roles import MOTION
from tests.support.blocks.masters import INPUT_MODES
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    """A master that moves with changing velocity, and offsets of which some are too great."""
    r = Random(draw(st.integers(0, 2**32 - 1)))
    period = draw(st.sampled_from((0.0, 360.0)))
    start: dict[str, Any] = {"master.period": period, **draw(INPUT_MODES)}
    start |= {f"master.{name}": draw(st.floats(-1e3, 1e3)) for name in MOTION}
    position = start["master.position"]
    run_steps: list[tuple[float, dict[str, Any]]] = []
    for _ in range(steps):
        h, velocity = r.uniform(1e-3, 0.1), r.gauss(0.0, 100.0)
        values = {"master.position": position, "master.velocity": velocity, "apply": r.random() < 0.5}
        values["offset"] = r.choice((0.0, r.uniform(-150.0, 150.0)))
        if r.random() < 0.02:
            values["master.velocity"] = r.choice(EXTREMES)
        run_steps.append((h, values))
        position += velocity * h
    return BlockRun(start, run_steps)


def watch(block: Shifter) -> set[Any]:
    """What is worth meeting of the block's present state."""
    return {("state", block.state), ("fault", block.error_id)}


STRATEGY = Strategy(
    runs, watch, frozenset({*(("state", state) for state in State), *(("fault", fault) for fault in Fault)})
)
