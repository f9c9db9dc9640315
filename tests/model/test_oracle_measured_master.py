"""The oracle of the measured master: against numbers by hand, against linear systems theory, and in closed form.

In the limit of short steps, with u = t/τ and s for τ·d/dt, the filter of the estimate x and then the path X are

    e = m - x = s³/(s + 1)³ m        (s + 1)² X = (s + 1)² x - (3s + 9) e
    X = (10s² + 5s + 1)/(s + 1)⁵ m   m - X = s³ (s² + 5s + 10)/(s + 1)⁵ m

so that a jump of the master's acceleration a makes an error of a τ² exp(-u) (u²/2 + u³/2 + u⁴/4), one of its velocity
the derivative of that.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from itertools import accumulate
from random import Random
from typing import Any

import numpy as np
import pytest

from tests.oracle import mp
from tests.oracle.master import Motion
from tests.oracle.measured_master import MeasuredMaster

EXACT = mp.mpf("1e-40")
ERROR = [Fraction(), Fraction(), Fraction(1, 2), Fraction(1, 2), Fraction(1, 4)]
"""The error of the path after a jump of the acceleration by 1/τ²: a polynomial of u, times exp(-u)."""
RESPONSE = [Fraction(), Fraction(), Fraction(5), Fraction(-5, 2), Fraction(1, 4)]
"""The impulse response of the path's position, likewise."""


def run(master: MeasuredMaster, steps: Iterable[tuple[Any, ...]]) -> list[Motion]:
    """The path after each step, given as h and the inputs."""
    paths = []
    for step in steps:
        master.step(*step)
        paths.append(master.path)
    return paths


def numbers(motion: Motion) -> list[Any]:
    return [motion.position, motion.velocity, motion.acceleration]


def close(motion: Motion, expected: Motion, error: Any = EXACT) -> bool:
    return all(abs(a - b) <= error for a, b in zip(numbers(motion), numbers(expected), strict=True))


def parabola(position: Any, velocity: Any, acceleration: Any) -> Callable[[Any], Motion]:
    """A line of constant acceleration, over time."""
    p, v, a = map(mp.mpf, (position, velocity, acceleration))
    return lambda t: Motion(p + v * t + a * t * t / 2, v + a * t, a)


def derivative(polynomial: Sequence[Fraction]) -> list[Fraction]:
    """Of a polynomial of u times exp(-u)."""
    raised = [*(power * c for power, c in enumerate(polynomial[1:], start=1)), Fraction()]
    return [r - c for r, c in zip(raised, polynomial, strict=True)]


def value(polynomial: Sequence[Fraction], u: float) -> float:
    """Of a polynomial times exp(-u)."""
    return math.exp(-u) * sum(float(c) * u**power for power, c in enumerate(polynomial))


# --- by hand ----------------------------------------------------------------------------------------------------------


def test_the_start_is_carried_on_over_the_delay() -> None:
    """X = 100 + 50/2 + 8/8, V = 50 + 8/2; after a quarter of a second X = 126 + 54/4 + 8/32, V = 54 + 8/4."""
    master = MeasuredMaster(100, 50, 8, delay=0.5)
    assert numbers(master.path) == [126, 54, 8]
    master.step(0.25, 100, 50, 8)
    assert numbers(master.path) == [139.75, 56, 8]
    assert numbers(master.estimate) == [100, 50, 8]


def test_a_measurement_after_one_smoothing_time() -> None:
    """θ(1) = 3/8: gains 485/512, 825/1024, 125/512 of the estimate, 135/128 and 25/64 of the path."""
    master = MeasuredMaster(0, smoothing_time=1.0)
    master.step(1.0, 0)
    assert numbers(master.path) == [0, 0, 0]
    master.step(1.0, 512)
    assert close(master.estimate, Motion(485, 412.5, 125))
    chosen = 125 + 412.5 * 135 / 128 + 485 * 25 / 64
    assert close(master.path, Motion(chosen / 2, chosen, chosen))


def test_after_a_first_step_that_differs_from_the_initialization_only_the_step_counts() -> None:
    steps = [(0.001, 7 + 0.3 * n, 300, -40) for n in range(5)]
    parameters = {"delay": 0.004, "period": 6.0}
    as_initialized = run(MeasuredMaster(7, 300, -40, **parameters), steps)
    assert run(MeasuredMaster(-5000, 1, 2, **parameters), steps) == as_initialized


def test_velocity_and_acceleration_inputs_act_in_the_first_step_only() -> None:
    positions = [0, 0.4, 1.1, 1.3]
    quiet = [(0.001, p) for p in positions]
    loud = [(0.001, p, 1e5 * (n > 0), -1e5 * (n > 0)) for n, p in enumerate(positions)]
    assert run(MeasuredMaster(0), quiet) == run(MeasuredMaster(0), loud)


