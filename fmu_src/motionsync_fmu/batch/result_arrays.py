"""New arrays for results, if they fit into memory: an array that does not is refused before anything is computed."""

import os
from math import inf, prod

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError

UNITS = ("B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB")


def new_array(what: str, shape: tuple[int, ...], instead: str) -> NDArray[np.float64]:
    """An array of numbers without values; `what` names it, and `instead` is the advice if it is too large.

    Linux would promise more memory than there is, and end the process when it is used.

    Raises:
        UserError: it is larger than the memory of this machine, or the system does not provide it.
    """
    size = 8 * prod(shape)
    try:
        if size <= memory_of_machine():
            return np.empty(shape)
    except (MemoryError, ValueError):  # ValueError: NumPy cannot even count its bytes
        pass
    raise UserError(
        f"{what} of shape {shape} would take {format_size(size)}, which does not fit into memory: {instead}"
    )


def memory_of_machine() -> float:
    """In bytes; infinite on Windows, which gives no memory that it does not have."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):
        return inf


def format_size(size: float) -> str:
    """A number of bytes with its unit."""
    power = min(max(int(size).bit_length() - 1, 0) // 10, len(UNITS) - 1)
    return f"{size / 1024**power:.1f} {UNITS[power]}"
