"""The block as WebAssembly has the native FMU's bits: all outputs and locals at all points of all scenarios."""

import hashlib
import weakref
from array import array
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import wasmtime

from motionsync_fmu.batch.block_memory import block_memory
from motionsync_fmu.batch.scripted_runs import RUN
from motionsync_fmu.compiler.memory_layout import packer
from motionsync_fmu.explorer.data import explored as shown
from motionsync_fmu.explorer.page import scenarios_of
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.runner.run import Run
from motionsync_fmu.scenario.run.tables import RunTables
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.script import Script
from tests import ROOT
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.explored import Explored, explored

PAGE = 65536
SETTERS = {"Real": "set_real", "Integer": "set_integer", "Enumeration": "set_integer", "Boolean": "set_boolean"}


class Module:
    """The module of a page in wasmtime, and its runs, each with an instance of its own.

    Attributes:
        log: what the last run has logged.
    """

    def __init__(self, page: Explored) -> None:
        self.block = block_memory(Recipe(page.data["name"]))
        self.outputs = [v.name for v in self.block.variables.values() if not v.settable]
        self.engine = wasmtime.Engine()
        self.module = wasmtime.Module(self.engine, page.code)
        self.log: list[str] = []

    def start(self, scenario: Scenario) -> int:
        """Reset the unit, set the start values and write the tables; the status of the initialization."""
        self.log = []
        self.store, linker = wasmtime.Store(self.engine), wasmtime.Linker(self.engine)
        this = weakref.ref(self)  # a store in a circle is deleted as Python ends, at a fault

        def log(*message: int) -> None:
            if module := this():
                module.add_message(*message)

        linker.define_func("page", "log", wasmtime.FuncType([wasmtime.ValType.i32()] * 3, []), log)
        self.web = linker.instantiate(self.store, self.module).exports(self.store)
        self.address = self.web["reset"](self.store)
        references = {name: i for i, name in enumerate(self.block.variables)}
        for name, x in scenario.start.items():
            kind = self.block.variables[name].kind
            setter, value = self.web[SETTERS[kind]], float(x) if kind == "Real" else int(x)
            assert setter(self.store, references[name], value) == 0, self.log
        self.tables = RunTables(scenario, scenario.step_size)
        self._set_host()
        self.run_address = self._write(
            packer(Run)(self.tables.run, lambda numbers: (self._write(numbers), len(numbers)))
        )
        self.arguments = self.store, self.run_address
        return int(self.web["initialize"](*self.arguments))

    def run(self, scenario: Scenario) -> np.ndarray:
        """All outputs and locals at all points, in the order of the variables."""
        assert self.start(scenario) == 0, self.log
        assert self.web["carry"](*self.arguments) == 0, self.log
        return self.rows()

    def rows(self) -> np.ndarray:
        """What has been recorded of the outputs and locals."""
        memory, end = self.web["memory"], self.run_address + RUN.itemsize
        host = np.frombuffer(memory.read(self.store, self.run_address, end), RUN)["host"][0]
        begin, size = host["values"].item()
        values = np.frombuffer(memory.read(self.store, begin, begin + 8 * size), "<f8")
        return np.ascontiguousarray(values.reshape(len(self.outputs), -1)[:, : host["count"]].T)

    def change_last_bit(self, name: str) -> None:
        """Replace a Real of the block by the next greater number."""
        at = self.address + self.block.fields[name].offset
        value = np.frombuffer(self.web["memory"].read(self.store, at, at + 8), "<f8")
        self.web["memory"].write(self.store, np.nextafter(value, np.inf).tobytes(), at)

    def _set_host(self) -> None:
        """Say where the block and its variables are, and let there be space for a recording."""
        tables, host = self.tables, self.tables.run.host
        checked = (v for v in self.block.variables.values() if v.checked and v.name in {*tables.inputs, *tables.sets})
        self.block.set_host(tables, self.address, self.outputs, checked)
        host.times, host.axis, host.values = (
            array("d", bytes(8 * width * tables.most_points)) for width in (1, 4, len(self.outputs))
        )

    def add_message(self, status: int, address: int, length: int) -> None:
        self.log.append(bytes(self.web["memory"].read(self.store, address, address + length)).decode())

    def _write(self, numbers: Any) -> int:
        """Write numbers behind all that is in memory; the answer is their address."""
        data = bytes(numbers)
        address: int = PAGE * self.web["memory"].grow(self.store, 1 + len(data) // PAGE)
        self.web["memory"].write(self.store, data, address)
        return address


def scenarios(page: Explored) -> Iterator[tuple[Scenario, dict[str, Any]]]:
    """The scenarios of a page, and what it has of each."""
    for scenario, stored in zip(scenarios_of(page.data["name"]), page.data["scenarios"], strict=True):
        yield shown(scenario), stored


def test_every_scenario_has_the_native_bits_in_webassembly(fmus: Fmus, block: str) -> None:
    """The tables are those of batches; reactions and drives run in the module itself."""
    page = explored(fmus, block)
    names = [s["name"] for s in page.data["scenarios"]]
    assert sorted(names) == sorted(["example", *(folder.name for folder in (ROOT / "scenarios" / block).glob("*/"))])
    module = Module(page)
    for scenario, stored in scenarios(page):
        rows = module.run(scenario)
        assert len(rows) == stored["points"]
        assert hashlib.sha256(rows.tobytes()).hexdigest() == stored["sha256"], scenario.name


def test_one_bit_more_in_an_input_is_another_sum(fmus: Fmus) -> None:
    """The comparison can fail: the last bit of one velocity in the middle of a run shows."""
    page = explored(fmus, "Synchronizer")
    scenario, stored = next(scenarios(page))
    module, sums = Module(page), []
    for changed in (False, True):
        assert module.start(scenario) == 0
        for step in range(stored["points"] - 1):
            assert module.web["prepare"](*module.arguments)
            if changed and step == stored["points"] // 4:
                module.change_last_bit("master.velocity")
            assert module.web["step"](*module.arguments) == 0
        assert not module.web["prepare"](*module.arguments)
        sums.append(hashlib.sha256(module.rows().tobytes()).hexdigest())
    assert sums[0] == stored["sha256"] != sums[1]


def test_the_module_asks_for_nothing_but_the_pages_log(fmus: Fmus, block: str) -> None:
    """No system interface, no C library, and a stack of 64 kB: memory of few pages."""
    module = wasmtime.Module(wasmtime.Engine(), explored(fmus, block).code)
    assert [(i.module, i.name) for i in module.imports] == [("page", "log")]
    (memory,) = [e.type for e in module.exports if isinstance(e.type, wasmtime.MemoryType)]
    assert memory.limits.min <= 8


def test_a_refused_start_value_is_reported_in_the_fmus_words(fmus: Fmus) -> None:
    page = explored(fmus, "FlyingSaw")
    scenario, _ = next(scenarios(page))
    module = Module(page)
    far = {"axis.min_position": 10.0, "axis.max_position": -10.0}
    assert module.start(replace(scenario, start={**scenario.start, **far})) != 0
    assert len(module.log) == 1
    assert "axis.min_position = 10" in module.log[0]
    assert "axis.max_position = -10" in module.log[0]


def test_an_input_that_the_fmu_does_not_allow_ends_the_run_in_its_words(fmus: Fmus) -> None:
    """The runner writes into the block's memory itself; the unit checks it all the same."""
    page = explored(fmus, "FlyingSaw")
    scenario, _ = next(scenarios(page))
    module = Module(page)
    far = replace(scenario, master=Script(0.0, 1e12, 0.0, []), stop_time=2.0, settings=(), reactions=(), drive=None)
    assert module.start(far) == 0
    assert module.web["carry"](*module.arguments) != 0
    assert [text.partition(" = ")[0] for text in module.log[-1:]] == ["master.position"]
    assert "is not allowed: it must be -1e+12 to 1e+12" in module.log[-1]
