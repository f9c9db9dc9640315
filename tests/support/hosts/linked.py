"""Runs of a block as calls of FMI 2.0, for a C host that has the unit linked in (`tests/fmu/linked_run.c`), and what a
built FMU answers to them."""

import struct
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

from motionsync_fmu.fmus.guid import compute_guid
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from motionsync_fmu.scenario.run.simulation import scheduled_steps, start_inputs
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT
from tests.support.blocks.runs import BlockRun

SCENARIO_INTERVAL, MAX_STEPS = 20, 400  # of a block's scenarios every so many; so many steps of each
LETTERS = {"Real": "R", "Boolean": "B", "Integer": "I", "Enumeration": "I"}
WORD = 2**64 - 1


def runs(name: str) -> list[BlockRun]:
    """The block's example and some of its scenarios."""
    scenarios = [load_example(name), *map(load_scenario, find_files(ROOT / "scenarios" / name)[::SCENARIO_INTERVAL])]
    return [_run(scenario) for scenario in scenarios if not scenario.reacts]


def _run(s: Scenario) -> BlockRun:
    steps = [(end - begin, values) for begin, end, values in islice(scheduled_steps(s, s.step_size), MAX_STEPS)]
    return BlockRun({**s.start, **start_inputs(s)}, steps)


def header(name: str, of: Sequence[BlockRun]) -> str:
    """run.h for `linked_run.c`."""
    recipe = Recipe(name)
    kinds = "".join(LETTERS[v.kind] for v in recipe.variables.values())
    rows = "".join(f"    {{'{what}', {r}, {bits:#x}u}},\n" for what, r, bits in _calls(recipe, of))
    calls = f"static const struct call CALLS[] = {{\n{rows}}};\n"
    return f'#define GUID "{compute_guid(recipe)}"\n#define KINDS "{kinds}"\n{calls}'


def _calls(recipe: Recipe, of: Sequence[BlockRun]) -> Iterator[tuple[str, int, int]]:
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


def answer(fmu: Path, of: Sequence[BlockRun]) -> str:
    """What the host has to print: the hash of the values that a built FMU puts out."""
    checksum = 14695981039346656037
    for run in of:
        with FmuInstance(fmu) as host:
            host.initialize(run.start)
            checksum = _mixed(checksum, host)
            for h, values in run.steps:
                host.step(h, values)
                checksum = _mixed(checksum, host)
    return f"{checksum:016x}"


def _mixed(checksum: int, host: FmuInstance) -> int:
    values = host.get()
    for name, (_, kind) in sorted(host.kinds.items(), key=lambda row: row[1][0]):
        word = _bits(values[name]) if kind == "Real" else int(values[name]) & 0xFFFFFFFF
        checksum = ((checksum ^ word) * 1099511628211) & WORD
        checksum ^= checksum >> 32
    return checksum


def _bits(x: float) -> int:
    return int(struct.unpack("<Q", struct.pack("<d", x))[0])
