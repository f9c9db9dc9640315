"""Numbers with a unit, as people write them: `40 m/min`, `6 m`, `4 m/s2`, `250 ms`, `5 ft 6 in`, `100 fpm`."""

import math
import re
from decimal import Decimal
from fractions import Fraction

from ..errors import UserError

Dimensions = dict[str, int]  # the exponents of m, deg and s; none is 0

INCH = Fraction(254, 10_000)  # m
UNITS: dict[str, tuple[Dimensions, Fraction]] = {
    "um": ({"m": 1}, Fraction(1, 1_000_000)),
    "mm": ({"m": 1}, Fraction(1, 1000)),
    "cm": ({"m": 1}, Fraction(1, 100)),
    "m": ({"m": 1}, Fraction(1)),
    "km": ({"m": 1}, Fraction(1000)),
    "in": ({"m": 1}, INCH),
    "inch": ({"m": 1}, INCH),
    '"': ({"m": 1}, INCH),
    "ft": ({"m": 1}, 12 * INCH),
    "'": ({"m": 1}, 12 * INCH),
    "ipm": ({"m": 1, "s": -1}, INCH / 60),
    "fpm": ({"m": 1, "s": -1}, 12 * INCH / 60),
    "deg": ({"deg": 1}, Fraction(1)),
    "rad": ({"deg": 1}, Fraction(180.0 / math.pi)),
    "rev": ({"deg": 1}, Fraction(360)),
    "rpm": ({"deg": 1, "s": -1}, Fraction(6)),
    "us": ({"s": 1}, Fraction(1, 1_000_000)),
    "ms": ({"s": 1}, Fraction(1, 1000)),
    "s": ({"s": 1}, Fraction(1)),
    "min": ({"s": 1}, Fraction(60)),
    "h": ({"s": 1}, Fraction(3600)),
}
NUMBER = r"(?>(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)"
QUANTITY = re.compile(rf"""([+-]?{NUMBER})(?:\s*(?=[a-z"'])|\s+(?=1/))(.+)""", re.IGNORECASE)
FEET_AND_INCHES = re.compile(rf"""([+-]?)({NUMBER})\s*(?:ft|')\s*-?\s*({NUMBER})\s*(?:in|inch|")""", re.IGNORECASE)
PART = re.compile(r"""([a-z]+|["'])\^?([2-9]?)""", re.IGNORECASE)
RAISED = str.maketrans("²³", "23")
MOST_PARTS = 8  # of a unit, between its signs /


def is_quantity(text: str) -> bool:
    """Whether a text is a number with something behind it that may be a unit."""
    return bool(QUANTITY.fullmatch(text.strip()))


def check_ends(first: str, last: str) -> None:
    """Refuse a range of which one end has a unit and the other none: it could mean either.

    Raises:
        UserError: it is such a range.
    """
    if is_quantity(first) != is_quantity(last):
        raise UserError("one end has a unit and the other none: give both theirs, as in 30 m/min..40 m/min")


def read_number(text: str, unit: str) -> float:
    """The number in a text, in this unit; the text may have a unit of its own.

    Raises:
        UserError: the text is no number, or its unit measures something else.
    """
    if is_quantity(text):
        return convert(text, unit)
    try:
        return float(text)
    except ValueError:
        raise UserError(f"{text!r} is not allowed: it must be {describe_number(unit)}") from None


def describe_number(unit: str) -> str:
    """What a number in this unit must be, in words; empty: it has none."""
    return f"a number in {unit}, or with a unit of its own" if unit else "a number"


def convert(text: str, unit: str) -> float:
    """The number of a quantity in another unit: `40 m/min` in `mm/s` is 666.67.

    Raises:
        UserError: the text has no unit, or one that measures something else, or the number is beyond all Reals.
    """
    if match := FEET_AND_INCHES.fullmatch(text.strip()):
        return convert(f"{match[1]}{match[2]} ft", unit) + convert(f"{match[1]}{match[3]} in", unit)
    match = QUANTITY.fullmatch(text.strip())
    if not match:
        raise UserError(f"{text!r} is no number with a unit, as in: 40 m/min")
    dimensions, factor = _parse(match[2])
    required, size = _parse(unit)
    if dimensions != required:
        raise UserError(f"{text!r} is in {match[2]}: it must be in {unit or 'no unit'}, or in what measures the same")
    return _scaled(match[1], factor / size, text)


def _scaled(number: str, factor: Fraction, text: str) -> float:
    """The number times the factor, rounded once; `text`: both, for the message.

    An exponent of nine digits would make integers of as many digits: a number that is no Real is left as it is."""
    value = float(number)
    try:
        scaled = float(Fraction(Decimal(number)) * factor) if math.isfinite(value) and value else value
    except OverflowError:
        scaled = math.inf
    if not math.isfinite(scaled):
        raise UserError(f"{text!r} is not allowed: it must be finite")
    return scaled


def _parse(unit: str) -> tuple[Dimensions, Fraction]:
    """What a unit measures, and its size in m, deg and s.

    Raises:
        UserError: there is no such unit.
    """
    dimensions: Dimensions = {}
    factor = Fraction(1)
    for i, part in enumerate(unit.translate(RAISED).replace(" ", "").split("/") if unit else []):
        if part == "1" and i == 0:
            continue
        match = PART.fullmatch(part) if i < MOST_PARTS else None
        if not match or match[1] not in UNITS:
            raise UserError(f"{unit!r} is no unit; there is {', '.join(UNITS)}, and what is made of them: m/min, mm/s2")
        own, size = UNITS[match[1]]
        power = int(match[2] or 1) * (-1 if i else 1)
        factor *= size**power
        for name, exponent in own.items():
            dimensions[name] = dimensions.get(name, 0) + exponent * power
    return {name: exponent for name, exponent in dimensions.items() if exponent}, factor
