"""Prints for `motionsync run`: a result for each scenario, and a summary of all."""

import math
from collections.abc import Iterator, Mapping, Sequence

from rich.markup import escape

from ..scenario.engineering import engineering
from ..scenario.evaluate.key_figures import KeyFigures, Peak
from ..scenario.evaluate.outcome import ScenarioOutcome
from ..scenario.evaluate.production import Production
from .console import out, print_checks, print_headline

LETTERS = {"velocity": "v", "acceleration": "a", "deceleration": "d", "jerk": "j"}
MOST_MESSAGES = 3  # of the FMU that a result shows; --verbose shows all
MOST_NAMES = 5  # of scenarios that the summary names


def print_row(outcome: ScenarioOutcome, width: int) -> None:
    """Print one result of several: one line, and below it the expectations that are not met, and the notes.

    `width`: of the column of names."""
    mark = "[green]ok [/]" if outcome.passed else "[red]NOT[/]"
    if outcome.passed and outcome.notes:
        mark = "[yellow]ok![/]"
    parts = [outcome.figures.work_text, ", ".join(_peak_text(p) for p in _select_peaks(outcome.figures.peaks))]
    if outcome.messages:
        parts.append(f"{_counted(len(outcome.messages), 'message')} of the FMU")
    out.print(f"{mark} {escape(f'{outcome.name:<{width}}')}  {escape('; '.join(filter(None, parts)))}")
    print_checks(outcome.failed, "    ")
    _print_notes(outcome, "    ")


def print_result(outcome: ScenarioOutcome, *, verbose: bool) -> None:
    """Print the result of one scenario: its figures, a line each, and what is not as expected.

    `verbose`: all expectations, all messages of the FMU, and the same run with FMPy alone."""
    print_headline(outcome.title, outcome.scenario, outcome.passed, len(outcome.notes))
    _print_notes(outcome, "  ")
    for name, text in figure_rows(outcome):
        out.print(f"  {name:<12}  {escape(text)}")
    print_checks([*outcome.expectations, *outcome.reference] if verbose else outcome.failed, "  ")
    number = len(outcome.messages)
    shown = outcome.messages if verbose or number <= MOST_MESSAGES else outcome.messages[:MOST_MESSAGES]
    for message in shown:
        out.print(f"  the FMU logged {escape(' '.join(message.split()))}")
    if number > len(shown):
        out.print(f"  the FMU logged {number - len(shown)} more; --verbose shows all")
    out.print(f"  {'result':<12}  {escape(outcome.result)}")
    if verbose:
        out.print(f"  the same with FMPy alone: {escape(outcome.fmpy)}\n")


def print_summary(outcomes: Sequence[ScenarioOutcome], left_out: Mapping[str, list[str]]) -> None:
    """Print how many scenarios are as expected, and which are not.

    `left_out`: the names of scenarios that were not run, by the reason."""
    failed = [o.name for o in outcomes if not o.passed]
    number = f"\n[bold]{_counted(len(outcomes), 'scenario')}[/]: "
    if not failed:
        out.print(f"{number}[green]{'all ' * (len(outcomes) > 1)}as expected[/]")
    else:
        passed = len(outcomes) - len(failed)
        out.print(f"{number}{passed} as expected, [red]{len(failed)} not[/]: {escape(_first_names(failed))}")
    if noted := [o.name for o in outcomes if o.notes]:
        out.print(f"[yellow]![/] {_counted(len(noted), 'result')} with a note: {escape(_first_names(noted))}")
    for reason, names in left_out.items():
        out.print(f"[yellow]![/] {len(names)} not run: {escape(reason)}: {escape(_first_names(names))}")


def figure_rows(outcome: ScenarioOutcome) -> Iterator[tuple[str, str]]:
    """The figures of a result, a name and a text each."""
    figures = outcome.figures
    if figures.tolerance is not None:
        yield "saw", f"{figures.cuts_text}; {figures.tolerance_text} allowed"
    if figures.production:
        yield from _production_figures(figures.production)
    yield from _true_figures(figures)
    for p in figures.peaks:
        yield p.name, f"{p.value_text:<22}  limit {p.limit_text}" if p.limit_text else p.value_text
    yield "peaks", figures.peaks_text
    if outcome.expectations:
        passed, number = sum(c.passed for c in outcome.expectations), len(outcome.expectations)
        yield "expectations", f"{passed} of {number} met"
    if outcome.reference:
        passed, number = sum(d.passed for d in outcome.reference), len(outcome.reference)
        yield "reference", f"{passed} of {_counted(number, 'variable')} agree"


