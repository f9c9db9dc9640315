"""Many runs of scenarios of one block, in compiled code on all cores.

    variants = [replace(scenario, start={**scenario.start, "axis.max_jerk": jerk}) for jerk in jerks]
    runs = run_scenarios(variants, ["slave.position"], {"slave.acceleration": "max"})

Each run gives the bits that `scenario.run.run_in_process` gives: outputs, communication points, the axis, what was set.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from ctypes import addressof, c_void_p
from dataclasses import dataclass
from functools import partial
from itertools import accumulate
from math import nan, prod
from typing import Any

import numpy as np

from ..compiler import memory_layout
from ..interface.roles import MOTION
from ..interface.variables import LONGEST_STEP, Variable, message_text, shown, step_size_refusal, variables_in_message
from ..scenario import clocks
from ..scenario.recording import Recording
from ..scenario.run.simulation import start_inputs
from ..scenario.scenario import Scenario
from ..scenario.settings import UnmetReaction
from .library import library
from .loop_plan import Cause
from .reductions import Reduce, Reductions
from .script_tables import LIMITED, RUN, SCENARIOS, RunTables, address, block_memory
from .simulation import NO_RESULT, count_workers, find_refused, limits

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


class _Runs:
    """Some runs of the scenarios of one recipe, in one call of compiled code."""

    def __init__(self, scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Reduce) -> None:
        self.scenarios, self.outputs = scenarios, outputs
        self.block = block = block_memory(scenarios[0].recipe)
        self.library = library(block.type)
        self.reductions = Reductions(block.type, reduce, len(scenarios))
        self.sinks = block.table(outputs)
        self.memory = np.full(len(scenarios), block.image)
        self.tables = [RunTables(s, block, len(outputs)) for s in scenarios]
        self._allocate_targets()
        set_names = self._set_start_values()
        self.axis = self._axis_inputs()
        self.checked = self._checked_variables()
        self.limits = np.array([(block.fields[v.name].offset, *limits(v)) for v in self.checked], LIMITED)
        size, first = self.memory.itemsize, address(self.memory)
        self.runs = np.array([t.run(first + i * size) for i, t in enumerate(self.tables)], RUN)
        checked_at_start = (v for v in block.variables.values() if v.name in set_names | block.unset)
        self.refused = find_refused(checked_at_start, self.memory)
        self.runs["cause"][list(self.refused)] = Cause.START

    def _allocate_targets(self) -> None:
        """Allocate one array for the recordings of all runs.

        The next call is likely to get the same memory again, and saves the time for new pages: a third of its time."""
        sizes = [prod(t.shape) for t in self.tables]
        memory = np.empty(sum(sizes))
        for t, end, size in zip(self.tables, accumulate(sizes), sizes, strict=True):
            t.target = memory[end - size : end].reshape(t.shape)

    def _set_start_values(self) -> set[str]:
        """Set the start values, and the inputs of the axis at time 0; the names of what is set."""
        columns: dict[str, tuple[list[int], list[Any]]] = {}
        for i, s in enumerate(self.scenarios):
            for name, value in {**s.start, **start_inputs(s)}.items():
                indices, values = columns.setdefault(name, ([], []))
                indices.append(i)
                values.append(value)
        for name, (indices, values) in columns.items():
            memory_layout.field(self.memory, name)[indices] = values
        return set(columns)

    def _axis_inputs(self) -> list[str]:
        """The inputs of the axis by name: position, velocity, acceleration, and the cycle index of a remote one."""
        remote = self.scenarios[0].remote
        part = remote.names.part if remote else "master"
        return [f"{part}.{name}" for name in MOTION] + ([remote.names.cycle_index] if remote else [])

    def _checked_variables(self) -> list[Variable]:
        """The variables that each step checks: the Reals of the axis and those that any of the runs sets."""
        names = {*self.axis[: len(MOTION)], *(name for t in self.tables for name in t.checked)}
        return [v for v in self.block.variables.values() if v.name in names]

    def run(self) -> None:
        """Run all of them, without the interpreter's lock."""
        offsets = [self.block.fields[name].offset for name in self.axis]
        samples = self.reductions.samples()
        reductions = addressof(self.reductions.c_tables) if self.reductions.measures else 0
        table = np.array(
            (
                *offsets,
                *[0] * (4 - len(offsets)),
                *(address(self.limits), len(self.limits), address(self.sinks), len(self.sinks)),
                *(LONGEST_STEP, clocks.CLOSE, reductions, address(samples), address(self.runs), len(self.runs)),
            ),
            SCENARIOS,
        )
        self.library.script_run(c_void_p(address(table)))

    def results(self) -> list[ScriptedRun]:
        """The result of each run."""
        failed = np.flatnonzero(self.runs["cause"]).tolist()
        measures = self.reductions.results(failed)
        messages = {i: f"at {self.runs['now'][i]:g} s {self._message(i)}" for i in failed}
        return [
            self._result(i, messages.get(i, ""), {name: column[i].item() for name, column in measures.items()})
            for i in range(len(self.runs))
        ]

    def _result(self, i: int, failure: str, measures: dict[str, float]) -> ScriptedRun:
        tables = self.tables[i]
        recording = tables.recording(self.runs[i], self.outputs) if self.outputs and not failure else None
        failed_at = self.runs["now"][i].item() if failure else nan
        return ScriptedRun(recording, failure, failed_at, measures, tables.unmet)

    def _message(self, i: int) -> str:
        """Why a run failed."""
        row, memory = self.runs[i], self.memory[i]
        number: int = row["number"].item()

        def value(name: str) -> Any:
            return memory_layout.field(memory, name).item()

        match Cause(row["cause"].item()):
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
