"""A block as one WebAssembly module, for a page in a browser: zig compiles the same text as for the platforms."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ..errors import UserError
from ..native.libraries import FREESTANDING
from ..native.tables import model_header
from ..native.translator import c_source
from ..native.unit_sources import HERE as NATIVE

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
        core = (file for file in NATIVE.glob("*.[ch]") if not file.name.startswith(OTHERS))
        for source in (WEB, *core, *FREESTANDING.glob("*.[ch]")):
            (work / source.name).write_bytes(source.read_bytes())
        for name, text in c_source(block).items():
            (work / name).write_bytes(text)
        (work / "model.h").write_text(model_header(block, guid), "utf-8", newline="\n")
        command = [sys.executable, "-m", "ziglang", "cc", "-target", TARGET, *FLAGS.split(), "-I."]
        done = subprocess.run(
            [*command, *sorted(source.name for source in work.glob("*.c")), "-o", "block.wasm"],
            cwd=work,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode:
            raise UserError(f"zig could not compile for {TARGET}:\n{done.stderr.strip()[-2000:]}")
        return (work / "block.wasm").read_bytes()