@pytest.mark.parametrize("sign", [1, -1])
def test_velocity_and_acceleration_of_the_estimate_and_acceleration_of_the_path_are_limited(sign: int) -> None:
    """h = 2⁻²⁰: a jump by 1 asks for v = 3/2·2²⁰ and a = 2⁴⁰ > 1e12; the next one, by 1e12, for more than 1e12 of v.

    In between the estimate goes on with the limited acceleration: a measurement in its place changes nothing.
    """
    h, limit = mp.mpf(2) ** -20, sign * mp.mpf(10) ** 12
    master = MeasuredMaster(0, smoothing_time=0.0)
    master.step(h, 0)
    master.step(h, sign)
    assert numbers(master.estimate) == [sign, sign * 1.5 * 2**20, limit]
    assert numbers(master.path) == [limit * h * h / 2, limit * h, limit]
    master.step(h, sign * 2.5 + limit * h * h / 2)
    assert numbers(master.estimate) == [sign * 2.5 + limit * h * h / 2, sign * 1.5 * 2**20 + limit * h, limit]
    assert numbers(master.path) == [2 * limit * h * h, 2 * limit * h, limit]
    master.step(h, limit)
    assert numbers(master.estimate) == [limit, limit, limit]


@pytest.mark.parametrize(
    "step",
    [
        *((h, 1.0, 0.0, 0.0) for h in (0.0, -0.001, math.nan, 1.1e6)),
        *((0.001, *values) for bad in (math.nan, math.inf, 1.1e12, -1.1e12) for values in [(bad, 0, 0), (1, bad, 0)]),
        (0.001, 1.0, 0.0, math.nan),
    ],
)
@pytest.mark.parametrize("before", [0, 3])
def test_a_refused_step_changes_nothing(step: tuple[float, ...], before: int) -> None:
    steps = [(0.001, n * n) for n in range(6)]
    master = MeasuredMaster(0)
    run(master, steps[:before])
    with pytest.raises(ValueError, match=" is "):
        master.step(*step)
    assert run(master, steps[before:]) == run(MeasuredMaster(0), steps)[before:]


# --- when a measurement is taken --------------------------------------------------------------------------------------

WITHIN, MISSED = 2.0**-28, 2.0**-27
"""3.7e-9 and 7.5e-9: by so much less than a multiple of 4; the tolerance is 4e-9."""


def times_of_measurements(steps: Iterable[float], sample_time: float) -> list[float]:
    """The times at which steps take a measurement, after the first step: each position input is another one."""
    master, times = MeasuredMaster(0, smoothing_time=20.0, sample_time=sample_time), []
    for number, h in enumerate(steps):
        before, begin = master.estimate, float(master.elapsed)
        master.step(h, number)
        if master.estimate != before:
            times.append(begin)
    return times


@pytest.mark.parametrize(
    ("steps", "times"),
    [
        ([1] * 10, [4, 8]),
        ([3] * 11, [6, 9, 12, 18, 21, 24, 30]),  # the first step's begin at or after 4, 8, 12, 16, 20, 24, 28
        ([10, 1, 1, 1, 5, 1], [10, 12, 18]),  # 8 has passed at 10: the next multiple is 12
        ([4 - WITHIN, 1, 1], [4 - WITHIN]),
        ([4 - MISSED, 1, 1], [5 - MISSED]),
        ([1e6 - 4, 4 - WITHIN, 1, 1], [1e6 - 4, 1e6 - WITHIN]),
        ([1e6 - 4, 4 - MISSED, 1, 1], [1e6 - 4, 1e6 + 1 - MISSED]),  # the tolerance is that of 4, not of 1e6
    ],
)
def test_a_measurement_is_taken_where_a_multiple_of_the_sample_time_is_reached(
    steps: list[float], times: list[float]
) -> None:
    assert times_of_measurements(steps, 4) == times
    assert times_of_measurements(steps, 0) == list(accumulate(steps[:-1]))


@pytest.mark.parametrize("steps", [1, 2, 4, 5, 8, 30])
def test_the_setpoints_at_multiples_of_the_sample_time_do_not_depend_on_the_step(steps: int) -> None:
    """What is at the input in between is not looked at. Multiples are missed by 1e-17 where h is rounded: 4 ms / 5."""
    r, sample_time = Random(4), 0.004
    measured = [100 * n * sample_time + r.gauss(0, 0.02) for n in range(24)]
    once = run(MeasuredMaster(0, delay=0.003, sample_time=sample_time), [(sample_time, m) for m in measured])
    shorter = [(sample_time / steps, 1e6 if k else m) for m in measured for k in range(steps)]
    often = run(MeasuredMaster(0, delay=0.003, sample_time=sample_time), shorter)[steps - 1 :: steps]
    error = EXACT if math.log2(steps).is_integer() else mp.mpf("1e-11")
    assert all(close(path, expected, error) for path, expected in zip(often, once, strict=True))


