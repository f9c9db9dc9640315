"""A line: a scripted remote axis, RemoteSync's parameters, and who follows with which commands."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..interface.recipe import Recipe
from ..interface.roles import MOTION
from ..interface.variables import Variable
from ..scenario.recording import Reals
from ..scenario.scenario import AtTime, Expectation, Scenario, When, Within
from ..scenario.telegrams import Remote

REMOTE = "RemoteSync"
ENABLE = "enable"  # set by the line itself
RAMP = ("syn_ramp_on", "local.ramp_begin", "local.progress", "local.transition_distance")
SHOWN = {  # outputs that are looked at: of RemoteSync, and of who follows
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
class Line:
    """A checked line.

    Attributes:
        follower: who follows, as a scenario: its master is the true axis, its settings the commands.
        remote: the telegrams that tell the axis.
        start: RemoteSync's start values.
        places: how far from its place on the true axis a transition of the follower may be, in u; None: not judged.
    """

    follower: Scenario
    remote: Remote
    start: Mapping[str, Any]
    places: float | None

    @property
    def name(self) -> str:
        """Of its package and its report."""
        return self.follower.file.stem

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
        """The components by name. Enumerations are baked in: libcosim cannot set them."""
        starts = {REMOTE: self.start, self.follower.recipe.name: self.follower.start}
        slave_units = {REMOTE: "", self.follower.recipe.name: self.follower.slave_unit}
        return {n: Recipe(n, self.unit, _baked(n, values), slave_units[n]) for n, values in starts.items()}

    @cached_property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Of each component, the start values that are not baked in."""
        starts = {REMOTE: self.start, self.follower.recipe.name: self.follower.start}
        return {name: {n: v for n, v in starts[name].items() if n not in r.starts} for name, r in self.recipes.items()}

    @cached_property
    def outputs(self) -> dict[str, list[Variable]]:
        """Of each component, what is looked at: what every report shows, and what the file names."""
        s = self.follower
        named = [n for e in s.expectations for n in expected_names(e)]
        named += [s.cuts.name] if s.cuts else []
        named += RAMP if self.places is not None else ()
        wanted = {REMOTE: SHOWN[REMOTE], s.recipe.name: (*SHOWN[""], *(_readable(n) for n in named))}
        declared = {name: recipe.variables for name, recipe in self.recipes.items()}
        return {
            name: [declared[name][n] for n in dict.fromkeys(chosen) if n in declared[name]]
            for name, chosen in wanted.items()
        }

    @cached_property
    def commands(self) -> dict[str, NDArray[Any]]:
        """The inputs of the follower that are set during the line: their value in each step."""
        s = self.follower
        names = sorted({n for setting in s.settings for n in setting.values})
        begins = {n: s.start.get(n, s.recipe.variables[n].start) for n in names}
        found: dict[str, NDArray[Any]] = {n: np.full(self.steps, begins[n]) for n in names}
        for setting in sorted(s.settings, key=lambda setting: setting.at):
            first = self.remote.clocks.acted(setting.at)
            for name, value in setting.values.items():
                found[name][first:] = value
        return found

    @cached_property
    def telegrams(self) -> dict[str, NDArray[Any]]:
        """RemoteSync's inputs in each step. It is enabled from the second step on: FMPy's SSP simulation shows zeros
        in the first one."""
        names, telegrams = self.remote.names, self.remote.telegrams
        motion = {f"{names.part}.{name}": telegrams.motion[:, i] for i, name in enumerate(MOTION)}
        return {ENABLE: np.arange(self.steps) > 0, names.cycle_index: telegrams.cycle_index, **motion}

    @cached_property
    def times(self) -> Reals:
        """The ends of the steps, in s."""
        return np.asarray(np.arange(1, self.steps + 1) * self.step_size)


def _baked(name: str, start: Mapping[str, Any]) -> dict[str, str]:
    """The start values of enumerations, as a recipe has them."""
    declared = Recipe(name).variables
    return {n: str(int(value)) for n, value in start.items() if declared[n].choices}


def expected_names(expectation: Expectation) -> Iterable[str]:
    """The variables that an expectation names."""
    match expectation:
        case AtTime():
            return expectation.values
        case When():
            return (expectation.name,)
        case Within():
            return expectation.limits


def _readable(name: str) -> str:
    """The variable from which the value of this one is read: libcosim reads no enumerations, but `state_code` is the
    number of `state`."""
    return "state_code" if name == "state" else name
