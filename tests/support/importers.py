"""What several tests of importers have in common: a run through FMPy, which the others have to repeat bit for bit; and
fmutool's check of an FMU."""

import logging
from pathlib import Path
from typing import Any

import pytest
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU

from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.runs import BlockRun


class Logged(FmuInstance):
    """Keeps status and category of each message, too."""

    lines: list[tuple[int, str, str]]

    def _log(self, environment: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
        super()._log(environment, name, status, category, message)
        self.lines = [*getattr(self, "lines", []), (status, category.decode(), message.decode())]


def bits(values: dict[str, Any]) -> dict[str, Any]:
    """Values that are equal only if their bits are; the time, a variable of FMI 3.0 alone, is left out."""
    return {name: v.hex() if isinstance(v, float) else int(v) for name, v in values.items() if name != "time"}


def through_fmpy(fmu: Path, run: BlockRun) -> list[dict[str, Any]]:
    """All variables, initially and after each step."""
    with FmuInstance(fmu) as host:
        host.initialize(run.start)
        rows = [bits(host.get())]
        for h, values in run.steps:
            host.step(h, values)
            rows.append(bits(host.get()))
    return rows


def check_by_fmutool(fmu: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Check that `fmutool -check` finds neither an error nor a warning. A process of its own would import for a second.

    Raises:
        AssertionError: it does; the text is what it says.
    """
    with caplog.at_level(logging.INFO, "fmu_manipulation_toolbox"), FMU(str(fmu)) as opened:
        checkers = [checker() for checker in get_checkers()]
        for checker in checkers:
            opened.apply_operation(checker)
    text = caplog.text
    assert "compliant with FMI-2.0" in text
    assert "No semantic error" in text
    assert all(record.levelno < logging.WARNING for record in caplog.records), text
