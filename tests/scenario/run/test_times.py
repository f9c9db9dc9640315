"""The times of a run: the package `runner` has them step by step; plain Python has the same ones all at once."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.runner.points import rounded
from motionsync_fmu.scenario.drive import Drive
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.run.tables import RunTables
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script, Segment
from motionsync_fmu.scenario.settings import Setting
from tests import ROOT
from tests.support.blocks.drawn import drawn

EXAMPLE = load_scenario(find_files(ROOT / "scenarios/FlyingSaw/cyclic_cut")[0])


@drawn(300, anew=True)
@given(st.lists(st.floats(0.0, 1e7) | st.floats(0.0, 1e-9) | st.integers(0, 10**12).map(lambda n: n / 1e9), min_size=1))
def test_times_are_rounded_as_python_rounds_them(times: list[float]) -> None:
    assert [rounded(t) for t in times] == [round(t, 12) for t in times]


@given(st.integers(0, 2**26))
def test_of_two_decimals_at_the_same_distance_the_even_one_is_taken(odd: int) -> None:
    """Odd multiples of 2^-13 have 13 decimals, the last of which is 5."""
    tie = (2 * odd + 1) / 8192.0
    assert rounded(tie) == round(tie, 12)


@pytest.mark.parametrize(("stop_time", "count"), [(0.5, 4), (0.45, 4), (0.1, 0)])
def test_scans_are_the_multiples_before_the_end(stop_time: float, count: int) -> None:
    points = RunTables(replace(EXAMPLE, scan=0.1, stop_time=stop_time), 1.0).run.points
    times = [points.scan_time(number) for number in range(1, 6)]
    assert times == [0.1, 0.2, 0.3, 0.4, math.inf][:count] + [math.inf] * (5 - count)


def communication_points(scenario: Scenario, step_size: float) -> list[float]:
    """The points that a run has in any case."""
    tables, times = RunTables(scenario, step_size), []
    points, axis = tables.run.points, tables.run.axis
    points.begin(axis)
    while points.next < math.inf:
        times.append(points.next)
        points.advance(axis)
    assert len(times) <= tables.most_points
    return times


def one_by_one(scenario: Scenario, step_size: float) -> list[float]:
    """The points, as `Points` explains them."""
    expected = []
    while scenario.reacts and (scan := round((len(expected) + 1) * scenario.scan, 12)) < scenario.stop_time:
        expected.append(scan)
    extra = [*(s.at for s in scenario.settings), *expected, *scenario.master.breaks[1:], scenario.stop_time]
    breaks = expected if scenario.drive else scenario.master.breaks
    grid = [i * step_size for i in range(math.floor(scenario.stop_time / step_size * (1.0 + 1e-12)) + 1)]
    remaining: list[float] = []
    for t in sorted([*grid, *(t for t in extra if t <= scenario.stop_time)]):
        if not remaining or t - remaining[-1] > 1e-9 * step_size:
            remaining.append(t)
        elif t in extra and remaining[-1] not in breaks:
            remaining[-1] = t
    return remaining


NEAR = st.builds(
    lambda i, step, offset: i * step + offset,
    st.integers(1, 40),
    st.sampled_from([0.05, 0.07, 0.1]),
    st.sampled_from([0.0, 1e-13, -1e-13, 3e-12, -3e-12, 5e-11, -5e-11, 9e-11, 1.1e-10, 2e-10]),
)


@drawn(150, anew=True)
@given(
    step_size=st.sampled_from([0.05, 0.07, 0.1]),
    scan=st.sampled_from([0.05, 0.07]),
    at=st.lists(NEAR, max_size=12),
    durations=st.lists(NEAR, max_size=4),
    reacts=st.booleans(),
    driven=st.booleans(),
)
def test_points_that_lie_close_are_those_that_are_found_one_by_one(
    step_size: float, scan: float, at: list[float], durations: list[float], reacts: bool, driven: bool
) -> None:
    """Settings and breaks are next to the grid and the scans, some just within what is close, some just outside."""
    scenario = replace(
        EXAMPLE,
        stop_time=2.0,
        scan=scan,
        settings=tuple(Setting(t, {}) for t in at),
        reactions=EXAMPLE.reactions if reacts else (),
        master=Script(0.0, 1.0, 0.0, [] if driven else [Segment(d) for d in durations]),
        drive=Drive("slave.velocity", 1.0, math.inf) if driven else None,
        expectations=(),
    )
    assert communication_points(scenario, step_size) == one_by_one(scenario, step_size)


@given(
    times=st.lists(st.floats(0.0, 5.0), min_size=1),
    segments=st.lists(
        st.builds(Segment, st.floats(1e-3, 1.0), jerk=st.floats(-1e3, 1e3))
        | st.builds(Segment, st.floats(1e-3, 1.0), acceleration=st.floats(-1e3, 1e3)),
        max_size=5,
    ),
)
def test_motions_at_many_times_are_those_at_each(times: list[float], segments: list[Segment]) -> None:
    script = Script(1.5, -2.25, 3.125, segments)
    times += script.breaks
    one = [script.at(t) for t in times]
    result = script.motions_at(np.array(times)).tolist()
    assert result == [[m.position, m.velocity, m.acceleration, m.jerk] for m in one]
