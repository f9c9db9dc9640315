"""A great many random gear_in_pos plans, followed to their ends: what is planned, what is refused, whether rules hold.

Half of the plans are ones that a machine might ask for, half are wild: sizes, times, ratios and limits over many powers
of ten. The slave is at rest, moves at its initial velocity, or is under way by another command; the master has either
direction, mostly an acceleration of 0 at the edge, and goes on at constant velocity, so that the characteristics must
bound what the slave does.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.flying_saw.block import FlyingSaw
from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.interface import State
from motionsync.flying_saw.profile import ProfileKind
from motionsync.var import LARGEST_INPUT
from motionsync_fmu.batch.simulation import BatchResult, simulate_many
from motionsync_fmu.interface.variables import variables
from tests.support.blocks.dice import Bools, Dice, Reals

Values = dict[str, Any]

STEPS = 26  # of a run: one before the edge, a short one at it, and those that follow the profile a little past its end
EDGE = 1  # the step at whose beginning the command is given
PAST = 1.05  # of the profile's duration: the profile has ended then
SHORT = 1e-9  # of the profile's duration: the step at the edge, where the master may have an acceleration
CHECKS = {  # the checks, and how often each is set
    "check_min_position": 0.1,
    "check_max_position": 0.1,
    "check_max_velocity": 0.3,
    "check_max_acceleration": 0.2,
    "check_max_deceleration": 0.2,
    "check_max_jerk": 0.2,
    "check_overshoot_position": 0.1,
    "check_undershoot_position": 0.1,
    "check_overshoot_velocity": 0.2,
    "check_undershoot_velocity": 0.2,
    "check_overshoot_velocity_zero": 0.03,
    "check_undershoot_velocity_zero": 0.1,
}
OTHERS = {
    "prefer_constant_velocity": 0.3,
    "ignore_master_acceleration": 0.3,
    "ignore_slave_acceleration": 0.3,
    "detailed_error_codes": 0.9,
    "time_based": 0.005,
    "rollback_lock": 0.1,
    "instant_stop_on_rollback": 0.1,
}
BEFORE = ("move_velocity", "move_absolute", "gear_in_velo", "halt", "stop")  # what may be under way
MOTION = ("position", "velocity", "acceleration", "jerk")
WHOLE = ("state_code", "characteristics.profile", "gear_in_pos.error_id")
OUTPUTS = [v.name for v in variables(FlyingSaw()) if v.causality in ("output", "local") and v.kind == "Real"]
TOLERANCE = 1e-9  # of the checks
FAILED = -1  # instead of an error code
EPSILON = 2.0**-52


@dataclass(frozen=True)
class Requests:
    """Random requests, one for each instance: the arguments of `simulate_many`."""

    step_size: Reals
    inputs: Values
    start: Values


def draw_requests(seed: int, number: int) -> Requests:
    """Random requests for `number` instances; the same seed gives the same requests."""
    d = Dice(seed, number)
    sign = d.choice(-1.0, 1.0)
    duration = d.either(d.uniform(0.2, 4.0), d.powers(-3.0, 3.0))
    speed = d.either(d.uniform(10.0, 1000.0), d.powers(-4.0, 4.0)) * sign
    ratio = d.either(d.uniform(0.2, 3.0), d.powers(-2.0, 2.0)) * d.choice(-1.0, 1.0)
    denominator = d.choice(1, 1, 1, 2, 7)
    angle = np.where(d.seldom(0.2), d.uniform(-80.0, 80.0), 0.0)
    synchronous = ratio / denominator / np.cos(np.radians(angle)) * speed
    travel = np.abs(synchronous) * duration
    edge_position = d.either(d.uniform(-1e3, 1e3), np.clip(speed * duration * d.powers(-2.0, 6.0), -1e11, 1e11))
    position = d.either(d.uniform(-1e3, 1e3), travel * d.powers(-2.0, 6.0) * sign)
    velocity = synchronous * d.either(
        d.choice(0.0, 1.0, -0.5, 0.5, 2.0) * d.choice(1.0, 0.9), d.normal() * d.powers(-2.0, 2.0)
    )
    distance = synchronous * duration * d.either(d.uniform(0.05, 1.5), d.powers(-2.0, 2.0))
    mean = 0.5 * (velocity + synchronous) * duration  # with it the velocity can stay between those of both ends
    distance = np.where(d.seldom(0.4), mean * (1.0 + d.normal(0.3)), distance)
    before = d.powers(-3.0, 0.0) * duration  # the step before the edge
    moved = d.seldom(0.4)  # whether the slave is under way by a command
    initial = np.where(moved & d.seldom(0.1), 0.0, velocity)

    start = _limits(d, travel / duration, duration, position, np.abs(distance) + travel)
    start |= {f"sync_mode.{bit}": d.seldom(share) for bit, share in (CHECKS | OTHERS).items()}
    start |= {
        "diagonal_angle": angle,
        "axis.initial_position": position,
        "axis.initial_velocity": initial,
        "gear_in_pos.ratio_numerator": ratio,
        "gear_in_pos.ratio_denominator": denominator,
        "gear_in_pos.master_sync_position": edge_position + speed * duration * np.where(d.seldom(0.01), -1.0, 1.0),
        "gear_in_pos.slave_sync_position": position + initial * before + distance * np.where(d.seldom(0.01), -1.0, 1.0),
        "gear_in_pos.master_start_distance": np.abs(speed) * duration * _distance(d),
        "gear_in_velo.ratio_numerator": ratio,
        "move_velocity.velocity": velocity * d.normal(),
        "move_absolute.position": position + (np.abs(distance) + travel) * d.normal(),
        **{f"{group}.execute": np.zeros(number, np.bool_) for group in (*BEFORE, "gear_in_pos")},
    }
    start = {name: x if x.dtype == np.bool_ else np.clip(x, -LARGEST_INPUT, LARGEST_INPUT) for name, x in start.items()}

    speed = np.where(d.seldom(0.003), 0.0, speed)
    acceleration = speed / duration * d.either(d.normal(0.3), d.powers(-12.0, 1.0))
    h, inputs = _path(d, edge_position, speed, np.where(d.seldom(0.7), 0.0, acceleration), before, duration)
    choice = d.r.choice(len(BEFORE), number, p=[0.4, 0.3, 0.2, 0.08, 0.02])
    for i, group in enumerate(BEFORE):
        inputs[f"{group}.execute"] = np.repeat((moved & (choice == i))[:, None], STEPS, axis=1)
    for name, values in _wrong(d, start).items():
        inputs[name] = np.repeat(values[:, None], STEPS, axis=1)
    return Requests(h, inputs, start)


def _wrong(d: Dice, start: Values) -> Values:
    """Values that now and then no command can be made of; set after the initialization, which would refuse them."""
    return {
        "gear_in_pos.ratio_numerator": np.where(d.seldom(0.003), 0.0, start["gear_in_pos.ratio_numerator"]),
        "gear_in_pos.ratio_denominator": np.where(
            d.seldom(0.003), d.choice(0, -3), start["gear_in_pos.ratio_denominator"]
        ),
        "gear_in_pos.jerk": np.where(d.seldom(0.005), -1.0, start["gear_in_pos.jerk"]),
    }


def _limits(d: Dice, scale: Reals, duration: Reals, position: Reals, length: Reals) -> Values:
    """The axis' limits, and the request's own, for velocities of this scale; some limits are tight."""
    limits = {
        "velocity": scale * (1.0 + d.either(d.powers(-2.0, 1.0), d.powers(-3.0, 4.0))),
        "acceleration": scale / duration * d.either(d.powers(-0.3, 1.5), d.powers(-4.0, 5.0)),
        "deceleration": scale / duration * d.either(d.powers(-0.3, 1.5), d.powers(-4.0, 5.0)),
        "jerk": scale / duration**2 * d.either(d.powers(0.0, 2.5), d.powers(-4.0, 6.0)),
    }
    limits = {name: np.clip(x, 1e-9, LARGEST_INPUT) for name, x in limits.items()}
    own = {name: np.where(d.seldom(0.3), x * d.powers(-0.5, 0.5), 0.0) for name, x in limits.items()}
    return {
        "axis.min_position": position - length * d.powers(-2.0, 1.0),
        "axis.max_position": position + length * d.powers(-2.0, 1.0),
        **{f"axis.max_{name}": x for name, x in limits.items()},
        **{f"gear_in_pos.{name}": x for name, x in own.items()},
    }


def _distance(d: Dice) -> Reals:
    """The distance of the start before the sync position, as a share of the master's travel."""
    waits = np.where(d.seldom(0.15), d.uniform(0.0, 1.5), 0.0)
    return np.where(d.seldom(0.003), -1.0, waits)


