"""The platforms that a native FMU runs on: one row each. All else that depends on the platform follows from this table:
what zig compiles and how, the folders in the FMU, the documentation, and what the tests compare."""

import platform
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..interface.recipe import Fmi
from .macho import universal

# Flags for zig's compiler besides those that all platforms have. What can be left out of a library is left out: an FMU
# holds one library for each platform. No library of zig's is linked, nor a C library: freestanding.c has what is then
# missing. zig would have to compile these libraries first, which takes minutes.
UNWINDING = "-fno-asynchronous-unwind-tables -fno-unwind-tables"  # no tables for exceptions: none passes through
LINUX = f"-nostdlib -Wl,--gc-sections,--hash-style=sysv {UNWINDING}"
WINDOWS = f"-nostdlib -lkernel32 -Wl,-e,library_main {UNWINDING}"
# zig links libSystem nevertheless: every library of macOS has to name it. Behind the header it leaves 4 kB for tools
# that lengthen it; Apple's linker leaves 32 bytes. The names of inner functions are left out, which -s keeps there.
MACOS = f"-nostdlib -Wl,-headerpad,20,-x {UNWINDING}"
ARM = "-mno-outline"  # outlining repeated pieces of code makes code shorter, but it compresses worse
# Instructions stay in the order of the source, which compresses best (zig does so for Apple's processors by itself);
# all places in a library are within 1 MB, so that one instruction finds them instead of two.
ARM_LINUX = f"{ARM} -mllvm -enable-misched=false -mllvm -enable-post-misched=false -mcmodel=tiny"
QUICK = "-mllvm -inline-threshold=10"  # no more becomes part of its callers than makes a step quicker
# A step takes an eighth longer, but not on Linux on x86-64, where most sweeps run. Blocks of code stay in the order of
# the source, too.
SMALL = "-Xclang -Oz -mllvm -disable-block-placement"

PROCESSORS = {"x86_64": "x86-64", "aarch64": "64-bit ARM"}  # by zig's names
SYSTEMS = {"linux": "Linux", "windows": "Windows", "macos": "macOS"}
DARWIN = {"macos": "darwin"}  # FMI 3.0 has other names of systems


@dataclass(frozen=True)
class Platform:
    """One platform.

    Attributes:
        folder: its name in FMI, under binaries/.
        suffix: the suffix of a library's file name.
        targets: zig's name of each processor and system, with its own flags.
        join: the function that makes one library of the libraries of all targets, in their order.
    """

    folder: str
    suffix: str
    targets: Mapping[str, str]
    join: Callable[..., bytes] = bytes  # of one target: its library itself

    @property
    def title(self) -> str:
        """Its name in the documentation."""
        processors, systems = zip(*map(parts, self.targets), strict=True)
        return f"{SYSTEMS[systems[0]]} on {' and on '.join(PROCESSORS[processor] for processor in processors)}"

    def library(self, block: str) -> str:
        """The path of a block's library in the FMU."""
        return f"binaries/{self.folder}/{block}.{self.suffix}"


def parts(target: str) -> tuple[str, str]:
    """Processor and system of one of zig's targets."""
    processor, system = re.split(r"[-.]", target)[:2]
    return processor, system


ROWS = (
    Platform("linux64", "so", {"x86_64-linux-none": f"{LINUX} {QUICK}"}),
    Platform("aarch64-linux", "so", {"aarch64-linux-none": f"{LINUX} {ARM_LINUX} {SMALL}"}),
    Platform("win64", "dll", {"x86_64-windows-gnu": f"{WINDOWS} {SMALL}"}),
    Platform(
        "darwin64",
        "dylib",
        {"x86_64-macos.11.0": f"{MACOS} {SMALL}", "aarch64-macos.11.0": f"{MACOS} {ARM} {SMALL}"},
        universal,
    ),
)
PLATFORMS = {platform.folder: platform for platform in ROWS}  # of FMI 2.0
# FMI 3.0 has a folder for each processor.
OF_VERSION = {
    Fmi.TWO: ROWS,
    Fmi.THREE: tuple(
        Platform(f"{processor}-{DARWIN.get(system, system)}", row.suffix, {target: flags})
        for row in ROWS
        for target, flags in row.targets.items()
        for processor, system in [parts(target)]
    ),
}
WASM = "wasm32-wasip2"  # the folder of a component (layered standard fmi-ls-wasm)
TITLES = {platform.folder: platform.title for rows in OF_VERSION.values() for platform in rows}
TITLES[WASM] = "WebAssembly (a component by the draft of fmi-ls-wasm: experimental)"


def host_platform(fmi: Fmi = Fmi.TWO) -> Platform | None:
    """The platform of this machine; None if it is none of these."""
    processor = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    system = {"win32": "windows", "darwin": "macos"}.get(sys.platform, sys.platform)
    rows = (row for row in OF_VERSION[fmi] for target in row.targets if parts(target) == (processor, system))
    return next(rows, None)
