"""Random scripts of a line with commands, the CutToLength's run along one, and its comparison with the oracle."""

from collections.abc import Iterable, Mapping
from itertools import pairwise
from random import Random
from typing import Any

from motionsync.cut_to_length.block import CutToLength
from motionsync.master import MasterInput
from tests.oracle.cut_to_length import events, reference
from tests.support.blocks import cutting_scripts
from tests.support.blocks.cutting_scripts import random_line, random_marks
from tests.support.blocks.oracle_runs import Script, find_differences

LEAST_RETURN_TIME = 1e-4
"""Time (s) in which no carriage returns home that has left it."""

VELOCITIES = (
    *("slave.velocity", "limits.max_line_velocity", "limits.max_line_velocity_orders", "line.velocity_request"),
)
POSITIONS = (
    *("slave.position", "next_cut.position", "next_cut.distance", "piece.length", "piece.ordered"),
    *("last.length", "last.error", "limits.min_length", "limits.stroke", "limits.min_sensor_distance"),
    *("local.approach_distance", "order.length_active", "statistics.length_good", "statistics.length_waste"),
    *("statistics.error_worst", "statistics.error_mean", "statistics.error_deviation"),
)
TIMES = (*("clock", "tool.command_time", "last.time", "limits.cycle_time", "local.start_time", "local.home_time"),)
SHARES = (
    "last.reserve",
    "limits.reserve",
    "statistics.reserve_worst",
    "local.ease",
    "calibration.factor",
    "local.coupling_factor",
)
AT_VELOCITY = ("limits.min_length", "limits.cycle_time", "limits.reserve", "limits.stroke", "next_cut.distance")
"""What jumps where the line comes to rest: rounding of the velocity decides."""
ARRIVAL_TOLERANCE = 1e-5
"""Time (s): the way home ends so softly that rounding of the carriage's state changes the end by so much."""
RELATIVE, LONGEST = 1e-9, 5.0
"""Of the machine's sizes; the longest time that is compared, s."""
NOT_COMPARED = ("time",)
"""The columns of the oracle's rows that are not compared."""


def tolerance(name: str, scale: Mapping[str, float]) -> float:
    """How far a value may be from the oracle's; `scale`: the sizes of the script."""
    if name == "local.home_time":
        return ARRIVAL_TOLERANCE
    if name == "slave.jerk":
        return RELATIVE * scale["jerk"]
    if name == "slave.acceleration":
        return RELATIVE * scale["acceleration"]
    if name in VELOCITIES:
        return RELATIVE * scale["velocity"]
    if name in POSITIONS:
        return RELATIVE * scale["length"]
    return RELATIVE * LONGEST if name in TIMES else RELATIVE if name in SHARES else 0.0


def find_undecided(script: Script) -> tuple[float, set[str]]:
    """From when on rounding decides, and the names of the outputs that are undetermined.

    A carriage that has never left home returns home in a time of rounding. A start while the line reverses, or is at
    rest, has an instant that is exact to the root of rounding only. The reserve of a cycle whose approach began twice
    is not specified.
    """
    undetermined: set[str] = set()
    for (begin, before), (end, name) in pairwise(events(script)):
        if name == "home" and end - begin < LEAST_RETURN_TIME:
            return begin, undetermined
        if (before, name) == ("start", "sync") and end - begin < LEAST_RETURN_TIME:
            undetermined |= set(TIMES)
        if name == "turned back":
            undetermined |= {"last.reserve", "statistics.reserve_worst"}
    return float(script["stop_time"]), undetermined


def differences(
    script: Script, ends: Iterable[float], *, stride: int = 1, mode: MasterInput = MasterInput.START_OF_STEP
) -> list[str]:
    """Where the block's outputs are not the oracle's, at the end of each step or of each `stride`-th one."""
    start = script["start"]
    scale = {"length": 1000.0} | {n: start[f"axis.max_{n}"] for n in ("velocity", "acceleration", "jerk")}
    horizon, undetermined = find_undecided(script)
    (first, *_) = reference(script, [0.0])
    tolerances = {name: tolerance(name, scale) for name in first.keys() - {*NOT_COMPARED, *undetermined}}
    rows = cutting_scripts.simulate(CutToLength(), script, ends, tolerances, AT_VELOCITY, mode, stride)
    return find_differences(reference, script, [row for row in rows if row["time"] <= horizon], tolerances)


# --- scripts ----------------------------------------------------------------------------------------------------------


