"""The folders for files whose path the user did not give, and files that are written as a whole or not at all."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile
from uuid import uuid4

from platformdirs import user_cache_path

OUTPUT = Path("build")
PART = ".part"  # the end of the name of a file that is being written


def cache_folder() -> Path:
    """motionsync's folder in the user's cache, which may not exist."""
    return user_cache_path("motionsync", appauthor=False)


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
