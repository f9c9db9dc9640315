"""The charts of a line plan: data that plotly accepts, with the results of the plan."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.plan.charts import chart_comparison, chart_cycle, chart_over_length, chart_over_velocity
from motionsync_fmu.plan.line_plan import make_plan, plan_machine
from motionsync_fmu.plan.report import select_example, write_plan
from tests.plan.machines import KNIFE, LOADED, REFERENCE, knife, machine


def test_the_charts_are_what_plotly_takes() -> None:
    plan = plan_machine(machine(REFERENCE, approach_reserve="0.02"), [500.0, 2000.0], [500.0, 1480.0])
    charts = [chart_over_length(plan), chart_over_velocity(plan), chart_cycle(plan.machine, 2000.0, 1000.0)]
    for chart in charts:
        go.Figure(json.loads(re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart.as_json()))))
    assert curve(charts[0], "greatest line velocity")["y"][-1] == pytest.approx(1422.098, abs=1e-3)
    assert curve(charts[1], "shortest length")["x"][-1] == pytest.approx(1422.098, abs=1e-3)
    assert {"approach", "cut", "way home", "more stroke", "less cut"} <= {t["name"] for t in charts[0].traces}


def test_the_page_lists_all_limits_in_use(tmp_path: Path) -> None:
    """Nobody has set a deceleration."""
    values = {name: value for name, value in REFERENCE.items() if name != "axis.max_deceleration"}
    plan = make_plan([machine(values, axis_max_acceleration="4000")], [2000.0], [500.0])
    limits = (
        write_plan(plan, tmp_path / "report.html")
        .read_text("utf-8")
        .partition("The limits in use")[2]
        .partition("</table>")[0]
    )
    for name, value, reason in (
        ("axis.max_velocity", "1500 mm/s", "set"),
        ("axis.max_acceleration", "4000 mm/s²", "set"),
        ("axis.max_deceleration", "4000 mm/s²", "as axis.max_acceleration"),
        ("homing.deceleration", "4000 mm/s²", "as axis.max_deceleration"),
        ("approach.jerk", "200000 mm/s³", "as axis.max_jerk"),
    ):
        assert f'<td class="name">{name}</td><td>{value}</td><td>{reason}</td>' in limits


def test_one_cycle_is_drawn_as_the_block_ran_it() -> None:
    """At 1000 the carriage is at home again after 0.9976 s. It reverses beyond S = 336.602540: 0.05 s of jerk take
    1000 to 750 in 50 - 4.166667, then -10000 takes it to 0 in 750^2/20000 = 28.125; the sum is 410.560874."""
    chart = chart_cycle(machine(REFERENCE), 2000.0, 1000.0)
    position = next(trace for trace in chart.traces if trace["name"] == "carriage")
    assert max(position["y"]) == pytest.approx(410.5609, abs=1e-2)
    assert position["x"][-1] == pytest.approx(0.997607, abs=2e-3)
    assert {"approach", "cut", "way home"} <= {trace["name"] for trace in chart.traces}


def test_the_use_of_the_motor_is_drawn_over_length_and_velocity() -> None:
    """The peak is that of the full acceleration against friction: 120 kg 10 m/s2 + 150 N = 1350 N, 45 % of 3000 N.
    The rms at the planned length is that of the table, of 900 N."""
    plan = plan_machine(machine(LOADED), [2000.0], [500.0])
    for chart, (prediction,), at in (
        (chart_over_length(plan), plan.over_length, 2000.0),
        (chart_over_velocity(plan), plan.over_velocity, 500.0),
    ):
        rms, peak = curve(chart, "rms of the motor"), curve(chart, "peak of the motor")
        assert rms["yaxis"] == peak["yaxis"] == "y4"
        assert max(peak["y"]) == pytest.approx(45.0, abs=0.1)
        assert prediction.motor
        assert np.interp(at, rms["x"], rms["y"]) == pytest.approx(prediction.motor.rms / 9.0, rel=0.01)
        assert curve(chart, "all that the motor can give")["y"] == [100.0, 100.0]
        assert "use of the motor's force in %" in [note["text"] for note in chart.layout["annotations"]]


def test_only_what_is_known_of_the_motor_is_drawn() -> None:
    """Without limits the forces; with one limit the share of that one; without a load no row."""
    forces = {name: value for name, value in LOADED.items() if "force" not in name}
    chart = chart_over_length(plan_machine(machine(forces), [2000.0], [500.0]))
    assert max(curve(chart, "peak of the motor")["y"]) == pytest.approx(1350.0, rel=2e-3)
    names = {trace["name"] for trace in chart.traces}
    assert "all that the motor can give" not in names
    assert "motor's force in N" in [note["text"] for note in chart.layout["annotations"]]
    chart = chart_over_length(plan_machine(machine(forces | {"load.peak_force": "1000"}), [2000.0], [500.0]))
    assert max(curve(chart, "peak of the motor")["y"]) == pytest.approx(135.0, rel=2e-3)
    assert "rms of the motor" not in {trace["name"] for trace in chart.traces}
    chart = chart_over_length(plan_machine(machine(REFERENCE), [2000.0], [500.0]))
    assert not {name for name in (trace["name"] for trace in chart.traces) if "motor" in name}


def curve(chart: Chart, name: str) -> dict[str, Any]:
    return next(trace for trace in chart.traces if trace["name"] == name)


# --- the page ---------------------------------------------------------------------------------------------------------


def test_the_user_s_own_lengths_and_line_velocity_are_marked(tmp_path: Path) -> None:
    """Pieces of 6000 at 40 m/min, 666.667 mm/s: the machine admits more, so that the cycle drawn is this one."""
    data = replace(machine(REFERENCE), orders=(6000.0,), line_velocity=2000.0 / 3.0)
    plan = make_plan([data], [2000.0], [500.0])
    for chart, x, y in (
        (chart_over_length(plan.machines[0]), 6000.0, 2000.0 / 3.0),
        (chart_over_velocity(plan.machines[0]), 2000.0 / 3.0, 6000.0),
    ):
        point = curve(chart, "the scenario")
        assert (point["x"], point["y"]) == (pytest.approx([x]), pytest.approx([y], rel=1e-6))
    page = write_plan(plan, tmp_path / "report.html").read_text("utf-8")
    assert "in a run of the block: pieces of 6000 mm at 666.667 mm/s (40 m/min), as in the scenario." in page
    assert "Diamonds mark the scenario: pieces of 6000 mm at 666.667 mm/s (40 m/min)." in page
    assert "1431.8 mm/s (85.91 m/min)" in page
    fast = select_example(plan_machine(replace(data, line_velocity=1500.0), [2000.0], [500.0]))
    assert fast
    assert fast.text == (
        "pieces of 2000 mm at 1431.8 mm/s (85.91 m/min), the greatest line velocity for this length; the line of the "
        "scenario, at 1500 mm/s (90 m/min), is too fast for its lengths"
    )


def test_the_charts_of_a_knife() -> None:
    """At the synchronous length of 600 the line may run at 6000; the knife parks above 1217.142857. 4000 mm/s are too
    fast for pieces in between."""
    plan = plan_machine(knife(KNIFE), [300.0, 1500.0], [1000.0, 5000.0])
    over_length, over_velocity = chart_over_length(plan), chart_over_velocity(plan)
    assert max(curve(over_length, "greatest line velocity")["y"]) == pytest.approx(6000.0)
    resting = curve(over_length, "rest at park")
    starts = [x for x, y in zip(resting["x"], resting["y"], strict=True) if y > 0.0]
    assert min(starts) == pytest.approx(1217.142857, rel=1e-6)
    assert {"in sync", "turning on", "ramp down", "ramp up", "more jerk", "less window"} <= names(over_length)
    gap = curve(over_velocity, "too fast for these lengths")
    assert min(gap["x"]) == pytest.approx(3800.0, abs=100.0)  # from 3800.184663 on, which 900 admits
    for chart in (over_length, over_velocity):
        go.Figure(json.loads(re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart.as_json()))))


def test_one_cycle_of_a_knife() -> None:
    """On 400 at 1000 the knife goes from cut to cut in 0.4 s, over 360 degrees, and is 2.102941 times as fast as in
    sync in the middle; its velocity is drawn with its limit."""
    chart = chart_cycle(knife(KNIFE, axis_max_velocity="1500"), 400.0, 1000.0)
    position, velocity, _ = (trace for trace in chart.traces if trace["name"] == "knife")
    assert (position["x"][-1], position["y"][-1]) == (pytest.approx(0.4, rel=1e-6), pytest.approx(360.0, rel=1e-4))
    assert max(velocity["y"]) == pytest.approx(2.102941 * 600.0, rel=1e-4)
    assert curve(chart, "limit")["y"] == [1500.0, 1500.0]
    assert "knife's velocity in deg/s, limit 1500" in [note["text"] for note in chart.layout["annotations"]]
    assert {"in sync", "turning on"} <= names(chart)


def test_both_machines_are_drawn_in_one_chart(tmp_path: Path) -> None:
    """The saw reaches 1001.572745 for 1000, the knife 940 cbrt(1e6/14400) = 3863.728."""
    saw, rotary_knife = machine(REFERENCE), knife(KNIFE)
    plan = make_plan([saw, rotary_knife], [1000.0], [900.0])
    assert plan.comparison
    chart = chart_comparison(plan.comparison)
    for name, velocity in (("the saw cuts below this", 1001.572745), ("the knife cuts below this", 3863.728)):
        line = curve(chart, name)
        assert np.interp(1000.0, line["x"], line["y"]) == pytest.approx(velocity, rel=2e-3)
    are_areas = ["fill" in trace for trace in chart.traces]
    assert are_areas == sorted(are_areas, reverse=True), "an area hides what was drawn before it"
    assert [trace["name"] for trace in chart.traces[:2]] == ["the knife cuts below this", "the saw cuts below this"]
    assert (curve(chart, "orders")["x"], curve(chart, "orders")["y"]) == ([1000], [900])
    page = write_plan(plan, tmp_path / "report.html").read_text("utf-8")
    assert "<h1>The saw, or the knife?</h1>" in page
    assert f"<strong>{plan.comparison.sentence}</strong>" in page
    assert page.count("The limits in use") == 2
    assert "1001.57 mm/s (60.09 m/min)" in page


def names(chart: Chart) -> set[str]:
    return {trace["name"] for trace in chart.traces}
