"""What the parameters of a cycle amount to: whether they are in order, and which travels of the master follow.

Source: Robox mv_follow2. Every function reads the parameters as they are in the present step; what has to keep an
earlier value is in `CycleState`. `park` is where the slave is parked, which may be an earlier `park_slave`. Positions
and travels of the master are in M, those of the slave in S; k is `k_slave_master`, in S/M.
"""

from ..limits import MOST, usable
from .faults import Fault
from .interface import LEAST_LENGTH, FollowerInterface

SAME_PLACE = 1e-9  # of the master's cycle: places that differ by less are the same
ROUNDING = 1e-12  # of the master's cycle: a travel that is not greater is nothing but rounding


def parameter_fault(parameters: FollowerInterface, park: float) -> Fault:
    """ORDER, RATIO, NO_ROOM or NONE; a value that is not finite or beyond 1e12 is out of order."""
    if not in_order(parameters, park):
        return Fault.ORDER
    if not usable(parameters.k_slave_master):
        return Fault.RATIO
    if not LEAST_LENGTH <= parameters.master_cycle <= MOST:
        return Fault.NO_ROOM
    return Fault.NONE if room(parameters, park) > ROUNDING * parameters.master_cycle else Fault.NO_ROOM


def in_order(parameters: FollowerInterface, park: float) -> bool:
    """park < sync_slave < sync_out, of a cyclic slave < park + slave_cycle, and the spaces in their ranges."""
    sync = parameters.sync_slave
    out = parameters.sync_out
    if not (bounded(park) and bounded(sync) and bounded(out) and 0.0 <= parameters.space_wait_in_park <= MOST):
        return False
    if not (sync - park >= LEAST_LENGTH and out > sync):
        return False
    if parameters.slave_cycle > 0.0:
        return park + parameters.slave_cycle - out >= LEAST_LENGTH
    return LEAST_LENGTH <= parameters.space_stop_slave <= MOST


def start_computable(parameters: FollowerInterface) -> bool:
    """Whether the start of a cycle can be computed, be its parameters in order or not."""
    known = usable(parameters.k_slave_master) and LEAST_LENGTH <= parameters.master_cycle <= MOST
    return known and bounded(parameters.sync_slave) and bounded(parameters.sync_out)


def wait_travel(parameters: FollowerInterface) -> float:
    """space_wait_in_park; 0 while it is out of its range, which is a fault where the next cycle begins."""
    wait = parameters.space_wait_in_park
    return wait if 0.0 <= wait <= MOST else 0.0


def room(parameters: FollowerInterface, park: float) -> float:
    """Master travel that a cycle leaves: to a linear slave for the way home, to a cyclic one for that and the approach
    (R)."""
    synchronous = (parameters.sync_out - parameters.sync_slave) / parameters.k_slave_master
    rest = parameters.master_cycle - synchronous - parameters.space_wait_in_park
    if parameters.slave_cycle > 0.0:
        return rest
    return rest - ramp_travel(parameters, park) - 2.0 * parameters.space_stop_slave / parameters.k_slave_master


def ramp_travel(parameters: FollowerInterface, park: float) -> float:
    """M_f of the simple jerk ramp from the park to sync_slave: k times it is twice the slave's travel."""
    return 2.0 * (parameters.sync_slave - park) / parameters.k_slave_master


def steady_approach_travel(parameters: FollowerInterface) -> float:
    """M_f when one cycle follows another: shorter than a ramp's where a cyclic slave that parks lacks the room."""
    forth = parameters.sync_slave - parameters.park_slave
    back = parameters.park_slave + parameters.slave_cycle - parameters.sync_out
    ramp = ramp_travel(parameters, parameters.park_slave)
    if parameters.slave_cycle == 0.0:
        return ramp
    travel = room(parameters, parameters.park_slave)
    if travel >= 2.0 * (forth + back) / parameters.k_slave_master * (1.0 - SAME_PLACE):
        return ramp
    return travel * (forth / (forth + back))


def half_synchronous_travel(parameters: FollowerInterface) -> float:
    """Half the master's travel in the synchronized phase."""
    return 0.5 * (parameters.sync_out - parameters.sync_slave) / parameters.k_slave_master


def bounded(position: float) -> bool:
    """Whether a position is finite and within 1e12."""
    return abs(position) <= MOST
