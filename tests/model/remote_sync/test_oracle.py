"""RemoteSync on random clocks and telegrams is its oracle, with steps that are cycles, parts of them, or several."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import given, seed
from hypothesis import strategies as st

from motionsync.remote_sync.faults import Fault
from motionsync.remote_sync.interface import Estimator, Mode
from tests.model.remote_sync.harness import OUTPUTS, RemoteSyncHarness
from tests.oracle.remote_sync import RemoteSyncOracle
from tests.support.blocks.drawn import drawn

rngs = st.integers(0, 2**32 - 1).map(Random)

BEAT, PHASE = Estimator.BEAT, Estimator.PHASE
INDEX = "remote.cycle_index"
CYCLES = 800
INPUTS = ("enable", "delay_time_offset", "remote.position", "remote.velocity", "remote.acceleration")
SHOWN = (*OUTPUTS, *INPUTS)
BURST, BURST_STEP = 3, 5  # together beyond the greatest max_cycle_index_difference + 2 that is drawn
NEAR = {  # limits that no telegram meets but for rounding
    "threshold_for_sync": (0.0512345, 0.3123, 0.0077, 2.345),
    "max_position_difference": (0.0, 0.0, 0.0, 1.51234, 4.31234),  # of the axis' way in a cycle
}


@dataclass(frozen=True)
class Clock:
    """How a sender's index comes: its gain a cycle of its own, jitter, and how often a cycle something happens.

    A burst jumps in several cycles one after the other, each time too little for a fault; together too much for the
    correction."""

    drift: float
    jitter: float = 0.0
    losses: float = 0.0
    jumps: float = 0.0
    bursts: float = 0.0
    changes: float = 0.0

    def indices(self, r: Random, cycles: int, ratio: float) -> Iterator[int]:
        """What is seen in each of the receiver's cycles, counted on without wrapping."""
        phase, drift, sent, jumped, seen, lost, burst = r.random(), self.drift, 0, 0, 0, 0, 0
        for _ in range(cycles):
            sent = max(sent, math.floor(phase + r.gauss(0.0, self.jitter)))
            if r.random() < self.losses:
                lost = r.choice((3, 6, 6, 9))
            if r.random() < self.jumps:
                jumped += r.choice((1, -1, 2, -2, 3, 5, 20))
            if r.random() < self.bursts:
                burst = BURST
            if burst > 0:
                jumped += BURST_STEP
                burst -= 1
            if r.random() < self.changes:
                drift = r.choice((-drift, -drift, 0.6 * drift, self.drift))
            seen = seen if lost else sent + jumped
            lost = max(lost - 1, 0)
            yield seen
            phase += (1.0 + drift) / ratio


@dataclass(frozen=True)
class ReceivedRun:
    """Start values, and what is set before each of the receiver's cycles."""

    start: dict[str, Any]
    cycles: list[dict[str, Any]] = field(repr=False)

    @property
    def cycle(self) -> float:
        return float(self.start["task_cycle_time"])

    @property
    def ratio(self) -> float:
        return self.start["data_cycle_time"] / self.cycle if self.start["data_cycle_time"] else 1.0

    def rows(self) -> list[dict[str, Any]]:
        """Inputs, outputs and locals, a row a cycle."""
        receiver = RemoteSyncHarness(self.start)
        return [receiver.step(self.cycle, values).stepper.get(SHOWN) for values in self.cycles]


CHOICES: dict[str, tuple[Any, ...]] = {
    "end_of_transition_limit": (3, 10, 30),
    "new_drift_blending_cycles": (1, 7, 30, 90),
    "time_mode_blending_cycles": (1, 7, 30, 90),
    "periods_for_mean_drift": (1, 1, 1, 2, 4),
    "slope1_numerator": (0.95, 0.5, 1.0, 0.3),
    "slope1_denominator": (0.5, 0.2, 0.7),
    "max_cycle_index_difference": (7, 12),
    "age_of_data_limit": (7, 12, 0),
    "force_time_mode": (False,) * 7 + (True,),
    "automatic_reinit": (False, True, True, True),
    "start_up_mode": (4, 2, 1, 4),
    "fall_back_mode": (1, 2),
    "use_acceleration": (False, True),
    "pt1_factor_position": (3.0, 0.5),
}


@st.composite
def received_runs(draw: st.DrawFn) -> ReceivedRun:
    """Beats twice to ten times as far apart as they have to be."""
    estimator = draw(st.sampled_from((BEAT, PHASE)))
    ratio = 1.0 if estimator == PHASE else draw(st.sampled_from((1.0, 1.0, 1.0, 2.0, 3.0, 0.5, 0.25)))
    cycle = draw(st.sampled_from((0.002, 0.001, 0.0005, 0.01)))
    start = {name: draw(st.sampled_from(choice)) for name, choice in (CHOICES | NEAR).items()}
    speed = draw(st.floats(-300.0, 300.0))
    start["max_position_difference"] *= cycle * max(1.0, abs(speed))
    start |= {
        "task_cycle_time": cycle,
        "data_cycle_time": ratio * cycle if ratio != 1.0 else draw(st.sampled_from((0.0, cycle))),
        "estimator": estimator,
        "blending_time": cycle * draw(st.sampled_from((3.7, 12.0, 30.0))),
        "delay_time_offset": cycle * draw(st.sampled_from((0.0, 1.0, -0.3))),
    }
    clock = draw(clocks(ratio, start["end_of_transition_limit"]))
    rng = draw(rngs)
    telegrams = draw(axes(list(clock.indices(rng, CYCLES, ratio)), ratio * cycle, speed))
    order(rng, telegrams, start)
    return ReceivedRun(start, telegrams)


