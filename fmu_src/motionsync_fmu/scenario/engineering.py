"""Values as engineers write them, in a few digits and with their unit."""

import math
from decimal import Decimal
from functools import lru_cache

from motionsync.var import Unit

from ..interface.units import metres_per_minute, unit_name

ROUNDING = 1e-9  # relative; what is smaller is rounding


@lru_cache(maxsize=4096)  # tolerances and lengths are the same in many runs
def engineering(value: float, unit: str = "", *, scale: float = 0.0, digits: int = 4) -> str:
    """A value as engineers write it: `0.0021 mm`, `1200 mm/s`, `448623 mm/s2`, `3.6e-12 mm`.

    A value with fewer than `digits` digits before its point has `digits` significant ones; the others are whole. One
    below 1e-9 `scale` is `0 (to rounding)`; powers of ten stand for magnitudes below 1e-6 and from 1e9 on only."""
    if not math.isfinite(value):
        return f"{value} {unit}".strip()
    if 0.0 < abs(value) <= ROUNDING * scale:
        return "0 (to rounding)"
    if value == 0.0:
        return f"0 {unit}".strip()
    if 1e-6 <= abs(value) < 1e9:
        whole = math.floor(math.log10(abs(value))) + 1
        text = format(Decimal(f"{value:.{max(digits, whole)}g}"), "f")
    else:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        text = f"{float(mantissa):g}e{int(exponent)}"
    return f"{text} {unit}".strip()


def line_speed(velocity: float, unit: str, *, digits: int = 4) -> str:
    """A line's velocity, in u/s, with that in m/min: `666.7 mm/s (40 m/min)`. `unit`: that of positions."""
    text = engineering(velocity, unit_name(Unit.VELOCITY, unit), digits=digits)
    per_minute = metres_per_minute(velocity, unit)
    return text if per_minute is None else f"{text} ({engineering(per_minute)} m/min)"
