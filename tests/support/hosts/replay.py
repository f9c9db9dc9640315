"""A plain host in C, `tests/fmu/replay.c`, that runs a unit without any Python, on every platform at hand."""

import os
import shutil
import struct
import subprocess
import sys
from array import array
from collections.abc import Iterator, Sequence
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from typing import Any

import fmpy
import pytest
import ziglang

from motionsync_fmu import paths
from motionsync_fmu.interface.recipe import Fmi
from motionsync_fmu.native.libraries import HEADERS
from motionsync_fmu.native.platforms import OF_VERSION, ROWS, parts
from motionsync_fmu.scenario.run.fmu_instance import TYPES, FmuError, FmuInstance, fmi_version
from tests import ROOT
from tests.support.blocks.runs import BlockRun

# The letters of the orders, by the types of FMI's get and set functions.
LETTERS = {"Real": "R", "Float64": "R", "Integer": "I", "Int32": "I", "Int64": "E", "Boolean": "B"}
REFUSED = {Fmi.TWO: "3", Fmi.THREE: "2"}  # the status of a native unit's refused step
SOURCES = ROOT / "tests" / "fmu"
WINDOWS_HEADERS = Path(ziglang.__file__).parent / "lib" / "libc" / "include" / "any-windows-any"
WINDOWS = [
    f"-isystem{WINDOWS_HEADERS}",
    *("-Dmain=host", "-fno-builtin", "-nostdlib", "-lkernel32", "-lucrtbase", "-Wl,-e,start"),
]
LINUX = ["-nostdlib", "-lc", "-ldl"]  # without the compiler's own library, which zig would compile first, in seconds
# The host for libraries of each system: zig's name of the system it runs on itself and of its C library, its sources,
# and zig's options.
HOSTS = {
    "linux": ("linux-gnu.2.17", ["replay.c"], LINUX),
    "windows": ("windows-gnu", ["replay.c", "windows.c"], WINDOWS),
    "macos": ("linux-gnu.2.17", ["replay.c", "macho.c"], LINUX),
}
PATIENCE = 120.0  # s, until a library that does not answer is given up
TARGETS = [target for platform in ROWS for target in platform.targets]  # in both versions of FMI


def tried(call: Any, *arguments: Any) -> str:
    """What a call that fails says; empty if it succeeds."""
    try:
        call(*arguments)
    except FmuError as e:
        return str(e)
    return ""


def wine() -> list[str]:
    result = shutil.which("wine64") or shutil.which("wine64", path="/usr/lib/wine") or shutil.which("wine")
    if not result:
        pytest.skip("wine64 is not installed")
    return [result]


def qemu(processor: str) -> list[str]:
    root = Path(os.environ.get("QEMU_LD_PREFIX", f"/usr/{processor}-linux-gnu"))
    result = shutil.which(f"qemu-{processor}") or shutil.which(f"qemu-{processor}-static")
    if not result:
        pytest.skip("qemu-user is not installed")
    if not (root / "lib" / f"ld-linux-{processor}.so.1").exists():
        pytest.skip(f"the C library of Linux on {processor} is not installed (Debian: libc6-arm64-cross)")
    return [result, "-L", str(root)]


def launcher(target: str) -> list[str]:
    """The command that runs the host for libraries of zig's target on this machine."""
    processor, system = parts(target)
    if system == "windows":
        return wine()
    if sys.platform != "linux":
        pytest.skip("this is not Linux")
    return [] if os.uname().machine == processor else qemu(processor)


def double(x: float) -> str:
    return struct.pack(">d", x).hex()


def orders(host: FmuInstance, run: BlockRun) -> Iterator[tuple[str, str]]:
    """A run as lines for the host in C, and what it answers to each, by the values of the FMU in `host`."""
    letters = {name: LETTERS[kind] for name, (_, kind) in host.kinds.items()}
    are_real = [letter == "R" for letter in letters.values()]
    form = " ".join("%016x" if is_real else "%d" for is_real in are_real)

    def setting(values: dict[str, Any]) -> Iterator[tuple[str, str]]:
        for name, value in values.items():
            host.set({name: value})
            bits = double(value) if letters[name] == "R" else int(value)
            yield f"{letters[name]} {host.kinds[name][0]} {bits}", "0"

    def all_values() -> tuple[str, str]:
        result = host.get()
        values = [result[name] for name in letters]
        words = array("Q", array("d", values).tobytes())
        return "g", form % tuple(w if is_real else v for w, v, is_real in zip(words, values, are_real, strict=True))

    yield "n", "0"
    if host.fmi == Fmi.TWO:
        host.unit.setupExperiment(startTime=0.0)
    host.unit.enterInitializationMode()
    yield "e", "0"
    yield from setting(run.start)
    yield all_values()
    host.unit.exitInitializationMode()
    yield "x", "0"
    for h, values in run.steps:
        yield from setting(values)
        order = f"s {double(host.time)} {double(h)}"
        yield order, REFUSED[host.fmi] if tried(host.step, h) else "0"
        yield all_values()


def host_program(target: str, fmi: Fmi) -> Path:
    """The host for libraries of zig's target and of a version of FMI, compiled once for all test runs."""
    processor, system = parts(target)
    runs_on, names, options = HOSTS[system]
    sources = [SOURCES / name for name in names]
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", f"{processor}-{runs_on}", "-O1", f"-DFMI={fmi}"]
    compiler += options
    contents = [*compiler[1:], metadata.version("ziglang"), *map(Path.read_text, sources)]
    folder = paths.cache_folder() / "replay" / sha256("\0".join(contents).encode()).hexdigest()[:32]
    program = folder / f"replay{'.exe' if system == 'windows' else ''}"
    if not program.exists():
        with paths.replace_files(folder) as part:
            output = [f"-I{HEADERS}", "-o", str(part(program.name))]
            subprocess.run([*compiler, *output, *map(str, sources)], check=True)
    return program


def wine_environment(prefix: Path) -> dict[str, str]:
    """The environment in which wine loads its own libraries from where they are installed.

    Otherwise wine copies them into its prefix, 700 MB, which takes longer than all that is run there."""
    prefix.mkdir()
    (prefix / ".update-timestamp").write_text("disable")
    return {"WINEDEBUG": "-all", "WINEPREFIX": str(prefix), "WINEBOOTSTRAPMODE": "1"}


def replayed(target: str, folder: Path, orders: Sequence[str], scratch: Path) -> list[str]:
    """What the unit of an extracted FMU answers to the orders.

    `target`: zig's name of the processor and the system of its library; `scratch`: an empty folder."""
    start = launcher(target)
    description = fmpy.read_model_description(str(folder))
    fmi = fmi_version(description)
    kinds = "".join(LETTERS[TYPES[fmi][v.type]] for v in description.modelVariables)
    program = host_program(target, fmi)
    (platform,) = (platform for platform in OF_VERSION[fmi] if target in platform.targets)
    orders_file, answers_file = scratch / "orders.txt", scratch / "answers.txt"
    orders_file.write_text("".join(f"{order}\n" for order in orders))
    library = folder / platform.library(description.coSimulation.modelIdentifier)
    with orders_file.open() as stdin, answers_file.open("w") as stdout:  # no pipes: wine's server would hold them open
        subprocess.run(
            [*start, str(program), str(library), description.guid, kinds],
            stdin=stdin,
            stdout=stdout,
            check=True,
            timeout=PATIENCE,
            env=os.environ | (wine_environment(scratch / "wine") if "windows" in target else {}),
        )
    return [line.strip() for line in answers_file.read_text().splitlines()]
