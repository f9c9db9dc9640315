"""Positions that repeat on an axis: the turns of a modulo axis, and grids of equal spacing."""

ROUNDING = 1e-15  # of a position: what is smaller is taken for a rounding error
SPACING_ROUNDING = 1e-12  # of a grid's spacing: a smaller distance is rounding, summed up over many spacings


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


def nearest_on_grid(base: float, spacing: float, position: float) -> float:
    """Of the positions base + n spacing the one nearest to `position`; with a spacing of 0, `base`."""
    if spacing == 0.0:
        return base
    return base + floor((position - base) / spacing + 0.5) * spacing


def rounding_tolerance(a: float, b: float) -> float:
    """The difference of two positions, u, up to which they are taken for the same: 1e-15 of both magnitudes."""
    return ROUNDING * (abs(a) + abs(b))


def grid_tolerance(base: float, spacing: float, position: float) -> float:
    """The distance, u, up to which `position` is on the grid base + n spacing: rounding, and 1e-12 of the spacing."""
    return rounding_tolerance(position, base) + SPACING_ROUNDING * spacing


def first_on_grid_ahead(base: float, spacing: float, direction: float, position: float, including: bool) -> float:
    """Of the positions base + n spacing the first one ahead of `position` in a direction, 1 or -1.

    One within `grid_tolerance` of `position` counts as ahead if `including`, and as passed if not. With a spacing of 0
    the result is `base`, ahead or not.
    """
    if spacing == 0.0:
        return base
    margin = grid_tolerance(base, spacing, position)
    missing = direction * (position - base) + (-margin if including else margin)
    return base - direction * floor(-missing / spacing) * spacing


def first_on_grid_from(base: float, spacing: float, lowest: float) -> float:
    """Of the positions base + n spacing the first one that is not before `lowest`; with a spacing of 0, `base`."""
    if spacing == 0.0:
        return base
    return base - floor((base - lowest) / spacing) * spacing
