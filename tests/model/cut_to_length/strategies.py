"""Random runs of the CutToLength, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

import math
from random import Random
from typing import Any

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.faults import Fault, SkipReason
from motionsync.cut_to_length.interface import State, ToolMode, Warnings
from tests.support.blocks import cutting_runs
from tests.support.blocks.cutting_runs import COMMANDS, CuttingMachine
from tests.support.blocks.runs import Strategy


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


MACHINE = CuttingMachine(
    machine=random_machine,
    tool=random_tool,
    commands=COMMANDS | {"tool.done": (0.2, 0.02)},
    lengths=(1.0, 1.0, 1.5),
    new_lengths=(1.0, 1.0, 1.5, 0.2, 0.0),
    order_lengths=(1.1,),
    new_order_lengths=(1.0, 1.3, 1.0, 0.0),
    checked=("kerf", "tool.cut_time", "axis.max_jerk", "homing.velocity", "front_position", "gap.travel"),
    fixed=("tool.mode",),
)
runs = MACHINE.runs


def features(block: CutToLength) -> set[Any]:
    """The remarkable features of the block's present state."""
    return cutting_runs.features(block) | {
        ("in sync", block.state if block.in_sync else None),
        ("cut", block.tool.mode if block.state == State.CUTTING else None),
        ("eased", block.local.ease < 1.0),
    }


def check(block: CutToLength) -> None:
    cutting_runs.check(block, State.OFF, State.FAULT)
    assert 0.0 <= block.local.progress <= 1.0


STRATEGY = Strategy(
    runs,
    features,
    frozenset(
        {
            *cutting_runs.required_features(State, Warnings),
            *(("fault", fault) for fault in Fault),
            *(("skipped", reason) for reason in SkipReason),
            *(("in sync", state) for state in (State.SYNCHRONOUS, State.CUTTING, State.CLEARING)),
            *(("cut", mode) for mode in ToolMode),
            ("eased", True),
        }
    ),
    check,
)
