"""The folder of a block, with its description and its example."""

import sys
from pathlib import Path
from typing import Any


def block_file(block_type: type[Any], name: str) -> Path:
    """The path of the file of this name in the folder of a block."""
    return Path(str(sys.modules[block_type.__module__].__file__)).with_name(name)
