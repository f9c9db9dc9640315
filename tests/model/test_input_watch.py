"""What the master reports of its inputs: counts, jumps, a velocity or a position that is nonsense. Of a line that is
exact, or measured and smoothed, it reports nothing."""

import math
from collections.abc import Iterable, Sequence
from copy import deepcopy
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.input_watch import InputWarning
from motionsync.master import Master, MasterInput
from tests.oracle.input_watch import Reported, Sample, reported
from tests.support.blocks.drawn import drawn

START, END, ONLY, MEASURED = MasterInput
EXACT = [START, END, ONLY]
WITH_VELOCITY = [START, END]
COUNTS, JUMP, VELOCITY, FROZEN = (
    InputWarning.COUNTS,
    InputWarning.JUMP,
    InputWarning.VELOCITY,
    InputWarning.FROZEN,
)
H = 1e-3


class Watched:
    """A master that gets samples, each a step after the one before, and what it has reported after each."""

    def __init__(self, mode: MasterInput, **values: Any) -> None:
        self.master = Master(input_mode=mode, **values)
        assert self.master.try_initialize()
        self.reported: list[Reported] = []

    def give(self, position: float, velocity: float = 0.0, acceleration: float = 0.0, h: float = H) -> None:
        """One sample; h: the time to the next one, at END_OF_STEP since the last one."""
        it = self.master
        it.position, it.velocity, it.acceleration = position, velocity, acceleration
        assert it.try_advance(h)
        it.rebase()
        self.reported.append(Reported(it.input_warning, it.likely_period, it.velocity_ratio))

    def run(self, samples: Iterable[Sequence[float]], h: float = H) -> "Watched":
        for values in samples:
            self.give(*values, h=h)
        return self

    @property
    def codes(self) -> list[int]:
        return [each.code for each in self.reported]


def line(velocity: float, count: int, *, first: int = 0, h: float = H, ratio: float = 1.0) -> list[tuple[float, float]]:
    """Samples of a line of constant velocity, and a multiple of this velocity."""
    return [(velocity * h * n, velocity * ratio) for n in range(first, first + count)]


def wrapping(velocity: float, period: float, count: int, at: int) -> list[tuple[float, float]]:
    """A line of constant velocity, whose counter wraps from sample `at` - 1 to sample `at`, the first one being 0."""
    offset = period - velocity * H * (at - 0.5)
    return [((velocity * H * n + offset) % period, velocity) for n in range(count)]


# --- counts ---


@pytest.mark.parametrize("mode", EXACT)
@pytest.mark.parametrize(
    ("velocity", "resolution", "period"),
    [(333.3, 0.1, 0.0), (-90.7, 0.1, 0.0), (333.3, 0.001, 0.0), (333.3, 0.1, 360.0), (170.0, 1.0, 0.0)],
)
def test_counts_of_an_encoder_are_reported(
    mode: MasterInput, velocity: float, resolution: float, period: float
) -> None:
    """Even if its velocity is known."""
    counted = [math.floor(velocity * n * H / resolution) * resolution for n in range(4000)]
    samples = [(x % period if period else x, velocity) for x in counted]
    codes = Watched(mode, period=period).run(samples).codes
    assert set(codes) == {0, COUNTS}
    assert codes == sorted(codes)


def test_counts_that_are_smoothed_are_not_reported() -> None:
    assert not any(Watched(MEASURED).run([(math.floor(3.333 * n) * 0.1,) for n in range(4000)]).codes)


# --- jumps ---


@pytest.mark.parametrize("mode", list(MasterInput))
@pytest.mark.parametrize(("velocity", "period"), [(120.0, 360.0), (-750.0, 65536 * 0.02), (90.0, 40.0)])
def test_a_counter_that_wraps_is_reported_with_its_period(mode: MasterInput, velocity: float, period: float) -> None:
    """Sample 40 is the first one after the wrap, and only sample 41 shows that the line goes on as before."""
    it = Watched(mode).run(wrapping(velocity, period, 60, at=40))
    assert it.codes == [0] * 41 + [JUMP] * 19
    assert [each.likely_period for each in it.reported[40:42]] == [0.0, pytest.approx(period, rel=1e-12)]


