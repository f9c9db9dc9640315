"""A CutToLength whose line is measured: no piece is lost, on a running line and on one that halts for a while."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

from motionsync.cut_to_length.interface import State, ToolMode
from motionsync_fmu.batch.simulation import simulate_many
from tests.measured.lines import (
    MEASURED,
    POSITION_SIGMA,
    SEEDS,
    STEP,
    Reals,
    changes,
    counted,
    halting,
    noisy,
    times,
)

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


SPEEDS = [  # of lines, mm/s, with the share by which the jerk may be above its limit on them
    (np.concatenate([np.linspace(150.0, 1250.0, 45), [150.5, 199.5, 200.5, 300.5, 401.0]]), 1.05),
    (np.concatenate([np.linspace(80.0, 150.0, 20), np.linspace(98.0, 103.0, 30)]), 1.2),
    (np.geomspace(2.0, 80.0, 50), 5.0),
]


@pytest.mark.parametrize(("sigma", "resolution"), [(0.05, 0.0), (0.0, 0.1)])
@pytest.mark.parametrize(("velocity", "most"), SPEEDS, ids=["150 mm/s and more", "80 mm/s and more", "creeping"])
@pytest.mark.parametrize("length", [100.0, 300.0, 800.0, 3000.0])
def test_only_the_jerk_may_exceed_its_limit(
    length: float, velocity: Reals, most: float, sigma: float, resolution: float
) -> None:
    """What the page says of lines at all velocities; those that make a whole number of counts a step are among them.
    The limits of the start values: 2000 mm/s, 10 000 mm/s2, 100 000 mm/s3."""
    limit = simulate_many("CutToLength", STEP, {}, "limits.max_line_velocity", start={"length": length}).values[0, 0, 0]
    velocity = velocity[velocity < 0.97 * limit]
    line = velocity[:, None] * times(30.0) + np.random.default_rng(3).uniform(0.0, 1.0, (velocity.size, 1))
    slave = {f"slave.{name}": ("min", "max") for name in ("velocity", "acceleration", "jerk")}
    result = simulate_many(
        "CutToLength",
        STEP,
        {"master.position": counted(line, resolution) if resolution else noisy(line, sigma, velocity.size)},
        reduce={**dict.fromkeys(["statistics.skipped", "statistics.late"], "last"), "error_id": "max", **slave},
        start={**MEASURED, "master.velocity": velocity, "length": length, "auto_start": True},
    )
    assert not result.failures
    for name in ("statistics.skipped.last", "statistics.late.last", "error_id.max"):
        assert not result.measures[name].any(), name
    allowed = {"velocity": 2000.0 * (1.0 + 1e-9), "acceleration": 1e4 * (1.0 + 1e-9), "jerk": 1e5 * most}
    for name, greatest in allowed.items():
        reached = np.maximum(result.measures[f"slave.{name}.max"], -result.measures[f"slave.{name}.min"])
        assert reached.max() <= greatest, name


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


FAST, GENTLE = (500.0, 2000.0, 13.0), (200.0, 40.0, 25.0)  # velocity, deceleration, duration, with a halt of 5 s
EARLY = {"tool.on_delay": 1.0}  # the tool is commanded before the approach starts, or with it
LONG = {"approach.distance": 50.0}


@pytest.mark.parametrize(
    ("run", "rests", "settings"),
    [
        (FAST, (1800.0, 2600.0), {}),
        (FAST, (1800.0, 2600.0), {"tool.on_delay": 0.05, "tool.retract_time": 0.1, "homing.ease": True}),
        (FAST, (1800.0, 2600.0), {"tool.mode": ToolMode.DISTANCE, "gap.distance": 5.0}),
        (GENTLE, (2399.85, 2400.05), EARLY),
        (GENTLE, (2349.9, 2350.1), {**LONG, **EARLY}),
    ],
    ids=["any stage", "any stage, with delays", "any stage, with a gap", "short approach", "long approach"],
)
def test_a_noisy_line_that_halts_in_any_stage_is_cut_as_if_it_ran(
    run: tuple[float, float, float], rests: tuple[float, float], settings: dict[str, Any]
) -> None:
    """It halts for 5 s around the third cut, or in 100 places where an approach to it starts: all cuts are made, and
    the tool's command changes once each way a cut."""
    velocity, acceleration, duration = run
    line = halting(np.linspace(*rests, SEEDS)[:, None], velocity, acceleration, 5.0, times(duration))
    result = simulate_many(
        "CutToLength",
        STEP,
        {"master.position": noisy(line, 0.05)},
        ["tool.command", "state", "statistics.cuts", "statistics.skipped", "statistics.late", "error_id"],
        start={**MEASURED, "master.velocity": velocity, "length": 800.0, "auto_start": True, **settings},
    )
    cuts = line[0, -1] // 800.0
    assert not result.failures
    assert (result["statistics.cuts"][:, -1] == cuts).all()
    assert (changes(result["tool.command"]) == 2 * cuts).all()
    assert changes(result["state"]).max() <= 7 * cuts + 1
    for name in ("statistics.skipped", "statistics.late", "error_id"):
        assert not result[name].any(), name


@pytest.mark.parametrize(("sigma", "eased"), [(0.02, 0.95), (0.05, 0.9)])
def test_noise_does_not_hurry_an_eased_way_home(sigma: float, eased: float) -> None:
    """The carriage comes home with ease in nearly all cycles, and no cut is late."""
    result = simulate_many(
        "CutToLength",
        STEP,
        {"master.position": noisy(1000.0 * times(15.0), sigma)},
        ["local.ease", "state", "statistics.late", "statistics.skipped"],
        start={**MEASURED, "master.velocity": 1000.0, "length": 3000.0, "auto_start": True, "homing.ease": True},
    )
    returns = result["state"] == State.RETURNING
    arrives = returns[:, :-1] & ~returns[:, 1:]
    share = result["local.ease"][:, :-1][arrives]
    assert share.size == 4 * SEEDS
    assert np.count_nonzero(share < 0.3) >= eased * share.size
    assert not result["statistics.late"].any()
    assert not result["statistics.skipped"].any()
