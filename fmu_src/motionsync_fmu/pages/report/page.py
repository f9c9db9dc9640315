"""The report of a run: a self-contained HTML page with its figures, cuts, interactive plots and expectations."""

from collections.abc import Mapping
from pathlib import Path

from markupsafe import Markup

from motionsync.var import Unit

from ...interface.fingerprint import PACKAGE
from ...interface.units import unit_name
from ...scenario.engineering import ROUNDING, engineering
from ...scenario.evaluate.find_pieces import Piece
from ...scenario.evaluate.key_figures import KeyFigures, compute_key_figures
from ...scenario.evaluate.outcome import ScenarioOutcome
from ...scenario.evaluate.production import Production
from ...scenario.recording import Recording
from ...scenario.scenario import Scenario
from ...scenario.settings import Reaction
from ..machine.fragment import machine
from ..style import TEMPLATES, load_template, typeset
from .chart import Chart, align_charts, kind_colour
from .cutting import chart_cuts
from .lanes import Lane, chart_lanes, find_changes, find_lanes, is_shaded
from .limit_rows import limit_rows
from .motion import chart_motion, chart_remote_errors, motion_units
from .origin import describe_fmu, origin_rows, shown_path
from .piece_charts import MOST_DRAWN, chart_piece_list, chart_pieces, error_text, kind_key
from .real_machine import chart_axis, chart_force_over_velocity, chart_histogram, chart_true_errors

Settings = list[tuple[float, list[tuple[str, str]]]]
"""What is set during a run: times, each with names and values as texts."""

PLOTLY = PACKAGE / "pages" / "vendor" / "plotly-basic.min.js"


def plotly_script() -> Markup:
    """The text of plotly.js, which every page with charts contains."""
    return Markup(PLOTLY.read_text("utf-8"))


def write_report(
    file: Path,
    scenario: Scenario,
    recording: Recording,
    outcome: ScenarioOutcome,
    fmu: Path | None = None,
    results: Path | None = None,
) -> None:
    """Write the page; it loads nothing from elsewhere.

    `fmu`: the FMU that was run, None: the block ran in this process; `results`: the file with the outputs, which the
    page links to."""
    scenario, filed = with_recorded_settings(scenario, recording), scenario
    figures = outcome.figures
    lanes = find_lanes(scenario, recording)
    settings = list_settings(scenario)
    charts = {name: chart.html() for name, chart in _charts(scenario, recording, figures, lanes, settings).items()}
    text = load_template(TEMPLATES, "report.html.j2").render(
        scenario=scenario,
        script=scenario.text,
        figures=figures,
        outcome=outcome,
        reactions=[_describe_reaction(reaction, scenario) for reaction in filed.reactions],
        drive=filed.drive,
        unmet=recording.unmet,
        charts=charts,
        machine=machine(scenario, recording),
        keys=colour_keys(lanes),
        shades=colour_keys([lane for lane in lanes if is_shaded(lane)]),
        many=figures.production is not None and len(figures.production.pieces) > MOST_DRAWN,
        kinds=[("kind", kind_key(scenario, figures.production))] if figures.production else [],
        unit=unit_name(Unit.POSITION, scenario.unit),
        settings=settings,
        starts=_with_units(scenario, scenario.start),
        limits=limit_rows(scenario.recipe.variables, scenario.start, scenario.unit, scenario.slave_unit),
        origin=_origin(scenario, recording, fmu, results),
        tool=figures.production.tool if figures.production else "saw" if scenario.cuts else "slave",
        axis_units=motion_units(scenario.unit),
        axis=[] if filed.is_recorded else list(zip(filed.master.breaks, filed.master.motions, strict=True)),
        engineering=engineering,
        kind_colour=kind_colour,
        measured=_measured,
        error_text=error_text,
        bundle=plotly_script(),
    )
    file.write_text(text, "utf-8")


def _origin(scenario: Scenario, recording: Recording, fmu: Path | None, results: Path | None) -> dict[str, str]:
    """The table "Where this comes from", by the names of its rows."""
    times = f"outputs were recorded at {len(recording.time)} times up to {scenario.stop_time:.10g} s"
    rows = {"step size": f"{scenario.step_size:.10g} s; {times}", "scenario": shown_path(scenario.file)}
    if results:
        digits = "all outputs with all digits; a curve of the charts has about as many points as a screen"
        rows["outputs"] = Markup('<a href="{0}">{0}</a>, {1}').format(results.name, digits)
    in_process = f"none: the block {scenario.recipe.name} ran in this process"
    return origin_rows({"FMU": describe_fmu(fmu) if fmu else in_process}, rows)


