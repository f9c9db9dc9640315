"""The variables of a block that works in cycles on telegrams, found by the roles that the block declares."""

from collections.abc import Iterable
from dataclasses import dataclass

from motionsync.var import Role

from .variables import Variable

MOTION = ("position", "velocity", "acceleration")  # an axis has its motion under these names


@dataclass(frozen=True)
class RemoteAxis:
    """An axis that a block knows by telegrams alone, and the names of the variables that belong to it.

    Attributes:
        part: the part of the block that is the axis; its inputs are the cycle index and, by the names in MOTION, the
            motion.
        cycle_index: the sender's cycle counter in the telegram.
        wraps_at: the counter begins again at 0 where it would reach this number.
        task_cycle: the length of the block's own cycles, in s.
        data_cycle: the nominal length of the sender's cycles, in s; 0: the same as the block's own.
        delay: the time by which the outputs are later than the cycle's instant, in s.
        corrected_index: the sender's cycle index as the block estimates it.
    """

    part: str
    cycle_index: str
    wraps_at: int
    task_cycle: str
    data_cycle: str
    delay: str
    corrected_index: str


def with_role(variables: Iterable[Variable], role: Role) -> Variable | None:
    """The variable that has this role, if there is one."""
    return next((v for v in variables if v.declaration.role is role), None)


def remote_axis(variables: Iterable[Variable]) -> RemoteAxis | None:
    """The remote axis of the block with these variables; None for a block that has a master.

    Raises:
        KeyError: the block has a cycle index, but not all the other roles.
    """
    by_role = {v.declaration.role: v for v in variables if v.declaration.role}
    if Role.CYCLE_INDEX not in by_role:
        return None
    index = by_role[Role.CYCLE_INDEX]
    return RemoteAxis(
        index.name.rpartition(".")[0],
        index.name,
        index.declaration.wraps_at,
        by_role[Role.TASK_CYCLE].name,
        by_role[Role.DATA_CYCLE].name,
        by_role[Role.DELAY].name,
        by_role[Role.CORRECTED_INDEX].name,
    )
