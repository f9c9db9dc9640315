"""A plan whose runs are short and need no block: what is known of them is a square."""

import os
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import pyarrow as pa


@dataclass(frozen=True)
class Tiny:
    """A plan.

    Attributes:
        pace: s that a run takes.
        trap: a folder; a worker that finds the file `trap` in it ends.
    """

    runs: int
    chunk: int = 0
    seed: int = 1
    pace: float = 0.0
    trap: str = ""

    @classmethod
    def read(cls, folder: Path) -> Self:
        message = tomllib.loads((folder / "plan.toml").read_text("utf-8"))
        return cls(message["runs"], message["chunk"], message["seed"])

    def write(self, folder: Path) -> None:
        (folder / "plan.toml").write_text(f"runs = {self.runs}\nchunk = {self.chunk}\nseed = {self.seed}\n", "utf-8")

    def differs(self, other: "Tiny") -> str:
        return "" if self.seed == other.seed else f"seed = {self.seed}, not {other.seed}"


def squares(plan: Tiny, first: int, last: int) -> pa.Table:
    """The rows of runs: number, number times seed, squared, and the process that computed it where it is asked for."""
    runs = range(first, last)
    time.sleep(plan.pace * len(runs))
    if plan.trap and (Path(plan.trap) / f"trap-{first}").exists():
        os._exit(1)
    return pa.table({"run": pa.array(runs, pa.int64()), "square": [(plan.seed * run) ** 2 for run in runs]})
