"""The lines of pictures are smooth where a curve is, step where it steps, and are never far away from it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.path import Path

from motionsync.blocks import BLOCKS
from motionsync_fmu.pages.pictures import make_panels
from motionsync_fmu.pages.smooth_path import smooth_path
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.recording import Reals
from motionsync_fmu.scenario.run.simulation import run_in_process

FAR = 1e-3  # of the range: a tenth of a point of a plot's height
KINK = 5.0  # degrees, that nobody sees, in a plot four times as wide as high


def drawn(path: Path) -> list[tuple[Reals, Reals, bool]]:
    """Each stroke of a line: where it is at many points, x and y, by the formula of Bézier curves; whether it is a
    straight one."""
    strokes = []
    vertices, codes = path.vertices, path.codes
    assert codes is not None
    u = np.linspace(0.0, 1.0, 129)[:, None]
    i = 0
    while i < len(codes):
        if codes[i] == Path.CURVE4:
            a, b, c, d = vertices[i - 1 : i + 3]
            points = a * (1 - u) ** 3 + 3 * b * u * (1 - u) ** 2 + 3 * c * u**2 * (1 - u) + d * u**3
            i += 3
        else:
            points = (
                vertices[i - 1] + (vertices[i] - vertices[i - 1]) * u if codes[i] == Path.LINETO else np.empty((0, 2))
            )
            i += 1
        if len(points):
            strokes.append((points[:, 0], points[:, 1], codes[i - 1] == Path.LINETO))
    return strokes


def ramp(u: Reals) -> Reals:
    """A ramp from 0 to 1 whose first and second derivatives are continuous, and 0 at both ends."""
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (10.0 + u * (6.0 * u - 15.0))


times = st.floats(0.05, 0.9)


@given(begin=times, width=st.floats(0.1, 0.8), height=st.floats(-1e4, 1e4).filter(lambda h: abs(h) > 1e-3))
def test_a_smooth_motion_is_drawn_without_corners_and_starts_when_it_starts(
    begin: float, width: float, height: float
) -> None:
    x = np.linspace(0.0, 2.0, 4001)
    path = smooth_path(x, 100.0 + height * ramp((x - begin) / width))
    strokes = drawn(path)
    assert len(strokes) < 30
    angle = 0.0
    for at, y, _ in strokes:
        assert np.abs(y - 100.0 - height * ramp((at - begin) / width)).max() <= FAR * abs(height)
        assert np.abs(y[at <= begin] - 100.0).max(initial=0.0) <= 0.5 * FAR * abs(height)
        directions = np.degrees(np.arctan2(np.diff(y) / abs(height), 2.0 * np.diff(at)))
        assert abs(directions[0] - angle) < KINK
        assert np.abs(np.diff(directions)).max(initial=0.0) < 2.0 * KINK  # within a curve, between two of 129 points
        angle = directions[-1]


@given(
    at=st.lists(st.integers(3, 997).map(lambda i: 4 * i), min_size=1, max_size=6, unique=True),
    slope=st.floats(-3.0, 3.0),
    height=st.floats(0.2, 50.0),
)
def test_a_step_is_drawn_upright_where_the_new_value_is_present(at: list[int], slope: float, height: float) -> None:
    """A sawtooth, as the length of a piece is: it rises by `slope` a unit of time, and steps by `height` at samples."""
    x = np.linspace(0.0, 1.0, 4001)
    y = slope * x + height * np.searchsorted(np.sort(at), np.arange(4001), side="right")
    upright = [(float(a[0]), float(b[-1] - b[0])) for a, b, straight in drawn(smooth_path(x, y)) if np.ptp(a) == 0.0]
    assert [a for a, _ in upright] == [x[i] for i in sorted(at)]
    assert all(abs(step - height) < 1.1e-3 * abs(slope) + FAR * np.ptp(y) for _, step in upright)


def test_a_cubic_curve_is_a_single_stroke_and_a_straight_line_has_no_curve() -> None:
    """3 x² - 2 x³ has the control points (0, 0), (1/3, 0), (2/3, 1), (1, 1): it is level at both ends."""
    x = np.linspace(0.0, 1.0, 501)
    cubic = smooth_path(x, x * x * (3.0 - 2.0 * x))
    assert np.abs(cubic.vertices - [[0, 0], [1 / 3, 0], [2 / 3, 1], [1, 1]]).max() < 0.01
    assert smooth_path(x, 7.0 - 2.0 * x).vertices.tolist() == [[0.0, 7.0], [1.0, 5.0]]


@given(st.floats(-1e6, 1e6).filter(lambda x: abs(x) > 1e-3), st.integers(0, 99))
def test_a_value_that_is_constant_to_rounding_is_a_straight_line(value: float, seed: int) -> None:
    noise = np.random.default_rng(seed).uniform(-4e-16, 4e-16, 501)
    assert len(smooth_path(np.linspace(0.0, 1.0, 501), value * (1.0 + noise)).vertices) == 2


@given(first=st.integers(1, 200), missing=st.integers(1, 100))
def test_a_gap_is_not_drawn(first: int, missing: int) -> None:
    x = np.linspace(0.0, 1.0, 401)
    y = np.sin(3.0 * x)
    y[first : first + missing] = math.nan
    for at, _, _ in drawn(smooth_path(x, y)):
        assert at[-1] <= x[first - 1] or at[0] >= x[first + missing]


@pytest.mark.parametrize("name", [name for name in BLOCKS if not load_example(name).remote])
def test_the_velocities_of_a_block_s_picture_are_those_of_its_run_with_other_steps(name: str) -> None:
    """Of a remote axis the steps are its cycles, and the picture shows no velocity."""
    example = load_example(name)
    other = run_in_process(example, example.step_size / 27.0)
    panel = make_panels(example, example.unit)[1]
    velocity = panel.curves[-1].values
    for at, y, _ in drawn(smooth_path(panel.time, velocity)):
        expected = np.interp(at, other.time, other.values["slave.velocity"])
        assert np.abs(y - expected).max() <= FAR * np.ptp(velocity)


@pytest.mark.parametrize(("name", "start"), [("CutToLength", 0.3), ("RotaryKnife", 0.45)])
def test_a_piece_ends_at_once_and_nothing_moves_before_it_has_to(name: str, start: float) -> None:
    """The picture of a start that is given at another time: the slave's velocity is 0 until then, and the lengths of
    pieces fall upright."""
    example = load_example(name)
    given_at = [replace(s, at=start) if "start" in s.values else s for s in example.settings]
    panels = make_panels(replace(example, settings=given_at), example.unit, example.slave_unit)
    for at, y, _ in drawn(smooth_path(panels[1].time, panels[1].curves[-1].values)):
        assert np.abs(y[at <= start]).max(initial=0.0) < 1e-3 * float(np.ptp(panels[1].curves[-1].values))
    falls = [
        np.ptp(at)
        for at, y, _ in drawn(smooth_path(panels[-1].time, panels[-1].curves[0].values))
        if y[-1] < y[0] - 100.0
    ]
    assert len(falls) >= 2
    assert not any(falls)
