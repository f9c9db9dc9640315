"""What a block sees of a scenario's remote axis: telegrams, which are samples of the scripted axis."""

from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..interface.roles import RemoteAxisVariables
from ..runner import telegrams as runner
from .clocks import Clocks, Telegrams
from .script import Script


@dataclass(frozen=True)
class Accuracy:
    """The accuracy that a scenario expects of the block.

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
class RemoteView:
    """An axis that the block sees through telegrams only.

    Attributes:
        names: the block's variables that belong to the axis.
        axis: the true axis.
        cycles: the number of the receiver's cycles in the run.
        data_cycle: nominal distance of the telegrams, in s.
        delays: by how much the block's outputs are later than a cycle's instant, from a time on, both in s; the first
            from 0 on.
        accuracy: how near the block has to be to the truth; None: this is not checked.
    """

    names: RemoteAxisVariables
    axis: Script
    clocks: Clocks
    cycles: int
    data_cycle: float
    delays: Sequence[tuple[float, float]]
    accuracy: Accuracy | None

    def seen(self) -> runner.Telegrams:
        """The telegrams of a run."""
        return runner.Telegrams(self.clocks.task_cycle, *self._series)

    @cached_property
    def _series(self) -> "tuple[array[int], array[float]]":
        """Index and motion of the telegrams, as the package `runner` reads them."""
        indices = self.telegrams.cycle_index.astype(np.int64)
        return array("q", indices.tobytes()), array("d", self.telegrams.motion.tobytes())

    @cached_property
    def telegrams(self) -> Telegrams:
        return self.clocks.telegrams(self.axis, self.cycles)
