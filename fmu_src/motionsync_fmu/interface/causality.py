"""Which variables an FMU shows with another causality than the block declares."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from fnmatch import fnmatchcase
from typing import Any

from ..errors import UserError, choose
from .roles import remote_axis
from .variables import Variable, variables

SETPOINT = "slave.position"
IN_WORDS = {"input": "an input", "output": "an output", "parameter": "a parameter", "local": "a local variable"}
FORMER = {"input": "parameter", "parameter": "input", "output": "local", "local": "output"}  # what each can replace


class CausalityError(UserError):
    """A causality override that is refused.

    Attributes:
        causality: the one that a variable was to get.
        reason: why it cannot, in a sentence that names the variable or pattern.
    """

    def __init__(self, causality: str, reason: str) -> None:
        super().__init__(f"{causality}: {reason}")
        self.causality = causality
        self.reason = reason


@dataclass(frozen=True)
class Interface:
    """The variables that get another causality, by that causality: a name or shell pattern, or several.

    A tunable parameter may become an input, an input a parameter, which is tunable then, an output a local variable and
    a local variable an output. What has the causality already stays as it is.
    """

    input: str | Sequence[str] = ()
    output: str | Sequence[str] = ()
    parameter: str | Sequence[str] = ()
    local: str | Sequence[str] = ()

    def causalities(self, block: Any) -> dict[str, str]:
        """The new causality of each variable of a block that gets another one.

        Raises:
            CausalityError: no variable matches, a variable cannot get this causality, or would get two.
        """
        patterns = list(self.patterns())
        declared = {v.name: v for v in variables(block)} if patterns else {}  # to read them takes 10 ms
        axis = remote_axis(declared.values())
        causalities: dict[str, str] = {}
        for causality, pattern in patterns:
            for v in _matching_variables(declared, causality, pattern, type(block).__name__):
                if (other := causalities.setdefault(v.name, causality)) != causality:
                    raise CausalityError(causality, f"{v.name} already becomes {IN_WORDS[other]}")
                if reason := _refusal(v, causality, axis.part if axis else "master"):
                    raise CausalityError(causality, f"{v.name} cannot become {IN_WORDS[causality]}: {reason}")
        return {name: new for name, new in causalities.items() if new != declared[name].causality}

    def patterns(self) -> Iterator[tuple[str, str]]:
        """Each causality with each of its patterns."""
        for field in fields(self):
            given = getattr(self, field.name)
            yield from ((field.name, pattern) for pattern in ([given] if isinstance(given, str) else given))


def _matching_variables(declared: Mapping[str, Variable], causality: str, pattern: str, block: str) -> list[Variable]:
    """The variables of a block that a pattern names; there is at least one."""
    if matches := [v for name, v in declared.items() if fnmatchcase(name, pattern)]:
        return matches
    if near := [name for name in declared if fnmatchcase(name.lower(), pattern.lower())]:
        names = ", ".join(near[:3])
        raise CausalityError(causality, f"no variable of {block} is named {pattern!r}; did you mean {names}?")
    try:
        return [choose(declared, pattern, f"variable of {block}")]
    except UserError as e:
        raise CausalityError(causality, str(e)) from None


def _refusal(v: Variable, causality: str, axis: str) -> str:
    """Why a variable cannot get this causality; empty if it can. `axis`: the part that is the leading axis."""
    former = FORMER[causality]
    reasons = (
        (v.causality == causality, ""),
        (v.causality != former, f"it is {IN_WORDS[v.causality]}, and only {IN_WORDS[former]} can"),
        (v.variability == "fixed", "it is fixed, since the initialization alone reads it"),
        (v.declaration.command, "it is a command, whose edge acts during a run"),
        (causality == "parameter" and v.name.startswith(f"{axis}."), "it is a signal of the axis that leads"),
        (v.name == SETPOINT, "it is the setpoint, the purpose of the FMU"),
    )
    return next((reason for applies, reason in reasons if applies), "")
