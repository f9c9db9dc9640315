"""What the page knows of a block and of its scenarios, as JSON has it."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from motionsync import var

from ..about import HOME, __version__
from ..batch.block_memory import STORED, block_memory
from ..batch.simulation import limits
from ..compiler.memory_layout import dtype
from ..errors import UserError
from ..interface.recipe import Recipe
from ..interface.variables import field_types, summary
from ..pages.machine.block_json import block_json, plain, plain_values, units_of, variable_json
from ..runner import telegrams
from ..runner.points import CLOSE
from ..runner.run import Run
from ..scenario import clocks
from ..scenario.encoder import Encoder
from ..scenario.files import encoder_table
from ..scenario.files.example import load_example
from ..scenario.files.reaction_tables import LENGTH
from ..scenario.files.reader import read_tables
from ..scenario.files.shipped import SCENARIO_FILE
from ..scenario.recording import Recording
from ..scenario.remote_view import RemoteView
from ..scenario.run.simulation import simulate
from ..scenario.run.tables import COMPARISONS
from ..scenario.scenario import Scenario
from ..scenario.settings import Reaction
from .opening import opening_of

SCALARS = ("title", "source", "unit", "slave_unit", "stop_time", "step_size", "step_bound")
EXPECTED = ("count", "skipped", "lengths", "kinds")  # keys of [cuts] that say what is expected of a run
SCRIPT = ("position", "velocity", "acceleration", "segments")  # keys of [master] and of [remote]


def page_data(name: str, scenarios: Iterable[Scenario], fmu: Path) -> dict[str, Any]:
    """All data of a block's page but the block's code; `fmu`: its native FMU, whose bits the page shows.

    Raises:
        UserError: no block has this name.
    """
    scenarios = [explored(s) for s in scenarios]
    recipe = Recipe(name)
    declared = recipe.variables.values()
    memory, ranges = block_memory(recipe), sorted({limits(v) for v in declared if v.checked})
    names = _names(scenarios)
    return block_json(recipe, scenarios) | {
        "name": name,
        "version": __version__,
        "home": HOME,
        "summary": summary(type(recipe.block())),
        "variables": [
            variable_json(v)
            | {"offset": memory.fields[v.name].offset}
            | ({"limit": ranges.index(limits(v))} if v.checked else {})
            for v in declared
        ],
        "runner": _runner() | {"limits": ranges},
        "shaded": load_example(name).picture.shaded,
        "main": opening_of(name).main,
        "normals": _normals(scenarios),
        "ideal_encoder": asdict(Encoder()),
        "scenarios": [_scenario(s, n, fmu) for s, n in zip(scenarios, names, strict=True)],
    }


def explored(scenario: Scenario) -> Scenario:
    """The scenario as a page has it: of the FMU with the declared causalities, and with nothing expected, since an
    expectation would set communication points of its own."""
    return replace(scenario, recipe=Recipe(scenario.recipe.name), expectations=())


def fingerprint(recording: Recording) -> str:
    """SHA-256 of all outputs and locals of a run, point by point, in the order of the variables."""
    return hashlib.sha256(np.column_stack(list(recording.values.values())).tobytes()).hexdigest()


def _runner() -> dict[str, Any]:
    """What the page needs to write and read a run in the module's memory, and numbers that have one meaning in Python
    and in C. `layout`: of each member of the run the offset, how it is stored, and its start value."""
    return {
        "layout": {name: [offset, kind, start] for name, offset, kind, start in _members(Run(), dtype(Run()))},
        "size": dtype(Run()).itemsize,
        "stored": {kind: int(stored) for kind, stored in STORED.items()},
        "comparisons": {sign: int(comparison) for sign, comparison in COMPARISONS.items()},
        "close": CLOSE,
        "cycle_close": telegrams.CLOSE,
        "largest_jitter": clocks.LARGEST_JITTER,
        "sent_before_start": clocks.SENT_BEFORE_START,
        "encoder": {
            "smallest": encoder_table.SMALLEST,
            "most": encoder_table.MOST,
            "longest": encoder_table.LONGEST,
        },
    }


def _members(part: Any, layout: Any, path: str = "", begin: int = 0) -> Iterator[tuple[str, int, str, float]]:
    """The members of a part of a run: name, offset, kind and start value; of series the kind of their numbers."""
    part_class: type = type(part)
    hints = field_types(part_class)
    for f in fields(part):
        value, name, offset = getattr(part, f.name), f"{path}{f.name}", begin + layout.fields[f.name][1]
        if is_dataclass(value):
            yield from _members(value, layout.fields[f.name][0], f"{name}.", offset)
        elif f.metadata.get("series", False):
            yield name, offset, "reals" if hints[f.name] == var.Reals else "wholes", 0
        else:
            yield name, offset, {float: "real", bool: "flag"}.get(hints[f.name], "whole"), plain(value)


def _names(scenarios: Iterable[Scenario]) -> list[str]:
    """The names of the scenarios' folders or files; the second one of a name has a 2 behind it."""
    names = [s.name if s.file.name == SCENARIO_FILE else s.file.stem for s in scenarios]
    counts = (names[: i + 1].count(name) for i, name in enumerate(names))
    return [name if count == 1 else f"{name}_{count}" for name, count in zip(names, counts, strict=True)]


