"""Finds what the tests hold for a block by the block's name: the modules of `tests/model/<block>/`."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from motionsync_fmu.interface.recipe import Recipe


def folder(name: str) -> str:
    """The folder of a registered block, as in `model/motionsync`: FlyingSaw lies in flying_saw."""
    block: Any = Recipe(name).block()
    return str(type(block).__module__).split(".")[1]


def own(name: str, module: str) -> ModuleType:
    """The module of that name among the block's tests.

    Raises:
        LookupError: the block has none; the text says which file is missing.
    """
    found = f"tests.model.{folder(name)}"
    if not find_spec(found) or not find_spec(f"{found}.{module}"):
        raise LookupError(f"{name} needs tests/model/{folder(name)}/{module}.py")
    return import_module(f"{found}.{module}")
