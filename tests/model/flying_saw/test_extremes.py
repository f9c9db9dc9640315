"""The extremes of synchronisation profiles against exact fractions: values, places, peaks and integrals."""

from collections.abc import Iterator
from itertools import pairwise
from math import sqrt

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from motionsync.flying_saw.extremes import Extremes
from motionsync.flying_saw.profile import Profile, ProfileKind
from tests.model.flying_saw.fake_blocks import ProfileMeasurer
from tests.oracle.numerics.mp import Ratio, mpq
from tests.oracle.numerics.roots import Exact, at, derivative, roots_inside
from tests.support.blocks.drawn import drawn
from tests.support.compiler.compiled import Compiled, equal

repeatable = drawn()

EPS = mpq(1, 2**52)
EQUAL = mpq(1, 10**12)
QUANTITIES = ("position", "velocity", "acceleration", "jerk")
RESULTS = [name for name in Extremes.__slots__ if isinstance(getattr(Extremes(), name), float)]

Pieces = list[tuple[float, list[float]]]  # durations and coefficients


def profile(origin: float, pieces: Pieces) -> Profile:
    made = Profile()
    made.start(ProfileKind.P5, origin)
    for duration, coefficients in pieces:
        made.add_segment(duration, *[*coefficients, 0.0, 0.0, 0.0, 0.0, 0.0][:6])
    return made


def measured(of: Profile) -> Extremes:
    made = Extremes()
    made.measure(of)
    made.integrate(of)
    return made


# --- profiles ---


def quintic(
    duration: float,
    distance: float,
    velocity: float,
    end_velocity: float,
    acceleration: float = 0.0,
    start: float = 0.0,
) -> tuple[float, list[float]]:
    """Acceleration-free at its end."""
    c1, c2 = velocity * duration, 0.5 * acceleration * duration * duration
    a, b = distance - c1 - c2, end_velocity * duration - c1 - 2.0 * c2
    return duration, [start, c1, c2, 10.0 * a - 4.0 * b + c2, -15.0 * a + 7.0 * b - 2.0 * c2, 6.0 * a - 3.0 * b + c2]


def ramp(duration: float, velocity: float, end_velocity: float, start: float = 0.0) -> tuple[float, list[float]]:
    """v0 + (v1 - v0) (3 u^2 - 2 u^3)."""
    change = (end_velocity - velocity) * duration
    return duration, [start, velocity * duration, 0.0, change, -0.5 * change]


def straight(duration: float, velocity: float, start: float = 0.0) -> tuple[float, list[float]]:
    return duration, [start, velocity * duration]


def joined(parts: Pieces) -> Pieces:
    """Each starts where the one before ends."""
    start = 0.0
    pieces = []
    for duration, coefficients in parts:
        pieces.append((duration, [start, *coefficients[1:]]))
        start = sum(pieces[-1][1])
    return pieces


def no_less(x: float) -> float:
    """0 for what makes products leave a double's range."""
    return x if abs(x) > 1e-9 else 0.0


durations = st.builds(lambda mantissa, power: mantissa * 10.0**power, st.floats(1.0, 9.0), st.integers(-9, 1))
velocities = st.floats(-1000.0, 1000.0).map(no_less) | st.sampled_from([0.0, 250.0, 500.0])
origins = st.floats(-1e4, 1e4) | st.sampled_from([0.0, 1e8])
numbers = st.floats(-100.0, 100.0).map(no_less) | st.integers(-5, 5).map(float) | st.just(1e-13)

quintics = st.builds(
    lambda *given: [quintic(*given)],
    st.floats(0.01, 100.0),
    st.floats(-1e4, 1e4).map(no_less),
    velocities,
    velocities,
    st.floats(-100.0, 100.0).map(no_less) | st.just(0.0),
)
ramps = st.builds(
    lambda t, first, v, c, end: joined([ramp(t, v, c), straight(first, c), ramp(first, c, end)]),
    durations,
    durations,
    velocities,
    velocities,
    velocities,
)
anything = st.lists(st.tuples(durations, st.lists(numbers, min_size=2, max_size=6)), min_size=1, max_size=4)
profiles = st.builds(profile, origins, quintics | ramps | anything)