def random_machine(r: Random) -> dict[str, Any]:
    """Parameters of a machine that can cut pieces of 300 to 2000 at some hundred u/s."""

    def sometimes(chance: float, low: float, high: float) -> float:
        return r.uniform(low, high) if r.random() < chance else 0.0

    start: dict[str, Any] = {
        "axis.max_velocity": r.uniform(1000.0, 2500.0),
        "axis.max_acceleration": r.uniform(5000.0, 20000.0),
        "axis.max_deceleration": sometimes(0.7, 4000.0, 20000.0),
        "axis.max_jerk": r.uniform(5e4, 5e5),
        "home_position": r.uniform(-200.0, 200.0),
        "axis.min_position": r.choice([-1e9, -300.0]),
        "axis.max_position": r.choice([1e9, 1e9, 1500.0, 800.0]),
        "diagonal_angle": sometimes(0.3, -40.0, 40.0),
        "material_factor": r.choice([1.0, r.uniform(0.9, 1.1)]),
        "kerf": sometimes(0.6, 0.0, 8.0),
        "length": r.uniform(300.0, 2000.0),
        "length_correction": sometimes(0.3, -3.0, 3.0),
        "length_tolerance": r.choice([0.5, 1e-3]),
        "late_mode": r.choice([1, 1, 2, 2, 3]),
        "start_mode": r.choice([1, 1, 2]),
        "trim_length": sometimes(0.7, 0.0, 400.0),
        "front_position": sometimes(0.4, -300.0, 100.0),
        "change_mode": r.choice([1, 2]),
        "sample_length": r.uniform(100.0, 600.0),
        "waste_length": r.uniform(100.0, 600.0),
        "batch_size": r.choice([0, 1, 2, 3]),
        "approach.distance": sometimes(0.3, 0.0, 250.0),
        "approach.reserve": r.choice([0.0, 0.02, r.uniform(0.0, 0.3)]),
        "approach.acceleration": sometimes(0.3, 3000.0, 12000.0),
        "approach.jerk": sometimes(0.3, 3e4, 4e5),
        "homing.velocity": sometimes(0.4, 500.0, 2000.0),
        "homing.acceleration": sometimes(0.4, 3000.0, 15000.0),
        "homing.deceleration": sometimes(0.4, 3000.0, 15000.0),
        "homing.jerk": sometimes(0.4, 3e4, 5e5),
        "homing.settle_time": sometimes(0.4, 0.0, 0.1),
        "homing.ease": r.random() < 0.4,
        "homing.spare_time": r.uniform(0.0, 0.1),
        "homing.slowest": r.choice([0.05, 0.4]),
        "tool.mode": r.choice([1, 1, 2, 3]),
        "tool.settle_time": sometimes(0.4, 0.0, 0.1),
        "tool.on_delay": sometimes(0.5, 0.0, 0.2),
        "tool.cut_time": r.uniform(0.0, 0.4),
        "tool.cut_distance": r.uniform(0.0, 250.0),
        "tool.retract_time": sometimes(0.5, 0.0, 0.1),
        "tool.timeout": sometimes(0.6, 0.1, 0.5),
        "gap.distance": sometimes(0.4, 1.0, 20.0),
        "gap.travel": r.uniform(80.0, 300.0),
        "order.repeat": r.random() < 0.3,
        "line.margin": r.choice([0.02, 0.0]),
        "line.wanted_velocity": r.choice([1e9, 700.0]),
        "master.period": r.choice([0.0, 0.0, 360.0, 5000.0]),
    }
    start["axis.initial_position"] = r.choice([start["home_position"], start["home_position"] + r.uniform(-90.0, 90.0)])
    return start


COMMANDS = (
    *("start", "start", "stop", "abort", "reset", "cut_now", "take_sample", "order.add", "order.add", "order.add"),
    *("order.skip", "order.clear", "tool.done", "tool.done", "clear_statistics", "calibration.execute"),
)


def random_commands(r: Random, start: dict[str, Any], duration: float) -> list[dict[str, Any]]:
    """Edges of commands, and levels and lengths that change."""
    begin = r.randint(50, 400) / 1000.0
    sets: list[dict[str, Any]] = [{"at": begin, "start": True}, {"at": begin + 0.0125, "start": False}]
    rate = r.choice([0.2, 0.5, 2.0])
    time = begin
    if start["tool.mode"] == 3:
        done = begin
        while done < duration:
            done = round(done + r.uniform(0.1, 0.5), 4)
            sets += [{"at": done, "tool.done": True}, {"at": round(done + 0.0125, 4), "tool.done": False}]
    while (time := round(time + r.expovariate(rate), 4)) < duration:
        name = r.choice([*COMMANDS, "hold", "waste", "length", "length", "late_mode", "start_mode", "kerf"])
        values: dict[str, Any] = {name: True}
        match name:
            case "hold" | "waste":
                sets.append({"at": round(time + r.uniform(0.05, 1.0), 4), name: False})
            case "length":
                values = {name: r.choice([0.0, r.uniform(300.0, 2000.0), r.uniform(300.0, 2000.0)])}
            case "late_mode" | "start_mode":
                values = {name: r.choice([1, 2, 3])}
            case "kerf":
                values = {name: r.uniform(0.0, 8.0)}
            case "order.add":
                values |= {"order.length": r.uniform(300.0, 2000.0), "order.quantity": r.choice([0, 1, 1, 2, 3])}
            case "calibration.execute":
                values |= {"calibration.measured_length": r.choice([0.0, r.uniform(900.0, 1100.0)])}
        sets.append({"at": time, **values})
        if name in COMMANDS:
            sets.append({"at": round(time + 0.0125, 4), name: False})
    return sorted((table for table in sets if table["at"] < duration), key=lambda table: table["at"])


def random_script(r: Random, duration: float, step_size: float | None, *, jumps: bool = True) -> Script:
    """A machine, its line, and what is set while it runs.

    `step_size`: of the run, for what is noticed at a step's beginning; None: any, and nothing is noticed there.
    `jumps`: of the line's velocity.
    """
    start = random_machine(r)
    master = random_line(r, duration, jumps=jumps)
    stop = sum(segment["duration"] for segment in master["segments"])
    sets = random_commands(r, start, duration)
    if r.random() < 0.25:
        seen = random_marks(r, start, master, duration, windows=step_size is not None)
        sets = sorted([*sets, *seen], key=lambda table: table["at"])
    return {"stop_time": stop, "step_size": step_size or stop, "start": start, "master": master, "set": sets}
