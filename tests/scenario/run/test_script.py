"""The scripted axis: segments, one after the other, which are exact at every time."""

from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.scenario.script import Script, Segment


@dataclass(frozen=True)
class Piece:
    """A segment in exact numbers; `kind` is the one thing that it holds, or empty."""

    duration: Fraction
    kind: str
    value: Fraction

    def segment(self) -> Segment:
        held = {self.kind: float(self.value)} if self.kind else {}
        return Segment(float(self.duration), **held)


Initial = tuple[Fraction, Fraction, Fraction]
"""Position, velocity and acceleration at the beginning."""


def scripted(initial: Initial, pieces: list[Piece]) -> Script:
    p, v, a = map(float, initial)
    return Script(p, v, a, [piece.segment() for piece in pieces])


def exact(initial: Initial, pieces: list[Piece], t: Fraction, *, before: bool) -> tuple[Fraction, ...]:
    """Position, velocity, acceleration, jerk at t, integrated piece by piece; at a break, `before` or after it."""
    p, v, a = initial
    j, zero = Fraction(0), Fraction(0)
    for piece in pieces:
        v = piece.value if piece.kind == "velocity" else v
        a = {"acceleration": piece.value, "jerk": a}.get(piece.kind, zero)
        j = piece.value if piece.kind == "jerk" else zero
        d = min(t, piece.duration)
        p, v, a, t = p + v * d + a * d**2 / 2 + j * d**3 / 6, v + a * d + j * d**2 / 2, a + j * d, t - d
        if t == 0 and (before or d < piece.duration):
            return p, v, a, j
    return p + v * t, v, zero, zero


def dyadic(least: int, greatest: int, parts: int) -> st.SearchStrategy[Fraction]:
    """Numbers that floats hold exactly, and so do their sums."""
    return st.integers(least * parts, greatest * parts).map(lambda n: Fraction(n, parts))


AXIS = dyadic(-100, 100, 8)
PIECES = st.lists(
    st.builds(
        Piece,
        st.integers(1, 512).map(lambda n: Fraction(n, 128)),
        st.sampled_from(["", "velocity", "acceleration", "jerk"]),
        dyadic(-50, 50, 8),
    ),
    max_size=6,
)


@given(st.tuples(AXIS, AXIS, AXIS), PIECES, dyadic(0, 30, 128))
def test_the_script_is_its_segments_integrated(initial: Initial, pieces: list[Piece], t: Fraction) -> None:
    script = scripted(initial, pieces)
    breaks = [Fraction(0), *accumulate(piece.duration for piece in pieces)]
    for time in (t, *breaks):
        for motion, before in ((script.at(float(time)), False), (script.until(float(time)), True)):
            required = exact(initial, pieces, time, before=before)
            result = (motion.position, motion.velocity, motion.acceleration, motion.jerk)
            assert result == pytest.approx([float(x) for x in required], rel=1e-11, abs=1e-8)


@given(st.tuples(AXIS, AXIS, AXIS), PIECES)
def test_the_script_never_jumps_in_position(initial: Initial, pieces: list[Piece]) -> None:
    script = scripted(initial, pieces)
    for time in script.breaks:
        assert script.at(time).position == pytest.approx(script.until(time).position, rel=1e-12, abs=1e-12)
