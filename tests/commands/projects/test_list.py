"""`motionsync list`: the blocks, scenarios and lines that it names."""

import re
from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.interface.variables import summary
from tests import ROOT
from tests.support.project.command_line import Command
from tests.support.project.workshop import STOP, scenario


@pytest.mark.all_blocks
def test_list_counts_the_scenarios_of_each_block(motionsync: Command) -> None:
    outcome = motionsync("list")
    assert (outcome.status, outcome.err) == (0, "")
    counts = dict(re.findall(r"^ *(\w+) +(\d+) ", outcome.out, re.M))
    for name in BLOCKS:
        files = (ROOT / "scenarios").rglob("scenario.toml")
        assert summary(BLOCKS[name]) in outcome.out
        assert counts[name] == str(sum(f'\nfmu = "{name}"\n' in file.read_text("utf-8") for file in files))
    assert "line/line.toml" in outcome.out


def test_list_of_a_block_names_what_can_be_run(motionsync: Command) -> None:
    outcome = motionsync("list", "Synchronizer")
    assert (outcome.status, outcome.err) == (0, "")
    title = "A stop and a start along the 3-4-5 polynomial"
    assert re.search(rf"^ *Synchronizer/polynomial +{title} *$", outcome.out, re.M)
    assert "FlyingSaw" not in outcome.out


def test_list_of_an_own_folder_names_its_scenarios_in_full(motionsync: Command) -> None:
    long = Path("mine/Synchronizer/a_scenario_whose_name_says_all_that_happens_in_it")
    scenario(str(long))
    outcome = motionsync("list", "--scenarios", "mine")
    assert (outcome.status, outcome.err) == (0, "")
    assert re.search(rf"^ *{re.escape(str(long))} +A stop along a parabola *$", outcome.out, re.M)


def test_list_reports_a_missing_folder(motionsync: Command) -> None:
    outcome = motionsync("list", "--scenarios", "elsewhere")
    assert outcome.status == 0
    assert "elsewhere" in outcome.out


def test_list_reports_a_broken_scenario_in_one_line(motionsync: Command) -> None:
    file = scenario("mine", STOP.replace("title =", "titel ="))
    outcome = motionsync("list", "--scenarios", "mine")
    assert outcome.status == 2
    assert outcome.err.startswith(f"motionsync: {file}:1: title: ")
    assert outcome.err.count("\n") == 1
