"""The names in C: those of the source, longer where two modules have the same one or C has it itself."""

import ast
from collections import Counter
from pathlib import PurePosixPath

from ..subset.package import Package, Reading, name_of
from .helpers import HELPERS

KEYWORDS = (
    "auto break case char const continue default do double else enum extern float for goto if inline int long register "
    "restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool true "
    "false asm"
)
LIBRARY = (
    "sqrt floor rint fmod fabs INFINITY NAN HUGE_VAL DBL_MAX DOMAIN OVERFLOW UNDERFLOW SING int32_t int64_t size_t "
    "Block START block_start block_initialize block_step failed UNIT_PREFIX JOINED OWN MUST_HOLD APART"
)
RESERVED = frozenset([*KEYWORDS.split(), *LIBRARY.split(), *HELPERS])
BASE = "base"  # the member of a derived struct that holds what it derives from


class Names:
    """The names of all that the modules of a package declare."""

    def __init__(self, package: Package) -> None:
        self.package = package
        self.taken: set[str] = set()
        self.given: dict[ast.AST, str] = {}
        declared = package.homes.items()
        own = [(node, file) for node, file in declared if not package.exempt(file) or name_of(node)]
        found = Counter(plain(node, file) for node, file in own)
        for node, file in own:
            if name := plain(node, file):
                self.given[node] = self.unique(name if found[name] == 1 else longer(node, file))
        for node, _ in own:
            for item in node.body if isinstance(node, ast.ClassDef) else []:
                member = item.name if isinstance(item, ast.FunctionDef) else name_of(item)
                if member and not isinstance(item, ast.AnnAssign):
                    self.given[item] = self.unique(f"{self.given[node]}_{member}")

    def unique(self, name: str) -> str:
        while name in self.taken or name in RESERVED:
            name += "_"
        self.taken.add(name)
        return name

    def of(self, node: ast.AST) -> str:
        """The name of a class, a constant, a function or method, or a member of an enumeration."""
        return self.given[node]

    def function(self, reading: Reading) -> str:
        return self.of(reading.node)

    def local(self, name: str) -> str:
        """A local or parameter; it hides no name of the file."""
        return f"{name}_" if name in RESERVED or name in self.taken else name

    @staticmethod
    def member(name: str) -> str:
        """A field."""
        return f"{name}_" if name in RESERVED or name == BASE else name


def plain(node: ast.stmt, file: str) -> str:
    """The name of what a statement at module level declares; functions have their module's before it."""
    match node:
        case ast.FunctionDef(name=name):
            return f"{PurePosixPath(file).stem}_{name}"
        case ast.ClassDef(name=name):
            return name
    return name_of(node)


def longer(node: ast.stmt, file: str) -> str:
    """The same, where two modules have the name."""
    path = PurePosixPath(file)
    match node:
        case ast.FunctionDef(name=name):
            return f"{path.parent.name}_{path.stem}_{name}"
        case ast.ClassDef(name=name):
            return f"{path.stem.title().replace('_', '')}{name}"
    return f"{path.stem.upper()}_{name_of(node)}"
