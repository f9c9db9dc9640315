"""The report of a line: digits that are aligned, and the order of the variants."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from motionsync_fmu.production_line.report import decimals, error_chart, event_chart
from motionsync_fmu.production_line.variants import FollowerEvent
from tests.pages.reports import coloured, named, notes, sheets

TIMES = np.arange(1, 101) * 0.1


def variant(name: str, size: float) -> Any:
    """A variant of a line whose slave is off by `size`, in u, and whose index by twice as many cycles."""
    cuts = [FollowerEvent(1, 1.0, 2.0, 100.0, size), FollowerEvent(2, 3.0, 4.0, 200.0, -3.0 * size)]
    errors = np.full(100, size)
    return SimpleNamespace(name=name, deviation=errors, index=2.0 * errors, cuts=cuts, events=cuts, products=[])


@pytest.fixture
def line() -> Any:
    return SimpleNamespace(times=TIMES, unit="mm")


@pytest.fixture
def result() -> Any:
    variants = [variant("RemoteSync", 0.01), variant("raw telegrams", 1.5), variant("other", 0.5)]
    after = [SimpleNamespace(deviation=0.01)]
    return SimpleNamespace(variants=variants, wired=variants[0], after=after, synced=2.0)


def test_values_that_stand_together_have_as_many_decimals() -> None:
    """Five digits of the greatest: 1.9139 mm beside -0.0008 mm."""
    assert decimals([1.9139, -0.00083, None]) == 4
    assert decimals([-123.4, 0.5]) == 2
    assert decimals([0.0123]) == 6
    assert decimals([123456.0]) == 0
    assert decimals([None, 0.0]) == 0


def test_the_wired_variant_is_first_in_the_legend_and_drawn_over_the_others(line: Any, result: Any) -> None:
    chart = error_chart(line, result)
    first_row = [t for t in chart.traces if t["yaxis"] == "y"]
    assert [t["name"] for t in first_row] == ["other", "raw telegrams", "RemoteSync"]
    in_legend = sorted((t for t in chart.traces if t["showlegend"]), key=lambda t: t["legendrank"])
    assert [t["name"] for t in in_legend] == ["RemoteSync", "raw telegrams", "other"]
    assert {t["yaxis"] for t in named(chart, "RemoteSync")} == {"y", "y2", "y3"}
    assert {"index error in cycles", "slave's error, as wired in mm", "in sync"} <= set(notes(chart))
    assert chart.axis(2)["range"] == pytest.approx([-0.013, 0.013])


def test_the_errors_of_the_cuts_have_a_bar_each(line: Any, result: Any) -> None:
    chart = event_chart(line, result)
    (bars,) = named(chart, "raw telegrams")
    assert (bars["x"], bars["y"], bars["customdata"]) == ([1, 2], [1.5, 4.5], [1.5, -4.5])
    assert chart.axis(1)["type"] == "log"
    assert notes(chart) == ["|error| of the cut in mm"]


def test_the_errors_of_products_stand_at_their_numbers(line: Any, result: Any) -> None:
    """The first piece has no cut before it; a piece with a cut left out in it is no product."""
    for v in result.variants:
        v.products = [FollowerEvent(number, 0.0, 1.0, 300.0, number * v.deviation[0], 0.0) for number in (2, 4)]
        v.events = v.products
    chart = event_chart(line, result)
    (bars,) = named(chart, "raw telegrams")
    assert (bars["x"], bars["y"]) == ([2, 4], [3.0, 6.0])
    assert notes(chart) == ["|error| of the product in mm"]


def test_its_charts_are_what_plotly_js_takes(line: Any, result: Any) -> None:
    light, _ = sheets()
    for chart in (error_chart(line, result), event_chart(line, result)):
        go.Figure(coloured(chart.as_json(), light))
