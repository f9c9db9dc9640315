"""The library of a block for this process: its C text and the C of this folder, compiled for this machine.

zig compiles it, as it compiles the library in an FMU, if it is installed (the extra `native`); otherwise the machine's
own C compiler does. The libraries of the project's own blocks are kept in the user's cache, so that the next process
only loads them; of several processes that begin at the same time one compiles, and the others wait for it."""

import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from ctypes import CDLL
from hashlib import sha256
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

from filelock import FileLock

from motionsync import var

from ... import places
from ...archive import Files, digest
from ...errors import UserError
from ...extras import how_to_install
from ...interface.recipe import Fmi
from ..platforms import here
from ..translator import c_source
from .plan import Cause

LOOP = Path(__file__).parent  # whose C is compiled with every block
MADE_FROM = (Path(str(var.__file__)).parent, LOOP.parent)  # the folders of the model and of all that compiles it
# After zig's flags for a library in an FMU, which is to be small, and shows nothing but the functions of FMI.
ZIG_FLAGS = "-O2 -fvisibility=default"
COMPILERS = ("cc", "gcc", "clang")  # of the machine itself
FLAGS = "-std=c99 -O2 -ffp-contract=off -fno-math-errno -fPIC -shared -g0"  # of these
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
UNKEPT = (OSError, RuntimeError)  # the cache cannot be read, written or locked, or nobody knows where it is
PATIENCE = 300.0  # s; a process that compiles for longer is no longer waited for

_libraries: dict[type[Any], CDLL] = {}
_compiling = Lock()


def library(block_type: type[Any]) -> CDLL:
    """A block's library: `block_initialize` and `block_step` of its C text, `batch_run` of loop.c, and `script_run` of
    script.c.

    The first call for a block in a process loads it, and compiles it if it is not in the cache.

    Raises:
        UserError: no C compiler is installed, or it failed.
    """
    with _compiling:
        if block_type not in _libraries:
            own = block_type.__module__.partition(".")[0] == var.__package__
            _libraries[block_type] = _kept(block_type) if own else _loaded(_compiled(block_type))
        return _libraries[block_type]


def _kept(block_type: type[Any]) -> CDLL:
    """The library from the user's cache; if it is not there as it was made, it is made anew.

    The name of a library's file says from what it was made, and ends with the hash of its contents: what has been
    damaged is not loaded."""
    name = block_type.__name__
    begin = f"{name}-{_made_from()[:16]}-"
    if found := _found(begin):
        return found
    with _alone(name):
        return _found(begin) or _made(block_type, begin)


def _found(begin: str) -> CDLL | None:
    """The library whose file's name begins so, if it is in the cache as it was made."""
    with suppress(*UNKEPT):
        for file in _folder().glob(f"{begin}*{SUFFIX}"):
            if file.name == _file_name(begin, file.read_bytes()):
                return CDLL(str(file))
    return None


def _made(block_type: type[Any], begin: str) -> CDLL:
    """The library, compiled now. It takes the place of older ones of its block, if anything can be kept."""
    made = _compiled(block_type)
    with suppress(*UNKEPT):
        folder, name = _folder(), block_type.__name__
        for old in folder.glob(f"{name}-*{SUFFIX}"):
            with suppress(OSError):  # another process has loaded it, on Windows
                old.unlink()
        part = folder / f"{name}.{os.getpid()}.part"
        part.write_bytes(made)
        return CDLL(str(part.replace(folder / _file_name(begin, made))))
    return _loaded(made)


@contextmanager
def _alone(name: str) -> Iterator[None]:
    """Let no other process of this user compile the block of that name; where nothing can be kept, nobody waits.

    The operating system ends the lock of a process that dies."""
    with ExitStack() as stack:
        with suppress(*UNKEPT):
            _folder().mkdir(parents=True, exist_ok=True)
            stack.enter_context(FileLock(_folder() / f"{name}.lock", PATIENCE))
        yield


def _folder() -> Path:
    return places.cache() / "blocks"


def _made_from() -> str:
    """A hash of all that a library depends on, and of some files more: to find out which matter would take longer."""
    files = {
        f"{number}/{file.relative_to(folder).as_posix()}": file.read_bytes()
        for number, folder in enumerate(MADE_FROM)
        for file in folder.rglob("*.*")
        if file.suffix in (".py", ".c", ".h")
    }
    compiler = f"zig {metadata.version('ziglang')}" if _has_zig() else _compiler()
    return digest(files | {"machine": f"{compiler} {platform.system()} {platform.machine()}".encode()})


def _file_name(begin: str, contents: bytes) -> str:
    return f"{begin}{sha256(contents).hexdigest()[:32]}{SUFFIX}"


def _loaded(made: bytes) -> CDLL:
    """The library, loaded from a file that does not last; Windows keeps the file until somebody cleans up."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        file = Path(folder) / f"block{SUFFIX}"
        file.write_bytes(made)
        return CDLL(str(file))


def _compiled(block_type: type[Any]) -> bytes:
    """The library of a block, compiled for this machine.

    Raises:
        UserError: no C compiler is installed, or it failed.
    """
    with TemporaryDirectory() as folder:
        work = Path(folder)
        for name, text in (c_source(block_type()) | loop_source()).items():
            (work / name).write_bytes(text)
        return _compiled_by_zig(work) if _has_zig() else _compiled_by_machine(work)


def loop_source() -> Files:
    """The C of this folder, and causes.h."""
    causes = "".join(f"#define CAUSE_{cause.name} {cause.value}\n" for cause in Cause)
    return {"causes.h": causes.encode()} | {file.name: file.read_bytes() for file in LOOP.glob("*.[ch]")}


def _has_zig() -> bool:
    return find_spec("ziglang") is not None and here(Fmi.THREE) is not None


def _compiled_by_zig(work: Path) -> bytes:
    """The library of the C files in a folder, for any machine of this one's kind: machines may share a cache."""
    from ..libraries import compiled  # noqa: PLC0415 (it needs zig)

    platform = here(Fmi.THREE)
    assert platform
    ((target, flags),) = platform.targets.items()
    return compiled(target, f"{flags} {ZIG_FLAGS}", f"{target}/block{SUFFIX}", work)


def _compiled_by_machine(work: Path) -> bytes:
    command = [_compiler(), *FLAGS.split(), *(file.name for file in work.glob("*.c")), "-lm", "-o", f"block{SUFFIX}"]
    done = subprocess.run(command, cwd=work, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        raise UserError(f"{command[0]} could not compile a batch; it said:\n{done.stderr.strip()[-2000:]}")
    return (work / f"block{SUFFIX}").read_bytes()


def _compiler() -> str:
    """The machine's own C compiler.

    Raises:
        UserError: there is none.
    """
    found = next(filter(None, map(shutil.which, COMPILERS)), None)
    if not found:
        raise UserError(f"batches are compiled with ziglang, which is not installed: {how_to_install('native')}")
    return found
