"""The runs of scenarios that pages show, each made once."""

from functools import cache

from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT
from tests.support.scenarios.recordings import run_compiled


@cache
def run(name: str) -> tuple[Scenario, Recording]:
    """A scenario that comes with motionsync, and its recording."""
    scenario = load_scenario(ROOT / "scenarios" / name / "scenario.toml")
    return scenario, record(scenario)


def record(scenario: Scenario) -> Recording:
    """The recording of a run in compiled code, which has the bits of Python and takes far less time."""
    (run,) = run_compiled(scenario)
    assert run.recording, run.failure
    return run.recording
