"""The replacement of a C library in native FMUs: numbers as texts, and exact functions."""

import ctypes
import math
import random
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from ctypes import c_char_p, c_double, c_int, c_size_t, create_string_buffer
from pathlib import Path

import pytest

from motionsync_fmu.interface.variables import COMPUTED_DIGITS, SHOWN_DIGITS, rounded
from motionsync_fmu.native.libraries import FOLDER as NATIVE
from motionsync_fmu.native.libraries import FREESTANDING

WRITE = "size_t write(char *to, double x, int digits) { return (size_t)(write_decimal(to, x, digits) - to); }"
COUNT, LONG = 30_000, 1_000_000  # random numbers; besides, each power of two is tried with its neighbours
SPECIAL = [0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, -5e-324, 2.2250738585072014e-308, 1.7976931348623157e308]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The C files as a library for this machine, compiled as they are for an FMU."""
    target = tmp_path_factory.mktemp("freestanding") / "library.so"
    decimal = target.with_name("decimal.c")
    decimal.write_text('#include "decimal.h"\n' + WRITE)
    files = [str(decimal), str(FREESTANDING / "freestanding.c")]
    compiler = [sys.executable, "-m", "ziglang", "cc", "-Os", "-fno-math-errno", "-ffp-contract=off"]
    flags = ["-rtlib=none", "-fPIC", "-shared", "-I", str(FREESTANDING), "-I", str(NATIVE)]
    subprocess.run([*compiler, *flags, *files, "-o", str(target)], check=True)
    library = ctypes.CDLL(str(target))
    library.write.argtypes, library.write.restype = (c_char_p, c_double, c_int), c_size_t
    for name, count in (("floor", 1), ("rint", 1), ("fmod", 2)):
        function = getattr(library, name)
        function.argtypes, function.restype = (c_double,) * count, c_double
    library.memcmp.argtypes, library.memcmp.restype = (c_char_p, c_char_p, c_size_t), c_int
    library.strcmp.argtypes, library.strcmp.restype = (c_char_p, c_char_p), c_int
    library.strlen.argtypes, library.strlen.restype = (c_char_p,), c_size_t
    return library


def random_numbers(seed: int, count: int) -> Iterator[float]:
    """Numbers of all sizes, denormal ones too, and those that people write."""
    generator = random.Random(seed)
    yield from SPECIAL
    for power in range(-1074, 1024):
        at = math.ldexp(1.0, power)
        yield from (at, math.nextafter(at, 0.0), math.nextafter(at, math.inf))
    for _ in range(count // 5):
        yield struct.unpack("<d", generator.randbytes(8))[0]
        yield math.ldexp(generator.getrandbits(generator.randrange(53)), -1074)
        yield generator.randrange(-(10**9), 10**9) / 10 ** generator.randrange(10)
        yield float(f"{generator.randrange(-999, 1000)}e{generator.randrange(-320, 306)}")
        yield generator.randrange(2**53) / 2 ** generator.randrange(60)


@pytest.mark.parametrize("digits", [COMPUTED_DIGITS, SHOWN_DIGITS])
def test_a_number_has_the_digits_of_python(digits: int, library: ctypes.CDLL, soak: Callable[[int, int], int]) -> None:
    """What was written in so many digits is shown so. Any other number lies between two such texts: one near their
    middle may get either."""
    written = create_string_buffer(32)

    def text_of(x: float) -> str:
        length = library.write(written, x, digits)
        assert length == len(written.value)
        return written.value.decode()

    for x in random_numbers(1, soak(COUNT, LONG)):
        expected, text = rounded(x, digits), text_of(x)
        if text != expected:
            unit = 10.0 ** (math.floor(math.log10(abs(x))) + 1 - digits)
            assert abs(float(text) - x) <= 0.51 * unit, x.hex()
            assert text == rounded(float(text), digits)
        if math.isfinite(float(expected)):  # the greatest number of all is rounded up
            assert text_of(float(expected)) == expected
    assert text_of(299.99999940000004) == ("300" if digits == COMPUTED_DIGITS else "299.9999994")


def test_numbers_are_rounded_and_divided_as_python_does(library: ctypes.CDLL, soak: Callable[[int, int], int]) -> None:
    def same(result: float, expected: float) -> bool:
        return struct.pack("d", result) == struct.pack("d", expected) or (math.isnan(result) and math.isnan(expected))

    numbers = [x for x in random_numbers(2, soak(COUNT, LONG)) if math.isfinite(x)]
    for x, y in zip(numbers, [*numbers[1:], 1.0], strict=True):
        assert same(library.rint(x), math.copysign(float(round(x)), x)), x.hex()
        assert same(library.floor(x), math.copysign(float(math.floor(x)), x)), x.hex()
        if y:
            assert same(library.fmod(x, y), math.fmod(x, y)), (x.hex(), y.hex())
    for x, y in [(math.inf, 1.0), (math.nan, 1.0), (1.0, 0.0), (1.0, math.nan)]:
        assert math.isnan(library.fmod(x, y))
    assert library.fmod(-1.5, math.inf) == -1.5
    for function in (library.floor, library.rint):
        assert all(same(function(x), x) for x in (math.inf, -math.inf, math.nan, -0.0))


@pytest.mark.parametrize("word", [b"", b"a", b"ab", b"a\x00b", b"b", b"\xff\x01"])
@pytest.mark.parametrize("other", [b"", b"a", b"ab", b"ac", b"\xff", b"\x7f"])
def test_texts_are_compared_byte_by_byte(library: ctypes.CDLL, word: bytes, other: bytes) -> None:
    def sign(x: int) -> int:
        return (x > 0) - (x < 0)

    n = min(len(word), len(other))
    assert sign(library.memcmp(word, other, n)) == (word[:n] > other[:n]) - (word[:n] < other[:n])
    text, another = word.split(b"\0")[0], other.split(b"\0")[0]
    assert sign(library.strcmp(word, other)) == (text > another) - (text < another)
    assert library.strlen(word) == len(text)


def test_nothing_but_these_files_is_included() -> None:
    """The C files include no other header of a C library than those here and the compiler's own."""
    own = {path.name for path in [*NATIVE.glob("*.h"), *FREESTANDING.glob("*.h")]} | {"block.h", "model.h"}
    compilers = {"float.h", "stdarg.h", "stdbool.h", "stddef.h", "stdint.h"}
    sources: list[Path] = [*NATIVE.glob("*.[ch]"), *FREESTANDING.glob("*.[ch]")]
    for path in sources:
        for line in path.read_text("utf-8").splitlines():
            if line.startswith("#include"):
                name = line.split()[1].strip('<>"')
                assert name in own | compilers or name.startswith("fmi"), (path.name, name)
