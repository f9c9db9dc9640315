"""Options that several commands have."""

from collections.abc import Callable, Iterable
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
    str, typer.Option(metavar="ADDRESS", help="A Dask scheduler, whose workers do the runs, as tcp://10.0.0.5:8786.")
]
Workers = Annotated[
    int | None, typer.Option(metavar="N", help="Processes of this computer; by default one for each core.")
]
Yes = Annotated[bool, typer.Option("--yes", help="Start even if there are more than 10^9 runs.")]


def number_parser(option: str, form: str) -> Callable[[str], float]:
    """The parser of an option that is a number; `form`: what it must be, in words."""

    def parse(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise UserError(f"{option} {text}: it must be {form}") from None

    return parse


def parse_factors(texts: Iterable[str]) -> dict[str, str]:
    """The values of the option --set NAME=VALUES of a sweep, by name.

    Raises:
        UserError: a text is no such setting, or a name is given twice.
    """
    from ..scenario.variation.values import split_setting

    values: dict[str, str] = {}
    for name, text in map(split_setting, texts):
        if name in values:
            raise UserError(f"--set {name}={text}: {name} is given twice, as {name}={values[name]}")
        values[name] = text
    return values


def parse_assignments(option: str, texts: Iterable[str], example: str) -> dict[str, str]:
    """The values of an option NAME=VALUE that may be repeated, by name.

    Raises:
        UserError: a text is no assignment, or a name has two values; the message has the option and an example.
    """
    values: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise UserError(f"{option} {text}: write NAME=VALUE, as in: {option} {example}")
        if (other := values.setdefault(name, value)) != value:
            raise UserError(f"{option} {name} is given twice, as {other} and as {value}")
    return values
