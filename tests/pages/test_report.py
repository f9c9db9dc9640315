"""The report of a run: which charts it has, what they show, and what the page tells."""

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
import pytest
from plotly.offline import get_plotlyjs_version

from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.pages.report.page import BUNDLE, run_charts, write_report
from motionsync_fmu.pages.style import TEMPLATES
from motionsync_fmu.scenario.judge import check, compare
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT

FLAGSHIP = "FlyingSaw/cyclic_cut"
SHOWN = (
    FLAGSHIP,
    "Synchronizer/polynomial",
    "RemoteSync/accelerating_axis",
    "Follower/cyclic_through",
    "Gearing/ccw_direct",
)
Run = tuple[Scenario, Recording]


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    """Scenarios of all blocks, and their recordings."""
    loaded = {name: load(ROOT / "scenarios" / name / "scenario.toml") for name in SHOWN}
    return {name: (s, run_in_process(s, s.step_size)) for name, s in loaded.items()}


@pytest.fixture(scope="module")
def flagship(runs: dict[str, Run]) -> Run:
    return runs[FLAGSHIP]


def page(run: Run, file: Path) -> str:
    """The report of a run."""
    s, recording = run
    write_report(
        file, s, recording, check(s, recording), compare(s, recording), s.step_size, results=file.parent / "out.csv"
    )
    return file.read_text("utf-8")


def found(chart: Chart, row: int, name: str) -> dict[str, Any]:
    """The one trace of a name in a row."""
    axis = f"y{row if row > 1 else ''}"
    (trace,) = [t for t in chart.traces if t["name"] == name and t["yaxis"] == axis]
    return trace


def coloured(value: Any, colours: dict[str, str]) -> Any:
    """A chart with its colours in place of the names of CSS properties, as the page's script puts them."""
    if isinstance(value, dict):
        return {k: coloured(v, colours) for k, v in value.items()}
    if isinstance(value, list):
        return [coloured(v, colours) for v in value]
    return colours[value] if isinstance(value, str) and value.startswith("--") else value


def sheets() -> list[dict[str, str]]:
    """The colours of a light and of a dark page, by CSS property."""
    text = TEMPLATES.get_template("plotted.html.j2").render(bundle="")
    light, dark = text[: text.index("@media screen")], text[text.index("@media screen") : text.index(".good")]
    pairs = [dict(re.findall(r"(--[\w-]+): ([^;]+);", part)) for part in (light, dark)]
    return pairs


# --- the page ---


def test_the_flagship_s_report_is_small(flagship: Run, tmp_path: Path) -> None:
    """Below 2.5 MB: plotly.js' basic bundle is the greater part of it."""
    text = page(flagship, tmp_path / "report.html")
    assert len(text.encode()) < 2_500_000
    assert len(text.encode()) > BUNDLE.stat().st_size


def test_a_report_loads_nothing(runs: dict[str, Run], tmp_path: Path) -> None:
    for run in runs.values():
        text = page(run, tmp_path / "report.html").replace(BUNDLE.read_text("utf-8"), "")
        assert not re.search(r"<(script|link|img|iframe)[^>]+(src|href)=", text)
        assert not re.search(r"https?://|@import|url\(|fetch\(|XMLHttpRequest", text)
        assert '<a href="out.csv">' in text


def test_plotly_js_is_the_one_that_was_looked_at() -> None:
    """The digest is that of `plotly-basic.min.js` of the npm package plotly.js-basic-dist-min 4.1.1."""
    text = BUNDLE.read_bytes()
    assert hashlib.sha256(text).hexdigest() == "99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba"
    assert b"Licensed under the MIT license" in text[:300]
    assert b"</script" not in text
    readme = BUNDLE.with_name("README.md").read_text("utf-8")
    assert f"plotly.js {get_plotlyjs_version()}," in readme
    assert "MIT" in BUNDLE.with_name("plotly-LICENSE.txt").read_text("utf-8")


def test_the_charts_are_what_plotly_js_takes(runs: dict[str, Run]) -> None:
    """Plotly's own schema refuses a property or value that plotly.js does not know."""
    light, dark = sheets()
    assert light.keys() >= dark.keys() - {"--ink", "--paper", "--muted", "--grid", "--axis"}
    for run in runs.values():
        for chart in run_charts(*run).values():
            data = coloured(json.loads(json.dumps(chart.as_json(), allow_nan=False)), light)
            go.Figure(data)
            go.Figure(coloured(chart.as_json(), light | dark))


def test_a_dark_page_has_a_colour_of_its_own_for_each_of_a_light_one() -> None:
    light, dark = sheets()
    assert light.keys() == dark.keys()
    assert not [name for name in light if light[name] == dark[name]]
