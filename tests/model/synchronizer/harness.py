"""A Synchronizer that a test drives step by step, with the numbers of its state at hand."""

from collections.abc import Mapping
from typing import Any

import pytest

from motionsync.master import MasterInput
from motionsync.synchronizer.block import Synchronizer
from motionsync.synchronizer.faults import Refusal
from motionsync.synchronizer.interface import Curve, State

PARABOLA, POLYNOMIAL = Curve.PARABOLA, Curve.POLYNOMIAL_3_4_5
START, END, ONLY = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY
READY, EXECUTING, STACKED = State.READY, State.EXECUTING, State.STACKED


def write(block: Synchronizer, values: Mapping[str, Any]) -> None:
    for name, value in values.items():
        *path, last = name.split(".")
        part: Any = block
        for step in path:
            part = getattr(part, step)
        setattr(part, last, type(getattr(part, last))(value))


class Harness:
    """A block whose master goes where a test says; each travel is one step. Wrapped inputs with a period.

    The laws of the numbers below, rest R and phasing D: with the parabola both ramps lie from R - D to R + D, a start
    is R + (m - R + D)^2 / 4D, a stop R - (R + D - m)^2 / 4D.
    """

    def __init__(self, at: float = 0.0, *, period: float = 0.0, mode: MasterInput = START, **values: Any) -> None:
        self.at = at
        self.block = Synchronizer()
        write(self.block, {"curve": PARABOLA, "output_phasing": 10.0, **values})
        write(self.block, {"master.input_mode": mode, "master.period": period, "master.position": self.input})
        assert self.block.initialize() == Refusal.NONE

    @property
    def input(self) -> float:
        period = self.block.master.period
        return self.at % period if period > 0.0 else self.at

    def move(self, velocity: float, acceleration: float, h: float, **values: Any) -> "Harness":
        """The inputs given are set before the step, whose master is at `at` with this velocity and acceleration."""
        write(self.block, values)
        end = self.at + (velocity + 0.5 * acceleration * h) * h
        if self.block.master.input_mode == END:
            self.at, velocity = end, velocity + acceleration * h
        write(self.block, {"master.position": self.input, "master.velocity": velocity})
        self.block.master.acceleration = acceleration
        assert self.block.step(h) == Refusal.NONE
        self.at = end
        return self

    def go(self, *master_positions: float, **values: Any) -> "Harness":
        """With constant velocity to each position of the master, 1 s each; inputs are set before the first step."""
        for master_position in master_positions:
            self.move(master_position - self.at, 0.0, 1.0, **values)
            values = {}
        return self

    def stand(self, master_position: float, **values: Any) -> "Harness":
        """END_OF_STEP: at rest at both ends of the step, and no turning point in between."""
        write(self.block, values)
        self.at = master_position
        write(self.block, {"master.position": self.input, "master.velocity": 0.0, "master.acceleration": 0.0})
        assert self.block.step(1.0) == Refusal.NONE
        return self

    def pulse(self, **values: Any) -> "Harness":
        """Commands given to a standing master, and taken back."""
        self.go(self.at, **values)
        return self.go(self.at, start=False, stop=False)

    def rest_at(self, rest: float) -> "Harness":
        """READY and resting there, as a stop in an inactive block leaves it."""
        return self.pulse(active=False, stop=True, rest_value=rest).pulse(active=True)

    def shows(self, state: State, *, s: bool, ramp: bool = False, error: int = 0) -> "Harness":
        block = self.block
        assert (block.state, block.synchronized, block.syn_ramp_on, block.error_id) == (state, s, ramp, error)
        assert (block.state_code, block.ready, block.error) == (int(state), state == READY, error != 0)
        assert block.syn_synchronized == (s and not ramp)
        assert block.status == (1 if s and not ramp else 0) + (2 if ramp else 0)
        return self

    def slave(self, position: float, velocity: float | None = None) -> "Harness":
        assert self.block.slave.position == pytest.approx(position, rel=1e-12, abs=1e-12)
        if velocity is not None:
            assert self.block.slave.velocity == pytest.approx(velocity, rel=1e-12, abs=1e-12)
        return self
