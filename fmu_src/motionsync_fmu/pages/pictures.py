"""Pictures of a block's example: the page's, the README's and the FMU's icon.

An example is the scenario in the block's folder, `example.toml`; a picture shows the outputs of a run of it in this
process. `python -m motionsync_fmu.pages.pictures FOLDER [BLOCK ...]` writes FOLDER/<block>.svg for these blocks, or for
all.
"""

import io
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from motionsync.blocks import BLOCKS
from motionsync.var import Unit

from ..interface.units import unit_name
from ..paths import replace_file
from ..scenario.cutting import CutSpec
from ..scenario.evaluate.cuts import passages, reach
from ..scenario.evaluate.find_pieces import Piece, coupling_factor, find_pieces
from ..scenario.evaluate.remote_errors import remote_errors
from ..scenario.evaluate.time_series import true_stretches
from ..scenario.files.example import load_example
from ..scenario.recording import Reals, Recording
from ..scenario.remote_view import RemoteView
from ..scenario.run.simulation import run_in_process
from ..scenario.scenario import Scenario
from .compact import compact
from .numbers import jumps
from .style import MASTER, SLAVE, typeset

STYLE: Any = {  # the same picture at every build
    "svg.hashsalt": "motionsync",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana"],
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
}
VARIANTS = (SLAVE, "#1f6fb2")  # the slave's colour in each of an example's runs
ICON_COLOURS = 8  # an icon needs few shades
SHADE: Any = {"color": "#d5ead8", "linewidth": 0.0, "zorder": 0}
OUTSIDE = 0.35  # of the saw's range: how far outside of it ends of pieces are drawn
SAMPLES = 4000  # of a run, at least: as many as make an event happen where the picture shows it


@dataclass(frozen=True)
class PictureCurve:
    """Values over a panel's time."""

    label: str
    colour: str
    width: float
    values: Reals


@dataclass(frozen=True)
class Panel:
    """One of the plots of a picture, which are above one another.

    Attributes:
        label: what is shown, in which unit.
        time: in s, shape (points,).
        shaded: where the plot is shaded, shape (points,); None: nowhere.
    """

    label: str
    time: Reals
    curves: list[PictureCurve]
    shaded: Reals | None = None


@dataclass(frozen=True)
class PictureVariant:
    """A run of the example, and the name and colour of its curves."""

    name: str
    colour: str
    recording: Recording


def make_panels(example: Scenario, unit: str, slave_unit: str = "") -> list[Panel]:
    """Make the plots of an example, the main one first.

    `unit`: the name of the unit of positions in the plots; `slave_unit`: that of the slave's positions (empty: the same
    as `unit`).

    Raises:
        UserError: the block refuses its example.
    """
    runs = [
        PictureVariant(name, colour, run_in_process(variant, _step_size(example)))
        for (name, variant), colour in zip(_variants(example).items(), VARIANTS, strict=False)
    ]
    motion = _errors(example.remote, runs, unit) if example.remote else _motion(example, runs, unit, slave_unit)
    units = unit, slave_unit
    return motion + [_curve(example, runs, name, label, units) for name, label in example.picture.curves.items()]


def _step_size(example: Scenario) -> float:
    """The step size, in s, of the runs that are drawn; of a remote axis the example's own, which fits its cycles."""
    coarse = SAMPLES * example.step_size / example.stop_time
    return example.step_size if example.remote else example.step_size / max(1, math.ceil(coarse))


def _variants(example: Scenario) -> dict[str, Scenario]:
    """The scenarios whose runs the picture shows together, by the names of their curves."""
    variants = {
        name: replace(example, start={**example.start, **start}) for name, start in example.picture.variants.items()
    }
    return variants or {"slave": example}


