"""The CutToLength on random machines and lines: places of cuts, limits, ends, blade, continuity, step sizes, state."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import Phase as Generation
from hypothesis import strategies as st

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.interface import LateMode, PieceKind, State, ToolMode
from motionsync.master import MasterInput
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import variables
from tests.model.cut_to_length.harness import CutToLengthHarness
from tests.model.cut_to_length.strategies import machine, runs, tool
from tests.support.finite import finite_steps
from tests.support.harness import MOTION, Row
from tests.support.runs import Run

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
IN_CONTACT = (State.SYNCHRONOUS, State.CUTTING, State.PULLING, State.CLEARING)
COMMANDS = ("cut_now", "take_sample", "abort", "stop", "start", "order.add", "order.skip")
LENGTH, DURATION = 1000.0, 1.0  # of a piece, u; about that of a cycle, s
LINE = LENGTH / DURATION

# A failing run is reported as it was drawn: what is drawn is a seed.
PHASES = [Generation.explicit, Generation.reuse, Generation.generate]
settings.register_profile("cut to length", derandomize=True, deadline=None, max_examples=25, phases=PHASES)
repeatable = settings.get_profile("cut to length")
rngs = st.integers(0, 2**32 - 1).map(Random)
modes = st.sampled_from([START, END])


@dataclass(frozen=True)
class Phase:
    """A time of constant acceleration of the line, and what is set and given at its beginning."""

    duration: float
    acceleration: float = 0.0
    values: dict[str, Any] = field(default_factory=dict)
    commands: tuple[str, ...] = ()


LONG_CUT = {"tool.cut_time": 0.15, "tool.cut_distance": 150.0}  # long enough to be seen


def random_machine(rng: Random, **values: Any) -> dict[str, Any]:
    """For pieces of about LENGTH on a line of about LINE, with much room; it is at home."""
    found = machine(rng, LENGTH, DURATION) | tool(rng, LENGTH, DURATION)
    found |= {"axis.initial_position": found["home_position"], "axis.max_position": 1e5, "axis.min_position": -1e5}
    found |= {"kerf": rng.choice((0.0, 5.0)), "length_correction": rng.choice((0.0, -2.0)), "homing.ease": False}
    found |= {"tool.mode": rng.choice((ToolMode.TIME, ToolMode.DISTANCE)), "length": LENGTH}
    return found | {name.replace("__", "."): value for name, value in values.items()}


def speed_for(values: dict[str, Any], share: float) -> float:
    """A line velocity that is this share of what the machine can follow with its length."""
    saw = CutToLengthHarness(values, speed=1.0).now()
    return share * float(saw["limits.max_line_velocity"])


def random_line(rng: Random, speed: float, phases: int, *, stops: bool = True) -> Iterator[Phase]:
    """The line runs, gets faster and slower within 0.4 s or more; `stops`: it stops, and turns back now and then."""
    present = speed
    for _ in range(phases):
        shares = (1.0, 1.0, 0.9, 0.5, rng.uniform(0.3, 1.0))
        target = speed * rng.choice((*shares, 0.0, -0.1) if stops else shares)
        duration = DURATION * rng.uniform(0.4, 0.8)
        yield Phase(duration, (target - present) / duration)
        present = target
        yield Phase(DURATION * rng.uniform(0.1, 1.5) if target > 0.0 else 0.2 * DURATION)


def run_phase(saw: CutToLengthHarness, phase: Phase, cuts: list[float]) -> dict[float, Row]:
    saw.put(phase.values).give(*phase.commands)
    return saw.rows(phase.duration, acceleration=phase.acceleration, cuts=cuts)


def every(duration: float, step: float) -> list[float]:
    return [i * step for i in range(1, int(duration / step) + 1)]


class Observed(CutToLengthHarness):
    """Notes where the cuts really are: in contact the blade's line is at m - s / k on the material.

    Attributes:
        begin: that of the front end when start was given.
        places: of the cuts that were made.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.places: list[float] = []
        self.begin = math.nan
        self.line = math.nan
        self.contact = 0
        super().__init__(*arguments, **options)

    def begun(self, k: float, f: float) -> "Observed":
        """start is given; the carriage's k and the material's f are computed from the parameters here."""
        self.k = k
        self.begin = self.place - 0.5 * self["kerf"] / f
        self.give("start").run(1e-9)
        return self

    def stepped(self) -> None:
        before = self.cuts
        super().stepped()
        if self.cuts > before:
            assert self.cuts == before + 1
            self.places.append(self.line)
        if self["in_sync"] and self.state != State.CLEARING:
            self.contact += 1
            self.line = self.block.master.end - self["slave.position"] / self.k


