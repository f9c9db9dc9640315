"""Random runs of the RemoteSync, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Fault
from motionsync.remote_sync.interface import Estimator, Mode
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy

INDICES = (0, 1, -1, 32768, 65535, 65536, 2**31 - 1, -(2**31))
TUNABLE = ("delay_time_offset", "max_position_difference")
RARE = ((0.0, 0.0, 0.02), (0.0, 0.005, 0.05), (0.0, 0.0, 0.01, 0.05), (0.0, 0.0, 0.01, 0.2))
WHOLE = {  # limits that are short, so that a few hundred cycles meet beats
    "end_of_transition_limit": (1, 3, 10),
    "new_drift_blending_cycles": (1, 5, 20),
    "time_mode_blending_cycles": (1, 5, 20),
    "periods_for_mean_drift": (1, 1, 2, 64),
    "max_cycle_index_difference": (7, 3, 0),
}


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    """A sender whose drift brings a beat each ten to hundred cycles; the axis mostly moves evenly."""
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-6, 1e6)))  # of the axis' way in a cycle
    cycle = draw(st.one_of(st.sampled_from((0.002, 2.0**-7)), st.floats(1e-4, 1e-1)))
    ratio = draw(st.sampled_from((1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 0.5)))  # of the data cycle to the task cycle
    phase = ratio == 1.0 and draw(st.booleans())
    start = {name: draw(st.sampled_from(choice)) for name, choice in WHOLE.items()} | {
        "enable": draw(st.sampled_from((True, True, True, True, True, False))),
        "task_cycle_time": cycle,
        "data_cycle_time": ratio * cycle if ratio != 1.0 else draw(st.sampled_from((0.0, cycle))),
        "estimator": 2 if phase else 1,
        "threshold_for_sync": draw(st.sampled_from((0.3, 0.05, 2.0))),
        "age_of_data_limit": draw(st.sampled_from((7, 3, 0))),
        "slope1_numerator": draw(st.sampled_from((0.95, 0.5, 1.0))),
        "slope1_denominator": draw(st.sampled_from((0.5, 0.5, 0.9))),
        "start_up_mode": draw(st.sampled_from((1, 2, 4, 4))),
        "fall_back_mode": draw(st.sampled_from((1, 2))),
        "max_position_difference": length * draw(st.sampled_from((0.0, 0.0, 0.0, 0.6, 3.0))),
        "pt1_factor_position": draw(st.sampled_from((3.0, 1e-3, 100.0))),
        "pt1_factor_velocity": draw(st.sampled_from((3.0, 0.5))),
        "blending_time": cycle * draw(st.sampled_from((0.0, 5.0, 30.0))),
        "delay_time_offset": cycle * draw(st.sampled_from((0.0, 1.0, -2.5))),
        "remote.cycle_index": draw(st.sampled_from((0, 1, 65500, 65535))),
    }
    start |= {name: draw(st.booleans()) for name in ("use_acceleration", "automatic_reinit")}
    start["force_time_mode"] = draw(st.sampled_from((False, False, False, True)))
    drift = draw(st.sampled_from((0.02, 0.05, 0.03, 0.01, 0.0))) * draw(st.sampled_from((1.0, -1.0)))
    chances = [draw(st.sampled_from(choice)) for choice in RARE]
    jitter = draw(st.sampled_from((0.0, 0.003, 0.03)))
    random = Random(draw(st.integers(0, 2**32 - 1)))
    return BlockRun(start, list(_steps(random, start, steps, length, ratio, drift, jitter, *chances)))


def _steps(
    r: Random,
    start: dict[str, Any],
    steps: int,
    length: float,
    ratio: float,
    drift: float,
    jitter: float,
    extreme: float,
    commands: float,
    losses: float,
    odd: float,
) -> Iterator[tuple[float, dict[str, Any]]]:
    """Telegrams of a clock that goes wrong now and then; the last four are probabilities a step."""
    cycle = start["task_cycle_time"]
    time, index, lost = r.random(), 0, 0  # of the sender, in its cycles; its last telegram; how many are yet lost
    acceleration = r.choice((0.0, 0.0, 0.01)) * length / cycle**2
    for _ in range(steps):
        if lost == 0:
            index = max(math.floor(time + r.gauss(0.0, jitter)), index)
        lost = r.choice((1, 6, 7, 10, 30)) if r.random() < losses else max(lost - 1, 0)
        sent = index * ratio * cycle
        values: dict[str, Any] = {
            "remote.cycle_index": (start["remote.cycle_index"] + index) % 65536,
            "remote.position": length / cycle * sent + 0.5 * acceleration * sent**2,
            "remote.velocity": length / cycle + acceleration * sent,
            "remote.acceleration": acceleration,
        }
        values |= dict(_commands(r, start, length, extreme, commands))
        h = cycle * (r.choice((0.3, 0.5, 2.5, 1e-9, r.uniform(0.0, 4.0))) if r.random() < odd else 1.0)
        time += h / cycle * (1.0 + drift) / ratio
        if r.random() < extreme:  # many cycles: more than any limit that is drawn, and few enough for Python
            h = r.choice((0.0, -h, math.nan, math.inf, 300.0 * cycle, 1.5e6 * cycle, 1.1e6, 5e-324))
        yield h, values
        if r.random() < 0.003:
            drift = r.choice((-drift, 0.5 * drift, 0.0))
        if r.random() < losses:
            index += r.choice((2, 7, 9, 1000))
            time = max(time, float(index))


def _commands(
    r: Random, start: dict[str, Any], length: float, extreme: float, commands: float
) -> Iterator[tuple[str, Any]]:
    """New starts, and tunables that mostly stay within their limits."""
    if r.random() < commands:
        yield "enable", r.random() < 0.8
    if r.random() < commands:
        name = r.choice(TUNABLE)
        scale = start["task_cycle_time"] if name == "delay_time_offset" else length
        yield name, scale * r.choice((0.0, 0.6, 1.0, 3.0)) if r.random() < 0.9 else r.choice((*EXTREMES, -length))
    if r.random() < commands:
        yield from ((name, start[name]) for name in TUNABLE)
    if r.random() < extreme:
        yield "remote.cycle_index", r.choice(INDICES)
    if r.random() < extreme:
        yield f"remote.{r.choice(('position', 'velocity', 'acceleration'))}", r.choice(EXTREMES)


def watch(block: RemoteSync) -> set[Any]:
    """What is worth meeting of the block's present state."""
    return {
        ("state", block.state),
        ("fault", block.error_id),
        ("estimator", block.estimator, block.synced),
        ("warning", block.warning),
        ("transition", block.estimator, block.local.transition),
        ("blending", block.blending.mode, block.blending.cycles > 0),
    }


def check(block: RemoteSync) -> None:
    assert block.start_up + block.synced + block.error + (not block.enable) == 1
    expected = Mode.SYNC if block.synced else block.fall_back_mode if block.error else block.start_up_mode
    assert block.state == (expected if block.enable else Mode.BYPASS)


STRATEGY = Strategy(
    runs,
    watch,
    frozenset(
        {
            *(("state", mode) for mode in Mode),
            *(("fault", fault) for fault in Fault),
            *(("estimator", kind, synced) for kind in Estimator for synced in (False, True)),
            *(("warning", warning) for warning in (False, True)),
            *(("transition", kind, zone) for kind in Estimator for zone in (False, True)),
            *(("blending", mode, True) for mode in Mode),
        }
    ),
    check,
)
