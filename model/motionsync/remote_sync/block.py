"""RemoteSync: the values of an axis on another controller, as they are at this controller's own instants.

Source: TwinCAT TS5066, remote synchronisation; the PHASE estimator is motionsync's own.

Decisions where the source is silent:
- Everything happens in the receiver's cycles, also what `enable` does; but a step with `enable` false makes the next
  cycle with `enable` true a first one, whether a cycle lay in between or not.
- cycle_index_difference is the step of the index since the last cycle. Limits of it are in data indices, as the step.
- In a cycle with several faults the one with the least number is told. What that cycle has found is not taken:
  correction_time, corrected_cycle_index, drift, beats and warning stay as they were before.
- With automatic_reinit the error shows for one cycle, and the next cycle is a first one.
- Disabled, correction_time, corrected_cycle_index and drift stay as they were: the values of before blend out.
- With r >= 2 the difference is looked at every r cycles, and a quiet stretch can be told only there.
- With force_time_mode beats are counted and the drift is told, but not used: the values are never SYNC.
- BEAT counts `beats` of one sign, PHASE those of both; a jump of two counts or more forgets them in both. PHASE can be
  in sync from its second beat on; periods_for_mean_drift, the slopes and time_mode_blending_cycles are BEAT's alone.
  The warning of PHASE compares the last two distances.
- A closed zone lets PHASE hold the phase in its count again; what that changes fades, too.
- equal_data_total counts since the initialization. No count goes beyond what an Integer holds.
- Before the first cycle the slave has the values as received.
"""

from dataclasses import dataclass

from .. import var
from ..slave import Slave
from ..var import LARGEST_INPUT, Enumeration, Role, Unit
from .beat import Beats
from .blending import Blending, Mode
from .faults import Fault, Refusal
from .history import MOST_PERIODS
from .phase import Phase
from .zone import Finding, Zone

INDICES = 65536  # of the sender's counter, then it wraps
LONGEST = 1e6  # s
LEAST_CYCLE = 1e-9  # s
MOST_CYCLES = 1e6  # of the receiver in one step
MOST_RATIO = 10000  # of the cycle times: indices must not wrap within a cycle
SAME_RATIO = 1e-6  # of a ratio that is a whole number but for rounding
SAME_INSTANT = 1e-6  # of a cycle
LARGEST_COUNT = 2147483647  # that an Integer shows


class Estimator(Enumeration):
    """How the sender's phase is estimated"""

    BEAT = 1, "the source's: from the distances between beats"
    PHASE = 2, "phase and drift by a Kalman filter: more even, and within 0.05 cycles; for equal cycle times"


