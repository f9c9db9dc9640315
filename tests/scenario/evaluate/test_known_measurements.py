"""Numbers that are known of encoder, servo, load and true pieces: by hand, published, or by an integrator."""

import math
from itertools import accumulate, pairwise
from random import Random
from typing import Any

import numpy as np
import pytest

from tests.oracle.measured_line import load, true_pieces
from tests.oracle.measured_line.encoder import Encoder, scripted_line
from tests.oracle.measured_line.servo import Servo
from tests.oracle.measured_line.true_pieces import TrueCuts
from tests.oracle.numerics import mp, splitmix64

EXACT = mp.mpf("1e-40")
PUBLISHED = {  # the first outputs of the published generator, started with these states
    0: [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F, 0xF88BB8A8724C81EC, 0x1B39896A51A8749B],
    1234567: [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
        4593380528125082431,
        16408922859458223821,
    ],
}


# --- noise ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("state", PUBLISHED)
def test_splitmix64_has_the_published_outputs(state: int) -> None:
    assert [splitmix64.mixed(state + i * splitmix64.GAMMA) for i in range(1, 6)] == PUBLISHED[state]


def test_the_first_sample_of_seed_0_by_hand() -> None:
    """The output of the state 0, which is 0, and the five published ones."""
    halves = [half for output in PUBLISHED[0] for half in divmod(output, 2**32)]
    assert splitmix64.noise_sample(0, 0) == sum(halves) / 2**32 - 6


def test_a_sample_of_any_seed_starts_at_its_own_state() -> None:
    """The counter of sample n is seed * 2**32 + 6 n, whose multiple of the gamma is taken modulo 2**64."""
    seed, n = 2**32 - 1, 12345
    state = (seed * 2**32 + 6 * n) * splitmix64.GAMMA % 2**64
    halves = [half for i in range(6) for half in divmod(splitmix64.mixed(state + i * splitmix64.GAMMA), 2**32)]
    assert splitmix64.noise_sample(seed, n) == sum(halves) / 2**32 - 6


CLIPPED = [(1, 24006, 4.44419), (2, 39361, 4.00890), (3, 20227, -4.03847)]
"""Seed, number and size in sigma of samples that are beyond 4: of a million, 17 are."""


@pytest.mark.parametrize(("seed", "n", "sigma"), CLIPPED)
def test_the_noise_is_clipped_at_four_sigma(seed: int, n: int, sigma: float) -> None:
    outputs = [splitmix64.mixed((seed * 2**32 + 6 * n + i) * splitmix64.GAMMA) for i in range(6)]
    assert sum(half for output in outputs for half in divmod(output, 2**32)) / 2**32 - 6 == pytest.approx(
        sigma, abs=1e-5
    )
    assert splitmix64.noise_sample(seed, n) == math.copysign(4, sigma)


# --- encoder ----------------------------------------------------------------------------------------------------------


def ramp(t: Any) -> Any:
    """A true line of -3 + 100 t."""
    return -3 + 100 * mp.mpf(t)


def readings(encoder: Encoder, line: Any, steps: int, h: float) -> list[Any]:
    """Those at communication points, without a sample time."""
    return [encoder.reading(n * h, n, line) for n in range(steps)]


def test_an_ideal_encoder_shows_the_true_position() -> None:
    assert readings(Encoder(), ramp, 5, 0.125) == [-3, 9.5, 22, 34.5, 47]


def test_the_resolution_rounds_down_also_below_0() -> None:
    """Rounded down towards minus infinity; what is a multiple stays."""
    encoder = Encoder(resolution=0.25)
    values = [encoder.reading(0, 0, lambda _, p=p: mp.mpf(p)) for p in (-0.5, -0.26, -0.25, -0.01, 0, 0.24, 0.25, 0.5)]
    assert values == [-0.5, -0.5, -0.25, -0.25, 0, 0, 0.25, 0.5]


def test_the_value_is_delayed() -> None:
    encoder = Encoder(delay=0.25)
    assert readings(encoder, ramp, 5, 0.125) == [-28, -15.5, -3, 9.5, 22]


def test_before_the_start_the_line_is_carried_on_backwards() -> None:
    """p = 10 + 4 t + 8 t² before 0, though the first segment changes both; then 10 + 2 t; from 1 s on at rest at 12."""
    segments = [{"duration": 1.0, "velocity": 2.0}, {"duration": 1.0, "velocity": 0.0}]
    line = scripted_line({"position": 10.0, "velocity": 4.0, "acceleration": 16.0, "segments": segments}, 9)
    assert [line(mp.mpf(t)) for t in (-2, -0.5, -0.25, 0, 0.5, 1, 1.5, 8)] == [34, 10, 9.5, 10, 11, 12, 12, 12]
    assert readings(Encoder(delay=0.5), line, 4, 0.25) == [10, 9.5, 10, 10.5]


