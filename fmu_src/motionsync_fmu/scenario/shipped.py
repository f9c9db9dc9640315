"""The scenarios and lines that come with motionsync, and how they are found by name in any folder.

A wheel holds them beside the modules; in a checkout they are the folder `scenarios` itself."""

from difflib import get_close_matches
from pathlib import Path

from ..errors import UserError

HERE = Path(__file__).parents[1]
FILE = "scenario.toml"
LINES = "line*.toml"


def shipped() -> Path:
    """The folder with the scenarios that come with motionsync."""
    inside = HERE / "scenarios"
    return inside if inside.is_dir() else HERE.parents[1] / "scenarios"


def find(path: Path, pattern: str = FILE) -> list[Path]:
    """The files at a path: the file itself, or all below a folder whose names match the pattern.

    A path that does not exist here may name something that comes with motionsync: `FlyingSaw/cyclic_cut`, `FlyingSaw`.

    Raises:
        UserError: there is none; the message has the nearest names.
    """
    place = path if path.exists() else shipped() / path
    if place.is_file():
        return [place]
    found = sorted(place.rglob(pattern))
    if not found:
        reason = f"no {pattern} below it" if place.is_dir() else f"no such file or folder{nearest(str(path), pattern)}"
        raise UserError(f"{path}: {reason}")
    return found


def find_one(path: Path) -> Path:
    """The scenario's file at a path.

    Raises:
        UserError: there is none, or there are several; the message has names.
    """
    found = find(path)
    if len(found) > 1:
        names = ", ".join(called(file) for file in found[:3])
        raise UserError(f"{path}: there are {len(found)} scenarios: name one of them, as {names}")
    return found[0]


def called(file: Path) -> str:
    """The name under which `find` finds a scenario or line: short if it comes with motionsync, else its path."""
    named = file.parent if file.name == FILE else file
    return named.relative_to(shipped()).as_posix() if named.is_relative_to(shipped()) else str(named)


def nearest(name: str, pattern: str = FILE) -> str:
    """The names that were probably meant, as the end of a sentence; empty if there is none like it."""
    known = [called(file) for file in sorted(shipped().rglob(pattern))]
    known += dict.fromkeys(n.partition("/")[0] for n in known)
    spelt = {n.lower(): n for n in known}
    asked = name.replace("\\", "/").removeprefix("scenarios/").strip("/").lower()
    near = [spelt[n] for n in get_close_matches(asked, spelt)]
    return f"; did you mean {' or '.join(near)}?" if near else ""
