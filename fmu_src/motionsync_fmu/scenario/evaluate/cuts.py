"""Cuts of a saw: where on the material they are, and how far each is from its mark.

The material moves with the master. Marks are on it at distances of `length`. A saw that is coupled at a mark stays at
this mark: slave = ratio (master - mark), of a saw that turns without whole turns, near 0. Each interval in which the
Boolean of the table [cuts] is true is one cut.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..cutting import CutSpec
from ..recording import Reals, Recording, unwrapped
from .time_series import in_nearest_turn


@dataclass(frozen=True)
class Cut:
    """One synchronous phase, seen at the communication points.

    Attributes:
        begin, end: its first and its last point, in s.
        mark: the place of the nearest mark on the material, in u.
        error: the distance of the cut from the mark where it is greatest, in u; positive: the saw lags behind the mark.
    """

    begin: float
    end: float
    mark: float
    error: float


def find_cuts(spec: CutSpec, recording: Recording, slave_period: float = 0.0) -> list[Cut]:
    """The cuts of a run, in the order of time.

    `slave_period`: that of the saw's position; 0: it is not wrapped."""
    on = recording.values[spec.name] != 0.0
    borders = np.flatnonzero(np.diff(on, prepend=False, append=False))
    first, after = borders[::2], borders[1::2]
    if not len(first):
        return []
    points = after - first
    begins = np.cumsum(points) - points  # of the cuts, among the places
    saw = recording.values["slave.position"]
    if slave_period:
        saw = unwrapped(recording.time, saw, recording.values["slave.velocity"], slave_period)
    saw = in_nearest_turn(saw[on], begins, slave_period)
    places = recording.master[on, 0] - saw / spec.ratio
    marks = spec.nearest_marks(np.add.reduceat(places, begins) / points)
    errors = places - np.repeat(marks, points)
    greatest = np.maximum.reduceat(np.abs(errors), begins)
    at_greatest = np.flatnonzero(np.abs(errors) == np.repeat(greatest, points))
    worst = errors[at_greatest[np.searchsorted(at_greatest, begins)]]
    time = recording.time
    return [Cut(*cut) for cut in np.column_stack([time[first], time[after - 1], marks, worst]).tolist()]


@dataclass(frozen=True)
class Passage:
    """A mark while it passes the range of the saw: its place on the material, in u, and where it is when."""

    number: int
    place: float
    time: Reals
    position: Reals


def reach(spec: CutSpec, recording: Recording) -> tuple[float, float]:
    """The range of the saw's axis in which passing marks are of interest: that of the run, and a little more."""
    saw = recording.values["slave.position"]
    margin = 0.05 * float(np.ptp(saw)) + 1e-3 * spec.length
    return float(saw.min()) - margin, float(saw.max()) + margin


def passages(spec: CutSpec, recording: Recording, low: float, high: float) -> Iterator[Passage]:
    """The passages of all marks through a range of the saw's axis."""
    travel, distance = spec.ratio * (recording.master[:, 0] - spec.offset), abs(spec.ratio) * spec.length
    first = np.ceil((travel - high) / distance).astype(np.int64)
    several = [first + k for k in range(int((high - low) // distance) + 1)]
    inside = [np.flatnonzero(travel - n * distance >= low) for n in several]
    numbers = np.concatenate([n[at] for n, at in zip(several, inside, strict=True)])
    points = np.concatenate(inside)
    order = np.lexsort((points, numbers))
    numbers, points = numbers[order], points[order]
    borders = np.flatnonzero((np.diff(numbers) != 0) | (np.diff(points) != 1)) + 1
    for part in np.split(np.arange(len(points)), borders) if len(points) else []:
        at, n = points[part], int(numbers[part[0]])
        number = n if spec.ratio > 0.0 else -n
        place = spec.offset + number * spec.length
        yield Passage(number, place, recording.time[at], travel[at] - n * distance)
