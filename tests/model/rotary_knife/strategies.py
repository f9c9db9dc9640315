"""Random runs of the RotaryKnife, as hypothesis draws them: ordinary ones, and ones at the limits of the inputs."""

from random import Random
from typing import Any

from motionsync.cutting.interface import CuttingWarnings
from motionsync.motion.exceeded_limit import Limit
from motionsync.rotary_knife.block import RotaryKnife
from motionsync.rotary_knife.faults import SkipReason
from motionsync.rotary_knife.interface import State, SyncMode
from tests.support.blocks import cutting_runs
from tests.support.blocks.cutting_runs import COMMANDS, CuttingMachine
from tests.support.blocks.runs import Strategy


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
    }


def random_window(r: Random, length: float, _duration: float) -> dict[str, Any]:
    """A window that any of these knives can have."""
    return {
        "sync.before": length * r.choice((0.0, 0.05, 0.12)),
        "sync.after": length * r.choice((0.0, 0.05, 0.12)),
        "sync.overspeed": r.choice((0.0, 0.0, 0.05, -0.1)),
    }


KNIFE_LIMITS = (Limit.MAX_VELOCITY, Limit.MAX_ACCELERATION, Limit.MAX_DECELERATION, Limit.MAX_JERK)

MACHINE = CuttingMachine(
    machine=random_knife,
    tool=random_window,
    commands=COMMANDS | {"stop": (0.002, 0.05), "abort": (0.002, 0.05), "cut_now": (0.02, 0.3)},
    lengths=(1.0, 1.0, 0.7, 1.5, 2.5),
    new_lengths=(1.0, 1.0, 1.5, 0.4, 3.0, 0.0),
    order_lengths=(1.1, 0.8),
    new_order_lengths=(1.0, 1.3, 0.7, 0.0),
    checked=("kerf", "sync.before", "sync.after", "sync.overspeed", "front_position", "line.margin"),
)
runs = MACHINE.runs


def features(block: RotaryKnife) -> set[Any]:
    """The remarkable features of the block's present state."""
    return cutting_runs.features(block) | {("in sync", block.sync.mode if block.in_sync else None)}


def check(block: RotaryKnife) -> None:
    cutting_runs.check(block, State.OFF, State.FAULT)
    assert 0.0 <= block.slave.position < block.knife.turn
    assert block.in_sync == block.knife.in_window == (block.state == State.SYNCHRONOUS)


STRATEGY = Strategy(
    runs,
    features,
    frozenset(
        {
            *cutting_runs.required_features(State, CuttingWarnings),
            *(("in sync", mode) for mode in SyncMode),
            *(("skipped", reason) for reason in SkipReason),
            *(("exceeded", limit) for limit in KNIFE_LIMITS),
        }
    ),
    check,
)