# --- constant acceleration --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_constant_acceleration_since_the_start_is_exact(seed: int) -> None:
    """With any parameters and steps of random lengths; the inputs of the start are those of `delay` before it."""
    r = Random(seed)
    delay, period = r.choice([0.0, 0.004, r.random()]), r.choice([0.0, 0.1, 360.0])
    master_at = parabola(r.uniform(-1e3, 1e3), r.uniform(-1e3, 1e3), r.uniform(-1e4, 1e4))
    times = [mp.mpf(0), *accumulate(mp.mpf(r.uniform(0.001, 0.03)) for _ in range(60))]
    inputs = [master_at(t - delay) for t in times]
    measured = [i.position % period if period else i.position for i in inputs]
    turns = measured[0] - inputs[0].position
    master = MeasuredMaster(
        measured[0],
        inputs[0].velocity,
        inputs[0].acceleration,
        smoothing_time=r.choice([0.0, 0.001, 0.02, r.uniform(0, 10)]),
        delay=delay,
        sample_time=r.choice([0.0, 0.005, r.uniform(0, 0.2)]),
        period=period,
    )
    steps = [
        (end - begin, m, i.velocity, i.acceleration)
        for begin, end, m, i in zip(times, times[1:], measured, inputs, strict=False)
    ]
    for path, end in zip(run(master, steps), times[1:], strict=True):
        ideal = master_at(end)
        assert close(path, Motion(ideal.position + turns, ideal.velocity, ideal.acceleration))


def test_without_smoothing_the_estimate_is_the_parabola_through_three_samples() -> None:
    """At equal distances h it ends with velocity (3p₃ - 4p₂ + p₁)/2h, and has acceleration (p₃ - 2p₂ + p₁)/h²."""
    r, h = Random(3), 0.125
    p = [mp.mpf(r.uniform(-10, 10)) for _ in range(12)]
    master = MeasuredMaster(p[0], 3.0, -70.0, smoothing_time=0.0)
    run(master, [(h, q) for q in p[:3]])
    for p1, p2, p3 in zip(p[1:], p[2:], p[3:], strict=False):
        master.step(h, p3)
        expected = Motion(p3, (3 * p3 - 4 * p2 + p1) / (2 * h), (p3 - 2 * p2 + p1) / (h * h))
        assert close(master.estimate, expected)


def test_without_smoothing_an_unknown_motion_is_followed_exactly_after_five_steps() -> None:
    """Three samples make the parabola, which the path, both of whose poles are then 0, reaches in two steps."""
    master_at, h = parabola(5, 300, -4000), 0.125
    paths = run(
        MeasuredMaster(0, smoothing_time=0.0, delay=0.25), [(h, master_at(n * h - 0.25).position) for n in range(9)]
    )
    exact = [close(path, master_at((n + 1) * h)) for n, path in enumerate(paths)]
    assert exact == [False] * 4 + [True] * 5


# --- turns ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("velocity", [-1.3e5, 1.3e5, 3e9])
@pytest.mark.parametrize("extra", [0, 5])
def test_turns_make_no_difference(velocity: float, extra: int) -> None:
    """0.36, or 8333.3, turns a step, measured with noise, in any turn: the path is that of a linear axis."""
    r, period, h = Random(5), 360.0, 0.001
    position = [100 + velocity * n * h + r.uniform(-1, 1) for n in range(100)]
    wrapped = [mp.mpf(p) % period + (r.randint(-extra, extra) * period if n else 0) for n, p in enumerate(position)]
    linear, modulo = MeasuredMaster(0), MeasuredMaster(0, period=period)
    turns = wrapped[0] - position[0]
    for p, w in zip(position, wrapped, strict=True):
        linear.step(h, p, velocity)
        modulo.step(h, w, velocity)
        x = linear.path
        assert close(modulo.path, Motion(x.position + turns, x.velocity, x.acceleration), mp.mpf("1e-36"))
        assert 0 <= modulo.wrapped < period
        assert modulo.wrapped == modulo.path.position % period
        assert linear.wrapped == x.position
    assert abs(modulo.path.position) > 30 * period


