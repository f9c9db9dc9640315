"""What mypy knows of the project and of the packages that it uses."""

import shutil
from pathlib import Path

from tests import ROOT


def copied_cache(folder: Path) -> Path:
    """mypy's cache from `make lint`, copied into a folder, where a test may change it; empty if there is none.

    It serves for a check with the options of pyproject.toml, which then takes a second instead of ten."""
    cached, copy = ROOT / ".mypy_cache", folder / "mypy_cache"
    if cached.is_dir():
        shutil.copytree(cached, copy)
    return copy
