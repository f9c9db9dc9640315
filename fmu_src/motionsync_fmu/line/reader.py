"""Line files: a scripted remote axis, RemoteSync's parameters, and who follows with which commands.

The follower's part is that of a scenario file whose master is the true axis; every mistake is told as there.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motionsync.blocks import BLOCKS

from ..errors import UserError
from ..interface.recipe import Recipe
from ..interface.variables import Variable, variables
from ..scenario.recording import Reals
from ..scenario.scenario import DELAY, SCALARS, AtTime, Reader, Scenario, When, Within
from ..scenario.telegrams import MOTION, Remote

PATTERN = "line*.toml"
REMOTE = "RemoteSync"
CYCLE = "task_cycle_time"
GIVEN = (CYCLE, "enable")  # what the line itself sets of RemoteSync
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
        named = [n for e in s.expectations for n in _named(e)]
        named += [s.cuts.name] if s.cuts else []
        named += RAMP if self.places is not None else ()
        wanted = {REMOTE: SHOWN[REMOTE], s.recipe.name: (*SHOWN[""], *(_readable(n) for n in named))}
        by_name = {name: {v.name: v for v in variables(BLOCKS[name].type())} for name in wanted}
        return {
            name: [by_name[name][n] for n in dict.fromkeys(chosen) if n in by_name[name]]
            for name, chosen in wanted.items()
        }

    @cached_property
    def commands(self) -> dict[str, NDArray[Any]]:
        """The inputs of the follower that are set during the line: their value in each step."""
        s = self.follower
        begins = {v.name: v.start for v in variables(s.recipe.block())} | dict(s.start)
        names = sorted({n for setting in s.settings for n in setting.values})
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
        told = self.remote.telegrams
        motion = {f"remote.{name}": told.motion[:, i] for i, name in enumerate(MOTION)}
        return {"enable": np.arange(self.steps) > 0, "remote.cycle_index": told.cycle_index, **motion}

    @cached_property
    def times(self) -> Reals:
        """The ends of the steps, in s."""
        return np.asarray(np.arange(1, self.steps + 1) * self.step_size)


def _baked(name: str, start: Mapping[str, Any]) -> dict[str, str]:
    choices = {v.name for v in variables(BLOCKS[name].type()) if v.choices}
    return {n: str(int(value)) for n, value in start.items() if n in choices}


def _named(expectation: AtTime | When | Within) -> Iterable[str]:
    match expectation:
        case AtTime():
            return expectation.values
        case When():
            return (expectation.name,)
        case Within():
            return expectation.limits


def _readable(name: str) -> str:
    """libcosim does not read enumerations; `state_code` is `state`."""
    return "state_code" if name == "state" else name


def find_lines(path: Path) -> list[Path]:
    """The line files at a path: a file, or all below a folder.

    Raises:
        UserError: there is none.
    """
    if path.is_file():
        return [path]
    found = sorted(path.rglob(PATTERN))
    if not found:
        raise UserError(f"{path}: {f'no {PATTERN} below it' if path.is_dir() else 'no such file or folder'}")
    return found


def load_line(file: Path) -> Line:
    """Read and check a line file.

    Raises:
        UserError: the first mistake in it, with file, line and key.
    """
    return _LineReader(file).line()


class _LineReader(Reader):
    """Reads the follower's tables as those of a scenario, then RemoteSync's."""

    def line(self) -> Line:
        scalars = tuple(key for key in SCALARS if key != "tolerance")
        tables = ("remote", "remote_sync", "start", "set", "expect", "cuts", "switches")
        self.keys(self.root, (*scalars, *tables), "")
        unit, slave_unit = self.block()
        if self.group == "remote":
            self.fail("", 0, "fmu", f"{self.name} sees telegrams itself: name the block that follows it")
        stop_time, step_size = self.times()
        self.origin = REMOTE
        start, settings, expectations = self.start(), tuple(self.settings(stop_time)), self.readable(stop_time)
        tolerance, cuts, places = 1e-9, self.cuts() if "cuts" in self.root else None, self.places()
        name = self.name
        remote, remote_start = self.telegrams(stop_time, step_size)
        texts = self.string("title"), self.string("source")
        recipe, times = Recipe(name), (stop_time, step_size)
        follower = Scenario(
            self.file, *texts, recipe, unit, slave_unit, *times, tolerance,
            start, remote.axis, None, settings, expectations, cuts,
        )  # fmt: skip
        return Line(follower, remote, remote_start, places)

    def readable(self, stop_time: float) -> tuple[AtTime | When | Within, ...]:
        """Expectations; libcosim does not read enumerations but by their code."""
        found = tuple(self.expectations(stop_time))
        for i, e in enumerate(found):
            for name in _named(e):
                if self.variables[name].choices and name != "state":
                    self.fail("expect", i, name, "is an enumeration: in a line, expect its code or something else")
        return found

    def places(self) -> float | None:
        if "switches" not in self.root:
            return None
        table = self.table("switches")
        self.keys(table, ("tolerance",), "switches")
        if missing := [name for name in RAMP if name not in self.variables]:
            self.fail("switches", 0, "", f"{self.name} is not switched on and off: it has no {missing[0]}")
        return self.number(table, "tolerance", "switches", above=0.0)

    def telegrams(self, stop_time: float, step_size: float) -> tuple[Remote, dict[str, Any]]:
        """The remote axis, and RemoteSync's start values: its cycle is the line's step, and its output in a step is
        what the follower sees in the next one."""
        self.turn_to(REMOTE)
        if "accuracy" in self.table("remote"):
            self.fail("remote", 0, "accuracy", "a line is judged by [cuts], [switches] and [[expect]]")
        given = self.start("remote_sync")
        for name in GIVEN:
            if name in given:
                told = "is the line's step_size" if name == CYCLE else "is set by the line itself"
                self.fail("remote_sync", 0, name, told)
        start = {CYCLE: step_size, DELAY: step_size} | given
        return self.remote(self.script(), start, (), stop_time), start
