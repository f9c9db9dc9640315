"""The slave's own motion against Ruckig and closed forms; that it is continuous, keeps its limits and ends exactly.

Ruckig takes a position as reached within 1e-8 of its unit and may then be faster than any exact motion: it is asked
where lengths are of order 1.
"""

import math
from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import Any, NamedTuple

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motionsync.motion.jerk_limited import Motion, acceleration_limit, stopping_distance
from tests.oracle.numerics.mp import mpq
from tests.support.blocks.drawn import drawn
from tests.support.compiler.compiled import Compiled, equal
from tests.support.fake_blocks.planner import Planner

repeatable = drawn(300)

EPS = 2.0**-52


class Move(NamedTuple):
    """A start, and what `Motion.move` is given; `Motion.try_change` and `halt` take of it what they need."""

    position: float
    velocity: float
    acceleration: float
    target: float
    speed: float
    up: float
    down: float
    jerk: float

    def mirrored(self) -> "Move":
        p, v, a, target, *limits = self
        return Move(-p, -v, -a, -target, *limits)


def moved(move: Move) -> Motion:
    motion = started(*move[:3])
    motion.move(*move[3:])
    return motion


def changed(*arguments: float) -> Motion:
    motion = started(*arguments[:3])
    assert motion.try_change(*arguments[3:])
    return motion


def halted(move: Move) -> Motion:
    motion = started(*move[:3])
    motion.halt(move.down, move.jerk)
    return motion


def started(position: float, velocity: float, acceleration: float) -> Motion:
    motion = Motion()
    motion.start(position, velocity, acceleration)
    return motion


def rows(motion: Motion) -> list[tuple[float, ...]]:
    """Begin, position, velocity, acceleration and jerk of each piece."""
    lists = (motion.start_times, motion.positions, motion.velocities, motion.accelerations, motion.jerks)
    return list(zip(*(values[: motion.segments] for values in lists), strict=True))


def random_move(rng: Random, *, equal_limits: bool = True) -> Move:
    """Limits over two decades; half the states at rest or inside the limits, the others up to twice beyond them; ways
    from 1e-6 to 1e3 and none at all."""
    speed, up, down, jerk = (10.0 ** rng.uniform(-1.0, 1.0) for _ in range(4))
    part = [rng.choice((0.0, rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-2.0, 2.0))) for _ in range(2)]
    position = rng.choice((0.0, rng.uniform(-100.0, 100.0)))
    way = rng.choice((0.0, 10.0 ** rng.uniform(-6.0, 0.0), 10.0 ** rng.uniform(-1.0, 3.0), rng.uniform(0.0, 10.0)))
    target = position + rng.choice((-1.0, 1.0)) * way
    return Move(position, part[0] * speed, part[1] * up, target, speed, up, up if equal_limits else down, jerk)


random_moves = st.builds(
    lambda seed, equal_limits: random_move(Random(seed), equal_limits=equal_limits),
    st.integers(0, 2**32),
    st.booleans(),
)


# --- against Ruckig ---------------------------------------------------------------------------------------------------


def ruckig() -> Any:
    """The module; the test is skipped where it has no wheel."""
    return pytest.importorskip("ruckig")


def fastest(given: Any) -> float | None:
    """Ruckig's duration; None if it finds no motion."""
    trajectory, result = ruckig().Trajectory(1), ruckig().Result
    try:
        results = ruckig().Ruckig(1).calculate(given, trajectory)
    except ruckig().RuckigError:
        return None
    return float(trajectory.duration) if results in (result.Working, result.Finished) else None


def fastest_move(move: Move) -> float | None:
    given = ruckig().InputParameter(1)
    given.current_position, given.current_velocity = [move.position], [move.velocity]
    given.current_acceleration, given.target_position = [move.acceleration], [move.target]
    given.max_velocity, given.max_acceleration, given.max_jerk = [move.speed], [move.up], [move.jerk]
    return fastest(given)


def fastest_change(
    velocity: float, acceleration: float, target: float, slope: float, low: float, high: float, jerk: float
) -> float | None:
    """In coordinates that move with the target."""
    given = ruckig().InputParameter(1)
    given.control_interface = ruckig().ControlInterface.Velocity
    given.current_velocity, given.current_acceleration = [velocity - target], [acceleration - slope]
    given.target_velocity = [0.0]
    given.max_acceleration, given.min_acceleration, given.max_jerk = [high - slope], [low - slope], [jerk]
    return fastest(given)


