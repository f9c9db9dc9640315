"""The flavours that can be built on this machine, and the FMUs that `motionsync run` uses, built where necessary."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from .. import paths
from ..errors import UserError
from ..interface.recipe import Fmi, Recipe
from ..native.platforms import host_platform
from ..optional_dependencies import how_to_install, missing_for_native
from .fmu import NO_PYTHON, BuildOptions, Flavour, Progress, build, fmu_path, ignore, why_outdated
from .guid import compute_guid


def available_flavours(notify: Callable[[str], None]) -> list[Flavour]:
    """The flavours that can be built on this machine, the native one first; `notify` gets a line if that is missing."""
    if not (missing := missing_for_native()):
        return list(Flavour)
    notify(
        f"{missing} is not installed, with which the native flavour is built: the python flavour is taken "
        f"({how_to_install('native')})"
    )
    return [Flavour.PYTHON]


def select_flavours(fmi: Fmi, flavours: Sequence[Flavour], notify: Callable[[str], None]) -> Sequence[Flavour]:
    """The flavours that the user requests; if there are none, those that can be built on this machine.

    Raises:
        UserError: FMUs of this version of FMI cannot have one of the flavours.
    """
    if fmi == Fmi.TWO:
        return flavours or available_flavours(notify)
    if Flavour.PYTHON in flavours:
        raise UserError(NO_PYTHON)
    return [Flavour.NATIVE]


Report = Callable[[str], AbstractContextManager[Progress]]
"""Reports a task while it is done; what it gives reports a part of it."""


@contextmanager
def silent(task: str) -> Iterator[Progress]:
    """A task that nobody is shown."""
    yield ignore


def prepare_fmus(recipes: Sequence[Recipe], flavour: Flavour, report: Report = silent) -> list[Path]:
    """The FMU of each recipe, to be run on this machine. What is missing or stale is built, and reported."""
    prepared: list[tuple[Recipe, Path]] = []
    for recipe in recipes:
        if all(recipe != other for other, _ in prepared):
            prepared.append((recipe, _prepare_fmu(recipe, flavour, report)))
    return [next(fmu for other, fmu in prepared if other == recipe) for recipe in recipes]


def _prepare_fmu(recipe: Recipe, flavour: Flavour, report: Report) -> Path:
    """The FMU in build/ if that is up to date, else one in the user's cache.

    The latter has a library for this machine alone. Therefore it is in a folder from which nobody passes FMUs on. It is
    run only if nobody else can have written it."""
    complete = fmu_path(recipe, paths.OUTPUT, flavour)
    if _is_current(complete, recipe):
        return complete
    platform = host_platform(recipe.fmi) if flavour == Flavour.NATIVE else None
    kind = f"{complete.parent.name}-{platform.folder}" if platform else complete.parent.name
    target = paths.own_cache(kind, compute_guid(recipe).strip("{}")) / complete.name
    if not (_is_current(target, recipe) and paths.is_own(target)):
        with report(f"building {target}{', for this machine alone' if platform else ''}") as notify:
            build(recipe, target, BuildOptions(flavour, platforms=[platform] if platform else ()), notify)
        target.chmod(paths.PRIVATE)
    return target


_CURRENT: set[tuple[object, ...]] = set()
"""The FMUs that this process has found to be up to date: path and version of the file, and recipe."""


def _is_current(fmu: Path, recipe: Recipe) -> bool:
    """Whether an FMU can be used as it is. One whose file has not changed since the last look is not read again."""
    try:
        status = fmu.stat()
    except OSError:
        return False
    version = (fmu.absolute(), status.st_ino, status.st_size, status.st_mtime_ns, repr(recipe))
    if version not in _CURRENT and not why_outdated(fmu, recipe):
        _CURRENT.add(version)
    return version in _CURRENT
