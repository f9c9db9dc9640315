"""The folder of a block, with its description and its example, and what its source says of it."""

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from motionsync.blocks import BLOCKS


def block_file(block_type: type[Any], name: str) -> Path:
    """The path of the file of this name in the folder of a block."""
    return Path(str(sys.modules[block_type.__module__].__file__)).with_name(name)


def block_summary(name: str) -> str:
    """The first line of the docstring of a block, without its full stop. The block is not imported: that takes long."""
    spec = find_spec(BLOCKS.modules[name], "motionsync")
    assert spec
    assert spec.origin
    source = Path(spec.origin).read_text("utf-8")
    docstring = source.partition(f"\nclass {name}(")[2].partition('"""')[2]
    return docstring.partition('"""')[0].partition("\n")[0].rstrip(".")
