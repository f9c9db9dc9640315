"""The libraries of a native FMU: zig compiles the C of a block and of the FMI functions for every platform.

Python and zig are only needed to build the libraries, not to run them.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, as_completed, wait
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from ..archive import Files
from ..errors import UserError
from ..interface.recipe import Fmi
from .platforms import ROWS, Platform

HERE = Path(__file__).parent
FREESTANDING = HERE / "freestanding"  # what stands in for a C library
FLAGS = (
    "-Os -ffp-contract=off -fno-math-errno -fno-strict-aliasing -fno-slp-vectorize -fomit-frame-pointer "
    "-ffunction-sections -fdata-sections -fPIC -shared -fvisibility=hidden -g0 -s -rtlib=none -DOWN_MEMORY"
)
PATIENCE = 15.0  # s
SLOW = "compiling takes longer than usual"


def _package(name: str) -> Path:
    """The folder of an installed package, which is not imported.

    Raises:
        ModuleNotFoundError: the package is not installed.
    """
    spec = find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    return Path(*spec.submodule_search_locations)


HEADERS = _package("fmpy") / "c-code"  # FMI's
ZIG = _package("ziglang")


def libraries(
    name: str,
    unit: Files,
    platforms: Sequence[Platform] = ROWS,
    progress: Callable[[str], None] = lambda text: None,
) -> Files:
    """The library of each platform, by its path in the FMU; `progress` gets lines of text if this takes long.

    `name`: the block's; `unit`: the C of its unit (`c_sources`), of the platforms' version of FMI.

    Raises:
        UserError: zig failed.
    """
    with workplace(unit) as work, ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = {
            target: pool.submit(compiled, target, flags, f"{target}/{name}.{platform.suffix}", work)
            for platform in platforms
            for target, flags in platform.targets.items()
        }
        if wait(jobs.values(), PATIENCE, FIRST_EXCEPTION).not_done:
            progress(SLOW)
            targets = {job: target for target, job in jobs.items()}
            for job in as_completed(targets):
                progress(f"compiled for {targets[job]}")
        return {p.library(name): p.join(*(jobs[target].result() for target in p.targets)) for p in platforms}


@contextmanager
def workplace(files: Files) -> Iterator[Path]:
    """A folder for a while that holds these C files and headers, and what stands in for a C library."""
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        stand_ins = {source.name: source.read_bytes() for source in FREESTANDING.glob("*.[ch]")}
        for name, text in (stand_ins | files).items():
            (work / name).write_bytes(text)
        yield work


def compiled(target: str, flags: str, path: str, work: Path) -> bytes:
    """The library of the C files in a folder, compiled there into `path`, for one of zig's targets with its own flags.

    File names stay relative, so that the library does not depend on where this happens.

    Raises:
        UserError: zig failed.
    """
    (work / path).parent.mkdir()
    sources = sorted(source.name for source in work.glob("*.c"))
    return zig_cc(target, [*FLAGS.split(), "-I.", *sources, *flags.split()], path, work)


def zig_cc(target: str, arguments: Sequence[str], path: str, work: Path) -> bytes:
    """What zig makes, in the folder `work`, for one of its targets; `path`: where it puts that, relative to the folder.

    Raises:
        UserError: zig failed.
    """
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-I", str(HEADERS)]
    done = subprocess.run(
        [*command, *arguments, "-o", path],
        cwd=work,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if done.returncode:
        raise UserError(
            f"zig could not compile for {target}: it needs a folder that can be written (ZIG_GLOBAL_CACHE_DIR; else "
            f"one in the user's cache) with 1 GB to spare; an FMU of --flavour python is built without zig. zig said:\n"
            f"{done.stderr.strip()[-2000:]}"
        )
    return (work / path).read_bytes()


def linked_licences(fmi: Fmi) -> Files:
    """The licences of what the libraries hold beside the block: FMI's headers."""
    header = (HEADERS / f"fmi{fmi}Functions.h").read_text("utf-8")
    return {
        "fmi-headers.txt": header[header.index("Copyright") : header.index("*/")].rstrip().encode() + b"\n",
    }
