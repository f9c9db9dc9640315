"""Random programs in the kernel subset: methods of one block, each a list of statements that hypothesis chooses.

Python and C promise to agree on each program: whole numbers stay far within 64 bits, and loops end."""

import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

HEAD = '''"""Random programs."""

import math
from dataclasses import dataclass
from math import floor, fmod, isfinite, sqrt

from motionsync import var
from motionsync.var import Enumeration

SIZE = 5
HALF = SIZE // 2
RATIO = 1.0 / 3.0
BELOW = -0.5


class Refusal(Enumeration):
    NONE = 0, "done"


class Way(Enumeration):
    NONE = 0, "none"
    UP = 1, "up"
    BACK = -3, "back"


@dataclass(slots=True)
class Part:
    x: float = 0.25
    n: int = 3
    on: bool = False
    values: list[float] = var.array(4)

    def add(self, x: float) -> float:
        self.x += x
        self.on = x > 1.0
        return self.x - x

    def twice(self) -> float:
        return 2.0 * self.x


@dataclass(slots=True)
class Longer(Part):
    y: float = var.parameter(-0.0, "more", tunable=True, min=-2.0, below=1.5, smallest=0.25)
    turn: Way = var.parameter(Way.NONE, "a direction", tunable=True)
    number: int = var.parameter(1, "a whole number", tunable=True, min=-1)


@dataclass(slots=True)
class Programs:
    which: int = var.input(0, "which program runs")
    a: float = var.input(0.0, "a number")
    b: float = var.input(0.0, "a number")
    m: int = var.input(0, "a whole number")
    n: int = var.input(0, "a whole number")
    f: bool = var.input(False, "a Boolean")
    way: Way = var.input(Way.NONE, "a direction")
    part: Part = var.part(Part)
    other: Part = var.part(Part)
    longer: Longer = var.part(Longer)
    stored: Longer = var.part(Longer)
    values: list[float] = var.array(SIZE)
    x: float = 0.0
    y: float = 0.0
    i: int = 0
    k: int = 0
    on: bool = False
    calls: int = 0
    rows: list[float] = var.array(6)
    reals: var.Reals = var.series()
    wholes: var.Wholes = var.series()
    noted: list[float] = var.array(32)
    notes: int = 0

    def initialize(self) -> Refusal:
        return Refusal.NONE

    def opposite_way(self, way: Way) -> Way:
        match way:
            case Way.UP | Way.NONE:
                return Way.BACK
            case _:
                return Way.UP if self.f else way

    def note(self, x: float) -> None:
        self.noted[self.notes % 32] = x
        self.notes += 1

    def count_call(self) -> int:
        self.calls += 1
        return self.calls % 3

    def try_move(self) -> bool:
        self.i = self.count_call() - 1
        self.part.n -= 1
        self.y = self.a
        return self.f

    def climb(self, step: float) -> float:
        height = 0.0
        while height < 5.0:
            height += step
        return height
'''
TAIL = """

def pair(x: float, y: float) -> tuple[float, float]:
    return y, x


def split(x: float, n: int) -> tuple[float, int, bool]:
    if n < 0:
        return -x, n, False
    return x, n + 1, x > float(n)


def total(values: list[float], at: int) -> float:
    return values[at] + 0.5 * float(len(values))


def law(x: float, y: float) -> float:
    return x if x < y else y - x
"""

REALS = ["0.0", "-0.0", "1.0", "0.5", "2.5", "-1.5", "1e300", "5e-324", "1e-12", "RATIO", "math.inf", "math.pi", "7.5"]
WHOLES = ["0", "1", "2", "-1", "3", "7", "-5", "SIZE", "HALF"]
WAYS = ["Way.NONE", "Way.UP", "Way.BACK"]
FIELDS = {
    "float": ["self.a", "self.b", "self.x", "self.y", "self.part.x", "self.other.x", "self.longer.x", "self.longer.y"],
    "int": ["self.m", "self.n", "self.i", "self.k", "self.part.n", "self.longer.n"],
    "bool": ["self.f", "self.on", "self.part.on", "self.longer.on"],
    "way": ["self.way"],
}
LISTS = {"self.values": 5, "self.part.values": 4, "self.longer.values": 4}
FIRST = {"float": "0.75", "int": "2", "bool": "True", "way": "Way.UP"}


