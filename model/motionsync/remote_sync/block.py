"""The behaviour of a RemoteSync. Source: TwinCAT TS5066; README.md has the decisions where it is silent."""

from dataclasses import dataclass

from .. import var
from ..var import LARGEST_INPUT, Enumeration
from .beat_estimator import BeatEstimator
from .blending import ModeBlending
from .faults import Fault, Refusal
from .interface import INDICES, LONGEST, Estimator, FallBackMode, Mode, RemoteSyncInterface, StartUpMode
from .phase_filter import PhaseFilter
from .transition_zone import Observation, TransitionZone

MOST_CYCLES = 1e6  # of the receiver in one step
MOST_RATIO = 10000  # of the cycle times: indices must not wrap within a cycle
LAST_CYCLE = 70_000_000_000_000  # of an estimate: two thousand years of 1 ms; times MOST_RATIO it is below 2^60
SAME_RATIO = 1e-6  # of a ratio that is a whole number but for rounding
SAME_INSTANT = 1e-6  # of a cycle
LARGEST_COUNT = 2147483647  # that an Integer shows


class Stage(Enumeration):
    """What drives the slave"""

    DISABLED = 1, "the slave has the values as received"
    START_UP = 2, "the estimate runs, and the values are corrected by start_up_mode"
    IN_SYNC = 3, "the values are shifted in time to where the even index belongs"
    FALLEN_BACK = 4, "a fault has stopped the estimate, and the slave has the values of fall_back_mode"


