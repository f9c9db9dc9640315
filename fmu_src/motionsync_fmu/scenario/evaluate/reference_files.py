"""A scenario for FMPy's own command line: its inputs as a CSV file, and the call."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from shlex import quote
from typing import Any, TextIO

from ..run.simulation import scheduled_steps
from ..scenario import Scenario


def inputs_csv(scenario: Scenario) -> str:
    """The text of `write_inputs`."""
    out = io.StringIO()
    write_inputs(out, scenario)
    return out.getvalue()


def write_inputs(out: TextIO, scenario: Scenario) -> None:
    """Write the inputs at every communication point: the axis, and whatever the scenario sets. Booleans are 0 and 1."""
    by_name = scenario.recipe.variables
    steps = scheduled_steps(scenario, scenario.step_size)
    first = next(steps)
    changing = {name: scenario.start.get(name, by_name[name].start) for s in scenario.settings for name in s.values}
    values: dict[str, Any] = changing | first[2]
    columns = [(name, float if by_name[name].kind == "Real" else int) for name in sorted(values)]

    def rows() -> Iterator[list[float]]:
        for time, _, changed in chain([first], steps):
            values.update(changed)
            yield [time, *(number(values[name]) for name, number in columns)]

    write_csv(out, ["time", *(name for name, _ in columns)], rows())


def csv_text(names: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    """The text of `write_csv`."""
    out = io.StringIO()
    write_csv(out, names, rows)
    return out.getvalue()


def write_csv(out: TextIO, names: Sequence[str], rows: Iterable[Sequence[float]]) -> None:
    """Write CSV as FMPy and the FMI cross-check have it: commas, quoted names, numbers with all their digits."""
    writer = csv.writer(out, quoting=csv.QUOTE_NONNUMERIC, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)


def command_line(scenario: Scenario, fmu: Path, inputs: Path) -> str:
    """The call of FMPy that runs the scenario from its input file, without motionsync."""
    by_name = scenario.recipe.variables
    starts = " ".join(f"{name} {by_name[name].literal(value)}" for name, value in scenario.start.items())
    parts = [
        f"fmpy simulate {quote(str(fmu))} --stop-time {scenario.stop_time!r} --output-interval {scenario.step_size!r}",
        f"--start-values {starts}" if starts else "",
        f"--input-file {quote(str(inputs))} --output-file {scenario.recipe.name}_out.csv",
    ]
    return " ".join(filter(None, parts))
