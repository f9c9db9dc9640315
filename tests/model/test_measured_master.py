"""The input mode MEASURED of the master axis, against its oracle and the closed forms that the oracle agrees with."""

from collections.abc import Callable, Iterable
from copy import deepcopy
from itertools import pairwise
from math import exp, inf, nan, sqrt
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.master import Master, MasterInput, PathRefusal
from tests.model.exact_paths import repeatable
from tests.oracle.measured_master import MeasuredMaster


def measured(
    position: float = 0.0,
    velocity: float = 0.0,
    acceleration: float = 0.0,
    *,
    smoothing_time: float = 0.02,
    delay: float = 0.0,
    sample_time: float = 0.0,
    period: float = 0.0,
) -> Master:
    """An initialized master in the mode MEASURED."""
    master = Master(
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        input_mode=MasterInput.MEASURED,
        smoothing_time=smoothing_time,
        delay=delay,
        sample_time=sample_time,
        period=period,
    )
    assert master.try_initialize()
    return master


def outputs(master: Master) -> list[float]:
    return [master.smoothed_position, master.smoothed_velocity, master.smoothed_acceleration]


def paths(master: Master, h: float, positions: Iterable[float]) -> list[list[float]]:
    """The outputs after each step of h seconds, for these measured positions."""
    rows = []
    for position in positions:
        master.position = position
        assert master.try_advance(h)
        rows.append(outputs(master))
    return rows


def distance(a: float, b: float, period: float) -> float:
    """On a circle, if there is a period."""
    away = abs(a - b)
    return min(away, period - away) if period else away


# --- against the oracle -----------------------------------------------------------------------------------------------


def lengths(r: Random) -> Callable[[], float]:
    """The lengths of steps: the same each time, one of a few, or any."""
    h = r.choice([1e-3, 4e-3, 1e-4, 0.02])
    return r.choice([lambda: h, lambda: r.choice([h, 2.0 * h, 0.5 * h]), lambda: h * r.uniform(0.3, 1.7)])


@pytest.mark.parametrize("seed", range(60))
def test_random_runs_agree_with_the_oracle(seed: int) -> None:
    """To 1e-9 up to 100 u: lines that speed up, stand and turn back, with noise, delay, sample times, turns."""
    r = Random(seed)
    step = lengths(r)
    tau = r.choice([0.02, 0.02, 0.01, 0.1, 0.005, 1.0])
    settings = {
        "smoothing_time": tau,
        "delay": r.choice([0.0, 0.0, 0.004, 0.03]),
        "sample_time": r.choice([0.0, 0.0, 0.002, 0.004, 0.05]),
        "period": r.choice([0.0, 0.0, 360.0, 77.7]),
    }
    line = [r.uniform(-1e2, 1e2), r.choice([0.0, r.uniform(-500, 500)]), r.choice([0.0, r.uniform(-1000, 1000)])]
    master, oracle = measured(*line, **settings), MeasuredMaster(*line, **settings)
    noise = r.choice([0.0, 0.02, 0.1])
    position, velocity, acceleration = line
    for _ in range(300):
        at_end = oracle.path
        size = max(1.0, abs(position) / 100.0)
        assert distance(master.smoothed_position, float(oracle.wrapped), settings["period"]) <= 1e-9 * size
        assert master.smoothed_velocity == pytest.approx(float(at_end.velocity), rel=1e-9, abs=1e-9 * 1e3)
        assert master.smoothed_acceleration == pytest.approx(
            float(at_end.acceleration), rel=1e-9, abs=1e-6 / min(tau, 0.1) ** 2 * 0.01 + 1e-6
        )
        h = step()
        if r.random() < 0.02:
            acceleration = r.choice([0.0, r.uniform(-2000, 2000)])
        if r.random() < 0.02:
            velocity = r.choice([0.0, -velocity])
        reading = position + noise * r.gauss(0.0, 1.0)
        master.position, master.velocity, master.acceleration = reading, velocity, acceleration
        assert master.try_advance(h)
        oracle.step(h, reading, velocity, acceleration)
        position += velocity * h + 0.5 * acceleration * h * h
        velocity += acceleration * h
        if r.random() < 0.05:
            master.rebase()


