"""Builds the FMUs of a block, and tells whether a built one is up to date."""

import zipfile
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import metadata
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError, fromstring, tostring

from motionsync.blocks import BLOCKS

from .archive import Files, compilers, digest, epoch, runtime, sources, write
from .errors import UserError, choose
from .interface.fmi2_xml import BASES, describe, finish
from .interface.variables import Variable, variables
from .native.subset.modules import check
from .pages.block_page import pages, picture

SCRIPT = """from {package}_{tag}.{module} import {name}
from motionsync_fmu_{tag}.python.slave import BlockSlave, keep

keep(globals())


class {name}Slave(BlockSlave):
    block_type = {name}
    build = "{tag}"
    starts = {starts!r}
"""


class Flavour(StrEnum):
    """How the block gets into the FMU."""

    NATIVE = "native"
    PYTHON = "python"


@dataclass(frozen=True)
class Recipe:
    """What an FMU is built from: a block, the unit of its positions, start values to bake in (name to text), and the
    unit of the slave's positions where it is not the same (empty: it is)."""

    name: str
    unit: str = "mm"
    starts: Mapping[str, str] = field(default_factory=dict)
    slave_unit: str = ""

    def block(self) -> Any:
        """A new block with the baked start values.

        Raises:
            UserError: an unknown block, unit or variable, a value that the variable does not allow, or a slave unit
                for a block whose slave is in the master's.
        """
        block = choose(BLOCKS, self.name, "block").type()
        choose(BASES, self.unit, "unit")
        check_slave_unit(block, self.slave_unit)
        by_name = {v.name: v for v in variables(block) if v.settable}
        for name, text in self.starts.items():
            v = choose(by_name, name, f"parameter or input of {self.name}")
            v.cell.set(parse(v, text))
        return block

    def guid(self) -> str:
        """A hash of the variables and of the source: the same for both flavours, and for every build of it."""
        block = self.block()
        files = sources(type(block).__module__)
        files |= {f"fmu/{name}": text for name, text in (runtime() | compilers()).items()}
        h = digest(files | {"modelDescription.xml": tostring(describe(block, self.unit, self.slave_unit))})
        return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


def check_slave_unit(block: Any, unit: str) -> None:
    """Refuse a slave unit that is none, or for a block that does not tell both axes' units apart.

    Raises:
        UserError: which of the two.
    """
    if unit:
        choose(BASES, unit, "slave unit")
        if not any(v.declaration.unit.slave for v in variables(block)):
            raise UserError(f"slave unit {unit!r}: the slave of {type(block).__name__} is in its master's unit")


def parse(v: Variable, text: str) -> Any:
    """A start value given as text: a number, true or false, a member's name or number.

    Raises:
        UserError: it is none of these, or outside the variable's limits.
    """
    value: Any = None
    if v.kind == "Boolean":
        value = {"true": True, "false": False, "1": True, "0": False}.get(text.lower())
    elif v.choices and text in (names := {member.name: member.value for member in v.choices}):
        value = names[text]
    else:
        with suppress(ValueError):
            value = float(text) if v.kind == "Real" else int(text)
    if value is None:
        allowed = "true or false" if v.kind == "Boolean" else v.range
        raise UserError(f"{v.name} = {text} is no {v.kind}: it must be {allowed}")
    if refusal := v.refusal(value):
        raise UserError(refusal)
    return value


def build(flavour: Flavour, recipe: Recipe, target: Path, told: Callable[[str], None] = lambda text: None) -> Path:
    """The FMU of a recipe; `told` is told what takes long."""
    return build_native(recipe, target, told) if flavour == Flavour.NATIVE else build_python(recipe, target)


