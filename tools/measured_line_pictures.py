"""Draws the pictures of a measured line, for docs/how_to/measured_line.md and the README.

`python -m tools.measured_line_pictures FOLDER` reads seeds.csv, noise.csv and ramps.csv in FOLDER/measured_line, which
come from the sweeps on the pages of the measured line, and runs CutToLength/measured_line. It draws length_errors.svg,
smoothing_time.svg and measured_line.svg in FOLDER.
"""

import csv
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import erf, sqrt
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from motionsync_fmu.api.scenario_source import load
from motionsync_fmu.batch.scripted_runs import run_scenarios
from motionsync_fmu.pages.pictures import SHADE, STYLE, write_svg
from motionsync_fmu.pages.report.histogram import bar_borders
from motionsync_fmu.pages.style import MASTER, SLAVE
from motionsync_fmu.scenario.evaluate.key_figures import compute_key_figures
from motionsync_fmu.scenario.evaluate.time_series import true_stretches
from motionsync_fmu.scenario.evaluate.true_pieces import TruePiece
from motionsync_fmu.scenario.files.shipped import find_scenario
from motionsync_fmu.scenario.recording import Recording

Reals = NDArray[np.float64]

SCENARIO = Path("CutToLength/measured_line")
SMOOTHING_TIME, PRODUCT, ERROR = "master.smoothing_time", "product", "error"
RIGHT, WRONG = "#17713a", SLAVE
TOLERANCE = 0.1  # mm, of the scenario
FORGOTTEN = {"master.delay": "0.002"}  # s: that of the encoder alone; the servo's dead time of 2 ms is forgotten
STEP, NOISE, ACCELERATION = 0.002, sqrt(0.02**2 + 0.05**2 / 12.0), 250.0  # s, mm, mm/s2: of the scenario
THIN = 10  # of the recording's points, one so often is drawn


@dataclass(frozen=True)
class ErrorTable:
    """The true length errors in a CSV file, one a row; all arrays have the shape (rows,).

    Attributes:
        smoothing_time: in s; empty where the file has none.
        product: the number of the product in its run, from 1.
        error: in mm.
    """

    smoothing_time: Reals
    product: Reals
    error: Reals

    @classmethod
    def read(cls, file: Path) -> "ErrorTable":
        """The rows of a file."""
        with file.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        smoothing_times = [float(row[SMOOTHING_TIME]) for row in rows if SMOOTHING_TIME in row]
        columns = (smoothing_times, *([float(row[name]) for row in rows] for name in (PRODUCT, ERROR)))
        return cls(*map(np.array, columns))

    def times(self) -> list[float]:
        """The smoothing times, in rising order."""
        return sorted(set(self.smoothing_time.tolist()))

    def sigma_of_noise(self, smoothing_time: float) -> float:
        """One sigma of the same product in runs with different noise, in mm: the root of the mean of the variances."""
        at_time = self.smoothing_time == smoothing_time
        products = set(self.product[at_time].tolist())
        variances = [np.var(self.error[at_time & (self.product == product)], ddof=1) for product in products]
        return sqrt(float(np.mean(variances)))

    def greatest(self, smoothing_time: float) -> float:
        """The greatest magnitude of an error, in mm."""
        return float(np.abs(self.error[self.smoothing_time == smoothing_time]).max())


def predict_noise(smoothing_time: float) -> float:
    """One sigma of a length, in mm, if two independent positions with the noise of the page bound it."""
    return sqrt(2.0) * 1.187 * NOISE * sqrt(STEP / smoothing_time)


def predict_ramp_error(smoothing_time: float) -> float:
    """The greatest error of the position after the line's acceleration has changed, in mm."""
    return 2.0 * ACCELERATION * smoothing_time**2


def draw_histogram(errors: Reals) -> bytes:
    """Draw how many products have which true length error, within the tolerance."""
    mean, sigma = float(errors.mean()), float(errors.std(ddof=1))
    low, high = np.quantile(errors, (0.005, 0.995))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 3.2), layout="constrained")
        axes = figure.subplots()
        borders = bar_borders(float(errors.min()), float(errors.max()), len(errors), TOLERANCE)
        axes.stairs(np.histogram(errors, borders)[0], borders, fill=True, color=RIGHT, label="products")
        x = np.linspace(mean - 4.0 * sigma, mean + 4.0 * sigma, 120)
        half = 0.5 * (borders[1] - borders[0])
        scale = 1.0 / (sqrt(2.0) * sigma)
        expected = [0.5 * len(errors) * (erf((e - mean + half) * scale) - erf((e - mean - half) * scale)) for e in x]
        axes.plot(x, expected, color=MASTER, linewidth=1.4, label="normal distribution")
        axes.axvspan(low, high, label=f"99 %: {low:.3f} to {high:.3f} mm", **SHADE)
        for limit, label in ((-TOLERANCE, "tolerance"), (TOLERANCE, "_")):
            axes.axvline(limit, color=WRONG, linewidth=1.2, linestyle="--", label=label)
        axes.set(xticks=[-0.1, -0.05, 0.0, 0.05, 0.1], xlabel="true length error in mm", ylabel="products")
        axes.legend(frameon=False, fontsize="small", loc="upper right", bbox_to_anchor=(0.96, 1.0))
        return write_svg(figure)


