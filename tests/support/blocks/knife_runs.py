"""Runs of a knife with a servo and a motor, with as many pieces as a test wants."""

from pathlib import Path

from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from tests.support.scenarios.recordings import run_compiled

TEXT = """\
title = "A knife with a motor"
fmu = "RotaryKnife"
slave_unit = "deg"
stop_time = {stop_time}
step_size = 0.005
[start]
length = 500.0
"order.length" = 400.0
"order.quantity" = {first}
"sync.before" = 20.0
"sync.after" = 20.0
front_position = -2000.0
[master]
velocity = 1000.0
[servo]
position_gain = 50.0
[load]
inertia = 0.2
friction = 1.0
peak_force = 90.0
continuous_force = 30.0
[cuts]
tolerance = 0.5
[[set]]
at = 0.01
"order.add" = true
[[set]]
at = 0.02
start = true
"""


def run_knife(folder: Path, count: int, first: int) -> tuple[Scenario, Recording]:
    """A run at 1000 mm/s in which `count` pieces are cut off: `first` of 400 mm, the others of 500 mm. The cut at the
    front end comes after 2 s, that of the last piece 0.2 s before the end."""
    length = 400.0 * min(first, count) + 500.0 * max(count - first, 0)
    file = folder / f"knife_{count}_{first}.toml"
    file.write_text(TEXT.format(stop_time=2.2 + length / 1000.0, first=first), "utf-8")
    scenario = load_scenario(file)
    (run,) = run_compiled(scenario)
    assert run.recording, run.failure
    return scenario, run.recording
