"""The master of random runs: how it is described (input mode, and what belongs to the mode MEASURED), and how it
wanders."""

from random import Random
from typing import Any

from hypothesis import strategies as st

from motionsync.master import MasterInput
from motionsync_fmu.interface.variables import LONGEST_STEP

INPUT_MODES = st.fixed_dictionaries(
    {
        "master.input_mode": st.sampled_from([int(mode) for mode in MasterInput]),
        "master.smoothing_time": st.one_of(st.sampled_from((0.02, 0.0, 10.0)), st.floats(0.0, 1.0)),
        "master.delay": st.sampled_from((0.0, 0.0, 0.004, 1.0)),
        "master.sample_time": st.one_of(st.sampled_from((0.0, 0.0, 1e-9, 1.0)), st.floats(1e-3, 0.1)),
    }
)


class WanderingMaster:
    """A master whose velocity jumps now and then, in steps of any size; it is shown wrapped or not."""

    def __init__(self, r: Random, start: dict[str, Any], length: float) -> None:
        self.r, self.length, self.period = r, length, start["master.period"]
        self.position, self.velocity, self.acceleration = start["master.position"], start["master.velocity"], 0.0

    def begin_step(self) -> tuple[float, dict[str, Any]]:
        """A step size, and the master's inputs."""
        r = self.r
        h = 10.0 ** r.uniform(-3.0, 0.0) if r.random() < 0.9 else 10.0 ** r.uniform(-15.0, 5.0)
        self.acceleration = r.choice((0.0, 0.0, r.gauss(0.0, self.length)))
        return h, {
            "master.position": self.position if r.random() < 0.7 else self.position % (self.period or 1e9),
            "master.velocity": self.velocity,
            "master.acceleration": self.acceleration,
        }

    def end_step(self, h: float) -> None:
        """Move on by h, unless no step has this size."""
        if not 0.0 < h <= LONGEST_STEP:
            return
        r, velocity, after = self.r, self.velocity, self.velocity + self.acceleration * h
        self.position += (velocity + 0.5 * self.acceleration * h) * h
        self.velocity = r.choice((after, velocity, r.gauss(0.0, self.length), 0.0))
        if abs(self.position) > 1e11 or abs(self.velocity) > 1e11:
            self.position, self.velocity = 0.0, self.length
