"""A first scenario of one's own: the file `new.toml` in the folder of the block, with the user's figures.

Its table [figures] has the names of the figures that a user knows of a machine, each with the path of the value in the
scenario: `stroke = "start.axis.max_position"`."""

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from motionsync.blocks import BLOCKS

from ...errors import UserError, choose
from ...interface.block_folder import block_file
from ...interface.quantities import NUMBER, is_quantity
from .reader import read_scenario_text
from .toml_tables import writable

FILE = "new.toml"
FIGURES = "\n[figures]\n"
LINE = r'(?m)^(?P<key>"?{key}"? = )(?P<value>[^#\n]*?)(?P<space> *)(?P<comment># .*)?$'
SIGNED = re.compile(rf"[+-]?{NUMBER}", re.IGNORECASE)


@dataclass(frozen=True)
class Figure:
    """A figure of a machine.

    Attributes:
        name: as the option and the parameter have it: `line_speed`.
        value: the one of the template, as TOML writes it.
        meaning: what it is, in words.
    """

    name: str
    value: str
    meaning: str


def figures(block: str) -> list[Figure]:
    """The figures that a new scenario of this block takes."""
    text, paths = _template(block)
    listed = []
    for name, path in paths.items():
        match = _find(text, path)
        listed.append(Figure(name, match["value"].strip('"'), (match["comment"] or "").removeprefix("# ")))
    return listed


def new_scenario(block: str, given: Mapping[str, str | float], file: Path) -> str:
    """The text of a scenario of this block with the given figures, which are numbers or numbers with a unit.

    `file`: where it will be written, for the messages about it.

    Raises:
        UserError: the block has no such figure, or a value is not allowed.
    """
    text, paths = _template(block)
    for name, value in given.items():
        path = choose(paths, name, f"figure of {block}")
        match = _find(text, path)
        literal = _literal(name, value, is_count=match["value"].isdigit())
        padding = " " * max(1, len(match["value"] + match["space"]) - len(literal)) if match["comment"] else ""
        text = (
            text[: match.start("value")]
            + literal
            + padding
            + text[match.start("comment") if padding else match.end() :]
        )
    read_scenario_text(text, file)
    return text


def _template(block: str) -> tuple[str, dict[str, str]]:
    """The text of the template, and the paths of the figures in it."""
    text = block_file(choose(BLOCKS, block, "block"), FILE).read_text("utf-8")
    scenario, _, listed = text.partition(FIGURES)
    return scenario.rstrip("\n") + "\n", tomllib.loads(listed)


def _find(text: str, path: str) -> re.Match[str]:
    """The line with the value at a path."""
    table, _, key = path.partition(".")
    match = re.compile(LINE.format(key=re.escape(key))).search(text, text.index(f"\n[{table}]"))
    assert match, path
    return match


def _literal(name: str, value: str | float, *, is_count: bool) -> str:
    """A figure as TOML writes it, with or without a unit; `is_count`: a whole number."""
    text, option = str(writable(value)).strip(), f"--{name.replace('_', '-')}"
    if (number := SIGNED.match(text)) and float(number[0]) <= 0.0:
        raise UserError(f"{option} {text}: it must be above 0")
    if is_count:
        try:
            return str(int(text))
        except ValueError:
            raise UserError(f"{option} {text}: it must be a whole number, as in: {option} 2") from None
    try:
        return repr(float(text))
    except ValueError:
        if is_quantity(text):
            return json.dumps(text, ensure_ascii=False)
    raise UserError(f'{option} {text}: it must be a number, or one with a unit, as in: {option} "40 m/min"')