@pytest.mark.parametrize("mode", list(MasterInput))
def test_a_line_with_its_period_does_not_jump(mode: MasterInput) -> None:
    assert not any(Watched(mode, period=360.0).run(wrapping(250.0, 360.0, 4000, at=40)).codes)


def test_the_thirtieth_sample_is_the_first_that_can_be_a_jump() -> None:
    """At 10 u/s a step is 0.01: the step of 7 goes from sample 28 to sample 29, counted from 0, or one earlier."""
    for at, code in ((28, 0), (29, JUMP)):
        samples = [(0.01 * n + 7.0 * (n >= at), 10.0) for n in range(40)]
        assert Watched(START).run(samples).codes[-1] == code


@pytest.mark.parametrize(
    ("jump", "after", "code"),
    [
        (0.49, 0.05, 0),  # 9.8 times the greatest change so far
        (0.51, 0.05, JUMP),
        (-0.51, 0.05, JUMP),
        (0.80, 0.07, JUMP),  # the next change is less than a tenth
        (0.80, 0.09, 0),
        (0.80, -0.8, 0),  # a spike is no jump
    ],
)
@pytest.mark.parametrize("mode", [ONLY, MEASURED])
def test_a_jump_is_ten_times_the_greatest_change_and_then_a_tenth(
    mode: MasterInput, jump: float, after: float, code: int
) -> None:
    changes = [*[0.05] * 40, jump, after, *[0.05] * 5]
    it = Watched(mode).run([(sum(changes[:n]),) for n in range(len(changes))])
    assert it.codes[-1] == code
    if code:
        assert it.reported[-1].likely_period == pytest.approx(abs(jump - 0.05))


@pytest.mark.parametrize(("velocity", "acceleration", "code"), [(0.0, 0.0, JUMP), (90.0, 0.0, 0), (0.0, 2e5, 0)])
def test_what_velocity_and_acceleration_allow_is_no_jump(velocity: float, acceleration: float, code: int) -> None:
    """From 0.01 a step to 0.6 in one: 10 h v = 0.9, or 10 h^2/2 a = 1.0, at either end of the step allows that."""
    for at in (39, 40):
        changes = [*[0.01] * 39, 0.6, *[0.01] * 5]
        samples = [
            (sum(changes[:n]), velocity if n == at else 10.0, acceleration if n == at else 0.0)
            for n in range(len(changes))
        ]
        assert Watched(START).run(samples).codes[-1] == code


def test_a_jump_does_not_hide_the_next_one() -> None:
    samples = [(0.5 * n + 300.0 * (n >= 50) - 20.0 * (n >= 70), 500.0) for n in range(80)]
    it = Watched(END).run(samples)
    assert [each.likely_period for each in (it.reported[51], it.reported[71])] == pytest.approx([300.0, 20.0])


def test_a_line_that_has_never_moved_does_not_jump() -> None:
    """Nothing is known of it: its position may have been set anew."""
    assert not any(Watched(ONLY).run([(500.0 * (n >= 40),) for n in range(60)]).codes)


# --- velocities ---


@pytest.mark.parametrize("mode", WITH_VELOCITY)
@pytest.mark.parametrize("ratio", [1000.0, 1e-3, 60.0, 1.0 / 60.0, -1.0, 0.0, 25.4, 2.01, 0.49])
@pytest.mark.parametrize("velocity", [333.3, -0.07])
def test_a_velocity_in_another_unit_is_reported_with_the_ratio(
    mode: MasterInput, ratio: float, velocity: float
) -> None:
    """30 changes need 31 samples."""
    it = Watched(mode).run(line(velocity, 60, ratio=ratio))
    assert it.codes == [0] * 30 + [VELOCITY] * 30
    assert it.reported[-1].velocity_ratio == pytest.approx(ratio, rel=1e-9)


@pytest.mark.parametrize("mode", [ONLY, MEASURED])
def test_a_velocity_that_is_not_used_is_not_compared(mode: MasterInput) -> None:
    assert not any(Watched(mode).run(line(333.3, 100, ratio=60.0)).codes)


