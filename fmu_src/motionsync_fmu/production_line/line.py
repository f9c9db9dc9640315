"""A line: a scripted remote axis, RemoteSync's parameters, and the follower with its commands."""

from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..interface.recipe import Recipe
from ..interface.roles import MOTION, PieceVariables
from ..interface.variables import Variable
from ..scenario.recording import Reals
from ..scenario.remote_view import RemoteView
from ..scenario.scenario import Scenario

REMOTE = "RemoteSync"
ENABLE = "enable"  # set by the line itself
RAMP = ("syn_ramp_on", "local.ramp_begin", "local.progress", "local.transition_distance")
SHOWN = {  # outputs that every report shows: those of RemoteSync, and those of the follower
    REMOTE: (
        *(f"slave.{name}" for name in MOTION),
        "state_code",
        "synced",
        "drift",
        "correction_time",
        "corrected_cycle_index",
        "beats",
        "error",
        "error_id",
    ),
    "": (*(f"slave.{name}" for name in (*MOTION, "jerk")), "state_code", "error", "error_id"),
}


@dataclass(frozen=True)
class ProductionLine:
    """A checked line.

    Attributes:
        follower: the follower as a scenario, whose master is the true axis and whose settings are the commands.
        remote: the telegrams that describe the axis.
        start: RemoteSync's start values.
        switch_tolerance: how far a transition of the follower may be from its position on the true axis, in u; None:
            this is not checked.
    """

    follower: Scenario
    remote: RemoteView
    start: Mapping[str, Any]
    switch_tolerance: float | None

    @property
    def name(self) -> str:
        """The name of the package and of the report."""
        return self.follower.file.stem

    @cached_property
    def piece_variables(self) -> PieceVariables | None:
        """The variables by which the follower reports its pieces; None: it does not report them."""
        return self.follower.recipe.piece_variables

    @property
    def step_size(self) -> float:
        return self.follower.step_size

    @property
    def steps(self) -> int:
        return self.remote.cycles

    @property
    def unit(self) -> str:
        return self.follower.unit

    @cached_property
    def recipes(self) -> dict[str, Recipe]:
        """The recipe of each component. Start values of enumerations are baked in, since libcosim cannot set them."""
        starts = {REMOTE: self.start, self.follower.recipe.name: self.follower.start}
        slave_units = {REMOTE: "", self.follower.recipe.name: self.follower.slave_unit}
        return {n: Recipe(n, self.unit, _baked(n, values), slave_units[n]) for n, values in starts.items()}

    @cached_property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """The start values of each component that are not baked in."""
        starts = {REMOTE: self.start, self.follower.recipe.name: self.follower.start}
        return {name: {n: v for n, v in starts[name].items() if n not in r.starts} for name, r in self.recipes.items()}

    @cached_property
    def outputs(self) -> dict[str, list[Variable]]:
        """The recorded outputs of each component: those that every report shows, and those that the file names."""
        s = self.follower
        named = [n for e in s.expectations for n in e.names]
        named += [s.cuts.name] if s.cuts else []
        named += RAMP if self.switch_tolerance is not None else ()
        named += self._piece_outputs
        requested = {REMOTE: SHOWN[REMOTE], s.recipe.name: (*SHOWN[""], *(_readable(n) for n in named))}
        declared = {name: recipe.variables for name, recipe in self.recipes.items()}
        return {
            name: [declared[name][n] for n in dict.fromkeys(names) if n in declared[name]]
            for name, names in requested.items()
        }

    @property
    def _piece_outputs(self) -> list[str]:
        """The outputs by which the follower reports its pieces."""
        names = astuple(self.piece_variables) if self.piece_variables else ()
        flat = [n for name in names for n in (name if isinstance(name, tuple) else (name,))]
        return [n for n in flat if n and not self.follower.recipe.variables[n].settable]

    @cached_property
    def commands(self) -> dict[str, NDArray[Any]]:
        """The value in each step of each input of the follower that is set during the line."""
        s = self.follower
        names = sorted({n for setting in s.settings for n in setting.values})
        starts = {n: s.start.get(n, s.recipe.variables[n].start) for n in names}
        values_of: dict[str, NDArray[Any]] = {n: np.full(self.steps, starts[n]) for n in names}
        for setting in sorted(s.settings, key=lambda setting: setting.at):
            first = self.remote.clocks.count_cycles(setting.at)
            for name, value in setting.values.items():
                values_of[name][first:] = value
        return values_of

    @cached_property
    def telegrams(self) -> dict[str, NDArray[Any]]:
        """RemoteSync's inputs in each step. It is enabled from the second step on, since FMPy's SSP simulation has
        zeros in the first one."""
        names, telegrams = self.remote.names, self.remote.telegrams
        motion = {f"{names.part}.{name}": telegrams.motion[:, i] for i, name in enumerate(MOTION)}
        return {ENABLE: np.arange(self.steps) > 0, names.cycle_index: telegrams.cycle_index, **motion}

    @cached_property
    def times(self) -> Reals:
        """The ends of the steps, in s."""
        return np.asarray(np.arange(1, self.steps + 1) * self.step_size)


def _baked(name: str, start: Mapping[str, Any]) -> dict[str, str]:
    """The start values of enumerations, in the form that a recipe needs."""
    declared = Recipe(name).variables
    return {n: str(int(value)) for n, value in start.items() if declared[n].choices}


def _readable(name: str) -> str:
    """The variable to read in place of this one: libcosim cannot read enumerations, but `state_code` is the number of
    `state`."""
    return "state_code" if name == "state" else name
