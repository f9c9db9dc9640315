"""Blades on a cylinder that turns on: RotaryKnife."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple

import numpy as np

from motionsync.cutting.piece import UNLIMITED
from motionsync.rotary_knife.interface import State
from motionsync.rotary_knife.knife import Knife as KnifeData
from motionsync.rotary_knife.limits import NO_LENGTH, CycleLimit, LengthLimits
from motionsync.rotary_knife.window import Window
from motionsync.var import Unit

from ..errors import UserError
from ..interface.stepper import Stepper
from ..scenario.engineering import line_speed
from ..scenario.evaluate.expectations import Check
from ..scenario.recording import Reals
from .machine import LimitRow, Machine
from .prediction import (
    ACCELERATION,
    JERK,
    LENGTH,
    LINE,
    NOT_TAKEN,
    SHARE,
    VELOCITY,
    CuttingRun,
    Figure,
    Gap,
    Prediction,
    find_boundary,
    relative_gain,
)

WINDOW = "window"
NO_WAY = "no way between two windows"
IN_SYNC, TURNING, DOWN, REST, UP = "in sync", "turning on", "ramp down", "rest at park", "ramp up"
SCANNED = 64  # the parts of the range of pitches in which those are searched that the line is too fast for
BEYOND = 1e-9  # relative: a pitch that is longer by so much parks
START_SHARE = 0.999  # of the greatest line velocity out of rest: that of the first piece of a run
SAME_SHARE = 1e-9


class Setup(NamedTuple):
    """What the limits of a knife are computed from."""

    knife: KnifeData
    window: Window


def solve_cycle(setup: Setup, pitch: float) -> CycleLimit:
    """The cycle from one cut to the next, `pitch` of the master later; UNLIMITED is the pitch of a piece that parks."""
    cycle = CycleLimit()
    cycle.solve_piece(setup.knife, setup.window, setup.window, pitch)
    return cycle


def prepare_lengths(setup: Setup) -> LengthLimits:
    """Which pitches are possible without parking."""
    lengths = LengthLimits()
    lengths.prepare(setup.knife, setup.window)
    return lengths


@dataclass(frozen=True)
class Knife(Machine):
    """The knife is in sync in a window around each cut; between two windows it turns on, or parks. All predictions are
    those of the block, by the functions of its `limits.py`."""

    kind: ClassVar[str] = "knife"
    block: ClassVar[str] = "RotaryKnife"
    tool: ClassVar[str] = "knife"
    bound_colours: ClassVar[Mapping[str, str]] = {
        VELOCITY: "--band-1",
        ACCELERATION: "--band-0",
        JERK: "--band-3",
    }
    part_colours: ClassVar[Mapping[str, str]] = {
        IN_SYNC: "--cut",
        TURNING: "--tone-0",
        DOWN: "--tone-1",
        REST: "--band-0",
        UP: "--band-5",
    }
    needs: ClassVar[Sequence[str]] = (WINDOW,)
    state_names: ClassVar[Mapping[int, str]] = {
        State.SYNCHRONOUS: IN_SYNC,
        State.TURNING: TURNING,
        State.DISENGAGING: DOWN,
        State.WAITING: REST,
        State.ENGAGING: UP,
    }
    limit_rows: ClassVar[Sequence[LimitRow]] = (
        LimitRow(
            VELOCITY, "axis.max_velocity", "short pieces, on which the knife turns faster than the material moves"
        ),
        LimitRow(ACCELERATION, "axis.max_acceleration", "the way between two windows"),
        LimitRow(JERK, "axis.max_jerk", "the way between two windows; with sync.mode = HORIZONTAL the window, too"),
        LimitRow(
            WINDOW, "sync.before, sync.after", "the material around a cut that leaves less way between two windows"
        ),
        LimitRow(NOT_TAKEN, "allow_parking", "pieces on which the knife would have to rest"),
    )

    above_the_curve: ClassVar[str] = "Above it the block warns (warning.line_too_fast), and cuts are lost."

    @cached_property
    def setup(self) -> Setup:
        """The knife and its window, as the block has them."""
        block = self.initialized_block
        return Setup(block.knife_data, block.predictions.window)

    @cached_property
    def lengths(self) -> LengthLimits:
        """Which pitches are possible without parking."""
        return prepare_lengths(self.setup)

    @cached_property
    def relaxed(self) -> list[tuple[str, Setup, LengthLimits]]:
        """The machine with each of its limits raised, and with its window narrower, by SHARE, with its name."""
        knife, window = self.setup
        more = 1.0 + SHARE
        setups = {
            VELOCITY: Setup(replace(knife, max_velocity=more * knife.max_velocity), window),
            ACCELERATION: Setup(replace(knife, max_acceleration=more * knife.max_acceleration), window),
            JERK: Setup(replace(knife, max_jerk=more * knife.max_jerk), window),
            WINDOW: Setup(knife, self.narrower_window()),
        }
        return [(name, setup, prepare_lengths(setup)) for name, setup in setups.items()]

    def narrower_window(self) -> Window:
        """The window with less material before and after the cut, by SHARE."""
        before, after = ((1.0 - SHARE) * float(self.value(f"sync.{side}")) for side in ("before", "after"))
        window = Window()
        window.set(
            self.setup.knife, float(self.value("material_factor")), before, after, float(self.value("sync.overspeed"))
        )
        return window

    @cached_property
    def ramp_up(self) -> CycleLimit:
        """Out of rest into the window."""
        cycle = CycleLimit()
        cycle.solve_ramp_up(*self.setup)
        return cycle

    @cached_property
    def parking(self) -> CycleLimit:
        """The cycle of a long piece, on which the knife parks."""
        return solve_cycle(self.setup, UNLIMITED)

    @property
    def parking_pitch(self) -> float:
        """The shortest pitch on which the knife comes to rest without shortened ramps."""
        return self.parking.cut.place

    @property
    def parking_velocity(self) -> float:
        """The greatest line velocity for pieces on which the knife parks; 0: it must not park."""
        return self.parking.max_line_velocity if self.setup.knife.may_park else 0.0

    def velocity_at(self, pitch: float) -> float:
        """The greatest line velocity for pieces of this pitch, in u/s; 0: there is none."""
        if pitch > self.lengths.longest and not self.setup.knife.may_park:
            return 0.0
        return solve_cycle(self.setup, pitch).max_line_velocity

    @property
    def greatest_velocity(self) -> float:
        return max(self.lengths.max_line_velocity, self.parking_velocity)

    @property
    def greatest_velocity_bound(self) -> str:
        unit = self.unit_of(Unit.POSITION)
        pieces = "on which it parks" if self.parks_on_fastest else f"of {self.length(self.lengths.fastest):.6g} {unit}"
        start = line_speed(self.ramp_up.max_line_velocity, self.unit)
        bound = self.find_bound(self.fastest_cycle)
        return f"with pieces {pieces.rstrip()}, limited by the knife's {bound}; out of rest {start}"

    @property
    def parks_on_fastest(self) -> bool:
        """Whether pieces on which the knife parks admit the greatest line velocity."""
        return self.parking_velocity > self.lengths.max_line_velocity

    @property
    def fastest_cycle(self) -> CycleLimit:
        """A cycle that admits the greatest line velocity."""
        return self.parking if self.parks_on_fastest else solve_cycle(self.setup, self.lengths.fastest)

    def check(self) -> None:
        if self.greatest_velocity <= 0.0:
            raise UserError("the knife can follow no line")

    def pitch_range(self, slow_velocity: float) -> tuple[float, float]:
        return self.shortest_pitch(slow_velocity), self.lengths.longest

    @property
    def special_lengths(self) -> Sequence[float]:
        """That of the fastest line, the longest without parking, and the next longer one."""
        longest = self.lengths.longest
        return [self.length(pitch) for pitch in (self.lengths.fastest, longest, longest * (1.0 + BEYOND))]

    # --- predictions ---

    def predict_greatest_velocity(self, length: float) -> Prediction:
        pitch = self.pitch(length)
        velocity = self.velocity_at(pitch)
        if velocity <= 0.0:
            bound = NO_WAY if pitch <= self.lengths.longest else NOT_TAKEN
            return Prediction(LENGTH, length, 0.0, None, bound, bound)
        gains = {
            name: relative_gain(solve_cycle(setup, pitch).max_line_velocity, velocity)
            for name, setup, _ in self.relaxed
        }
        cycle = solve_cycle(self.setup, pitch)
        bound = self.find_bound(cycle)
        return Prediction(
            LENGTH,
            length,
            velocity,
            velocity,
            bound,
            bound,
            gains,
            self.parts(cycle, pitch, velocity),
            self.peaks(cycle, velocity),
        )

    def predict_shortest_length(self, velocity: float) -> Prediction:
        pitch = self.shortest_pitch(velocity)
        if pitch >= NO_LENGTH:
            bound = self.find_bound(self.fastest_cycle)
            return Prediction(LINE, None, velocity, None, bound, bound)
        gains = {
            name: relative_gain(pitch, shortest_turning(setup, lengths, velocity))
            for name, setup, lengths in self.relaxed
            if pitch <= self.lengths.longest
        }
        cycle = solve_cycle(self.setup, pitch)
        bound, length = self.find_bound(cycle), max(self.length(pitch), 0.0)
        return Prediction(
            LINE,
            length,
            velocity,
            length,
            bound,
            bound,
            gains,
            self.parts(cycle, pitch, velocity),
            self.peaks(cycle, velocity),
            self.find_gap(velocity, pitch),
        )

    def shortest_pitch(self, velocity: float) -> float:
        """The shortest pitch at a line velocity > 0; NO_LENGTH: there is none."""
        pitch = shortest_turning(self.setup, self.lengths, velocity)
        if pitch >= NO_LENGTH and self.parking_velocity >= velocity:
            return find_boundary(
                self.parking_pitch, self.lengths.longest, lambda pitch: self.velocity_at(pitch) < velocity
            )
        return pitch

    @cached_property
    def scanned(self) -> list[tuple[float, float]]:
        """Pitches up to which the greatest line velocity falls and rises again, with this velocity."""
        first, longest, last = self.lengths.fastest, self.lengths.longest, self.parking_pitch
        spread = np.linspace(first, max(longest, last), SCANNED + 1)
        pitches = sorted({*spread.tolist(), longest, longest * (1.0 + BEYOND)})
        return [(pitch, self.velocity_at(pitch)) for pitch in pitches]

    def find_gap(self, velocity: float, shortest: float) -> Gap | None:
        """The lengths above the shortest one for which a line of this velocity is too fast."""
        scanned = [(pitch, greatest) for pitch, greatest in self.scanned if pitch >= shortest]
        pitches, lost = [pitch for pitch, _ in scanned], [pitch for pitch, greatest in scanned if greatest < velocity]

        def too_fast(pitch: float) -> bool:
            return self.velocity_at(pitch) < velocity

        if not lost:
            return None
        ends = pairwise([shortest, *pitches])
        begin = next(find_boundary(low, high, too_fast) for low, high in ends if high == lost[0])
        end = next((find_boundary(high, low, too_fast) for low, high in pairwise(pitches) if low == lost[-1]), None)
        return Gap(self.length(begin), None if end is None else self.length(end))

    def find_bound(self, cycle: CycleLimit) -> str:
        """Which limit of the axis a cycle reaches first on a line that gets faster."""
        knife, peaks, v = self.setup.knife, cycle.peaks, cycle.max_line_velocity
        uses = {
            VELOCITY: peaks.d1 * v / knife.max_velocity,
            ACCELERATION: peaks.d2 * v * v / knife.max_acceleration,
            JERK: peaks.d3 * v * v * v / knife.max_jerk,
        }
        return max(uses, key=lambda name: uses[name])

    def parts(self, cycle: CycleLimit, pitch: float, velocity: float) -> dict[str, float]:
        """The parts of a cycle at a line velocity, in s."""
        window, way = self.setup.window, cycle.way
        sync, travel = window.before + window.after, pitch - window.before - window.after
        down, up = (section.end - section.begin for section in (way.first, way.ramp_up))
        travels = {IN_SYNC: sync, TURNING: travel, DOWN: 0.0, REST: 0.0, UP: 0.0}
        if way.parks:
            travels |= {TURNING: 0.0, DOWN: down, REST: max(travel - down - up, 0.0), UP: up}
        return {name: travel / velocity for name, travel in travels.items()}

    def peaks(self, cycle: CycleLimit, velocity: float) -> dict[str, Figure]:
        """The knife's greatest velocity and acceleration in a cycle at a line velocity."""
        return {
            "knife's velocity": Figure(cycle.peaks.d1 * velocity, self.slave_unit_of(Unit.VELOCITY)),
            "knife's acceleration": Figure(cycle.peaks.d2 * velocity * velocity, self.slave_unit_of(Unit.ACCELERATION)),
        }

    # --- runs of the block ---

    @property
    def lead_in(self) -> float:
        """The ramp up out of rest, with the window's half after it."""
        return -self.ramp_up.way.ramp_up.begin

    def first_velocity(self, velocity: float) -> float:
        """The knife comes out of rest on a slower line, where the ramp up limits the line more than the pieces do."""
        return min(velocity, START_SHARE * self.ramp_up.max_line_velocity)

    def start_values(self, length: float) -> dict[str, Any]:
        """The material's front end is so far from the cut that the first piece can be cut."""
        lead_in = self.lead_in * float(self.value("material_factor"))
        return super().start_values(length) | {"front_position": -lead_in}

    def check_cycle(self, prediction: Prediction, run: CuttingRun) -> Check:
        """The knife rests for as great a share of each cycle as predicted."""
        assert prediction.cycle
        assert prediction.cycle_time
        expected = prediction.cycle[REST] / prediction.cycle_time
        return Check(
            f"the knife rests for {100.0 * expected:.9g} % of each cycle",
            f"{100.0 * run.reserve:.9g} %",
            abs(run.reserve - expected) <= SAME_SHARE,
        )

    def simulate_cycle(self, length: float, velocity: float, steps: int) -> Reals:
        turn = float(self.value("knife.turn"))
        rows = np.array(list(self._cycle_rows(length, velocity, steps)))
        rows[:, 0] -= rows[0, 0]
        rows[:, 1] = np.unwrap(rows[:, 1], period=turn)
        rows[:, 1] -= turn / float(self.value("knife.blades")) * round(rows[0, 1] / turn)
        return rows

    def _cycle_rows(self, length: float, velocity: float, steps: int) -> Iterator[list[float]]:
        """Step the block from the second cut to the third one; the first is made on a line that may be slower."""
        stepper, position = Stepper(self.recipe.block()), 0.0
        stepper.initialize(self.start_values(length))

        def travel(distance: float, v: float) -> list[float]:
            nonlocal position
            stepper.step(distance / v, {"master.position": position, "master.velocity": v})
            position += distance
            motion = (float(stepper[f"slave.{name}"]) for name in ("position", "velocity", "acceleration"))
            return [stepper["clock"], *motion, float(stepper["state"])]

        first = self.first_velocity(velocity)
        travel(1e-3 * self.lead_in, first)
        travel(stepper["next_cut.position"] - position, first)
        pitch = self.pitch(length)
        yield travel(pitch, velocity)
        for _ in range(steps):
            yield travel(pitch / steps, velocity)

    @property
    def cycle_limits(self) -> tuple[Sequence[float], Sequence[float], Sequence[float]]:
        knife = self.setup.knife
        return (), (knife.max_velocity,), (knife.max_acceleration, -knife.max_acceleration)


def shortest_turning(setup: Setup, lengths: LengthLimits, velocity: float) -> float:
    """The shortest pitch without parking at a line velocity > 0; NO_LENGTH: there is none."""
    lengths.solve_shortest(setup.knife, setup.window, velocity)
    return lengths.shortest
