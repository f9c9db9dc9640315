"""How far the slave may go: a module that imports from the packages around it."""

from ..numerics.computable_range import clamp
from ..numerics.cosine import cosine

FARTHEST = 1e9


def limited(position: float, limit: float) -> float:
    return clamp(position, -FARTHEST, min(limit, FARTHEST))


def slanted(degrees: float) -> float:
    return 1.0 / cosine(degrees)
