"""The kernel subset: every rule for modules and classes refuses what breaks it, and the model is inside."""

import textwrap
from importlib.resources import files

import pytest

from motionsync_fmu.compiler.subset.expression_rules import Violation
from motionsync_fmu.compiler.subset.module_rules import check
from tests.support.compiler.kernel_rules import PART, assert_only, find_violations

IMPORTS = "from dataclasses import dataclass\nfrom . import var\nfrom .var import Enumeration\n"
CLASS = "@dataclass(slots=True)\nclass Block:\n"
INTERFACE = (  # two interfaces; the line after it is line 13
    IMPORTS
    + "@dataclass(slots=True)\nclass Interface:\n    a: float = var.input(0.0, 'a')\n"
    + "@dataclass(slots=True)\nclass Other:\n    b: float = var.input(0.0, 'b')\n"
    + "@dataclass(slots=True)\nclass Longer(Interface):\n    def f(self) -> None: pass\n"
)
MODULES = [
    ("import os", 1, "imports only math"),
    ("import math as m, sys", 1, "imports only math"),
    ("from typing import Final", 1, "imports only math"),
    ("from __future__ import annotations", 1, "imports only math"),
    ("from dataclasses import field", 1, "imports only math"),
    ("from math import *", 1, "imports only math"),
    ("from . import part", 1, "imports only math"),
    ("if True:\n    import math", 1, "at module level are only"),
    ("try:\n    import math\nexcept ImportError:\n    pass", 1, "at module level are only"),
    ("print(1)", 1, "at module level are only"),
    ("for i in range(3):\n    pass", 1, "at module level are only"),
    ("A = B = 1.0", 1, "at module level are only"),
    ("A: str = 1.0", 1, "at module level are only"),
    ("NAME = 'name'", 1, "no strings"),
    ("TABLE = (1.0, 2.0)", 1, "a tuple is only"),
    ("TABLE = [1.0, 2.0]", 1, "no lists"),
    ("A = 2.0 ** 3", 1, "no `**`"),
    ("import math\nA = math.cos(1.0)", 2, "calls nothing but math.sqrt"),
    ("A = max(1.0, 2.0)", 1, "calls nothing but math.sqrt"),
    (IMPORTS + "class State(Enumeration):\n    IDLE = 1", 5, "an enumeration holds only members"),
    (IMPORTS + "class State(Enumeration):\n    IDLE = 1.5, 'rests'", 5, "an enumeration holds only members"),
    (
        IMPORTS + "class State(Enumeration):\n    A = 1, 'a'\n    def f(self) -> int:\n        return 1",
        6,
        "holds only members",
    ),
    ("class Block:\n    x: float = 0.0", 1, "@dataclass(slots=True)"),
    (IMPORTS + "@dataclass\nclass Block:\n    x: float = 0.0", 5, "@dataclass(slots=True)"),
    (
        IMPORTS + "@dataclass(slots=True)\nclass Block(Unknown):\n    x: float = var.local(0.0, 'x')",
        5,
        "derives from one",
    ),
    (IMPORTS + CLASS + "    x = 1.0", 6, "only typed fields and methods"),
    (IMPORTS + CLASS + "    x: float", 6, "has a start value"),
    (IMPORTS + CLASS + "    x: float = 0", 6, "starts with a value of its own type"),
    (IMPORTS + CLASS + "    x: float = var.input(0, 'x')", 6, "starts with a value of its own type"),
    (IMPORTS + CLASS + "    n: int = 1.0", 6, "starts with a value of its own type"),
    (IMPORTS + CLASS + "    n: bool = 0", 6, "starts with a value of its own type"),
    (IMPORTS + CLASS + "    n: int = field(default=1)", 6, "calls nothing but math.sqrt"),
    (IMPORTS + CLASS + "    name: str = 'x'", 6, "a field is a float"),
    (IMPORTS + CLASS + "    x: 'float' = 0.0", 6, "a field is a float"),
    (IMPORTS + CLASS + "    x: float | None = None", 6, "a field is a float"),
    (IMPORTS + CLASS + "    x: tuple[float, float] = (0.0, 0.0)", 6, "a field is a float"),
    (IMPORTS + CLASS + "    x: list[int] = var.array(3)", 6, "a field is a float"),
    (IMPORTS + CLASS + "    x: list[float] = [0.0]", 6, "made with its owner"),
    ("from .part import Part\n" + IMPORTS + CLASS + "    x: Part = Part()", 7, "made with its owner"),
    (IMPORTS + CLASS + "    x: float = 0.0\n    def x(self) -> None:\n        pass", 7, "has the name of a field"),
    (IMPORTS + CLASS + "    def x(self) -> None:\n        pass\n    x: float = 0.0", 6, "has the name of a field"),
    (
        "from .part import Part\n" + IMPORTS + "@dataclass(slots=True)\nclass Block(Part):\n    x: float = 0.0",
        7,
        "nothing but declared fields",
    ),
    (
        "from .part import Part\n"
        + IMPORTS
        + "@dataclass(slots=True)\nclass Block(Part):\n    def f(self) -> None:\n        pass",
        7,
        "nothing but declared fields",
    ),
    (
        "from .part import Pair, Part\n"
        + IMPORTS
        + "@dataclass(slots=True)\nclass Block(Part, Pair):\n    x: float = var.local(0.0, 'x')",
        6,
        "derives from one kernel dataclass at most",
    ),
    (
        INTERFACE + "@dataclass(slots=True)\nclass Both(Interface, Other):\n    x: float = var.local(0.0, 'x')",
        14,
        "derives from one kernel dataclass at most",
    ),
    (
        INTERFACE + "@dataclass(slots=True)\nclass Block(Longer):\n    y: float = 0.0",
        15,
        "nothing but declared fields",
    ),
    (IMPORTS + CLASS + "    @staticmethod\n    def f(x: float) -> float:\n        return x", 7, "no decorators"),
    ("def f(x: float = 1.0) -> float:\n    return x", 1, "parameters are positional"),
    ("def f(*x: float) -> float:\n    return 1.0", 1, "parameters are positional"),
    ("def f(**x: float) -> float:\n    return 1.0", 1, "parameters are positional"),
    ("def f(*, x: float) -> float:\n    return x", 1, "parameters are positional"),
    ("def f(x: float, /) -> float:\n    return x", 1, "parameters are positional"),
    ("def f(x) -> float:\n    return 1.0", 1, "a parameter is a float"),
    ("def f(x: float) -> float:\n    return f(x)", 1, "does not call itself"),
    (
        "from .part import Part\ndef f(part: Part) -> Part:\n    return part",
        2,
        "is never returned",
    ),
    ("def f(x: str) -> float:\n    return 1.0", 1, "a parameter is a float"),
    ("def f(x: float):\n    return x", 1, "declares what it returns"),
    (
        "def f(x: float) -> tuple[float, str]:\n    return g(x)\ndef g(x: float) -> float:\n    return x",
        1,
        "declares what it",
    ),
    ("from . import var\ndef f(x: var.Reals) -> float:\n    return 1.0", 2, "a parameter is a float"),
    (IMPORTS + "@dataclass(slots=True)\nclass Block:\n    x: var.Reals = var.array(3)", 6, "a series is made by"),
    ("def f(x: float) -> float:\n    if x > 0.0:\n        return x", 1, "every path returns"),
    ("async def f() -> None:\n    pass", 1, "at module level are only"),
    ("def f(n: int) -> int:\n    return range", 2, "neither a local nor a constant"),
]


