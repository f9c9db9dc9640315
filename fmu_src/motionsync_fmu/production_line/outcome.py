"""The outcome of a line: the record that `motionsync line` prints, and its files."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..paths import replace_files
from ..scenario.evaluate.csv_files import csv_text
from ..scenario.evaluate.expectations import Check
from .evaluation import LineResult, VariantErrors
from .line import REMOTE, ProductionLine
from .package import LinePackage
from .report import write_line_report


@dataclass(frozen=True, repr=False)
class LineOutcome:
    """The results of a line, and where they are written. The fields are the keys of `--json`.

    Attributes:
        line: the line file.
        synced: the time at which RemoteSync was in sync for the first time, in s; None: never.
        settled: the time from which it uses its drift in full, in s; None: never.
        before: the errors of each variant before `settled`.
        in_sync: those from then on.
        ssp: the SSP package.
        osp: the OSP system structure.
        result: the CSV file with the outputs.
        report: the HTML page; None: no page is written.
    """

    line: str
    title: str
    passed: bool
    synced: float | None
    settled: float | None
    before: list[VariantErrors]
    in_sync: list[VariantErrors]
    expectations: list[Check]
    ssp: str
    osp: str
    result: str
    report: str | None

    def __repr__(self) -> str:
        return f"{self.title} ({self.line}): {'as expected' if self.passed else 'NOT as expected'}"

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        return asdict(self)


def write_outcome(
    line: ProductionLine, package: LinePackage, result: LineResult, folder: Path, *, report: bool
) -> LineOutcome:
    """Write the outputs and, if `report` is true, the report into the folder."""
    outputs = {REMOTE: result.remote, line.follower.recipe.name: result.wired.recording.values}
    columns = {f"{component}.{n}": values.tolist() for component, of in outputs.items() for n, values in of.items()}
    file, page = folder / f"{line.name}_out.csv", folder / "report.html"
    with replace_files(folder) as part:
        part(file.name).write_text(
            csv_text(["time", *columns], zip(line.times.tolist(), *columns.values(), strict=True))
        )
        if report:
            write_line_report(part(page.name), line, package, result, file)
    return LineOutcome(
        str(line.follower.file),
        line.follower.title,
        result.passed,
        None if math.isinf(result.synced) else result.synced,
        None if math.isinf(result.settled) else result.settled,
        result.before,
        result.after,
        result.checks,
        str(package.ssp),
        str(package.osp),
        str(file),
        str(page) if report else None,
    )
