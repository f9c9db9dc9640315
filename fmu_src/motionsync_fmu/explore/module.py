"""A block as one WebAssembly module, for a page in a browser: zig compiles the same text as for the platforms."""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from ..errors import UserError
from ..native.libraries import HERE as NATIVE
from ..native.llvm_text import llvm_text
from ..native.tables import model_header

HERE = Path(__file__).parent
TARGET = "wasm32-wasi"
FLAGS = (
    "-mexec-model=reactor "
    "-O2 -ffp-contract=off -fno-strict-aliasing -fno-slp-vectorize -fvisibility=hidden -g0 -s -Wno-override-module "
    "-Wl,--no-entry -Wl,-z,stack-size=65536"
)


def webassembly(block: Any, guid: str) -> bytes:
    """The module; web.c tells what it exports.

    Raises:
        UserError: zig failed.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for source in (NATIVE / "unit.h", NATIVE / "unit.c", HERE / "web.c"):
            (work / source.name).write_bytes(source.read_bytes())
        (work / "model.ll").write_text(llvm_text(block), "utf-8", newline="\n")
        (work / "model.h").write_text(model_header(block, guid), "utf-8", newline="\n")
        command = [sys.executable, "-m", "ziglang", "cc", "-target", TARGET, *FLAGS.split()]
        done = subprocess.run(
            [*command, "unit.c", "web.c", "model.ll", "-o", "block.wasm"],
            cwd=work,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode:
            raise UserError(f"zig could not compile for {TARGET}:\n{done.stderr.strip()[-2000:]}")
        return (work / "block.wasm").read_bytes()
