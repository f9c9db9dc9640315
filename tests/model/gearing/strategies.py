"""Random runs of the Gearing, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.gearing.block import Gearing
from motionsync.gearing.faults import Fault
from motionsync.gearing.interface import State, Transition
from motionsync.gearing.request import PositionSource
from motionsync.gearing.stage import Stage
from motionsync.master import MasterInput
from tests.support.blocks.masters import INPUT_MODES, WanderingMaster
from tests.support.blocks.runs import EXTREMES, BlockRun, Strategy

LEVELS = ("start", "activate", "reset", "set_master.execute", "set_slave.execute")


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-6, 1e6)))
    periods = st.one_of(st.just(0.0), st.floats(0.5, 20.0).map(lambda x: x * length), st.floats(1e-9, 1e4))
    start = {
        **draw(INPUT_MODES),
        "master.period": draw(periods),
        "master.position": length * draw(st.floats(-3.0, 3.0)),
        "master.velocity": length * draw(st.sampled_from((0.0, 1.0, -1.0, 2.0))),
        "master.acceleration": length * draw(st.sampled_from((0.0, 0.0, 1.0))),
        "slave.initial_position": length * draw(st.floats(-3.0, 3.0)),
        "slave.period": draw(periods),
        "gear_in.distance": length,
        "gear_out.distance": length,
        "activate": draw(st.sampled_from((True, True, False))),
        "start": draw(st.booleans()),
    }
    extreme = draw(st.sampled_from((0.0, 0.0, 0.02)))
    commands = draw(st.sampled_from((0.02, 0.1, 0.4)))
    return BlockRun(
        start, list(_steps(Random(draw(st.integers(0, 2**32 - 1))), start, length, steps, extreme, commands))
    )


def _steps(
    r: Random, start: dict[str, Any], length: float, steps: int, extreme: float, commands: float
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A master that wanders, wrapped or not, and commands; `extreme` and `commands` are probabilities a step."""
    master = WanderingMaster(r, start, length)
    started, active, upset = start["start"], start["activate"], False
    for _ in range(steps):
        h, values = master.begin_step()
        values["reset"] = r.random() < 0.05
        if r.random() < commands:
            started = not started
            group = "gear_in" if started else "gear_out"
            values["start"] = started
            settings = _settings(r, started, length, master.position)
            values |= {f"{group}.{name}": value for name, value in settings.items()}
        if not active or r.random() < 0.05 * commands:
            active = r.random() < 0.5
            values["activate"] = active
        for name in ("set_master", "set_slave"):
            values[f"{name}.execute"] = r.random() < 0.3
            values[f"{name}.value"] = length * r.gauss(0.0, 3.0)
        if upset or r.random() < 0.2 * commands:  # a ratio of 0 lasts for one step
            upset = r.random() < 0.2
            values["gearing.numerator"] = r.choice((1, -1, 3, 2**31 - 1, 7)) * r.choice((1, 1, 0 if upset else 1))
            values["gearing.denominator"] = r.choice((1, 2, -5, 1000)) * r.choice((1, 1, 0 if upset else 1))
        if r.random() < extreme:  # the edge's values last; the master is set anew in every step
            name = r.choice(("master.position", "master.velocity", "master.acceleration", "set_slave.value"))
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            name = r.choice(
                ("gear_in.time", "gear_out.time", "gear_in.distance", "gear_out.distance", "gear_out.stop_position")
            )
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            h = r.choice((0.0, -h, math.nan, math.inf, 1e6, 1.1e6, 5e-324))
        yield h, values
        master.end_step(h)


def _settings(r: Random, engage: bool, length: float, position: float) -> dict[str, Any]:
    """The values of an edge: mostly valid ones, now and then a wrong one."""
    wrong = r.random() < 0.05
    values: dict[str, Any] = {
        "transition": r.choice((1, 2, 3)),
        "time": r.choice((0.01, 0.1, 1.0)) if not wrong else r.choice((0.0, -1.0)),
        "distance": length * r.choice((0.0, 0.1, 1.0, 3.0)) if not wrong else r.choice((-length, length)),
    }
    if engage:
        values["start_mode"] = r.randint(1, 7)
        values["reference_position"] = position + length * r.gauss(0.0, 1.0)
        values["offset"] = r.choice((0.0, length))
    else:
        values["stop_mode"] = r.randint(1, 6)
        values["stop_position"] = length * r.gauss(0.0, 3.0)
    if wrong and r.random() < 0.3:
        values[r.choice(("transition", "start_mode" if engage else "stop_mode"))] = r.choice((0, 8))
    return values


def watch(block: Gearing) -> set[Any]:
    """What is worth meeting of the block's present state."""
    manoeuvre = block.manoeuvre
    is_engaging = block.state < State.WAITING_FOR_STOPPOSITION
    request = manoeuvre.gear_in_request if is_engaging else manoeuvre.gear_out_request
    return {
        ("state", block.state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("manoeuvre", block.state, request.source, request.transition),
        ("inactive", block.state if manoeuvre.stage == Stage.FROZEN else None),
        ("queued edge", block.state if manoeuvre.has_queued_edge else None),
    }


def check(block: Gearing) -> None:
    assert 0.0 <= block.local.progress <= 1.0
    assert block.in_gear == (block.state == State.ACTIVE)


# The sources that a request may have in the states that carry it out; without transition GEAR_IN and GEAR_OUT end at
# once.
MANOEUVRES = {
    State.WAITING_FOR_STARTPOSITION: tuple(PositionSource),
    State.WAITING_FOR_STOPPOSITION: (PositionSource.DIRECT, PositionSource.POSITION),
    State.GEAR_IN: tuple(PositionSource),
    State.GEAR_OUT: (PositionSource.DIRECT, PositionSource.POSITION),
}
AT_ONCE = {
    ("manoeuvre", state, source, Transition.NONE)
    for state in (State.GEAR_IN, State.GEAR_OUT)
    for source in PositionSource
}
STRATEGY = Strategy(
    runs,
    watch,
    frozenset(
        {
            *(("state", state) for state in State),
            *(("mode", mode) for mode in MasterInput),
            *(("fault", fault) for fault in Fault),
            *(("inactive", state) for state in State),
            *(("queued edge", state) for state in (State.GEAR_IN, State.GEAR_OUT)),
            *(
                ("manoeuvre", state, source, transition)
                for state, sources in MANOEUVRES.items()
                for source in sources
                for transition in Transition
            ),
        }
    )
    - AT_ONCE,
    check,
)
