"""What follows from the parameters of a cycle: whether they are valid, and the travels of the master.

Source: Robox mv_follow2. Every function reads the parameters as they are in the present step; what has to keep an
earlier value is in `CycleState`. `park` is where the slave is parked, which may be an earlier `park_slave`. Positions
and travels of the master are in M, those of the slave in S; k is `k_slave_master`, in S/M.
"""

from ..numerics.computable_range import LARGEST, is_usable
from .faults import Fault
from .interface import LEAST_LENGTH, FollowerInterface

POSITION_TOLERANCE = 1e-9  # of the master's cycle: positions that differ by less are the same
ROUNDING = 1e-12  # of the master's cycle: a travel that is not greater is nothing but rounding


def parameter_fault(parameters: FollowerInterface, park: float) -> Fault:
    """ORDER, RATIO, CYCLE_TOO_SHORT or NONE; a value that is not finite or beyond 1e12 is out of order."""
    if not is_in_order(parameters, park):
        return Fault.ORDER
    if not is_usable(parameters.k_slave_master):
        return Fault.RATIO
    if not LEAST_LENGTH <= parameters.master_cycle <= LARGEST:
        return Fault.CYCLE_TOO_SHORT
    is_long_enough = remaining_travel(parameters, park) > ROUNDING * parameters.master_cycle
    return Fault.NONE if is_long_enough else Fault.CYCLE_TOO_SHORT


def is_in_order(parameters: FollowerInterface, park: float) -> bool:
    """park < sync_slave < sync_out, of a cyclic slave < park + slave_cycle, and the spaces in their ranges."""
    sync = parameters.sync_slave
    out = parameters.sync_out
    are_bounded = abs(park) <= LARGEST and abs(sync) <= LARGEST and abs(out) <= LARGEST
    if not (are_bounded and 0.0 <= parameters.space_wait_in_park <= LARGEST):
        return False
    if not (sync - park >= LEAST_LENGTH and out > sync):
        return False
    if parameters.slave_cycle > 0.0:
        return park + parameters.slave_cycle - out >= LEAST_LENGTH
    return LEAST_LENGTH <= parameters.space_stop_slave <= LARGEST


def is_start_computable(parameters: FollowerInterface) -> bool:
    """Whether the start of a cycle can be computed, be its parameters in order or not."""
    if not (is_usable(parameters.k_slave_master) and LEAST_LENGTH <= parameters.master_cycle <= LARGEST):
        return False
    return abs(parameters.sync_slave) <= LARGEST and abs(parameters.sync_out) <= LARGEST


def wait_travel(parameters: FollowerInterface) -> float:
    """space_wait_in_park; 0 while it is out of its range, which is a fault where the next cycle starts."""
    wait = parameters.space_wait_in_park
    return wait if 0.0 <= wait <= LARGEST else 0.0


def remaining_travel(parameters: FollowerInterface, park: float) -> float:
    """R: master travel that a cycle leaves for a linear slave's way home, or a cyclic one's way home and approach."""
    synchronous = (parameters.sync_out - parameters.sync_slave) / parameters.k_slave_master
    rest = parameters.master_cycle - synchronous - parameters.space_wait_in_park
    if parameters.slave_cycle > 0.0:
        return rest
    return rest - ramp_travel(parameters, park) - 2.0 * parameters.space_stop_slave / parameters.k_slave_master


def ramp_travel(parameters: FollowerInterface, park: float) -> float:
    """M_f of the simple jerk ramp from the park to sync_slave: k times it is twice the slave's travel."""
    return 2.0 * (parameters.sync_slave - park) / parameters.k_slave_master


def steady_approach_travel(parameters: FollowerInterface) -> float:
    """M_f when one cycle follows another: shorter than a ramp's where a cyclic slave that parks lacks the travel."""
    approach_stroke = parameters.sync_slave - parameters.park_slave
    homing_stroke = parameters.park_slave + parameters.slave_cycle - parameters.sync_out
    ramp = ramp_travel(parameters, parameters.park_slave)
    if parameters.slave_cycle == 0.0:
        return ramp
    travel = remaining_travel(parameters, parameters.park_slave)
    if travel >= 2.0 * (approach_stroke + homing_stroke) / parameters.k_slave_master * (1.0 - POSITION_TOLERANCE):
        return ramp
    return travel * (approach_stroke / (approach_stroke + homing_stroke))
