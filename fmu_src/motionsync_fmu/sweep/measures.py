"""The measures of a sweep: figures of outputs over a whole run, as the command line and the plan give them.

What each kind means is told by `native/loop/reductions.py`."""

from collections.abc import Iterable, Mapping, Sequence

from ..errors import UserError, spelled
from ..interface.recipe import Recipe
from ..native.loop.reductions import measures

Measures = Mapping[str, Sequence[str]]  # the kinds by the name of the output


def parsed(texts: Iterable[str], recipe: Recipe) -> dict[str, tuple[str, ...]]:
    """The measures for texts such as `slave.velocity=max,max_time`; an output may be named in several texts.

    Raises:
        UserError: a text that is no `NAME=KIND,...`, an unknown output or kind, or a measure that is given twice.
    """
    found: dict[str, tuple[str, ...]] = {}
    for text in texts:
        name, _, kinds = text.partition("=")
        if not name.strip() or not all(kind.strip() for kind in kinds.split(",")):
            raise UserError(f"--measure {text}: it must be NAME=KIND,..., as in slave.velocity=max,max_time")
        known = spelled(recipe.variables, name.strip(), f"variable of {recipe.name}")
        found[known] = (*found.get(known, ()), *(kind.strip() for kind in kinds.split(",")))
    return checked(found, recipe)


def checked(asked: Mapping[str, str | Sequence[str]], recipe: Recipe) -> dict[str, tuple[str, ...]]:
    """The measures, each a figure of an output or local variable that is one number for a run.

    Raises:
        UserError: one is not; the message names it, and says which there are.
    """
    for measure in measures(recipe.variables, asked, recipe.name):
        v = measure.variable
        if v.settable:
            raise UserError(f"{v.name} is a {v.variability} {v.causality}: outputs and local variables are measured")
        if measure.of == "every":
            raise UserError(f"{v.name}: the measure {measure.kind!r} is many numbers, and a row has one a measure")
    return {name: (kinds,) if isinstance(kinds, str) else tuple(kinds) for name, kinds in asked.items()}


def columns(asked: Measures) -> list[str]:
    """The names of the columns of the rows: `slave.velocity.max`."""
    return [f"{name}.{kind}" for name, kinds in asked.items() for kind in kinds]


def joined(*several: Measures) -> dict[str, tuple[str, ...]]:
    """All measures together, each once."""
    names = dict.fromkeys(name for some in several for name in some)
    return {name: tuple(dict.fromkeys(kind for some in several for kind in some.get(name, ()))) for name in names}
