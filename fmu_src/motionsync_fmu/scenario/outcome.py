"""The outcome of a run: the record that `motionsync run` prints."""

from dataclasses import asdict, dataclass
from typing import Any

from .cuts import Cut
from .judge import Check, Deviation


@dataclass(frozen=True)
class Outcome:
    """The results of a run of a scenario, and where they are written. The fields are the keys of `--json`.

    Attributes:
        scenario: the folder of the scenario.
        fmu: the block's name.
        step_size: the step size of this run, in s.
        reference: how far the run is from the reference; empty without one.
        cuts: empty if the scenario has no table [cuts].
        messages: what the FMU logged.
        result: the CSV file with the outputs.
        report: the HTML page; None: no page is written.
        fmpy: the command line that does the same with FMPy alone.
    """

    scenario: str
    title: str
    fmu: str
    step_size: float
    passed: bool
    expectations: list[Check]
    reference: list[Deviation]
    cuts: list[Cut]
    messages: list[str]
    result: str
    report: str | None
    fmpy: str

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        reference = [
            {"variable": d.name, "max_difference": d.greatest, "at": d.at, "allowed": d.allowed, "passed": d.passed}
            for d in self.reference
        ]
        return asdict(self) | {"reference": reference}
