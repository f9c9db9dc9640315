"""Writes the reference of every scenario and example, from the oracle, and says which have changed, and by how much.

python -m tests.regenerate [FOLDER ...]
"""

import csv
import sys
import time
import tomllib
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from motionsync.blocks import BLOCKS
from motionsync.master import MasterInput
from motionsync_fmu.fmus.zip import zip_bytes
from motionsync_fmu.interface.block_folder import block_file
from motionsync_fmu.interface.build_time import FIRST_INSTANT
from motionsync_fmu.runner.points import rounded
from motionsync_fmu.scenario.evaluate.csv_files import csv_text
from motionsync_fmu.scenario.evaluate.reference_comparison import ARCHIVE, reference_file
from motionsync_fmu.scenario.files import example
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.run.simulation import scheduled_steps, start_inputs
from motionsync_fmu.scenario.run.tables import RunTables
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script
from motionsync_fmu.scenario.settings import Reaction, Setting
from tests import ROOT
from tests.oracle.measured_master import MeasuredMaster
from tests.oracle.reactions import settled
from tests.support.blocks.by_block import block_folder

SCENARIOS = ROOT / "scenarios"
SMOOTHED = ("time", "master.smoothed_position", "master.smoothed_velocity", "master.smoothed_acceleration")
POINTS = 200  # of a reference, about
Keep: TypeAlias = Callable[[object, Callable[[], Any]], Any]
"""`keep(question, find)` is what `find()` returns, or what it has returned for an equal question."""


def oracle(name: str) -> Any:
    """The block's module in `tests/oracle`.

    The module has COLUMNS, the names of the variables in a reference, and the function `reference(script, times)`. For
    a block with a remote axis it has the class <Block>Oracle instead of the function: the class is made from the
    parameters and first inputs, and is then stepped with all inputs.

    Raises:
        LookupError: the block has no oracle that makes references.
    """
    module = f"tests.oracle.{block_folder(name)}"
    result = import_module(module) if find_spec(module) else None
    if not hasattr(result, "COLUMNS"):
        raise LookupError(
            f"{name} needs tests/oracle/{block_folder(name)}.py with COLUMNS and reference(script, times)"
        )
    return result


def find_anew(_question: object, find: Callable[[], Any]) -> Any:
    return find()