def _production_figures(production: Production) -> Iterator[tuple[str, str]]:
    """The figures of a production, a name and a text each."""
    yield "made", production.pieces_text
    if production.worst:
        allowed = engineering(production.tolerance, production.unit)
        worst = production.worst_text + (f" ({production.products_text})" if production.merged else "")
        yield "length error", f"{worst:<22}  {allowed} allowed"
    if production.tightest:
        yield "not on time", production.missed_text or "no cut"
        yield "reserve", production.reserve_text
    if production.line:
        yield "line", f"{production.line_speed_text:<22}  {production.line_text}"


def _true_figures(figures: KeyFigures) -> Iterator[tuple[str, str]]:
    """What is true of the pieces, and what the axis needs: a name and a text each."""
    if true := figures.true_pieces:
        if true.pieces:
            lengths = true.lengths
            mean = engineering(true.mean, true.unit, digits=7)
            of = f"mean {mean}" if len(lengths) == 1 else f"{len(lengths)} lengths"
            worst = engineering(abs(true.worst), true.unit, scale=figures.scale)
            yield "true length", f"{_counted(len(true.pieces), 'product')}: {of}, error at most {worst}"
        if len(true.pieces) > 1:
            sigma, allowed = (
                engineering(value, true.unit, scale=figures.scale) for value in (true.deviation, true.tolerance)
            )
            yield "sigma", f"{sigma:<22}  C_pk {true.c_pk_text} for {allowed}" if true.c_pk_text else sigma
        moves = f"the tool moves {true.movement_text} against the material at most"
        yield "in the cut", true.movement_text if math.isnan(true.movement) else moves
    if error := figures.following_error:
        yield "following", f"{engineering(error.greatest, error.unit)} at most, at {engineering(error.at, 's')}"
    if load := figures.load:
        span = f"over {_counted(load.cycles, 'cycle')}" if load.cycles else "over the whole run"
        work = "" if load.work is None else f", work {engineering(load.work, 'J')} a cycle"
        yield f"{load.what} rms", f"{_of_motor(load.rms, load.rms_share, load.unit):<22}  {span}"
        peak = _of_motor(load.peak, load.peak_share, load.unit)
        yield f"{load.what} peak", f"{peak:<22}  at {engineering(load.peak_at, 's')}"
        yield "power peak", f"{engineering(load.peak_power, 'W')}{work}"


def _of_motor(force: float, share: float | None, unit: str) -> str:
    """A force, and its share of what the motor can give: `712.3 N, 79.1 %`."""
    return engineering(force, unit) + ("" if share is None else f", {100.0 * share:.3g} %")


def _select_peaks(peaks: Sequence[Peak]) -> list[Peak]:
    """The peaks in a line: not the position; of acceleration and deceleration the one that is nearer to its limit."""
    shown = [p for p in peaks if p.name in LETTERS]
    pair = [p for p in shown if p.name in ("acceleration", "deceleration")]
    nearest = max(pair, key=lambda p: p.value / p.limit if p.limit else 0.0)
    return [p for p in shown if p not in pair or p is nearest]


def _peak_text(peak: Peak) -> str:
    """A peak as a part of a line: `v 1100 of 1500 mm/s`."""
    limit = f" of {peak.limit_text}" if peak.limit_text else ""
    value = peak.value_text.removesuffix(f" {peak.unit}") if limit else peak.value_text
    return f"{LETTERS[peak.name]} {value}{limit}"


def _print_notes(outcome: ScenarioOutcome, indent: str) -> None:
    for text in outcome.notes:
        out.print(f"{indent}[yellow]![/] {escape(text)}")


def _first_names(names: Sequence[str]) -> str:
    """The names; of many the first ones."""
    more = [f"and {len(names) - MOST_NAMES} more"] if len(names) > MOST_NAMES else []
    return ", ".join([*names[:MOST_NAMES], *more])


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"