def build_python(recipe: Recipe, target: Path) -> Path:
    """PythonFMU's library, PythonFMU itself, and our sources under names that carry their hash: all the FMUs of a
    process share one interpreter, and so one `sys.modules`."""
    block, guid, name = recipe.block(), recipe.guid(), recipe.name
    tag = guid[1:9] + guid[10:14]
    package, _, module = type(block).__module__.partition(".")
    starts = {v.name: plain(v.start) for v in variables(block) if v.name in recipe.starts}
    script = SCRIPT.format(name=name, tag=tag, package=package, module=module, starts=starts)
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
    files |= {f"documentation/licenses/{n}": text for n, text in licences("motionsync", "pythonfmu").items()}
    return _write(target, recipe, Flavour.PYTHON, files)


def build_native(recipe: Recipe, target: Path, told: Callable[[str], None] = lambda text: None) -> Path:
    """One library for each platform, and no Python; `told` is told once if compiling them will take minutes.

    Raises:
        UserError: the compilers are not installed or failed, or the block is outside the kernel subset.
    """
    block = recipe.block()
    check_kernel(type(block).__module__)
    try:
        from .native import libraries, tables  # noqa: PLC0415 (Numba and zig: needed for this flavour only)
    except ModuleNotFoundError as e:
        raise UserError(
            f"the native flavour is compiled with {e.name}, which is not installed: install it with "
            "pip install 'motionsync[native]', or take --flavour python"
        ) from None
    files = libraries.libraries(block, recipe.guid(), told)
    texts = licences("motionsync", "numba", "ziglang") | libraries.linked_licences()
    files |= {f"documentation/licenses/{n}": text for n, text in texts.items()}
    return _write(target, recipe, Flavour.NATIVE, files, tables.abilities(block))


def check_kernel(module: str) -> None:
    """Refuse a block that does not keep to the kernel subset, and would do something else when compiled.

    Raises:
        UserError: file, line and rule of each violation.
    """
    package = module.partition(".")[0]
    if found := check({name: text.decode() for name, text in sources(module).items()}):
        raise UserError("\n".join(f"{package}/{violation}" for violation in found))


def _write(
    target: Path, recipe: Recipe, flavour: Flavour, files: Files, abilities: Mapping[str, str] | None = None
) -> Path:
    """The FMU with what both flavours hold: documentation, picture and modelDescription."""
    epoch()  # Matplotlib reads it too, and says nothing useful to a bad one
    block = recipe.block()
    platforms = sorted({name.split("/")[1] for name in files if name.startswith("binaries/")})
    texts = pages(recipe.name, block, recipe.unit, flavour, platforms, recipe.slave_unit)
    files = files | {f"documentation/{n}": text for n, text in texts.items()}
    files |= {
        "model.png": picture(recipe.name),
        "modelDescription.xml": finish(describe(block, recipe.unit, recipe.slave_unit), recipe.guid(), abilities),
    }
    write(target, files)
    return target


def plain(value: Any) -> Any:
    """The number behind an enumeration's member: a script shows its value, not its name."""
    return int(value) if isinstance(value, int) and not isinstance(value, bool) else value


def licences(*distributions: str) -> Files:
    """The licence texts of installed distributions, by file name; not those of what they have in subfolders."""
    found: Files = {}
    for name in distributions:
        texts = [file for file in metadata.files(name) or [] if "LICEN" in file.name.upper()]
        if not texts:
            raise UserError(f"the licence of {name} is not installed: install motionsync with pip")
        found[f"{name}.txt"] = min(texts, key=lambda file: len(str(file))).read_binary()
    return found


def fmu_path(recipe: Recipe, folder: Path, flavour: Flavour) -> Path:
    """<folder>/<flavour>/<FMU>.fmu."""
    return folder / flavour.value / f"{recipe.name}.fmu"


def outdated(fmu: Path, recipe: Recipe) -> str:
    """Why a built FMU cannot be used as it is: "missing", "stale" (its sources have changed); empty if it can.

    A damaged file, or one that is no FMU of this block, is stale too."""
    if not fmu.exists():
        return "missing"
    try:
        with zipfile.ZipFile(fmu) as z:
            built = None if z.testzip() else fromstring(z.read("modelDescription.xml")).get("guid")
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, ParseError):
        built = None
    return "" if built == recipe.guid() else "stale"
