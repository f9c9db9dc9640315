"""Which flavour can be built here, and the FMUs that `motionsync run` uses: as they are, or built before."""

from collections.abc import Callable, Sequence
from pathlib import Path

from . import places
from .build import NO_PYTHON, Flavour, build, fmu_path, outdated
from .errors import UserError
from .extras import how_to_install, missing_for_native
from .interface.recipe import Fmi, Recipe
from .native.platforms import here
from .pages.progress import doing


def at_hand(tell: Callable[[str], None]) -> list[Flavour]:
    """The flavours that can be built here, the native one first; `tell` gets a line if that one is left out."""
    if not (missing := missing_for_native()):
        return list(Flavour)
    tell(
        f"{missing} is not installed, with which the native flavour is built: the python flavour is taken "
        f"({how_to_install('native')})"
    )
    return [Flavour.PYTHON]


def chosen(fmi: Fmi, flavours: Sequence[Flavour], tell: Callable[[str], None]) -> Sequence[Flavour]:
    """The flavours that were asked for; else those that can be built here, the native one first.

    Raises:
        UserError: that version of FMI does not go with the flavours.
    """
    if fmi == Fmi.TWO:
        return flavours or at_hand(tell)
    if Flavour.PYTHON in flavours:
        raise UserError(NO_PYTHON)
    return [Flavour.NATIVE]


def ready(recipes: Sequence[Recipe], flavour: Flavour) -> list[Path]:
    """The FMU of each recipe, to be run here. What is missing or stale is built, and told."""
    found: list[tuple[Recipe, Path]] = []
    for recipe in recipes:
        if all(recipe != other for other, _ in found):
            found.append((recipe, _ready(recipe, flavour)))
    return [next(fmu for other, fmu in found if other == recipe) for recipe in recipes]


def _ready(recipe: Recipe, flavour: Flavour) -> Path:
    """The FMU in build/ if that is up to date, else one in the user's cache.

    The latter has a library for this machine alone, and lies where nobody takes it for one to hand on."""
    complete = fmu_path(recipe, places.OUTPUT, flavour)
    if not outdated(complete, recipe):
        return complete
    platform = here(recipe.fmi) if flavour == Flavour.NATIVE else None
    kind = f"{complete.parent.name}-{platform.folder}" if platform else complete.parent.name
    target = places.cache() / kind / recipe.guid().strip("{}") / complete.name
    if outdated(target, recipe):
        with doing(f"building {target}{', for this machine alone' if platform else ''}") as tell:
            build(flavour, recipe, target, tell, [platform] if platform else ())
    return target
