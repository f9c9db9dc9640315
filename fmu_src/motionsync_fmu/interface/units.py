"""The units of an FMU: the units of positions that a build may choose, and the units that follow from the choice."""

import math

from motionsync.var import Unit

BASES = {  # the units of positions that a build may choose, each in SI base units: the base unit, and its factor
    "mm": ("m", 1e-3),
    "m": ("m", 1.0),
    "deg": ("rad", math.pi / 180.0),
    "rad": ("rad", 1.0),
    "1": ("", 1.0),
}
DEGREE = "deg"


def unit_name(kind: Unit, unit: str, slave_unit: str = "") -> str:
    """The name of a unit, as `mm/s2`, `1/deg2` or `deg/mm`; the empty string for a pure number.

    `unit`: the unit of positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`). Both are
    keys of BASES.
    """
    powers: dict[str, int] = {}
    factors = ((unit, kind.position), (slave_unit or unit, kind.slave), (DEGREE, kind.degree), ("s", kind.second))
    for symbol, exponent in factors:
        powers[symbol] = powers.get(symbol, 0) + exponent
    powers.pop("1", None)
    above = "".join(_power(symbol, exponent) for symbol, exponent in powers.items())
    below = "".join(f"/{p}" for symbol, exponent in powers.items() if (p := _power(symbol, -exponent)))
    return (above or "1") + below if above or below or kind is not Unit.NONE else ""


def base_unit(kind: Unit, unit: str, slave_unit: str = "") -> tuple[dict[str, int], float]:
    """A unit in SI base units: the exponent of each base unit that has one, and the factor."""
    powers: dict[str, int] = {}
    factor = 1.0
    for symbol, exponent in ((unit, kind.position), (slave_unit or unit, kind.slave), (DEGREE, kind.degree)):
        base, size = BASES[symbol]
        powers[base] = powers.get(base, 0) + exponent
        factor *= size**exponent if exponent >= 0 else 1.0 / size**-exponent
    powers["s"] = kind.second
    return {symbol: power for symbol, power in powers.items() if symbol and power}, factor


def metres_per_minute(velocity: float, unit: str) -> float | None:
    """A line's velocity as the trade gives it, in m/min; None for a unit of positions that is no length."""
    base, size = BASES[unit]
    return velocity * size * 60.0 if base == "m" else None


def _power(symbol: str, exponent: int) -> str:
    """A unit raised to a power > 0; the empty string for the other powers."""
    return "" if not symbol or exponent <= 0 else symbol + (str(exponent) if exponent > 1 else "")
