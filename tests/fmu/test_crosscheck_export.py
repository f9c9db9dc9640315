"""`motionsync export-crosscheck`: FMPy's own check of the cross-check's rules, and runs from the files alone."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.cross_check.validate_vendor_repo import validate_test_fmu
from fmpy.util import read_csv, read_ref_opt_file

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__, crosscheck
from motionsync_fmu.build import build_native
from motionsync_fmu.crosscheck import export, models, recipe_of, refusal
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.native.platforms import ROWS, Platform, here
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.shipped import find
from tests import ROOT
from tests.support.command_line import Command
from tests.support.references import assert_met

PLATFORM = here()
NAMES = ["Gearing", "RemoteSync/drift_changes"]


@pytest.mark.skipif(PLATFORM is None, reason="no native FMU runs on this machine")
@pytest.mark.parametrize("name", NAMES)
def test_an_importer_gets_the_reference_from_the_files(name: str, tmp_path: Path) -> None:
    """The Gearing's example changes tunable parameters, which become inputs."""
    assert PLATFORM
    (model,) = models([name])
    folder, in_c = export(model, tmp_path, platforms=[PLATFORM])
    title = name.replace("/", "_")
    assert folder == tmp_path / "fmus" / "2.0" / "cs" / PLATFORM.folder / "motionsync" / __version__ / title
    assert sorted(f.name for f in folder.iterdir()) == sorted(
        ["README.md", f"{title}.fmu", f"{title}_in.csv", f"{title}_ref.csv", f"{title}_ref.opt"]
    )
    assert in_c == tmp_path / "fmus" / "2.0" / "cs" / "c-code" / "motionsync" / __version__ / title
    assert validate_test_fmu(str(folder)) == validate_test_fmu(str(in_c)) == []
    options = read_ref_opt_file(folder / f"{title}_ref.opt")
    inputs, reference = (read_csv(folder / f"{title}_{kind}.csv") for kind in ("in", "ref"))
    result = simulate_fmu(
        str(folder / f"{title}.fmu"),
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        input=inputs,
        output=reference.dtype.names[1:],
    )
    assert_met(reference, result, options["RelTol"])
    assert np.ptp(reference["slave.position"]) > 50.0
    times = np.unique(reference["time"])
    assert times[-1] == options["StopTime"]
    assert np.diff(times).max() == pytest.approx(options["OutputIntervalLength"], rel=1e-6)
    causality = {v.name: v.causality for v in read_model_description(str(folder / f"{title}.fmu")).modelVariables}
    assert {causality[name] for name in inputs.dtype.names[1:]} == {"input"}
    assert {causality[name] for name in reference.dtype.names[1:]} == {"output"}
    assert 4 <= len(reference.dtype.names) <= 11


@pytest.mark.skipif(PLATFORM is None, reason="no native FMU runs on this machine")
def test_the_command_writes_the_same_fmu_for_each_platform(
    motionsync: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The FMU is built with the binary for this machine alone, which is quicker."""

    def build(recipe: Recipe, target: Path, progress: Any, platforms: Sequence[Platform], **further: Any) -> Path:
        assert platforms == ROWS
        assert PLATFORM
        return build_native(recipe, target, progress, [PLATFORM], **further)

    monkeypatch.setattr(crosscheck, "build_native", build)
    done = motionsync("export-crosscheck", "here", "synchronizer")
    assert done.status == 0, done.err
    places = [Path(line) for line in done.out.splitlines()]
    assert [place.parts[:5] for place in places] == [
        ("here", "fmus", "2.0", "cs", platform) for platform in ("linux64", "win64", "darwin64", "c-code")
    ]
    assert len({(tmp_path / place / "Synchronizer.fmu").read_bytes() for place in places}) == 1
    (fmu,) = {place / "Synchronizer.fmu" for place in places[:1]}
    starts = {v.name: v.start for v in read_model_description(str(fmu)).modelVariables}
    assert (starts["rest_value"], starts["master.period"], starts["master.velocity"]) == ("180.0", "360.0", "180.0")


def test_without_a_name_all_blocks_are_exported() -> None:
    found = models([])
    assert [model.name for model in found] == list(BLOCKS)
    for model in found:
        model.recipe.block()


def test_what_is_exported_can_be_initialized_from_its_start_values_alone() -> None:
    """Every seventh of the scenarios."""
    scenarios = [load(file) for file in find(ROOT / "scenarios")[::7]]
    allowed = [scenario for scenario in scenarios if not refusal(scenario)]
    assert len(allowed) > 0.8 * len(scenarios)
    for scenario in allowed:
        assert recipe_of(scenario).block().initialize() == 0, scenario.label


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["Gear"], "Gear: no such file or folder; did you mean Gearing"),
        (["Gearing", "gearing"], "gearing: Gearing is given twice"),
        (["CutToLength/cyclic_orders"], "no model of the cross-check: its inputs depend on what the block puts out"),
        (["Synchronizer/end_of_step_inputs"], "cross-check: its inputs are those of the end of each step, and"),
        (
            ["Synchronizer/phasing_changed_while_executing"],
            "check: output_phasing = 0 is not allowed: it must be a",
        ),
        (["CutToLength/limit_exceeded"], "something happens at 1.925 s, between two steps of 0.01 s"),
        (["own"], "own/scenario.toml: no model of the cross-check: it has no reference"),
    ],
)
def test_what_cannot_be_exported_is_told(names: list[str], message: str, motionsync: Command, tmp_path: Path) -> None:
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "scenario.toml").write_bytes((ROOT / "model/motionsync/gearing/example.toml").read_bytes())
    done = motionsync("export-crosscheck", "here", *names)
    assert (done.status, done.out) == (2, "")
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not (tmp_path / "here").exists()
