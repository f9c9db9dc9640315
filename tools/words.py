"""Refuses words of a private language in names and prose: `words.toml` lists them, with what to use instead.

python -m tools.words
"""

import io
import re
import subprocess
import sys
import tokenize
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
LIST = Path(__file__).with_name("words.toml")
CODE = re.compile(  # of C and JavaScript: a comment or a string, or else a name
    r"""(?P<prose>/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`)"""
    r"""|[A-Za-z_$]\w*""",
    re.S,
)
NAME = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")  # the words of a name in any case
WORD = re.compile(r"[A-Za-z]+")
TEXTS = (".md", ".toml", ".j2", ".css", "Makefile")
CODES = (".c", ".h", ".js")
SKIPPED = ("vendor/", "tools/words.toml")

Part = tuple[int, str, str]  # a line, "identifiers" or "prose", and the text


def python_parts(text: str) -> Iterator[Part]:
    """The names of a Python file, and its comments and strings; the name of a test is a sentence.

    A dotted name is one part, and so is a field with its type: an exception may be `last.good` or `good: bool`."""
    line, name = 0, ""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if name and token.string in (".", ":"):
            name += {".": ".", ":": ": "}[token.string]
        elif token.type == tokenize.NAME and name.endswith((".", ": ")):
            name += token.string
        else:
            if name:
                yield line, "prose" if name.startswith("test_") else "identifiers", name
            line, name = token.start[0], token.string if token.type == tokenize.NAME else ""
            if token.type in (tokenize.COMMENT, tokenize.STRING):
                yield line, "prose", token.string


def code_parts(text: str) -> Iterator[Part]:
    """The names of a C or JavaScript file, and its comments and strings."""
    for match in CODE.finditer(text):
        kind = "prose" if match["prose"] else "identifiers"
        yield text.count("\n", 0, match.start()) + 1, kind, match[0]


def parts(path: Path) -> Iterator[Part]:
    """What is checked of a file."""
    if path.suffix == ".py":
        yield from python_parts(path.read_text("utf-8"))
    elif path.suffix in CODES:
        yield from code_parts(path.read_text("utf-8"))
    elif path.name.endswith(TEXTS):
        yield 1, "prose", path.read_text("utf-8")


def refused(part: Part, words: Mapping[str, Mapping[str, str]]) -> Iterator[tuple[int, str, str]]:
    """The words of a part that are refused: line, word, and what to use instead."""
    line, kind, text = part
    pattern = NAME if kind == "identifiers" else WORD
    if words[kind].keys().isdisjoint(map(str.lower, pattern.findall(text))):
        return
    for exception in words["exceptions"]:
        text = text.replace(exception, "-" * len(exception))
    for match in pattern.finditer(text):
        if instead := words[kind].get(match[0].lower()):
            yield line + text.count("\n", 0, match.start()), match[0], instead


def main() -> None:
    """Print each refused word with its place; the exit status is 1 if there is one."""
    words = tomllib.loads(LIST.read_text("utf-8"))
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    files = [name for name in listed.split("\0") if name and not any(s in name for s in SKIPPED)]
    lines = [
        f"{name}:{line}: {word!r} is none of the project's words; use {instead}"
        for name in files
        if (ROOT / name).is_file()
        for part in parts(ROOT / name)
        for line, word, instead in refused(part, words)
        if f"{name}:{word}" not in words["exceptions"]
    ]
    print(*lines, sep="\n", end="\n" if lines else "")
    sys.exit(bool(lines))


if __name__ == "__main__":
    main()
