"""Builds the FMUs of a recipe, and says whether a built FMU is up to date."""

import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import StrEnum
from importlib import metadata
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError, fromstring

from .archive import Files, build_time, digest, runtime, sources, write
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

Finish = Callable[[Path, Callable[[str], None]], Path]  # of a build that is begun: target and `progress` to target

LICENCE = "documentation/licenses/license.txt"  # FMI 3.0 demands this name
NO_COMPONENT = "--wasm: only an FMU of FMI 3.0 can have a WebAssembly component; add --fmi 3"
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
    """Build the FMU of a recipe; `progress` and what follows: as for `NativeBuild`.

    Raises:
        UserError: as `begun`, or as the flavour's build.
    """
    finish = begun(flavour, recipe, platforms, with_sources=with_sources, with_component=with_component)
    return finish(target, progress)


def begun(
    flavour: Flavour,
    recipe: Recipe,
    platforms: Sequence[Platform] = (),
    *,
    with_sources: bool = False,
    with_component: bool = False,
) -> Finish:
    """The build of an FMU, begun; the function that is given finishes it, as `NativeBuild.finish`.

    Raises:
        UserError: as `NativeBuild`.
    """
    if flavour == Flavour.NATIVE:
        return NativeBuild(recipe, platforms, with_sources=with_sources, with_component=with_component).finish
    return lambda target, progress: build_python(recipe, target)


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
    libraries = list((pythonfmu / "resources" / "binaries").glob("*/*"))
    for library in libraries:
        files[f"binaries/{library.parent.name}/{name}{library.suffix}"] = library.read_bytes()
    files[LICENCE] = in_sections(licences("motionsync", "pythonfmu"))
    files |= _documents(recipe, Flavour.PYTHON, (library.parent.name for library in libraries), ())
    return _write(target, recipe, files, OWN_MEMORY, ())


def build_native(
    recipe: Recipe,
    target: Path,
    progress: Callable[[str], None] = lambda text: None,
    platforms: Sequence[Platform] = (),
    *,
    with_sources: bool = False,
    with_component: bool = False,
) -> Path:
    """Build the native FMU of a recipe, as `NativeBuild` does."""
    build = NativeBuild(recipe, platforms, with_sources=with_sources, with_component=with_component)
    return build.finish(target, progress)


class NativeBuild:
    """An FMU with a library for each of these platforms (none: for all), without Python, while it is built: zig's
    processes compile from the beginning on, whatever the program does before it finishes the build.

    `with_sources`: the C that the libraries are compiled from is in the FMU, too; `with_component`: so is the unit as a
    WebAssembly component, of FMI 3.0 only.

    Raises:
        UserError: what builds it is not installed, the block is outside the kernel subset, or an FMU of this version
            has no component.
    """

    def __init__(
        self,
        recipe: Recipe,
        platforms: Sequence[Platform] = (),
        *,
        with_sources: bool = False,
        with_component: bool = False,
    ) -> None:
        block, fmi = recipe.block(), recipe.fmi
        if with_component and fmi != Fmi.THREE:
            raise UserError(NO_COMPONENT)
        check_kernel(type(block).__module__)
        try:
            from .native import libraries, unit_sources  # noqa: PLC0415 (it asks where zig is)
        except ModuleNotFoundError as e:
            other = "; or take --flavour python" if fmi == Fmi.TWO else ""
            raise UserError(
                f"the native flavour is built with {e.name}, which is not installed: {how_to_install('native')}{other}"
            ) from None
        self.recipe, self.platforms = recipe, platforms or OF_VERSION[fmi]
        self.with_sources, self.with_component = with_sources, with_component
        self.unit = unit_sources.c_sources(block, recipe.guid(), recipe.turned, fmi)
        self.compilation = libraries.Compilation(recipe.name, self.unit, self.platforms)

    def finish(self, target: Path, progress: Callable[[str], None] = lambda text: None) -> Path:
        """Write the FMU; `progress` is called with lines of text if compiling takes long.

        Raises:
            UserError: zig failed.
        """
        from .native import libraries, tables, unit_sources  # noqa: PLC0415
        from .native.wasm import component  # noqa: PLC0415

        recipe, block = self.recipe, self.recipe.block()
        c_files = unit_sources.c_names(self.unit) if self.with_sources else ()
        folders = [*(row.folder for row in self.platforms), *([WASM] if self.with_component else [])]
        files = _documents(recipe, Flavour.NATIVE, folders, c_files) | self.compilation.libraries(progress)
        if self.with_component:
            files |= component.component_files(recipe.name, self.unit)
        files[LICENCE] = in_sections(licences("motionsync") | libraries.linked_licences(recipe.fmi))
        if self.with_sources:
            files |= unit_sources.source_files(block, self.unit, recipe.fmi)
        memory = {} if self.with_sources else OWN_MEMORY
        return _write(target, recipe, files, tables.abilities(block) | memory, c_files)


def check_kernel(module: str) -> None:
    """Refuse a block outside the kernel subset, since its compiled code might differ from its behaviour in Python.

    Raises:
        UserError: the block violates the subset; the message has file, line and rule of each violation.
    """
    package = module.partition(".")[0]
    if found := check({name: text.decode() for name, text in sources(module).items()}):
        raise UserError("\n".join(f"{package}/{violation}" for violation in found))


def _documents(recipe: Recipe, flavour: Flavour, platforms: Iterable[str], c_files: Sequence[str]) -> Files:
    """What both flavours hold beside libraries, licences and modelDescription: documentation, picture, example.

    `platforms`: the names of the libraries' folders; `c_files`: the C files among the sources in the FMU."""
    from .pages.block_page import pages  # noqa: PLC0415 (Matplotlib: it takes long to load)
    from .pages.pictures import icon  # noqa: PLC0415
    from .pages.related_files import related_files  # noqa: PLC0415
    from .scenario.example import example_of  # noqa: PLC0415 (NumPy)

    build_time()  # refuses a bad SOURCE_DATE_EPOCH first: Matplotlib's message about it is not clear
    block, example = recipe.block(), example_of(recipe.name)
    related = {} if recipe.starts or recipe.turned else related_files(example)  # of the block as it is declared
    told = bool(related), recipe.fmi, bool(c_files)
    texts = pages(block, example, recipe.unit, flavour, sorted(platforms), recipe.slave_unit, recipe.turned, *told)
    picture = icon(example)
    files = related | {f"documentation/{n}": text for n, text in texts.items()}
    files |= {f"{FOLDER}/icon.png": picture, f"{FOLDER}/terminalsAndIcons.xml": terminals(block, recipe.turned)}
    return files if recipe.fmi == Fmi.THREE else files | {"model.png": picture}


def _write(target: Path, recipe: Recipe, files: Files, abilities: Mapping[str, str], c_files: Sequence[str]) -> Path:
    """Write the FMU with these files and with its descriptions."""
    write(target, files | _descriptions(recipe, abilities, c_files))
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
    """The licence text of each installed distribution, by its name, without those of bundled software."""
    found: Files = {}
    for name in distributions:
        texts = [file for file in metadata.files(name) or [] if "LICEN" in file.name.upper()]
        if not texts:
            raise UserError(f"the licence of {name} is not installed: install motionsync with pip")
        found[name] = min(texts, key=lambda file: len(str(file))).read_binary()
    return found


def in_sections(texts: Files) -> bytes:
    """One text of several, each below its name."""
    return (
        b"\n\n".join(f"{name}\n{'=' * len(name)}\n\n".encode() + text.rstrip() for name, text in texts.items()) + b"\n"
    )


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