def _measured(piece: Piece, production: Production) -> str:
    """The length of a piece by the positions of slave and material; `as reported` if it is equal."""
    if piece.measured is None:
        return ""
    exact = abs(piece.measured - piece.length) <= ROUNDING * production.scale
    return "as reported" if exact else engineering(piece.measured, production.unit, digits=7)


def with_recorded_settings(scenario: Scenario, recording: Recording) -> Scenario:
    """The scenario with all settings of a run of it, each at its time, and with the master's motion in it."""
    return scenario.with_recorded_inputs(recording.settings or scenario.settings, recording.script or scenario.master)


def _describe_reaction(reaction: Reaction, scenario: Scenario) -> tuple[str, str, str, str]:
    """A reaction in words: its condition, how long after it, what it sets and adds, and how often."""
    changes = [f"{name} = {text}" for name, text in _with_units(scenario, reaction.set)]
    changes += [f"{name} + {text}" for name, text in _with_units(scenario, reaction.add)]
    often = "each time" if reaction.times is None else "once" if reaction.times == 1 else f"{reaction.times} times"
    after = engineering(reaction.after, "s") if reaction.after else "at once"
    return reaction.condition.text, after, ", ".join(changes), often


def list_settings(scenario: Scenario) -> Settings:
    """The settings of a run, with their values as texts."""
    return [(s.at, _with_units(scenario, s.values)) for s in scenario.settings]


def _with_units(scenario: Scenario, values: Mapping[str, float]) -> list[tuple[str, str]]:
    """Names of variables, and their values as texts, with units."""
    declared = [(scenario.recipe.variables[name], value) for name, value in values.items()]
    units = [typeset(unit_name(v.declaration.unit, scenario.unit, scenario.slave_unit)) for v, _ in declared]
    return [(v.name, f"{v.text(value)} {unit}".rstrip()) for (v, value), unit in zip(declared, units, strict=True)]


def colour_keys(lanes: list[Lane]) -> list[tuple[str, list[tuple[str, str, str]]]]:
    """The colours of each enumeration that is shown, the state first: of each the CSS property, name, description."""
    return [(lane.title, lane.key()) for lane in lanes if lane.variable.choices]


def run_charts(scenario: Scenario, recording: Recording) -> dict[str, Chart]:
    """The charts of a run: "cuts" (if there is a table [cuts]), "list" and "pieces" (of a block that reports pieces),
    "histogram" and "true" (where true pieces are known), "axis" and "force" (of an axis with servo or load), "errors"
    (of a remote axis), "motion" and "lanes"."""
    scenario = with_recorded_settings(scenario, recording)
    lanes = find_lanes(scenario, recording)
    return _charts(scenario, recording, compute_key_figures(scenario, recording), lanes, list_settings(scenario))


def _charts(
    scenario: Scenario, recording: Recording, figures: KeyFigures, lanes: list[Lane], settings: Settings
) -> dict[str, Chart]:
    """The charts of a scenario that has the settings of its run; `settings`: the same as texts."""
    times = [at for at, _ in settings]
    texts = [", ".join(f"{name} = {text}" for name, text in values) for _, values in settings]
    required = find_changes(recording, lanes, times)
    charts = {"cuts": chart_cuts(scenario.cuts, scenario, recording, figures, required)} if scenario.cuts else {}
    if figures.production:
        charts |= {"list": chart_piece_list(scenario, figures.production)} if figures.production.pieces else {}
        charts["pieces"] = chart_pieces(scenario, recording, figures, figures.production, required)
    if figures.true_pieces and figures.true_pieces.pieces:
        charts["histogram"] = chart_histogram(figures.true_pieces)
        charts["true"] = chart_true_errors(scenario, figures.true_pieces)
    if figures.following_error or figures.load:
        charts["axis"] = chart_axis(scenario, recording, figures.load, required)
    if figures.load:
        charts["force"] = chart_force_over_velocity(scenario, recording, figures.load)
    if scenario.remote:
        charts["errors"] = chart_remote_errors(scenario.remote, scenario, recording, required)
    charts["motion"] = chart_motion(scenario, recording, figures, lanes, times, required)
    charts["lanes"] = chart_lanes(lanes, scenario.stop_time, times, texts)
    align_charts(charts.values())
    return charts
