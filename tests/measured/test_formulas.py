"""The formulas of docs/how_to/measured_line.md, over the ranges for which the page claims them.

The filter is linear: what noise leaves is the root of the sum of squares of its answer to a single measurement of 1."""

import re
from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.batch.simulation import simulate_many
from tests import ROOT
from tests.measured.lines import MEASURED, Reals, noisy
from tests.support.blocks.drawn import drawn

PAGE = (ROOT / "docs" / "how_to" / "measured_line.md").read_text("utf-8")
PATH = [f"master.smoothed_{name}" for name in ("position", "velocity", "acceleration")]
SMOOTHING_TIMES = (0.005, 0.02, 0.08)  # s


def path(line: Reals, h: float, tau: float, velocity: Reals | float, delay: Reals | float = 0.0) -> Reals:
    """Position, velocity and acceleration of the smoothed line at the end of each step, of shape (runs, steps, 3);
    `line`: what is measured at the starts, of shape (runs, steps); `velocity`: of the line at the start."""
    start = {**MEASURED, "master.velocity": velocity, "master.smoothing_time": tau, "master.delay": delay}
    result = simulate_many("Gearing", h, {"master.position": line}, PATH, start=start)
    assert not result.failures
    return result.values


def row(head: str) -> tuple[str, list[float]]:
    """The formula and the figures in a row of the page's tables; sigma is written s."""
    page = PAGE.replace("\N{GREEK SMALL LETTER SIGMA}", "s")
    (cells,) = re.findall(rf"^\| {re.escape(head)} \| (.*) \|$", page, re.M)
    formula, *figures = cells.split(" | ")
    return formula, [float(figure.split()[0]) for figure in figures]


def noise_left(h: float, tau: float, delay: float = 0.0) -> Reals:
    """What is left of noise of 1 in position, velocity and acceleration."""
    line = np.zeros((1, round(40.0 * tau / h) + 100))
    line[0, 20] = 1.0
    return np.asarray(np.sqrt((path(line, h, tau, 0.0, delay)[0] ** 2).sum(axis=0)))


@pytest.mark.parametrize("share", [0.0125, 0.05, 0.1, 0.2, 0.3])
@pytest.mark.parametrize("tau", SMOOTHING_TIMES)
def test_what_is_left_of_noise(tau: float, share: float) -> None:
    h = share * tau
    formulas = np.array([1.19, 1.43 / tau, 3.71 / tau**2]) * sqrt(h / tau)
    np.testing.assert_allclose(noise_left(h, tau), formulas, rtol=0.06)


def test_the_table_of_noise_has_the_figures_of_its_formulas() -> None:
    rows = [row(f"noise of the {name}") for name in ("position", "velocity", "acceleration")]
    assert [formula for formula, _ in rows] == ["1.19 s √(h/τ)", "1.43 s √(h/τ) / τ", "3.71 s √(h/τ) / τ²"]
    for i, tau in enumerate((0.01, 0.02, 0.04)):
        figures = [figures[i] for _, figures in rows]
        np.testing.assert_allclose(figures, 0.02 * noise_left(0.001, tau), rtol=0.03)
    assert f"the position's is {0.02 * noise_left(0.001, 0.02, 0.004)[0]:.4f} mm" in " ".join(PAGE.split())


def ramp_errors(tau: float, h: float, delays: Reals, acceleration: float, at: float) -> Reals:
    """The error of the path from the change of the acceleration on, for each delay, of shape (delays, steps)."""
    t = np.arange(round((0.3 + 25.0 * tau + delays.max()) / h)) * h

    def line(time: Reals) -> Reals:
        return np.asarray(300.0 * time + 0.5 * acceleration * np.clip(time - at, 0.0, None) ** 2)

    smoothed = path(line(t - delays[:, None]), h, tau, 300.0, delays)[:, :, 0]
    error = smoothed - line(t + h)
    first = int(at / h)
    return np.asarray((error - error[:, first - 1 : first])[:, first:])


