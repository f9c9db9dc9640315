"""Which variables an FMU shows with another causality than the block declares."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from fnmatch import fnmatchcase
from typing import Any

from ..errors import UserError, choose
from .roles import remote_axis
from .variables import Variable, variables

SETPOINT = "slave.position"
NAMES = {"input": "an input", "output": "an output", "parameter": "a parameter", "local": "a local variable"}
FROM = {"input": "parameter", "parameter": "input", "output": "local", "local": "output"}  # what may be turned to each


class TurnError(UserError):
    """A turn that is refused.

    Attributes:
        causality: the one to which a variable was to be turned.
        reason: why not, in a sentence that names the variable or pattern.
    """

    def __init__(self, causality: str, reason: str) -> None:
        super().__init__(f"{causality}: {reason}")
        self.causality = causality
        self.reason = reason


@dataclass(frozen=True)
class Interface:
    """The variables that are turned, by their new causality: a name or shell pattern, or several.

    A tunable parameter may be turned to an input, an input to a parameter, which is tunable then, an output to a local
    variable and a local variable to an output. What has the causality already stays as it is.
    """

    input: str | Sequence[str] = ()
    output: str | Sequence[str] = ()
    parameter: str | Sequence[str] = ()
    local: str | Sequence[str] = ()

    def causalities(self, block: Any) -> dict[str, str]:
        """The new causality of each variable of a block that is turned.

        Raises:
            TurnError: no variable matches, a variable cannot be turned so, or is turned to two causalities.
        """
        patterns = list(self.patterns())
        declared = {v.name: v for v in variables(block)} if patterns else {}  # to read them takes 10 ms
        axis = remote_axis(declared.values())
        found: dict[str, str] = {}
        for causality, pattern in patterns:
            for v in _matching(declared, causality, pattern, type(block).__name__):
                if (other := found.setdefault(v.name, causality)) != causality:
                    raise TurnError(causality, f"{v.name} is already turned to {NAMES[other]}")
                if why := _refusal(v, causality, axis.part if axis else "master"):
                    raise TurnError(causality, f"{v.name} cannot become {NAMES[causality]}: {why}")
        return {name: causality for name, causality in found.items() if causality != declared[name].causality}

    def patterns(self) -> Iterator[tuple[str, str]]:
        """Each causality with each of its patterns."""
        for field in fields(self):
            given = getattr(self, field.name)
            yield from ((field.name, pattern) for pattern in ([given] if isinstance(given, str) else given))


def _matching(declared: Mapping[str, Variable], causality: str, pattern: str, block: str) -> list[Variable]:
    """The variables of a block, of which there is at least one, that a pattern names."""
    if found := [v for name, v in declared.items() if fnmatchcase(name, pattern)]:
        return found
    if near := [name for name in declared if fnmatchcase(name.lower(), pattern.lower())]:
        raise TurnError(causality, f"no variable of {block} is named {pattern!r}; did you mean {', '.join(near[:3])}?")
    try:
        return [choose(declared, pattern, f"variable of {block}")]
    except UserError as e:
        raise TurnError(causality, str(e)) from None


def _refusal(v: Variable, causality: str, axis: str) -> str:
    """Why a variable cannot be turned so; empty if it can. `axis`: the part of the block with the axis that leads."""
    reasons = (
        (v.causality == causality, ""),
        (v.causality != FROM[causality], f"it is {NAMES[v.causality]}, and only {NAMES[FROM[causality]]} can"),
        (v.variability == "fixed", "it is fixed, since the initialization alone reads it"),
        (v.declaration.command, "it is a command, whose edge acts during a run"),
        (causality == "parameter" and v.name.startswith(f"{axis}."), "it tells where the axis is that leads"),
        (v.name == SETPOINT, "it is the setpoint, for which the FMU is there"),
    )
    return next((why for applies, why in reasons if applies), "")
