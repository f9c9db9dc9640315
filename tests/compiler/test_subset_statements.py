"""The kernel subset: every rule for statements and expressions refuses what breaks it, with file and line."""

import textwrap

import pytest

from tests.support.compiler.kernel_rules import find_violations

HEAD = '''"""A module."""
import math
from dataclasses import dataclass
from math import isfinite, sin

from . import var
from .var import Enumeration
from .part import Pair, Part, clamp, pair, total


class State(Enumeration):
    IDLE = 1, "at rest"
    RUN = 2, "moving", "ratio"


@dataclass(slots=True)
class Track:
    times: var.Reals = var.series()


@dataclass(slots=True)
class Block:
    part: Part = var.part(Part)
    other: Part = var.part(Part)
    pair: Pair = var.part(Pair)
    ratio: float = var.parameter(1.0, "a ratio", tunable=True)
    state: State = var.output(State.IDLE, "the state")
    count: int = 0
    on: bool = False
    values: list[float] = var.array(4)
    more: list[float] = var.array(5)
    track: Track = var.part(Track)
    times: var.Reals = var.series()
    numbers: var.Wholes = var.series()

    def index(self) -> int:
        self.count += 1
        return self.count

    def apply(self, x: float, n: int) -> float:
'''


# The body of `Block.apply`; the line that breaks the rule ends with `# !`.
STATEMENTS = [
    ("x = x ** 2  # !", "no `**`"),
    ("x **= 2.0  # !", "no `**`"),
    ("x = pow(x, 2.0)  # !", "no pow"),
    ("x = math.pow(x, 2.0)  # !", "no pow"),
    ("x = math.cos(x)  # !", "math.cos is not called"),
    ("x = math.ceil(x)  # !", "math.ceil is not called"),
    ("x = sin(x)  # !", "math.sin is not called"),
    ("n = n << 2  # !", "operators are"),
    ("n |= 4  # !", "operators are"),
    ("n = ~n  # !", "no bit operators"),
    ("print(x)  # !", "are called"),
    ("self.values.append(x)  # !", "are called"),
    ("n = sum(self.values)  # !", "are called"),
    ("x = max(self.values)  # !", "are called"),
    ("x = round(x, 3)  # !", "round takes one argument"),
    ("x = clamp(x, 0.0, high=1.0)  # !", "arguments are positional"),
    ("self.missing()  # !", "are called"),
    ("n = var.input(1, 'n')  # !", "var.input is not called"),
    ("var.copy(self.part, self.pair)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.part, x)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(x, x)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(n, n)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.state, self.state)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.values, self.values)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.part)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.part, self.other, self.part)  # !", "var.copy takes two parts of the same class"),
    ("var.copy(self.part, source=self.other)  # !", "arguments are positional"),
    ("self.on = var.same(self.part, self.pair)  # !", "var.same takes two parts of the same class"),
    ("self.on = var.same(self.values, self.values)  # !", "var.same takes two parts of the same class"),
    ("self.on = var.same(self.part)  # !", "var.same takes two parts of the same class"),
    ("var.copy_valid(self.part, self.pair)  # !", "var.copy_valid takes two parts of the same class"),
    ("n = var.first_invalid(self.part, self.part)  # !", "var.first_invalid takes a part"),
    ("n = var.first_invalid(x)  # !", "var.first_invalid takes a part"),
    ("x = self.part.move(x) + float(var.same(self.part, self.other))  # !", "write two statements"),
    ("self.on = self.part == self.other  # !", "parts are compared with var.same"),
    ("self.on = n == 1 != self.values  # !", "lists element by element"),
    ("part = Part()  # !", "no allocation"),
    ("name = 'slave'  # !", "no strings"),
    ("name = f'{n}'  # !", "no strings"),
    ("list = [x, x]  # !", "no lists"),
    ("table = {n: x}  # !", "no lists, dicts"),
    ("group = {n}  # !", "no lists, dicts or sets"),
    ("list = [x for i in range(3)]  # !", "no comprehension"),
    ("x = max(x for i in range(3))  # !", "no generator"),
    ("f = lambda: 1.0  # !", "no function or class inside"),
    ("def f() -> None:  # !\n    pass", "no function or class inside"),
    ("class C:  # !\n    pass", "no function or class inside"),
    ("found = None  # !", "no `None`"),
    ("try:  # !\n    x = 1.0\nexcept ValueError:\n    pass", "no exceptions"),
    ("raise ValueError  # !", "no exceptions"),
    ("assert x > 0.0  # !", "no exceptions"),
    ("with self.part:  # !\n    pass", "no with"),
    ("yield x  # !", "no with, yield"),
    ("global HALF  # !", "no global"),
    ("nonlocal HALF  # !", "nonlocal"),
    ("del x  # !\nx = 1.0", "or del"),
    ("import math  # !", "imports are at module level"),
    ("if self.state is State.RUN:  # !\n    x = 1.0", "no `is`"),
    ("if self.state is not State.RUN:  # !\n    x = 1.0", "no `is`"),
    ("if x in self.values:  # !\n    x = 1.0", "`in` searches a tuple"),
    ("if self.state in [State.RUN]:  # !\n    x = 1.0", "`in` searches a tuple"),
    ("self.state = State(n)  # !", "never converted"),
    ("n = self.state.value  # !", "its name, value"),
    ("n = State.RUN.value  # !", "its name, value"),
    ("state = self.state\nn = state.description  # !", "its name, value"),
    ("if self.state:  # !\n    x = 1.0", "no truth value"),
    ("while self.state:  # !\n    x = 1.0", "no truth value"),
    ("on = not self.state  # !", "no truth value"),
    ("on = self.on and self.state  # !", "no truth value"),
    ("x = 1.0 if self.state else 2.0  # !", "no truth value"),
    ("state = State.RUN if self.on else self.state\nif state:  # !\n    x = 1.0", "no truth value"),
    ("if self.part:  # !\n    x = 1.0", "no truth value"),
    ("for i in range(n):\n    i = 2  # !", "loop variable i is not reassigned"),
    ("for i in range(n):\n    i += 1  # !", "loop variable i is not reassigned"),
    ("for i in range(n):\n    for i in range(n):  # !\n        x = 1.0", "loop variable i is not reassigned"),
    ("for i in range(n):\n    pass\nn = i  # !", "loop variable i is not used after"),
    ("i = 0\nfor i in range(n):\n    pass\nn = i  # !", "loop variable i is not used after"),
    (
        "i = 0\nwhile x < 1.0:\n    n = i  # !\n    for i in range(n):\n        x = 2.0",
        "loop variable i is not used after",
    ),
    ("for x in self.values:  # !\n    pass", "over range"),
    ("for i in range(n):\n    pass\nelse:\n    x = 1.0  # !", "no else"),
    ("n %= 3  # !", "no `%=`"),
    ("self.count %= 3  # !", "no `%=`"),
    ("self.part = self.other  # !", "never rebound"),
    ("self.values = self.values  # !", "never rebound"),
    ("both = self.values + self.values  # !", "whole lists"),
    ("if self.on:\n    y = 1.0\nx = y  # !", "y may be unbound"),
    ("while x < 1.0:\n    x = y = 2.0\nx = y  # !", "y may be unbound"),
    ("for _ in range(n):\n    y = x\nx = y  # !", "y may be unbound"),
    ("match n:\n    case 1:\n        y = 1.0\n    case 2:\n        y = 2.0\nx = y  # !", "y may be unbound"),
    ("while True:\n    if self.on:\n        break\n    y = 1.0\n    break\nx = y  # !", "y may be unbound"),
    ("y += x  # !", "y may be unbound"),
    ("y: float\nx = y  # !", "y may be unbound"),
    ("x = unknown  # !", "neither a local nor a constant"),
    ("f = clamp  # !", "neither a local nor a constant"),
    ("x = math.sqrt  # !", "neither a local nor a constant"),
    ("if (y := x) > 0.0:  # !\n    x = 1.0", "no assignment inside"),
    ("both = x, x  # !", "a tuple is only returned"),
    ("x, y = y, x  # !", "a tuple is only returned"),
    ("both = pair(x)  # !", "a tuple is only returned"),
    ("x = pair(x)[0]  # !", "a tuple is only returned"),
    ("self.ratio, m = pair(x)  # !", "a tuple is only returned"),
    ("both = x, m = pair(x)  # !", "a tuple is only returned"),
    ("x, *rest = pair(x)  # !", "a tuple is only returned"),
    ("x = clamp(*self.values)  # !", "no star"),
    ("part = self.values[1:]  # !", "no slices"),
    ("y: str = x  # !", "a local is a float"),
    ("match x:  # !\n    case _:\n        pass", "match and its patterns"),
    ("match n:\n    case m:  # !\n        pass", "match and its patterns"),
    ("match n:\n    case None:  # !\n        pass", "match and its patterns"),
    ("match self.part:  # !\n    case Part():  # !\n        pass", "match and its patterns"),
    ("match n:\n    case 1.5:  # !\n        pass", "match and its patterns"),
    ("x = x // 2.0  # !", "no `//` of floats"),
    ("x //= 2.0  # !", "no `//` of floats"),
    ("if self.on and n:  # !\n    x = 1.0", "and, or join Booleans only"),
    ("n = n or 3  # !", "and, or join Booleans only"),
    ("y = 1.0\ny = 2  # !", "y has one kind: float or int"),
    ("m = 1\nm = self.state  # !", "m has one kind: int or State"),
    ("m = 1\nm += 0.5  # !", "m has one kind: int or float"),
    ("self.ratio = 2  # !", "write 1.0, or float(n)"),
    ("self.values[0] = n  # !", "write 1.0, or float(n)"),
    ("y: float = self.on  # !", "write 1.0, or float(n)"),
    ("x = clamp(x, 0, 1.0)  # !", "write 1.0, or float(n)"),
    ("x = self.part.move(n)  # !", "write 1.0, or float(n)"),
    ("x = 0 if self.on else 1.5  # !", "write 1.0, or float(n)"),
    ("x = max(x, 0)  # !", "write 1.0, or float(n)"),
    ("return n  # !", "write 1.0, or float(n)"),
    ("part = self.part if self.on else self.other  # !\npart.position = x", "chosen by its name alone"),
    ("part = self.part\npart = self.other  # !\npart.position = x", "part names an object, and is assigned once"),
    ("x = self.part.move(x) + self.part.position  # !", "write two statements"),
    ("self.part.position += self.part.move(x)  # !", "write two statements"),
    ("x = clamp(self.part.move(x), self.part.position, x)  # !", "write two statements"),
    ("self.values[self.index()] = self.values[self.index()]  # !", "write two statements"),
    ("if 0.0 < self.part.move(x) < 1.0:  # !\n    x = 1.0", "in the middle of a chain"),
    ("if self.index() in (1, 2):  # !\n    x = 1.0", "`in` searches plain values"),
    ("if n in (1, int(clamp(x, 0.0, 9.0))):  # !\n    x = 1.0", "`in` searches plain values"),
    ("match n:\n    case 1 if self.index() > 0:  # !\n        x = 1.0", "a guard changes nothing"),
    ("match self.index():  # !\n    case 1 if n > 2:\n        x = 1.0", "no call is matched"),
    (
        "for _ in range(n):\n    match self.index():  # !\n        case 1:\n            break",
        "no call is matched",
    ),
    ("self.count = m = self.index()  # !", "several targets are assigned together only if"),
    ("m = self.values[m] = 1.0  # !", "several targets are assigned together only if"),
    ("self.ratio = self.ratio = x  # !", "several targets are assigned together only if"),
    ("x = total(self.values) + total(self.more)  # !", "lists of the same length"),
    ("times = self.times  # !\nx = times[0]", "a series is a field"),
    ("self.times = self.track.times  # !", "a series is a field"),
    ("x = total(self.times)  # !", "a series is a field"),
    ("x = self.times + 1.0  # !", "a series is a field"),
    ("var.copy(self.track, self.track)  # !", "a series is a field"),
    ("self.on = var.same(self.track, self.track)  # !", "a series is a field"),
    ("m = self.numbers[0]\nself.ratio = self.numbers[m]  # !", "an integer becomes a float"),
    ("for i in range(3, 0, n):  # !\n    x = 1.0", "the step of a range is a whole number, not 0"),
    ("for i in range(3, 0, 0):  # !\n    x = 1.0", "the step of a range is a whole number, not 0"),
]


@pytest.mark.parametrize(("body", "rule"), STATEMENTS)
def test_a_statement_outside_the_subset_is_named_with_its_line(body: str, rule: str) -> None:
    text = HEAD + textwrap.indent(body + "\nreturn 0.0\n", " " * 8)
    lines = {at for at, line in enumerate(text.splitlines(), 1) if line.endswith("# !")}
    violations = find_violations(text)
    assert {at for at, _ in violations} == lines, violations
    assert any(rule in sentence for _, sentence in violations), violations


def test_the_frame_of_the_statement_tests_is_inside_the_subset() -> None:
    assert find_violations(HEAD + " " * 8 + "return 0.0\n") == []


def test_a_block_of_another_package_may_import_the_declarations() -> None:
    text = HEAD.replace("from . import var", "from motionsync import var").replace("from .var", "from motionsync.var")
    assert find_violations(text + " " * 8 + "return 0.0\n") == []