@pytest.mark.parametrize(("measured", "position"), [(299, -61), (301, -59), (-61, -61), (119, 119), (121, -239)])
def test_a_measurement_belongs_to_the_turn_in_which_it_is_nearest_to_the_expected_position(
    measured: float, position: float
) -> None:
    """Expected at -60: at rest there. Without smoothing the estimate is where the measurement is."""
    master = MeasuredMaster(-60, smoothing_time=0.0, period=360.0)
    run(master, [(0.5, -60), (0.5, measured)])
    assert master.estimate.position == position


# --- noise ------------------------------------------------------------------------------------------------------------


def pole(time: float, smoothing_time: float) -> float:
    u = time / smoothing_time
    return 1 / (1 + u + u**2 / 2 + u**3 / 6)


def linear_system(h: float, smoothing_time: float, delay: float, before: float) -> tuple[Any, Any]:
    """F and G of z⁺ = F z + G m, z = (x, v, a, X, V, A), for a step of length h after one of length `before`."""
    t, theta = before, pole(before, smoothing_time)
    predict = np.array([[1, t, t**2 / 2], [0, 1, t], [0, 0, 1]])
    gain = np.array([1 - theta**3, 1.5 * (1 - theta) ** 2 * (1 + theta) / t, (1 - theta) ** 3 / t**2])
    theta, d = pole(h, smoothing_time), delay
    now = np.array([[1, d, d**2 / 2], [0, 1, d], [0, 0, 1]])
    feedback = np.array([(1 - theta) ** 2 / h**2, (1 - theta) * (3 + theta) / 2 / h, 1])
    # from (x, v, a) after the measurement and the path (X, V) before the step
    choose = np.concatenate([feedback @ now, -feedback[:2]])
    move = np.zeros((6, 5))
    move[:3, :3] = np.eye(3)
    move[3:, 3:] = np.array([[1, h], [0, 1], [0, 0]])
    move[3:] += np.outer([h**2 / 2, h, 1], choose)
    measure = np.zeros((5, 6))
    measure[:3, :3] = predict - np.outer(gain, predict[0])
    measure[3:, 3:5] = np.eye(2)
    return move @ measure, move @ np.concatenate([gain, [0, 0]])


def deviations(h: float, smoothing_time: float, delay: float) -> Any:
    """One sigma of X, V, A for white noise of 1 in each measurement: P = F P Fᵀ + G Gᵀ, as linear equations of P."""
    f, g = linear_system(h, smoothing_time, delay, h)
    f = f[:, :5]  # A has no effect on what follows
    covariance = np.linalg.solve(np.eye(25) - np.kron(f[:5], f[:5]), np.kron(g[:5], g[:5])).reshape(5, 5)
    return np.sqrt(np.diag(f @ covariance @ f.T + np.outer(g, g)))[3:]


LINES = [
    (1, 10, 0, ("0.00751", "0.908", "234.3")),
    (1, 20, 0, ("0.00531", "0.3193", "41.49")),
    (1, 40, 0, ("0.00375", "0.1127", "7.336")),
    (1, 20, 4, ("0.00576", "0.3506", "45.68")),
    (4, 20, 0, ("0.01067", "0.6555", "82.34")),
]
"""h, smoothing time, delay (ms); one sigma of X, V, A for noise of 0.02 mm."""


@pytest.mark.parametrize(("h", "smoothing_time", "delay", "figures"), LINES)
def test_noise_of_the_path(h: int, smoothing_time: int, delay: int, figures: tuple[str, ...]) -> None:
    computed = 0.02 * deviations(h / 1e3, smoothing_time / 1e3, delay / 1e3)
    decimals = [len(figure.partition(".")[2]) for figure in figures]
    assert tuple(f"{sigma:.{n}f}" for sigma, n in zip(computed, decimals, strict=True)) == figures


