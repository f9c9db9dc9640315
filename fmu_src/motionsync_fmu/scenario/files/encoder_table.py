"""The table [encoder] of a scenario file: what is measured of the master, and how the block takes it."""

from collections.abc import Container
from typing import Any

from motionsync.master import MasterInput

from ..encoder import LARGEST_SEED, Encoder
from .keys import Key, TableKeys, number, whole
from .toml_tables import TomlTable

MOST = 1e12  # u
SMALLEST = 1e-9  # u and s: what is smaller is rounding
LONGEST = 1.0  # s, as of the block's own parameters
SCALING = "master.encoder_scaling"

ENCODER = TableKeys(
    "[encoder]",
    "An encoder between the true master and master.position. In mode MEASURED master.delay and master.sample_time are "
    "those of the encoder, and master.encoder_scaling, where a block has it, is the resolution in every mode, unless "
    "[start] has others.",
    (
        number("resolution", "the position is rounded down to a multiple of it", "u", smallest=SMALLEST, most=MOST),
        number("noise", "one sigma; white, Gaussian, clipped at 4 sigma", "u", default=0.0, least=0.0, most=MOST),
        number("delay", "how old a position is", "s", default=0.0, least=0.0, most=LONGEST),
        number("scale", "the measured travel over the true one", default=1.0, above=0.0, most=MOST),
        Key("runout", "a sine, once a turn of the wheel", "{ amplitude, length }: both numbers in u", "none"),
        number("sample_time", "how long a position is held", "s", smallest=SMALLEST, most=LONGEST),
        whole("seed", "of the noise", default=0, most=LARGEST_SEED),
    ),
)
RUNOUT = TableKeys(
    "runout",
    "",
    (number("amplitude", "", "u", least=0.0, most=MOST), number("length", "", "u", least=SMALLEST, most=MOST)),
)


def read_encoder(table: TomlTable) -> Encoder:
    """The encoder in the table [encoder].

    Raises:
        UserError: the first mistake in it.
    """
    values = ENCODER.read(table)
    if "runout" in table:
        runout = RUNOUT.read(table.table("runout"))
        values |= {f"runout_{name}": value for name, value in runout.items()}
    return Encoder(**values)


def with_encoder(start: dict[str, Any], encoder: Encoder, variables: Container[str]) -> dict[str, Any]:
    """The start values of a block that takes what this encoder measures: MEASURED, with the encoder's delay and sample
    time, and its resolution if `variables`, the names of the block's, have a place for it, unless the start values have
    others."""
    values: dict[str, Any] = {"master.input_mode": MasterInput.MEASURED.value}
    if SCALING in variables:
        values[SCALING] = encoder.resolution
    if start.get("master.input_mode", MasterInput.MEASURED) == MasterInput.MEASURED:
        values |= {"master.delay": encoder.delay, "master.sample_time": encoder.sample_time}
    return values | start
