"""Searches: at each point of a sweep's grid, the value of one name at which a condition on the row starts to hold.

from motionsync_fmu import search

if __name__ == "__main__":  # the processes that work read this file, too
    velocities = {"master.velocity": [500.0, 1000.0]}
    boundaries = search("CutToLength/any_length", vary="length=50..6000", until="passed", set=velocities)
    print(boundaries.select(["master.velocity", "length"]).to_pylist())

That is the shortest length that works; with another name it may be the greatest line velocity. The runs show which
end of the range works.
"""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Unpack

from numpy.typing import ArrayLike

from ..errors import Interrupted
from ..fmus.fmu import ignore
from ..optional_dependencies import require
from ..scenario.files.shipped import find_scenario
from .shown import Count, counted
from .sweep import settings

if TYPE_CHECKING:
    import pyarrow as pa

    from ..sweeps.boundaries import Search
    from ..sweeps.sweep_plan import SamplingOptions

TOGETHER = 100  # points, which this process looks at together


def search(
    scenario: str | Path,
    *,
    vary: str,
    until: str,
    set: Mapping[str, str | ArrayLike] | None = None,
    relative: float = 1e-6,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str = "",
    progress: Count | None = None,
    notify: Callable[[str], None] | None = None,
    **options: Unpack[SamplingOptions],
) -> pa.Table:
    """The boundaries at all points of the grid that the factors make.

    Args:
        scenario: its file or folder, or its short name.
        vary: what is varied, and between which values: `"length=300..3000"`.
        until: the condition on a row: columns compared with values, `"late == 0 and cut_error < 0.01"`.
        set: the grid, as of a sweep; none: there is one point.
        relative: how far apart the two values beside a boundary may be, as a share of their magnitude.
        output: a folder that keeps the rows as parts, so that the same call goes on; None: nothing is kept.
        workers: how many processes of this computer search, as of a sweep.
        scheduler: the address of a Dask scheduler, as of a sweep.
        progress: called with the number of points that are done, and of all; by default a notebook shows them.
        notify: called with a message to the user.
        options: as of a sweep. The measures are those of the run at the boundary; what the condition names is measured
            anyway.

    Returns:
        A row for each point, with the columns of a sweep. A point without a boundary has a row, too.

    Raises:
        UserError: what is asked for is refused, the folder has another search, or it cannot be written.
        Interrupted: the user broke it off; what is finished is kept if there is a folder.
    """
    require("sweep", "distributed", "pyarrow", "scipy")
    import pyarrow as pa  # noqa: PLC0415 (part of an extra, like the next ones)

    from ..sweeps.boundaries import Search, boundaries  # noqa: PLC0415
    from ..sweeps.execution import execute  # noqa: PLC0415

    file, grid = find_scenario(Path(scenario)), settings(set or {})
    request = Search.of(file, vary, until, grid, relative=relative, **options)
    how: Any = {"scheduler": scheduler, "workers": workers, "notify": notify or ignore}
    with counted(progress, f"searching {vary.partition('=')[0]}", "points") as count:
        if output is not None:
            execute(request, Path(output), boundaries, progress=count, **how)
            return _read_rows(Path(output))
        try:
            if not scheduler and (workers == 1 or (workers is None and request.runs <= TOGETHER)):
                return pa.concat_tables(_searched_in_this_process(request, count))
            with TemporaryDirectory() as aside:
                execute(request, Path(aside), boundaries, progress=count, **how)
                return _read_rows(Path(aside))
        except (KeyboardInterrupt, Interrupted):
            raise Interrupted("interrupted: nothing is kept without a folder for the rows (--output)") from None


def _read_rows(folder: Path) -> pa.Table:
    """The rows in the parts of a folder, in the order of the points."""
    import pyarrow.dataset as ds  # noqa: PLC0415

    files = [str(file) for file in folder.glob("part-*.parquet")]
    return ds.dataset(files).to_table().sort_by("point").replace_schema_metadata()


def _searched_in_this_process(request: Search, progress: Count) -> Iterator[pa.Table]:
    """The rows of all points, some at a time."""
    from ..sweeps.boundaries import boundaries  # noqa: PLC0415

    for first in range(0, request.runs, TOGETHER):
        last = min(first + TOGETHER, request.runs)
        yield boundaries(request, first, last)
        progress(last, request.runs)
