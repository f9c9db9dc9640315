"""The translator from the kernel subset to C: the same bits as Python, and an error exactly where Python raises."""

import hashlib
import importlib
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
from ctypes import create_string_buffer
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from motionsync.blocks import BLOCKS
from motionsync_fmu.errors import UserError
from motionsync_fmu.native.libraries import ZIG
from motionsync_fmu.native.loop.library import library
from motionsync_fmu.native.memory_layout import image
from motionsync_fmu.native.translator import c_source
from tests.support.compiled import Compiled, Layout
from tests.support.random_programs import HEAD, module, programs

PROGRAMS = 100
RUNS = 12  # of each program
REALS = [0.0, -0.0, 1.0, -1.0, 0.5, 2.5, -7.25, 5e-324, -1e-300, 1e300, 1e9, 1e15, math.inf, -math.inf, math.nan]
WHOLES = [0, 1, -1, 2, -2, 3, 5, -7, 1000]
GENERATE = settings(phases=[Phase.generate], database=None, suppress_health_check=list(HealthCheck), deadline=None)
RAISES = (ZeroDivisionError, ValueError, OverflowError, IndexError)


def loaded(folder: Path, name: str, text: str) -> ModuleType:
    """The module of that text, which is written to the folder."""
    (folder / f"{name}.py").write_text(text, "utf-8")
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(folder))


def words(memory: bytes) -> list[bytes]:
    """The memory in pieces of 8 bytes; all numbers that are none are alike, since their bits are not defined."""
    found = [memory[i : i + 8] for i in range(0, len(memory), 8)]
    return [b"not a number" if math.isnan(struct.unpack("<d", word.ljust(8, b"\0"))[0]) else word for word in found]


class Sides:
    """A block in Python and in C, with the same values."""

    def __init__(self, block_type: Any) -> None:
        self.block = block_type()
        self.compiled = Compiled(block_type())
        self.layout = Layout(self.block)
        self.clean = self.compiled.memory.tobytes()
        self.compiled.initialize()
        self.type = block_type

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            setattr(self.block, name, value)
            self.compiled.set(name, value)

    def begin_anew(self) -> None:
        self.block = self.type()
        self.compiled.memory[...] = self.compiled.memory.__class__(
            self.compiled.memory.shape, self.compiled.memory.dtype, self.clean
        )

    def step(self, h: float) -> bool:
        """Both do the same step; whether both raise.

        Raises:
            AssertionError: one raises and the other does not, or the bits differ.
        """
        try:
            answer = self.block.step(h)
        except RAISES:
            with pytest.raises(ArithmeticError):  # as Python
                self.compiled.step(h)
            return True
        assert self.compiled.step(h) == answer
        assert words(self.compiled.memory.tobytes()) == words(self.layout.bytes(self.block))
        return False


def drawn_values(rng: random.Random, way: Any) -> dict[str, Any]:
    def real() -> float:
        return rng.choice(REALS) if rng.random() < 0.6 else rng.uniform(-10.0, 10.0)

    return {
        "a": real(),
        "b": real(),
        "m": rng.choice(WHOLES),
        "n": rng.choice(WHOLES),
        "f": rng.random() < 0.5,
        "way": rng.choice(list(way)),
    }


