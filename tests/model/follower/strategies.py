"""Random runs of the Follower, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.follower.block import Follower
from motionsync.follower.faults import DropReason, Fault
from motionsync.follower.interface import State
from motionsync.follower.stages import Stage
from motionsync.master import MasterInput
from tests.support.blocks.masters import INPUT_MODES
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy

EDGES = ("position_to_park", "position_to_cycle", "end_synchronism", "reset")
MOTION = ("master.position", "master.velocity", "master.acceleration")
LONG = (1e3, 3e6)  # cycles: a step of so many takes Python seconds to minutes; from 1e6 on it is refused
LEVELS = ("skip_next_cycle", "stop_after_forward", "sync_assumed")
TUNABLE = {  # what a machine changes while it runs, as a factor of its start value
    **dict.fromkeys(("master_cycle", "space_stop_slave", "k_slave_master"), (0.9, 1.1)),
    **dict.fromkeys(("park_slave", "sync_slave", "sync_out", "space_wait_in_park"), (0.97, 1.03)),
    **dict.fromkeys(("max_speed", "max_acceleration"), (0.7, 1.5)),
    **{f"positioning.{name}": (0.5, 2.0) for name in ("velocity", "acceleration", "jerk")},
}


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    """Start values for which the master's travel suffices; the master mostly moves forwards."""
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-3, 1e6)))  # of the slave's ways
    ratio = draw(st.one_of(st.sampled_from((1.0, 0.5)), st.floats(1e-2, 1e2)))
    ways = [length * draw(st.floats(0.2, 2.0)) for _ in range(4)]  # to sync, to out, to stop, and on to the park
    cyclic, variable = draw(st.booleans()), draw(st.booleans())
    park = length * draw(st.sampled_from((0.0, 0.0, -1.5, 3.0)))
    least = (2.0 * ways[0] + ways[1] + 2.0 * ways[2]) / ratio
    cycle = least * draw(st.floats(0.5, 2.5) if cyclic else st.floats(1.01, 2.5))
    cycle = max(cycle, 1.01 * ways[1] / ratio)
    remaining = cycle - (ways[1] / ratio if cyclic else least)
    start = {
        **draw(INPUT_MODES),
        "master.period": cycle * draw(st.sampled_from((0.0, 0.0, 1.0, 3.0, 0.7))),
        "master.position": cycle * draw(st.floats(-2.0, 2.0)),
        "master.velocity": cycle * draw(st.sampled_from((0.0, 0.3, 1.0))),
        "master.acceleration": cycle * draw(st.sampled_from((0.0, 0.0, 1.0))),
        "master_cycle": cycle,
        "variable_cycle": variable,
        "sync_master": cycle * draw(st.floats(-1.0, 3.0)),
        "slave_cycle": sum(ways) if cyclic else 0.0,
        "park_slave": park,
        "sync_slave": park + ways[0],
        "sync_out": park + ways[0] + ways[1],
        "space_stop_slave": ways[2],
        "space_wait_in_park": remaining * draw(st.sampled_from((0.0, 0.1, 0.5))),
        "k_slave_master": ratio,
        "max_speed": length * draw(st.sampled_from((0.0, 5.0, 100.0))),
        "max_acceleration": length * draw(st.sampled_from((0.0, 100.0, 1000.0))),
        "slave.initial_position": draw(st.sampled_from((park, 0.0, 2.7 * length))),
        **dict(zip((f"positioning.{n}" for n in ("velocity", "acceleration", "jerk")), _limits(length), strict=True)),
    }
    names = ("align_center", "stop_in_park", "recover_late_sync", "check_speed", "check_acceleration")
    start |= {name: draw(st.booleans()) for name in (*names, *EDGES, *LEVELS)}
    if cyclic and variable and draw(st.booleans()):
        start |= {"stop_in_park": False, "recover_late_sync": True}
    chances = [draw(st.sampled_from(choice)) for choice in ((0.0, 0.0, 0.02), (0.01, 0.05, 0.2), (0.0, 0.0, 0.02))]
    return BlockRun(start, list(_steps(Random(draw(st.integers(0, 2**32 - 1))), start, steps, *chances)))


def _limits(length: float) -> tuple[float, float, float]:
    return 20.0 * length, 400.0 * length, 8000.0 * length


