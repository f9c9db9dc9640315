"""Builds the FMUs of recipes, and finds out whether a built FMU is up to date."""

import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from importlib import metadata
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError, fromstring

from ..compiler.subset.expression_rules import Violation
from ..compiler.subset.module_rules import check
from ..errors import UserError
from ..interface.build_time import build_time
from ..interface.fingerprint import Files, collect_sources, digest
from ..interface.fmi2_xml import OWN_MEMORY, SOURCES, complete, content, describe
from ..interface.fmi3_xml import build_description, translated
from ..interface.recipe import Fmi, Recipe
from ..interface.terminals import FOLDER, terminals
from ..interface.variables import variables
from ..native.platforms import OF_VERSION, WASM, Platform
from ..optional_dependencies import how_to_install
from .guid import compute_guid, python_runtime
from .zip import write_zip

SCRIPT = """from motionsync_fmu_{tag}.python import slave

slave.add_references(globals())
if "{name}Slave" in globals():  # PythonFMU runs this script at each instantiation, and keeps each class that it finds
    {name}Slave = globals()["{name}Slave"]
else:
    from {package}_{tag}.{module} import {name}

    class {name}Slave(slave.BlockSlave):
        block_type = {name}
        build = "{tag}"
        starts = {starts!r}
        causality_overrides = {overrides!r}
"""

Progress = Callable[[str], None]  # gets lines of text if a build takes long
Finish = Callable[[Path, Progress], Path]  # completes a build that has been started: writes the FMU to a path

TERMINALS = f"{FOLDER}/terminalsAndIcons.xml"
LICENCE = "documentation/licenses/license.txt"  # FMI 3.0 demands this name
NO_COMPONENT = "--wasm: only an FMU of FMI 3.0 can have a WebAssembly component; add --fmi 3"
NO_PYTHON = "the python flavour is of FMI 2.0 only: for --fmi 3 take --flavour native"


class Flavour(StrEnum):
    """How the block gets into the FMU."""

    NATIVE = "native"
    PYTHON = "python"


@dataclass(frozen=True)
class BuildOptions:
    """What an FMU holds for the same recipe.

    Attributes:
        flavour: how the block gets into the FMU.
        with_terminals: whether an FMU of FMI 2.0 says what is wired together; one of FMI 3.0 always does. FMI 2.0.4
            allows it, but FMILibrary 3, and what uses it, logs an error about the version of that file. What follows
            applies to the native flavour only.
        platforms: those for which the FMU has a library; none: all.
        with_sources: whether the C that the libraries are compiled from is in the FMU, too.
        with_component: whether a WebAssembly component is in it, of FMI 3.0 only.
    """

    flavour: Flavour = Flavour.NATIVE
    with_terminals: bool = False
    platforms: Sequence[Platform] = ()
    with_sources: bool = False
    with_component: bool = False

    def optional_contents(self, fmi: Fmi) -> tuple[bool, bool, bool]:
        """Whether an FMU of this version has terminals, its C, and the unit as a WebAssembly component."""
        return self.with_terminals or fmi == Fmi.THREE, self.with_sources, self.with_component


NATIVE = BuildOptions()


def ignore(text: str) -> None:
    """Progress that nobody is shown."""


def build(recipe: Recipe, target: Path, options: BuildOptions = NATIVE, progress: Progress = ignore) -> Path:
    """Build the FMU of a recipe.

    Raises:
        UserError: the errors of `NativeBuild` and of `build_python`.
    """
    return start_build(recipe, options)(target, progress)


def start_build(recipe: Recipe, options: BuildOptions = NATIVE) -> Finish:
    """Start to build the FMU of a recipe: zig compiles until the returned function is called, which completes it.

    Raises:
        UserError: the errors of `NativeBuild`.
    """
    if options.flavour == Flavour.NATIVE:
        return NativeBuild(recipe, options).finish
    return lambda target, progress: build_python(recipe, target, options.with_terminals)


