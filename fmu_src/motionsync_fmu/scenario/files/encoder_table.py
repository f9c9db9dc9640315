"""The table [encoder] of a scenario file: what is measured of the master, and how the block takes it."""

from typing import Any

from motionsync.master import MasterInput

from ..encoder import LARGEST_SEED, Encoder
from .toml_tables import TomlTable

KEYS = ("resolution", "noise", "delay", "scale", "runout", "sample_time", "seed")
MOST = 1e12  # u
SMALLEST = 1e-9  # u and s: what is smaller is rounding
LONGEST = 1.0  # s, as of the block's own parameters


def read_encoder(table: TomlTable) -> Encoder:
    """The encoder in the table [encoder].

    Raises:
        UserError: the first mistake in it.
    """
    table.allow_only(*KEYS)
    runout = table.table("runout", required=False)
    runout.allow_only("amplitude", "length")
    has_runout = "runout" in table
    return Encoder(
        table.number_or_0("resolution", smallest=SMALLEST, most=MOST),
        table.number("noise", default=0.0, least=0.0, most=MOST),
        table.number("delay", default=0.0, least=0.0, most=LONGEST),
        table.number("scale", default=1.0, above=0.0, most=MOST),
        runout.number("amplitude", least=0.0, most=MOST) if has_runout else 0.0,
        runout.number("length", least=SMALLEST, most=MOST) if has_runout else 1.0,
        table.number_or_0("sample_time", smallest=SMALLEST, most=LONGEST),
        _seed(table),
    )


def _seed(table: TomlTable) -> int:
    seed = table.whole("seed", default=0)
    if seed > LARGEST_SEED:
        table.fail("seed", f"{seed} is not allowed: it must be 0 to {LARGEST_SEED}")
    return seed


def with_encoder(start: dict[str, Any], encoder: Encoder) -> dict[str, Any]:
    """The start values of a block that takes what this encoder measures: MEASURED, with the encoder's delay and sample
    time, unless the start values have others."""
    values: dict[str, Any] = {"master.input_mode": MasterInput.MEASURED.value}
    if start.get("master.input_mode", MasterInput.MEASURED) == MasterInput.MEASURED:
        values |= {"master.delay": encoder.delay, "master.sample_time": encoder.sample_time}
    return values | start
