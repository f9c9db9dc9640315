"""RotaryKnife: material that never stops is cut to length by blades on a cylinder that turns above it.

Source: what vendors' packages for cross cutters do has been collected and decided on; README.md gives the decisions.
"""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..cutting.faults import MarkRefusal, NoLength, PieceFault
from ..cutting.interface import LateMode, PieceKind
from ..cutting.material import Material
from ..cutting.operation import Operation
from ..cutting.outputs import (
    show_line_request,
    show_marks,
    show_piece,
    show_queues,
    show_skipped_cut,
    show_warnings,
)
from ..cutting.piece import UNLIMITED
from ..cutting.pieces import can_change_pieces, fix_piece, record_piece, try_drop_turns
from ..cutting.records import PieceRecords, increased
from ..cutting.reserve import Reserve
from ..master import PathRefusal
from ..master_path import MOST_EVENTS, NEVER
from ..motion.axis_limits import AxisLimits
from ..motion.exceeded_limit import ExceededLimit
from ..motion.laws import chain_rule
from ..numerics.computable_range import LARGEST
from ..numerics.grid import wrap
from .curves import PUNCTUAL, SHORTEST_WAY, Peaks, keeps_limits
from .cycle import RAMP_DOWN, RAMP_UP, TURNING_ON, Cycle, Stage
from .departure import Departure
from .faults import Refusal, SkipReason
from .interface import RotaryKnifeInterface
from .knife import Knife
from .outputs import show_peaks, show_state
from .parking import Parking
from .pieces import FixedPiece, changed_cut, missing_length, skip_cuts_before, skip_to_reached_cut
from .predictions import Predictions
from .settings import KnifeSettings, describe_knife
from .window import Cut, Window

LATE = 1e-9  # of a ramp's travel: with so much less it begins in time


