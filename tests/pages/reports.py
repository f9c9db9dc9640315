"""Reads what a report shows: the traces and texts of its charts, the words of its page, the colours of both."""

import re
from pathlib import Path
from typing import Any

from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.pages.report.page import write_report
from motionsync_fmu.pages.style import TEMPLATES, load_template
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario

Run = tuple[Scenario, Recording]


def page(run: Run, folder: Path) -> str:
    """The report of a run."""
    write_report(folder / "report.html", *run, evaluate_run(*run), results=folder / "out.csv")
    return (folder / "report.html").read_text("utf-8")


def words(html: str) -> str:
    """The text of a page without its scripts and styles, each blank once."""
    text = re.sub(r"<(script|style)\b.*?</\1>", " ", html, flags=re.S)
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


def named(chart: Chart, name: str, axis: str = "") -> list[dict[str, Any]]:
    """The traces of a name, all or those of an axis ("y", "y2", ...)."""
    return [t for t in chart.traces if t["name"] == name and axis in ("", t["yaxis"])]


def notes(chart: Chart) -> list[str]:
    """What is written in a chart."""
    return [str(note["text"]) for note in chart.layout["annotations"]]


def coloured(value: Any, colours: dict[str, str]) -> Any:
    """A chart with its colours in place of the names of CSS properties, as the page's script puts them."""
    if isinstance(value, dict):
        return {k: coloured(v, colours) for k, v in value.items()}
    if isinstance(value, list):
        return [coloured(v, colours) for v in value]
    return colours[value] if isinstance(value, str) and value.startswith("--") else value


def sheets() -> list[dict[str, str]]:
    """The colours of a light and of a dark page, by CSS property."""
    text = load_template(TEMPLATES, "plotted.html.j2").render(bundle="")
    light, dark = text[: text.index("@media screen")], text[text.index("@media screen") : text.index(".good")]
    return [dict(re.findall(r"(--[\w-]+): ([^;]+);", part)) for part in (light, dark)]