# --- the oracle ---


def pieces(of: Profile) -> Iterator[tuple[Ratio, Ratio, Exact]]:
    """Begin, duration and the absolute position of each."""
    for i in range(of.segments):
        f = [mpq(c) for c in of.coefficients[6 * i : 6 * i + 6]]
        yield mpq(of.start_times[i]), mpq(of.durations[i]), [f[0] + mpq(of.origin), *f[1:]]


def candidates(of: Profile, order: int) -> Iterator[tuple[Ratio, Ratio, Ratio]]:
    """Where the derivative of that order may be extreme: time, value, the velocity there."""
    for begin, d, f in pieces(of):
        for u in [mpq(0), *roots_inside(derivative(f, order + 1)), mpq(1)]:
            yield begin + u * d, at(derivative(f, order), u) / d**order, at(derivative(f), u) / d


def rounding(of: Profile, order: int) -> Ratio:
    """Of the values of that derivative: a few of all its terms together."""
    terms = (sum(abs(c) for c in derivative(f, order)) / d**order for _, d, f in pieces(of))
    return 8 * EPS * max(terms, key=abs) + (4 * EPS * abs(mpq(of.origin)) if order == 0 else 0)


def integral(f: Exact) -> Ratio:
    return sum((c / (n + 1) for n, c in enumerate(f)), mpq(0))


def product(a: Exact, b: Exact) -> Exact:
    result = [mpq(0)] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for k, y in enumerate(b):
            result[i + k] += x * y
    return result


# --- values and places ---


@repeatable
@given(profiles)
@example(profile(-250.0, [quintic(3.0, 1250.0, 250.0, 500.0)]))
@example(profile(0.0, [quintic(3.0, 1500.0, 500.0, 500.0)]))
@example(profile(1e8, joined([straight(1e-9, 500.0), ramp(1.0, 500.0, 0.0)])))
def test_the_extremes_are_those_of_exact_arithmetic(of: Profile) -> None:
    result = measured(of)
    for order, name in enumerate(QUANTITIES):
        near = rounding(of, order)
        values = [value for _, value, _ in candidates(of, order)]
        assert abs(mpq(getattr(result, f"{name}_min")) - min(values)) <= near, name
        assert abs(mpq(getattr(result, f"{name}_max")) - max(values)) <= near, name


@repeatable
@given(profiles)
@example(profile(0.0, joined([straight(1.0, 250.0), ramp(2.0, 250.0, 500.0)])))
@example(profile(0.0, [ramp(2.0, 500.0, 0.0)]))
@example(profile(0.0, [quintic(1.0, 2184.7221560704093, 0.0, 0.0)]))
def test_the_place_of_an_extremum_is_the_first_where_it_is_attained(of: Profile) -> None:
    result = measured(of)
    for order, name in enumerate(QUANTITIES[:3]):
        everywhere = list(candidates(of, order))
        size = max(abs(value) for _, value, _ in everywhere)
        near = rounding(of, order)
        for which, sign in (("min", -1), ("max", 1)):
            best = max(sign * value for _, value, _ in everywhere)
            time = mpq(getattr(result, f"{name}_{which}_time"))
            there = max(sign * value for value in values_at(of, time, order))
            assert there >= best - EQUAL * size - near - drift(of, time, order), (name, which)
            late = mpq(of.duration()) / 10**7  # a double root is known to the square root of rounding
            before = [sign * value for t, value, _ in everywhere if t < time - late]
            assert not before or max(before) <= best - EQUAL * size + near, (name, which)


def values_at(of: Profile, time: Ratio, order: int) -> Iterator[Ratio]:
    """On either side of a joint."""
    late = 4 * EPS * mpq(of.duration())
    for begin, d, f in pieces(of):
        if begin - late <= time <= begin + d + late:
            yield at(derivative(f, order), (min(max(time, begin), begin + d) - begin) / d) / d**order


def drift(of: Profile, time: Ratio, order: int) -> Ratio:
    """What the rounding of a time changes."""
    return (
        4 * EPS * time * max(sum(abs(c) for c in derivative(f, order + 1)) / d ** (order + 1) for _, d, f in pieces(of))
    )


