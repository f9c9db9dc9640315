"""Builds the FMUs of a recipe, and says whether a built FMU is up to date."""

import zipfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from importlib import metadata
from importlib.resources import files as package_files
from pathlib import Path, PurePosixPath
from typing import Any
from xml.etree.ElementTree import ParseError, fromstring

from .archive import Deflate, Files, build_time, digest, quick, runtime, sources, write
from .errors import UserError
from .extras import how_to_install
from .interface.fmi2_xml import OWN_MEMORY, SOURCES, complete, content, describe
from .interface.fmi3_xml import build_description, translated
from .interface.recipe import Fmi, Recipe
from .interface.terminals import FOLDER, terminals
from .interface.variables import variables
from .native.platforms import OF_VERSION, WASM, Platform
from .native.subset.modules import check

SCRIPT = """from motionsync_fmu_{tag}.python import slave

slave.keep(globals())
if "{name}Slave" in globals():  # PythonFMU runs this script at each instantiation, and keeps each class that it finds
    {name}Slave = globals()["{name}Slave"]
else:
    from {package}_{tag}.{module} import {name}

    class {name}Slave(slave.BlockSlave):
        block_type = {name}
        build = "{tag}"
        starts = {starts!r}
        turned = {turned!r}
"""

LICENCES = "documentation/licenses"
NO_PYTHON = "the python flavour is of FMI 2.0 only: for --fmi 3 take --flavour native"


class Flavour(StrEnum):
    """How the block gets into the FMU."""

    NATIVE = "native"
    PYTHON = "python"


def build(
    flavour: Flavour,
    recipe: Recipe,
    target: Path,
    progress: Callable[[str], None] = lambda text: None,
    platforms: Sequence[Platform] = (),
    *,
    with_sources: bool = False,
    with_component: bool = False,
) -> Path:
    """Build the FMU of a recipe; `progress` and what follows: as for `build_native`.

    Raises:
        UserError: as `build_native`; or the python flavour cannot be of the recipe's version.
    """
    if flavour == Flavour.NATIVE:
        return build_native(
            recipe, target, progress, platforms, with_sources=with_sources, with_component=with_component
        )
    return build_python(recipe, target)


def build_python(recipe: Recipe, target: Path) -> Path:
    """Build the FMU with PythonFMU's library, PythonFMU itself and motionsync's sources.

    All FMUs of a process share one interpreter, and therefore one `sys.modules`. For this reason the names of
    motionsync's modules in the FMU contain the hash of their sources.

    Raises:
        UserError: the FMU is to be of another version than PythonFMU knows.
    """
    if recipe.fmi != Fmi.TWO:
        raise UserError(NO_PYTHON)
    block, guid, name = recipe.block(), recipe.guid(), recipe.name
    tag = guid[1:9] + guid[10:14]
    package, _, module = type(block).__module__.partition(".")
    starts = {v.name: plain(v.start) for v in variables(block) if v.name in recipe.starts}
    script = SCRIPT.format(
        name=name, tag=tag, package=package, module=module, starts=starts, turned=dict(recipe.turned)
    )
    files: Files = {
        f"resources/{name.lower()}_{tag}.py": script.encode(),
        "resources/slavemodule.txt": f"{name.lower()}_{tag}".encode(),
        **{f"resources/motionsync_fmu_{tag}/{room}__init__.py": b"" for room in ("", "interface/", "python/")},
    }
    files |= {f"resources/{package}_{tag}/{n}": text for n, text in sources(type(block).__module__).items()}
    files |= {f"resources/motionsync_fmu_{tag}/{n}": text for n, text in runtime().items()}
    pythonfmu = Path(str(package_files("pythonfmu")))
    files |= {f"resources/pythonfmu/{p.name}": p.read_bytes() for p in pythonfmu.glob("*.py")}
    for library in (pythonfmu / "resources" / "binaries").glob("*/*"):
        files[f"binaries/{library.parent.name}/{name}{library.suffix}"] = library.read_bytes()
    files |= {f"{LICENCES}/{n}": text for n, text in licences("motionsync", "pythonfmu").items()}
    return _write(target, recipe, Flavour.PYTHON, files, quick, OWN_MEMORY)


def build_native(
    recipe: Recipe,
    target: Path,
    progress: Callable[[str], None] = lambda text: None,
    platforms: Sequence[Platform] = (),
    *,
    with_sources: bool = False,
    with_component: bool = False,
) -> Path:
    """Build the FMU with a library for each of these platforms (none: for all), without Python.

    An FMU for all platforms is packed as small as can be, which takes seconds. `progress` is called with lines of text
    if compiling takes long. `with_sources`: the C that the libraries are compiled from is in the FMU, too;
    `with_component`: so is the unit of FMI 3.0 as a WebAssembly component.

    Raises:
        UserError: what builds it is not installed or failed, or the block is outside the kernel subset.
    """
    block, every = recipe.block(), OF_VERSION[recipe.fmi]
    check_kernel(type(block).__module__)
    try:
        # Zopfli is installed for this flavour only.
        from .native import libraries, packing, tables, unit_sources  # noqa: PLC0415
        from .native.wasm import component  # noqa: PLC0415
    except ModuleNotFoundError as e:
        other = "; or take --flavour python" if recipe.fmi == Fmi.TWO else ""
        raise UserError(
            f"the native flavour is built with {e.name}, which is not installed: {how_to_install('native')}{other}"
        ) from None
    files = libraries.libraries(block, recipe.guid(), platforms or every, progress, recipe.turned, recipe.fmi)
    texts = licences("motionsync") | libraries.linked_licences(recipe.fmi)
    files |= {f"{LICENCES}/{n}": text for n, text in texts.items()}
    if with_sources:
        files |= unit_sources.source_files(block, recipe.guid(), recipe.turned, recipe.fmi)
    if with_component:
        files |= component.component_files(block, recipe.guid(), recipe.turned)
    deflate = packing.smallest if all(row in (platforms or every) for row in every) else quick
    memory = {} if with_sources else OWN_MEMORY
    return _write(target, recipe, Flavour.NATIVE, files, deflate, tables.abilities(block) | memory)


