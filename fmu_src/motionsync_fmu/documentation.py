"""The pages inside an FMU: what the block does, its variables, and a picture of a transition; all from its source."""

import io
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2
import matplotlib
from markupsafe import Markup, escape
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from motionsync.blocks import BLOCKS
from motionsync.declare import Unit
from motionsync.master import MasterInput

from . import __version__
from .archive import Files
from .description import axis_label, literal, summary, unit_name
from .errors import UserError
from .variables import Variable, cells, members, variables

TEMPLATES = jinja2.Environment(
    loader=jinja2.PackageLoader("motionsync_fmu"), autoescape=True, trim_blocks=True, lstrip_blocks=True
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
PLATFORMS = {  # the names that FMI gives them
    "linux64": "Linux on x86-64",
    "aarch64-linux": "Linux on 64-bit ARM",
    "win64": "Windows on x86-64",
    "darwin64": "macOS on x86-64 and on 64-bit ARM",
}
MASTER, SLAVE = "#7a8793", "#c8451b"
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
        "guide": BLOCKS[name].guide,
        "names": BLOCKS[name].names,
        "groups": groups(block, unit, slave_unit),
        "choices": {v.cell.type: v.choices for v in variables(block) if v.choices},
        "codes": {v.declaration.codes: members(v.declaration.codes) for v in variables(block) if v.declaration.codes},
        "describe": summary,
        "flavour": flavour,
        "platforms": {p: PLATFORMS[p] for p in platforms},
    }
    names = ["index.html"] + (["externalDependencies.html"] if flavour == "python" else [])
    files = {page: TEMPLATES.get_template(f"{page}.j2").render(values).encode() for page in names}
    return files | {"transition.svg": transition(name, unit, slave_unit)}


def paragraphs(thing: Any) -> list[str]:
    """A docstring's paragraphs after its first line."""
    return [" ".join(p.split()) for p in (thing.__doc__ or "").split("\n\n")[1:] if p.strip()]


@dataclass
class Group:
    """Variables that share the first part of their names, in the order of declaration; the block's own have none."""

    name: str
    summary: str
    rows: list[dict[str, str]]


def groups(block: Any, unit: str, slave_unit: str = "") -> list[Group]:
    """All variables; a group's summary is that of its part of the block."""
    found: dict[str, Group] = {}
    for v in variables(block):
        name = v.name.partition(".")[0] if "." in v.name else ""
        if name not in found:
            found[name] = Group(name, summary(type(getattr(block, name))) if name else "The block's own", [])
        found[name].rows.append(row(v, unit, slave_unit))
    return list(found.values())


def row(v: Variable, unit: str, slave_unit: str = "") -> dict[str, str]:
    """One line of a table of variables; the values as they are written."""
    return {
        "name": v.name,
        "causality": v.causality,
        "variability": v.variability,
        "type": v.cell.type.__name__ if v.choices else v.kind,
        "unit": unit_name(v.declaration.unit, unit, slave_unit),
        "start": literal(v, v.start) if v.settable else "",
        "range": v.range if v.settable and v.kind in ("Real", "Integer") else "",
        "description": v.declaration.description,
    }


def run(name: str) -> dict[str, list[float]]:
    """The block's example in plain Python: the courses over time of master, slave and what is shaded.

    Raises:
        UserError: the block refuses it.
    """
    example = BLOCKS[name].example
    block = BLOCKS[name].type()
    by_name = {c.name: c for c in cells(block)}
    for variable, value in example.start.items():
        by_name[variable].set(value)
    attempt(name, block.initialize())
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


def attempt(name: str, refusal: Any) -> None:
    if refusal:
        raise UserError(f"the example of {name} in blocks.py is refused: {refusal.description}")


def transition(name: str, unit: str, slave_unit: str = "") -> bytes:
    """The example as an SVG: position and velocity of master and slave, and the slave's acceleration."""
    courses = run(name)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.6, 5.8), layout="constrained")
        top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
        plot(top, courses)
        top.legend(loc="upper left", ncols=2, frameon=False)
        middle.plot(courses["time"], courses["master_velocity"], color=MASTER)
        for axes in (top, middle, bottom) if any(courses["shaded"]) else ():
            on = [bool(x) for x in courses["shaded"]]
            axes.fill_between(courses["time"], 0.0, 1.0, on, transform=axes.get_xaxis_transform(), **SHADE)
        for axes, n in ((middle, "velocity"), (bottom, "acceleration")):
            axes.plot(courses["time"], courses[n], color=SLAVE)
        for axes, kind in ((top, Unit.POSITION), (middle, Unit.VELOCITY), (bottom, Unit.ACCELERATION)):
            of_slave = unit_name(kind, slave_unit or unit)
            label = of_slave if axes is bottom else axis_label(kind, unit, slave_unit)
            axes.set_ylabel(kind.quantity.lower() + (f"\n{label}" if label else ""))
        figure.align_ylabels()
        bottom.set_xlabel("time in s")
        out = io.BytesIO()
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return re.sub(rb"-?\d+\.\d{3,}", lambda x: b"%g" % round(float(x[0]), 2), out.getvalue())  # half as long


def plot(axes: Axes, courses: dict[str, list[float]]) -> None:
    """Master and slave position over time; a line ends where a period wraps."""
    for n, colour, width in (("master", MASTER, 1.5), ("position", SLAVE, 2.2)):
        jump = max(courses[n]) - min(courses[n])
        broken = [
            y if abs(y - before) < 0.5 * jump else float("nan")
            for before, y in zip([courses[n][0], *courses[n]], courses[n], strict=False)
        ]
        axes.plot(courses["time"], broken, color=colour, linewidth=width, label="slave" if n == "position" else n)


def picture(name: str) -> bytes:
    """model.png: the example without axes, as an icon."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(1.6, 1.6), dpi=100, layout="constrained")
        axes = figure.subplots()
        plot(axes, run(name))
        axes.grid(visible=False)
        axes.set(xticks=[], yticks=[])
        axes.set_title(name, fontsize=9)
        out, small = io.BytesIO(), io.BytesIO()
        figure.savefig(out, format="png", metadata={"Software": None})
    Image.open(out).convert("RGB").quantize(COLOURS).save(small, "PNG", optimize=True)
    return small.getvalue()


def main() -> None:
    """Write the example of every block as FOLDER/<block>.svg: python -m motionsync_fmu.documentation FOLDER."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in BLOCKS:
        (folder / f"{name}.svg").write_bytes(transition(name, BLOCKS[name].example.unit))


if __name__ == "__main__":
    main()