@repeatable
@given(profiles)
def test_the_velocity_at_an_extreme_acceleration_is_that_of_its_place(of: Profile) -> None:
    result = measured(of)
    late = 4 * EPS * mpq(of.duration())
    for time, velocity in [
        (result.acceleration_min_time, result.velocity_at_acceleration_min),
        (result.acceleration_max_time, result.velocity_at_acceleration_max),
    ]:
        near = rounding(of, 1) + drift(of, mpq(time), 1)
        places = [v for t, _, v in candidates(of, 2) if abs(t - mpq(time)) <= late] + [*values_at(of, mpq(time), 1)]
        assert min(abs(mpq(velocity) - v) for v in places) <= near


@repeatable
@given(profiles)
def test_no_sample_exceeds_the_extremes(of: Profile) -> None:
    result = measured(of)
    for order, name in enumerate(QUANTITIES):
        low = mpq(getattr(result, f"{name}_min")) - rounding(of, order)
        high = mpq(getattr(result, f"{name}_max")) + rounding(of, order)
        for _, d, f in pieces(of):
            slope = derivative(f, order)
            assert all(low <= at(slope, mpq(n, 64)) / d**order <= high for n in range(65)), name


# --- peaks and integrals ---


@repeatable
@given(profiles)
@example(profile(0.0, [quintic(3.0, 1000.0, -250.0, 750.0)]))
@example(profile(0.0, [quintic(1.0, 1.0, 0.0, 5.0, 100.0)]))
@example(profile(0.0, [ramp(1.0, 500.0, -500.0)]))
def test_peaks_are_the_greatest_magnitudes_where_speed_rises_and_falls(of: Profile) -> None:
    """An interval in which v or a is 0 but for rounding may count or not."""
    result = measured(of)
    certain = {True: mpq(0), False: mpq(0)}
    possible = dict(certain)
    for _, d, f in pieces(of):
        v, a = derivative(f), derivative(f, 2)
        small = [10**-12 * sum(abs(c) for c in g) for g in (v, a)]
        cuts = sorted({mpq(0), mpq(1), *roots_inside(v), *roots_inside(a), *roots_inside(derivative(a))})
        for low, high in pairwise(cuts):
            middle = (low + high) / 2
            speeding = at(v, middle) * at(a, middle) > 0
            peak = max(abs(at(a, low)), abs(at(a, high)))
            possible[speeding] = max(possible[speeding], peak / d**2)
            if max(abs(at(v, low)), abs(at(v, high))) > small[0] and peak > small[1]:
                certain[speeding] = max(certain[speeding], peak / d**2)
    for peak, speeding in [(mpq(result.acceleration_peak), True), (mpq(result.deceleration_peak), False)]:
        assert certain[speeding] - rounding(of, 2) <= peak <= possible[speeding] + rounding(of, 2)


@repeatable
@given(profiles)
def test_momentum_mean_and_effective_value_are_those_of_exact_arithmetic(of: Profile) -> None:
    result = measured(of)
    momenta = []
    distance = power = mpq(0)
    for _, d, f in pieces(of):
        v, a = derivative(f), derivative(f, 2)
        momentum = product(v, a)
        momenta += [at(momentum, u) / d**3 for u in [mpq(0), *roots_inside(derivative(momentum)), mpq(1)]]
        turns = [mpq(0), *roots_inside(v), mpq(1)]
        distance += sum(abs(at(f, high) - at(f, low)) for low, high in pairwise(turns))
        power += integral(product(a, a)) / d**3
    near = rounding(of, 1) * rounding(of, 2) / EPS / 4
    assert abs(mpq(result.momentum_min) - min(momenta)) <= near
    assert abs(mpq(result.momentum_max) - max(momenta)) <= near
    assert result.velocity_mean == pytest.approx(float(distance / mpq(of.duration())), abs=2 * float(rounding(of, 1)))
    effective = sqrt(power / mpq(of.duration()))
    assert result.acceleration_effective == pytest.approx(effective, rel=1e-13, abs=2 * float(rounding(of, 2)))