def check_kernel(module: str) -> None:
    """Refuse a block outside the kernel subset, since its compiled code might differ from its behaviour in Python.

    Raises:
        UserError: the block violates the subset; the message has file, line and rule of each violation.
    """
    package = module.partition(".")[0]
    if found := check({name: text.decode() for name, text in sources(module).items()}):
        raise UserError("\n".join(f"{package}/{violation}" for violation in found))


def _write(
    target: Path,
    recipe: Recipe,
    flavour: Flavour,
    files: Files,
    deflate: Deflate,
    abilities: Mapping[str, str],
) -> Path:
    """Write the FMU with these files and with what both flavours hold: documentation, picture, example,
    modelDescription."""
    from .pages.block_page import pages  # noqa: PLC0415 (Matplotlib: it takes long to load)
    from .pages.pictures import icon  # noqa: PLC0415
    from .pages.related_files import related_files  # noqa: PLC0415
    from .scenario.example import example_of  # noqa: PLC0415 (NumPy)

    build_time()  # refuses a bad SOURCE_DATE_EPOCH first: Matplotlib's message about it is not clear
    block, example = recipe.block(), example_of(recipe.name)
    platforms = sorted({name.split("/")[1] for name in files if name.startswith("binaries/")})
    related = {} if recipe.starts or recipe.turned else related_files(example)  # of the block as it is declared
    c_files = sorted(PurePosixPath(name).name for name in files if name.startswith(SOURCES) and name.endswith(".c"))
    told = bool(related), recipe.fmi, bool(c_files)
    texts = pages(block, example, recipe.unit, flavour, platforms, recipe.slave_unit, recipe.turned, *told)
    files = files | related | {f"documentation/{n}": text for n, text in texts.items()}
    picture = icon(example)
    files |= {f"{FOLDER}/icon.png": picture, f"{FOLDER}/terminalsAndIcons.xml": terminals(block, recipe.turned)}
    if recipe.fmi == Fmi.THREE:
        files[f"{LICENCES}/license.txt"] = files.pop(f"{LICENCES}/motionsync.txt")  # FMI 3.0 demands this name
    else:
        files["model.png"] = picture
    write(target, files | _descriptions(recipe, abilities, c_files), deflate)
    return target


def _descriptions(recipe: Recipe, abilities: Mapping[str, str], c_files: Sequence[str]) -> Files:
    """modelDescription.xml and, of FMI 3.0 with sources, their buildDescription.xml."""
    root = describe(recipe.block(), recipe.unit, recipe.slave_unit, recipe.turned)
    complete(root, recipe.guid(), abilities, c_files)
    if recipe.fmi == Fmi.TWO:
        return {"modelDescription.xml": content(root)}
    files = {"modelDescription.xml": content(translated(root))}
    if c_files:
        files[f"{SOURCES}buildDescription.xml"] = content(build_description(recipe.name, c_files))
    return files


def plain(value: Any) -> Any:
    """A value as the script in the FMU contains it: a member of an enumeration is written as its number."""
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value


def licences(*distributions: str) -> Files:
    """The licence text of each installed distribution, by file name, without those of bundled software."""
    found: Files = {}
    for name in distributions:
        texts = [file for file in metadata.files(name) or [] if "LICEN" in file.name.upper()]
        if not texts:
            raise UserError(f"the licence of {name} is not installed: install motionsync with pip")
        found[f"{name}.txt"] = min(texts, key=lambda file: len(str(file))).read_binary()
    return found


def fmu_path(recipe: Recipe, folder: Path, flavour: Flavour) -> Path:
    """<folder>/<flavour>/<FMU>.fmu, of FMI 3.0 <folder>/fmi3/<FMU>.fmu; an FMU with turned variables has its own name,
    <FMU>-<hash of these>.fmu."""
    kind = "fmi3" if recipe.fmi == Fmi.THREE else flavour.value
    turned = digest({name: causality.encode() for name, causality in recipe.turned.items()})[:8]
    return folder / kind / f"{recipe.name}{f'-{turned}' if recipe.turned else ''}.fmu"


def has_sources(fmu: Path) -> bool:
    """Whether an FMU brings its C along."""
    return _holds(fmu, SOURCES)


def has_component(fmu: Path) -> bool:
    """Whether an FMU has the unit as a WebAssembly component."""
    return _holds(fmu, f"binaries/{WASM}/")


def _holds(fmu: Path, folder: str) -> bool:
    with zipfile.ZipFile(fmu) as z:
        return any(name.startswith(folder) for name in z.namelist())


def outdated(fmu: Path, recipe: Recipe) -> str:
    """Why a built FMU cannot be used as it is: "missing" or "stale"; empty if it can be used.

    An FMU is stale if its sources have changed. A damaged file, or one that is no FMU of this block, is stale too."""
    if not fmu.exists():
        return "missing"
    token = "instantiationToken" if recipe.fmi == Fmi.THREE else "guid"
    try:
        with zipfile.ZipFile(fmu) as z:
            built = None if z.testzip() else fromstring(z.read("modelDescription.xml")).get(token)
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, ParseError):
        built = None
    return "" if built == recipe.guid() else "stale"
