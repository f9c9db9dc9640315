"""Random runs of the CutToLength, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from dataclasses import fields
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.faults import Fault
from motionsync.cut_to_length.interface import State, ToolMode, Warnings
from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.master import MasterInput
from tests.support.masters import INPUT_MODES
from tests.support.runs import EXTREMES, BlockRun, Strategy

# How likely a command rises in a step in which it can: usually, and in a run that is about this command.
COMMANDS = {
    "start": (0.2, 0.5),
    "stop": (0.001, 0.05),
    "abort": (0.001, 0.05),
    "reset": (0.05, 0.5),
    "cut_now": (0.01, 0.3),
    "take_sample": (0.02, 0.3),
    "order.add": (0.02, 0.7),
    "order.skip": (0.005, 0.1),
    "order.clear": (0.002, 0.02),
    "mark.detected": (0.1, 0.9),
    "tool.done": (0.2, 0.02),
    "calibration.execute": (0.002, 0.05),
    "calibration.reset": (0.02, 0.1),
    "clear_statistics": (0.002, 0.05),
}
WARNINGS = tuple(field.name for field in fields(Warnings))
INVALID_VALUES = (-1.0, math.nan, math.inf, 2e12)
INVALID_CHOICES = ("start_mode", "change_mode", "late_mode")


def random_machine(r: Random, length: float, duration: float) -> dict[str, Any]:
    """A machine for pieces of this length, u, in cycles of about this duration, s; no parameter at its start value."""
    line = length / duration
    factor, angle = r.choice((1.0, 1.02, 0.5)), r.choice((0.0, 0.0, 30.0, -60.0))
    speed = line * factor / math.cos(math.radians(angle))
    acceleration = speed / (duration * r.uniform(0.02, 0.15))
    jerk = acceleration / (duration * r.uniform(0.02, 0.1))
    home = length * r.choice((0.0, 0.1, -0.3))
    return {
        "diagonal_angle": angle,
        "material_factor": factor,
        "home_position": home,
        "axis.initial_position": home + length * r.choice((0.0, 0.0, 0.2)),
        "axis.max_velocity": speed * r.uniform(1.3, 3.0),
        "axis.max_acceleration": acceleration,
        "axis.max_deceleration": r.choice((0.0, acceleration)),
        "axis.max_jerk": jerk,
        "axis.min_position": home - length * r.choice((0.3, 1e3)),
        "axis.max_position": home + length * r.choice((0.7, 1.0, 1e3)),
        "approach.distance": length * r.choice((0.0, 0.0, 0.1)),
        "approach.reserve": r.choice((0.0, 0.02, 0.2)),
        "approach.acceleration": acceleration * r.choice((0.0, 0.7)),
        "approach.jerk": jerk * r.choice((0.0, 0.7)),
        "homing.velocity": speed * r.choice((0.0, 1.2)),
        "homing.acceleration": acceleration * r.choice((0.0, 0.6)),
        "homing.deceleration": acceleration * r.choice((0.0, 0.8)),
        "homing.jerk": jerk * r.choice((0.0, 0.6)),
        "homing.settle_time": duration * r.choice((0.0, 0.05)),
        "homing.ease": r.random() < 0.4,
        "homing.spare_time": duration * r.choice((0.0, 0.02)),
        "homing.slowest": r.choice((0.05, 0.5)),
    }


def random_tool(r: Random, length: float, duration: float) -> dict[str, Any]:
    return {
        "tool.mode": r.choice(list(ToolMode)),
        "tool.settle_time": duration * r.choice((0.0, 0.03)),
        "tool.on_delay": duration * r.choice((0.0, 0.02, 0.08)),
        "tool.cut_time": duration * r.choice((0.0, 0.1, 0.2)),
        "tool.cut_distance": length * r.choice((0.0, 0.1, 0.2)),
        "tool.retract_time": duration * r.choice((0.0, 0.05)),
        "tool.timeout": duration * r.choice((0.0, 0.15)),
        "gap.distance": length * r.choice((0.0, 0.005, 0.05)),
        "gap.travel": length * r.choice((0.1, 0.05)),
    }


def random_settings(r: Random, length: float, duration: float) -> dict[str, Any]:
    """What is cut, and what decides where."""
    return {
        "source": r.choice(list(Source)),
        "start_mode": r.choice((1, 2, 3)),
        "change_mode": r.choice((1, 2)),
        "late_mode": r.choice(list(LateMode)),
        "front_position": length * r.choice((0.0, 0.1)),
        "trim_length": length * r.choice((0.0, 0.5)),
        "sample_length": length * r.choice((0.8, 1.2)),
        "waste_length": length * r.choice((0.6, 0.9)),
        "kerf": length * r.choice((0.0, 0.01)),
        "length_tolerance": length * r.choice((1e-6, 0.1)),
        "batch_size": r.choice((0, 2)),
        "order.repeat": r.random() < 0.3,
        "line.margin": r.choice((0.0, 0.02)),
        "mark.sensor_distance": length * r.choice((0.5, 1.5, 1.5, 1e3)),
        "mark.cut_offset": length * r.choice((0.0, 0.1)),
        "mark.spacing": length * r.choice((0.0, 0.5)),
        "mark.window": length * r.choice((0.0, 0.05, 0.2)),
        "mark.every": r.choice((1, 2)),
        "mark.max_missing": r.choice((0, 1, 30)),
        "mark.substitute": r.random() < 0.5,
        "mark.latched": r.random() < 0.5,
        "mark.delay": duration * r.choice((0.0, 0.05)),
    }


def random_inputs(r: Random, length: float, duration: float) -> dict[str, Any]:
    return {
        "length": length * r.choice((1.0, 1.0, 1.5)),
        "length_correction": length * r.choice((0.0, 0.0, 1e-3)),
        "order.length": length * 1.1,
        "line.wanted_velocity": length / duration * r.choice((0.5, 1e3)),
        "waste": r.random() < 0.1,
        "hold": False,
    }


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    """A machine, a line that it can nearly follow, and what the run is about: a command that comes often, or none."""
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-3, 1e6)))
    duration = 10.0 ** draw(st.floats(-1.0, 1.0))
    master = draw(INPUT_MODES)
    mode = master["master.input_mode"]
    theme = draw(st.sampled_from(("", "", "", "mark.detected", *COMMANDS)))
    extreme = draw(st.sampled_from((0.0, 0.0, 0.01)))
    r = Random(repr((draw(st.integers(0, 2**32 - 1)), length, duration, mode, theme, extreme)))
    start: dict[str, Any] = {
        **master,
        "master.period": length * r.choice((0.0, 30.0) if mode == MasterInput.POSITION_ONLY else (0.0, 0.0, 0.7, 3.0)),
        "master.position": length * r.uniform(-3.0, 3.0),
        "master.velocity": length / duration * r.choice((0.0, 0.5, 0.8)),
        "master.acceleration": length / duration**2 * r.choice((0.0, 0.0, 0.1)),
        **random_machine(r, length, duration),
        **random_tool(r, length, duration),
        **random_settings(r, length, duration),
        **random_inputs(r, length, duration),
        "auto_start": r.random() < 0.3,
    }
    if theme == "mark.detected":  # more marks than can wait
        start |= {"source": Source.MARK, "mark.sensor_distance": 1e3 * length, "mark.spacing": 0.0, "mark.every": 1}
        start["start_mode"] = StartMode.FRONT
    if not start["mark.window"] < 0.5 * start["mark.spacing"]:
        start["mark.window"] = 0.0
    return BlockRun(start, list(_steps(r, start, length, duration, steps, theme, extreme)))


def _steps(
    r: Random, start: dict[str, Any], length: float, duration: float, steps: int, theme: str, extreme: float
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A line that mostly runs, commands, new settings; `extreme` is the probability of an invalid value in a step."""
    position, velocity, period = start["master.position"], start["master.velocity"], start["master.period"]
    line, mean_step = length / duration, duration * r.choice((0.02, 0.02, 0.05, 0.2))
    has_velocity = start["master.input_mode"] != MasterInput.POSITION_ONLY  # else sudden changes give absurd velocities
    target, levels = velocity, dict.fromkeys(COMMANDS, False)
    to_restore: dict[str, Any] = {}
    for _ in range(steps):
        h = mean_step * 10.0 ** r.uniform(-0.5, 0.5)
        if has_velocity and r.random() < 0.03:
            h = duration * 10.0 ** r.uniform(-12.0, 1.0)
        if r.random() < 0.05:
            target = line * r.choice((0.0, 0.3, 0.5, 0.7, 0.7, 0.9, -0.3, 4.0))
            velocity = target if has_velocity and r.random() < 0.5 else velocity
        acceleration = (target - velocity) / max(h, 0.2 * duration)
        levels = {name: not levels[name] and r.random() < shares[name == theme] for name, shares in COMMANDS.items()}
        values: dict[str, Any] = {
            "master.position": position % period if period and r.random() < 0.3 else position,
            "master.velocity": velocity,
            "master.acceleration": acceleration,
            **levels,
            "mark.position": position - line * duration * r.choice((0.0, 0.0, 0.01)),
            **to_restore,
        }
        to_restore = {}
        if r.random() < 0.05:
            values |= _new_inputs(r, length, duration)
        if r.random() < 0.02:
            values |= _new_settings(r, length, duration)
        if r.random() < 0.004:
            invalid = _invalid_settings(r)
            values, to_restore = values | invalid, {name: start[name] for name in invalid}
        if r.random() < extreme:
            name = r.choice(("master.position" if has_velocity else "length", "master.velocity", "mark.position"))
            values[name] = r.choice(EXTREMES)
        if r.random() < extreme:
            name = r.choice(("length", "length_correction", "order.length"))
            values[name], to_restore = r.choice(EXTREMES), to_restore | {name: start[name]}
        if r.random() < extreme:
            h = r.choice((0.0, -h, math.nan, math.inf, 1.1e6, *((1e6, 5e-324) if has_velocity else ())))
        yield h, values
        if not 0.0 < h <= 1e3 * duration:
            continue
        position += (velocity + 0.5 * acceleration * h) * h
        velocity += acceleration * h


