"""Finds a block's modules of tests, in `tests/model/<block>/`, by the block's name."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from motionsync_fmu.interface.recipe import Recipe


def block_folder(name: str) -> str:
    """The folder of a registered block, as in `model/motionsync`: flying_saw for FlyingSaw."""
    block: Any = Recipe(name).block()
    return str(type(block).__module__).split(".")[1]


def load_test_module(name: str, module: str) -> ModuleType:
    """The module of that name among the block's tests.

    Raises:
        LookupError: the block has none; the text says which file is missing.
    """
    package = f"tests.model.{block_folder(name)}"
    if not find_spec(package) or not find_spec(f"{package}.{module}"):
        raise LookupError(f"{name} needs tests/model/{block_folder(name)}/{module}.py")
    return import_module(f"{package}.{module}")
