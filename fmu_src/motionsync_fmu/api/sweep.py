"""What `motionsync sweep` does, with its rows as a table.

import numpy as np

from motionsync_fmu import sweep

if __name__ == "__main__":  # the processes that work read this file, too
    rows = sweep(
        "FlyingSaw/cyclic_cut",
        set={
            "length": np.linspace(1100.0, 1800.0, 71),
            "axis.max_jerk": "1e5..1e6",
            "axis.max_deceleration": "axis.max_acceleration",
        },
        samples=1000,
        measures={"slave.velocity": ("max", "max_time")},
        output="out",
    )
    rows.to_frame(["length", "passed"]).to_pandas()
"""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from ..errors import UserError
from ..fmus.fmu import ignore
from ..optional_dependencies import require
from ..scenario.files.shipped import find_scenario
from .scenario_source import literal
from .shown import Count, counted

if TYPE_CHECKING:
    from ..sweeps.sweep_plan import SamplingOptions
    from ..sweeps.table import Rows


def sweep(
    scenario: str | Path,
    *,
    set: Mapping[str, str | ArrayLike],
    output: str | Path,
    workers: int | None = None,
    scheduler: str = "",
    chunk: int = 0,
    progress: Count | None = None,
    notify: Callable[[str], None] | None = None,
    **options: Unpack[SamplingOptions],
) -> Rows:
    """Run a scenario with many values, on all cores or many computers.

    Args:
        scenario: its file or folder, or its short name: `FlyingSaw/cyclic_cut`.
        set: what varies, by the names of start values, inputs, and numbers of the script: a text as `--set` takes it,
            `"start:stop:count"`, `"first:last"`, `"low..high"`, `"a,b,c"` or, for what follows from others, an
            expression such as `"2*axis.max_velocity"`; or values: one, or an array of shape (values,).
        output: the folder for the rows and the plan. If rows of the same sweep are in it, the others are added.
        workers: how many processes of this computer work; by default one for each core.
        scheduler: the address of a Dask scheduler, whose workers do it instead.
        chunk: the runs of a part file; 0: those of some seconds.
        progress: called with the number of runs that are done, and of all; by default a notebook shows them.
        notify: called with a message to the user.
        options: `samples`, `method`, `seed`, `measures` and `yes`, as `sweep_plan.SamplingOptions` explains them.

    Returns:
        The rows, which are read when they are asked for. A run that fails has a row, too.

    Raises:
        UserError: what is asked for is refused, the folder has another sweep, or it cannot be written.
        Interrupted: the user broke it off; the rows that are finished are kept, and the same call goes on.
    """
    require("sweep", "distributed", "pyarrow", "scipy")
    from ..sweeps.execution import execute  # noqa: PLC0415 (part of an extra, like the next ones)
    from ..sweeps.rows import rows  # noqa: PLC0415
    from ..sweeps.sweep_plan import SweepPlan  # noqa: PLC0415
    from ..sweeps.table import Rows  # noqa: PLC0415

    plan = SweepPlan.of(find_scenario(Path(scenario)), settings(set), chunk=chunk, **options)
    how: Any = {"scheduler": scheduler, "workers": workers, "notify": notify or ignore}
    with counted(progress, f"sweeping {plan.variation.scenario.label}", "runs") as count:
        execute(plan, Path(output), rows, progress=count, **how)
    return Rows(Path(output))


def settings(factors: Mapping[str, str | ArrayLike]) -> list[str]:
    """What varies, as `--set` takes it.

    Raises:
        UserError: the values of a factor are no list of values.
    """
    return [f"{name}={_text(name, values)}" for name, values in factors.items()]


def _text(name: str, values: str | ArrayLike) -> str:
    """The values of a factor as `--set` takes them."""
    if isinstance(values, str):
        return values
    array = np.atleast_1d(np.asarray(values))
    if array.ndim > 1 or not array.size or array.dtype.kind not in "biufU":
        raise UserError(f"{name} is an array of shape {array.shape} of {array.dtype}: it must be a list of values")
    return ",".join(map(literal, array.tolist()))
