"""What `motionsync new` does."""

from __future__ import annotations  # help() shows the types as they are written here

from pathlib import Path

from motionsync.blocks import BLOCKS

from ..errors import UserError, resolve_name
from ..paths import replace_file
from ..scenario.files.new_scenario import new_scenario
from ..scenario.files.shipped import SCENARIO_FILE

Quantity = float | str
"""A number in the scenario's unit (mm, mm/s, mm/s2, s), or a text with its own: `"40 m/min"`."""


def new(
    block: str,
    folder: str | Path,
    *,
    length: Quantity | None = None,
    line_speed: Quantity | None = None,
    stroke: Quantity | None = None,
    circumference: Quantity | None = None,
    blades: int | str | None = None,
    max_velocity: Quantity | None = None,
    max_acceleration: Quantity | None = None,
    cut_time: Quantity | None = None,
) -> Path:
    """Write a scenario that runs, as the start of one of your own; return its file.

    It has at most 40 lines, says in each what to change for another machine, and expects what stays true then.

    Args:
        block: what the scenario runs.
        folder: where to write `scenario.toml`; it is made if it is missing.
        length: of the pieces; of a Follower, the master's way from one meeting to the next.
        line_speed: how fast the line, or the master, runs.
        stroke: how far the carriage of a saw can travel from its home.
        circumference: of a RotaryKnife, that of the circle on which the edges run.
        blades: how many blades a RotaryKnife has, evenly spaced.
        max_velocity: of the slave's axis.
        max_acceleration: of the slave's axis, and its deceleration.
        cut_time: how long a cut of a CutToLength takes.

    Raises:
        UserError: there is no such block, it has no such figure, a value is not allowed, or the file exists.
    """
    name, file = resolve_name(BLOCKS, block, "block"), Path(folder) / SCENARIO_FILE
    if file.exists():
        raise UserError(f"{file} exists: name another folder")
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
    text = new_scenario(name, {key: value for key, value in figures.items() if value is not None}, file)
    with replace_file(file) as part:
        part.write_text(text, "utf-8")
    return file
