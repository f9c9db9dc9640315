"""What `motionsync plan-line` does, as a function."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from .line_plan import LinePlan, make_plan
from .reader import read_machines, read_option


def plan_line(
    *machines: str | Path,
    machine: str = "",
    set: Mapping[str, str] | None = None,
    length: str | Sequence[float] = (),
    velocity: str | Sequence[float] = (),
    unit: str = "",
) -> LinePlan:
    """Predict how fast a line may run, and how short its pieces may be; runs of the blocks confirm each figure.

    Args:
        machines: a file with a machine's data, or a scenario of CutToLength or RotaryKnife or the name of one; without
            any, and for what `machine` asks for in addition, the block's own start values count.
        machine: `"saw"`, `"knife"`, or `"both"`, which says which of the two is the better one; by default the machines
            that are given, else a saw.
        set: parameters of the block, or `load.NAME`, in place of the file's values. With several machines those of an
            axis need the block's name: `{"RotaryKnife.axis.max_velocity": "3000"}`.
        length: of the pieces, in u: numbers, or a text: `"500,1000"`, or `"300..3000"` for round numbers in between;
            by default those of the file, else a selection.
        velocity: of the line, in u/s, likewise.
        unit: of positions; by default the file's, else mm.

    Raises:
        UserError: something that is given is not allowed; the text is what the command line prints.
    """
    data, own_lengths, own_velocities = read_machines([Path(m) for m in machines], machine, set or {}, unit)
    return make_plan(
        data,
        read_option("length", length) or own_lengths,
        read_option("velocity", velocity) or own_velocities,
    )
