"""Random runs of machines that cut to length: what they all cut, the line, and their commands."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.cutting.faults import MarkRefusal, PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, Source, StartMode
from motionsync.master import MasterInput
from tests.support.blocks.masters import INPUT_MODES
from tests.support.blocks.runs import EXTREMES, BlockRun

# How likely a command rises in a step in which it can: usually, and in a run that is about this command.
COMMANDS: Mapping[str, tuple[float, float]] = {
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
    "calibration.execute": (0.002, 0.05),
    "calibration.reset": (0.02, 0.1),
    "clear_statistics": (0.002, 0.05),
}
FILLED_QUEUES = ("mark.detected", "order.add")  # commands that come oftener than others as what a run is about
LATCHED = (0.0,) * 12 + (-0.01,) * 6 + (-4.0, 1e5)  # how far from the master a mark is latched, in lengths
FAULT = -1  # the state in which a fault is present
INVALID_VALUES = (-1.0, math.nan, math.inf, 2e12)
INVALID_CHOICES = ("start_mode", "change_mode", "late_mode")
FIXED = ("source", *(f"mark.{name}" for name in ("latched", "window", "spacing", "every", "sensor_distance")))
"""Settings that no step of a run changes."""

Draw = Callable[[Random, float, float], dict[str, Any]]
"""Draws parameters for pieces of about this length, u, which pass in about this time, s."""


@dataclass(frozen=True)
class CuttingMachine:
    """What is different for each machine.

    Attributes:
        machine: draws the parameters of the machine.
        tool: draws those of what cuts, which may be tuned.
        commands: how likely its commands rise, as COMMANDS.
        lengths, new_lengths: of pieces without an order, at the start and later, in multiples of the length.
        order_lengths, new_order_lengths: those of orders, likewise.
        fixed: tunable parameters that no step changes, in addition to FIXED.
        checked: parameters of which an invalid value is tried.
    """

    machine: Draw
    tool: Draw
    commands: Mapping[str, tuple[float, float]]
    lengths: Sequence[float]
    new_lengths: Sequence[float]
    order_lengths: Sequence[float]
    new_order_lengths: Sequence[float]
    checked: Sequence[str]
    fixed: Sequence[str] = ()

    def inputs(self, r: Random, length: float, duration: float) -> dict[str, Any]:
        """What is cut at the start, and how fast."""
        return {
            "length": length * r.choice(self.lengths),
            "length_correction": length * r.choice((0.0, 0.0, 1e-3)),
            "order.length": length * r.choice(self.order_lengths),
            "line.wanted_velocity": length / duration * r.choice((0.5, 1e3)),
            "waste": r.random() < 0.1,
            "hold": False,
        }

    def new_inputs(self, r: Random, length: float, duration: float) -> dict[str, Any]:
        return self.inputs(r, length, duration) | {
            "length": length * r.choice(self.new_lengths),
            "order.length": length * r.choice(self.new_order_lengths),
            "order.quantity": r.choice((1, 1, 2, 3, 0)),
            "hold": r.random() < 0.1,
            "waste": r.random() < 0.2,
            "calibration.measured_length": length * r.choice((1.01, 0.99, 0.0, 3.0)),
        }

    def new_settings(self, r: Random, length: float, duration: float) -> dict[str, Any]:
        """A few other parameters that may be tuned."""
        candidates = {**self.tool(r, length, duration), **random_settings(r, length, duration)}
        names = sorted(candidates.keys() - {*FIXED, *self.fixed})
        return {name: candidates[name] for name in r.sample(names, 3)}

    def invalid_settings(self, r: Random) -> dict[str, Any]:
        if r.random() < 0.7:
            return {r.choice(self.checked): r.choice(INVALID_VALUES)}
        return {r.choice(INVALID_CHOICES): r.choice((0, 9))}

    def runs(self, steps: int) -> st.SearchStrategy[BlockRun]:
        """Runs of so many steps."""
        return _runs(self, steps)


def random_settings(r: Random, length: float, duration: float) -> dict[str, Any]:
    """What is cut, and what decides where."""
    return {
        "source": r.choice(list(Source)),
        "start_mode": r.choice((1, 2, 3)),
        "change_mode": r.choice((1, 2)),
        "late_mode": r.choice(list(LateMode)),
        "front_position": length * r.choice((0.0, 0.1, -3.0)),
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


@st.composite
def _runs(draw: st.DrawFn, machine: CuttingMachine, steps: int) -> BlockRun:
    """A machine, a line that it can nearly follow, and what the run is about: a command that comes often, or none."""
    length = draw(st.one_of(st.floats(0.1, 100.0), st.floats(1e-3, 1e6)))
    duration = 10.0 ** draw(st.floats(-1.0, 1.0))
    master = draw(INPUT_MODES)
    mode = master["master.input_mode"]
    extreme = draw(st.sampled_from((0.0, 0.0, 0.01)))
    r = Random(repr((draw(st.integers(0, 2**32 - 1)), length, duration, mode, extreme)))
    theme = r.choice(("", "", *FILLED_QUEUES, *machine.commands))
    start: dict[str, Any] = {
        **master,
        "master.period": length * r.choice((0.0, 30.0) if mode == MasterInput.POSITION_ONLY else (0.0, 0.0, 0.7, 3.0)),
        "master.position": length * r.uniform(-3.0, 3.0),
        "master.velocity": length / duration * r.choice((0.0, 0.5, 0.8)),
        "master.acceleration": length / duration**2 * r.choice((0.0, 0.0, 0.1)),
        **machine.machine(r, length, duration),
        **machine.tool(r, length, duration),
        **random_settings(r, length, duration),
        **machine.inputs(r, length, duration),
        "auto_start": r.random() < 0.3,
    }
    if theme == "mark.detected":  # more marks than can wait
        start |= {"source": Source.MARK, "mark.sensor_distance": 1e3 * length, "mark.spacing": 0.0, "mark.every": 1}
        start["start_mode"] = StartMode.FRONT
    if theme == "order.add":  # more orders than can wait
        start["order.quantity"] = 1000
    if not start["mark.window"] < 0.5 * start["mark.spacing"]:
        start["mark.window"] = 0.0
    return BlockRun(start, list(_steps(r, machine, start, length, duration, steps, theme, extreme)))


def _steps(
    r: Random,
    machine: CuttingMachine,
    start: dict[str, Any],
    length: float,
    duration: float,
    steps: int,
    theme: str,
    extreme: float,
) -> Iterator[tuple[float, dict[str, Any]]]:
    """A line that mostly runs, commands, new settings; `extreme` is the probability of an invalid value in a step."""
    position, velocity, period = start["master.position"], start["master.velocity"], start["master.period"]
    line, mean_step = length / duration, duration * r.choice((0.02, 0.02, 0.05, 0.2))
    has_velocity = start["master.input_mode"] != MasterInput.POSITION_ONLY  # else sudden changes give absurd velocities
    shares = {name: pair[name == theme] for name, pair in machine.commands.items()}
    target, levels = velocity, dict.fromkeys(shares, False)
    to_restore: dict[str, Any] = {}
    for _ in range(steps):
        h = mean_step * 10.0 ** r.uniform(-0.5, 0.5)
        if has_velocity and r.random() < 0.03:
            h = duration * 10.0 ** r.uniform(-12.0, 1.0)
        if r.random() < 0.05:
            target = line * r.choice((0.0, 0.3, 0.5, 0.7, 0.7, 0.9, -0.3, 4.0))
            velocity = target if has_velocity and r.random() < 0.5 else velocity
        acceleration = (target - velocity) / max(h, 0.2 * duration)
        levels = {name: not levels[name] and r.random() < share for name, share in shares.items()}
        values: dict[str, Any] = {
            "master.position": position % period if period and r.random() < 0.3 else position,
            "master.velocity": velocity,
            "master.acceleration": acceleration,
            **levels,
            "mark.position": position + length * r.choice(LATCHED),
            **to_restore,
        }
        to_restore = {}
        if r.random() < 0.05:
            values |= machine.new_inputs(r, length, duration)
        if r.random() < 0.02:
            values |= machine.new_settings(r, length, duration)
        if r.random() < 0.004:
            invalid = machine.invalid_settings(r)
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


def features(block: Any) -> set[Any]:
    """The remarkable features of the present state of any such block."""
    return {
        ("state", block.state),
        ("mode", block.master.input_mode),
        ("fault", block.error_id),
        ("piece", block.piece.kind),
        ("made", block.last.kind),
        ("late", block.late_mode if block.statistics.late > 0 else None),
        ("out of sync", block.statistics.unsynchronised > 0),
        ("exceeded", block.local.exceeded_limit),
        ("refused mark", block.local.mark_refusal),
        ("skipped", block.local.skip_reason),
        ("stopping in fault", block.state == FAULT and block.slave.velocity != 0.0),
        ("batch", block.batch_done),
        ("order", block.order.completed > 0),
        ("marks", block.statistics.marks_missing > 0 and block.statistics.marks > 0),
        *(("warning", field.name) for field in fields(block.warning) if getattr(block.warning, field.name)),
    }


def check(block: Any, off: int, fault: int) -> None:
    """What belongs together in each state of any such block; `off`, `fault`: the states in which it does not run."""
    assert block.running or block.state in (off, fault)
    assert block.line.stop_request == (block.state == fault)
    assert min(block.piece.length, block.limits.min_length) >= 0.0
    assert block.last.length > 0.0 or block.statistics.cuts == 0


def required_features(state: type[Any], warnings: type[Any]) -> set[Any]:
    """Those that the runs of a block with these states and warnings have to reach."""
    return {
        *(("state", member) for member in state),
        *(("mode", mode) for mode in MasterInput),
        *(("fault", fault) for fault in PieceFault),
        *(("piece", kind) for kind in PieceKind),
        *(("made", kind) for kind in PieceKind),
        *(("refused mark", reason) for reason in MarkRefusal),
        *((name, True) for name in ("out of sync", "stopping in fault", "batch", "order", "marks")),
        *(("warning", field.name) for field in fields(warnings)),
        ("late", LateMode.LATE),
    }
