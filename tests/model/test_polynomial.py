"""Roots of polynomials in (0, 1) against exact fractions: all of them, to rounding, whatever the coefficients."""

from collections.abc import Sequence
from math import inf, isfinite, nan

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from motionsync.numerics.polynomial import EPSILON, ROUNDING, Polynomial
from tests.model.flying_saw.fake_blocks import RootFinder
from tests.oracle.numerics.mp import Ratio, mpq
from tests.oracle.numerics.roots import at, roots_inside
from tests.support.blocks.drawn import drawn
from tests.support.compiler.compiled import Compiled, equal

repeatable = drawn()

ULP = mpq(EPSILON)
LEAST = mpq(1, 2**60)  # smaller roots, and differences between roots, are lost


def polynomial(coefficients: list[float]) -> Polynomial:
    made = Polynomial()
    made.degree = len(coefficients) - 1
    made.coefficients[: len(coefficients)] = coefficients
    return made


def solved(coefficients: list[float]) -> list[float]:
    it = polynomial(coefficients)
    it.solve()
    return it.roots[: it.root_count]


def expand(roots: list[float], factor: float = 1.0) -> list[float]:
    """The coefficients, each rounded once."""
    exact = [mpq(factor)]
    for root in roots:
        exact = [a - mpq(root) * b for a, b in zip([mpq(0), *exact], [*exact, mpq(0)], strict=True)]
    return [float(c) for c in exact]


def terms(f: Sequence[float], u: Ratio) -> Ratio:
    return at([abs(c) for c in f], u)


def assert_root(coefficients: list[float], root: float) -> None:
    """The value is 0 within its rounding, or that of its place."""
    slope = [n * c for n, c in enumerate(coefficients)][1:]
    u = mpq(root)
    assert 0.0 < root < 1.0
    assert abs(at(coefficients, u)) <= 8 * ULP * terms(coefficients, u) + LEAST * terms(slope, u)


def assert_solved(coefficients: list[float]) -> int:
    """Each root found is one to rounding, and one is found where the sign changes beyond rounding; how many are."""
    result = solved(coefficients)
    assert len(result) < len(coefficients)
    assert result == sorted(result)
    for root in result:
        assert_root(coefficients, root)
    if abs(at(coefficients, mpq(1))) <= 2 * mpq(ROUNDING) * terms(coefficients, mpq(1)):
        return 0
    certain = 0
    slope = [n * c for n, c in enumerate(coefficients)][1:]
    for u in roots_inside(coefficients):
        away = max(32 * ULP * terms(coefficients, u) / (abs(at(slope, u)) or 1), LEAST)
        low, high = at(coefficients, u - away), at(coefficients, u + away)
        beyond = min(abs(low), abs(high)) > 16 * ULP * terms(coefficients, u)
        if away < u < 1 - away and low * high < 0 and beyond:
            certain += 1
            assert any(abs(mpq(root) - u) <= away for root in result), (result, float(u))
    return certain


sizes = st.floats(1e-12, 1e12) | st.sampled_from([0.0, 1.0, 1e-300, 1e300, 1e-17, 5e-324])
coefficients_ = st.lists(
    st.builds(lambda x, sign: sign * x, sizes, st.sampled_from([1.0, -1.0])), min_size=2, max_size=7
)
inside = st.floats(0.0, 1.0) | st.sampled_from([0.0, 1.0, 0.5, 0.5 + 1e-8, 1e-9, 1.0 - 1e-9])


@repeatable
@given(coefficients_.filter(any))
@example([1e-300, -2e-300, 3e-301])
@example([-1e300, 2e300])
@example([-5e-324, 1e-323])
@example([0.25, -1.0, 1.0, 0.0, 1e-17, -1e-17])
def test_any_coefficients(coefficients: list[float]) -> None:
    assert_solved(coefficients)


@repeatable
@given(st.lists(inside | st.floats(-3.0, 3.0), min_size=1, max_size=6), st.sampled_from([1.0, -1e-8, 1e9]))
@example([0.5, 0.5, 0.5, 0.5, 0.5, 0.5], 1.0)
@example([0.0, 0.0, 1.0, 1.0, 0.3], 1.0)
def test_roots_wherever_they_lie_single_or_clustered(roots: list[float], factor: float) -> None:
    assert_solved(expand(roots, factor))