def _path(
    d: Dice, edge_position: Reals, speed: Reals, acceleration: Reals, before: Reals, duration: Reals
) -> tuple[Reals, Values]:
    """Random step sizes, and the master's inputs: it is at `edge_position` at the edge, with `speed` from then on."""
    rest = d.r.exponential(1.0, (d.number, STEPS - 2)) + 0.01
    rest *= (PAST * duration / rest.sum(axis=1))[:, None]
    h = np.column_stack([before, SHORT * duration, rest])
    position = edge_position[:, None] + speed[:, None] * (np.cumsum(h, axis=1) - h - before[:, None])
    velocity = np.repeat(speed[:, None], STEPS, axis=1)
    accelerations = np.zeros_like(h)
    position[:, 0] = edge_position - (speed - 0.5 * acceleration * before) * before
    velocity[:, 0] = speed - acceleration * before
    accelerations[:, : EDGE + 1] = acceleration[:, None]
    return h, {
        "master.position": position,
        "master.velocity": velocity,
        "master.acceleration": accelerations,
        "gear_in_pos.execute": np.broadcast_to(np.arange(STEPS) >= EDGE, h.shape),
    }


def simulate(requests: Requests) -> BatchResult:
    return simulate_many(FlyingSaw, requests.step_size, requests.inputs, [*OUTPUTS, *WHOLE], start=requests.start)


