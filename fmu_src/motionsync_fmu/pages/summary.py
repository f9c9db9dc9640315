"""What `motionsync run` prints: a result for each scenario, and a summary of all."""

from collections.abc import Iterator, Mapping, Sequence

from rich.markup import escape

from ..scenario.amounts import engineering
from ..scenario.figures import Peak
from ..scenario.judge import Check, Deviation
from ..scenario.outcome import Outcome
from ..scenario.production import Production
from .console import out, print_headline, verdict

LETTERS = {"velocity": "v", "acceleration": "a", "deceleration": "d", "jerk": "j"}
MOST_MESSAGES = 3  # of the FMU that a result shows; --verbose shows all
LONGEST = 100  # characters of such a message
MOST_NAMES = 5  # of scenarios that the summary names


def print_row(outcome: Outcome, width: int) -> None:
    """Print one result of several: one line, and below it what is broken and what has to be known.

    `width`: of the column of names."""
    mark = "[green]ok [/]" if outcome.passed else "[red]NOT[/]"
    if outcome.passed and outcome.remarks:
        mark = "[yellow]ok![/]"
    told = [outcome.figures.work_text, ", ".join(_short(p) for p in _shown(outcome.figures.peaks))]
    if outcome.messages:
        told.append(f"{_counted(len(outcome.messages), 'message')} of the FMU")
    out.print(f"{mark} {escape(f'{outcome.name:<{width}}')}  {escape('; '.join(filter(None, told)))}")
    _print_judged(outcome.broken, "    ")
    _print_remarks(outcome, "    ")


def print_result(outcome: Outcome, *, verbose: bool) -> None:
    """Print the result of one scenario: its figures, a line each, and what is not as expected.

    `verbose`: everything that was judged, everything that the FMU logged, and how FMPy alone does the same."""
    print_headline(outcome.title, outcome.scenario, outcome.passed, len(outcome.remarks))
    _print_remarks(outcome, "  ")
    for name, text in _figures(outcome):
        out.print(f"  {name:<12}  {escape(text)}")
    _print_judged([*outcome.expectations, *outcome.reference] if verbose else outcome.broken, "  ")
    number = len(outcome.messages)
    shown = outcome.messages if verbose or number <= MOST_MESSAGES else outcome.messages[:MOST_MESSAGES]
    for message in shown:
        out.print(f"  the FMU logged: {escape(message if verbose else _shortened(message))}")
    if number > len(shown):
        out.print(f"  the FMU logged {number - len(shown)} more; --verbose shows all")
    out.print(f"  {'result':<12}  {escape(outcome.result)}")
    if verbose:
        out.print(f"  the same with FMPy alone: {escape(outcome.fmpy)}\n")


def print_summary(outcomes: Sequence[Outcome], left_out: Mapping[str, list[str]]) -> None:
    """Print how many scenarios are as expected, and which are not.

    `left_out`: the names of scenarios that were not run, by the reason."""
    broken = [o.name for o in outcomes if not o.passed]
    number = f"\n[bold]{_counted(len(outcomes), 'scenario')}[/]: "
    if not broken:
        out.print(f"{number}[green]{'all ' * (len(outcomes) > 1)}as expected[/]")
    else:
        good = len(outcomes) - len(broken)
        out.print(f"{number}{good} as expected, [red]{len(broken)} not[/]: {escape(_named(broken))}")
    if remarked := [o.name for o in outcomes if o.remarks]:
        out.print(f"[yellow]![/] {_counted(len(remarked), 'result')} with a remark: {escape(_named(remarked))}")
    for reason, names in left_out.items():
        out.print(f"[yellow]![/] {len(names)} not run: {escape(reason)}: {escape(_named(names))}")


def _figures(outcome: Outcome) -> Iterator[tuple[str, str]]:
    """The figures of a result, a name and a text each."""
    figures = outcome.figures
    if figures.tolerance is not None:
        yield "saw", f"{figures.cuts_text}; {figures.tolerance_text} allowed"
    if figures.production:
        yield from _made(figures.production)
    for p in figures.peaks:
        yield p.name, f"{p.value_text:<22}  limit {p.limit_text}" if p.limit_text else p.value_text
    if outcome.expectations:
        kept, number = sum(c.passed for c in outcome.expectations), len(outcome.expectations)
        yield "expectations", f"{kept} of {number} kept"
    if outcome.reference:
        kept, number = sum(d.passed for d in outcome.reference), len(outcome.reference)
        yield "reference", f"{kept} of {_counted(number, 'variable')} agree"


def _made(made: Production) -> Iterator[tuple[str, str]]:
    """What was made, a name and a text each."""
    yield "made", made.pieces_text
    if made.worst:
        allowed = engineering(made.tolerance, made.unit)
        yield "length error", f"{made.worst_text:<22}  {allowed} allowed"
    if made.tightest:
        yield "not on time", made.missed_text or "no cut"
        yield "reserve", f"at least {made.reserve_text} of a cycle"
    if made.line:
        yield "line", f"{made.line.greatest_text:<22}  {made.line.limit_text}"


def _shown(peaks: Sequence[Peak]) -> list[Peak]:
    """The peaks of a line: not the position; of acceleration and deceleration the one that is nearer to its limit."""
    shown = [p for p in peaks if p.name in LETTERS]
    pair = [p for p in shown if p.name in ("acceleration", "deceleration")]
    nearest = max(pair, key=lambda p: p.value / p.limit if p.limit else 0.0)
    return [p for p in shown if p not in pair or p is nearest]


def _short(peak: Peak) -> str:
    """A peak as a part of a line: `v 1100 of 1500 mm/s`."""
    limit = f" of {peak.limit_text}" if peak.limit_text else ""
    value = peak.value_text.removesuffix(f" {peak.unit}") if limit else peak.value_text
    return f"{LETTERS[peak.name]} {value}{limit}"


def _print_judged(judged: Sequence[Check | Deviation], indent: str) -> None:
    for j in judged:
        out.print(f"{indent}{verdict(j.passed)}  {escape(j.text)}")


def _print_remarks(outcome: Outcome, indent: str) -> None:
    for text in outcome.remarks:
        out.print(f"{indent}[yellow]![/] {escape(text)}")


def _shortened(message: str) -> str:
    text = " ".join(message.split())
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def _named(names: Sequence[str]) -> str:
    """The names, of many the first ones."""
    more = [f"and {len(names) - MOST_NAMES} more"] if len(names) > MOST_NAMES else []
    return ", ".join([*names[:MOST_NAMES], *more])


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"
