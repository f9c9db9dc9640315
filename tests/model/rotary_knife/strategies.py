"""Random runs of the RotaryKnife, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from collections.abc import Iterator
from dataclasses import fields
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.master import MasterInput
from motionsync.rotary_knife.block import RotaryKnife
from motionsync.rotary_knife.interface import State, SyncMode, Warnings
from tests.support.masters import INPUT_MODES
from tests.support.runs import EXTREMES, BlockRun, Strategy

# How likely a command rises in a step in which it can: usually, and in a run that is about this command.
COMMANDS = {
    "start": (0.2, 0.5),
    "stop": (0.002, 0.05),
    "abort": (0.002, 0.05),
    "reset": (0.05, 0.5),
    "cut_now": (0.02, 0.3),
    "take_sample": (0.02, 0.3),
    "order.add": (0.02, 0.7),
    "order.skip": (0.005, 0.1),
    "order.clear": (0.002, 0.02),
    "mark.detected": (0.1, 0.9),
    "calibration.execute": (0.002, 0.05),
    "calibration.reset": (0.02, 0.1),
    "clear_statistics": (0.002, 0.05),
}
WARNINGS = tuple(field.name for field in fields(Warnings))
INVALID_VALUES = (-1.0, math.nan, math.inf, 2e12)
INVALID_CHOICES = ("start_mode", "change_mode", "late_mode")


def random_knife(r: Random, length: float, duration: float) -> dict[str, Any]:
    """A knife with pieces of about this length between two of its blades, u, which pass in about this time, s."""
    blades = r.choice((1, 1, 2, 3))
    turn = r.choice((360.0, 1.0, 25.0))
    spacing, circumference = turn / blades, length * blades
    velocity = turn / blades / duration
    acceleration = velocity / (duration * r.uniform(0.01, 0.1))
    return {
        "knife.blades": blades,
        "knife.turn": turn,
        "knife.circumference": circumference,
        "knife.park_angle": spacing * r.uniform(0.35, 0.6),
        "sync.mode": r.choice((SyncMode.TANGENTIAL, SyncMode.TANGENTIAL, SyncMode.HORIZONTAL)),
        "axis.max_velocity": velocity * r.uniform(2.0, 6.0),
        "axis.max_acceleration": acceleration,
        "axis.max_jerk": acceleration / (duration * r.uniform(0.01, 0.05)),
        "allow_parking": r.random() < 0.8,
        "material_factor": r.choice((1.0, 1.02, 0.5)),
        **random_window(r, length),
    }


def random_window(r: Random, length: float) -> dict[str, Any]:
    """A window that any of these knives can have."""
    return {
        "sync.before": length * r.choice((0.0, 0.05, 0.12)),
        "sync.after": length * r.choice((0.0, 0.05, 0.12)),
        "sync.overspeed": r.choice((0.0, 0.0, 0.05, -0.1)),
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
        "length": length * r.choice((1.0, 1.0, 0.7, 1.5, 2.5)),
        "length_correction": length * r.choice((0.0, 0.0, 1e-3)),
        "order.length": length * r.choice((1.1, 0.8)),
        "line.wanted_velocity": length / duration * r.choice((0.5, 1e3)),
        "waste": r.random() < 0.1,
        "hold": False,
    }


@st.composite
def runs(draw: st.DrawFn, steps: int) -> BlockRun:
    """A knife, a line that it can nearly follow, and what the run is about: a command that comes often, or none."""
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
        **random_knife(r, length, duration),
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
        "length": length * r.choice((1.0, 1.0, 1.5, 0.4, 3.0, 0.0)),
        "order.length": length * r.choice((1.0, 1.3, 0.7, 0.0)),
        "order.quantity": r.choice((1, 1, 2, 3, 0)),
        "hold": r.random() < 0.1,
        "waste": r.random() < 0.2,
        "calibration.measured_length": length * r.choice((1.01, 0.99, 0.0)),
    }


def _new_settings(r: Random, length: float, duration: float) -> dict[str, Any]:
    """A few other parameters that may be tuned."""
    candidates = {**random_window(r, length), **random_settings(r, length, duration)}
    mark = ("latched", "window", "spacing", "every", "sensor_distance")
    unchanged = ("source", *(f"mark.{name}" for name in mark))
    return {name: candidates[name] for name in r.sample(sorted(candidates.keys() - set(unchanged)), 3)}


def _invalid_settings(r: Random) -> dict[str, Any]:
    name = r.choice(("kerf", "sync.before", "sync.after", "sync.overspeed", "front_position", "line.margin"))
    return {name: r.choice(INVALID_VALUES)} if r.random() < 0.7 else {r.choice(INVALID_CHOICES): r.choice((0, 9))}


def features(block: RotaryKnife) -> set[Any]:
    """The remarkable features of the block's present state."""
    return {
        ("state", block.state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("in sync", block.sync.mode if block.in_sync else None),
        ("piece", block.piece.kind),
        ("made", block.last.kind),
        ("late", block.late_mode if block.statistics.late > 0 else None),
        ("out of sync", block.statistics.unsynchronised > 0),
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
            *(("fault", fault) for fault in PieceFault),
            *(("in sync", mode) for mode in SyncMode),
            *(("piece", kind) for kind in PieceKind),
            *(("made", kind) for kind in PieceKind),
            *((name, True) for name in ("out of sync", "stopping in fault", "batch", "order", "marks")),
            *(("warning", name) for name in WARNINGS),
            ("late", LateMode.LATE),
        }
    ),
)
