"""The picture of the machine: which blocks have one, and how big it is. What it shows is tested in a browser."""

import re
from pathlib import Path

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages.machine import description
from motionsync_fmu.pages.machine.fragment import machine
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT
from tests.support.scenarios.recordings import run_compiled


@pytest.fixture(scope="module")
def cyclic_cut() -> tuple[Scenario, Recording]:
    scenario = load_scenario(ROOT / "scenarios" / "FlyingSaw" / "cyclic_cut" / "scenario.toml")
    (run,) = run_compiled(scenario)
    assert run.recording
    return scenario, run.recording


def test_the_cyclic_cut_is_below_300_kilobytes(cyclic_cut: tuple[Scenario, Recording]) -> None:
    assert len(machine(*cyclic_cut).encode()) < 300_000


def test_a_block_without_a_picture_has_none(
    cyclic_cut: tuple[Scenario, Recording], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(description, "block_file", lambda *_: tmp_path / "machine.toml")
    assert machine(*cyclic_cut) == ""


AXES = """
[[picture]]
scene = "axes"
master_period = ["master.period"]
slave_period = ["master.period"]
coupled = ["state == EXECUTING"]
changing = ["syn_ramp_on"]
master_marks = [{ label = "ramp", at = "local.ramp_begin", shown = ["syn_ramp_on"] }]
"""


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('scene = "axes"', "", "2: scene: is missing"),
        ('scene = "axes"', 'scene = "axis"', "3: scene: 'axis' is none of axes, belt"),
        ('changing = ["syn_ramp_on"]', "", "2: changing: is missing"),
        ('label = "ramp", ', "", "8: label: is missing"),
        ("ramp_begin", "ramp_start", "8: at: Synchronizer has no variable 'local.ramp_start'; do you mean"),
        ("EXECUTING", "RUNNING", "6: coupled: 'RUNNING' is no Enumeration: it must be 0 READY,"),
        ('"master.period"', '"master.period unless cyclic"', "4: master_period: Synchronizer has no variable"),
        ('scene = "axes"', 'scene = "belt"', "2: tool: is missing"),
    ],
)
def test_a_mistake_in_a_description_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: str, after: str, message: str
) -> None:
    file = tmp_path / "machine.toml"
    monkeypatch.setattr(description, "block_file", lambda *_: file)
    file.write_text(AXES)
    block = Recipe("Synchronizer")
    assert [picture["scene"] for picture in description.pictures_of(block)] == ["axes"]
    file.write_text(AXES.replace(before, after))
    with pytest.raises(UserError, match=re.escape(f"machine.toml:{message}")):
        description.pictures_of(block)


def test_the_description_of_every_block_has_no_mistake(block: str) -> None:
    description.pictures_of(Recipe(block))


@pytest.mark.parametrize("key", ["turn", "along_material", "next_cut"])
def test_a_cylinder_needs_all_of_its_keys(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, key: str) -> None:
    file = ROOT / "model" / "motionsync" / "rotary_knife" / "machine.toml"
    text = "\n".join(line for line in file.read_text("utf-8").splitlines() if not line.startswith(f"{key} "))
    (tmp_path / "machine.toml").write_text(text, "utf-8")
    monkeypatch.setattr(description, "block_file", lambda *_: tmp_path / "machine.toml")
    with pytest.raises(UserError, match=f"{key}.*is missing"):
        description.pictures_of(Recipe("RotaryKnife"))