@pytest.mark.parametrize(("h", "smoothing_time", "delay", "figures"), LINES)
def test_impulse_response(h: int, smoothing_time: int, delay: int, figures: tuple[str, ...]) -> None:
    """That of the linear system whose covariance gives the figures; its squares add up to theirs, from 14 τ on."""
    h_s, tau, d = h / 1e3, smoothing_time / 1e3, delay / 1e3
    f, g = linear_system(h_s, tau, d, h_s)
    master = MeasuredMaster(0, smoothing_time=tau, delay=d)
    master.step(h_s, 0)
    z, response = g, []
    for n in range(16 * smoothing_time // h):
        master.step(h_s, 1 if n == 0 else 0)
        response.append([float(value) for value in numbers(master.path)])
        if n < 40:
            state = [float(value) for value in numbers(master.estimate)] + response[-1]
            scale = np.array([1, 1 / tau, 1 / tau**2] * 2)
            assert np.abs((state - z) / scale).max() < 1e-11
        z = f @ z
    sums = np.sqrt(np.square(response).sum(axis=0))
    assert 0.02 * sums == pytest.approx([float(figure) for figure in figures], rel=1e-3)


def test_noise_of_the_path_at_short_steps() -> None:
    """The integral of the squared impulse response, ∫ uⁿ exp(-2u) du = n!/2ⁿ⁺¹, and of its two derivatives."""
    squares, response = [], RESPONSE
    for _ in range(3):
        products = ((i + j, a * b) for i, a in enumerate(response) for j, b in enumerate(response))
        squares.append(sum(c * Fraction(math.factorial(n), 2 ** (n + 1)) for n, c in products))
        response = derivative(response)
    assert squares == [Fraction(45, 32), Fraction(65, 32), Fraction(441, 32)]
    factors = [math.sqrt(square) for square in squares]
    assert factors == pytest.approx([1.1859, 1.4252, 3.7123], abs=5e-5)
    assert deviations(0.002, 1.0, 0.0) / math.sqrt(0.002) == pytest.approx(factors, rel=1e-5)


def test_steps_of_random_lengths() -> None:
    """The linear system with the matrices of each step."""
    r, tau, delay = Random(2), 0.02, 0.003
    lengths = [r.choice([r.uniform(1e-4, 1e-2), 1e-3]) for _ in range(200)]
    master, z, before = MeasuredMaster(0, smoothing_time=tau, delay=delay), np.zeros(6), 0.0
    scale = np.array([1, 1 / tau, 1 / tau**2] * 2)
    for n, h in enumerate(lengths):
        measured = r.uniform(-1, 1) if n else 0.0
        master.step(h, measured)
        if n:
            f, g = linear_system(h, tau, delay, before)
            z = f @ z + g * measured
        before = h
        state = [float(value) for value in numbers(master.estimate) + numbers(master.path)]
        assert np.abs((state - z) / scale).max() < 1e-11


# --- transients -------------------------------------------------------------------------------------------------------


def errors_of_position(line: Callable[[float], float], h: float, smoothing_time: float, until: float) -> list[float]:
    """Of the path at the end of each step, for a line that is at rest until its start and does not announce it."""
    master = MeasuredMaster(0, smoothing_time=smoothing_time)
    paths = run(master, [(h, line(n * h)) for n in range(round(until / h))])
    return [line((n + 1) * h) - float(path.position) for n, path in enumerate(paths)]


@pytest.mark.parametrize(
    ("line", "error"),
    [(lambda t: 500 * t * t, ERROR), (lambda t: 1000 * t, derivative(ERROR))],
    ids=["jump of a", "of v"],
)
def test_a_jump_of_acceleration_or_velocity_makes_the_transient_of_the_closed_form(
    line: Callable[[float], float], error: Sequence[Fraction]
) -> None:
    """To 0.3 with τ = 50 h; the errors are up to 1965 and 932."""
    computed = errors_of_position(line, 0.02, 1.0, 12.0)
    assert computed == pytest.approx([1000 * value(error, 0.02 * (n + 1)) for n in range(600)], abs=0.3)


def test_the_transient_in_figures() -> None:
    """The greatest error is 1.965 a τ², at 3.5 τ; of it 22 % are left after 8 τ, 2 % after 12 τ."""
    error = [value(ERROR, n / 100) for n in range(2000)]
    greatest = max(error)
    assert (f"{greatest:.3f}", f"{greatest:.1f}", error.index(greatest)) == ("1.965", "2.0", 348)
    assert (f"{error[800] / greatest:.3f}", f"{error[1200] / greatest:.3f}") == ("0.224", "0.019")


@pytest.mark.parametrize(
    ("smoothing_time", "h", "figure", "error"),
    [
        *((10, h, 0.197, 0.05) for h in (0.1, 1, 3)),
        (10, 5, 0.216, 0.005),
        *((20, h, 0.787, 0.05) for h in (0.5, 5)),
        *((40, h, 3.15, 0.05) for h in (1, 5)),
    ],
)
def test_greatest_error_after_a_jump_of_the_acceleration(
    smoothing_time: int, h: float, figure: float, error: float
) -> None:
    """By 1000 mm/s². It grows with (h/τ)²: by 10 % at h = τ/2, by less than 5 % up to h = 0.3 τ."""
    errors = errors_of_position(lambda t: 500 * t * t, h / 1e3, smoothing_time / 1e3, 5 * smoothing_time / 1e3)
    assert max(map(abs, errors)) == pytest.approx(figure, rel=error)
