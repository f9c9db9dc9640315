"""A run of a sweep alone: `motionsync run --set`, with the very values of the run."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from motionsync_fmu import places
from motionsync_fmu.build import Flavour, fmu_path
from motionsync_fmu.scenario.judge import check
from motionsync_fmu.scenario.run import run_in_process
from motionsync_fmu.sweep.plan import SweepPlan
from motionsync_fmu.sweep.plot.page import make_page
from motionsync_fmu.sweep.plot.view import Question
from motionsync_fmu.sweep.repeat import with_values
from motionsync_fmu.sweep.rows import rows
from tests.support.command_line import Command, assert_one_line
from tests.support.fmus import Fmus
from tests.sweep.made_up import EXAMPLE, unpacked

SAMPLED = [
    "master.velocity=100..1500",
    "axis.max_acceleration=2000..10000",
    "axis.max_deceleration=axis.max_acceleration",
]
LISTED = ["late_mode=LATE,SKIP", "order.quantity=1,2"]
SCENARIO = "CutToLength/basic_cut"


def test_the_printed_values_make_the_same_scenario() -> None:
    """All fields are compared, to the bit."""
    plan = SweepPlan.of(EXAMPLE, [*SAMPLED, *LISTED], samples=2, seed=3)
    for run in range(plan.runs):
        given = {name: str(values.tolist()[0]) for name, values in plan.values(run, run + 1).items()}
        found, expected = with_values(EXAMPLE, given), plan.scenario(run)
        assert (found.master.breaks, found.master.motions) == (expected.master.breaks, expected.master.motions)
        assert replace(found, master=expected.master) == expected


def test_a_run_is_judged_as_the_sweep_judges_it(motionsync: Command, fmus: Fmus) -> None:
    """Through the FMU, without the reference, which is one of the file's own values; the folder is one of its own."""
    plan = SweepPlan.of(EXAMPLE, ["master.velocity=390..410"], samples=3)
    value = plan.values(1, 2)["master.velocity"].tolist()[0]
    scenario = plan.scenario(1)
    expected = check(scenario, run_in_process(scenario, scenario.step_size))
    fmu = fmu_path(scenario.recipe, places.OUTPUT, Flavour.PYTHON)
    fmu.parent.mkdir(parents=True)
    shutil.copy(fmus.python("CutToLength"), fmu)
    done = motionsync("run", EXAMPLE, "--set", f"master.velocity={value!r}", "--flavour", "python", "--json")
    (outcome,) = json.loads(done.out)
    assert done.status == 1
    assert outcome["given"] == {"master.velocity": repr(value)}
    assert [c["found"] for c in outcome["expectations"]] == [c.found for c in expected]
    assert outcome["reference"] == []
    report = Path(outcome["report"])
    assert report.parent.name.startswith("cut_to_length-")
    assert f"<code>master.velocity</code> = {value!r}" in report.read_text("utf-8")
    assert (report.parent / "CutToLength_in.csv").is_file()


@pytest.mark.parametrize(
    ("setting", "parts"),
    [
        ("master.velocty=500", ("--set", "'master.velocty'", "master.velocity")),
        ("master.velocity", ("--set", "NAME=VALUE")),
        ("master.velocity=fast", ("--set", "master.velocity=fast", "'fast' is no value")),
        ("master.velocity=100:200:3", ("--set", "one value", "motionsync sweep")),
        ("master.velocity=nan", ("--set", "finite")),
        ("axis.max_acceleration=-1", ("--set", "axis.max_acceleration", "-1")),
    ],
)
def test_a_value_that_is_none_is_told(motionsync: Command, setting: str, parts: tuple[str, ...]) -> None:
    assert_one_line(motionsync("run", SCENARIO, "--set", setting, "--flavour", "python"), *parts)


def test_a_command_of_the_page_repeats_the_run_that_it_tells(tmp_path: Path) -> None:
    """A sweep that is really run: what the page's command sets gives the measures of the row, to the bit."""
    measures = {"slave.acceleration": ["max"], "limits.min_length": ["last"]}
    plan = SweepPlan.of(EXAMPLE, SAMPLED, samples=4, seed=1, measures=measures)
    plan.write(tmp_path)
    table = rows(plan, 0, plan.runs)
    pq.write_table(table, tmp_path / "part-000000.parquet")
    page = make_page(tmp_path, Question("master.velocity", "slave.acceleration.max")).read_text("utf-8")
    packed = json.loads(re.findall(r'id="sweep">(.*)</script>', page)[0])["runs"]
    numbers = unpacked(packed["numbers"])
    assert numbers == [float(run) for run in range(4)]  # each run lies alone in its cell
    values = {c["name"]: unpacked(c["values"]) for c in packed["columns"] if c["varied"]}
    for i, told in enumerate(table.to_pylist()):
        scenario = with_values(EXAMPLE, {name: repr(of_run[i]) for name, of_run in values.items()})
        recording = run_in_process(scenario, scenario.step_size)
        assert recording.values["slave.acceleration"][1:].max() == told["slave.acceleration.max"]
        assert recording.values["limits.min_length"][-1] == told["limits.min_length.last"]
        assert recording.values["statistics.cuts"][-1] == told["cuts"]