@drawn(30)
@given(
    tau=st.floats(0.005, 0.08),
    share=st.floats(0.0125, 0.3),
    acceleration=st.floats(50.0, 20000.0),
    phase=st.floats(0.0, 1.0),
    backwards=st.booleans(),
)
def test_the_greatest_error_after_a_change_of_the_acceleration(
    tau: float, share: float, acceleration: float, phase: float, backwards: bool
) -> None:
    """For delays from none to 3 smoothing times, each entered as it is; without one it is 2 a τ², too."""
    h = share * tau
    delays = np.linspace(0.0, 3.0, 7) * tau
    errors = ramp_errors(tau, h, delays, -acceleration if backwards else acceleration, 0.2 + phase * h)
    formula = acceleration * (2.0 * tau**2 + 1.85 * tau * delays + 0.42 * delays**2)
    np.testing.assert_allclose(np.abs(errors).max(axis=1), formula, rtol=0.03)


def test_the_table_of_errors_has_the_figures_of_its_formulas() -> None:
    formula, figures = row("greatest error after a = 1000 mm/s²")
    assert formula == "2.0 a τ²"
    with_delay, delayed = row("the same with a delay of d = 8 ms")
    assert with_delay == "a (2 τ² + 1.85 τ d + 0.42 d²)"
    for tau, figure, late in zip((0.01, 0.02, 0.04), figures, delayed, strict=True):
        exact = np.abs(ramp_errors(tau, 0.001, np.array([0.0, 0.008]), 1000.0, 0.2)).max(axis=1)
        np.testing.assert_allclose([figure, late], exact, rtol=0.03)


@pytest.mark.parametrize("tau", SMOOTHING_TIMES)
def test_the_error_is_gone_after_twelve_smoothing_times(tau: float) -> None:
    (error,) = np.abs(ramp_errors(tau, 0.05 * tau, np.zeros(1), 1000.0, 0.2))
    assert error[240:].max() < 0.02 * error.max() < error[200]


@pytest.mark.parametrize("delay", [0.0, 0.004, 0.008, 0.016])
@pytest.mark.parametrize(("allowed", "acceleration"), [(0.3, 300.0), (0.5, 1000.0), (2.0, 250.0)])
def test_the_smoothing_time_that_a_line_allows(allowed: float, acceleration: float, delay: float) -> None:
    """With it, the error is what is allowed, and hardly less."""
    tau = sqrt(allowed / (2.0 * acceleration)) - 0.46 * delay
    error = np.abs(ramp_errors(tau, 0.001, np.array([delay]), acceleration, 0.2)).max()
    assert 0.9 * allowed < error < 1.03 * allowed


def test_the_example_of_a_smoothing_time() -> None:
    """In whole ms, rounded down."""
    with_delay = sqrt(0.3 / 600.0) - 0.46 * 0.008
    text = f"{int(1e3 * sqrt(0.3 / 600.0))} ms without a delay, and {int(1e3 * with_delay)} ms with one of 8 ms"
    assert text in " ".join(PAGE.split())


BEAT = {  # of each row of the table: the two figures of its formula
    "s of the position": (0.48, 0.24),
    "s of the velocity": (0.47, 0.25),
    "s of the acceleration": (0.77, 0.41),
    "greatest acceleration": (1.75, 0.95),
}
COUNTS = np.sort(np.concatenate([n + s * np.geomspace(1e-3, 0.5, 60) for n in (1.0, 2.0, 3.0) for s in (-1.0, 1.0)]))


