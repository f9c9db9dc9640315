"""What a scenario sets during a run: at given times, and as reactions to outputs of the block."""

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {"==": operator.eq, "<": operator.lt, ">": operator.gt}


@dataclass(frozen=True)
class Setting:
    """Variables that are set at a time, in s."""

    at: float
    values: Mapping[str, Any]


@dataclass(frozen=True)
class OutputCondition:
    """A comparison of an output or local variable with a value.

    Attributes:
        text: the condition as the file has it.
        comparison: a key of COMPARISONS.
    """

    text: str
    name: str
    comparison: str
    value: float


@dataclass(frozen=True)
class Reaction:
    """What is set when a condition becomes true.

    Attributes:
        after: how long after the scan that saw it, in s.
        set: the values of variables.
        add: what is added to the present values of variables.
        times: how often it reacts at most; None: each time the condition becomes true.
        required: the run is not as expected if it reacts less often, or never where `times` is None.
    """

    condition: OutputCondition
    after: float = 0.0
    set: Mapping[str, Any] = field(default_factory=dict)
    add: Mapping[str, Any] = field(default_factory=dict)
    times: int | None = 1
    required: bool = False

    @property
    def least(self) -> int:
        """How often it has to react so that nothing is missing."""
        return 1 if self.times is None else self.times


@dataclass(frozen=True)
class UnmetReaction:
    """A reaction that happened less often than it could have: `happened` times."""

    reaction: Reaction
    happened: int

    @property
    def expected(self) -> str:
        """How often it should have happened, in words."""
        least = self.reaction.least
        often = "at least once" if self.reaction.times is None else "once" if least == 1 else f"{least} times"
        return f"reaction to {self.reaction.condition.text} {often}"

    @property
    def actual(self) -> str:
        """How often it happened, in words."""
        return {0: "never", 1: "once"}.get(self.happened, f"{self.happened} times")
