"""The references of the site, made from what they describe: blocks, commands, keys of files, functions."""

import ast
import inspect
import re
import sys
import textwrap
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import typer

import motionsync_fmu
from motionsync.blocks import BLOCKS
from motionsync_fmu.commands.app import COMMANDS, app
from motionsync_fmu.interface.recipe import default_slave_unit
from motionsync_fmu.interface.table import groups
from motionsync_fmu.interface.variables import members, summary, variables
from motionsync_fmu.pages.style import load_template
from motionsync_fmu.scenario.files.keys import REQUIRED
from motionsync_fmu.scenario.files.shipped import SCENARIO_FILE, scenario_name, shipped_folder
from motionsync_fmu.scenario.files.tables import ALL_TABLES
from tools.site.pages import made_pages

TEMPLATES = Path(__file__).parent / "templates"
UNIT = "mm"  # in which the tables give positions
FILES = re.compile("|".join(map(re.escape, made_pages().values())))
TO_USUAL_END = re.compile(r"(\S+) to (?:1e\+12|2147483647)$")
PARAGRAPH_AS_IT_IS = "\b"  # click's mark of a paragraph whose lines are not joined


def block_reference(name: str) -> str:
    """The variables of a block, its enumerations and its fault codes, in HTML."""
    block, slave_unit = BLOCKS[name](), default_slave_unit(BLOCKS[name])
    values = {
        "unit": UNIT,
        "slave_unit": slave_unit,
        "groups": groups(block, UNIT, slave_unit),
        "choices": {v.cell.type: v.choices for v in variables(block) if v.choices},
        "codes": {v.declaration.codes: members(v.declaration.codes) for v in variables(block) if v.declaration.codes},
        "describe": summary,
        "without_usual_end": without_usual_end,
        "scenarios": {scenario_name(file): read_title(file) for file in sorted(scenario_files(name))},
    }
    return load_template(TEMPLATES, "block.html.j2").render(values)


def without_usual_end(allowed_range: str) -> str:
    """A range as the table of a block has it: `≥ 0` for `0 to 1e+12`, since most variables end there."""
    if allowed_range.startswith("-1e+12"):
        return allowed_range
    return TO_USUAL_END.sub(r"≥ \1", allowed_range).removesuffix(" and <= 1e+12")


def scenario_files(name: str) -> Iterator[Path]:
    """The files of the scenarios that come with a block."""
    yield from (shipped_folder() / name).rglob(SCENARIO_FILE)


def read_title(file: Path) -> str:
    """The title of a scenario."""
    return str(tomllib.loads(file.read_text("utf-8"))["title"])


def command_reference() -> str:
    """All commands with their options."""
    group: Any = typer.main.get_command(app)
    template = load_template(TEMPLATES, "command.md.j2")
    return "\n".join(template.render(_command(name, group.get_command(None, name))) for name in COMMANDS)


def _command(name: str, command: Any) -> dict[str, Any]:
    context = typer.Context(command, info_name=f"motionsync {name}")
    return {
        "name": name,
        "usage": " ".join(["motionsync", name, *command.collect_usage_pieces(context)]),
        "text": _help_as_markdown(command.help),
        "parameters": list(filter(None, (p.get_help_record(context) for p in command.params))),
    }


def _help_as_markdown(text: str) -> str:
    """The help of a command; a paragraph whose lines are kept becomes code."""
    paragraphs = inspect.cleandoc(text).split("\n\n")
    for i, paragraph in enumerate(paragraphs):
        if paragraph.startswith(PARAGRAPH_AS_IT_IS):
            lines = textwrap.dedent(paragraph.removeprefix(PARAGRAPH_AS_IT_IS).strip("\n"))
            paragraphs[i] = textwrap.indent(lines, "    ")
        elif not paragraph.startswith("    "):
            paragraphs[i] = FILES.sub(_page_link, paragraph.replace("<", "&lt;"))
    return "\n\n".join(paragraphs)


def _page_link(file: re.Match[str]) -> str:
    """A link to the page that is made from a file which the help of a command names."""
    (page,) = (page for page, source in made_pages().items() if source == file[0])
    return f"[{file[0]}](../{page})"


def python_reference() -> str:
    """The public functions and classes of motionsync_fmu, and the types of what they return, as mkdocstrings reads
    them."""
    public = [getattr(motionsync_fmu, name) for name in dir(motionsync_fmu)]
    functions = [member for member in public if inspect.isroutine(member)]
    classes = [member for member in public if inspect.isclass(member)]
    results = dict.fromkeys([*classes, *(t for f in functions for t in _types_in(f.__annotations__["return"], f))])
    results |= dict.fromkeys([t for result in results for t in _types_of_fields(result)])
    returned = sorted(results.keys() - {*classes}, key=lambda t: t.__name__)
    parts = [_from_source(member, 2) for member in [*functions, *classes]]
    return "\n".join([*parts, "## Types of results\n", *(_from_source(t, 3) for t in returned)])


def _from_source(member: Any, level: int) -> str:
    """What mkdocstrings replaces by the signature and the docstring of a function or class."""
    options = {"heading": member.__name__, "toc_label": member.__name__, "heading_level": level}
    lines = [f"      {name}: {value}" for name, value in options.items()]
    return "\n".join([f"::: {member.__module__}.{member.__qualname__}", "    options:", *lines, ""])


def _types_of_fields(result: type) -> Iterator[type]:
    """The types of motionsync_fmu that the public fields and properties of a class have, and its bases."""
    for base in (base for base in result.__mro__ if base.__module__.startswith(motionsync_fmu.__name__)):
        yield base
        for name, annotation in inspect.get_annotations(base).items():
            yield from () if name.startswith("_") else _types_in(annotation, base)
        for name, member in vars(base).items():
            getter = getattr(member, "fget", None) or getattr(member, "func", None)  # of a property, a cached one
            if getter and not name.startswith("_"):
                yield from _types_in(getter.__annotations__["return"], base)


def _types_in(annotation: Any, owner: Any) -> Iterator[type]:
    """The types of motionsync_fmu in an annotation of a function or class; some modules import them for it alone."""
    words = set(re.findall(r"\w+", annotation if isinstance(annotation, str) else str(annotation)))
    module = sys.modules[owner.__module__]
    for node in _imports_and_classes(module):
        if isinstance(node, ast.ClassDef):
            yield from [getattr(module, node.name)] if node.name in words else ()
        elif names := [alias.name for alias in node.names if alias.name in words]:
            source = import_module("." * node.level + (node.module or ""), module.__package__)
            yield from (member for member in (getattr(source, name) for name in names) if inspect.isclass(member))


@cache
def _imports_and_classes(module: ModuleType) -> list[ast.ImportFrom | ast.ClassDef]:
    """The relative imports in a module, and its classes."""
    nodes = ast.walk(ast.parse(inspect.getsource(module)))
    return [n for n in nodes if isinstance(n, ast.ClassDef) or (isinstance(n, ast.ImportFrom) and n.level)]


def key_reference() -> str:
    """The tables of a scenario file with their keys, in HTML."""
    return load_template(TEMPLATES, "keys.html.j2").render(tables=ALL_TABLES, required=REQUIRED)


def insert_references(text: str) -> str:
    """The text of a page with its references; the line below a mark is shown by a code host, which has none."""
    return MARK.sub(lambda mark: REFERENCES[mark[1]](), text)


MARK = re.compile(r"^<!-- reference: (\w+) -->\n.*$", re.M)
REFERENCES: dict[str, Callable[[], str]] = {
    "commands": command_reference,
    "keys": key_reference,
    "python": python_reference,
}