@dataclass(slots=True)
class RotaryKnife(RotaryKnifeInterface):
    """A rotary knife that cuts running material to length, with all that belongs to it.

    `start` sets the machine to work. It determines where the next cut is, from the lengths of the orders, the input
    length or marks on the material; it turns the knife so that a blade is in sync at the cut, records the pieces, and
    shows what line velocity it can follow.

    Everything happens at its own place of the material, so that the results do not depend on the step size.
    """

    # Not shown. Positions of cuts are unwrapped positions of the master, u; times are in s. Positions of the knife
    # count from where the blade of the next cut cuts.
    knife_data: Knife = var.part(Knife)
    operation: Operation = var.part(Operation)
    settings: KnifeSettings = var.part(KnifeSettings)
    material: Material = var.part(Material)
    records: PieceRecords = var.part(PieceRecords)
    predictions: Predictions = var.part(Predictions)
    exceeded: ExceededLimit = var.part(ExceededLimit)
    axis_limits: AxisLimits = var.part(AxisLimits, hidden=True)

    # The windows: of the latest cut to which a way was planned; of the last cut that was made.
    fixed: FixedPiece = var.part(FixedPiece)
    planned_cut: Cut = var.part(Cut)
    is_cut_made: bool = True
    last_window: Window = var.part(Window)
    has_last_window: bool = False

    cycle: Cycle = var.part(Cycle)
    departure: Departure = var.part(Departure)
    cycle_peaks: Peaks = var.part(Peaks)
    parking: Parking = var.part(Parking)
    reserve: Reserve = var.part(Reserve)
    is_blocked: bool = False  # the ramp up: a parameter that it needs is out of its range
    is_ramp_too_fast: bool = False
    is_change_pending: bool = False
    is_cut_refused: bool = False  # a cut_now could not move the next cut forward

    block_clock: Clock = var.part(Clock)

    def initialize(self) -> Refusal:
        """The knife rests at park; may be called again while parameters still change.

        What the machine can do is put out, too; warnings come with the first step."""
        describe_knife(self.knife_data, self)
        refusal = self.settings.start_refusal(self, self.knife_data)
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.describe_axis()
        self.cycle.rest_at(Stage.RESTING, self.knife_data, self.blade_after(1.0), self.park_position())
        self.operation.take_levels(self)
        self.material.demand.read(self)
        self.update_settings()
        self.show_motion()
        return Refusal.NONE

    def describe_axis(self) -> None:
        """The axis's limits, as the check of the setpoint needs them: it has no end positions."""
        self.axis_limits.max_velocity = self.axis.max_velocity
        self.axis_limits.max_acceleration = self.axis.max_acceleration
        self.axis_limits.max_jerk = self.axis.max_jerk
        self.axis_limits.min_position = -LARGEST
        self.axis_limits.max_position = LARGEST

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
        self.reserve.advance(h)
        self.parking.motion.advance(h)

    # --- the parameters ---

    def are_settings_current(self) -> bool:
        """Whether all tunable parameters are valid, and have been taken over."""
        return self.settings.are_current(self) and self.material.settings.are_current(self)

    def update_settings(self) -> None:
        """Compute with the present parameters, as far as they are valid."""
        self.settings.take_over(self, self.knife_data)
        self.material.settings.take_over(self)
        self.local.refused_parameter = self.settings.refused_parameter(self)
        self.is_blocked = self.is_blocked and not self.material.settings.has_cycle(self)
        self.describe_window()

    def describe_window(self) -> None:
        """Compute with the present factor of calibration."""
        factor = self.material.settings.cycle.material_factor * self.calibration.factor
        sync = self.settings.sync
        self.material.settings.factor = factor
        self.predictions.window.set(self.knife_data, factor, sync.before, sync.after, sync.overspeed)
        self.predictions.describe(self.knife_data)

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands of the step, and what is looked at at each step's beginning."""
        self.master.path.leave()
        if not self.are_settings_current():
            self.update_settings()
        self.obey_machine()
        self.obey_pieces()
        self.watch_marks()
        if self.operation.try_request_cut(self):
            self.advance_cut()
        self.update_piece()

    def obey_machine(self) -> None:
        """Carry out reset, abort, stop, start."""
        operation = self.operation
        operation.reset(self, self.cycle.stage == Stage.RESTING)
        if operation.try_abort(self):
            self.leave_material()
        if operation.try_stop(self) and self.cycle.stage == Stage.WAITING:
            self.enter_resting()
        if operation.try_take_start(self):
            is_off = self.cycle.stage == Stage.RESTING
            if operation.try_start(self, self.material, is_off, self.are_settings_current()):
                self.set_to_work()

    def obey_pieces(self) -> None:
        """The commands for pieces."""
        factor = self.calibration.factor
        self.operation.obey_pieces(self, self.records, self.material)
        if self.calibration.factor != factor:
            self.describe_window()

    def set_to_work(self) -> None:
        """Fix the first piece, and wait for its cut."""
        self.running = True
        self.fixed.is_late = False
        self.reserve.reset()
        self.reserve.wait(self.master.path.now)
        is_sample_pending = self.material.is_sample_pending
        settings = self.material.settings
        self.material.start(self.start_mode, self.master.begin, settings.start.front_position / settings.factor)
        self.fixed.accept(self, self.operation, self.material, self.predictions, is_sample_pending)
        self.cycle.rest_at(Stage.WAITING, self.knife_data, self.cycle.blade, self.park_position())

    def advance_cut(self) -> None:
        """A cut_now that comes at rest, or soon before, is made as soon as possible; on a curve the next cut is moved
        forward."""
        operation = self.operation
        if self.cycle.stage == Stage.WAITING:
            return
        is_turning = self.cycle.stage in (Stage.TURNING, Stage.DISENGAGING)
        if self.cycle.stage == Stage.DISENGAGING and self.hold:
            return
        if self.cycle.stage == Stage.SYNCHRONOUS and self.is_cut_made and self.cycle.is_last():
            return
        operation.is_cut_pending = False
        if is_turning:
            self.departure.leave_curve(self.cycle, self.master)
            if self.hold or not self.cycle.can_append(2) or not self.try_earlier_cut():
                self.is_cut_refused = True

    # --- the pieces ---

    def fix_piece(self, is_open: bool) -> None:
        """Fix the piece that starts at the last cut, if the settings are valid; `is_open`: it had no length so far."""
        is_sample_pending = self.material.is_sample_pending
        fix_piece(self.operation, self.material, self.can_fix(), is_open)
        self.fixed.accept(self, self.operation, self.material, self.predictions, is_sample_pending)

    def can_fix(self) -> bool:
        """Whether all is valid that a piece is fixed with."""
        return self.settings.are_current(self) and self.material.settings.has_piece(self)

    def update_piece(self) -> None:
        """Fix a piece that had no length, and one whose length has changed."""
        piece = self.material.piece
        if not self.running:
            self.is_change_pending = False
        elif not piece.is_fixed:
            self.is_change_pending = False
            self.fix_piece(True)
        elif not can_change_pieces(self.material):
            self.is_change_pending = False
        elif piece.kind == PieceKind.PRODUCT:
            has_changed = self.material.has_changed()
            can_change = has_changed and self.can_fix()
            self.is_change_pending = has_changed and not (can_change and self.try_change_piece())

    def try_change_piece(self) -> bool:
        """Fix the product in progress anew, if its cut can still be reached: the curve to it is planned anew."""
        cut = changed_cut(self, self.predictions, self.material)
        if cut == UNLIMITED:
            return False
        if self.cycle.stage == Stage.WAITING:
            ramp_begin = self.predictions.ramp_up.way.ramp_up.begin
            travel = -(self.predictions.window.before + ramp_begin)
            can_reach = self.master.begin <= cut + ramp_begin + LATE * travel
        else:
            can_reach = self.can_leave_curve() and self.departure.try_cut(
                self.knife_data, self.predictions.window, cut, False
            )
        if can_reach:
            self.change_piece()
            if self.cycle.stage != Stage.WAITING:
                self.plan_way()
        return can_reach

    def can_leave_curve(self) -> bool:
        """Whether the knife may leave the curve on which it is; then the departure is from there."""
        stage = self.cycle.stage
        is_held = stage == Stage.DISENGAGING and (self.operation.is_stopping or self.hold)
        is_on_curve = stage in (Stage.ENGAGING, Stage.TURNING, Stage.DISENGAGING)
        if is_held or not is_on_curve or self.master.begin_velocity <= 0.0 or not self.cycle.can_append(2):
            return False
        self.departure.leave_curve(self.cycle, self.master)
        return True

    def change_piece(self) -> None:
        self.material.change_product()
        self.fixed.take_window(self.predictions)

    def watch_marks(self) -> None:
        """What the sensor sees, and does not see; marks that are missing or too many stop the machine."""
        was_fixed = self.material.piece.is_fixed
        self.material.watch_marks(self, self.operation.mark_edge.try_rise(self.mark.detected))
        show_marks(self, self.warning, self.local, self.material)
        if self.material.piece.is_fixed and not was_fixed:
            self.fixed.take_window(self.predictions)
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
        match self.cycle.stage:
            case Stage.RESTING:
                return False
            case Stage.PARKING:
                return self.try_event_parking()
            case _:
                return self.try_event_on_cycle()

    def try_event_parking(self) -> bool:
        """The knife arrives at park."""
        path = self.master.path
        motion = self.parking.motion
        time = path.due(motion.clock, motion.end_time())
        if time == NEVER:
            return False
        path.now = time
        self.arrive()
        return True

    def try_event_on_cycle(self) -> bool:
        """The knife comes to another section of its cycle, or what its present stage waits for happens."""
        path = self.master.path
        begin = path.positions[path.section]
        end = path.end
        cycle = self.cycle
        if end < begin:
            # On a measured line noise must not end a ramp that has hardly begun: before it the knife rests as well.
            begin_of_stage = cycle.begin
            if cycle.stage == Stage.ENGAGING:
                begin_of_stage -= min(self.master.uncertain_travel(), cycle.rest_before())
            if cycle.present > 0 and end < begin_of_stage:
                path.go_to(begin_of_stage)
                self.enter_section(cycle.present - 1)
                return True
        elif end > begin and not cycle.is_last():
            if end >= cycle.next_begin:
                path.go_to(cycle.next_begin)
                self.enter_section(cycle.present + 1)
                return True
            return False
        elif end > begin and cycle.stage == Stage.SYNCHRONOUS:
            return self.try_event_synchronous()
        return cycle.stage == Stage.WAITING and self.try_event_waiting()

    def try_event_synchronous(self) -> bool:
        """In the latest window: the cut, or the window's end."""
        place = self.planned_cut.end() if self.is_cut_made else self.planned_cut.place
        if self.master.path.end < place:
            return False
        self.master.path.go_to(place)
        if self.is_cut_made:
            self.leave_window()
        else:
            self.make_cut()
        return True

    def try_event_waiting(self) -> bool:
        """The machine rests for good, or a ramp up begins."""
        if self.operation.is_stopping:
            self.enter_resting()
            return True
        path = self.master.path
        travel = path.end - path.positions[path.section]
        if self.hold or self.is_blocked or travel < 0.0 or (path.is_correction() and travel == 0.0):
            return False
        if self.operation.is_cut_pending:  # by rounding of its position a line that runs back has a correction forwards
            return not self.master.goes_against(1.0) and self.try_requested_cut()
        return travel > 0.0 and self.material.piece.is_fixed and self.try_ramp()

    def try_ramp(self) -> bool:
        """The ramp up to the next cut begins, if the section of the path leads there."""
        piece = self.material.piece
        path = self.master.path
        begin = piece.end + self.fixed.ramp_begin
        if path.end < begin:
            return False
        path.go_to(begin)
        if piece.waits_for_line() and not (
            self.try_wait_for_line(self.fixed.ramp_velocity)
            and self.can_ramp_to(max(piece.end, path.reached - self.fixed.ramp_begin))
        ):
            return False
        self.begin_ramp()
        return True

    def can_ramp_to(self, cut: float) -> bool:
        """Whether a ramp up to the window of a cut would have a length from here on, where positions are rounded."""
        return cut - self.fixed.window.before - self.master.path.reached > SHORTEST_WAY

    def try_requested_cut(self) -> bool:
        """A cut_now at rest, as soon as the line is slow enough."""
        is_fixed = self.material.piece.is_fixed
        limit = self.fixed.ramp_velocity if is_fixed else self.predictions.ramp_up.max_line_velocity
        if not self.try_wait_for_line(limit):
            return False
        if not is_fixed:
            self.fixed.take_window(self.predictions)
        cut = self.master.path.reached - self.fixed.ramp_begin
        if self.operation.try_take_cut(self.material, cut, self.can_ramp_to(cut)):
            self.enter_engaging()
        return True

    def try_wait_for_line(self, limit: float) -> bool:
        """Go to the first instant on what is left of the section at which the line is no faster than the limit of a
        ramp, u/s; False: there is none."""
        master = self.master
        path = master.path
        greatest = limit * PUNCTUAL
        velocity = master.present_velocity()
        if velocity <= greatest:
            return True
        last = master.velocity_at(path.until)
        if last > greatest:
            return False
        time = path.now + (path.until - path.now) * ((velocity - greatest) / (velocity - last))
        path.now = max(path.now, min(time, path.until))
        path.reached = max(path.reached, min(path.position(path.now), path.end))
        return True

    # --- sections of the cycle ---

    def enter_section(self, index: int) -> None:
        """The knife comes to the next section of its cycle, or back to the one before."""
        is_forward = index > self.cycle.present
        self.reserve.leave(self.master.path.now)
        self.cycle.enter(index)
        if self.cycle.stage != Stage.WAITING:
            return
        self.reserve.wait(self.master.path.now)
        self.master.watch_travel()
        if self.operation.is_stopping:
            self.enter_resting()
        elif self.hold or not is_forward:
            self.cycle.cut_off()

    def begin_ramp(self) -> None:
        """The ramp up to the next cut begins, unless the line is too fast or it is too late."""
        piece = self.material.piece
        before = self.fixed.window.before
        begin = piece.end + self.fixed.ramp_begin
        travel = -(before + self.fixed.ramp_begin)
        earliest = self.master.path.reached - self.fixed.ramp_begin
        if not self.material.settings.has_cycle(self):
            self.is_blocked = True
            self.operation.refusal = PieceFault.TUNABLE
            return
        velocity = self.master.present_velocity()
        is_slow = velocity <= self.fixed.ramp_velocity * PUNCTUAL
        is_in_time = self.master.path.reached <= begin + LATE * travel and self.can_ramp_to(piece.end)
        if is_slow and is_in_time and piece.leaves_length(piece.end):
            self.enter_engaging()
        elif piece.waits_for_line():
            piece.end = earliest
            self.enter_engaging()
        elif is_slow and self.can_delay_cut(earliest):
            self.delay_cut(earliest)
            self.enter_engaging()
        elif self.material.settings.cycle.late_mode == LateMode.STOP_LINE:
            self.fail(PieceFault.CUT_MISSED)
        else:
            missing = max(self.master.path.reached - begin, 0.0) if is_slow else 0.0
            self.show_skipped_cut(SkipReason.RAMP if is_slow else SkipReason.LATE, missing)
            skip_cuts_before(self.material, earliest - LATE * travel, self.statistics)
            self.predictions.is_cycle_current = False

    def can_delay_cut(self, earliest: float) -> bool:
        """Whether a late cut out of rest is made at this position, u, as early as it can be."""
        is_late_mode = self.material.settings.cycle.late_mode == LateMode.LATE
        return is_late_mode and self.material.piece.leaves_length(earliest) and self.can_ramp_to(earliest)

    def enter_engaging(self) -> None:
        """The ramp up to the next cut begins."""
        knife = self.knife_data
        self.cycle.forget_old_sections(2, knife)
        self.departure.aim(self.fixed.window, self.material.piece.end)
        self.departure.way.plan_ramp_up(knife, self.master.path.reached, self.departure.cut)
        self.cycle.append_section(RAMP_UP, self.departure.way.ramp_up, self.cycle.blade)
        self.plan_window()
        var.copy(self.cycle_peaks, self.departure.way.peaks)
        self.enter_section(self.cycle.present + 1)

    def plan_window(self) -> None:
        """Append the window of the next cut to the cycle."""
        self.planned_cut.place = self.material.piece.end
        var.copy(self.planned_cut.window, self.fixed.window)
        self.is_cut_made = False
        self.cycle.append_window(self.planned_cut, self.next_blade())

    def next_blade(self) -> float:
        """The blade of the next cut."""
        is_over = self.cycle.stage == Stage.SYNCHRONOUS
        return self.blade_after(self.cycle.blade + 1.0) if is_over else self.cycle.blade

    def plan_way(self) -> None:
        """Plan the way to the next cut that the departure has found."""
        way = self.departure.way
        cycle = self.cycle
        blade = self.next_blade()
        knife = self.knife_data
        if way.parks:
            is_shortened = way.ramp_up.begin <= way.first.end and cycle.can_append(4)
            cycle.forget_old_sections(4 if is_shortened else 2, knife)
            cycle.append_section(RAMP_DOWN, way.first, blade)
            cycle.append_rest(way.first.end, blade, self.park_position())
            if is_shortened:
                cycle.append_section(RAMP_UP, way.ramp_up, blade)
                self.plan_window()
        else:
            cycle.forget_old_sections(2, knife)
            cycle.append_section(TURNING_ON, way.first, blade)
            self.plan_window()
        var.copy(self.cycle_peaks, self.departure.peaks)
        self.enter_section(cycle.present + 1)

    def plan_ramp_down(self) -> None:
        """Plan the ramp down to park, whatever the axis can do."""
        departure = self.departure
        blade = self.next_blade()
        departure.way.plan_ramp_down(self.knife_data, departure.begin, departure.point, 0.0)
        departure.include_leaving(departure.way.peaks)
        if not keeps_limits(self.knife_data, departure.way.peaks, departure.velocity):
            self.is_ramp_too_fast = True
        self.cycle.forget_old_sections(2, self.knife_data)
        self.cycle.append_section(RAMP_DOWN, departure.way.first, blade)
        self.cycle.append_rest(departure.way.first.end, blade, self.park_position())
        var.copy(self.cycle_peaks, departure.peaks)
        self.enter_section(self.cycle.present + 1)

    # --- cuts ---

    def make_cut(self) -> None:
        """The piece ends, and the next one starts."""
        self.is_cut_made = True
        self.is_ramp_too_fast = False
        self.is_change_pending = False
        self.is_cut_refused = False
        var.copy(self.last_window, self.planned_cut.window)
        self.has_last_window = True
        self.reserve.start_cut(self.master.path.now, self.fixed.is_late)
        time = self.block_clock.time + self.master.path.now
        record_piece(self, self.material, self.records, self.planned_cut.place, time, self.reserve.share)
        self.reserve.end_cut()
        self.predictions.is_cycle_current = False
        self.fix_piece(False)

    def leave_window(self) -> None:
        """At the end of a window: the way to the next cut is planned, or the ramp down."""
        departure = self.departure
        operation = self.operation
        piece = self.material.piece
        velocity = self.master.present_velocity()
        departure.leave_window(self.planned_cut, self.knife_data.spacing, velocity)
        has_to_rest = operation.is_stopping or self.hold
        if not has_to_rest:
            self.change_piece_in_window()
            if operation.is_cut_pending:
                operation.is_cut_pending = False
                if self.try_earlier_cut():
                    return
                self.is_cut_refused = True
        if has_to_rest or not piece.is_fixed:
            self.plan_ramp_down()
        elif piece.leaves_length(piece.end) and departure.try_cut(self.knife_data, self.fixed.window, piece.end, True):
            self.plan_way()
        else:
            self.act_on_late_cut()

    def change_piece_in_window(self) -> None:
        """Fix the product in progress anew where a change has come in the window after the cut."""
        material = self.material
        if not (self.is_change_pending and can_change_pieces(material) and material.has_changed()):
            return
        cut = changed_cut(self, self.predictions, self.material)
        if cut < UNLIMITED and self.departure.try_cut(self.knife_data, self.predictions.window, cut, True):
            self.change_piece()
            self.is_change_pending = False

    def act_on_late_cut(self) -> None:
        """The next cut cannot be reached from the window's end."""
        knife = self.knife_data
        piece = self.material.piece
        departure = self.departure
        late_mode = self.material.settings.cycle.late_mode
        if late_mode == LateMode.STOP_LINE:
            self.fail(PieceFault.CUT_MISSED)
        elif late_mode == LateMode.LATE and departure.try_earliest(
            knife, self.fixed.window, max(piece.end, piece.least_end())
        ):
            self.delay_cut(departure.cut.place)
            self.plan_way()
        else:
            self.show_skipped_cut(SkipReason.LATE, 0.0)
            if skip_to_reached_cut(departure, knife, self.fixed.window, self.material, self.statistics):
                self.plan_way()
            else:
                self.plan_ramp_down()
            self.predictions.is_cycle_current = False

    def delay_cut(self, cut: float) -> None:
        """The cut is made late, at this position of the master, u."""
        self.material.piece.end = cut
        self.fixed.is_late = True
        self.statistics.late = increased(self.statistics.late, 1.0)

    def show_skipped_cut(self, reason: SkipReason, missing_distance: float) -> None:
        """Show that the next cut is skipped, and why."""
        show_skipped_cut(self.local, reason, self.master, self.material.piece.end, missing_distance)

    def try_earlier_cut(self) -> bool:
        """A cut_now where the knife turns: the cut is made as early as it can be, if that is before it is due."""
        piece = self.material.piece
        departure = self.departure
        if not departure.velocity > 0.0:
            return False
        knife = self.knife_data
        least = max(departure.begin, piece.least_end())
        if piece.is_fixed:
            if not departure.try_earliest_turning(knife, self.fixed.window, least, piece.end):
                return False
            if not departure.cut.place < piece.end:
                return False
        else:
            window = self.predictions.window
            if not departure.try_earliest_turning(knife, window, least, UNLIMITED):
                return False
            self.fixed.take_window(self.predictions)
        if not self.material.try_fix_short(departure.cut.place):
            return False
        self.plan_way()
        return True

    # --- rest, park, faults ---

    def enter_resting(self) -> None:
        """The machine does not run any more; the knife is at park."""
        self.cycle.rest_at(Stage.RESTING, self.knife_data, self.cycle.blade, self.park_position())
        self.running = False
        self.is_blocked = False
        self.drop_piece()

    def fail(self, fault: int) -> None:
        """The machine stops for a fault: the knife parks."""
        self.operation.fail(fault)
        self.running = False
        self.leave_material()

    def leave_material(self) -> None:
        """The knife parks, by a motion of its own if it turns."""
        match self.cycle.stage:
            case Stage.RESTING | Stage.PARKING:
                pass
            case Stage.WAITING:
                self.enter_resting()
            case _:
                self.enter_parking()

    def enter_parking(self) -> None:
        """From the cycle to park."""
        self.reserve.leave(self.master.path.now)
        self.parking.plan(self.knife_data, self.cycle, self.master)
        self.cycle.stage = Stage.PARKING
        if self.operation.fault != PieceFault.NONE:
            self.drop_piece()

    def drop_piece(self) -> None:
        """The piece in progress ends without a cut, and so does what was to change it."""
        self.operation.is_cut_pending = False
        self.is_change_pending = False
        self.is_cut_refused = False
        self.material.piece.reset()

    def arrive(self) -> None:
        """The knife is at park."""
        knife = self.knife_data
        self.count_passed_places(self.parking.end)
        self.cycle.blade = self.blade_after(self.parking.blade + self.parking.turns_at_end(knife))
        self.enter_resting()

    def count_passed_places(self, position: float) -> None:
        """Count the places of cuts that the blades have passed out of sync, up to a position of the knife."""
        number = self.parking.places_passed(self.knife_data, position)
        if number > 0.0:
            self.parking.passed += number
            self.statistics.unsynchronised = increased(self.statistics.unsynchronised, number)
            self.local.skip_reason = SkipReason.PARKING

    def park_position(self) -> float:
        """Where the knife rests, counted from where the blade of the next cut cuts."""
        return self.knife_data.park_angle - self.knife_data.spacing

    def blade_after(self, blade: float) -> float:
        """The number of a blade, counted round the cylinder."""
        return wrap(blade, float(self.knife.blades))

    # --- what is put out ---

    def set_slave(self) -> None:
        """The knife's setpoint at the end of the step."""
        match self.cycle.stage:
            case Stage.RESTING | Stage.WAITING:
                last_blade = self.blade_after(self.cycle.blade - 1.0)
                self.slave.set(self.shown_position(last_blade, self.knife_data.park_angle), 0.0, 0.0, 0.0)
            case Stage.PARKING:
                position, velocity, acceleration, jerk = self.parking.motion.at(0.0)
                self.count_passed_places(position)
                self.slave.set(self.shown_position(self.parking.blade, position), velocity, acceleration, jerk)
            case _:
                position, d1, d2, d3 = self.cycle.at(self.master.end)
                velocity, acceleration, jerk = chain_rule(
                    d1, d2, d3, self.master.end_velocity, self.master.end_acceleration
                )
                self.slave.set(self.shown_position(self.cycle.blade, position), velocity, acceleration, jerk)

    def shown_position(self, blade: float, position: float) -> float:
        """The position of the cylinder, for one of the knife that counts from where that blade cuts."""
        return wrap(blade * self.knife_data.spacing + position, self.knife_data.turn)

    def show_motion(self) -> None:
        """The setpoint, and what is predicted from the motion of the line."""
        self.set_slave()
        self.update_predictions()
        stage = self.cycle.stage
        is_entering = stage == Stage.SYNCHRONOUS and not self.is_cut_made and self.cycle.is_last()
        show_piece(self, self.material, self.master.end)
        if self.next_cut.known and not is_entering:
            self.next_cut.distance = (self.material.piece.end - self.master.end) - self.fixed.window.before
        window = self.predictions.window
        self.local.coupling_factor = window.slope
        self.local.blade_spacing = self.knife_data.spacing
        self.local.edge_radius = window.radian if window.is_horizontal else 0.0
        show_line_request(self, self.limits, self.operation, self.material.settings.line.margin)
        show_peaks(self, self.cycle_peaks)

    def update_predictions(self) -> None:
        """The limits of the line: from the last cut to the one in progress, and on to the next."""
        stage = self.cycle.stage
        is_out_of_rest = (
            stage in (Stage.RESTING, Stage.WAITING, Stage.ENGAGING) and self.operation.fault == PieceFault.NONE
        )
        if not (self.running and self.material.piece.is_fixed):
            var.copy(self.fixed.window, self.predictions.window)
        if not self.has_last_window:
            var.copy(self.last_window, self.predictions.window)
        self.predictions.update(
            self, self.knife_data, self.material, self.last_window, self.fixed.window, is_out_of_rest
        )

    def show(self, before: float, h: float) -> None:
        """What is shown of the machine from the first step on; of h seconds, from the setpoint `before`."""
        show_state(self, self.cycle.stage, self.operation)
        missing = missing_length(self, self.predictions, self.material) if self.running else NoLength.NONE
        show_queues(self, self.local, self.material, missing)
        if self.cycle.stage in (Stage.RESTING, Stage.WAITING):
            self.exceeded.clear()
        else:
            self.exceeded.check_setpoint(self.axis_limits, self.slave)
        self.exceeded.check_way(self.axis_limits, self.slave, before, self.knife_data.turn, h, self.master)
        window = self.predictions.window
        greatest_slope = max(window.begin.d1, window.end.d1)
        self.warning.velocity = greatest_slope * self.master.end_velocity > self.axis.max_velocity
        self.warning.change_pending = self.is_change_pending or self.is_cut_refused
        show_warnings(self, self.limits, self.warning, self.local, self.exceeded)
        self.warning.limit_exceeded = self.warning.limit_exceeded or self.is_ramp_too_fast
        self.warning.any = self.warning.any or self.is_ramp_too_fast
        self.clock = self.block_clock.time

    def rebase(self) -> None:
        """Drop the master's whole turns from all positions."""
        turns = try_drop_turns(self.master, self.material)
        if turns != 0.0:
            self.cycle.rebase(turns)
            self.planned_cut.place -= turns