@pytest.mark.parametrize(("text", "line", "rule"), MODULES)
def test_a_declaration_outside_the_subset_is_named_with_its_line(text: str, line: int, rule: str) -> None:
    assert_only(text + "\n", line, rule)


INSIDE = {
    "constants": """
        import math
        from .part import HALF
        EPSILON = 1e-9
        SEVEN = 7.0 / 8.0 * HALF
        ROOT: float = -math.sqrt(3.0)
        FAR = math.inf
        COUNT = 3

        def f() -> float:
            return EPSILON + SEVEN * ROOT if isfinite_count(COUNT) else FAR

        def isfinite_count(n: int) -> bool:
            return math.isfinite(float(n)) and math.fmod(1.0 * n, 2.0) == 0.0
    """,
    "enumeration and its uses": """
        from dataclasses import dataclass
        from . import var
        from .var import Enumeration

        class State(Enumeration):
            \"\"\"What it does.\"\"\"
            OFF = -1, "off"
            ON = 2, "on", "ratio", "length"

        @dataclass(slots=True)
        class Block:
            state: State = State.OFF
            state_code: int = var.output(State.OFF, "the same")
            first: bool = True

            def step(self, other: "Block") -> State:
                match self.state:
                    case State.OFF | State.ON if self.first:
                        pass
                    case _:
                        self.state = State.ON
                if self.state in (State.OFF, State.ON) and not self.first and State.OFF < other.state != State.ON:
                    self.state_code = other.state
                return State.ON if self.first else self.state
    """,
    "a copy of a part": """
        from dataclasses import dataclass
        from . import var
        from .part import Part

        @dataclass(slots=True)
        class Block:
            part: Part = var.part(Part)
            stored: Part = var.part(Part)

            def keep(self, other: Part) -> None:
                var.copy(self.stored, self.part)
                var.copy(self.part, other)
                var.copy(other, other)

            def is_current(self, other: Part) -> bool:
                return var.same(self.stored, other) and not var.same(other, self.part)

            def try_take(self, other: Part) -> int:
                var.copy_valid(self.stored, other)
                return var.first_invalid(other)
    """,
    "a block over its interface": """
        from dataclasses import dataclass
        from . import var
        from .part import Part

        @dataclass(slots=True)
        class Master:
            position: float = var.input(0.0, "where the master is")

        @dataclass(slots=True)
        class Interface(Master):
            \"\"\"What the block shows.\"\"\"
            part: Part = var.part(Part)
            speed: float = var.output(0.0, "how fast")

        @dataclass(slots=True)
        class Block(Interface):
            \"\"\"What it does.\"\"\"
            before: float = 0.0
            edges: list[float] = var.array(2)

            def step(self, h: float) -> float:
                self.speed = (self.part.move(self.position) - self.before) / h
                self.before = self.part.position
                return self.speed
    """,
    "an inheriting dataclass": """
        from dataclasses import dataclass
        from . import var
        from .part import Part

        @dataclass(slots=True)
        class Longer(Part):
            \"\"\"A part that shows more.\"\"\"
            length: float = var.local(0.0, "how long")

        def use(part: Longer) -> float:
            moved = part.move(part.length)
            return moved + part.position
    """,
    "tuples": """
        from .part import pair

        def f(x: float) -> tuple[float, int]:
            y, n = pair(x)
            y %= 1.0
            return pair(y * n)
    """,
    "loops": """
        def f(values: list[float], n: int) -> float:
            total = 0.0
            for i in range(len(values)):
                if values[i] < 0.0:
                    continue
                total += values[i]
            for i in range(1, n, 2):
                at = (i + 1) % len(values)
                values[at] = total
            i = 7
            while True:
                i -= 1
                half = i // 2
                if half == 0:
                    break
            return total + half
    """,
    "bound on every path": """
        def f(x: float, n: int) -> float:
            if x > 0.0:
                y = abs(x)
            elif n > 1:
                return min(x, 0.0, 1.0)
            else:
                y = float(round(x))
            match n:
                case 1 | -2:
                    z = int(y)
                case _:
                    z = n
            a = b = z
            return y + a * b
    """,
}


