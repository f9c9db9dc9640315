"""A scenario of a saw that moves freely, for tests of what may be added to a scenario."""

from pathlib import Path

FREE_SAW = """\
title = "A free saw at 100 mm/s"
fmu = "FlyingSaw"
stop_time = 2.0
step_size = 0.01

[start]
"axis.initial_velocity" = 100.0
"move_velocity.velocity" = 100.0

[master]
"""


def written(text: str, folder: Path) -> Path:
    """A scenario file with this text."""
    file = folder / "scenario.toml"
    file.write_text(text, "utf-8")
    return file
