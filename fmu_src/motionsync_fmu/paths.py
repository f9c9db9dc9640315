"""The folders for files whose path the user did not give."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryFile

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