# --- what is known ---


def test_the_first_example_of_the_source() -> None:
    """Master 500, from -500 to 1000; slave 250, from -250 to 1000."""
    result = measured(profile(-250.0, [quintic(3.0, 1250.0, 250.0, 500.0)]))
    assert (result.position_min, result.position_min_time) == (-250.0, 0.0)
    assert (result.position_max, result.position_max_time) == (pytest.approx(1000.0, rel=1e-15), 3.0)
    assert (result.velocity_min, result.velocity_min_time) == (250.0, 0.0)
    assert (result.velocity_max, result.velocity_max_time) == (pytest.approx(506.0), pytest.approx(2.4))
    assert [result.acceleration_min, result.acceleration_max] == pytest.approx([-15.04601, 175.04601], abs=5e-6)
    assert [result.jerk_min, result.jerk_max] == pytest.approx([-1400 / 9, 4000 / 9], rel=1e-14)
    assert [result.acceleration_peak, result.deceleration_peak] == [result.acceleration_max, -result.acceleration_min]
    assert result.velocity_mean == pytest.approx(1250 / 3)


def test_the_second_example_of_the_source() -> None:
    """Master 500, from -500 to 1000; slave -250, from -500 to 500, factor 1.5. First it brakes, then it speeds up."""
    result = measured(profile(-500.0, [quintic(3.0, 1000.0, -250.0, 750.0)]))
    assert [result.velocity_min, result.velocity_max] == pytest.approx([-250.0, 750.0])
    assert [result.acceleration_min, result.acceleration_max] == pytest.approx([0.0, 568.755], abs=5e-4)
    assert [result.jerk_min, result.jerk_max] == pytest.approx([-3700 / 9, 11000 / 9])
    assert result.position_min == pytest.approx(-620.638, abs=5e-4)
    assert result.acceleration_peak == result.acceleration_max
    assert 0.0 < result.deceleration_peak < result.acceleration_peak
    assert result.velocity_mean > 1000.0 / 3.0


def test_a_ramp_then_constant_velocity() -> None:
    result = measured(profile(-250.0, joined([ramp(2.0, 250.0, 500.0), straight(1.0, 500.0)])))
    assert (result.velocity_max, result.velocity_max_time) == (500.0, 2.0)
    assert (result.acceleration_max, result.acceleration_max_time) == (pytest.approx(187.5), pytest.approx(1.0))
    assert (result.acceleration_min, result.acceleration_min_time) == (pytest.approx(0.0, abs=1e-12), 0.0)
    assert (result.velocity_at_acceleration_max, result.velocity_at_acceleration_min) == (375.0, 250.0)
    assert [result.jerk_min, result.jerk_max] == pytest.approx([-375.0, 375.0])
    assert (result.acceleration_peak, result.deceleration_peak) == (pytest.approx(187.5), 0.0)
    assert result.acceleration_effective == pytest.approx(sqrt(250.0**2 * 36 / 30 / 2 / 3))


@pytest.mark.parametrize("speed", [500.0, -500.0, 0.1, 1e-7])
@pytest.mark.parametrize("duration", [1.0, 0.3, 7.7])
def test_a_ramp_to_rest_is_all_deceleration_and_ends_at_its_end(speed: float, duration: float) -> None:
    """Its end is a double root of the velocity and one of the acceleration, but for rounding."""
    result = measured(profile(0.0, [ramp(duration, speed, 0.0)]))
    assert result.acceleration_peak == 0.0
    assert result.deceleration_peak == pytest.approx(1.5 * abs(speed) / duration)
    assert (result.position_max_time if speed > 0.0 else result.position_min_time) == duration
    assert (result.velocity_min_time if speed > 0.0 else result.velocity_max_time) == duration
    assert result.velocity_mean == pytest.approx(0.5 * abs(speed))


