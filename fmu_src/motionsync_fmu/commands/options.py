"""Options that several commands have."""

from ..interface.units import BASES

UNITS = "|".join(BASES)
