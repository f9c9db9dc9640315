"""The export for the cross-check: FMPy's own check of the cross-check's rules, and runs from the files alone."""

from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.cross_check.validate_vendor_repo import validate_test_fmu
from fmpy.util import read_csv, read_ref_opt_file

from motionsync.blocks import BLOCKS
from motionsync_fmu import __version__
from motionsync_fmu.export.crosscheck import export, models, recipe_of, refusal
from motionsync_fmu.native.platforms import host_platform
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.files.shipped import find_files
from tests import ROOT
from tests.support.references import assert_met

PLATFORM = host_platform()
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


def test_without_a_name_all_blocks_are_exported() -> None:
    exported = models([])
    assert [model.name for model in exported] == list(BLOCKS)
    for model in exported:
        model.recipe.block()


def test_what_is_exported_can_be_initialized_from_its_start_values_alone() -> None:
    """Every seventh of the scenarios."""
    scenarios = [load_scenario(file) for file in find_files(ROOT / "scenarios")[::7]]
    allowed = [scenario for scenario in scenarios if not refusal(scenario)]
    assert len(allowed) > 0.8 * len(scenarios)
    for scenario in allowed:
        assert recipe_of(scenario).block().initialize() == 0, scenario.label