# Programs of which each goes wrong in C if one thing is translated word by word.
FLOWS = """
stop = 4
x = 0.0
for j in range(stop):
    stop = 0
    x += float(j) + float(stop)
return x

self.k = 3
x = 0.0
for j in range(self.k):
    self.k += j
    x += 1.0
    if x > 9.0:
        break
return x

self.k = -3
x = 0.0
for _ in range(abs(self.k)):
    self.k = 0
    x += 1.0
return x

x = 0.0
for j in range(5):
    match j:
        case 2:
            break
        case _:
            x += 1.0
    self.note(x)
return x

x = 0.0
for j in range(5):
    match j:
        case 1 | 3:
            continue
        case 4 if x > 1.0:
            break
    x += 10.0
return x

x, y = pair(1.0, 2.0)
x, y = pair(x - y, y)
z, n, on = split(x, self.m)
self.on = on
return x + 10.0 * y + z * float(n)

x = 0.0
for j in range(SIZE):
    x += self.part.values[j]
return x

x = 0.0
for j in range(4, -1, -1):
    x += self.values[j] + float(j)
for j in range(0, 7, 3):
    x -= float(j)
return x

x = 0.0
if self.f:
    if self.a > 0.0:
        y = 1.0
    else:
        y = 2.0
    x = y
else:
    y = 3.0
    x = y + 1.0
return x

return sqrt(min(self.a, 1.0)) + sqrt(max(self.b, -2.0))

for j in range(3):
    self.values[j] += 1.0
j = self.m
return self.values[j]

x = 1.0 / self.m
y = 0.0
while y < 5.0:
    y += 0.0 if x > 2.0 else 1.0
return y

x = 1.0 / self.m
return self.climb(0.0 if x > 2.0 else 1.0)

self.part.n = 1
if self.values[self.part.n] < 1.0 and self.try_move() and self.values[self.part.n] < 1.0:
    self.values[self.part.n] = self.part.values[self.part.n] + 1.0
return self.values[self.part.n] - self.values[1]

self.y = 1.0
if self.y != 0.0 and self.try_move():
    return 1.0 / self.y
return 2.0 / self.y

if self.m < 0:
    self.values[self.m] = 1.0
    x = self.values[self.m]
elif self.m < 3:
    return self.values[self.n] - self.values[self.n]
else:
    x = 2.0
self.values[self.m] += x
return self.values[self.m]

x = 0.0
for j in range(2):
    for l in range(3):
        self.rows[3 * j + l] = float(j - l)
        x += self.rows[3 * self.n + l] + self.rows[3 * self.n + 2]
    x += self.rows[3 * self.n + 3]
return x - self.rows[2 * self.m + 1] * self.rows[2 * self.m]

for l in range(-1, 2):
    self.rows[3 * self.m + l] += 1.0 + self.rows[3 * self.m]
return self.rows[0] - self.rows[2]

x = 0.0
for j in range(3):
    for l in range(3):
        if j + l < self.m:
            x += self.part.values[j + l]
return x

if self.m < 0:
    self.values[self.m] = 1.0
    x = self.values[self.m]
else:
    return 2.0
return x + self.values[self.m]

i = 1
self.values[i] = 2.0
x = self.values[i]
i = self.m
return x + self.values[i] * self.values[i]

x = 2.0
y = 1.0 / x
x = self.a
return y / x

self.y = 2.0
x = 1.0 / self.y
self.y: float = self.b
return x + 1.0 / self.y

return 7.5 / self.n + float(self.m % self.n) - float(self.m // self.n)

x = 0.0
match self.m:
    case 1:
        x = 1.0 / self.a
    case 2:
        x = 2.0 / self.a
return x + 1.0 / self.a

self.values[2] = 3.0
i = 0
x = self.values[i] + self.values[i]
while i < 4:
    x += self.values[i] * 2.0
    i += 1
return x + self.values[i]

if self.a > BELOW:
    return 1.0 / self.a
return 2.0

if self.a > 0.0 and self.f:
    return 1.0
return 1.0 / self.a

if self.a != 0.0 or self.f:
    return 1.0 / self.a
return 2.0

if self.a != 0.0:
    return 1.0
return 1.0 / self.a

x = 1.0 if self.a < 0.0 else 1.0 / self.a
return x + 1.0 / self.a if self.f else x
"""


def test_random_programs_give_the_bits_of_python_and_raise_where_python_does(tmp_path: Path) -> None:
    bodies = [text.split("\n") for text in FLOWS.strip().split("\n\n")]
    flows = len(bodies)

    @settings(GENERATE, max_examples=PROGRAMS)
    @given(programs())
    def collect(body: list[str]) -> None:
        bodies.append(body)

    collect()
    space = loaded(tmp_path, "random_programs_of_this_run", module(bodies))
    sides = Sides(space.Programs)
    rng = random.Random(len(bodies))
    raised = steps = 0
    for which, body in enumerate(bodies):
        for _ in range(8 * RUNS if which < flows else RUNS):
            sides.begin_anew()
            values = drawn_values(rng, space.Way) | {"which": which}
            for _ in range(2):
                sides.set(values)
                steps += 1
                try:
                    failed = sides.step(0.5)
                except AssertionError as e:
                    raise AssertionError("\n".join([f"{values} in", *body, str(e)])) from None
                raised += failed
                if failed:
                    break
    assert steps / 20 < raised < steps * 3 / 4  # both happen often


