"""How close RemoteSync's corrected cycle index comes to the sender's true one: both estimators on random clocks.

    python benchmarks/accuracy.py [--seeds 60] [--drifts 20 100 2000] [--jobs 2]

Each seed is two clocks with a start phase of their own; every second one has a slower sender. The result of a run is
the peak to peak value of the corrected index minus the true one, in cycles, from 91 cycles after the identification of
the second beat on, and how far the index's steps from cycle to cycle differ from 1 + drift there. A constant offset of
whole cycles does not count: BEAT follows a slower sender one cycle behind. `COLUMNS` has the allowed values, which
tests/model/remote_sync/test_accuracy.py applies as well.
"""

import argparse
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from motionsync.remote_sync.interface import INDICES, Estimator
from motionsync_fmu.batch.simulation import simulate_many
from motionsync_fmu.scenario.clocks import Clocks, Rate

Reals = NDArray[np.float64]
Limit = Callable[[float, bool], float]  # by the drift's size (not in ppm), and whether there is jitter

TASK_CYCLE = 0.002  # s
DRIFTS = (20, 50, 100, 300, 1000, 2000)  # ppm
JITTERS = (0.0, 0.01)  # of a cycle, one standard deviation on both sides
FIRST_INDEX = 100
WAITING = 90  # end_of_transition_limit and new_drift_blending_cycles
SETTLED = WAITING + 1  # cycles after the identification
BEATS_AFTER = 3.0  # the number of beats for which a run goes on after that
GROUP = 12  # runs at a time: their inputs and results take 100 MB


@dataclass(frozen=True)
class Column:
    """A setting of the block, and the limits of its errors: `peak` to peak, and the greatest deviation of a `step`."""

    name: str
    start: dict[str, Any]
    peak: Limit
    step: Limit


COLUMNS = (
    Column(
        "BEAT, uniform",
        {"estimator": Estimator.BEAT, "slope1_numerator": 0.5, "slope1_denominator": 0.5},
        lambda d, jitter: (WAITING + 3) * d + (0.12 if jitter else 0.0),
        lambda d, jitter: 2.1 * d + (0.0012 if jitter else 0.0),
    ),
    Column(
        "BEAT, default slopes",
        {"estimator": Estimator.BEAT},
        lambda d, jitter: 0.45 + (WAITING + 3) * d + (0.12 if jitter else 0.0),
        lambda d, jitter: 5.0 * d + (0.002 if jitter else 0.0),
    ),
    Column(
        "PHASE",
        {"estimator": Estimator.PHASE},
        lambda d, jitter: 0.03 if jitter else 0.05,
        lambda d, jitter: 0.002,
    ),
)


@dataclass(frozen=True)
class Case:
    """Clocks that differ by so many ppm, with this jitter; a seed's parity is the drift's sign."""

    ppm: float
    jitter: float

    @property
    def size(self) -> float:
        return self.ppm * 1e-6

    @property
    def cycles(self) -> int:
        """The number of cycles of a run: two beats until the first two are identified, then those that are measured."""
        return int((2.0 + BEATS_AFTER) / self.size) + 4 * WAITING

    def drift(self, seed: int) -> float:
        return -self.size if seed % 2 else self.size

    def clocks(self, seed: int) -> Clocks:
        rate = Rate(0.0, TASK_CYCLE / (1.0 + self.drift(seed)))
        phase = float(np.random.default_rng((seed, 2)).random())
        return Clocks(TASK_CYCLE, [rate], phase, self.jitter, seed, first_index=FIRST_INDEX)


@dataclass
class Reached:
    """The results of the runs of one case, an entry a run, in cycles: bounds of the error, greatest step deviation."""

    lowest: list[float] = field(default_factory=list)
    highest: list[float] = field(default_factory=list)
    steps: list[float] = field(default_factory=list)

    @property
    def peaks(self) -> Reals:
        return np.asarray(np.array(self.highest) - np.array(self.lowest), np.float64)


def reached(case: Case, seeds: Sequence[int], threads: int) -> list[Reached]:
    """The results of each column, on the same clocks."""
    reached_by_column = [Reached() for _ in COLUMNS]
    times = np.arange(float(case.cycles)) * TASK_CYCLE
    for group in (seeds[i : i + GROUP] for i in range(0, len(seeds), GROUP)):
        clocks = [case.clocks(seed) for seed in group]
        index = np.array([c.received_indices(case.cycles) for c in clocks]) % INDICES
        true = [c.true_index(times) for c in clocks]
        for column, achieved in zip(COLUMNS, reached_by_column, strict=True):
            names = ["corrected_cycle_index", "beats"]
            run = simulate_many(
                "RemoteSync", TASK_CYCLE, {"remote.cycle_index": index}, names, start=column.start, threads=threads
            )
            for row, seed in enumerate(group):
                error = run["corrected_cycle_index"][row] - true[row]
                begin = int(np.argmax(run["beats"][row] >= 2)) + SETTLED
                assert begin > SETTLED, f"{column.name} has not identified two beats at {case} with seed {seed}"
                achieved.lowest.append(float(error[begin:].min()))
                achieved.highest.append(float(error[begin:].max()))
                achieved.steps.append(float(np.abs(np.diff(error[begin:])).max()))
    return reached_by_column


def rows(cases: Sequence[Case], seeds: Sequence[int], threads: int) -> Iterator[tuple[str, ...]]:
    """The rows of the table: worst and median value beside the allowed one."""
    for case in cases:
        for column, achieved in zip(COLUMNS, reached(case, seeds, threads), strict=True):
            peak, step = (limit(case.size, case.jitter > 0.0) for limit in (column.peak, column.step))
            yield (
                f"{case.ppm:g}",
                f"{case.jitter:.0%}",
                column.name,
                *(f"{x:.4f}" for x in (achieved.peaks.max(), np.median(achieved.peaks), peak)),
                f"{np.mean(achieved.peaks <= peak):.0%}",
                *(f"{1e6 * x:.0f}" for x in (max(achieved.steps), np.median(achieved.steps), step)),
                f"{np.mean(np.array(achieved.steps) <= step):.0%}",
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=60, help="runs of each case")
    parser.add_argument("--drifts", type=float, nargs="+", default=DRIFTS, help="ppm")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="threads")
    options = parser.parse_args()
    table = Table(title=f"Corrected against true index, {options.seeds} runs each", box=None)
    for name in ("drift, ppm", "jitter", "setting"):
        table.add_column(name, justify="left" if name == "setting" else "right")
    for name in (
        "peak to peak, worst",
        "median",
        "allowed",
        "within",
        "step, worst, 1e-6",
        "median",
        "allowed",
        "within",
    ):
        table.add_column(name, justify="right")
    cases = [Case(ppm, jitter) for jitter in JITTERS for ppm in options.drifts]
    for row in rows(cases, range(options.seeds), options.jobs):
        table.add_row(*row)
    Console(highlight=False, width=150).print(table)


if __name__ == "__main__":
    main()
