"""Searches: at each point of a sweep's grid, the value of one name at which a condition on the row begins to hold.

from motionsync_fmu.sweep.search import search

if __name__ == "__main__":  # the processes that work read this file, too
    found = search("CutToLength/any_length", "length=50..6000", "passed", {"master.velocity": [500.0, 1000.0]})
    print(found.select(["master.velocity", "length"]).to_pylist())

That is the shortest length that works; with another name it may be the greatest line velocity. Which end of the range
it is that works, the runs tell.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from ..errors import Interrupted, choose
from ..extras import need
from ..scenario.reader import load
from ..scenario.shipped import find_one
from .sweep import settings

if TYPE_CHECKING:
    import pyarrow as pa

    from .boundaries import Search

TOGETHER = 100  # points, which this process looks at together


def search(
    scenario: str | Path,
    vary: str,
    until: str,
    factors: Mapping[str, str | ArrayLike] | None = None,
    *,
    derived: Mapping[str, str] | None = None,
    relative: float = 1e-6,
    samples: int | None = None,
    method: str = "lhs",
    seed: int = 0,
    measures: Mapping[str, str | Sequence[str]] | None = None,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str = "",
    yes: bool = False,
    progress: Callable[[int, int], None] = lambda done, points: None,
    tell: Callable[[str], None] = lambda line: None,
) -> "pa.Table":
    """The boundaries at all points of the grid that the factors make.

    Args:
        scenario: its file or folder, or its short name.
        vary: what is varied, and between which values: `"length=300..3000"`.
        until: the condition on a row: columns compared with values, `"late == 0 and cut_error < 0.01"`.
        factors, derived, samples, method, seed: the grid, as of a sweep; none: there is one point.
        relative: how far apart the two values beside a boundary may be, as a share of their magnitude.
        measures: figures of outputs in the run at the boundary. Those that the condition names are taken anyway.
        output: a folder that keeps the rows as parts, so that the same call goes on; None: nothing is kept.
        workers, scheduler: who searches, as of a sweep.
        yes: begin even if there are more than 10^9 runs at each end of the range.
        progress: called with the number of points that are done, and of all.
        tell: called with a line about what the user may want to know meanwhile.

    Returns:
        A row for each point, with the columns that docs/sweeps.md tells. A point without a boundary has a row, too.

    Raises:
        UserError: what is asked for is refused, the folder has another search, or it cannot be written.
        Interrupted: the user broke it off; what is finished is kept if there is a folder.
    """
    need("sweep", "distributed", "pyarrow", "scipy")
    from .boundaries import Search  # noqa: PLC0415 (part of an extra, like the next ones)
    from .measures import checked  # noqa: PLC0415
    from .samples import Method  # noqa: PLC0415

    file = find_one(Path(scenario))
    wanted = Search.of(
        file,
        vary,
        until,
        settings(factors or {}, derived or {}),
        relative=relative,
        samples=samples,
        method=choose({str(m): m for m in Method}, method, "method"),
        seed=seed,
        measures=checked(measures, load(file).recipe) if measures else {},
        yes=yes,
    )
    return found(wanted, output=output, workers=workers, scheduler=scheduler, progress=progress, tell=tell)


def found(
    wanted: "Search",
    *,
    output: str | Path | None,
    workers: int | None,
    scheduler: str,
    progress: Callable[[int, int], None],
    tell: Callable[[str], None],
) -> "pa.Table":
    """What `search` gives, for a search that is made already."""
    import pyarrow as pa  # noqa: PLC0415

    from .boundaries import boundaries  # noqa: PLC0415
    from .spread import go  # noqa: PLC0415

    options: Any = {"scheduler": scheduler, "workers": workers, "progress": progress, "tell": tell}
    if output is not None:
        go(wanted, Path(output), boundaries, **options)
        return _read(Path(output))
    try:
        if not scheduler and (workers == 1 or (workers is None and wanted.runs <= TOGETHER)):
            return pa.concat_tables(_here(wanted, progress))
        with TemporaryDirectory() as aside:
            go(wanted, Path(aside), boundaries, **options)
            return _read(Path(aside))
    except (KeyboardInterrupt, Interrupted):
        raise Interrupted("interrupted: nothing is kept without a folder for the rows (--output)") from None


def _read(folder: Path) -> "pa.Table":
    """The rows in the parts of a folder, in the order of the points."""
    import pyarrow.dataset as ds  # noqa: PLC0415

    files = [str(file) for file in folder.glob("part-*.parquet")]
    return ds.dataset(files).to_table().sort_by("point").replace_schema_metadata()


def _here(wanted: "Search", progress: Callable[[int, int], None]) -> "Iterator[pa.Table]":
    """The rows of all points, some at a time."""
    from .boundaries import boundaries  # noqa: PLC0415

    for first in range(0, wanted.runs, TOGETHER):
        last = min(first + TOGETHER, wanted.runs)
        yield boundaries(wanted, first, last)
        progress(last, wanted.runs)