def beyond_speed(move: Move) -> bool:
    """Whether the start makes it unavoidable that the velocity limit is broken; there Ruckig first brakes, to the limit
    and further, and is not optimal."""
    direct = move.velocity + move.acceleration * abs(move.acceleration) / (2.0 * move.jerk)
    return max(abs(move.velocity), abs(direct)) > move.speed


@pytest.mark.slow
def test_no_move_is_slower_than_ruckigs(soak: Callable[[int, int], int]) -> None:
    rng, moves = Random(5055), soak(4000, 40000)
    count: Counter[str] = Counter()
    for _ in range(moves):
        move = random_move(rng)
        motion, theirs = moved(move), fastest_move(move)
        assert_sound(motion, move)
        if theirs is None:
            count["none"] += 1
            continue
        tolerance = 1e-9 * max(1.0, theirs)
        assert motion.end_time() <= theirs + tolerance, move
        same = motion.end_time() >= theirs - tolerance
        count["same" if same else "slower, beyond speed" if beyond_speed(move) else "slower"] += 1
    assert count["none"] <= moves // 1000  # "error in step 1", where acceleration or velocity break their limits
    assert count["slower"] == 0
    assert count["slower, beyond speed"] <= moves // 20
    assert count["same"] >= moves * 19 // 20


@pytest.mark.slow
@pytest.mark.parametrize("slope", [0.0, 0.3, -0.9])
def test_changes_of_velocity_take_as_long_as_ruckigs(slope: float, soak: Callable[[int, int], int]) -> None:
    """The slope is a part of the limit on its side."""
    rng = Random(2)
    for _ in range(soak(1000, 20000)):
        low, high, jerk = -(10.0 ** rng.uniform(-1.0, 1.0)), 10.0 ** rng.uniform(-1.0, 1.0), 10.0 ** rng.uniform(-1, 1)
        velocity, target = rng.uniform(-5.0, 5.0), rng.choice((0.0, rng.uniform(-5.0, 5.0)))
        acceleration = rng.choice((0.0, low, high, rng.uniform(low, high), rng.uniform(2.0 * low, 2.0 * high)))
        rise = slope * (high if slope > 0.0 else -low)
        motion = changed(7.0, velocity, acceleration, target, rise, low, high, jerk)
        theirs = fastest_change(velocity, acceleration, target, rise, low, high, jerk)
        assert theirs is not None
        assert motion.end_time() == pytest.approx(theirs, rel=1e-9, abs=1e-9)
        assert_continuous(motion, (7.0, velocity, acceleration))
        assert motion.velocities[motion.segments - 1] == target + rise * motion.end_time()
        assert motion.accelerations[motion.segments - 1] == rise
        assert_acceleration_within(motion, acceleration, low, high)
        assert {abs(j) for j in motion.jerks[: motion.segments]} <= {0.0, jerk}


# --- what holds for every motion --------------------------------------------------------------------------------------


def assert_continuous(motion: Motion, start: tuple[float, float, float]) -> None:
    """Each piece, integrated exactly, leads to the beginning of the next to a few roundings of state and time."""
    table = rows(motion)
    assert table[0][:4] == (0.0, *start)
    end = motion.end_time()
    great = [max(abs(row[i]) for row in table) for i in range(1, 5)]
    near = [32.0 * EPS * (great[i] + end * great[i + 1]) for i in range(3)]
    for (begin, *before), (after, *state) in pairwise(table):
        assert begin < after
        t = mpq(after) - mpq(begin)
        p, v, a, j = (mpq(x) for x in before)
        exact = (p + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j)
        for i in range(3):
            assert abs(exact[i] - mpq(state[i])) <= near[i], (i, table)


def assert_acceleration_within(motion: Motion, start: float, low: float, high: float) -> None:
    """Inside the limits, or on the straight way there from a start outside them."""
    accelerations = motion.accelerations[1 : motion.segments]
    rounding = 4.0 * EPS * max(-low, high)
    if not low <= start <= high and accelerations:
        assert motion.jerks[0] * start < 0.0
    assert all(low - rounding <= a <= high + rounding for a in accelerations)


def peaks(motion: Motion) -> list[float]:
    """Velocities at the pieces' ends and where the acceleration vanishes inside."""
    result = motion.velocities[: motion.segments]
    for (begin, _, v, a, j), (end, *_) in pairwise(rows(motion)):
        if j != 0.0 and 0.0 < -a / j < end - begin:
            result.append(v - a * a / (2.0 * j))
    return result


