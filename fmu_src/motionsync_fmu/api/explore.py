"""What `motionsync explore` does."""

from __future__ import annotations  # help() shows the types as they are written here

from pathlib import Path

from motionsync.blocks import BLOCKS

from .. import paths
from ..errors import UserError
from ..explorer.page import scenarios_of, write_page
from ..fmus.fmu import Flavour, ignore
from ..fmus.prebuilt import Report, prepare_fmus
from ..interface.recipe import Recipe
from ..optional_dependencies import how_to_install, missing_for_native
from ..scenario.files.reader import load_scenario
from ..scenario.files.shipped import find_files
from ..scenario.scenario import Scenario
from .shown import shown


def explore(subject: str | Path, *, output: str | Path | None = None, report: Report | None = None) -> Path:
    """Write a page on which a block is moved by hand, without any tool and without a network; return its path.

    Args:
        subject: a block, or a scenario to start with: its file, its folder or its short name.
        output: the folder for the page, `<block>.html`; by default `build/explore`.
        report: reports a task while it is done; by default this is shown in a notebook only.

    Raises:
        UserError: neither a block nor a scenario has this name, the scenarios are of several blocks, or the compiler is
            not installed.
    """
    if missing := missing_for_native():
        raise UserError(f"{missing} builds the page, and is not installed: {how_to_install('native')}")
    name, scenarios = _find_scenarios(str(subject))
    (fmu,) = prepare_fmus([Recipe(name)], Flavour.NATIVE, shown(report))
    folder = Path(output) if output else paths.output_folder(ignore) / "explore"
    target = folder / f"{name}.html"
    with shown(report)(f"writing {target}, with {len(scenarios)} scenarios") as progress:
        write_page(name, scenarios, fmu, target, progress)
    return target


def _find_scenarios(subject: str) -> tuple[str, list[Scenario]]:
    """The block's name and its scenarios; the page starts with the first one.

    Raises:
        UserError: neither a block nor a scenario has this name, or the scenarios are of several blocks.
    """
    if block := {name.lower(): name for name in BLOCKS}.get(subject.lower()):
        return block, scenarios_of(block)
    requested = [load_scenario(file) for file in find_files(Path(subject))]
    names = sorted({s.recipe.name for s in requested})
    if len(names) > 1:
        raise UserError(f"{subject}: scenarios of several blocks, {', '.join(names)}; a page is of one block")
    files = {s.file.resolve() for s in requested}
    return names[0], requested + [s for s in scenarios_of(names[0]) if s.file.resolve() not in files]