def _motion(example: Scenario, runs: list[PictureVariant], unit: str, slave_unit: str) -> list[Panel]:
    """Plots of position and velocity of master and slave, and of the slave's acceleration. Where the units of the two
    differ, the master has a plot of its own.

    In place of the material's position, a saw is shown with the marks that pass it, or with the cuts that it makes."""
    first = runs[0].recording
    shaded = example.picture.shaded
    position, velocity = first.master[:, 0], first.master[:, 1]
    pieces = find_pieces(example, first)
    wrapped = position % example.period if example.period else position
    master = {Unit.POSITION: _broken(first.time, wrapped, velocity), Unit.VELOCITY: velocity}

    def panels(kind: Unit, name: str) -> list[Panel]:
        label, followed, apart = unit_name(kind, slave_unit or unit), list[PictureCurve](), list[Panel]()
        shade = first.values[shaded] if shaded else None
        if kind == Unit.POSITION and example.cuts:
            followed = [PictureCurve("marks on the master", MASTER, 1.5, _marks(example.cuts, first))]
        elif kind == Unit.POSITION and pieces:
            followed = [PictureCurve("ends of the pieces", MASTER, 1.5, piece_ends(pieces, example, first))]
        elif kind in master:
            followed = [PictureCurve("master", MASTER, 1.5, master[kind])]
            if (its_own := unit_name(kind, unit)) != label:
                apart, followed = [Panel(_labelled("master", its_own), first.time, followed, shade)], []
        curves = [PictureCurve(r.name, r.colour, 2.2, _slave_values(r.recording, kind, name)) for r in runs]
        return [Panel(_labelled(name, label), first.time, followed + curves, shade), *apart]

    return [
        *panels(Unit.POSITION, "position"),
        *panels(Unit.VELOCITY, "velocity"),
        *panels(Unit.ACCELERATION, "acceleration"),
    ]


def _slave_values(recording: Recording, kind: Unit, name: str) -> Reals:
    """The slave's position, with gaps where it wraps, or a derivative of it."""
    values = recording.values[f"slave.{name}"]
    return _broken(recording.time, values, recording.values["slave.velocity"]) if kind == Unit.POSITION else values


def _marks(spec: CutSpec, recording: Recording) -> Reals:
    """The position of the mark that passes the saw at each point; a gap where none does, or before the next one."""
    positions = np.full(len(recording.time), np.nan)
    for passage in passages(spec, recording, *reach(spec, recording)):
        at = np.searchsorted(recording.time, passage.time)
        positions[at], positions[at[0]] = passage.position, np.nan
    return positions


def piece_ends(pieces: Sequence[Piece], example: Scenario, recording: Recording) -> Reals:
    """The position of the end of a piece at each point, while it passes the saw's range or is a little outside of it; a
    gap where none does, or before the next one."""
    factor = coupling_factor(example, recording)
    saw, positions = recording.values["slave.position"], np.full(len(recording.time), np.nan)
    margin = OUTSIDE * float(np.ptp(saw))
    for piece in pieces:
        passing = factor * (recording.master[:, 0] - piece.end)
        inside = np.flatnonzero((passing >= saw.min() - margin) & (passing <= saw.max() + margin))
        positions[inside] = passing[inside]
        positions[inside[:1]] = np.nan
    return positions


def _errors(remote: RemoteView, runs: list[PictureVariant], unit: str) -> list[Panel]:
    """Plots of the error of the position, and of how far the index is ahead of the receiver's own."""
    errors_of_runs = [remote_errors(remote, run.recording) for run in runs]
    cycles = _cycles(remote, errors_of_runs[0].time)
    ahead = remote.telegrams.true_index[cycles] - cycles

    def panel(label: str, received: Reals, corrected: list[Reals]) -> Panel:
        curves = [PictureCurve("as received", MASTER, 1.2, received)]
        curves += [PictureCurve(r.name, r.colour, 2.0, values) for r, values in zip(runs, corrected, strict=True)]
        return Panel(label, cycles * remote.clocks.task_cycle, curves)

    position = _labelled("position - true one", unit_name(Unit.POSITION, unit))
    return [
        panel(position, errors_of_runs[0].position, [e.corrected_position for e in errors_of_runs]),
        panel(
            "index - receiver's", errors_of_runs[0].index + ahead, [e.corrected_index + ahead for e in errors_of_runs]
        ),
    ]


