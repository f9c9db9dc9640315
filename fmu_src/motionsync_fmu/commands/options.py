"""Options that several commands have."""

from collections.abc import Iterable
from typing import Annotated

import typer

from ..errors import UserError
from ..interface.recipe import Fmi
from ..interface.units import BASES

UNITS = "|".join(BASES)
Version = Annotated[Fmi, typer.Option(help="The version of FMI; FMUs of FMI 3.0 are always compiled.")]


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