def _new_inputs(r: Random, length: float, duration: float) -> dict[str, Any]:
    return random_inputs(r, length, duration) | {
        "length": length * r.choice((1.0, 1.0, 1.5, 0.2, 0.0)),
        "order.length": length * r.choice((1.0, 1.3, 1.0, 0.0)),
        "order.quantity": r.choice((1, 1, 2, 3, 0)),
        "hold": r.random() < 0.1,
        "waste": r.random() < 0.2,
        "calibration.measured_length": length * r.choice((1.01, 0.99, 0.0)),
    }


def _new_settings(r: Random, length: float, duration: float) -> dict[str, Any]:
    """A few other parameters that may be tuned."""
    candidates = {**random_tool(r, length, duration), **random_settings(r, length, duration)}
    mark = ("latched", "window", "spacing", "every", "sensor_distance")
    unchanged = ("tool.mode", "source", *(f"mark.{name}" for name in mark))
    return {name: candidates[name] for name in r.sample(sorted(candidates.keys() - set(unchanged)), 3)}


def _invalid_settings(r: Random) -> dict[str, Any]:
    name = r.choice(("kerf", "tool.cut_time", "axis.max_jerk", "homing.velocity", "front_position", "gap.travel"))
    return {name: r.choice(INVALID_VALUES)} if r.random() < 0.7 else {r.choice(INVALID_CHOICES): r.choice((0, 9))}


