"""Texts of scenarios: of saws, of a line that follows its slave, of a Synchronizer; and mistakes in such texts."""

from pathlib import Path

import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.scenario.files.reader import load_scenario

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

EVEN_RAMP = """\
title = "A saw at rest comes into sync over an even ramp"
fmu = "FlyingSaw"
stop_time = 1.0
step_size = 0.02
[start]
"axis.max_velocity" = 1e6
"axis.max_acceleration" = 4000.0
"gear_in_pos.slave_sync_position" = 100.0
"gear_in_pos.master_start_distance" = 200.0
"gear_in_pos.master_sync_position" = 310.0
[master]
velocity = 500.0
[[set]]
at = 0.02
"gear_in_pos.execute" = true
"""

VALID = """\
title = "A good one"
source = "By hand"
fmu = "Synchronizer"
unit = "deg"
stop_time = 4.0
step_size = 0.01
tolerance = 1e-9

[start]
"master.period" = 360.0
curve = "PARABOLA"
active = true

[master]
position = 0.0
velocity = 90.0
segments = [
    { duration = 1.0, acceleration = 1.0 },
    { duration = 1.5 },
]

[[set]]
at = 0.5
stop = true

[[set]]
at = 1.5
output_phasing = 45.0

[[expect]]
at = 2.0
"slave.position" = 1.0
tolerance = 1e-6

[[expect]]
when = "syn_ramp_on"
time = 1.0

[[expect]]
from = 0.0
to = 1.0
"slave.velocity" = { min = 0.0, max = 90.0 }
"""
SEGMENTS = VALID[VALID.index("segments") : VALID.index("]\n\n[[set]]") + 1]
ENCODED_SAW = """\
title = "A saw whose master is an encoder"
fmu = "FlyingSaw"
stop_time = 2.5
step_size = 0.001
[start]
"sync_mode.check_overshoot_velocity" = true
"gear_in_pos.master_sync_position" = 1100.0
"gear_in_pos.slave_sync_position" = 750.0
[master]
velocity = 437.7
[encoder]
resolution = 0.1
[[set]]
at = 0.2
"gear_in_pos.execute" = true
"""
COUPLED = """\
title = "The line follows a slave that goes half as fast as the line itself"
fmu = "Gearing"
stop_time = 2.0
step_size = 0.01

[start]
"gear_in.start_mode" = "CW_CCW_DIRECT"
"gear_in.transition" = "NONE"
"gearing.numerator" = 1
"gearing.denominator" = 2

[master]
velocity = 100.0
follows = "slave.velocity"
time_constant = 0.3

[[set]]
at = 0.1
start = true
"""


def write_scenario(text: str, folder: Path) -> Path:
    """Write a scenario file with this text."""
    file = folder / "scenario.toml"
    file.write_text(text, "utf-8")
    return file


def assert_refused(text: str, folder: Path, at: int | str, key: str, *parts: str) -> None:
    """Check that a scenario with this text is refused by one line that has file, line, key and these words.

    `at`: the number of the line, or a text that begins on it."""
    file = write_scenario(text, folder)
    line = at if isinstance(at, int) else text[: text.index(at)].count("\n") + 1
    with pytest.raises(UserError) as error:
        load_scenario(file)
    place, message = f"{file}:{line}: {key}: ", str(error.value)
    assert message.startswith(place)
    assert [part for part in parts if part not in message.removeprefix(place)] == []
    assert "\n" not in message


def check_mistake(table: str, text: str, key: str, why: str, folder: Path) -> None:
    """Check that a free saw with this text in a table is refused by one line with the key's place, and why."""
    whole = f"{FREE_SAW}[{table}]\n{text}\n"
    at = next((n for n, line in enumerate(whole.split("\n"), 1) if line.startswith(f"{key} =")), f"[{table}]")
    assert_refused(whole, folder, at, key, why)
