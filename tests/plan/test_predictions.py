"""What a plan predicts, by hand; that runs of the block confirm it, and that they would not confirm anything else."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.plan.confirmation import GAP_SKIPPED, confirm
from motionsync_fmu.plan.line_plan import default_lengths, default_velocities, plan_machine
from motionsync_fmu.plan.prediction import VELOCITY
from motionsync_fmu.plan.saw import CYCLE, STROKE, WAYS
from tests.model.cut_to_length.machine_results import CYCLES, GREATEST_VELOCITIES, result_of, to
from tests.plan.machines import JERKLESS, REFERENCE, machine, variant
from tests.support.blocks.drawn import drawn

ONE_PER_CENT = math.sqrt(1.01) - 1.0  # of what goes with the square of the velocity


@pytest.mark.parametrize(
    ("length", "velocity", "bound"),
    [
        *((length, GREATEST_VELOCITIES[length], CYCLE) for length in (500.0, 1000.0, 1500.0)),
        (2000.0, GREATEST_VELOCITIES[2000.0], STROKE),
    ],
)
def test_the_greatest_line_velocity_and_what_limits_it(length: float, velocity: float, bound: str) -> None:
    point = machine(REFERENCE).predict_greatest_velocity(length)
    assert point.velocity == pytest.approx(velocity, abs=5e-7)
    assert point.bound == bound
    assert point.lost == pytest.approx(point.velocity, rel=1e-12)  # there is no reserve


def test_the_shortest_length_and_the_parts_of_its_cycle() -> None:
    point, expected = machine(REFERENCE).predict_shortest_length(1000.0), CYCLES[1000.0]
    assert point.cycle
    assert point.length == to(6, expected.shortest_pitch)
    assert point.cycle["approach"] == to(9, expected.approach_time)
    assert point.cycle["cut"] == 0.25
    assert point.cycle["way home"] == to(9, expected.return_time)
    assert (point.cycle["settling"], point.cycle["gap"], point.cycle["clearing"], point.cycle["rest at home"]) == (
        0.0,
        0.0,
        0.0,
        0.0,
    )
    assert point.figures["stroke"].value == to(6, expected.stroke)


def test_settling_clearing_and_rest_are_parts_of_the_cycle() -> None:
    point = variant("slower").predict_shortest_length(800.0)
    assert point.cycle
    assert point.length == to(6, result_of("slower", "shortest_pitch", 800.0))
    assert (point.cycle["settling"], point.cycle["clearing"], point.cycle["rest at home"]) == (
        pytest.approx(0.05),
        0.04,
        0.02,
    )
    assert point.cycle["way home"] == to(9, result_of("slower", "return_time", 800.0))
    assert point.cycle_time == to(9, result_of("slower", "cycle_time", 800.0))


def test_kerf_measuring_wheel_mitre_and_gap() -> None:
    """L 812, b 4, f 1.02: the pitch is 800. The gap of 10 over 150 takes as long as the carriage needs for 150."""
    point, fastest = variant("mitre").predict_greatest_velocity(812.0), result_of("mitre", "max_line_velocity", 800.0)
    assert point.cycle
    assert point.velocity == to(6, fastest)
    assert point.cycle["gap"] == pytest.approx(150.0 / (fastest * 1.02 / math.cos(math.pi / 6.0)), rel=1e-8)


def test_a_velocity_that_is_too_great_has_no_length() -> None:
    """The stroke of 650 admits 1431.8; without it the axis admits 1500."""
    assert [machine(REFERENCE).predict_shortest_length(v).bound for v in (1431.7, 1431.9)] == [CYCLE, STROKE]
    assert machine(REFERENCE).predict_shortest_length(1431.9).length is None
    endless = machine(REFERENCE, axis_max_position="1e9")
    assert [endless.predict_shortest_length(v).bound for v in (1500.0, 1500.1)] == [CYCLE, VELOCITY]


def test_a_length_below_the_ways_of_a_cycle_has_no_velocity() -> None:
    """An approach over 150 takes 300 of the material, however slow the line is."""
    data = machine(REFERENCE, approach_distance="150")
    points = [data.predict_greatest_velocity(length) for length in (299.0, 301.0)]
    assert [point.bound for point in points] == [WAYS, CYCLE]
    assert points[0].velocity == 0.0 < points[1].velocity


def test_gains_by_hand() -> None:
    """Without jerk and times p = 4.736 v2/a, stroke = 1.25 v2/a: what goes with v2 gains sqrt(1.01) - 1."""
    data = machine(JERKLESS)
    long = data.predict_greatest_velocity(1000.0)
    assert long.gains["acceleration"] == pytest.approx(ONE_PER_CENT, rel=1e-4)
    assert data.predict_shortest_length(1000.0).gains["acceleration"] == pytest.approx(0.01, rel=1e-4)
    assert long.limited_by == "cycle time: acceleration"
    assert {name for name, gain in long.gains.items() if gain > 1e-6} == {"acceleration"}
    at_end = machine(JERKLESS, axis_max_position="100").predict_greatest_velocity(1000.0)
    assert at_end.gains["stroke"] == pytest.approx(ONE_PER_CENT, rel=1e-4)
    assert at_end.gains["acceleration"] == pytest.approx(ONE_PER_CENT, rel=1e-4)
    fast = machine(JERKLESS, axis_max_velocity="100").predict_greatest_velocity(1000.0)
    assert fast.gains["velocity"] == pytest.approx(0.01, rel=1e-9)
    assert fast.limited_by == "velocity"


def test_cuts_are_lost_only_when_the_reserve_is_used_up() -> None:
    """Without jerk and times: D = q lead, q = 1.1^2, lead = 0.75 v2/a; p_min = (1.5 q + 1 + 2 sqrt(0.75 q + 0.5)) v2/a.
    A start may be late by D - lead, so cuts are lost from p_min - 0.75 (q - 1) v2/a = p on."""
    q = 1.21
    point = machine(JERKLESS, approach_reserve="0.1").predict_greatest_velocity(1000.0)
    factor = 1.5 * q + 1.0 + 2.0 * math.sqrt(0.75 * q + 0.5)
    assert point.velocity == pytest.approx(math.sqrt(1e4 * 1000.0 / factor), rel=1e-6)
    assert point.lost == pytest.approx(math.sqrt(1e4 * 1000.0 / (factor - 0.75 * (q - 1.0))), rel=1e-6)


def test_a_reserve_is_of_no_use_where_the_tool_s_delay_is_waited_for() -> None:
    """A shorter approach leaves more of the delay to be waited in sync: the carriage never catches up."""
    point = machine(REFERENCE, approach_reserve="0.1", tool_on_delay="0.5").predict_greatest_velocity(1500.0)
    assert point.lost == pytest.approx(point.velocity, rel=1e-12)
    assert confirm(machine(REFERENCE, approach_reserve="0.1", tool_on_delay="0.5"), point).is_confirmed


def test_the_default_lengths_show_where_the_cycle_time_no_longer_limits() -> None:
    data = machine(REFERENCE)
    lengths, velocities = default_lengths(data), default_velocities(data)
    assert {data.predict_greatest_velocity(length).bound for length in lengths} == {CYCLE, STROKE}
    assert velocities[-1] == data.greatest_velocity == pytest.approx(GREATEST_VELOCITIES[2000.0], abs=5e-7)
    assert all(x < y for values in (lengths, velocities) for x, y in pairwise(values))


# --- confirmed by the block -------------------------------------------------------------------------------------------


def test_runs_confirm_what_is_predicted() -> None:
    plan = plan_machine(machine(REFERENCE), [1500.0, 2000.0], [500.0, 1400.0, 1480.0])
    assert plan.is_confirmed
    assert all(point.checks for point in plan.predictions)
    assert [len(point.checks) for point in plan.over_length] == [3, 3]  # below, cycle, above


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_runs_confirm_no_other_velocity(share: float) -> None:
    data = machine(REFERENCE)
    point = data.predict_greatest_velocity(1500.0)
    assert point.lost
    assert confirm(data, point).is_confirmed
    assert not confirm(data, replace(point, velocity=share * point.velocity, lost=share * point.lost)).is_confirmed


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_runs_confirm_no_other_length(share: float) -> None:
    data = machine(REFERENCE, approach_reserve="0.02")
    point = data.predict_shortest_length(800.0)
    assert point.length
    assert point.lost
    assert confirm(data, point).is_confirmed
    assert not confirm(data, replace(point, length=share * point.length)).is_confirmed
    assert not confirm(data, replace(point, lost=share * point.lost)).is_confirmed


def test_a_gap_that_is_left_out_is_noted() -> None:
    """The gap of 10 over 100 at 1000 needs a jerk of 60 10 / 0.1^3 = 600000, three times the axis's."""
    data = machine(REFERENCE, gap_distance="10")
    assert confirm(data, data.predict_shortest_length(1000.0)).note == GAP_SKIPPED
    assert not confirm(data, data.predict_shortest_length(400.0)).note


