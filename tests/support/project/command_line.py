"""The outcome of a command of the command line, and a check of its message about a mistake."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """The exit status and both streams of a command."""

    status: int
    out: str
    err: str


Command = Callable[..., Outcome]


def assert_one_line(outcome: Outcome, *parts: str) -> None:
    """A mistake of the user: exit status 2, one line with all these parts, nothing else."""
    assert outcome.status == 2, outcome
    assert outcome.err.count("\n") == 1, outcome.err
    assert outcome.err.startswith("motionsync: ")
    for part in parts:
        assert part in outcome.err
    assert outcome.out == ""
