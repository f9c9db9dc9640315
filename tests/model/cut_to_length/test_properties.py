"""The CutToLength on random machines and lines: where it cuts, limits, ends, blade, continuity, step sizes, state."""

import math
from collections.abc import Iterator
from itertools import pairwise
from random import Random
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.interface import LateMode, PieceKind
from motionsync.master import MasterInput
from motionsync_fmu.interface.recipe import declared_variables
from motionsync_fmu.interface.stepper import Stepper
from tests.model.cut_to_length.harness import CutToLengthHarness
from tests.model.cut_to_length.strategies import random_machine, random_tool, runs
from tests.support.compiled import Layout
from tests.support.harness import MOTION
from tests.support.line_phases import (
    COMMANDS,
    DURATION,
    GENERATIONS,
    LENGTH,
    LINE,
    Phase,
    modes,
    multiples_of,
    rngs,
    run_phase,
)
from tests.support.runs import BlockRun

IN_CONTACT = (State.SYNCHRONOUS, State.CUTTING, State.PULLING, State.CLEARING)

settings.register_profile("cut to length", derandomize=True, deadline=None, max_examples=25, phases=GENERATIONS)
repeatable = settings.get_profile("cut to length")


LONG_CUT = {"tool.cut_time": 0.15, "tool.cut_distance": 150.0}  # long enough to be seen


def long_stroke_machine(rng: Random, **values: Any) -> dict[str, Any]:
    """For pieces of about LENGTH on a line of about LINE, with a long stroke; it is at home."""
    start = random_machine(rng, LENGTH, DURATION) | random_tool(rng, LENGTH, DURATION)
    start |= {"axis.initial_position": start["home_position"], "axis.max_position": 1e5, "axis.min_position": -1e5}
    start |= {"kerf": rng.choice((0.0, 5.0)), "length_correction": rng.choice((0.0, -2.0)), "homing.ease": False}
    start |= {"tool.mode": rng.choice((ToolMode.TIME, ToolMode.DISTANCE)), "length": LENGTH}
    return start | {name.replace("__", "."): value for name, value in values.items()}


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


