"""Values within limits, and limits that can be computed with."""

LEAST_LIMIT = 1e-12
MOST = 1e12
LEAST_RATE = 1e-60  # u/s and u/s2: quotients and powers of smaller rates may leave the range of a double ...
MOST_RATE = 1e24  # ... and so may those of greater ones; ordinary rates, products of two inputs, are within
SHORTEST = 1e-80  # s: so may those of shorter times


def clamp(x: float, low: float, high: float) -> float:
    """The value between `low` and `high` that is nearest to `x`; `low` <= `high`."""
    return max(low, min(x, high))


def computable(rate: float) -> float:
    """The velocity or acceleration that can be computed with and is nearest to this one; 0 keeps the sign."""
    return clamp(rate, -MOST_RATE, MOST_RATE) if abs(rate) >= LEAST_RATE else 0.0 * rate


def usable(limit: float) -> bool:
    """Whether a limit of a motion, in any unit, can be computed with: 1e-12 to 1e12, where nothing overflows."""
    return LEAST_LIMIT <= limit <= MOST
