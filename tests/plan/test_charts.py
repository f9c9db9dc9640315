"""The charts of a line plan: data that plotly accepts, with the results of the plan."""

import json
import re
from pathlib import Path

import plotly.graph_objects as go
import pytest

from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.plan.charts import chart_cycle, chart_over_length, chart_over_velocity
from motionsync_fmu.plan.line_plan import make_plan
from motionsync_fmu.plan.report import write_plan
from tests.plan.machines import REFERENCE, machine


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
    plan = make_plan(machine(REFERENCE, axis_max_acceleration="4000"), [2000.0], [500.0])
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


def curve(chart: Chart, name: str) -> dict[str, list[float]]:
    return next(trace for trace in chart.traces if trace["name"] == name)
