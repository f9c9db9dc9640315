"""What goes into an FMU: sources, their hash, and a zip file that is the same for every build."""

import ast
import hashlib
import importlib
import os
import sys
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .errors import UserError

HERE = Path(__file__).parent
Files = dict[str, bytes]
FIRST_INSTANT = 315532800  # s since 1970, the first that a zip file can hold


def sources(module: str) -> Files:
    """The source of a module and of all that it imports from its own package.

    The contents are listed by their paths in the package, with forward slashes. The `__init__` files of the packages
    around each module, and what they import, are included."""
    package, *parts = module.split(".")
    root = Path(str(importlib.import_module(package).__file__)).parent
    found: Files = {}
    wanted = [root.joinpath(*parts)]
    while wanted:
        place = wanted.pop()
        path = place / "__init__.py" if place.is_dir() else place.with_name(f"{place.name}.py")
        name = path.relative_to(root).as_posix()
        if name not in found:
            found[name] = path.read_bytes().replace(b"\r\n", b"\n")
            packages = (root / folder for folder in path.relative_to(root).parents)
            wanted += [*packages, *_imported(ast.parse(found[name]), path)]
    return dict(sorted(found.items()))


def _imported(tree: ast.Module, path: Path) -> Iterator[Path]:
    """The modules and packages that relative imports name, as paths without suffix."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level:
            origin = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            yield origin
            modules = (origin / alias.name for alias in node.names)  # a name imported from a package may be a module
            yield from (m for m in modules if m.is_dir() or m.with_name(f"{m.name}.py").is_file())


def beside(block_type: type[Any], name: str) -> Path:
    """The place of the file of this name in the folder of a block."""
    return Path(str(sys.modules[block_type.__module__].__file__)).with_name(name)


def runtime() -> Files:
    """The part of this package that runs inside the Python FMU."""
    return _own("interface/variables.py", "python/slave.py")


def compilers() -> Files:
    """The part of this package that determines the native code: the compiler with its modules, the C files and the
    template of the tables."""
    native = HERE / "native"
    modules = {name for name in sources(f"{__package__}.native.libraries") if name.startswith("native/")}
    others = (file.relative_to(HERE).as_posix() for file in native.iterdir() if file.suffix in (".c", ".h", ".j2"))
    return _own(*modules, *others)


def _own(*names: str) -> Files:
    return {name: (HERE / name).read_bytes().replace(b"\r\n", b"\n") for name in sorted(names)}


def digest(files: Files) -> str:
    """A hash of names and contents; the order of the files does not matter."""
    h = hashlib.sha256()
    for part in (p for name in sorted(files) for p in (name.encode(), files[name])):
        h.update(len(part).to_bytes(8, "little") + part)
    return h.hexdigest()


def build_time() -> int | None:
    """The build's time in s since 1970, from SOURCE_DATE_EPOCH; None if it is not set.

    Raises:
        UserError: SOURCE_DATE_EPOCH is no such time.
    """
    text = os.environ.get("SOURCE_DATE_EPOCH")
    if not text:
        return None
    if not text.isdecimal() or int(text) > 4354819198:  # the last instant a zip file can hold
        raise UserError(f"SOURCE_DATE_EPOCH = {text} is not allowed: it must be whole seconds from 0 to 4354819198")
    return max(int(text), FIRST_INSTANT)


def write(target: Path, files: Files) -> None:
    """Write a zip file of the sorted, compressed files, each with the build's time.

    Without such a time each has the first that a zip file can hold. The file appears at `target` only when it is
    complete."""
    stamp = time.gmtime(build_time() or FIRST_INSTANT)[:6]
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_suffix(f".{os.getpid()}.part")
    with zipfile.ZipFile(part, "w") as z:
        for name in sorted(files):
            info = zipfile.ZipInfo(name, stamp)
            info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            z.writestr(info, files[name], compresslevel=9)
    part.replace(target)
