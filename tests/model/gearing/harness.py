"""A Gearing along a scripted master, for tests of the block alone."""

from typing import Any, Self

from motionsync.gearing.block import Gearing
from tests.support.harness import MOTION, BlockHarness


class Gear(BlockHarness):
    """Its commands are the edges of `start`."""

    TYPE = Gearing
    SHOWN = (*MOTION, "state_code")

    def start(self, **values: Any) -> Self:
        """A rising edge of `start` with the next run; the values go to gear_in."""
        return self.put({f"gear_in.{name}": value for name, value in values.items()} | {"start": True})

    def stop(self, **values: Any) -> Self:
        """A falling edge of `start` with the next run; the values go to gear_out."""
        return self.put({f"gear_out.{name}": value for name, value in values.items()} | {"start": False})
