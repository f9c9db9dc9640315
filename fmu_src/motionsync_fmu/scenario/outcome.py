"""The outcome of a run: the record that `motionsync run` prints."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from .figures import Figures
from .judge import Check, Deviation


@dataclass(frozen=True)
class Outcome:
    """The results of a run of a scenario, and where they are written. Nearly all fields are keys of `--json`.

    Attributes:
        scenario: the folder of the scenario.
        name: the scenario's short name, `<FMU>/<folder>`.
        fmu: the block's name.
        step_size: the step size of this run, in s.
        figures: the cuts, and how far the slave went beside the limits of its axis.
        reference: how far the run is from the reference; empty without one.
        messages: what the FMU logged.
        unmet: the reactions that happened less often than they could have, in words; without those that are required,
            which are among the expectations.
        result: the CSV file with the outputs.
        report: the HTML page; None: no page is written.
        fmpy: the command line that does the same with FMPy alone.
        given: what the scenario has in place of its file's values, by name; without any, no key of `--json`.
    """

    scenario: str
    name: str
    title: str
    fmu: str
    step_size: float
    figures: Figures
    expectations: list[Check]
    reference: list[Deviation]
    messages: list[str]
    unmet: list[str]
    result: str
    report: str | None
    fmpy: str
    given: Mapping[str, str] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether everything is as expected."""
        return not self.broken

    @property
    def broken(self) -> list[Check | Deviation]:
        """What is not as expected."""
        judged: list[Check | Deviation] = [*self.expectations, *self.reference]
        return [j for j in judged if not j.passed]

    @property
    def remarks(self) -> list[str]:
        """What a reader has to know although it is not judged, a sentence each; empty if there is nothing."""
        found = [f"beyond the limit of the axis: {p.text}" for p in self.figures.peaks if p.exceeded]
        if self.figures.uncut:
            found.append(self.figures.uncut_text)
        if self.figures.production:
            found += self.figures.production.remarks
        found += self.unmet
        if not self.expectations and not self.reference:
            found.append("nothing is judged: the scenario has no [[expect]], no [cuts] and no reference")
        return found

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        found = asdict(self) | {"passed": self.passed}
        figures = found.pop("figures")
        reference = [
            {"variable": d.name, "max_difference": d.greatest, "at": d.at, "allowed": d.allowed, "passed": d.passed}
            for d in self.reference
        ]
        del found["unmet"]  # a part of the remarks
        if not found["given"]:
            del found["given"]
        kept = {key: figures[key] for key in ("cuts", "uncut", "production", "peaks")}
        return found | kept | {"reference": reference, "remarks": self.remarks}