values = {
    "axis.max_acceleration": st.sampled_from(("2000", "10000")),
    "axis.max_deceleration": st.just("10000"),  # that of the way home is not above it
    "axis.max_jerk": st.sampled_from(("20000", "200000")),
    "homing.velocity": st.sampled_from(("0", "300")),
    "homing.deceleration": st.sampled_from(("0", "4000")),
    "axis.max_position": st.sampled_from(("650", "1e6")),
    "approach.reserve": st.sampled_from(("0", "0.02", "0.2")),
    "approach.distance": st.sampled_from(("0", "120")),
    "tool.mode": st.sampled_from(("TIME", "DISTANCE", "FEEDBACK")),
    "tool.settle_time": st.sampled_from(("0", "0.05")),
    "tool.on_delay": st.sampled_from(("0", "0.04", "0.4")),
    "tool.retract_time": st.sampled_from(("0", "0.06")),
    "homing.settle_time": st.sampled_from(("0", "0.1")),
    "homing.ease": st.sampled_from(("false", "true")),
    "kerf": st.sampled_from(("0", "4")),
    "material_factor": st.sampled_from(("1", "1.02")),
    "diagonal_angle": st.sampled_from(("0", "40")),
    "home_position": st.sampled_from(("0", "-30")),
}


@drawn(6, shrink=False)
@given(st.fixed_dictionaries(values), st.sampled_from((400.0, 1000.0, 2500.0)), st.sampled_from((150.0, 700.0)))
def test_runs_confirm_any_machine(given_values: dict[str, str], length: float, velocity: float) -> None:
    plan = plan_machine(machine(REFERENCE | given_values), [length], [velocity])
    assert plan.is_confirmed, [check.text for point in plan.predictions for check in point.checks if not check.passed]
