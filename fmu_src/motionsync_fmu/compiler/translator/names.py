"""The names in C: those of the source, longer where two modules have the same one or C has it itself."""

import ast
from collections import Counter
from pathlib import PurePosixPath

from ..subset.expression_rules import PART_FUNCTIONS
from ..subset.package import Package, assigned_name
from .helpers import HELPERS

KEYWORDS = (
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool true "
    "false asm"
)
LIBRARY = (
    "sqrt floor rint fmod fabs INFINITY NAN HUGE_VAL DBL_MAX DOMAIN OVERFLOW UNDERFLOW SING int32_t int64_t size_t "
    "Block START block_start block_initialize block_step failed INSTANCE_PREFIX JOINED OWN MUST_HOLD APART"
)
RESERVED = frozenset([*KEYWORDS.split(), *LIBRARY.split(), *HELPERS])
BASE = "base"  # the member of a derived struct that holds what it derives from


class Names:
    """The names of all that the modules of a package declare.

    Attributes:
        part_functions: of the functions of parts of a class, by the name that they have in `var`.
    """

    def __init__(self, package: Package) -> None:
        self.package = package
        self.taken: set[str] = set()
        self.names: dict[ast.AST, str] = {}
        own = {
            node: short_and_long_name(node, file)
            for node, file in package.file_of.items()
            if not package.is_exempt(file) or assigned_name(node)
        }
        counts = Counter(short for short, _ in own.values())
        for node, (short, long) in own.items():
            if short:
                self.names[node] = self.add_unique(short if counts[short] == 1 else long)
        classes = [node for node in own if isinstance(node, ast.ClassDef)]
        for node in classes:
            for item in node.body:
                member = item.name if isinstance(item, ast.FunctionDef) else assigned_name(item)
                if member and not isinstance(item, ast.AnnAssign):
                    self.names[item] = self.add_unique(f"{self.names[node]}_{member}")
        self.part_functions = {
            (function, node): self.add_unique(f"{self.names[node]}_{function.removeprefix('var.')}")
            for function in PART_FUNCTIONS
            for node in classes
        }

    def add_unique(self, name: str) -> str:
        while name in self.taken or name in RESERVED:
            name += "_"
        self.taken.add(name)
        return name

    def name_of(self, node: ast.AST) -> str:
        """The name of a class, a constant, a function or method, or a member of an enumeration."""
        return self.names[node]

    def local_name(self, name: str) -> str:
        """A local or parameter; it shadows no name of the file."""
        return f"{name}_" if name in RESERVED or name in self.taken else name

    @staticmethod
    def field_name(name: str) -> str:
        return f"{name}_" if name in RESERVED or name == BASE else name


def short_and_long_name(node: ast.stmt, file: str) -> tuple[str, str]:
    """The name of what a statement at module level declares, empty if it declares nothing; and the longer one where two
    modules have the same name. A function's name is preceded by its module's."""
    path = PurePosixPath(file)
    match node:
        case ast.FunctionDef(name=name):
            return f"{path.stem}_{name}", f"{path.parent.name}_{path.stem}_{name}"
        case ast.ClassDef(name=name):
            return name, f"{path.stem.title().replace('_', '')}{name}"
    name = assigned_name(node)
    return name, f"{path.stem.upper()}_{name}"