def assert_sound(motion: Motion, move: Move) -> None:
    """Continuous, inside the limits but for what the start makes unavoidable, and at rest at the target in the end."""
    assert_continuous(motion, move[:3])
    assert motion.at(motion.end_time()) == motion.at(motion.end_time() + 1e3) == (move.target, 0.0, 0.0, 0.0)
    limit = max(move.up, move.down)
    assert_acceleration_within(motion, move.acceleration, -limit, limit)
    assert {abs(j) for j in motion.jerks[: motion.segments]} <= {0.0, move.jerk}
    direct = move.velocity + move.acceleration * abs(move.acceleration) / (2.0 * move.jerk)
    bounds = (move.velocity, direct, move.speed, -move.speed)
    rounding = 16.0 * EPS * max(abs(x) for x in bounds)
    assert min(bounds) - rounding <= min(peaks(motion)) <= max(peaks(motion)) <= max(bounds) + rounding


@repeatable
@given(random_moves)
@example(Move(0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0))
@example(Move(3.0, -1.0, 1.0, 2.5, 2.0, 1.0, 1.0, 0.5))
@example(Move(0.0, -0.5, -0.5, 10.0, 1.0, 0.5, 2.0, 1.0))
def test_a_move_is_sound_whatever_its_limits(move: Move) -> None:
    assert_sound(moved(move), move)


@repeatable
@given(random_moves)
@example(Move(0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0))
@example(Move(0.0, 0.5, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0))
def test_a_mirrored_start_gives_the_mirrored_motion_bit_for_bit(move: Move) -> None:
    signs = (1.0, -1.0, -1.0, -1.0, -1.0)
    there, back = moved(move), moved(move.mirrored())
    assert rows(there) == [tuple(s * x for s, x in zip(signs, row, strict=True)) for row in rows(back)]
    there, back = halted(move), halted(move.mirrored())
    assert rows(there) == [tuple(s * x for s, x in zip(signs, row, strict=True)) for row in rows(back)]


@repeatable
@given(random_moves)
def test_between_rest_states_acceleration_and_deceleration_have_their_own_limits(move: Move) -> None:
    """Also where a start velocity has to be reversed."""
    move = move._replace(acceleration=0.0, velocity=max(-move.speed, min(move.velocity, move.speed)))
    motion = moved(move)
    for begin, (end, *_) in zip(motion.start_times, rows(motion)[1:], strict=False):
        for i in range(9):
            _, v, a, _ = motion.at(begin + (end - begin) * i / 8.0)
            assert abs(a) <= (move.up if v * a > 0.0 else move.down) * (1.0 + 1e-12) or abs(v) <= 1e-12 * move.speed


@repeatable
@given(random_moves)
def test_a_stop_ends_where_it_is_said_to_end(move: Move) -> None:
    motion = halted(move._replace(position=0.0))
    assert motion.at(motion.end_time())[1:] == (0.0, 0.0, 0.0)
    way = stopping_distance(*move[1:3], move.down, move.jerk)
    assert motion.at(motion.end_time())[0] == pytest.approx(way, rel=1e-14, abs=1e-14 * motion.end_time() * move.speed)
    motion = halted(move)
    assert_continuous(motion, move[:3])
    assert_acceleration_within(motion, move.acceleration, -move.down, move.down)


@repeatable
@given(random_moves, st.floats(0.0, 1.0))
def test_planned_again_on_the_way_the_motion_is_the_same(move: Move, part: float) -> None:
    """A time-optimal motion is so from each of its states on. Its duration is a cube root of small ways: positions are
    compared."""
    motion = moved(move._replace(down=move.up))
    passed = part * motion.end_time()
    again = moved(Move(*motion.at(passed)[:3], move.target, move.speed, move.up, move.up, move.jerk))
    size = max(abs(x) for x in motion.positions[: motion.segments])
    for i in range(9):
        time = (motion.end_time() - passed) * i / 8.0
        assert again.at(time)[0] == pytest.approx(motion.at(passed + time)[0], abs=1e-9 * (1.0 + size))


# --- known motions ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("velocity", "target", "limit"),
    [(-1.0, 2.0, 3.0), (1.0, -2.0, 3.0), (1.0, 2.0, 5.0), (0.0, -2.0, 5.0), (2.0, 1.0, 3.0), (2.0, 2.0, 3.0)],
)
def test_the_limit_of_a_change_of_velocity(velocity: float, target: float, limit: float) -> None:
    """Acceleration 5, deceleration 3."""
    assert acceleration_limit(velocity, target, 5.0, 3.0) == limit


def test_through_standstill_the_lower_limit_counts() -> None:
    assert acceleration_limit(-1.0, 1.0, 3.0, 5.0) == 3.0
    assert acceleration_limit(-1e-200, 1e-200, 5.0, 3.0) == 3.0


