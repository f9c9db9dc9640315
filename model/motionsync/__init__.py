"""Master/slave motion synchronisation: the motion laws and the blocks. Standard library only; no I/O, no FMI.

    from motionsync import CutToLength

A block is imported when its name is used, since an FMU has the modules of its own block alone.
"""

from importlib import import_module
from typing import Any


def __getattr__(name: str) -> Any:
    if not name[:1].isupper():  # a module, which `from . import` asks for before it imports it
        raise AttributeError(f"motionsync has no {name}")
    blocks = import_module(f"{__name__}.blocks").BLOCKS
    if name in blocks:
        return blocks[name]
    raise AttributeError(f"motionsync has no {name}; it has {', '.join(blocks)}")


def __dir__() -> list[str]:
    return [*globals(), *import_module(f"{__name__}.blocks").BLOCKS]
