"""motionsync new"""

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from motionsync.blocks import BLOCKS

from ..errors import resolve_name
from ..pages.console import out


def command(
    block: Annotated[str, typer.Argument(help="The block that the scenario runs.")],
    folder: Annotated[Path, typer.Argument(help="Where to write scenario.toml; the folder is made if it is missing.")],
    length: Annotated[str | None, typer.Option(metavar="MM", help="How long the pieces are.")] = None,
    line_speed: Annotated[str | None, typer.Option(metavar="MM/S", help="How fast the line runs.")] = None,
    stroke: Annotated[str | None, typer.Option(metavar="MM", help="How far a saw's carriage can travel.")] = None,
    circumference: Annotated[
        str | None, typer.Option(metavar="MM", help="Of the circle on which a rotary knife's edges run.")
    ] = None,
    blades: Annotated[
        str | None, typer.Option(metavar="N", help="How many blades a rotary knife has, evenly spaced.")
    ] = None,
    max_velocity: Annotated[str | None, typer.Option(metavar="MM/S", help="How fast the axis can be.")] = None,
    max_acceleration: Annotated[
        str | None, typer.Option(metavar="MM/S2", help="How fast the axis can accelerate and brake.")
    ] = None,
    cut_time: Annotated[str | None, typer.Option(metavar="S", help="How long a cut of a CutToLength takes.")] = None,
) -> None:
    """Write a short scenario that runs, as the start of one of your own, with the figures of your machine.

    A figure may have a unit of its own: "40 m/min", "6 m". At a terminal those that are not given are asked for. The
    scenario expects what stays true when its figures are changed: no cut is skipped, each piece is as long as ordered.

    Examples:

        motionsync new CutToLength my_saw

        motionsync new CutToLength tube --length 6000 --line-speed "40 m/min" --stroke 5000 --max-velocity 2000 \
--max-acceleration 4000 --cut-time 2

        motionsync new RotaryKnife my_knife --length 600 --line-speed "100 m/min" --circumference 500 --blades 2
    """
    from ..api.new import new

    figures = {
        "length": length,
        "line_speed": line_speed,
        "stroke": stroke,
        "circumference": circumference,
        "blades": blades,
        "max_velocity": max_velocity,
        "max_acceleration": max_acceleration,
        "cut_time": cut_time,
    }
    name = resolve_name(BLOCKS, block, "block")
    if sys.stdin.isatty():
        figures |= _ask(name, {key for key, value in figures.items() if value is not None})
    file = new(name, folder, **figures)
    out.print(f"written: {escape(str(file))}")
    out.print(f"run it:  motionsync run {escape(str(folder))} --open")
    out.print(f"names:   motionsync describe {name}")


def _ask(block: str, given: set[str]) -> dict[str, str]:
    """The figures that the user types, by name; what is left as it was in the template is left out."""
    from ..scenario.files.new_scenario import figures

    return {
        figure.name: answer
        for figure in figures(block)
        if figure.name not in given
        and (answer := typer.prompt(f"{figure.name.replace('_', ' ')}, {figure.meaning}", default=figure.value))
        != figure.value
    }
