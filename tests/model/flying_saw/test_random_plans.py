"""Some ten thousand random gear_in_pos plans, followed to their ends."""

import numpy as np
import pytest

from motionsync.flying_saw.faults import Fault
from motionsync.flying_saw.profile import ProfileKind
from motionsync_fmu.batch.simulation import BatchResult
from tests.model.flying_saw.random_plans import (
    Requests,
    coded,
    draw_requests,
    find_broken_rules,
    outcome,
    simulate,
)

pytestmark = pytest.mark.slow

SEEDS, CHUNK = range(8), 5_000  # plans at a time: their results take 100 MB


@pytest.fixture(scope="module", params=SEEDS)
def plans(request: pytest.FixtureRequest) -> tuple[Requests, BatchResult]:
    requests = draw_requests(request.param, CHUNK)
    return requests, simulate(requests)


def test_every_plan_ends_in_sync_and_keeps_the_checks_and_its_own_characteristics(
    plans: tuple[Requests, BatchResult],
) -> None:
    requests, result = plans
    assert not result.failures
    assert {name: instances.tolist() for name, instances in find_broken_rules(requests, result).items()} == {}


def test_every_kind_of_profile_and_every_error_code_of_gear_in_pos_occurs(plans: tuple[Requests, BatchResult]) -> None:
    counted = outcome(plans[1]).count()
    kinds = {kind.name for kind in ProfileKind} - {"NONE", "JERK_LIMITED"}  # these are gear_in_velo's
    codes = {coded(fault) for fault in Fault} - {coded(Fault.NONE), coded(Fault.SLAVE_MOVING)}  # and this one too
    assert set(counted) == kinds | codes
    assert counted["P5"] > CHUNK / 5
    assert min(counted[kind] for kind in kinds) > CHUNK / 100
    assert sum(counted[kind] for kind in kinds) > CHUNK / 3


def test_the_check_sees_what_is_broken() -> None:
    """Were the limits a little lower than those that the plans were made for, or the motions a little different."""
    requests = draw_requests(0, CHUNK)
    result = simulate(requests)
    broken: set[str] = set()
    for name in ("axis.max_velocity", "axis.max_acceleration", "axis.max_deceleration", "axis.max_jerk"):
        tighter = Requests(requests.step_size, requests.inputs, requests.start | {name: 0.5 * requests.start[name]})
        broken |= set(find_broken_rules(tighter, result))
    ends = {"axis.min_position": 1.0, "axis.max_position": -1.0}
    checks = {n: np.ones(CHUNK, np.bool_) for n in requests.start if n.startswith("sync_mode.check")}
    for changed in (checks, {n: requests.start[n] + 1e9 * sign for n, sign in ends.items()}):
        other = Requests(requests.step_size, requests.inputs, requests.start | changed)
        broken |= set(find_broken_rules(other, result))
    for name in ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk"):
        values = result.values.copy()
        values[:, :, result.names.index(name)] *= 1.001
        broken |= set(find_broken_rules(requests, BatchResult(result.names, values, (), {})))
    checked = {n.removeprefix("sync_mode.") for n in checks}
    assert checked <= {n.removesuffix(", by outputs") for n in broken}
    assert {"not on the line in sync", "slave.jerk beyond its characteristic extremes"} <= broken