@pytest.mark.parametrize("far", [0.0, 2.0**20])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("way", "down", "duration"),
    [
        (2.0**-29, 1.0, 2.0**-8),  # the cube root of 32 d / j
        (2.0, 1.0, 4.0),  # the same: 1 u/s2 is just reached
        (6.0, 1.0, 6.0),  # a/j + sqrt((a/j)^2 + 4 d/a)
        (12.0, 1.0, 8.0),  # the same: 3 u/s are just reached
        (15.0, 1.0, 9.0),  # d/v + v/a + a/j
        (18.0, 0.5, 11.25),  # d/v and half of v/a + a/j for either ramp
    ],
)
def test_from_rest_to_rest(way: float, down: float, duration: float, sign: float, far: float) -> None:
    """Limits 3 u/s, 1 u/s2, 1 u/s3."""
    motion = moved(Move(far, 0.0, 0.0, far + sign * way, 3.0, 1.0, down, 1.0))
    assert motion.end_time() == pytest.approx(duration, rel=1e-14)


def test_the_pieces_of_a_move() -> None:
    motion = moved(Move(0.0, 0.0, 0.0, 15.0, 3.0, 1.0, 1.0, 1.0))
    assert [(begin, v, a, j) for begin, _, v, a, j in rows(motion)] == [
        (0.0, 0.0, 0.0, 1.0),
        (1.0, 0.5, 1.0, 0.0),
        (3.0, 2.5, 1.0, -1.0),
        (4.0, 3.0, 0.0, 0.0),
        (5.0, 3.0, 0.0, -1.0),
        (6.0, 2.5, -1.0, 0.0),
        (8.0, 0.5, -1.0, 1.0),
        (9.0, 0.0, 0.0, 0.0),
    ]
    assert motion.at(4.5) == (7.5, 3.0, 0.0, 0.0)
    assert motion.at(4.0)[3] == 0.0
    assert motion.at(math.nextafter(4.0, 0.0))[3] == 0.0  # rounding of a time does not delay what happens at it
    assert motion.at(4.0 - 1e-9)[3] == -1.0
    assert motion.is_over(math.nextafter(9.0, 0.0))
    assert not motion.is_over(9.0 - 1e-9)


def test_an_acceleration_beyond_the_limit_first_comes_down_to_it() -> None:
    """2 u/s2 at a limit of 1; 1.5 u/s are gained on the way, 7 on the limit, 0.5 at its end."""
    assert [(begin, v, a) for begin, _, v, a, _ in rows(changed(0.0, 1.0, 2.0, 10.0, 0.0, -1.0, 1.0, 1.0))] == [
        (0.0, 1.0, 2.0),
        (1.0, 2.5, 1.0),
        (8.0, 9.5, 1.0),
        (9.0, 10.0, 0.0),
    ]


def test_a_target_that_moves_is_met_and_kept() -> None:
    """In w = v - c: from -1 u/s and -0.5 u/s2 at a limit of 0.5 u/s2, 1.125 u/s are lacking."""
    motion = changed(0.0, 0.0, 0.0, 1.0, 0.5, -1.0, 1.0, 1.0)
    assert motion.start_times[: motion.segments] == [0.0, 1.0, 2.75, 3.25]
    assert motion.accelerations[: motion.segments] == [0.0, 1.0, 1.0, 0.5]
    assert motion.at(13.25)[1:] == (7.625, 0.5, 0.0)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "slope", "reached"),
    [
        (0.0, 0.0, 1.5, False),
        (9.0, -1.0, 1.5, False),
        (0.0, 0.5, 1.0, False),
        (3.0, 1.0, 1.0, True),
        (9.0, -0.5, 1.0, True),
        (2.5, 2.0, 1.0, True),
        (2.4, 2.0, 1.0, False),
        (0.0, 0.0, -1.5, False),
        (9.0, 3.0, -1.0, False),
        (3.0, -1.0, -1.0, True),
        (0.0, 0.5, -1.0, True),
    ],
)
def test_a_target_that_runs_away_is_followed_at_the_limit(
    velocity: float, acceleration: float, slope: float, reached: bool
) -> None:
    """From 3 u/s on, the limits ±1 u/s2: one that just keeps the limit is met from the side it moves to."""
    motion = started(0.0, velocity, acceleration)
    assert motion.try_change(3.0, slope, -1.0, 1.0, 1.0) == reached
    limit = math.copysign(1.0, slope)
    assert (motion.accelerations[motion.segments - 1], motion.jerks[motion.segments - 1]) == (limit, 0.0)
    assert_continuous(motion, (0.0, velocity, acceleration))
    assert (motion.at(motion.end_time())[1] == 3.0 + slope * motion.end_time()) == reached


