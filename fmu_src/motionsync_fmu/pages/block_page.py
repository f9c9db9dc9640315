"""The pages inside an FMU: what the block does, its variables, and a picture of a transition; all from its source."""

import io
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import jinja2
import matplotlib
from markupsafe import Markup, escape
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from motionsync.blocks import BLOCKS, Example, RemoteExample
from motionsync.master import MasterInput
from motionsync.var import Unit

from .. import __version__
from ..archive import Files
from ..errors import UserError
from ..interface.table import groups
from ..interface.units import axis_label, unit_name
from ..interface.variables import Cell, cells, members, summary, variables
from ..native.platforms import PLATFORMS
from ..scenario.clocks import Clocks, Rate
from ..scenario.script import Script

TEMPLATES = jinja2.Environment(
    loader=jinja2.PackageLoader("motionsync_fmu.pages"), autoescape=True, trim_blocks=True, lstrip_blocks=True
)
TEMPLATES.filters["code"] = lambda text: Markup(re.sub("`(.*?)`", r"<code>\1</code>", str(escape(text))))
STYLE: Any = {  # the same picture at every build
    "svg.hashsalt": "motionsync",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
}
MASTER, SLAVE = "#7a8793", "#c8451b"
VARIANTS = (SLAVE, "#1f6fb2")  # of a block, beside one another
COLOURS = 32  # of the icon: shades of few
SHADE: Any = {"color": "#d5ead8", "linewidth": 0.0, "zorder": 0}
DRAWN = ("position", "velocity", "acceleration")
SAMPLES = 250


def pages(name: str, block: Any, unit: str, flavour: str, platforms: list[str], slave_unit: str = "") -> Files:
    """index.html, its picture, and for the python flavour externalDependencies.html.

    `block` has the FMU's start values; `platforms`: the folders of its binaries; `slave_unit`: empty, `unit`.
    """
    values = {
        "name": name,
        "version": __version__,
        "summary": summary(type(block)),
        "paragraphs": paragraphs(type(block)),
        "caption": BLOCKS[name].example.caption,
        "inputs": list(MasterInput),
        "remote": isinstance(BLOCKS[name].example, RemoteExample),
        "guide": BLOCKS[name].guide,
        "names": BLOCKS[name].names,
        "groups": groups(block, unit, slave_unit),
        "choices": {v.cell.type: v.choices for v in variables(block) if v.choices},
        "codes": {v.declaration.codes: members(v.declaration.codes) for v in variables(block) if v.declaration.codes},
        "describe": summary,
        "flavour": flavour,
        "platforms": {p: PLATFORMS[p].title for p in platforms},
    }
    names = ["index.html"] + (["externalDependencies.html"] if flavour == "python" else [])
    files = {page: TEMPLATES.get_template(f"{page}.j2").render(values).encode() for page in names}
    return files | {"transition.svg": transition(name, unit, slave_unit)}


def paragraphs(thing: Any) -> list[str]:
    """A docstring's paragraphs after its first line."""
    return [" ".join(p.split()) for p in (thing.__doc__ or "").split("\n\n")[1:] if p.strip()]


@dataclass(frozen=True)
class Line:
    """Values over a panel's time."""

    label: str
    colour: str
    width: float
    values: list[float]


@dataclass(frozen=True)
class Panel:
    """A part of a block's picture: what it shows in which unit, lines over a time, and where it is shaded."""

    label: str
    time: list[float]
    lines: list[Line]
    shaded: list[bool]


def panels(name: str, unit: str, slave_unit: str = "") -> list[Panel]:
    """The block's example in plain Python: the main panel, then two lower ones.

    Raises:
        UserError: the block refuses it.
    """
    example = BLOCKS[name].example
    return _of_clocks(name, example, unit) if isinstance(example, RemoteExample) else _of_axes(name, unit, slave_unit)


def _of_axes(name: str, unit: str, slave_unit: str) -> list[Panel]:
    """Position and velocity of master and slave, and the slave's acceleration."""
    courses = run(name)
    shaded = [bool(x) for x in courses["shaded"]]

    def panel(kind: Unit, master: str, slave: str) -> Panel:
        of_slave = unit_name(kind, slave_unit or unit)
        label = axis_label(kind, unit, slave_unit) if master else of_slave
        lines = [Line("master", MASTER, 1.5, broken(courses[master]))] if master else []
        return Panel(
            kind.quantity.lower() + (f"\n{label}" if label else ""),
            courses["time"],
            [*lines, Line("slave", SLAVE, 2.2, broken(courses[slave]))],
            shaded,
        )

    return [
        panel(Unit.POSITION, "master", "position"),
        panel(Unit.VELOCITY, "master_velocity", "velocity"),
        panel(Unit.ACCELERATION, "", "acceleration"),
    ]


