"""A WebAssembly component of the layered standard fmi-ls-wasm: a block's core module among sections that are always the
same.

`component.bin` has these sections, with an empty core module in the block's place. wasm-tools made it from the draft's
interface (`wasm-tools component embed wit --world co-simulation-fmu`, `wasm-tools component new`).
"""

from pathlib import Path

from ...archive import Files
from ..platforms import WASM
from .core import core_module

HERE = Path(__file__).parent
COMPILED = ("wit.c", "unit.c", "decimal.c", "block.c")  # wit.c includes fmi3.c
CORE_MODULE = 1  # the kind of section

MANIFEST = """<?xml version="1.0" encoding="UTF-8"?>
<fmiLayeredStandardManifest xmlns="http://fmi-standard.org/fmi-ls-manifest"
  xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"
  fmi-ls:fmi-ls-name="org.modelica.fmi-ls-wasm"
  fmi-ls:fmi-ls-version="0.1.0"
  fmi-ls:fmi-ls-description="FMI Layered Standard for WebAssembly"/>
"""


def component_files(name: str, unit: Files) -> Files:
    """What an FMU of FMI 3.0 holds more: the component, and the manifest of the layered standard.

    `name`: the block's; `unit`: the C of its unit (`c_sources`), of FMI 3.0.

    Raises:
        UserError: zig failed.
    """
    core = core_module(unit | {"wit.c": (HERE / "wit.c").read_bytes()}, COMPILED)
    return {
        f"binaries/{WASM}/{name}.wasm": around(core),
        "extra/org.modelica.fmi-ls-wasm/manifest.xml": MANIFEST.encode(),
    }


def around(core: bytes) -> bytes:
    """The component around a core module."""
    template = (HERE / "component.bin").read_bytes()
    whole, at = template[:8], 8
    while at < len(template):
        kind, (start, length) = template[at], _number(template, at + 1)
        at = start + length
        content = core if kind == CORE_MODULE and not length else template[start:at]
        whole += bytes([kind]) + _packed(len(content)) + content
    return whole


def _number(text: bytes, at: int) -> tuple[int, int]:
    """Where a number of WebAssembly (LEB128) ends, and the number."""
    number = shift = 0
    while True:
        byte = text[at]
        number |= (byte & 127) << shift
        shift += 7
        at += 1
        if byte < 128:
            return at, number


def _packed(number: int) -> bytes:
    packed = b""
    while number > 127:
        packed += bytes([number & 127 | 128])
        number >>= 7
    return packed + bytes([number])
