"""The C of a unit: what its libraries are compiled from, and what an FMU with sources brings along."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..compiler.memory_layout import dtype
from ..compiler.translator import c_source
from ..interface.fingerprint import Files
from ..interface.fmi2_xml import SOURCES
from ..interface.recipe import Fmi
from .tables import ENVIRONMENT, model_header

FOLDER = Path(__file__).parent
STATE_HEADER = 120  # bytes of an FMU state besides the block's memory


def c_sources(block: Any, guid: str, overrides: Mapping[str, str] | None = None, fmi: Fmi = Fmi.TWO) -> Files:
    """The C files and headers of a unit by name. With FMI's headers, which are not among them, any C99 compiler makes
    the unit of the C files.

    `overrides`: as for `variables`; `fmi`: the version."""
    others = {f"fmi{version}.c" for version in Fmi if version != fmi}
    shared = (file for file in sorted(FOLDER.glob("*.[ch]")) if file.name not in others)
    files = {file.name: file.read_bytes().replace(b"\r\n", b"\n") for file in shared}
    files |= c_source(block)
    files["block.h"] = b'#include "portable.h"\n' + files["block.h"]
    return files | {"model.h": model_header(block, guid, overrides, fmi).encode()}


def c_names(files: Files) -> list[str]:
    """The names of those files that a compiler is given."""
    return sorted(name for name in files if name.endswith(".c"))


def sources_folder(block: Any, files: Files, fmi: Fmi = Fmi.TWO) -> Files:
    """What an FMU holds as its sources, by the paths in it: the C files of `c_sources`, and how to compile them."""
    name, state = type(block).__name__, dtype(block).itemsize + STATE_HEADER
    text = ENVIRONMENT.get_template("sources.md.j2").render(name=name, files=c_names(files), fmi=str(fmi), state=state)
    return {f"{SOURCES}{name}": content for name, content in (files | {"README.md": text.encode()}).items()}
