"""RemoteSync: the values of an axis on another controller, as they are at this controller's own instants.

Source: TwinCAT TS5066, remote synchronisation; the PHASE estimator is motionsync's own. README.md in this folder says
how the block decides where the source is silent.
"""

from dataclasses import dataclass

from .. import var
from ..var import LARGEST_INPUT, Enumeration
from .beat import Beats
from .blending import Blending
from .faults import Fault, Refusal
from .interface import INDICES, LONGEST, Estimator, FallBackMode, Mode, RemoteSyncInterface, StartUpMode
from .phase import PhaseFilter
from .zone import Finding, Zone

MOST_CYCLES = 1e6  # of the receiver in one step
MOST_RATIO = 10000  # of the cycle times: indices must not wrap within a cycle
SAME_RATIO = 1e-6  # of a ratio that is a whole number but for rounding
SAME_INSTANT = 1e-6  # of a cycle
LARGEST_COUNT = 2147483647  # that an Integer shows


class Stage(Enumeration):
    """What drives the slave"""

    DISABLED = 1, "the values are put out as received"
    START_UP = 2, "the estimate runs, and the values are corrected as start_up_mode says"
    IN_SYNC = 3, "the values are shifted in time to where the even index belongs"
    FALLEN_BACK = 4, "a fault has stopped the estimate, and the values are put out as fall_back_mode says"


