"""What the page knows of a block and of its scenarios, as JSON has it."""

import hashlib
import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import HOME, __version__
from ..errors import UserError
from ..interface.recipe import Recipe
from ..interface.roles import books
from ..interface.units import unit_name
from ..interface.variables import Variable, summary
from ..pages.style import typeset
from ..scenario.clocks import BEFORE
from ..scenario.example import example_of
from ..scenario.reaction_tables import LENGTH
from ..scenario.recording import Recording
from ..scenario.run import simulate
from ..scenario.scenario import Scenario
from ..scenario.settings import Reaction
from ..scenario.shipped import FILE
from ..scenario.telegrams import Remote

JUDGED = ("count", "lengths", "kinds")  # keys of [cuts] that say what is expected of a run
SCRIPT = ("position", "velocity", "acceleration", "segments")  # keys of [master] and of [remote]
MOST = 1e9  # a declared limit beyond it limits nothing that anybody would choose


def page_data(name: str, scenarios: Iterable[Scenario], fmu: Path) -> dict[str, Any]:
    """All that the page of a block knows but the block's code; `fmu`: its native FMU, whose bits are told.

    Raises:
        UserError: no block has this name.
    """
    scenarios = [explored(s) for s in scenarios]
    recipe = Recipe(name)
    declared = recipe.variables.values()
    told = books(declared)
    names = _names(scenarios)
    return {
        "name": name,
        "version": __version__,
        "home": HOME,
        "summary": summary(type(recipe.block())),
        "variables": [_variable(v) for v in declared],
        "roles": {v.declaration.role.name: v.name for v in declared if v.declaration.role},
        "books": asdict(told) if told else None,
        "shaded": example_of(name).picture.shaded,
        "units": {_units_of(s): _unit_names(s, declared) for s in scenarios},
        "normals": _normals(scenarios),
        "scenarios": [_scenario(s, n, fmu) for s, n in zip(scenarios, names, strict=True)],
    }


def explored(scenario: Scenario) -> Scenario:
    """The scenario as a page has it: of the FMU with the declared causalities, and with nothing expected, since an
    expectation would set communication points of its own."""
    return replace(scenario, recipe=Recipe(scenario.recipe.name), expectations=())


def fingerprint(recording: Recording) -> str:
    """SHA-256 of all outputs and locals of a run, point by point, in the order of the variables."""
    return hashlib.sha256(np.column_stack(list(recording.values.values())).tobytes()).hexdigest()


def _variable(v: Variable) -> dict[str, Any]:
    d = v.declaration
    row: dict[str, Any] = {
        "name": v.name,
        "kind": v.kind,
        "causality": v.causality,
        "variability": v.variability,
        "unit": d.unit.name,
        "description": d.description,
        "choices": [[int(m), m.name, m.description] for m in v.choices],
    }
    if v.settable:
        low, high = max(d.min, d.above), min(d.max, d.below)
        row |= {"start": plain(v.start), "range": v.allowed_range if v.kind != "Boolean" else ""}
        row |= {"command": True} if d.command else {}
        row |= {"min": low} if abs(low) < MOST else {}
        row |= {"max": high} if abs(high) < MOST else {}
    return row


def _units_of(s: Scenario) -> str:
    return f"{s.unit} {s.slave_unit}".strip()


def _unit_names(s: Scenario, declared: Iterable[Variable]) -> dict[str, str]:
    kinds = {v.declaration.unit for v in declared}
    return {kind.name: typeset(unit_name(kind, s.unit, s.slave_unit)) for kind in sorted(kinds, key=lambda k: k.name)}


def _names(scenarios: Iterable[Scenario]) -> list[str]:
    """The names of the scenarios' folders or files; the second one of a name has a 2 behind it."""
    names = [s.name if s.file.name == FILE else s.file.stem for s in scenarios]
    counts = (names[: i + 1].count(name) for i, name in enumerate(names))
    return [name if count == 1 else f"{name}_{count}" for name, count in zip(names, counts, strict=True)]


