"""Searches: each goes on until nothing is left between its two places but the result, and takes few steps."""

import math
from collections.abc import Callable

import pytest

from motionsync.numerics.bracket import Bracket, can_halve, halve, middle


@pytest.mark.parametrize(("before", "after"), [(1.0, 2.0), (2.0, 1.0), (-2.0, -1.0), (0.0, 1e300)])
def test_a_condition_is_halved_down_to_neighbouring_numbers(before: float, after: float) -> None:
    """Of x^2 < 2, where that begins to differ from what it is at `before`: at the square root of 2, in either order."""
    at_first = before * before < 2.0
    halvings = 0
    while can_halve(before, after):
        place = middle(before, after)
        before, after = halve(before, after, (place * place < 2.0) != at_first)
        halvings += 1
    assert math.nextafter(before, after) == after
    assert (before * before < 2.0) == at_first != (after * after < 2.0)
    assert halvings < 1100


def test_next_to_0_halving_ends_soon() -> None:
    """2^-200 is 6e-61: numbers are not halved down to the least one, 5e-324, of which there are 1,074 halvings."""
    before, after = 0.0, 1.0
    halvings = 0
    while can_halve(before, after):
        before, after = halve(before, after, True)
        halvings += 1
    assert (before, halvings) == (0.0, 200)
    assert after == 2.0**-200


@pytest.mark.parametrize(
    ("function", "root"),
    [
        (lambda x: x * x * x - 2.0, 2.0 ** (1.0 / 3.0)),
        (lambda x: 1e-30 - x, 1e-30),
        (lambda x: math.expm1(x - 0.7), 0.7),
        (lambda x: math.atan(20.0 * (x - 3.0)), 3.0),
    ],
)
def test_a_root_is_bracketed_to_its_last_digits(function: Callable[[float], float], root: float) -> None:
    """From 1e-60 to 5: first the magnitude is halved, then the chord is cut."""
    bracket, places = Bracket(), []
    bracket.set(1e-60, function(1e-60), 5.0, function(5.0))
    while bracket.try_narrow():
        places.append(bracket.place)
        value = function(bracket.place)
        bracket.replace(value, (value > 0.0) == (function(5.0) > 0.0))
    assert bracket.low <= root <= bracket.high
    assert bracket.high - bracket.low <= 1e-13 * bracket.high
    assert len(places) <= 30
