"""The checks of a recording, whatever of the slave it has."""

from motionsync_fmu.scenario.evaluate.cutting_results import CuttingResults
from motionsync_fmu.scenario.evaluate.expectations import Check
from motionsync_fmu.scenario.evaluate.key_figures import SLAVE_OUTPUTS, find_peaks
from motionsync_fmu.scenario.evaluate.verdict import find_checks, gather
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario


def checks_of(scenario: Scenario, recording: Recording) -> list[Check]:
    """All that is checked of a run but its reference; the limits of the axis, if the slave's motion was recorded."""
    peaks = find_peaks(scenario, recording) if all(name in recording.values for name in SLAVE_OUTPUTS) else []
    checks = find_checks(gather(scenario, recording, CuttingResults(scenario, recording), peaks))
    return [check for check in checks if isinstance(check, Check)]
