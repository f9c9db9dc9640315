"""What the parts of the translator share: a block's modules as the checker has analysed them, the names in C, and what
the text needs."""

import ast
import importlib
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Any

from ...errors import UserError
from ...interface.fingerprint import collect_sources
from ..subset import evaluation_order
from ..subset.effects import Effects
from ..subset.module_rules import check_block
from ..subset.package import MODEL, SERIES, Kind, Package, assigned_name
from .names import Names
from .raising import Raising
from .text import comments

TYPES = {"float": "double", "list": "double", "int": "int64_t", "bool": "bool", "None": "void"}
TYPES |= dict.fromkeys(SERIES.values(), "Series")


class Context:
    """One translation of a block.

    Attributes:
        block_class: the block's class in the package.
        lines: of each module's text.
        comments: of each module, by line.
        helpers, constants, tuples, types: what the text needs.
        is_inline: whether the functions are to be made part of what calls them.
        part_functions: those functions of parts, by their names in `var` and the parts' classes.

    Raises:
        UserError: the block is outside the kernel subset.
    """

    def __init__(self, block_type: type[Any], texts: Mapping[str, str]) -> None:
        self.root = block_type.__module__.partition(".")[0]
        self.package = Package(texts)
        self.block_class = self.find_class(block_type)
        if violations := check_block(self.package, self.block_class):
            raise UserError("\n".join(map(str, violations)))
        self.effects = Effects(self.package)
        if violations := evaluation_order.violations(self.effects):
            raise UserError("\n".join(map(str, violations)))
        self.raising = Raising(self.effects)
        self.names = Names(self.package)
        self.lines = {file: texts[file].splitlines() for file in self.package.trees}
        self.comments = {file: dict(comments(texts[file])) for file in self.package.trees}
        self.helpers: set[str] = set()
        self.constants: dict[ast.stmt, str] = {}
        self.tuples: dict[str, tuple[Kind, ...]] = {}
        self.types: dict[ast.ClassDef, None] = {}
        self.part_functions: dict[tuple[str, ast.ClassDef], None] = {}
        self.is_inline = False

    def find_class(self, python_class: type[Any]) -> ast.ClassDef:
        classes = (node for node in self.package.file_of if isinstance(node, ast.ClassDef))
        same_name = (node for node in classes if node.name == python_class.__name__)
        return next(node for node in same_name if self.python_class(node) is python_class)

    def python_class(self, node: ast.ClassDef) -> Any:
        """The class that a statement of the package declares, as Python runs it."""
        parts = PurePosixPath(self.package.file_of[node]).with_suffix("").parts
        inside = () if parts[0] == self.root else (MODEL,)
        return getattr(importlib.import_module(".".join((*inside, *parts))), node.name)

    def required_classes(self, node: ast.ClassDef) -> dict[ast.ClassDef, None]:
        """A class after its base and the classes of its fields."""
        base = self.package.base_class(node)
        classes = self.required_classes(base) if base else {}
        for kind in self.package.own_fields(node).values():
            if isinstance(kind, ast.ClassDef):
                classes |= {kind: None} if kind in self.package.enumerations else self.required_classes(kind)
        return classes | {node: None}

    # --- names that the text needs ---

    def constant(self, statement: ast.stmt) -> str:
        return self.constants.setdefault(statement, self.names.name_of(statement))

    def part_function(self, name: str, kind: Kind) -> str:
        """The function of that name in `var`, for parts of a class."""
        assert isinstance(kind, ast.ClassDef)
        self.part_functions.setdefault((name, kind))
        return self.names.part_functions[name, kind]

    def enumerator(self, node: ast.ClassDef, member: str) -> str:
        self.types.setdefault(node)
        item = next(item for item in node.body if assigned_name(item) == member)
        return self.names.name_of(item)

    def type_of(self, kind: Kind) -> str:
        if isinstance(kind, ast.ClassDef):
            self.types.setdefault(kind)
            return self.names.name_of(kind)
        if isinstance(kind, tuple):
            letters = "".join({"float": "d", "bool": "b"}.get(str(part), "i") for part in kind)
            name = f"Real{len(kind)}" if set(letters) == {"d"} else f"Tuple_{letters}"
            self.tuples[name] = kind
            return name
        return TYPES[kind]


def module_texts(module: str) -> dict[str, str]:
    """The text of a module, and of those of its package and of the model that it imports, by their paths.

    Paths of the model start inside its package; those of another package start with its name."""
    root = module.partition(".")[0]
    if root == MODEL:
        return {name: text.decode() for name, text in collect_sources(module).items()}
    if "." in module:
        own = {f"{root}/{name}": text.decode() for name, text in collect_sources(module).items()} | headers(module)
    else:
        own = {f"{root}.py": Path(str(importlib.import_module(module).__file__)).read_text("utf-8")}
    modules = [text for name, text in own.items() if name.endswith(".py")]
    imports = [node for text in modules for node in ast.parse(text).body if isinstance(node, ast.ImportFrom)]
    of_model = {str(node.module) for node in imports if not node.level and f"{node.module}".startswith(f"{MODEL}.")}
    return {name: text for other in sorted(of_model) for name, text in module_texts(other).items()} | own


def headers(module: str) -> dict[str, str]:
    """The C that is written by hand beside a module, by paths that start with the name of its package."""
    folder = Path(str(importlib.import_module(module).__file__)).parent
    path = "/".join(module.split(".")[:-1])
    return {f"{path}/{file.name}": file.read_text("utf-8") for file in sorted(folder.glob("*.h"))}