def factors(values: dict[str, Any]) -> tuple[float, float]:
    """k and f."""
    f = values["material_factor"]
    return f / math.cos(math.radians(values["diagonal_angle"])), f


# --- where the cuts lie, and the books --------------------------------------------------------------------------------


@settings(repeatable, max_examples=30)
@given(rngs, st.floats(0.6, 1.3), st.sampled_from([LateMode.SKIP, LateMode.LATE]), modes)
def test_cuts_lie_where_the_lengths_say_and_nothing_is_lost(
    rng: Random, share: float, late: LateMode, mode: MasterInput
) -> None:
    """SKIP: a whole number of pitches apart; LATE: one pitch apart, or further where the cut was late. The pieces with
    their kerfs are the material from the front end to the last cut, whatever the line does."""
    values = random_machine(rng, late_mode=late, **LONG_CUT)
    k, f = factors(values)
    saw = Observed(values, speed=speed_for(values, share), mode=mode).begun(k, f)
    for phase in random_line(rng, saw.speed, 6):
        run_phase(saw, phase, every(phase.duration, 0.05))
        assert saw.state != State.FAULT
    pitch = (LENGTH + values["kerf"] + values["length_correction"]) / f
    ends = [saw.begin, *saw.places]
    assert len(saw.places) == saw["statistics.cuts"]
    if not saw.places:
        return
    for (first, last), piece in zip(pairwise(ends), saw.pieces, strict=True):
        assert piece.length == pytest.approx(
            f * (last - first) - values["kerf"] - values["length_correction"], abs=1e-8
        )
        pitches = (last - first) / pitch
        if late == LateMode.SKIP:
            assert pitches == pytest.approx(round(pitches), abs=1e-9)
            assert piece.kind == (PieceKind.PRODUCT if round(pitches) == 1 else PieceKind.MERGED)
        else:
            assert pitches > 1.0 - 1e-9
    removed = len(saw.pieces) * (values["kerf"] + values["length_correction"])
    assert sum(saw.lengths()) + removed == pytest.approx(f * (saw.places[-1] - saw.begin), abs=1e-8)
    made = saw["statistics.length_good"] + saw["statistics.length_waste"]
    assert made == pytest.approx(sum(saw.lengths()), abs=1e-8)
    if late == LateMode.SKIP:
        skipped = round((saw.places[-1] - saw.begin) / pitch) - len(saw.pieces)
        assert saw["statistics.skipped"] >= skipped


@repeatable
@given(rngs, modes)
def test_the_books_of_orders_samples_and_waste_balance(rng: Random, mode: MasterInput) -> None:
    """Whatever is ordered, ended early or merged: each piece is in the books once, and all material is."""
    values = random_machine(rng, sample_length=0.9 * LENGTH, waste_length=0.95 * LENGTH, **LONG_CUT)
    k, f = factors(values)
    saw = Observed(values, speed=speed_for(values, 0.8), mode=mode).begun(k, f)
    for _ in range(12):
        given_now = tuple(c for c in ("cut_now", "take_sample", "order.add", "order.skip") if rng.random() < 0.2)
        new = {"order.length": LENGTH * rng.uniform(0.5, 1.5), "waste": rng.random() < 0.2}
        duration = DURATION * rng.uniform(0.2, 1.2)
        run_phase(saw, Phase(duration, 0.0, new, given_now), every(duration, 0.02))
    s = saw.block.statistics
    assert s.pieces_good + s.pieces_bad + s.pieces_sample + s.pieces_waste == s.cuts == len(saw.pieces)
    good = sum(piece.length for piece in saw.pieces if piece.good)
    samples = sum(piece.length for piece in saw.pieces if piece.kind == PieceKind.SAMPLE)
    assert s.length_good == pytest.approx(good, abs=1e-8)
    assert s.length_good + s.length_waste + samples == pytest.approx(sum(saw.lengths()), abs=1e-8)
    removed = len(saw.pieces) * (values["kerf"] + values["length_correction"])
    if saw.places:
        assert sum(saw.lengths()) + removed == pytest.approx(f * (saw.places[-1] - saw.begin), abs=1e-8)


