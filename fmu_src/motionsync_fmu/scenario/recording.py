"""Recorded outputs of one run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .script import Script
from .settings import Setting, UnmetReaction

Reals = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Recording:
    """The outputs of the FMU: `values[name]`, shape (points,), at the communication points `time`, shape (points,), s.

    `master`: the scripted axis at these points, unwrapped, shape (points, 4): u, u/s, u/s2, u/s3. `settings`: all that
    was set, by the scenario's settings and by its reactions, in this order; `unmet`: the reactions that happened less
    often than they could have. `script`: the same axis at every time; None: the recording was not made by a run.
    `computed`: columns that follow from the outputs, by name, shape (points,).
    """

    time: Reals
    values: dict[str, Reals]
    master: Reals
    messages: list[str]
    settings: Sequence[Setting] = ()
    unmet: Sequence[UnmetReaction] = ()
    script: Script | None = None
    computed: Mapping[str, Reals] = field(default_factory=dict)

    @property
    def columns(self) -> dict[str, Reals]:
        """The outputs, and what is computed from them."""
        return {**self.values, **self.computed}


def greatest_position(recording: Recording) -> float:
    """The greatest magnitude of the positions of master and slave, in u."""
    return max(float(np.abs(p).max()) for p in (recording.master[:, 0], recording.values["slave.position"]))


def nearest_turn(position: Any, to: Any, period: float) -> Any:
    """Positions in the turns in which they are nearest to others: numbers, or arrays of one shape; `period`: 0: as they
    are."""
    return position - period * np.rint((position - to) / period) if period else position


def unwrapped(time: Reals, position: Reals, velocity: Reals, period: float) -> Reals:
    """Positions without turns: each is in the turn nearest to where the velocities lead from the one before.

    All of shape (points,); `period`: 0: they are not wrapped."""
    if not period:
        return position
    expected = 0.5 * np.diff(time) * (velocity[1:] + velocity[:-1])
    turns = np.rint((np.diff(position) - expected) / period)
    return position - period * np.concatenate([[0.0], np.cumsum(turns)])
