"""What makes a run fail, and what is a note: each entry of both lists, in a run, in a sweep and on the page."""

import json
import re
from pathlib import Path
from typing import NamedTuple

import pytest

from motionsync_fmu.scenario.evaluate.outcome import ScenarioOutcome, evaluate_run
from motionsync_fmu.scenario.evaluate.verdict import FAILURES, NOTES
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.sweeps.rows import run_and_evaluate
from tests import ROOT
from tests.support.scenarios.scenario_texts import FREE_SAW

SAW = """\
title = "Pieces of 800 from a line that slows down"
fmu = "CutToLength"
stop_time = 12.0
step_size = 0.004
[start]
length = 800.0
auto_start = true
[master]
velocity = 500.0
segments = [{ duration = 5.0 }, { duration = 1.0, acceleration = -200.0 }]
"""
LATE = "[servo]\nposition_gain = 50.0\ndead_time = 0.002\n"  # at 300 mm/s 0.4 mm nearer to the setpoint than at 500
FAST = SAW.replace("length = 800.0", 'length = 800.0\nlate_mode = "SKIP"').replace(
    "velocity = 500.0", "velocity = 1400.0"
)
GEARED = """\
title = "A gear that cannot be engaged"
fmu = "Gearing"
stop_time = 2.0
step_size = 0.01
[master]
velocity = 100.0
[[set]]
at = 0.5
start = true
"gearing.denominator" = 0
"""
FREE = FREE_SAW.replace("\n[master]", '"axis.max_velocity" = 80.0\n\n[master]')
KNIFE = (ROOT / "scenarios/RotaryKnife/formats/scenario.toml").read_text()
KNIFE += "[servo]\nposition_gain = 50.0\nvelocity_time_constant = 0.003\n"
MARKED = """\
title = "A slave that leaves its marks"
fmu = "Synchronizer"
unit = "mm"
stop_time = 2.0
step_size = 0.01
[start]
output_phasing = 5.0
[master]
velocity = 25.0
[[set]]
at = 0.5
stop = true
rest_value = 20.0
[cuts]
while = "syn_synchronized"
length = 5.0
tolerance = 100.0
"""
UNTIL = '[[expect]]\nfrom = 0.0\nto = 1.0\n"slave.position" = { max = 1e6 }\n'


class Case(NamedTuple):
    """A scenario that breaks a rule, the number of this rule, what is expected and what results, and what the scenario
    has to say so that the rule is kept."""

    rule: int
    text: str
    broken: str
    remedy: str = ""


