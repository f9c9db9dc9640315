"""The CSV files of a run: its outputs, and its inputs with the call of FMPy's own command that takes them."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from shlex import quote
from typing import Any, TextIO

import numpy as np

from ..recording import Reals, Recording
from ..run.simulation import scheduled_steps
from ..scenario import Scenario

FIRST = ("state", "in_sync")  # columns of the outputs, after time, master and slave
ROWS = 1000  # of the outputs, that are made at a time: as Python's numbers they need a multiple of the memory
MASTER = ("position", "velocity", "acceleration", "jerk")


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


def write_outputs(out: TextIO, scenario: Scenario, recording: Recording) -> None:
    """Write all columns of a run; only Reals have a point."""
    kinds = {name: v.kind for name, v in scenario.columns.items()}
    columns = output_columns(scenario, recording)
    types = [float if kinds.get(name, "Real") == "Real" else int for name in columns]

    def rows() -> Iterator[tuple[float, ...]]:
        for i in range(0, len(recording.time), ROWS):
            parts = (column[i : i + ROWS] for column in columns.values())
            yield from zip(*(part.astype(t).tolist() for part, t in zip(parts, types, strict=True)), strict=True)

    write_csv(out, list(columns), rows())


def output_columns(scenario: Scenario, recording: Recording) -> dict[str, Reals]:
    """Time, the scripted axis, what is measured of it, the slave, the columns that are computed of it, state, in_sync,
    then the other variables, each of shape (points,)."""
    values = recording.columns
    slave = [name for name in values if name.startswith("slave.")]
    names = [*slave, *recording.computed, *(name for name in FIRST if name in values)]
    measured = measured_inputs(scenario, recording)
    axis = "true_axis" if scenario.remote else "true.master" if measured else "master"
    master = {f"{axis}.{name}": column for name, column in zip(MASTER, recording.master.T, strict=True)}
    return {"time": recording.time, **master, **measured, **{name: values[name] for name in names}, **values}


def measured_inputs(scenario: Scenario, recording: Recording) -> dict[str, Reals]:
    """What the encoder says of the master at the communication points, by the names of the inputs; none without one."""
    encoder, line = scenario.encoder, recording.script or scenario.master
    if not encoder or scenario.is_recorded:
        return {}
    readings = encoder.readings(line, recording.time.tolist(), scenario.step_size, scenario.period)
    return dict(zip(("master.position", "master.velocity"), np.array([*readings])[:, :2].T, strict=True))


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
