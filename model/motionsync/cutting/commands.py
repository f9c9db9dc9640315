"""The commands for pieces: orders, samples, calibration, statistics, and the sensor of marks."""

from dataclasses import dataclass

from .. import var
from ..numerics.computable_range import is_usable
from ..slave import Edge
from .faults import PieceFault
from .interface import Calibration, CuttingInterface, Order
from .material import Material
from .records import PieceRecords

LEAST_FACTOR = 0.5  # of a calibration: what is beyond it, or beyond its reciprocal, comes from a wrong measurement


@dataclass(slots=True)
class PieceCommands:
    """The commands for pieces, each given by its rising edge; `fault`: why the last of all commands was refused."""

    take_sample: Edge = var.part(Edge)
    order_add: Edge = var.part(Edge)
    order_skip: Edge = var.part(Edge)
    order_clear: Edge = var.part(Edge)
    mark: Edge = var.part(Edge)
    calibrate: Edge = var.part(Edge)
    calibration_reset: Edge = var.part(Edge)
    clear_statistics: Edge = var.part(Edge)
    fault: int = 0

    def take_levels(self, block: CuttingInterface) -> None:
        """Take the present levels of the commands as they are: the first value seen is no edge."""
        self.take_sample.take_level(block.take_sample)
        self.order_add.take_level(block.order.add)
        self.order_skip.take_level(block.order.skip)
        self.order_clear.take_level(block.order.clear)
        self.mark.take_level(block.mark.detected)
        self.calibrate.take_level(block.calibration.execute)
        self.calibration_reset.take_level(block.calibration.reset)
        self.clear_statistics.take_level(block.clear_statistics)

    def obey(self, block: CuttingInterface, records: PieceRecords, material: Material) -> None:
        """Carry out the commands for statistics, calibration and orders."""
        if self.clear_statistics.try_rise(block.clear_statistics):
            self.fault = PieceFault.NONE
            records.clear(block.statistics)
        self.obey_calibration(block.calibration, block.last.length, material)
        self.obey_orders(block.order, block.take_sample, material)

    def obey_calibration(self, calibration: Calibration, last_length: float, material: Material) -> None:
        """Carry out calibration.reset and calibration.execute: change the factor of calibration."""
        if self.calibration_reset.try_rise(calibration.reset):
            self.fault = PieceFault.NONE
            calibration.factor = 1.0
        if self.calibrate.try_rise(calibration.execute):
            calibrated = calibrated_factor(calibration, last_length, material)
            self.fault = PieceFault.CALIBRATION
            if calibrated > 0.0:
                self.fault = PieceFault.NONE
                calibration.factor = calibrated

    def obey_orders(self, order: Order, take_sample: bool, material: Material) -> None:
        """Carry out order.clear, order.skip, order.add, take_sample."""
        if self.order_clear.try_rise(order.clear):
            self.fault = PieceFault.NONE
            material.orders.clear()
        if self.order_skip.try_rise(order.skip):
            self.fault = PieceFault.NONE
            if material.orders.waiting > 0:
                material.orders.drop()
        if self.order_add.try_rise(order.add):
            self.add_order(order, material)
        if self.take_sample.try_rise(take_sample):
            self.fault = PieceFault.NONE
            material.is_sample_pending = True

    def add_order(self, order: Order, material: Material) -> None:
        """Append an order, if it is one and the queue is not full."""
        if not (order.length > 0.0 and order.quantity >= 1):
            self.fault = PieceFault.ORDER
        elif material.orders.is_full():
            self.fault = PieceFault.ORDERS_FULL
        else:
            self.fault = PieceFault.NONE
            material.orders.append(order.length, float(order.quantity))


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
