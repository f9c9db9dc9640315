"""What compiled code must get right whatever the block, and how a block lies in memory."""

from dataclasses import dataclass
from math import inf

import pytest

from motionsync import var
from motionsync.var import Enumeration
from motionsync_fmu.native.memory_layout import image
from motionsync_fmu.native.tables import number, quoted
from tests.support.compiled import Compiled, equal


class Refusal(Enumeration):
    """Why the sample refuses a call"""

    NONE = 0, "done"
    LONG = 1, "the step must be at most 1e6 s"


class Way(Enumeration):
    NONE = 0, "none"
    UP = 1, "up"
    DOWN = 2, "down"


@dataclass(slots=True)
class Adder:
    """The same fields and methods as `Doubler`, but another law."""

    x: float = 0.0

    def put(self, x: float) -> float:
        self.x += x
        return self.x


@dataclass(slots=True)
class Doubler:
    x: float = 0.0

    def put(self, x: float) -> float:
        self.x = 2.0 * x
        return self.x


@dataclass(slots=True)
class Shown(Adder):
    """A part that only adds what it shows."""

    more: float = var.local(0.0, "more")


@dataclass(slots=True)
class Sample:
    adder: Adder = var.part(Adder)
    doubler: Doubler = var.part(Doubler)
    second: Doubler = var.part(Doubler)
    shown: Shown = var.part(Shown)
    values: list[float] = var.ring(3)
    way: Way = Way.NONE
    code: int = 0
    on: bool = False
    sum: float = 0.0
    rest: float = 0.0
    turns: float = 0.0
    least: float = 0.0
    greatest: float = 0.0

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        self.sum = self.adder.put(h)
        self.sum += self.doubler.put(h)
        self.sum += 10.0 * self.second.put(h + 1.0)
        self.sum += self.shown.put(3.0 * h)
        self.way = self.turned(self.way)
        self.code = self.way
        self.on = not self.on and h > 0.0
        self.values[self.code] = self.sum / (h - 3.0)
        self.rest = h % 0.75
        self.turns = round(h / 0.75) * 0.75
        self.least = min(h, 0.0)
        self.greatest = max(0.0, h, -1.0)
        return Refusal.LONG if h > 1e6 else Refusal.NONE

    def turned(self, way: Way) -> Way:
        match way:
            case Way.UP:
                return Way.DOWN
            case _:
                return Way.UP if way == Way.NONE or way in (Way.DOWN,) else way


@dataclass(slots=True)
class Inner:
    values: list[float] = var.ring(3)
    way: Way = Way.NONE


@dataclass(slots=True)
class Kept:
    inner: Inner = var.part(Inner)
    x: float = 0.0
    n: int = 0
    on: bool = False
    way: Way = var.output(Way.NONE, "a direction")


@dataclass(slots=True)
class Keeper:
    """Copies its present part into the kept one, and the kept one into itself."""

    present: Kept = var.part(Kept)
    kept: Kept = var.part(Kept)

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        if h > 0.0:
            var.copy(self.kept, self.present)
        else:
            var.copy(self.kept, self.kept)
        return Refusal.NONE


def keeper() -> Keeper:
    """No two fields have the same value, and none of the present part has the kept one's."""
    block = Keeper()
    present, kept = block.present, block.kept
    present.inner.values[:], kept.inner.values[:] = [0.1, -0.0, inf], [4.0, 5.0, 6.0]
    present.inner.way, kept.inner.way = Way.UP, Way.DOWN
    present.x, present.n, present.on, present.way = 5e-324, -(2**62), True, Way.DOWN
    kept.x, kept.n, kept.way = 7.0, 8, Way.UP
    return block


def test_a_compiled_copy_copies_every_field_as_python_does() -> None:
    block, compiled = keeper(), Compiled(keeper())
    assert compiled.memory["kept"].tobytes() != compiled.memory["present"].tobytes()
    block.step(1.0)
    compiled.step(1.0)
    assert equal(block, compiled)
    assert compiled.memory["kept"].tobytes() == compiled.memory["present"].tobytes()
    assert block.kept.inner.values == [0.1, 0.0, inf]
    assert (block.kept.inner.way, block.kept.x, block.kept.n, block.kept.on) == (Way.UP, 5e-324, -(2**62), True)
    compiled.memory["present"]["inner"]["values"][0] = 9.0
    assert compiled.memory["kept"]["inner"]["values"][0] == 0.1


def test_a_copy_of_a_part_into_itself_changes_nothing() -> None:
    block, compiled = keeper(), Compiled(keeper())
    block.step(-1.0)
    compiled.step(-1.0)
    assert equal(block, compiled)
    assert equal(keeper(), compiled)


STEPS = (1.0, 2.0, 0.1, -0.0, 0.0, -0.75, -1e-300, 5e-324, 0.375, 1.125, -0.375, 7.5, 1e6, 1.1e6, -1e15, 1e12)


def test_every_operation_gives_the_bits_that_python_gives() -> None:
    """Remainders with their signs, halves rounded to even, the first of two equal zeros, whatever inherits."""
    block, compiled = Sample(), Compiled(Sample())
    assert compiled.initialize() == block.initialize() == 0
    for h in STEPS:
        assert compiled.step(h) == block.step(h)
        assert equal(block, compiled), h


def test_what_python_raises_the_compiled_code_reports() -> None:
    compiled = Compiled(Sample())
    with pytest.raises(ArithmeticError):
        compiled.step(3.0)
    block, compiled = Sample(), Compiled(Sample())
    block.way = 7  # type: ignore[assignment]
    compiled.memory["way"] = 7
    with pytest.raises(IndexError):
        block.step(1.0)
    with pytest.raises(ArithmeticError):
        compiled.step(1.0)


def test_the_memory_holds_every_field_at_its_place() -> None:
    memory = image(Sample(code=-3, on=True, sum=2.5))
    assert (memory["code"], memory["on"], memory["sum"]) == (-3, True, 2.5)
    assert memory["shown"].dtype.names == ("x", "more")
    assert image(Sample()).tobytes() == image(Sample()).tobytes()


def test_numbers_and_texts_in_c() -> None:
    assert (number(-1.5), number(inf), number(-inf)) == (
        "-0x1.8000000000000p+0",
        "INFINITY",
        "-INFINITY",
    )
    assert quoted('5 % of "u"\\') == '"5 percent of \\"u\\"\\\\"'
