"""A RemoteSync that a test gives telegrams, one a cycle, and what its tests have in common."""

from collections.abc import Iterable, Mapping
from copy import copy
from typing import Any, Self

import pytest

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Refusal
from motionsync.remote_sync.interface import Estimator, Mode
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.interface.variables import variables
from tests.support.blocks.harness import copy_stepper

OUTPUTS = tuple(v.name for v in variables(RemoteSync()) if not v.settable)
T = 0.002  # s, the task cycle time unless it is said otherwise
Recording = dict[str, list[Any]]  # outputs and locals, a value a cycle


class RemoteSyncHarness:
    """A block that has been initialized; variables are set and read by name."""

    def __init__(self, values: Mapping[str, Any] | None = None) -> None:
        self.stepper = Stepper(RemoteSync())
        self.stepper.initialize(values)

    @property
    def block(self) -> RemoteSync:
        block: RemoteSync = self.stepper.block
        return block

    def twin(self) -> Self:
        """Another one in the same state."""
        other = copy(self)
        other.stepper = copy_stepper(self.stepper)
        return other

    def put(self, values: Mapping[str, Any]) -> Self:
        self.stepper.set(values)
        return self

    def step(self, h: float, values: Mapping[str, Any] | None = None) -> Self:
        self.stepper.step(h, values)
        return self

    def see(self, index: int, values: Mapping[str, Any] | None = None) -> Self:
        """A cycle with the telegram of this index."""
        return self.step(self["task_cycle_time"], {"remote.cycle_index": index, **(values or {})})

    def run(self, indices: Iterable[int], values: Mapping[str, Any] | None = None) -> Recording:
        """A cycle an index; the values are set before the first one."""
        self.put(values or {})
        rows = [self.see(index).shown() for index in indices]
        return {name: [row[name] for row in rows] for name in OUTPUTS}

    def shown(self) -> dict[str, Any]:
        """All outputs and locals."""
        return self.stepper.get(OUTPUTS)

    def __getitem__(self, name: str) -> Any:
        return self.stepper[name]

    @property
    def slave(self) -> tuple[float, float, float]:
        """Position, velocity and acceleration."""
        slave = self.block.slave
        return slave.position, slave.velocity, slave.acceleration


def beating(cycles: int, *dates: int, sign: int = 1, first: int = 0) -> list[int]:
    """Indices whose difference D to the cycles is `first` and steps by `sign` at each of the dates."""
    return [n + first + sign * sum(n >= date for date in dates) for n in range(cycles)]


UNIFORM: dict[str, Any] = {"slope1_numerator": 0.5, "slope1_denominator": 0.5}
PHASE: dict[str, Any] = {"estimator": Estimator.PHASE}
BEATING = beating(1400, 500, 1000)
MOVING: dict[str, Any] = {"remote.position": 5.0, "remote.velocity": 40.0, "remote.acceleration": 1000.0}


def run(indices: Iterable[int], values: dict[str, Any] | None = None, **parameters: Any) -> Recording:
    """From the first cycle on; `values` have dots in their names."""
    return RemoteSyncHarness({**parameters, **(values or {})}).run(indices)


def close(*values: float, tolerance: float = 1e-12) -> Any:
    return pytest.approx(values if len(values) > 1 else values[0], rel=tolerance, abs=tolerance)


def at(recording: Recording, name: str, *cycles: int) -> tuple[Any, ...]:
    return tuple(recording[name][n] for n in cycles)


def offset(recording: Recording, *cycles: int) -> tuple[float, ...]:
    """c - n."""
    return tuple(recording["corrected_cycle_index"][n] - n for n in cycles)


def since(recording: Recording, name: str) -> int:
    """The first cycle in which a flag is set."""
    return recording[name].index(True)


def beat_cycles(recording: Recording) -> list[int]:
    """Cycles in which the number of beats grows."""
    beats = recording["beats"]
    return [n for n in range(1, len(beats)) if beats[n] > beats[n - 1]]


def held(recording: Recording, cycle: int, error_id: int, mode: Mode = Mode.PT1) -> bool:
    """From this cycle on a fault: latched, the estimate as in the cycle before, the fall-back mode."""
    names = ("correction_time", "corrected_cycle_index", "drift", "beats", "warning")
    assert (since(recording, "error"), set(recording["error_id"][cycle:])) == (cycle, {error_id})
    assert all(recording["error"][cycle:])
    assert (set(recording["state"][cycle:]), any(recording["synced"][cycle:])) == ({mode}, False)
    assert not any(recording["start_up"][cycle:])
    return all(set(recording[name][cycle - 1 :]) == {recording[name][cycle - 1]} for name in names)


CONTRADICTIONS: list[tuple[dict[str, Any], Refusal, str]] = [
    ({"data_cycle_time": 0.003}, Refusal.RATIO, "a whole multiple or a whole part of task_cycle_time"),
    ({"data_cycle_time": 0.0015}, Refusal.RATIO, "data_cycle_time = 0.0015, task_cycle_time = 0.002"),
    ({"data_cycle_time": 0.002 * (1 + 2e-6)}, Refusal.RATIO, "data_cycle_time"),
    ({"data_cycle_time": 21.0, "age_of_data_limit": 0}, Refusal.RATIO, "at most 10000"),
    ({"data_cycle_time": 0.004, "estimator": 2}, Refusal.PHASE, "the PHASE estimator is for equal cycle times"),
    ({"data_cycle_time": 0.001, "estimator": 2}, Refusal.PHASE, "estimator = 2, data_cycle_time = 0.001"),
    ({"data_cycle_time": 0.016}, Refusal.AGE, "age_of_data_limit = 7, data_cycle_time = 0.016"),
    ({"data_cycle_time": 0.004, "age_of_data_limit": 1}, Refusal.AGE, "age_of_data_limit must be 0 or at least"),
    ({"data_cycle_time": 0.00025}, Refusal.STEP, "max_cycle_index_difference = 7, data_cycle_time = 0.00025"),
    (
        {"data_cycle_time": 0.001, "max_cycle_index_difference": 1},
        Refusal.STEP,
        "max_cycle_index_difference must be 0 or at least task_cycle_time / data_cycle_time",
    ),
]
