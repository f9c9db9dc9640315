"""CutToLength: material that never stops is cut to length by a saw that runs with it; axis and sequence in one block.

Source: what vendors' packages for cross cutters do has been collected and decided on. README.md tells the decisions.
"""

from dataclasses import dataclass

from .. import var
from ..clock import Clock
from ..cosine import cosine
from ..exceeded import Exceeded, Limit
from ..grid import floor, nearest, wrap
from ..laws import chain_rule
from ..limits import usable
from ..motion import SAME_TIME, Motion, stopping_distance
from ..slave import Edge
from ..var import Enumeration
from .books import Books, more
from .carriage import Carriage, gap_keeps_limits
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
from .limits import (
    Machine,
    approach_distance,
    change_time,
    cycle_time,
    is_admissible,
    lead,
    max_line_velocity,
    return_time,
    shortest_pitch,
    stroke,
)
from .marks import Marks
from .orders import Orders
from .piece import LEAST_MATERIAL, NO_ORDER, PieceInProgress
from .settings import Settings, first_bad, is_narrow
from .tunables import Tunable

NEVER = 1e300  # s since the step's beginning; u: a pitch that limits nothing
LATE = 1.0 - 1e-9  # of the least way of an approach: with less, a start is late
WHOLE = 1e-12  # of a pitch: what a number of pitches may lack to be whole
FASTER = 1.0 + 1e-9  # of a velocity: beyond it the line has become faster
LONG_AGO = -1e9  # s: the carriage has been at home since long before the initialization
MOST_PITCHES = 1e4  # that the master may travel in one step
MOST_EVENTS = 1000000  # in a piece of the path; so many never happen
BISECTIONS = 200  # this many halve any time down to neighbouring numbers
LEAST_FACTOR = 1e-6  # of a calibration


class Stage(Enumeration):
    """What drives the carriage"""

    RESTING = 0, "nothing: it rests, and the machine does not run"
    HOMING = 1, "its motion home after start"
    WAITING = 2, "nothing: it rests at home until the start point"
    APPROACHING = 3, "the curve into sync"
    SYNCHRONOUS = 4, "the line of the cut, before the blade cuts"
    CUTTING = 5, "the line of the cut"
    PULLING = 6, "the curve that gets ahead of the line"
    CLEARING = 7, "the curve or line on which it was, until the blade is clear"
    RETURNING = 8, "its motion home"


class Condition(Enumeration):
    """What an event waits for, at an instant of the step"""

    START = 0, "an approach to the next cut has to begin"
    CUT_NOW = 1, "an approach for cut_now may begin"
    SYNC = 2, "the approach is over"
    BACK = 3, "the line has gone back to before the approach"
    COMMAND = 4, "the tool has to be commanded before sync"
    THROUGH = 5, "the cut's distance is travelled"
    PULLED = 6, "the gap is open"
    STROKE_END = 7, "the carriage has to stop before an end of its stroke"


