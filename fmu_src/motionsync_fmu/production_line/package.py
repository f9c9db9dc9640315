"""The line as files: an SSP package for FMPy and other tools, and an OSP system structure for libcosim.

The package holds SystemStructure.ssd, the FMUs, and their parameters as a parameter set of the whole system, with names
such as `RemoteSync.delay_time_offset`. The inputs of the system are the telegram and the follower's commands. libcosim
reads packages too, but not if their system has connectors. Therefore it gets a folder with an OSP structure and the
same FMUs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from shutil import copyfile
from typing import Any, NamedTuple

from ..about import __version__
from ..fmus.fmu import BuildOptions, Flavour, build, fmu_path, why_outdated
from ..fmus.zip import write_zip
from ..interface.fmi2_xml import describe
from ..interface.recipe import Recipe
from ..interface.roles import MOTION
from ..interface.units import unit_name
from ..interface.variables import Variable
from ..pages.style import load_template
from ..paths import replace_files
from .line import REMOTE, ProductionLine

TEMPLATES = Path(__file__).parent / "templates"
PARAMETERS = "resources/parameters.ssv"
STRUCTURE = "OspSystemStructure.xml"


@dataclass(frozen=True)
class LinePackage:
    """The files of a line.

    Attributes:
        ssp: the SSP package.
        osp: the OSP system structure, with the FMUs next to it.
        fmus: the built FMUs by component.
    """

    ssp: Path
    osp: Path
    fmus: dict[str, Path]


class Connection(NamedTuple):
    """A wire from an output to an input. An end without the name of a component belongs to the system."""

    start: str
    output: str
    end: str
    input: str


def write_package(line: ProductionLine, flavour: Flavour, output: Path, progress: Callable[[str], None]) -> LinePackage:
    """Build missing and stale FMUs, write OUTPUT/<line>.ssp and OUTPUT/<line>/.

    `progress` is called with a line of text before each build."""
    folder, ssp = output / line.name, output / f"{line.name}.ssp"
    fmus = {name: folder / f"{name}.fmu" for name in line.recipes}
    texts = _render_texts(line)
    osp = folder / STRUCTURE
    with replace_files(folder) as part:
        for name, recipe in line.recipes.items():
            shared = recipe == Recipe(name)  # `motionsync run` uses the same FMU
            built = fmu_path(recipe, output, flavour) if shared else fmus[name]
            if why_outdated(built, recipe):
                progress(f"building {built}")
                built = build(recipe, built if shared else part(built.name), BuildOptions(flavour), progress)
            if shared:
                copyfile(built, part(fmus[name].name))
        part(STRUCTURE).write_bytes(texts.pop(STRUCTURE))
    write_zip(ssp, texts | {f"resources/{name}.fmu": fmu.read_bytes() for name, fmu in fmus.items()})
    return LinePackage(ssp, osp, fmus)


def connections(line: ProductionLine) -> list[Connection]:
    """The wires: telegram and commands enter the system, the axis leads from RemoteSync to the follower, and the
    follower's outputs leave the system."""
    follower = line.follower.recipe.name
    return [
        *(Connection("", name, REMOTE, name) for name in line.telegrams),
        *(Connection("", name, follower, name) for name in line.commands),
        *(Connection(REMOTE, f"slave.{name}", follower, f"master.{name}") for name in MOTION),
        *(Connection(follower, v.name, "", v.name) for v in line.outputs[follower]),
    ]


def _render_texts(line: ProductionLine) -> dict[str, bytes]:
    blocks = {name: recipe.variables for name, recipe in line.recipes.items()}
    values: dict[str, Any] = {
        "line": line,
        "name": line.name,
        "version": __version__,
        "blocks": blocks,
        "connections": connections(line),
        "enumerations": {
            _enumeration_name(name, v): v.choices for name, of in line.outputs.items() for v in of if v.choices
        },
        "enumeration_name": _enumeration_name,
        "unit_of": lambda v: unit_name(v.declaration.unit, line.unit, line.follower.slave_unit),
        "units": _units(line),
        "values": [
            {
                "component": c,
                "variable": n,
                "name": f"{c}.{n}",
                "kind": blocks[c][n].kind,
                "value": blocks[c][n].literal(x),
            }
            for c, start in line.parameters.items()
            for n, x in start.items()
        ],
    }
    names = {"SystemStructure.ssd": "SystemStructure.ssd", PARAMETERS: "parameters.ssv", STRUCTURE: STRUCTURE}
    return {name: load_template(TEMPLATES, f"{t}.j2").render(values).encode() for name, t in names.items()}


def _enumeration_name(component: str, v: Variable) -> str:
    """The name of an enumeration in the system, where a name must denote one type only."""
    return f"{component}.{v.cell.type.__name__}"


def _units(line: ProductionLine) -> list[dict[str, Any]]:
    """The units of all components, as their modelDescriptions define them."""
    units = {}
    for recipe in line.recipes.values():
        for unit in describe(recipe.block(), recipe.unit, recipe.slave_unit).iterfind("UnitDefinitions/Unit"):
            units[unit.get("name")] = dict(unit[0].attrib)
    return [{"name": name, "base": base} for name, base in sorted(units.items())]
