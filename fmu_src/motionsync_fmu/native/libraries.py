"""The libraries of a native FMU: zig compiles the C of a block and of the FMI functions for every platform.

Python and zig are only needed to build the libraries, not to run them.
"""

import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_EXCEPTION, as_completed, wait
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Self

from .. import paths
from ..errors import UserError
from ..interface.fingerprint import Files, digest
from ..interface.recipe import Fmi
from .compiler_process import CompilerPool, run_compiler
from .platforms import ROWS, Platform

FOLDER = Path(__file__).parent
FREESTANDING = FOLDER / "freestanding"  # what replaces a C library
OF_A_BLOCK = ("block.c", "block.h")
OF_AN_INSTANCE = "instance"  # so begin instance.c and its parts, one of which includes model.h
FLAGS = (
    "-Os -ffp-contract=off -fno-math-errno -fno-strict-aliasing -fno-slp-vectorize -fomit-frame-pointer "
    "-ffunction-sections -fdata-sections -fPIC -shared -fvisibility=hidden -g0 -s -rtlib=none -DOWN_MEMORY"
)
# What LLVM does for long loops is left out: code copied to paths that have not computed a value yet, values kept from
# one place to another, indices turned into pointers. A switch is a chain of comparisons. A block's steps are as quick
# so, and smaller. (-enable-ipra, by which calls save fewer registers, is not used: it makes wrong code for arm64.)
COMPACT = (
    "-mllvm -enable-pre=false -mllvm -disable-machine-licm -mllvm -disable-machine-cse -mllvm -disable-lsr "
    "-fno-jump-tables"
)
C_LIBRARY = "libc.so.6"  # Linux's, by the name that glibc has for it; musl knows that name, too
CACHE_NEEDED = (
    "it needs a folder that can be written (ZIG_GLOBAL_CACHE_DIR; else one in the user's cache) with 1 GB to spare; an "
    "FMU of --flavour python is built without zig"
)
CACHE_TIME = 20.0  # s within which zig has found its cache; it takes 10 ms, and for ever if it cannot be made
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


class Compilation:
    """The libraries of a unit, which zig's processes compile while the program does something else.

    As a context manager it waits at the end for compilers that still run, after an interruption it ends them; then it
    removes their folder."""

    def __init__(self, name: str, unit: Files, platforms: Sequence[Platform] = ROWS) -> None:
        """Start it. `name`: the block's; `unit`: the C of its unit (`c_sources`), of the platforms' version of FMI."""
        self.name, self.platforms = name, platforms
        self.folder = tempfile.TemporaryDirectory()
        self.pool = CompilerPool()
        work, submit = Path(self.folder.name), self.pool.submit
        c_names = sorted((file for file in unit if file.endswith(".c")), key=lambda file: (is_shared(file), file))
        sources = locate_sources(unit, c_names, work)
        self.jobs = {
            target: submit(compile_library, target, f"{COMPACT} {flags}", f"{target}/{name}.{p.suffix}", work, sources)
            for p in platforms
            for target, flags in p.targets.items()
        }

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self.folder:
            self.pool.__exit__(kind, error, trace)

    def libraries(self, progress: Callable[[str], None] = lambda text: None) -> Files:
        """Wait for the library of each platform, by its path in the FMU; `progress` gets lines of text if that takes
        long.

        Raises:
            UserError: zig failed.
        """
        if wait(self.jobs.values(), PATIENCE, FIRST_EXCEPTION).not_done:
            progress(SLOW)
            targets = {job: target for target, job in self.jobs.items()}
            for job in as_completed(targets):
                progress(f"compiled for {targets[job]}")
        results = {target: job.result() for target, job in self.jobs.items()}
        return {p.library(self.name): p.join(*(results[target] for target in p.targets)) for p in self.platforms}


def locate_sources(files: Files, c_names: Iterable[str], work: Path) -> list[str]:
    """The paths of these C files, with their headers next to them.

    zig caches what it has compiled, by path and contents of the source. What is the same in all instances is therefore
    compiled in its own folder. The rest lies in the user's cache, in a folder named after its contents: the block apart
    from its instance, since it is the same for both versions of FMI, all units of positions and all causalities. If the
    cache cannot be written it lies in `work`."""
    own = {name: text for name, text in files.items() if not is_shared(name)}
    folders: dict[str, Path] = {}
    for of_the_block in (True, False):
        part = {name: text for name, text in own.items() if (name in OF_A_BLOCK) == of_the_block}
        folders |= dict.fromkeys(part, _keep(part, work))
    return [str(folders.get(name, FOLDER) / name) for name in c_names]


def is_shared(name: str) -> bool:
    """Whether a C file or header is the same in all instances."""
    return not name.startswith(OF_AN_INSTANCE) and (FOLDER / name).is_file()


def _keep(files: Files, other: Path) -> Path:
    """A folder in the user's cache that holds these files; the folder `other` if the cache cannot be written."""
    with suppress(OSError, RuntimeError):  # there may be no folder for a cache
        folder = paths.own_cache("c", digest(files)[:32])
        for name, text in files.items():
            if not (file := folder / name).is_file() or file.read_bytes() != text:
                with paths.replace_file(file) as part:
                    part.write_bytes(text)
        return folder
    for name, text in files.items():
        (other / name).write_bytes(text)
    return other


def compile_library(target: str, flags: str, path: str, work: Path, sources: Sequence[str]) -> bytes:
    """The library of these C files, compiled in the folder `work` into `path`, for one of zig's targets with its own
    flags.

    Raises:
        UserError: zig failed.
    """
    (work / path).parent.mkdir()
    arguments = [*FLAGS.split(), *flags.split()]
    if "-linux-" in target:
        c_library = f"{target}/{C_LIBRARY}"
        zig_cc(target, [str(FREESTANDING / "libc.c"), *arguments, f"-Wl,-soname,{C_LIBRARY}"], c_library, work)
        arguments.append(c_library)
    return zig_cc(target, [*sources, *arguments], path, work)


def zig_cc(target: str, arguments: Sequence[str], path: str, work: Path) -> bytes:
    """What zig makes of C files and of what replaces a C library, in the folder `work`, for one of its targets.

    `path`: of the result, relative to the folder, in which headers are looked for first.

    Raises:
        UserError: zig failed.
    """
    _check_cache(work)
    command = [str(ZIG / "zig"), "cc", "-target", target]
    command += [f"-I{folder}" for folder in (".", FOLDER, FREESTANDING, HEADERS)]
    result = run_compiler([*command, *arguments, str(FREESTANDING / "freestanding.c"), "-o", path], work)
    if result.returncode:
        raise UserError(
            f"zig could not compile for {target}: {CACHE_NEEDED}. zig said:\n{result.stderr.strip()[-2000:]}"
        )
    return (work / path).read_bytes()


def _check_cache(work: Path) -> None:
    """Refuse to compile if zig does not find its cache: where it cannot be made, zig may try for ever."""
    try:
        run_compiler([str(ZIG / "zig"), "env"], work, CACHE_TIME)
    except UserError as e:
        raise UserError(f"zig cannot make its cache: {CACHE_NEEDED}; {e}") from None


def linked_licences(fmi: Fmi) -> Files:
    """The licences of what the libraries hold besides the block, by its name: FMI's headers."""
    header = (HEADERS / f"fmi{fmi}Functions.h").read_text("utf-8")
    return {"FMI's headers": header[header.index("Copyright") : header.index("*/")].encode()}
