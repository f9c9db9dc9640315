"""Runs of a block as calls of FMI 2.0, for a C host that has the unit linked in (`tests/fmu/linked_run.c`), and what a
built FMU answers to them."""

import struct
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.example import example_of
from motionsync_fmu.scenario.fmu_instance import FmuInstance
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.run import inputs, schedule
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.shipped import find
from tests import ROOT
from tests.support.runs import Run

EVERY, MOST = 20, 400  # of a block's scenarios every so many; so many steps of each
LETTERS = {"Real": "R", "Boolean": "B", "Integer": "I", "Enumeration": "I"}
WORD = 2**64 - 1


def runs(name: str) -> list[Run]:
    """The block's example and some of its scenarios."""
    scenarios = [example_of(name), *map(load, find(ROOT / "scenarios" / name)[::EVERY])]
    return [_run(scenario) for scenario in scenarios if not scenario.reacts]


def _run(s: Scenario) -> Run:
    steps = [(end - begin, values) for begin, end, values in islice(schedule(s, s.step_size), MOST)]
    return Run({**s.start, **inputs(s, s.master, 0.0, 0.0)}, steps)


def header(name: str, of: Sequence[Run]) -> str:
    """run.h for `linked_run.c`."""
    recipe = Recipe(name)
    kinds = "".join(LETTERS[v.kind] for v in recipe.variables.values())
    rows = "".join(f"    {{'{what}', {r}, {bits:#x}u}},\n" for what, r, bits in _calls(recipe, of))
    calls = f"static const struct call CALLS[] = {{\n{rows}}};\n"
    return f'#define GUID "{recipe.guid()}"\n#define KINDS "{kinds}"\n{calls}'


def _calls(recipe: Recipe, of: Sequence[Run]) -> Iterator[tuple[str, int, int]]:
    references = {name: (r, LETTERS[v.kind]) for r, (name, v) in enumerate(recipe.variables.items())}

    def settings(values: Mapping[str, Any]) -> Iterator[tuple[str, int, int]]:
        for name, value in values.items():
            r, letter = references[name]
            yield letter, r, _bits(value) if letter == "R" else int(value) & 0xFFFFFFFF

    for run in of:
        yield "n", 0, 0
        yield from settings(run.start)
        yield "x", 0, 0
        for h, values in run.steps:
            yield from settings(values)
            yield "s", 0, _bits(h)


def answer(fmu: Path, of: Sequence[Run]) -> str:
    """What the host has to print: the hash of the values that a built FMU puts out."""
    found = 14695981039346656037
    for run in of:
        with FmuInstance(fmu) as host:
            host.initialize(run.start)
            found = _mixed(found, host)
            for h, values in run.steps:
                host.step(h, values)
                found = _mixed(found, host)
    return f"{found:016x}"


def _mixed(found: int, host: FmuInstance) -> int:
    values = host.get()
    for name, (_, kind) in sorted(host.kinds.items(), key=lambda row: row[1][0]):
        word = _bits(values[name]) if kind == "Real" else int(values[name]) & 0xFFFFFFFF
        found = ((found ^ word) * 1099511628211) & WORD
        found ^= found >> 32
    return found


def _bits(x: float) -> int:
    return int(struct.unpack("<Q", struct.pack("<d", x))[0])
