"""What a machine that cuts to length puts out besides its setpoint and its pieces."""

from .faults import PieceFault
from .interface import LineRequest, Order
from .orders import OrderQueue


def show_orders(order: Order, orders: OrderQueue) -> None:
    """The queue of orders."""
    order.waiting = orders.waiting
    order.remaining = int(orders.remaining_pieces())
    order.length_active = orders.length(0) if orders.waiting > 0 else 0.0


def show_line_request(line: LineRequest, fault: int, margin: float, max_velocity: float) -> None:
    """What the machine asks of the line, whose highest admissible velocity is `max_velocity`, u/s."""
    line.stop_request = fault != PieceFault.NONE
    line.velocity_request = 0.0
    if fault == PieceFault.NONE:
        admissible = (1.0 - margin) * max_velocity
        line.velocity_request = min(line.wanted_velocity, admissible)