@st.composite
def clocks(draw: st.DrawFn, ratio: float, limit: int) -> Clock:
    """`limit`: the cycles without a change that end a transition zone."""
    apart = max(20.0, limit * draw(st.sampled_from((2.0, 4.0, 10.0))))
    drift = draw(st.sampled_from((1.0, -1.0))) * ratio / apart
    jitter = draw(st.sampled_from((0.0, 0.01, 0.05)))
    rare = draw(st.sampled_from((0.0, 0.2, 0.5))) / apart
    return Clock(drift, jitter, rare, rare, 0.3 * rare, rare)


@st.composite
def axes(draw: st.DrawFn, indices: list[int], data_cycle: float, speed: float) -> list[dict[str, Any]]:
    """The telegrams with these indices of an axis with constant acceleration, which may be 0."""
    base = draw(st.sampled_from((0, 65000, 70000, -5)))
    curved = draw(st.sampled_from((0.0, 20.0)))
    times = [index * data_cycle for index in indices]
    return [
        {
            INDEX: base + index,
            "remote.position": speed * t + 0.5 * curved * t * t,
            "remote.velocity": speed + curved * t,
            "remote.acceleration": curved,
        }
        for index, t in zip(indices, times, strict=True)
    ]


def order(r: Random, telegrams: list[dict[str, Any]], start: dict[str, Any]) -> None:
    """New starts, and tunables that are good, or bad for a while."""
    cycle, enabled = start["task_cycle_time"], True
    for values in telegrams:
        if r.random() < (0.001 if enabled else 0.1):
            enabled = not enabled
            values["enable"] = enabled
        if r.random() < 0.002:
            values["delay_time_offset"] = cycle * r.choice((0.0, 1.0, 1.0, math.nan, 2.0))
        elif r.random() < 0.05:
            values["delay_time_offset"] = start["delay_time_offset"]
        if r.random() < 0.0005:
            values["max_position_difference"] = r.choice((0.0, -1.0, math.inf))
        elif r.random() < 0.05:
            values["max_position_difference"] = start["max_position_difference"]


def going_on(rows: list[dict[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """One cycle and the next one, between which there is neither a fault nor a new start."""
    for before, now in pairwise(rows):
        if now["enable"] and not (before["error"] or now["error"]) and now["local.cycles"] > 0:
            yield before, now


@pytest.mark.slow
def test_the_lines_meet_what_is_to_be_proven_on_them() -> None:
    """Within 180 lines; those after the one with which all is met are not run."""
    met: set[Any] = set()
    events = ("synced", "warning", "beat", "forgotten")
    required = {
        *(("fault", fault) for fault in Fault),
        *(("mode", mode) for mode in Mode),
        *((kind, event) for kind in Estimator for event in events),
        "synced no more",
    }

    @seed(0)
    @drawn(180, anew=True, shrink=False)
    @given(received_runs())
    def draw(received: ReceivedRun) -> None:
        if met == required:
            return
        kind = received.start["estimator"]
        rows = received.rows()
        met.update(("fault", row["error_id"]) for row in rows)
        met.update(("mode", row["state"]) for row in rows)
        for before, now in going_on(rows):
            met.update((kind, name) for name in ("synced", "warning") if now[name])
            met.update({(kind, "beat")} if now["beats"] > before["beats"] else ())
            met.update({(kind, "forgotten")} if now["beats"] < before["beats"] else ())
            met.update({"synced no more"} if before["synced"] and not now["synced"] else ())

    draw()
    assert met == required


# --- the oracle -------------------------------------------------------------------------------------------------------


@drawn(40, shrink=False)  # to shrink telegrams takes minutes and shows nothing
@given(received_runs(), rngs, st.sampled_from(((1.0,), (1.0,), (0.5, 0.1), (2.0, 5.0), (1.0, 0.25, 3.3), (0.7,))))
def test_the_block_is_as_the_oracle(received: ReceivedRun, rng: Random, sizes: tuple[float, ...]) -> None:
    """All outputs of all steps, to 1e-9 of their size, with steps that are no cycles too."""
    receiver, oracle = (
        RemoteSyncHarness(received.start | received.cycles[0]),
        RemoteSyncOracle(received.start, received.cycles[0]),
    )
    time = 0.0
    while time < len(received.cycles) - 6.0:
        size = rng.choice(sizes)
        values = received.cycles[math.ceil(time - 1e-6)]
        expected = oracle.step(values, size * received.cycle)
        receiver.step(size * received.cycle, values)
        for name, value in expected.items():
            scale = max(100.0 if name == "drift" else 1.0, abs(float(value)))
            assert abs(float(receiver[name]) - float(value)) <= 1e-9 * scale, name
        time += size