@pytest.mark.parametrize("mode", WITH_VELOCITY)
@pytest.mark.parametrize("ratio", [1.99, 0.51])
def test_up_to_twice_or_half_is_no_contradiction(mode: MasterInput, ratio: float) -> None:
    assert not any(Watched(mode).run(line(100.0, 100, ratio=ratio)).codes)


def test_the_row_begins_anew_where_the_line_turns_or_rests() -> None:
    """Its velocity is 60 times too great throughout: 29 samples forwards, 29 back or at rest, 31 forwards."""
    for between in (-1.0, 0.0):
        changes = [*[0.1] * 29, *[0.1 * between] * 29, *[0.1] * 31]
        samples = [(sum(changes[:n]), 6000.0 * math.copysign(1.0, between)) for n in range(len(changes) + 1)]
        codes = Watched(END).run(samples).codes
        assert codes.index(VELOCITY) == 29 + 29 + 30


def test_the_ratio_is_that_of_the_whole_row() -> None:
    """30 changes of 0.1 at 1000 u/s, then 30 of 0.2 at 800 u/s, the first of which has 900 u/s in the mean."""
    samples = [*[(0.1 * n, 1000.0) for n in range(31)], *[(3.0 + 0.2 * n, 800.0) for n in range(1, 31)]]
    ratio = Watched(START).run(samples).reported[-1].velocity_ratio
    assert ratio == pytest.approx((30.0 + 0.9 + 29 * 0.8) / 9.0, rel=1e-12)


# --- a position that stays ---


@pytest.mark.parametrize("mode", WITH_VELOCITY)
def test_an_encoder_that_breaks_is_reported_after_a_hundred_changes(mode: MasterInput) -> None:
    """At 400 u/s a change is 0.4; it breaks at sample 50. A way of more than 40 takes 101 samples."""
    samples = [(0.4 * min(n, 50), 400.0) for n in range(200)]
    assert Watched(mode).run(samples).codes == [0] * 151 + [FROZEN] * 49


@pytest.mark.parametrize("mode", WITH_VELOCITY)
def test_position_and_velocity_swapped_are_reported_after_thirty_samples(mode: MasterInput) -> None:
    it = Watched(mode).run([(700.0, 0.7 * n) for n in range(60)])
    assert it.codes == [0] * 30 + [FROZEN] * 30


def test_a_line_at_rest_may_stay_as_long_as_it_likes() -> None:
    """And it may start suddenly: at the sample at which it has its velocity, it has not moved yet."""
    samples = [*[(900.0, 0.0)] * 500, *[(900.0 + 0.25 * n, 250.0) for n in range(100)]]
    for mode in WITH_VELOCITY:
        assert not any(Watched(mode).run(samples).codes)


def test_a_line_that_creeps_in_single_precision_does_not_stay() -> None:
    """At 1e5 u a single has steps of 1/128; at 0.01 u/s it stays for 0.78 s."""
    first = 1e5 + 1.0 / 128.0
    creeping = [(math.floor((1e5 + 1e-5 * n) * 128.0) / 128.0, 0.01) for n in range(5000)]
    assert max(position for position, _ in creeping) > first
    assert not any(Watched(START).run(creeping).codes)


# --- episodes ---


def test_an_episode_ends_ten_seconds_after_its_last_finding() -> None:
    """Steps of 0.1 s at 30 u/s: jumps by 700 at samples 40 and 100, which samples 41 and 101 show."""
    samples = [(3.0 * n + 700.0 * ((n >= 40) + (n >= 100)), 30.0) for n in range(300)]
    codes = Watched(START).run(samples, h=0.1).codes
    assert codes == [0] * 41 + [JUMP] * (101 - 41 + 100) + [0] * (300 - 201)


def test_two_faults_that_come_in_turns_are_shown_once_each_in_an_episode() -> None:
    """A velocity without its sign, and a counter that wraps each 60 samples: each wrap interrupts the row."""
    samples = [((0.3 * n) % 18.0, -300.0) for n in range(1000)]
    codes = Watched(START).run(samples).codes
    assert [code for n, code in enumerate(codes) if n and code != codes[n - 1]] == [VELOCITY, JUMP]


