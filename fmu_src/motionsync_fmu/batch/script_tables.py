"""The tables from which compiled code runs scenarios: NumPy records with the layout of the C structures in
`scenario_run.h`. Addresses, offsets and distances are in bytes."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, cached_property, lru_cache
from math import expm1
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from motionsync.master import MasterInput

from ..compiler import memory_layout
from ..errors import choose
from ..interface.recipe import Recipe
from ..scenario.computed_columns import compute_columns
from ..scenario.recording import Reals, Recording
from ..scenario.run.reactions import COMPARISON_MARGIN, SAMPLE_LEAD, round_times, scan_times
from ..scenario.run.simulation import CLOSE, communication_points
from ..scenario.scenario import Scenario
from ..scenario.script import AxisMotion, Script
from ..scenario.settings import Setting, UnmetReaction
from .block_description import refusals_by_number, start_memory
from .loop_plan import Cause

Array = NDArray[Any]

WIDTH = 5  # columns of a recording before the outputs: the time, and the axis
NEVER = np.empty(0)

KINDS = {"Real": 0, "Integer": 1, "Enumeration": 1, "Boolean": 2}  # STORED_REAL, _WORD, _FLAG in scenario_run.h
COMPARISONS = {"<": 0, ">": 1, "==": 2}  # LESS, GREATER, EQUAL


def _record(reals: str, order: str) -> np.dtype[Any]:
    """A record of fields of 8 bytes in this order: doubles with the names in `reals`, integers with all others."""
    real = set(reals.split())
    return np.dtype([(name, np.float64 if name in real else np.int64) for name in order.split()])


FIELD = _record("", "offset kind")
LIMITED = _record("least greatest smallest zero", "offset least greatest smallest zero")
ASSIGNMENT = _record("real", "offset kind adds word real")
EVENT = _record("at", "at what")
BUNDLE = _record("", "first last")
REACTION = _record("value margin", "offset kind comparison value margin at times what held happened")
ENCODER = _record(
    "resolution noise delay scale amplitude length sample_time interval initial_position initial_velocity"
    " initial_acceleration start_velocity start_acceleration latest former",
    "resolution noise delay scale amplitude length sample_time interval seed initial_position initial_velocity"
    " initial_acceleration start_velocity start_acceleration number latest former",
)
RUN = _record(
    "close stop_time period before cycle gain most scan now step end",
    "block close stop_time period end_of_step points point_count scans scan_count before events taken event_count"
    " bundles assignments reactions reaction_count breaks motions motion_count motion_capacity indices telegrams cycle"
    " encoder follows kind gain most scan times axis values column count now step end cause number section next point",
)
SCENARIOS = _record(  # what all runs have in common, and the runs: rows of LIMITED, FIELD and RUN
    "longest closest",
    "position velocity acceleration cycle_index limits limit_count sinks sink_count longest closest reductions samples"
    " runs run_count",
)
LAYOUTS = {  # by the names of the structures in C
    "Field": FIELD,
    "Limited": LIMITED,
    "Assignment": ASSIGNMENT,
    "Event": EVENT,
    "Bundle": BUNDLE,
    "Reaction": REACTION,
    "Encoder": ENCODER,
    "Run": RUN,
    "Scenarios": SCENARIOS,
}


Locate = Callable[[Array], int]
"""Gives the address at which compiled code finds an array."""


def address(array: Array) -> int:
    """The address of an array in the memory of this process."""
    return array.ctypes.data


class Field(NamedTuple):
    """Where a variable is in the block's memory, how it is stored, and whether each step checks it."""

    offset: int
    kind: int
    checked: bool


class BlockMemory:
    """What is the same in all runs of a recipe.

    Attributes:
        type: the block's class.
        variables: its variables by name.
        image: its memory with the start values of the recipe.
        fields: where each variable is in the memory.
        refusals: the members of its `Refusal` by their numbers.
        unset: the settable variables whose own start values are not allowed.
    """

    def __init__(self, recipe: Recipe) -> None:
        block = recipe.block()
        self.type = block.__class__
        self.variables = recipe.variables
        self.image = memory_layout.image(block) if recipe.starts else start_memory(self.type)
        layout = self.image.dtype
        self.fields = {
            v.name: Field(memory_layout.offset(layout, v.name), KINDS[v.kind], v.checked)
            for v in self.variables.values()
        }
        self.unset = {v.name for v in self.variables.values() if v.settable and not v.allows(v.start)}
        self.refusals = refusals_by_number(self.type)

    def table(self, names: Iterable[str]) -> Array:
        """Where variables are, as FIELD.

        Raises:
            UserError: the block has no variable of a name.
        """
        fields = (choose(self.fields, name, f"variable of {self.type.__name__}") for name in names)
        return np.array([(field.offset, field.kind) for field in fields], FIELD)


def block_memory(recipe: Recipe) -> BlockMemory:
    """What is the same in all runs of a recipe; of a block as it is declared it is made once, in milliseconds."""
    return BlockMemory(recipe) if recipe.starts or recipe.causality_overrides else _declared(recipe.name)


