"""CutToLength: material that never stops is cut to length by a saw that runs with it; axis and sequence in one block.

Source: what vendors' packages for cross cutters do has been collected and decided on. README.md tells the decisions.
"""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..cosine import cosine
from ..exceeded import Exceeded, Limit
from ..grid import floor, rounding, wrap
from ..laws import chain_rule
from ..limits import usable
from ..motion import SAME_TIME, stopping_distance
from ..var import Enumeration
from .books import Books, more
from .carriage import Carriage, gap_extremes, gap_keeps_limits
from .edges import Edges
from .faults import Fault, Refusal
from .interface import (
    ChangeMode,
    CutToLengthInterface,
    LateMode,
    PieceKind,
    Source,
    StartMode,
    State,
    ToolMode,
)
from .limits import Machine, approach_distance, is_admissible, lead, turning_acceleration
from .material import Material
from .piece import UNLIMITED
from .predictions import Predictions
from .settings import Settings, is_narrow
from .stage import Stage, state_of
from .tunables import Tunable
from .way_home import WayHome

NEVER = 1e300  # s since the step's beginning
LATE = 1.0 - 1e-9  # of the least way of an approach: with less, a start is late
FASTER = 1e-9  # of a velocity: by so much the line has become faster
NEARLY = 1e-9  # of an approach: what is missing to sync is rounding
WHOLE = 1e-12  # of a pitch: what a number of pitches may lack to be whole
IN_TIME = 1.0 - 1e-12  # of the time that is left: rounding must not make an eased way home too slow
LONG_AGO = -1e9  # s: the carriage has been at home since long before the initialization
MOST_PITCHES = 1e4  # that the master may travel in one step
MOST_EVENTS = 1000000  # in a piece of the path; so many never happen
BISECTIONS = 200  # this many halve any time down to neighbouring numbers
LEAST_FACTOR = 1e-6  # of a calibration


class Condition(Enumeration):
    """What an event waits for, at an instant of the step"""

    START = 0, "an approach to the next cut has to begin"
    ADMISSIBLE = 1, "the line does not go back, and the carriage can follow it"
    SYNC = 2, "the approach is over"
    BACK = 3, "the line has gone back to before the approach"
    COMMAND = 4, "the tool has to be commanded before sync"
    THROUGH = 5, "the cut's distance is travelled"
    PULLED = 6, "the gap is open"
    STROKE_END = 7, "the carriage has to stop before an end of its stroke"


