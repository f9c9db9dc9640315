"""libcosim, which has wheels for Linux on x86-64 and for Windows only."""

from importlib import import_module
from types import SimpleNamespace

import pytest

CLASSES = {
    "CosimEnums": "CosimExecutionState",
    "CosimExecution": "CosimExecution",
    "CosimManipulator": "CosimManipulator",
    "CosimObserver": "CosimObserver",
    "CosimSlave": "CosimLocalSlave",
}


def cosim() -> SimpleNamespace:
    """libcosim's classes by their names; the test is skipped where libcosim is not installed."""
    pytest.importorskip("libcosimpy")
    return SimpleNamespace(**{c: getattr(import_module(f"libcosimpy.{m}"), c) for m, c in CLASSES.items()})
