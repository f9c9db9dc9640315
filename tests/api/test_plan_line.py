"""`plan_line` from Python: what it gives, that a notebook shows it, and its errors."""

import re
from pathlib import Path

import pytest

from motionsync_fmu import plan_line
from tests.api.test_run import Frame

SLOW = 158.0  # mm/s, for pieces of 100 mm: the table in model/motionsync/cut_to_length/README.md


def test_a_plan_has_its_predictions_and_its_page(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    plan = plan_line(length=[100.0], velocity=[500.0], set={"approach.reserve": 0, "kerf": 4})
    (machine,) = plan.machines
    assert plan.is_confirmed
    assert plan.comparison is None
    assert machine.over_length[0].velocity > SLOW  # the kerf makes the pitch longer
    assert machine.over_velocity[0].velocity == 500.0
    assert repr(plan).endswith(f"2 predictions, confirmed by {plan.runs} runs")
    page = plan.report(tmp_path / "mine" / "plan.html")
    assert page == tmp_path / "mine" / "plan.html"
    frame = Frame()
    frame.feed(plan._repr_html_())
    without_times = [re.sub(r"\d\d:\d\d:\d\d", "", text) for text in (frame.page, page.read_text("utf-8"))]
    assert without_times[0] == without_times[1]
    assert plan.title in frame.page
    assert capfd.readouterr() == ("", "")
