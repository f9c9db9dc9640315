"""Runs the block at a constant line velocity, to see whether it does what was predicted."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from motionsync.cut_to_length.interface import LateMode, Source, StartMode, State, ToolMode
from motionsync.cut_to_length.limits import cycle_time
from motionsync.master import MasterInput

from ..interface.stepper import RefusedError, Stepper
from ..scenario.recording import Reals
from .machine_data import MachineData

PIECES = 6  # of a run, if nothing else is said
STEPS = 9.7  # of a run in each piece; no event comes at a fixed part of a step
SHORT = 1e-3  # u: a length of pieces that the kerf keeps apart
CYCLE_STEPS = 40  # of a run of one cycle


@dataclass(frozen=True)
class Run:
    """What the block did while some pieces passed.

    Attributes:
        pieces: how many were to pass; the run ends with the first that is skipped.
        cuts, skipped: cuts made and left out.
        warned: whether the warning line_too_fast stood before a cut was left out.
        gap_skipped: whether a gap was not opened, for the axis's limits.
        exceeded: whether the carriage exceeded a limit of its axis.
        refused: why the block refused a step; empty: it did not.
    """

    pieces: int
    cuts: int
    skipped: int
    warned: bool
    gap_skipped: bool
    exceeded: bool
    refused: str = ""

    @property
    def made(self) -> bool:
        """Whether every cut was made, within the limits of the axis."""
        return self.cuts >= self.pieces and not self.skipped and not self.exceeded and not self.refused

    @property
    def text(self) -> str:
        """What happened, in words."""
        if self.refused:
            return self.refused
        told = [f"{self.cuts} cuts, {self.skipped} skipped"]
        told += ["the warning line_too_fast"] if self.warned else []
        told += ["a limit of the axis exceeded"] if self.exceeded else []
        return ", ".join(told)


def start_values(data: MachineData, length: float) -> dict[str, Any]:
    """The machine as it is run: it starts by itself from home, with the material's front end at home.

    Its way home is not eased: what is predicted is the direct one. An eased one stops first, which is quicker where the
    deceleration is the greater limit."""
    home = data.value("home_position")
    timed = data.value("tool.mode") == ToolMode.FEEDBACK  # its cut lasts as long as is expected
    return {
        **data.start,
        "axis.initial_position": home,
        "front_position": home,
        "auto_start": True,
        "length": length,
        "source": Source.LENGTH,
        "start_mode": StartMode.FRONT,
        "late_mode": LateMode.SKIP,
        "homing.ease": False,
        "tool.mode": ToolMode.TIME if timed else data.value("tool.mode"),
        "master.input_mode": MasterInput.START_OF_STEP,
        "master.period": 0.0,
        **dict.fromkeys(("hold", "waste", "start", "stop", "abort", "cut_now", "take_sample", "order.add"), False),
    }


def simulate(data: MachineData, length: float, velocity: float, pieces: int = PIECES) -> Run:
    """Run the block while so many pieces of this length pass at this line velocity, or until cuts are skipped."""
    h = data.pitch(length) / velocity / STEPS
    stepper = Stepper(data.recipe.block())
    warned = gap_skipped = exceeded = False
    skipped, refused = 0, ""
    try:
        stepper.initialize(start_values(data, length))
        for i in range(round((pieces + 0.9) * STEPS)):
            stepper.step(h, {"master.position": i * h * velocity, "master.velocity": velocity})
            skipped = stepper["statistics.skipped"]
            if skipped:
                break
            warned |= stepper["warning.line_too_fast"]
            gap_skipped |= stepper["warning.gap_skipped"]
            exceeded |= stepper["warning.limit_exceeded"]
    except RefusedError as e:
        refused = str(e)
    return Run(pieces, stepper["statistics.cuts"], skipped, warned, gap_skipped, exceeded, refused)


def lone_cycle(data: MachineData, velocity: float, steps: int) -> Iterator[Stepper]:
    """The block at each of so many steps, which begin shortly before a cycle and end before the next one begins.

    The first cut lies a pitch and half a kerf behind home, where the carriage begins less than a cycle before it."""
    time = cycle_time(data.machine, velocity)
    pitch = max(2.0 * velocity * time, data.pitch(SHORT))
    stepper = Stepper(data.recipe.block())
    stepper.initialize(start_values(data, data.length(pitch)))
    kerf = data.pitch(data.value("kerf")) - data.pitch(0.0)
    begin = max((pitch - 0.5 * kerf) / velocity - time, 0.0)
    if begin > 0.0:
        stepper.step(begin, {"master.position": 0.0, "master.velocity": velocity})
    h = 2.0 * time / steps
    for i in range(steps):
        yield stepper.step(h, {"master.position": (begin + i * h) * velocity, "master.velocity": velocity})


def arrival(data: MachineData, velocity: float) -> float:
    """The time from the start of an approach to the arrival at home, in s, of a run; 0: the carriage was not there."""
    last = deque(lone_cycle(data, velocity, CYCLE_STEPS), 1).pop()
    return max(float(last["local.home_time"] - last["local.start_time"]), 0.0)


def cycle_motion(data: MachineData, velocity: float, steps: int) -> Reals:
    """One cycle of the carriage in a run of so many steps: time since its start, position, velocity, acceleration and
    state, a column each, in s and u."""
    rows = []
    for at in lone_cycle(data, velocity, steps):
        if State.APPROACHING <= at["state"] <= State.RETURNING:
            motion = (float(at[f"slave.{name}"]) for name in ("position", "velocity", "acceleration"))
            rows.append([at["clock"] - at["local.start_time"], *motion, float(at["state"])])
    return np.array(rows)