@dataclass(slots=True)
class CutToLength(CutToLengthInterface):
    """A saw that cuts running material to length, with all that belongs to it.

    `start` sets the machine to work. It knows where the next cut lies, from the lengths of the orders, the input length
    or marks on the material; it starts the carriage so that it is in sync at the cut, commands the blade, keeps the
    books, and takes the carriage home. It tells what line velocity it can follow, and warns before a cut is missed.

    Everything happens at its own instant inside the step, so that the results do not depend on the step size.
    """

    # Not shown. Places are unwrapped positions of the master, u; times are in s.
    cosine: float = 1.0  # of diagonal_angle
    stage: Stage = Stage.RESTING
    fault: Fault = Fault.NONE  # why the machine has stopped
    refusal: Fault = Fault.NONE  # why the last command was refused
    begun: bool = False  # there has been a step
    stopping: bool = False  # the machine rests as soon as the carriage is at home
    cut_waits: bool = False  # a cut_now
    edges: Edges = var.part(Edges)
    good: Settings = var.part(Settings)
    bad: Tunable = Tunable.NONE  # the first tuned parameter that is out of its range
    material: Material = var.part(Material)
    predictions: Predictions = var.part(Predictions)
    books: Books = var.part(Books)
    exceeded: Exceeded = var.part(Exceeded)

    # The cycle under way.
    cycle: Machine = var.part(Machine)  # as it was when the approach began
    timeout: float = 0.0  # of the cut
    carriage: Carriage = var.part(Carriage)
    cut_place: float = 0.0  # the line of the cut passes carriage position 0 at this place
    cut_mu: float = 0.0  # how far the master is beyond cut_place when the blade begins to cut
    early: bool = False  # the blade has touched before sync
    reserve: float = 1.0  # share of the cycle that the carriage has spent ready at home
    waited: float = 0.0  # so long the carriage was ready at home before starts of this cycle
    first_cut: bool = True  # there has been no cut since start
    sync_time: float = 0.0  # the block's time
    clear_time: float = 0.0  # how long CLEARING lasts
    way_home: WayHome = var.part(WayHome)
    ready: bool = False  # the carriage has settled at home

    now: float = 0.0  # up to which all events are carried out, since the step's beginning
    block_clock: Clock = var.part(Clock)
    phase: Clock = var.part(Clock)  # since the stage began; at rest, since the arrival
    start_clock: Clock = var.part(Clock)  # since the last start of an approach
    cycle_clock: Clock = var.part(Clock)  # since the start of the last cut's approach
    ready_clock: Clock = var.part(Clock)  # since the carriage has been ready for a start
    tool_clock: Clock = var.part(Clock)  # since the tool's command has changed

    def initialize(self) -> Refusal:
        """The carriage rests at its initial position; may be called again while parameters still change.

        What the machine can do is put out, too; warnings come with the first step."""
        refusal = self.start_refusal()
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.way_home.rest_at(self.axis.initial_position)
        self.phase.start(LONG_AGO)
        self.edges.hold(self)
        self.use_settings()
        self.set_slave()
        self.predictions.put(self, self.good, self.material)
        self.show_piece()
        self.show_line()
        return Refusal.NONE

    def start_refusal(self) -> Refusal:
        """Why the start values contradict one another; NONE: they do not."""
        low = self.axis.min_position
        high = self.axis.max_position
        if not (low <= self.home_position and self.home_position <= high):
            return Refusal.HOME
        if not (low <= self.axis.initial_position and self.axis.initial_position <= high):
            return Refusal.INITIAL_POSITION
        return Refusal.NONE if is_narrow(self.mark) else Refusal.WINDOW

    def step(self, h: float) -> Refusal:
        """From t to t+h: the input correction, the commands, then the path of the step."""
        if self.running and self.master.longest_travel(h) > MOST_PITCHES * self.predictions.pitch_orders:
            return Refusal.TRAVEL
        if not self.master.try_advance(h):
            return Refusal.MASTER_TURNS
        self.travel(0)
        self.obey()
        for piece in range(1, self.master.path.pieces):
            self.travel(piece)
        self.advance_clocks(h)
        self.set_slave()
        self.show()
        self.rebase()
        self.begun = True
        return Refusal.NONE

    def advance_clocks(self, h: float) -> None:
        self.block_clock.advance(h)
        self.phase.advance(h)
        self.start_clock.advance(h)
        self.cycle_clock.advance(h)
        self.ready_clock.advance(h)
        self.tool_clock.advance(h)
        self.way_home.motion.advance(h)

    # --- the parameters ---

    def judge_settings(self) -> None:
        """Take over what was tuned, if it is good."""
        if self.bad != Tunable.NONE or not self.good.are_those_of(self):
            self.use_settings()

    def use_settings(self) -> None:
        """Compute with the present parameters, as far as they are good."""
        self.good.judge(self)
        self.bad = self.good.first_bad()
        self.describe_machine()

    def describe_machine(self) -> None:
        """Compute with the present factor of calibration."""
        self.good.describe(self.predictions.machine, self.calibration.factor, self.cosine)
        self.predictions.solved = False

    # --- the commands ---

    def obey(self) -> None:
        """Carry out the commands of the step, and what is looked at at each step's beginning."""
        self.now = 0.0
        self.judge_settings()
        self.obey_machine()
        self.obey_books()
        self.obey_orders()
        if self.edges.take_sample.try_rise(self.take_sample):
            self.accept()
            self.material.sample_waits = True
        self.watch_marks()
        if self.edges.cut_now.try_rise(self.cut_now):
            self.command_cut_now()
        if self.edges.done.try_rise(self.tool.done):
            self.command_done()
        self.watch_piece()
        self.watch_ease()

    def obey_machine(self) -> None:
        """reset, abort, stop, start."""
        auto = self.auto_start and not self.begun
        if self.edges.reset.try_rise(self.reset):
            self.command_reset()
        if self.edges.abort.try_rise(self.abort):
            self.command_abort()
        if self.edges.stop.try_rise(self.stop):
            self.command_stop()
        if self.edges.start.try_rise(self.start) or auto:
            self.command_start()

    def obey_books(self) -> None:
        """clear_statistics, calibration.reset, calibration.execute."""
        if self.edges.clear_statistics.try_rise(self.clear_statistics):
            self.accept()
            self.books.clear(self.statistics)
        if self.edges.calibration_reset.try_rise(self.calibration.reset):
            self.accept()
            self.calibrate(1.0)
        if self.edges.calibrate.try_rise(self.calibration.execute):
            self.command_calibrate()

    def obey_orders(self) -> None:
        """order.clear, order.skip, order.add."""
        if self.edges.order_clear.try_rise(self.order.clear):
            self.accept()
            self.material.clear_orders()
        if self.edges.order_skip.try_rise(self.order.skip):
            self.accept()
            self.material.skip_order()
        if self.edges.order_add.try_rise(self.order.add):
            self.command_add_order()

    def accept(self) -> None:
        """A command is carried out."""
        self.refusal = Fault.NONE

    def command_reset(self) -> None:
        """Clear what was refused, and the fault once the carriage rests; in motion the command does nothing."""
        if self.fault == Fault.NONE or self.stage == Stage.RESTING:
            self.fault = Fault.NONE
            self.refusal = Fault.NONE

    def command_abort(self) -> None:
        """Leave the material; the piece stays uncut."""
        if self.running:
            self.accept()
            self.stopping = True
            self.cut_waits = False
            self.leave_material()

    def command_stop(self) -> None:
        """Finish the cut under way; without one go home, or stay there."""
        if not self.running:
            return
        self.accept()
        self.stopping = True
        self.cut_waits = False
        if self.stage == Stage.WAITING:
            self.enter_resting()
        elif self.stage == Stage.RETURNING and self.way_home.eased:
            self.enter_returning()

    def command_start(self) -> None:
        """Set the machine to work."""
        if (
            self.running
            or self.stage != Stage.RESTING
            or self.fault != Fault.NONE
            or (self.start_mode == StartMode.CONTINUE and not self.material.has_cut)
        ):
            self.refusal = Fault.START
        elif not self.good.can_start():
            self.refusal = Fault.TUNABLE
        else:
            self.accept()
            self.set_to_work()

    def set_to_work(self) -> None:
        """Where the first piece begins is known; the carriage goes home, or waits there."""
        self.running = True
        self.stopping = False
        self.cut_waits = False
        self.first_cut = True
        self.waited = 0.0
        material = self.material
        material.piece.begin = material.last_place
        if self.start_mode != StartMode.CONTINUE:
            material.forget_marks()
            front = (
                self.good.front_position / self.predictions.machine.coupling + 0.5 * self.good.kerf / self.good.factor
            )
            material.piece.begin = self.master.begin - front
        if self.start_mode == StartMode.TRIM:
            material.crop(self, self.good)
        else:
            material.fix(self, self.good)
        if self.way_home.home == self.good.home_position:
            self.enter_waiting()
        else:
            self.enter_homing()

    def command_calibrate(self) -> None:
        """The last piece measured so long: the material's travel is corrected."""
        kerf = self.material.last_kerf
        material = self.material.measured_material(self.last.length)
        measured = self.calibration.measured_length
        if self.material.has_cut and measured > 0.0 and material > 0.0:
            factor = self.calibration.factor * ((measured + kerf) / material)
            if LEAST_FACTOR <= factor <= 1.0 / LEAST_FACTOR and usable(self.good.material_factor * factor):
                self.accept()
                self.calibrate(factor)
                return
        self.refusal = Fault.CALIBRATION

    def calibrate(self, factor: float) -> None:
        """The factor is in force from the next piece on."""
        self.calibration.factor = factor
        self.describe_machine()

    def command_add_order(self) -> None:
        """Append an order."""
        if not (self.order.length > 0.0 and self.order.quantity >= 1):
            self.refusal = Fault.ORDER
        elif self.material.orders.is_full():
            self.refusal = Fault.ORDERS_FULL
        else:
            self.accept()
            self.material.add_order(self.order.length, float(self.order.quantity))

    def command_cut_now(self) -> None:
        """Keep it until the carriage is ready at home."""
        if not self.running or self.stopping:
            self.refusal = Fault.CUT_NOW
        else:
            self.accept()
            self.cut_waits = True

    def command_done(self) -> None:
        """The cut is through; an earlier edge is lost."""
        if self.stage == Stage.CUTTING and self.tool.mode == ToolMode.FEEDBACK:
            self.end_cut()

    # --- the material ---

    def watch_marks(self) -> None:
        """What the sensor sees, and does not see; marks that are missing or too many stop the machine."""
        detected = self.edges.mark.try_rise(self.mark.detected)
        if self.running and self.source == Source.MARK:
            self.material.watch_marks(self, self.good, detected, self.master.begin, self.master.begin_velocity)
            if self.material.fault != Fault.NONE:
                self.fail(self.material.fault)

    def fix_piece(self) -> None:
        """Fix the piece that begins at the last cut, if that is possible."""
        if self.good.can_fix():
            self.material.fix(self, self.good)
        else:
            self.refusal = Fault.TUNABLE

    def watch_piece(self) -> None:
        """Look for a length where none was known, and for one that has changed."""
        piece = self.material.piece
        if not self.running:
            self.warning.change_pending = False
        elif not piece.known and self.good.can_fix():
            self.material.look_for_length(self, self.good)
        elif not piece.known:
            self.refusal = Fault.TUNABLE
        elif self.source == Source.MARK or self.good.change_mode != ChangeMode.THIS_PIECE:
            self.warning.change_pending = False
        elif piece.kind == PieceKind.PRODUCT:
            changed = self.material.has_changed(self, self.good)
            self.warning.change_pending = changed and not self.can_change()
            if changed and not self.warning.change_pending:
                self.material.change_product(self, self.good)

    def can_change(self) -> bool:
        """Whether the cut of the product in progress can still be reached if it is fixed anew."""
        if not self.good.can_fix() or self.stage in (Stage.APPROACHING, Stage.SYNCHRONOUS, Stage.CUTTING):
            return False
        pitch = self.material.changed_pitch(self, self.good)
        if pitch == UNLIMITED:
            return False
        machine = self.predictions.machine
        mu = self.beyond(self.material.piece.begin + pitch, 0.0)
        return machine.home_position - machine.coupling * mu >= lead(machine, self.master.begin_velocity)

    # --- the master's path ---

    def travel(self, piece: int) -> None:
        """Carry out the events on a piece of the path; on piece 0 those of the step's first instant."""
        path = self.master.path
        self.now = 0.0 if piece == 0 else path.times[piece]
        until = 0.0 if piece == 0 else path.times[piece + 1]
        for _ in range(MOST_EVENTS):
            if not self.try_event(until):
                break

    def try_event(self, until: float) -> bool:
        """Carry out the next event up to a time since the step's beginning; False: there is none."""
        happened = False
        match self.stage:
            case Stage.RESTING:
                pass
            case Stage.HOMING | Stage.RETURNING:
                happened = self.try_event_returning(until)
            case Stage.WAITING:
                happened = self.try_event_waiting(until)
            case Stage.APPROACHING:
                happened = self.try_event_approaching(until)
            case Stage.SYNCHRONOUS:
                happened = self.try_event_synchronous(until)
            case Stage.CUTTING:
                happened = self.try_event_cutting(until)
            case Stage.PULLING:
                happened = self.try_event_pulling(until)
            case Stage.CLEARING:
                happened = self.try_event_clearing(until)
        return happened

    def beyond(self, place: float, time: float) -> float:
        """How far the master is beyond a place, at a time since the step's beginning, u."""
        path = self.master.path
        return (path.origin - place) + time * (path.velocity + time * (path.c2 + time * path.c3))

    def due(self, clock: Clock, length: float, until: float) -> float:
        """When a clock has come to a time, since the step's beginning; NEVER: not up to `until`."""
        if clock.time + until < length * SAME_TIME:
            return NEVER
        return max(self.now, min(length - clock.time, until))

    def first(self, condition: Condition, until: float) -> float:
        """The first instant from now on at which a condition holds, since the step's beginning; NEVER: none up to
        `until`. It is bisected down to rounding."""
        if self.holds(condition, self.now):
            return self.now
        if until <= self.now or not self.holds(condition, until):
            return NEVER
        low = self.now
        high = until
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if middle <= low or middle >= high:
                break
            if self.holds(condition, middle):
                high = middle
            else:
                low = middle
        return high

    def holds(self, condition: Condition, time: float) -> bool:
        """Whether a condition holds at a time since the step's beginning."""
        velocity = self.master.velocity_at(time)
        mu = self.beyond(self.cut_place, time)
        carriage = self.carriage
        holds = False
        match condition:
            case Condition.START:
                holds = self.start_is_due(velocity, time)
            case Condition.ADMISSIBLE:
                holds = velocity >= 0.0 and is_admissible(self.predictions.machine, velocity)
            case Condition.SYNC:
                holds = mu >= carriage.sync
            case Condition.BACK:
                holds = velocity < 0.0 and mu < carriage.start
            case Condition.COMMAND:
                holds = mu + velocity * (self.cycle.on_delay - self.cycle.settle_time) >= carriage.sync
            case Condition.THROUGH:
                holds = carriage.coupling * (mu - self.cut_mu) >= self.cycle.cut_distance
            case Condition.PULLED:
                holds = mu >= carriage.gap_end
            case Condition.STROKE_END:
                holds = self.has_to_stop(time)
        return holds

    def start_is_due(self, velocity: float, time: float) -> bool:
        """Whether the line moves on, and the next cut's line is where the approach to it begins."""
        if velocity < 0.0 or (velocity == 0.0 and self.master.mean_acceleration() <= 0.0):
            return False
        if not self.reaches_start(velocity, time):
            return False
        return not self.material.piece.waits_for_line() or is_admissible(self.predictions.machine, velocity)

    def reaches_start(self, velocity: float, time: float) -> bool:
        """Whether the next cut's line is where an approach to it begins, or beyond that."""
        machine = self.predictions.machine
        travel = machine.coupling * self.beyond(self.material.piece.end, time)
        return travel >= self.way_home.home - approach_distance(machine, velocity)

    def is_far_from_start(self, until: float) -> bool:
        """Whether no start can be due up to a time since the step's beginning: it spares the search for one.

        The approach is no longer than predicted on a line no faster than then, and else than that of a faster line."""
        begin = self.master.begin_velocity
        end = self.master.end_velocity
        fastest = max(begin, end)
        machine = self.predictions.machine
        distance = self.local.approach_distance
        if not self.predictions.solved or fastest > self.predictions.velocity:
            distance = approach_distance(machine, fastest + FASTER * (abs(begin) + abs(end)))
        place = self.material.piece.end
        mu = max(self.beyond(place, self.now), self.beyond(place, until))
        return machine.coupling * mu < self.way_home.home - distance

    def is_far_from_ends(self, until: float) -> bool:
        """Whether the carriage, in sync, need not stop for an end of its stroke up to a time since the step begins: it
        spares the search for the instant. The bound of the way of a stop is a rough one."""
        if not self.carriage.joined:
            return False
        k = self.carriage.coupling
        down = turning_acceleration(self.predictions.machine)
        jerk = self.predictions.machine.homing_jerk
        speed = k * max(abs(self.master.begin_velocity), abs(self.master.end_velocity))
        change = k * abs(self.master.end_velocity - self.master.begin_velocity)
        ahead = 0.0
        if self.carriage.pulls:
            ahead = self.carriage.gap
            step = self.master.step
            speed, acceleration = gap_extremes(speed, change / step, ahead, self.cycle.gap_travel)
            change = acceleration * step
        if change > down * self.master.step:
            return False
        first = k * self.beyond(self.cut_place, self.now)
        last = k * self.beyond(self.cut_place, until)
        axis = self.good.axis
        room = min(min(first, last) - axis.min_position, axis.max_position - ahead - max(first, last))
        # With F = jerk speed + down^2 / 2 the way is below F (F / 2 + 3 down^2) / (down jerk^2).
        fast = jerk * speed + 0.5 * down * down
        return room * down * jerk * jerk > fast * (0.5 * fast + 3.0 * down * down)

    def has_to_stop(self, time: float) -> bool:
        """Whether the time-optimal stop from here ends at an end of the stroke, or beyond it."""
        position, velocity, acceleration, _ = self.carriage_at(time)
        down = turning_acceleration(self.predictions.machine)
        end = position + stopping_distance(velocity, acceleration, down, self.predictions.machine.homing_jerk)
        if velocity > 0.0 or (velocity == 0.0 and acceleration > 0.0):
            return end >= self.good.axis.max_position
        return (velocity < 0.0 or acceleration < 0.0) and end <= self.good.axis.min_position

    def carriage_at(self, time: float) -> tuple[float, float, float, float]:
        """The carriage's setpoint on its curve over the master, at a time since the step's beginning."""
        position, d1, d2, d3 = self.carriage.at(self.beyond(self.cut_place, time))
        velocity, acceleration, jerk = chain_rule(
            d1, d2, d3, self.master.velocity_at(time), self.master.mean_acceleration()
        )
        return position, velocity, acceleration, jerk

    # --- the events of each stage ---

    def try_event_returning(self, until: float) -> bool:
        """The carriage arrives, or has halted to come home with ease."""
        time = self.due(self.way_home.motion.clock, self.way_home.motion.end(), until)
        if time == NEVER:
            return False
        self.now = time
        if self.way_home.halting:
            self.way_home.go_on(self.predictions.machine, time)
        else:
            self.arrive()
        return True

    def try_event_waiting(self, until: float) -> bool:
        """The carriage has settled, or an approach begins."""
        if not self.ready:
            return self.try_settle(until)
        if self.hold:
            return False
        if self.cut_waits:
            time = self.first(Condition.ADMISSIBLE, until)
        elif self.material.piece.known and not self.is_far_from_start(until):
            time = self.first(Condition.START, until)
        else:
            return False
        if time == NEVER:
            return False
        if self.good.bad_machine != Tunable.NONE:
            self.refusal = Fault.TUNABLE
            return False
        crossed = not self.reaches_start(self.master.velocity_at(self.now), self.now)
        self.now = time
        if self.cut_waits:
            self.begin_cut_now()
        else:
            self.begin_cut(crossed, until)
        return True

    def try_settle(self, until: float) -> bool:
        """The carriage has rested at home for long enough."""
        time = self.due(self.phase, self.good.homing.settle_time, until)
        if time == NEVER:
            return False
        self.now = time
        self.ready = True
        self.ready_clock.start(time)
        return True

    def try_event_approaching(self, until: float) -> bool:
        """The tool is commanded, the blade touches, sync is reached, or the line goes back."""
        if self.try_tool_before_sync(until):
            return True
        back = self.first(Condition.BACK, until)
        if back != NEVER:
            self.now = back
            self.go_back()
            return True
        sync = self.first(Condition.SYNC, until)
        if sync == NEVER:
            return False
        self.now = sync
        self.enter_synchronous()
        return True

    def try_tool_before_sync(self, until: float) -> bool:
        """Carry out what the tool does before sync, if it comes first."""
        time = NEVER
        if not self.tool.command:
            if self.cycle.on_delay > self.cycle.settle_time:
                time = self.first(Condition.COMMAND, until)
        elif not self.tool.blade_down:
            time = self.due(self.tool_clock, self.cycle.on_delay, until)
        if time == NEVER:
            return False
        if self.first(Condition.SYNC, time) < time or self.first(Condition.BACK, time) < time:
            return False
        if self.tool.command and self.is_nearly_in_sync(time):
            return False  # the blade touches in sync
        self.now = time
        if self.tool.command:
            self.tool.blade_down = True
            self.early = True
            self.warning.blade_early = True
            self.statistics.unsynchronised = more(self.statistics.unsynchronised, 1.0)
        else:
            self.set_tool(True)
        return True

    def is_nearly_in_sync(self, time: float) -> bool:
        """Whether sync lies ahead by rounding only, at a time since the step's beginning."""
        missing = self.carriage.sync - self.beyond(self.cut_place, time)
        travel = self.carriage.sync - self.carriage.start
        return missing <= NEARLY * travel + rounding(self.cut_place, self.master.end)

    def try_event_synchronous(self, until: float) -> bool:
        """The tool is commanded, the blade touches, the cut begins, or the stroke ends."""
        touch = NEVER
        if not self.tool.command:
            time = self.due(self.phase, max(self.cycle.settle_time - self.cycle.on_delay, 0.0), until)
        else:
            touch = self.due(self.tool_clock, self.cycle.on_delay, until)
            settled = self.due(self.phase, self.cycle.settle_time, until)
            time = max(touch, settled)
            if not self.tool.blade_down and touch < settled:
                time = touch
        if self.try_end_of_stroke(min(time, until), time):
            return True
        if time == NEVER:
            return False
        self.now = time
        if not self.tool.command:
            self.set_tool(True)
        elif touch == time and not self.tool.blade_down and self.due(self.phase, self.cycle.settle_time, time) == NEVER:
            self.tool.blade_down = True
        else:
            self.enter_cutting()
        return True

    def try_event_cutting(self, until: float) -> bool:
        """The cut is through, the tool does not answer, or the stroke ends."""
        time = NEVER
        match self.tool.mode:
            case ToolMode.TIME:
                time = self.due(self.phase, self.cycle.cut_time, until)
            case ToolMode.DISTANCE:
                time = self.first(Condition.THROUGH, until)
            case _:
                if self.timeout > 0.0:
                    time = self.due(self.phase, self.timeout, until)
        if self.try_end_of_stroke(min(time, until), time):
            return True
        if time == NEVER:
            return False
        self.now = time
        if self.tool.mode == ToolMode.FEEDBACK:
            self.fail(Fault.TOOL_TIMEOUT)
        else:
            self.end_cut()
        return True

    def try_event_pulling(self, until: float) -> bool:
        """The gap is open, or the stroke ends."""
        time = self.first(Condition.PULLED, until)
        if self.try_end_of_stroke(min(time, until), time):
            return True
        if time == NEVER:
            return False
        self.now = time
        self.set_tool(False)
        self.enter_clearing(self.cycle.retract_time)
        return True

    def try_event_clearing(self, until: float) -> bool:
        """The blade is clear, sync is reached after all, or the stroke ends."""
        time = self.due(self.phase, self.clear_time, until)
        if not self.carriage.joined:
            sync = self.first(Condition.SYNC, min(time, until))
            if sync != NEVER:
                self.now = sync
                self.carriage.joined = True
                return True
        if self.try_end_of_stroke(min(time, until), time):
            return True
        if time == NEVER:
            return False
        self.now = time
        self.tool.blade_down = False
        self.enter_returning()
        return True

    def try_end_of_stroke(self, until: float, other: float) -> bool:
        """The carriage has to stop before an end of its stroke, earlier than the other event comes."""
        time = NEVER if self.is_far_from_ends(until) else self.first(Condition.STROKE_END, until)
        if time == NEVER or time >= other:
            return False
        self.now = time
        if self.tool.blade_down:
            self.statistics.unsynchronised = more(self.statistics.unsynchronised, 1.0)
        if self.fault == Fault.NONE:
            self.stop_for(Fault.STROKE)
        self.set_tool(False)
        self.enter_returning()
        return True

    # --- cuts begin and end ---

    def begin_cut(self, crossed: bool, until: float) -> None:
        """The next cut's line is where an approach to it begins, or beyond that: begin it, or say that it is late."""
        velocity = self.master.velocity_at(self.now)
        machine = self.predictions.machine
        piece = self.material.piece
        least = lead(machine, velocity)
        mu = self.beyond(piece.end, self.now)
        distance = self.way_home.home - machine.coupling * mu
        waits = piece.waits_for_line()
        if crossed and not waits:
            distance = approach_distance(machine, velocity)  # the same, without the rounding of places
        if not (waits or is_admissible(machine, velocity)):
            self.pass_cuts(until)
        elif distance >= least * LATE:
            self.enter_approaching(distance, False)
        elif waits or self.good.late_mode == LateMode.LATE:
            self.statistics.late = more(self.statistics.late, 0.0 if waits else 1.0)
            self.move_cut(mu, least)
            self.enter_approaching(least, True)
        else:
            self.miss_cut(mu, least)

    def begin_cut_now(self) -> None:
        """Cut where the carriage can be in sync first."""
        piece = self.material.piece
        self.cut_waits = False
        if not piece.known:
            self.material.measure(self, self.good)
        piece.known = True
        piece.kind = PieceKind.SHORT
        piece.end = self.master.begin
        least = lead(self.predictions.machine, self.master.velocity_at(self.now))
        self.move_cut(self.beyond(piece.end, self.now), least)
        self.enter_approaching(least, False)

    def move_cut(self, mu: float, distance: float) -> None:
        """The cut, whose line is at mu, goes to where an approach of a distance begins now."""
        self.material.piece.end += mu - (self.way_home.home - distance) / self.predictions.machine.coupling

    def miss_cut(self, mu: float, least: float) -> None:
        """The cut, whose line is at mu, cannot be reached: stop for that, or end the piece with a later cut."""
        if self.good.late_mode == LateMode.STOP_LINE:
            self.fail(Fault.CUT_MISSED)
        elif self.source == Source.MARK:
            self.skip_marks(least)
        else:
            self.skip_pitches(mu, self.way_home.home - least)

    def pass_cuts(self, until: float) -> None:
        """The carriage cannot follow so fast a line: stop for that, or leave out all cuts that are due before the line
        is slow enough, up to a time since the step's beginning."""
        velocity = self.master.velocity_at(self.now)
        machine = self.predictions.machine
        if self.good.late_mode == LateMode.STOP_LINE:
            self.fail(Fault.STROKE)
        elif self.source == Source.MARK:
            self.skip_marks(lead(machine, velocity))
        else:
            self.now = min(self.first(Condition.ADMISSIBLE, until), until)
            velocity = self.master.velocity_at(self.now)
            mu = self.beyond(self.material.piece.end, self.now)
            self.skip_pitches(mu, self.way_home.home - approach_distance(machine, velocity))

    def skip_pitches(self, mu: float, position: float) -> None:
        """The cut, whose line is at mu, is left out, and all others whose lines are ahead of that carriage position."""
        piece = self.material.piece
        k = self.predictions.machine.coupling
        number = max(1.0, -floor(WHOLE - (k * mu - position) / (k * piece.pitch)))
        piece.kind = PieceKind.MERGED
        piece.end += number * piece.pitch
        self.statistics.skipped = more(self.statistics.skipped, number)

    def skip_marks(self, least: float) -> None:
        """Drop the marks whose cuts cannot be reached, the next one in any case."""
        material = self.material
        material.piece.kind = PieceKind.MERGED
        for _ in range(material.marks.waiting):
            material.drop_mark()
            self.statistics.skipped = more(self.statistics.skipped, 1.0)
            if material.marks.waiting > 0:
                mu = self.beyond(material.marks.place(0), self.now)
                if self.predictions.machine.coupling * mu <= self.way_home.home - least * LATE:
                    break
        material.piece.known = material.marks.waiting > 0
        if material.piece.known:
            material.piece.end = material.marks.place(0)
        else:
            material.piece.pitch = UNLIMITED

    def enter_approaching(self, distance: float, late: bool) -> None:
        """The carriage starts now and is in sync after its own travel `distance`."""
        var.copy(self.cycle, self.predictions.machine)
        self.timeout = self.good.tool.timeout
        self.carriage.lay_approach(self.cycle.coupling, self.way_home.home, distance)
        self.cut_place = self.material.piece.end
        self.waited += self.ready_clock.time + self.now
        self.judge_reserve(late)
        self.early = False
        self.start_clock.start(self.now)
        self.local.start_time = self.block_clock.time + self.now
        self.stage = Stage.APPROACHING
        if self.is_nearly_in_sync(self.now):  # the line stands where the cut is, or nearly so
            self.enter_synchronous()

    def judge_reserve(self, late: bool) -> None:
        """The share of its cycle that the carriage has spent at home, ready for this start."""
        if self.first_cut:
            self.reserve = 1.0
        elif late:
            self.reserve = 0.0
        else:
            since_start = self.cycle_clock.time + self.now
            self.reserve = max(0.0, min(self.waited / since_start, 1.0)) if since_start > 0.0 else 1.0

    def end_cut(self) -> None:
        """The blade is through: the piece ends, and the next one begins."""
        self.keep_books()
        self.warning.gap_skipped = False
        velocity = self.master.velocity_at(self.now)
        if self.cycle.gap_distance > 0.0:
            k = self.cycle.coupling
            if velocity > 0.0 and gap_keeps_limits(
                k * velocity, self.cycle.gap_distance, self.cycle.gap_travel, self.good.axis
            ):
                self.enter_pulling()
                return
            self.warning.gap_skipped = True
        self.set_tool(False)
        self.enter_clearing(self.cycle.retract_time)

    def keep_books(self) -> None:
        """Enter the piece that the cut has ended, and fix the next one."""
        piece = self.material.piece
        length = piece.length(self.cut_place)
        error = length - piece.ordered if piece.exact else 0.0
        good = piece.kind == PieceKind.PRODUCT and abs(error) <= self.good.length_tolerance
        self.last.length = length
        self.last.error = error
        self.last.kind = piece.kind
        self.last.good = good
        self.warning.change_pending = False
        self.last.time = self.sync_time
        self.last.reserve = self.reserve
        self.first_cut = False
        self.waited = 0.0
        var.copy(self.cycle_clock, self.start_clock)
        self.books.enter(self.statistics, piece.kind, good, length, error, self.reserve)
        self.batch_done = False
        if good:
            self.count_good()
        self.material.end_piece(self, self.cut_place)
        self.fix_piece()

    def count_good(self) -> None:
        """A good piece counts for its order and for the batch."""
        if self.material.try_fulfil_order(self.order.repeat):
            self.order.completed = more(self.order.completed, 1.0)
        if self.good.batch_size > 0:
            self.batch_count += 1
            if self.batch_count >= self.good.batch_size:
                self.batch_count = 0
                self.batches = more(self.batches, 1.0)
                self.batch_done = True

    # --- the stages are entered ---

    def enter_resting(self) -> None:
        """The machine does not run any more."""
        self.stage = Stage.RESTING
        self.running = False
        self.warning.change_pending = False
        self.material.piece.forget()

    def enter_waiting(self) -> None:
        """At home until the start point."""
        self.stage = Stage.WAITING
        self.ready = False

    def enter_homing(self) -> None:
        """From rest to home."""
        self.stage = Stage.HOMING
        self.way_home.plan(self.predictions.machine, self.now, self.way_home.home, 0.0, 0.0)

    def enter_synchronous(self) -> None:
        self.stage = Stage.SYNCHRONOUS
        self.carriage.joined = True
        self.phase.start(self.now)
        self.sync_time = self.block_clock.time + self.now

    def enter_cutting(self) -> None:
        self.stage = Stage.CUTTING
        self.phase.start(self.now)
        self.cut_mu = self.beyond(self.cut_place, self.now)
        self.tool.blade_down = True
        self.warning.blade_early = self.early

    def enter_pulling(self) -> None:
        self.stage = Stage.PULLING
        mu = self.beyond(self.cut_place, self.now)
        self.carriage.lay_gap(mu, self.cycle.gap_distance, self.cycle.gap_travel)

    def enter_clearing(self, time: float) -> None:
        """The carriage stays on its curve for so long."""
        self.stage = Stage.CLEARING
        self.phase.start(self.now)
        self.clear_time = time

    def enter_returning(self) -> None:
        """From any motion to home; from the material with ease, if there is time for it."""
        machine = self.predictions.machine
        if self.stage in (Stage.RETURNING, Stage.HOMING):
            position, velocity, acceleration, _ = self.way_home.at(self.now)
            self.way_home.plan(machine, self.now, position, velocity, acceleration)
        else:
            position, velocity, acceleration, _ = self.carriage_at(self.now)
            self.way_home.plan(machine, self.now, position, velocity, acceleration)
            if self.may_ease():
                time = self.time_to_home()
                slowest = self.good.homing.slowest
                self.way_home.ease(machine, slowest, self.now, position, velocity, acceleration, time)
                self.way_home.eased_velocity = self.master.velocity_at(self.now)
                self.way_home.eased_place = self.material.piece.end
        self.stage = Stage.RETURNING

    def may_ease(self) -> bool:
        """Whether the next cut is known, and the line comes to it without getting faster."""
        if self.stopping or self.cut_waits or not (self.running and self.homing.ease and self.material.piece.known):
            return False
        return self.master.velocity_at(self.now) > 0.0 and not self.line_accelerates()

    def line_accelerates(self) -> bool:
        """Whether the line gets faster in the present step."""
        begin = self.master.begin_velocity
        return self.master.end_velocity - begin > FASTER * abs(begin)

    def time_to_home(self) -> float:
        """How long the way home may take, s, at the line's present velocity, which is above 0."""
        machine = self.predictions.machine
        velocity = self.master.velocity_at(self.now)
        start = (machine.home_position - approach_distance(machine, velocity)) / machine.coupling
        time = (start - self.beyond(self.material.piece.end, self.now)) / velocity
        return time * IN_TIME - machine.homing_settle_time - self.good.homing.spare_time

    def watch_ease(self) -> None:
        """Hurry home where there is no time for ease any more."""
        if self.stage == Stage.RETURNING and self.way_home.eased:
            piece = self.material.piece
            if (
                self.cut_waits
                or not piece.known
                or self.line_accelerates()
                or self.master.begin_velocity > self.way_home.eased_velocity * (1.0 + FASTER)
                or piece.end != self.way_home.eased_place
            ):
                self.enter_returning()

    def arrive(self) -> None:
        """The carriage is at home."""
        self.phase.start(self.now)
        self.local.home_time = self.block_clock.time + self.now
        self.way_home.rest_at(self.way_home.home)
        if self.stopping or self.fault != Fault.NONE:
            self.enter_resting()
        else:
            self.enter_waiting()

    def go_back(self) -> None:
        """The line has gone back to before the approach: the carriage is at home at rest again."""
        self.set_tool(False)
        self.tool.blade_down = False
        if self.stopping:
            self.phase.start(self.now)
            self.enter_resting()
        else:
            self.enter_waiting()
            self.ready = True
            self.ready_clock.start(self.now)

    def set_tool(self, command: bool) -> None:
        """The tool's command, if it changes."""
        if self.tool.command != command:
            self.tool.command = command
            self.tool.command_time = self.block_clock.time + self.now
            self.tool_clock.start(self.now)

    def fail(self, fault: Fault) -> None:
        """The machine stops for a fault: the carriage leaves the material and comes home."""
        self.stop_for(fault)
        self.leave_material()

    def stop_for(self, fault: Fault) -> None:
        """Nothing goes on but the way home."""
        self.fault = fault
        self.running = False
        self.cut_waits = False

    def leave_material(self) -> None:
        """With the blade down the carriage stays on its curve until that is clear; then, or else, it goes home."""
        self.set_tool(False)
        match self.stage:
            case Stage.WAITING:
                self.enter_resting()
            case Stage.APPROACHING | Stage.SYNCHRONOUS | Stage.CUTTING | Stage.PULLING:
                if self.tool.blade_down:
                    self.enter_clearing(self.cycle.retract_time)
                else:
                    self.enter_returning()
            case Stage.HOMING:
                self.enter_returning()
            case Stage.RETURNING:
                if self.way_home.eased:
                    self.enter_returning()
            case _:
                pass

    # --- what is put out ---

    def set_slave(self) -> None:
        """The carriage's setpoint at the end of the step."""
        match self.stage:
            case Stage.RESTING | Stage.WAITING:
                self.slave.put(self.way_home.home, 0.0, 0.0, 0.0)
            case Stage.HOMING | Stage.RETURNING:
                position, velocity, acceleration, jerk = self.way_home.at(0.0)
                self.slave.put(position, velocity, acceleration, jerk)
            case _:
                position, d1, d2, d3 = self.carriage.at(self.master.end - self.cut_place)
                velocity, acceleration, jerk = chain_rule(
                    d1, d2, d3, self.master.end_velocity, self.master.end_acceleration
                )
                self.slave.put(position, velocity, acceleration, jerk)

    def show(self) -> None:
        self.show_state()
        self.show_tool()
        self.predictions.put(self, self.good, self.material)
        self.show_piece()
        self.show_orders()
        self.show_line()
        self.show_warnings()
        self.clock = self.block_clock.time

    def show_state(self) -> None:
        self.error_id = self.fault if self.fault != Fault.NONE else self.refusal
        self.error = self.error_id != Fault.NONE
        if self.fault != Fault.NONE:
            self.state = State.FAULT
        else:
            self.state = state_of(self.stage)
        self.state_code = self.state
        self.in_sync = self.state in (State.SYNCHRONOUS, State.CUTTING) or (
            self.state == State.CLEARING and self.carriage.joined and not self.carriage.pulls
        )

    def show_tool(self) -> None:
        """The blade is clear some time after its command has ended, wherever the carriage is."""
        self.tool.cutting = self.stage == Stage.CUTTING and self.fault == Fault.NONE
        if self.tool.blade_down and not self.tool.command and self.stage != Stage.CLEARING:
            self.tool.blade_down = self.tool_clock.time < self.cycle.retract_time

    def show_piece(self) -> None:
        """The piece in progress and its cut."""
        piece = self.material.piece
        k = self.predictions.machine.coupling
        if self.is_on_curve():
            k = self.carriage.coupling
        self.local.coupling_factor = k
        self.piece.kind = PieceKind.NONE
        self.piece.ordered = 0.0
        self.piece.length = 0.0
        if self.running:
            self.piece.length = max(piece.length(self.master.end - self.slave.position / k), 0.0)
        self.next_cut.known = self.running and piece.known
        self.next_cut.position = 0.0
        self.next_cut.distance = 0.0
        self.local.start_position = 0.0
        self.local.progress = 0.0
        if self.next_cut.known:
            self.piece.kind = piece.kind
            self.piece.ordered = piece.ordered
            self.next_cut.position = wrap(piece.end, self.master.period)
            self.show_approach(self.master.end - piece.end)

    def is_on_curve(self) -> bool:
        """Whether the carriage follows its curve over the master."""
        return self.stage not in (Stage.RESTING, Stage.HOMING, Stage.WAITING, Stage.RETURNING)

    def show_approach(self, mu: float) -> None:
        """How far the approach to the next cut, whose line is at mu, lies ahead or is done."""
        k = self.predictions.machine.coupling
        home = self.predictions.machine.home_position
        distance = self.local.approach_distance
        self.local.start_position = wrap(self.material.piece.end + (home - distance) / k, self.master.period)
        match self.stage:
            case Stage.APPROACHING:
                self.next_cut.distance = max(self.carriage.sync - mu, 0.0)
                self.local.progress = self.carriage.progress(mu)
            case Stage.SYNCHRONOUS | Stage.CUTTING:
                self.local.progress = 1.0
            case _:
                self.next_cut.distance = (home + distance) / k - mu

    def show_orders(self) -> None:
        orders = self.material.orders
        self.order.waiting = orders.waiting
        self.order.remaining = int(orders.lacking())
        self.order.length_active = orders.length(0) if orders.waiting > 0 else 0.0
        self.local.marks_waiting = self.material.marks.waiting
        self.local.ease = self.way_home.share

    def show_line(self) -> None:
        """What the machine asks of the line."""
        self.line.stop_request = self.fault != Fault.NONE
        self.line.velocity_request = 0.0
        if self.fault == Fault.NONE:
            admissible = (1.0 - self.good.margin) * self.limits.max_line_velocity
            self.line.velocity_request = min(self.line.wanted_velocity, admissible)

    def show_warnings(self) -> None:
        velocity = self.master.end_velocity
        warning = self.warning
        warning.line_too_fast = velocity > self.limits.max_line_velocity
        warning.orders_too_fast = velocity > self.limits.max_line_velocity_orders
        machine = self.predictions.machine
        warning.stroke = machine.home_position + self.limits.stroke > machine.max_position
        warning.velocity = machine.coupling * velocity > machine.max_velocity
        warning.no_length = self.running and self.source == Source.LENGTH and not self.next_cut.known
        if self.stage in (Stage.RESTING, Stage.WAITING):
            self.exceeded.clear()
        else:
            self.exceeded.judge_setpoint(self.axis, self.slave)
        warning.limit_exceeded = self.exceeded.limit != Limit.NONE
        self.local.exceeded_limit = self.exceeded.limit
        self.local.exceeded_value = self.exceeded.value
        self.local.refused_parameter = self.bad
        warning.any = (
            warning.line_too_fast
            or warning.limit_exceeded
            or warning.orders_too_fast
            or warning.stroke
            or warning.velocity
            or warning.blade_early
            or warning.gap_skipped
            or warning.mark_missing
            or warning.mark_outside
            or warning.no_length
            or warning.change_pending
        )

    def rebase(self) -> None:
        """Drop the master's whole turns from all places."""
        if self.master.period > 0.0:
            before = self.master.end
            self.master.rebase()
            turns = before - self.master.end
            if turns != 0.0:
                self.material.shift(turns)
                self.way_home.eased_place -= turns
                self.cut_place -= turns
