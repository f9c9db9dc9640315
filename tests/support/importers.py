"""What several tests of importers have in common: a run through FMPy, which the others have to repeat bit for bit."""

from pathlib import Path
from typing import Any

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