# --- sharpness --------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=40)
@given(rngs, modes)
def test_the_highest_line_velocity_is_sharp(rng: Random, mode: MasterInput) -> None:
    """At 0.999999 of it every cut is on time, at 1.000001 the warning stands from the beginning and a cut is missed,
    unless the gap that is reckoned with is left out."""
    values = random_machine(rng, approach__reserve=0.0, approach__distance=0.0, gap__distance=0.0)
    if rng.random() < 0.3:  # a gap that the axis can pull at any velocity that it has: jerk 60 g / T^3
        duration = values["gap.travel"] / values["axis.max_velocity"]
        values["gap.distance"] = 0.9 * values["axis.max_jerk"] * duration**3 / 60.0
    values["axis.max_position"] = values["home_position"] + LENGTH * rng.choice((0.6, 1.0, 100.0))
    for share in (0.999999, 1.000001):
        saw = CutToLengthHarness(values, speed=speed_for(values, share), mode=mode).give("start")
        duration = (values["length"] + 10.0) / values["material_factor"] / saw.speed
        saw.run(0.2 * duration)
        assert saw["warning.line_too_fast"] == (share > 1.0)
        assert saw["statistics.skipped"] == 0
        for _ in range(12):
            saw.run(0.5 * duration)
        assert (saw["statistics.skipped"] > 0) == (share > 1.0 and not saw["warning.gap_skipped"])
        assert saw["statistics.late"] == 0
        if share < 1.0:
            assert saw["statistics.cuts"] >= 4
            assert saw["statistics.pieces_good"] == saw["statistics.cuts"]


# --- limits and ends --------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=25)
@given(rngs, st.floats(0.2, 1.0), modes, st.booleans())
def test_on_a_line_of_constant_velocity_no_limit_is_exceeded(
    rng: Random, share: float, mode: MasterInput, ease: bool
) -> None:
    values = random_machine(rng, homing__ease=ease)
    saw = CutToLengthHarness(values, speed=speed_for(values, share), mode=mode).give("start")
    acceleration, jerk = values["axis.max_acceleration"], values["axis.max_jerk"]
    bounds = (values["axis.max_velocity"], acceleration, jerk)
    for row in saw.rows(3.5 * LENGTH / saw.speed, cuts=every(3.5 * LENGTH / saw.speed, 0.0131)).values():
        for name, bound in zip(MOTION[1:], bounds, strict=True):
            assert abs(row[name]) <= bound * (1.0 + 1e-6), name
    assert saw["statistics.cuts"] > 0
    assert not saw["warning.limit_exceeded"]


@settings(repeatable, max_examples=30)
@given(rngs, modes)
def test_the_ends_of_the_stroke_are_never_passed(rng: Random, mode: MasterInput) -> None:
    """The line speeds up or turns back in the cuts, the tool may never answer: the carriage stops in time."""
    values = random_machine(rng, tool__timeout=0.0, gap__distance=0.0)
    values["tool.mode"] = rng.choice(list(ToolMode))
    home = values["home_position"]
    values |= {"axis.min_position": home - 50.0, "axis.max_position": home + LENGTH}
    speed = speed_for(values, 0.7)
    values["axis.max_position"] = home + 1.3 * CutToLengthHarness(values, speed=speed).now()["limits.stroke"]
    saw = CutToLengthHarness(values, speed=speed, mode=mode).give("start")
    low, high = values["axis.min_position"], values["axis.max_position"]
    change = 0.0
    for _ in range(500):
        if saw.state not in IN_CONTACT:  # in contact the acceleration stays: a jump of it is a jump of the stopping way
            change = speed * rng.choice((-2.0, 0.3, 1.0)) / rng.uniform(0.4, 0.8)
        approached = saw.state in IN_CONTACT
        (row,) = saw.rows(0.02, acceleration=change if approached else (speed - saw.speed) / 0.02).values()
        assert low - 1e-6 <= row["slave.position"] <= high + 1e-6
        if saw.state == State.FAULT:
            break
    for row in saw.rows(1.5, cuts=every(1.5, 0.01)).values():
        assert low - 1e-6 <= row["slave.position"] <= high + 1e-6