@dataclass(slots=True)
class RemoteSync(RemoteSyncInterface):
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

    stage: Stage = Stage.START_UP
    restart: bool = True
    until_cycle: float = 0.0
    cycles_per_index: int = 1
    indices_per_cycle: int = 1
    ratio: float = 1.0
    cycle: int = 0
    index: int = 0
    received: int = 0
    base: int = 0
    zone: Zone = var.part(Zone)
    beat: Beats = var.part(Beats)
    phase: PhaseFilter = var.part(PhaseFilter)
    blending: Blending = var.part(Blending)
    smoothing: bool = False
    smooth_position: float = 0.0
    smooth_velocity: float = 0.0

    def initialize(self) -> Refusal:
        """As received; may be called again while parameters and inputs still change."""
        if not self.try_set_ratio():
            return Refusal.RATIO
        if self.estimator == Estimator.PHASE and (self.cycles_per_index > 1 or self.indices_per_cycle > 1):
            return Refusal.PHASE
        if 0 < self.age_of_data_limit < self.cycles_per_index:
            return Refusal.AGE
        if 0 < self.max_cycle_index_difference < self.indices_per_cycle:
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
        if self.enable:
            self.enter_start_up()
        else:
            self.enter_disabled()
        self.blending.begin(self.shown_mode())
        self.slave.put(self.remote.position, self.remote.velocity, self.remote.acceleration, 0.0)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """The receiver's cycles in [t, t+h), all with the same input."""
        cycle = self.task_cycle_time
        if h > MOST_CYCLES * cycle:
            return Refusal.CYCLES
        self.restart = self.restart or not self.enable
        worked = 0
        while worked <= MOST_CYCLES and self.until_cycle + worked * cycle < h - SAME_INSTANT * cycle:
            self.work()
            worked += 1
        self.until_cycle += worked * cycle - h
        return Refusal.NONE

    def try_set_ratio(self) -> bool:
        """r = data cycle time / task cycle time: a whole number of cycles an index, or of indices a cycle.

        False where it is neither, or beyond its limit."""
        ratio = self.data_cycle_time / self.task_cycle_time if self.data_cycle_time > 0.0 else 1.0
        inverse = 1.0 / ratio
        if not (ratio <= MOST_RATIO + 0.5 and inverse <= MOST_RATIO + 0.5):
            return False
        self.cycles_per_index = max(int(ratio + 0.5), 1)
        self.indices_per_cycle = max(int(inverse + 0.5), 1)
        self.ratio = self.cycles_per_index / self.indices_per_cycle
        return abs(ratio - self.ratio) <= SAME_RATIO * ratio

    # --- a cycle ---

    def work(self) -> None:
        """A cycle of the receiver."""
        self.obey()
        if self.stage in (Stage.START_UP, Stage.IN_SYNC):
            self.advance()
        self.smooth()
        self.set_slave()
        self.show()

    def obey(self) -> None:
        """`enable`, and a new start that is due."""
        if not self.enable:
            self.enter_disabled()
        elif self.restart:
            self.begin()

    def begin(self) -> None:
        """The first cycle: it has no step to judge."""
        self.restart = False
        self.index = self.remote.cycle_index % INDICES
        self.base = self.index
        self.received = 0
        self.cycle = -1
        self.zone.begin(0)
        self.beat.begin(0)
        self.phase.begin(0)
        self.enter_start_up()

    def advance(self) -> None:
        """The estimate goes on by a cycle; a fault leaves the correction as it was."""
        self.cycle += 1
        self.local.cycles = min(self.cycle, LARGEST_COUNT)
        self.receive()
        fault = self.fault_of_telegram()
        lead = 0.0
        if fault == Fault.NONE:
            self.estimate()
            lead = self.lead()
            fault = self.fault_of_correction(lead)
        if fault == Fault.NONE:
            self.correct(lead)
            self.show_estimate()
        else:
            self.enter_fallen_back(fault)

    def enter_disabled(self) -> None:
        self.stage = Stage.DISABLED
        self.error_id = Fault.NONE

    def enter_start_up(self) -> None:
        self.stage = Stage.START_UP
        self.error_id = Fault.NONE

    def enter_in_sync(self) -> None:
        self.stage = Stage.IN_SYNC

    def enter_fallen_back(self, fault: Fault) -> None:
        self.stage = Stage.FALLEN_BACK
        self.error_id = fault
        self.restart = self.automatic_reinit

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
        """What is known to be wrong before anything is estimated."""
        if 0 < self.max_cycle_index_difference < abs(self.cycle_index_difference):
            return Fault.INDEX_STEP
        if 0 < self.age_of_data_limit < self.equal_data_consecutive:
            return Fault.AGE_OF_DATA
        return Fault.NONE

    def estimate(self) -> None:
        """The difference of the indices, in a cycle in which a new index is due, and what follows from it."""
        cycle = self.cycle
        if cycle % self.cycles_per_index == 0:
            expected = cycle // self.cycles_per_index * self.indices_per_cycle
            self.zone.observe(cycle, self.received - expected, self.end_of_transition_limit)
        else:
            self.zone.skip()
        if self.estimator == Estimator.PHASE:
            anew = self.zone.finding == Finding.JUMP
            self.phase.learn(self.zone, cycle)
        else:
            anew = self.beat.is_contradicted_by(self.zone)
            self.beat.learn(self.zone, cycle)
        if anew:
            self.enter_start_up()

    def lead(self) -> float:
        """How far the corrected index is ahead of the received one, in data indices."""
        cycle = self.cycle
        offset = self.phase.offset(cycle) if self.estimator == Estimator.PHASE else self.beat.offset(cycle)
        return offset - (self.received - cycle * self.indices_per_cycle / self.cycles_per_index)

    def fault_of_correction(self, lead: float) -> Fault:
        """Why this lead cannot be used."""
        if self.max_cycle_index_difference > 0 and abs(lead) > self.max_cycle_index_difference + 2.0:
            return Fault.INDEX_CORRECTION
        if not (abs(self.delay_time_offset) <= LONGEST and 0.0 <= self.max_position_difference <= LARGEST_INPUT):
            return Fault.TUNABLE
        shifts = self.start_up_mode == StartUpMode.TIME or self.is_in_sync(lead)
        if shifts and 0.0 < self.max_position_difference < abs(self.shift(self.correction(lead))):
            return Fault.POSITION_DIFFERENCE
        return Fault.NONE

    def is_in_sync(self, lead: float) -> bool:
        """Whether the drift is known and, once since then, the lead was small."""
        ready = self.phase.ready() if self.estimator == Estimator.PHASE else self.beat.ready()
        return self.stage == Stage.IN_SYNC or (ready and abs(lead) * self.ratio < self.threshold_for_sync)

    def correction(self, lead: float) -> float:
        """The time by which the values are shifted, s."""
        return lead * self.ratio * self.task_cycle_time + self.delay_time_offset

    def shift(self, time: float) -> float:
        """How far the remote axis travels in that time, u."""
        travel = self.remote.velocity * time
        return travel + 0.5 * self.remote.acceleration * time * time if self.use_acceleration else travel

    def correct(self, lead: float) -> None:
        """The correction of this cycle."""
        if self.is_in_sync(lead):
            self.enter_in_sync()
        self.correction_time = self.correction(lead)
        self.corrected_cycle_index = self.base + self.received + lead
        self.drift = 1e6 * (self.phase.drift if self.estimator == Estimator.PHASE else self.beat.gain() * self.ratio)

    # --- what is put out ---

    def smooth(self) -> None:
        """The first-order lags run in every cycle, from the first value on."""
        if not self.smoothing:
            self.smoothing = True
            self.smooth_position = self.remote.position
            self.smooth_velocity = self.remote.velocity
        self.smooth_position += (self.remote.position - self.smooth_position) / (1.0 + self.pt1_factor_position)
        self.smooth_velocity += (self.remote.velocity - self.smooth_velocity) / (1.0 + self.pt1_factor_velocity)

    def set_slave(self) -> None:
        """The axis values of all modes, by their weights."""
        mode = self.shown_mode()
        self.blending.advance(mode, self.blending_time / self.task_cycle_time)
        time = self.correction_time
        position = self.remote.position + self.shift(time)
        velocity = self.remote.velocity
        if self.use_acceleration:
            velocity += self.remote.acceleration * time
        bypass = self.blending.bypass
        pt1 = self.blending.pt1
        shifted = self.blending.shifted
        accelerated = self.use_acceleration or mode in (Mode.BYPASS, Mode.PT1)
        self.slave.put(
            bypass * self.remote.position + pt1 * self.smooth_position + shifted * position,
            bypass * self.remote.velocity + pt1 * self.smooth_velocity + shifted * velocity,
            self.remote.acceleration if accelerated else 0.0,
            0.0,
        )

    def show(self) -> None:
        """What drives the slave, in the block's own variables."""
        self.state = self.shown_mode()
        self.state_code = self.state
        self.start_up = self.stage == Stage.START_UP
        self.synced = self.stage == Stage.IN_SYNC
        self.error = self.stage == Stage.FALLEN_BACK

    def shown_mode(self) -> Mode:
        """Where the axis values come from in this stage."""
        match self.stage:
            case Stage.DISABLED:
                return Mode.BYPASS
            case Stage.FALLEN_BACK:
                return Mode.PT1 if self.fall_back_mode == FallBackMode.PT1 else Mode.BYPASS
            case Stage.IN_SYNC:
                return Mode.SYNC
            case _:
                return self.mode_of_start_up()

    def mode_of_start_up(self) -> Mode:
        match self.start_up_mode:
            case StartUpMode.BYPASS:
                return Mode.BYPASS
            case StartUpMode.PT1:
                return Mode.PT1
            case _:
                return Mode.TIME

    def show_estimate(self) -> None:
        """What has been found so far."""
        phase = self.estimator == Estimator.PHASE
        self.beats = self.phase.history.beats if phase else self.beat.history.beats
        self.warning = self.phase.history.changed if phase else self.beat.history.changed
        self.local.difference = max(-LARGEST_COUNT, min(self.zone.difference, LARGEST_COUNT))
        self.local.transition = self.zone.open
        self.local.beat_distance = self.phase.history.mean if phase else self.beat.history.mean
