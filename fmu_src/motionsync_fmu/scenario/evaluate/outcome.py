"""The outcome of a run: the record that `motionsync run` prints."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from .expectations import Check
from .key_figures import KeyFigures
from .reference_comparison import Deviation


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
        unmet: the reactions that happened less often than they could have, in words; without those that are required,
            which are among the expectations.
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
    unmet: list[str]
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

    @property
    def notes(self) -> list[str]:
        """What a reader should know although no check fails by it, a sentence each."""
        notes = [f"beyond the limit of the axis: {p.text}" for p in self.figures.peaks if p.exceeded]
        if self.figures.uncut:
            notes.append(self.figures.uncut_text)
        if self.figures.production:
            notes += self.figures.production.notes
        notes += self.figures.axis_notes
        notes += self.unmet
        if not self.expectations and not self.reference:
            notes.append("nothing is checked: the scenario has no [[expect]], no [cuts] and no reference")
        return notes

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        values = asdict(self) | {"passed": self.passed}
        figures = values.pop("figures")
        reference = [
            {"variable": d.name, "max_difference": d.greatest, "at": d.at, "allowed": d.allowed, "passed": d.passed}
            for d in self.reference
        ]
        del values["unmet"]  # it is among the notes
        if not values["overrides"]:
            del values["overrides"]
        given = [key for key in ("true_pieces", "following_error", "load") if figures[key] is not None]
        shown = {key: figures[key] for key in ("cuts", "uncut", "production", *given, "peaks")}
        return values | shown | {"reference": reference, "notes": self.notes}