# --- what became of the plans ---


@dataclass(frozen=True)
class PlanOutcome:
    """The outcome of each instance: the profile that it took, or the error code, 0 if there is none."""

    profile: NDArray[np.int64]
    fault: NDArray[np.int64]

    @property
    def accepted(self) -> Bools:
        return self.fault == Fault.NONE

    def count(self) -> Counter[str]:
        """How often each profile was taken and each command refused, by their names."""
        taken = Counter(ProfileKind(kind).name for kind in self.profile[self.accepted].tolist())
        return taken + Counter(coded(code) for code in self.fault[~self.accepted].tolist())


def coded(code: int) -> str:
    return "failed" if code == FAILED else f"0x{code:04X} {Fault(code).name}"


def outcome(result: BatchResult) -> PlanOutcome:
    """The outcome of a batch. A failed instance counts as refused, with the code FAILED."""
    profile, fault = (result[name][:, -1] for name in ("characteristics.profile", "gear_in_pos.error_id"))
    failed = np.isnan(fault)
    return PlanOutcome(np.where(failed, 0, profile).astype(np.int64), np.where(failed, FAILED, fault).astype(np.int64))


def find_broken_rules(requests: Requests, result: BatchResult) -> dict[str, NDArray[np.int64]]:
    """The instances that break a rule, by the name of the rule.

    For all instances: every number is finite. For the accepted ones: they are in sync at the end, on the line that
    leads through both sync positions; during the profile nothing leaves the extremes in the characteristics; neither
    the characteristics nor the outputs break a check that was asked for.
    """
    results = {"failed": np.array([f.instance for f in result.failures], np.int64)}
    results["not finite"] = np.flatnonzero(~np.isfinite(result.values).all(axis=(1, 2)))
    accepted = outcome(result).accepted
    results["not in sync at the end"] = np.flatnonzero(accepted & (result["state_code"][:, -1] != State.SYNCHRON))
    for name, wrong in (*_off_the_line(requests, result), *_beyond_extremes(result), *_unchecked(requests, result)):
        results[name] = np.flatnonzero(accepted & wrong)
    return {name: instances for name, instances in results.items() if len(instances)}


def _off_the_line(requests: Requests, result: BatchResult) -> Iterator[tuple[str, Bools]]:
    """The instances that are in sync, but not at slave_sync + factor (master - master_sync), up to rounding."""
    h, master = requests.step_size[:, -1], requests.inputs["master.position"][:, -1]
    master = master + requests.inputs["master.velocity"][:, -1] * h
    sync, slave_sync = (requests.start[f"gear_in_pos.{name}_sync_position"] for name in ("master", "slave"))
    factor, slave = result["coupling_factor"][:, -1], result["slave.position"][:, -1]
    rounding = 16.0 * EPSILON * (np.abs(factor) * (np.abs(master) + np.abs(sync)) + np.abs(slave) + np.abs(slave_sync))
    yield "not on the line in sync", np.abs(slave - (slave_sync + factor * (master - sync))) > rounding


def _beyond_extremes(result: BatchResult) -> Iterator[tuple[str, Bools]]:
    """The instances that leave the extremes of the characteristics during the profile."""
    under_way = _under_way(result)
    for name in MOTION:
        minimum, maximum = (result[f"characteristics.slave_{name}_{end}"][:, -1:] for end in ("min", "max"))
        size = np.maximum(np.abs(minimum), np.abs(maximum))
        tolerance = TOLERANCE * (maximum - minimum if name == "position" else size) + 8.0 * EPSILON * size
        x = result[f"slave.{name}"]
        beyond = (x < minimum - tolerance) | (x > maximum + tolerance)
        yield f"slave.{name} beyond its characteristic extremes", (beyond & under_way).any(axis=1)