def rounding_left(counts: Reals, q: float, h: float, tau: float, delay: float) -> Reals:
    """What is left of rounding to q on lines that make so many counts a step: sigma of position, velocity and
    acceleration, and the greatest acceleration, each of shape (lines,)."""
    velocity = counts * q / h
    settled = round(20.0 * tau / h)
    line = (counts * q)[:, None] * np.arange(settled + 4000) + 0.37 * q
    smoothed = path(np.round(line / q) * q, h, tau, velocity, delay)
    errors = smoothed[:, settled:, 0] - (line + (counts * q)[:, None])[:, settled:]
    accelerations = smoothed[:, settled:, 2]
    sigmas = [errors.std(axis=1), smoothed[:, settled:, 1].std(axis=1), accelerations.std(axis=1)]
    return np.array([*sigmas, np.abs(accelerations).max(axis=1)])


@pytest.mark.parametrize("delay_share", [0.0, 0.4, 1.0])
@pytest.mark.parametrize(("tau", "h"), [(0.02, 0.001), (0.01, 0.003), (0.05, 0.004), (0.005, 0.0005)])
def test_rounding_is_bounded_at_every_velocity(tau: float, h: float, delay_share: float) -> None:
    """The lines make from a thousandth of a count to nearly four in a step: those near whole numbers beat. The worst
    of them comes near each bound."""
    q = 0.1
    counts = np.concatenate([np.geomspace(1e-3, 0.5, 40), COUNTS])
    worst = rounding_left(counts, q, h, tau, delay_share * tau).max(axis=1)
    units = np.array([q, q / tau, q / tau**2, q / tau**2])
    bounds = np.array([first + second * delay_share for first, second in BEAT.values()]) * units
    assert (worst < bounds).all(), worst / bounds
    assert (worst > 0.9 * bounds).all(), worst / bounds


@pytest.mark.parametrize(("tau", "h"), [(0.01, 0.001), (0.02, 0.001), (0.04, 0.001), (0.01, 0.003)])
def test_half_of_all_velocities_leave_less_than_noise(tau: float, h: float) -> None:
    """And near a whole number of counts it is more than noise leaves: the formula for noise is no bound."""
    spread = np.linspace(1.0, 3.0, 400) + 1e-4
    left = rounding_left(spread, 0.1, h, tau, 0.0)[:3]
    noise = 0.0289 * noise_left(h, tau)
    assert (np.median(left, axis=1) < noise).all()
    near = rounding_left(np.array([1.01, 2.005, 3.002]), 0.1, h, tau, 0.0)[0].max()
    assert near > 1.9 * noise[0]


def test_the_table_of_resolutions_has_the_figures_of_its_formulas() -> None:
    for i, (head, (first, second)) in enumerate(BEAT.items()):
        formula, figures = row(head)
        power = min(i, 2)
        assert formula == f"({first} + {second} d/τ) q" + ["", " / τ", " / τ²"][power]
        for tau, figure in zip((0.01, 0.02, 0.04), figures, strict=True):
            assert figure == pytest.approx(first * 0.1 / tau**power, rel=0.03)


@pytest.mark.parametrize("delay_share", [0.0, 0.4, 1.0, 3.0])
@pytest.mark.parametrize("share", [0.0125, 0.05, 0.3])
@pytest.mark.parametrize("tau", SMOOTHING_TIMES)
def test_the_uncertain_travel_is_enough(tau: float, share: float, delay_share: float) -> None:
    """For a line of 300 mm/s that stops at once, which needs about half of it, and for noise on a line at rest, at the
    highest speed that the noise itself has made."""
    h, delay = share * tau, delay_share * tau
    t = np.arange(round((1.0 + 40.0 * tau + delay) / h)) * h
    for line, velocity, most in (
        (np.minimum(300.0 * (t - delay), 150.0)[None], 300.0, 0.55),
        (noisy(np.zeros(10_000), 0.05, 20), 0.0, 0.9),
    ):
        position, speed, _ = np.moveaxis(path(line, h, tau, velocity, delay), 2, 0)[:, :, 10:]
        back = np.maximum.accumulate(position, axis=1) - position
        travel = 3.0 * np.maximum.accumulate(np.abs(speed), axis=1) * (tau + delay + h)
        assert (back < most * travel).all()
