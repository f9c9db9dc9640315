"""Values within limits, and limits that can be computed with."""

SMALLEST_LIMIT = 1e-12
LARGEST = 1e12
SMALLEST_RATE = 1e-60  # u/s and u/s2: quotients and powers of smaller rates may leave the range of a double ...
LARGEST_RATE = 1e24  # ... and so may those of greater ones; ordinary rates, products of two inputs, are within
SHORTEST_TIME = 1e-80  # s: so may those of shorter times


def clamp(x: float, low: float, high: float) -> float:
    """The value between `low` and `high` that is nearest to `x`; `low` <= `high`."""
    return max(low, min(x, high))


def to_computable_rate(rate: float) -> float:
    """The velocity or acceleration that can be computed with and is nearest to this one; 0 keeps the sign."""
    return clamp(rate, -LARGEST_RATE, LARGEST_RATE) if abs(rate) >= SMALLEST_RATE else 0.0 * rate


def is_usable(limit: float) -> bool:
    """Whether a limit of a motion, in any unit, can be computed with: 1e-12 to 1e12, where nothing overflows."""
    return SMALLEST_LIMIT <= limit <= LARGEST
