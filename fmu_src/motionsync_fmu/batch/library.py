"""The library of a block for this process: its C text and the C of this folder, compiled for this machine.

zig compiles it, as it compiles the library in an FMU, if it is installed (the extra `native`); otherwise the machine's
own C compiler does. The libraries of the project's own blocks are stored in the user's cache, so that the next
process only loads them; of several processes that start at the same time one compiles, and the others wait for it."""

import platform
import shutil
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from ctypes import CDLL
from functools import cache
from hashlib import sha256
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

from filelock import FileLock

from motionsync import var

from .. import paths
from ..compiler.translator import c_source, c_text
from ..errors import UserError
from ..interface.fingerprint import Files, digest
from ..interface.recipe import Fmi
from ..native.compiler_process import run_compiler
from ..native.platforms import host_platform
from ..optional_dependencies import how_to_install
from ..runner.run import Run
from .batch_layout import Cause

BATCH_FOLDER = Path(__file__).parent  # whose C is compiled with every block
SOURCE_FOLDERS = (  # the folders of the model and of all that compiles it
    Path(str(var.__file__)).parent,
    *(BATCH_FOLDER.with_name(name) for name in ("batch", "compiler", "native", "runner")),
)
# After zig's flags for a library in an FMU, which is to be small, and shows nothing but the functions of FMI. With the
# usual threshold it depends on chance which functions of a step are inlined, and a step takes up to 1.5 times as long.
ZIG_FLAGS = "-O2 -mllvm -inline-threshold=500 -fvisibility=default"
COMPILERS = ("cc", "gcc", "clang")  # of the machine itself
FLAGS = "-std=c99 -O2 -ffp-contract=off -fno-math-errno -fPIC -shared -g0"  # of these
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
CACHE_ERRORS = (OSError, RuntimeError)  # the cache cannot be read, written or locked, or there is no folder for it
LOCK_TIMEOUT = 300.0  # s; other processes do not wait longer for one that compiles

_libraries: dict[type[Any], CDLL] = {}
_compiling = Lock()


def library(block_type: type[Any]) -> CDLL:
    """A block's library: `block_initialize` and `block_step` of its C text, `batch_run` of loop.c, and `script_run` of
    scenario_batch.c.

    The first call for a block in a process loads it, and compiles it if it is not in the cache.

    Raises:
        UserError: no C compiler is installed, or it failed.
    """
    with _compiling:
        if block_type not in _libraries:
            is_own = block_type.__module__.partition(".")[0] == var.__package__
            _libraries[block_type] = _cached_library(block_type) if is_own else _load(_compile(block_type))
        return _libraries[block_type]


def _cached_library(block_type: type[Any]) -> CDLL:
    """The library from the user's cache; it is compiled if it is missing or damaged.

    The name of a library's file has the hash of its sources, and ends with that of its contents."""
    name = block_type.__name__
    prefix = f"{name}-{_hash_sources()[:16]}-"
    if library := _load_from_cache(prefix):
        return library
    with _lock_block(name):
        return _load_from_cache(prefix) or _compile_into_cache(block_type, prefix)


def _load_from_cache(prefix: str) -> CDLL | None:
    """The library whose file's name has that prefix, if it is in the cache and undamaged."""
    with suppress(*CACHE_ERRORS):
        for file in _folder().glob(f"{prefix}*{SUFFIX}"):
            if paths.is_own(file) and file.name == _file_name(prefix, file.read_bytes()):
                return CDLL(str(file))
    return None


def _compile_into_cache(block_type: type[Any], prefix: str) -> CDLL:
    """Compile and load the library. It replaces older ones of its block, if the cache can be written."""
    contents = _compile(block_type)
    with suppress(*CACHE_ERRORS):
        folder, name = _folder(), block_type.__name__
        for old in folder.glob(f"{name}-*{SUFFIX}"):
            with suppress(OSError):  # another process has loaded it, on Windows
                old.unlink()
        target = folder / _file_name(prefix, contents)
        with paths.replace_file(target) as part:
            part.write_bytes(contents)
            part.chmod(paths.PRIVATE)
        return CDLL(str(target))
    return _load(contents)


