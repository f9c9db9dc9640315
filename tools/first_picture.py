"""The first picture of the README and of the site: a saw that cuts a running line, which moves, above its curves.

`python -m tools.first_picture FOLDER` writes FOLDER/first_picture.svg. The run is the example of CutToLength with
pieces of one length; the picture repeats two of its cycles. Where a reader prefers no motion it shows the saw in a cut.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.path import Path as Line

from motionsync_fmu.pages.compact import compact
from motionsync_fmu.pages.pictures import piece_ends
from motionsync_fmu.pages.style import MASTER, SLAVE, load_template
from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.evaluate.time_series import true_stretches
from motionsync_fmu.scenario.files.example import load_example
from motionsync_fmu.scenario.recording import Reals
from motionsync_fmu.scenario.run.simulation import run_in_process

FILE = "first_picture.svg"
LENGTH, VELOCITY = 800.0, 500.0  # of the pieces in mm, of the line in mm/s
DURATION = 2.0 * LENGTH / VELOCITY  # s, of two cycles: the end is like the beginning
SLOWER = 2.0  # than it is, so many times
BEFORE = 0.55  # s, from the beginning of the picture to its first cut
STEP, FRAME = 0.001, 0.04  # s, of the run, and between two places of the saw that moves
WIDTH, LEFT, RIGHT = 640, 62, 626  # px, of the picture; the borders of plots and line
LEAST, MOST = -300.0, 560.0  # mm, the positions of the saw at these borders
DASHES = 20  # of the line's grain, in a piece
DEPTH, PLUNGE = 62, 0.1  # px and s, by which the blade goes down
OUT = 20.0  # mm, how far the gap of a cut goes beyond the border


@dataclass(frozen=True)
class Cycles:
    """The part of the run that is shown, from time 0 on, in s, mm and mm/s, each of shape (points,).

    Attributes:
        saw, velocity: of the saw.
        end: of the piece that is next, as a position of the saw; NaN where none is near.
        length: of the piece so far.
        cuts: when each cut begins and ends.
    """

    time: Reals
    saw: Reals
    velocity: Reals
    end: Reals
    length: Reals
    cuts: list[tuple[float, float]]

    def place(self, time: float) -> float:
        """Where the saw is, in px from home."""
        return across(float(np.interp(time, self.time, self.saw))) - across(0.0)


def run_cycles() -> Cycles:
    """Run the example with pieces of one length; of it two cycles from the second cut on."""
    example = load_example("CutToLength")
    settings = tuple(s for s in example.settings if "start" in s.values)
    start = {**example.start, "length": LENGTH}
    scenario = replace(example, start=start, settings=settings, expectations=(), pieces=None, stop_time=8.0)
    recording = run_in_process(scenario, STEP)
    values, cutting = recording.values, recording.values["tool.cutting"] != 0.0
    _, (first, _), *_ = true_stretches(cutting)
    first -= round(BEFORE / STEP)
    at = slice(first, first + round(DURATION / STEP) + 1)
    time = recording.time[at] - recording.time[first]
    return Cycles(
        time,
        values["slave.position"][at],
        values["slave.velocity"][at],
        piece_ends(find_pieces(scenario, recording), scenario, recording)[at],
        values["piece.length"][at],
        [(float(time[begin]), float(time[after - 1])) for begin, after in true_stretches(cutting[at])],
    )


def draw(cycles: Cycles) -> bytes:
    """The picture as SVG."""
    still = 0.5 * sum(cycles.cuts[0])
    values = {
        "width": WIDTH,
        "left": LEFT,
        "right": RIGHT,
        "home": round(across(0.0), 1),
        "depth": DEPTH,
        "dash": round(travel(LENGTH) / DASHES / 2.0, 3),
        "still": round(cycles.place(still), 1),
        "now": round(along(still) - LEFT, 1),
        "seconds": f"{SLOWER * DURATION:g}",
        "movements": {name: _percent(frames) for name, frames in _movements(cycles).items()},
        "gaps": [f"gap{i}" for i in range(len(cycles.cuts))],
        "line": f"line, {VELOCITY:g} mm/s",
        "pieces": f"pieces of {LENGTH:g} mm",
        "cuts": [(along(begin), along(end)) for begin, end in cycles.cuts],
        "rows": _rows(cycles),
        "times": [(along(second), f"{second} s" if second else "0") for second in range(int(DURATION) + 1)],
        "master": MASTER,
        "slave": SLAVE,
    }
    return compact(load_template(Path(__file__).parent, f"{FILE}.j2").render(values).encode() + b"\n")


def across(position: float) -> float:
    """Where a position of the saw is, in px."""
    return LEFT + (RIGHT - LEFT) * (position - LEAST) / (MOST - LEAST)


def travel(distance: float) -> float:
    """A distance on the line, in px."""
    return across(distance) - across(0.0)


def along(time: float) -> float:
    """Where a time is in the plots, in px."""
    return round(LEFT + (RIGHT - LEFT) * time / DURATION, 1)


Frames = list[tuple[float, str]]
"""Times in s, and how something is drawn then, as CSS has it; in between it moves evenly."""


def _movements(cycles: Cycles) -> dict[str, Frames]:
    """What moves: the cursor of the plots, the line, saw and blade, and the gap of each cut, from its end on."""
    times = np.linspace(0.0, DURATION, 1 + round(DURATION / FRAME)).tolist()
    movements = {
        "now": [(0.0, _moved(0.0)), (DURATION, _moved(RIGHT - LEFT))],
        "grain": [(0.0, "stroke-dashoffset:0"), (DURATION, f"stroke-dashoffset:{-travel(2.0 * LENGTH):.2f}")],
        "saw": [(t, _moved(cycles.place(t))) for t in times],
        "blade": [(0.0, _moved(0.0)), (DURATION, _moved(0.0))],
    }
    for i, (begin, end) in enumerate(cycles.cuts):
        down, up = _moved(0.0, DEPTH), _moved(0.0)
        movements["blade"][-1:-1] = [(begin - PLUNGE, up), (begin, down), (end, down), (end + PLUNGE, up)]
        first = float(np.interp(end, cycles.time, cycles.saw))
        gone = end + (MOST + OUT - first) / VELOCITY
        at_saw, outside = _moved(travel(first)), _moved(travel(MOST + OUT))
        movements[f"gap{i}"] = [
            (0.0, f"opacity:0;{at_saw}"),
            (end - STEP, f"opacity:0;{at_saw}"),
            (end, f"opacity:1;{at_saw}"),
            (gone, f"opacity:1;{outside}"),
            (DURATION, f"opacity:0;{outside}"),
        ]
    return movements


def _moved(x: float, y: float = 0.0) -> str:
    return f"transform:translate({x:.1f}px,{y:g}px)"


def _percent(frames: Frames) -> list[tuple[str, str]]:
    return [(f"{100.0 * time / DURATION:.4g}", style) for time, style in frames]


def _rows(cycles: Cycles) -> list[dict[str, Any]]:
    """The plots from the top: title, place in px, ticks, curves and their names."""
    line = np.full(len(cycles.time), VELOCITY)
    return [
        _row(
            "position in mm",
            (196, 300),
            (0, 100, 200),
            [(cycles.end, MASTER, "end of the piece"), (cycles.saw, SLAVE, "saw")],
        ),
        _row("velocity in mm/s", (320, 382), (-500, 0, 500), [(line, MASTER, "line"), (cycles.velocity, SLAVE, "saw")]),
        _row("length of the piece in mm", (402, 442), (0, 400, 800), [(cycles.length, SLAVE, "")]),
    ]


def _row(
    title: str, span: tuple[int, int], ticks: Sequence[int], curves: Sequence[tuple[Reals, str, str]]
) -> dict[str, Any]:
    top, bottom = span
    least, most = (float(f([f(v) for v, *_ in curves])) for f in (np.nanmin, np.nanmax))
    scale = (bottom - top - 6.0) / (most - least)  # with 3 px at both ends

    def up(values: Any) -> Any:
        return bottom - 3.0 - scale * (values - least)

    return {
        "title": title,
        "top": top,
        "ticks": [(round(up(tick), 1), str(tick).replace("-", "\N{MINUS SIGN}")) for tick in ticks],
        "curves": [(_path(up(values)), colour) for values, colour, _ in curves],
        "names": [(name, colour) for *_, colour, name in curves],
    }


def _path(y: Reals) -> str:
    """A curve of evenly spaced points over the whole time, as SVG has it."""
    segments = Line(np.column_stack([np.linspace(LEFT, RIGHT, len(y)), y])).iter_segments(simplify=True)
    letters = {Line.MOVETO: "M", Line.LINETO: "L"}
    return "".join(f"{letters[code]} {x:.4f} {up:.4f} \n" for (x, up), code in segments)


def main() -> None:
    """Draw the picture into the folder that the command line names."""
    Path(sys.argv[1], FILE).write_bytes(draw(run_cycles()))


if __name__ == "__main__":
    main()
