"""Many runs of scenarios of one block, in compiled code on all cores.

    variants = [replace(scenario, start={**scenario.start, "axis.max_jerk": jerk}) for jerk in jerks]
    runs = run_scenarios(variants, ["slave.position"], {"slave.acceleration": "max"})

Each run gives the bits that `scenario.run.run_in_process` gives: outputs, communication points, the axis, what was set.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from ctypes import Structure, addressof, byref, c_double, c_int64, c_void_p
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import Any

import numpy as np

from ..compiler.memory_layout import address_and_count, dtype, field, packer
from ..interface.variables import LONGEST_STEP, Variable, message_text, shown, step_size_refusal, variables_in_message
from ..runner.axis import MOTION as AXIS
from ..runner.run import Run
from ..scenario.recording import Recording
from ..scenario.run.tables import RunTables
from ..scenario.scenario import Scenario
from ..scenario.settings import UnmetReaction
from .batch_layout import Cause
from .block_memory import block_memory
from .library import library
from .reductions import Reduce, Reductions
from .simulation import NO_RESULT, count_workers, find_refused

RUN = dtype(Run())
WIDTH = 1 + AXIS  # columns of a recording before the outputs: the time, and the axis
MOST_RUNS = 64  # in one call of compiled code: their tables are in memory at the same time


@dataclass(frozen=True)
class ScriptedRun:
    """The result of one run.

    Attributes:
        recording: of the requested outputs at the communication points; None without outputs, or if the run failed.
        failure: why it failed; empty: it did not.
        failed_at: the latest communication point of a run that failed, in s; else NaN.
        measures: by name, `slave.velocity.max` say; NaN if the run failed.
        unmet: the reactions that happened less often than they could have.
    """

    recording: Recording | None
    failure: str
    failed_at: float
    measures: Mapping[str, float]
    unmet: Sequence[UnmetReaction]


def run_scenarios(
    scenarios: Sequence[Scenario],
    outputs: Sequence[str],
    reduce: Reduce | None = None,
    threads: int | None = None,
) -> list[ScriptedRun]:
    """Run scenarios at their own step sizes, with compiled code, without the interpreter's lock.

    All results are in memory at the same time: 8 bytes for each output, and 40 bytes more, for each communication point
    of each run. Without outputs the results do not grow with the points.

    Args:
        scenarios: of one recipe; all else may differ.
        outputs: the outputs and local variables that are recorded; `scenario.evaluate.verdict.needed_outputs`
            names those that an evaluation needs.
        reduce: the measures, as for `simulate_many`; all kinds but `every:N`.
        threads: the greatest number of threads; by default the number of cores.

    Returns:
        One result for each scenario, in their order. A run that the block refuses fails in the words of
        `run_in_process`, without the file's name; as in the FMU, a run fails also where a start value, a Real input or
        a step size is not allowed.

    Raises:
        UserError: an unknown variable or measure, or a number of threads below 1; or there is no C compiler.
    """
    workers = count_workers(threads)
    size = max(1, min(MOST_RUNS, -(-len(scenarios) // workers)))
    chunks = [scenarios[first : first + size] for first in range(0, len(scenarios), size)]
    run_chunk = partial(_run_chunk, outputs=outputs, reduce=reduce or {})
    if workers == 1 or len(chunks) == 1:
        return [run for chunk in chunks for run in run_chunk(chunk)]
    with ThreadPoolExecutor(workers, "motionsync") as pool:
        return [run for runs in pool.map(run_chunk, chunks) for run in runs]


def _run_chunk(scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Reduce) -> list[ScriptedRun]:
    """As `run_scenarios`, in this thread; at least one."""
    runs = _Runs(scenarios, outputs, reduce)
    runs.run()
    return runs.results()


class RunBatch(Structure):
    """Runs for `scenario_batch.c`: the address of the first one, their number, the greatest allowed step size, the
    tables of what is reduced, if anything is, and memory for their samples."""

    _fields_ = (
        ("runs", c_int64),
        ("count", c_int64),
        ("longest", c_double),
        ("reductions", c_void_p),
        ("samples", c_void_p),
    )


class _Runs:
    """Some runs of the scenarios of one recipe, in one call of compiled code."""

    def __init__(self, scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Reduce) -> None:
        self.scenarios, self.outputs = scenarios, outputs
        self.block = block = block_memory(scenarios[0].recipe)
        self.library = library(block.type)
        self.reductions = Reductions(block.type, reduce, len(scenarios))
        self.memory = np.full(len(scenarios), block.image)
        self.tables = [RunTables(s, s.step_size, bool(outputs)) for s in scenarios]
        for tables in self.tables:
            tables.run.start()
        set_names = self._set_start_values()
        self.checked = self._checked_variables()
        self._set_hosts()
        checked_at_start = (v for v in block.variables.values() if v.name in set_names | block.unset)
        self.refused = find_refused(checked_at_start, self.memory)
        pack = packer(Run)
        memory = bytearray(b"".join(pack(tables.run, address_and_count) for tables in self.tables))
        self.runs = np.frombuffer(memory, RUN)
        self.hosts = self.runs["host"]
        self.hosts["cause"][list(self.refused)] = Cause.START

    def _set_start_values(self) -> set[str]:
        """Set the start values, and the inputs of the axis at time 0; the names of what is set."""
        columns: dict[str, tuple[list[int], list[Any]]] = {}
        for i, tables in enumerate(self.tables):
            for name, value in {**tables.scenario.start, **tables.axis_inputs}.items():
                indices, values = columns.setdefault(name, ([], []))
                indices.append(i)
                values.append(value)
        for name, (indices, values) in columns.items():
            field(self.memory, name)[indices] = values
        return set(columns)

    def _checked_variables(self) -> list[Variable]:
        """The variables that each step checks: the Reals of the axis and those that any of the runs sets."""
        names = {name for t in self.tables for name in (*t.inputs, *t.sets)}
        return [v for v in self.block.variables.values() if v.name in names and v.checked]

    def _set_hosts(self) -> None:
        """Set where the variables of each run are, and where it is recorded.

        One array is for the recordings of all runs. The next call is likely to get the same memory again, and saves the
        time for new pages: a third of its time."""
        first, size = self.memory.ctypes.data, self.memory.itemsize
        points = [t.most_points if self.outputs else 0 for t in self.tables]
        self.target = np.empty((WIDTH + len(self.outputs)) * sum(points))
        targets = np.split(self.target, np.cumsum(points[:-1]) * (WIDTH + len(self.outputs)))
        for i, (tables, most, target) in enumerate(zip(self.tables, points, targets, strict=True)):
            self.block.set_host(tables, first + i * size, self.outputs, self.checked)
            if self.outputs:
                host: Any = tables.run.host
                host.times, host.axis, host.values = target[:most], target[most : WIDTH * most], target[WIDTH * most :]

    def run(self) -> None:
        """Run all of them, without the interpreter's lock."""
        samples = self.reductions.samples()
        reductions = addressof(self.reductions.c_tables) if self.reductions.measures else None
        batch = RunBatch(self.runs.ctypes.data, len(self.runs), LONGEST_STEP, reductions, samples.ctypes.data)
        self.library.script_run(byref(batch))

    def results(self) -> list[ScriptedRun]:
        """The result of each run."""
        failed = np.flatnonzero(self.hosts["cause"]).tolist()
        measures = self.reductions.results(failed)
        messages = {i: f"at {self.runs['now'][i]:g} s {self._message(i)}" for i in failed}
        return [
            self._result(i, messages.get(i, ""), {name: column[i].item() for name, column in measures.items()})
            for i in range(len(self.runs))
        ]

    def _result(self, i: int, failure: str, measures: dict[str, float]) -> ScriptedRun:
        recording = self._recording(i) if self.outputs and not failure else None
        failed_at = self.runs["now"][i].item() if failure else nan
        return ScriptedRun(recording, failure, failed_at, measures, self.tables[i].unmet)

    def _recording(self, i: int) -> Recording:
        tables, host, row = self.tables[i], self.tables[i].run.host, self.runs[i]
        tables.run.program.taken, tables.run.axis.count = row["program"]["taken"].item(), row["axis"]["count"].item()
        n = row["host"]["count"].item()
        values: Any = np.asarray(host.values).reshape(len(self.outputs), -1)[:, :n]
        axis = np.asarray(host.axis)[: AXIS * n].reshape(n, AXIS)
        return tables.recording(np.asarray(host.times)[:n], dict(zip(self.outputs, values, strict=True)), axis, [])

    def _message(self, i: int) -> str:
        """Why a run failed."""
        row, memory = self.runs[i], self.memory[i]
        number: int = row["host"]["number"].item()

        def value(name: str) -> Any:
            return field(memory, name).item()

        match Cause(row["host"]["cause"].item()):
            case Cause.START:
                return self.refused[i]
            case Cause.STEP_SIZE:
                return step_size_refusal(row["step"].item())
            case Cause.INPUT:
                variable = self.checked[number]
                return variable.refusal(value(variable.name))
            case Cause.REFUSED:
                refusal = self.block.refusals[number]
                call = f"step({shown(row['step'].item())})" if row["step"] else "initialize()"
                reason: str = message_text(refusal, variables_in_message(refusal, self.block.variables), value)
                return f"{self.block.type.__name__} refuses {call}: {reason}"
            case _:
                return NO_RESULT
