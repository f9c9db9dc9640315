"""Lines of C: numbers, comments, docstrings, and long lines in several."""

import ast
import io
import math
import textwrap
import tokenize
from collections.abc import Iterator

WIDTH = 120
# Where a line is broken first, of the positions with the fewest parentheses open.
BREAKS = {",": 0, "?": 1, ":": 1, "||": 2, "&&": 3, "+": 4, "-": 4, "*": 5, "/": 5}
LOOSEST = 99


def literal(value: float) -> str:
    """A number or Boolean; the digits of a float are the fewest that read back as the same one."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if math.isnan(value):
        return "NAN"
    return f"{'-' if value < 0 else ''}INFINITY" if math.isinf(value) else repr(value)


def comments(text: str) -> Iterator[tuple[int, tuple[bool, str]]]:
    """The comments of a Python text by line: whether one has the line for itself, and its words."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith(("# noqa", "# type:", "#!")):
            yield token.start[0], (not token.line[: token.start[1]].strip(), token.string[1:].strip())


def as_comment(words: str) -> str:
    return f"/* {words.replace('/*', '/ *').replace('*/', '* /')} */"


def docstring(node: ast.Module | ast.ClassDef | ast.FunctionDef) -> list[str]:
    """A docstring as lines of a comment."""
    words = ast.get_docstring(node)
    if not words:
        return []
    paragraphs = [fill(paragraph) for paragraph in as_comment(words).split("\n\n")]
    first, *others = "\n\n".join(paragraphs).splitlines()
    return [first, *(f" * {line}".rstrip() for line in others)]


def fill(paragraph: str) -> str:
    """A paragraph with lines that are short enough for a comment; unchanged if they are already."""
    width = WIDTH - len(" * ")
    if all(len(line) <= width for line in paragraph.splitlines()):
        return paragraph
    return textwrap.fill(" ".join(paragraph.split()), width)


def append_comment(line: str, words: list[str]) -> list[str]:
    """A line with a comment at its end, or before it where that is too long; the line itself is folded."""
    if not words:
        return fold(line)
    end = as_comment("; ".join(words))
    if len(f"{line} {end}") <= WIDTH:
        return [f"{line} {end}"]
    space = line[: len(line) - len(line.lstrip())]
    above = textwrap.wrap(end, WIDTH, initial_indent=space, subsequent_indent=f"{space} * ")
    return [*above, *fold(line)]


def fold(line: str, more: int = 4) -> list[str]:
    """A long line in several, broken where the fewest parentheses are open."""
    if len(line) <= WIDTH or line.lstrip().startswith("/*"):
        return [line]
    indent = len(line) - len(line.lstrip())
    depth, best = 0, (LOOSEST, 0, 0)
    for i, character in enumerate(line[: WIDTH + 1]):
        depth += (character in "([{") - (character in ")]}")
        rank = BREAKS.get("," if line[i - 1] == "," else line[i + 1 : i + 3].strip()) if character == " " else None
        if rank is not None and i > indent + 8 and (depth, rank) <= best[:2]:
            best = depth, rank, i
    at = best[2]
    return [line[:at], *fold(" " * (indent + more) + line[at + 1 :], 0)] if at else [line]
