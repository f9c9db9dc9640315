"""Modules that a test writes and imports."""

import importlib
import sys
from pathlib import Path
from types import ModuleType


def load_module(folder: Path, name: str, text: str) -> ModuleType:
    """Write a module of that text to a folder, and import it."""
    (folder / f"{name}.py").write_text(text, "utf-8")
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))