@pytest.mark.parametrize("text", INSIDE.values(), ids=INSIDE.keys())
def test_plain_scalar_code_is_inside_the_subset(text: str) -> None:
    assert find_violations(textwrap.dedent(text)) == []


def test_functions_that_call_each_other_in_a_circle_are_named() -> None:
    text = "def f(x: float) -> float:\n    return g(x)\n\ndef g(x: float) -> float:\n    return f(x)\n"
    assert {line for line, _ in find_violations(text)} == {1, 4}


def test_a_violation_reads_file_line_rule() -> None:
    assert str(Violation("axis.py", 3, "no strings in kernel code")) == "axis.py:3: no strings in kernel code"
    assert [str(violation) for violation in check({"a/b.py": "A = 'x'\n"})] == ["a/b.py:1: no strings in kernel code"]


def test_names_are_followed_into_other_folders_of_the_package() -> None:
    law = "from ..part import Part\n\ndef f(part: Part) -> None:\n    part.position = part.move(1.0)\n    part.fly()\n"
    assert [(v.file, v.line) for v in check({"saw/law.py": law, "part.py": PART})] == [("saw/law.py", 5)]


def test_names_are_followed_through_a_package() -> None:
    package = {"saw/__init__.py": "from .law import Law\n", "saw/law.py": PART.replace("class Part", "class Law")}
    text = "from .saw import Law\n\ndef f(law: Law) -> None:\n    law.position = law.move(1.0)\n    law.fly()\n"
    assert [(v.file, v.line) for v in check(package | {"use.py": text})] == [("use.py", 5)]


