"""Modules that are checked against the rules of the kernel subset."""

from motionsync_fmu.compiler.subset.module_rules import check

PART = """
from dataclasses import dataclass

HALF = 1.0 / 2.0


@dataclass(slots=True)
class Part:
    position: float = 0.0

    def move(self, by: float) -> float:
        self.position += by
        return self.position


@dataclass(slots=True)
class Pair:
    first: float = 0.0


def clamp(x: float, low: float, high: float) -> float:
    return max(low, min(x, high))


def pair(x: float) -> tuple[float, int]:
    return x, 1


def total(values: list[float]) -> float:
    return values[0] + values[1]
"""


def find_violations(text: str) -> list[tuple[int, str]]:
    """The lines and rules that a module violates; it may import from `part.py`."""
    return [(violation.line, violation.rule) for violation in check({"module.py": text, "part.py": PART})]


def assert_only(text: str, line: int, rule: str) -> None:
    violations = find_violations(text)
    assert {at for at, _ in violations} == {line}, violations
    assert any(rule in sentence for _, sentence in violations), violations
