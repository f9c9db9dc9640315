"""Cuts of a saw: where on the material they lie, and how far each is from its mark.

The material moves with the master. Marks lie on it at distances of `length`. A saw that is coupled at a mark stays at
this mark: slave = ratio (master - mark). Each interval in which the Boolean of the table [cuts] is true is one cut.
"""

from dataclasses import dataclass

import numpy as np

from ..interface.units import BASES
from .recording import Recording

TOLERANCE = 1e-4  # m: how far a cut may be from its mark where the scenario does not say


def usual_tolerance(unit: str, length: float) -> float:
    """The tolerance of a scenario that gives none: 0.1 mm in its unit.

    Where positions are angles or pure numbers it is a ten-thousandth of the distance of the marks."""
    base, size = BASES[unit]
    return TOLERANCE / size if base == "m" else 1e-4 * length


@dataclass(frozen=True)
class CutSpec:
    """How cuts are found and checked: the slave is a saw that cuts the master's material while a Boolean is true.

    Attributes:
        name: the name of the Boolean.
        length: distance of the marks on the material, in u; one of them lies at `offset`.
        ratio: the slave's travel over the master's.
        tolerance: the greatest allowed distance of a cut from its mark, in u.
        count: how many cuts there have to be; None: any number.
    """

    name: str
    length: float
    offset: float
    ratio: float
    tolerance: float
    count: int | None

    def nearest(self, place: float) -> float:
        """The place of the mark that is nearest to a place on the material."""
        return self.offset + round((place - self.offset) / self.length) * self.length


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


def find_cuts(spec: CutSpec, recording: Recording) -> list[Cut]:
    """The cuts of a run, in the order of time."""
    on = recording.values[spec.name] != 0.0
    borders = np.flatnonzero(np.diff(on, prepend=False, append=False))
    places = recording.master[:, 0] - recording.values["slave.position"] / spec.ratio
    found = []
    for first, after in zip(borders[::2].tolist(), borders[1::2].tolist(), strict=True):
        mark = spec.nearest(float(places[first:after].mean()))
        errors = places[first:after] - mark
        worst = float(errors[np.argmax(np.abs(errors))])
        found.append(Cut(float(recording.time[first]), float(recording.time[after - 1]), mark, worst))
    return found
