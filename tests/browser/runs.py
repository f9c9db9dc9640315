"""The runs of scenarios that pages show, each made once."""

from functools import cache

from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT


@cache
def run(name: str) -> tuple[Scenario, Recording]:
    """A scenario that comes with motionsync, and its recording."""
    scenario = load_scenario(ROOT / "scenarios" / name / "scenario.toml")
    return scenario, run_in_process(scenario, scenario.step_size)
