"""A FlyingSaw along a scripted master, for tests of the block alone."""

from collections.abc import Iterable
from typing import Any, Self

from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.interface.variables import variables
from tests.support.harness import BlockHarness, Row

OUTPUTS = tuple(v.name for v in variables(FlyingSaw()) if v.causality in ("output", "local"))
RESULTS = (
    *("start_sync", "in_sync", "in_velocity", "done", "busy", "active"),
    *("command_aborted", "error"),
)
GROUPS = (
    *("gear_in_velo", "gear_in_pos", "gear_out", "halt", "stop"),
    *("move_velocity", "move_absolute", "reset"),
)


class Saw(BlockHarness):
    """Its commands are function blocks; `execute` has to fall before it can rise again."""

    TYPE = FlyingSaw

    def stepped(self) -> None:
        self.held = {group for group in GROUPS if self[f"{group}.execute"]}

    def modes(self, *names: str) -> Self:
        """These bits of sync_mode, and no other."""
        bits = (name for name in self.stepper.cells if name.startswith("sync_mode."))
        return self.put({name: name.removeprefix("sync_mode.") in names for name in bits})

    def order(self, group: str, **values: Any) -> Self:
        """The group's inputs, and a rising edge of its `execute` with the next run."""
        assert group not in self.held, "no edge: execute has not been false"
        return self.put({f"{group}.{name}": value for name, value in values.items()} | {f"{group}.execute": True})

    def release(self, *groups: str) -> Self:
        """A falling edge of these groups' `execute`, of all of them if none is named."""
        return self.put({f"{group}.execute": False for group in groups or GROUPS})

    def read(self, names: Iterable[str] = OUTPUTS) -> Row:
        return super().read(names)

    def results(self, group: str) -> set[str]:
        """The names of the group's outputs that are true."""
        return {name for name in RESULTS if f"{group}.{name}" in self.stepper.cells and self[f"{group}.{name}"]}
