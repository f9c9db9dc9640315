"""A scenario's run as the package `runner` carries it: its tables, and what has come of them."""

from array import array
from collections.abc import Mapping, Sequence
from functools import cached_property
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np

from motionsync.master import MasterInput

from ...interface.roles import MOTION
from ...runner.axis import MOTION as WIDTH
from ...runner.axis import Axis
from ...runner.program import Comparison
from ...runner.run import Run
from ..computed_columns import compute_columns
from ..recording import Reals, Recording
from ..scenario import AtTime, Scenario, Within
from ..script import AxisMotion, Script
from ..settings import Setting, UnmetReaction

Assigned: TypeAlias = tuple[Mapping[str, Any], Mapping[str, Any]]  # what is set together, and what is added
COMPARISONS = {"<": Comparison.LESS, ">": Comparison.GREATER, "==": Comparison.EQUAL}


class RunTables:
    """The run of a scenario.

    Attributes:
        run: what carries it; its series live as long as this object.
        sets: the names of the variables that its program sets.
        sees: those of the outputs that its program sees.
        inputs: those of the inputs of the axis: position, velocity, acceleration, and the cycle index of a remote one.
    """

    def __init__(self, scenario: Scenario, step_size: float, remembers: bool = True) -> None:
        """`step_size`: of the run. `remembers`: whether all motions of a master with a drive are kept, for a
        recording."""
        s = self.scenario = scenario
        self._timed = sorted(s.settings, key=attrgetter("at"))
        assigned: list[Assigned] = [(setting.values, {}) for setting in self._timed] + [
            (r.set, r.add) for r in s.reactions
        ]
        self.sets = tuple(dict.fromkeys(name for values, added in assigned for name in (*values, *added)))
        followed = {s.drive.follows} if s.drive else set()
        self.sees = tuple(sorted({r.condition.name for r in s.reactions} | followed))
        part = s.remote.names.part if s.remote else "master"
        self.inputs = [f"{part}.{name}" for name in MOTION] + ([s.remote.names.cycle_index] if s.remote else [])
        self._scans = int(s.stop_time / s.scan) + 1 if s.reacts else 0  # or one less
        self.run = run = Run()
        run.period = s.period
        run.is_ahead = s.start.get("master.input_mode", MasterInput.START_OF_STEP) == MasterInput.END_OF_STEP
        self._set_points(step_size)
        self._set_program(assigned)
        self._set_axis(step_size, remembers)
        self._set_sight(step_size)

    def _set_points(self, step_size: float) -> None:
        s, points = self.scenario, self.run.points
        points.step_size, points.stop_time = step_size, s.stop_time
        points.scan = s.scan if s.reacts else 0.0
        points.has_drive = s.drive is not None
        named = [setting.at for setting in s.settings]
        named += [e.at for e in s.expectations if isinstance(e, AtTime)]
        named += [t for e in s.expectations if isinstance(e, Within) for t in (e.begin, e.end)]
        points.named = array("d", sorted(t for t in (*named, s.stop_time) if t <= s.stop_time))

    @property
    def most_points(self) -> int:
        """The run has at most so many communication points: each is one of these times, or that of a reaction."""
        points, axis = self.run.points, self.run.axis
        grid = int(points.stop_time / points.step_size * (1.0 + 1e-12)) + 1
        breaks = 0 if axis.is_recorded or points.has_drive else axis.count
        return (
            grid + len(points.named) + breaks + 2 * self._scans + len(self.run.program.at)
        )  # a sample and a point for each scan

    def _set_program(self, assigned: Sequence[Assigned]) -> None:
        s, p = self.scenario, self.run.program
        kinds = {"Real": float, "Boolean": bool}
        self._types = [kinds.get(s.recipe.variables[name].kind, int) for name in self.sets]
        number = {name: i for i, name in enumerate(self.sets)}
        rows = [
            [(number[n], float(x), adds) for adds, part in enumerate(both) for n, x in part.items()]
            for both in assigned
        ]
        first = [0]
        for row in rows:
            first.append(first[-1] + len(row))
        flat = [assignment for row in rows for assignment in row]
        p.first, p.target = array("q", first), array("q", [target for target, _, _ in flat])
        p.amount, p.adds = array("d", [x for _, x, _ in flat]), array("q", [adds for _, _, adds in flat])
        declared = s.recipe.variables
        p.values = array("d", [float(s.start.get(name, declared[name].start)) for name in self.sets])
        p.outputs = array("d", bytes(8 * len(self.sees)))
        # A reaction happens at every second scan at most.
        most = (self._scans + 1) // 2
        capacity = sum(most if r.times is None else min(r.times, most) for r in s.reactions)
        p.at = array("d", [setting.at for setting in self._timed]) + array("d", bytes(8 * capacity))
        p.what = array("q", range(len(self._timed))) + array("q", bytes(8 * capacity))
        p.count = p.settings = len(self._timed)
        r = p.reactions
        r.output = array("q", [self.sees.index(reaction.condition.name) for reaction in s.reactions])
        r.comparison = array("q", [COMPARISONS[reaction.condition.comparison] for reaction in s.reactions])
        r.value = array("d", [reaction.condition.value for reaction in s.reactions])
        r.after = array("d", [reaction.after for reaction in s.reactions])
        r.most = array("q", [-1 if reaction.times is None else reaction.times for reaction in s.reactions])
        r.held, r.happened = (array("q", bytes(8 * len(s.reactions))) for _ in range(2))
        if s.drive:
            p.follows, p.max_acceleration = self.sees.index(s.drive.follows), s.drive.max_acceleration
            p.gain = s.drive.gain(s.scan)

    def _set_axis(self, step_size: float, remembers: bool) -> None:
        s = self.scenario
        if not s.drive:
            self.run.axis = s.master.axis()
            return
        begin = s.master.at(0.0)
        self.run.axis = axis = Script(begin.position, begin.velocity, 0.0, ()).axis()
        more = self._scans if remembers else self._motions_needed(step_size)
        axis.breaks += array("d", bytes(8 * more))
        axis.motions += array("d", bytes(8 * WIDTH * more))

    def _set_sight(self, step_size: float) -> None:
        """Set what is between the axis and the block."""
        s = self.scenario
        if s.encoder:
            self.run.has_encoder = True
            s.encoder.set(self.run.encoder, step_size)
        if s.remote:
            self.run.is_remote = True
            self.run.telegrams = s.remote.seen()

    def _motions_needed(self, step_size: float) -> int:
        """How many motions of a master with a drive the run needs beside the present one: those of the present scan,
        and those that the encoder measures, which are as old as its delay and two samples."""
        s, e = self.scenario, self.scenario.encoder
        oldest = e.delay + 2.0 * (e.sample_time or step_size) if e else 0.0
        return min(self._scans, 3 + int(oldest / s.scan)) if e else 1

    # --- what has come of it ---

    def recording(self, time: Reals, values: dict[str, Reals], axis: Reals, messages: list[str]) -> Recording:
        """The recording of the run, which has ended: the outputs by name and the motion of the axis at all points."""
        s = self.scenario
        computed = compute_columns(s.servo, s.load, s.slave_period, time, values)
        return Recording(time, values, axis, messages, self.settings, self.unmet, self.script, computed)

    @property
    def axis_inputs(self) -> dict[str, float]:
        """The inputs of the axis for the present step."""
        run = self.run
        return dict(zip(self.inputs, (run.position, run.velocity, run.acceleration, run.cycle_index), strict=False))

    def set_since(self, taken: int) -> dict[str, Any]:
        """The variables that have been set since the program had taken so many settings, with their present values."""
        p = self.run.program
        bundles = p.what[taken : p.taken]
        targets = dict.fromkeys(p.target[i] for b in bundles for i in range(p.first[b], p.first[b + 1]))
        return {self.sets[k]: self._types[k](p.values[k]) for k in targets}

    @property
    def script(self) -> Script:
        """The axis of the run; that of a master with a drive as far as it has been determined."""
        return _Driven(self.run.axis, self.scenario.master.initial) if self.scenario.drive else self.scenario.master

    @property
    def unmet(self) -> list[UnmetReaction]:
        """The reactions that happened less often than they could have."""
        counts = self.run.program.reactions.happened
        return [UnmetReaction(r, n) for r, n in zip(self.scenario.reactions, counts, strict=True) if n < r.least]

    @property
    def settings(self) -> list[Setting]:
        """All that was set, in the order in which it was."""
        s, p, settings = self.scenario, self.run.program, []
        added = {name for r in s.reactions for name in r.add}
        present = {name: s.start.get(name, s.recipe.variables[name].start) for name in added}
        for at, what in zip(p.at[: p.taken], p.what[: p.taken], strict=True):
            if what < len(self._timed):
                setting = self._timed[what]
            else:
                reaction = s.reactions[what - len(self._timed)]
                setting = Setting(at, {**reaction.set, **{name: present[name] + x for name, x in reaction.add.items()}})
            present |= {name: value for name, value in setting.values.items() if name in present}
            settings.append(setting)
        return settings


class _Driven(Script):
    """The script of a master that has followed a velocity; its motions are made when they are read."""

    def __init__(self, axis: Axis, initial: AxisMotion) -> None:
        self.initial = initial
        self.breaks = self.points = list(axis.breaks[: axis.count])
        self._table = np.array(axis.motions[: WIDTH * axis.count]).reshape(-1, WIDTH)

    @cached_property
    def motions(self) -> list[AxisMotion]:  # type: ignore[override]
        return [AxisMotion(*row) for row in self._table.tolist()]