class StartUpMode(Enumeration):
    """Where the axis values come from until the drift is known"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"
    TIME = 4, "shifted in time by what evens out the received cycle index"


class FallBackMode(Enumeration):
    """Where the axis values come from after a fault"""

    BYPASS = 1, "as received"
    PT1 = 2, "as received, smoothed by a first-order lag"


@dataclass(slots=True)
class Remote:
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
    beat_distance: float = var.local(
        0.0, "mean distance of the last beats in receiver cycles; 0: none known", discrete=True
    )


@dataclass(slots=True)
class RemoteSync:
    """Takes the beat of two clocks out of the values of an axis on another controller.

    Two controllers run nearly equal cycles from two clocks. Who reads the other's axis sees its cycle counter repeat
    or skip now and then, and its position jump by velocity times cycle time. This block finds those beats, makes the
    cycle index even again, and shifts the axis values in time to where the even index belongs.

    Wire the telegram to `remote.*` and `slave.*` to whatever follows the remote axis. Until the drift of the clocks is
    known (`start_up`), the values are corrected as start_up_mode says; then `synced` holds. A lost connection or an
    index that jumps falls back to fall_back_mode, until `enable` rises again.

    The receiver's cycles act each task_cycle_time, whatever the step size; the outputs belong to those instants. Set
    delay_time_offset to task_cycle_time to have the values one cycle later, at the step's end.
    """

    enable: bool = var.input(True, "false: as received, without any fault; rising edge: a new start (bEnable)")
    remote: Remote = var.part(Remote)
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
        0.05,
        "in sync once the correction is less than this share of the cycle time, more than 0 (fThresholdForSync)",
        above=0.0,
        max=LARGEST_INPUT,
    )
    max_cycle_index_difference: int = var.parameter(7, "greatest step of the cycle index in a cycle; 0: any", min=0)
    age_of_data_limit: int = var.parameter(7, "for so many cycles the index may stand still; 0: for ever", min=0)
    periods_for_mean_drift: int = var.parameter(
        1,
        "over how many distances between beats the drift is averaged (iNoOfPeriodsForMeanDrift)",
        min=1,
        max=MOST_PERIODS,
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
        90, "the same before the drift is known (iTimeModeBlendingCycles)", min=1
    )
    force_time_mode: bool = var.parameter(False, "BEAT does not use the drift, even if it is known")
    automatic_reinit: bool = var.parameter(False, "after a fault the next cycle is a new start")
    start_up_mode: StartUpMode = var.parameter(StartUpMode.TIME, "where the values come from until the drift is known")
    fall_back_mode: FallBackMode = var.parameter(FallBackMode.PT1, "where the values come from after a fault")
    max_position_difference: float = var.parameter(
        0.0,
        "greatest shift of the position by the correction; 0: any",
        Unit.POSITION,
        tunable=True,
        min=0.0,
        max=LARGEST_INPUT,
    )
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
        0.0, "of the sender's clock in ppm; negative: its cycle is the longer one; 0: not known", discrete=True
    )
    synced: bool = var.output(False, "the drift is known and used (bSynced)")
    start_up: bool = var.output(True, "enabled, without fault, not yet in sync (bStartUp)", depends=("enable",))
    warning: bool = var.output(False, "the drift has changed significantly")
    error: bool = var.output(False, "a fault is present")
    error_id: int = var.output(0, "which: the source's number, 0x4B51 to 0x4B59", codes=Fault)
    cycle_index_difference: int = var.output(0, "step of the received cycle index since the last cycle")
    equal_data_total: int = var.output(0, "cycles in which the index had not changed, since the initialization")
    equal_data_consecutive: int = var.output(0, "the same, one after the other, up to now")
    beats: int = var.output(0, "beats identified since the first cycle, or since the drift changed its sign")
    local: Local = var.part(Local)

    cycles_of_index: int = 1
    indices_of_cycle: int = 1
    data_cycles: float = 1.0
    missing: float = 0.0
    fresh: bool = True
    started: bool = False
    cycle: int = 0
    index: int = 0
    received: int = 0
    base: int = 0
    zone: Zone = var.part(Zone)
    beat: Beats = var.part(Beats)
    phase: Phase = var.part(Phase)
    blending: Blending = var.part(Blending)
    lag_position: float = 0.0
    lag_velocity: float = 0.0

    def initialize(self) -> Refusal:
        """As received; may be called again while parameters and inputs still change."""
        if not self.find_ratio():
            return Refusal.RATIO
        if self.estimator == Estimator.PHASE and (self.cycles_of_index > 1 or self.indices_of_cycle > 1):
            return Refusal.PHASE
        if 0 < self.age_of_data_limit < self.cycles_of_index:
            return Refusal.AGE
        if 0 < self.max_cycle_index_difference < self.indices_of_cycle:
            return Refusal.STEP
        self.beat.periods = self.periods_for_mean_drift
        self.beat.slope = self.slope1_numerator
        self.beat.knee = self.slope1_denominator
        self.beat.forced = self.force_time_mode
        self.beat.drift_blending = self.new_drift_blending_cycles
        self.beat.time_blending = self.time_mode_blending_cycles
        self.phase.forced = self.force_time_mode
        self.phase.blending = self.new_drift_blending_cycles
        self.corrected_cycle_index = float(self.remote.cycle_index % INDICES)
        self.start_up = self.enable
        self.show_state(self.mode())
        self.blending.begin(self.state)
        self.slave.put(self.remote.position, self.remote.velocity, self.remote.acceleration, 0.0)
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """The receiver's cycles in [t, t+h), all with the same input."""
        cycle = self.task_cycle_time
        if h > MOST_CYCLES * cycle:
            return Refusal.CYCLES
        self.fresh = self.fresh or not self.enable
        worked = 0
        while self.missing + worked * cycle < h - SAME_INSTANT * cycle:
            self.work()
            worked += 1
        self.missing += worked * cycle - h
        return Refusal.NONE

    def find_ratio(self) -> bool:
        """r = data cycle time / task cycle time: a whole number of cycles an index, or of indices a cycle."""
        ratio = self.data_cycle_time / self.task_cycle_time if self.data_cycle_time > 0.0 else 1.0
        inverse = 1.0 / ratio
        if not (ratio <= MOST_RATIO + 0.5 and inverse <= MOST_RATIO + 0.5):
            return False
        self.cycles_of_index = max(int(ratio + 0.5), 1)
        self.indices_of_cycle = max(int(inverse + 0.5), 1)
        self.data_cycles = self.cycles_of_index / self.indices_of_cycle
        return abs(ratio - self.data_cycles) <= SAME_RATIO * ratio

    # --- a cycle ---

    def work(self) -> None:
        """A cycle of the receiver."""
        if not self.enable:
            self.tell(Fault.NONE)
            self.synced = False
        else:
            if self.fresh:
                self.begin()
            if not self.error:
                self.advance()
        self.start_up = self.enable and not self.error and not self.synced
        self.put_out()

    def begin(self) -> None:
        """The first cycle: it has no step to judge."""
        self.fresh = False
        self.synced = False
        self.tell(Fault.NONE)
        self.index = self.remote.cycle_index % INDICES
        self.base = self.index
        self.received = 0
        self.cycle = -1
        self.zone.begin(0)
        self.beat.begin(0)
        self.phase.begin(0)

    def advance(self) -> None:
        """The estimate goes on by a cycle; a fault leaves the correction as it was."""
        self.cycle += 1
        self.local.cycles = min(self.cycle, LARGEST_COUNT)
        self.receive()
        fault = self.fault_of_telegram()
        if fault == Fault.NONE:
            self.estimate()
            fault = self.correct()
        self.tell(fault)
        if fault == Fault.NONE:
            self.show_estimate()
        else:
            self.synced = False
            self.fresh = self.automatic_reinit

    def receive(self) -> None:
        """The step of the index, the shorter way round."""
        index = self.remote.cycle_index % INDICES
        step = (index - self.index + INDICES // 2) % INDICES - INDICES // 2
        self.index = index
        self.received += step
        self.cycle_index_difference = step
        if step != 0 or self.cycle == 0:
            self.equal_data_consecutive = 0
        else:
            self.equal_data_consecutive = min(self.equal_data_consecutive + 1, LARGEST_COUNT)
            self.equal_data_total = min(self.equal_data_total + 1, LARGEST_COUNT)

    def fault_of_telegram(self) -> Fault:
        """What can be told before anything is estimated."""
        if 0 < self.max_cycle_index_difference < abs(self.cycle_index_difference):
            return Fault.INDEX_STEP
        if 0 < self.age_of_data_limit < self.equal_data_consecutive:
            return Fault.AGE_OF_DATA
        return Fault.NONE

    def estimate(self) -> None:
        """The difference of the indices, where there is a new one, and what follows from it."""
        cycle = self.cycle
        finding = Finding.NOTHING
        if cycle % self.cycles_of_index == 0:
            expected = cycle // self.cycles_of_index * self.indices_of_cycle
            finding = self.zone.look(cycle, self.received - expected, self.end_of_transition_limit)
        if self.estimator == Estimator.PHASE:
            anew = self.phase.take(self.zone, finding, cycle)
        else:
            anew = self.beat.take(self.zone, finding, cycle)
        if anew:
            self.synced = False

    def correct(self) -> Fault:
        """The correction of this cycle, unless it is a fault."""
        cycle = self.cycle
        phase = self.estimator == Estimator.PHASE
        offset = self.phase.offset(cycle) if phase else self.beat.offset(cycle)
        behind = self.received - cycle * self.indices_of_cycle / self.cycles_of_index
        lead = offset - behind  # of the corrected index over the received one
        if self.max_cycle_index_difference > 0 and abs(lead) > self.max_cycle_index_difference + 2.0:
            return Fault.INDEX_CORRECTION
        if not (abs(self.delay_time_offset) <= LONGEST and 0.0 <= self.max_position_difference <= LARGEST_INPUT):
            return Fault.TUNABLE
        time = lead * self.data_cycles * self.task_cycle_time + self.delay_time_offset
        ready = self.phase.ready() if phase else self.beat.ready()
        synced = self.synced or (ready and abs(lead) * self.data_cycles < self.threshold_for_sync)
        if (synced or self.start_up_mode == StartUpMode.TIME) and self.exceeds(time):
            return Fault.POSITION_DIFFERENCE
        self.synced = synced
        self.correction_time = time
        self.corrected_cycle_index = self.base + self.received + lead
        self.drift = 1e6 * (self.phase.d if phase else self.beat.gain() * self.data_cycles)
        return Fault.NONE

    def exceeds(self, time: float) -> bool:
        """Whether a correction would shift the position too far."""
        return 0.0 < self.max_position_difference < abs(self.shift(time))

    def shift(self, time: float) -> float:
        """The way of the remote axis in that time."""
        way = self.remote.velocity * time
        return way + 0.5 * self.remote.acceleration * time * time if self.use_acceleration else way

    def tell(self, fault: Fault) -> None:
        self.error_id = fault
        self.error = fault != Fault.NONE

    # --- what is put out ---

    def put_out(self) -> None:
        """The axis values of all modes, by their weights."""
        mode = self.mode()
        self.blending.advance(mode, self.blending_time / self.task_cycle_time)
        self.show_state(mode)
        self.smooth()
        time = self.correction_time
        position = self.remote.position + self.shift(time)
        velocity = self.remote.velocity
        if self.use_acceleration:
            velocity += self.remote.acceleration * time
        bypass = self.blending.bypass
        pt1 = self.blending.pt1
        shifted = self.blending.shifted
        kept = self.use_acceleration or mode in (Mode.BYPASS, Mode.PT1)
        self.slave.put(
            bypass * self.remote.position + pt1 * self.lag_position + shifted * position,
            bypass * self.remote.velocity + pt1 * self.lag_velocity + shifted * velocity,
            self.remote.acceleration if kept else 0.0,
            0.0,
        )

    def mode(self) -> Mode:
        if not self.enable:
            return Mode.BYPASS
        if self.error:
            return Mode.PT1 if self.fall_back_mode == FallBackMode.PT1 else Mode.BYPASS
        if self.synced:
            return Mode.SYNC
        match self.start_up_mode:
            case StartUpMode.BYPASS:
                return Mode.BYPASS
            case StartUpMode.PT1:
                return Mode.PT1
            case _:
                return Mode.TIME

    def smooth(self) -> None:
        """The first-order lags, from the first value on."""
        if not self.started:
            self.started = True
            self.lag_position = self.remote.position
            self.lag_velocity = self.remote.velocity
        self.lag_position += (self.remote.position - self.lag_position) / (1.0 + self.pt1_factor_position)
        self.lag_velocity += (self.remote.velocity - self.lag_velocity) / (1.0 + self.pt1_factor_velocity)

    def show_state(self, mode: Mode) -> None:
        self.state = mode
        self.state_code = mode

    def show_estimate(self) -> None:
        """What has been found so far."""
        phase = self.estimator == Estimator.PHASE
        self.beats = self.phase.history.beats if phase else self.beat.history.beats
        self.warning = self.phase.history.changed if phase else self.beat.history.changed
        self.local.difference = max(-LARGEST_COUNT, min(self.zone.difference, LARGEST_COUNT))
        self.local.transition = self.zone.open
        self.local.beat_distance = self.phase.history.mean if phase else self.beat.history.mean
