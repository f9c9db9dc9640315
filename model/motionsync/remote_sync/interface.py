"""What a RemoteSync shows to the outside. Variables that make it work in cycles of its own have a `role`."""

from dataclasses import dataclass

from .. import var
from ..slave import Slave
from ..var import LARGEST_INPUT, Enumeration, Role, Unit
from .faults import Fault

INDICES = 65536  # the sender's counter runs from 0 to one less, then it wraps
LONGEST = 1e6  # s
LEAST_CYCLE = 1e-9  # s
MOST_PERIODS = 64  # distances between beats that are averaged


class Estimator(Enumeration):
    """How the sender's phase is estimated"""

    BEAT = 1, "the source's: from the distances between beats"
    PHASE = 2, "phase and drift by a Kalman filter: more even, and within 0.05 cycles; for equal cycle times"


class StartUpMode(Enumeration):
    """Where the axis values come from until the drift is determined"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"
    TIME = 4, "shifted in time by what evens out the received cycle index"


class FallBackMode(Enumeration):
    """Where the axis values come from after a fault"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"


class Mode(Enumeration):
    """Where the axis values come from"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"
    SYNC = 3, "shifted in time by the correction, the drift being determined"
    TIME = 4, "shifted in time by the correction before the drift is determined"


@dataclass(slots=True)
class RemoteAxis:
    """The axis on the other controller, as received with its cycle index."""

    cycle_index: int = var.input(
        0, "the sender's cycle counter, taken modulo 65536 (iCycleIndex)", role=Role.CYCLE_INDEX, wraps_at=INDICES
    )
    position: float = var.input(0.0, "the remote axis's position", Unit.POSITION, discrete=True)
    velocity: float = var.input(0.0, "its velocity", Unit.VELOCITY, discrete=True)
    acceleration: float = var.input(0.0, "its acceleration", Unit.ACCELERATION, discrete=True)


@dataclass(slots=True)
class Local:
    """What a commissioning engineer would watch."""

    cycles: int = var.local(0, "receiver cycles since the first one")
    difference: int = var.local(0, "sender's cycles less receiver's since the first one, in data indices")
    transition: bool = var.local(False, "the difference changes, or has not been quiet since: a transition zone")
    beat_distance: float = var.snapshot(0.0, "mean distance of the last beats in receiver cycles; 0: too few beats")


@dataclass(slots=True)
class RemoteSyncInterface:
    """What the outside world sees of a RemoteSync."""

    remote: RemoteAxis = var.part(RemoteAxis)
    enable: bool = var.input(True, "false: as received, without any fault; rising edge: a new start (bEnable)")
    slave: Slave = var.part(
        Slave,
        depends={
            "position": ("remote.position",),
            "velocity": ("remote.velocity",),
            "acceleration": ("remote.acceleration",),
        },
    )
    state: Mode = var.output(Mode.BYPASS, "where the axis values come from", depends=("enable", "start_up_mode"))
    state_code: int = var.output(1, "the state as a plain integer", depends=("enable", "start_up_mode"))
    synced: bool = var.output(False, "the drift is determined and used (bSynced)")
    start_up: bool = var.output(True, "enabled, without fault, not yet in sync (bStartUp)", depends=("enable",))
    warning: bool = var.output(False, "the drift has changed significantly")
    error: bool = var.output(False, "a fault is present")
    error_id: int = var.output(0, "which: the source's number, 0x4B51 to 0x4B59", codes=Fault)
    correction_time: float = var.output(
        0.0, "by which the received values are shifted (fCorrectionTime)", Unit.TIME, discrete=True
    )
    corrected_cycle_index: float = var.output(
        0.0,
        "the even cycle index, never wrapped",
        discrete=True,
        depends=("remote.cycle_index",),
        role=Role.CORRECTED_INDEX,
    )
    drift: float = var.output(
        0.0, "of the sender's clock in ppm; negative: its cycle is the longer one; 0: not determined", discrete=True
    )
    task_cycle_time: float = var.parameter(
        0.002,
        "the receiver's cycle time, not 0 (fTaskCycleTime)",
        Unit.TIME,
        min=0.0,
        max=LONGEST,
        smallest=LEAST_CYCLE,
        zero=False,
        role=Role.TASK_CYCLE,
    )
    data_cycle_time: float = var.parameter(
        0.0,
        "the sender's cycle time, a whole multiple or a whole part of the receiver's; 0: the same (fDataCycleTime)",
        Unit.TIME,
        min=0.0,
        max=LONGEST,
        smallest=LEAST_CYCLE,
        role=Role.DATA_CYCLE,
    )
    estimator: Estimator = var.parameter(Estimator.BEAT, "how the sender's phase is estimated")
    threshold_for_sync: float = var.parameter(
        0.05, "correction below which it is in sync, in cycles (fThresholdForSync)", above=0.0, max=LARGEST_INPUT
    )
    max_cycle_index_difference: int = var.parameter(7, "greatest step of the cycle index in a cycle; 0: any", min=0)
    age_of_data_limit: int = var.parameter(7, "for so many cycles the index may stay the same; 0: for ever", min=0)
    periods_for_mean_drift: int = var.parameter(
        1, "distances between beats that the drift is averaged over (iNoOfPeriodsForMeanDrift)", min=1, max=MOST_PERIODS
    )
    delay_time_offset: float = var.parameter(
        0.0,
        "added to the correction time (fDelayTimeOffset)",
        Unit.TIME,
        tunable=True,
        min=-LONGEST,
        max=LONGEST,
        role=Role.DELAY,
    )
    slope1_numerator: float = var.parameter(
        0.95, "share of a beat's correction that is done in its first part, more than 0", above=0.0, max=1.0
    )
    slope1_denominator: float = var.parameter(
        0.5, "length of that part, as a share of the time between beats, less than 1", min=1e-9, below=1.0
    )
    end_of_transition_limit: int = var.parameter(
        90, "cycles without a change that end a transition zone (iEndOfTransitionLimit)", min=1
    )
    new_drift_blending_cycles: int = var.parameter(
        90, "cycles over which the correction goes over to a new drift (iNewDriftBendingCycles)", min=1
    )
    time_mode_blending_cycles: int = var.parameter(
        90, "the same before the drift is determined (iTimeModeBlendingCycles)", min=1
    )
    force_time_mode: bool = var.parameter(False, "BEAT does not use the drift, even if it is determined")
    automatic_reinit: bool = var.parameter(False, "after a fault the next cycle is a new start")
    start_up_mode: StartUpMode = var.parameter(
        StartUpMode.TIME, "where the values come from until the drift is determined"
    )
    fall_back_mode: FallBackMode = var.parameter(FallBackMode.PT1, "where the values come from after a fault")
    max_position_difference: float = var.length(0.0, "greatest shift of the position by the correction; 0: any")
    use_acceleration: bool = var.parameter(True, "the shift in time uses the acceleration (bUseAccForExtrapolation)")
    pt1_factor_position: float = var.parameter(
        3.0, "time constant of PT1 in task cycles, more than 0", above=0.0, max=LARGEST_INPUT
    )
    pt1_factor_velocity: float = var.parameter(
        3.0, "time constant of PT1 in task cycles, more than 0", above=0.0, max=LARGEST_INPUT
    )
    blending_time: float = var.parameter(
        0.06, "time of the blending from one mode to another (fBlendingTime)", Unit.TIME, min=0.0, max=LONGEST
    )
    cycle_index_difference: int = var.local(0, "step of the received cycle index since the last cycle")
    equal_data_total: int = var.local(0, "cycles in which the index had not changed, since the initialization")
    equal_data_consecutive: int = var.local(0, "the same, one after the other, up to now")
    beats: int = var.local(0, "beats identified since the first cycle, or since the drift changed its sign")
    local: Local = var.part(Local)
