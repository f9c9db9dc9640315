"""A RotaryKnife whose line is measured: no cut is lost, and no limit of the axis is exceeded."""

import numpy as np
import pytest

from motionsync_fmu import simulate_many
from tests.measured.lines import MEASURED, SEEDS, STEP, counted, noisy, times

LENGTHS = np.tile([300.0, 400.0, 600.0, 900.0, 1500.0], SEEDS // 5)
LIMITS = np.tile([1085.767, 1760.765, 4326.748, 3800.184, 4326.748], SEEDS // 5)  # mm/s; 600 out of rest
SHARES = np.where(np.arange(SEEDS) % 3 == 0, 0.5, 0.97)  # of the greatest line velocity
DURATION = 20.0  # s
WINDOW = {"sync.before": 30.0, "sync.after": 30.0}
FIRST = np.where(LENGTHS < 570.0, 2.0, 1.0)  # the first place that a ramp of 540 and half a window reach from rest


@pytest.mark.parametrize(("sigma", "resolution"), [(0.02, 0.0), (0.0, 0.1)])
def test_no_cut_of_a_measured_line_is_lost(sigma: float, resolution: float) -> None:
    """100 lines, most of them at 97 % of what the knife can do; each ends in the middle of a piece."""
    pieces = np.floor(SHARES * LIMITS * DURATION / LENGTHS)
    velocity = (pieces + 0.5) * LENGTHS / DURATION
    velocity = np.where(velocity > SHARES * LIMITS, velocity - LENGTHS / DURATION, velocity)
    line = velocity[:, None] * times(DURATION)
    result = simulate_many(
        "RotaryKnife",
        STEP,
        {"master.position": counted(line, resolution) if resolution else noisy(line, sigma)},
        reduce={
            **dict.fromkeys(["statistics.cuts", "statistics.skipped", "statistics.late"], "last"),
            **dict.fromkeys(["warning.limit_exceeded", "error_id"], "max"),
            "slave.velocity": "min",
        },
        start={**MEASURED, **WINDOW, "master.velocity": velocity, "length": LENGTHS, "auto_start": True},
    )
    assert not result.failures
    cuts = np.floor(velocity * DURATION / LENGTHS) - (FIRST - 1.0)
    np.testing.assert_array_equal(result.measures["statistics.cuts.last"], cuts)
    np.testing.assert_array_equal(result.measures["statistics.skipped.last"], FIRST - 1.0)
    for name in ("statistics.late.last", "warning.limit_exceeded.max", "error_id.max"):
        assert not result.measures[name].any(), name
    assert result.measures["slave.velocity.min"].min() >= 0.0
