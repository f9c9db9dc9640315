"""The report of a knife: each figure in its unit, for each ordered length, and readable with any number of pieces.

The knife turns 360 deg on 600 mm of the line, which runs at 1000 mm/s. The first piece is cut off at 2420 mm, 400 mm
behind the cut at the front end.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.pages.report.chart import count_swings
from motionsync_fmu.pages.report.page import run_charts
from motionsync_fmu.pages.summary import figure_rows
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from tests.pages.reports import named, notes, page
from tests.support.blocks.knife_runs import run_knife

DEGREES = 0.6  # of the knife, for each mm of the line


@pytest.mark.parametrize(("count", "first"), [(1, 1), (9, 4), (30, 30)])
def test_knife_and_material_have_axes_in_their_own_units(tmp_path: Path, count: int, first: int) -> None:
    """At 2.5 s the first cut end is 80 mm behind the knife, which is 48 deg of its way."""
    chart = run_charts(*run_knife(tmp_path, count, first))["pieces"]
    assert {"knife in deg", "material in mm"} <= set(notes(chart))
    bands = next(trace for trace in named(chart, "PRODUCT") if trace["yaxis"] != "y")
    axes = [chart.layout[f"yaxis{trace['yaxis'][1:]}"] for trace in (*named(chart, "knife"), bands)]
    assert axes[0]["range"] == pytest.approx([DEGREES * end for end in axes[1]["range"]])
    assert axes[1]["side"] == "right"
    lower = slice(0, bands["x"].index(None) // 2)  # of the first band: its lower edge, then the upper one
    x, y = np.array(bands["x"][lower], float), np.array(bands["y"][lower], float)
    inside = (y > axes[1]["range"][0] + 1.0) & (y < axes[1]["range"][1] - 1.0)
    assert y[inside] == pytest.approx(1000.0 * x[inside] - 2420.0, abs=0.01)


@pytest.mark.parametrize(("count", "first"), [(2, 1), (12, 5)])
def test_no_line_crosses_a_chart_where_a_turn_ends(tmp_path: Path, count: int, first: int) -> None:
    charts = run_charts(*run_knife(tmp_path, count, first))
    lines = [*named(charts["pieces"], "knife"), *named(charts["pieces"], "cutting"), *named(charts["axis"], "setpoint")]
    assert len(lines) == 3
    for line in lines:
        values = np.array([np.nan if y is None else y for y in line["y"]], float)
        steps = np.abs(np.diff(values))
        assert np.nanmax(steps) < 60.0


@pytest.mark.parametrize(("count", "first"), [(20, 8), (70, 41)])
def test_the_true_lengths_are_given_for_each_ordered_length(tmp_path: Path, count: int, first: int) -> None:
    """The first piece has no piece before it that was measured: one less of 400 mm."""
    run = run_knife(tmp_path, count, first)
    text = page(run, tmp_path)
    table = text[text.index("<th>mean length</th>") :]
    rows = re.findall(r"<tr><td>(\d+) mm</td><td>(\d+)</td><td>(\d+) mm</td>", table[: table.index("</table>")])
    assert rows == [("400", str(first - 1), "400"), ("500", str(count - first), "500")]
    assert "mean error" in text
    assert {"rms torque of the motor", "peak torque of the motor"} <= set(re.findall(r"<dt>([^<]*)</dt>", text))
    printed = dict(figure_rows(evaluate_run(*run)))
    assert printed["true length"].startswith(f"{count - 1} products: 2 lengths, ")
    assert {"torque rms", "torque peak"} <= printed.keys()
    assert not any("force" in name for name in printed)


def test_of_one_ordered_length_the_mean_is_given(tmp_path: Path) -> None:
    run = run_knife(tmp_path, 6, 6)
    text = page(run, tmp_path)
    assert "mean 400 mm" in text
    assert "<th>mean length</th>" not in text
    assert dict(figure_rows(evaluate_run(*run)))["true length"].startswith("5 products: mean 400 mm, ")


@pytest.mark.parametrize(("count", "first"), [(45, 20), (125, 1), (500, 260)])
def test_many_pieces_are_drawn_as_dots_and_those_that_are_alike_as_one(tmp_path: Path, count: int, first: int) -> None:
    charts = run_charts(*run_knife(tmp_path, count, first))
    (bars,) = [trace for trace in charts["list"].traces if trace["type"] == "bar"]
    assert bars["base"] == [2020, 2020 + 400 * first]
    assert bars["x"] == [400 * first, 500 * (count - first)]
    one = "1" if first == 1 else f"1 to {first}"
    assert bars["text"] == [f"{one}<br>400", f"{first + 1} to {count}<br>500"]
    (dots,) = named(charts["pieces"], "length, PRODUCT")
    assert dots["y"] == pytest.approx([400.0] * first + [500.0] * (count - first))
    assert not named(charts["pieces"], "knife")
    assert sum(trace["yaxis"] == "y" for trace in charts["motion"].traces if trace["name"] == "slave") == 1
    behind = charts["motion"].layout["yaxis"].get("overlaying", "none")
    shaded = [trace for trace in charts["motion"].traces if trace["yaxis"] == behind]
    assert bool(shaded) == (behind != "none")  # over an axis without a trace plotly.js draws nothing


def test_few_pieces_are_drawn_one_by_one(tmp_path: Path) -> None:
    charts = run_charts(*run_knife(tmp_path, 20, 8))
    (bars,) = [trace for trace in charts["list"].traces if trace["type"] == "bar"]
    assert [text.partition("<br>")[0] for text in bars["text"]] == [str(i) for i in range(1, 21)]
    assert named(charts["pieces"], "knife")


@pytest.mark.parametrize("turns", [1, 7, 300])
def test_the_swings_of_a_curve_are_counted(turns: int) -> None:
    """A sine starts in the middle, goes to the top, and to the other side twice a turn, but for the first time."""
    t = np.linspace(0.0, turns, 40 * turns + 1)
    assert count_swings(5.0 + 3.0 * np.sin(2.0 * np.pi * t)) == 2 * turns - 1
    assert count_swings(np.full(10, 4.0)) == 0
