"""RemoteSync's accuracy on random clocks: the table of its description, over many seeds of either sign.

The runs are those of benchmarks/accuracy.py, which prints what is reached.
"""

from collections.abc import Callable

import numpy as np
import pytest
from accuracy import COLUMNS, DRIFTS, JITTERS, Case, reached

SEEDS = {20: 12, 50: 24, 100: 50, 300: 60, 1000: 100, 2000: 300}
LONG = 100  # seeds of the smallest drifts in the long form: a run has a hundred times the cycles of one at 2000 ppm
UNIFORM, SLOPES, PHASE = COLUMNS


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
@pytest.mark.parametrize("ppm", DRIFTS)
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
    for column, result in zip(COLUMNS, reached(case, range(soak(SEEDS[ppm], max(SEEDS[ppm], LONG))), 2), strict=True):
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
    for column, result in zip(COLUMNS, reached(case, range(8), 2), strict=True):
        behind = np.array([0.0 if column is PHASE else 1.0 * (seed % 2) for seed in range(8)])
        allowed = column.peak(case.size, True)
        assert (np.array(result.lowest) + behind).min() >= -allowed
        assert (np.array(result.highest) + behind).max() <= allowed