@repeatable
@given(st.floats(0.01, 100.0), st.floats(1.0, 1000.0), st.floats(0.0, 1.0))
def test_a_p5_without_overshoot_only_decelerates(duration: float, velocity: float, share: float) -> None:
    """The middle third of the ways: the velocity falls all the time, its end is 0 but for rounding."""
    assume(share < 0.99)
    end = share * velocity
    distance = (0.5 * velocity + 0.5 * end) * duration
    result = measured(profile(0.0, [quintic(duration, distance, velocity, end)]))
    assert result.acceleration_peak <= 1e-12 * velocity / duration
    assert result.velocity_min == pytest.approx(end, abs=1e-12 * velocity)


def test_at_a_root_of_the_velocity_both_sides_count() -> None:
    """Constant acceleration through rest: the speed falls, then rises."""
    result = measured(profile(0.0, [(2.0, [0.0, -20.0, 20.0])]))
    assert (result.velocity_min, result.velocity_max) == (-10.0, 10.0)
    assert (result.acceleration_peak, result.deceleration_peak) == (10.0, 10.0)
    assert (result.position_min, result.position_min_time) == (-5.0, 1.0)
    assert result.velocity_mean == 5.0
    assert (result.momentum_min, result.momentum_max) == (-100.0, 100.0)


@pytest.mark.parametrize(("velocity", "peaks"), [(0.0, (10.0, 0.0)), (-20.0, (0.0, 10.0))])
def test_rest_at_an_end_belongs_to_the_side_inside(velocity: float, peaks: tuple[float, float]) -> None:
    result = measured(profile(0.0, [(2.0, [0.0, 2.0 * velocity, 20.0])]))
    assert (result.acceleration_peak, result.deceleration_peak) == peaks


def test_at_a_joint_the_accelerations_and_jerks_of_both_sides_count() -> None:
    """Without jerk at +10, then at -10."""
    result = measured(profile(0.0, joined([(1.0, [0.0, 11.0, 5.0]), (1.0, [0.0, 21.0, -5.0, -1.0])])))
    assert (result.acceleration_max, result.acceleration_min) == (10.0, -16.0)
    assert (result.acceleration_peak, result.deceleration_peak) == (10.0, 16.0)
    assert (result.jerk_min, result.jerk_max) == (-6.0, 0.0)
    assert (result.velocity_max, result.velocity_max_time) == (21.0, 1.0)


def test_a_piece_a_thousand_million_times_shorter_has_its_own_extremes() -> None:
    """1e-9 s with a jerk of 1e12 up and down between straight pieces of 1 s: the acceleration peaks inside it."""
    pulse = (1e-9, [0.0, 1e-9, 0.0, 1e12 * 1e-27 / 6.0, -1e12 * 1e-27 / 12.0])
    result = measured(profile(0.0, joined([straight(1.0, 1.0), pulse, straight(1.0, 1.0)])))
    assert result.acceleration_max == pytest.approx(0.25 * 1e3)
    assert result.acceleration_max_time == pytest.approx(1.0 + 0.5e-9, abs=1e-15)
    assert [result.jerk_min, result.jerk_max] == pytest.approx([-1e12, 1e12])


# --- mirrored and compiled ---


@repeatable
@given(profiles)
def test_a_mirrored_profile_has_the_mirrored_extremes_bit_for_bit(of: Profile) -> None:
    mirrored = measured(profile(-of.origin, [(of.durations[i], negated(of, i)) for i in range(of.segments)]))
    result = measured(of)
    for name in RESULTS:
        value = getattr(mirrored, name)
        if name.startswith(QUANTITIES) and not name.startswith(("velocity_mean", "acceleration_effective")):
            other = name.replace("min", "MAX").replace("max", "min").replace("MAX", "max")
            opposite = value if name.endswith("_time") or name.endswith("_peak") else -value
            assert opposite == getattr(result, other), name
        else:
            assert value == getattr(result, name), name


def negated(of: Profile, i: int) -> list[float]:
    return [-c for c in of.coefficients[6 * i : 6 * i + 6]]


@pytest.mark.slow
@drawn(300)
@given(profiles)
def test_compiled_code_gives_the_bits_of_python(of: Profile) -> None:
    block = ProfileMeasurer(profile=of)
    compiled = Compiled(block)
    assert compiled.initialize() == block.initialize()
    assert compiled.step(0.0) == block.step(0.0)
    assert equal(block, compiled)