@dataclass(slots=True)
class Edges:
    """The commands, each given by its rising edge."""

    start: Edge = var.part(Edge)
    stop: Edge = var.part(Edge)
    abort: Edge = var.part(Edge)
    reset: Edge = var.part(Edge)
    cut_now: Edge = var.part(Edge)
    take_sample: Edge = var.part(Edge)
    order_add: Edge = var.part(Edge)
    order_skip: Edge = var.part(Edge)
    order_clear: Edge = var.part(Edge)
    mark: Edge = var.part(Edge)
    done: Edge = var.part(Edge)
    calibrate: Edge = var.part(Edge)
    calibration_reset: Edge = var.part(Edge)
    clear_statistics: Edge = var.part(Edge)


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
    sample_waits: bool = False  # a take_sample
    edges: Edges = var.part(Edges)

    # What the machine computes with.
    good: Settings = var.part(Settings)
    bad: Tunable = Tunable.NONE
    machine: Machine = var.part(Machine)
    cycle: Machine = var.part(Machine)  # as it was when the approach began
    timeout: float = 0.0  # of the cycle's cut

    # The material.
    piece_now: PieceInProgress = var.part(PieceInProgress)
    orders: Orders = var.part(Orders)
    marks: Marks = var.part(Marks)
    books: Books = var.part(Books)
    has_cut: bool = False  # a cut has been made, at last_place, with this kerf and length correction
    last_place: float = 0.0
    last_kerf: float = 0.0
    last_correction: float = 0.0

    # The carriage.
    rest: float = 0.0  # where it rests, or rested last, u
    carriage: Carriage = var.part(Carriage)
    cut_place: float = 0.0  # the line of the cycle's cut passes carriage position 0 at this place
    motion: Motion = var.part(Motion)
    eased: bool = False  # the way home is an eased one
    halting: bool = False  # its first part is under way
    eased_velocity: float = 0.0  # the line's when it was planned
    eased_place: float = 0.0  # the next cut's when it was planned

    # Times.
    now: float = 0.0  # up to which all events are carried out, since the step's beginning
    block_clock: Clock = var.part(Clock)
    phase: Clock = var.part(Clock)  # since the stage began; at rest, since the arrival
    cycle_clock: Clock = var.part(Clock)  # since the last start of an approach
    ready_clock: Clock = var.part(Clock)  # since the carriage has been ready for a start
    tool_clock: Clock = var.part(Clock)  # since the tool's command has changed
    ready: bool = False
    clear_time: float = 0.0  # of CLEARING
    first_cut: bool = True  # none has been started since start
    reserve: float = 1.0  # of the cycle under way
    sync_time: float = 0.0  # the block's time
    cut_mu: float = 0.0  # how far the master is beyond cut_place when the cut begins
    early: bool = False  # the blade has touched before sync, in this cycle

    # What the limits were solved for.
    solved_velocity: float = 0.0
    solved_pitch: float = 0.0
    solved_pitch_orders: float = 0.0
    pitch: float = 0.0  # shortest at the present line velocity
    queue_kerf: float = -1.0  # what the shortest pitch of all orders was found for; -1: it has to be found
    queue_correction: float = 0.0
    queue_factor: float = 0.0
    queue_pitch: float = NEVER
    exceeded: Exceeded = var.part(Exceeded)

    def initialize(self) -> Refusal:
        """The carriage rests at its initial position; may be called again while parameters still change."""
        refusal = self.start_refusal()
        if refusal != Refusal.NONE:
            return refusal
        if not self.master.try_initialize():
            return Refusal.MASTER_TURNS
        self.cosine = cosine(self.diagonal_angle)
        self.rest = self.axis.initial_position
        self.phase.start(LONG_AGO)
        self.hold_edges()
        self.use_settings()
        self.set_slave()
        self.show()
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
        if self.running and self.master.longest_travel(h) > MOST_PITCHES * self.solved_pitch_orders:
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
        self.cycle_clock.advance(h)
        self.ready_clock.advance(h)
        self.tool_clock.advance(h)
        self.motion.advance(h)

    # --- the parameters ---

    def judge_settings(self) -> None:
        """Take over what was tuned, if all parameters are good."""
        if self.bad != Tunable.NONE or not self.good.are_those_of(self):
            self.bad = first_bad(self)
            if self.bad == Tunable.NONE:
                self.use_settings()

    def use_settings(self) -> None:
        """Compute with the present parameters and the present factor of calibration."""
        self.good.take(self)
        self.describe_machine()

    def describe_machine(self) -> None:
        self.good.describe(self.machine, self.calibration.factor, self.cosine)
        self.queue_kerf = -1.0
        self.solve_cycle(self.master.end_velocity)
        self.solved_pitch = self.limiting_pitch()
        self.solve_line_velocity()

    def factor(self) -> float:
        """True travel of the material per travel of the master."""
        return self.good.material_factor * self.calibration.factor

    # --- the commands ---

    def hold_edges(self) -> None:
        """Take the present levels of the commands as they are: the first value seen is no edge."""
        edges = self.edges
        edges.start.hold(self.start)
        edges.stop.hold(self.stop)
        edges.abort.hold(self.abort)
        edges.reset.hold(self.reset)
        edges.cut_now.hold(self.cut_now)
        edges.take_sample.hold(self.take_sample)
        edges.order_add.hold(self.order.add)
        edges.order_skip.hold(self.order.skip)
        edges.order_clear.hold(self.order.clear)
        edges.mark.hold(self.mark.detected)
        edges.done.hold(self.tool.done)
        edges.calibrate.hold(self.calibration.execute)
        edges.calibration_reset.hold(self.calibration.reset)
        edges.clear_statistics.hold(self.clear_statistics)

    def obey(self) -> None:
        """Carry out the commands of the step, and what is looked at at each step's beginning."""
        self.now = 0.0
        self.judge_settings()
        self.obey_machine()
        self.obey_books()
        self.obey_orders()
        if self.edges.take_sample.try_rise(self.take_sample):
            self.accept()
            self.sample_waits = True
        self.watch_marks(self.edges.mark.try_rise(self.mark.detected))
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
            self.orders.clear()
            self.queue_kerf = -1.0
        if self.edges.order_skip.try_rise(self.order.skip):
            self.accept()
            if self.orders.waiting > 0:
                self.orders.drop()
                self.queue_kerf = -1.0
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
        elif self.stage == Stage.RETURNING and self.eased:
            self.enter_returning()

    def command_start(self) -> None:
        """Set the machine to work."""
        if (
            self.running
            or self.stage != Stage.RESTING
            or self.fault != Fault.NONE
            or (self.start_mode == StartMode.CONTINUE and not self.has_cut)
        ):
            self.refusal = Fault.START
        elif self.bad != Tunable.NONE:
            self.refusal = Fault.TUNABLE
        else:
            self.accept()
            self.set_to_work()

    def set_to_work(self) -> None:
        self.running = True
        self.stopping = False
        self.cut_waits = False
        self.first_cut = True
        piece = self.piece_now
        piece.begin = self.last_place
        if self.start_mode != StartMode.CONTINUE:
            self.marks.forget()
            front = self.good.front_position / self.machine.coupling + 0.5 * self.good.kerf / self.factor()
            piece.begin = self.master.begin - front
        if self.start_mode == StartMode.TRIM:
            self.measure_piece()
            piece.fix(PieceKind.TRIM, self.good.trim_length, NO_ORDER)
            piece.pitch = NEVER
        else:
            self.fix_piece()
        if self.rest == self.good.home_position:
            self.enter_waiting()
        else:
            self.enter_homing()

    def command_calibrate(self) -> None:
        """The last piece measured so long: the material's travel is corrected."""
        material = self.last.length + self.last_kerf + self.last_correction
        measured = self.calibration.measured_length
        if self.has_cut and measured > 0.0 and material > 0.0:
            factor = self.calibration.factor * ((measured + self.last_kerf) / material)
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
        elif self.orders.is_full():
            self.refusal = Fault.ORDERS_FULL
        else:
            self.accept()
            self.orders.append(self.order.length, float(self.order.quantity))
            self.queue_kerf = -1.0

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

    # --- marks ---

    def watch_marks(self, detected: bool) -> None:
        """Take a mark that the sensor has seen, and miss those that should have come."""
        if not (self.running and self.source == Source.MARK):
            return
        settings = self.good.mark
        factor = self.factor()
        spacing = settings.spacing / factor
        window = settings.window / factor
        here = self.master.begin - self.master.begin_velocity * settings.delay
        place = here
        if detected and self.mark.latched:
            place = nearest(self.mark.position, self.master.period, self.master.begin)
        expects = spacing > 0.0 and window > 0.0
        if expects:
            self.miss_marks(place if detected else here, spacing, window)
        if detected and self.running:
            if expects and self.marks.known and place < self.marks.last + spacing - window:
                self.statistics.marks_outside += 1
                self.warning.mark_outside = True
            else:
                self.warning.mark_missing = False
                self.warning.mark_outside = False
                self.statistics.marks += 1
                self.marks.missing = 0
                self.take_mark(place)

    def miss_marks(self, place: float, spacing: float, window: float) -> None:
        """Count the marks that should have come before a place, and put others in their stead."""
        while self.running and self.marks.known and place > self.marks.last + spacing + window:
            self.marks.missing += 1
            self.statistics.marks_missing += 1
            self.warning.mark_missing = True
            if self.marks.missing > self.good.mark.max_missing:
                self.fail(Fault.MARKS_MISSING)
            elif self.mark.substitute:
                self.take_mark(self.marks.last + spacing)
            else:
                self.marks.last += spacing

    def take_mark(self, place: float) -> None:
        """A mark lies at this place."""
        self.marks.known = True
        self.marks.last = place
        if self.marks.try_take(self.good.mark.every):
            if self.marks.is_full():
                self.fail(Fault.MARKS_FULL)
                return
            self.marks.append(place + (self.good.mark.sensor_distance + self.good.mark.cut_offset) / self.factor())
            self.queue_kerf = -1.0
            piece = self.piece_now
            if self.running and not piece.known:
                merged = piece.kind == PieceKind.MERGED
                self.fix_piece()
                if merged:
                    piece.kind = PieceKind.MERGED

    # --- which piece ---

    def fix_piece(self) -> None:
        """Fix the piece that begins at the last cut, if its length is known."""
        piece = self.piece_now
        piece.forget()
        if self.bad != Tunable.NONE:
            self.refusal = Fault.TUNABLE
            return
        self.measure_piece()
        if self.source == Source.MARK:
            self.fix_marked_piece()
            return
        length, order = self.product()
        kind = PieceKind.PRODUCT
        if self.waste:
            length = self.good.waste_length
            kind = PieceKind.WASTE
        elif self.sample_waits:
            length = self.good.sample_length
            kind = PieceKind.SAMPLE
        if piece.material(length) > LEAST_MATERIAL and length > 0.0:
            piece.fix(kind, length, order if kind == PieceKind.PRODUCT else NO_ORDER)
            if kind == PieceKind.SAMPLE:
                self.sample_waits = False

    def measure_piece(self) -> None:
        """The piece is measured as the parameters say now; a length correction does not belong to marks."""
        piece = self.piece_now
        piece.factor = self.factor()
        piece.kerf = self.good.kerf
        piece.correction = self.length_correction if self.source == Source.LENGTH else 0.0

    def fix_marked_piece(self) -> None:
        """The piece ends at the next mark that is cut. Marks without a known spacing say nothing of its length."""
        piece = self.piece_now
        piece.kind = PieceKind.PRODUCT
        piece.exact = self.good.mark.spacing > 0.0
        if piece.exact:
            piece.ordered = self.good.mark.spacing * float(self.good.mark.every) - piece.kerf
        if self.marks.waiting > 0:
            piece.known = True
            piece.end = self.marks.place(0)
            piece.pitch = piece.end - piece.begin

    def product(self) -> tuple[float, int]:
        """Length of the product that is due, and the number of its order."""
        if self.orders.waiting > 0:
            return self.orders.length(0), self.orders.first
        return self.length, NO_ORDER

    def watch_piece(self) -> None:
        """Look for a length where none was known, and for one that has changed."""
        piece = self.piece_now
        self.warning.change_pending = False
        if not self.running or self.source == Source.MARK:
            return
        if not piece.known:
            self.fix_piece()
        elif self.change_mode == ChangeMode.THIS_PIECE and piece.kind == PieceKind.PRODUCT:
            length, order = self.product()
            if (
                length != piece.ordered
                or order != piece.order
                or self.length_correction != piece.correction
                or self.good.kerf != piece.kerf
                or self.factor() != piece.factor
            ):
                self.change_piece(length, order)

    def change_piece(self, length: float, order: int) -> None:
        """The product in progress is fixed anew if its new cut can still be reached."""
        piece = self.piece_now
        pitch = (length + self.length_correction + self.good.kerf) / self.factor()
        mu = self.beyond(piece.begin + pitch, 0.0)
        reachable = self.good.home_position - self.machine.coupling * mu >= lead(
            self.machine, self.master.begin_velocity
        )
        movable = self.stage in (Stage.HOMING, Stage.WAITING, Stage.PULLING, Stage.CLEARING, Stage.RETURNING)
        if movable and reachable and self.bad == Tunable.NONE:
            self.measure_piece()
            if length > 0.0 and piece.material(length) > LEAST_MATERIAL:
                piece.fix(PieceKind.PRODUCT, length, order)
            else:
                piece.forget()
        else:
            self.warning.change_pending = True

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
        match self.stage:
            case Stage.RESTING:
                return False
            case Stage.HOMING | Stage.RETURNING:
                return self.try_event_returning(until)
            case Stage.WAITING:
                return self.try_event_waiting(until)
            case Stage.APPROACHING:
                return self.try_event_approaching(until)
            case Stage.SYNCHRONOUS:
                return self.try_event_synchronous(until)
            case Stage.CUTTING:
                return self.try_event_cutting(until)
            case Stage.PULLING:
                return self.try_event_pulling(until)
            case _:
                return self.try_event_clearing(until)

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
        carriage = self.carriage
        match condition:
            case Condition.START:
                return self.start_is_due(velocity, time)
            case Condition.CUT_NOW:
                return velocity >= 0.0 and is_admissible(self.machine, velocity)
            case Condition.SYNC:
                return self.beyond(self.cut_place, time) >= carriage.sync
            case Condition.BACK:
                return velocity < 0.0 and self.beyond(self.cut_place, time) < carriage.start
            case Condition.COMMAND:
                ahead = velocity * (self.cycle.on_delay - self.cycle.settle_time)
                return self.beyond(self.cut_place, time) + ahead >= carriage.sync
            case Condition.THROUGH:
                travel = self.beyond(self.cut_place, time) - self.cut_mu
                return carriage.coupling * travel >= self.cycle.cut_distance
            case Condition.PULLED:
                return self.beyond(self.cut_place, time) >= carriage.gap_end
            case _:
                return self.has_to_stop(time)

    def start_is_due(self, velocity: float, time: float) -> bool:
        """Whether the line moves on, and the next cut's line is where the approach to it begins."""
        if velocity < 0.0 or (velocity == 0.0 and self.master.mean_acceleration() <= 0.0):
            return False
        travel = self.machine.coupling * self.beyond(self.piece_now.end, time)
        if travel < self.rest - approach_distance(self.machine, velocity):
            return False
        return not self.waits_for_line() or is_admissible(self.machine, velocity)

    def waits_for_line(self) -> bool:
        """Whether the piece's cut is made wherever it can be: it is not skipped, but waits for a slower line."""
        return self.piece_now.kind in (PieceKind.TRIM, PieceKind.SHORT)

    def has_to_stop(self, time: float) -> bool:
        """Whether the time-optimal stop from here ends at an end of the stroke, or beyond it."""
        position, velocity, acceleration, _ = self.carriage_at(time)
        down = min(self.machine.homing_acceleration, self.machine.homing_deceleration)
        jerk = self.machine.homing_jerk
        if abs(acceleration) <= down:  # then the stop takes no longer than this
            fast = abs(velocity) + 0.5 * down * down / jerk
            far = fast * (0.5 * fast / down + 3.0 * down / jerk)
            if self.good.axis.min_position < position - far and position + far < self.good.axis.max_position:
                return False
        end = position + stopping_distance(velocity, acceleration, down, jerk)
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
        time = self.due(self.motion.clock, self.motion.end(), until)
        if time == NEVER:
            return False
        self.now = time
        if self.halting:
            self.ease_home()
        else:
            self.arrive()
        return True

    def try_event_waiting(self, until: float) -> bool:
        """The carriage has settled, or an approach begins."""
        if not self.ready:
            time = self.due(self.phase, self.good.homing.settle_time, until)
            if time == NEVER:
                return False
            self.now = time
            self.ready = True
            self.ready_clock.start(time)
            return True
        if self.hold or self.bad != Tunable.NONE:
            return False
        if self.cut_waits:
            time = self.first(Condition.CUT_NOW, until)
            if time == NEVER:
                return False
            self.now = time
            self.begin_cut_now()
            return True
        if not self.piece_now.known:
            return False
        time = self.first(Condition.START, until)
        if time == NEVER:
            return False
        crossed = time > self.now and not self.waits_for_line()
        self.now = time
        self.begin_cut(crossed)
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
        self.now = time
        if self.tool.command:
            self.tool.blade_down = True
            if self.first(Condition.SYNC, time) == NEVER:
                self.early = True
                self.warning.blade_early = True
                self.statistics.unsynchronised += 1
        else:
            self.set_tool(True)
        return True

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
        time = self.first(Condition.STROKE_END, until)
        if time == NEVER or time >= other:
            return False
        self.now = time
        if self.tool.blade_down:
            self.statistics.unsynchronised += 1
        if self.fault == Fault.NONE:
            self.stop_for(Fault.STROKE)
        self.set_tool(False)
        self.enter_returning()
        return True

    # --- cuts begin and end ---

    def begin_cut(self, crossed: bool) -> None:
        """The next cut's line is where an approach to it begins, or beyond that: begin it, or say that it is late."""
        velocity = self.master.velocity_at(self.now)
        piece = self.piece_now
        least = lead(self.machine, velocity)
        mu = self.beyond(piece.end, self.now)
        distance = self.rest - self.machine.coupling * mu
        if crossed:
            distance = approach_distance(self.machine, velocity)
        late = distance < least * LATE
        if not (self.waits_for_line() or is_admissible(self.machine, velocity)):
            if self.late_mode == LateMode.STOP_LINE:
                self.fail(Fault.STROKE)
            else:
                self.skip(mu, least)
        elif not late:
            self.begin_approach(distance, False)
        elif self.waits_for_line():
            self.move_cut(mu, least)
            self.begin_approach(least, True)
        elif self.late_mode == LateMode.SKIP:
            self.skip(mu, least)
        elif self.late_mode == LateMode.LATE:
            self.move_cut(mu, least)
            self.statistics.late += 1
            self.begin_approach(least, True)
        else:
            self.fail(Fault.CUT_MISSED)

    def begin_cut_now(self) -> None:
        """Cut where the carriage can be in sync first."""
        piece = self.piece_now
        self.cut_waits = False
        piece.known = True
        piece.kind = PieceKind.SHORT
        piece.end = self.master.begin
        least = lead(self.machine, self.master.velocity_at(self.now))
        self.move_cut(self.beyond(piece.end, self.now), least)
        self.begin_approach(least, False)

    def move_cut(self, mu: float, distance: float) -> None:
        """The cut, whose line is at mu, goes to where an approach of a distance begins now."""
        self.piece_now.end += mu - (self.rest - distance) / self.machine.coupling

    def skip(self, mu: float, least: float) -> None:
        """The piece ends with the first of the next cuts that can be reached."""
        piece = self.piece_now
        k = self.machine.coupling
        too_far = k * mu - (self.rest - least)  # so far the carriage would have to be ahead of where it can be
        if self.source == Source.MARK:
            self.skip_marks(least)
        else:
            number = max(1.0, -floor(WHOLE - too_far / (k * piece.pitch)))
            piece.end += number * piece.pitch
            self.statistics.skipped = more(self.statistics.skipped, number)
        piece.kind = PieceKind.MERGED

    def skip_marks(self, least: float) -> None:
        """Drop the marks whose cuts cannot be reached, the next one in any case."""
        piece = self.piece_now
        self.queue_kerf = -1.0
        for _ in range(self.marks.waiting):
            self.marks.drop()
            self.statistics.skipped += 1
            if self.marks.waiting > 0:
                mu = self.beyond(self.marks.place(0), self.now)
                if self.machine.coupling * mu <= self.rest - least * LATE:
                    break
        piece.known = self.marks.waiting > 0
        if piece.known:
            piece.end = self.marks.place(0)

    def begin_approach(self, distance: float, late: bool) -> None:
        """The carriage starts now and is in sync after its own travel `distance`."""
        var.copy(self.cycle, self.machine)
        self.timeout = self.good.tool.timeout
        self.carriage.lay_approach(self.machine.coupling, self.rest, distance)
        self.cut_place = self.piece_now.end
        self.judge_reserve(late)
        self.first_cut = False
        self.early = False
        self.cycle_clock.start(self.now)
        self.local.start_time = self.block_clock.time + self.now
        self.stage = Stage.APPROACHING
        if distance == 0.0:  # the line stands where the cut is
            self.enter_synchronous()

    def judge_reserve(self, late: bool) -> None:
        """The share of its cycle that the carriage has spent at home, ready for this start."""
        if self.first_cut:
            self.reserve = 1.0
        elif late:
            self.reserve = 0.0
        else:
            waited = self.ready_clock.time + self.now
            since_start = self.cycle_clock.time + self.now
            self.reserve = max(0.0, min(waited / since_start, 1.0)) if since_start > 0.0 else 1.0

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
        piece = self.piece_now
        length = piece.length(self.cut_place)
        error = length - piece.ordered if piece.exact else 0.0
        good = piece.kind == PieceKind.PRODUCT and abs(error) <= self.good.length_tolerance
        self.last.length = length
        self.last.error = error
        self.last.kind = piece.kind
        self.last.good = good
        self.last.time = self.sync_time
        self.last.reserve = self.reserve
        self.books.enter(self.statistics, piece.kind, good, length, error, self.reserve)
        self.batch_done = False
        if good:
            self.count_good()
        self.has_cut = True
        self.last_place = self.cut_place
        self.last_kerf = piece.kerf
        self.last_correction = piece.correction
        if self.source == Source.MARK and not self.waits_for_line() and self.marks.waiting > 0:
            self.marks.drop()
            self.queue_kerf = -1.0
        piece.begin = self.cut_place
        self.fix_piece()

    def count_good(self) -> None:
        """A good piece counts for its order and for the batch."""
        number = self.piece_now.order
        if number != NO_ORDER and self.orders.has(number):
            if self.orders.try_fulfil(number, self.order.repeat):
                self.order.completed += 1
            self.queue_kerf = -1.0
        if self.good.batch_size > 0:
            self.batch_count += 1
            if self.batch_count >= self.good.batch_size:
                self.batch_count = 0
                self.batches += 1
                self.batch_done = True

    # --- the stages are entered ---

    def enter_resting(self) -> None:
        """The machine does not run any more."""
        self.stage = Stage.RESTING
        self.running = False
        self.piece_now.forget()

    def enter_waiting(self) -> None:
        """At home until the start point."""
        self.stage = Stage.WAITING
        self.ready = False

    def enter_homing(self) -> None:
        """From rest to home."""
        self.plan_way_home(self.rest, 0.0, 0.0)
        self.stage = Stage.HOMING

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
        """From any motion to home, with ease if there is time for it."""
        if self.stage in (Stage.RETURNING, Stage.HOMING):
            position, velocity, acceleration, _ = self.motion.at(self.motion.clock.time + self.now)
        else:
            position, velocity, acceleration, _ = self.carriage_at(self.now)
        self.plan_way_home(position, velocity, acceleration)
        if self.stage not in (Stage.RETURNING, Stage.HOMING):
            self.plan_ease(position, velocity, acceleration)
        self.stage = Stage.RETURNING

    def plan_way_home(self, position: float, velocity: float, acceleration: float) -> None:
        """As fast as the limits of homing allow."""
        machine = self.machine
        self.rest = machine.home_position
        self.motion.move(
            position,
            velocity,
            acceleration,
            machine.home_position,
            machine.homing_velocity,
            machine.homing_acceleration,
            machine.homing_deceleration,
            machine.homing_jerk,
        )
        self.motion.clock.start(self.now)
        self.eased = False
        self.halting = False
        self.local.ease = 1.0

    def plan_ease(self, position: float, velocity: float, acceleration: float) -> None:
        """If there is time, halt first; the way from there to home then takes just the time that is left."""
        line = self.master.velocity_at(self.now)
        piece = self.piece_now
        idle = self.stopping or self.cut_waits or self.fault != Fault.NONE
        if idle or not (self.homing.ease and piece.known and line > 0.0):
            return
        machine = self.machine
        down = machine.homing_deceleration
        jerk = machine.homing_jerk
        halt = change_time(velocity, down, jerk)
        distance = position - machine.home_position + 0.5 * velocity * halt
        if not distance > 0.0:
            return
        way = return_time(0.0, distance, machine.homing_acceleration, down, jerk, machine.homing_velocity)
        missing = (machine.home_position - approach_distance(machine, line)) / machine.coupling - self.beyond(
            piece.end, self.now
        )
        left = missing / line - machine.homing_settle_time - self.good.homing.spare_time - halt
        if left > way:
            self.eased = True
            self.halting = True
            self.eased_velocity = line
            self.eased_place = piece.end
            self.local.ease = max(self.good.homing.slowest, way / left)
            self.motion.halt(position, velocity, acceleration, down, jerk)
            self.motion.clock.start(self.now)

    def ease_home(self) -> None:
        """The carriage has halted: from here home, with a share of the limits."""
        machine = self.machine
        share = self.local.ease
        position, _, _, _ = self.motion.at(self.motion.end())
        self.halting = False
        self.motion.move(
            position,
            0.0,
            0.0,
            self.rest,
            share * machine.homing_velocity,
            share * share * machine.homing_acceleration,
            share * share * machine.homing_deceleration,
            share * share * share * machine.homing_jerk,
        )
        self.motion.clock.start(self.now)

    def watch_ease(self) -> None:
        """There is no time for ease any more: the line gets faster, or the next cut lies elsewhere."""
        if self.stage == Stage.RETURNING and self.eased:
            line = self.master.begin_velocity
            end = self.master.end_velocity
            faster = line > self.eased_velocity * FASTER or end > line + (FASTER - 1.0) * abs(line)
            piece = self.piece_now
            if faster or self.cut_waits or not piece.known or piece.end != self.eased_place:
                self.enter_returning()

    def arrive(self) -> None:
        """The carriage is at home."""
        self.phase.start(self.now)
        self.local.home_time = self.block_clock.time + self.now
        self.eased = False
        self.local.ease = 1.0
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
            case Stage.RETURNING:
                if self.eased:
                    self.enter_returning()
            case _:
                pass

    # --- what is put out ---

    def set_slave(self) -> None:
        """The carriage's setpoint at the end of the step."""
        match self.stage:
            case Stage.RESTING | Stage.WAITING:
                self.slave.put(self.rest, 0.0, 0.0, 0.0)
            case Stage.HOMING | Stage.RETURNING:
                position, velocity, acceleration, jerk = self.motion.at(self.motion.clock.time)
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
        self.show_limits()
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

    def show_limits(self) -> None:
        """What the machine can do; it is solved again where something has changed on which it depends."""
        velocity = self.master.end_velocity
        if velocity != self.solved_velocity:
            self.solve_cycle(velocity)
        pitch = self.limiting_pitch()
        orders = min(pitch, self.shortest_pitch_of_queue())
        if pitch != self.solved_pitch or orders != self.solved_pitch_orders:
            self.solved_pitch = pitch
            self.solve_line_velocity()
        moving = velocity > 0.0
        factor = self.factor()
        material = factor * self.pitch - self.good.kerf - self.length_correction
        self.limits.min_length = max(material, 0.0) if moving else 0.0
        self.limits.reserve = 1.0
        if moving and self.running and self.piece_now.pitch < NEVER:
            self.limits.reserve = 1.0 - self.limits.cycle_time * velocity / self.piece_now.pitch
        sensor = (self.local.approach_distance - self.good.home_position) / self.machine.coupling
        sensor += max(velocity, 0.0) * self.good.mark.delay
        self.limits.min_sensor_distance = max(factor * sensor, 0.0)

    def solve_cycle(self, velocity: float) -> None:
        """The cycle at a line velocity."""
        self.solved_velocity = velocity
        self.pitch = shortest_pitch(self.machine, velocity)
        self.limits.cycle_time = cycle_time(self.machine, velocity)
        self.limits.stroke = stroke(self.machine, velocity) if velocity > 0.0 else self.machine.approach_distance
        self.local.approach_distance = approach_distance(self.machine, velocity)
        self.local.coupling_factor = self.machine.coupling

    def solve_line_velocity(self) -> None:
        """The highest admissible line velocities."""
        self.solved_pitch_orders = min(self.solved_pitch, self.shortest_pitch_of_queue())
        self.limits.max_line_velocity = max_line_velocity(self.machine, self.solved_pitch)
        self.limits.max_line_velocity_orders = self.limits.max_line_velocity
        if self.solved_pitch_orders < self.solved_pitch:
            self.limits.max_line_velocity_orders = max_line_velocity(self.machine, self.solved_pitch_orders)

    def limiting_pitch(self) -> float:
        """The smaller of the pitch in progress, as it was fixed, and the one that is expected after it."""
        expected = self.expected_pitch()
        return min(self.piece_now.pitch, expected) if self.running else expected

    def expected_pitch(self) -> float:
        """The pitch of the piece after the one in progress, as far as it is known; NEVER: it is not."""
        if self.source == Source.MARK:
            if self.marks.waiting > 1:
                return self.marks.place(1) - self.marks.place(0)
            spacing = self.good.mark.spacing * float(self.good.mark.every)
            return spacing / self.factor() if spacing > 0.0 else NEVER
        if self.waste:
            return self.pitch_of(self.good.waste_length)
        if self.sample_waits:
            return self.pitch_of(self.good.sample_length)
        place = self.orders.place_after(self.piece_now.order if self.running else NO_ORDER, self.order.repeat)
        return self.pitch_of(self.length if place < 0 else self.orders.length(place))

    def pitch_of(self, length: float) -> float:
        """The pitch of a piece of that length; NEVER: it is none."""
        material = length + self.length_correction + self.good.kerf
        return material / self.factor() if length > 0.0 and material > LEAST_MATERIAL else NEVER

    def shortest_pitch_of_queue(self) -> float:
        """The least pitch of all orders that wait, or of all marks."""
        factor = self.factor()
        if (
            self.queue_kerf != self.good.kerf
            or self.queue_correction != self.length_correction
            or self.queue_factor != factor
        ):
            self.queue_kerf = self.good.kerf
            self.queue_correction = self.length_correction
            self.queue_factor = factor
            shortest = self.marks.shortest()
            if self.source == Source.LENGTH:
                shortest = self.orders.shortest()
                shortest = self.pitch_of(shortest) if shortest < NEVER else NEVER
            self.queue_pitch = shortest
        return self.queue_pitch

    def show_piece(self) -> None:
        """The piece in progress and its cut."""
        piece = self.piece_now
        k = self.machine.coupling
        self.piece.kind = piece.kind
        self.piece.ordered = piece.ordered
        self.piece.length = 0.0
        if self.running:
            self.piece.length = max(piece.length(self.master.end - self.slave.position / k), 0.0)
        known = self.running and piece.known
        self.next_cut.known = known
        self.next_cut.position = wrap(piece.end, self.master.period) if known else 0.0
        self.next_cut.distance = 0.0
        self.local.start_position = 0.0
        self.local.progress = 0.0
        if known:
            mu = self.master.end - piece.end
            distance = self.local.approach_distance
            start = (self.good.home_position - distance) / k
            self.local.start_position = wrap(piece.end + start, self.master.period)
            match self.stage:
                case Stage.APPROACHING:
                    self.next_cut.distance = max(self.carriage.sync - mu, 0.0)
                    travel = self.carriage.sync - self.carriage.start
                    if travel > 0.0:
                        self.local.progress = max(0.0, min((mu - self.carriage.start) / travel, 1.0))
                case Stage.SYNCHRONOUS | Stage.CUTTING:
                    self.local.progress = 1.0
                case _:
                    self.next_cut.distance = max((self.good.home_position + distance) / k - mu, 0.0)

    def show_orders(self) -> None:
        self.order.waiting = self.orders.waiting
        self.order.remaining = int(self.orders.lacking())
        self.order.length_active = self.orders.length(0) if self.orders.waiting > 0 else 0.0
        self.local.marks_waiting = self.marks.waiting

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
        warning.stroke = self.good.home_position + self.limits.stroke > self.good.axis.max_position
        warning.velocity = self.machine.coupling * velocity > self.machine.max_velocity
        warning.no_length = self.running and self.source == Source.LENGTH and not self.piece_now.known
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
                self.piece_now.begin -= turns
                self.piece_now.end -= turns
                self.cut_place -= turns
                self.last_place -= turns
                self.eased_place -= turns
                self.marks.shift(turns)


def state_of(stage: Stage) -> State:
    """What is shown of a stage, without a fault."""
    match stage:
        case Stage.HOMING:
            return State.HOMING
        case Stage.WAITING:
            return State.WAITING
        case Stage.APPROACHING:
            return State.APPROACHING
        case Stage.SYNCHRONOUS:
            return State.SYNCHRONOUS
        case Stage.CUTTING:
            return State.CUTTING
        case Stage.PULLING:
            return State.PULLING
        case Stage.CLEARING:
            return State.CLEARING
        case Stage.RETURNING:
            return State.RETURNING
        case _:
            return State.OFF
