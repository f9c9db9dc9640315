"""The receiver's cycles of RemoteSync in steps of any size."""

import pytest

from motionsync.remote_sync.faults import Refusal
from motionsync_fmu.batch.simulation import simulate_many
from tests.model.remote_sync.harness import RemoteSyncHarness, T, close


def test_a_step_within_a_cycle_holds_the_outputs() -> None:
    receiver = RemoteSyncHarness()
    seen = []
    for n in range(9):
        receiver.step(T / 4, {"remote.cycle_index": n})
        seen.append(receiver["cycle_index_difference"])
    assert seen == [0] * 4 + [4] * 4 + [4]
    assert receiver["local.cycles"] == 2


def test_a_longer_step_repeats_its_inputs() -> None:
    receiver, other = RemoteSyncHarness(), RemoteSyncHarness()
    receiver.see(0).step(5 * T, {"remote.cycle_index": 5})
    other.run([0, 5, 5, 5, 5, 5])
    assert receiver.shown() == other.shown()
    assert (receiver["equal_data_total"], receiver["local.cycles"]) == (4, 5)


def test_cycles_keep_their_instants_with_any_step_size() -> None:
    """Steps of 0.7 cycles: 0, 0.7, 1.4, 2.1, 2.8 ... the one from 2.1 to 2.8 has no cycle in it."""
    receiver = RemoteSyncHarness()
    seen = []
    for n in range(8):
        receiver.step(0.7 * T, {"remote.cycle_index": n})
        seen.append((receiver["local.cycles"], receiver["cycle_index_difference"]))
    assert seen == [(0, 0), (1, 1), (2, 1), (2, 1), (3, 2), (4, 1), (4, 1), (5, 2)]


@pytest.mark.parametrize(("share", "cycles"), [(1 + 5e-7, 1), (1 + 2e-6, 2), (1 - 5e-7, 1), (1 - 2e-6, 1)])
def test_a_cycle_just_at_the_end_of_a_step_is_the_next_step_s(share: float, cycles: int) -> None:
    receiver = RemoteSyncHarness()
    receiver.step(share * T)
    assert receiver["local.cycles"] == cycles - 1
    receiver.step((2.0 - share) * T)
    assert receiver["local.cycles"] == 1


@pytest.mark.parametrize("part", [3, 7, 10])
def test_instants_do_not_wander_with_rounding(part: int) -> None:
    receiver = RemoteSyncHarness({"age_of_data_limit": 0, "max_cycle_index_difference": 0})
    for _ in range(part * 3000):
        receiver.block.step(T / part)
    assert receiver["local.cycles"] == 2999
    receiver.block.step(T / part)
    assert receiver["local.cycles"] == 3000


def test_a_step_of_more_than_a_million_cycles_is_refused_and_changes_nothing() -> None:
    receiver = RemoteSyncHarness()
    receiver.run(range(20))
    last = receiver.shown()
    twin = receiver.twin()
    assert receiver.put({"remote.cycle_index": 77}).block.step(2000.1) == Refusal.CYCLES
    assert receiver.shown() == last
    assert receiver.see(20).shown() == twin.see(20).shown()


def test_a_million_cycles_are_not_too_many() -> None:
    """No more and no less in 2000 s: the index does not change in all but the first."""
    start = {"age_of_data_limit": 0, "max_cycle_index_difference": 0}
    names = ["equal_data_total", "correction_time"]
    one = simulate_many("RemoteSync", 2000.0, {}, names, start=start, steps=1)
    assert not one.failures
    assert one.values[0, 0].tolist() == [999999.0, close(999999 * T)]
