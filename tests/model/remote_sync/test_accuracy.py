"""RemoteSync's accuracy on random clocks: the table of its description, over many seeds of either sign.

Each seed is two clocks with a start phase of their own; every second one has a slower sender. The result of a run is
the peak to peak value of the corrected index minus the true one, in cycles, from 91 cycles after the identification of
the second beat on, and how far the index's steps from cycle to cycle differ from 1 + drift there. A constant offset of
whole cycles does not count: BEAT follows a slower sender one cycle behind.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from motionsync.remote_sync.interface import INDICES, Estimator
from motionsync_fmu.batch.simulation import simulate_many
from motionsync_fmu.scenario.clocks import Clocks, Rate

Reals = NDArray[np.float64]
Limit = Callable[[float, bool], float]  # by the drift's size (not in ppm), and whether there is jitter

TASK_CYCLE = 0.002  # s
SEEDS = {20: 12, 50: 24, 100: 50, 300: 60, 1000: 100, 2000: 300}  # of each drift, in ppm
LONG = 100  # seeds of the smallest drifts in the long form: a run has a hundred times the cycles of one at 2000 ppm
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


def reached(case: Case, seeds: Sequence[int]) -> list[Reached]:
    """The results of each column, on the same clocks."""
    reached_by_column = [Reached() for _ in COLUMNS]
    times = np.arange(float(case.cycles)) * TASK_CYCLE
    for group in (seeds[i : i + GROUP] for i in range(0, len(seeds), GROUP)):
        clocks = [case.clocks(seed) for seed in group]
        index = np.array([c.received_indices(case.cycles) for c in clocks]) % INDICES
        true = [c.true_index(times) for c in clocks]
        for column, achieved in zip(COLUMNS, reached_by_column, strict=True):
            names = ["corrected_cycle_index", "beats"]
            run = simulate_many("RemoteSync", TASK_CYCLE, {"remote.cycle_index": index}, names, start=column.start)
            for row, seed in enumerate(group):
                error = run["corrected_cycle_index"][row] - true[row]
                begin = int(np.argmax(run["beats"][row] >= 2)) + SETTLED
                assert begin > SETTLED, f"{column.name} has not identified two beats at {case} with seed {seed}"
                achieved.lowest.append(float(error[begin:].min()))
                achieved.highest.append(float(error[begin:].max()))
                achieved.steps.append(float(np.abs(np.diff(error[begin:])).max()))
    return reached_by_column


PHASE = COLUMNS[-1]


@pytest.mark.parametrize(
    ("ppm", "jitter", "peaks", "steps"),
    [
        (20, 0.0, (0.00186, 0.45186, 0.05), (42e-6, 100e-6, 0.002)),
        (300, 0.0, (0.0279, 0.4779, 0.05), (630e-6, 0.0015, 0.002)),
        (2000, 0.0, (0.186, 0.636, 0.05), (0.0042, 0.01, 0.002)),
        (100, 0.01, (0.1293, 0.5793, 0.03), (0.00141, 0.0025, 0.002)),
        (1000, 0.01, (0.213, 0.663, 0.03), (0.0033, 0.007, 0.002)),
    ],
)
def test_the_bounds_are_those_of_the_description(
    ppm: float, jitter: float, peaks: tuple[float, ...], steps: tuple[float, ...]
) -> None:
    """(90 + 3) d, 0.45 more with the default slopes, 0.12 more with jitter; 2.1 d and 5 d."""
    assert [column.peak(1e-6 * ppm, jitter > 0.0) for column in COLUMNS] == pytest.approx(peaks)
    assert [column.step(1e-6 * ppm, jitter > 0.0) for column in COLUMNS] == pytest.approx(steps)


@pytest.mark.slow
@pytest.mark.parametrize("jitter", JITTERS)
@pytest.mark.parametrize("ppm", SEEDS)
def test_the_corrected_index_is_as_accurate_as_described(
    ppm: int, jitter: float, soak: Callable[[int, int], int]
) -> None:
    """In every run; with one exception, PHASE at 2000 ppm with jitter.

    There the estimate rests on two dates until the third beat is identified, up to 590 cycles beyond the second one.
    Whatever the estimator, so few cycles with so much jitter give a date to no better than 0.004 cycles of phase (the
    bound of Cramer and Rao; to count them reaches it), and at the far end of the line through both dates that has grown
    to 0.01. 0.03 is not beyond the reach of such errors: some runs in a hundred may exceed it, none 0.045.
    """
    case = Case(ppm, jitter)
    for column, result in zip(COLUMNS, reached(case, range(soak(SEEDS[ppm], max(SEEDS[ppm], LONG)))), strict=True):
        peaks, steps = result.peaks, np.array(result.steps)
        allowed = column.peak(case.size, jitter > 0.0)
        if column is PHASE and ppm == 2000 and jitter:
            assert np.mean(peaks <= allowed) >= 0.95
            allowed = 0.045
        assert peaks.max() <= allowed, f"{column.name}, seed {peaks.argmax()}"
        assert steps.max() <= column.step(case.size, jitter > 0.0), f"{column.name}, seed {steps.argmax()}"


@pytest.mark.parametrize("ppm", [100, 1000])
def test_phase_is_at_the_true_index_and_beat_one_cycle_behind_a_slower_sender(ppm: int) -> None:
    """Odd seeds are slower senders."""
    case = Case(ppm, 0.01)
    for column, result in zip(COLUMNS, reached(case, range(8)), strict=True):
        behind = np.array([0.0 if column is PHASE else 1.0 * (seed % 2) for seed in range(8)])
        allowed = column.peak(case.size, True)
        assert (np.array(result.lowest) + behind).min() >= -allowed
        assert (np.array(result.highest) + behind).max() <= allowed