def _steps(
    r: Random, start: dict[str, Any], steps: int, extreme: float, commands: float, back: float
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A master that moves and rests, wrapped or not, and commands; the last three are probabilities a step."""
    position, velocity, period = start["master.position"], start["master.velocity"], start["master.period"]
    cycle = start["master_cycle"]
    first = r.choice(("position_to_park", "position_to_park", "position_to_cycle"))
    speed = velocity
    last: dict[str, Any] = {name: start[name] for name in MOTION[:2]}
    for i in range(steps):
        h = 10.0 ** r.uniform(-2.5, -0.5) if r.random() < 0.97 else 10.0 ** r.uniform(-15.0, 1.5)
        if r.random() < 0.05:
            speed = cycle * r.choice((0.0, 0.3, 1.0, r.uniform(0.0, 3.0)))
        if first == "position_to_cycle" and i < 12:
            speed = 0.0
        acceleration = (speed - velocity) / h if h > 1e-6 else 0.0
        at_end = start["master.input_mode"] == 2
        before, position = position, position + (velocity + 0.5 * acceleration * h) * h
        shown = position if at_end else before
        values: dict[str, Any] = {
            "master.position": shown if r.random() < 0.7 or not period else shown % period,
            "master.velocity": velocity + acceleration * h if at_end else velocity,
            "master.acceleration": acceleration,
        }
        velocity += acceleration * h
        values |= {name: i == 5 and name == first for name in EDGES}
        calm, ordinary = values | dict(_commands(r, start, before, commands)), h
        values = calm | dict(_extremes(r, extreme))
        if r.random() < extreme:
            h = r.choice((0.0, -h, math.nan, math.inf, 1e3, 1e6, 1.1e6, 5e-324))
        way = _way(last, values, h)
        if LONG[0] * cycle < way < LONG[1] * cycle:
            h, values = ordinary, calm
        elif way <= LONG[0] * cycle:
            last = values
        yield h, values
        if r.random() < back:
            position -= r.choice((1e-11, 1e-6, 1.3)) * cycle
        if abs(position) > 1e4 * cycle:
            position = 0.0


def _commands(r: Random, start: dict[str, Any], position: float, commands: float) -> Iterator[tuple[str, Any]]:
    """Edges, levels, values of sync_master, mostly in time, and changes of parameters, mostly small ones."""
    cycle, variable = start["master_cycle"], start["variable_cycle"]
    yield from ((name, r.random() < 0.2) for name in LEVELS if r.random() < 0.1)
    if r.random() < commands:
        yield r.choice(EDGES), True
    if r.random() < max(commands, 0.1 * variable):
        lead = r.choice((1.0, 1.2, 2.0, r.uniform(0.0, 2.5)))
        yield "sync_master", position + lead * cycle if variable else r.gauss(0.0, 0.1 * cycle)
    if r.random() < commands:
        name = r.choice(tuple(TUNABLE))
        yield name, start[name] * r.uniform(*TUNABLE[name]) if r.random() < 0.95 else r.choice(EXTREMES)
        if r.random() < 0.5:
            yield name, start[name]


def _extremes(r: Random, extreme: float) -> Iterator[tuple[str, Any]]:
    if r.random() < extreme:
        yield r.choice((*MOTION, "sync_master")), r.choice(EXTREMES)


def _way(last: dict[str, Any], values: dict[str, Any], h: float) -> float:
    """No less than what the master travels in a step and before it."""
    before, now = (last[name] for name in MOTION[:2]), (values[name] for name in MOTION)
    (p0, v0), (p, v, a) = before, now
    return float(abs(p - p0) + (abs(v0) + abs(v) + abs(a) * abs(h)) * abs(h))


def watch(block: Follower) -> set[Any]:
    """What is worth meeting of the block's present state."""
    return {
        ("stage", block.sequence.current.stage),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("cyclic", block.slave_cycle > 0.0, block.state),
        ("variable", block.variable_cycle, block.state),
        ("drop reason", block.local.drop_reason),
        ("shortened approach", block.sequence.current.is_approach_shortened),
    }


def check(block: Follower) -> None:
    assert (block.state == State.M_IN_ALARM) == (block.error_id >= 2)
    assert block.slave_cycle <= 0.0 or 0.0 <= block.slave.position < block.slave_cycle


# The faults that are not rare.
OFTEN = (
    Fault.NONE,
    Fault.POSITIONING,
    Fault.MASTER_MOVED,
    Fault.CYCLE_TOO_SHORT,
    Fault.SPEED_FOLLOWING,
    Fault.MASTER_BACKWARDS,
    Fault.ACCELERATION_POSITIONING,
)
STRATEGY = Strategy(
    runs,
    watch,
    frozenset(
        {
            *(("stage", stage) for stage in Stage),
            *(("mode", mode) for mode in MasterInput),
            *(("fault", fault) for fault in OFTEN),
            *(("cyclic", False, state) for state in State),
            *(("cyclic", True, state) for state in State if state != State.M_DECEL),
            *(("variable", variable, state) for variable in (False, True) for state in State),
            *(("drop reason", reason) for reason in DropReason if reason != DropReason.TOO_SHORT),
            *(("shortened approach", is_shortened) for is_shortened in (False, True)),
        }
    ),
    check,
)
