"""`motionsync new`: a scenario that runs."""

from pathlib import Path

import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu.fmus.fmu import Flavour
from tests.support.command_line import Command, assert_one_line
from tests.support.fmus import Fmus
from tests.support.workshop import PYTHON


@pytest.mark.parametrize("name", BLOCKS)
def test_a_new_scenario_runs_as_expected(motionsync: Command, fmus: Fmus, name: str) -> None:
    fmus.copied(Flavour.PYTHON, name, Path("build"))
    outcome = motionsync("new", name.lower(), "mine/first")
    assert (outcome.status, outcome.err) == (0, "")
    file = Path("mine/first/scenario.toml")
    assert outcome.out.splitlines()[:2] == [f"written: {file}", f"run it:  motionsync run {file.parent} --open"]
    assert file.read_text("utf-8").count("\n# ") >= 4
    outcome = motionsync("run", "mine/first", *PYTHON, "--no-report")
    assert (outcome.status, outcome.err) == (0, "")
    assert ": as expected\n" in outcome.out
    assert_one_line(motionsync("new", name, "mine/first"), str(file), "exists")
