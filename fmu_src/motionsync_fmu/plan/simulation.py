"""Runs the block at a constant line velocity, to see whether it does what was predicted."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cut_to_length.machine_limits import cycle_time
from motionsync.cutting.interface import LateMode, Source, StartMode
from motionsync.master import MasterInput

from ..interface.stepper import RefusedError, Stepper
from ..scenario.recording import Reals
from .machine_data import MachineData

PIECES = 6  # of a run, by default
STEPS_PER_PIECE = 9.7  # so that no event is at the same fraction of each step
SHORT_LENGTH = 1e-3  # u, of pieces between which there is a kerf
CYCLE_STEPS = 40  # of a run of one cycle


@dataclass(frozen=True)
class CuttingRun:
    """What the block did while some pieces passed.

    Attributes:
        pieces: how many had to pass; the run ends with the first that is skipped.
        cuts, skipped: how many cuts were made, and how many left out.
        has_warned: whether the warning line_too_fast was active before a cut was left out.
        has_skipped_gap: whether a gap was not opened, because of the axis's limits.
        has_exceeded_limit: whether the carriage exceeded a limit of its axis.
        refusal: why the block refused a step; empty: it did not.
    """

    pieces: int
    cuts: int
    skipped: int
    has_warned: bool
    has_skipped_gap: bool
    has_exceeded_limit: bool
    refusal: str = ""

    @property
    def has_made_all(self) -> bool:
        """Whether every cut was made, within the limits of the axis."""
        return self.cuts >= self.pieces and not self.skipped and not self.has_exceeded_limit and not self.refusal

    @property
    def text(self) -> str:
        """The result in words."""
        if self.refusal:
            return self.refusal
        parts = [f"{self.cuts} cuts, {self.skipped} skipped"]
        parts += ["the warning line_too_fast"] if self.has_warned else []
        parts += ["a limit of the axis exceeded"] if self.has_exceeded_limit else []
        return ", ".join(parts)


def start_values(data: MachineData, length: float) -> dict[str, Any]:
    """The start values of a run: the machine starts by itself from home, with the material's front end at home.

    Its way home is not eased, since the direct one is predicted. An eased one stops first, which is quicker where the
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


def simulate(data: MachineData, length: float, velocity: float, pieces: int = PIECES) -> CuttingRun:
    """Run the block while so many pieces of this length pass at this line velocity, or until cuts are skipped."""
    h = data.pitch(length) / velocity / STEPS_PER_PIECE
    stepper = Stepper(data.recipe.block())
    has_warned = has_skipped_gap = has_exceeded_limit = False
    skipped, refusal = 0, ""
    try:
        stepper.initialize(start_values(data, length))
        for i in range(round((pieces + 0.9) * STEPS_PER_PIECE)):
            stepper.step(h, {"master.position": i * h * velocity, "master.velocity": velocity})
            skipped = stepper["statistics.skipped"]
            if skipped:
                break
            has_warned |= stepper["warning.line_too_fast"]
            has_skipped_gap |= stepper["warning.gap_skipped"]
            has_exceeded_limit |= stepper["warning.limit_exceeded"]
    except RefusedError as error:
        refusal = str(error)
    return CuttingRun(
        pieces, stepper["statistics.cuts"], skipped, has_warned, has_skipped_gap, has_exceeded_limit, refusal
    )


def step_through_cycle(data: MachineData, velocity: float, steps: int) -> Iterator[Stepper]:
    """Step the block through one cycle of the carriage, from shortly before its start to before the next one starts.

    The first cut is a pitch and half a kerf behind home, where the carriage starts less than a cycle before it."""
    time = cycle_time(data.machine, velocity)
    pitch = max(2.0 * velocity * time, data.pitch(SHORT_LENGTH))
    stepper = Stepper(data.recipe.block())
    stepper.initialize(start_values(data, data.length(pitch)))
    kerf = data.pitch(data.value("kerf")) - data.pitch(0.0)
    start = max((pitch - 0.5 * kerf) / velocity - time, 0.0)
    if start > 0.0:
        stepper.step(start, {"master.position": 0.0, "master.velocity": velocity})
    h = 2.0 * time / steps
    for i in range(steps):
        yield stepper.step(h, {"master.position": (start + i * h) * velocity, "master.velocity": velocity})


def simulate_return_time(data: MachineData, velocity: float) -> float:
    """Simulate the time from the start of an approach to the arrival at home, in s; 0: the carriage did not arrive."""
    last = deque(step_through_cycle(data, velocity, CYCLE_STEPS), 1).pop()
    return max(float(last["local.home_time"] - last["local.start_time"]), 0.0)


def simulate_cycle(data: MachineData, velocity: float, steps: int) -> Reals:
    """Simulate one cycle of the carriage: time since its start, position, velocity, acceleration and state, a column
    each, in s and u."""
    rows = []
    for block in step_through_cycle(data, velocity, steps):
        if State.APPROACHING <= block["state"] <= State.RETURNING:
            motion = (float(block[f"slave.{name}"]) for name in ("position", "velocity", "acceleration"))
            rows.append([block["clock"] - block["local.start_time"], *motion, float(block["state"])])
    return np.array(rows)
