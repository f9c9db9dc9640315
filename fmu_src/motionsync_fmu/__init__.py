"""From a block to an FMU, and what is done with it: the command line as functions.

    from motionsync_fmu import run

    run("CutToLength/any_length", set={"master.velocity": 400.0}).passed

`__init__.pyi` lists the names; each is imported when it is used first. Before that nothing is imported, so that Ctrl-C
at the start of a command is no traceback.
"""

from functools import cache
from typing import Any

from .about import __version__ as __version__


@cache
def _public() -> Any:
    """What finds a name, what lists the names, and the names."""
    import lazy_loader  # noqa: PLC0415 (see above)

    return lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    find, _, names = _public()
    return names if name == "__all__" else find(name)


def __dir__() -> list[str]:
    return list(_public()[2])
