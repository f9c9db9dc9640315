"""Where the oracles' functions become 0: to the last bit, and soon."""

import math

import pytest

from tests.oracle import mp
from tests.oracle.root_search import Bracket, Function, find_root


@pytest.mark.parametrize(
    "function",
    [lambda x: x * x - 0.5, lambda x: math.exp(x) - 1.3, lambda x: x**9 - 0.01, lambda x: 0.3 - (1.0 - x) ** 5],
)
def test_a_root_is_found_to_the_last_bit_by_few_values(function: Function) -> None:
    called: list[float] = []

    def counted(x: float) -> float:
        called.append(x)
        return function(x)

    root = find_root(counted, 0.0, 1.0)
    assert function(root) >= 0.0 > function(math.nextafter(root, 0.0))
    assert len(called) <= 40


def test_both_ends_of_a_bracket_come_near_the_root() -> None:
    """Of x^2 = 2, rising or falling: a dozen values give 30 digits."""
    root = mp.sqrt(mp.mpf(2))
    for sign in (1, -1):
        bracket = Bracket(mp.mpf(0), mp.mpf(2), mp.mpf(-2 * sign), mp.mpf(2 * sign))
        for _ in range(13):
            point = bracket.false_position
            bracket.narrow(point, sign * (point * point - 2))
        assert bracket.low <= root <= bracket.high
        assert min(bracket.high - root, root - bracket.low) < 1e-30
        assert max(bracket.high - root, root - bracket.low) < 1e-10
