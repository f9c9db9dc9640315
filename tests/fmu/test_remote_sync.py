"""The FMU of RemoteSync: what it logs of refusals and faults."""

import math
from typing import Any

import pytest

from motionsync.remote_sync.block import RemoteSync
from motionsync.remote_sync.faults import Fault
from motionsync.remote_sync.interface import Mode
from motionsync_fmu.interface.variables import variables
from motionsync_fmu.scenario.run.fmu_instance import FmuError, FmuInstance
from tests.model.remote_sync.harness import CONTRADICTIONS, T
from tests.support.hosts.fmus import Fmus


@pytest.mark.parametrize(
    ("values", "text"),
    [
        *((values, text) for values, _, text in CONTRADICTIONS),
        ({"task_cycle_time": 0.0}, "task_cycle_time = 0 is not allowed: it must be 1e-09 to 1e+06"),
        ({"estimator": 3}, "estimator = 3 is not allowed: it must be 1 BEAT, 2 PHASE"),
        ({"max_cycle_index_difference": -1}, "difference = -1 is not allowed: it must be 0 to 2147483647"),
        ({"slope1_denominator": 1.0}, "slope1_denominator = 1 is not allowed: it must be >= 1e-09 and < 1"),
        ({"delay_time_offset": math.nan}, "delay_time_offset = nan is not allowed: it must be -1e+06 to 1e+06"),
    ],
)
def test_a_refused_initialization_is_logged(fmus: Fmus, values: dict[str, Any], text: str) -> None:
    """The limits of all parameters are tested of the block; here one of each kind."""
    with FmuInstance(fmus.python("RemoteSync")) as host, pytest.raises(FmuError) as error:
        host.initialize(values)
    assert text in str(error.value)


@pytest.mark.parametrize(
    ("indices", "values", "fault", "text"),
    [
        (
            [0, 1, 10],
            {},
            Fault.INDEX_STEP,
            "the cycle index has stepped by more than max_cycle_index_difference (cycle_index_difference = 9, "
            "max_cycle_index_difference = 7, remote.cycle_index = 10)",
        ),
        (
            [5] * 9,
            {},
            Fault.AGE_OF_DATA,
            "the cycle index has not changed for more than age_of_data_limit cycles (equal_data_consecutive = 8, "
            "age_of_data_limit = 7, remote.cycle_index = 5)",
        ),
        (
            [0, 7, 14],
            {},
            Fault.INDEX_CORRECTION,
            "the corrected cycle index is more than max_cycle_index_difference + 2 away from the received one "
            "(max_cycle_index_difference = 7, remote.cycle_index = 14)",
        ),
        (
            [0, 1],
            {"delay_time_offset": 2e6},
            Fault.TUNABLE,
            "delay_time_offset must be within 1e6 s, max_position_difference 0 to 1e12 (delay_time_offset = 2e+06, "
            "max_position_difference = 0)",
        ),
        (
            [0, 1],
            {"max_position_difference": 0.5, "delay_time_offset": 0.01, "remote.velocity": 60.0},
            Fault.POSITION_DIFFERENCE,
            "the correction would shift the position by more than max_position_difference (max_position_difference = "
            "0.5, remote.position = 0, remote.velocity = 60, remote.acceleration = 0)",
        ),
    ],
)
def test_a_fault_is_logged_when_it_comes_and_not_again(
    fmus: Fmus, indices: list[int], values: dict[str, Any], fault: Fault, text: str
) -> None:
    with FmuInstance(fmus.python("RemoteSync")) as host:
        host.initialize()
        for index in indices[:-1]:
            host.step(T, {"remote.cycle_index": index})
        assert host.messages == []
        host.step(T, {"remote.cycle_index": indices[-1], **values})
        assert host.messages == [text]
        assert host.get(["error", "error_id", "state"]) == {"error": True, "error_id": fault, "state": Mode.PT1}
        for _ in range(3):
            host.step(T)
        assert host.messages == [text]
        host.step(T, {"enable": False})
        assert host.messages == [text]


def test_each_fault_of_a_block_that_starts_anew_is_logged(fmus: Fmus) -> None:
    with FmuInstance(fmus.python("RemoteSync")) as host:
        host.initialize({"automatic_reinit": True})
        for index in (0, 1, 900, 901, 902, 300):
            host.step(T, {"remote.cycle_index": index})
        assert ["cycle_index_difference = 899" in text for text in host.messages] == [True, False]


@pytest.mark.parametrize(
    ("h", "values", "text"),
    [
        (2000.1, {}, "a step must have at most 1e6 cycles (task_cycle_time = 0.002)"),
        (0.0, {}, "step size = 0 is not allowed"),
        (T, {"remote.position": math.nan}, "remote.position = nan is not allowed"),
        (T, {"remote.velocity": math.inf}, "remote.velocity = inf is not allowed"),
        (T, {"remote.acceleration": -2e12}, "remote.acceleration = -2e+12 is not allowed"),
    ],
)
def test_a_refused_step_is_logged_and_the_next_one_goes_on(
    fmus: Fmus, h: float, values: dict[str, float], text: str
) -> None:
    with FmuInstance(fmus.python("RemoteSync")) as host:
        host.initialize()
        host.step(T, {"remote.cycle_index": 3})
        names = [v.name for v in variables(RemoteSync()) if not v.settable]
        before = host.get(names)
        with pytest.raises(FmuError) as error:
            host.step(h, {"remote.cycle_index": 99, **values})
        assert text in str(error.value)
        assert host.get(names) == before
        host.step(T, {"remote.cycle_index": 4, **dict.fromkeys(values, 0.0)})
        assert host.get(["corrected_cycle_index", "error_id"]) == {"corrected_cycle_index": 4.0, "error_id": 0}
