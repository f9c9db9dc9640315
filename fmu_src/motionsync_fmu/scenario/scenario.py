"""A scenario: a scripted axis, commands over time, and expectations of the outputs.

`files.reader` reads it and validates it: all names exist in the block, and all values fit their variables.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from ..interface.recipe import Recipe
from ..interface.variables import Variable
from .computed_columns import computed_variables
from .cutting import CutSpec, PieceSpec
from .drive import Drive
from .encoder import Encoder
from .load import Load
from .remote_view import RemoteView
from .script import Script
from .servo import Servo
from .settings import OutputCondition, Reaction, Setting


@dataclass(frozen=True)
class AtTime:
    """Values that are expected at a time, in s, within a tolerance."""

    at: float
    values: Mapping[str, float]
    tolerance: float

    @property
    def names(self) -> tuple[str, ...]:
        """The variables whose values are expected."""
        return tuple(self.values)


@dataclass(frozen=True)
class When(OutputCondition):
    """The first time, in s, at which a condition is expected to hold.

    Attributes:
        tolerance: the tolerance of the time, in s; None: one step of the run, or one cycle of a cyclic block if that is
            longer.
    """

    time: float
    tolerance: float | None

    @property
    def names(self) -> tuple[str, ...]:
        """The variable of the condition."""
        return (self.name,)


@dataclass(frozen=True)
class Within:
    """Limits that are expected to hold at all communication points of an interval."""

    begin: float
    end: float
    limits: Mapping[str, tuple[float, float]]
    tolerance: float

    @property
    def names(self) -> tuple[str, ...]:
        """The variables whose values are expected."""
        return tuple(self.limits)


Expectation = AtTime | When | Within


@dataclass(frozen=True)
class Picture:
    """How the run of a scenario is drawn where it is a block's example.

    Attributes:
        shaded: a Boolean output; the picture is shaded where it is true. Empty: nothing is shaded.
        curves: further outputs, each with the label of a plot of its own.
        variants: the runs that are shown together: the name of each, and its further start values. Empty: the scenario
            itself is shown.
    """

    shaded: str = ""
    curves: Mapping[str, str] = field(default_factory=dict)
    variants: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """A checked scenario.

    Attributes:
        file: where it was read from.
        text: what was read.
        recipe: the FMU that runs it.
        unit: the unit of positions, for reports; the numbers of the FMU do not depend on it.
        slave_unit: the unit of the slave's positions, for a block whose axes may have different units; empty: the same
            as `unit`.
        step_size: the step size of the run, in s; `motionsync run --step-size` takes another one than the file has.
        scan: the cycle of the reactions' program, in s: the step size in the file, whatever the run's is.
        tolerance: the tolerance of the reference, relative to the greatest magnitude of each variable in it.
        master: the scripted axis; where it is a remote one, the true axis; where it has a drive, how it starts.
        encoder: what is between the true master and the inputs of the block; None: they are its true motion.
        remote: how the block sees a remote axis; None: the block has a master.
        settings: what is set, each at its time.
        reactions: what is set when an output fulfils a condition.
        cuts: how its cuts are checked; None: they are not.
        pieces: how the pieces are checked that the block reports; None: they are not.
        picture: how the scenario is drawn where it is a block's example.
        drive: what moves the master if it follows a velocity that the block requests; None: it is scripted.
        servo: what is between the setpoint and the tool; None: the tool is where the setpoint is.
        load: what the slave's axis moves; None: this is not known.
        overrides: the values that replace those of its file, as texts by name.
        step_bound: why the scenario is valid at its own step size only; empty: it is valid at every one.
    """

    file: Path
    text: str = field(compare=False)
    title: str
    source: str
    recipe: Recipe
    unit: str
    slave_unit: str
    stop_time: float
    step_size: float
    scan: float
    tolerance: float = 1e-9
    start: Mapping[str, Any]
    master: Script
    encoder: Encoder | None = None
    remote: RemoteView | None = None
    settings: tuple[Setting, ...]
    expectations: tuple[Expectation, ...]
    cuts: CutSpec | None = None
    pieces: PieceSpec | None = None
    picture: Picture = field(default_factory=Picture)
    reactions: tuple[Reaction, ...] = ()
    drive: Drive | None = None
    servo: Servo | None = None
    load: Load | None = None
    step_bound: str = ""
    overrides: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The name of the scenario's folder."""
        return self.file.resolve().parent.name

    @property
    def label(self) -> str:
        """The block and the name of the scenario's folder: `Gearing/ccw_direct`."""
        return f"{self.recipe.name}/{self.name}"

    def step_refusal(self, step_size: float) -> str:
        """Why the expectations cannot be checked at this step size, in s; empty if they can."""
        cycle = self.remote.clocks.task_cycle if self.remote else math.inf
        if step_size > cycle * (1.0 + 1e-9):
            return f"{self.recipe.name} works in cycles of {cycle:g} s, and a step of {step_size:g} s is longer"
        return self.step_bound if step_size != self.step_size else ""

    @property
    def period(self) -> float:
        """The master's period, in u; 0: it is a linear axis."""
        return float(self.start.get("master.period", 0.0))

    @property
    def slave_period(self) -> float:
        """The period of the slave's position, in u; 0: it is not wrapped."""
        return self.period_of("slave.position")

    def period_of(self, name: str) -> float:
        """The period of a variable that is a position, in u; 0: it is not wrapped."""
        period = self.columns[name].period
        return float(self.start.get(period, self.recipe.variables[period].start)) if period else 0.0

    @property
    def has_true_places(self) -> bool:
        """Whether it is known how far the places of material and tool are from where the block takes them to be.

        Of a recorded line only the measured positions are known."""
        return bool(self.encoder or self.servo) and not self.is_recorded

    @property
    def columns(self) -> dict[str, Variable]:
        """The variables of the block, and the columns that are computed after the run, by name."""
        computed = computed_variables(servo=self.servo is not None, load=self.load is not None)
        return {**self.recipe.variables, **computed}

    @property
    def is_recorded(self) -> bool:
        """Whether the line was recorded by an encoder, so that its true motion is not known."""
        return self.master.is_recorded

    @property
    def reacts(self) -> bool:
        """Whether inputs depend on outputs: then only a run determines them."""
        return bool(self.reactions or self.drive)

    def with_recorded_inputs(self, settings: Iterable[Setting], master: Script) -> Self:
        """The same scenario with the settings and the master's motion of a run in place of reactions and drive."""
        return replace(self, settings=tuple(settings), master=master, reactions=(), drive=None)
