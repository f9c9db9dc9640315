"""Some ten thousand random gear_in_pos plans, followed to their ends: the benchmark's, judged in the same way."""

import numpy as np
import pytest
from plans import CHUNK, Orders, broken, coded, drawn, outcome, simulated

from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.profile import ProfileKind
from motionsync_fmu.native.batch import BatchResult

SEEDS = range(8)


@pytest.fixture(scope="module", params=SEEDS)
def plans(request: pytest.FixtureRequest) -> tuple[Orders, BatchResult]:
    orders = drawn(request.param, CHUNK)
    return orders, simulated(orders)


def test_every_plan_ends_in_sync_and_keeps_the_checks_and_its_own_characteristics(
    plans: tuple[Orders, BatchResult],
) -> None:
    orders, result = plans
    assert not result.failures
    assert {name: instances.tolist() for name, instances in broken(orders, result).items()} == {}


def test_every_kind_of_profile_and_every_error_code_of_gear_in_pos_occurs(plans: tuple[Orders, BatchResult]) -> None:
    counted = outcome(plans[1]).count()
    kinds = {kind.name for kind in ProfileKind} - {"NONE", "JERK_LIMITED"}  # these are gear_in_velo's
    codes = {coded(fault) for fault in Fault} - {coded(Fault.NONE), coded(Fault.SLAVE_MOVING)}  # and this one too
    assert set(counted) == kinds | codes
    assert counted["P5"] > CHUNK / 5
    assert min(counted[kind] for kind in kinds) > CHUNK / 100
    assert sum(counted[kind] for kind in kinds) > CHUNK / 3


def test_the_judge_sees_what_is_broken() -> None:
    """Were the limits a little lower than those that the plans were made for, or the motions a little different."""
    orders = drawn(0, CHUNK)
    result = simulated(orders)
    seen: set[str] = set()
    for name in ("axis.max_velocity", "axis.max_acceleration", "axis.max_deceleration", "axis.max_jerk"):
        tighter = Orders(orders.step_size, orders.inputs, orders.start | {name: 0.5 * orders.start[name]})
        seen |= set(broken(tighter, result))
    ends = {"axis.min_position": 1.0, "axis.max_position": -1.0}
    checks = {n: np.ones(CHUNK, np.bool_) for n in orders.start if n.startswith("sync_mode.check")}
    for changed in (checks, {n: orders.start[n] + 1e9 * sign for n, sign in ends.items()}):
        seen |= set(broken(Orders(orders.step_size, orders.inputs, orders.start | changed), result))
    for name in ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk"):
        values = result.values.copy()
        values[:, :, result.names.index(name)] *= 1.001
        seen |= set(broken(orders, BatchResult(result.names, values, (), {})))
    checked = {n.removeprefix("sync_mode.") for n in checks}
    assert checked <= {n.removesuffix(", by outputs") for n in seen}
    assert {"not on the line in sync", "slave.jerk beyond its characteristic extremes"} <= seen
