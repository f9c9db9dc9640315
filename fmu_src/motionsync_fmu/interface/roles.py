"""The variables that mean something to a tool, by the roles that a block declares: those of a block that works in
cycles on telegrams, and of one that records the pieces that it cuts off."""

from collections.abc import Iterable
from dataclasses import MISSING, dataclass, field, fields
from typing import Any

from motionsync.var import Role

from .variables import Variable

MOTION = ("position", "velocity", "acceleration")  # an axis has its motion under these names


@dataclass(frozen=True)
class RemoteAxisVariables:
    """An axis of which a block gets telegrams alone, and the names of the variables that belong to it.

    Attributes:
        part: the part of the block that is the axis; its inputs are the cycle index and, by the names in MOTION, the
            motion.
        cycle_index: the sender's cycle counter in the telegram.
        wraps_at: the counter starts again at 0 when it would reach this number.
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


def _of(role: Role, sibling: str = "", default: Any = MISSING) -> Any:
    """The field for the name of the variable with a role, or for that of its `sibling` in the same part; without a
    default the block has to have it."""
    return field(default=default, metadata={"role": role, "sibling": sibling})


@dataclass(frozen=True, kw_only=True)
class PieceVariables:
    """The names of the variables by which a block reports the pieces that it cuts off the master's material. Such a
    block has all these roles.

    Attributes:
        pieces: how many have been cut off; when it rises, the next variables describe the last piece.
        skipped, late: how many cuts were left out or made late.
        length, error: of the last piece, in u; the error is the length less what was ordered.
        kind: an enumeration with the member PRODUCT.
        in_tolerance: whether the piece is a good product.
        time: when the tool came in sync for its cut, in s of the block's clock.
        reserve: the share of its cycle that was left.
        orders, remaining, repeat: how many orders are left, the active one included; the pieces that this one lacks;
            whether orders are appended anew, so that there is always one.
        running: whether pieces are cut.
        cutting: whether the tool works in the material, in sync with it.
        coupling_factor: the slave's travel over the master's in sync.
        cut_spacing, edge_radius: of a tool that turns, the slave's travel from cut to cut, and per rad where its edge
            is in sync along the material (else 0); empty for another tool.
        factors: their product is the material's true travel over the master's.
        kerf: the length of material that a cut removes, in u.
        correction: by how much pieces are cut longer than the reported length, in u.
        tolerance: how far the length of a good piece may be off, in u.
        max_velocity: the greatest velocity of the master at which each cut is reached, in u/s.
        spare: the share of a cycle that is left at the present velocity.
        request: the velocity that the block asks the master for, in u/s.
    """

    pieces: str = _of(Role.PIECES)
    skipped: str = _of(Role.PIECES, "skipped")
    late: str = _of(Role.PIECES, "late")
    length: str = _of(Role.LAST_LENGTH)
    error: str = _of(Role.LAST_LENGTH, "error")
    kind: str = _of(Role.LAST_LENGTH, "kind")
    in_tolerance: str = _of(Role.LAST_LENGTH, "good")
    time: str = _of(Role.LAST_LENGTH, "time")
    reserve: str = _of(Role.LAST_LENGTH, "reserve")
    orders: str = _of(Role.ORDERS)
    remaining: str = _of(Role.ORDERS, "remaining")
    repeat: str = _of(Role.ORDERS, "repeat")
    running: str = _of(Role.RUNNING)
    cutting: str = _of(Role.CUTTING)
    coupling_factor: str = _of(Role.COUPLING_FACTOR)
    factors: tuple[str, str]  # MATERIAL_FACTOR, CALIBRATION_FACTOR
    kerf: str = _of(Role.KERF)
    correction: str = _of(Role.LENGTH_CORRECTION)
    tolerance: str = _of(Role.LENGTH_TOLERANCE)
    max_velocity: str = _of(Role.MAX_MASTER_VELOCITY)
    spare: str = _of(Role.MAX_MASTER_VELOCITY, "reserve")
    request: str = _of(Role.MASTER_REQUEST)
    cut_spacing: str = _of(Role.CUT_SPACING, default="")
    edge_radius: str = _of(Role.EDGE_RADIUS, default="")

    @property
    def turns(self) -> bool:
        """Whether the tool turns from cut to cut."""
        return bool(self.cut_spacing)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The outputs that describe the pieces of a run."""
        last = (self.length, self.error, self.kind, self.in_tolerance, self.time, self.reserve)
        turning = (self.cut_spacing, self.edge_radius) if self.turns else ()
        counted = (self.pieces, self.skipped, self.late)
        return (*counted, *last, self.running, self.cutting, self.coupling_factor, self.max_velocity, *turning)


def find_by_role(variables: Iterable[Variable], role: Role) -> Variable | None:
    """The variable that has this role, if there is one."""
    return next((v for v in variables if v.declaration.role is role), None)


def remote_axis(variables: Iterable[Variable]) -> RemoteAxisVariables | None:
    """The remote axis of the block with these variables; None for a block that has a master.

    Raises:
        KeyError: the block has a cycle index, but not all the other roles.
    """
    by_role = {v.declaration.role: v for v in variables if v.declaration.role}
    if Role.CYCLE_INDEX not in by_role:
        return None
    index = by_role[Role.CYCLE_INDEX]
    others = (Role.TASK_CYCLE, Role.DATA_CYCLE, Role.DELAY, Role.CORRECTED_INDEX)
    names = (by_role[role].name for role in others)
    return RemoteAxisVariables(index.name.rpartition(".")[0], index.name, index.declaration.wraps_at, *names)


def piece_variables(variables: Iterable[Variable]) -> PieceVariables | None:
    """The variables by which a block reports its pieces; None for a block that does not.

    Raises:
        KeyError: the block counts PIECES, but has not all the other roles.
    """
    by_role = {v.declaration.role: v.name for v in variables if v.declaration.role}
    if Role.PIECES not in by_role:
        return None

    def name(role: Role, sibling: str) -> str:
        return f"{by_role[role].rpartition('.')[0]}.{sibling}" if sibling else by_role[role]

    named = [f for f in fields(PieceVariables) if f.metadata]
    names = {f.name: name(**f.metadata) for f in named if f.default is MISSING or f.metadata["role"] in by_role}
    return PieceVariables(factors=(by_role[Role.MATERIAL_FACTOR], by_role[Role.CALIBRATION_FACTOR]), **names)
