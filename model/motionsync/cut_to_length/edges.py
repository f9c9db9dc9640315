"""The commands of the machine."""

from dataclasses import dataclass

from .. import var
from ..slave import Edge
from .interface import CutToLengthInterface


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

    def hold(self, block: CutToLengthInterface) -> None:
        """Take the present levels of the commands as they are: the first value seen is no edge."""
        self.start.hold(block.start)
        self.stop.hold(block.stop)
        self.abort.hold(block.abort)
        self.reset.hold(block.reset)
        self.cut_now.hold(block.cut_now)
        self.take_sample.hold(block.take_sample)
        self.order_add.hold(block.order.add)
        self.order_skip.hold(block.order.skip)
        self.order_clear.hold(block.order.clear)
        self.mark.hold(block.mark.detected)
        self.done.hold(block.tool.done)
        self.calibrate.hold(block.calibration.execute)
        self.calibration_reset.hold(block.calibration.reset)
        self.clear_statistics.hold(block.clear_statistics)