@dataclass(slots=True)
class RemoteSync(RemoteSyncInterface):
    """Removes the beat of two clocks from the values of an axis on another controller.

    It identifies the beats, makes the cycle index even again, and shifts the axis values in time to where the even
    index belongs. The receiver's cycles act each task_cycle_time, whatever the step size; the outputs belong to those
    instants.
    """

    stage: Stage = Stage.START_UP
    restart: bool = True
    time_to_cycle: float = 0.0
    cycles_per_index: int = var.count(MOST_RATIO, start=1)
    indices_per_cycle: int = var.count(MOST_RATIO, start=1)
    ratio: float = 1.0
    cycle: int = var.count(LAST_CYCLE)
    index: int = 0
    received: int = 0
    first_index: int = 0
    zone: TransitionZone = var.part(TransitionZone)
    beat_estimator: BeatEstimator = var.part(BeatEstimator)
    phase_filter: PhaseFilter = var.part(PhaseFilter)
    blending: ModeBlending = var.part(ModeBlending)
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
        self.beat_estimator.periods = self.periods_for_mean_drift
        self.beat_estimator.knee_share = self.slope1_numerator
        self.beat_estimator.knee = self.slope1_denominator
        self.beat_estimator.ignores_drift = self.force_time_mode
        self.beat_estimator.drift_blending = self.new_drift_blending_cycles
        self.beat_estimator.time_blending = self.time_mode_blending_cycles
        self.phase_filter.ignores_drift = self.force_time_mode
        self.phase_filter.blending = self.new_drift_blending_cycles
        self.corrected_cycle_index = float(self.remote.cycle_index % INDICES)
        if self.enable:
            self.enter_start_up()
        else:
            self.enter_disabled()
        self.blending.start(self.shown_mode())
        self.slave.set(self.remote.position, self.remote.velocity, self.remote.acceleration, 0.0)
        self.show()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """The receiver's cycles in [t, t+h), all with the same input."""
        cycle = self.task_cycle_time
        if h > MOST_CYCLES * cycle:
            return Refusal.CYCLES
        self.restart = self.restart or not self.enable
        cycles = 0
        while cycles <= MOST_CYCLES and self.time_to_cycle + cycles * cycle < h - SAME_INSTANT * cycle:
            self.run_cycle()
            cycles += 1
        self.time_to_cycle += cycles * cycle - h
        return Refusal.NONE

    def try_set_ratio(self) -> bool:
        """Set r = data cycle time / task cycle time, a whole number of cycles an index, or of indices a cycle."""
        ratio = self.data_cycle_time / self.task_cycle_time if self.data_cycle_time > 0.0 else 1.0
        inverse = 1.0 / ratio
        if not (ratio <= MOST_RATIO + 0.5 and inverse <= MOST_RATIO + 0.5):
            return False
        self.cycles_per_index = max(int(ratio + 0.5), 1)
        self.indices_per_cycle = max(int(inverse + 0.5), 1)
        self.ratio = self.cycles_per_index / self.indices_per_cycle
        return abs(ratio - self.ratio) <= SAME_RATIO * ratio

    # --- a cycle ---

    def run_cycle(self) -> None:
        """Carry out a cycle of the receiver."""
        self.obey()
        if self.stage in (Stage.START_UP, Stage.IN_SYNC):
            self.advance()
        self.smooth()
        self.set_slave()
        self.show()

    def obey(self) -> None:
        """Carry out `enable`, and a new start that is due."""
        if not self.enable:
            self.enter_disabled()
        elif self.restart:
            self.start_estimate()

    def start_estimate(self) -> None:
        """Start in the first cycle, which has no step of the index yet."""
        self.restart = False
        self.index = self.remote.cycle_index % INDICES
        self.first_index = self.index
        self.received = 0
        self.cycle = -1
        self.zone.start(0)
        self.beat_estimator.start(0)
        self.phase_filter.start(0)
        self.enter_start_up()

    def advance(self) -> None:
        """Continue the estimate by a cycle; a fault leaves the correction as it was."""
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
        """Read the index; its step is taken the shorter way round."""
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
        """The fault of a telegram, before anything is estimated; NONE: it has none."""
        if 0 < self.max_cycle_index_difference < abs(self.cycle_index_difference):
            return Fault.INDEX_STEP
        if 0 < self.age_of_data_limit < self.equal_data_consecutive:
            return Fault.AGE_OF_DATA
        return Fault.NONE

    def estimate(self) -> None:
        """Update the estimate by the difference of the indices, in a cycle in which a new index is due."""
        cycle = self.cycle
        if cycle % self.cycles_per_index == 0:
            expected = cycle // self.cycles_per_index * self.indices_per_cycle
            self.zone.observe(cycle, self.received - expected, self.end_of_transition_limit)
        else:
            self.zone.observation = Observation.NOTHING
        if self.estimator == Estimator.PHASE:
            restarts = self.zone.observation == Observation.JUMP
            self.phase_filter.update(self.zone, cycle)
        else:
            restarts = self.beat_estimator.is_contradicted_by(self.zone)
            self.beat_estimator.update(self.zone, cycle)
        if restarts:
            self.enter_start_up()

    def lead(self) -> float:
        """How far the corrected index is ahead of the received one, in data indices."""
        cycle = self.cycle
        is_phase = self.estimator == Estimator.PHASE
        offset = self.phase_filter.offset(cycle) if is_phase else self.beat_estimator.offset(cycle)
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
        """Whether the drift is determined and, once since then, the lead was small."""
        is_phase = self.estimator == Estimator.PHASE
        is_determined = self.phase_filter.has_usable_drift() if is_phase else self.beat_estimator.has_usable_drift()
        return self.stage == Stage.IN_SYNC or (is_determined and abs(lead) * self.ratio < self.threshold_for_sync)

    def correction(self, lead: float) -> float:
        """The time by which the values are shifted, s."""
        return lead * self.ratio * self.task_cycle_time + self.delay_time_offset

    def shift(self, time: float) -> float:
        """How far the remote axis travels in that time, u."""
        travel = self.remote.velocity * time
        return travel + 0.5 * self.remote.acceleration * time * time if self.use_acceleration else travel

    def correct(self, lead: float) -> None:
        """Set the correction of this cycle."""
        if self.is_in_sync(lead):
            self.enter_in_sync()
        self.correction_time = self.correction(lead)
        self.corrected_cycle_index = self.first_index + self.received + lead
        is_phase = self.estimator == Estimator.PHASE
        self.drift = 1e6 * (self.phase_filter.drift if is_phase else self.beat_estimator.drift() * self.ratio)

    # --- the outputs ---

    def smooth(self) -> None:
        """Run the first-order lags; they run in every cycle, from the first value on."""
        if not self.smoothing:
            self.smoothing = True
            self.smooth_position = self.remote.position
            self.smooth_velocity = self.remote.velocity
        self.smooth_position += (self.remote.position - self.smooth_position) / (1.0 + self.pt1_factor_position)
        self.smooth_velocity += (self.remote.velocity - self.smooth_velocity) / (1.0 + self.pt1_factor_velocity)

    def set_slave(self) -> None:
        """Set the slave to the axis values of all modes, by their shares."""
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
        self.slave.set(
            bypass * self.remote.position + pt1 * self.smooth_position + shifted * position,
            bypass * self.remote.velocity + pt1 * self.smooth_velocity + shifted * velocity,
            self.remote.acceleration if accelerated else 0.0,
            0.0,
        )

    def show(self) -> None:
        """Show in the block's variables what drives the slave."""
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
                if self.start_up_mode == StartUpMode.BYPASS:
                    return Mode.BYPASS
                return Mode.PT1 if self.start_up_mode == StartUpMode.PT1 else Mode.TIME

    def show_estimate(self) -> None:
        """Show what the estimate has resulted in so far."""
        is_phase = self.estimator == Estimator.PHASE
        self.beats = self.phase_filter.history.beats if is_phase else self.beat_estimator.history.beats
        self.warning = self.phase_filter.history.has_changed if is_phase else self.beat_estimator.history.has_changed
        self.local.difference = max(-LARGEST_COUNT, min(self.zone.difference, LARGEST_COUNT))
        self.local.transition = self.zone.is_open
        self.local.beat_distance = self.phase_filter.history.mean if is_phase else self.beat_estimator.history.mean
