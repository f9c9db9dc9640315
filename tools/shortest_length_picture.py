"""Draws the picture of the page on sweeps: the shortest length over the line velocity, as the results of two searches.

`python -m tools.shortest_length_picture FOLDER` reads CutToLength.csv and FlyingSaw.csv in
FOLDER/shortest_length, which `motionsync search` has written, and draws FOLDER/shortest_length.svg.
"""

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from motionsync_fmu.pages.pictures import STYLE, write_svg
from motionsync_fmu.pages.style import MASTER, SLAVE

Reals = NDArray[np.float64]

VELOCITY, ACCELERATION = "master.velocity", "axis.max_acceleration"
LENGTH, OTHER_SIDE, PREDICTED = "length", "length.beside", "limits.min_length.last"
DRAWN = (2000.0, 5000.0, 10000.0, 20000.0)  # mm/s2: the limits with a curve
SHADES = ("#9ecae1", "#4292c6", "#1f6fb2", "#08306b")
EACH = 5  # of a curve's points, one so often is marked
TO_METRES = 1e-3
TO_METRES_A_MINUTE = 60.0 * TO_METRES


@dataclass(frozen=True)
class BoundaryCurves:
    """The rows of a search, those without a boundary left out; all arrays have the shape (rows,).

    Attributes:
        runs: how many runs the search took, those of the rows left out included.
        velocity: of the line, in mm/s.
        acceleration: the axis's limit, in mm/s2.
        length: the shortest length that works, in mm.
        other_side: the length next to it that does not, in mm.
        predicted: the prediction of the block, in mm; NaN: there is none.
    """

    runs: int
    velocity: Reals
    acceleration: Reals
    length: Reals
    other_side: Reals
    predicted: Reals

    @classmethod
    def read(cls, file: Path) -> "BoundaryCurves":
        """The rows of a search in a CSV file."""
        with file.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        with_length = [row for row in rows if row[LENGTH]]

        def column(name: str) -> Reals:
            return np.array([float(row.get(name) or "nan") for row in with_length])

        columns = map(column, (VELOCITY, ACCELERATION, LENGTH, OTHER_SIDE, PREDICTED))
        return cls(sum(int(row["runs"]) for row in rows), *columns)

    def curve(self, acceleration: float) -> tuple[Reals, Reals, Reals]:
        """Line velocity, shortest length and prediction at one limit, in rising order of the velocity; mm/s and mm."""
        at_acceleration = np.flatnonzero(self.acceleration == acceleration)
        order = at_acceleration[np.argsort(self.velocity[at_acceleration])]
        return self.velocity[order], self.length[order], self.predicted[order]


def compare_with(curves: BoundaryCurves, other: BoundaryCurves) -> BoundaryCurves:
    """Select the points at which another search has a boundary, too; its lengths become the predictions."""
    lengths = dict(zip(zip(other.velocity, other.acceleration, strict=True), other.length, strict=True))
    points = list(zip(curves.velocity, curves.acceleration, strict=True))
    both = np.array([point in lengths for point in points])
    predicted = np.array([lengths[point] for point in points if point in lengths])
    columns = (curves.velocity, curves.acceleration, curves.length, curves.other_side)
    return BoundaryCurves(curves.runs, *[*(values[both] for values in columns), predicted])


def draw_picture(machine: BoundaryCurves, saw: BoundaryCurves) -> bytes:
    """Draw the shortest lengths, and how much longer those of the saw are.

    `machine`: the boundaries of CutToLength; `saw`: those of FlyingSaw."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 4.2), layout="constrained")
        curves, shares = figure.subplots(1, 2, width_ratios=(3, 2), sharex=True)
        _draw_curves(curves, machine, saw)
        _draw_shares(shares, compare_with(saw, machine))
        for axes in (curves, shares):
            axes.set_xlabel("line velocity in m/min")
        return write_svg(figure)


def _draw_curves(axes: Axes, machine: BoundaryCurves, saw: BoundaryCurves) -> None:
    for acceleration, shade in zip(DRAWN, SHADES, strict=True):
        velocity, _, length = machine.curve(acceleration)
        label = f"{acceleration * TO_METRES:g} m/s²"
        axes.plot(TO_METRES_A_MINUTE * velocity, TO_METRES * length, color=shade, linewidth=1.6, label=label)
    for curves, marker, size, colour, label in (
        (machine, "o", 3.0, MASTER, "CutToLength, by search"),
        (saw, "+", 5.0, SLAVE, "FlyingSaw, by search"),
    ):
        for acceleration in DRAWN:
            velocity, length, _ = (values[::EACH] for values in curves.curve(acceleration))
            x, y = TO_METRES_A_MINUTE * velocity, TO_METRES * length
            in_legend = label if acceleration == DRAWN[0] else "_"  # once
            axes.plot(x, y, marker, markersize=size, color=colour, label=in_legend)
    axes.set_ylabel("shortest length in m")
    axes.set_title("lines: what CutToLength predicts", fontsize="medium")
    axes.legend(frameon=False, fontsize="small")


def _draw_shares(axes: Axes, saw: BoundaryCurves) -> None:
    for acceleration, shade in zip(DRAWN, SHADES, strict=True):
        velocity, length, other = saw.curve(acceleration)
        axes.plot(TO_METRES_A_MINUTE * velocity, 100.0 * (length / other - 1.0), color=shade, linewidth=1.6)
    axes.axhline(0.0, color=MASTER, linewidth=0.8)
    axes.set_ylabel("excess of FlyingSaw's length in %")


def main() -> None:
    """Draw the picture into the folder that the command line names."""
    folder = Path(sys.argv[1])
    machine, saw = (
        BoundaryCurves.read(folder / "shortest_length" / f"{name}.csv") for name in ("CutToLength", "FlyingSaw")
    )
    (folder / "shortest_length.svg").write_bytes(draw_picture(machine, saw))


if __name__ == "__main__":
    main()
