"""A block as one WebAssembly module, for a page in a browser: zig compiles the same text as for the platforms."""

import tempfile
from pathlib import Path
from typing import Any

from ..native.libraries import FREESTANDING, zig_cc
from ..native.unit_sources import c_sources

WEB = Path(__file__).with_name("web.c")
OTHERS = ("fmi", "memory")  # how the names of C files begin that a page does not need
TARGET = "wasm32-wasi"  # "freestanding" would turn fabs and sqrt from instructions into unknown functions
FLAGS = (
    "-std=c11 -O2 -ffp-contract=off -fno-math-errno -fno-strict-aliasing -fno-slp-vectorize "
    "-mllvm -inline-threshold=100 -fvisibility=hidden -g0 -s -rtlib=none -nostdlib "
    "-Wl,--no-entry -Wl,-z,stack-size=65536"
)


def webassembly(block: Any, guid: str) -> bytes:
    """The module; web.c tells what it exports.

    Raises:
        UserError: zig failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for source in (WEB, *FREESTANDING.glob("*.[ch]")):
            (work / source.name).write_bytes(source.read_bytes())
        for name, text in c_sources(block, guid).items():
            if not name.startswith(OTHERS):
                (work / name).write_bytes(text)
        own = sorted(source.name for source in work.glob("*.c"))
        return zig_cc(TARGET, [*FLAGS.split(), "-I.", *own], "block.wasm", work)