def test_the_scale_is_measured_per_true_travel() -> None:
    expected = [mp.mpf(1.0005) * p for p in (-3, 9.5, 22)]
    assert readings(Encoder(scale=1.0005), ramp, 3, 0.125) == expected


def test_the_runout_is_a_sine_of_the_true_travel_once_a_turn() -> None:
    """Quarters of a turn, of 500; the scale leaves the sine alone."""
    encoder = Encoder(scale=2.0, runout_amplitude=0.5, runout_length=500.0)
    values = [encoder.reading(0, 0, lambda _, p=p: mp.mpf(p)) for p in (-125, 0, 125, 250, 375, 1125)]
    expected = [-250.5, 0, 250.5, 500, 749.5, 2250.5]
    assert all(abs(a - b) < EXACT for a, b in zip(values, expected, strict=True))
    sixth = encoder.reading(0, 0, lambda _: mp.mpf(500) / 12)
    assert abs(sixth - (mp.mpf(1000) / 12 + 0.25)) < EXACT


def test_the_noise_comes_before_the_rounding() -> None:
    noise = [splitmix64.noise_sample(3, n) for n in range(200)]
    values = readings(Encoder(resolution=0.5, noise=2.0, seed=3), lambda _: mp.mpf(0), 200, 0.001)
    assert values == [math.floor(2 * 2.0 * z) / 2 for z in noise]
    assert len(set(values)) > 10
    continuous = readings(Encoder(noise=2.0, seed=3), lambda _: mp.mpf(7), 200, 0.001)
    assert [float(c - 7) for c in continuous] == pytest.approx([2 * z for z in noise], abs=1e-15)


def test_wrapping_comes_last() -> None:
    """With a period of 1, that is no multiple of the resolution, and the noise's turn."""
    encoder = Encoder(resolution=0.375, period=1.0)
    values = [encoder.reading(0, 0, lambda _, p=p: mp.mpf(p)) for p in (-0.1, 0, 0.99, 1.2, 2.7)]
    assert values == [0.625, 0, 0.75, 0.125, 0.625]
    noisy, linear = (Encoder(noise=2.0, seed=4, period=period) for period in (1.0, 0.0))
    for n in range(50):
        wrapped, unwrapped = noisy.reading(0, n, lambda _: mp.mpf(0)), linear.reading(0, n, lambda _: mp.mpf(0))
        assert 0 <= wrapped < 1
        assert noisy.unwrapped(0, n, lambda _: mp.mpf(0)) == unwrapped
        assert abs(unwrapped - wrapped - mp.nint(unwrapped - wrapped)) < EXACT


def test_with_a_sample_time_the_value_is_held() -> None:
    """A line of 100 u/s, at multiples of 1/8 s less the delay of 1/16; a time short of one by 1e-10 of it is there."""
    encoder = Encoder(sample_time=0.125, delay=0.0625)
    times = [0, 0.0625, 0.1249, 0.125 - 1e-11, 0.125, 0.2, 0.25, 1.0]
    numbers = [encoder.sample_number(t) for t in times]
    assert numbers == [0, 0, 0, 1, 1, 1, 2, 8]
    assert [encoder.reading(t, n, ramp) for t, n in zip(times, numbers, strict=True)] == [
        -9.25 + 12.5 * n for n in numbers
    ]
    with pytest.raises(ValueError, match="number 1, not 2"):
        encoder.reading(0.2, 2, ramp)


def test_with_a_sample_time_the_readings_depend_neither_on_the_step_nor_on_the_order() -> None:
    """With everything; steps of 4, 1 and 0.5 ms and odd points between, in any order."""
    encoder = Encoder(0.1, 0.02, 0.003, 1.0005, 0.05, 500.0, 0.004, 7, 360.0)
    times = [n * 0.0005 for n in range(160)] + [Random(1).uniform(0, 0.08) for _ in range(40)]
    Random(2).shuffle(times)
    samples: dict[int, set[Any]] = {}
    for t in times:
        n = encoder.sample_number(t)
        samples.setdefault(n, set()).add(encoder.reading(t, n, ramp))
    assert sorted(samples) == list(range(20))
    assert all(len(values) == 1 for values in samples.values())
    assert len(set.union(*samples.values())) > 15


# --- servo ------------------------------------------------------------------------------------------------------------


