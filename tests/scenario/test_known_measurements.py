"""Numbers worked out by hand or published that the encoder, the load and the true pieces have in the oracles."""

import math
from typing import Any

import pytest

from tests.oracle import load, mp, splitmix64, true_pieces
from tests.oracle.encoder import Encoder, scripted_line
from tests.oracle.true_pieces import TrueCuts

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


def test_the_load_of_an_axis_at_rest() -> None:
    assert load.force(120.0, 150.0, 0.0, 0.0) == 0
    assert load.peak([0.0, -3.0, 2.0]) == 3


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


def test_places_of_a_line_with_a_period() -> None:
    """Turns of 90, backwards as well: from 0 to 300, and back to 100."""

    def master(t: float) -> float:
        return 100 * t if t < 3 else 300 - 50 * (t - 3)

    def cutting(t: float) -> bool:
        return t in (0.5, 2.0, 6.0)

    linear = cuts(master, lambda t: 0.0, cutting)
    modulo = cuts(lambda t: master(t) % 90, lambda t: 0.0, cutting, period=90.0)
    assert linear.places == modulo.places == [50, 200, 150]
    assert modulo.lengths() == [150, -50]


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
