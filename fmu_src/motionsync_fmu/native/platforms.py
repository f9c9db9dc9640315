"""The platforms that a native FMU runs on: one row each. All else that depends on the platform follows from this table:
what zig compiles and how, the folders in the FMU, the documentation, and what the tests compare."""

import platform as machine
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .macho import universal

# Flags for zig's compiler beside those that all platforms have. What can be left out of a library is left out: an FMU
# holds one library for each platform. No library of zig's is linked, nor a C library: freestanding.c has what is then
# missing. zig would have to compile these libraries first, which takes minutes.
UNWINDING = "-fno-asynchronous-unwind-tables -fno-unwind-tables"  # no tables for C++ exceptions
LINUX = f"-nostdlib -Wl,--hash-style=gnu {UNWINDING}"
WINDOWS = "-nostdlib -lkernel32 -Wl,-e,library_main"
MACOS = f"-nostdlib {UNWINDING}"  # zig links libSystem nevertheless: every library of macOS has to name it
ARM = "-mno-outline"  # outlining repeated pieces of code makes code shorter, but it compresses worse


def alone(library: bytes) -> bytes:
    """The only library, for a platform with one processor."""
    return library


@dataclass(frozen=True)
class Platform:
    """One platform.

    Attributes:
        folder: its name in FMI, under binaries/.
        title: its name in the documentation.
        suffix: the suffix of a library's file name.
        targets: zig's name of each processor and system, with its own flags.
        join: the function that makes one library of the libraries of all targets, in their order.
    """

    folder: str
    title: str
    suffix: str
    targets: Mapping[str, str]
    join: Callable[..., bytes] = alone

    def library(self, block: str) -> str:
        """The path of a block's library in the FMU."""
        return f"binaries/{self.folder}/{block}.{self.suffix}"


ROWS = (
    Platform("linux64", "Linux on x86-64", "so", {"x86_64-linux-none": LINUX}),
    Platform("aarch64-linux", "Linux on 64-bit ARM", "so", {"aarch64-linux-none": f"{LINUX} {ARM}"}),
    Platform("win64", "Windows on x86-64", "dll", {"x86_64-windows-gnu": WINDOWS}),
    Platform(
        "darwin64",
        "macOS on x86-64 and on 64-bit ARM",
        "dylib",
        {"x86_64-macos.11.0": MACOS, "aarch64-macos.11.0": f"{MACOS} {ARM}"},
        universal,
    ),
)
PLATFORMS = {platform.folder: platform for platform in ROWS}


def here() -> Platform | None:
    """The platform of this machine; None if it is none of these."""
    processor = {"AMD64": "x86_64", "arm64": "aarch64"}.get(machine.machine(), machine.machine())
    system = {"win32": "windows", "darwin": "macos"}.get(sys.platform, sys.platform)
    rows = (row for row in ROWS for target in row.targets if target.startswith(f"{processor}-{system}"))
    return next(rows, None)