# Each with what it gives: `x`, `i` or `on`. Every pair of nasty values is tried.
OPERATIONS = {
    "x": [
        "self.a + self.b",
        "self.a - (self.b - self.a)",
        "self.a * self.b",
        "self.a / self.b",
        "self.a % self.b",
        "-self.a % 7.5",
        "min(self.a, self.b)",
        "max(self.a, self.b, 0.0)",
        "max(-0.0, self.a, self.b)",
        "abs(self.a) - -self.b",
        "sqrt(self.a)",
        "sqrt(max(self.a, 0.0))",
        "fmod(self.a, self.b)",
        "math.fmod(self.b, 3.0)",
        "float(round(self.a))",
        "floor(self.a) * self.b",
        "-floor(self.a) * 1.0",
        "self.a + round(self.b) * 0.5",
        "float(self.m) / self.n",
        "self.m / self.n",
        "self.a if self.a < self.b else self.b if self.f else -self.a",
        "self.values[self.n]",
        "self.values[-5] + self.values[4]",
        "self.long + self.base - self.longer.auto_",
        "float(self.on)",
    ],
    "i": [
        "self.m // self.n",
        "self.m % self.n",
        "-self.m // 7 + self.n % -4",
        "abs(self.m) - max(self.n, -self.m, 2)",
        "round(self.a) if abs(self.a) < 1e15 else -1",
        "int(self.a) if not abs(self.a) >= 1e15 else -2",
        "floor(self.b) if not abs(self.b) >= 1e15 else -2",
        "(self.m < self.n) + True + int(self.f)",
        "(self.m - self.n + SIZE // 2) % SIZE - HALF",
        "-(-self.m) - (-3 - self.n)",
        "len(self.values) * 2",
    ],
    "on": [
        "self.a < self.b <= 2.5",
        "self.a != self.b == self.a",
        "self.a == self.m or self.n > self.b",
        "not self.f and isfinite(self.a)",
        "self.m in (1, 2, self.n)",
        "self.way not in (Way.UP, Way.BACK) and self.way != Way.NONE",
        "(self.a < self.b) == self.f",
        "0 < self.m < self.n in (2, 3)",
    ],
}
KEYWORDS = """
    long: float = 1.5
    base: float = 2.5
    signed: bool = True
"""


def operations() -> str:
    """The text of a block that does each operation when `which` says so; some names are C's own."""
    places = [(kind, text) for kind, texts in OPERATIONS.items() for text in texts]
    head = HEAD.replace("    calls: int = 0\n", "    calls: int = 0" + KEYWORDS)
    head = head.replace("    y: float = var.local(", "    auto_: float = 4.0\n    y: float = var.local(").replace(
        "    auto_: float = 4.0", "    auto_: float = var.local(4.0, 'like a keyword')"
    )
    text = head + "\n    def step(self, h: float) -> Refusal:\n        match self.which:\n"
    for i, (kind, expression) in enumerate(places):
        text += f"            case {i}:\n                self.{kind} = {expression}\n"
    return text + "            case _:\n                pass\n        return Refusal.NONE\n"


def test_every_operation_gives_the_bits_of_python_for_nasty_values(tmp_path: Path) -> None:
    space = loaded(tmp_path, "operations_of_this_run", operations())
    sides = Sides(space.Programs)
    raised = {True: 0, False: 0}
    for which in range(sum(map(len, OPERATIONS.values()))):
        for at, a in enumerate(REALS):
            for b in REALS:
                m, n = WHOLES[at % len(WHOLES)], WHOLES[(at + which) % len(WHOLES)]
                values = {"which": which, "a": a, "b": b, "m": m, "n": n, "f": a < b, "way": list(space.Way)[at % 3]}
                sides.begin_anew()
                sides.set(values)
                raised[sides.step(0.0)] += 1
    assert min(raised.values()) > 500


