"""Runs of scenarios in compiled code: they have the bits of runs in Python, whatever reacts to what, and fail in the
same words. Every scenario of the project is compared in tests/model/test_scenarios.py, which runs them in Python."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync_fmu.batch.scripted_runs import MOST_RUNS, run_scenarios
from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.clocks import Rate
from motionsync_fmu.scenario.drive import Drive
from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script, Segment
from motionsync_fmu.scenario.settings import OutputCondition, Reaction, Setting
from tests import ROOT
from tests.support.blocks.drawn import drawn
from tests.support.scenarios.recordings import assert_as_in_python, assert_same, run_compiled, run_interpreted

CYCLIC_CUT = ROOT / "scenarios/FlyingSaw/cyclic_cut/scenario.toml"
DRIVEN = ROOT / "scenarios/CutToLength/cyclic_orders/scenario.toml"
REMOTE = ROOT / "scenarios/RemoteSync/fast_sender_jitter/scenario.toml"


def scenarios_of(block: str) -> Iterator[list[Scenario]]:
    """The scenarios of a block, in lists of those that have one recipe."""
    loaded = sorted(map(load_scenario, find_files(ROOT / "scenarios" / block)), key=lambda s: str(s.recipe.interface))
    for _, same in groupby(loaded, key=lambda s: s.recipe):
        yield list(same)


def test_runs_together_are_what_each_is_alone(block: str) -> None:
    """All scenarios of a block at once, at a step that some of them do not allow."""
    for scenarios in scenarios_of(block):
        variants = [replace(s, step_size=0.007) for s in scenarios]
        for scenario, run in zip(variants, run_compiled(*variants, threads=2), strict=True):
            (alone,) = run_compiled(scenario)
            assert (run.failure, run.unmet) == (alone.failure, alone.unmet)
            if alone.recording:
                assert run.recording
                assert_same(run.recording, alone.recording)


def test_many_runs_on_many_threads_come_back_in_their_order() -> None:
    """Each starts at a position of its own, and stays there at rest."""
    positions = np.arange(3.0 * MOST_RUNS + 1.0)
    start = {"axis.initial_position": 0.0}
    scenario = replace(load_scenario(CYCLIC_CUT), stop_time=0.05, reactions=(), settings=(), expectations=(), cuts=None)
    many = [replace(scenario, start={**scenario.start, **start, "axis.initial_position": float(p)}) for p in positions]
    for threads in (1, 3):
        runs = run_compiled(*many, names=["slave.position"], threads=threads)
        ends = [r.recording.values["slave.position"][-1] for r in runs if r.recording]
        assert ends == positions.tolist()


# --- random programs ---


def times(stop: float, scan: float) -> st.SearchStrategy[float]:
    """Any time, or one at or near a scan, where the points of a run are close to one another."""
    near = st.builds(
        lambda i, offset: round(i * scan, 12) + offset,
        st.integers(1, int(stop / scan) - 1),
        st.sampled_from([0.0, 1e-13, -1e-13, 1e-11, scan / 128, -scan / 128]),
    )
    return st.floats(1e-3, stop * 0.99) | near


def conditions(names: dict[str, tuple[float, float]]) -> st.SearchStrategy[OutputCondition]:
    """A comparison of one of these outputs with a number within its range."""
    return st.sampled_from(sorted(names)).flatmap(
        lambda name: st.builds(
            lambda comparison, value: OutputCondition(f"{name} {comparison} {value}", name, comparison, value),
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
    reactions = st.builds(
        Reaction,
        conditions(names),
        st.sampled_from([0.0, 0.01, 0.05, 0.1]) | st.floats(0.0, stop / 2),
        st.fixed_dictionaries({}, optional=given),
        st.fixed_dictionaries({}, optional=added),
        st.sampled_from([None, 1, 2, 5]),
        st.booleans(),
    )
    return st.lists(reactions, max_size=5).map(tuple)


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


ENCODERS = st.builds(
    Encoder,
    st.sampled_from([0.0, 0.1]),
    st.sampled_from([0.0, 0.02]),
    st.sampled_from([0.0, 0.004]) | st.floats(0.0, 1.0),
    st.sampled_from([1.0, 1.0005]),
    st.sampled_from([0.0, 0.05]),
    st.floats(1.0, 1000.0),
    st.sampled_from([0.0, 0.002]) | st.floats(1e-3, 0.1),
    st.integers(0, 2**32 - 1),
)


@st.composite
def saws(draw: st.DrawFn) -> Scenario:
    """A saw that moves freely, with settings and reactions, behind a scripted master or one that follows the saw."""
    stop, scan = 1.5, draw(st.sampled_from([0.01, 0.02, 0.0173]))
    setting = st.builds(Setting, times(stop, scan), st.fixed_dictionaries({}, optional=SAW))
    period = draw(st.sampled_from([0.0, 0.0, 250.0]))
    mode = draw(st.sampled_from(MasterInput))
    drives = st.builds(
        Drive, st.just("slave.velocity"), st.floats(1e-2, 1.0), st.sampled_from([math.inf, 100.0, 900.0])
    )
    drive = draw(drives | st.none())
    given = {name: value for name, value in SAW.items() if name != "gear_in_pos.master_sync_position"}
    return replace(
        load_scenario(CYCLIC_CUT),
        stop_time=stop,
        step_size=draw(st.sampled_from([scan, 0.007, 0.3, 0.01]) | st.floats(2e-3, 0.5)),
        scan=scan,
        start={**FREE, "master.period": period, "master.input_mode": mode},
        master=Script(draw(st.floats(-100, 100)), draw(st.floats(-300, 600)), 0.0, () if drive else draw(SEGMENTS)),
        settings=tuple(draw(st.lists(setting, max_size=6))),
        reactions=draw(reactions(stop, SEEN, given, ADDED | ADDED_MORE)),
        drive=drive,
        encoder=draw(ENCODERS | st.none()),
        expectations=(),
        cuts=None,
    )


@drawn(50, anew=True, shrink=False)
@given(scenario=saws())
def test_random_programs_give_the_bits_of_python(scenario: Scenario) -> None:
    assert_as_in_python(scenario)


@drawn(15, anew=True, shrink=False)
@given(
    step_size=st.sampled_from([0.002, 0.0013, 0.0007]) | st.floats(3e-4, 0.002),
    cycle=st.floats(0.0005, 0.01),
    phase=st.floats(0.0, 0.99),
    program=reactions(
        0.2,
        {"slave.position": (0.0, 100.0), "slave.velocity": (0.0, 500.0)},
        {"enable": st.booleans()},
        {},
    ),
    segments=SEGMENTS,
)
def test_random_telegrams_give_the_bits_of_python(
    step_size: float, cycle: float, phase: float, program: tuple[Reaction, ...], segments: list[Segment]
) -> None:
    scenario = load_scenario(REMOTE)
    remote = scenario.remote
    assert remote
    axis = Script(10.0, 100.0, 0.0, segments)
    clocks = replace(remote.clocks, rates=[Rate(0.0, cycle)], phase=phase)
    seen = replace(remote, axis=axis, clocks=clocks, cycles=clocks.count_cycles(0.2), accuracy=None)
    assert_as_in_python(
        replace(
            scenario, stop_time=0.2, step_size=step_size, master=axis, remote=seen, reactions=program, expectations=()
        )
    )


# --- failures ---


def test_a_refused_initialization_fails_in_the_words_of_python() -> None:
    saw = load_scenario(CYCLIC_CUT)
    run = assert_as_in_python(replace(saw, start={**saw.start, "axis.min_position": 10.0, "axis.max_position": -10.0}))
    why = "the lower software end position must not be above the upper one"
    values = "axis.min_position = 10, axis.max_position = -10"
    assert run.failure == f"at 0 s FlyingSaw refuses initialize(): {why} ({values})"
    assert run.failed_at == 0.0


def test_a_refused_step_fails_in_the_words_of_python_with_its_time() -> None:
    """A rotary master with turns of 1e-6 mm that jumps to 1e12 mm/s at 0.5 s would do 1e16 turns in a step."""
    jumps = Script(0.0, 100.0, 0.0, [Segment(0.5), Segment(1.0, velocity=1e12)])
    run = assert_as_in_python(replace(free_saw(), start={**FREE, "master.period": 1e-6}, master=jumps))
    assert run.failure.startswith("at 0.5 s FlyingSaw refuses step(0.01")
    assert run.failed_at == 0.5


SET_TOO_FAR = (Setting(0.25, {"gear_in_pos.master_sync_position": 2e12}),)
ADDED_TOO_FAR = (
    Reaction(OutputCondition("", "slave.position", ">", 50.0), add={"gear_in_pos.master_sync_position": 2e12}),
)


@pytest.mark.parametrize(
    ("changes", "text", "at"),
    [
        (
            {"settings": SET_TOO_FAR},
            "at 0.25 s gear_in_pos.master_sync_position = 2e+12 is not allowed: it must be -1e+12 to 1e+12",
            0.25,
        ),
        (
            {"reactions": ADDED_TOO_FAR},
            "at 0.51 s gear_in_pos.master_sync_position = 2.0000000003e+12 is not allowed: it must be -1e+12 to 1e+12",
            0.51,
        ),
        (
            {"master": Script(0.0, 1e12, 0.0, [])},
            "at 1.01 s master.position = 1.01e+12 is not allowed: it must be -1e+12 to 1e+12",
            1.01,
        ),
        (
            {"start": FREE | {"axis.max_velocity": -1.0}},
            "at 0 s axis.max_velocity = -1 is not allowed: it must be 1e-12 to 1e+12",
            0.0,
        ),
        (
            {"step_size": 2e6, "stop_time": 3e6, "settings": ()},
            "at 0 s step size = 2e+06 is not allowed: it must be > 0 and <= 1e+06",
            0.0,
        ),
    ],
)
def test_what_the_fmu_does_not_allow_fails_in_its_words(changes: dict[str, Any], text: str, at: float) -> None:
    """The saw moves at 100 mm/s, so the scan at 0.51 s sees it beyond 50 mm."""
    scenario = replace(free_saw(), **changes)
    (run,) = run_compiled(scenario)
    assert run.failure.startswith(text)
    assert run.failed_at == at
    assert run.recording is None


def free_saw() -> Scenario:
    """A saw at 100 mm/s behind a line at 500 mm/s; nothing happens."""
    master = Script(0.0, 500.0, 0.0, [])
    bare = replace(
        load_scenario(CYCLIC_CUT), start=FREE, master=master, settings=(), reactions=(), expectations=(), cuts=None
    )
    return replace(bare, stop_time=2.0, step_size=0.01, scan=0.01)


def test_a_run_that_fails_leaves_the_others_alone() -> None:
    valid, refused = free_saw(), replace(free_saw(), settings=SET_TOO_FAR)
    measures = {"slave.position": ("max", "last")}
    first, failed, third = run_scenarios([valid, refused, valid], ["slave.position"], measures, threads=1)
    assert first.recording
    assert third.recording
    assert_same(first.recording, third.recording)
    assert first.measures == third.measures == {"slave.position.max": 200.0, "slave.position.last": 200.0}
    assert [*map(math.isnan, failed.measures.values())] == [True, True]
    assert [first.failure, third.failure] == ["", ""]
    assert math.isnan(first.failed_at)


# --- measures ---


@pytest.mark.parametrize("file", [CYCLIC_CUT, DRIVEN, REMOTE], ids=lambda file: file.parent.name)
def test_measures_are_those_of_the_recording(file: Path) -> None:
    scenario, names = load_scenario(file), ["slave.velocity", "slave.position", "state_code"]
    names = [name for name in names if name in scenario.recipe.variables]
    (run,) = run_scenarios([scenario], names, dict.fromkeys(names, ("min", "max_time", "mean", "last")))
    assert run.recording
    time, lengths = run.recording.time, np.diff(run.recording.time)
    for name in names:
        values = run.recording.values[name][1:]
        assert run.measures[f"{name}.min"] == values.min()
        assert run.measures[f"{name}.last"] == values[-1]
        assert run.measures[f"{name}.max_time"] == time[1:][np.argmax(values)]
        assert run.measures[f"{name}.mean"] == np.cumsum(values * lengths)[-1] / np.cumsum(lengths)[-1]


@pytest.mark.parametrize("file", [CYCLIC_CUT, DRIVEN, REMOTE], ids=lambda file: file.parent.name)
def test_measures_are_the_same_without_a_recording(file: Path) -> None:
    scenario = load_scenario(file)
    names = [v.name for v in scenario.recipe.variables.values()]
    measures = dict.fromkeys(names, ("mean", "min_time"))
    (measured,), (recorded,) = (run_scenarios([scenario], outputs, measures) for outputs in ([], ["slave.position"]))
    assert len(measured.measures) == 2 * len(names)
    assert measured.measures == recorded.measures
    assert (measured.recording, measured.unmet) == (None, recorded.unmet)


def test_without_outputs_there_are_measures_and_unmet_reactions_alone() -> None:
    never = Reaction(
        OutputCondition("slave.position > 1000", "slave.position", ">", 1000.0), set={"halt.execute": True}
    )
    (run,) = run_scenarios([replace(free_saw(), reactions=(never,))], [], {"slave.position": "last"})
    assert (run.recording, run.failure) == (None, "")
    assert run.measures == {"slave.position.last": 200.0}
    assert [(u.reaction, u.happened) for u in run.unmet] == [(never, 0)]


@pytest.mark.parametrize(
    ("outputs", "measures", "threads", "text"),
    [
        (["slave.positon"], {}, 1, "no variable of FlyingSaw is named 'slave.positon'"),
        ([], {"slave.positon": "max"}, 1, "no variable of FlyingSaw is named 'slave.positon'"),
        ([], {"slave.position": "most"}, 1, "slave.position: no measure is named 'most'"),
        (
            [],
            {"slave.position": "every:10"},
            1,
            "slave.position: the measure 'every:10' is not allowed: the runs differ in their steps",
        ),
        ([], {}, 0, "threads = 0 is not allowed: it must be >= 1"),
    ],
)
def test_unknown_outputs_and_measures_are_refused(
    outputs: list[str], measures: dict[str, str], threads: int, text: str
) -> None:
    with pytest.raises(UserError) as e:
        run_scenarios([free_saw()], outputs, measures, threads)
    assert str(e.value).startswith(text)


def test_no_scenarios_give_no_runs() -> None:
    assert run_scenarios([], ["slave.position"]) == []


def test_baked_start_values_and_causalities_are_those_of_the_recipe() -> None:
    """The same saw, whose velocity at the start is a part of its FMU."""
    saw = free_saw()
    start = {name: value for name, value in FREE.items() if name != "axis.initial_velocity"}
    baked = replace(saw, recipe=replace(saw.recipe, starts={"axis.initial_velocity": "100"}), start=start)
    run = assert_as_in_python(baked)
    assert run.recording
    recording, _ = run_interpreted(saw)
    assert recording
    assert_same(run.recording, recording)