def _unchecked(requests: Requests, result: BatchResult) -> Iterator[tuple[str, Bools]]:
    """The instances that break a check that was asked for: by the characteristics, and by the outputs."""
    under_way = _under_way(result)
    results = {name: result[f"characteristics.{name}"][:, -1] for name in _CHARACTERISTIC}
    outputs = {name: np.where(under_way, result[f"slave.{name}"], np.nan) for name in MOTION}
    for by, rows in (
        ("characteristics", {name: (results[f"slave_{name}_min"], results[f"slave_{name}_max"]) for name in MOTION}),
        ("outputs", {name: _range(values) for name, values in outputs.items()}),
    ):
        for name, wrong in _beyond_limits(requests, results, rows):
            yield f"{name}, by {by}", _is_check_active(requests, name) & wrong
    v, a = outputs["velocity"], outputs["acceleration"]
    sure = np.abs(v) > TOLERANCE * _speed(results)[:, None]  # elsewhere the sign of v depends on rounding
    for name, along, peak in (
        ("acceleration", v * a > 0.0, "plan_acceleration"),
        ("deceleration", v * a < 0.0, "plan_deceleration"),
    ):
        limit = _limit(requests, name) * (1.0 + 2.0 * TOLERANCE)
        maximum = np.where(along & sure, np.abs(a), 0.0).max(axis=1)
        yield f"check_max_{name}, by outputs", _is_check_active(requests, f"check_max_{name}") & (maximum > limit)
        yield (
            f"check_max_{name}, by local",
            _is_check_active(requests, f"check_max_{name}") & (result[f"local.{peak}"][:, -1] > limit),
        )


_CHARACTERISTIC = (
    *(f"slave_{name}_{end}" for name in MOTION for end in ("min", "max")),
    *(f"slave_{name}_{end}" for name in ("position", "velocity") for end in ("start", "end")),
)


def _beyond_limits(
    requests: Requests, result: dict[str, Reals], rows: dict[str, tuple[Reals, Reals]]
) -> Iterator[tuple[str, Bools]]:
    """The instances that break a check other than those of acceleration and deceleration.

    `rows`: the least and the greatest value of each quantity.
    """
    low, high = rows["position"]
    size = np.maximum(np.abs(result["slave_position_min"]), np.abs(result["slave_position_max"]))
    tolerance = 2.0 * TOLERANCE * (result["slave_position_max"] - result["slave_position_min"]) + 8.0 * EPSILON * size
    first, last = result["slave_position_start"], result["slave_position_end"]
    yield "check_min_position", low < requests.start["axis.min_position"] - tolerance
    yield "check_max_position", high > requests.start["axis.max_position"] + tolerance
    yield "check_undershoot_position", low < np.minimum(first, last) - tolerance
    yield "check_overshoot_position", high > np.maximum(first, last) + tolerance
    low, high = rows["velocity"]
    tolerance = 2.0 * TOLERANCE * _speed(result)
    first, last = result["slave_velocity_start"], result["slave_velocity_end"]
    limit = _limit(requests, "velocity")
    yield "check_max_velocity", (high > limit + tolerance) | (low < -limit - tolerance)
    is_forwards = last > 0.0
    begin, end = np.where(is_forwards, first, -first), np.abs(last)
    minimum, maximum = np.where(is_forwards, low, -high), np.where(is_forwards, high, -low)
    yield "check_overshoot_velocity", maximum > np.maximum(begin, end) + tolerance
    yield "check_undershoot_velocity", minimum < np.minimum(begin, end) - tolerance
    yield "check_overshoot_velocity_zero", high > tolerance
    yield "check_undershoot_velocity_zero", minimum < -tolerance
    low, high = rows["jerk"]
    limit = _limit(requests, "jerk") * (1.0 + 2.0 * TOLERANCE)
    yield "check_max_jerk", (high > limit) | (low < -limit)


def _under_way(result: BatchResult) -> Bools:
    """The ends of steps, after the one at the edge, at which the slave is in the profile."""
    under_way: Bools = result["state_code"] == State.SYNCHRONIZING
    under_way[:, : EDGE + 1] = False
    return under_way


def _is_check_active(requests: Requests, check: str) -> Bools:
    is_active: Bools = requests.start[f"sync_mode.{check}"]
    return is_active


def _limit(requests: Requests, name: str) -> Reals:
    own: Reals = requests.start[f"gear_in_pos.{name}"]
    return np.where(own == 0.0, requests.start[f"axis.max_{name}"], own)


def _speed(result: dict[str, Reals]) -> Reals:
    return np.maximum(np.abs(result["slave_velocity_min"]), np.abs(result["slave_velocity_max"]))


def _range(values: Reals) -> tuple[Reals, Reals]:
    """The least and the greatest of each row; for a row without values inf and -inf."""
    minimum = np.where(np.isnan(values), np.inf, values).min(axis=1)
    return minimum, np.where(np.isnan(values), -np.inf, values).max(axis=1)