def build_python(recipe: Recipe, target: Path, with_terminals: bool = False) -> Path:
    """Build the FMU with PythonFMU's library, PythonFMU itself and motionsync's sources.

    All FMUs of a process share one interpreter, and therefore one `sys.modules`. For this reason the names of
    motionsync's modules in the FMU contain the hash of their sources.

    Raises:
        UserError: the recipe is for another version of FMI than PythonFMU supports.
    """
    if recipe.fmi != Fmi.TWO:
        raise UserError(NO_PYTHON)
    block, guid, name = recipe.block(), compute_guid(recipe), recipe.name
    tag = guid[1:9] + guid[10:14]
    package, _, module = type(block).__module__.partition(".")
    starts = {v.name: plain_value(v.start) for v in variables(block) if v.name in recipe.starts}
    overrides = dict(recipe.causality_overrides)
    script = SCRIPT.format(name=name, tag=tag, package=package, module=module, starts=starts, overrides=overrides)
    files: Files = {
        f"resources/{name.lower()}_{tag}.py": script.encode(),
        "resources/slavemodule.txt": f"{name.lower()}_{tag}".encode(),
        **{f"resources/motionsync_fmu_{tag}/{folder}__init__.py": b"" for folder in ("", "interface/", "python/")},
    }
    files |= {f"resources/{package}_{tag}/{n}": text for n, text in collect_sources(type(block).__module__).items()}
    files |= {f"resources/motionsync_fmu_{tag}/{n}": text for n, text in python_runtime().items()}
    # The installed one: a process that has run such an FMU may have imported the copy in its folder, which is gone.
    pythonfmu = Path(str(metadata.distribution("pythonfmu").locate_file("pythonfmu")))
    files |= {f"resources/pythonfmu/{p.name}": p.read_bytes() for p in pythonfmu.glob("*.py")}
    libraries = list((pythonfmu / "resources" / "binaries").glob("*/*"))
    for library in libraries:
        files[f"binaries/{library.parent.name}/{name}{library.suffix}"] = library.read_bytes()
    files[LICENCE] = join_in_sections(licences("motionsync", "pythonfmu"))
    folders = (library.parent.name for library in libraries)
    files |= _documents(recipe, BuildOptions(Flavour.PYTHON, with_terminals), folders, ())
    return write_zip(target, files | _descriptions(recipe, OWN_MEMORY, ()))


class NativeBuild:
    """The build of an FMU with a library for each platform; zig's processes compile while the program goes on.

    Raises:
        UserError: what builds it is not installed, the block is outside the kernel subset, or an FMU of this version
            has no component.
    """

    def __init__(self, recipe: Recipe, options: BuildOptions = NATIVE) -> None:
        try:
            from ..native import instance_sources, libraries  # noqa: PLC0415 (it looks for zig)
        except ModuleNotFoundError as e:
            other = "; or take --flavour python" if recipe.fmi == Fmi.TWO else ""
            raise UserError(
                f"the native flavour is built with {e.name}, which is not installed: {how_to_install('native')}{other}"
            ) from None
        block, fmi = recipe.block(), recipe.fmi
        if options.with_component and fmi != Fmi.THREE:
            raise UserError(NO_COMPONENT)
        check_kernel(type(block).__module__)
        self.recipe, self.options = recipe, options
        self.platforms = options.platforms or OF_VERSION[fmi]
        self.unit = instance_sources.c_sources(block, compute_guid(recipe), recipe.causality_overrides, fmi)
        self.compilation = libraries.Compilation(recipe.name, self.unit, self.platforms)

    def finish(self, target: Path, progress: Progress = ignore) -> Path:
        """Write the FMU.

        Raises:
            UserError: zig failed.
        """
        from ..native import instance_sources, libraries, tables  # noqa: PLC0415
        from ..native.wasm import component  # noqa: PLC0415

        recipe, options, block = self.recipe, self.options, self.recipe.block()
        c_files = instance_sources.c_names(self.unit) if options.with_sources else ()
        folders = [*(platform.folder for platform in self.platforms), *([WASM] if options.with_component else [])]
        with self.compilation:
            files = _documents(recipe, options, folders, c_files) | self.compilation.libraries(progress)
        if options.with_component:
            files |= component.component_files(recipe.name, self.unit)
        files[LICENCE] = join_in_sections(licences("motionsync") | libraries.linked_licences(recipe.fmi))
        if options.with_sources:
            files |= instance_sources.sources_folder(block, self.unit, recipe.fmi)
        memory = {} if options.with_sources else OWN_MEMORY
        return write_zip(target, files | _descriptions(recipe, tables.abilities(block) | memory, c_files))


def check_kernel(module: str) -> None:
    """Refuse a block outside the kernel subset, since its compiled code might differ from its behaviour in Python.

    Raises:
        UserError: the block violates the subset; the message has file, line and rule of each violation.
    """
    package = module.partition(".")[0]
    if violations := _violations(tuple(collect_sources(module).items())):
        raise UserError("\n".join(f"{package}/{violation}" for violation in violations))


@lru_cache(maxsize=8)
def _violations(sources: tuple[tuple[str, bytes], ...]) -> list[Violation]:
    """What the checker finds in these modules: FMUs of one block have the same."""
    return check({name: text.decode() for name, text in sources})