def draw_trade(noise: ErrorTable, ramps: ErrorTable) -> bytes:
    """Draw what the smoothing time does: the sigma from noise, and the greatest error on a line that ramps."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 3.6), layout="constrained")
        axes = figure.subplots()
        for table, value, predict, colour, marker, label in (
            (noise, ErrorTable.sigma_of_noise, predict_noise, MASTER, "o", "sigma from the encoder's noise"),
            (ramps, ErrorTable.greatest, predict_ramp_error, SLAVE, "s", "greatest error on a line that ramps"),
        ):
            times = table.times()
            milliseconds = [1e3 * time for time in times]
            axes.plot(milliseconds, [value(table, time) for time in times], marker, color=colour, label=label)
            axes.plot(milliseconds, [predict(time) for time in times], color=colour, linewidth=1.0)
        axes.set(xscale="log", yscale="log", xlabel="smoothing time in ms", ylabel="true length error in mm")
        ticks = [5, 10, 20, 40, 80]
        axes.set_xticks(ticks, [str(tick) for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.set_yticks([0.01, 0.1, 1.0], ["0.01", "0.1", "1"])
        axes.legend(frameon=False, fontsize="small")
        return write_svg(figure)


def run_line() -> tuple[Recording, list[TruePiece], list[TruePiece]]:
    """Run the scenario, and again with a forgotten delay: the first recording, and the pieces of both."""
    file = find_scenario(SCENARIO)
    scenarios = [load(file, set=values) for values in ({}, FORGOTTEN)]
    outputs = [v.name for v in scenarios[0].recipe.variables.values() if not v.settable]
    recordings = [run.recording for run in run_scenarios(scenarios, outputs) if run.recording]
    figures = [compute_key_figures(s, recording) for s, recording in zip(scenarios, recordings, strict=True)]
    right, forgotten = (list(f.true_pieces.pieces) for f in figures if f.true_pieces)
    return recordings[0], right, forgotten


def draw_line(recording: Recording, right: Sequence[TruePiece], forgotten: Sequence[TruePiece]) -> bytes:
    """Draw the line's velocity with the cuts, and below it the length errors of the pieces, true and believed."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 4.4), layout="constrained")
        line, lengths = figure.subplots(2, 1, sharex=True, height_ratios=(2, 3))
        _draw_velocity(line, recording)
        lengths.axhspan(-TOLERANCE, TOLERANCE, label="tolerance", **SHADE)
        for pieces, marker, colour, label in (
            (forgotten, "^", WRONG, "true, 2 ms of the delay forgotten"),
            (right, "o", RIGHT, "true"),
        ):
            errors = [piece.error for piece in pieces]
            lengths.plot([piece.at for piece in pieces], errors, marker, color=colour, markersize=5, label=label)
        believed = [(piece.believed or 0.0) - piece.ordered for piece in forgotten]
        at = [piece.at for piece in forgotten]
        lengths.plot(at, believed, "x", color="black", markersize=4, label="believed, in both runs")
        lengths.set_ylabel("length error\nmm")
        lengths.set_xlabel("time in s")
        lengths.legend(frameon=False, fontsize="small", ncols=2, loc="upper left")
        lengths.set_ylim(top=0.85)
        figure.align_ylabels()
        return write_svg(figure)


def _draw_velocity(axes: Axes, recording: Recording) -> None:
    axes.plot(recording.time[::THIN], recording.master[::THIN, 1], color=MASTER, linewidth=1.8)
    for first, after in true_stretches(recording.values["tool.cutting"]):
        axes.axvspan(recording.time[first], recording.time[after - 1], **SHADE)
    axes.set_ylabel("line velocity\nmm/s")
    axes.set_title("shaded: the saw cuts", fontsize="small", loc="right")


def main() -> None:
    """Draw the pictures into the folder that the command line names."""
    folder = Path(sys.argv[1])
    seeds, noise, ramps = (
        ErrorTable.read(folder / "measured_line" / f"{name}.csv") for name in ("seeds", "noise", "ramps")
    )
    (folder / "length_errors.svg").write_bytes(draw_histogram(seeds.error))
    (folder / "smoothing_time.svg").write_bytes(draw_trade(noise, ramps))
    (folder / "measured_line.svg").write_bytes(draw_line(*run_line()))


if __name__ == "__main__":
    main()
