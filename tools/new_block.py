"""Writes the files of a new block, which begins as a copy of the Shifter, and registers it.

python -m tools.new_block NAME        (as FlyingSaw is written)
"""

import re
import sys
from pathlib import Path

from motionsync.blocks import BLOCKS

ROOT = Path(__file__).parents[1]
FILES = ROOT / "tests" / "support" / "new_block"  # with the paths that they have in the project
LAST_ROW = "| follow a master on another controller"  # of the table in README


def write_block(name: str, root: Path = ROOT) -> list[Path]:
    """Write the files of a block of that name into a checkout of the project, and enter it in blocks.py and README.md.

    Returns:
        The files, relative to `root`; the last two are those that existed.

    Raises:
        ValueError: the name is none that a block can have, or files of the block exist.
    """
    if not re.fullmatch(r"([A-Z][a-z0-9]+)+", name):
        raise ValueError(f"NAME = {name} is not allowed: it must be a word or several, as Gearing or FlyingSaw")
    folder = re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()
    texts = {
        Path(renamed(str(file.relative_to(FILES)), name, folder)): renamed(file.read_text("utf-8"), name, folder)
        for file in sorted(FILES.rglob("*"))
        if file.is_file() and file.suffix != ".pyc" and file.name != "conftest.py"
    }
    if name in BLOCKS or (existing := next((path for path in texts if (root / path).exists()), None)):
        raise ValueError(f"NAME = {name} is not allowed: {'there is such a block' if name in BLOCKS else existing}")
    registry, front = Path("model/motionsync/blocks.py"), Path("README.md")
    text = (root / registry).read_text("utf-8")
    imports = re.findall(r"^    from \..*\n", text, re.M)
    added = sorted([*imports, f"    from .{folder}.block import {name} as {name}\n"])
    text = text.replace("".join(imports), "".join(added))
    texts[registry] = text.replace("\n    }\n", f'\n        "{name}": ".{folder}.block",\n    }}\n')
    row = f"| … | [`{name}`](model/motionsync/{folder}/README.md) |\n"
    texts[front] = (root / front).read_text("utf-8").replace(LAST_ROW, row + LAST_ROW, 1)
    for path, text in texts.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, "utf-8")
    return list(texts)


def renamed(text: str, name: str, folder: str) -> str:
    """A text about the Shifter as one about the block."""
    return text.replace("Shifter", name).replace("shifter", folder)


if __name__ == "__main__":
    try:
        (requested,) = sys.argv[1:]
        written = write_block(requested)
    except ValueError as error:
        print(error if len(sys.argv) == 2 else __doc__, file=sys.stderr)
        sys.exit(2)
    print(*written, sep="\n")
    print("What to write in them, and in which order, is in CONTRIBUTING.md: Add a block")