def _documents(recipe: Recipe, options: BuildOptions, platforms: Iterable[str], c_files: Sequence[str]) -> Files:
    """What both flavours hold besides libraries, licences and modelDescription: documentation, picture, example,
    terminals.

    `platforms`: the names of the libraries' folders; `c_files`: the C files among the sources in the FMU."""
    from ..pages.block_page import FmuContents, make_pages  # noqa: PLC0415 (Matplotlib: it takes long to load)
    from ..pages.pictures import draw_icon  # noqa: PLC0415
    from ..pages.related_files import related_files  # noqa: PLC0415
    from ..scenario.files.example import load_example  # noqa: PLC0415 (NumPy)

    build_time()  # refuses an invalid SOURCE_DATE_EPOCH first: Matplotlib's message about it is not clear
    example, overrides = load_example(recipe.name), recipe.causality_overrides
    related = {} if recipe.starts or overrides else related_files(example)  # of the block as it is declared
    contents = FmuContents(recipe, options.flavour, sorted(platforms), bool(related), bool(c_files))
    pages, picture = make_pages(contents), draw_icon(recipe.name)
    files = related | {f"documentation/{name}": page for name, page in pages.items()}
    files[f"{FOLDER}/icon.png" if recipe.fmi == Fmi.THREE else "model.png"] = picture
    has_terminals, *_ = options.optional_contents(recipe.fmi)
    if has_terminals:
        files[TERMINALS] = terminals(recipe.block(), overrides, recipe.fmi)
    return files


def _descriptions(recipe: Recipe, abilities: Mapping[str, str], c_files: Sequence[str]) -> Files:
    """modelDescription.xml and, of FMI 3.0 with sources, their buildDescription.xml."""
    root = describe(recipe.block(), recipe.unit, recipe.slave_unit, recipe.causality_overrides)
    complete(root, compute_guid(recipe), abilities, c_files)
    if recipe.fmi == Fmi.TWO:
        return {"modelDescription.xml": content(root)}
    files = {"modelDescription.xml": content(translated(root))}
    if c_files:
        files[f"{SOURCES}buildDescription.xml"] = content(build_description(recipe.name, c_files))
    return files


def plain_value(value: Any) -> Any:
    """A value as the script in the FMU contains it: a member of an enumeration is written as its number."""
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value


def licences(*distributions: str) -> Files:
    """The licence text of each installed distribution, by its name, without those of bundled software."""
    texts: Files = {}
    for name in distributions:
        licence_files = [file for file in metadata.files(name) or [] if "LICEN" in file.name.upper()]
        if not licence_files:
            raise UserError(f"the licence of {name} is not installed: install motionsync with pip")
        texts[name] = min(licence_files, key=lambda file: len(str(file))).read_binary()
    return texts


def join_in_sections(texts: Files) -> bytes:
    """One text of several, each below its name."""
    sections = (f"{name}\n{'=' * len(name)}\n\n".encode() + text.rstrip() for name, text in texts.items())
    return b"\n\n".join(sections) + b"\n"


def fmu_path(recipe: Recipe, folder: Path, flavour: Flavour) -> Path:
    """<folder>/<flavour>/<FMU>.fmu, of FMI 3.0 <folder>/fmi3/<FMU>.fmu; an FMU with causality overrides has a name of
    its own, <FMU>-<hash of these>.fmu."""
    kind = "fmi3" if recipe.fmi == Fmi.THREE else flavour.value
    overrides = {name: causality.encode() for name, causality in recipe.causality_overrides.items()}
    suffix = f"-{digest(overrides)[:8]}" if overrides else ""
    return folder / kind / f"{recipe.name}{suffix}.fmu"


def optional_contents(fmu: Path) -> tuple[bool, bool, bool]:
    """What a built FMU holds of `BuildOptions.optional_contents`."""
    with zipfile.ZipFile(fmu) as z:
        names = z.namelist()
    folders = (SOURCES, f"binaries/{WASM}/")
    sources, component = (any(name.startswith(folder) for name in names) for folder in folders)
    return TERMINALS in names, sources, component


def why_outdated(fmu: Path, recipe: Recipe) -> str:
    """Why a built FMU cannot be used as it is: "missing" or "stale"; empty if it can be used.

    An FMU is stale if its sources have changed. A damaged file, or one that is no FMU of this block, is stale too."""
    if not fmu.exists():
        return "missing"
    token = "instantiationToken" if recipe.fmi == Fmi.THREE else "guid"
    try:
        with zipfile.ZipFile(fmu) as z:
            guid = None if z.testzip() else fromstring(z.read("modelDescription.xml")).get(token)
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, ParseError):
        guid = None
    return "" if guid == compute_guid(recipe) else "stale"
