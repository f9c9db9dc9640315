"""A unit as a WebAssembly component of the layered standard fmi-ls-wasm: a core module, for which zig compiles the same
text as for the platforms, among sections that are always the same.

`component.bin` has these sections, with an empty core module in the block's place. wasm-tools made it from the draft's
interface (`wasm-tools component embed wit --world co-simulation-fmu`, `wasm-tools component new`).
"""

import tempfile
from collections.abc import Iterable
from pathlib import Path

from ...interface.fingerprint import Files
from ..libraries import locate_sources, zig_cc
from ..platforms import WASM

FOLDER = Path(__file__).parent
COMPILED = ("wit.c", "instance.c", "block.c")  # wit.c includes fmi3.c
CORE_MODULE = 1  # the kind of section
TARGET = "wasm32-wasi"  # "freestanding" would turn fabs and sqrt from instructions into unknown functions
FLAGS = (
    "-std=c11 -O2 -ffp-contract=off -fno-math-errno -fno-strict-aliasing -fno-slp-vectorize "
    "-mllvm -inline-threshold=100 -fvisibility=hidden -g0 -s -rtlib=none -nostdlib "
    "-Wl,--no-entry -Wl,-z,stack-size=65536"
)

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
    core = core_module(unit | {"wit.c": (FOLDER / "wit.c").read_bytes()}, COMPILED)
    return {
        f"binaries/{WASM}/{name}.wasm": wrap_in_component(core),
        "extra/org.modelica.fmi-ls-wasm/manifest.xml": MANIFEST.encode(),
    }


def core_module(files: Files, c_names: Iterable[str]) -> bytes:
    """The core module of these C files and headers; `c_names`: those that the compiler gets, besides what replaces a C
    library.

    Raises:
        UserError: zig failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        return zig_cc(TARGET, [*FLAGS.split(), *locate_sources(files, c_names, work)], "core.wasm", work)


def wrap_in_component(core: bytes) -> bytes:
    """The component around a core module."""
    template = (FOLDER / "component.bin").read_bytes()
    whole, position = template[:8], 8
    while position < len(template):
        kind, (start, length) = template[position], _number(template, position + 1)
        position = start + length
        content = core if kind == CORE_MODULE and not length else template[start:position]
        whole += bytes([kind]) + _packed(len(content)) + content
    return whole


def _number(text: bytes, position: int) -> tuple[int, int]:
    """Where a number of WebAssembly (LEB128) ends, and the number."""
    number = shift = 0
    while True:
        byte = text[position]
        number |= (byte & 127) << shift
        shift += 7
        position += 1
        if byte < 128:
            return position, number


def _packed(number: int) -> bytes:
    packed = b""
    while number > 127:
        packed += bytes([number & 127 | 128])
        number >>= 7
    return packed + bytes([number])
