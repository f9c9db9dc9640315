"""Runs of scenarios in compiled code: they have the bits of runs in Python, whatever reacts to what, and fail in the same
words. Every scenario of the project is compared in tests/model/test_scenarios.py, which runs them in Python anyway."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync_fmu.errors import UserError
from motionsync_fmu.native.loop.scripted import MOST_RUNS, run_scenarios
from motionsync_fmu.scenario.clocks import Rate
from motionsync_fmu.scenario.drive import Drive
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script, Segment
from motionsync_fmu.scenario.settings import Condition, Reaction, Setting
from motionsync_fmu.scenario.shipped import find
from tests import ROOT
from tests.support.recordings import assert_as_in_python, assert_same, compiled, interpreted

CYCLIC_CUT = ROOT / "scenarios/FlyingSaw/cyclic_cut/scenario.toml"
DRIVEN = ROOT / "scenarios/CutToLength/cyclic_orders/scenario.toml"
REMOTE = ROOT / "scenarios/RemoteSync/fast_sender_jitter/scenario.toml"
ROTARY = ROOT / "scenarios/Synchronizer/end_of_step_inputs/scenario.toml"


def of_block(block: str) -> Iterator[list[Scenario]]:
    """The scenarios of a block, in lists of those that have one recipe."""
    loaded = sorted(map(load, find(ROOT / "scenarios" / block)), key=lambda s: str(s.recipe.interface))
    for _, same in groupby(loaded, key=lambda s: s.recipe):
        yield list(same)


def test_runs_together_are_what_each_is_alone(block: str) -> None:
    """All scenarios of a block at once, also at a step that some of them do not allow."""
    for scenarios in of_block(block):
        for chosen in (scenarios, [replace(s, step_size=0.007) for s in scenarios]):
            for scenario, run in zip(chosen, compiled(*chosen, threads=2), strict=True):
                (alone,) = compiled(scenario)
                assert (run.failure, run.unmet) == (alone.failure, alone.unmet)
                if alone.recording:
                    assert run.recording
                    assert_same(run.recording, alone.recording)


def test_many_runs_on_many_threads_come_back_in_their_order() -> None:
    """Each begins at a place of its own, and at rest it stays there."""
    places = np.arange(3.0 * MOST_RUNS + 1.0)
    start = {"axis.initial_position": 0.0}
    scenario = replace(load(CYCLIC_CUT), stop_time=0.05, reactions=(), settings=(), expectations=(), cuts=None)
    many = [replace(scenario, start={**scenario.start, **start, "axis.initial_position": float(p)}) for p in places]
    for threads in (1, 3):
        runs = compiled(*many, names=["slave.position"], threads=threads)
        found = [r.recording.values["slave.position"][-1] for r in runs if r.recording]
        assert found == places.tolist()


# --- random programs ---


def times(stop: float, scan: float) -> st.SearchStrategy[float]:
    """Any time, or one at or beside a scan: the points of a run lie close to one another there."""
    near = st.builds(
        lambda i, beside: round(i * scan, 12) + beside,
        st.integers(1, int(stop / scan) - 1),
        st.sampled_from([0.0, 1e-13, -1e-13, 1e-11, scan / 128, -scan / 128]),
    )
    return st.floats(1e-3, stop * 0.99) | near


def conditions(names: dict[str, tuple[float, float]]) -> st.SearchStrategy[Condition]:
    """A comparison of one of these outputs with a number within its range."""
    return st.sampled_from(sorted(names)).flatmap(
        lambda name: st.builds(
            lambda comparison, value: Condition(f"{name} {comparison} {value}", name, comparison, value),
            st.sampled_from(["<", ">", "=="]),
            st.floats(*names[name]) | st.sampled_from([0.0, *names[name]]),
        )
    )


def reactions(
    stop: float,
    names: dict[str, tuple[float, float]],
    given: dict[str, st.SearchStrategy[Any]],
    added: dict[str, st.SearchStrategy[Any]],
) -> st.SearchStrategy[tuple[Reaction, ...]]:
    one = st.builds(
        Reaction,
        conditions(names),
        st.sampled_from([0.0, 0.01, 0.05, 0.1]) | st.floats(0.0, stop / 2),
        st.fixed_dictionaries({}, optional=given),
        st.fixed_dictionaries({}, optional=added),
        st.sampled_from([None, 1, 2, 5]),
        st.booleans(),
    )
    return st.lists(one, max_size=5).map(tuple)


SAW = {
    "move_velocity.execute": st.booleans(),
    "move_absolute.execute": st.booleans(),
    "halt.execute": st.booleans(),
    "gear_in_pos.execute": st.booleans(),
    "reset.execute": st.booleans(),
    "gear_in_pos.master_sync_position": st.floats(100.0, 900.0),
}
SEEN = {
    "slave.position": (-50.0, 300.0),
    "slave.velocity": (-200.0, 400.0),
    "gear_in_pos.busy": (0.0, 1.0),
    "in_sync": (0.0, 1.0),
    "state_code": (0.0, 12.0),
}
ADDED = {"halt.jerk": st.floats(0.0, 1e5), "move_velocity.velocity": st.floats(-50.0, 100.0)}
ADDED_MORE = {
    "gear_in_pos.master_sync_position": st.floats(0.0, 700.0),
    "gear_in_pos.ratio_numerator": st.floats(-1, 1),
}
SEGMENTS = st.lists(
    st.builds(
        lambda duration, key, value: Segment(duration, **({key: value} if key else {})),
        st.floats(1e-3, 0.5) | st.sampled_from([0.1, 0.2]),
        st.sampled_from(["velocity", "acceleration", "jerk", ""]),
        st.floats(-800.0, 800.0),
    ),
    max_size=4,
)
FREE = {
    "axis.initial_velocity": 100.0,
    "move_velocity.velocity": 100.0,
    "move_absolute.velocity": 150.0,
    "gear_in_pos.master_sync_position": 300.0,
    "gear_in_pos.slave_sync_position": 120.0,
}


@st.composite
def saws(draw: st.DrawFn) -> Scenario:
    """A saw that moves freely, with settings and reactions, behind a scripted master or one that follows the saw."""
    stop, scan = 1.5, draw(st.sampled_from([0.01, 0.02, 0.0173]))
    setting = st.builds(Setting, times(stop, scan), st.fixed_dictionaries({}, optional=SAW))
    period = draw(st.sampled_from([0.0, 0.0, 250.0]))
    mode = draw(st.sampled_from(MasterInput))
    drive = st.builds(Drive, st.just("slave.velocity"), st.floats(1e-2, 1.0), st.sampled_from([math.inf, 100.0, 900.0]))
    given = {name: value for name, value in SAW.items() if name != "gear_in_pos.master_sync_position"}
    return replace(
        load(CYCLIC_CUT),
        stop_time=stop,
        step_size=draw(st.sampled_from([scan, 0.007, 0.3, 0.01]) | st.floats(2e-3, 0.5)),
        scan=scan,
        start={**FREE, "master.period": period, "master.input_mode": mode},
        master=Script(draw(st.floats(-100, 100)), draw(st.floats(-300, 600)), 0.0, draw(SEGMENTS)),
        settings=tuple(draw(st.lists(setting, max_size=6))),
        reactions=draw(reactions(stop, SEEN, given, ADDED | ADDED_MORE)),
        drive=draw(drive | st.none()),
        expectations=(),
        cuts=None,
    )


@settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))
@given(scenario=saws())
def test_random_programs_give_the_bits_of_python(scenario: Scenario) -> None:
    assert_as_in_python(scenario)


@settings(deadline=None, max_examples=15, suppress_health_check=list(HealthCheck))
@given(
    step_size=st.sampled_from([0.002, 0.0013, 0.0007]) | st.floats(3e-4, 0.002),
    cycle=st.floats(0.0005, 0.01),
    phase=st.floats(0.0, 0.99),
    program=reactions(
        0.2,
        {"slave.position": (0.0, 100.0), "slave.velocity": (0.0, 500.0)},
        {"reset": st.booleans()},
        {},
    ),
    segments=SEGMENTS,
)
def test_random_telegrams_give_the_bits_of_python(
    step_size: float, cycle: float, phase: float, program: tuple[Reaction, ...], segments: list[Segment]
) -> None:
    scenario = load(REMOTE)
    remote = scenario.remote
    assert remote
    axis = Script(10.0, 100.0, 0.0, segments)
    clocks = replace(remote.clocks, rates=[Rate(0.0, cycle)], phase=phase)
    seen = replace(remote, axis=axis, clocks=clocks, cycles=clocks.acted(0.2), accuracy=None)
    assert_as_in_python(
        replace(
            scenario, stop_time=0.2, step_size=step_size, master=axis, remote=seen, reactions=program, expectations=()
        )
    )
