"""The tables from which compiled code runs scenarios: NumPy records and a structure with the layout of those in
`script.c`. Addresses, offsets and distances are in bytes."""

from collections.abc import Iterable, Mapping, Sequence
from ctypes import Structure, c_double, c_int64, c_void_p
from functools import cache, cached_property, lru_cache
from math import expm1
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motionsync.master import MasterInput

from ...errors import choose
from ...interface.recipe import Recipe
from ...scenario.reactions import LOOK, MARGIN, rounded, scans
from ...scenario.recording import Reals, Recording
from ...scenario.run import CLOSE, points
from ...scenario.scenario import Scenario
from ...scenario.script import Motion, Script
from ...scenario.settings import Setting, Unmet
from .. import memory_layout
from .described import described
from .plan import Cause

Array = NDArray[Any]

WIDTH = 5  # columns of a recording before the outputs: the time, and the axis
NEVER = np.empty(0)

KINDS = {"Real": 0, "Integer": 1, "Enumeration": 1, "Boolean": 2}  # REAL, WORD, FLAG in script.c
COMPARISONS = {"<": 0, ">": 1, "==": 2}  # LESS, GREATER, EQUAL


def _record(reals: str, order: str) -> np.dtype[Any]:
    """A record of fields of 8 bytes in this order: doubles with the names in `reals`, integers with all others."""
    real = set(reals.split())
    return np.dtype([(name, np.float64 if name in real else np.int64) for name in order.split()])


PLACE = _record("", "offset kind")
LIMITED = _record("least greatest smallest zero", "offset least greatest smallest zero")
ASSIGNMENT = _record("real", "offset kind adds word real")
EVENT = _record("at", "at what")
BUNDLE = _record("", "first last")
REACTION = _record("value margin", "offset kind comparison value margin at times what held happened")
RUN = _record(
    "close stop_time period before cycle gain most scan now step",
    "block close stop_time period end_of_step points point_count scans scan_count before events taken event_count"
    " bundles assignments reactions reaction_count breaks motions motion_count indices telegrams cycle follows kind"
    " gain most scan times axis values room count now step cause number place next",
)


class Scenarios(Structure):
    """What all runs have in common, and the runs.

    Attributes:
        axis: the offsets of the inputs of the axis: position, velocity, acceleration, and the cycle index if it is a
            remote one.
        limits: the Reals to judge at each step, in the order of the variables; LIMITED.
        sinks: what is recorded; PLACE.
        longest: the greatest allowed step size, in s.
        closest: of a cycle: a time that follows an instant by less is taken for that instant.
        samples: room for the samples of the reductions.
        runs: RUN.
    """

    _fields_ = (
        ("axis", c_int64 * 4),
        ("limits", c_void_p),
        ("limit_count", c_int64),
        ("sinks", c_void_p),
        ("sink_count", c_int64),
        ("longest", c_double),
        ("closest", c_double),
        ("reductions", c_void_p),
        ("samples", c_void_p),
        ("runs", c_void_p),
        ("run_count", c_int64),
    )


def address(array: Array) -> int:
    """Where an array lies in memory."""
    return array.ctypes.data


class Place(NamedTuple):
    """Where a variable lies in the block, how, and whether each step judges it."""

    offset: int
    kind: int
    judged: bool


class BlockMemory:
    """What is the same in all runs of a recipe.

    Attributes:
        type: the block's class.
        variables: its variables by name.
        image: its memory with the start values of the recipe.
        places: where each variable lies in the memory.
        refusals: the members of its `Refusal` by their numbers.
        unset: the settable variables whose own start values are not allowed.
    """

    def __init__(self, recipe: Recipe) -> None:
        block = recipe.block()
        self.type = type(block)
        self.variables = recipe.variables
        known = described(self.type)
        self.image = memory_layout.image(block) if recipe.starts else known.memory
        layout = self.image.dtype
        self.places = {
            v.name: Place(memory_layout.offset(layout, v.name), KINDS[v.kind], v.judged)
            for v in self.variables.values()
        }
        self.unset = {v.name for v in self.variables.values() if v.settable and not v.allows(v.start)}
        self.refusals = known.refusals

    def table(self, names: Iterable[str]) -> Array:
        """The places of variables, as PLACE.

        Raises:
            UserError: the block has no variable of a name.
        """
        found = (choose(self.places, name, f"variable of {self.type.__name__}") for name in names)
        return np.array([(place.offset, place.kind) for place in found], PLACE)


