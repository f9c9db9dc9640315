"""The HTML page with links to the reports of several scenarios."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..paths import replace_file
from ..scenario.evaluate.outcome import ScenarioOutcome
from .style import TEMPLATES, load_template


def write_overview(file: Path, outcomes: Sequence[ScenarioOutcome], left_out: Mapping[str, list[str]]) -> None:
    """Write the page; it loads nothing from elsewhere.

    `left_out`: the names of scenarios without a result, by the reason."""
    rows = [(o, Path(os.path.relpath(o.report, file.parent)).as_posix()) for o in outcomes if o.report]
    failed = sum(not o.passed for o in outcomes)
    text = load_template(TEMPLATES, "overview.html.j2").render(rows=rows, failed=failed, left_out=left_out)
    with replace_file(file) as part:
        part.write_text(text, "utf-8")
