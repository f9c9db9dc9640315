"""A CutToLength whose line is measured: no piece is lost, on a running line and on one that halts for a while."""

from math import sqrt

import numpy as np
import pytest

from motionsync_fmu.batch.simulation import simulate_many
from tests.measured.lines import MEASURED, POSITION_SIGMA, SEEDS, STEP, Reals, counted, noisy, times

LENGTHS = np.tile([300.0, 500.0, 800.0, 1500.0, 3000.0], SEEDS // 5)
SHARES = np.where(np.arange(SEEDS) % 3 == 0, 0.5, 0.97)  # of the greatest line velocity
CUT_TIME = 0.25  # s


def line_velocities() -> Reals:
    limits = simulate_many(
        "CutToLength", STEP, {}, "limits.max_line_velocity", start={"length": LENGTHS}, instances=SEEDS
    )
    return SHARES * limits["limits.max_line_velocity"][:, 0]


def cut_ends(velocity: Reals) -> Reals:
    """The line's travel from where a piece ends at carriage position 0 to the end of its cut: the approach of the start
    values, with its reserve of 2 %, and the cut."""
    fast = 1.02 * velocity
    return np.maximum(0.75 * fast**2 / 1e4, np.sqrt(1.5 * fast**3 / 1e5)) + velocity * CUT_TIME


@pytest.mark.parametrize(("sigma", "resolution", "duration"), [(0.02, 0.0, 60.0), (0.0, 0.1, 60.0), (0.05, 0.0, 20.0)])
def test_no_piece_of_a_measured_line_is_skipped_or_late(sigma: float, resolution: float, duration: float) -> None:
    """Nor is a limit exceeded: 100 lines, most of them at 97 % of what the machine can do."""
    velocity = line_velocities()
    first = np.random.default_rng(3).uniform(0.0, 1.0, (SEEDS, 1))  # where it is between two counts
    line = velocity[:, None] * times(duration) + first
    result = simulate_many(
        "CutToLength",
        STEP,
        {"master.position": counted(line, resolution) if resolution else noisy(line, sigma)},
        reduce={
            **dict.fromkeys(["statistics.cuts", "statistics.skipped", "statistics.late"], "last"),
            **dict.fromkeys(["warning.limit_exceeded", "error_id"], "max"),
        },
        start={**MEASURED, "master.velocity": velocity, "length": LENGTHS, "auto_start": True},
    )
    cuts = np.floor((velocity * duration - cut_ends(velocity)) / LENGTHS)
    assert not result.failures
    np.testing.assert_array_equal(result.measures["statistics.cuts.last"], cuts)
    for name in ("statistics.skipped.last", "statistics.late.last", "warning.limit_exceeded.max", "error_id.max"):
        assert not result.measures[name].any(), name


def test_true_lengths_vary_by_at_most_twice_the_sigma_of_the_path() -> None:
    """Where the blade touches, as where the cut's mean is: no more than 0.6 of the noise."""
    sigma, velocity, length = 0.02, 500.0, 800.0
    line = velocity * times(12.0)
    true = line + velocity * STEP  # at the end of each step
    result = simulate_many(
        "CutToLength",
        STEP,
        {"master.position": noisy(line, sigma)},
        ["slave.position", "tool.cutting"],
        start={**MEASURED, "master.velocity": velocity, "length": length, "auto_start": True},
    )
    touches, means = [], []
    for position, cutting in zip(result["slave.position"], result["tool.cutting"] > 0.0, strict=True):
        places = (true - position)[cutting]
        ends = np.flatnonzero(np.diff(np.flatnonzero(cutting)) > 1) + 1
        cuts = np.split(places, ends)[:-1]  # the last one may be under way
        touches.append(np.diff([cut[0] for cut in cuts]))
        means.append(np.diff([cut.mean() for cut in cuts]))
    at_touch, at_mean = np.array(touches), np.array(means)
    assert at_touch.shape == (SEEDS, 5)
    assert at_touch.std() == pytest.approx(sqrt(2.0) * POSITION_SIGMA * sigma, rel=0.1)
    assert at_mean.std() < at_touch.std() < 2.0 * POSITION_SIGMA * sigma < 0.6 * sigma
    assert abs(at_mean - length).max() < 4.0 * sigma
