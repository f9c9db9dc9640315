"""Pieces as a tape measure finds them, from the true master and the actual slave of a run.

A place is a position on the material: what passed position 0 of the axis when the master was there.

Where the description may be read in two ways, this is the reading:
- True positions of the master are true travel of the material, so `ratio`, actual travel of the slave per travel of the
  material, is the true one: 1, or 1 / cos(diagonal_angle). What a block takes for the material's travel
  (`material_factor`, calibration) has no part in it, nor has `length_correction`.
- A cut is a run of rows in which the tool cuts, its place the mean over time (trapezoids) between the first of them and
  the last; one row alone is its place. A cut that is not over at the last row is none yet.
- Movement in a cut is the greatest place less the least in it.
- The first piece lies between the first cut and the second: the front end is no cut.
- The worst error is the one of the greatest magnitude. C_pk is (tolerance - |mean|) / (3 sigma), sigma with n - 1; it
  needs two errors, and is infinite where all are the same: positive if that is within the tolerance, else negative.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from tests.oracle.measured_line.load import integral
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

Cut = tuple[list[Number], list[Number]]
"""Times, and the blade's places on the material."""


class TrueCuts:
    """The cuts of a run: rows of the times (s), the true master (u), the actual slave, and whether the tool cuts."""

    def __init__(
        self,
        times: Sequence[Number],
        master: Sequence[Number],
        slave: Sequence[Number],
        cutting: Sequence[bool],
        *,
        ratio: Number = 1.0,
    ) -> None:
        places = [m - mp.mpf(s) / ratio for m, s in zip(map(mp.mpf, master), slave, strict=True)]
        self.cuts = list(_cuts(times, places, cutting))

    @property
    def places(self) -> list[Number]:
        """The place (u) of each cut."""
        return [integral(t, x) / (t[-1] - t[0]) if t[-1] > t[0] else x[0] for t, x in self.cuts]

    @property
    def movement(self) -> Number:
        """How far (u) the blade moves against the material in a cut, in the worst of them; 0 without a cut."""
        return max((max(x) - min(x) for _, x in self.cuts), default=mp.mpf(0))

    def lengths(self, kerf: Number = 0.0) -> list[Number]:
        """The length (u) of each piece between two cuts, from the centres of the kerf."""
        return [b - a - mp.mpf(kerf) for a, b in pairwise(self.places)]


def mean(values: Sequence[Number]) -> Number:
    return mp.mpf(sum(map(mp.mpf, values))) / len(values)


def deviation(values: Sequence[Number]) -> Number:
    """One sigma, estimated from two values or more."""
    centre = mean(values)
    return mp.sqrt(sum((mp.mpf(value) - centre) ** 2 for value in values) / (len(values) - 1))


def worst(errors: Sequence[Number]) -> Number:
    """The error of the greatest magnitude, with its sign."""
    return max(map(mp.mpf, errors), key=abs)


def c_pk(errors: Sequence[Number], tolerance: Number) -> Number:
    """The process capability of errors that may be up to `tolerance` on both sides."""
    margin, sigma = mp.mpf(tolerance) - abs(mean(errors)), deviation(errors)
    return margin / (3 * sigma) if sigma else mp.inf if margin >= 0 else -mp.inf


def _cuts(times: Sequence[Number], places: Sequence[Number], cutting: Sequence[bool]) -> Iterator[Cut]:
    rows: Cut = ([], [])
    for time, place, cuts in zip(times, places, cutting, strict=True):
        if cuts:
            rows[0].append(mp.mpf(time))
            rows[1].append(place)
        elif rows[0]:
            yield rows
            rows = ([], [])