# --- the blade --------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=30)
@given(rngs, modes)
def test_the_blade_is_in_the_material_only_in_sync_or_it_is_told(rng: Random, mode: MasterInput) -> None:
    """Whatever the line does, and with commands: where blade and material move against each other, that was counted."""
    values = random_machine(rng, gap__distance=0.0)
    values |= {"tool.mode": rng.choice(list(ToolMode)), "axis.max_position": values["home_position"] + 0.9 * LENGTH}
    values["axis.min_position"] = values["home_position"] - 0.3 * LENGTH
    k, _ = factors(values)
    saw = CutToLengthHarness(values, speed=speed_for(values, 0.8), mode=mode).give("start")
    counted = 0
    for phase in random_line(rng, saw.speed, 5):
        saw.give(*(c for c in (*COMMANDS, "tool.done", "reset") if rng.random() < 0.1))
        for _ in range(int(phase.duration / 0.01)):
            saw.run(0.01, acceleration=phase.acceleration)
            if not saw["tool.blade_down"]:
                counted = saw["statistics.unsynchronised"]
            elif abs(saw["slave.velocity"] - k * saw.speed) > 1e-6 * LINE:
                assert saw["statistics.unsynchronised"] > counted
                assert saw["warning.blade_early"] or saw.state == State.FAULT


# --- continuity -------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=12)
@given(rngs, modes)
def test_position_velocity_and_acceleration_have_no_step(rng: Random, mode: MasterInput) -> None:
    """Each is the next one's integral over every event, to the rule of trapezoids; on a line of constant acceleration
    the carriage's jumps only where the line's does. (A start at standstill has an approach of no length.)"""
    values = random_machine(rng, homing__ease=rng.random() < 0.5)
    saw = CutToLengthHarness(values, speed=speed_for(values, 0.7), mode=mode).give("start")
    slope = factors(values)[0] * (1.0 + 1.875 * values["gap.distance"] / values["gap.travel"])  # the steepest
    acceleration = values["axis.max_acceleration"]
    line_acceleration = 0.0
    for phase in random_line(rng, saw.speed, 4, stops=False):
        saw.give(*(c for c in ("cut_now", "abort", "start") if rng.random() < 0.15))
        rows = {saw.time: saw.read(MOTION)}
        rows |= saw.rows(phase.duration, acceleration=phase.acceleration, cuts=every(phase.duration, 0.002))
        jerk = 1.2 * max(values["axis.max_jerk"], *(abs(row["slave.jerk"]) for row in rows.values()))
        for number, ((before, x), (after, y)) in enumerate(pairwise(rows.items())):
            h = after - before
            jump = slope * abs(phase.acceleration - line_acceleration) if number == 0 else 0.0
            gap = abs(y["slave.acceleration"] - x["slave.acceleration"])
            assert gap <= h * jerk + jump + 1e-6 * acceleration
            trapezoid = 0.5 * h * (x["slave.acceleration"] + y["slave.acceleration"])
            assert abs(y["slave.velocity"] - x["slave.velocity"] - trapezoid) <= h * h * jerk + h * jump + 1e-9 * LINE
            trapezoid = 0.5 * h * (x["slave.velocity"] + y["slave.velocity"])
            allowed = h * h * h * jerk + h * h * jump + 1e-9 * LENGTH
            assert abs(y["slave.position"] - x["slave.position"] - trapezoid) <= allowed
        line_acceleration = phase.acceleration


# --- step sizes and input modes ---------------------------------------------------------------------------------------

# What is compared is all that is put out, each with its scale. The velocities that are predicted are those of a search.
SCALES = {"POSITION": LENGTH, "VELOCITY": LINE, "ACCELERATION": 1e2 * LINE, "JERK": 1e4 * LINE, "TIME": DURATION}


def shown(saw: CutToLengthHarness) -> dict[str, tuple[Any, float]]:
    """All outputs and locals with their scales; 0: they must be equal."""
    found = {}
    for v in variables(CutToLength()):
        if v.causality in ("output", "local"):
            found[v.name] = (saw[v.name], SCALES.get(v.declaration.unit.name, 1.0) if v.kind == "Real" else 0.0)
    return found


def assert_alike(one: CutToLengthHarness, other: CutToLengthHarness) -> None:
    second = shown(other)
    assert [
        (name, value, second[name][0])
        for name, (value, scale) in shown(one).items()
        if abs(value - second[name][0]) > 1e-8 * scale
    ] == []


