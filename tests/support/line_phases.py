"""Lines whose acceleration changes now and then, with commands, for tests of machines that cut to length."""

from dataclasses import dataclass, field
from random import Random
from typing import Any, Protocol, Self

from hypothesis import Phase as Generation
from hypothesis import strategies as st

from motionsync.master import MasterInput
from tests.support.harness import Row

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
COMMANDS = ("cut_now", "take_sample", "abort", "stop", "start", "order.add", "order.skip")
LENGTH, DURATION = 1000.0, 1.0  # of a piece, u; about the time in which it passes, s
LINE = LENGTH / DURATION

# A failing run is reported as it was drawn: what is drawn is a seed.
GENERATIONS = [Generation.explicit, Generation.reuse, Generation.generate]
rngs = st.integers(0, 2**32 - 1).map(Random)
modes = st.sampled_from([START, END])


class Cutter(Protocol):
    """The harness of such a machine."""

    def set(self, values: dict[str, Any]) -> Self: ...
    def give(self, *commands: str) -> Self: ...
    def rows(self, duration: float, *, acceleration: float, cuts: list[float]) -> dict[float, Row]: ...


@dataclass(frozen=True)
class Phase:
    """A time of constant acceleration of the line, and what is set and given at its beginning."""

    duration: float
    acceleration: float = 0.0
    values: dict[str, Any] = field(default_factory=dict)
    commands: tuple[str, ...] = ()


def run_phase(cutter: Cutter, phase: Phase, cuts: list[float]) -> dict[float, Row]:
    """Run a machine through a phase, in steps that end at these times."""
    return (
        cutter.set(phase.values).give(*phase.commands).rows(phase.duration, acceleration=phase.acceleration, cuts=cuts)
    )


def multiples_of(duration: float, step: float) -> list[float]:
    """The times that cut a duration into steps of this size."""
    return [i * step for i in range(1, int(duration / step) + 1)]
