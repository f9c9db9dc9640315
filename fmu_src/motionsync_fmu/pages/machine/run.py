"""What the machines of all blocks are drawn from: a scenario and its recording, asked for signals and values."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ...scenario.recording import Reals, Recording
from ...scenario.scenario import Scenario
from .signals import Signal, held, smooth

FINENESS = 2e-7  # of the range of what is drawn, by which a smooth signal may differ from the recording


@dataclass(frozen=True)
class Run:
    """A scenario and its recording."""

    scenario: Scenario
    recording: Recording

    @property
    def unit(self) -> str:
        """The name of the unit of the master's positions."""
        return unit_name(Unit.POSITION, self.scenario.unit)

    @property
    def slave_unit(self) -> str:
        """The name of the unit of the slave's positions."""
        return unit_name(Unit.POSITION, self.scenario.slave_unit or self.scenario.unit)

    def values(self, name: str) -> Reals:
        """An output or local at the communication points, shape (points,)."""
        return self.recording.values[name]

    def where(self, conditions: Sequence[str]) -> Any:
        """Where one of these conditions holds, shape (points,); see `description`."""
        never = np.zeros(len(self.recording.time), bool)
        return np.logical_or.reduce([never, *(self._holds(condition) for condition in conditions)])

    def _holds(self, condition: str) -> Any:
        name, _, member = condition.partition(" == ")
        choices = self.scenario.recipe.variables[name].choices
        return (
            self.values(name) == next(int(m) for m in choices if m.name == member) if member else self.values(name) != 0
        )

    def starts_as(self, condition: str) -> bool:
        """Whether a start value is that member of its enumeration: `parameter == MEMBER`."""
        name, _, member = condition.partition(" == ")
        return self.start(name) == next(
            int(m) for m in self.scenario.recipe.variables[name].choices if m.name == member
        )

    def shown(self, conditions: Sequence[str]) -> Signal:
        """Whether one of these conditions holds, over time."""
        return held(self.recording.time, self.where(conditions).astype(float))

    def period(self, names: Sequence[str]) -> float:
        """The first of these start values that is not 0; see `description`."""
        values = (self._unless(*name.split(" unless ")) for name in names)
        return next(filter(None, values), 0.0)

    def _unless(self, name: str, other: str = "") -> float:
        return 0.0 if other and self.start(other) else self.start(name)

    def start(self, name: str) -> float:
        """The start value of a parameter or input."""
        given = self.scenario.start.get(name, self.scenario.recipe.variables[name].start)
        return float(given)

    def setting(self, name: str) -> Signal:
        """A parameter or input over time: its start value, and what the run set it to."""
        given = [(s.at, float(s.values[name])) for s in self.recording.settings if name in s.values]
        return {"t": [0.0, *(at for at, _ in given)], "x": [self.start(name), *(value for _, value in given)]}

    def signal(self, name: str) -> Signal:
        """Any variable over time."""
        return self.setting(name) if self.scenario.recipe.variables[name].settable else self.held(name)

    def held(self, name: str) -> Signal:
        """A discrete output or local over time."""
        return held(self.recording.time, self.values(name))

    def axes(self, positions: Reals, span: float) -> dict[str, Any]:
        """What a scene of two axes needs.

        Args:
            positions: the slave's positions, without wrapping.
            span: the length of what is drawn, in units of the slave's positions.
        """
        tolerance = FINENESS * span
        time, master = self.recording.time, self.recording.master
        slave, within = smooth(time, positions, self.values("slave.velocity"), tolerance)
        return self.common(span) | {
            "within": within,
            "master": smooth(time, master[:, 0], master[:, 1], tolerance)[0],
            "slave": slave,
        }

    def common(self, span: float) -> dict[str, Any]:
        """What every scene needs: its length, the end of time, units, the states by their numbers."""
        choices = self.scenario.recipe.variables["state"].choices
        return {
            "stop": float(self.recording.time[-1]),
            "unit": self.unit,
            "slave_unit": self.slave_unit,
            "span": span,
            "state": self.held("state"),
            "states": {str(int(member)): [member.name, member.description] for member in choices},
        }
