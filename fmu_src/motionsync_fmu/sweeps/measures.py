"""The measures of a sweep: figures of outputs over a whole run, as the command line and the plan give them.

`batch/reductions.py` defines the kinds."""

from collections.abc import Iterable, Mapping, Sequence

from ..batch.reductions import parse_measures
from ..errors import UserError, resolve_name
from ..interface.recipe import Recipe

Measures = Mapping[str, Sequence[str]]  # the kinds by the name of the output


def parse_texts(texts: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The measures for texts such as `slave.velocity=max,max_time`; an output may be named in several texts.

    Raises:
        UserError: a text that is no `NAME=KIND,...`.
    """
    kinds_by_output: dict[str, tuple[str, ...]] = {}
    for text in texts:
        name, kinds = text.partition("=")[0].strip(), [kind.strip() for kind in text.partition("=")[2].split(",")]
        if not name or not all(kinds):
            raise UserError(f"--measure {text}: it must be NAME=KIND,..., as in slave.velocity=max,max_time")
        kinds_by_output[name] = (*kinds_by_output.get(name, ()), *kinds)
    return kinds_by_output


def check_measures(requested: Mapping[str, str | Sequence[str]], recipe: Recipe) -> dict[str, tuple[str, ...]]:
    """The measures, each a figure of an output or local variable that is one number for a run.

    Raises:
        UserError: one is not, or is given twice; the message names it, and lists those that there are.
    """
    kinds_by_output: dict[str, tuple[str, ...]] = {}
    for name, kinds in requested.items():
        output = resolve_name(recipe.variables, name, f"variable of {recipe.name}")
        kinds_by_output[output] = (*kinds_by_output.get(output, ()), *((kinds,) if isinstance(kinds, str) else kinds))
    for measure in parse_measures(recipe.variables, kinds_by_output, recipe.name):
        v = measure.variable
        if v.settable:
            raise UserError(f"{v.name} is a {v.variability} {v.causality}: outputs and local variables are measured")
        if measure.base_kind == "every":
            raise UserError(f"{v.name}: the measure {measure.kind!r} is many numbers, and a row has one a measure")
    return kinds_by_output


def join_measures(*several: Measures) -> dict[str, tuple[str, ...]]:
    """All measures together, each once."""
    names = dict.fromkeys(name for some in several for name in some)
    return {name: tuple(dict.fromkeys(kind for some in several for kind in some.get(name, ()))) for name in names}