def test_counts_are_shown_again_after_an_episode() -> None:
    """A counter of 0.1 u at 3.33 counts a step of 0.05 s, which jumps once."""
    samples = [(math.floor(3.33 * n) * 0.1 + 500.0 * (n >= 200), 6.66) for n in range(600)]
    codes = Watched(END).run(samples, h=0.05).codes
    assert [code for n, code in enumerate(codes) if n and code != codes[n - 1]] == [COUNTS, JUMP, 0, COUNTS]


def test_a_saved_state_goes_on_as_the_original() -> None:
    """Amid a row, with a jump that the next sample decides, and in an episode."""
    samples = [((0.3 * n) % 18.0, -300.0) for n in range(200)]
    whole = Watched(START).run(samples)
    for n in (20, 61, 95):
        part = Watched(START).run(samples[:n])
        part.master = deepcopy(part.master)
        assert part.run(samples[n:]).reported == whole.reported
        assert part.master == whole.master


def test_a_refused_step_is_no_sample() -> None:
    it = Watched(START, period=1.0).run(line(0.2, 20, ratio=-1.0))
    before = deepcopy(it.master)
    it.master.position = 1e16
    assert not it.master.try_advance(H)
    it.master.position = before.position
    assert it.master == before


# --- no false alarm, and the same as the independent model ---


def exact_line(r: Random, steps: list[float], *, jumps: bool) -> list[tuple[float, float, float]]:
    """The samples of a line whose acceleration, or jerk, or even velocity, changes at most once in three steps."""
    shortest, p, v, a = 3.0 * max(steps), r.gauss(0.0, 1.0) * r.choice((0.0, 1.0, 1e6)), 0.0, 0.0
    scale = 10.0 ** r.uniform(-3.0, 3.0)
    left = jerk = 0.0
    samples = []
    for h in steps:
        samples.append((p, v, a))
        missing = h
        while missing > 0.0:
            if left <= 0.0:
                left = shortest * r.choice((1.0, 3.0, 30.0))
                a = r.choice((0.0, 0.0, r.gauss(0.0, scale / shortest)))
                v = r.choice((0.0, r.gauss(0.0, scale))) if jumps and r.random() < 0.3 else v
                jerk = r.choice((0.0, r.gauss(0.0, scale / shortest / left)))
            t = min(missing, left)
            p += t * (v + t * (a / 2.0 + t * jerk / 6.0))
            v += t * (a + t * jerk / 2.0)
            a += t * jerk
            missing, left = missing - t, left - t
    return samples


def random_steps(r: Random, count: int) -> list[float]:
    """Equal ones, or any."""
    h = 10.0 ** r.uniform(-4.0, -1.0)
    return [h * (10.0 ** r.uniform(-1.0, 0.0) if r.random() < 0.5 else 1.0) for _ in range(count)]


def run_exactly(mode: MasterInput, r: Random, steps: list[float]) -> Watched:
    it = Watched(mode)
    samples = exact_line(r, steps, jumps=mode != ONLY)
    after = [*steps[1:], steps[-1]] if mode != END else [steps[0], *steps[:-1]]
    for sample, h in zip(samples, steps if mode != END else after, strict=True):
        it.give(*sample, h=h)
    return it


@pytest.mark.parametrize("mode", EXACT)
@drawn(anew=True)
@given(seed=st.integers(0, 2**32 - 1), equal=st.booleans())
def test_no_exact_line_is_reported_more_of_than_counts(mode: MasterInput, seed: int, equal: bool) -> None:
    rng = Random(seed)
    steps = [10.0 ** rng.uniform(-4.0, -1.0)] * 300 if equal else random_steps(rng, 300)
    assert max(run_exactly(mode, rng, steps).codes) <= COUNTS


