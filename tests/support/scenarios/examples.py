"""The commands that help texts and pages show: `motionsync …`, with what a shell makes of them."""

import inspect
import re
import shlex
from importlib import import_module

from motionsync_fmu.commands.app import COMMANDS, app
from tests import ROOT

PLACEHOLDER = re.compile(r"[A-Z|]+|NAME=.*|.*…|\[.*")  # what stands for an argument, or for some
COMMAND = re.compile(rf"^ *motionsync ((?:{'|'.join(COMMANDS)})\b.*)$", re.M)
IN_PROSE = re.compile(rf"`motionsync ((?:{'|'.join(COMMANDS)})\s[^`-][^`]*)`")
PAGES = [
    path.relative_to(ROOT).as_posix()
    for path in (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *sorted((ROOT / "docs").rglob("*.md")),
        *sorted((ROOT / "scenarios").rglob("*.md")),
        *sorted((ROOT / "examples").rglob("*.md")),
        *sorted((ROOT / "model").rglob("*.md")),
    )
]


def help_of(command: str) -> str:
    """The text of a command's help without its options; of the command line itself if it is empty."""
    if not command:
        return str(app.info.epilog)
    return inspect.getdoc(import_module(f"motionsync_fmu.commands.{command.replace('-', '_')}").command) or ""


def shown_commands(text: str) -> list[list[str]]:
    """The arguments of each command that a help text or a page shows, in their sequence: lines of code, and code in
    prose that has arguments. What has a placeholder is left out."""
    joined = re.sub(r" *\\\n\s*", " ", text)
    matches = sorted((m.start(), m[1]) for m in [*COMMAND.finditer(joined), *IN_PROSE.finditer(joined)])
    split = [shlex.split(shown.replace("\n", " "), comments=True) for _, shown in matches]
    return [words for words in split if not any(map(PLACEHOLDER.fullmatch, words))]