def with_reference(scenario_file: Path, keep: Keep = find_anew) -> tuple[Scenario, str]:
    """A scenario, with its reactions where the oracle finds them, and the text of its reference. `keep` may know what
    the oracle finds."""
    scenario = load_scenario(scenario_file)
    name = scenario.recipe.name
    steps = round(scenario.stop_time / scenario.step_size)
    stride = max(steps // POINTS, 1)
    times = [i * scenario.step_size for i in range(0, steps + 1, stride)]
    independent, columns = oracle(name), SMOOTHED
    if scenario.start.get("master.input_mode") == MasterInput.MEASURED:
        rows = smoothed(scenario, times[1:], keep)
    elif scenario.remote:
        columns = ("time", *independent.COLUMNS)
        rows = stepped(getattr(independent, f"{name}Oracle"), scenario, times[1:], keep)
    else:
        columns = ("time", *independent.COLUMNS)
        script, rows = solved(scenario, times, keep)
        if scenario.reacts:
            scenario = scenario.with_recorded_inputs(settings(script), master(scenario, script))
    if scenario.start.get("master.input_mode") == MasterInput.POSITION_ONLY:  # an estimate lags at jumps
        columns = ("time", "slave.position")
    return scenario, csv_text(columns, [[row[c] + 0.0 for c in columns] for row in rows])


def examples(names: Iterable[str] = BLOCKS) -> list[Path]:
    """The example of each block."""
    return [block_file(BLOCKS[name], example.FILE) for name in names]


def independent_script(scenario: Scenario) -> dict[str, Any]:
    """What an oracle gets: the tables of the file, with the members of enumerations as numbers.

    Raises:
        LookupError: the scenario reacts, and the oracle is one that is stepped.
    """
    script = tomllib.loads(scenario.file.read_text()) | {"start": scenario.start}
    if not scenario.reacts:
        return script
    if scenario.remote:
        raise LookupError(f"{scenario.file}: the oracle of a block with a remote axis finds no reactions")
    declared = scenario.recipe.variables
    added = {name: declared[name].start for r in scenario.reactions for name in r.add}
    tables = [on_table(r) for r in scenario.reactions]
    return script | {"start": {**added, **scenario.start}, "on": tables}


def solved(
    scenario: Scenario, times: Sequence[float], keep: Keep = find_anew
) -> tuple[dict[str, Any], list[dict[str, float]]]:
    """The sets and the master's segments that the oracle's own trajectory makes of the reactions and of what the master
    follows, as tables of a script, and the outputs in the reference at those times."""
    script, independent = independent_script(scenario), oracle(scenario.recipe.name)

    def find() -> Any:
        settled_script = settled(script, independent.reference) if scenario.reacts else script
        rows = independent.reference(settled_script, times)
        columns = ("time", *independent.COLUMNS)
        return {"set": settled_script.get("set", []), "master": settled_script["master"]}, [
            {c: row[c] for c in columns} for row in rows
        ]

    settled_script, rows = keep((independent.__name__, script, times), find)
    return settled_script, rows


def on_table(reaction: Reaction) -> dict[str, Any]:
    """A reaction as a table [[on]] in numbers."""
    c = reaction.condition
    table = {"when": f"{c.name} {c.comparison} {c.value!r}", "after": reaction.after}
    return {**table, "set": reaction.set, "add": reaction.add, "times": reaction.times}


def settings(script: Mapping[str, Any]) -> list[Setting]:
    """The tables [[set]] of a script."""
    return [Setting(t["at"], {name: value for name, value in t.items() if name != "at"}) for t in script["set"]]


def master(scenario: Scenario, script: Mapping[str, Any]) -> Script:
    """The scenario's master; one that follows the block has its motion from the script's segments, one a scan."""
    if not scenario.drive:
        return scenario.master
    tables = RunTables(scenario, scenario.step_size)
    for scan, segment in enumerate(script["master"]["segments"][1:], 1):
        tables.run.axis.accelerate(rounded(scan * scenario.scan), float(segment["acceleration"]))
    return tables.script


def stepped(
    oracle_type: Callable[..., Any], scenario: Scenario, times: Sequence[float], keep: Keep = find_anew
) -> list[dict[str, float]]:
    """The outputs, at some of the steps' ends, of an oracle that gets in each step the inputs of the FMU.

    Raises:
        LookupError: the scenario reacts.
    """
    independent_script(scenario)
    declared = scenario.recipe.variables
    parameters = {name: value for name, value in scenario.start.items() if declared[name].causality == "parameter"}
    inputs = {name: value for name, value in scenario.start.items() if declared[name].causality == "input"}
    inputs |= start_inputs(scenario)
    steps = list(scheduled_steps(scenario, scenario.step_size))
    required = {round(t / scenario.step_size, 6): t for t in times}

    def find() -> list[dict[str, float]]:
        present, rows = dict(inputs), []
        running = oracle_type(parameters, present)
        for start, end, changed in steps:
            present |= changed
            result = running.step(dict(present), end - start)
            if (step := round(end / scenario.step_size, 6)) in required:
                rows.append({"time": required[step], **{name: float(value) for name, value in result.items()}})
        return rows

    rows: list[dict[str, float]] = keep((oracle_type.__name__, parameters, inputs, steps, required), find)
    return rows


def smoothed(scenario: Scenario, times: Sequence[float], keep: Keep = find_anew) -> list[dict[str, float]]:
    """The master as the block follows it, at some of the steps' ends, in mode MEASURED: the oracles of the blocks know
    an ideal master only.

    Raises:
        LookupError: the scenario reacts.
    """
    if scenario.reacts:
        raise LookupError(f"{scenario.file}: the oracle of a measured master finds no reactions")
    parameters = ("smoothing_time", "delay", "sample_time", "period")
    given = {name: scenario.start[f"master.{name}"] for name in parameters if f"master.{name}" in scenario.start}
    names = [f"master.{name}" for name in ("position", "velocity", "acceleration")]
    first = [start_inputs(scenario)[name] for name in names]
    steps = [
        (end, end - t, [values[name] for name in names])
        for t, end, values in scheduled_steps(scenario, scenario.step_size)
    ]
    required = {round(t / scenario.step_size, 6): t for t in times}

    def find() -> list[dict[str, float]]:
        line, rows = MeasuredMaster(*first, **given), []
        for end, h, inputs in steps:
            line.step(h, *inputs)
            if (step := round(end / scenario.step_size, 6)) in required:
                path = (line.wrapped, line.path.velocity, line.path.acceleration)
                rows.append(dict(zip(SMOOTHED, (required[step], *map(float, path)), strict=True)))
        return rows

    rows: list[dict[str, float]] = keep(("measured_master", given, first, steps, required), find)
    return rows


def write_references(name: str) -> Iterator[str]:
    """Write the references of a block's scenarios and example; a line for each that has changed.

    An archive is written only where a text has changed: another version of the compressor gives other bytes.
    """
    folder, made = SCENARIOS / name, dict[Path, bytes]()
    before = {folder / member: text for member, text in archived(folder / ARCHIVE).items()}
    for scenario_file in find_files(folder):
        scenario, text = with_reference(scenario_file)
        made[file := reference_file(scenario)] = text.encode()
        yield from described(scenario.label, before.get(file), made[file])
    yield from (f"{name}/{file.parent.name}: the reference is no more" for file in before.keys() - made.keys())
    if made != before:
        members = {file.relative_to(folder).as_posix(): text for file, text in made.items()}
        (folder / ARCHIVE).write_bytes(zip_bytes(members, time.gmtime(FIRST_INSTANT)))
    for scenario_file in examples([name]):
        scenario, text = with_reference(scenario_file)
        file = reference_file(scenario)
        yield from described(scenario.label, file.read_bytes() if file.exists() else None, text.encode())
        file.write_text(text)


def archived(archive: Path) -> dict[str, bytes]:
    """The members of an archive, by their names; none without one."""
    if not archive.exists():
        return {}
    with zipfile.ZipFile(archive) as z:
        return {name: z.read(name) for name in z.namelist()}


def described(label: str, before: bytes | None, now: bytes) -> Iterator[str]:
    """A line about the greatest difference of two references; none if they are the same."""
    if before is None:
        yield f"{label}: the reference is new"
    elif before != now:
        (old, *rows_before), (header, *rows) = (list(csv.reader(text.decode().splitlines())) for text in (before, now))
        if header != old or [row[0] for row in rows] != [row[0] for row in rows_before]:
            yield f"{label}: the reference has other columns or times"
        else:
            differences = np.abs(np.array(rows, float) - np.array(rows_before, float))
            row, column = np.unravel_index(np.argmax(differences), differences.shape)
            yield f"{label}: {header[column]} differs by {differences[row, column]:.3g} at {rows[row][0]} s"


if __name__ == "__main__":
    for block in BLOCKS:
        if not sys.argv[1:] or block_folder(block) in sys.argv[1:]:
            print(f"{block}:", *(list(write_references(block)) or ["no reference has changed"]), sep="\n  ", flush=True)
