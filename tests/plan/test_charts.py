"""The charts of a line plan: data that plotly accepts, with the results of the plan."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.plan.charts import chart_cycle, chart_over_length, chart_over_velocity
from motionsync_fmu.plan.line_plan import make_plan
from motionsync_fmu.plan.report import write_plan
from tests.plan.machines import LOADED, REFERENCE, machine


def test_the_charts_are_what_plotly_takes() -> None:
    plan = make_plan(machine(REFERENCE, approach_reserve="0.02"), [500.0, 2000.0], [500.0, 1480.0])
    charts = [chart_over_length(plan), chart_over_velocity(plan), chart_cycle(plan.data, 1000.0)]
    for chart in charts:
        go.Figure(json.loads(re.sub(r'"--[a-z0-9-]+"', '"#123456"', json.dumps(chart.as_json()))))
    assert curve(charts[0], "greatest line velocity")["y"][-1] == pytest.approx(1422.098, abs=1e-3)
    assert curve(charts[1], "shortest length")["x"][-1] == pytest.approx(1422.098, abs=1e-3)
    assert {"approach", "cut", "way home", "more stroke", "less cut"} <= {t["name"] for t in charts[0].traces}


def test_the_page_lists_all_limits_in_use(tmp_path: Path) -> None:
    """Nobody has set a deceleration."""
    values = {name: value for name, value in REFERENCE.items() if name != "axis.max_deceleration"}
    plan = make_plan(machine(values, axis_max_acceleration="4000"), [2000.0], [500.0])
    limits = write_plan(plan, tmp_path).read_text("utf-8").partition("The limits in use")[2].partition("</table>")[0]
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
    chart = chart_cycle(machine(REFERENCE), 1000.0)
    position = next(trace for trace in chart.traces if trace["name"] == "carriage")
    assert max(position["y"]) == pytest.approx(410.5609, abs=1e-2)
    assert position["x"][-1] == pytest.approx(0.997607, abs=2e-3)
    assert {"approach", "cut", "way home"} <= {trace["name"] for trace in chart.traces}


def test_the_use_of_the_motor_is_drawn_over_length_and_velocity() -> None:
    """The peak is that of the full acceleration against friction: 120 kg 10 m/s2 + 150 N = 1350 N, 45 % of 3000 N.
    The rms at the planned length is that of the table, of 900 N."""
    plan = make_plan(machine(LOADED), [2000.0], [500.0])
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
    chart = chart_over_length(make_plan(machine(forces), [2000.0], [500.0]))
    assert max(curve(chart, "peak of the motor")["y"]) == pytest.approx(1350.0, rel=2e-3)
    names = {trace["name"] for trace in chart.traces}
    assert "all that the motor can give" not in names
    assert "motor's force in N" in [note["text"] for note in chart.layout["annotations"]]
    chart = chart_over_length(make_plan(machine(forces | {"load.peak_force": "1000"}), [2000.0], [500.0]))
    assert max(curve(chart, "peak of the motor")["y"]) == pytest.approx(135.0, rel=2e-3)
    assert "rms of the motor" not in {trace["name"] for trace in chart.traces}
    chart = chart_over_length(make_plan(machine(REFERENCE), [2000.0], [500.0]))
    assert not {name for name in (trace["name"] for trace in chart.traces) if "motor" in name}


def curve(chart: Chart, name: str) -> dict[str, Any]:
    return next(trace for trace in chart.traces if trace["name"] == name)
