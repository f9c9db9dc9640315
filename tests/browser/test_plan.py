"""The page of a plan, in a real browser."""

from dataclasses import replace
from pathlib import Path

import pytest

from motionsync_fmu.plan.line_plan import make_plan
from motionsync_fmu.plan.report import write_plan
from tests.browser.charts import ChartView
from tests.browser.conftest import Open
from tests.plan.machines import KNIFE, LOADED, REFERENCE, knife, machine


@pytest.fixture(scope="module")
def plan_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the reference machine with a reserve of the approach."""
    plan = make_plan([machine(REFERENCE, approach_reserve="0.02")], [500.0, 1500.0, 2000.0], [500.0, 1000.0, 1480.0])
    return write_plan(plan, tmp_path_factory.mktemp("plan") / "report.html")


@pytest.fixture(scope="module")
def loaded_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the reference machine with a load."""
    return write_plan(
        make_plan([machine(LOADED)], [1500.0], [500.0]), tmp_path_factory.mktemp("loaded") / "report.html"
    )


def test_the_page_of_a_plan_shows_the_greatest_line_velocity(open_page: Open, plan_page: Path) -> None:
    """1291.397 for 1500, of which the value at the nearest drawn point is shown."""
    chart = ChartView(open_page(plan_page), "The greatest line velocity over the length")
    assert {"greatest line velocity", "confirmed by runs", "cuts are lost from here on"} <= set(chart.legend)
    length, values = chart.hover_values(1500.0)
    assert length == pytest.approx(1500.0, abs=10.0)
    assert values["greatest line velocity"] == pytest.approx(1291.4, abs=6.0)


def test_the_page_of_a_plan_fits_a_narrow_window(open_page: Open, plan_page: Path) -> None:
    visit = open_page(plan_page, width=500, color_scheme="dark")
    visit.page.locator(".plot .main-svg").last.wait_for()
    assert visit.overflow() <= 0.0


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_of_two_machines_shows_where_each_reaches(
    open_page: Open, tmp_path_factory: pytest.TempPathFactory, width: int
) -> None:
    """No text of a chart is cut off, neither in the chart of both machines nor in those of the knife."""
    folder = tmp_path_factory.mktemp("both")
    rotary_knife = replace(knife(KNIFE), orders=(600.0, 900.0), line_velocity=1000.0)
    both = make_plan([machine(REFERENCE), rotary_knife], [], [900.0])
    visit = open_page(write_plan(both, folder / "both.html"), width=width)
    chart = ChartView(visit, "Where each machine reaches")
    assert {"the saw cuts below this", "the knife cuts below this", "orders"} <= set(chart.legend)
    assert chart.hidden_texts() == []
    assert visit.overflow() <= 0.0
    alone = replace(both, machines=both.machines[1:], comparison=None)
    visit = open_page(write_plan(alone, folder / "knife.html"), width=width)
    for name in ("The greatest line velocity over", "The shortest length over", "One cycle of the knife"):
        assert ChartView(visit, name).hidden_texts() == []
    assert visit.overflow() <= 0.0


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_of_a_plan_shows_the_use_of_the_motor(open_page: Open, loaded_page: Path, width: int) -> None:
    """The peak is 1350 N of 3000 N; no text is cut off, and none lies on another one."""
    visit = open_page(loaded_page, width=width)
    for name in ("The greatest line velocity over the length", "The shortest length over the line velocity"):
        chart = ChartView(visit, name)
        assert {"rms of the motor", "peak of the motor", "all that the motor can give"} <= set(chart.legend)
        assert "use of the motor's force in %" in chart.texts
        assert chart.hidden_texts() == []
    assert visit.overflow() <= 0.0
    if width == 1280:
        _, values = ChartView(visit, "The greatest line velocity over the length").hover_values(1500.0)
        assert values["peak of the motor"] == pytest.approx(45.0, abs=0.1)
        assert 0.0 < values["rms of the motor"] < 100.0
