"""Every scenario in this process, without an FMU: its expectations hold, and its reference is met."""

from pathlib import Path

import pytest

from motionsync_fmu.scenario.judge import check, compare
from motionsync_fmu.scenario.reader import load
from motionsync_fmu.scenario.run import run_in_process
from motionsync_fmu.scenario.shipped import find
from tests import ROOT


@pytest.mark.parametrize("file", find(ROOT / "scenarios"), ids=lambda file: "/".join(file.parts[-3:-1]))
def test_the_block_does_what_its_scenario_expects(file: Path) -> None:
    scenario = load(file)
    recording = run_in_process(scenario, scenario.step_size)
    found = [*check(scenario, recording), *compare(scenario, recording)]
    assert found
    assert [judged for judged in found if not judged.passed] == []
