"""The picture of docs/sweeps.md: the shortest length over the line velocity, as two searches found it.

`python -m motionsync_fmu.sweep.picture FOLDER` reads FOLDER/shortest_length/CutToLength.csv and FlyingSaw.csv, which
`motionsync search` has written, and draws FOLDER/shortest_length.svg.
"""

import csv
import io
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..pages.compact import compact
from ..pages.pictures import STYLE
from ..pages.style import MASTER, SLAVE

Reals = NDArray[np.float64]

VELOCITY, ACCELERATION = "master.velocity", "axis.max_acceleration"
LENGTH, BESIDE, PREDICTED = "length", "length.beside", "limits.min_length.last"
DRAWN = (2000.0, 5000.0, 10000.0, 20000.0)  # mm/s2: the limits with a curve
SHADES = ("#9ecae1", "#4292c6", "#1f6fb2", "#08306b")
EACH = 5  # of a curve's points, one so often is marked
TO_METRES = 1e-3
TO_METRES_A_MINUTE = 60.0 * TO_METRES


@dataclass(frozen=True)
class Found:
    """The rows of a search, those without a boundary left out; all arrays have the shape (rows,).

    Attributes:
        velocity: of the line, in mm/s.
        acceleration: the axis's limit, in mm/s2.
        length: the shortest length that works, in mm.
        beside: the length next to it that does not, in mm.
        predicted: what the block foretold, in mm; NaN: it foretells none.
        runs: how many runs the search took, those of the rows left out included.
    """

    velocity: Reals
    acceleration: Reals
    length: Reals
    beside: Reals
    predicted: Reals
    runs: int

    @classmethod
    def read(cls, file: Path) -> "Found":
        """The rows of a search in a CSV file."""
        with file.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        kept = [row for row in rows if row[LENGTH]]

        def column(name: str) -> Reals:
            return np.array([float(row.get(name) or "nan") for row in kept])

        velocity, acceleration, length, beside, predicted = map(
            column, (VELOCITY, ACCELERATION, LENGTH, BESIDE, PREDICTED)
        )
        return cls(velocity, acceleration, length, beside, predicted, sum(int(row["runs"]) for row in rows))

    def curve(self, acceleration: float) -> tuple[Reals, Reals]:
        """The shortest length over the line velocity at one limit, in rising order of the velocity; mm/s and mm."""
        here = np.flatnonzero(self.acceleration == acceleration)
        order = here[np.argsort(self.velocity[here])]
        return self.velocity[order], self.length[order]

    def prediction(self, acceleration: float) -> tuple[Reals, Reals]:
        """What the block foretold at one limit, as `curve`."""
        here = np.flatnonzero(self.acceleration == acceleration)
        order = here[np.argsort(self.velocity[here])]
        return self.velocity[order], self.predicted[order]


def beside(found: Found, other: Found) -> Found:
    """Rows at the points at which another search has a boundary, too, with its lengths as predictions."""
    places = zip(other.velocity, other.acceleration, strict=True)
    lengths = dict(zip(places, other.length, strict=True))
    own = list(zip(found.velocity, found.acceleration, strict=True))
    both = np.array([place in lengths for place in own])
    predicted = np.array([lengths[place] for place in own if place in lengths])
    columns = (found.velocity, found.acceleration, found.length, found.beside)
    velocity, acceleration, length, next_to_it = (values[both] for values in columns)
    return Found(velocity, acceleration, length, next_to_it, predicted, found.runs)


def svg(machine: Found, saw: Found) -> bytes:
    """The picture: the shortest lengths, and how much longer those of the saw are.

    `machine`: what the search found for CutToLength; `saw`: for FlyingSaw."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 4.2), layout="constrained")
        curves, shares = figure.subplots(1, 2, width_ratios=(3, 2), sharex=True)
        _curves(curves, machine, saw)
        _shares(shares, beside(saw, machine))
        for axes in (curves, shares):
            axes.set_xlabel("line velocity in m/min")
        out = io.BytesIO()
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return compact(out.getvalue())


def _curves(axes: Axes, machine: Found, saw: Found) -> None:
    for acceleration, shade in zip(DRAWN, SHADES, strict=True):
        velocity, length = machine.prediction(acceleration)
        label = f"{acceleration * TO_METRES:g} m/s²"
        axes.plot(TO_METRES_A_MINUTE * velocity, TO_METRES * length, color=shade, linewidth=1.6, label=label)
    for found, marker, size, colour, label in (
        (machine, "o", 3.0, MASTER, "CutToLength, found"),
        (saw, "+", 5.0, SLAVE, "FlyingSaw, found"),
    ):
        for acceleration in DRAWN:
            velocity, length = (values[::EACH] for values in found.curve(acceleration))
            places = (TO_METRES_A_MINUTE * velocity, TO_METRES * length)
            named = label if acceleration == DRAWN[0] else "_"  # one entry in the legend
            axes.plot(*places, marker, markersize=size, color=colour, label=named)
    axes.set_ylabel("shortest length in m")
    axes.set_title("lines: what CutToLength foretells", fontsize="medium")
    axes.legend(frameon=False, fontsize="small")


def _shares(axes: Axes, saw: Found) -> None:
    for acceleration, shade in zip(DRAWN, SHADES, strict=True):
        velocity, length = saw.curve(acceleration)
        _, other = saw.prediction(acceleration)
        axes.plot(TO_METRES_A_MINUTE * velocity, 100.0 * (length / other - 1.0), color=shade, linewidth=1.6)
    axes.axhline(0.0, color=MASTER, linewidth=0.8)
    axes.set_ylabel("FlyingSaw's length beside CutToLength's in %")


def main() -> None:
    """Draw the picture into the folder that the command line names."""
    folder = Path(sys.argv[1])
    machine, saw = (Found.read(folder / "shortest_length" / f"{name}.csv") for name in ("CutToLength", "FlyingSaw"))
    (folder / "shortest_length.svg").write_bytes(svg(machine, saw))


if __name__ == "__main__":
    main()