@dataclass
class Writer:
    """Writes one program; `pick` chooses."""

    pick: Callable[[list[Any]], Any]
    locals: dict[str, list[str]] = field(default_factory=lambda: {kind: [] for kind in FIRST})
    counted: list[str] = field(default_factory=list)  # the variables of the loops around
    number: int = 0

    def new_name(self, letter: str) -> str:
        self.number += 1
        return f"{letter}{self.number}"

    # --- expressions without a change ---

    def expression(self, kind: str, depth: int = 3) -> str:
        return str(getattr(self, f"{kind}_expression")(depth))

    def leaf(self, kind: str) -> str:
        constants = {"float": REALS, "int": WHOLES, "bool": ["True", "False"], "way": WAYS}[kind]
        counted = self.counted if kind == "int" else []
        return str(self.pick([*constants, *FIELDS[kind], *self.locals[kind] * 3, *counted * 2]))

    def float_expression(self, depth: int) -> str:
        if depth <= 0:
            return self.leaf("float")
        e, n = (lambda: self.float_expression(depth - 1)), (lambda: self.int_expression(depth - 1))
        forms = {
            "leaf": lambda: self.leaf("float"),
            "+": lambda: f"({e()} + {e()})",
            "-": lambda: f"({e()} - {e()})",
            "flat": lambda: f"{e()} - {e()} * {e()}",
            "*": lambda: f"{e()} * {e()}",
            "/": lambda: f"({e()}) / ({e()})",
            "%": lambda: f"({e()}) % ({e()})",
            "minus": lambda: f"-({e()})",
            "abs": lambda: f"abs({e()})",
            "min": lambda: f"min({e()}, {e()})",
            "max": lambda: f"max({e()}, {e()}, {e()})",
            "sqrt": lambda: f"sqrt({e()})",
            "root": lambda: f"sqrt(max({e()}, {self.pick(['0.0', '2.5', '-1.5'])}))",
            "least": lambda: f"sqrt({self.pick(['min', 'max'])}({self.leaf('float')}, {self.leaf('float')}))",
            "fmod": lambda: f"fmod({e()}, {e()})",
            "float": lambda: f"float({n()})",
            "round": lambda: f"round({e()}) * ({e()})",
            "floor": lambda: f"({e()} + floor({e()}) * 0.5)",
            "floors": lambda: f"(-floor({e()}) - ({e()}))",
            "mixed": lambda: f"({n()} * ({e()}) - {n()})",
            "divided": lambda: f"({n()}) / ({n()})",
            "if": lambda: f"(({e()}) if {self.bool_expression(depth - 1)} else ({e()}))",
            "call": lambda: f"law({e()}, {e()})",
            "method": lambda: f"self.{self.pick(['part', 'longer'])}.twice()",
            "element": lambda: self.element(depth - 1),
            "given": self.given,
            "total": lambda: f"total({self.pick(['self.part.values', 'self.longer.values'])}, {self.small()})",
        }
        return str(forms[self.pick(list(forms))]())

    def small(self) -> str:
        """A whole number that is seldom outside a list."""
        return str(self.pick(["0", "1", "-1", "3", "self.m % 4", "self.n % 5 - 1", *self.counted]))

    def given(self) -> str:
        """An element of a series, whose length only the run knows."""
        return f"self.reals[{self.pick([self.small(), 'len(self.wholes) - 1', 'self.wholes[0]'])}]"

    def element(self, depth: int, index: str = "") -> str:
        return f"{self.pick(list(LISTS))}[{index or self.small()}]"

    def int_expression(self, depth: int) -> str:
        if depth <= 0:
            return self.leaf("int")
        e, x = (lambda: self.int_expression(depth - 1)), (lambda: self.float_expression(depth - 1))
        forms = {
            "leaf": lambda: self.leaf("int"),
            "+": lambda: f"({e()} + {e()})",
            "-": lambda: f"({e()} - {e()})",
            "*": lambda: f"{self.leaf('int')} * {self.leaf('int')}",
            "//": lambda: f"({e()}) // ({e()})",
            "%": lambda: f"({e()}) % ({e()})",
            "constant": lambda: f"({e()}) {self.pick(['//', '%'])} {self.pick(['3', '7', '-4'])}",
            "abs": lambda: f"abs({e()})",
            "min": lambda: f"min({e()}, {e()}, {e()})",
            "max": lambda: f"max({e()}, {e()})",
            "len": lambda: f"len({self.pick([*LISTS, 'self.reals', 'self.wholes'])})",
            "given": lambda: f"self.wholes[{self.small()}]",
            "minus": lambda: f"-({e()})",
            "if": lambda: f"(({e()}) if {self.bool_expression(depth - 1)} else ({e()}))",
            "bool": lambda: f"({self.bool_expression(0)} + int({self.bool_expression(0)}))",
            "whole": lambda: self.whole(x()),
            "first invalid": lambda: "var.first_invalid(self.longer)",
        }
        return str(forms[self.pick(list(forms))]())

    def whole(self, x: str) -> str:
        """A number made whole, unless it is large; what is not a number raises."""
        return f"({self.pick(['int', 'round', 'floor'])}({x}) if not abs({x}) >= 1e9 else 3)"

    def bool_expression(self, depth: int) -> str:
        if depth <= 0:
            return self.leaf("bool")
        e, x, n = (
            (lambda: self.bool_expression(depth - 1)),
            (lambda: self.float_expression(depth - 1)),
            (lambda: self.int_expression(depth - 1)),
        )
        sign = lambda: self.pick(["<", "<=", ">", ">=", "==", "!="])  # noqa: E731
        forms = {
            "leaf": lambda: self.leaf("bool"),
            "reals": lambda: f"({x()} {sign()} {x()})",
            "wholes": lambda: f"({n()} {sign()} {n()})",
            "mixed": lambda: f"({x()} {sign()} {n()})",
            "chain": lambda: f"({x()} {sign()} {x()} {sign()} {x()})",
            "bools": lambda: f"(({e()}) {self.pick(['==', '!='])} ({e()}))",
            "and": lambda: f"(({e()}) and ({e()}))",
            "or": lambda: f"({e()} or {e()} or {e()})",
            "not": lambda: f"(not {e()})",
            "in": lambda: f"({n()} {self.pick(['in', 'not in'])} ({self.leaf('int')}, {self.leaf('int')}))",
            "ways": lambda: f"({self.leaf('way')} {self.pick(['==', '!='])} {self.leaf('way')})",
            "among": lambda: f"({self.leaf('way')} in ({self.leaf('way')}, Way.UP))",
            "isfinite": lambda: f"isfinite({x()})",
            "same": lambda: (
                f"var.same({self.pick(['self.part', 'self.other'])}, {self.pick(['self.other', 'self.longer'])})"
            ),
        }
        return str(forms[self.pick(list(forms))]())

    def way_expression(self, depth: int) -> str:
        forms = {
            "leaf": lambda: self.leaf("way"),
            "if": lambda: f"({self.leaf('way')} if {self.bool_expression(depth - 1)} else {self.leaf('way')})",
            "call": lambda: f"self.opposite_way({self.leaf('way')})",
        }
        return str(forms[self.pick(list(forms))]())

    def bounded(self) -> str:
        """A whole number that stays small, and may be stored."""
        return f"({self.int_expression(2)}) % 1009 - 500"

    def value(self, kind: str) -> str:
        return self.bounded() if kind == "int" else self.expression(kind)

    # --- statements ---

    def body(self, depth: int, loop: bool) -> list[str]:
        """A block; the locals that it declares end with it."""
        before = {kind: list(names) for kind, names in self.locals.items()}
        lines = [line for _ in range(self.pick([1, 1, 2, 3])) for line in self.statement(depth, loop)]
        self.locals = before
        return indented(lines)

    def statement(self, depth: int, loop: bool) -> list[str]:
        simple = [
            self.local,
            self.local,
            self.field,
            self.changed,
            self.changing,
            self.unpacked,
            self.item,
            self.aliased,
            self.again,
            self.again,
            self.divided,
            self.divided,
        ]
        nested = [self.branch, self.branch, self.count, self.repeat, self.match] if depth > 0 else []
        leaving = [self.leave] if loop else []
        write = self.pick([*simple, *nested, *nested, *leaving])
        before = {kind: list(names) for kind, names in self.locals.items()}
        lines: list[str] = write(depth, loop) if write in nested else write()
        return [*lines, *self.notes(before)]

    def notes(self, before: dict[str, list[str]]) -> list[str]:
        """Make all values visible: those of new locals, and of an earlier one, are stored in the block."""
        earlier = [name for name in self.locals["float"] if name in before["float"]]
        reals = [name for name in self.locals["float"] if name not in before["float"]]
        reals += [self.pick(earlier)] if earlier else []
        wholes = [name for kind in ("int", "bool") for name in self.locals[kind] if name not in before[kind]]
        return [f"self.note({name})" for name in reals] + [f"self.note(float({name}))" for name in wholes]

    def local(self) -> list[str]:
        kind = self.pick(list(FIRST))
        if self.locals[kind] and self.pick([True, False]):
            return [f"{self.pick(self.locals[kind])} = {self.value(kind)}"]
        name, value = self.new_name(kind[0]), self.value(kind)
        self.locals[kind].append(name)
        return [f"{name} = {value}  # a new one" if self.number % 3 == 0 else f"{name} = {value}"]

    def field(self) -> list[str]:
        kind = self.pick(list(FIRST))
        target = self.pick(FIELDS[kind])
        other = self.pick(FIELDS[kind])
        if self.pick([True, False, False]) and other != target:
            return [f"{target} = {other} = {self.value(kind)}"]
        return [f"{target} = {self.value(kind)}"]

    def changed(self) -> list[str]:
        sign = self.pick(["+", "-", "*", "/", "%"])
        target = self.pick([*FIELDS["float"], *self.locals["float"], "self.values[1]"])
        return [f"{target} {sign}= {self.expression('float')}"]

    def changing(self) -> list[str]:
        """A call that changes something."""
        result = self.new_name("f")
        call = self.pick(["self.part.add", "self.longer.add", "self.other.add"])
        line = f"{result} = {call}({self.expression('float', 2)})"
        self.locals["float"].append(result)
        copies = ["var.copy(self.other, self.part)", "var.copy_valid(self.stored, self.longer)"]
        return [line, self.pick([*copies, "self.i = self.count_call()"])]

    def unpacked(self) -> list[str]:
        if self.pick([True, False]):
            x, n = self.new_name("f"), self.new_name("i")
            line = f"{x}, {n}, _ = split({self.expression('float', 2)}, {self.leaf('int')} % 7)"
            self.locals["float"].append(x)
            self.locals["int"].append(n)
            return [line]
        reals = self.locals["float"]
        x, y = self.pick([*reals, self.new_name("f")]), self.new_name("f")
        line = f"{x}, {y} = pair({self.expression('float', 2)}, {self.expression('float', 2)})"
        self.locals["float"] += [name for name in (x, y) if name not in reals]
        return [line]

    def item(self) -> list[str]:
        if self.pick([True, False, False]):
            whole = f"self.wholes[{self.small()}] = {self.bounded()}"
            return [
                self.pick(
                    [
                        whole,
                        f"{self.given()} = {self.expression('float', 2)}",
                        f"{self.given()} -= {self.leaf('float')}",
                    ]
                )
            ]
        return [f"{self.pick(list(LISTS))}[{self.small()}] = {self.expression('float', 2)}"]

    def aliased(self) -> list[str]:
        if self.pick([True, False]):
            values = self.new_name("v")
            return [f"{values} = self.part.values", f"{values}[{self.small()}] += {self.expression('float', 1)}"]
        part = self.new_name("p")
        changes = [f"{part}.{self.pick(['x', 'y'])} = {self.expression('float', 2)}"]
        changes += [f"{part}.number = {self.leaf('int')}", f"{part}.turn = {self.leaf('way')}"]
        return [f"{part} = self.longer", self.pick(changes)]

    def again(self) -> list[str]:
        """Elements with the same index, which may change in between."""
        at = self.pick([*self.locals["int"], "self.i", "self.part.n", "self.k"])
        index = self.pick([at, at, f"{at} + 1", f"{at} - 1", f"3 * {at} + {self.pick(['0', '2', '3'])}"])
        elements = [f"self.rows[{index}]", *(f"{values}[{index}]" for values in LISTS)]
        element = lambda: self.pick(elements)  # noqa: E731
        real = lambda: self.expression("float", 1)  # noqa: E731
        lines = [f"{at} = {self.small()}", f"{element()} = {real()}"]
        for _ in range(self.pick([1, 2, 3])):
            lines += self.pick(
                [
                    [f"{element()} = {element()} * 0.5 + {element()}"],
                    [f"{element()} {self.pick(['+', '-', '/', '%'])}= {element()}"],
                    [f"self.on = {element()} > 0.5 {self.pick(['and', 'or'])} {element()} > {element()}"],
                    [f"self.on = self.try_move() {self.pick(['and', 'or'])} {element()} > 0.0"],
                    [f"self.x = {element()} if {self.expression('bool', 1)} else {element()}"],
                    [f"self.x = {element()} / {element()} if {element()} != 0.0 else {real()}"],
                    [f"self.note({element()})"],
                    [f"if {element()} < 1.0:", f"    {at} = {self.small()}", "else:", f"    {element()} = {element()}"],
                    [f"if {self.expression('bool', 1)}:", f"    {element()} += {element()}", f"self.note({element()})"],
                    [
                        "for _ in range(2):",
                        f"    self.note({element()})",
                        f"    self.x -= {element()}",
                        f"    {at} += 1",
                    ],
                    [f"while {at} < 2:", f"    {element()} += {element()}", f"    {at} += 1"],
                    [
                        "match self.m:",
                        "    case 1 | 2:",
                        f"        {element()} += {element()}",
                        f"self.note({element()})",
                    ],
                    ["self.i = self.count_call()"],
                    [f"{at} = {self.small()}"],
                    [
                        "var.copy(self.part, self.other)",
                        f"self.on = var.same(self.other, self.part) and {element()} > 0.5",
                    ],
                ]
            )
        return [*lines, f"self.note({element()})"]

    def divided(self) -> list[str]:
        """Divisions by the same number, which may be 0, may have been compared before, and may change in between."""
        kind = self.pick(["float", "float", "int"])
        n = self.pick([*self.locals[kind], "self.y" if kind == "float" else "self.i"])
        test = lambda: self.comparison(n)  # noqa: E731
        over = lambda: f"{self.leaf('float')} {self.pick(['/', '%'] if kind == 'float' else ['/'])} {n}"  # noqa: E731
        if kind == "int":
            over = lambda: self.pick([f"7.5 / {n}", f"float(self.m % {n})", f"float(self.m // {n})"])  # noqa: E731
        zero = "0.0" if kind == "float" else "0"
        lines = [f"{n} = {self.leaf(kind)}{' % 3 - 1' if kind == 'int' else ''}"]
        for _ in range(self.pick([1, 2, 3])):
            lines += self.pick(
                [
                    [f"self.x = {over()} - {over()}"],
                    [f"self.x = {over()} if {test()} else {over()}"],
                    [f"self.on = {test()} {self.pick(['and', 'or'])} {over()} > 1.0"],
                    [f"self.on = {test()} and self.try_move() and {over()} > 1.0"],
                    [f"if {test()} and self.try_move():", f"    self.x += {over()}"],
                    [f"if {test()}:", f"    self.x = {over()}", "else:", f"    self.note({over()})"],
                    [f"if {test()}:", f"    return {over()}"],
                    [f"if {test()}:", f"    {n} = {self.leaf(kind)}", f"elif {test()}:", f"    self.note({over()})"],
                    ["for _ in range(3):", f"    self.note({over()})", f"    {n} -= 1"],
                    [
                        f"while {test()}:",
                        f"    self.note({over()})",
                        f"    if {test()}:",
                        "        break",
                        f"    {n} = {zero}",
                    ],
                    [f"{n} = {self.leaf(kind)}"],
                    ["self.on = self.try_move()"],
                ]
            )
        return [*lines, f"self.note({over()})"] if self.pick([True, False]) else lines

    def comparison(self, n: str) -> str:
        limit, sign = self.pick(["0", "0.0", "0.0", "1", "2.5"]), self.pick(["<", "<=", ">", ">=", "==", "!="])
        test = self.pick([f"{n} {sign} {limit}", f"{limit} {sign} {n}", f"0.0 < {n} {sign} 2.5"])
        return str(self.pick([test, test, f"not {test}", f"({test} and self.f)", f"({test} or self.f)"]))

    def leave(self) -> list[str]:
        if self.pick([True, False]):
            return ["match self.notes % 3:", "    case 1:", f"        {self.pick(['break', 'continue'])}"]
        return [f"if {self.expression('bool', 2)}:", f"    {self.pick(['break', 'continue'])}"]

    def branch(self, depth: int, loop: bool) -> list[str]:
        lines = [f"if {self.expression('bool')}:", *self.body(depth - 1, loop)]
        for _ in range(self.pick([0, 0, 1, 2])):
            lines += ["# otherwise", f"elif {self.expression('bool', 2)}:", *self.body(depth - 1, loop)]
        if self.pick([True, False]):
            lines += ["else:", *self.body(depth - 1, loop)]
        if self.pick([True, False, False, False]):
            lines += [f"if {self.expression('bool', 2)}:", f"    return {self.expression('float', 2)}"]
        return lines

    def count(self, depth: int, loop: bool) -> list[str]:
        name = self.new_name("j")
        limits = self.pick(
            [
                f"({self.leaf('int')}) % 4",
                "len(self.part.values)",
                "len(self.reals)",
                "self.k % 4",
                "abs(self.i) % 4",
                "SIZE - 1",
                f"1, ({self.leaf('int')}) % 5",
                f"({self.leaf('int')}) % 5, -2, -1",
                "0, 7, 3",
                "SIZE",
            ]
        )
        self.counted.append(name)
        first = ["self.k += 1", "self.i -= 1", f"self.note(float({name}))", f"self.note({self.element(0, name)})"]
        body = [f"    {self.pick(first)}", *self.body(depth - 1, True)]
        self.counted.remove(name)
        return [f"for {name} in range({limits}):", *body]

    def repeat(self, depth: int, loop: bool) -> list[str]:
        name = self.new_name("w")
        test = self.pick([f"{name} < 4", f"{name} < 3 and {self.expression('bool', 2)}"])
        return [f"{name} = 0", f"while {test}:", f"    {name} += 1", *self.body(depth - 1, True)]

    def match(self, depth: int, loop: bool) -> list[str]:
        on_way = self.pick([True, False])
        lines = [f"match {self.leaf('way') if on_way else self.pick(['self.m % 4', *FIELDS['int']])}:"]
        values = ["Way.NONE", "Way.UP | Way.BACK"] if on_way else ["0", "1 | 2", "-1", "3"]
        for value in values:
            guard = f" if {self.expression('bool', 2)}" if self.pick([True, False, False]) else ""
            lines += textwrap.indent(
                "\n".join([f"case {value}{guard}:", *self.body(depth - 1, loop)]), "    "
            ).splitlines()
        if self.pick([True, False]):
            lines += textwrap.indent("\n".join(["case _:", *self.body(depth - 1, loop)]), "    ").splitlines()
        return lines

    def program(self) -> list[str]:
        lines: list[str] = []
        for kind, first in FIRST.items():
            name = self.new_name(kind[0])
            lines.append(f"{name} = {first}")
            self.locals[kind].append(name)
        for _ in range(self.pick([2, 3, 4, 6])):
            lines += self.statement(2, False)
        return [*lines, f"self.on = {self.expression('bool', 1)}", f"return {self.expression('float')}"]


def indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for line in lines]


@st.composite
def programs(draw: st.DrawFn) -> list[str]:
    """The lines of one program's body."""
    return Writer(lambda choices: draw(st.sampled_from(choices))).program()


def module(bodies: list[list[str]]) -> str:
    """The text of a module with the block `Programs`, of which `which` chooses the program that a step runs."""
    text = HEAD + "\n    def step(self, h: float) -> Refusal:\n        match self.which:\n"
    for i in range(len(bodies)):
        text += f"            case {i}:\n                self.x = self.program_{i}(h)\n"
    text += "            case _:\n                pass\n        return Refusal.NONE\n"
    for i, body in enumerate(bodies):
        text += f"\n    def program_{i}(self, h: float) -> float:\n" + textwrap.indent("\n".join(body), " " * 8) + "\n"
    return text + TAIL
