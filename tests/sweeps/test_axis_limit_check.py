"""The extremes of the slave's values show that limits were kept: what exceeds one is never overlooked."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.evaluate.key_figures import SLAVE_OUTPUTS, find_peaks
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.settings import OutputCondition, Reaction, Setting
from motionsync_fmu.sweeps.axis_limit_check import AxisLimitCheck, Extent

SAW = load_example("FlyingSaw")
LIMITS = AxisLimitCheck(SAW.recipe.variables.values())
NAMES = [f"axis.{name}" for name in (
    "min_position", "max_position", "max_velocity", "max_acceleration", "max_deceleration", "max_jerk"
)]  # fmt: skip
NEAR = st.sampled_from([0.0, 1.0, 1.0 + 1e-10, 1.0 + 1e-8, 2.0, 5.0])
VALUES = st.builds(lambda x, sign: sign * x, NEAR, st.sampled_from([-1.0, 1.0]))


def recorded(courses: dict[str, list[float]], settings: list[Setting]) -> Recording:
    points = len(courses[SLAVE_OUTPUTS[0]])
    values = {name: np.array(course) for name, course in courses.items()}
    return Recording(np.arange(float(points)), values, np.zeros((points, 4)), [], settings)


def extents(recording: Recording) -> dict[str, Extent]:
    return {name: Extent(x.min(), x.max()) for name, x in recording.values.items()}


def limited(**limits: float) -> Scenario:
    """The saw with these limits of its axis."""
    return replace(SAW, start={f"axis.{name}": limit for name, limit in limits.items()}, settings=())


@given(
    st.tuples(*(st.lists(VALUES, min_size=5, max_size=5) for _ in SLAVE_OUTPUTS)),
    st.tuples(*(NEAR for _ in NAMES)),
    st.lists(st.tuples(st.integers(0, 4), st.sampled_from(NAMES), NEAR), max_size=2),
)
def test_what_exceeds_a_limit_is_never_overlooked(
    courses: tuple[list[float], ...], limits: tuple[float, ...], changes: list[tuple[int, str, float]]
) -> None:
    settings = [Setting(float(at), {name: value}) for at, name, value in changes]
    scenario = replace(SAW, start=dict(zip(NAMES, limits, strict=True)), settings=tuple(settings))
    recording = recorded(dict(zip(SLAVE_OUTPUTS, courses, strict=True)), settings)
    if any(peak.exceeded for peak in find_peaks(scenario, recording)):
        assert LIMITS.may_be_exceeded(scenario, extents(recording))


@pytest.mark.parametrize(
    ("name", "course"),
    [
        ("slave.position", [-1.0, 3.0, 0.0]),
        ("slave.velocity", [2.0, -2.0, 0.0]),
        ("slave.acceleration", [0.0, 4.0 * (1.0 + 1e-10), 0.0]),
        ("slave.jerk", [0.0, -5.0, 5.0]),
    ],
)
def test_what_reaches_its_limits_needs_no_recording(name: str, course: list[float]) -> None:
    scenario = limited(
        min_position=-1.0, max_position=3.0, max_velocity=2.0, max_acceleration=4.0, max_deceleration=0.0, max_jerk=5.0
    )
    within = {other: Extent(0.0, 0.0) for other in SLAVE_OUTPUTS}
    assert not LIMITS.may_be_exceeded(scenario, within | {name: Extent(min(course), max(course))})
    assert LIMITS.may_be_exceeded(scenario, within | {name: Extent(1.001 * min(course), 1.001 * max(course))})


def test_a_limit_that_a_reaction_changes_by_an_amount_needs_a_recording() -> None:
    still = {name: Extent(0.0, 0.0) for name in SLAVE_OUTPUTS}
    more = Reaction(OutputCondition("in_sync", "in_sync", "==", 1.0), add={"axis.max_velocity": -1.0})
    assert not LIMITS.may_be_exceeded(limited(), still)
    assert LIMITS.may_be_exceeded(replace(limited(), reactions=(more,)), still)


def test_a_limit_that_a_reaction_sets_counts() -> None:
    quick = {name: Extent(0.0, 10.0 if name == "slave.velocity" else 0.0) for name in SLAVE_OUTPUTS}
    slower = Reaction(OutputCondition("in_sync", "in_sync", "==", 1.0), set={"axis.max_velocity": 5.0})
    assert not LIMITS.may_be_exceeded(limited(max_velocity=20.0), quick)
    assert LIMITS.may_be_exceeded(replace(limited(max_velocity=20.0), reactions=(slower,)), quick)


def test_a_block_without_limits_has_none() -> None:
    assert LIMITS
    assert not AxisLimitCheck(Recipe("Gearing").variables.values())
