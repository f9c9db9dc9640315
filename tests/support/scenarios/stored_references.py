"""Keeps in the user's cache what the oracles have computed.

An answer depends on what the oracle is asked for, its sources, Python, its packages and the machine; the name of its
file is a hash of these. A file that was not read for a month is deleted when another one is written.
"""

import gzip
import json
import platform
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from typing import Any

from motionsync_fmu import paths
from tests import ROOT

SOURCES = [*sorted((ROOT / "tests" / "oracle").rglob("*.py")), ROOT / "tests" / "regenerate.py", Path(__file__)]
CACHE_ERRORS = (OSError, RuntimeError)  # the cache cannot be read or written, or there is no folder for it
MONTH = 30 * 86400.0  # s


def keep(question: object, find: Callable[[], Any]) -> Any:
    """What `find` returns, as JSON has it (numbers of the oracles as floats); found again only if it is not stored.

    `question`: all that the answer depends on beside the sources; its `repr` says it exactly.
    """
    name = f"{sha256(f'{_source_hash(tuple(SOURCES))} {question!r}'.encode()).hexdigest()}.json.gz"
    with suppress(*CACHE_ERRORS, EOFError, ValueError, zlib.error):  # a damaged file does not pass gzip's checksum
        file = _folder() / name
        answer = json.loads(gzip.decompress(file.read_bytes()))
        file.touch()
        return answer
    text = json.dumps(find(), default=float)
    with suppress(*CACHE_ERRORS):
        _delete_old(_folder())
        with paths.replace_file(_folder() / name) as part:
            part.write_bytes(gzip.compress(text.encode(), 6))
    return json.loads(text)


def _folder() -> Path:
    return paths.cache_folder() / "references"


@cache
def _source_hash(files: tuple[Path, ...]) -> str:
    versions = [platform.platform(), platform.python_version(), *map(metadata.version, ("gmpy2", "numpy"))]
    contents = [f"{file.name} {sha256(file.read_bytes()).hexdigest()}" for file in files]
    return sha256("\n".join([*versions, *contents]).encode()).hexdigest()


@cache  # once in a process
def _delete_old(folder: Path) -> None:
    for file in folder.glob("*.json.gz"):
        with suppress(OSError):  # another process deletes it
            if time.time() - file.stat().st_mtime > MONTH:
                file.unlink()
