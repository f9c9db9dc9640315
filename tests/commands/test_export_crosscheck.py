"""`motionsync export-crosscheck`: the folders that it writes, and its messages."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description

from motionsync_fmu.export import crosscheck
from motionsync_fmu.fmus.fmu import BuildOptions, build
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import ROWS, host_platform
from tests import ROOT
from tests.support.command_line import Command

PLATFORM = host_platform()


@pytest.mark.skipif(PLATFORM is None, reason="no native FMU runs on this machine")
def test_the_command_writes_the_same_fmu_for_each_platform(
    motionsync: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The FMU is built with the binary for this machine alone, which is quicker."""

    def build_quickly(recipe: Recipe, target: Path, options: BuildOptions, progress: Any) -> Path:
        assert options.platforms == ROWS
        assert PLATFORM
        return build(recipe, target, replace(options, platforms=[PLATFORM]), progress)

    monkeypatch.setattr(crosscheck, "build", build_quickly)
    outcome = motionsync("export-crosscheck", "here", "synchronizer")
    assert outcome.status == 0, outcome.err
    folders = [Path(line) for line in outcome.out.splitlines()]
    assert [folder.parts[:5] for folder in folders] == [
        ("here", "fmus", "2.0", "cs", platform) for platform in ("linux64", "win64", "darwin64", "c-code")
    ]
    assert len({(tmp_path / folder / "Synchronizer.fmu").read_bytes() for folder in folders}) == 1
    starts = {v.name: v.start for v in read_model_description(str(folders[0] / "Synchronizer.fmu")).modelVariables}
    assert (starts["rest_value"], starts["master.period"], starts["master.velocity"]) == ("180.0", "360.0", "180.0")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["Gear"], "Gear: no such file or folder; did you mean Gearing"),
        (["Gearing", "gearing"], "gearing: Gearing is given twice"),
        (["CutToLength/cyclic_orders"], "no model of the cross-check: its inputs depend on the block's outputs"),
        (["Synchronizer/end_of_step_inputs"], "cross-check: its inputs are those of the end of each step, and"),
        (
            ["Synchronizer/phasing_changed_while_executing"],
            "check: output_phasing = 0 is not allowed: it must be a",
        ),
        (["CutToLength/limit_exceeded"], "something happens at 1.925 s, between two steps of 0.01 s"),
        (["own"], "own/scenario.toml: no model of the cross-check: it has no reference"),
    ],
)
def test_what_cannot_be_exported_is_reported(
    names: list[str], message: str, motionsync: Command, tmp_path: Path
) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "scenario.toml").write_bytes((ROOT / "model/motionsync/gearing/example.toml").read_bytes())
    outcome = motionsync("export-crosscheck", "here", *names)
    assert (outcome.status, outcome.out) == (2, "")
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert not (tmp_path / "here").exists()