SAMPLE = '''"""A sample of the text."""

from dataclasses import dataclass

from motionsync import var
from motionsync.var import Enumeration

STEEP = 2.0 / 3.0  # of the ramp
LEAST = 1e-12  # u


class Refusal(Enumeration):
    """Why a call fails"""

    NONE = 0, "done"
    LONG = 1, "the step is too long"


@dataclass(slots=True)
class Ramp:
    """How far the slave is.

    It grows with each step."""

    travel: float = var.output(0.5, "what is covered")
    laps: list[float] = var.ring(3)
    times: list[float] = var.ring(3)
    rows: list[float] = var.ring(6)

    def advance(self, h: float, gain: float) -> None:
        """Add what a step covers."""
        rate, lap = shares(h, gain)
        for i in range(3):
            self.laps[i] += rate  # each lap
        # The last lap counts twice.
        self.laps[lap] = self.laps[-1] + (self.travel - rate)
        if rate != 0.0:
            self.times[lap] += self.laps[lap] / rate
            self.rows[2 * lap] = self.rows[2 * lap + 1] / gain - rate / gain
        self.travel += STEEP * rate


@dataclass(slots=True)
class Sampled:
    ramp: Ramp = var.part(Ramp)
    gain: float = var.input(1.0, "the gain")

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        if h > 1.0:
            return Refusal.LONG
        self.ramp.advance(h, self.gain)
        return Refusal.NONE


def shares(h: float, gain: float) -> tuple[float, int]:
    """The rate, u/s, and the lap in which it counts."""
    return h / gain, 1 if gain > LEAST else 0
'''
IN_C = """\
/* Add what a step covers. */
static void Ramp_advance(Ramp *self, double h, double gain, bool *failed) {
    const Tuple_di shares = sampled_of_this_run_shares(h, gain, failed);
    const double rate = shares.v0;
    const int64_t lap = shares.v1;
    for (int64_t i = 0; i < 3; i++) {
        self->laps[i] += rate; /* each lap */
    }
    /* The last lap counts twice. */
    const int64_t at_lap = index_in(lap, 3, failed);
    self->laps[at_lap] = self->laps[index_in(-1, 3, failed)] + (self->travel - rate);
    if (rate != 0.0) {
        self->times[at_lap] += self->laps[at_lap] / rate;
        self->rows[2 * at_lap] = self->rows[2 * at_lap + 1] / nonzero(gain, failed) - rate / gain;
    }
    self->travel += STEEP * rate;
}
"""
STRUCT_IN_C = """\
/* How far the slave is.
 *
 * It grows with each step. */
typedef struct {
    double travel; /* output: what is covered */
    double laps[3];
    double times[3];
    double rows[6];
} Ramp;
"""


def test_the_text_keeps_the_names_the_comments_and_the_docstrings(tmp_path: Path) -> None:
    block = loaded(tmp_path, "sampled_of_this_run", SAMPLE).Sampled()
    files = {name: text.decode() for name, text in c_source(block).items()}
    assert IN_C in files["block.c"]
    assert "static const double STEEP = 0.6666666666666666; /* 2.0 / 3.0; of the ramp */" in files["block.c"]
    assert "    .ramp = {\n        .travel = 0.5,\n    },\n    .gain = 1.0,\n" in files["block.c"]
    assert STRUCT_IN_C in files["block.h"]
    assert "    Refusal_LONG = 1, /* the step is too long */" in files["block.h"]
    assert all(len(line) <= 120 for text in files.values() for line in text.splitlines())


def test_a_block_outside_the_subset_is_refused_with_file_and_line(tmp_path: Path) -> None:
    text = SAMPLE.replace("h / gain, 1 if", "h ** gain, 1 if").replace("class Sampled", "class Wrong")
    block = loaded(tmp_path, "wrong_of_this_run", text).Wrong()
    line = text[: text.index("h ** gain")].count("\n") + 1
    with pytest.raises(UserError, match=rf"wrong_of_this_run\.py:{line}: no `\*\*`"):
        c_source(block)


def test_the_text_is_the_same_in_another_process_with_another_seed_for_hashes() -> None:
    script = "import hashlib; from motionsync.blocks import BLOCKS\n"
    script += "from motionsync_fmu.native.translator import c_source\n"
    script += "for name in BLOCKS: print(*(hashlib.sha256(t).hexdigest() for t in c_source(BLOCKS[name]()).values()))"
    seed = os.environ | {"PYTHONHASHSEED": "7"}
    done = subprocess.run([sys.executable, "-c", script], env=seed, capture_output=True, text=True, check=True)
    here = [" ".join(hashlib.sha256(text).hexdigest() for text in c_of(name).values()) for name in BLOCKS]
    assert done.stdout.splitlines() == here


