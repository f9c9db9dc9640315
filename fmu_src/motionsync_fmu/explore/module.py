"""A block as one WebAssembly module, for a page in a browser."""

from pathlib import Path
from typing import Any

from ..native.unit_sources import c_names, c_sources
from ..native.wasm.core import core_module

WEB = Path(__file__).with_name("web.c")
OTHERS = ("fmi", "memory")  # how the names of C files begin that a page does not need


def webassembly(block: Any, guid: str) -> bytes:
    """The module; web.c tells what it exports.

    Raises:
        UserError: zig failed.
    """
    unit = {name: text for name, text in c_sources(block, guid).items() if not name.startswith(OTHERS)}
    files = unit | {WEB.name: WEB.read_bytes()}
    return core_module(files, c_names(files))
