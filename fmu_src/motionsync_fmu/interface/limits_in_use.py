"""The limits with which a block's axis moves, also those that nobody has set."""

from collections.abc import Mapping
from dataclasses import dataclass

from motionsync.numerics.computable_range import SMALLEST_LIMIT
from motionsync.var import Role, Unit

from .variables import Variable

RATES = (Unit.VELOCITY, Unit.ACCELERATION, Unit.JERK)


@dataclass(frozen=True)
class LimitInUse:
    """A limit of the axis, or of a part of its cycle; those of commands are the command's affair.

    Attributes:
        variable: the parameter.
        value: what it stands for, in the parameter's unit: its own value, or that of another one where that is 0.
        reason: "set", "start value", or "as axis.max_acceleration".
    """

    variable: Variable
    value: float
    reason: str


def find_limits_in_use(variables: Mapping[str, Variable], start: Mapping[str, float]) -> list[LimitInUse]:
    """All limits, in the order of the block's variables.

    `start`: values of variables, by name; the others have their own start values."""
    by_role: dict[Role | None, Variable] = {v.declaration.role: v for v in variables.values() if v.declaration.role}

    def in_use(v: Variable) -> LimitInUse:
        value = float(start.get(v.name, v.start))
        other = by_role.get(_stand_in(v))
        if value == 0.0 and other:
            return LimitInUse(v, in_use(other).value, f"as {other.name}")
        return LimitInUse(v, value, "set" if v.name in start else "start value")

    return [in_use(v) for v in variables.values() if _is_limit(v, variables)]


def _is_limit(v: Variable, variables: Mapping[str, Variable]) -> bool:
    is_rate = v.declaration.unit in RATES and v.declaration.smallest == SMALLEST_LIMIT
    return is_rate and v.name.rpartition(".")[0] + ".execute" not in variables


def _stand_in(v: Variable) -> Role | None:
    """The role of the parameter whose value counts where this one is 0."""
    if v.declaration.role:
        return Role.MAX_ACCELERATION if v.declaration.role == Role.MAX_DECELERATION else None
    return Role.__members__.get(f"MAX_{v.name.rpartition('.')[2].upper()}")
