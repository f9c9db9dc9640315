"""The folders for files whose path the user did not give, and files that are written as a whole or not at all."""

import errno
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from stat import S_IMODE, S_ISREG
from tempfile import TemporaryFile
from uuid import uuid4

from platformdirs import user_cache_path

OUTPUT = Path("build")
PRIVATE = 0o600  # the mode of a file in the cache that is run
PART = ".part"  # the end of the name of a file that is being written


def cache_folder() -> Path:
    """motionsync's folder in the user's cache, which may not exist."""
    return user_cache_path("motionsync", appauthor=False)


def own_cache(*names: str) -> Path:
    """A folder in motionsync's cache, made if it is missing, into which this user alone can look and write: what is run
    from there must be nobody else's.

    Raises:
        OSError: it cannot be made, or it is another user's.
        RuntimeError: there is no folder for a cache.
    """
    folder = cache_folder()
    folder.parent.mkdir(parents=True, exist_ok=True)
    for name in ("", *names):
        folder /= name
        folder.mkdir(0o700, exist_ok=True)
        if sys.platform != "win32":  # where the folders of a user have been his own
            status = folder.stat()
            if status.st_uid != os.geteuid():
                raise PermissionError(errno.EPERM, "it is another user's", str(folder))
            if S_IMODE(status.st_mode) & 0o077:
                folder.chmod(0o700)
    return folder


def is_own(file: Path) -> bool:
    """Whether a file is this user's, and nobody else can have written it.

    Raises:
        OSError: there is no such file.
    """
    if sys.platform == "win32":
        return True
    status = file.lstat()
    return S_ISREG(status.st_mode) and status.st_uid == os.geteuid() and not status.st_mode & 0o022


def output_folder(notify: Callable[[str], None]) -> Path:
    """The folder `build` in the current folder, or, if that cannot be written, the one in the user's cache.

    In the latter case `notify` is called with a line about it."""
    try:
        OUTPUT.mkdir(exist_ok=True)
        with TemporaryFile(dir=OUTPUT):
            return OUTPUT
    except OSError:
        cached = cache_folder() / OUTPUT
        notify(f"this folder cannot be written: all files go to {cached}")
        return cached


@contextmanager
def replace_file(target: Path) -> Iterator[Path]:
    """A path to write to, which becomes the target at the end, as by `replace_files`.

    Raises:
        OSError: it cannot be written; the error names the target.
    """
    with _replaced(target.parent, target) as part:
        yield part(target.name)


@contextmanager
def replace_files(folder: Path) -> Iterator[Callable[[str], Path]]:
    """A function that gives a path to write to for the name of a file in `folder`; at the end these become the files.

    After an error or an interruption nothing is left of them. If the process is killed, each file is as it was before
    or whole, and what was not finished has a name of its own, which ends with PART.

    Raises:
        OSError: they cannot be written; the error names the folder.
    """
    with _replaced(folder, folder) as part:
        yield part


@contextmanager
def _replaced(folder: Path, named: Path) -> Iterator[Callable[[str], Path]]:
    """As `replace_files`; `named`: what errors name."""
    parts: dict[str, Path] = {}
    is_new = not folder.exists()
    try:
        with _naming(named):
            folder.mkdir(parents=True, exist_ok=True)
            yield lambda name: parts.setdefault(name, folder / f"{name}.{uuid4().hex}{PART}")
            for part in parts.values():
                _flush(part)
            for name, part in parts.items():
                part.replace(folder / name)
    finally:
        for part in parts.values():
            part.unlink(missing_ok=True)
        if is_new:
            with suppress(OSError):  # it is not empty
                folder.rmdir()


def _flush(file: Path) -> None:
    """Write a file to the disk: one across a network may report only now that it is full."""
    with file.open("rb+") as stream:
        os.fsync(stream.fileno())


@contextmanager
def _naming(target: Path) -> Iterator[None]:
    """Name the target in errors of the system that name no file, as that of a full disk."""
    try:
        yield
    except OSError as e:
        if e.errno is None or e.filename:
            raise
        raise OSError(e.errno, e.strerror, str(target)) from e
