"""Example runs for the cells and points of a page, with all that is needed to repeat them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...pages.style import typeset
from ..database import Column, ColumnKind, Database
from .packing import numbers_packed, texts_packed

ALWAYS_SHOWN = ("passed", "refusal", "first_broken")  # of each run, if the rows have it


class ExampleRuns:
    """Runs by their numbers, each once."""

    def __init__(self) -> None:
        self.runs: NDArray[np.int64] = np.array([], np.int64)

    def add(self, *runs: NDArray[Any]) -> None:
        """Add numbers of runs; negative ones stand for no run."""
        given = np.concatenate([self.runs, *(r.astype(np.int64) for r in runs)])
        self.runs = np.unique(given[given >= 0])

    def indices_of(self, runs: NDArray[Any]) -> list[int]:
        """The indices of runs among all; -1: no run."""
        indices = np.searchsorted(self.runs, runs)
        return [int(index) if run >= 0 else -1 for index, run in zip(indices, runs, strict=True)]

    def packed(self, db: Database, shown: Sequence[Column]) -> dict[str, Any]:
        """The runs for the page's script: their numbers, and the columns by name: those that vary, the results of each
        run, and those that are `shown`."""
        columns = [c for c in db.columns.values() if c.varied or c in shown or c.name in ALWAYS_SHOWN]
        names = ", ".join(f"{column.sql} AS c{i}" for i, column in enumerate(columns))
        numbers = ", ".join(map(str, self.runs.tolist()))
        answer = db.ask(f"SELECT run, {names} FROM runs WHERE run IN ({numbers or -1}) ORDER BY run")
        return {
            "numbers": numbers_packed(self.runs.astype(float)),
            "columns": [
                {"name": c.name, "unit": typeset(c.unit), "varied": c.varied, "kind": c.kind.name.lower()}
                | {"values": texts_packed(values) if c.kind is not ColumnKind.NUMBER else numbers_packed(values)}
                for i, c in enumerate(columns)
                for values in [answer[f"c{i}"]]
            ],
        }