@cache
def _declared(name: str) -> BlockMemory:
    return BlockMemory(Recipe(name))


@lru_cache(maxsize=32)
def _setting_times(scan: float, stop_time: float, after: float) -> Reals:
    """The times at which a reaction sets its values if it happens at each of the scans, in s."""
    return round_times(scan_times(scan, stop_time) + after)


class RunTables:
    """The tables of one run, which live as long as it.

    Attributes:
        timed: the settings of the scenario, in the order of time.
        checked: the names of the variables in them that each step checks.
        shape: of what is recorded: time, axis, outputs, a column each; large enough for all points.
        target: an array of this shape, which the caller has to provide.
    """

    target: Reals

    def __init__(self, scenario: Scenario, block: BlockMemory, outputs: int, locate: Locate = address) -> None:
        """`outputs`: how many are recorded; `locate`: of the memory in which the compiled code runs."""
        self.scenario, self.block, self._locate = scenario, block, locate
        self.timed = sorted(scenario.settings, key=attrgetter("at"))
        self.checked: set[str] = set()
        self.points = communication_points(scenario, scenario.step_size)
        self.scans = scan_times(scenario.scan, scenario.stop_time) if scenario.reacts else NEVER
        self.assignments, self.bundles = self._assignments()
        self._times = [_setting_times(scenario.scan, scenario.stop_time, r.after) for r in scenario.reactions]
        self.reactions = self._reactions()
        self.events = self._events()
        self.breaks, self.motions = self._axis(len(self.scans) + 1 if outputs else self._motions_needed())
        self.encoder = self._encoder()
        seen = scenario.remote and scenario.remote.telegrams  # by each cycle of a remote axis
        self._seen = (
            (np.array(seen.cycle_index, np.int64), np.ascontiguousarray(seen.motion)) if seen else (NEVER, NEVER)
        )
        # A step ends at a point of this table, at a sample or at a setting, each of which is behind it then.
        capacity = len(self.points) + len(self.scans) + len(self.events)
        self.shape = (WIDTH + outputs, capacity if outputs else 0)

    def _assignments(self) -> tuple[Array, Array]:
        """All that settings and reactions set: the assignments, and which of them are made together."""
        values_and_additions: list[tuple[Mapping[str, Any], Mapping[str, Any]]]
        values_and_additions = [(s.values, {}) for s in self.timed] + [(r.set, r.add) for r in self.scenario.reactions]
        rows: list[tuple[int, int, int, int, float]] = []
        bundles = []
        for values, additions in values_and_additions:
            first = len(rows)
            rows += [self._assignment(name, value, 0) for name, value in values.items()]
            rows += [self._assignment(name, value, 1) for name, value in additions.items()]
            bundles.append((first, len(rows)))
        return np.array(rows, ASSIGNMENT), np.array(bundles, BUNDLE)

    def _assignment(self, name: str, value: Any, adds: int) -> tuple[int, int, int, int, float]:
        field = self.block.fields[name]
        if field.checked:
            self.checked.add(name)
        is_real = field.kind == KINDS["Real"]
        return field.offset, field.kind, adds, 0 if is_real else int(value), float(value) if is_real else 0.0

    def _reactions(self) -> Array:
        """The reactions, with the times at which they set values."""
        rows = []
        for i, (r, at) in enumerate(zip(self.scenario.reactions, self._times, strict=True)):
            c, field = r.condition, self.block.fields[r.condition.name]
            condition = (
                field.offset,
                field.kind,
                COMPARISONS[c.comparison],
                c.value,
                COMPARISON_MARGIN * max(1.0, abs(c.value)),
            )
            times = -1 if r.times is None else r.times
            rows.append((*condition, self._locate(at), times, len(self.timed) + i, 0, 0))
        return np.array(rows, REACTION)

    def _events(self) -> Array:
        """The events of the settings, and space for those of reactions: each happens at every second scan at most."""
        limit = (len(self.scans) + 1) // 2
        counts = (limit if r.times is None else min(r.times, limit) for r in self.scenario.reactions)
        events = np.empty(len(self.timed) + sum(counts), EVENT)
        events["at"][: len(self.timed)] = [s.at for s in self.timed]
        events["what"][: len(self.timed)] = np.arange(len(self.timed))
        return events

    def _axis(self, capacity: int) -> tuple[Reals, Reals]:
        """The breaks and motions of the script; of a master with a drive the first ones, in tables for so many."""
        master = self.scenario.master
        if not self.scenario.drive:
            return np.array(master.breaks), master.table()
        breaks, motions = np.empty(capacity), np.empty((capacity, 4))
        start = master.at(0.0)
        breaks[0], motions[0] = 0.0, (start.position, start.velocity, 0.0, 0.0)
        return breaks, motions

    def _motions_needed(self) -> int:
        """How many motions of a master with a drive the run needs at the same time: those of the present scan, and
        those that the encoder measures, which are as old as its delay and two samples."""
        s, e = self.scenario, self.scenario.encoder
        oldest = e.delay + 2.0 * (e.sample_time or s.step_size) if e else 0.0
        return min(len(self.scans) + 1, 4 + int(oldest / s.scan)) if e else 2

    def _encoder(self) -> Array:
        """The encoder, as ENCODER; empty: there is none."""
        s, e = self.scenario, self.scenario.encoder
        if not e:
            return np.empty(0, ENCODER)
        shape = (e.resolution, e.noise, e.delay, e.scale, e.runout_amplitude, e.runout_length)
        first = s.master.initial
        initial = (first.position, first.velocity, first.acceleration)
        times = (e.sample_time, e.sample_time or s.step_size)
        return np.array([(*shape, *times, e.seed, *initial, *e.start_motion(s.master), -1, 0.0, 0.0)], ENCODER)

    def run(self, memory: int) -> tuple[Any, ...]:
        """The row of RUN, for a block whose memory has this address."""
        s, address = self.scenario, self._locate
        mode = s.start.get("master.input_mode", MasterInput.START_OF_STEP)
        head = (memory, CLOSE * s.step_size, s.stop_time, s.period, mode == MasterInput.END_OF_STEP)
        times = (address(self.points), len(self.points), address(self.scans), len(self.scans), SAMPLE_LEAD * s.scan)
        events = (address(self.events), 0, len(self.timed), address(self.bundles), address(self.assignments))
        reactions = (address(self.reactions), len(self.reactions))
        motions = len(self.motions) if not s.drive else 1
        table = (address(self.breaks), address(self.motions), motions, len(self.motions))
        encoder = address(self.encoder) if s.encoder else 0
        axis = (*table, *self._remote(), encoder, *self._drive())
        return (*head, *times, *events, *reactions, *axis, *self._columns(), 0, 0.0, 0.0, 0.0, Cause.NONE, 0, 0, 0, 0)

    def _remote(self) -> tuple[int, int, float]:
        if not self.scenario.remote:
            return 0, 0, 0.0
        index, motion = map(self._locate, self._seen)
        return index, motion, self.scenario.remote.clocks.task_cycle

    def _drive(self) -> tuple[int, int, float, float, float]:
        s = self.scenario
        if not s.drive:
            return -1, 0, 0.0, 0.0, 0.0
        field = self.block.fields[s.drive.follows]
        return field.offset, field.kind, -expm1(-s.scan / s.drive.time_constant), s.drive.max_acceleration, s.scan

    def _columns(self) -> tuple[int, int, int, int]:
        if not self.target.size:
            return 0, 0, 0, 0
        time, distance = self._locate(self.target), self.target.strides[0]
        return time, time + distance, time + WIDTH * distance, distance

    def recording(self, run: Any, outputs: Sequence[str]) -> Recording:
        """The recording of a run that has ended; `run`: its row of RUN."""
        n, capacity = run["count"].item(), self.target.shape[1]
        axis = self.target.ravel()[capacity : capacity + 4 * n].reshape(n, 4)
        values = dict(zip(outputs, self.target[WIDTH:, :n], strict=True))
        script = self.scenario.master
        if self.scenario.drive:
            count = run["motion_count"].item()
            script = _Driven(self.breaks[:count], self.motions[:count], script.initial)
        time, settings = self.target[0, :n], self.settings(run["taken"].item())
        scenario = self.scenario
        computed = compute_columns(scenario.servo, scenario.load, scenario.slave_period, time, values)
        return Recording(time, values, axis, [], settings, self.unmet, script, computed)

    @property
    def unmet(self) -> list[UnmetReaction]:
        """The reactions that happened less often than they could have."""
        counts = self.reactions["happened"].tolist()
        return [UnmetReaction(r, n) for r, n in zip(self.scenario.reactions, counts, strict=True) if n < r.least]

    def settings(self, taken: int) -> list[Setting]:
        """All that was set in a run, in the order in which it was: so many settings."""
        s, settings = self.scenario, []
        added = {name for r in s.reactions for name in r.add}
        present = {name: s.start.get(name, self.block.variables[name].start) for name in added}
        for at, what in self.events[:taken].tolist():
            if what < len(self.timed):
                setting = self.timed[what]
            else:
                reaction = s.reactions[what - len(self.timed)]
                setting = Setting(at, {**reaction.set, **{name: present[name] + x for name, x in reaction.add.items()}})
            present |= {name: value for name, value in setting.values.items() if name in present}
            settings.append(setting)
        return settings


class _Driven(Script):
    """The script of a master that has followed a velocity; its motions are made when they are read."""

    def __init__(self, breaks: Reals, motions: Reals, initial: AxisMotion) -> None:
        self.initial = initial
        self.breaks = self.points = breaks.tolist()
        self._table = motions

    @cached_property
    def motions(self) -> list[AxisMotion]:  # type: ignore[override]
        return [AxisMotion(*row) for row in self._table.tolist()]
