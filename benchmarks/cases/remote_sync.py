"""What the RemoteSync is measured in."""

from typing import Any

from cases.measured import Cases, H, MovingAxis, Steady, Values, Worst
from motionsync.remote_sync.faults import Fault
from motionsync.remote_sync.interface import MOST_PERIODS, Estimator, Mode, StartUpMode

RATE = 1.0 / H  # of a sender whose cycle is H, 1/s
FAST = 1.002 * RATE  # its clock fast by 2000 ppm: a beat every 500 cycles
BEATING = 1.5 * RATE  # a beat every 2 cycles: with a limit of 1 it is identified in the second one
EQUAL = {"task_cycle_time": H}
AT_ONCE = {"end_of_transition_limit": 1, "new_drift_blending_cycles": 1, "time_mode_blending_cycles": 1}
TEN_CYCLES = {"task_cycle_time": 0.1 * H, "data_cycle_time": H, "age_of_data_limit": 0}


def receiving(name: str, mode: Mode, counts: float = RATE, begin: Values | None = None, **start: Any) -> Steady:
    holds = {"state_code": mode, "error": False}
    return Steady(name, start=EQUAL | start, begin=begin or {}, holds=holds, counts=counts)


def identified(name: str, cycles: Values, estimator: Estimator, periods: int = 1) -> Worst:
    """A beat in each step; the block stays in sync only as long as it identifies each beat."""
    own = {"estimator": estimator, "periods_for_mean_drift": periods, "threshold_for_sync": 10.0}
    return Worst(
        name,
        (),
        start=cycles | own | AT_ONCE,
        watch=("state_code", "error_id"),
        planned=((Mode.SYNC, Fault.NONE),),
        counts=BEATING,
    )


CASES = Cases(
    steady=(
        receiving("TIME, clocks alike", Mode.TIME),
        receiving("BYPASS, disabled", Mode.BYPASS, begin={"enable": False}),
        receiving("PT1, clocks alike", Mode.PT1, start_up_mode=StartUpMode.PT1),
        receiving("SYNC by BEAT", Mode.SYNC, FAST),
        receiving("SYNC by PHASE", Mode.SYNC, FAST, estimator=Estimator.PHASE),
        Steady("after a fault", start=EQUAL, holds={"state_code": Mode.PT1, "error_id": Fault.AGE_OF_DATA}),
    ),
    worst=(
        identified("a beat identified by BEAT", EQUAL, Estimator.BEAT, MOST_PERIODS),
        identified("a beat identified by PHASE", EQUAL, Estimator.PHASE),
        identified("the same by BEAT, 10 cycles in the step", TEN_CYCLES, Estimator.BEAT, MOST_PERIODS),
    ),
    axis=MovingAxis("remote", "remote.cycle_index"),
)
