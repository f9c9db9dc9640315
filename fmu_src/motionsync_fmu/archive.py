"""What goes into an FMU: sources, their hash, and a zip file that is the same for every build."""

import ast
import hashlib
import importlib
import os
import struct
import sys
import time
import zlib
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from deflate import deflate_compress

from .errors import UserError

HERE = Path(__file__).parent
Files = dict[str, bytes]
SMALLEST = 12  # libdeflate's level
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
            wanted += [*packages, *_imported(_relative_imports(found[name]), path)]
    return dict(sorted(found.items()))


@cache
def _relative_imports(text: bytes) -> Sequence[ast.ImportFrom]:
    """Those of a module. Blocks share modules, and a build asks for the sources of a block again and again."""
    return [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom) and node.level]


def _imported(imports: Iterable[ast.ImportFrom], path: Path) -> Iterator[Path]:
    """The modules and packages that relative imports name, as paths without suffix."""
    for node in imports:
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


@cache
def compilers() -> MappingProxyType[str, bytes]:
    """The part of this package that determines the native code: what makes the C and compiles it, with its modules, the
    C files and the template of the tables."""
    native = HERE / "native"
    makers = (sources(f"{__package__}.native.{module}") for module in ("unit_sources", "libraries"))
    modules = {name for names in makers for name in names if name.startswith("native/")}
    files = (file for folder in (native, native / "freestanding") for file in folder.iterdir())
    others = (file.relative_to(HERE).as_posix() for file in files if file.suffix in (".c", ".h", ".j2"))
    return MappingProxyType(_own(*modules, *others))


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


def packed(data: bytes) -> bytes:
    """The data as raw deflate (RFC 1951), by libdeflate: some 4 % smaller than zlib's."""
    return bytes(deflate_compress(data, SMALLEST))


def write(target: Path, files: Files) -> None:
    """Write a zip file of the sorted files, each with the build's time.

    Without such a time each file has the first that a zip file can hold. The zip file appears at `target` only when it
    is complete."""
    whole = zipped(files, time.gmtime(build_time() or FIRST_INSTANT))
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_suffix(f".{os.getpid()}.part")
    part.write_bytes(whole)
    part.replace(target)


def zipped(files: Files, stamp: time.struct_time) -> bytes:
    """The zip file (PKWARE's APPNOTE, 4.3), below 4 GiB. Python's zipfile would allow no other compressor than zlib.

    Raises:
        struct.error: it would be larger.
    """
    clock = stamp.tm_hour << 11 | stamp.tm_min << 5 | stamp.tm_sec // 2
    date = stamp.tm_year - 1980 << 9 | stamp.tm_mon << 5 | stamp.tm_mday
    body, directory = bytearray(), bytearray()
    for name, contents in sorted(files.items()):
        path, utf8, small = name.encode(), 0 if name.isascii() else 0x800, packed(contents)
        sizes = zlib.crc32(contents), len(small), len(contents), len(path)
        both = struct.pack("<5H3I2H", 20, utf8, 8, clock, date, *sizes, 0)  # zip 2.0, method 8: deflate; nothing extra
        mode = 0o644 << 16  # a Unix file (3)
        directory += struct.pack("<4s2B26s3H2I", b"PK\1\2", 20, 3, both, 0, 0, 0, mode, len(body)) + path
        body += b"PK\3\4" + both + path + small
    sizes_of_all = len(files), len(files), len(directory), len(body)
    return bytes(body + directory + struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, *sizes_of_all, 0))
