"""A RotaryKnife on a scripted line."""

from typing import Any, Self

from motionsync.master import MasterInput
from motionsync.rotary_knife.block import RotaryKnife
from tests.support.blocks.harness import MOTION, BlockHarness

WINDOW: dict[str, Any] = {"sync.before": 30.0, "sync.after": 30.0}


class RotaryKnifeHarness(BlockHarness):
    """A RotaryKnife with windows of 30 on both sides; a command that is given falls again after the next step."""

    TYPE = RotaryKnife
    SHOWN = (*MOTION, "state_code", "statistics.cuts", "statistics.skipped", "warning.limit_exceeded")

    def __init__(self, values: dict[str, Any] | None = None, **options: Any) -> None:
        self.given_commands: tuple[str, ...] = ()
        super().__init__(WINDOW | (values or {}), **options)

    def after_step(self) -> None:
        for name in self.given_commands:
            self.set({name: False})
        self.given_commands = ()

    def give(self, *commands: str) -> Self:
        """Rising edges of these commands with the next step."""
        self.given_commands += commands
        return self.set(dict.fromkeys(commands, True))

    def at(self, time: float, *, acceleration: float = 0.0) -> Self:
        """Run until this time since the initialization, in one step."""
        return self.run(time - self.time, acceleration=acceleration)


def started_knife(
    values: dict[str, Any] | None = None, *, speed: float = 1000.0, mode: MasterInput = MasterInput.START_OF_STEP
) -> RotaryKnifeHarness:
    """A knife to which `start` is given with the next step, on a line that runs from 0 on."""
    return RotaryKnifeHarness(values, speed=speed, mode=mode).give("start")