# --- known results ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("h", "smoothing_time", "delay", "sigmas"),
    [
        (1, 10, 0, (0.00751, 0.908, 234.3)),
        (1, 20, 0, (0.00531, 0.3193, 41.49)),
        (1, 40, 0, (0.00375, 0.1127, 7.336)),
        (1, 20, 4, (0.00576, 0.3506, 45.68)),
        (4, 20, 0, (0.01067, 0.6555, 82.34)),
    ],
)
def test_white_noise_of_002_mm_makes_this_noise_of_the_path(
    h: int, smoothing_time: int, delay: int, sigmas: tuple[float, ...]
) -> None:
    """One sigma of position, velocity, acceleration: by the response to a single wrong measurement, since the filter is
    linear. Of 40 smoothing times, after which nothing is left of it."""
    master = measured(smoothing_time=smoothing_time / 1e3, delay=delay / 1e3)
    response = paths(master, h / 1e3, [0.0, 0.02] + [0.0] * (40 * smoothing_time // h))
    for values, sigma in zip(zip(*response, strict=True), sigmas, strict=True):
        assert sqrt(sum(value * value for value in values)) == pytest.approx(sigma, rel=1e-3)
    assert response[-1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("smoothing_time", "h", "error"), [(10, 1.0, 0.197), (20, 5.0, 0.787), (40, 1.0, 3.15)])
def test_a_jump_of_the_acceleration_makes_this_error_until_it_is_forgotten(
    smoothing_time: int, h: float, error: float
) -> None:
    """By 1000 mm/s2, to 5 %; after 12 smoothing times 2 % of it are left."""
    step = h / 1e3
    steps = round(14 * smoothing_time / h)
    master = measured(smoothing_time=smoothing_time / 1e3)
    rows = paths(master, step, [500.0 * (n * step) ** 2 for n in range(steps)])
    errors = [abs(500.0 * ((n + 1) * step) ** 2 - row[0]) for n, row in enumerate(rows)]
    assert max(errors) == pytest.approx(error, rel=0.05)
    assert max(errors[round(12.5 * smoothing_time / h) :]) < 0.02 * error


@pytest.mark.parametrize("sample_time", [0.0, 0.004, 0.0017])
@pytest.mark.parametrize("delay", [0.0, 0.004, 1.0])
@pytest.mark.parametrize("smoothing_time", [0.0, 0.02, 10.0])
@pytest.mark.parametrize("h", [0.001, 0.01])
def test_a_line_of_constant_acceleration_that_says_so_at_the_start_is_the_ideal_line(
    h: float, smoothing_time: float, delay: float, sample_time: float
) -> None:
    start, velocity, acceleration = 5.0, 100.0, -80.0

    def at(t: float) -> list[float]:
        return [start + (velocity + 0.5 * acceleration * t) * t, velocity + acceleration * t, acceleration]

    # of a measurement, how it acts on the estimate's acceleration, and how that acts on the path's over the delay
    share = 1.0 - exp(-h / smoothing_time) if smoothing_time else 1.0
    rounding = 1e-12 * share**3 / h**2 * (1.0 + (delay * share / h) ** 2)
    master = measured(
        *at(-delay)[:2], acceleration, smoothing_time=smoothing_time, delay=delay, sample_time=sample_time
    )
    assert outputs(master) == pytest.approx(at(0.0), abs=1e-9)
    rows = paths(master, h, (at(n * h - delay)[0] for n in range(200)))
    for n, row in enumerate(rows):
        for value, ideal, error in zip(row, at((n + 1) * h), (h * h, h, 1.0), strict=True):
            assert value == pytest.approx(ideal, abs=max(1e-9, rounding * error))


@pytest.mark.parametrize("h", [0.004, 0.002, 0.001, 0.0005])
def test_with_a_sample_time_the_path_does_not_depend_on_the_step(h: float) -> None:
    """The oracle in steps of 4 ms; the other measurements are not even looked at."""
    r = Random(4)
    line = [100.0 * n * 0.004 + r.gauss(0.0, 0.1) for n in range(250)]
    oracle = MeasuredMaster(line[0], 100.0, sample_time=0.004)
    master = measured(line[0], 100.0, sample_time=0.004)
    for position in line:
        oracle.step(0.004, position, 100.0)
        paths(master, h, [position] + [nan_free(r) for _ in range(round(0.004 / h) - 1)])
        assert master.smoothed_position == pytest.approx(float(oracle.path.position), abs=1e-9)
        assert master.smoothed_velocity == pytest.approx(float(oracle.path.velocity), abs=1e-7)


def nan_free(r: Random) -> float:
    """Any position."""
    return r.uniform(-1e9, 1e9)


# --- what the path promises -------------------------------------------------------------------------------------------

numbers = st.floats(-1e3, 1e3)


@repeatable
@given(
    st.lists(st.tuples(st.floats(1e-4, 0.1), numbers), min_size=2, max_size=30),
    st.sampled_from([0.0, 0.005, 0.02, 1.0]),
    st.sampled_from([0.0, 0.004]),
    st.sampled_from([0.0, 0.002, 0.05]),
)
def test_position_and_velocity_of_the_path_never_jump(
    steps: list[tuple[float, float]], smoothing_time: float, delay: float, sample_time: float
) -> None:
    """Whatever is measured; and a step has a single section after the input correction, which is a point."""
    master = measured(steps[0][1], smoothing_time=smoothing_time, delay=delay, sample_time=sample_time)
    for h, position in steps:
        position_before, velocity_before = master.end, master.end_velocity
        master.position = position
        assert master.try_advance(h)
        assert master.begin == master.path.positions[0] == position_before
        assert master.begin_velocity == velocity_before
        assert master.end == master.path.positions[master.path.sections]


@repeatable
@given(
    st.floats(-1e12, 1e12),
    st.lists(st.tuples(st.floats(1e-9, 1e6), st.floats(-1e12, 1e12)), max_size=20),
    st.floats(0.0, 10.0),
    st.floats(0.0, 1.0),
    st.sampled_from([0.0, 1e-9, 1.0]),
)
def test_nothing_is_nan_or_infinite_and_a_refused_step_changes_nothing(
    start: float, steps: list[tuple[float, float]], smoothing_time: float, delay: float, sample_time: float
) -> None:
    master = measured(start, smoothing_time=smoothing_time, delay=delay, sample_time=sample_time, period=360.0)
    for h, position in steps:
        master.position = position
        before = deepcopy(master)
        if not master.try_advance(h):
            assert master == before
        assert all(-inf < value < inf for value in [*outputs(master), master.end, master.encoder.position])


@pytest.mark.parametrize("sample_time", [0.0, 0.005])
@pytest.mark.parametrize("delay", [0.0, 0.004, 0.05])
@pytest.mark.parametrize("smoothing_time", [0.005, 0.02, 0.1])
def test_a_path_goes_back_by_less_than_its_uncertain_travel(
    smoothing_time: float, delay: float, sample_time: float
) -> None:
    """By its overshoot after a sudden stop, by no more than half of that."""
    master = measured(-500.0 * delay, 500.0, smoothing_time=smoothing_time, delay=delay, sample_time=sample_time)
    rows = paths(master, 1e-3, (500.0 * min(n * 1e-3 - delay, 0.2) for n in range(800)))
    highest = max(row[0] for row in rows)
    assert highest > 100.0 + 100.0 * smoothing_time
    end = rows.index(max(rows))
    assert highest - min(row[0] for row in rows[end:]) < 0.53 * master.uncertain_travel()


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize(("smoothing_time", "delay"), [(0.02, 0.0), (0.02, 0.004), (0.1, 0.0), (0.0, 0.0)])
def test_noise_on_a_line_at_rest_moves_the_path_by_less_than_its_uncertain_travel(
    smoothing_time: float, delay: float, seed: int
) -> None:
    """From any time on, and after it has been watched for a while not by much."""
    r = Random(seed)
    master = measured(smoothing_time=smoothing_time, delay=delay)
    paths(master, 1e-3, (r.gauss(0.0, 0.05) for _ in range(500 + 10 * seed)))
    master.watch_travel()
    watched = master.begin
    for _ in range(1000):
        paths(master, 1e-3, [r.gauss(0.0, 0.05)])
        assert abs(master.end - watched) < master.uncertain_travel()
    if (smoothing_time, delay) == (0.02, 0.0):
        assert 0.1 < master.uncertain_travel() < 0.3


def test_the_travel_of_the_other_modes_is_certain() -> None:
    for mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY):
        master = Master(input_mode=mode, velocity=5.0)
        assert master.try_initialize()
        assert master.try_advance(0.5)
        master.watch_travel()
        assert master.uncertain_travel() == 0.0


@pytest.mark.parametrize("turns", [0, 3, -7])
def test_whole_turns_in_the_measurement_mean_nothing(turns: int) -> None:
    r = Random(turns)
    line = [0.5 * n + r.gauss(0.0, 0.01) for n in range(1000)]
    there = paths(measured(line[0], 500.0, period=360.0), 1e-3, line)
    around = paths(measured(line[0], 500.0, period=360.0), 1e-3, [x % 360.0 + turns * 360.0 for x in line])
    for a, b in zip(there, around, strict=True):
        assert distance(a[0], b[0], 360.0) < 1e-9
        assert a[1:] == pytest.approx(b[1:], abs=1e-5)


def test_a_running_line_that_does_not_say_so_at_the_start_is_caught_up_with() -> None:
    rows = paths(measured(), 1e-3, (0.5 * n for n in range(500)))
    assert max(abs(0.5 * (n + 1) - row[0]) for n, row in enumerate(rows)) > 5.0
    assert rows[-1][:2] == pytest.approx([250.0, 500.0], abs=1e-3)


def test_the_other_modes_show_what_they_predict() -> None:
    for mode in (MasterInput.START_OF_STEP, MasterInput.END_OF_STEP):
        master = Master(input_mode=mode, position=10.0, velocity=5.0, acceleration=2.0, smoothing_time=nan)
        assert master.try_initialize()
        assert outputs(master) == [10.0, 5.0, 2.0]
        assert master.try_advance(0.5)
        assert outputs(master) == [master.end, master.end_velocity, master.end_acceleration]
    assert outputs(master) == [10.0, 5.0, 2.0]


def travelled(master: Master) -> float:
    """How far the master goes, back and forth, in the step whose path is set."""
    path = master.path.positions[: master.path.sections + 1]
    return sum(abs(b - a) for a, b in pairwise(path))


@pytest.mark.parametrize("mode", MasterInput)
def test_a_step_is_refused_in_which_the_master_might_travel_more_than_the_block_allows(mode: MasterInput) -> None:
    """Whatever is allowed: an accepted step travels no more, and a refused one has changed nothing."""
    r = Random(int(mode))
    master = Master(input_mode=mode, smoothing_time=0.02, delay=0.004)
    assert master.try_initialize()
    met = set()
    for _ in range(500):
        master.position, master.velocity, master.acceleration = (r.uniform(-10.0, 10.0) for _ in range(3))
        h = r.choice([1e-3, 0.1])
        longest = r.choice([0.1, 3.0, 10.0])
        before = deepcopy(master)
        refusal = master.try_advance_within(h, longest)
        met.add(refusal)
        if refusal == PathRefusal.NONE:
            assert travelled(master) <= longest * (1.0 + 1e-9) + 1e-9
        else:
            assert master == before
            assert master.try_advance(h)
    assert met == {PathRefusal.NONE, PathRefusal.TRAVEL}


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(
    ("mode", "travel"),
    [
        (MasterInput.START_OF_STEP, 2.25),
        (MasterInput.END_OF_STEP, 2.0),
        (MasterInput.MEASURED, 2.25),
    ],
)
def test_the_longest_travel_is_counted_with_the_signs_of_a_master_that_gets_faster(
    mode: MasterInput, travel: float, direction: float
) -> None:
    """In the first step of 0.5 s from position 0 at 4 u/s and 2 u/s2: 4 * 0.5 + 2 * 0.25 / 2 = 2.25. At END_OF_STEP the
    position given for its end counts, and both velocities for the way back and forth: 0 + (4 + 0) * 0.5 = 2."""
    master = Master(input_mode=mode, velocity=4.0 * direction, acceleration=2.0 * direction, smoothing_time=0.02)
    assert master.try_initialize()
    if mode == MasterInput.END_OF_STEP:
        master.velocity = master.acceleration = 0.0
    assert master.try_advance_within(0.5, travel * (1.0 - 1e-9)) == PathRefusal.TRAVEL
    assert master.try_advance_within(0.5, travel * (1.0 + 1e-9)) == PathRefusal.NONE


@pytest.mark.parametrize("mode", [MasterInput.START_OF_STEP, MasterInput.POSITION_ONLY])
def test_the_input_correction_counts_as_travel(mode: MasterInput) -> None:
    """From rest at 3, where the position before was, to the given position 5: 2 u. MEASURED has no correction."""
    master = Master(input_mode=mode, position=3.0)
    assert master.try_initialize()
    assert master.try_advance(1.0)
    master.position = 5.0
    if mode == MasterInput.POSITION_ONLY:  # an estimated 2 u/s for another second
        assert master.try_advance_within(1.0, 3.999) == PathRefusal.TRAVEL
        assert master.try_advance_within(1.0, 4.001) == PathRefusal.NONE
    else:
        assert master.try_advance_within(1.0, 1.999) == PathRefusal.TRAVEL
        assert master.try_advance_within(1.0, 2.001) == PathRefusal.NONE
    assert travelled(master) > 1.999
