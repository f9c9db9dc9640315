"""The sources of a module and of all that it imports, and a hash of files."""

import ast
import hashlib
import importlib
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
Files = dict[str, bytes]


def collect_sources(module: str) -> Files:
    """The source of a module and of all that it imports from its own package.

    The contents are listed by their paths in the package, with forward slashes. The `__init__` files of the packages
    around each module, and what they import, are included."""
    package, *parts = module.split(".")
    root = Path(str(importlib.import_module(package).__file__)).parent
    files: Files = {}
    pending = [root.joinpath(*parts)]
    while pending:
        origin = pending.pop()
        path = origin / "__init__.py" if origin.is_dir() else origin.with_name(f"{origin.name}.py")
        name = path.relative_to(root).as_posix()
        if name not in files:
            files[name] = _read(path)
            packages = (root / folder for folder in path.relative_to(root).parents)
            pending += [*packages, *_imported_modules(_relative_imports(files[name]), path)]
    return dict(sorted(files.items()))


@cache
def _relative_imports(text: bytes) -> Sequence[ast.ImportFrom]:
    """The relative imports in the text of a module; cached, since blocks share modules."""
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom) and node.level]


def _imported_modules(imports: Iterable[ast.ImportFrom], path: Path) -> Iterator[Path]:
    """The modules and packages that relative imports name, as paths without suffix."""
    for node in imports:
        origin = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
        yield origin
        modules = (origin / alias.name for alias in node.names)  # a name imported from a package may be a module
        yield from (m for m in modules if m.is_dir() or m.with_name(f"{m.name}.py").is_file())


def read_sources(*names: str) -> Files:
    """These files of this package, with the line ends of Unix, by their paths in it."""
    return {name: _read(PACKAGE / name) for name in sorted(names)}


def _read(path: Path) -> bytes:
    return path.read_bytes().replace(b"\r\n", b"\n")


def digest(files: Files) -> str:
    """A hash of names and contents; the order of the files does not matter."""
    h = hashlib.sha256()
    for part in (p for name in sorted(files) for p in (name.encode(), files[name])):
        h.update(len(part).to_bytes(8, "little") + part)
    return h.hexdigest()
