"""What `motionsync build` does."""

from __future__ import annotations  # help() shows the types as they are written here

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from motionsync.blocks import BLOCKS

from .. import paths
from ..errors import UserError, choose, resolve_name
from ..fmus.fmu import (
    NO_COMPONENT,
    BuildOptions,
    Finish,
    Flavour,
    fmu_path,
    ignore,
    optional_contents,
    start_build,
    why_outdated,
)
from ..fmus.prebuilt import Report, select_flavours
from ..interface.build_time import build_time
from ..interface.causality import CausalityError, Interface
from ..interface.recipe import Fmi, Recipe
from ..interface.units import BASES
from .scenario_source import Value, literal
from .shown import shown

Names = str | Sequence[str]
"""One name, or several."""


def build(
    fmu: Names = (),
    *,
    flavour: Names = (),
    fmi: str = "2",
    unit: str = "mm",
    slave_unit: str = "",
    start: Mapping[str, Value] | None = None,
    as_input: Names = (),
    as_output: Names = (),
    as_parameter: Names = (),
    as_local: Names = (),
    output: str | Path | None = None,
    terminals: bool = False,
    sources: bool = False,
    wasm: bool = False,
    force: bool = False,
    report: Report | None = None,
    notify: Callable[[str], None] | None = None,
    finished: Callable[[BuiltFmu], None] | None = None,
) -> list[BuiltFmu]:
    """Build FMUs that are missing or stale.

    Args:
        fmu: the blocks; all if none is named.
        flavour: `"native"` or `"python"`; by default all that can be built here.
        fmi: the version of FMI, `"2"` or `"3"`.
        unit: of all positions, `"mm"`, `"m"`, `"deg"`, `"rad"` or `"1"`; velocities follow.
        slave_unit: of the slave's positions, for a block whose slave may have another unit than its master; by default
            deg if its tool turns, else `unit`.
        start: start values to bake in, by name: `{"kerf": 4.0}` or `{"kerf": "4 mm"}`; for one block only, as the
            next four.
        as_input: the variables that become inputs, as names or patterns: `"gearing.*"`.
        as_output: those that become outputs.
        as_parameter: those that become parameters.
        as_local: those that become local variables.
        output: the folder for the FMUs, `<flavour>/<block>.fmu`, of FMI 3.0 `fmi3/<block>.fmu`; by default `build`.
        terminals: say in an FMU of FMI 2.0, too, which variables are wired together.
        sources: add the C code, for any other processor; of the native flavour.
        wasm: add a WebAssembly component, of FMI 3.0.
        force: build FMUs that are up to date, too.
        report: reports a task while it is done; by default this is shown in a notebook only.
        notify: called with a message to the user.
        finished: called with each FMU as soon as it is there.

    Returns:
        The FMUs, in the order of blocks and flavours.

    Raises:
        UserError: something that is asked for is not allowed, or the compiler is not installed or fails.
    """
    version = choose({str(v): v for v in Fmi}, fmi, "version of FMI")
    flavours = [choose({str(f): f for f in Flavour}, each, "flavour") for each in _listed(flavour)]
    interface = Interface(as_input, as_output, as_parameter, as_local)
    starts = {name: literal(value) for name, value in (start or {}).items()}
    unit, slave_unit = resolve_name(BASES, unit, "unit"), resolve_name(["", *BASES], slave_unit, "slave unit")
    blocks = [resolve_name(BLOCKS, name, "block") for name in _listed(fmu) or BLOCKS]
    override = next((f"--as-{causality}" for causality, _ in interface.patterns()), "")
    if (option := "--start" if starts else override) and len(blocks) != 1:
        example = f"motionsync build Synchronizer {option} ..."
        raise UserError(f"{option}: name the one block that it is for, as in: {example}")
    recipes = [Recipe(name, unit, starts, slave_unit, interface, version) for name in blocks]
    for recipe in recipes:
        _validate(recipe)
    build_time()  # refuses a bad SOURCE_DATE_EPOCH
    notify = notify or ignore
    chosen = select_flavours(version, flavours, notify)
    folder = Path(output) if output else paths.output_folder(notify)
    if sources and Flavour.NATIVE not in chosen:
        raise UserError("--sources: the python flavour has no C; take --flavour native")
    if wasm and version != Fmi.THREE:
        raise UserError(NO_COMPONENT)
    return _build_all(
        [
            _RequestedBuild(recipe, fmu_path(recipe, folder, options.flavour), options, force)
            for recipe in recipes
            for each in chosen
            for options in [BuildOptions(each, terminals, (), sources and each == Flavour.NATIVE, wasm)]
        ],
        shown(report),
        finished,
    )


@dataclass(frozen=True, repr=False)
class BuiltFmu:
    """An FMU that is there.

    Attributes:
        path: its file.
        recipe: what it is built from: block, units, start values, causalities, version of FMI.
        is_new: whether it was built now; else it was up to date.
        has_replaced: whether it took the place of a file: of an FMU that was stale, or had other start values or units.
    """

    path: Path
    recipe: Recipe
    is_new: bool
    has_replaced: bool

    def __repr__(self) -> str:
        return f"{self.path} ({self.recipe.name}, FMI {self.recipe.fmi}.0, {'new' if self.is_new else 'up to date'})"


@dataclass(frozen=True)
class _RequestedBuild:
    """An FMU to build, and what it shall contain."""

    recipe: Recipe
    target: Path
    options: BuildOptions
    force: bool

    def is_up_to_date(self) -> bool:
        if self.force or why_outdated(self.target, self.recipe):
            return False
        return optional_contents(self.target) == self.options.optional_contents(self.recipe.fmi)

    def start(self) -> Finish:
        """Start the build: zig compiles this FMU while the previous one is finished."""
        return start_build(self.recipe, self.options)


def _build_all(
    builds: Sequence[_RequestedBuild], report: Report, finished: Callable[[BuiltFmu], None] | None
) -> list[BuiltFmu]:
    """Build what is missing or stale; one is compiled while the one before is packed."""
    built: list[BuiltFmu] = []
    finish_next: Finish | None = None
    for this, following in zip(builds, [*builds[1:], None], strict=True):
        finish, finish_next = finish_next, None
        existed = this.target.exists()
        if is_new := not this.is_up_to_date():
            this.target.parent.mkdir(parents=True, exist_ok=True)
            with report(f"building {this.target}") as notify:
                finish = finish or this.start()
                with suppress(UserError):  # its own iteration starts it again, and reports this error
                    finish_next = following.start() if following and not following.is_up_to_date() else None
                finish(this.target, notify)
        built.append(BuiltFmu(this.target, this.recipe, is_new, is_new and existed))
        if finished:
            finished(built[-1])
    return built


def _listed(names: Names) -> Sequence[str]:
    return [names] if isinstance(names, str) else names


def _validate(recipe: Recipe) -> None:
    """Report a mistake in a recipe before anything is built."""
    try:
        recipe.block()
    except CausalityError as e:
        raise UserError(f"--as-{e}") from None