def setpoint(seed: int) -> tuple[list[float], list[float], list[float]]:
    """A setpoint with steps of random length and any velocities, the first one too."""
    r = Random(seed)
    times = [0.0, *accumulate(r.uniform(0.005, 0.05) for _ in range(8))]
    return times, [r.uniform(-1, 1) for _ in times], [r.uniform(-20, 20) for _ in times]


SERVOS = [
    (50.0, 0.003, 1.0, 0.002),  # complex roots
    (20.0, 0.01, 0.6, 0.0),  # real ones
    (25.0, 0.01, 0.0, 0.0301),  # the same root twice, but for the rounding of 0.01
    (16.0, 0.015625, 0.5, 0.01),  # twice, exactly
    (40.0, 0.0, 0.7, 0.013),
    (3.0, 0.5, 1.3, 0.2),
]


@pytest.mark.parametrize("parameters", SERVOS)
def test_the_servo_is_what_an_integrator_computes(parameters: tuple[float, float, float, float]) -> None:
    """scipy's, from kink to kink, for any setpoint; the setpoint is scipy's, too."""
    from scipy.integrate import solve_ivp  # noqa: PLC0415 (these take long to load, in every process that collects tests)
    from scipy.interpolate import CubicHermiteSpline  # noqa: PLC0415

    gain, lag, feedforward, dead_time = parameters
    times, positions, velocities = setpoint(5)
    s = CubicHermiteSpline(times, positions, velocities)
    ds = s.derivative()
    x, v, a = (np.array(values, float) for values in Servo(*parameters).run(times, positions, velocities))
    state = np.array([positions[0], 0.0] if lag else [positions[0]])
    computed = [[positions[0], 0.0, 0.0]]
    for begin, end in pairwise(sorted({*times, *(t + dead_time for t in times if t + dead_time < times[-1])})):
        moves = begin + end > 2 * dead_time

        def rates(t: float, y: Any, moves: bool = moves) -> list[float]:
            late = max(t - dead_time, 0.0)
            u = feedforward * ds(late) * moves + gain * ((s(late) if moves else positions[0]) - y[0])
            return [y[1], (u - y[1]) / lag] if lag else [u]

        state = solve_ivp(rates, (begin, end), state, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        if end in times:
            computed.append([*state, *rates(end, state)[-1:], *([] if lag else [math.nan])])
    expected = np.array(computed)
    assert np.ptp(x) > 0.05
    assert x == pytest.approx(expected[:, 0], rel=1e-9, abs=1e-9)
    assert v == pytest.approx(expected[:, 1], rel=1e-9, abs=1e-9)
    if lag:
        assert a == pytest.approx(expected[:, 2], rel=1e-9, abs=1e-7)


def test_a_dead_time_that_is_a_multiple_of_the_step_but_for_rounding() -> None:
    """Without Tv the acceleration jumps with the setpoint's: a row has the one before, whatever 0.007 rounds to."""
    h, steps = 0.001, 12
    times = [n * h for n in range(steps)]
    velocities = [0.0 if n < 2 else 3.0 * (n - 2) for n in range(steps)]  # 3000 from 2 ms on
    positions = [0.0 if n < 2 else 1500 * ((n - 2) * h) ** 2 for n in range(steps)]
    _, _, a = Servo(50.0, dead_time=0.003).run(times, positions, velocities)
    assert [float(value) for value in a] == pytest.approx([0.0] * 6 + [3000.0] * 6, abs=1e-6)


# --- load -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("acceleration", "velocity", "unit", "newton"),
    [
        (5000.0, 500.0, "mm", 750.0),  # 120 kg · 5 m/s² + 150 N
        (5000.0, -500.0, "mm", 450.0),
        (-5000.0, 0.0, "mm", -600.0),
        (0.0, 1e-300, "mm", 150.0),
        (2.0, -1.0, "m", 90.0),
        (180.0, 1.0, "deg", 120 * math.pi + 150),
        (2.0, 1.0, "rad", 390.0),
    ],
)
def test_force(acceleration: float, velocity: float, unit: str, newton: float) -> None:
    assert float(load.force(120.0, 150.0, acceleration, velocity, unit)) == pytest.approx(newton, rel=1e-15)


