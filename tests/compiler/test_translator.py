"""The translator from the kernel subset to C: the same bits as Python, and an error exactly where Python raises."""

import math
import random
import struct
from array import array
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given

from motionsync_fmu.compiler.memory_layout import address_and_count
from tests.support.blocks.drawn import drawn
from tests.support.compiler.compiled import Compiled, Layout
from tests.support.compiler.modules import load_module
from tests.support.compiler.random_programs import HEAD, module, programs

PROGRAMS = 100
RUNS = 12  # of each program
REALS = [0.0, -0.0, 1.0, -1.0, 0.5, 2.5, -7.25, 5e-324, -1e-300, 1e300, 1e9, 1e15, math.inf, -math.inf, math.nan]
WHOLES = [0, 1, -1, 2, -2, 3, 5, -7, 1000]
RAISES = (ZeroDivisionError, ValueError, OverflowError, IndexError)


def to_words(memory: bytes) -> list[bytes]:
    """The memory in words of 8 bytes; all NaN are alike, since their bits are not defined."""
    contents = [memory[i : i + 8] for i in range(0, len(memory), 8)]
    return [b"not a number" if math.isnan(struct.unpack("<d", word.ljust(8, b"\0"))[0]) else word for word in contents]


class Sides:
    """A block in Python and in C, with the same values."""

    def __init__(self, block_type: Any) -> None:
        self.block = block_type()
        self.compiled = Compiled(block_type())
        self.layout = Layout(self.block)
        self.clean = self.compiled.memory.tobytes()
        self.given: list[tuple[str, Any, Any]] = []  # each series by name, in Python and in C
        self.compiled.initialize()
        self.type = block_type

    def set(self, values: dict[str, Any]) -> None:
        for name, value in values.items():
            setattr(self.block, name, value)
            self.compiled.set(name, value)

    def give(self, name: str, numbers: "array[Any]") -> None:
        """Give a series: each side has its own numbers."""
        own = numbers[:]
        self.given.append((name, numbers, own))
        setattr(self.block, name, numbers)
        self.compiled.memory[name] = address_and_count(own)

    def reset(self) -> None:
        self.given.clear()
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
            refusal = self.block.step(h)
        except RAISES:
            with pytest.raises(ArithmeticError):  # as Python
                self.compiled.step(h)
            return True
        assert self.compiled.step(h) == refusal
        memory = bytearray(self.compiled.memory.tobytes())
        for name, numbers, own in self.given:
            assert to_words(numbers.tobytes()) == to_words(own.tobytes())
            at, form = self.layout.places[name]
            form.pack_into(memory, at, 0, 0)
        assert to_words(bytes(memory)) == to_words(self.layout.bytes(self.block))
        return False


def random_values(rng: random.Random, way: Any) -> dict[str, Any]:
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


def random_series(rng: random.Random) -> dict[str, "array[Any]"]:
    """The numbers that are given from outside: few, or none."""
    return {
        "reals": array("d", [rng.choice(REALS) for _ in range(rng.choice([0, 3, 5]))]),
        "wholes": array("q", [rng.choice(WHOLES) for _ in range(rng.choice([1, 4, 4, 5]))]),
    }


# Programs, each of which fails in C if one thing is translated literally.
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

self.other.values[1] = self.a
self.part.values[1] = self.b
self.on = var.same(self.part, self.other)
self.other.n = self.m
self.part.n = self.n
return 1.0 if var.same(self.other, self.part) else 2.0

self.longer.y = self.a
part = self.longer
return 1.0 if var.same(part, self.longer) else 2.0

self.longer.y = self.a
self.longer.number = self.m
self.longer.turn = self.way
var.copy_valid(self.stored, self.longer)
var.copy_valid(self.part, self.stored)
self.on = var.same(self.part, self.longer)
return float(var.first_invalid(self.longer)) + self.stored.y
"""


@pytest.mark.slow
def test_random_programs_give_the_bits_of_python_and_raise_where_python_does(tmp_path: Path) -> None:
    bodies = [text.split("\n") for text in FLOWS.strip().split("\n\n")]
    flows = len(bodies)

    @drawn(PROGRAMS, anew=True, shrink=False)
    @given(programs())
    def collect(body: list[str]) -> None:
        bodies.append(body)

    collect()
    programs_module = load_module(tmp_path, "random_programs_of_this_run", module(bodies))
    sides = Sides(programs_module.Programs)
    rng = random.Random(len(bodies))
    raised = steps = 0
    for which, body in enumerate(bodies):
        for _ in range(8 * RUNS if which < flows else RUNS):
            sides.reset()
            values = random_values(rng, programs_module.Way) | {"which": which}
            for name, numbers in random_series(rng).items():
                sides.give(name, numbers)
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
    assert steps / 20 < raised < steps * 3 / 4  # both are frequent


# Operations by the field that gets the result: `x`, `i` or `on`. Every pair of nasty values is tried.
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
    """The text of a block that does the operation with the number `which`; some names are keywords of C."""
    assignments = [(kind, text) for kind, texts in OPERATIONS.items() for text in texts]
    head = HEAD.replace("    calls: int = 0\n", "    calls: int = 0" + KEYWORDS)
    longer = "class Longer(Part):\n"
    head = head.replace(longer, longer + "    auto_: float = var.local(4.0, 'like a keyword')\n")
    text = head + "\n    def step(self, h: float) -> Refusal:\n        match self.which:\n"
    for i, (kind, expression) in enumerate(assignments):
        text += f"            case {i}:\n                self.{kind} = {expression}\n"
    return text + "            case _:\n                pass\n        return Refusal.NONE\n"


@pytest.mark.slow
def test_every_operation_gives_the_bits_of_python_for_nasty_values(tmp_path: Path) -> None:
    programs_module = load_module(tmp_path, "operations_of_this_run", operations())
    sides = Sides(programs_module.Programs)
    raised = {True: 0, False: 0}
    for which in range(sum(map(len, OPERATIONS.values()))):
        for at, a in enumerate(REALS):
            for b in REALS:
                m, n = WHOLES[at % len(WHOLES)], WHOLES[(at + which) % len(WHOLES)]
                values = {
                    "which": which,
                    "a": a,
                    "b": b,
                    "m": m,
                    "n": n,
                    "f": a < b,
                    "way": list(programs_module.Way)[at % 3],
                }
                sides.reset()
                sides.set(values)
                raised[sides.step(0.0)] += 1
    assert min(raised.values()) > 500
