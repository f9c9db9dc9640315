"""Lines whose acceleration changes now and then, with commands, for tests of machines that cut to length."""

from dataclasses import dataclass
from random import Random

from hypothesis import strategies as st

from motionsync.master import MasterInput

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
COMMANDS = ("cut_now", "take_sample", "abort", "stop", "start", "order.add", "order.skip")
LENGTH, DURATION = 1000.0, 1.0  # of a piece, u; about the time in which it passes, s
LINE = LENGTH / DURATION

rngs = st.integers(0, 2**32 - 1).map(Random)
modes = st.sampled_from([START, END])


@dataclass(frozen=True)
class Phase:
    """A time of constant acceleration of the line."""

    duration: float
    acceleration: float = 0.0


def multiples_of(duration: float, step: float) -> list[float]:
    """The times that cut a duration into steps of this size."""
    return [i * step for i in range(1, int(duration / step) + 1)]
