"""The GUID of an FMU: a hash of all that its description and its behaviour are made from."""

from functools import cache
from types import MappingProxyType
from xml.etree.ElementTree import tostring

from ..interface.fingerprint import PACKAGE, Files, collect_sources, digest, read_sources
from ..interface.fmi2_xml import describe
from ..interface.fmi3_xml import translated
from ..interface.recipe import Fmi, Recipe
from ..interface.terminals import terminals


def compute_guid(recipe: Recipe) -> str:
    """The GUID: the same for both flavours and versions, and for every build of them."""
    block, overrides = recipe.block(), recipe.causality_overrides
    files = collect_sources(type(block).__module__)
    files |= {f"fmu/{name}": text for name, text in (python_runtime() | native_toolchain()).items()}
    description = describe(block, recipe.unit, recipe.slave_unit, overrides)
    files |= {
        "fmi2/modelDescription.xml": tostring(description),
        "fmi3/modelDescription.xml": tostring(translated(description)),
        "terminalsAndIcons.xml": terminals(block, overrides, Fmi.THREE),
    }
    h = digest(files)
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


def python_runtime() -> Files:
    """The part of this package that runs inside the Python FMU."""
    return read_sources("interface/variables.py", "python/slave.py")


@cache
def native_toolchain() -> MappingProxyType[str, bytes]:
    """The part of this package that determines the native code: what makes the C and compiles it, with its modules, the
    C files and the template of the tables."""
    native = PACKAGE / "native"
    makers = (collect_sources(f"{PACKAGE.name}.native.{module}") for module in ("instance_sources", "libraries"))
    modules = {name for names in makers for name in names if name.startswith(("compiler/", "native/"))}
    files = (file for folder in (native, native / "freestanding") for file in folder.iterdir())
    others = (file.relative_to(PACKAGE).as_posix() for file in files if file.suffix in (".c", ".h", ".j2"))
    return MappingProxyType(read_sources(*modules, *others))
