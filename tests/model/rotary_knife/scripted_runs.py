"""Random scripts of a line with commands, the RotaryKnife's run along one, and its comparison with the oracle."""

from collections.abc import Iterable, Mapping
from random import Random
from typing import Any

from motionsync.master import MasterInput
from motionsync.rotary_knife.block import RotaryKnife
from tests.oracle.rotary_knife import reference
from tests.support.blocks import cutting_scripts
from tests.support.blocks.cutting_scripts import random_line, random_marks
from tests.support.blocks.oracle_runs import Script, find_differences

VELOCITIES = ("limits.max_line_velocity", "limits.max_line_velocity_orders", "line.velocity_request")
POSITIONS = (
    *("next_cut.position", "next_cut.distance", "piece.length", "piece.ordered", "last.length", "last.error"),
    *("limits.min_length", "limits.max_length", "limits.min_sensor_distance", "order.length_active"),
    *("statistics.length_good", "statistics.length_waste"),
    *("statistics.error_worst", "statistics.error_mean", "statistics.error_deviation"),
)
TIMES = ("clock", "last.time", "limits.cycle_time")
SHARES = ("last.reserve", "limits.reserve", "statistics.reserve_worst", "calibration.factor")
OF_KNIFE = ("velocity", "acceleration", "jerk")
AT_VELOCITY = ("limits.min_length", "limits.cycle_time", "limits.reserve")
"""What jumps where the line comes to rest: rounding of the velocity decides."""
LENGTH = 5000.0  # u
RELATIVE = 1e-9
NOT_COMPARED = ("time", "local.unwrapped_position", "warning.limit_exceeded")
"""The columns of the oracle's rows that are not compared: its warning is that of a ramp down alone."""


def tolerance(name: str, start: Mapping[str, Any]) -> float:
    """How far a value may be from the oracle's: relative to the machine's size, or to the way of the line."""
    group, _, quantity = name.partition(".")
    if group in ("slave", "peaks") and quantity in OF_KNIFE:
        return RELATIVE * float(start.get(f"axis.max_{quantity}", {"velocity": 3600.0}.get(quantity, 1e5)))
    if name == "slave.position":
        return RELATIVE * float(start.get("knife.turn", 360.0))
    if name in VELOCITIES or name in POSITIONS:
        return RELATIVE * LENGTH
    return RELATIVE if name in TIMES or name in SHARES else 0.0


def differences(
    script: Script, ends: Iterable[float], *, stride: int = 1, mode: MasterInput = MasterInput.START_OF_STEP
) -> list[str]:
    """Where the block's outputs are not the oracle's, at the end of each step or of each `stride`-th one."""
    (first, *_) = reference(script, [0.0])
    tolerances = {name: tolerance(name, script["start"]) for name in first if name not in NOT_COMPARED}
    rows = cutting_scripts.simulate(RotaryKnife(), script, ends, tolerances, AT_VELOCITY, mode, stride)
    return find_differences(reference, script, rows, tolerances)


# --- scripts ----------------------------------------------------------------------------------------------------------