def _curve(example: Scenario, runs: list[PictureVariant], name: str, label: str, units: tuple[str, str]) -> Panel:
    """A plot of one output in all runs; `units`: those of the positions of master and slave."""
    time = runs[0].recording.time[1:]
    curves = [PictureCurve(run.name, run.colour, 2.0, run.recording.values[name][1:]) for run in runs]
    if example.remote:
        time = _cycles(example.remote, time) * example.remote.clocks.task_cycle
    unit = unit_name(example.recipe.variables[name].declaration.unit, *units)
    return Panel(_labelled(label, unit), time, curves)


def _cycles(remote: RemoteView, time: Reals) -> Reals:
    """The receiver's cycles whose outputs are present at these times, and describe the axis at the cycles' instants."""
    return np.array([remote.clocks.count_cycles(t) - 1 for t in time.tolist()])


def _labelled(name: str, unit: str) -> str:
    return name + (f"\n{typeset(unit)}" if unit else "")


def _broken(time: Reals, position: Reals, velocity: Reals) -> Reals:
    """The positions, with a gap where they start their next turn."""
    broken = position.copy()
    broken[jumps(time, position, velocity)] = np.nan
    return broken


@cache
def draw_example(name: str, unit: str, slave_unit: str = "") -> bytes:
    """Draw a block's example with axes, as SVG for the block's page; units as for `make_panels`. It is drawn once in a
    process: the FMUs of both flavours and versions show the same."""
    shown = make_panels(load_example(name), unit, slave_unit)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 5.8 + max(0, len(shown) - 4)), layout="constrained")
        parts = figure.subplots(len(shown), 1, sharex=True, height_ratios=(2, *(1 for _ in shown[1:])))
        for axes, panel in zip(parts, shown, strict=True):
            _plot(axes, panel)
            axes.patch.set_visible(False)  # the whole picture has a background
            for begin, end in _stretches(panel):
                axes.axvspan(begin, end, **SHADE)
            axes.set_ylabel(panel.label)
        lines = [Line2D([], [], color=c.colour, linewidth=c.width, label=c.label) for c in shown[0].curves]
        parts[0].legend(handles=lines, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False)
        figure.align_ylabels()
        parts[-1].set_xlabel("time in s")
        return write_svg(figure)


def write_svg(figure: Figure) -> bytes:
    """Write a figure as SVG, small and the same at every build."""
    out = io.BytesIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return compact(out.getvalue())


@cache
def draw_icon(name: str) -> bytes:
    """Draw the main plot of a block's example without axes, once in a process, as a PNG that is not compressed: the
    FMU's zip file does it better."""
    example = load_example(name)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(1.28, 1.28), dpi=100, layout="constrained")
        axes = figure.subplots()
        _plot(axes, make_panels(example, example.unit)[0])
        axes.grid(visible=False)
        axes.set(xticks=[], yticks=[])
        axes.set_title(example.recipe.name, fontsize=8)
        out, small = io.BytesIO(), io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    Image.open(out).convert("RGB").quantize(ICON_COLOURS).save(small, "PNG", compress_level=0)
    return small.getvalue()


def _stretches(panel: Panel) -> Iterator[tuple[float, float]]:
    """The first and the last point of time of each stretch in which a panel is shaded."""
    if panel.shaded is not None:
        for first, after in true_stretches(panel.shaded):
            yield float(panel.time[first]), float(panel.time[after - 1])


def _plot(axes: Axes, panel: Panel) -> None:
    for curve in panel.curves:
        axes.plot(panel.time, curve.values, color=curve.colour, linewidth=curve.width)


def main() -> None:
    """Write the pictures of the blocks' examples."""
    folder, *names = sys.argv[1:]
    for name in names or BLOCKS:
        example = load_example(name)
        with replace_file(Path(folder, f"{name}.svg")) as part:
            part.write_bytes(draw_example(name, example.unit, example.slave_unit))


if __name__ == "__main__":
    main()
