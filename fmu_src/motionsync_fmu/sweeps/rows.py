"""A chunk of a sweep's runs, simulated and evaluated; the result is a table with a row for each run.

A run that fails is a row, too: it has what was refused."""

import re
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

import pyarrow as pa

from ..batch.scripted_runs import run_scenarios
from ..errors import UserError
from ..scenario.scenario import Scenario
from ..scenario.variation.expressions import Array
from .measures import Measures, join_measures
from .result_columns import schema
from .run_evaluation import Row, RunEvaluation, refused_row
from .sweep_plan import SweepPlan

MOST_MEMORY = 16e6  # bytes of the recordings that are in memory at a time
MOST_RUNS = 512  # whose scenarios are in memory at a time
POINT = 40  # bytes of a communication point: the time, and the master's motion
VALUE = 8  # bytes of an output at a point
TELEGRAM = 80  # bytes of a telegram that a remote axis sends
PREFIX = re.compile(r"^.*?:\d+: ((\S+): (?=\2 = ))?")  # of a refused value: run, file and line; its name if it follows

RunOrRefusal = Scenario | UserError
AnyRun = TypeVar("AnyRun", Scenario, RunOrRefusal)


def rows(plan: SweepPlan, first: int, last: int, threads: int = 1) -> pa.Table:
    """The rows of the runs from `first` up to, but not including, `last`.

    `threads`: how many run at the same time.

    Raises:
        UserError: there are no such runs; or there is no C compiler.
    """
    values = plan.values(first, last)
    number, *others = schema(plan, values)
    numbered = rows_with(plan, values, [field.name for field in others], threads)
    return numbered.add_column(0, number, pa.array(range(first, last), number.type))


def rows_with(plan: SweepPlan, values: Mapping[str, Array], columns: Iterable[str], threads: int = 1) -> pa.Table:
    """Some columns of the rows of runs that have other values than those of the plan.

    `values`: of all factors, each of shape (runs,).

    Raises:
        UserError: there is no C compiler.
    """
    rows: list[Row] = []
    for begin in range(0, len(next(iter(values.values()))), MOST_RUNS):
        chunk = {name: of_runs[begin : begin + MOST_RUNS] for name, of_runs in values.items()}
        scenarios = _pop_scenarios(deque(plan.scenarios_with(chunk)))
        rows += run_and_evaluate(plan.variation.scenario, scenarios, plan.measures, threads)
    row_schema = schema(plan, values)
    fields = [row_schema.field(name) for name in dict.fromkeys(columns)]
    arrays = [
        pa.array(values[f.name] if f.name in values else [r.get(f.name) for r in rows], f.type, from_pandas=True)
        for f in fields
    ]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def _pop_scenarios(scenarios: deque[RunOrRefusal]) -> Iterator[RunOrRefusal]:
    """Take the scenarios out, one after the other: nobody keeps those that have run, whose telegrams need memory."""
    while scenarios:
        yield scenarios.popleft()


def run_and_evaluate(
    base: Scenario, scenarios: Iterable[RunOrRefusal], measures: Measures, threads: int = 1
) -> list[Row]:
    """The rows of runs: their results and measures by the names of the columns, without those that a run does
    not have. A run that a UserError stands for was refused by it.

    Recordings of 16 MB are in memory at a time, or that of one run. If nothing needs the whole course, there are none,
    and the memory does not grow with the steps.

    `base`: a scenario of which the others differ in values alone."""
    evaluation = RunEvaluation(base)
    reduce = join_measures(measures, evaluation.reduce)

    def evaluate_batch(batch: Sequence[Scenario], outputs: Sequence[str]) -> list[Row]:
        runs = run_scenarios(batch, outputs, reduce, threads)
        return [{**run.measures, **evaluation.row(s, run)} for s, run in zip(batch, runs, strict=True)]

    rows: list[Row] = []
    for batch in _batches(scenarios, len(evaluation.outputs)):
        accepted = [s for s in batch if isinstance(s, Scenario)]
        evaluated = evaluate_batch(accepted, evaluation.outputs)
        unknown = [i for i, row in enumerate(evaluated) if evaluation.lacks_limits(row)]
        numbers = iter(unknown)
        for chunk in _batches([accepted[i] for i in unknown], len(evaluation.limit_outputs)):
            for row in evaluate_batch(chunk, evaluation.limit_outputs):
                evaluated[next(numbers)] = row
        rows_of = iter(evaluated)
        rows += [next(rows_of) if isinstance(s, Scenario) else refused_row(PREFIX.sub("", str(s)), 0.0) for s in batch]
    return rows


def _batches(scenarios: Iterable[AnyRun], outputs: int) -> Iterator[list[AnyRun]]:
    """The scenarios in batches whose recordings of so many outputs fit into memory together."""
    batch: list[AnyRun] = []
    size = 0.0
    for s in scenarios:
        needed = _memory(s, outputs) if isinstance(s, Scenario) else 0.0
        if batch and size + needed > MOST_MEMORY:
            yield batch
            batch, size = [], 0.0
        batch.append(s)
        size += needed
    if batch:
        yield batch


def _memory(scenario: Scenario, outputs: int) -> float:
    """About how much memory a run needs of which so many outputs are recorded, in bytes."""
    scans = scenario.stop_time / scenario.scan if scenario.reacts else 0.0
    points = scenario.stop_time / scenario.step_size + scans * (1.0 + 0.5 * len(scenario.reactions))
    telegrams = TELEGRAM * scenario.remote.cycles if scenario.remote else 0.0
    computed = len(scenario.columns) - len(scenario.recipe.variables)
    return telegrams + points * (POINT + VALUE * (outputs + computed) if outputs else VALUE)
