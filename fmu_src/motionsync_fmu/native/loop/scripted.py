"""Many runs of scenarios of one block, carried by compiled code on all cores.

    variants = [replace(scenario, start={**scenario.start, "axis.max_jerk": jerk}) for jerk in jerks]
    runs = run_scenarios(variants, ["slave.position"], {"slave.acceleration": "max"})

Each run gives the bits that `scenario.run.run_in_process` gives: outputs, communication points, the axis, what was set.
"""

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from ctypes import addressof, byref
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import Any

import numpy as np

from ...errors import UserError
from ...interface.roles import MOTION
from ...interface.variables import LONGEST_STEP, Variable, explained, shown, spoken_of, step_size_refusal
from ...scenario import clocks
from ...scenario.recording import Recording
from ...scenario.run import inputs
from ...scenario.scenario import Scenario
from ...scenario.settings import Unmet
from .. import memory_layout
from ..batch import NO_RESULT, allowed, limits
from .library import library
from .plan import Cause
from .reductions import Reduce, Reductions
from .script_tables import LIMITED, RUN, RunTables, Scenarios, address, block_memory

MOST_RUNS = 64  # in one call of compiled code: their tables are in memory at the same time


@dataclass(frozen=True)
class ScriptedRun:
    """What came of one run.

    Attributes:
        recording: what was asked for at the communication points; None without outputs, or if the run failed.
        failure: why it failed; empty: it did not.
        failed_at: the latest communication point of a run that failed, in s; else NaN.
        measures: by name, `slave.velocity.max` say; NaN if the run failed.
        unmet: the reactions that happened less often than they could have.
    """

    recording: Recording | None
    failure: str
    failed_at: float
    measures: Mapping[str, float]
    unmet: Sequence[Unmet]


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
        outputs: the outputs and local variables that are recorded; `scenario.judge.judged_outputs` names those that
            judging needs.
        reduce: the measures, as for `simulate_many`; all kinds but `every:N`.
        threads: the greatest number of threads; by default the number of cores.

    Returns:
        One result for each scenario, in their order. A run that the block refuses fails in the words of
        `run_in_process`, without the file's name; as in the FMU, a run fails also where a start value, a Real input or
        a step size is not allowed.

    Raises:
        UserError: an unknown variable or measure, or a number of threads below 1; or there is no C compiler.
    """
    if threads is not None and threads < 1:
        raise UserError(f"threads = {threads} is not allowed: it must be >= 1")
    workers = threads or os.cpu_count() or 1
    size = max(1, min(MOST_RUNS, -(-len(scenarios) // workers)))
    pieces = [scenarios[first : first + size] for first in range(0, len(scenarios), size)]
    some = partial(_run_some, outputs=outputs, reduce=reduce or {})
    if workers == 1 or len(pieces) == 1:
        return [run for piece in pieces for run in some(piece)]
    with ThreadPoolExecutor(workers, "motionsync") as pool:
        return [run for runs in pool.map(some, pieces) for run in runs]


def _run_some(scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Reduce) -> list[ScriptedRun]:
    """As `run_scenarios`, in this thread; at least one."""
    runs = _Runs(scenarios, outputs, reduce)
    runs.carry()
    return runs.results()


class _Runs:
    """Some runs of the scenarios of one recipe, which are carried in one call of compiled code."""

    def __init__(self, scenarios: Sequence[Scenario], outputs: Sequence[str], reduce: Reduce) -> None:
        self.scenarios, self.outputs = scenarios, outputs
        self.block = block = block_memory(scenarios[0].recipe)
        self.library = library(block.type)
        self.reductions = Reductions(block.type, reduce, len(scenarios))
        self.sinks = block.table(outputs)
        self.memory = np.full(len(scenarios), block.image)
        self.tables = [RunTables(s, block, len(outputs)) for s in scenarios]
        given = self._start()
        self.axis = self._axis()
        self.judged = self._judged()
        self.limits = np.array([(block.places[v.name].offset, *limits(v)) for v in self.judged], LIMITED)
        size, first = self.memory.itemsize, address(self.memory)
        self.runs = np.array([t.run(first + i * size) for i, t in enumerate(self.tables)], RUN)
        self.refused = self._judge(given | block.unset)
        self.runs["cause"][list(self.refused)] = Cause.START

    def _start(self) -> set[str]:
        """Set the start values, and the inputs of the axis at time 0; the names of what is set."""
        columns: dict[str, tuple[list[int], list[Any]]] = {}
        for i, s in enumerate(self.scenarios):
            for name, value in {**s.start, **inputs(s, s.master, 0.0, 0.0)}.items():
                places, values = columns.setdefault(name, ([], []))
                places.append(i)
                values.append(value)
        for name, (places, values) in columns.items():
            memory_layout.field(self.memory, name)[places] = values
        return set(columns)

    def _axis(self) -> list[str]:
        """The inputs of the axis by name: position, velocity, acceleration, and the cycle index of a remote one."""
        remote = self.scenarios[0].remote
        part = remote.names.part if remote else "master"
        return [f"{part}.{name}" for name in MOTION] + ([remote.names.cycle_index] if remote else [])

    def _judged(self) -> list[Variable]:
        """What each step judges: the Reals of the axis and those that any of the runs sets."""
        names = {*self.axis[: len(MOTION)], *(name for t in self.tables for name in t.judged)}
        return [v for v in self.block.variables.values() if v.name in names]

    def _judge(self, names: set[str]) -> dict[int, str]:
        """The runs that cannot be initialized, each with the message for its first bad variable."""
        refused: dict[int, str] = {}
        for v in (v for v in self.block.variables.values() if v.name in names):
            values = memory_layout.field(self.memory, v.name)
            for i in np.flatnonzero(~allowed(v, values)).tolist():
                refused.setdefault(i, v.refusal(values[i].item()))
        return refused

    def carry(self) -> None:
        """Carry all runs, without the interpreter's lock."""
        places = [self.block.places[name].offset for name in self.axis]
        samples = self.reductions.samples()
        table = Scenarios(
            axis=(*places, *[0] * (4 - len(places))),
            limits=address(self.limits),
            limit_count=len(self.limits),
            sinks=address(self.sinks),
            sink_count=len(self.sinks),
            longest=LONGEST_STEP,
            closest=clocks.CLOSE,
            reductions=addressof(self.reductions.in_c) if self.reductions.measures else None,
            samples=address(samples),
            runs=address(self.runs),
            run_count=len(self.runs),
        )
        self.library.script_run(byref(table))

    def results(self) -> list[ScriptedRun]:
        """What came of each run."""
        failed = np.flatnonzero(self.runs["cause"]).tolist()
        measured = self.reductions.results(failed)
        messages = {i: f"at {self.runs['now'][i]:g} s {self._message(i)}" for i in failed}
        return [
            self._result(i, messages.get(i, ""), {name: column[i].item() for name, column in measured.items()})
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
                judged = self.judged[number]
                return judged.refusal(value(judged.name))
            case Cause.REFUSED:
                refusal = self.block.refusals[number]
                call = f"step({shown(row['step'].item())})" if row["step"] else "initialize()"
                why: str = explained(refusal, spoken_of(refusal, self.block.variables), value)
                return f"{self.block.type.__name__} refuses {call}: {why}"
            case _:
                return NO_RESULT
