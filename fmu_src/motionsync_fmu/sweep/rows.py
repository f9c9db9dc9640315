"""A chunk of a sweep's runs: run, judged, and told in a table, a row a run.

A run that fails is a row, too: what was refused stands in it. Recordings of a few runs at a time are in memory."""

import re
from typing import Any

import pyarrow as pa

from ..errors import UserError
from ..scenario.run import run_in_process
from . import results
from .measures import columns
from .plan import SweepPlan

PLACE = re.compile(r"^.*?\.toml(:\d+)?: ")  # file and line, which say nothing of a varied value
REFUSED = re.compile(r"at (\S+) s (.*)", re.DOTALL)


def schema(plan: SweepPlan) -> pa.Schema:
    """The columns of the rows: the run's number, factors and derived values, what became of the run, and measures."""
    values = {name: pa.array(of_run).type for name, of_run in plan.values(0, 1).items()}
    measured = dict.fromkeys(columns(plan.measures), pa.float64())
    return pa.schema({"run": pa.int64()} | values | results.columns(plan.base) | measured)


def rows(plan: SweepPlan, first: int, last: int, threads: int = 1) -> pa.Table:
    """The rows of the runs from `first` up to, but not including, `last`.

    `threads`: how many run at the same time."""
    told = [_row(plan, run) for run in range(first, last)]
    wanted = schema(plan)
    given = {"run": range(first, last), **plan.values(first, last)}
    arrays = [pa.array(given[f.name] if f.name in given else [row.get(f.name) for row in told], f.type) for f in wanted]
    return pa.Table.from_arrays(arrays, schema=wanted)


def _row(plan: SweepPlan, run: int) -> dict[str, Any]:
    try:
        scenario = plan.scenario(run)
    except UserError as e:
        return results.refused(PLACE.sub("", str(e)), 0.0)
    try:
        recording = run_in_process(scenario, scenario.step_size)
    except UserError as e:
        at, text = REFUSED.fullmatch(PLACE.sub("", str(e))).groups()
        return results.refused(text, float(at))
    return results.told(scenario, recording)
