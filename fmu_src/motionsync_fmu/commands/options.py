"""Options that several commands have."""

from collections.abc import Iterable
from typing import Annotated

import typer

from ..errors import UserError
from ..interface.recipe import Fmi
from ..interface.units import BASES

UNITS = "|".join(BASES)
Version = Annotated[Fmi, typer.Option(help="The version of FMI; FMUs of FMI 3.0 are always compiled.")]

# Of the commands that run a scenario with many values.
Sampling = Annotated[
    str, typer.Option(metavar="lhs|sobol", help="How ranges are sampled: Latin hypercube, or Sobol points.")
]
Seed = Annotated[int, typer.Option(help="The seed of the samples.")]
Scheduler = Annotated[
    str, typer.Option(metavar="ADDRESS", help="A Dask scheduler whose workers do it, as tcp://10.0.0.5:8786.")
]
Workers = Annotated[
    int | None, typer.Option(metavar="N", help="Processes of this computer; by default one for each core.")
]
Yes = Annotated[bool, typer.Option("--yes", help="Begin even if there are more than 10^9 runs.")]


def assignments(option: str, texts: Iterable[str], example: str) -> dict[str, str]:
    """The values of an option NAME=VALUE that may be repeated, by name.

    Raises:
        UserError: a text is no assignment, or a name has two values; the message has the option and an example.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise UserError(f"{option} {text}: write NAME=VALUE, as in: {option} {example}")
        if (other := found.setdefault(name, value)) != value:
            raise UserError(f"{option} {name} is given twice, as {other} and as {value}")
    return found