def replaced(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1
    return text.replace(old, new)


FAILING = [
    Case(0, GEARED.replace("= 0\n", "= 1\n") + UNTIL.replace("max = 1e6", "min = 5.0"), "slave.position at least 5"),
    Case(
        0,
        SAW + '[[on]]\nwhen = "error"\nset = { hold = true }\nrequired = true\n',
        "reaction to error once: found never",
    ),
    Case(1, SAW + "[cuts]\ncount = 99\n", "number of pieces = 99: found 5"),
    Case(1, MARKED + "skipped = 4\ncount = 3\n", "number of cuts = 3: found 1"),
    Case(2, FAST, "number of skipped cuts = 0: found ", "[cuts]\nskipped = {number}\n"),
    Case(
        2,
        FAST.replace("SKIP", "LATE"),
        "number of late cuts = 0: found ",
        "[cuts]\nlate = {number}\ntolerance = 3000.0\n",
    ),
    Case(2, MARKED, "number of marks that pass uncut after the first cut = 0: found ", "skipped = {number}\n"),
    Case(
        3,
        SAW + LATE + "[cuts]\ntolerance = 0.2\nmovement = 1.0\n",
        "true lengths of products as ordered, within 0.2 mm",
    ),
    Case(
        3, replaced(SAW, "length = 800.0", "length = 800.0\nlength_tolerance = 0.1") + LATE, "true lengths of products"
    ),
    Case(4, SAW + LATE + "[cuts]\ntolerance = 0.5\nmovement = 0.01\n", "the tool moves in the cut by at most 0.01 mm"),
    Case(4, KNIFE, "the tool moves in the cut by at most 0.5 mm", "[cuts]\ntolerance = 1.0\nmovement = 1.5\n"),
    Case(
        5,
        FREE,
        "no limit of the axis exceeded: found velocity 100 mm/s",
        '[[expect]]\nat = 1.0\n"local.exceeded_limit" = 3\n',
    ),
    Case(
        5,
        FREE.replace("80.0", "99.0"),
        "no limit of the axis exceeded",
        "[[expect]]\nat = 1.0\nlimit_exceeded = true\n",
    ),
    Case(
        5,
        FREE.replace("80.0", "7.5"),
        "no limit of the axis exceeded",
        '[[expect]]\nat = 1.0\n"slave.velocity" = 100.0\n',
    ),
    Case(6, GEARED, "no alarm: found error_id = 1 at 0.51 s: ", "[[expect]]\nat = 1.0\nerror_id = 1\n"),
    Case(
        6, replaced(GEARED, "0.5", "1.23"), "no alarm: found error_id = 1", '[[expect]]\nwhen = "error"\ntime = 1.24\n'
    ),
]


def written(text: str, folder: Path) -> Scenario:
    (folder / "scenario.toml").write_text(text)
    return load_scenario(folder / "scenario.toml")


def outcome_of(scenario: Scenario) -> ScenarioOutcome:
    return evaluate_run(scenario, run_in_process(scenario, scenario.step_size))


def assert_same_in_a_sweep(scenario: Scenario, outcome: ScenarioOutcome) -> None:
    (row,) = run_and_evaluate(scenario, [scenario], {})
    assert (row["passed"], row["broken"]) == (outcome.passed, len(outcome.failed))
    assert row["first_broken"] == (outcome.failed[0].text if outcome.failed else "")


@pytest.mark.parametrize("case", FAILING, ids=lambda case: case.broken)
def test_each_rule_fails_a_run_in_all_that_evaluates_one(case: Case, tmp_path: Path) -> None:
    scenario = written(case.text, tmp_path)
    outcome = outcome_of(scenario)
    broken = [check for check in outcome.failed if check.text.startswith(case.broken)]
    assert broken, [check.text for check in outcome.failed]
    assert not outcome.passed
    assert json.loads(json.dumps(outcome.as_json()))["passed"] is False
    assert_same_in_a_sweep(scenario, outcome)
    if case.remedy:
        number = broken[0].text.rpartition("found ")[2].split()[0]
        expecting = written(case.text + case.remedy.replace("{number}", number), tmp_path)
        outcome = outcome_of(expecting)
        assert not outcome.failed
        assert_same_in_a_sweep(expecting, outcome)


def test_a_run_that_differs_from_its_reference_fails(tmp_path: Path) -> None:
    scenario = written(replaced(GEARED, "= 0\n", "= 1\n") + UNTIL, tmp_path)
    assert outcome_of(scenario).passed
    (tmp_path / "Gearing_ref.csv").write_text('"time","slave.velocity"\n0,0\n1,17\n2,100\n')
    outcome = outcome_of(scenario)
    assert not outcome.passed
    assert [check.text.partition(":")[0] for check in outcome.failed] == ["slave.velocity"]


def test_there_is_a_test_of_each_rule() -> None:
    assert {case.rule for case in FAILING} | {7} == {*range(len(FAILURES))}
    assert {case.rule for case in NOTED} == {*range(len(NOTES))}


@pytest.mark.parametrize(
    "expectation",
    [
        "[[expect]]\nat = 0.2\nerror = false\n",
        "[[expect]]\nat = 0.2\nerror_id = 0\n",
        "[[expect]]\nfrom = 0.0\nto = 2.0\nerror_id = { min = 0, max = 4 }\n",
        "[[expect]]\nfrom = 0.0\nto = 0.4\nerror = { max = 0 }\n",
    ],
)
def test_what_is_met_without_an_alarm_expects_none(expectation: str, tmp_path: Path) -> None:
    outcome = outcome_of(written(GEARED + expectation, tmp_path))
    assert [check.expected for check in outcome.failed] == ["no alarm"]


def test_another_alarm_than_the_expected_one_fails(tmp_path: Path) -> None:
    """The code 2, a numerator of 0, is expected and comes first; then 1, a denominator of 0."""
    text = replaced(GEARED, "denominator", "numerator")
    text += "[[expect]]\nat = 0.7\nerror_id = 2\n"
    assert outcome_of(written(text, tmp_path)).passed
    text += '[[set]]\nat = 1.0\nstart = false\n"gearing.numerator" = 3\n"gearing.denominator" = 0\n'
    text += "[[set]]\nat = 1.2\nstart = true\n"
    scenario = written(text, tmp_path)
    outcome = outcome_of(scenario)
    assert [check.actual.partition(":")[0] for check in outcome.failed] == ["error_id = 1 at 1.21 s"]
    assert_same_in_a_sweep(scenario, outcome)


# --- notes ------------------------------------------------------------------------------------------------------------

ORDER = """\
[[set]]
at = 0.1
"order.add" = true
"order.length" = 700.0
"order.quantity" = {quantity}
"""
FEW = SAW + ORDER.replace("{quantity}", "3")
MANY = SAW + ORDER.replace("{quantity}", "75")
COUNTS = """\
title = "A master in counts, which nothing smooths"
fmu = "Gearing"
stop_time = 2.0
step_size = 0.001
[start]
start = true
"master.input_mode" = "START_OF_STEP"
[master]
velocity = 437.7
[encoder]
resolution = 0.1
"""
NOTED = [
    Case(0, MANY, "1 order left at the end: the active one lacks ", "[cuts]\ntolerance = 1.0\norders_left = 1\n"),
    Case(0, MANY, "1 order left at the end: the active one lacks ", '[[expect]]\nat = 12.0\n"order.waiting" = 1\n'),
    Case(1, FAST, "the line was above its limit for "),
    Case(
        2,
        COUNTS,
        "master.input_warning = 1 at ",
        '[[expect]]\nwhen = "master.input_warning == 1"\ntime = 0.0\ntolerance = 2.0\n',
    ),
    Case(3, (ROOT / "scenarios/FlyingSaw/any_length/scenario.toml").read_text(), "before the first cut 1 mark"),
    Case(4, replaced(SAW, "step_size = 0.004", "step_size = 4.0"), "not reported: the step is longer"),
    Case(5, SAW + "[load]\nmass = 100.0\npeak_force = 10.0\n", "beyond the motor: peak force "),
    Case(6, SAW + '[[on]]\nwhen = "error"\nset = { hold = true }\n', "reaction to error once: found never"),
    Case(7, replaced(GEARED, "= 0\n", "= 1\n"), "nothing is checked"),
]


@pytest.mark.parametrize("case", NOTED, ids=lambda case: case.broken)
def test_each_note_is_one_and_fails_no_run(case: Case, tmp_path: Path) -> None:
    outcome = outcome_of(written(case.text, tmp_path))
    assert [note for note in outcome.notes if case.broken in note], outcome.notes
    assert json.loads(json.dumps(outcome.as_json()))["notes"] == outcome.notes
    if case.remedy:
        outcome = outcome_of(written(case.text + case.remedy, tmp_path))
        assert outcome.passed, outcome.failed
        assert not [note for note in outcome.notes if case.broken in note]


def test_orders_that_are_done_or_repeated_are_no_note(tmp_path: Path) -> None:
    assert not any("left" in note for note in outcome_of(written(FEW, tmp_path)).notes)
    endless = replaced(MANY, "[start]\n", '[start]\n"order.repeat" = true\n')
    assert not any("left" in note for note in outcome_of(written(endless, tmp_path)).notes)


def test_orders_that_are_expected_earlier_are_a_note_if_they_are_left(tmp_path: Path) -> None:
    earlier = written(MANY + '[[expect]]\nat = 3.0\n"order.waiting" = 1\n', tmp_path)
    assert any("left" in note for note in outcome_of(earlier).notes)


@pytest.mark.parametrize(("left", "passes"), [(0, False), (1, True), (2, False)])
def test_the_number_of_orders_left_is_checked(left: int, passes: bool, tmp_path: Path) -> None:
    scenario = written(MANY + f"[cuts]\ntolerance = 1.0\norders_left = {left}\n", tmp_path)
    outcome = outcome_of(scenario)
    assert outcome.passed == passes
    assert_same_in_a_sweep(scenario, outcome)


# --- the page ---------------------------------------------------------------------------------------------------------


def test_the_page_has_each_sentence_of_both_lists() -> None:
    page = (ROOT / "scenarios" / "README.md").read_text()
    section = page.partition("## What makes a run fail\n")[2].partition("\n## ")[0]
    listed = [" ".join(item.split()) for item in re.findall(r"^- (.*(?:\n  .*)*)", section, re.MULTILINE)]
    rules = [rule.sentence for rule in (*FAILURES, *NOTES)]
    assert [item for item in listed if item in rules] == rules
