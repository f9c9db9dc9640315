"""The report of a line, in a real browser."""

from pathlib import Path

import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.production_line.package import write_package
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.production_line.report import write_line_report
from tests.browser.charts import ChartView
from tests.browser.conftest import Open
from tests.support.hosts.fmus import Fmus, Shared
from tests.support.scenarios.lines import SAW, copied, evaluated


@pytest.fixture(scope="module")
def line_report(shared: Shared, fmus: Fmus, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of the line with the flying saw."""
    folder = copied(shared, fmus, tmp_path_factory.mktemp("lines"))
    line = load_line(SAW)
    package = write_package(line, Flavour.NATIVE, folder, pytest.fail)
    write_line_report(folder / "report.html", line, package, evaluated(shared, line, package), folder / "line_out.csv")
    return folder / "report.html"


def test_the_report_of_a_line_shows_the_errors_of_all_variants(open_page: Open, line_report: Path) -> None:
    visit = open_page(line_report)
    chart = ChartView(visit, "Errors of the slave")
    assert any("RemoteSync" in name for name in chart.legend)
    assert chart.traces >= 5
    time, values = chart.hover_values(10.0)
    assert time == pytest.approx(10.0, abs=0.2)
    assert any(name.endswith("slave's error") for name in values)


def test_the_report_of_a_line_fits_a_narrow_window(open_page: Open, line_report: Path) -> None:
    visit = open_page(line_report, width=500, color_scheme="dark")
    visit.page.locator(".plot .main-svg").last.wait_for()
    assert visit.overflow() <= 0.0
