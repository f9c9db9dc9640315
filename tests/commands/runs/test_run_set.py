"""A run of a sweep alone, by `motionsync run --set` with the very values of the run."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq

from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.sweeps.plot.page import make_page
from motionsync_fmu.sweeps.plot.view import Question
from motionsync_fmu.sweeps.rows import rows
from motionsync_fmu.sweeps.sweep_plan import SweepPlan
from tests.sweeps.example_plans import EXAMPLE, unpacked

SAMPLED = [
    "master.velocity=100..1500",
    "axis.max_acceleration=2000..10000",
    "axis.max_deceleration=axis.max_acceleration",
]
LISTED = ["late_mode=LATE,SKIP", "order.quantity=1,2"]


def test_the_printed_values_make_the_same_scenario() -> None:
    """All fields are compared, to the bit."""
    plan = SweepPlan.of(EXAMPLE, [*SAMPLED, *LISTED], samples=2, seed=3)
    for run in range(plan.runs):
        given = {name: str(values.tolist()[0]) for name, values in plan.values(run, run + 1).items()}
        result, expected = load(EXAMPLE, set=given), plan.scenario(run)
        assert (result.master.breaks, result.master.motions) == (expected.master.breaks, expected.master.motions)
        assert replace(result, master=expected.master, overrides={}) == expected


def test_a_command_of_the_page_repeats_the_run_that_it_shows(tmp_path: Path) -> None:
    """A sweep that is really run: what the page's command sets gives the measures of the row, to the bit."""
    measures = {"slave.acceleration": ["max"], "limits.min_length": ["last"]}
    plan = SweepPlan.of(EXAMPLE, SAMPLED, samples=4, seed=1, measures=measures)
    plan.write(tmp_path)
    table = rows(plan, 0, plan.runs)
    pq.write_table(table, tmp_path / "part-000000.parquet")
    page = make_page(tmp_path, Question("master.velocity", "slave.acceleration.max")).read_text("utf-8")
    packed = json.loads(re.findall(r'id="sweep">(.*)</script>', page)[0])["runs"]
    numbers = unpacked(packed["numbers"])
    assert numbers == [float(run) for run in range(4)]  # each run is alone in its cell
    values = {c["name"]: unpacked(c["values"]) for c in packed["columns"] if c["varied"]}
    for i, error in enumerate(table.to_pylist()):
        scenario = load(EXAMPLE, set={name: repr(of_run[i]) for name, of_run in values.items()})
        recording = run_in_process(scenario, scenario.step_size)
        assert recording.values["slave.acceleration"][1:].max() == error["slave.acceleration.max"]
        assert recording.values["limits.min_length"][-1] == error["limits.min_length.last"]
        assert recording.values["statistics.cuts"][-1] == error["cuts"]