def run(name: str) -> dict[str, list[float]]:
    """An example's courses over time: master, slave and what is shaded."""
    example = BLOCKS[name].example
    assert isinstance(example, Example)
    block, by_name = started(name, example.start)
    h = example.duration / SAMPLES
    waiting = list(example.inputs)
    courses: dict[str, list[float]] = {n: [] for n in ("time", "master", "master_velocity", "shaded", *DRAWN)}
    for i in range(SAMPLES):
        while waiting and waiting[0][0] <= i * h:
            for variable, value in waiting.pop(0)[1].items():
                by_name[variable].set(value)
        block.master.position = example.velocity * i * h
        attempt(name, block.step(h))
        courses["time"].append((i + 1) * h)
        courses["master"].append(block.master.end % block.master.period if block.master.period else block.master.end)
        courses["master_velocity"].append(block.master.end_velocity)
        courses["shaded"].append(by_name[example.shaded].get() if example.shaded else False)
        for n in DRAWN:
            courses[n].append(getattr(block.slave, n))
    return courses


def _of_clocks(name: str, example: RemoteExample, unit: str) -> list[Panel]:
    """How far the position is from the true one, how far the index is ahead of the receiver's, and the drift."""
    cycle = float(example.start["task_cycle_time"])
    cycles = round(example.duration / cycle)
    axis = Script(0.0, example.velocity, 0.0, [])
    seen = Clocks(cycle, (Rate(0.0, example.sender_cycle),)).telegrams(axis, cycles)
    time = [i * cycle for i in range(cycles)]
    drawn = slice(0, cycles, max(cycles // SAMPLES, 1))
    received = [position - example.velocity * t for position, t in zip(seen.motion[:, 0].tolist(), time, strict=True)]
    lines = [
        [Line("as received", MASTER, 1.2, received)],
        [Line("as received", MASTER, 1.2, [k - i for i, k in enumerate(seen.index.tolist())])],
        [],
    ]
    for (label, start), colour in zip(example.variants.items(), VARIANTS, strict=False):
        block, by_name = started(name, {**example.start, **start})
        found: list[list[float]] = [[], [], []]
        for i, t in enumerate(time):
            block.remote.cycle_index = int(seen.cycle_index[i])
            block.remote.position, block.remote.velocity, block.remote.acceleration = seen.motion[i].tolist()
            attempt(name, block.step(cycle))
            found[0].append(block.slave.position - example.velocity * t)
            found[1].append(by_name["corrected_cycle_index"].get() - i)
            found[2].append(by_name["drift"].get())
        for panel, values in zip(lines, found, strict=True):
            panel.append(Line(label, colour, 2.0, values))
    symbol = unit_name(Unit.POSITION, unit)
    labels = ("position - true one" + (f"\n{symbol}" if symbol else ""), "index - receiver's", "drift\nppm")
    thin = [[replace(line, values=line.values[drawn]) for line in of] for of in lines]
    return [Panel(label, time[drawn], of, []) for label, of in zip(labels, thin, strict=True)]


def started(name: str, start: Mapping[str, Any]) -> tuple[Any, dict[str, Cell]]:
    """A block with these start values, initialized, and its cells."""
    block = BLOCKS[name].type()
    by_name = {c.name: c for c in cells(block)}
    for variable, value in start.items():
        by_name[variable].set(value)
    attempt(name, block.initialize())
    return block, by_name


def attempt(name: str, refusal: Any) -> None:
    if refusal:
        raise UserError(f"the example of {name} in blocks.py is refused: {refusal.description}")


def transition(name: str, unit: str, slave_unit: str = "") -> bytes:
    """The example as an SVG."""
    shown = panels(name, unit, slave_unit)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 5.8), layout="constrained")
        parts = figure.subplots(len(shown), 1, sharex=True, height_ratios=(2, *(1 for _ in shown[1:])))
        for axes, panel in zip(parts, shown, strict=True):
            plot(axes, panel)
            if any(panel.shaded):
                axes.fill_between(panel.time, 0.0, 1.0, panel.shaded, transform=axes.get_xaxis_transform(), **SHADE)
            axes.set_ylabel(panel.label)
        parts[0].legend(loc="upper left", ncols=3, frameon=False)
        figure.align_ylabels()
        parts[-1].set_xlabel("time in s")
        out = io.BytesIO()
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(rb"-?\d+\.\d{3,}", lambda x: b"%g" % round(float(x[0]), 2), out.getvalue())  # half as long


def broken(values: list[float]) -> list[float]:
    """With a gap where a period wraps."""
    jump = 0.5 * (max(values) - min(values))
    before = [values[0], *values]
    return [y if abs(y - last) <= jump else float("nan") for last, y in zip(before, values, strict=False)]


def plot(axes: Axes, panel: Panel) -> None:
    """The lines of a panel."""
    for line in panel.lines:
        axes.plot(panel.time, line.values, color=line.colour, linewidth=line.width, label=line.label)


def picture(name: str) -> bytes:
    """model.png: the example without axes, as an icon."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(1.6, 1.6), dpi=100, layout="constrained")
        axes = figure.subplots()
        plot(axes, panels(name, BLOCKS[name].example.unit)[0])
        axes.grid(visible=False)
        axes.set(xticks=[], yticks=[])
        axes.set_title(name, fontsize=9)
        out, small = io.BytesIO(), io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    Image.open(out).convert("RGB").quantize(COLOURS).save(small, "PNG", optimize=True)
    return small.getvalue()


def main() -> None:
    """Write the example of every block as FOLDER/<block>.svg: python -m motionsync_fmu.pages.block_page FOLDER."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in BLOCKS:
        (folder / f"{name}.svg").write_bytes(transition(name, BLOCKS[name].example.unit))


if __name__ == "__main__":
    main()
