"""A small block with a remote axis, for scenarios with two clocks: it shifts each telegram by one correction."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import pytest

from motionsync import var
from motionsync.blocks import BLOCKS
from motionsync.slave import Slave
from motionsync.var import Enumeration, Role, Unit
from motionsync_fmu.interface.stepper import Stepper


class Listening(Enumeration):
    """What the listener does"""

    DEAF = 1, "no cycle has acted yet"
    LISTENING = 2, "telegrams are shifted"


@dataclass(slots=True)
class Telegram:
    """A remote axis as it was received."""

    cycle_index: int = var.input(0, "index of the sender's cycle", role=Role.CYCLE_INDEX, wraps_at=65536)
    position: float = var.input(0.0, "the axis' position", Unit.POSITION, discrete=True)
    velocity: float = var.input(0.0, "its velocity", Unit.VELOCITY, discrete=True)
    acceleration: float = var.input(0.0, "its acceleration", Unit.ACCELERATION, discrete=True)


@dataclass(slots=True)
class Listener:
    """Shifts each telegram by the same number of cycles and by delay_time_offset, at the telegram's velocity."""

    remote: Telegram = var.part(Telegram)
    task_cycle_time: float = var.parameter(0.002, "the receiver's cycle", Unit.TIME, above=0.0, role=Role.TASK_CYCLE)
    data_cycle_time: float = var.parameter(
        0.0, "the sender's cycle, about; 0: the same", Unit.TIME, min=0.0, role=Role.DATA_CYCLE
    )
    delay_time_offset: float = var.parameter(0.0, "added to the correction", Unit.TIME, tunable=True, role=Role.DELAY)
    share: float = var.parameter(0.5, "the correction in cycles")
    shifted: bool = var.input(True, "whether telegrams are shifted")
    slave: Slave = var.part(Slave)
    state: Listening = var.output(Listening.DEAF, "what the listener does")
    state_code: int = var.output(1, "the same as a plain integer")
    corrected_cycle_index: float = var.output(
        0.0, "index of the sender's cycle, shifted", discrete=True, role=Role.CORRECTED_INDEX
    )
    seen: int = var.output(0, "index of the last telegram")
    elapsed: float = 0.0
    cycle: int = 0

    def initialize(self) -> int:
        return 0

    def step(self, h: float) -> int:
        self.elapsed += h
        while self.cycle * self.task_cycle_time < self.elapsed - 1e-6 * self.task_cycle_time:
            self._cycle()
            self.cycle += 1
        return 0

    def _cycle(self) -> None:
        share = self.share if self.shifted else 0.0
        time = share * self.task_cycle_time + self.delay_time_offset
        remote = self.remote
        self.slave.set(remote.position + time * remote.velocity, remote.velocity, remote.acceleration, 0.0)
        self.state = Listening.LISTENING
        self.state_code = 2
        self.corrected_cycle_index = remote.cycle_index + share
        self.seen = remote.cycle_index


@contextmanager
def registered() -> Iterator[None]:
    """The context in which the Listener is one of the registered blocks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(BLOCKS.modules, "Listener", __name__)
        yield


class ListenerOracle:
    """A Listener in the form of an oracle; a step answers all its cells, the inputs included."""

    def __init__(self, parameters: dict[str, Any], shown: dict[str, Any]) -> None:
        self.stepper = Stepper(Listener()).set(parameters | shown)

    def step(self, shown: dict[str, Any], h: float) -> dict[str, Any]:
        return self.stepper.step(h, shown).get(self.stepper.cells)
