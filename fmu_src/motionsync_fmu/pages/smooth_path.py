"""The line of a picture through samples: Bézier curves where they are smooth, upright lines where they step."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from matplotlib.path import Path

from ..scenario.engineering import ROUNDING
from ..scenario.recording import Reals
from .numbers import Indices

TOLERANCE = 1e-4  # of the range of the values: how far the line may be away from a sample
STEP = 0.02  # of the range of the values: what is less is no step
FAR = 8.0  # a step is so many times greater than the differences before and after it


def smooth_path(x: Reals, y: Reals) -> Path:
    """The line through samples, shape (samples,); NaN in `y` is a gap. `x` increases from sample to sample."""
    vertices: list[tuple[float, float]] = []
    codes: list[np.uint8] = []
    tolerance = TOLERANCE * float(np.nanmax(y) - np.nanmin(y)) + ROUNDING * float(np.nanmax(np.abs(y)))
    stepped = steps(y)
    present = np.isfinite(y)
    begins = np.flatnonzero(present & ~np.concatenate(([False], present[:-1])))
    ends = np.flatnonzero(present & ~np.concatenate((present[1:], [False]))) + 1
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        vertices.append((x[begin], y[begin]))
        codes.append(Path.MOVETO)
        borders = [begin, *stepped[(stepped > begin) & (stepped < end)].tolist(), end]
        for first, after in pairwise(borders):
            if first > begin:
                vertices += [(x[first], vertices[-1][1]), (x[first], y[first])]
                codes += [Path.LINETO, Path.LINETO]
            for points in _pieces(x[first:after], y[first:after], tolerance):
                vertices += points
                codes += [Path.LINETO if len(points) == 1 else Path.CURVE4] * len(points)
    return Path(vertices, codes)


def steps(y: Reals) -> Indices:
    """The indices of the samples to which a curve steps: by far more than it changes before and after."""
    difference = np.abs(np.diff(y))
    around = np.fmax(np.concatenate(([0.0], difference[:-1])), np.concatenate((difference[1:], [0.0])))
    least = STEP * float(np.nanmax(y) - np.nanmin(y)) + ROUNDING * float(np.nanmax(np.abs(y)))
    return np.flatnonzero((difference > FAR * around) & (difference > least)) + 1


def _pieces(x: Reals, y: Reals, tolerance: float) -> Iterator[list[tuple[float, float]]]:
    """The vertices that follow the first sample: of each piece one, the end of a straight line, or the three of a cubic
    Bézier curve. The length of a piece is doubled until the tolerance does not allow it, then bisected."""
    first, last = 0, len(x) - 1
    while first < last:
        reached, length = first + 1, 2
        vertices = _fit(x[first : reached + 1], y[first : reached + 1], tolerance)
        beyond = last + 1
        while reached < last:
            tried = min(first + length, last) if beyond > last else (reached + beyond) // 2
            if tried == reached:
                break
            longer = _fit(x[first : tried + 1], y[first : tried + 1], tolerance)
            if longer:
                reached, vertices, length = tried, longer, 2 * length
            else:
                beyond = tried
        assert vertices
        yield vertices
        first = reached


def _fit(x: Reals, y: Reals, tolerance: float) -> list[tuple[float, float]] | None:
    """The straight line from the first to the last sample, or else the cubic curve with the slopes at both; None if no
    sample between may be so far away."""
    width, height = x[-1] - x[0], y[-1] - y[0]
    u = (x - x[0]) / width
    end = (float(x[-1]), float(y[-1]))
    if np.abs(y[0] + u * height - y).max() <= tolerance:
        return [end]
    begins, ends = _slope(x[:3], y[:3]) * width, _slope(x[:-4:-1], y[:-4:-1]) * width
    # The straight line, and the cubics of the Hermite basis by which the slopes differ from its own.
    cubic = y[0] + u * height + u * (1.0 - u) * ((1.0 - u) * (begins - height) - u * (ends - height))
    if np.abs(cubic - y).max() > tolerance:
        return None
    third = float(width) / 3.0
    return [(float(x[0]) + third, float(y[0] + begins / 3.0)), (end[0] - third, float(y[-1] - ends / 3.0)), end]


def _slope(x: Reals, y: Reals) -> float:
    """The slope of the parabola through three samples, at the first of them."""
    (near, far), (a, b) = x[1:] - x[0], y[1:] - y[0]
    return float((a * far * far - b * near * near) / (near * far * (far - near)))
