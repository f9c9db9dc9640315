"""A scenario's remote axis: what the block sees of it, and how far the block's outputs are from the truth.

An output at a communication point describes the axis at the instant of the last cycle before that point, shifted by the
block's delay. The truth is the script, of which the telegrams are samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..interface.roles import MOTION, RemoteAxis
from .clocks import Clocks, Telegrams
from .recording import Reals, Recording
from .script import Script


@dataclass(frozen=True)
class Accuracy:
    """How near the block has to be to the truth.

    Attributes:
        begin: the time from which this is checked, in s.
        index: the greatest allowed error of the corrected index against the sender's true index, peak to peak in the
            sender's cycles; None: this is not checked.
        position: the greatest allowed distance of `slave.position` from the true axis, in u; None: this is not checked.
        behind: how many data cycles the slave is behind the axis by design.
    """

    begin: float
    index: float | None
    position: float | None
    behind: float


@dataclass(frozen=True)
class Remote:
    """An axis that is known by telegrams only.

    Attributes:
        names: the block's variables that belong to the axis.
        axis: the true axis.
        cycles: the number of the receiver's cycles in the run.
        data_cycle: nominal distance of the telegrams, in s.
        delays: by how much the block's outputs are later than a cycle's instant, from a time on, both in s; the first
            from 0 on.
        accuracy: how near the block has to be to the truth; None: this is not checked.
    """

    names: RemoteAxis
    axis: Script
    clocks: Clocks
    cycles: int
    data_cycle: float
    delays: Sequence[tuple[float, float]]
    accuracy: Accuracy | None

    @cached_property
    def telegrams(self) -> Telegrams:
        return self.clocks.telegrams(self.axis, self.cycles)

    def inputs(self, begin: float, end: float) -> dict[str, float]:
        """The telegram that a step shows to the block."""
        i = self.clocks.shown(begin, end)
        motion = zip(MOTION, self.telegrams.motion[i].tolist(), strict=True)
        index = {self.names.cycle_index: int(self.telegrams.cycle_index[i])}
        return index | {f"{self.names.part}.{n}": x for n, x in motion}


@dataclass(frozen=True)
class Errors:
    """How far a run is from the truth, at its communication points but the first; each of shape (points - 1,).

    Attributes:
        time: in s.
        received: the axis as the telegrams described it, shape (points - 1, 3): u, u/s, u/s2.
        index, corrected_index: of the telegram and of the block, in the sender's cycles; positive: ahead of the
            sender. The telegrams' index wraps; therefore these errors wrap, too, to less than half of
            `Clocks.wraps_at`.
        position, corrected_position: the errors of the telegram, at the cycle's instant, and of the slave, in u.
    """

    time: Reals
    received: Reals
    index: Reals
    corrected_index: Reals
    position: Reals
    corrected_position: Reals


def errors(remote: Remote, recording: Recording) -> Errors:
    """The errors of a run."""
    clocks, telegrams = remote.clocks, remote.telegrams
    begun = clocks.acted_at(recording.time)
    acted = begun[1:] - 1
    shown = np.maximum(np.minimum(begun[:-1], acted), 0)  # as `Clocks.shown`
    instant = np.asarray(acted * clocks.task_cycle, np.float64)
    at, delays = np.array(remote.delays).T
    delay = delays[np.searchsorted(at, instant + 1e-9, "right") - 1]
    behind = remote.accuracy.behind * remote.data_cycle if remote.accuracy else 0.0
    true_index, received = telegrams.true_index[acted], telegrams.motion[shown]
    corrected = recording.values[remote.names.corrected_index][1:]
    return Errors(
        recording.time[1:],
        received,
        _wrapped(telegrams.cycle_index[shown] - true_index, clocks.wraps_at),
        _wrapped(corrected - true_index, clocks.wraps_at),
        received[:, 0] - remote.axis.motions_at(instant)[:, 0],
        recording.values["slave.position"][1:] - remote.axis.motions_at(instant + delay - behind)[:, 0],
    )


def _wrapped(difference: Reals, wraps_at: int) -> Reals:
    """The difference of two indices, without whole turns of the counter."""
    return np.asarray(difference - wraps_at * np.round(difference / wraps_at))