@cache
def c_of(name: str) -> dict[str, bytes]:
    return c_source(BLOCKS[name]())


def test_the_start_image_has_each_field_where_python_and_numpy_see_it(block: str) -> None:
    memory = image(BLOCKS[block]())
    found = create_string_buffer(memory.nbytes)
    library(BLOCKS[block]).block_start(found)
    assert found.raw == memory.tobytes()


# --- what C compilers say ---

WARNINGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]
DEEPEST = 2048  # bytes of stack: what a step needs at most, on x86-64 by gcc


@pytest.fixture
def folder(block: str, tmp_path: Path) -> Path:
    """The C of a block."""
    for name, text in c_of(block).items():
        (tmp_path / name).write_bytes(text)
    return tmp_path


def gcc(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    return subprocess.run(["gcc", *arguments, "-c", "block.c"], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("target", ["x86_64-linux-gnu", "x86_64-windows-gnu"])
def test_clang_finds_nothing_to_warn_of(folder: Path, target: str) -> None:
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *WARNINGS, "-c"]
    command += ["-Wno-unused-command-line-argument", "block.c", "-o", "block.o"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert ZIG.exists()


def test_gcc_finds_nothing_to_warn_of_and_a_step_needs_little_stack(block: str, folder: Path) -> None:
    done = gcc("-O2", *WARNINGS, "-fcallgraph-info=su", folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    own, calls = call_graph((folder / "block.ci").read_text())
    assert {"block_start", "block_initialize", "block_step"} <= own.keys()
    outside = {callee for callees in calls.values() for callee in callees} - own.keys()
    assert outside <= {"sqrt", "floor", "rint", "fmod", "fabs", "memcpy", "memset"}
    needed = {entry: deepest(entry, own, calls, ()) for entry in ("block_initialize", "block_step")}

    assert max(needed.values()) <= DEEPEST


def call_graph(text: str) -> tuple[dict[str, int], dict[str, list[str]]]:
    """Of gcc's call graph: the stack that each function needs itself, bytes, and what it calls."""
    own = {
        name: int(size) for name, size in re.findall(r'title: "(?:block\.c:)?(\w+)" label: "[^"]*?(\d+) bytes', text)
    }
    calls: dict[str, list[str]] = {}
    plain = r'"(?:block\.c:)?([\w.]+)"'
    own = {name: int(size) for name, size in re.findall(rf'title: {plain} label: "[^"]*?(\d+) bytes', text)}
    for caller, callee in re.findall(rf"sourcename: {plain} targetname: {plain}", text):
        calls.setdefault(caller, []).append(callee)
    return own, calls


def deepest(name: str, own: dict[str, int], calls: dict[str, list[str]], above: tuple[str, ...]) -> int:
    """The stack that a function needs with all that it calls; it never calls itself."""
    assert name not in above, f"{name} calls itself"
    below = [deepest(callee, own, calls, (*above, name)) for callee in calls.get(name, [])]
    return own.get(name, 0) + max(below, default=0)


@pytest.mark.parametrize(
    "flag",
    [
        "-ffast-math",
        "-ffinite-math-only",
        "-freciprocal-math",
        "-fno-signed-zeros",
        "-funsafe-math-optimizations",
        "-mfpmath=387",
    ],
)
def test_a_compiler_that_may_change_results_is_refused(tmp_path: Path, flag: str) -> None:
    for name, text in c_of("Synchronizer").items():
        (tmp_path / name).write_bytes(text)
    done = gcc("-fsyntax-only", flag, folder=tmp_path)
    assert "#error" in done.stderr, done.stderr
    assert gcc("-fsyntax-only", "-O3", folder=tmp_path).returncode == 0


def test_no_fused_operation_is_made_even_where_the_processor_has_it(tmp_path: Path) -> None:
    for name, text in c_of("Synchronizer").items():
        (tmp_path / name).write_bytes(text)
    for pragmas, fused in ((True, False), (False, True)):
        text = (tmp_path / "block.c").read_text()
        (tmp_path / "block.c").write_text(text if pragmas else re.sub("^#pragma.*$", "", text, flags=re.M))
        done = gcc("-std=gnu99", "-O3", "-march=haswell", "-S", "-o", "block.s", folder=tmp_path)
        assert done.returncode == 0, done.stderr
        assert ("vfmadd" in (tmp_path / "block.s").read_text()) == fused
