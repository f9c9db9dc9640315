"""Cuts of a saw: where on the material they are, and how far each is from its mark.

The material moves with the master. Marks are on it at distances of `length`. A saw that is coupled at a mark stays at
this mark: slave = ratio (master - mark), of a saw that turns without whole turns, near 0. Each interval in which the
Boolean of the table [cuts] is true is one cut.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from ..cutting import CutSpec
from ..engineering import ROUNDING, engineering
from ..recording import Reals, Recording, unwrapped
from .time_series import in_nearest_turn

MOST_MARKS = 10_000  # that passed uncut; more are not listed
NAMED_MARKS = 4  # that a text names; of more it names the first two


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


def find_uncut_marks(spec: CutSpec, cuts: tuple[Cut, ...], recording: Recording) -> list[float]:
    """The marks that came from before the saw, went out of its reach, and are the nearest mark of no cut.

    The position at which the saw starts is none of them: there the material ends. The reach is as far as the saw went
    along with the material in this run. Of very many marks the first MOST_MARKS are listed."""
    sign = 1.0 if recording.master[-1, 0] >= recording.master[0, 0] else -1.0
    material, saw = sign * recording.master[:, 0], sign * recording.values["slave.position"] / spec.ratio
    begin, end = float(material[0] - saw[0]), float(material.max() - saw.max())
    margin = ROUNDING * max(spec.length, float(np.abs(material).max()))
    first = math.floor((begin - sign * spec.offset + margin) / spec.length) + 1
    last = math.ceil((end - sign * spec.offset - margin) / spec.length) - 1
    marks = (spec.offset + sign * n * spec.length for n in range(first, last + 1))
    cut_marks = {round((cut.mark - spec.offset) / spec.length) for cut in cuts}
    return list(islice((m for m in marks if round((m - spec.offset) / spec.length) not in cut_marks), MOST_MARKS))


def uncut_text(uncut: Sequence[float], unit: str) -> str:
    """Marks that passed uncut, in words: `5 marks passed uncut: 1300, 1800, … mm`; empty if there are none."""
    number = len(uncut)
    if not number:
        return ""
    named = uncut if number <= NAMED_MARKS else uncut[:2]
    positions = ", ".join([*(engineering(position) for position in named), *(["…"] if number > len(named) else [])])
    count = f"{'at least ' * (number == MOST_MARKS)}{number} mark{'s' * (number > 1)}"
    return f"{count} passed uncut: {positions} {unit}".strip()