def _scenario(s: Scenario, name: str, fmu: Path) -> dict[str, Any]:
    raw = read_tables(s.text, s.file).values
    try:
        recording = simulate(s, fmu, s.step_size)
    except UserError:
        recording = None
    return {key: getattr(s, key) for key in SCALARS} | {
        "name": name,
        "units": units_of(s),
        "interface": raw.get("interface", {}),
        "start": plain_values({variable: s.start[variable] for variable in raw.get("start", {})}),
        "axis": _recorded(s) if s.is_recorded else {key: raw[_axis(s)][key] for key in SCRIPT if key in raw[_axis(s)]},
        "encoder": asdict(s.encoder) if s.encoder else None,
        "drive": _drive(s),
        "remote": _remote(s.remote) if s.remote else None,
        "settings": [{"at": setting.at, "values": plain_values(setting.values)} for setting in s.settings],
        "reactions": [_reaction(r, table) for r, table in zip(s.reactions, raw.get("on", []), strict=True)],
        "cuts": {key: value for key, value in raw.get("cuts", {}).items() if key not in EXPECTED},
        "points": len(recording.time) if recording else 0,
        "sha256": fingerprint(recording) if recording else "",
    }


def _axis(s: Scenario) -> str:
    return "remote" if s.remote else "master"


def _recorded(s: Scenario) -> dict[str, Any]:
    """A recorded line: its rows, with unwrapped positions and the velocities after them, and that at the start."""
    times, motions = np.array(s.master.breaks).tolist(), s.master.table()[:, :2].tolist()
    return {"times": times, "motions": motions, "velocity": s.master.initial.velocity}


def _drive(s: Scenario) -> dict[str, Any] | None:
    """`gain`: that of the scan in the file; `expm1` is not exact, so the page might compute another last bit."""
    if not s.drive:
        return None
    d = s.drive
    limit = d.max_acceleration if d.has_acceleration_limit else None
    gain = d.gain(s.scan)
    drive = {"follows": d.follows, "time_constant": d.time_constant, "max_acceleration": limit}
    return drive | {"scan": s.scan, "gain": gain}


def _remote(remote: RemoteView) -> dict[str, Any]:
    """The clocks, and the names of the variables that hold the lengths of the receiver's cycles and the delay."""
    behind = remote.accuracy.behind if remote.accuracy else 0.0
    return asdict(remote.clocks) | asdict(remote.names) | {"behind": behind}


def _normals(scenarios: Iterable[Scenario]) -> dict[str, list[list[float]]]:
    """The normal numbers of the jitter, by seed: those of the receiver's instants, and of the sender's; as many as the
    longest of these scenarios needs."""
    needed: dict[int, int] = {}
    for s in scenarios:
        if s.remote and s.remote.clocks.jitter:
            sent = int(s.remote.clocks.true_index(np.array([s.stop_time]))[0])
            count = max(s.remote.cycles, sent + 2 * clocks.SENT_BEFORE_START + 2)
            needed[s.remote.clocks.seed] = max(needed.get(s.remote.clocks.seed, 0), count)
    return {
        str(seed): [np.random.default_rng((seed, side)).standard_normal(count).tolist() for side in (0, 1)]
        for seed, count in needed.items()
    }


def _reaction(r: Reaction, table: Mapping[str, Any]) -> dict[str, Any]:
    """`table`: the file's own, in which the length of [cuts] has its name."""
    named = [name for name, value in table.get("add", {}).items() if value == LENGTH]
    return {
        "when": r.condition.text,
        "name": r.condition.name,
        "comparison": r.condition.comparison,
        "value": float(r.condition.value),
        "first": float(r.condition.value),
        "after": r.after,
        "set": plain_values(r.set),
        "add": plain_values(r.add) | dict.fromkeys(named, LENGTH),
        "times": r.times,
        "required": r.required,
    }
