"""CutToLength: material that never stops is cut to length by a saw that runs with it; axis and sequence in one block.

Source: what vendors' packages for cross cutters do has been collected and decided on; README.md gives the decisions.
"""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..cutting.faults import MarkRefusal, NoLength, PieceFault
from ..cutting.interface import Source
from ..cutting.material import Material
from ..cutting.operation import Operation
from ..cutting.outputs import show_line_request, show_marks, show_queues, show_skipped_cut
from ..cutting.pieces import fix_piece, record_piece, try_drop_turns
from ..cutting.records import PieceRecords, increased
from ..cutting.reserve import Reserve
from ..master import PathRefusal
from ..master_path import MOST_EVENTS, NEVER
from ..motion.exceeded_limit import ExceededLimit
from ..numerics.cosine import cosine
from .blade import Blade, stage_end
from .carriage import Carriage, Stage
from .carriage_curve import can_open_gap
from .faults import Fault, Refusal, SkipReason
from .homing_motion import is_accelerating
from .instants import Condition, first_instant, has_reached_start
from .interface import CutToLengthInterface, ToolMode
from .late_cuts import CutDecision, cut_of_start, decide_cut, fast_line_reason, skip_late_cuts
from .machine_limits import approach_distance, lead
from .outputs import show_cut, show_saw_warnings, show_state
from .pieces import update_piece
from .predictions import Predictions
from .settings import MachineSettings, refused_parameter, start_refusal

LONG_AGO = -1e9  # s: the carriage has been at home since long before the initialization


