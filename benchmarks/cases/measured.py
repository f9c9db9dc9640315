"""What a block is measured in, and how the axis that moves is set."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from motionsync.master import MasterInput

VELOCITY = 90.0  # of the axis that moves, u/s
H = 1e-3  # s a step
PERIOD = 360.0  # of a rotary axis, u
TURNS_A_STEP = 5.0  # of a rotary master, so that much happens in each step
FAR_AWAY = 1e9  # no benchmark gets there

Values = Mapping[str, Any]
Bounds = tuple[float, float]


@dataclass(frozen=True)
class MovingAxis:
    """The axis that moves: what is set at each step.

    Attributes:
        group: the part with position, velocity and acceleration.
        counter: an Integer, the count of the axis' cycles; empty if it has none.
    """

    group: str = "master"
    counter: str = ""

    @property
    def motion(self) -> tuple[str, str, str]:
        return f"{self.group}.position", f"{self.group}.velocity", f"{self.group}.acceleration"


@dataclass(frozen=True)
class Steady:
    """A motion without events, over a master at constant velocity.

    Attributes:
        start: parameters and inputs at the initialization.
        begin: what is set before the single step that leads into the motion; the master is then at 0, unless this sets
            another position.
        first: the length of that step, s.
        holds: the values that variables have throughout the motion.
        counts: the rate of the axis' counter, 1/s.
        change: by this share the axis is faster in every second step; 0 in the first case of a block.
    """

    name: str
    start: Values = field(default_factory=dict)
    begin: Values = field(default_factory=dict)
    first: float = H
    holds: Values = field(default_factory=dict)
    counts: float = 0.0
    change: float = 0.0


@dataclass(frozen=True)
class Worst:
    """Steps at whose beginning commands are given, each from a state that differs from the one before.

    Attributes:
        start: parameters and inputs at the initialization.
        commands: the Booleans that rise at the steps' beginnings.
        velocity: of the master, u/s.
        pause: the length of the step between two such steps, s; the commands are low in it.
        between: Booleans that are raised in the step between.
        draws: Real inputs, drawn from these bounds before the step between.
        ahead: Real inputs, drawn from these bounds after the step between and added to the variable of that name.
        watch: integers and enumerations that show after the step whether the command's motion was planned.
        planned: the values of `watch` after such a step: any of these tuples, at least one.
        counts: the rate of the axis' counter, 1/s.
    """

    name: str
    commands: tuple[str, ...]
    start: Values = field(default_factory=dict)
    velocity: float = 500.0
    pause: float = H
    between: tuple[str, ...] = ()
    draws: Mapping[str, Bounds] = field(default_factory=dict)
    ahead: Mapping[str, tuple[str, Bounds]] = field(default_factory=dict)
    watch: tuple[str, ...] = ()
    planned: tuple[tuple[int, ...], ...] = ()
    counts: float = 0.0


@dataclass(frozen=True)
class Cases:
    """The cases of a block; all flavours and hosts are compared in the first steady case.

    Attributes:
        in_each_mode: the number of the steady case in which the master's input modes are compared.
        longest_us: what a worst step may take, us.
    """

    steady: tuple[Steady, ...]
    worst: tuple[Worst, ...]
    axis: MovingAxis = MovingAxis()
    in_each_mode: int = 0
    longest_us: float = 20.0

    @property
    def by_mode(self) -> dict[str, Steady]:
        """The same motion in each input mode, by the mode's name; empty for a block without a master."""
        case = self.steady[self.in_each_mode]
        modes = MasterInput if self.axis.group == "master" else ()
        return {
            mode.name: replace(case, name=f"{case.name}, {mode.name}", start={**case.start, "master.input_mode": mode})
            for mode in modes
        }


def counted(counts: float, time: float) -> int:
    """The axis' counter at a time. It does not change where a step of a run starts, since that time is inexact."""
    return math.floor(counts * time + 0.25)
