"""The cross-check files of a scenario: inputs as a CSV file that FMPy's own command line takes, and options."""

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from shlex import quote
from typing import Any

from ..run.simulation import scheduled_steps
from ..scenario import Scenario


def inputs_csv(scenario: Scenario) -> str:
    """The inputs at every communication point: the axis, and whatever the scenario sets. Booleans are 0 and 1."""
    by_name = scenario.recipe.variables
    names = list(dict.fromkeys(name for s in scenario.settings for name in s.values))
    values: dict[str, Any] = {name: scenario.start.get(name, by_name[name].start) for name in names}
    columns: list[tuple[str, type[float | int]]] = []
    rows = []
    for t, _, changed in scheduled_steps(scenario, scenario.step_size):
        values |= changed
        if len(values) > len(columns):
            columns = [(name, float if by_name[name].kind == "Real" else int) for name in sorted(values)]
        rows.append([t, *(number(values[name]) for name, number in columns)])
    return csv_text(["time", *sorted(values)], rows)


def csv_text(names: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    """The cross-check format: commas, quoted names, numbers with all their digits."""
    out = io.StringIO()
    writer = csv.writer(out, quoting=csv.QUOTE_NONNUMERIC, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)
    return out.getvalue()


def options_text(scenario: Scenario) -> str:
    """The .opt file next to a reference."""
    settings = {
        "StartTime": 0.0,
        "StopTime": scenario.stop_time,
        "StepSize": scenario.step_size,
        "RelTol": scenario.tolerance,
    }
    return "".join(f"{name}, {value!r}\n" for name, value in settings.items())


def inputs_file(scenario: Scenario) -> Path:
    """The input file next to a scenario; a scenario of the user's own may have none."""
    return scenario.file.parent / f"{scenario.recipe.name}_in.csv"


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
