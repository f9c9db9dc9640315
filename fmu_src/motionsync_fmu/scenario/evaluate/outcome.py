"""The outcome of a run: the record that `motionsync run` prints."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from ..files.shipped import scenario_name
from ..recording import Recording
from ..scenario import Scenario
from .cutting_results import CuttingResults
from .expectations import Check
from .key_figures import KeyFigures, compute_key_figures
from .reference_comparison import Deviation, compare_with_reference
from .verdict import find_checks, find_notes, gather


@dataclass(frozen=True, repr=False)
class ScenarioOutcome:
    """The results of a run of a scenario, and the files with them. Nearly all fields are keys of `--json`.

    Attributes:
        scenario: the folder of the scenario.
        name: the scenario's short name, `<FMU>/<folder>`.
        fmu: the block's name.
        step_size: the step size of this run, in s.
        figures: the cuts, and the slave's extreme values next to the limits of its axis.
        reference: how far the run is from the reference; empty without one.
        messages: what the FMU logged.
        notes: what a reader should know although no check fails by it, a sentence each.
        result: the CSV file with the outputs; empty: it is not written.
        report: the HTML page; None: no page is written.
        fmpy: the command line that does the same with FMPy alone; empty: the inputs for it are not written.
        overrides: the values that replace those of the scenario's file, by name; without any, no key of `--json`.
    """

    scenario: str
    name: str
    title: str
    fmu: str
    step_size: float
    figures: KeyFigures
    expectations: list[Check]
    reference: list[Deviation]
    messages: list[str]
    notes: list[str]
    result: str = ""
    report: str | None = None
    fmpy: str = ""
    overrides: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        files = ", ".join(file for file in (self.result, self.report) if file)
        return f"{self.title} ({self.name}): {'as expected' if self.passed else 'NOT as expected'} {files}".rstrip()

    @property
    def passed(self) -> bool:
        """Whether everything is as expected."""
        return not self.failed

    @property
    def failed(self) -> list[Check | Deviation]:
        """What is not as expected."""
        checks: list[Check | Deviation] = [*self.expectations, *self.reference]
        return [c for c in checks if not c.passed]

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        values = asdict(self) | {"passed": self.passed}
        figures = values.pop("figures")
        reference = [
            {"variable": d.name, "max_difference": d.greatest, "at": d.at, "allowed": d.allowed, "passed": d.passed}
            for d in self.reference
        ]
        if not values["overrides"]:
            del values["overrides"]
        if (true := figures["true_pieces"]) and not math.isfinite(true["c_pk"]):
            true["c_pk"] = None
        given = [key for key in ("true_pieces", "following_error", "load") if figures[key] is not None]
        shown = {key: figures[key] for key in ("cuts", "uncut", "production", *given, "peaks")}
        return values | shown | {"reference": reference, "notes": values["notes"]}


def evaluate_run(scenario: Scenario, recording: Recording) -> ScenarioOutcome:
    """Compare a recording with what is expected; nothing is written yet.

    Raises:
        UserError: the scenario's reference cannot be used.
    """
    results = CuttingResults(scenario, recording)
    figures = compute_key_figures(scenario, recording, results)
    reference = [] if scenario.overrides else compare_with_reference(scenario, recording)
    evidence = gather(scenario, recording, results, figures.peaks, reference, figures.load)
    return ScenarioOutcome(
        scenario=scenario_name(scenario.file),
        name=scenario.label,
        title=scenario.title,
        fmu=scenario.recipe.name,
        step_size=scenario.step_size,
        figures=figures,
        expectations=[check for check in find_checks(evidence) if isinstance(check, Check)],
        reference=reference,
        messages=recording.messages,
        notes=find_notes(evidence),
        overrides=scenario.overrides,
    )
