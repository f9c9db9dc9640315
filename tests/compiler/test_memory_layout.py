"""What compiled code must get right whatever the block, and how a block lies in memory."""

from dataclasses import dataclass
from math import inf, isnan, nan, nextafter
from typing import Any

import pytest

from motionsync import var
from motionsync.var import Enumeration, Unit
from motionsync_fmu.compiler.memory_layout import image
from motionsync_fmu.native.tables import number, quoted
from tests.support.compiler.compiled import Compiled, equal


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
    values: list[float] = var.array(3)
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
        self.way = self.reversed_way(self.way)
        self.code = self.way
        self.on = not self.on and h > 0.0
        self.values[self.code] = self.sum / (h - 3.0)
        self.rest = h % 0.75
        self.turns = round(h / 0.75) * 0.75
        self.least = min(h, 0.0)
        self.greatest = max(0.0, h, -1.0)
        return Refusal.LONG if h > 1e6 else Refusal.NONE

    def reversed_way(self, way: Way) -> Way:
        match way:
            case Way.UP:
                return Way.DOWN
            case _:
                return Way.UP if way == Way.NONE or way in (Way.DOWN,) else way


@dataclass(slots=True)
class Inner:
    values: list[float] = var.array(3)
    way: Way = Way.NONE


@dataclass(slots=True)
class Sampled:
    inner: Inner = var.part(Inner)
    x: float = 0.0
    n: int = 0
    on: bool = False
    way: Way = var.output(Way.NONE, "a direction")


@dataclass(slots=True)
class Copier:
    """Copies its present part into the stored one, and the stored one into itself."""

    present: Sampled = var.part(Sampled)
    stored: Sampled = var.part(Sampled)

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        if h > 0.0:
            var.copy(self.stored, self.present)
        else:
            var.copy(self.stored, self.stored)
        return Refusal.NONE


def make_copier() -> Copier:
    """No two fields have the same value, and none of the present part has the stored one's."""
    block = Copier()
    present, stored = block.present, block.stored
    present.inner.values[:], stored.inner.values[:] = [0.1, -0.0, inf], [4.0, 5.0, 6.0]
    present.inner.way, stored.inner.way = Way.UP, Way.DOWN
    present.x, present.n, present.on, present.way = 5e-324, -(2**62), True, Way.DOWN
    stored.x, stored.n, stored.way = 7.0, 8, Way.UP
    return block


def test_a_compiled_copy_copies_every_field_as_python_does() -> None:
    block, compiled = make_copier(), Compiled(make_copier())
    assert compiled.memory["stored"].tobytes() != compiled.memory["present"].tobytes()
    block.step(1.0)
    compiled.step(1.0)
    assert equal(block, compiled)
    assert compiled.memory["stored"].tobytes() == compiled.memory["present"].tobytes()
    assert block.stored.inner.values == [0.1, 0.0, inf]
    assert (block.stored.inner.way, block.stored.x, block.stored.n, block.stored.on) == (Way.UP, 5e-324, -(2**62), True)
    compiled.memory["present"]["inner"]["values"][0] = 9.0
    assert compiled.memory["stored"]["inner"]["values"][0] == 0.1


def test_a_copy_of_a_part_into_itself_changes_nothing() -> None:
    block, compiled = make_copier(), Compiled(make_copier())
    block.step(-1.0)
    compiled.step(-1.0)
    assert equal(block, compiled)
    assert equal(make_copier(), compiled)


@dataclass(slots=True)
class Wider(Sampled):
    y: float = var.local(0.0, "more")


@dataclass(slots=True)
class Comparer:
    a: Wider = var.part(Wider)
    b: Wider = var.part(Wider)
    is_same: bool = False

    def initialize(self) -> Refusal:
        self.is_same = var.same(self.a, self.b)
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        a = self.a
        self.is_same = var.same(a, self.a)
        return Refusal.NONE


VALUES = [
    ("inner.values", [0.0, -0.0, 0.0], True),
    ("inner.values", [0.0, 0.0, 5e-324], False),
    ("inner.values", [0.0, nan, 0.0], False),
    ("inner.way", Way.UP, False),
    ("x", -0.0, True),
    ("x", 5e-324, False),
    ("x", nan, False),
    ("n", 2**62, False),
    ("on", True, False),
    ("way", Way.DOWN, False),
    ("y", 1.0, False),
]


