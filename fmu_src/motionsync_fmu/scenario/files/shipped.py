"""The scenarios and lines that come with motionsync, found by name from any folder.

A wheel holds them next to the modules; in a checkout they are the folder `scenarios` itself."""

from difflib import get_close_matches
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

from motionsync.blocks import BLOCKS

from ...errors import UserError

PACKAGE = Path(__file__).parents[2]
SCENARIO_FILE = "scenario.toml"
LINE_FILES = "line*.toml"
KINDS = {SCENARIO_FILE: "scenarios", LINE_FILES: "lines"}


@cache
def shipped_folder() -> Path:
    """The folder with the scenarios that come with motionsync."""
    packaged = PACKAGE / "scenarios"
    return packaged if packaged.is_dir() else PACKAGE.parents[1] / "scenarios"


def find_files(path: Path, pattern: str = SCENARIO_FILE) -> list[Path]:
    """The files at a path: the file itself, or all below a folder whose names match the pattern.

    A path that does not exist may name something that comes with motionsync: `FlyingSaw/cyclic_cut`, `FlyingSaw`.

    Raises:
        UserError: there is none; the message has similar names.
    """
    location = path if path.exists() else shipped_folder() / path
    if location.is_file():
        return [location]
    files = sorted(file for file in location.rglob("*") if fnmatch(file.name, pattern))  # links to nothing, too
    if not files:
        missing = f"no such file or folder{suggest_names(str(path), pattern)}"
        raise UserError(f"{path}: {f'no {pattern} below it' if location.is_dir() else missing}")
    return files


def find_scenario(path: Path, pattern: str = SCENARIO_FILE) -> Path:
    """The one file at a path, of those that `find_files` finds.

    Raises:
        UserError: there is none, or there are several; the message has names.
    """
    files = find_files(path, pattern)
    if len(files) > 1:
        names, what = ", ".join(scenario_name(file) for file in files[:3]), KINDS[pattern]
        raise UserError(f"{path}: there are {len(files)} {what}: name one of them, as {names}")
    return files[0]


def scenario_name(file: Path) -> str:
    """The name by which `find_files` finds a scenario or line: short if it comes with motionsync, else its path."""
    path = file.parent if file.name == SCENARIO_FILE else file
    return path.relative_to(shipped_folder()).as_posix() if path.is_relative_to(shipped_folder()) else str(path)


def suggest_names(name: str, pattern: str = SCENARIO_FILE) -> str:
    """The names that were probably meant, or of scenarios the blocks if none is similar, as the end of a sentence."""
    names = [scenario_name(file) for file in sorted(shipped_folder().rglob(pattern))]
    names += dict.fromkeys(n.partition("/")[0] for n in names)
    by_lower = {n.lower(): n for n in names}
    requested = name.replace("\\", "/").removeprefix("scenarios/").strip("/").lower()
    similar = [by_lower[n] for n in get_close_matches(requested, by_lower)]
    if similar:
        return f"; did you mean {' or '.join(similar)}?"
    if pattern != SCENARIO_FILE:
        return ""
    return f"; there is {', '.join(BLOCKS)}, and motionsync list names the scenarios of each"