def _scenario(s: Scenario, name: str, fmu: Path) -> dict[str, Any]:
    raw = tomllib.loads(s.file.read_text("utf-8-sig"))
    try:
        recording = simulate(s, fmu, s.step_size)
    except UserError:
        recording = None
    return {
        "name": name,
        "title": s.title,
        "source": s.source,
        "units": _units_of(s),
        "unit": s.unit,
        "slave_unit": s.slave_unit,
        "interface": raw.get("interface", {}),
        "stop_time": s.stop_time,
        "step_size": s.step_size,
        "step_bound": s.step_bound,
        "start": plain_values(s.start),
        "axis": {key: raw[_axis(s)][key] for key in SCRIPT if key in raw[_axis(s)]},
        "drive": _drive(s),
        "remote": _remote(s.remote) if s.remote else None,
        "settings": [{"at": setting.at, "values": plain_values(setting.values)} for setting in s.settings],
        "reactions": [_reaction(r, table) for r, table in zip(s.reactions, raw.get("on", []), strict=True)],
        "cuts": {key: value for key, value in raw.get("cuts", {}).items() if key not in JUDGED},
        "points": len(recording.time) if recording else 0,
        "sha256": fingerprint(recording) if recording else "",
    }


def _axis(s: Scenario) -> str:
    return "remote" if s.remote else "master"


def _drive(s: Scenario) -> dict[str, Any] | None:
    """`gain`: that of the scan in the file; since `expm1` is not exact, the page would compute another last bit."""
    if not s.drive:
        return None
    d = s.drive
    limit = d.max_acceleration if d.limited else None
    gain = -math.expm1(-s.scan / d.time_constant)
    drive = {"follows": d.follows, "time_constant": d.time_constant, "max_acceleration": limit}
    return drive | {"scan": s.scan, "gain": gain}


def _remote(remote: Remote) -> dict[str, Any]:
    clocks, names = remote.clocks, remote.names
    return {
        "part": names.part,
        "cycle_index": names.cycle_index,
        "task_cycle": names.task_cycle,
        "data_cycle": names.data_cycle,
        "delay": names.delay,
        "corrected_index": names.corrected_index,
        "wraps_at": clocks.wraps_at,
        "rates": [asdict(rate) for rate in clocks.rates],
        "phase": clocks.phase,
        "jitter": clocks.jitter,
        "seed": clocks.seed,
        "lost": [list(pair) for pair in clocks.lost],
        "first_index": clocks.first_index,
        "behind": remote.accuracy.behind if remote.accuracy else 0.0,
    }


def _normals(scenarios: Iterable[Scenario]) -> dict[str, list[list[float]]]:
    """The normal numbers of the jitter, by seed: those of the receiver's instants, and of the sender's; as many as the
    longest of these scenarios needs."""
    needed: dict[int, int] = {}
    for s in scenarios:
        if s.remote and s.remote.clocks.jitter:
            count = max(s.remote.cycles, int(s.remote.clocks.true_index(np.array([s.stop_time]))[0]) + 2 * BEFORE + 2)
            needed[s.remote.clocks.seed] = max(needed.get(s.remote.clocks.seed, 0), count)
    streams = ((seed, side, count) for seed, count in needed.items() for side in (0, 1))
    found: dict[str, list[list[float]]] = {}
    for seed, side, count in streams:
        normals = np.random.default_rng((seed, side)).standard_normal(count)
        found.setdefault(str(seed), []).append(normals.tolist())
    return found


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


def plain_values(values: Mapping[str, Any]) -> dict[str, float | int]:
    return {name: plain(value) for name, value in values.items()}


def plain(value: Any) -> float | int:
    """A number, of a Boolean or a member of an enumeration, too."""
    return int(value) if isinstance(value, int) else float(value)
