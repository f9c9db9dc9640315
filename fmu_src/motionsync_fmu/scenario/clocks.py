"""Two clocks and the telegrams between them: what a receiver sees of an axis whose controller has a clock of its own.

All times are the receiver's, in s: its cycle i acts at i times its cycle. The sender's cycles are nearly as long, or a
whole multiple or part of that. In each of its cycles the sender sends a telegram with the index of the cycle and the
motion of the axis at that instant. The sender's index at any time, as a real number, and the axis are known exactly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..runner.telegrams import CLOSE, count_cycles
from .recording import Reals
from .script import Script

Integers = np.ndarray[Any, np.dtype[np.int64]]
LARGEST_JITTER = 0.45  # of the shorter cycle: jitter moves no instant farther, so that telegrams stay in sequence
SENT_BEFORE_START = 2  # telegrams sent before time 0: one of them is seen until the first one arrives


@dataclass(frozen=True)
class Rate:
    """The length of the sender's cycles, in s, from a time on."""

    at: float
    cycle: float


@dataclass(frozen=True)
class Telegrams:
    """The telegrams that the receiver sees, one for each of its cycles.

    Attributes:
        index: the telegram's index, counted on from the first telegram without wrapping; shape (cycles,).
        cycle_index: the index as the telegram contains it: from 0 to below `Clocks.wraps_at`.
        motion: position, velocity and acceleration of the axis in the telegram, in u, u/s, u/s2; shape (cycles, 3).
        true_index: the sender's index at the cycle's instant, a real number that never wraps; shape (cycles,).
    """

    index: Integers
    cycle_index: Integers
    motion: Reals
    true_index: Reals


@dataclass(frozen=True)
class Clocks:
    """A receiver's clock and a sender's.

    Attributes:
        task_cycle: the receiver's cycle, in s.
        rates: the sender's cycles, the first from 0 on. Where they change, the phase continues.
        phase: how long before time 0 the first telegram is sent, as a share of the sender's cycle: from 0 to below 1.
        jitter: the jitter of the instants at which telegrams are sent, and of those at which they are read. Both are
            independent and Gaussian; this is their standard deviation as a share of the receiver's cycle. A telegram
            describes the axis at the instant without jitter.
        seed: the seed of the jitter; the same seed gives the same jitter, however long the run is.
        lost: first and last index of telegrams that never arrive, counted as `Telegrams.index` is; none of these
            ranges starts before the first telegram.
        first_index: the index of the first telegram, as the telegram contains it.
        wraps_at: the index in a telegram starts again at 0 where it would reach this number.
    """

    task_cycle: float
    rates: Sequence[Rate]
    phase: float = 0.0
    jitter: float = 0.0
    seed: int = 0
    lost: Sequence[tuple[int, int]] = ()
    first_index: int = 0
    wraps_at: int = 65536

    def count_cycles(self, t: float) -> int:
        """How many of the receiver's cycles have acted before t, which is the number of the next one."""
        return count_cycles(t, self.task_cycle)

    def count_cycles_at(self, times: Reals) -> Integers:
        """The same for many times at once, shape (times,)."""
        return np.maximum(np.ceil(times / self.task_cycle - CLOSE), 0.0).astype(np.int64)

    def true_index(self, times: Reals) -> Reals:
        """The sender's index at these times, shape (times,): real numbers that never wrap."""
        at, cycle, count = self._rate_table
        i = np.maximum(np.searchsorted(at, times, "right") - 1, 0)
        return np.asarray(self.first_index + count[i] + (times - at[i]) / cycle[i])

    def send_times(self, index: Integers) -> Reals:
        """The times at which the telegrams with these indices are sent, in s, without jitter; shape (index,)."""
        at, cycle, count = self._rate_table
        sent = index - self.first_index
        i = np.maximum(np.searchsorted(count, sent, "right") - 1, 0)
        return np.asarray(at[i] + (sent - count[i]) * cycle[i])

    def received_indices(self, cycles: int) -> Integers:
        """The latest telegram that has arrived at each of the receiver's first cycles, shape (cycles,): its index,
        counted on without wrapping."""
        read_times = np.arange(float(cycles)) * self.task_cycle + self._draw_jitter(0, cycles)
        last = int(self.true_index(np.array([cycles * self.task_cycle]))[0])
        index = np.arange(self.first_index - SENT_BEFORE_START, last + SENT_BEFORE_START)
        arrives = np.ones(len(index), bool)
        for lowest, highest in self.lost:
            arrives &= (index < lowest) | (highest < index)
        sent_at = self.send_times(index) + self._draw_jitter(1, len(index))
        return np.asarray(index[arrives][np.searchsorted(sent_at[arrives], read_times, "right") - 1])

    def telegrams(self, axis: Script, cycles: int) -> Telegrams:
        """What the receiver sees of an axis in its first cycles."""
        index = self.received_indices(cycles)
        return Telegrams(
            index,
            index % self.wraps_at,
            axis.motions_at(self.send_times(index))[:, :3],
            self.true_index(np.arange(float(cycles)) * self.task_cycle),
        )

    @cached_property
    def _rate_table(self) -> tuple[Reals, Reals, Reals]:
        """The times at which the length of the sender's cycles changes, the lengths from then on, both in s, and the
        sender's index at these times, counted from the first telegram."""
        at, cycle = np.array([(rate.at, rate.cycle) for rate in self.rates]).T
        return at, cycle, self.phase + np.concatenate([[0.0], np.cumsum(np.diff(at) / cycle[:-1])])

    def _draw_jitter(self, side: int, count: int) -> Reals:
        """The jitter of the first instants of one side, 0: the receiver, 1: the sender; in s, shape (count,)."""
        normal = np.random.default_rng((self.seed, side)).standard_normal(count)
        limit = LARGEST_JITTER * min(self.task_cycle, float(self._rate_table[1].min()))
        return np.clip(self.jitter * self.task_cycle * normal, -limit, limit)