def test_constant_velocity_goes_on_for_ever() -> None:
    motion = moved(Move(0.0, 0.0, 0.0, 15.0, 3.0, 1.0, 1.0, 1.0))
    motion.advance(2.0)
    motion.start(5.0, -2.0, 0.0)
    assert (motion.segments, motion.end_time(), motion.clock.time) == (1, 0.0, 0.0)
    assert motion.at(1e3) == (-1995.0, -2.0, 0.0, 0.0)


def test_what_is_reached_already_takes_no_time() -> None:
    for motion in (
        moved(Move(4.0, 0.0, 0.0, 4.0, 1.0, 1.0, 1.0, 1.0)),
        changed(4.0, 2.0, 0.0, 2.0, 0.0, -1.0, 1.0, 1.0),
    ):
        assert (motion.segments, motion.end_time()) == (1, 0.0)


# --- numbers ----------------------------------------------------------------------------------------------------------

anything = st.floats(-1e12, 1e12) | st.sampled_from([0.0, -0.0, 1e12, -1e12, 1e-12, 5e-324, -1e-300])
limits = st.sampled_from([1e-12, 1e12, 1.0]) | st.floats(-12.0, 12.0).map(lambda x: 10.0**x)
extreme_moves = st.builds(Move, anything, anything, anything, anything, limits, limits, limits, limits)


def assert_finite(motion: Motion) -> None:
    assert all(math.isfinite(x) for row in rows(motion) for x in row)
    times = [0.0, 1e-3, 1.0, 1e6, 1e12, motion.end_time(), *motion.start_times[: motion.segments]]
    assert all(math.isfinite(x) for time in times for x in motion.at(time))
    assert all(before[0] < after[0] for before, after in pairwise(rows(motion)))


@drawn(2000)
@given(extreme_moves, anything)
@example(Move(0.0, 0.0, 1e12, 1.0, 1e-12, 1e-12, 1e-12, 1e-12), 0.0)
@example(Move(0.0, -1e12, -1e12, -1e12, 1e12, 1e-12, 1e12, 1e-12), math.nextafter(1e-12, 0.0))
@example(Move(0.0, 5e-324, -5e-324, 5e-324, 1e-12, 1e-12, 1e-12, 1e12), 0.0)
def test_no_number_breaks_a_plan(move: Move, slope: float) -> None:
    """Where the numbers allow it at all, ends and limits are exact there too."""
    motion = moved(move)
    assert_finite(motion)
    assert rows(motion)[-1][1:] == (move.target, 0.0, 0.0, 0.0)
    motion = halted(move)
    assert_finite(motion)
    assert rows(motion)[-1][2:] == (0.0, 0.0, 0.0)
    motion = started(*move[:3])
    reached = motion.try_change(move.target, slope, -move.down, move.up, move.jerk)
    assert_finite(motion)
    limit = move.up if slope > 0.0 else -move.down
    assert motion.accelerations[motion.segments - 1] == (slope if reached else limit)


# --- the clock and the compiled code ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def compiled() -> Compiled:
    return Compiled(Planner())


def assert_same_bits(block: Planner, compiled: Compiled, move: Move) -> None:
    for kind in (1, 2, 3):
        block.kind = kind
        compiled.set("kind", kind)
        block.given[:] = move
        compiled.set("given", list(move))
        for h in (0.0, 1e-3, 0.7):
            assert block.step(h) == compiled.step(h) == 0
            assert equal(block, compiled), (kind, move)


@pytest.mark.slow
@repeatable
@given(random_moves | extreme_moves)
def test_compiled_code_plans_the_same_bits(compiled: Compiled, move: Move) -> None:
    block = Planner()
    compiled.memory[...] = Compiled(block).memory
    assert_same_bits(block, compiled, move)


def test_ten_million_steps_of_a_millisecond_do_not_drift(compiled: Compiled) -> None:
    """The exact sum of the rounded steps is 1e4 s + 2.1e-13 s; plain summation would be 1.6e-6 s off."""
    compiled.memory[...] = Compiled(Planner()).memory
    compiled.set("steps", 10**7)
    compiled.step(1e-3)
    assert mpq(float(compiled.memory["motion"]["clock"]["time"])) == pytest.approx(mpq(1e-3) * 10**7, abs=4e-12)
