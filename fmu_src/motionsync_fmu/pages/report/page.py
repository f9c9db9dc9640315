"""One self-contained HTML page a run: its figures, its cuts, interactive plots over time, and what was expected."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from motionsync.var import Unit

from ... import __version__
from ...archive import HERE
from ...interface.units import unit_name
from ...scenario.amounts import ROUNDING, engineering
from ...scenario.figures import Figures, figures
from ...scenario.judge import Check, Deviation
from ...scenario.pieces import Piece
from ...scenario.production import Production
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ...scenario.settings import Reaction
from ..machine.fragment import machine
from ..style import TEMPLATES
from .chart import Chart, align, kind_colour
from .cutting import cut_chart
from .lanes import Lane, changes, find_lanes, lane_chart
from .motion import error_chart, motion_chart
from .origin import here, now, origin
from .pieces import kinds_of, list_chart, piece_chart

Settings = list[tuple[float, list[tuple[str, str]]]]
"""What is set during a run: times, each with names and values as texts."""

AS_FILED: Mapping[str, str] = {}
"""Nothing in place of the values in a scenario's file."""

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
    instead: Mapping[str, str] = AS_FILED,
) -> None:
    """Write the page; it loads nothing from elsewhere.

    `fmu`: the FMU that was run, None: the block ran in this process; `results`: the file with the outputs, which the
    page links to; `instead`: what the scenario has in place of its file's values."""
    scenario, asked = happened(scenario, recording), scenario
    found = figures(scenario, recording)
    lanes = find_lanes(scenario, recording)
    given = settings(scenario)
    charts = {name: chart.html() for name, chart in _charts(scenario, recording, found, lanes, given).items()}
    text = TEMPLATES.get_template("report.html.j2").render(
        scenario=scenario,
        instead=instead,
        script=scenario.file.read_text("utf-8"),
        found=found,
        checks=checks,
        deviations=deviations,
        messages=recording.messages,
        reactions=[_told(reaction, scenario) for reaction in asked.reactions],
        drive=asked.drive,
        unmet=recording.unmet,
        passed=all(c.passed for c in checks) and all(d.passed for d in deviations),
        charts=charts,
        machine=machine(scenario, recording),
        keys=keys_of(lanes),
        kinds=[("kind", kinds_of(scenario, found.production))] if found.production else [],
        unit=unit_name(Unit.POSITION, scenario.unit),
        by_name=scenario.recipe.variables,
        settings=given,
        step_size=step_size,
        points=len(recording.time),
        version=__version__,
        origin=origin(fmu) if fmu else None,
        date=now(),
        platform=here(),
        axis=list(zip(asked.master.breaks, asked.master.motions, strict=True)),
        engineering=engineering,
        kind_colour=kind_colour,
        measured=_measured,
        results=results.name if results else None,
        bundle=bundle(),
    )
    file.write_text(text, "utf-8")


def _measured(piece: Piece, made: Production) -> str:
    """The length of a piece by the positions of slave and material: `as told`, or the length; empty if not known."""
    if piece.measured is None:
        return ""
    exact = abs(piece.measured - piece.length) <= ROUNDING * made.scale
    return "as told" if exact else engineering(piece.measured, made.unit, digits=7)


def happened(scenario: Scenario, recording: Recording) -> Scenario:
    """The scenario with all that was set in a run of it, each at its time, and with the master's motion in it."""
    return scenario.settled(recording.settings or scenario.settings, recording.script or scenario.master)


def _told(reaction: Reaction, scenario: Scenario) -> tuple[str, str, str, str]:
    """A reaction in words: its condition, how long after it, what it sets and adds, and how often."""
    by_name = scenario.recipe.variables
    given = [f"{name} = {by_name[name].text(value)}" for name, value in reaction.set.items()]
    given += [f"{name} + {value:.10g}" for name, value in reaction.add.items()]
    often = "each time" if reaction.times is None else "once" if reaction.times == 1 else f"{reaction.times} times"
    after = engineering(reaction.after, "s") if reaction.after else "at once"
    return reaction.condition.text, after, ", ".join(given), often


def settings(scenario: Scenario) -> Settings:
    """What was set during the run."""
    by_name = scenario.recipe.variables
    return [(s.at, [(n, by_name[n].text(value)) for n, value in s.values.items()]) for s in scenario.settings]


def keys_of(lanes: list[Lane]) -> list[tuple[str, list[tuple[str, str, str]]]]:
    """The colours of each enumeration that is shown, the state first: of each the CSS property, name, description."""
    return [(lane.title, lane.key()) for lane in lanes if lane.variable.choices]


def run_charts(scenario: Scenario, recording: Recording) -> dict[str, Chart]:
    """The charts of a run: "cuts" (if there is a table [cuts]), "list" and "pieces" (of a block that tells its pieces),
    "errors" (of a remote axis), "motion" and "lanes"."""
    scenario = happened(scenario, recording)
    lanes = find_lanes(scenario, recording)
    return _charts(scenario, recording, figures(scenario, recording), lanes, settings(scenario))


def _charts(
    scenario: Scenario, recording: Recording, found: Figures, lanes: list[Lane], given: Settings
) -> dict[str, Chart]:
    """The same of a scenario with all that was set in its run, `given`, whose figures and lanes are known."""
    times = [at for at, _ in given]
    texts = [", ".join(f"{name} = {text}" for name, text in values) for _, values in given]
    kept = changes(recording, lanes, times)
    charts = {"cuts": cut_chart(scenario.cuts, scenario, recording, found, kept)} if scenario.cuts else {}
    if found.production:
        charts |= {"list": list_chart(scenario, found.production)} if found.production.pieces else {}
        charts["pieces"] = piece_chart(scenario, recording, found, found.production, kept)
    if scenario.remote:
        charts["errors"] = error_chart(scenario.remote, scenario, recording, kept)
    charts["motion"] = motion_chart(scenario, recording, found, lanes, times, kept)
    charts["lanes"] = lane_chart(lanes, scenario.stop_time, times, texts)
    align(charts.values())
    return charts