def test_power_and_work_of_a_move() -> None:
    """100 kg, 50 N, up with 2 m/s² and down again, 1 s each: 250 N, then -150 N; at most 500 W; 50 N · 2 m = 100 J."""
    times = [n / 64 for n in range(65)] + [1 + n / 64 for n in range(65)]
    velocities = [2000 * t if n < 65 else 2000 * (2 - t) for n, t in enumerate(times)]
    forces = [load.force(100, 50, 2000 if n < 65 else -2000, v or 1) for n, v in enumerate(velocities)]
    powers = [load.power(f, v) for f, v in zip(forces, velocities, strict=True)]
    assert abs(load.peak(powers) - 500) < EXACT
    assert abs(min(powers) + 300) < EXACT
    assert abs(load.integral(times, powers) - 100) < EXACT
    assert abs(load.peak(forces) - 250) < EXACT
    assert abs(load.rms(times, forces) - mp.sqrt(mp.mpf(250**2 + 150**2) / 2)) < EXACT
    assert load.used(load.peak(forces), 1000) == pytest.approx(0.25)


def test_rms_is_a_mean_over_time() -> None:
    """1 for 1 s, then 7 for 3 s, with two rows at the jump: √(148/4). A jump of the sign alone is none."""
    assert abs(load.rms([0, 1, 1, 3, 4], [1, 1, 7, 7, 7]) - mp.sqrt(37)) < EXACT
    assert load.rms([0, 1, 4], [-3, 3, -3]) == 3


# --- true pieces ------------------------------------------------------------------------------------------------------

H = 1 / 64


def cuts(master: Any, slave: Any, cutting: Any, steps: int = 640, **options: float) -> TrueCuts:
    """The cuts of a run at multiples of 1/64 s, of functions of time."""
    times = [n * H for n in range(steps)]
    return TrueCuts(
        times, [master(t) for t in times], [slave(t) for t in times], [cutting(t) for t in times], **options
    )


def test_lengths_by_hand() -> None:
    """A line of 100 u/s, cut from 1 to 1.5 s at 100 t - 95, 3 to 3.25 at 100 t - 297, and 6.5 to 8 at 100 t - 645."""
    lines = [(1.0, 1.5, 95.0), (3.0, 3.25, 297.0), (6.5, 8.0, 645.0)]

    def slave(t: float) -> float:
        return next((100 * t - place for begin, end, place in lines if begin <= t <= end), -1e3)

    result = cuts(lambda t: 100 * t, slave, lambda t: slave(t) > -1e3)
    assert result.places == [95, 297, 645]
    assert result.lengths() == [202, 348]
    assert result.lengths(4.0) == [198, 344]
    assert result.movement == 0


def test_a_place_is_a_mean_over_time_and_the_movement_is_measured() -> None:
    """The blade lags by 0.5 at first, linearly less later on; in another cut by 0.25. Ratio 2: half of it in material.

    A row that is there twice counts once.
    """
    times = [0, 1, 2, 2, 4, 5, 6, 7, 8]
    lag = [0, 0.5, 0.375, 0.375, 0.125, 0, 0.25, 0.25, 0]
    cutting = [False, True, True, True, True, False, True, True, False]
    master = [100.0 * t for t in times]
    slave = [2 * (m - 40) - x for m, x in zip(master, lag, strict=True)]
    result = TrueCuts(times, master, slave, cutting, ratio=2.0)
    assert result.places == [40 + 0.3125 / 2, 40.125]
    assert result.movement == 0.375 / 2


def test_a_cut_in_one_row_and_one_that_is_not_over() -> None:
    result = TrueCuts([0, 1, 2, 3], [0, 10, 20, 30], [0, 1, 0, 2], [False, True, False, True])
    assert result.places == [9]
    assert result.lengths() == []
    assert result.movement == 0
    assert TrueCuts([0, 1], [0, 1], [0, 0], [False, False]).movement == 0


def test_figures_of_the_errors() -> None:
    """2, -4, 2, 2, 2, 2, 4, 2: the mean is 1.5, the squares of the deviations sum up to 38."""
    errors = [2.0, -4.0, 2.0, 2.0, 2.0, 2.0, 4.0, 2.0]
    assert true_pieces.mean(errors) == 1.5
    assert true_pieces.deviation(errors) ** 2 == pytest.approx(38 / 7)
    assert true_pieces.worst(errors) == -4
    assert true_pieces.c_pk(errors, 10.0) == pytest.approx(8.5 / (3 * math.sqrt(38 / 7)))
    assert true_pieces.c_pk([-e for e in errors], 1.0) == pytest.approx(-0.5 / (3 * math.sqrt(38 / 7)))
    assert true_pieces.c_pk([0.5, 0.5], 1.0) == math.inf
    assert true_pieces.c_pk([0.5, 0.5], 0.5) == math.inf
    assert true_pieces.c_pk([0.5, 0.5], 0.25) == -math.inf