@dataclass(slots=True)
class CutToLength(CutToLengthInterface):
    """A saw that cuts running material to length, with all that belongs to it.

    `start` sets the machine to work. It determines where the next cut is, from the lengths of the orders, the input
    length or marks on the material; it starts the carriage so that it is in sync at the cut, commands the blade,
    records the pieces, and moves the carriage home. It shows what line velocity it can follow, and warns before a cut
    is missed.

    Everything happens at its own instant inside the step, so that the results do not depend on the step size.
    """

    # Not shown. Positions of cuts are unwrapped positions of the master, u; times are in s.
    cosine: float = 1.0  # of diagonal_angle
    operation: Operation = var.part(Operation)
    settings: MachineSettings = var.part(MachineSettings, hidden=True)
    material: Material = var.part(Material)
    records: PieceRecords = var.part(PieceRecords)
    predictions: Predictions = var.part(Predictions)
    exceeded: ExceededLimit = var.part(ExceededLimit)

    # The cycle under way.
    carriage: Carriage = var.part(Carriage)
    blade: Blade = var.part(Blade)
    reserve: Reserve = var.part(Reserve)
    sync_time: float = 0.0  # the block's time

    block_clock: Clock = var.part(Clock)

    def initialize(self) -> Refusal:
        """The carriage rests at its initial position; may be called again while parameters still change.

        What the machine can do is put out, too; warnings come with the first step."""
        refusal = start_refusal(self)
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.carriage.homing.rest_at(self.axis.initial_position)
        self.carriage.stage_clock.start(LONG_AGO)
        self.operation.take_levels(self)
        self.blade.done_edge.take_level(self.tool.done)
        self.material.demand.read(self)
        self.update_settings()
        self.show_motion()
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        """From t to t+h. The commands act once the events of the first instant, on section 0, are carried out."""
        longest = self.operation.longest_travel(self, self.material, self.predictions.pitch_orders)
        refusal = self.master.try_advance_within(h, longest)
        if refusal != PathRefusal.NONE:
            return Refusal.TRAVEL if refusal == PathRefusal.TRAVEL else Refusal.MASTER_TURNS
        self.material.demand.read(self)
        self.local.skip_reason = SkipReason.NONE
        self.local.mark_refusal = MarkRefusal.NONE
        for section in range(self.master.path.sections):
            self.follow_section(section)
            if section == 0:
                self.obey()
        self.advance_clocks(h)
        before = self.slave.position
        self.show_motion()
        self.show(before, h)
        self.rebase()
        self.operation.has_stepped = True
        return Refusal.NONE

    def advance_clocks(self, h: float) -> None:
        self.block_clock.advance(h)
        self.carriage.stage_clock.advance(h)
        self.reserve.advance(h)
        self.blade.command_clock.advance(h)
        self.carriage.homing.motion.advance(h)

    # --- the parameters ---

    def are_settings_current(self) -> bool:
        """Whether all tunable parameters are valid, and have been taken over."""
        return self.settings.are_current(self) and self.material.settings.are_current(self)

    def update_settings(self) -> None:
        """Compute with the present parameters, as far as they are valid."""
        self.settings.take_over(self)
        self.material.settings.take_over(self)
        self.local.refused_parameter = refused_parameter(self)
        self.describe_machine()

    def describe_machine(self) -> None:
        """Compute with the present factor of calibration."""
        self.settings.describe(self.carriage.machine, self.material.settings, self.calibration.factor, self.cosine)
        self.predictions.is_current = False

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands of the step, and what is looked at at each step's beginning."""
        if not self.are_settings_current():
            self.update_settings()
        self.obey_machine()
        self.obey_pieces()
        self.watch_marks()
        self.operation.try_request_cut(self)
        is_done = self.blade.done_edge.try_rise(self.tool.done)
        if is_done and self.carriage.stage == Stage.CUTTING and self.tool.mode == ToolMode.FEEDBACK:
            self.end_cut()
        update_piece(self, self.operation, self.material, self.carriage)
        self.watch_ease()

    def obey_machine(self) -> None:
        """Carry out reset, abort, stop, start."""
        operation = self.operation
        operation.reset(self, self.carriage.stage == Stage.RESTING)
        if operation.try_abort(self):
            self.leave_material()
        if operation.try_stop(self):
            self.finish_cut()
        if operation.try_take_start(self):
            is_off = not self.running and self.carriage.stage == Stage.RESTING
            if operation.try_start(self, self.material, is_off, self.are_settings_current()):
                self.set_to_work()

    def obey_pieces(self) -> None:
        """The commands for pieces."""
        factor = self.calibration.factor
        self.operation.obey_pieces(self, self.records, self.material)
        if self.calibration.factor != factor:
            self.describe_machine()

    def finish_cut(self) -> None:
        """Finish the cut under way; without one move home, or stay there."""
        if self.carriage.stage == Stage.WAITING:
            self.enter_resting()
        elif self.carriage.stage == Stage.RETURNING and self.carriage.homing.is_eased:
            self.enter_returning()

    def set_to_work(self) -> None:
        """Fix the first piece, and wait for its cut at home."""
        self.running = True
        self.reserve.reset()
        front = self.material.settings.start.front_position / self.carriage.machine.coupling
        self.material.start(self.start_mode, self.master.begin, front)
        if self.carriage.homing.end == self.settings.home_position:
            self.carriage.enter_waiting()
        else:
            self.carriage.enter_homing(self.master.path.now)

    # --- the material ---

    def watch_marks(self) -> None:
        """What the sensor sees, and does not see; marks that are missing or too many stop the machine."""
        self.material.watch_marks(self, self.operation.mark_edge.try_rise(self.mark.detected))
        show_marks(self, self.warning, self.local, self.material)
        if self.material.mark_fault != PieceFault.NONE:
            self.fail(self.material.mark_fault)

    # --- the master's path ---

    def follow_section(self, section: int) -> None:
        """Carry out the events on a section of the path; on section 0 those of the step's first instant."""
        self.master.path.enter(section)
        for _ in range(MOST_EVENTS):
            if not self.try_event():
                break

    def try_event(self) -> bool:
        """Carry out the next event of the stage on what is left of the section; False: there is none."""
        match self.carriage.stage:
            case Stage.RESTING:
                return False
            case Stage.HOMING | Stage.RETURNING:
                return self.try_event_returning()
            case Stage.WAITING:
                return self.try_event_waiting()
            case Stage.APPROACHING:
                return self.try_event_approaching()
            case Stage.CLEARING:
                return self.try_sync_while_clearing() or self.try_event_on_curve()
            case _:
                return self.try_event_on_curve()

    def first(self, condition: Condition) -> float:
        """The first instant from now on at which a condition holds; NEVER: not on what is left of the section."""
        return first_instant(condition, self.master, self.carriage, self.material.piece, self.master.path.until)

    # --- the events of each stage ---

    def try_event_returning(self) -> bool:
        """The carriage arrives, or has halted to come home with ease."""
        time = self.master.path.due(self.carriage.homing.motion.clock, self.carriage.homing.motion.end_time())
        if time == NEVER:
            return False
        self.master.path.now = time
        if self.carriage.homing.is_halting:
            self.carriage.homing.continue_home(self.carriage.machine, time)
        else:
            self.arrive()
        return True

    def try_event_waiting(self) -> bool:
        """The carriage has settled, or an approach starts."""
        if not self.carriage.is_ready:
            return self.try_settle()
        if self.hold:
            return False
        if self.operation.is_cut_pending:
            time = self.first(Condition.ADMISSIBLE)
        elif self.material.piece.is_fixed and not self.predictions.is_far_from_start(
            self, self.carriage, self.material.piece.end
        ):
            time = self.first(Condition.START)
        else:
            return False
        if time == NEVER:
            return False
        if not (self.settings.are_current(self) and self.material.settings.has_cycle(self)):
            self.operation.refusal = PieceFault.TUNABLE
            return False
        path = self.master.path
        velocity = self.master.present_velocity()
        is_crossed = not has_reached_start(self.master, self.carriage, self.material.piece, velocity, path.now)
        path.now = time
        if self.operation.is_cut_pending:
            self.start_cut_now()
        else:
            self.start_next_cut(is_crossed)
        return True

    def try_settle(self) -> bool:
        """The carriage has rested at home for long enough."""
        time = self.master.path.due(self.carriage.stage_clock, self.settings.homing.settle_time)
        if time == NEVER:
            return False
        self.master.path.now = time
        self.carriage.is_ready = True
        self.reserve.wait(time)
        return True

    def try_event_approaching(self) -> bool:
        """The tool is commanded, the blade touches, sync is reached, or the line goes back."""
        if self.try_tool_before_sync():
            return True
        back = self.first(Condition.BACK)
        if back != NEVER:
            self.master.path.now = back
            self.go_back()
            return True
        sync = self.first(Condition.SYNC)
        if sync == NEVER:
            return False
        self.master.path.now = sync
        self.enter_synchronous()
        return True

    def try_tool_before_sync(self) -> bool:
        """Carry out what the tool does before sync, if it comes first."""
        piece = self.material.piece
        time = self.blade.instant_before_sync(self.tool, self.master, self.carriage, piece)
        if time == NEVER:
            return False
        self.master.path.now = time
        if self.tool.command:
            self.tool.blade_down = True
            self.blade.is_early = True
            self.warning.blade_early = True
            self.statistics.unsynchronised = increased(self.statistics.unsynchronised, 1.0)
        else:
            self.command_tool(True)
        return True

    def try_sync_while_clearing(self) -> bool:
        """CLEARING: the carriage, which has left the approach, is in sync after all."""
        if self.carriage.curve.has_joined:
            return False
        path = self.master.path
        clear = self.master.path.due(self.carriage.stage_clock, self.carriage.clearing_time)
        piece = self.material.piece
        time = first_instant(Condition.SYNC, self.master, self.carriage, piece, min(clear, path.until))
        if time == NEVER:
            return False
        path.now = time
        self.carriage.curve.has_joined = True
        return True

    def try_event_on_curve(self) -> bool:
        """The next event of the stage, or the stroke ends before it."""
        time = stage_end(self.carriage, self.blade, self.tool, self.master, self.material.piece)
        if self.try_end_of_stroke(time):
            return True
        if time == NEVER:
            return False
        match self.carriage.stage:
            case Stage.SYNCHRONOUS:
                self.act_in_sync(time)
            case Stage.CUTTING:
                self.master.path.now = time
                if self.tool.mode == ToolMode.FEEDBACK:
                    self.fail(Fault.TOOL_TIMEOUT)
                else:
                    self.end_cut()
            case Stage.PULLING:
                self.master.path.now = time
                self.command_tool(False)
                self.carriage.enter_clearing(self.master.path.now)
            case _:
                self.master.path.now = time
                self.tool.blade_down = False
                self.enter_returning()
        return True

    def act_in_sync(self, time: float) -> None:
        """The tool is commanded, the blade touches, or the cut starts."""
        cycle = self.carriage.cycle_machine
        touch = self.master.path.due(self.blade.command_clock, cycle.on_delay)
        self.master.path.now = time
        if not self.tool.command:
            self.command_tool(True)
        elif (
            touch == time
            and not self.tool.blade_down
            and not self.carriage.stage_clock.has_reached(cycle.settle_time, time)
        ):
            self.tool.blade_down = True
        else:
            self.enter_cutting()

    def try_end_of_stroke(self, other: float) -> bool:
        """The carriage has to stop before an end of its stroke, earlier than the other event comes."""
        until = min(other, self.master.path.until)
        if self.carriage.is_far_from_ends(self.master, until):
            return False
        time = first_instant(Condition.STROKE_END, self.master, self.carriage, self.material.piece, until)
        if time == NEVER or time >= other:
            return False
        self.master.path.now = time
        if self.tool.blade_down:
            self.statistics.unsynchronised = increased(self.statistics.unsynchronised, 1.0)
        if self.operation.fault == Fault.NONE:
            self.operation.fail(Fault.STROKE)
            self.running = False
        self.command_tool(False)
        self.enter_returning()
        return True

    # --- cuts start and end ---

    def start_next_cut(self, is_crossed: bool) -> None:
        """Start the approach to the next cut, which is where it starts, or beyond that; or act on a late cut.

        `is_crossed`: the cut has come there in the present step."""
        velocity = self.master.present_velocity()
        machine = self.carriage.machine
        piece = self.material.piece
        beyond_cut = self.master.distance_beyond(piece.end, self.master.path.now)
        distance = self.carriage.homing.end - machine.coupling * beyond_cut
        if is_crossed and not piece.waits_for_line():
            distance = approach_distance(machine, velocity)  # the same, without the rounding of positions
        earliest = cut_of_start(piece.end, self.carriage, self.master, lead(machine, velocity))
        match decide_cut(self.material.settings.cycle.late_mode, piece, machine, velocity, distance, earliest):
            case CutDecision.MAKE:
                self.enter_approaching(distance, False)
            case CutDecision.MAKE_LATE:
                self.statistics.late = increased(self.statistics.late, 0.0 if piece.waits_for_line() else 1.0)
                piece.end = earliest
                self.enter_approaching(lead(machine, velocity), True)
            case CutDecision.SKIP:
                distance = lead(machine, velocity)
                self.show_skipped_cut(SkipReason.LATE, distance)
                skip_late_cuts(self.material, self.statistics, self.carriage, self.master, distance)
            case CutDecision.STOP_LINE:
                self.fail(PieceFault.CUT_MISSED)
            case CutDecision.SKIP_UNTIL_ADMISSIBLE:
                self.skip_cuts_of_fast_line()
            case CutDecision.STOP_FAST_LINE:
                self.fail(Fault.STROKE)

    def start_cut_now(self) -> None:
        """Carry out a cut_now: cut where the carriage can be in sync first, if there is material."""
        distance = lead(self.carriage.machine, self.master.present_velocity())
        cut = cut_of_start(self.master.begin, self.carriage, self.master, distance)
        if self.operation.try_take_cut(self.material, cut, True):
            self.enter_approaching(distance, False)

    def skip_cuts_of_fast_line(self) -> None:
        """Leave out all cuts that are due before the line is slow enough, on what is left of the section."""
        machine = self.carriage.machine
        velocity = self.master.present_velocity()
        distance = lead(machine, velocity)
        self.show_skipped_cut(fast_line_reason(machine, velocity), distance)
        if self.source == Source.LENGTH:
            self.master.path.now = min(self.first(Condition.ADMISSIBLE), self.master.path.until)
            distance = approach_distance(machine, self.master.present_velocity())
        skip_late_cuts(self.material, self.statistics, self.carriage, self.master, distance)

    def show_skipped_cut(self, reason: SkipReason, distance: float) -> None:
        """Show that the next cut is skipped, and why; `distance`: the way that its approach would need, u."""
        carriage = self.carriage
        cut = self.material.piece.end
        left = carriage.homing.end - carriage.machine.coupling * self.master.distance_beyond(cut, self.master.path.now)
        show_skipped_cut(self.local, reason, self.master, cut, distance - left)

    def enter_approaching(self, distance: float, is_late: bool) -> None:
        """The carriage starts now and is in sync after its own travel `distance`."""
        carriage = self.carriage
        var.copy(carriage.cycle_machine, carriage.machine)
        carriage.cut_timeout = self.settings.tool.timeout
        carriage.curve.plan_approach(carriage.cycle_machine.coupling, carriage.homing.end, distance)
        carriage.cut = self.material.piece.end
        self.reserve.start_cut(self.master.path.now, is_late)
        self.blade.is_early = False
        self.local.start_time = self.block_clock.time + self.master.path.now
        self.carriage.stage = Stage.APPROACHING
        if carriage.is_nearly_in_sync(
            self.master, self.master.path.now
        ):  # the line is at rest where the cut is, or nearly so
            self.enter_synchronous()

    def end_cut(self) -> None:
        """The blade is through: the piece ends, and the next one starts."""
        record_piece(self, self.material, self.records, self.carriage.cut, self.sync_time, self.reserve.share)
        self.warning.change_pending = False
        self.reserve.end_cut()
        fix_piece(self.operation, self.material, self.material.settings.has_piece(self), False)
        self.warning.gap_skipped = False
        velocity = self.master.present_velocity()
        cycle = self.carriage.cycle_machine
        if cycle.gap_distance > 0.0:
            carriage_velocity = cycle.coupling * velocity
            if velocity > 0.0 and can_open_gap(
                carriage_velocity, cycle.gap_distance, cycle.gap_travel, self.settings.axis
            ):
                self.carriage.enter_pulling(self.master)
                return
            self.warning.gap_skipped = True
        self.command_tool(False)
        self.carriage.enter_clearing(self.master.path.now)

    # --- the stages are entered ---

    def enter_resting(self) -> None:
        """The machine does not run any more."""
        self.carriage.stage = Stage.RESTING
        self.running = False
        self.warning.change_pending = False
        self.material.piece.reset()

    def enter_synchronous(self) -> None:
        self.carriage.stage = Stage.SYNCHRONOUS
        self.carriage.curve.has_joined = True
        self.carriage.stage_clock.start(self.master.path.now)
        self.sync_time = self.block_clock.time + self.master.path.now

    def enter_cutting(self) -> None:
        self.carriage.stage = Stage.CUTTING
        self.carriage.stage_clock.start(self.master.path.now)
        self.carriage.cut_begin = self.master.distance_beyond(self.carriage.cut, self.master.path.now)
        self.tool.blade_down = True
        self.warning.blade_early = self.blade.is_early

    def enter_returning(self) -> None:
        """From any motion to home; from the material eased, if there is time for it."""
        is_homing = self.carriage.stage in (Stage.RETURNING, Stage.HOMING)
        self.carriage.plan_homing(self.master, is_homing)
        if not is_homing and self.can_ease():
            homing = self.settings.homing
            self.carriage.ease_homing(self.master, homing.slowest, homing.spare_time, self.material.piece.end)
        self.carriage.stage = Stage.RETURNING

    def can_ease(self) -> bool:
        """Whether the next cut is determined, and the line moves towards it without getting faster."""
        if self.operation.is_stopping or self.operation.is_cut_pending:
            return False
        if not (self.running and self.homing.ease and self.material.piece.is_fixed):
            return False
        return self.master.present_velocity() > 0.0 and not is_accelerating(self.master)

    def watch_ease(self) -> None:
        """Hurry home where there is no time for an eased motion any more."""
        homing = self.carriage.homing
        if self.carriage.stage == Stage.RETURNING and homing.is_eased:
            piece = self.material.piece
            if self.operation.is_cut_pending or not piece.is_fixed or not homing.can_stay_eased(self.master, piece.end):
                self.enter_returning()

    def arrive(self) -> None:
        """The carriage is at home."""
        self.carriage.stage_clock.start(self.master.path.now)
        self.local.home_time = self.block_clock.time + self.master.path.now
        self.carriage.homing.rest_at(self.carriage.homing.end)
        self.master.watch_travel()
        if self.operation.is_stopping or self.operation.fault != Fault.NONE:
            self.enter_resting()
        else:
            self.carriage.enter_waiting()

    def go_back(self) -> None:
        """The line has gone back to before the approach: the carriage is at home at rest again."""
        self.command_tool(False)
        self.tool.blade_down = False
        if self.operation.is_stopping:
            self.carriage.stage_clock.start(self.master.path.now)
            self.enter_resting()
        else:
            self.carriage.enter_waiting()
            self.carriage.is_ready = True
            self.reserve.wait(self.master.path.now)

    def command_tool(self, down: bool) -> None:
        """Command the tool, if that is a change."""
        self.blade.command(self.tool, down, self.master.path.now, self.block_clock.time)

    def fail(self, fault: int) -> None:
        """The machine stops for a fault: the carriage leaves the material and moves home."""
        self.operation.fail(fault)
        self.running = False
        self.leave_material()

    def leave_material(self) -> None:
        """With the blade down the carriage stays on its curve until that is clear; then, or else, it goes home."""
        self.command_tool(False)
        match self.carriage.stage:
            case Stage.WAITING:
                self.enter_resting()
            case Stage.APPROACHING | Stage.SYNCHRONOUS | Stage.CUTTING | Stage.PULLING:
                if self.tool.blade_down:
                    self.carriage.enter_clearing(self.master.path.now)
                else:
                    self.enter_returning()
            case Stage.HOMING:
                self.enter_returning()
            case Stage.RETURNING:
                if self.carriage.homing.is_eased:
                    self.enter_returning()
            case _:
                pass

    # --- what is put out ---

    def set_slave(self) -> None:
        """The carriage's setpoint at the end of the step."""
        match self.carriage.stage:
            case Stage.RESTING | Stage.WAITING:
                self.slave.set(self.carriage.homing.end, 0.0, 0.0, 0.0)
            case Stage.HOMING | Stage.RETURNING:
                position, velocity, acceleration, jerk = self.carriage.homing.motion.at(0.0)
                self.slave.set(position, velocity, acceleration, jerk)
            case _:
                position, velocity, acceleration, jerk = self.carriage.setpoint_at_end(self.master)
                self.slave.set(position, velocity, acceleration, jerk)

    def show_motion(self) -> None:
        """The setpoint, and what is predicted from the motion of the line."""
        self.set_slave()
        self.predictions.update(self, self.carriage.machine, self.material)
        show_cut(self, self.carriage, self.material)
        show_line_request(self, self.limits, self.operation, self.material.settings.line.margin)

    def show(self, before: float, h: float) -> None:
        """What is shown of the machine from the first step on; of h seconds, from the setpoint `before`."""
        carriage = self.carriage
        material = self.material
        show_state(self, carriage, self.operation)
        if carriage.stage != Stage.CLEARING:
            self.blade.update(self.tool, carriage.cycle_machine.retract_time)
        show_queues(self, self.local, material, material.missing_length() if self.running else NoLength.NONE)
        show_saw_warnings(self, carriage, self.exceeded, before, h)
        self.local.ease = carriage.homing.share
        self.clock = self.block_clock.time

    def rebase(self) -> None:
        """Drop the master's whole turns from all positions."""
        turns = try_drop_turns(self.master, self.material)
        self.carriage.homing.eased_cut -= turns
        self.carriage.cut -= turns