def random_knife(r: Random, *, horizontal: bool) -> tuple[dict[str, Any], float]:
    """Parameters of a knife, and the material that passes from one blade to the next."""

    def sometimes(chance: float, low: float, high: float) -> float:
        return r.uniform(low, high) if r.random() < chance else 0.0

    blades, turn = r.choice([1, 1, 2, 3]), r.choice([360.0, 360.0, 1.0])
    circumference = r.uniform(500.0, 900.0) * blades**0.7
    spacing = circumference / blades
    start = {
        "knife.turn": turn,
        "knife.circumference": circumference,
        "knife.blades": blades,
        "knife.park_angle": turn / blades * r.uniform(0.35, 0.6),
        "sync.mode": 2 if horizontal else 1,
        "sync.before": r.uniform(0.0, 0.12) * spacing,
        "sync.after": r.uniform(0.0, 0.12) * spacing,
        "sync.overspeed": r.choice([0.0, 0.0, 0.05, -0.1]),
        "axis.max_velocity": 10.0 * turn * r.uniform(0.7, 1.5),
        "axis.max_acceleration": 200.0 * turn * r.uniform(0.3, 1.2),
        "axis.max_jerk": 2800.0 * turn * r.uniform(0.5, 3.0),
        "allow_parking": r.random() < 0.8,
        "material_factor": r.choice([1.0, r.uniform(0.9, 1.1)]),
        "kerf": sometimes(0.5, 0.0, 8.0),
        "length": spacing * r.choice([1.0, r.uniform(0.5, 3.0)]),
        "length_correction": sometimes(0.3, -3.0, 3.0),
        "length_tolerance": r.choice([0.5, 1e-3]),
        "late_mode": r.choice([1, 1, 2, 2, 3]),
        "start_mode": r.choice([1, 1, 2]),
        "trim_length": sometimes(0.7, 0.0, 400.0),
        "front_position": sometimes(0.4, -300.0, 100.0),
        "change_mode": r.choice([1, 2]),
        "sample_length": spacing * r.uniform(0.6, 1.5),
        "waste_length": spacing * r.uniform(0.6, 1.5),
        "batch_size": r.choice([0, 1, 2]),
        "order.repeat": r.random() < 0.3,
        "line.margin": r.choice([0.02, 0.0]),
        "master.period": r.choice([0.0, 0.0, 360.0, 5000.0]),
    }
    return start, spacing


COMMANDS = (
    *("start", "start", "stop", "abort", "reset", "cut_now", "cut_now", "take_sample", "order.add", "order.add"),
    *("order.skip", "order.clear", "clear_statistics", "calibration.execute"),
)


def random_commands(r: Random, spacing: float, duration: float) -> list[dict[str, Any]]:
    """Edges of commands, and levels, lengths and settings that change."""
    time = r.randint(50, 400) / 1000.0
    sets: list[dict[str, Any]] = [{"at": time, "start": True}, {"at": time + 0.0125, "start": False}]
    rate = r.choice([0.2, 0.5, 1.5])
    while (time := round(time + r.expovariate(rate), 4)) < duration:
        changed = ("hold", "waste", "length", "length", "length", "late_mode", "kerf", "sync.before", "sync.overspeed")
        name = r.choice([*COMMANDS, *changed])
        values: dict[str, Any] = {name: True}
        match name:
            case "hold" | "waste":
                sets.append({"at": round(time + r.uniform(0.05, 1.0), 4), name: False})
            case "length":
                values = {name: r.choice([0.0, spacing * r.uniform(0.5, 3.0), spacing * r.uniform(0.5, 3.0)])}
            case "late_mode":
                values = {name: r.choice([1, 2, 3])}
            case "kerf":
                values = {name: r.uniform(0.0, 8.0)}
            case "sync.before":
                values = {name: r.uniform(0.0, 0.12) * spacing}
            case "sync.overspeed":
                values = {name: r.choice([0.0, 0.03])}
            case "order.add":
                lengths = {"order.length": spacing * r.uniform(0.5, 3.0), "order.quantity": r.choice([0, 1, 1, 2, 3])}
                values |= lengths
            case "calibration.execute":
                values |= {"calibration.measured_length": r.choice([0.0, spacing * r.uniform(0.9, 1.1)])}
        sets.append({"at": time, **values})
        if name in COMMANDS:
            sets.append({"at": round(time + 0.0125, 4), name: False})
    return sorted((table for table in sets if table["at"] < duration), key=lambda table: table["at"])


def random_script(r: Random, duration: float, step_size: float, *, horizontal: bool = False) -> Script:
    """A knife, its line, and what is set while it runs."""
    start, spacing = random_knife(r, horizontal=horizontal)
    master = random_line(r, duration)
    stop = sum(segment["duration"] for segment in master["segments"])
    sets = random_commands(r, spacing, duration)
    if r.random() < 0.25:
        seen = random_marks(r, start, master, duration, windows=True)
        sets = sorted([*sets, *seen], key=lambda table: table["at"])
    return {"stop_time": stop, "step_size": step_size, "start": start, "master": master, "set": sets}