class Observed(CutToLengthHarness):
    """Notes where the cuts really are: in contact the blade is at m - s / k on the material.

    Attributes:
        front: position of the front end when start was given.
        cut_positions: of the cuts that were made.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.cut_positions: list[float] = []
        self.front = math.nan
        self.blade_position = math.nan
        self.contact_steps = 0
        super().__init__(*arguments, **options)

    def start_at_front(self, k: float, f: float) -> "Observed":
        """Give start; the carriage's k and the material's f are passed by the test, which computes them itself."""
        self.k = k
        self.front = self.master_position - 0.5 * self["kerf"] / f
        self.give("start").run(1e-9)
        return self

    def after_step(self) -> None:
        before = self.cuts
        super().after_step()
        if self.cuts > before:
            assert self.cuts == before + 1
            self.cut_positions.append(self.blade_position)
        if self["in_sync"] and self.state != State.CLEARING:
            self.contact_steps += 1
            self.blade_position = self.block.master.end - self["slave.position"] / self.k


def factors(values: dict[str, Any]) -> tuple[float, float]:
    """k and f."""
    f = values["material_factor"]
    return f / math.cos(math.radians(values["diagonal_angle"])), f


# --- where the cuts are, and their records ----------------------------------------------------------------------------


@settings(repeatable, max_examples=30)
@given(rngs, st.floats(0.6, 1.3), st.sampled_from([LateMode.SKIP, LateMode.LATE]), modes)
def test_cuts_are_where_the_lengths_put_them_and_nothing_is_lost(
    rng: Random, share: float, late: LateMode, mode: MasterInput
) -> None:
    """SKIP: a whole number of pitches apart; LATE: one pitch apart, or further where the cut was late. The pieces with
    their kerfs are the material from the front end to the last cut, whatever the line does."""
    values = long_stroke_machine(rng, late_mode=late, **LONG_CUT)
    k, f = factors(values)
    saw = Observed(values, speed=speed_for(values, share), mode=mode).start_at_front(k, f)
    for phase in random_line(rng, saw.speed, 6):
        run_phase(saw, phase, multiples_of(phase.duration, 0.05))
        assert saw.state != State.FAULT
    pitch = (LENGTH + values["kerf"] + values["length_correction"]) / f
    ends = [saw.front, *saw.cut_positions]
    assert len(saw.cut_positions) == saw["statistics.cuts"]
    if not saw.cut_positions:
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
    assert sum(saw.lengths()) + removed == pytest.approx(f * (saw.cut_positions[-1] - saw.front), abs=1e-8)
    made = saw["statistics.length_good"] + saw["statistics.length_waste"]
    assert made == pytest.approx(sum(saw.lengths()), abs=1e-8)
    if late == LateMode.SKIP:
        skipped = round((saw.cut_positions[-1] - saw.front) / pitch) - len(saw.pieces)
        assert saw["statistics.skipped"] >= skipped


@repeatable
@given(rngs, modes)
def test_the_records_of_orders_samples_and_waste_balance(rng: Random, mode: MasterInput) -> None:
    """Whatever is ordered, ended early or merged: each piece is recorded once, and all material is."""
    values = long_stroke_machine(rng, sample_length=0.9 * LENGTH, waste_length=0.95 * LENGTH, **LONG_CUT)
    k, f = factors(values)
    saw = Observed(values, speed=speed_for(values, 0.8), mode=mode).start_at_front(k, f)
    for _ in range(12):
        given_now = tuple(c for c in ("cut_now", "take_sample", "order.add", "order.skip") if rng.random() < 0.2)
        new = {"order.length": LENGTH * rng.uniform(0.5, 1.5), "waste": rng.random() < 0.2}
        duration = DURATION * rng.uniform(0.2, 1.2)
        run_phase(saw, Phase(duration, 0.0, new, given_now), multiples_of(duration, 0.02))
    counts = saw.statistics("pieces_good", "pieces_bad", "pieces_sample", "pieces_waste")
    assert sum(counts) == saw["statistics.cuts"] == len(saw.pieces)
    accepted = sum(piece.length for piece in saw.pieces if piece.is_accepted)
    samples = sum(piece.length for piece in saw.pieces if piece.kind == PieceKind.SAMPLE)
    assert saw["statistics.length_good"] == pytest.approx(accepted, abs=1e-8)
    recorded = sum(saw.statistics("length_good", "length_waste")) + samples
    assert recorded == pytest.approx(sum(saw.lengths()), abs=1e-8)
    removed = len(saw.pieces) * (values["kerf"] + values["length_correction"])
    if saw.cut_positions:
        assert sum(saw.lengths()) + removed == pytest.approx(f * (saw.cut_positions[-1] - saw.front), abs=1e-8)


# --- sharpness --------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=40)
@given(rngs, modes)
def test_the_highest_line_velocity_is_sharp(rng: Random, mode: MasterInput) -> None:
    """At 0.999999 of it every cut is on time, at 1.000001 the warning holds from the beginning and a cut is missed,
    unless the gap that the limit includes is left out."""
    values = long_stroke_machine(rng, approach__reserve=0.0, approach__distance=0.0, gap__distance=0.0)
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
    values = long_stroke_machine(rng, homing__ease=ease)
    saw = CutToLengthHarness(values, speed=speed_for(values, share), mode=mode).give("start")
    acceleration, jerk = values["axis.max_acceleration"], values["axis.max_jerk"]
    bounds = (values["axis.max_velocity"], acceleration, jerk)
    for row in saw.rows(3.5 * LENGTH / saw.speed, cuts=multiples_of(3.5 * LENGTH / saw.speed, 0.0131)).values():
        for name, bound in zip(MOTION[1:], bounds, strict=True):
            assert abs(row[name]) <= bound * (1.0 + 1e-6), name
    assert saw["statistics.cuts"] > 0
    assert not saw["warning.limit_exceeded"]


@settings(repeatable, max_examples=30)
@given(rngs, modes)
def test_the_ends_of_the_stroke_are_never_passed(rng: Random, mode: MasterInput) -> None:
    """The line speeds up or turns back in the cuts, the tool may never answer: the carriage stops in time."""
    values = long_stroke_machine(rng, tool__timeout=0.0, gap__distance=0.0)
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
    for row in saw.rows(1.5, cuts=multiples_of(1.5, 0.01)).values():
        assert low - 1e-6 <= row["slave.position"] <= high + 1e-6


# --- the blade --------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=30)
@given(rngs, modes)
def test_the_blade_is_in_the_material_only_in_sync_or_it_is_reported(rng: Random, mode: MasterInput) -> None:
    """Whatever the line does, and with commands: where blade and material move against each other, that was counted."""
    values = long_stroke_machine(rng, gap__distance=0.0)
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
    values = long_stroke_machine(rng, homing__ease=rng.random() < 0.5)
    saw = CutToLengthHarness(values, speed=speed_for(values, 0.7), mode=mode).give("start")
    slope = factors(values)[0] * (1.0 + 1.875 * values["gap.distance"] / values["gap.travel"])  # the steepest
    acceleration = values["axis.max_acceleration"]
    line_acceleration = 0.0
    for phase in random_line(rng, saw.speed, 4, stops=False):
        saw.give(*(c for c in ("cut_now", "abort", "start") if rng.random() < 0.15))
        rows = {saw.time: saw.read(MOTION)}
        rows |= saw.rows(phase.duration, acceleration=phase.acceleration, cuts=multiples_of(phase.duration, 0.002))
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

# All outputs are compared, each with its scale. The velocities that are predicted are those of a search.
SCALES = {"POSITION": LENGTH, "VELOCITY": LINE, "ACCELERATION": 1e2 * LINE, "JERK": 1e4 * LINE, "TIME": DURATION}
COMPARED = {
    v.name: SCALES.get(v.declaration.unit.name, 1.0) if v.kind == "Real" else 0.0
    for v in declared_variables(CutToLength).values()
    if v.causality in ("output", "local") and v.name != "local.skip_reason"  # which is that of one step
}


def read_outputs(saw: CutToLengthHarness) -> dict[str, tuple[Any, float]]:
    """All outputs and locals with their scales; 0: they must be equal."""
    return {name: (value, COMPARED[name]) for name, value in saw.read(COMPARED).items()}


def assert_same_outputs(one: CutToLengthHarness, other: CutToLengthHarness) -> None:
    second = read_outputs(other)
    assert [
        (name, value, second[name][0])
        for name, (value, scale) in read_outputs(one).items()
        if abs(value - second[name][0]) > 1e-8 * scale
    ] == []


def random_phases(rng: Random, speed: float, number: int) -> list[Phase]:
    """A line, lengths, commands and settings. No approach starts while the line brakes hard to a stop."""
    phases = []
    for phase in random_line(rng, speed, number):
        speed += phase.acceleration * phase.duration
        stops = phase.acceleration < 0.0 and speed < 0.2 * LINE  # a start would be searched where it comes and goes
        values: dict[str, Any] = {"order.length": LENGTH * rng.uniform(0.7, 1.3), "hold": stops or rng.random() < 0.05}
        if rng.random() < 0.2:
            values["length"] = LENGTH * rng.uniform(0.7, 1.3)
        if rng.random() < 0.1:
            values["kerf"] = rng.uniform(0.0, 5.0)
        given_now = tuple(c for c in COMMANDS if rng.random() < 0.05)
        phases.append(Phase(phase.duration, phase.acceleration, values, given_now))
    return phases


@settings(repeatable, max_examples=16)
@given(rngs, st.sampled_from([0.001, 0.007, None]), modes, modes, st.sampled_from([0.0, 0.7 * LENGTH, 4.0 * LENGTH]))
def test_any_two_step_sizes_and_input_modes_agree(
    rng: Random, step: float | None, one: MasterInput, other: MasterInput, period: float
) -> None:
    """In all outputs, where the line's acceleration changes and in the middle between: as few steps as there
    can be, and steps of 1 ms, 7 ms or random ones."""
    values = long_stroke_machine(rng, late_mode=rng.choice(list(LateMode)), master__period=period, sample_length=LENGTH)
    speed = speed_for(values, rng.choice((0.7, 0.9, 1.2)))
    phases = random_phases(rng, speed, 2 if step == 0.001 else 5)
    few, many = (CutToLengthHarness(values, speed=speed, mode=mode).give("start") for mode in (one, other))
    for phase in phases:
        half = 0.5 * phase.duration
        for part in (phase, Phase(0.0, phase.acceleration)):
            fewest = multiples_of(half, 0.3 * LENGTH / LINE) if period else []
            cuts = multiples_of(half, step) if step else [rng.random() * half for _ in range(20)]
            run_phase(few, Phase(half, part.acceleration, part.values, part.commands), fewest)
            run_phase(many, Phase(half, part.acceleration, part.values, part.commands), [*cuts, *fewest])
            assert_same_outputs(few, many)


# --- the state --------------------------------------------------------------------------------------------------------


@settings(repeatable, max_examples=10, suppress_health_check=list(HealthCheck))
@given(runs(steps=300))
def test_a_state_that_is_restored_goes_on_with_the_same_bits(run: BlockRun) -> None:
    """When a state is met for the first time: a new block that gets all cells answers the next 40 steps alike."""
    block = Stepper(CutToLength())
    layout = Layout(block.block)
    ranges = [v for v in declared_variables(CutToLength).values() if v.checked]
    block.initialize(run.start)
    met, copies = set(), list[tuple[Stepper, int]]()
    for number, (h, values) in enumerate(run.steps):
        before = block.get(values)
        block.set(values)
        if not 0.0 < h <= 1e6 or not all(v.allows(block[v.name]) for v in ranges):
            block.set(before)
            continue
        answer = block.block.step(h)
        copies = [(copy, until) for copy, until in copies if number < until]
        for copy, _ in copies:
            assert copy.set(values).block.step(h) == answer
            assert layout.bytes(copy.block) == layout.bytes(block.block)
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
