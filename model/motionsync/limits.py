"""Values within limits, and limits that can be computed with."""

LEAST_LIMIT = 1e-12
MOST = 1e12


def clamp(x: float, low: float, high: float) -> float:
    """The value between `low` and `high` that is nearest to `x`; `low` <= `high`."""
    return max(low, min(x, high))


def usable(limit: float) -> bool:
    """Whether a limit of a motion, in any unit, can be computed with: 1e-12 to 1e12, where nothing overflows."""
    return LEAST_LIMIT <= limit <= MOST
