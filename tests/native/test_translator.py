"""The translator from the kernel subset to C: the same bits as Python, and an error exactly where Python raises."""

import importlib
import math
import random
import struct
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from tests.support.compiled import Compiled, Layout
from tests.support.random_programs import module, programs

PROGRAMS = 100
RUNS = 12  # of each program
REALS = [0.0, -0.0, 1.0, -1.0, 0.5, 2.5, -7.25, 5e-324, -1e-300, 1e300, 1e9, 1e15, math.inf, -math.inf, math.nan]
WHOLES = [0, 1, -1, 2, -2, 3, 5, -7, 1000]
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
        except RAISES as e:
            with pytest.raises(ArithmeticError):
                self.compiled.step(h)
                pytest.fail(f"Python raises {e!r}, C does not")
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


def test_random_programs_give_the_bits_of_python_and_raise_where_python_does(tmp_path: Path) -> None:
    bodies: list[list[str]] = []

    @settings(
        max_examples=PROGRAMS,
        phases=[Phase.generate],
        database=None,
        suppress_health_check=list(HealthCheck),
        deadline=None,
    )
    @given(programs())
    def collect(body: list[str]) -> None:
        bodies.append(body)

    collect()
    space = loaded(tmp_path, "random_programs_of_this_run", module(bodies))
    sides = Sides(space.Programs)
    rng = random.Random(len(bodies))
    raised = steps = 0
    for which, body in enumerate(bodies):
        for _ in range(RUNS):
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
