"""One self-contained HTML page a run: its figures, its cuts, interactive plots over time, and what was expected."""

from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from motionsync.var import Unit

from ... import __version__
from ...archive import HERE
from ...interface.units import unit_name
from ...scenario.figures import engineering, figures
from ...scenario.judge import Check, Deviation
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ..style import TEMPLATES
from .chart import Chart
from .cutting import cut_chart
from .lanes import changes, find_lanes, lane_chart
from .motion import motion_chart
from .origin import here, now, origin

BUNDLE = HERE / "pages" / "vendor" / "plotly-basic.min.js"


def bundle() -> Markup:
    """plotly.js, which every page with charts contains."""
    return Markup(BUNDLE.read_text("utf-8"))


def write_report(
    file: Path,
    scenario: Scenario,
    recording: Recording,
    checks: Sequence[Check],
    deviations: Sequence[Deviation],
    step_size: float,
    fmu: Path | None = None,
    results: Path | None = None,
) -> None:
    """Write the page; it loads nothing from elsewhere.

    `fmu`: the FMU that was run, None: the block ran in this process; `results`: the file with the outputs, which the
    page links to."""
    found = figures(scenario, recording)
    charts = {name: chart.html() for name, chart in run_charts(scenario, recording).items()}
    text = TEMPLATES.get_template("report.html.j2").render(
        scenario=scenario,
        script=scenario.file.read_text("utf-8"),
        found=found,
        checks=checks,
        deviations=deviations,
        messages=recording.messages,
        passed=all(c.passed for c in checks) and all(d.passed for d in deviations),
        charts=charts,
        keys=keys_of(scenario, recording),
        unit=unit_name(Unit.POSITION, scenario.unit),
        by_name=scenario.recipe.variables,
        settings=settings(scenario),
        step_size=step_size,
        points=len(recording.time),
        version=__version__,
        origin=origin(fmu) if fmu else None,
        date=now(),
        platform=here(),
        axis=list(zip(scenario.master.breaks, scenario.master.motions, strict=True)),
        engineering=engineering,
        results=results.name if results else None,
        bundle=bundle(),
    )
    file.write_text(text, "utf-8")


def settings(scenario: Scenario) -> list[tuple[float, list[tuple[str, str]]]]:
    """What was set during the run: times, each with names and values as texts."""
    by_name = scenario.recipe.variables
    return [(s.at, [(n, by_name[n].text(value)) for n, value in s.values.items()]) for s in scenario.settings]


def keys_of(scenario: Scenario, recording: Recording) -> list[tuple[str, list[tuple[str, str, str]]]]:
    """The colours of each enumeration that is shown, the state first: of each the CSS property, name, description."""
    return [(lane.title, lane.key()) for lane in find_lanes(scenario, recording) if lane.variable.choices]


def run_charts(scenario: Scenario, recording: Recording) -> dict[str, Chart]:
    """The charts of a run: "cuts" (if the scenario has a table [cuts]), "motion" and "lanes"."""
    found = figures(scenario, recording)
    lanes = find_lanes(scenario, recording)
    given = settings(scenario)
    times = [at for at, _ in given]
    texts = [", ".join(f"{name} = {text}" for name, text in values) for _, values in given]
    kept = changes(recording, lanes, times)
    charts = {"cuts": cut_chart(scenario.cuts, scenario, recording, found, kept)} if scenario.cuts else {}
    return charts | {
        "motion": motion_chart(scenario, recording, found, lanes, times, kept),
        "lanes": lane_chart(lanes, scenario.stop_time, times, texts),
    }