@pytest.mark.parametrize(("name", "value", "is_same"), VALUES)
def test_parts_are_the_same_if_no_field_differs_nor_any_inside_them(name: str, value: object, is_same: bool) -> None:
    block = Comparer()
    owner = block.a.inner if name.startswith("inner.") else block.a
    setattr(owner, name.removeprefix("inner."), value)
    compiled = Compiled(block)
    assert compiled.initialize() == block.initialize() == 0
    assert compiled.memory["is_same"] == block.is_same == is_same


@pytest.mark.parametrize("values", [[0.0, 1.0, 2.0], [0.0, nan, 2.0]])
def test_a_part_is_the_same_as_itself_unless_it_holds_a_nan(values: list[float]) -> None:
    block = Comparer()
    block.a.inner.values[:] = values
    compiled = Compiled(block)
    assert compiled.step(1.0) == block.step(1.0) == 0
    assert compiled.memory["is_same"] == block.is_same == (not any(map(isnan, values)))


@dataclass(slots=True)
class Ranges:
    """A range of each kind."""

    inner: Inner = var.part(Inner)
    limit: float = var.limit(1.0, "0, or 1e-12 to 1e12", Unit.NONE)
    share: float = var.parameter(0.5, "above 0, and below 1", tunable=True, above=0.0, below=1.0)
    count: int = var.parameter(1, "at least 1", tunable=True, min=1)
    on: bool = var.switch(False, "each value is allowed")
    way: Way = var.parameter(Way.UP, "a member", tunable=True)
    position: float = var.position(0.0, "within 1e12")
    speed: float = var.limit(1.0, "1e-12 to 1e12", Unit.NONE, zero=False)
    free: float = var.parameter(0.0, "finite", tunable=True)
    fixed: float = var.parameter(0.0, "not tunable", max=1.0)


@dataclass(slots=True)
class WiderRanges(Ranges):
    more: float = var.length(0.0, "at least 0")


@dataclass(slots=True)
class Validator:
    stored: Ranges = var.part(Ranges, hidden=True)
    given: WiderRanges = var.part(WiderRanges)
    first: int = 0

    def initialize(self) -> Refusal:
        self.first = var.first_invalid(self.given)
        return Refusal.NONE

    def step(self, h: float) -> Refusal:
        var.copy_valid(self.stored, self.given)
        return Refusal.NONE


LEAST = nextafter(0.0, 1.0)
RANGES = [
    ("limit", 1, (0.0, -0.0, 1e-12, 1e12), (nextafter(1e-12, 0.0), nextafter(1e12, inf), -1.0, nan, inf)),
    ("share", 2, (LEAST, nextafter(1.0, 0.0)), (0.0, 1.0, nan)),
    ("count", 3, (1, 2**31), (0, -(2**40))),
    ("on", 0, (True,), ()),
    ("way", 4, (Way.DOWN, Way.NONE), (7, -1)),
    ("position", 5, (-1e12, 1e12), (nextafter(-1e12, -inf), nextafter(1e12, inf), nan)),
    ("speed", 6, (1e-12, 1e12), (0.0, nextafter(1e-12, 0.0), -1.0)),
    ("free", 7, (1.7976931348623157e308, -1e308), (inf, -inf, nan)),
    ("more", 8, (0.0, 1e12), (-LEAST,)),
]


@pytest.mark.parametrize(("name", "number", "allowed", "refused"), RANGES)
def test_a_parameter_out_of_its_declared_range_is_numbered_and_its_part_not_copied(
    name: str, number: int, allowed: tuple[Any, ...], refused: tuple[Any, ...]
) -> None:
    """The tunable parameters are numbered in the order of declaration, those of the base first; Booleans are not."""
    for value in (*allowed, *refused):
        block = Validator()
        block.given.inner.values[1] = 3.0
        setattr(block.given, name, value)
        compiled = Compiled(block)
        assert compiled.initialize() == block.initialize() == 0
        assert compiled.memory["first"] == block.first == (0 if value in allowed else number)
        assert compiled.step(1.0) == block.step(1.0) == 0
        assert equal(block, compiled)
        assert block.stored.inner.values[1] == (3.0 if name == "more" or value in allowed else 0.0)


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
