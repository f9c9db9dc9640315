"""How the machine is operated: what its commands have asked for, what was refused, and why it has stopped."""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import is_usable
from ..slave import Edge
from .faults import PieceFault
from .interface import Calibration, CuttingInterface, Order, StartMode
from .material import Material
from .records import PieceRecords

LEAST_FACTOR = 0.5  # of a calibration: what is beyond it, or beyond its reciprocal, comes from a wrong measurement
MOST_PITCHES = 1e4  # that the master may travel in one step


@dataclass(slots=True)
class Operation:
    """The operation of the machine, by commands that are given by their rising edges.

    Attributes:
        refusal: why the last command was refused; `error_id` shows it where there is no fault.
        fault: why the machine has stopped.
        has_stepped: there has been a step since the initialization.
        is_stopping: the machine rests as soon as it can.
        is_cut_pending: a cut_now has not been carried out yet.
    """

    start_edge: Edge = var.part(Edge)
    stop_edge: Edge = var.part(Edge)
    abort_edge: Edge = var.part(Edge)
    reset_edge: Edge = var.part(Edge)
    cut_now_edge: Edge = var.part(Edge)
    take_sample_edge: Edge = var.part(Edge)
    order_add_edge: Edge = var.part(Edge)
    order_skip_edge: Edge = var.part(Edge)
    order_clear_edge: Edge = var.part(Edge)
    mark_edge: Edge = var.part(Edge)
    calibrate_edge: Edge = var.part(Edge)
    calibration_reset_edge: Edge = var.part(Edge)
    clear_statistics_edge: Edge = var.part(Edge)
    refusal: int = 0
    fault: int = 0
    has_stepped: bool = False
    is_stopping: bool = False
    is_cut_pending: bool = False

    def take_levels(self, block: CuttingInterface) -> None:
        """Take the present levels of all commands as they are: the first value seen is no edge."""
        self.start_edge.take_level(block.start)
        self.stop_edge.take_level(block.stop)
        self.abort_edge.take_level(block.abort)
        self.reset_edge.take_level(block.reset)
        self.cut_now_edge.take_level(block.cut_now)
        self.take_sample_edge.take_level(block.take_sample)
        self.order_add_edge.take_level(block.order.add)
        self.order_skip_edge.take_level(block.order.skip)
        self.order_clear_edge.take_level(block.order.clear)
        self.mark_edge.take_level(block.mark.detected)
        self.calibrate_edge.take_level(block.calibration.execute)
        self.calibration_reset_edge.take_level(block.calibration.reset)
        self.clear_statistics_edge.take_level(block.clear_statistics)

    def longest_travel(self, block: CuttingInterface, material: Material, shortest: float) -> float:
        """How far the master may travel in the present step, u; 0: any distance.

        `shortest`: the least pitch of the piece in progress and of all that wait."""
        is_started = (block.start and not self.start_edge.before) or (block.auto_start and not self.has_stepped)
        return MOST_PITCHES * material.repeated_pitch(shortest, block.length) if block.running or is_started else 0.0

    def reset(self, block: CuttingInterface, is_at_rest: bool) -> None:
        """Carry out reset: clear what was refused, and the fault once the machine rests; in motion it does nothing."""
        if self.reset_edge.try_rise(block.reset) and (self.fault == PieceFault.NONE or is_at_rest):
            self.fault = PieceFault.NONE
            self.refusal = PieceFault.NONE

    def try_abort(self, block: CuttingInterface) -> bool:
        """Accept the command abort, if it comes and the machine runs."""
        if self.abort_edge.try_rise(block.abort) and block.running:
            self.accept(True)
            return True
        return False

    def try_stop(self, block: CuttingInterface) -> bool:
        """Accept the command stop, if it comes and the machine runs."""
        if self.stop_edge.try_rise(block.stop) and block.running:
            self.accept(True)
            return True
        return False

    def try_take_start(self, block: CuttingInterface) -> bool:
        """Whether the command start comes."""
        return self.start_edge.try_rise(block.start) or (block.auto_start and not self.has_stepped)

    def try_start(self, block: CuttingInterface, material: Material, is_off: bool, are_valid: bool) -> bool:
        """Accept the command start, if the machine is off and has what it needs; else refuse it.

        `are_valid`: all tunable parameters are."""
        can_continue = block.start_mode != StartMode.CONTINUE or material.has_cut
        if not (is_off and self.fault == PieceFault.NONE and can_continue):
            self.refusal = PieceFault.START
        elif not are_valid:
            self.refusal = PieceFault.TUNABLE
        else:
            self.accept(False)
            return True
        return False

    def accept(self, is_stopping: bool) -> None:
        """A command that starts or stops the machine is accepted."""
        self.refusal = PieceFault.NONE
        self.is_stopping = is_stopping
        self.is_cut_pending = False

    def try_request_cut(self, block: CuttingInterface) -> bool:
        """Store a cut_now, if it comes and the machine runs, until it can be carried out."""
        if not self.cut_now_edge.try_rise(block.cut_now):
            return False
        self.refusal = PieceFault.NONE
        if not block.running or self.is_stopping:
            self.refusal = PieceFault.CUT_NOW
        else:
            self.is_cut_pending = True
        return self.refusal == PieceFault.NONE

    # --- the commands for pieces ---

    def obey_pieces(self, block: CuttingInterface, records: PieceRecords, material: Material) -> None:
        """Carry out the commands for statistics, calibration and orders."""
        if self.clear_statistics_edge.try_rise(block.clear_statistics):
            self.refusal = PieceFault.NONE
            records.clear(block.statistics)
        self.obey_calibration(block.calibration, block.last.length, material)
        self.obey_orders(block.order, block.take_sample, material)

    def obey_calibration(self, calibration: Calibration, last_length: float, material: Material) -> None:
        """Carry out calibration.reset and calibration.execute: change the factor of calibration."""
        if self.calibration_reset_edge.try_rise(calibration.reset):
            self.refusal = PieceFault.NONE
            calibration.factor = 1.0
        if self.calibrate_edge.try_rise(calibration.execute):
            calibrated = calibrated_factor(calibration, last_length, material)
            self.refusal = PieceFault.CALIBRATION
            if calibrated > 0.0:
                self.refusal = PieceFault.NONE
                calibration.factor = calibrated

    def obey_orders(self, order: Order, take_sample: bool, material: Material) -> None:
        """Carry out order.clear, order.skip, order.add, take_sample."""
        if self.order_clear_edge.try_rise(order.clear):
            self.refusal = PieceFault.NONE
            material.orders.clear()
        if self.order_skip_edge.try_rise(order.skip):
            self.refusal = PieceFault.NONE
            if material.orders.waiting > 0:
                material.orders.drop()
        if self.order_add_edge.try_rise(order.add):
            self.add_order(order, material)
        if self.take_sample_edge.try_rise(take_sample):
            self.refusal = PieceFault.NONE
            material.is_sample_pending = True

    def add_order(self, order: Order, material: Material) -> None:
        """Append an order, if it is one and the queue is not full."""
        if not (order.length > 0.0 and order.quantity >= 1):
            self.refusal = PieceFault.ORDER
        elif material.orders.is_full():
            self.refusal = PieceFault.ORDERS_FULL
        else:
            self.refusal = PieceFault.NONE
            material.orders.append(order.length, float(order.quantity))

    # --- what they lead to ---

    def try_take_cut(self, material: Material, cut: float, is_reachable: bool) -> bool:
        """Carry out the cut_now that waits: the piece ends at this position. It is refused if the cut cannot be reached
        from here, or leaves no piece."""
        self.is_cut_pending = False
        if is_reachable and material.try_fix_short(cut):
            return True
        self.refusal = PieceFault.CUT_NOW
        return False

    def fail(self, fault: int) -> None:
        """The machine stops for a fault."""
        self.fault = fault
        self.is_cut_pending = False


def calibrated_factor(calibration: Calibration, last_length: float, material: Material) -> float:
    """The factor of calibration with which the last piece has the measured length; 0: there is none."""
    factor = material.settings.cycle.material_factor
    cut = last_length + material.last_kerf + material.last_correction
    measured = calibration.measured_length
    if material.has_cut and measured > 0.0 and cut > 0.0:
        calibrated = calibration.factor * ((measured + material.last_kerf) / cut)
        if LEAST_FACTOR <= calibrated <= 1.0 / LEAST_FACTOR and is_usable(factor * calibrated):
            return calibrated
    return 0.0