LAW = """
from dataclasses import dataclass

from .. import var
from ..var import Enumeration, Unit
from .part import Part, clamp


class Way(Enumeration):
    UP = 1, "up", *NAMES


@dataclass(slots=True)
class Law:
    part: Part = var.part(Part)
    x: float = var.output(0.0, "x", Unit.POSITION)
    way: Way = Way.UP

    def step(self) -> float:
        return clamp(self.part.move(1.0), 0.0, self.x)
"""


def test_a_module_of_a_package_keeps_to_the_same_rules() -> None:
    text = LAW.replace("\n\nclass Way", '\nNAMES = ("x", ".y")\n\nclass Way')
    files = {"saw/law.py": text, "saw/part.py": PART, "saw/__init__.py": "NAMES = ['exempt']\n"}
    assert check(files) == []
    assert check({"saw/var.py": "NAMES = ['x']\n", "saw/blocks.py": "NAMES = ['x']\n"}) != []


@pytest.mark.parametrize("line", ["from ... import var", "from ...part import Part", "from . import var"])
def test_an_import_from_outside_the_package_is_named(line: str) -> None:
    (violation,) = check({"saw/law.py": f"{line}\n", "part.py": PART})
    assert str(violation).startswith("saw/law.py:1: a kernel module imports only")


def test_names_of_variables_are_for_enumerations_only() -> None:
    text = "NAMES = ('x', 'y')\n\ndef f(n: int) -> int:\n    return g(NAMES)\n\ndef g(n: int) -> int:\n    return n\n"
    assert [(v.line, v.rule) for v in check({"a.py": text})] == [(4, "no strings in kernel code")]


def test_a_constant_may_come_from_the_declarations() -> None:
    text = "from .var import LARGEST, f\n\ndef g() -> float:\n    x = LARGEST\n    return x + f()\n"
    declarations = "LARGEST = 1e12\n\ndef f():\n    return 'x'\n"
    assert [violation.line for violation in check({"a.py": text, "var.py": declarations})] == [5]


@pytest.mark.parametrize("file", ["__init__.py", "var.py", "blocks.py"])
def test_modules_that_are_never_compiled_are_exempt(file: str) -> None:
    assert check({file: "NAMES = ['x']\n"}) == []


def test_text_that_is_not_python_is_an_error_with_file_and_line() -> None:
    with pytest.raises(SyntaxError) as error:
        check({"axis.py": "A = 1.0\nB = (\n"})
    assert (error.value.filename, error.value.lineno) == ("axis.py", 2)


def test_the_model_is_inside_the_subset() -> None:
    package = files("motionsync")
    sources = {}
    folders = [("", package)]
    for prefix, folder in folders:
        for entry in folder.iterdir():
            if entry.is_dir():
                folders.append((f"{prefix}{entry.name}/", entry))
            elif entry.name.endswith(".py"):
                sources[prefix + entry.name] = entry.read_text(encoding="utf-8")
    assert {"__init__.py", "var.py"} < sources.keys()
    assert [str(violation) for violation in check(sources)] == []
