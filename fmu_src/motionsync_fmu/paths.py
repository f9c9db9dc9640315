"""The folders for files whose path the user did not give, and files that are written as a whole or not at all."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

from platformdirs import user_cache_path

OUTPUT = Path("build")


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
    """A path to write to, which becomes the target at the end. After an error or an interruption nothing is left of it.

    Raises:
        OSError: it cannot be written; the error names the target.
    """
    part = target.with_name(f"{target.name}.{os.getpid()}.part")
    try:
        with _naming(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            yield part
            part.replace(target)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def replace_files(folder: Path) -> Iterator[Path]:
    """A folder to write into, whose files are moved into `folder` at the end. After an error or an interruption nothing
    is left of it.

    Raises:
        OSError: it cannot be written; the error names the folder.
    """
    with _naming(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=folder.parent, prefix=".part-") as part:
            yield Path(part)
            folder.mkdir(exist_ok=True)
            for file in sorted(Path(part).iterdir()):
                file.replace(folder / file.name)


@contextmanager
def _naming(target: Path) -> Iterator[None]:
    """Name the target in errors of the system that name no file, as that of a full disk."""
    try:
        yield
    except OSError as e:
        if e.errno is None or e.filename:
            raise
        raise OSError(e.errno, e.strerror, str(target)) from e
