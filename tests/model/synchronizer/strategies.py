"""Random runs of the Synchronizer, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.faults import Fault
from motionsync.synchronizer.interface import Curve, State
from tests.support.blocks.masters import INPUT_MODES
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-9, 1e9)))
    periods = st.one_of(st.just(0.0), st.floats(0.5, 20.0).map(lambda x: max(x * length, 1e-9)), st.floats(1e-9, 1e4))
    start = {
        **draw(INPUT_MODES),
        "master.period": draw(periods),
        "master.position": length * draw(st.floats(-3.0, 3.0)),
        "master.velocity": draw(st.floats(-1e3, 1e3)),
        "master.acceleration": draw(st.floats(-1e3, 1e3)),
        "curve": draw(st.sampled_from((1, 2))),
        "output_phasing": length * draw(st.sampled_from((1.0, -1.0))),
        "rest_value": length * draw(st.floats(-3.0, 3.0)),
        "active": draw(st.booleans()),
        "start": draw(st.booleans()),
        "stop": draw(st.booleans()),
    }
    speed = length * draw(st.sampled_from((0.1, 1.0, 10.0)))
    extreme = draw(st.sampled_from((0.0, 0.0, 0.02)))
    commands = draw(st.sampled_from((0.01, 0.1, 0.4)))
    return BlockRun(
        start, list(_steps(Random(draw(st.integers(0, 2**32 - 1))), start, steps, speed, extreme, commands))
    )


def _steps(
    r: Random, start: dict[str, Any], steps: int, speed: float, extreme: float, commands: float
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A master that wanders, wrapped or not, and commands; `extreme` and `commands` are probabilities a step."""
    position, velocity, upset = start["master.position"], start["master.velocity"], False
    for _ in range(steps):
        h = 10.0 ** r.uniform(-3.0, 0.0) if r.random() < 0.9 else 10.0 ** r.uniform(-15.0, 5.0)
        acceleration = r.choice((0.0, r.gauss(0.0, speed)))
        values: dict[str, Any] = {
            "master.position": position if r.random() < 0.7 else position % (start["master.period"] or 1e9),
            "master.velocity": velocity,
            "master.acceleration": acceleration,
        }
        position += velocity * h
        if abs(position) > 1e11:
            position = 0.0
        velocity = r.choice((velocity, r.gauss(0.0, speed)))
        for name, likely in (("start", 0.5), ("stop", 0.5), ("active", 0.8)):
            if r.random() < commands:
                values[name] = r.random() < likely
        if r.random() < commands:
            values["output_phasing"] = r.gauss(0.0, speed) if r.random() < 0.9 else r.choice((0.0, math.nan, 2e12))
        if upset or r.random() < commands:
            values["rest_value"] = position + r.gauss(0.0, speed)
        upset = r.random() < extreme  # the master is set anew in every step, the rest value after this
        if upset:
            name = r.choice(("master.position", "master.velocity", "master.acceleration", "rest_value"))
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            h = r.choice((0.0, -h, math.nan, math.inf, 1e6, 1.1e6, 5e-324))
        yield h, values


def watch(block: Synchronizer) -> set[Any]:
    """What is worth meeting of the block's present state."""
    return {
        ("state", block.state),
        ("ramping", block.master.input_mode, block.syn_ramp_on),
        ("fault", block.error_id),
        ("curve", block.transition.curve),
    }


def check(block: Synchronizer) -> None:
    period, local = block.master.period, block.local
    assert period == 0.0 or 0.0 <= block.slave.position < period
    assert 0.0 <= local.progress <= 1.0
    assert min(local.distance_to_begin, local.distance_to_end) >= 0.0
    assert block.ready == (block.state == State.READY)
    assert block.status == block.syn_synchronized + 2 * block.syn_ramp_on


STRATEGY = Strategy(
    runs,
    watch,
    frozenset(
        {
            *(("state", state) for state in State),
            *(("ramping", mode, on) for mode in MasterInput for on in (False, True)),
            *(("fault", fault) for fault in Fault),
            *(("curve", curve) for curve in Curve),
        }
    ),
    check,
)