@repeatable
@given(st.lists(st.integers(1, 63), min_size=1, max_size=6, unique=True))
def test_well_separated_roots_are_all_found(numbers: list[int]) -> None:
    roots = sorted(n / 64 for n in numbers)
    coefficients = expand(roots)
    assert len(solved(coefficients)) == len(roots)
    assert assert_solved(coefficients) >= len(roots) - 2


def test_the_roots_are_exact_to_rounding_where_the_problem_is_well_conditioned() -> None:
    assert solved([-1.0, 4.0]) == [0.25]
    assert solved(expand([0.25, 0.75])) == [0.25, 0.75]
    assert solved([-0.125, 0.0, 0.0, 1.0]) == [0.5]
    assert solved([-1e-20, 1.0, 1.0]) == pytest.approx([1e-20], rel=1e-15)
    assert solved([-2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0]) == pytest.approx([(2 / 3) ** (1 / 6)], rel=2 * EPSILON)
    assert solved(expand([k / 7 for k in range(1, 7)])) == pytest.approx([k / 7 for k in range(1, 7)], abs=1e-12)


@pytest.mark.parametrize("roots", [[0.0], [1.0], [0.0, 1.0], [1.0, 1.0], [0.0, 0.0, 1.0, 1.0, 1.0], [-0.5, 1.5]])
def test_roots_at_the_ends_are_not_inside(roots: list[float]) -> None:
    assert solved(expand(roots)) == []
    assert solved(expand([*roots, 0.5])) == pytest.approx([0.5], rel=2 * EPSILON)


@pytest.mark.parametrize("noise", [1e-16, -1e-16, 3e-14, -3e-14])
def test_a_sum_of_coefficients_within_rounding_of_0_is_a_root_at_the_end(noise: float) -> None:
    """500 (1 - u)^2 (1 + 2 u): otherwise there would be a root near 1 - sqrt(noise)."""
    assert solved([500.0 + 500.0 * noise, 0.0, -1500.0, 1000.0]) == []


@pytest.mark.parametrize("shift", [0.0, 1e-17, -1e-17])
def test_a_double_root_is_found_once_or_not_at_all(shift: float) -> None:
    result = solved([0.09 + shift, -0.6, 1.0])
    assert result == [] or result == pytest.approx([0.3], abs=1e-7)
    assert len(result) <= 1


@pytest.mark.parametrize(
    "coefficients",
    [[0.0], [3.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [nan, 1.0], [-1.0, inf], [-1.0, 2.0, nan], [1e308] * 7],
)
def test_what_has_no_roots_has_none(coefficients: list[float]) -> None:
    assert solved(coefficients) == []


@repeatable
@given(coefficients_, st.sampled_from([-1.0, 2.0, 0.125, -(2.0**40)]))
def test_a_factor_that_rounds_nothing_changes_no_bit(coefficients: list[float], factor: float) -> None:
    coefficients = [c for c in coefficients if 1e-12 <= abs(c) <= 1e12 or c == 0.0]
    assert solved([factor * c for c in coefficients] or [0.0]) == solved(coefficients or [0.0])


@repeatable
@given(st.lists(inside, min_size=1, max_size=6), st.sampled_from([1e-290, 1e-150, 1e150, 1e290]))
def test_any_scale_gives_the_roots_within_rounding(roots: list[float], scale: float) -> None:
    coefficients = [scale * c for c in expand(roots)]
    for root in solved(coefficients):
        assert_root(coefficients, root)


def test_the_derivative() -> None:
    it = polynomial([7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0])
    assert it.coefficient_sum() == 28.0
    it.differentiate()
    assert (it.degree, it.coefficients) == (5, [6.0, 10.0, 12.0, 12.0, 10.0, 6.0, 0.0])
    for _ in range(7):
        it.differentiate()
    assert (it.degree, it.coefficients) == (0, [0.0] * 7)


# --- compiled ---


any_coefficients = st.floats() | st.floats(-1.0, 1.0) | st.just(0.0)


@pytest.mark.slow
@drawn(200)
@given(st.lists(any_coefficients, min_size=1, max_size=7) | st.lists(inside, min_size=1, max_size=6).map(expand))
def test_compiled_code_gives_the_bits_of_python_for_any_numbers(coefficients: list[float]) -> None:
    block = RootFinder(polynomial(coefficients))
    compiled = Compiled(block)
    assert compiled.initialize() == block.initialize()
    for _ in range(6):
        assert equal(block, compiled) or not all(isfinite(c) for c in block.polynomial.coefficients)
        assert compiled.step(0.0) == block.step(0.0)
        assert block.polynomial.roots[:6] == list(compiled.memory["polynomial"]["roots"])
