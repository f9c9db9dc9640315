"""The block as WebAssembly has the native FMU's bits: all outputs and locals at all points of all scenarios."""

import hashlib
from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wasmtime

from motionsync_fmu.explore.data import explored as shown
from motionsync_fmu.explore.page import scenarios_of
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.interface.variables import Variable
from motionsync_fmu.scenario.run import inputs, run_in_process, schedule, simulate
from motionsync_fmu.scenario.scenario import Scenario
from tests.support.explored import Explored, explored
from tests.support.fmus import Fmus

HERE = Path(__file__).parent
PAGE = 65536
STEP = 0
ENTRY = np.dtype([("what", "<i4"), ("reference", "<i4"), ("value", "<f8")])
KINDS = {"Real": 1, "Integer": 2, "Enumeration": 2, "Boolean": 3}
Step = tuple[float, float, dict[str, Any]]


class Module:
    """The module of a page in wasmtime, and its runs, each with an instance of its own.

    Attributes:
        told: what the last run has logged.
    """

    def __init__(self, code: bytes, variables: Mapping[str, Variable]) -> None:
        self.kinds = {v.name: (KINDS[v.kind], i) for i, v in enumerate(variables.values())}
        self.outputs = [v.name for v in variables.values() if not v.settable]
        self.engine = wasmtime.Engine()
        self.module = wasmtime.Module(self.engine, code)
        self.driver = wasmtime.Module(self.engine, (HERE / "replay.wat").read_text("utf-8"))
        self.told: list[str] = []

    def _begin(self) -> None:
        self.told = []
        self.store, linker = wasmtime.Store(self.engine), wasmtime.Linker(self.engine)
        told = wasmtime.FuncType([wasmtime.ValType.i32()] * 3, [])
        linker.define_func("page", "told", told, self._tell)
        instance = linker.instantiate(self.store, self.module)
        self.web = instance.exports(self.store)
        linker.define_instance(self.store, "web", instance)
        self.replay = linker.instantiate(self.store, self.driver).exports(self.store)["replay"]
        assert self.web["begin"](self.store)

    def _tell(self, status: int, place: int, length: int) -> None:
        self.told.append(bytes(self.web["memory"].read(self.store, place, place + length)).decode())

    @cached_property
    def row(self) -> list[str]:
        """The outputs and locals in the order in which the module gives them."""
        return sorted(self.outputs, key=lambda name: self.kinds[name][0])

    def run(self, start: dict[str, Any], steps: list[Step]) -> np.ndarray:
        """All outputs and locals after the initialization and after each step, in the order of the variables."""
        self._begin()
        entries = [(*self.kinds[name], self._value(name, x)) for name, x in start.items()]
        at = self._put(np.array(entries, ENTRY).tobytes())
        listed = self._put(np.array([self.kinds[name][1] for name in self.row], "<i4").tobytes())
        counts = [sum(self.kinds[name][0] == kind for name in self.row) for kind in (1, 2, 3)]
        rows = self._put(bytes(8 * len(self.row) * (len(steps) + 1)))
        assert self.replay(self.store, at, at + 16 * len(entries), listed, *counts, rows) == 0, self.told
        assert self.web["initialize"](self.store) == 0, self.told
        self.web["get"](self.store, listed, *counts, rows)
        tape = np.array(list(self._tape(steps)), ENTRY)
        at = self._put(tape.tobytes())
        end = self.web["memory"].data_len(self.store)
        assert self.replay(self.store, at, at + tape.nbytes, listed, *counts, rows + 8 * len(self.row)) == 0, self.told
        assert end == self.web["memory"].data_len(self.store)  # a run allocates nothing
        seen = self.web["memory"].read(self.store, rows, rows + 8 * len(self.row) * (len(steps) + 1))
        order = [self.row.index(name) for name in self.outputs]
        return np.frombuffer(seen, "<f8").reshape(len(steps) + 1, len(self.row))[:, order]

    def _tape(self, steps: list[Step]) -> Iterator[tuple[int, int, float]]:
        for begin, end, values in steps:
            for name, x in values.items():
                yield (*self.kinds[name], self._value(name, x))
            yield STEP, 0, end - begin

    def _value(self, name: str, x: Any) -> float:
        """The value as the tape has it: the bits of an integer lie in those of a float."""
        if self.kinds[name][0] == KINDS["Real"]:
            return float(x)
        return float(np.array([int(x), 0], "<i4").view("<f8")[0])

    def _put(self, data: bytes) -> int:
        """Put data behind all that is in memory; the answer is its place."""
        place: int = PAGE * self.web["memory"].grow(self.store, -(-len(data) // PAGE))
        self.web["memory"].write(self.store, data, place)
        return place


def steps_of(scenario: Scenario, fmu: Path) -> list[Step]:
    """The steps of a run of the native FMU, with all that is set before each."""
    if not scenario.reacts:
        return list(schedule(scenario, scenario.step_size))
    recording = simulate(scenario, fmu, scenario.step_size)
    assert recording.script
    steps, waiting = [], list(recording.settings)
    for begin, end in pairwise(recording.time.tolist()):
        values: dict[str, Any] = inputs(scenario, recording.script, begin, end)
        while waiting and waiting[0].at <= begin + 1e-9 * scenario.step_size:
            values |= waiting.pop(0).values
        steps.append((begin, end, values))
    return steps


def scenarios(page: Explored) -> Iterator[tuple[Scenario, dict[str, Any]]]:
    """The scenarios of a page, and what it knows of each."""
    for scenario in scenarios_of(page.data["name"]):
        yield shown(scenario), page.scenario(scenario.name)


def test_every_scenario_has_the_native_bits_in_webassembly(fmus: Fmus, block: str) -> None:
    page = explored(fmus, block)
    assert len(page.data["scenarios"]) >= 16
    module = Module(page.code, Recipe(block).variables)
    for scenario, known in scenarios(page):
        start = {**scenario.start, **inputs(scenario, scenario.master, 0.0, 0.0)}
        found = module.run(start, steps_of(scenario, fmus.native(block)))
        assert len(found) == known["points"]
        assert hashlib.sha256(found.tobytes()).hexdigest() == known["sha256"], scenario.name


def test_the_sum_on_the_page_is_that_of_a_run_in_plain_python(fmus: Fmus, block: str) -> None:
    """The shortest scenario, by the block's own source: no compiled code has a part in it."""
    scenario, known = min(scenarios(explored(fmus, block)), key=lambda pair: pair[1]["points"])
    recording = run_in_process(scenario, scenario.step_size)
    names = [v.name for v in Recipe(block).variables.values() if not v.settable]
    rows = np.column_stack([recording.values[name] for name in names])
    assert rows.shape == (known["points"], len(names))
    assert hashlib.sha256(rows.tobytes()).hexdigest() == known["sha256"]


def test_one_bit_more_in_an_input_is_another_sum(fmus: Fmus) -> None:
    """The comparison can fail: the last bit of one velocity in the middle of a run shows."""
    page = explored(fmus, "Synchronizer")
    scenario, known = next(scenarios(page))
    start = {**scenario.start, **inputs(scenario, scenario.master, 0.0, 0.0)}
    steps = list(schedule(scenario, scenario.step_size))
    begin, end, values = steps[len(steps) // 4]
    values["master.velocity"] = float(np.nextafter(values["master.velocity"], np.inf))
    steps[len(steps) // 4] = begin, end, values
    found = Module(page.code, Recipe("Synchronizer").variables).run(start, steps)
    assert hashlib.sha256(found.tobytes()).hexdigest() != known["sha256"]


def test_the_module_asks_for_nothing_but_the_pages_log(fmus: Fmus, block: str) -> None:
    """No system interface, no C library, and a stack of 64 kB: memory of few pages."""
    module = wasmtime.Module(wasmtime.Engine(), explored(fmus, block).code)
    assert [(i.module, i.name) for i in module.imports] == [("page", "told")]
    (memory,) = [e.type for e in module.exports if isinstance(e.type, wasmtime.MemoryType)]
    assert memory.limits.min <= 8


def test_a_refused_start_value_is_told_in_the_fmus_words(fmus: Fmus) -> None:
    module = Module(explored(fmus, "FlyingSaw").code, Recipe("FlyingSaw").variables)
    with pytest.raises(AssertionError):
        module.run({"axis.min_position": 10.0, "axis.max_position": -10.0}, [])
    assert len(module.told) == 1
    assert "axis.min_position = 10" in module.told[0]
    assert "axis.max_position = -10" in module.told[0]