@drawn(anew=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    resolution=st.sampled_from((0.0, 1e-3, 0.1, 3.0)),
    noise=st.sampled_from((0.0, 1e-4, 0.02, 1.0)),
    sample_time=st.sampled_from((0.0, 2.5e-3, 0.02)),
)
def test_no_measured_line_is_reported_anything(seed: int, resolution: float, noise: float, sample_time: float) -> None:
    rng = Random(seed)
    it = Watched(MEASURED, sample_time=sample_time)
    for p, v, a in exact_line(rng, [H] * 1000, jumps=True):
        measured = p + rng.gauss(0.0, noise)
        it.give(math.floor(measured / resolution) * resolution if resolution else measured, v, a)
    assert not any(it.codes)


@pytest.mark.parametrize("mode", EXACT)
@pytest.mark.parametrize("h", [1e-3, 0.1])
def test_no_ideal_line_is_reported_anything(mode: MasterInput, h: float) -> None:
    """Constant velocity and acceleration, far from 0, sines up to the sampling theorem's limit."""
    t = [n * h for n in range(2000)]
    for position in (0.0, 1e9):
        assert not any(Watched(mode).run([(position + 333.3 * x, 333.3) for x in t], h).codes)
        braking = [(position + 333.3 * x - 50.0 * x * x, 333.3 - 100.0 * x, -100.0) for x in t]
        assert not any(Watched(mode).run(braking, h).codes)
    for share in (0.01, 0.3, 0.9):
        w = share * math.pi / h
        sine = [(100.0 * math.sin(w * x), 100.0 * w * math.cos(w * x), -100.0 * w * w * math.sin(w * x)) for x in t]
        assert not any(Watched(mode).run(sine, h).codes)
    assert not any(Watched(mode, period=360.0).run([(333.3 * x % 360.0, 333.3) for x in t], h).codes)


def faulty_line(r: Random, count: int) -> list[Sample]:
    """A line in which now one thing is wrong, now another: its times are those since the sample before."""
    h = 10.0 ** r.uniform(-3.0, -0.5)
    p = v = a = 0.0
    samples = []
    ratio, count_of, is_frozen, noise, left = 1.0, 0.0, False, 0.0, 0
    for _ in range(count):
        if left == 0:
            left = r.choice((5, 40, 60, 140))
            v, a = r.choice((0.0, 1.0, 1.0, -1.0)) * r.choice((0.01, 1.0, 3.0)), r.choice((0.0, 0.0, 0.1))
            ratio = r.choice((1.0, 1.0, -1.0, 60.0, 0.0, 1.9, 2.1))
            is_frozen = r.random() < 0.2
            noise = r.choice((0.0, 0.0, 1e-3, 0.1)) * h
            count_of = r.choice((0.0, 0.0, 0.3 * h))
            p += r.choice((0.0, 0.0, 10.0, -30.0, 300.0)) * h * r.uniform(0.3, 3.0)
        left -= 1
        time = h * (r.uniform(0.5, 1.0) if r.random() < 0.1 else 1.0)
        if not is_frozen:
            p += (v + a * time / 2.0) * time
        v += a * time
        shown = p + (r.gauss(0.0, noise) if noise else 0.0)
        shown = math.floor(shown / count_of) * count_of if count_of else shown
        samples.append(Sample(time, shown, v * ratio, a * ratio))
    return samples


@pytest.mark.parametrize("mode", list(MasterInput))
@drawn(40, anew=True)
@given(seed=st.integers(0, 2**32 - 1))
def test_it_reports_what_the_independent_model_reports(mode: MasterInput, seed: int) -> None:
    samples = faulty_line(Random(seed), 400)
    it = Watched(mode)
    later = [*(sample.time for sample in samples[1:]), samples[-1].time]
    for sample, h in zip(samples, later, strict=True):
        it.give(sample.position, sample.velocity, sample.acceleration, sample.time if mode == END else h)
    expected = reported(samples, has_velocity=mode in WITH_VELOCITY, is_smoothed=mode == MEASURED)
    for n, (seen, right) in enumerate(zip(it.reported, expected, strict=True)):
        assert seen.code == right.code, n
        assert seen.likely_period == pytest.approx(right.likely_period, rel=1e-9, abs=1e-9)
        assert seen.velocity_ratio == pytest.approx(right.velocity_ratio, rel=1e-6)
