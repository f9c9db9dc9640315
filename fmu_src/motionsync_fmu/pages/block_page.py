"""The pages inside an FMU: the block's README with a picture of its example, and its variables; all from its source."""

from collections.abc import Mapping
from typing import Any

from motionsync.master import MasterInput

from .. import HOME, __version__
from ..archive import Files
from ..interface.recipe import Fmi
from ..interface.table import groups
from ..interface.variables import members, summary, variables
from ..native.platforms import TITLES
from ..scenario.judge import read_reference
from ..scenario.scenario import Scenario
from .compact import compact_page
from .pictures import svg
from .readme import readme, rendered
from .style import TEMPLATES

PICTURE = "example.svg"
WIRED_BEFORE = "<h2>Names in the source system</h2>"  # what most readers do not need


def pages(
    block: Any,
    example: Scenario,
    unit: str,
    flavour: str,
    platforms: list[str],
    slave_unit: str = "",
    turned: Mapping[str, str] | None = None,
    related: bool = False,
    fmi: Fmi = Fmi.TWO,
    sources: bool = False,
) -> Files:
    """index.html and its picture, and for the python flavour externalDependencies.html.

    `block` has the FMU's start values; `platforms`: the folders of its binaries; `unit`: the unit of
    positions; `slave_unit`: the unit of the slave's positions (empty: the same as `unit`); `turned`: as for
    `variables`; `related`: whether the FMU has the example's `related_files`; `fmi`: the version of the FMU;
    `sources`: whether it brings its C along.

    Raises:
        UserError: the block has no README.md, or refuses its example.
    """
    text = rendered(readme(type(block)), PICTURE, example.title)
    use, head, details = text.partition(WIRED_BEFORE)
    reference = read_reference(example) if related else None
    values = {
        "name": type(block).__name__,
        "version": __version__,
        "home": HOME,
        "summary": summary(type(block)),
        "use": use,
        "details": head + details,
        "inputs": list(MasterInput),
        "remote": example.remote.names if example.remote else None,
        "groups": groups(block, unit, slave_unit, turned),
        "choices": {v.cell.type: v.choices for v in variables(block) if v.choices},
        "codes": {v.declaration.codes: members(v.declaration.codes) for v in variables(block) if v.declaration.codes},
        "describe": summary,
        "flavour": flavour,
        "fmi": fmi,
        "title": example.title,
        "tolerance": reference[2] if reference else None,
        "sources": sources,
        "platforms": {p: TITLES[p] for p in platforms},
    }
    names = ["index.html"] + (["externalDependencies.html"] if flavour == "python" else [])
    files = {page: compact_page(TEMPLATES.get_template(f"{page}.j2").render(values)).encode() for page in names}
    return files | {PICTURE: svg(example, unit, slave_unit)}
