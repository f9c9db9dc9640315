"""The pages inside an FMU: the block's README with a picture of its example, and its variables; all from its source."""

from collections.abc import Sequence
from dataclasses import dataclass

from motionsync.master import MasterInput

from ..about import HOME, __version__
from ..interface.fingerprint import Files
from ..interface.recipe import Recipe
from ..interface.table import groups
from ..interface.variables import members, summary, variables
from ..native.platforms import TITLES
from ..scenario.files.example import load_example
from .pictures import draw_example
from .readme import read_readme, render_readme
from .style import TEMPLATES, load_template

PICTURE = "example.svg"
WIRING_BEFORE = "<h2>Names in the source system</h2>"  # the section Wiring comes before it


@dataclass(frozen=True)
class FmuContents:
    """What the pages state about the FMU that they are part of.

    Attributes:
        recipe: what the FMU is built from.
        flavour: "native" or "python".
        platforms: the folders of its binaries.
        has_related_files: whether it has the example's `related_files`.
        has_sources: whether it has its C sources.
    """

    recipe: Recipe
    flavour: str
    platforms: Sequence[str]
    has_related_files: bool = False
    has_sources: bool = False


def make_pages(contents: FmuContents) -> Files:
    """Make index.html and its picture, and for the python flavour externalDependencies.html.

    Raises:
        UserError: the block has no README.md, or refuses its example.
    """
    recipe, flavour = contents.recipe, contents.flavour
    block, unit, slave_unit = recipe.block(), recipe.unit, recipe.slave_unit
    example = load_example(recipe.name)
    text = render_readme(read_readme(type(block)), PICTURE, example.title)
    use, heading, details = text.partition(WIRING_BEFORE)
    values = {
        "name": recipe.name,
        "version": __version__,
        "home": HOME,
        "summary": summary(type(block)),
        "use": use,
        "details": heading + details,
        "inputs": list(MasterInput),
        "remote": example.remote.names if example.remote else None,
        "groups": groups(block, unit, slave_unit, recipe.causality_overrides),
        "choices": {v.cell.type: v.choices for v in variables(block) if v.choices},
        "codes": {v.declaration.codes: members(v.declaration.codes) for v in variables(block) if v.declaration.codes},
        "describe": summary,
        "flavour": flavour,
        "fmi": recipe.fmi,
        "title": example.title,
        "tolerance": example.tolerance if contents.has_related_files else None,
        "has_sources": contents.has_sources,
        "platforms": {p: TITLES[p] for p in contents.platforms},
    }
    names = ["index.html"] + (["externalDependencies.html"] if flavour == "python" else [])
    pages = {name: load_template(TEMPLATES, f"{name}.j2").render(values) for name in names}
    return {name: page.encode() for name, page in pages.items()} | {
        PICTURE: draw_example(recipe.name, unit, slave_unit)
    }
