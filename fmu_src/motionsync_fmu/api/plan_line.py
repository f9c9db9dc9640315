"""What `motionsync plan-line` does."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from ..plan.line_plan import LinePlan, make_plan
from ..plan.reader import read_machines, read_option
from ..plan.report import write_plan
from .frame import frame
from .scenario_source import Value, literal
from .shown import shown


def plan_line(
    *machines: str | Path,
    machine: str = "",
    set: Mapping[str, Value] | None = None,
    length: str | Sequence[float] = (),
    velocity: str | Sequence[float] = (),
    unit: str = "",
) -> LinePlanResult:
    """Predict how fast a line may run, and how short its pieces may be; runs of the blocks confirm each figure.

    Args:
        machines: a file with a machine's data, or a scenario of CutToLength or RotaryKnife or the name of one; without
            any, and for what `machine` asks for in addition, the block's own start values count.
        machine: `"saw"`, `"knife"`, or `"both"`, which says which of the two is the better one; by default the machines
            that are given, else a saw.
        set: parameters of the block, or `load.NAME`, in place of the file's values. With several machines those of an
            axis need the block's name: `{"RotaryKnife.axis.max_velocity": 3000}`.
        length: of the pieces, in u: numbers, or a text: `"500,1000"`, `"6 m"`, or `"300..3000"` for round numbers in
            between; by default those of the file, else a selection.
        velocity: of the line, in u/s, likewise.
        unit: of positions; by default the file's, else mm.

    Raises:
        UserError: something that is given is not allowed; the text is what the command line prints.
    """
    settings = {name: literal(value) for name, value in (set or {}).items()}
    data, own_lengths, own_velocities = read_machines([Path(m) for m in machines], machine, settings, unit)
    lengths, velocities = read_option("length", length, data[0]), read_option("velocity", velocity, data[0])
    with shown()("planning the line"):
        plan = make_plan(data, lengths or own_lengths, velocities or own_velocities)
    return LinePlanResult(plan.machines, plan.comparison)


class LinePlanResult(LinePlan):
    """The plan of a line, with its page."""

    def report(self, file: str | Path) -> Path:
        """Write the plan's HTML page, which needs no network, and return its path."""
        return write_plan(self, Path(file))

    def __repr__(self) -> str:
        confirmed = "confirmed" if self.is_confirmed else "NOT confirmed"
        return f"{self.title}: {len(self.predictions)} predictions, {confirmed} by {self.runs} runs"

    def _repr_html_(self) -> str:
        """The page, in a frame of its own."""
        with TemporaryDirectory() as folder:
            page = self.report(Path(folder, "report.html")).read_text("utf-8")
        return frame(page, self.title)
