"""The HTML page that leads to the reports of several scenarios."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..scenario.outcome import Outcome
from .style import TEMPLATES


def write_overview(file: Path, outcomes: Sequence[Outcome], left_out: Mapping[str, list[str]]) -> None:
    """Write the page; it loads nothing from elsewhere.

    `left_out`: the names of scenarios without a result, by the reason."""
    rows = [(o, Path(os.path.relpath(o.report, file.parent)).as_posix()) for o in outcomes if o.report]
    broken = sum(not o.passed for o in outcomes)
    text = TEMPLATES.get_template("overview.html.j2").render(rows=rows, broken=broken, left_out=left_out)
    file.write_text(text, "utf-8")
