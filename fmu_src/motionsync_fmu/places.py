"""Where files are put that nobody gave a place."""

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryFile

from platformdirs import user_cache_path

OUTPUT = Path("build")


def cache() -> Path:
    """motionsync's folder in the user's cache, which may not exist."""
    return user_cache_path("motionsync", appauthor=False)


def output(tell: Callable[[str], None]) -> Path:
    """The folder `build` here; if it cannot be written, the one in the user's cache, which `tell` gets a line about."""
    try:
        OUTPUT.mkdir(exist_ok=True)
        with TemporaryFile(dir=OUTPUT):
            return OUTPUT
    except OSError:
        tell(f"this folder cannot be written: all goes to {cache() / OUTPUT}")
        return cache() / OUTPUT
