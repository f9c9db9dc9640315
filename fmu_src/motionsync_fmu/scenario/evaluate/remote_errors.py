"""The errors of a run with a remote axis: how far telegrams and outputs are from the scripted axis.

An output at a communication point describes the axis at the instant of the last cycle before that point, shifted by the
block's delay.
"""

from dataclasses import dataclass

import numpy as np

from ..recording import Reals, Recording
from ..remote_view import RemoteView


@dataclass(frozen=True)
class RemoteErrors:
    """The errors of a run at its communication points but the first; each of shape (points - 1,).

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


def remote_errors(remote: RemoteView, recording: Recording) -> RemoteErrors:
    """The errors of a run."""
    clocks, telegrams = remote.clocks, remote.telegrams
    cycle_counts = clocks.count_cycles_at(recording.time)
    latest = cycle_counts[1:] - 1
    visible = np.maximum(np.minimum(cycle_counts[:-1], latest), 0)  # as `Telegrams.shown` of the runner
    instant = np.asarray(latest * clocks.task_cycle, np.float64)
    at, delays = np.array(remote.delays).T
    delay = delays[np.searchsorted(at, instant + 1e-9, "right") - 1]
    behind = remote.accuracy.behind * remote.data_cycle if remote.accuracy else 0.0
    true_index, received = telegrams.true_index[latest], telegrams.motion[visible]
    corrected = recording.values[remote.names.corrected_index][1:]
    return RemoteErrors(
        recording.time[1:],
        received,
        _wrap_difference(telegrams.cycle_index[visible] - true_index, clocks.wraps_at),
        _wrap_difference(corrected - true_index, clocks.wraps_at),
        received[:, 0] - remote.axis.motions_at(instant)[:, 0],
        recording.values["slave.position"][1:] - remote.axis.motions_at(instant + delay - behind)[:, 0],
    )


def _wrap_difference(difference: Reals, wraps_at: int) -> Reals:
    """The difference of two indices, without whole revolutions of the counter."""
    return np.asarray(difference - wraps_at * np.round(difference / wraps_at))
