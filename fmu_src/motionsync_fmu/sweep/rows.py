"""A chunk of a sweep's runs: run, judged, and told in a table, a row a run.

A run that fails is a row, too: what was refused stands in it."""

import re
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

import pyarrow as pa

from ..errors import UserError
from ..native.loop.scripted import run_scenarios
from ..scenario.figures import SLAVE
from ..scenario.scenario import Scenario
from .expressions import Array
from .measures import Measures, columns, joined
from .plan import SweepPlan
from .results import Results, Row, limits_broken, refused

MOST_MEMORY = 16e6  # bytes of the recordings that are in memory at a time
MOST_RUNS = 512  # whose scenarios are in memory at a time
POINT = 40  # bytes of a communication point: the time, and the master's motion
VALUE = 8  # bytes of an output at a point
TELEGRAM = 80  # bytes of a telegram that a remote axis sends
PLACE = re.compile(r"^.*?:\d+: ((\S+): (?=\2 = ))?")  # of a refused value: run, file and line; its name if it follows

Judgeable = Scenario | UserError
AnyRun = TypeVar("AnyRun", Scenario, Judgeable)


def schema(plan: SweepPlan) -> pa.Schema:
    """The columns of the rows: the run's number, factors and derived values, what became of the run, and measures."""
    return _schema(plan, plan.values(0, 1))


def _schema(plan: SweepPlan, values: Mapping[str, Array]) -> pa.Schema:
    """The columns; `values`: of any runs. Those of the first one would take long far behind it: see `samples.py`."""
    types = {name: pa.array(of_runs[:0]).type for name, of_runs in values.items()}
    measured = dict.fromkeys(columns(plan.measures), pa.float64())
    return pa.schema({"run": pa.int64()} | types | Results(plan.varied.scenario).columns | measured)


def rows(plan: SweepPlan, first: int, last: int, threads: int = 1) -> pa.Table:
    """The rows of the runs from `first` up to, but not including, `last`.

    `threads`: how many run at the same time.

    Raises:
        UserError: there are no such runs; or there is no C compiler.
    """
    values = plan.values(first, last)
    number, *others = _schema(plan, values)
    numbered = rows_with(plan, values, [field.name for field in others], threads)
    return numbered.add_column(0, number, pa.array(range(first, last), number.type))


def rows_with(plan: SweepPlan, values: Mapping[str, Array], columns: Iterable[str], threads: int = 1) -> pa.Table:
    """Some columns of the rows of runs that have other values than those of the plan.

    `values`: of all factors, each of shape (runs,).

    Raises:
        UserError: there is no C compiler.
    """
    told: list[Row] = []
    for begin in range(0, len(next(iter(values.values()))), MOST_RUNS):
        some = {name: of_runs[begin : begin + MOST_RUNS] for name, of_runs in values.items()}
        told += run_and_judge(plan.varied.scenario, _taken(deque(plan.scenarios_with(some))), plan.measures, threads)
    known = _schema(plan, values)
    fields = [known.field(name) for name in dict.fromkeys(columns)]
    arrays = [
        pa.array(values[f.name] if f.name in values else [row.get(f.name) for row in told], f.type, from_pandas=True)
        for f in fields
    ]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def _taken(scenarios: deque[Judgeable]) -> Iterator[Judgeable]:
    """Take the scenarios out, one after the other: nobody keeps those that have run, whose telegrams need memory."""
    while scenarios:
        yield scenarios.popleft()


def run_and_judge(base: Scenario, scenarios: Iterable[Judgeable], measures: Measures, threads: int = 1) -> list[Row]:
    """What the rows tell of runs: their results and measures by the names of the columns, without those that a run does
    not have. A run that a UserError stands for was refused by it.

    Recordings of 16 MB are in memory at a time, or that of one run. If nothing has to be judged from the whole course
    there are none, and the memory does not grow with the steps.

    `base`: a scenario of which the others differ in values alone."""
    results = Results(base)
    reduce = joined(measures, results.reduce)

    def judged(batch: Sequence[Scenario]) -> list[Row]:
        runs = run_scenarios(batch, results.outputs, reduce, threads)
        return [{**run.measures, **results.row(s, run)} for s, run in zip(batch, runs, strict=True)]

    def limited(batch: Sequence[Scenario]) -> list[Row]:
        runs = run_scenarios(batch, SLAVE, {}, threads)
        return [limits_broken(s, run.recording) for s, run in zip(batch, runs, strict=True) if run.recording]

    told: list[Row] = []
    for batch in _batches(scenarios, len(results.outputs)):
        accepted = [s for s in batch if isinstance(s, Scenario)]
        found = judged(accepted)
        unknown = [i for i, row in enumerate(found) if results.lacks_limits(row)]
        numbers = iter(unknown)
        for some in _batches([accepted[i] for i in unknown], len(SLAVE)):
            for row in limited(some):
                found[next(numbers)] |= row
        rows_of = iter(found)
        told += [next(rows_of) if isinstance(s, Scenario) else refused(PLACE.sub("", str(s)), 0.0) for s in batch]
    return told


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
    return telegrams + points * (POINT + VALUE * outputs if outputs else VALUE)
