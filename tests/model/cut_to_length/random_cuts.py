"""Random pieces cut on random machines: no limit may be broken, and each cut has to be where and when it should.

Half of the machines are ones that might be built, half are wild: sizes, times and limits over many powers of ten. Each
reports first how fast its line may run (`limits.max_line_velocity`, at standstill). Then the line runs at a constant
velocity: seven in ten at 0.2 to 0.999999 of that, so that every cut has to be on time, the others at up to 1.5 times
that, so that cuts are left out, or made late.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.interface import LateMode, PieceKind
from motionsync.var import LARGEST_INPUT
from motionsync_fmu.batch.simulation import BatchResult, simulate_many
from tests.support.blocks.dice import Bools, Dice, Reals

Values = dict[str, Any]

CUTS = 12  # pitches that pass in a run
STEPS = 40 * CUTS
SHARP = 0.999999  # of the highest line velocity: so near to it every cut is still on time
TOLERANCE = 1e-9  # relative, of the limits
MOTION = ("position", "velocity", "acceleration", "jerk")
OUTPUTS = (
    *(f"slave.{name}" for name in MOTION),
    *("state_code", "in_sync", "tool.blade_down", "error_id", "warning.line_too_fast", "warning.limit_exceeded"),
    *("statistics.cuts", "statistics.skipped", "statistics.late", "statistics.unsynchronised"),
    *("statistics.length_good", "statistics.length_waste", "next_cut.position", "last.error", "piece.kind"),
    *("warning.stroke", "warning.velocity"),
)
IN_SYNC_BEFORE_RECORDING = (State.SYNCHRONOUS, State.CUTTING)


@dataclass(frozen=True)
class Machines:
    """Random machines with their lines, one for each instance: the arguments of `simulate_many`.

    Attributes:
        velocity: of the line; 0 where the machine cannot cut at any velocity.
        share: how fast the line is, of the highest velocity that the machine reports.
        begin_position: of the master where the cuts begin.
        pitch, coupling: of the cuts, in master travel; carriage velocity per line velocity.
    """

    step_size: Reals
    inputs: Values
    start: Values
    velocity: Reals
    share: Reals
    begin_position: Reals
    pitch: Reals
    coupling: Reals

    @property
    def on_time(self) -> Bools:
        return (self.velocity > 0.0) & (self.share < 1.0)

    @property
    def skips(self) -> Bools:
        return (self.velocity > 0.0) & (self.share > 1.0) & (self.start["late_mode"] == LateMode.SKIP)

    @property
    def is_late(self) -> Bools:
        return (self.velocity > 0.0) & (self.share > 1.0) & (self.start["late_mode"] == LateMode.LATE)


def draw_machines(seed: int, number: int) -> Machines:
    """Random machines, `number` of them; the same seed gives the same machines."""
    d = Dice(seed, number)
    start, coupling, pitch = _machine(d)
    highest = _highest_velocities(start)
    share = np.where(d.seldom(0.7), d.uniform(0.2, 1.0), d.uniform(1.0, 1.5))
    share = np.where(d.seldom(0.1), SHARP, np.where(share < 1.0, np.minimum(share, SHARP), share + 1e-6))
    velocity = highest * share
    begin_position = pitch * d.either(d.uniform(-10.0, 10.0), d.powers(-2.0, 5.0) * d.choice(-1.0, 1.0))
    moving = np.where(velocity > 0.0, velocity, 1.0)
    h = d.r.exponential(1.0, (number, STEPS)) + 0.01
    h *= (CUTS * pitch / moving / h.sum(axis=1))[:, None]
    position = begin_position[:, None] + velocity[:, None] * (np.cumsum(h, axis=1) - h)
    inputs = {"master.position": position, "master.velocity": np.repeat(velocity[:, None], STEPS, axis=1)}
    return Machines(h, inputs, start, velocity, share, begin_position, pitch, coupling)


def _machine(d: Dice) -> tuple[Values, Reals, Reals]:
    """The start values of a machine, its coupling factor, and the pitch of its cuts."""
    factor = np.where(d.seldom(0.3), d.either(d.uniform(0.95, 1.05), d.powers(-1.0, 1.0)), 1.0)
    angle = np.where(d.seldom(0.2), d.uniform(-70.0, 70.0), 0.0)
    coupling = factor / np.cos(np.radians(angle))
    length = d.either(d.uniform(100.0, 6000.0), d.powers(-2.0, 5.0))
    kerf = np.where(d.seldom(0.6), length * d.powers(-4.0, -1.0), 0.0)
    correction = np.where(d.seldom(0.3), length * d.normal(0.01), 0.0)
    pitch = (length + kerf + correction) / factor
    duration = d.either(d.uniform(0.5, 5.0), d.powers(-2.0, 2.0))  # from cut to cut
    scale = coupling * pitch / duration
    home = scale * duration * np.where(d.seldom(0.5), d.uniform(-0.5, 0.5), 0.0)
    start = _axis(d, scale, duration, home) | _tool(d, scale, duration) | _gap(d, scale, duration)
    start |= {
        "auto_start": np.ones(d.number, np.bool_),
        "material_factor": factor,
        "diagonal_angle": angle,
        "length": length,
        "kerf": kerf,
        "length_correction": correction,
        "length_tolerance": length * 1e-6,
        "front_position": home - scale * duration * d.uniform(0.0, 0.3),
        "late_mode": d.choice(LateMode.SKIP, LateMode.LATE).astype(np.int64),
    }
    return start, coupling, pitch


def _axis(d: Dice, scale: Reals, duration: Reals, home: Reals) -> Values:
    """Limits for velocities of this scale; some are tight. Those of the approach and of the way home may be lower."""
    limits = {
        "velocity": scale * (1.0 + d.either(d.powers(-1.0, 1.0), d.powers(-3.0, 3.0))),
        "acceleration": scale / duration * d.either(d.powers(0.5, 2.0), d.powers(-1.0, 4.0)),
        "deceleration": scale / duration * d.either(d.powers(0.5, 2.0), d.powers(-1.0, 4.0)),
        "jerk": scale / duration**2 * d.either(d.powers(1.0, 3.5), d.powers(0.0, 6.0)),
    }
    limits = {name: np.clip(x, 1e-9, LARGEST_INPUT) for name, x in limits.items()}

    def own(name: str) -> Reals:
        return np.where(d.seldom(0.3), limits[name] * d.powers(-0.5, 0.0), 0.0)

    return {
        **{f"axis.max_{name}": x for name, x in limits.items()},
        **{f"approach.{name}": own(name) for name in ("acceleration", "jerk")},
        **{f"homing.{name}": own(name) for name in limits},
        "home_position": home,
        "axis.initial_position": home,
        "axis.min_position": home - scale * duration * d.powers(-6.0, 0.0),
        "axis.max_position": home + scale * duration * d.either(d.uniform(0.3, 3.0), d.powers(-1.0, 2.0)),
        "approach.reserve": d.choice(0.0, 0.02, 0.1),
        "approach.distance": np.where(d.seldom(0.2), scale * duration * d.powers(-3.0, -0.5), 0.0),
        "homing.settle_time": np.where(d.seldom(0.3), duration * d.powers(-4.0, -1.0), 0.0),
        "homing.ease": d.seldom(0.3),
        "homing.spare_time": np.where(d.seldom(0.5), duration * d.powers(-4.0, -1.0), 0.0),
        "homing.slowest": d.choice(0.05, 0.5, 1.0),
    }


def _tool(d: Dice, scale: Reals, duration: Reals) -> Values:
    def seconds(often: float) -> Reals:
        return np.where(d.seldom(often), duration * d.powers(-4.0, -1.0), 0.0)

    return {
        "tool.mode": d.choice(ToolMode.TIME, ToolMode.DISTANCE).astype(np.int64),
        "tool.cut_time": duration * d.uniform(0.0, 0.4),
        "tool.cut_distance": scale * duration * d.uniform(0.0, 0.4),
        "tool.settle_time": seconds(0.5),
        "tool.on_delay": seconds(0.5),
        "tool.retract_time": seconds(0.5),
    }


def _gap(d: Dice, scale: Reals, duration: Reals) -> Values:
    return {
        "gap.distance": np.where(d.seldom(0.3), scale * duration * d.powers(-5.0, -2.0), 0.0),
        "gap.travel": scale * duration * d.powers(-2.0, -0.7),
    }


def _highest_velocities(start: Values) -> Reals:
    """The highest line velocity of each machine, as it reports it while the line is at rest."""
    result = simulate_many(CutToLength, 1e-3, {}, "limits.max_line_velocity", start=start)
    assert not result.failures, result.failures[0].message
    return result["limits.max_line_velocity"][:, 0]


def simulate(machines: Machines) -> BatchResult:
    return simulate_many(CutToLength, machines.step_size, machines.inputs, OUTPUTS, start=machines.start)


# --- the rules ---


def find_broken_rules(machines: Machines, result: BatchResult) -> dict[str, NDArray[np.int64]]:
    """The machines that break a rule, by the name of the rule.

    For all machines: every number is finite; the carriage keeps the limits of the phase that it is in, and its ends;
    the blade is in the material only in sync, and then carriage and material are at the same position. Where the line
    is no faster than the machine reported, every cut is made on time and every piece has its length; where it is faster
    and cuts are left out, the pieces are whole multiples; where they are made late, no piece is shorter.
    """
    broken_rules = {"failed": np.array([f.instance for f in result.failures], np.int64)}
    broken_rules["not finite"] = np.flatnonzero(~np.isfinite(result.values).all(axis=(1, 2)))
    for check in (_check_limits, _check_cut_positions, _check_pieces):
        for name, wrong in check(machines, result):
            broken_rules[name] = np.flatnonzero((machines.velocity > 0.0) & wrong)
    return {name: instances for name, instances in broken_rules.items() if len(instances)}


def _limit(machines: Machines, group: str, name: str) -> Reals:
    """The limit in use, as a column: the group's own, or where that is 0 the axis's."""
    own = machines.start.get(f"{group}.{name}", 0.0)
    return np.asarray(np.where(own == 0.0, machines.start[f"axis.max_{name}"], own))[:, None]


def limit_shares(machines: Machines, result: BatchResult) -> Iterator[tuple[str, Reals]]:
    """How much of each limit is used, at each point: the phase's limits in an approach and on the way home.

    Forwards the way home brakes and backwards it speeds up; where it does both in one, the lower limit holds.
    """
    v, a, j = (result[f"slave.{name}"] for name in MOTION[1:])
    state = result["state_code"]
    line = np.where(machines.velocity > 0.0, machines.coupling * machines.velocity, 1.0)[:, None]
    yield "velocity", np.abs(v) / _limit(machines, "axis", "velocity")
    homing = np.where(v < 0.0, -v / _limit(machines, "homing", "velocity"), v / line)
    yield "velocity on the way home", np.where(state == State.RETURNING, homing, 0.0)
    up, down = (_limit(machines, "homing", name) for name in ("acceleration", "deceleration"))
    speeding = np.where(v * a > 0.0, np.abs(a) / up, np.abs(a) / down)
    approach = np.abs(a) / _limit(machines, "approach", "acceleration")
    own = np.where(state == State.APPROACHING, approach, np.where(state == State.RETURNING, speeding, 0.0))
    yield "acceleration", np.where(state == State.PULLING, np.abs(a) / _gap_limit(machines), own)
    own = np.where(state == State.APPROACHING, np.abs(j) / _limit(machines, "approach", "jerk"), 0.0)
    own = np.where(state == State.RETURNING, np.abs(j) / _limit(machines, "homing", "jerk"), own)
    yield "jerk", np.where(state == State.PULLING, np.abs(j) / _limit(machines, "axis", "jerk"), own)


def _gap_limit(machines: Machines) -> Reals:
    """The gap speeds up and brakes alike."""
    return np.minimum(_limit(machines, "axis", "acceleration"), _limit(machines, "axis", "deceleration"))


def _check_limits(machines: Machines, result: BatchResult) -> Iterator[tuple[str, Bools]]:
    for name, share in limit_shares(machines, result):
        yield f"{name} beyond its limit", (share > 1.0 + TOLERANCE).any(axis=1)
    position, home = result["slave.position"], machines.start["home_position"][:, None]
    tolerance = TOLERANCE * np.abs(position - home).max(axis=1, keepdims=True) + 1e-12 * np.abs(home)
    for end, sign in (("min_position", -1.0), ("max_position", 1.0)):
        beyond = sign * (position - machines.start[f"axis.{end}"][:, None])
        yield f"beyond axis.{end}", (beyond > tolerance).any(axis=1)
    yield "behind home", (position < home - tolerance).any(axis=1)
    yield "warning.limit_exceeded", result["warning.limit_exceeded"].any(axis=1)


def _check_cut_positions(machines: Machines, result: BatchResult) -> Iterator[tuple[str, Bools]]:
    """Positions are compared in the carriage's travel, to rounding of the master's position and of the pitch."""
    state, cut_position = result["state_code"], result["next_cut.position"]
    master = machines.inputs["master.position"] + machines.velocity[:, None] * machines.step_size
    size = np.abs(master).max(axis=1, keepdims=True) + machines.pitch[:, None]
    deviation = np.abs(result["slave.position"] - machines.coupling[:, None] * (master - cut_position))
    wrong = deviation > 1e-12 * machines.coupling[:, None] * size
    yield "not at its cut in sync", (np.isin(state, IN_SYNC_BEFORE_RECORDING) & wrong).any(axis=1)
    line = (machines.coupling * machines.velocity)[:, None]
    slip = np.abs(result["slave.velocity"] - line) > TOLERANCE * line
    yield "not as fast as the material in sync", ((result["in_sync"] > 0.0) & slip).any(axis=1)
    down = (result["tool.blade_down"] > 0.0) & (result["in_sync"] == 0.0) & (state != State.PULLING)
    gap = machines.start["gap.distance"][:, None] > 0.0  # the blade leaves the material ahead of its cut
    yield "blade down without sync", (down & ~(gap & (state == State.CLEARING))).any(axis=1)


def _check_pieces(machines: Machines, result: BatchResult) -> Iterator[tuple[str, Bools]]:
    last = {name: result[name][:, -1] for name in OUTPUTS}
    on_time, skips, late = machines.on_time, machines.skips, machines.is_late
    cuts, skipped = last["statistics.cuts"], last["statistics.skipped"]
    kerf, correction = machines.start["kerf"], machines.start["length_correction"]
    pitch = machines.start["length"] + kerf + correction
    size = 1e-11 * (np.abs(machines.begin_position) + 2.0 * CUTS * machines.pitch) * machines.start["material_factor"]
    yield "an error", last["error_id"] != 0.0
    yield "a cut missed", on_time & ((skipped > 0.0) | (last["statistics.late"] > 0.0))
    yield "a false warning", on_time & (result["warning.line_too_fast"].any(axis=1))
    yield "no warning", (skips | late) & ~result["warning.line_too_fast"].any(axis=1)
    lowest_count = _least_cut_count(machines)
    yield "too few or too many cuts", on_time & ((cuts < lowest_count) | (cuts > lowest_count + 1.0))
    error = np.abs(result["last.error"]).max(axis=1)
    yield "a wrong length", on_time & (error > size)
    balance = last["statistics.length_good"] + last["statistics.length_waste"] + cuts * (kerf + correction)
    whole = np.round(balance / pitch)
    missing = cuts + skipped - whole  # what is left out of the piece in progress
    open_ = (missing < 0.0) | ((missing > 0.0) & (last["piece.kind"] != PieceKind.MERGED))
    yield "the records do not balance", (on_time | skips) & ((np.abs(balance - whole * pitch) > size) | open_)
    able = ~(result["warning.stroke"].any(axis=1) | result["warning.velocity"].any(axis=1))
    yield "left out instead of late", late & able & (skipped > 0.0)
    yield "a piece too short", late & (result["last.error"].min(axis=1) < -size)


def _least_cut_count(machines: Machines) -> Reals:
    """The cuts of a run: the one that is recorded last is less than a pitch behind home at the end."""
    begin = machines.begin_position - machines.start["front_position"] / machines.coupling
    begin -= 0.5 * machines.start["kerf"] / machines.start["material_factor"]
    end = machines.begin_position + CUTS * machines.pitch - machines.start["home_position"] / machines.coupling
    return np.floor((end - begin) / machines.pitch) - 1.0


def count_cuts(machines: Machines, result: BatchResult) -> dict[str, NDArray[np.int64]]:
    """Of each group: its machines, and their cuts, cuts left out and late cuts."""
    counts = [result[f"statistics.{name}"][:, -1] for name in ("cuts", "skipped", "late")]
    groups = {"on time": machines.on_time, "too fast, SKIP": machines.skips, "too fast, LATE": machines.is_late}
    return {
        name: np.array([group.sum(), *(x[group].sum() for x in counts)], np.int64) for name, group in groups.items()
    }