def random_phases(rng: Random, speed: float, number: int) -> list[Phase]:
    """A line, lengths, commands and settings. No approach begins while the line brakes hard to a stop."""
    found = []
    for phase in random_line(rng, speed, number):
        speed += phase.acceleration * phase.duration
        stops = phase.acceleration < 0.0 and speed < 0.2 * LINE  # a start would be looked for where it comes and goes
        values: dict[str, Any] = {"order.length": LENGTH * rng.uniform(0.7, 1.3), "hold": stops or rng.random() < 0.05}
        if rng.random() < 0.2:
            values["length"] = LENGTH * rng.uniform(0.7, 1.3)
        if rng.random() < 0.1:
            values["kerf"] = rng.uniform(0.0, 5.0)
        given_now = tuple(c for c in COMMANDS if rng.random() < 0.05)
        found.append(Phase(phase.duration, phase.acceleration, values, given_now))
    return found


@settings(repeatable, max_examples=16)
@given(rngs, st.sampled_from([0.001, 0.007, None]), modes, modes, st.sampled_from([0.0, 0.7 * LENGTH, 4.0 * LENGTH]))
def test_any_two_step_sizes_and_input_modes_agree(
    rng: Random, step: float | None, one: MasterInput, other: MasterInput, period: float
) -> None:
    """In all that is put out, where the line's acceleration changes and in the middle between: as few steps as there
    can be, and steps of 1 ms, 7 ms or random ones."""
    values = random_machine(rng, late_mode=rng.choice(list(LateMode)), master__period=period, sample_length=LENGTH)
    speed = speed_for(values, rng.choice((0.7, 0.9, 1.2)))
    phases = random_phases(rng, speed, 2 if step == 0.001 else 5)
    few, many = (CutToLengthHarness(values, speed=speed, mode=mode).give("start") for mode in (one, other))
    for phase in phases:
        half = 0.5 * phase.duration
        for part in (phase, Phase(0.0, phase.acceleration)):
            fewest = every(half, 0.3 * LENGTH / LINE) if period else []
            cuts = every(half, step) if step else [rng.random() * half for _ in range(20)]
            run_phase(few, Phase(half, part.acceleration, part.values, part.commands), fewest)
            run_phase(many, Phase(half, part.acceleration, part.values, part.commands), [*cuts, *fewest])
            assert_alike(few, many)


# --- the state --------------------------------------------------------------------------------------------------------


def bits(stepper: Stepper) -> list[str]:
    return [repr(cell.get()) for cell in stepper.cells.values()]


@settings(repeatable, max_examples=10, suppress_health_check=list(HealthCheck))
@given(runs(steps=300))
def test_a_state_that_is_restored_goes_on_with_the_same_bits(run: Run) -> None:
    """When a state is met for the first time: a new block that gets all cells answers the next 40 steps alike."""
    block = Stepper(CutToLength())
    ranges = [v for v in variables(block.block) if v.judged]
    block.initialize(run.start)
    met, copies = set(), list[tuple[Stepper, int]]()
    for number, (h, values) in enumerate(run.steps):
        before = block.get(values)
        block.set(values)
        if not 0.0 < h <= 1e6 or not all(v.allows(v.cell.get()) for v in ranges):
            block.set(before)
            continue
        answer = block.block.step(h)
        copies = [(copy, until) for copy, until in copies if number < until]
        for copy, _ in copies:
            assert copy.set(values).block.step(h) == answer
            assert bits(copy) == bits(block)
        if answer:
            break
        if block["state_code"] not in met:
            met.add(block["state_code"])
            copy = Stepper(CutToLength())
            for name, cell in block.cells.items():
                value = cell.get()
                if isinstance(value, list):
                    copy.cells[name].get()[:] = value
                else:
                    copy.cells[name].set(value)
            copies.append((copy, number + 40))


# --- numbers ----------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=25, suppress_health_check=list(HealthCheck))
@given(runs(steps=300))
def test_whatever_comes_all_numbers_are_finite(run: Run) -> None:
    for block in finite_steps(CutToLength(), run):
        assert 0.0 <= block.local.progress <= 1.0
        assert block.state_code == block.state
        assert block.error == (block.error_id != 0)
        assert block.running or block.state in (State.OFF, State.FAULT)
        assert block.line.stop_request == (block.state == State.FAULT)
        assert block.piece.length >= 0.0
        assert block.limits.min_length >= 0.0