def features(block: CutToLength) -> set[Any]:
    """The remarkable features of the block's present state."""
    return {
        ("state", block.state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("in sync", block.state if block.in_sync else None),
        ("piece", block.piece.kind),
        ("made", block.last.kind),
        ("cut", block.tool.mode if block.state == State.CUTTING else None),
        ("late", block.late_mode if block.statistics.late > 0 else None),
        ("early", block.statistics.unsynchronised > 0),
        ("eased", block.local.ease < 1.0),
        ("stopping in fault", block.state == State.FAULT and block.slave.velocity != 0.0),
        ("batch", block.batch_done),
        ("order", block.order.completed > 0),
        ("marks", block.statistics.marks_missing > 0 and block.statistics.marks > 0),
        *(("warning", name) for name in WARNINGS if getattr(block.warning, name)),
    }


STRATEGY = Strategy(
    runs,
    features,
    frozenset(
        {
            *(("state", state) for state in State),
            *(("mode", mode) for mode in MasterInput),
            *(("fault", fault) for fault in (*Fault, *PieceFault)),
            *(("in sync", state) for state in (State.SYNCHRONOUS, State.CUTTING, State.CLEARING)),
            *(("piece", kind) for kind in PieceKind),
            *(("made", kind) for kind in PieceKind),
            *(("cut", mode) for mode in ToolMode),
            *((name, True) for name in ("early", "eased", "stopping in fault", "batch", "order", "marks")),
            *(("warning", name) for name in WARNINGS),
            ("late", LateMode.LATE),
        }
    ),
)
