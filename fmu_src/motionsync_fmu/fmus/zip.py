"""Zip files that are the same for every build."""

import struct
import time
import zlib
from functools import lru_cache
from pathlib import Path

from deflate import deflate_compress

from ..interface.build_time import FIRST_INSTANT, build_time
from ..interface.fingerprint import Files
from ..paths import replace_file

SMALLEST = 12  # libdeflate's level


@lru_cache(maxsize=128)
def deflated(data: bytes) -> bytes:
    """The data as raw deflate (RFC 1951), by libdeflate: some 4 % smaller than zlib's. Many FMUs of a process hold the
    same files."""
    return bytes(deflate_compress(data, SMALLEST))


def write_zip(target: Path, files: Files) -> Path:
    """Write a zip file of the sorted files, each with the build's time, and return its path.

    Without such a time each file has the first that a zip file can hold. The zip file appears at `target` only when it
    is complete."""
    whole = zip_bytes(files, time.gmtime(build_time() or FIRST_INSTANT))
    with replace_file(target) as part:
        part.write_bytes(whole)
    return target


def zip_bytes(files: Files, stamp: time.struct_time) -> bytes:
    """The zip file (PKWARE's APPNOTE, 4.3), below 4 GiB. Python's zipfile would allow no other compressor than zlib.

    Raises:
        struct.error: it would be larger.
    """
    clock = stamp.tm_hour << 11 | stamp.tm_min << 5 | stamp.tm_sec // 2
    date = stamp.tm_year - 1980 << 9 | stamp.tm_mon << 5 | stamp.tm_mday
    body, directory = bytearray(), bytearray()
    for name, contents in sorted(files.items()):
        path, utf8, small = name.encode(), 0 if name.isascii() else 0x800, deflated(contents)
        sizes = zlib.crc32(contents), len(small), len(contents), len(path)
        both = struct.pack("<5H3I2H", 20, utf8, 8, clock, date, *sizes, 0)  # zip 2.0, method 8: deflate; nothing extra
        mode = 0o644 << 16  # a Unix file (3)
        directory += struct.pack("<4s2B26s3H2I", b"PK\1\2", 20, 3, both, 0, 0, 0, mode, len(body)) + path
        body += b"PK\3\4" + both + path + small
    sizes_of_all = len(files), len(files), len(directory), len(body)
    return bytes(body + directory + struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, *sizes_of_all, 0))
