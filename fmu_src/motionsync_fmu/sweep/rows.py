"""A chunk of a sweep's runs: run, judged, and told in a table, a row a run.

A run that fails is a row, too: what was refused stands in it."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

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
PLACE = re.compile(r"^.*?:\d+: ((\S+): (?=\2 = ))?")  # of a refused value: run, file and line; its name if it follows


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
        scenarios = plan.scenarios_with({name: of_runs[begin : begin + MOST_RUNS] for name, of_runs in values.items()})
        told += run_and_judge(plan.varied.scenario, scenarios, plan.measures, threads)
    known = _schema(plan, values)
    fields = [known.field(name) for name in dict.fromkeys(columns)]
    arrays = [
        pa.array(values[f.name] if f.name in values else [row.get(f.name) for row in told], f.type, from_pandas=True)
        for f in fields
    ]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def run_and_judge(
    base: Scenario, scenarios: Sequence[Scenario | UserError], measures: Measures, threads: int = 1
) -> list[Row]:
    """What the rows tell of runs: their results and measures by the names of the columns, without those that a run does
    not have. A run that a UserError stands for was refused by it.

    Recordings of 16 MB are in memory at a time, or that of one run. If nothing has to be judged from the whole course
    there are none, and the memory does not grow with the steps.

    `base`: a scenario of which the others differ in values alone."""
    results = Results(base)
    told: list[Row] = [refused(PLACE.sub("", str(s)), 0.0) if isinstance(s, UserError) else {} for s in scenarios]
    accepted = [(i, s) for i, s in enumerate(scenarios) if isinstance(s, Scenario)]
    reduce = joined(measures, results.reduce)

    def judged(batch: Sequence[Scenario]) -> list[Row]:
        runs = run_scenarios(batch, results.outputs, reduce, threads)
        return [{**run.measures, **results.row(s, run)} for s, run in zip(batch, runs, strict=True)]

    def limited(batch: Sequence[Scenario]) -> list[Row]:
        runs = run_scenarios(batch, SLAVE, {}, threads)
        return [limits_broken(s, run.recording) for s, run in zip(batch, runs, strict=True) if run.recording]

    _tell(told, accepted, len(results.outputs), judged)
    _tell(told, [(i, s) for i, s in accepted if results.lacks_limits(told[i])], len(SLAVE), limited)
    return told


def _tell(
    told: list[Row],
    runs: Iterable[tuple[int, Scenario]],
    outputs: int,
    rows_of: Callable[[Sequence[Scenario]], list[Row]],
) -> None:
    """Add to the rows with these numbers what is told of the runs; so many outputs of them are recorded."""
    for batch in _batches(runs, outputs):
        for (i, _), row in zip(batch, rows_of([s for _, s in batch]), strict=True):
            told[i] |= row


def _batches(runs: Iterable[tuple[int, Scenario]], outputs: int) -> Iterator[list[tuple[int, Scenario]]]:
    """The runs in batches whose recordings of so many outputs fit into memory together."""
    batch: list[tuple[int, Scenario]] = []
    size = 0.0
    for i, s in runs:
        needed = _points(s) * (POINT + VALUE * outputs if outputs else VALUE)
        if batch and size + needed > MOST_MEMORY:
            yield batch
            batch, size = [], 0.0
        batch.append((i, s))
        size += needed
    if batch:
        yield batch


def _points(scenario: Scenario) -> float:
    """For about how many communication points a run needs memory."""
    scans = scenario.stop_time / scenario.scan if scenario.reacts else 0.0
    return scenario.stop_time / scenario.step_size + scans * (1.0 + 0.5 * len(scenario.reactions))
