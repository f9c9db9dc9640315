"""A saw that runs with the material: CutToLength."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from motionsync.cut_to_length import machine_limits as limits
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.var import Unit

from ..errors import UserError
from ..interface.stepper import Stepper
from ..scenario.evaluate.expectations import Check
from ..scenario.recording import Reals
from .machine import LimitRow, Machine
from .prediction import (
    ACCELERATION,
    JERK,
    LENGTH,
    LINE,
    SHARE,
    TOLERANCE,
    VELOCITY,
    CuttingRun,
    Figure,
    Prediction,
    find_boundary,
    greatest_gain,
    relative_gain,
)

ENDLESS_PITCH = 1e300  # with it the cycle time limits nothing
SHORT_LENGTH = 1e-3  # u, of pieces between which there is a kerf
SAME_TIME = 1e-9  # relative
CHECKED_STEPS = 40  # of the run of one cycle of which the end is checked

STROKE, CYCLE, WAYS = "stroke", "cycle time", "ways of approach, cut and gap"
LIMITS = {  # what limits the carriage, and the fields of the machine with these limits
    VELOCITY: ("max_velocity", "homing_velocity"),
    ACCELERATION: ("approach_acceleration", "homing_acceleration", "homing_deceleration"),
    JERK: ("approach_jerk", "homing_jerk"),
}
NEEDS = {  # what else takes time or distance in a cycle, and the fields of the machine
    "approach": ("approach_distance", "approach_reserve"),
    "settling": ("settle_time", "on_delay"),
    "cut": ("cut_time", "cut_distance"),
    "gap": ("gap_travel", "gap_distance"),
    "clearing": ("retract_time",),
    "rest at home": ("homing_settle_time",),
}


def compute_cycle(machine: limits.Machine, velocity: float) -> dict[str, float]:
    """The parts of the shortest cycle at a line velocity > 0, in s."""
    carriage = machine.coupling * velocity
    approach = 2.0 * limits.approach_distance(machine, velocity) / carriage
    cut = machine.cut_distance / carriage if machine.by_distance else machine.cut_time
    sync, gap = limits.tool_time(machine, carriage, approach), limits.gap_time(machine, carriage)
    rest = machine.homing_settle_time
    return {
        "approach": approach,
        "settling": max(sync - cut - machine.retract_time, 0.0),
        "cut": cut,
        "gap": gap,
        "clearing": machine.retract_time,
        "way home": limits.cycle_time(machine, velocity) - approach - sync - gap - rest,
        "rest at home": rest,
    }


def relax_each(machine: limits.Machine) -> Iterator[tuple[str, limits.Machine]]:
    """Yield the machine with each of its limits raised, and with each of its needs reduced, by SHARE, with its name."""

    def scaled(fields: tuple[str, ...], factor: float) -> limits.Machine:
        return replace(machine, **{name: factor * getattr(machine, name) for name in fields})

    for name, fields in LIMITS.items():
        yield name, scaled(fields, 1.0 + SHARE)
    travel = machine.max_position - machine.home_position
    yield STROKE, replace(machine, max_position=machine.max_position + SHARE * travel)
    for name, fields in NEEDS.items():
        yield name, scaled(fields, 1.0 - SHARE)


def is_lost(machine: limits.Machine, velocity: float, pitch: float) -> bool:
    """Whether cuts of this pitch, in u of the master, are lost at this line velocity, which must be > 0 and admissible.

    A cycle that is longer than the pitch lets the next approach begin late, and be shorter by as much. Cuts are lost
    where that is shorter than the limits allow. Else the next cycle is shorter by twice as much, and the carriage has
    caught up; but where the tool's delay is waited for in sync, it is not, and each start is later than the one before.
    """
    late = machine.coupling * (limits.shortest_pitch(machine, velocity) - pitch)
    distance = limits.approach_distance(machine, velocity) - max(late, 0.0)
    if late <= 0.0 or distance < limits.lead(machine, velocity):
        return late > 0.0
    shortened = replace(machine, approach_distance=distance, approach_reserve=0.0)
    return limits.shortest_pitch(shortened, velocity) > pitch


def max_line_velocity(machine: limits.Machine, pitch: float) -> float:
    """The greatest line velocity, in u/s, at which cuts of that pitch, in u, are reached; 0: there is none."""
    limit = limits.CycleLimit()
    limit.solve(machine, pitch)
    return limit.max_line_velocity


@dataclass(frozen=True)
class Saw(Machine):
    """The carriage goes with the material while the blade cuts, and comes home. All predictions are those of the block,
    by the functions of its `machine_limits.py`."""

    kind: ClassVar[str] = "saw"
    block: ClassVar[str] = "CutToLength"
    tool: ClassVar[str] = "carriage"
    bound_colours: ClassVar[Mapping[str, str]] = {CYCLE: "--band-0", STROKE: "--band-3", VELOCITY: "--band-1"}
    part_colours: ClassVar[Mapping[str, str]] = {
        "approach": "--tone-0",
        "settling": "--band-1",
        "cut": "--cut",
        "gap": "--band-3",
        "clearing": "--band-5",
        "way home": "--tone-1",
        "rest at home": "--band-0",
    }
    needs: ClassVar[Sequence[str]] = tuple(NEEDS)
    state_names: ClassVar[Mapping[int, str]] = {
        State.APPROACHING: "approach",
        State.SYNCHRONOUS: "settling",
        State.CUTTING: "cut",
        State.PULLING: "gap",
        State.CLEARING: "clearing",
        State.RETURNING: "way home",
    }
    limit_rows: ClassVar[Sequence[LimitRow]] = (
        LimitRow(
            VELOCITY,
            "axis.max_velocity, homing.velocity",
            "the line that the carriage can follow, and the way home",
        ),
        LimitRow(
            ACCELERATION,
            "axis.max_acceleration, axis.max_deceleration, approach.acceleration, homing.acceleration, "
            "homing.deceleration",
            "approach, and way home",
        ),
        LimitRow(JERK, "axis.max_jerk, approach.jerk, homing.jerk", "approach, and way home"),
        LimitRow(
            STROKE,
            "axis.max_position - home_position",
            "how far the carriage goes with the material, and until it could be at rest after that",
        ),
        LimitRow(
            "approach",
            "approach.distance, approach.reserve",
            "the approach, where it is longer than the limits require",
        ),
        LimitRow("settling", "tool.settle_time, tool.on_delay", "the time in sync before the blade touches"),
        LimitRow("cut", "tool.cut_time, tool.cut_distance", "the time of the cut"),
        LimitRow("gap", "gap.distance, gap.travel", "the time in which the gap is opened"),
        LimitRow("clearing", "tool.retract_time", "the time until the blade has left the material"),
        LimitRow("rest at home", "homing.settle_time", "the time before the next approach"),
    )

    above_the_curve: ClassVar[str] = (
        "Above it the block warns (warning.line_too_fast). Where there is a reserve of the approach, it is used up "
        "first, and cuts are lost above the dashed curve."
    )

    @cached_property
    def figures(self) -> limits.Machine:
        """What the block computes its predictions from.

        Raises:
            UserError: the block refuses these data.
        """
        figures: limits.Machine = self.initialized_block.carriage.machine
        return figures

    @cached_property
    def greatest_velocity(self) -> float:
        return max_line_velocity(self.figures, ENDLESS_PITCH)

    @property
    def greatest_velocity_bound(self) -> str:
        return f"for any length, limited by the carriage's {self.find_bound(self.greatest_velocity)}"

    def check(self) -> None:
        if self.greatest_velocity <= 0.0:
            end, home = self.figures.max_position, self.figures.home_position
            raise UserError(
                f"axis.max_position = {end:g} is too near: from home_position = {home:g} the travel is "
                f"{end - home:g}, and no cycle is that short"
            )

    def pitch_range(self, slow_velocity: float) -> tuple[float, float]:
        return (
            limits.shortest_pitch(self.figures, slow_velocity),
            limits.shortest_pitch(self.figures, self.greatest_velocity),
        )

    # --- predictions ---

    def predict_greatest_velocity(self, length: float) -> Prediction:
        machine, pitch = self.figures, self.pitch(length)
        velocity = max_line_velocity(machine, pitch)
        if velocity <= 0.0:
            return Prediction(LENGTH, length, 0.0, None, WAYS, WAYS, figures=self.stroke_at(0.0))
        gains = {n: relative_gain(max_line_velocity(m, pitch), velocity) for n, m in relax_each(machine)}
        bound = self.find_bound(velocity)
        return Prediction(
            LENGTH,
            length,
            velocity,
            find_boundary(velocity, self.greatest_velocity, lambda v: is_lost(machine, v, pitch)),
            bound,
            _limited_by(bound, gains),
            gains,
            compute_cycle(machine, velocity),
            self.stroke_at(velocity),
        )

    def predict_shortest_length(self, velocity: float) -> Prediction:
        machine, stroke = self.figures, self.stroke_at(velocity)
        bound = self.find_bound(velocity / (1.0 + TOLERANCE))
        if bound != CYCLE:
            gains = self.gains_of_greatest_velocity() if self.greatest_velocity else {}
            return Prediction(LINE, None, velocity, None, bound, bound, gains, figures=stroke)
        pitch = limits.shortest_pitch(machine, velocity)
        gains = {n: relative_gain(pitch, limits.shortest_pitch(m, velocity)) for n, m in relax_each(machine)}
        lost = find_boundary(pitch, 0.0, lambda p: is_lost(machine, velocity, p))
        return Prediction(
            LINE,
            max(self.length(pitch), 0.0),
            velocity,
            max(self.length(lost), 0.0),
            CYCLE,
            _limited_by(CYCLE, gains),
            gains,
            compute_cycle(machine, velocity),
            stroke,
        )

    def gains_of_greatest_velocity(self) -> dict[str, float]:
        """The gains of the greatest line velocity for any length."""
        top = self.greatest_velocity
        return {
            name: relative_gain(max_line_velocity(machine, ENDLESS_PITCH), top)
            for name, machine in relax_each(self.figures)
        }

    def find_bound(self, velocity: float) -> str:
        """What limits a line that is a little faster than this velocity, in u/s, however long the pieces are; CYCLE:
        only the cycle time does."""
        machine, more = self.figures, velocity * (1.0 + TOLERANCE)
        if machine.coupling * more > machine.max_velocity:
            return VELOCITY
        return CYCLE if limits.is_admissible(machine, more) else STROKE

    def stroke_at(self, velocity: float) -> dict[str, Figure]:
        """How far the carriage goes from home."""
        return {STROKE: Figure(limits.stroke(self.figures, velocity), self.unit_of(Unit.POSITION))}

    # --- runs of the block ---

    def start_values(self, length: float) -> dict[str, Any]:
        """The machine starts from home, with the material's front end at home.

        Its way home is not eased, since the direct one is predicted. An eased one stops first, which is quicker where
        the deceleration is the greater limit."""
        home = self.value("home_position")
        timed = self.value("tool.mode") == ToolMode.FEEDBACK  # its cut lasts as long as is expected
        return super().start_values(length) | {
            "axis.initial_position": home,
            "front_position": home,
            "homing.ease": False,
            "tool.mode": ToolMode.TIME if timed else self.value("tool.mode"),
        }

    def check_cycle(self, prediction: Prediction, run: CuttingRun) -> Check:
        """The carriage is at home as long after the start of its approach as predicted."""
        velocity = prediction.velocity * (1.0 - TOLERANCE)  # an admissible one, rounded or not
        cycle = compute_cycle(self.figures, velocity)
        expected = limits.cycle_time(self.figures, velocity) - cycle["rest at home"]
        simulated = self.simulate_return_time(velocity)
        return Check(
            f"the carriage is at home {expected:.9g} s after the start of its approach",
            f"{simulated:.9g} s",
            abs(simulated - expected) <= SAME_TIME * expected,
        )

    def simulate_return_time(self, velocity: float) -> float:
        """Simulate the time from the start of an approach to the arrival at home, in s; 0: the carriage did not
        arrive."""
        last = deque(self.step_through_cycle(velocity, CHECKED_STEPS), 1).pop()
        return max(float(last["local.home_time"] - last["local.start_time"]), 0.0)

    def simulate_cycle(self, length: float, velocity: float, steps: int) -> Reals:
        rows = []
        for block in self.step_through_cycle(velocity, steps):
            if State.APPROACHING <= block["state"] <= State.RETURNING:
                motion = (float(block[f"slave.{name}"]) for name in ("position", "velocity", "acceleration"))
                rows.append([block["clock"] - block["local.start_time"], *motion, float(block["state"])])
        return np.array(rows)

    def step_through_cycle(self, velocity: float, steps: int) -> Iterator[Stepper]:
        """Step the block through one cycle of the carriage, from shortly before its start to before the next one.

        The first cut is a pitch and half a kerf behind home, where the carriage starts less than a cycle before it."""
        time = limits.cycle_time(self.figures, velocity)
        pitch = max(2.0 * velocity * time, self.pitch(SHORT_LENGTH))
        stepper = Stepper(self.recipe.block())
        stepper.initialize(self.start_values(self.length(pitch)))
        kerf = self.pitch(self.value("kerf")) - self.pitch(0.0)
        start = max((pitch - 0.5 * kerf) / velocity - time, 0.0)
        if start > 0.0:
            stepper.step(start, {"master.position": 0.0, "master.velocity": velocity})
        h = 2.0 * time / steps
        for i in range(steps):
            yield stepper.step(h, {"master.position": (start + i * h) * velocity, "master.velocity": velocity})

    @property
    def cycle_limits(self) -> tuple[Sequence[float], Sequence[float], Sequence[float]]:
        m = self.figures
        slowing = -max(m.homing_acceleration, m.homing_deceleration)
        return (
            (m.home_position, m.max_position),
            (m.max_velocity, -m.homing_velocity),
            (m.approach_acceleration, slowing, m.homing_deceleration),
        )


def _limited_by(bound: str, gains: Mapping[str, float]) -> str:
    """The bound in words; of the cycle time with the limit of the carriage on which it depends most."""
    greatest = greatest_gain(gains, LIMITS) if bound == CYCLE else ""
    return f"{bound}: {greatest}" if greatest else bound
