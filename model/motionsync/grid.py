"""Places on an axis that repeat: the turns of a modulo axis, and grids of equal spacing."""

ROUNDING = 1e-15  # of a position: what is smaller is taken for a rounding error
SAME_PLACE = 1e-12  # of a grid's spacing: what is smaller is taken for a rounding error, summed up over many places


def wrap(position: float, period: float) -> float:
    """`position` modulo `period` in [0, period); `position` itself if the period is 0.

    The remainder is exact for a position >= 0. A negative remainder gets one period added; if that rounds to the period
    itself, the result is 0.
    """
    if period == 0.0:
        return position
    if 0.0 <= position < period:  # nearly always, and a division is slow
        return position + 0.0  # 0 of -0, as the remainder makes it
    wrapped = position % period
    return wrapped if wrapped < period else 0.0


def floor(x: float) -> float:
    """The greatest whole number not above x; from 2^52 on there are only whole numbers."""
    if abs(x) >= 4503599627370496.0:
        return x
    whole = float(int(x))
    return whole - 1.0 if whole > x else whole


def nearest(base: float, spacing: float, position: float) -> float:
    """Of the places base + n spacing the one nearest to `position`; with a spacing of 0, `base`."""
    if spacing == 0.0:
        return base
    return base + floor((position - base) / spacing + 0.5) * spacing


def rounding(a: float, b: float) -> float:
    """The difference of two positions, u, up to which they are taken for the same: 1e-15 of both magnitudes."""
    return ROUNDING * (abs(a) + abs(b))


def grid_tolerance(base: float, spacing: float, here: float) -> float:
    """The distance, u, up to which `here` is at a place of the grid base + n spacing: the `rounding` of base and
    here, and 1e-12 of the spacing."""
    return rounding(here, base) + SAME_PLACE * spacing


def first_ahead(base: float, spacing: float, direction: float, here: float, counts_here: bool) -> float:
    """Of the places base + n spacing the first one ahead of `here` in a direction, 1 or -1.

    A place within `grid_tolerance` of `here` is ahead if `counts_here`, and is passed already if not. With a spacing
    of 0 there is only the place `base`, which is the answer wherever it lies.
    """
    if spacing == 0.0:
        return base
    margin = grid_tolerance(base, spacing, here)
    missing = direction * (here - base) + (-margin if counts_here else margin)
    return base - direction * floor(-missing / spacing) * spacing


def first_at_or_after(base: float, spacing: float, least: float) -> float:
    """Of the places base + n spacing the first one that is not before `least`; with a spacing of 0, `base`."""
    if spacing == 0.0:
        return base
    return base - floor((base - least) / spacing) * spacing
