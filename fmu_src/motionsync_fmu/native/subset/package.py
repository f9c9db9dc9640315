"""The model's modules, and what their names stand for."""

import ast
from collections.abc import Iterator, Mapping
from pathlib import PurePosixPath
from typing import TypeAlias

EXEMPT = ("__init__.py", "blocks.py", "var.py")  # public names, registry, declarations: they are never compiled
ENUMERATIONS = ("var.Enumeration",)  # what enumerations derive from

# The kind of a value: "float", "int", "bool", "list", the class of an enumeration member or object, the kinds in a
# returned tuple, or "?" (unknown: its expression has violated a rule).
Kind: TypeAlias = "str | ast.ClassDef | tuple[Kind, ...]"
Meaning: TypeAlias = ast.stmt | str | None  # of a module-level name: its statement, or such as "math.sqrt"


class Package:
    """The modules of the model (path inside the package to text) and what their names stand for."""

    def __init__(self, sources: Mapping[str, str]) -> None:
        self.trees = {file: ast.parse(text, file) for file, text in sorted(sources.items())}
        self.names = {file: dict(self.module_names(tree)) for file, tree in self.trees.items()}
        self.homes = {node: file for file, tree in self.trees.items() for node in tree.body}
        classes = [(node, file) for node, file in self.homes.items() if isinstance(node, ast.ClassDef)]
        self.constants: dict[ast.stmt, Kind] = {}  # kinds of the constants that have been visited
        self.enumerations = {
            node for node, file in classes if any(self.meaning(file, base) in ENUMERATIONS for base in node.bases)
        }

    @staticmethod
    def exempt(file: str) -> bool:
        return file in EXEMPT or PurePosixPath(file).name == "__init__.py"

    @staticmethod
    def origin(file: str, node: ast.ImportFrom) -> PurePosixPath | None:
        """The module (without suffix) or folder of a relative import; None if it lies outside the package."""
        parents = PurePosixPath(file).parents
        inside = 0 < node.level <= len(parents)
        return parents[node.level - 1].joinpath(*(node.module or "").split(".")) if inside else None

    @staticmethod
    def module_names(tree: ast.Module) -> Iterator[tuple[str, tuple[ast.stmt, str]]]:
        """Each module-level name with its statement and, since `import … as` may change it, its original name."""
        for node in tree.body:
            match node:
                case ast.Import() | ast.ImportFrom():
                    yield from ((alias.asname or alias.name, (node, alias.name)) for alias in node.names)
                case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                    yield name, (node, name)
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                    yield name, (node, name)

    def find(self, file: str, name: str) -> Meaning:
        """What a name stands for in a module, through imports inside the package."""
        node, original = self.names.get(file, {}).get(name, (None, name))
        if isinstance(node, ast.Import):
            return original
        if not isinstance(node, ast.ImportFrom):
            return node
        origin = self.origin(file, node)
        if origin is None:
            return f"{node.module}.{original}"
        if node.module is None:
            return str(origin / original)
        module = next((m for m in (f"{origin}.py", f"{origin}/__init__.py") if m in self.trees), "")
        found = self.find(module, original)
        if f"{origin}.py" in EXEMPT and not isinstance(found, ast.Assign | ast.AnnAssign):
            return f"{origin}.{original}"
        return found

    def meaning(self, file: str, node: ast.expr | None) -> Meaning:
        """What a name, or a name of math or of the declarations (`math.sqrt`), stands for in a module."""
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            owner = self.find(file, node.value.id)
            return f"{owner}.{node.attr}" if isinstance(owner, str) else None
        return self.find(file, node.id) if isinstance(node, ast.Name) else None

    def kind(self, file: str, annotation: ast.expr | None) -> Kind:
        """The kind an annotation names; "?" if it is outside the subset."""
        match annotation:
            case ast.Constant(value=None):
                return "None"
            case ast.Constant(value=str(name)):  # a class inside its own body
                return self.kind(file, ast.Name(name))
            case ast.Name(id="float" | "int" | "bool" as name):
                return name
            case ast.Subscript(value=ast.Name(id="list"), slice=ast.Name(id="float")):
                return "list"
            case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=parts)):
                return tuple(self.kind(file, part) for part in parts)
        found = self.meaning(file, annotation)
        return found if isinstance(found, ast.ClassDef) else "?"

    def member(self, owner: ast.ClassDef, name: str, sort: type[ast.stmt]) -> "Kind | None":
        """The kind of a field, or of what a method returns, inherited ones included; None if there is none."""
        for item in owner.body:
            match item:
                case ast.AnnAssign(target=ast.Name(id=found), annotation=annotation) if found == name and sort is type(
                    item
                ):
                    return self.kind(self.homes[owner], annotation)
                case ast.FunctionDef(name=found, returns=returns) if found == name and sort is type(item):
                    return self.kind(self.homes[owner], returns)
        bases = [self.meaning(self.homes[owner], base) for base in owner.bases]
        inherited = [
            self.member(base, name, sort) for base in bases if isinstance(base, ast.ClassDef) and base != owner
        ]
        return inherited[0] if inherited else None