def block_memory(recipe: Recipe) -> BlockMemory:
    """What is the same in all runs of a recipe; of a block as it is declared it is made once, in milliseconds."""
    return BlockMemory(recipe) if recipe.starts or recipe.turned else _declared(recipe.name)


@cache
def _declared(name: str) -> BlockMemory:
    return BlockMemory(Recipe(name))


@lru_cache(maxsize=32)
def _setting_times(scan: float, stop_time: float, after: float) -> Reals:
    """When a reaction sets that is seen at each of the scans, in s."""
    return rounded(scans(scan, stop_time) + after)


class RunTables:
    """The tables of one run, which live as long as it.

    Attributes:
        known: the settings of the scenario, in the order of time.
        judged: the names of the variables in them that each step judges.
        target: what is recorded: time, axis, outputs; a column each.
    """

    def __init__(self, scenario: Scenario, block: BlockMemory, outputs: int) -> None:
        """`outputs`: how many are recorded."""
        self.scenario, self.block = scenario, block
        self.known = sorted(scenario.settings, key=attrgetter("at"))
        self.judged: set[str] = set()
        self.points = points(scenario, scenario.step_size)
        self.scans = scans(scenario.scan, scenario.stop_time) if scenario.reacts else NEVER
        self.assignments, self.bundles = self._given()
        self._times = [_setting_times(scenario.scan, scenario.stop_time, r.after) for r in scenario.reactions]
        self.reactions = self._reactions()
        self.events = self._events()
        self.breaks, self.motions = self._axis(len(self.scans) + 1 if outputs else 2)
        self._seen = self._telegrams()
        # A step ends at a known point, at a look or at a setting, each of which is behind it then.
        room = len(self.points) + len(self.scans) + len(self.events)
        self.target = np.empty((WIDTH + outputs, room if outputs else 0))

    def _given(self) -> tuple[Array, Array]:
        """All that settings and reactions set: the assignments, and which of them are made together."""
        given: list[tuple[Mapping[str, Any], Mapping[str, Any]]]
        given = [(s.values, {}) for s in self.known] + [(r.set, r.add) for r in self.scenario.reactions]
        rows: list[tuple[int, int, int, int, float]] = []
        bundles = []
        for values, more in given:
            first = len(rows)
            rows += [self._assignment(name, value, 0) for name, value in values.items()]
            rows += [self._assignment(name, value, 1) for name, value in more.items()]
            bundles.append((first, len(rows)))
        return np.array(rows, ASSIGNMENT), np.array(bundles, BUNDLE)

    def _assignment(self, name: str, value: Any, adds: int) -> tuple[int, int, int, int, float]:
        place = self.block.places[name]
        if place.judged:
            self.judged.add(name)
        real = place.kind == KINDS["Real"]
        return place.offset, place.kind, adds, 0 if real else int(value), float(value) if real else 0.0

    def _reactions(self) -> Array:
        """What is reacted to, with the times at which it sets."""
        rows = []
        for i, (r, at) in enumerate(zip(self.scenario.reactions, self._times, strict=True)):
            c, place = r.condition, self.block.places[r.condition.name]
            condition = (place.offset, place.kind, COMPARISONS[c.comparison], c.value, MARGIN * max(1.0, abs(c.value)))
            times = -1 if r.times is None else r.times
            rows.append((*condition, address(at), times, len(self.known) + i, 0, 0))
        return np.array(rows, REACTION)

    def _events(self) -> Array:
        """Those that are known, and room for those of reactions: what becomes true at each second scan at most."""
        most = (len(self.scans) + 1) // 2
        often = (most if r.times is None else min(r.times, most) for r in self.scenario.reactions)
        events = np.empty(len(self.known) + sum(often), EVENT)
        events["at"][: len(self.known)] = [s.at for s in self.known]
        events["what"][: len(self.known)] = np.arange(len(self.known))
        return events

    def _axis(self, room: int) -> tuple[Reals, Reals]:
        """The breaks and motions of the script; of a master with a drive the first ones, with room for so many."""
        master = self.scenario.master
        if not self.scenario.drive:
            return np.array(master.breaks), master.table()
        breaks, motions = np.empty(room), np.empty((room, 4))
        begin = master.at(0.0)
        breaks[0], motions[0] = 0.0, (begin.position, begin.velocity, 0.0, 0.0)
        return breaks, motions

    def run(self, memory: int) -> tuple[Any, ...]:
        """The row of RUN, for a block whose memory has this address."""
        s = self.scenario
        mode = s.start.get("master.input_mode", MasterInput.START_OF_STEP)
        head = (memory, CLOSE * s.step_size, s.stop_time, s.period, mode == MasterInput.END_OF_STEP)
        times = (address(self.points), len(self.points), address(self.scans), len(self.scans), LOOK * s.scan)
        events = (address(self.events), 0, len(self.known), address(self.bundles), address(self.assignments))
        reactions = (address(self.reactions), len(self.reactions))
        motions = len(self.motions) if not s.drive else 1
        axis = (address(self.breaks), address(self.motions), motions, *self._remote(), *self._drive())
        return (*head, *times, *events, *reactions, *axis, *self._columns(), 0, 0.0, 0.0, Cause.NONE, 0, 0, 0)

    def _telegrams(self) -> tuple[Array, Array]:
        """Index and motion in the telegram that each cycle sees of a remote axis."""
        if not self.scenario.remote:
            return NEVER, NEVER
        seen = self.scenario.remote.telegrams
        return np.array(seen.cycle_index, np.int64), np.ascontiguousarray(seen.motion)

    def _remote(self) -> tuple[int, int, float]:
        if not self.scenario.remote:
            return 0, 0, 0.0
        index, motion = self._seen
        return address(index), address(motion), self.scenario.remote.clocks.task_cycle

    def _drive(self) -> tuple[int, int, float, float, float]:
        s = self.scenario
        if not s.drive:
            return -1, 0, 0.0, 0.0, 0.0
        place = self.block.places[s.drive.follows]
        return place.offset, place.kind, -expm1(-s.scan / s.drive.time_constant), s.drive.max_acceleration, s.scan

    def _columns(self) -> tuple[int, int, int, int]:
        if not self.target.size:
            return 0, 0, 0, 0
        time, distance = address(self.target), self.target.strides[0]
        return time, time + distance, time + WIDTH * distance, distance

    def recording(self, run: Any, outputs: Sequence[str]) -> Recording:
        """What a run that has ended has recorded; `run`: its row of RUN."""
        n, room = run["count"].item(), self.target.shape[1]
        axis = self.target.ravel()[room : room + 4 * n].reshape(n, 4)
        values = dict(zip(outputs, self.target[WIDTH:, :n], strict=True))
        script = self.scenario.master
        if self.scenario.drive:
            laid = run["motion_count"].item()
            script = _Driven(self.breaks[:laid], self.motions[:laid])
        return Recording(self.target[0, :n], values, axis, [], self.settings(run["taken"].item()), self.unmet, script)

    @property
    def unmet(self) -> list[Unmet]:
        """The reactions that happened less often than they could have."""
        often = self.reactions["happened"].tolist()
        return [Unmet(r, n) for r, n in zip(self.scenario.reactions, often, strict=True) if n < r.least]

    def settings(self, taken: int) -> list[Setting]:
        """All that was set in a run, in the order in which it was: so many settings."""
        s, found = self.scenario, []
        added = {name for r in s.reactions for name in r.add}
        present = {name: s.start.get(name, self.block.variables[name].start) for name in added}
        for at, what in self.events[:taken].tolist():
            if what < len(self.known):
                setting = self.known[what]
            else:
                due = s.reactions[what - len(self.known)]
                setting = Setting(at, {**due.set, **{name: present[name] + more for name, more in due.add.items()}})
            present |= {name: value for name, value in setting.values.items() if name in present}
            found.append(setting)
        return found


class _Driven(Script):
    """The script of a master that has followed a velocity; its motions are made when somebody asks for them."""

    def __init__(self, breaks: Reals, motions: Reals) -> None:
        self.breaks = breaks.tolist()
        self._table = motions

    @cached_property
    def motions(self) -> list[Motion]:  # type: ignore[override]
        return [Motion(*row) for row in self._table.tolist()]
