"""A unit as a core module of WebAssembly: zig compiles the same text as for the platforms."""

from collections.abc import Iterable
from pathlib import Path

from ...archive import Files
from ..libraries import is_shared, shared_file, workplace, zig_cc

TARGET = "wasm32-wasi"  # "freestanding" would turn fabs and sqrt from instructions into unknown functions
FLAGS = (
    "-std=c11 -O2 -ffp-contract=off -fno-math-errno -fno-strict-aliasing -fno-slp-vectorize "
    "-mllvm -inline-threshold=100 -fvisibility=hidden -g0 -s -rtlib=none -nostdlib "
    "-Wl,--no-entry -Wl,-z,stack-size=65536"
)


def core_module(files: Files, compiled: Iterable[str]) -> bytes:
    """The module of these C files and headers; `compiled`: the names of those that the compiler is given, beside what
    stands in for a C library.

    Raises:
        UserError: zig failed.
    """
    sources = [shared_file(name) if is_shared(name) else name for name in compiled]
    with workplace(files) as work:
        return zig_cc(TARGET, [*FLAGS.split(), *sources], "core.wasm", Path(work))