@contextmanager
def _lock_block(name: str) -> Iterator[None]:
    """Let no other process of this user compile the block of that name, if the cache can be written.

    The operating system ends the lock of a process that dies."""
    with ExitStack() as stack:
        with suppress(*CACHE_ERRORS):
            stack.enter_context(FileLock(_folder() / f"{name}.lock", LOCK_TIMEOUT))
        yield


def _folder() -> Path:
    return paths.own_cache("blocks")


def _hash_sources() -> str:
    """A hash of all that a library depends on, and of other files: it takes longer to select the relevant ones."""
    files = {
        f"{number}/{file.relative_to(folder).as_posix()}": file.read_bytes()
        for number, folder in enumerate(SOURCE_FOLDERS)
        for file in folder.rglob("*.*")
        if file.suffix in (".py", ".c", ".h")
    }
    compiler = f"zig {metadata.version('ziglang')}" if _has_zig() else _compiler()
    return digest(files | {"machine": f"{compiler} {platform.system()} {platform.machine()}".encode()})


def _file_name(prefix: str, contents: bytes) -> str:
    return f"{prefix}{sha256(contents).hexdigest()[:32]}{SUFFIX}"


def _load(contents: bytes) -> CDLL:
    """The library, loaded from a temporary file, which Windows does not delete."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        file = Path(folder) / f"block{SUFFIX}"
        file.write_bytes(contents)
        return CDLL(str(file))


def _compile(block_type: type[Any]) -> bytes:
    """Compile the library of a block for this machine."""
    with TemporaryDirectory() as folder:
        work = Path(folder)
        for name, text in (c_source(block_type()) | batch_sources()).items():
            (work / name).write_bytes(text)
        return _compile_with_zig(work) if _has_zig() else _compile_with_machine_compiler(work)


def batch_sources() -> Files:
    """The C of this folder, causes.h, and run.h."""
    causes = "".join(f"#define CAUSE_{cause.name} {cause.value}\n" for cause in Cause)
    return {"causes.h": causes.encode(), "run.h": run_source()} | {
        file.name: file.read_bytes() for file in BATCH_FOLDER.glob("*.[ch]")
    }


@cache
def run_source() -> bytes:
    """The run of a scenario in C, which the hosts in C include."""
    return c_text(Run, ("start", "begin", "try_prepare", "finish", "sample")).encode()


def _has_zig() -> bool:
    return find_spec("ziglang") is not None and host_platform(Fmi.THREE) is not None


def _compile_with_zig(work: Path) -> bytes:
    """Compile the C files in a folder for any machine of this one's kind: machines may share a cache."""
    from ..native.libraries import compile_library  # noqa: PLC0415 (it needs zig)

    platform = host_platform(Fmi.THREE)
    assert platform
    ((target, flags),) = platform.targets.items()
    sources = sorted(source.name for source in work.glob("*.c"))
    return compile_library(target, f"{flags} {ZIG_FLAGS}", f"{target}/block{SUFFIX}", work, sources)


def _compile_with_machine_compiler(work: Path) -> bytes:
    command = [_compiler(), *FLAGS.split(), *(file.name for file in work.glob("*.c")), "-lm", "-o", f"block{SUFFIX}"]
    process = run_compiler(command, work)
    if process.returncode:
        raise UserError(f"{command[0]} could not compile a batch:\n{process.stderr.strip()[-2000:]}")
    return (work / f"block{SUFFIX}").read_bytes()


def _compiler() -> str:
    """The machine's own C compiler."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if not compiler:
        raise UserError(f"batches are compiled with ziglang, which is not installed: {how_to_install('native')}")
    return compiler
