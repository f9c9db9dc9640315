"""A machine that cuts to length, as a plan knows it: its data, and what each kind of machine answers."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

from motionsync.cutting.interface import LateMode, Source, StartMode
from motionsync.master import MasterInput
from motionsync.var import Unit

from ..errors import UserError
from ..interface.recipe import Recipe
from ..interface.stepper import RefusedError, Stepper
from ..interface.units import unit_name
from ..scenario.evaluate.expectations import Check
from ..scenario.load import Load
from ..scenario.recording import Reals
from .prediction import CuttingRun, Prediction


class LimitRow(NamedTuple):
    """What the page says of a limit or a need: its name, the parameters that set it, what it limits."""

    name: str
    parameters: str
    limits: str


@dataclass(frozen=True)
class Machine(ABC):
    """A machine, and what it cuts. Its kinds are the subclasses: `saw.py`, `knife.py`.

    Attributes:
        kind: the name of the kind, as the option `--machine` has it.
        block: the block that is this kind of machine.
        tool: what carries the blade.
        bound_colours: what limits such a machine, with a colour each.
        part_colours: the parts of its cycle in their sequence, with a colour each.
        needs: what a cycle needs in addition to the limits of its axis.
        state_names: the states of the block in a cycle, with the name of the part that each belongs to.
        limit_rows: the limits and needs, as the page explains them.
        above_the_curve: what happens on a line that is faster than predicted, as the page explains it.
        title: of the page.
        name: of the folder for the page.
        origin: where the data come from, in words; empty: from the command line.
        recipe: the block's FMU.
        unit, slave_unit: the units of positions of material and line, and of the slave, keys of BASES.
        start: values of parameters and inputs of the block, by name; the others have their own start values.
        load: what the slave moves; None: this is not known.
        orders: the lengths that the machine's scenario cuts; empty: there is no scenario.
        line_velocity: the greatest velocity of the line in it, u/s; None: there is none.
    """

    kind: ClassVar[str]
    block: ClassVar[str]
    tool: ClassVar[str]
    bound_colours: ClassVar[Mapping[str, str]]
    part_colours: ClassVar[Mapping[str, str]]
    needs: ClassVar[Sequence[str]]
    state_names: ClassVar[Mapping[int, str]]
    limit_rows: ClassVar[Sequence[LimitRow]]
    above_the_curve: ClassVar[str]

    title: str
    name: str
    origin: str
    recipe: Recipe
    unit: str
    slave_unit: str
    start: Mapping[str, Any]
    load: Load | None = None
    orders: tuple[float, ...] = ()
    line_velocity: float | None = None

    @classmethod
    def default(cls) -> Self:
        """The machine with the block's own start values."""
        title = f"A machine with {cls.block}"
        recipe = Recipe(cls.block)
        return cls(title, cls.kind, "", recipe, "mm", recipe.slave_unit or "mm", {})

    def with_units(self, unit: str, slave_unit: str = "") -> Self:
        """The machine with these units; `slave_unit`: empty: that of such a machine."""
        return replace(self, unit=unit, slave_unit=slave_unit or self.recipe.slave_unit or unit)

    def with_start(self, values: Mapping[str, Any]) -> Self:
        """The machine with other values of some parameters or inputs."""
        return replace(self, start={**self.start, **values})

    def value(self, name: str) -> Any:
        """The value of a parameter or input."""
        return self.start.get(name, self.recipe.variables[name].start)

    def unit_of(self, kind: Unit) -> str:
        """The name of a unit of the material and the line."""
        return unit_name(kind, self.unit)

    def slave_unit_of(self, kind: Unit) -> str:
        """The name of a unit of the slave."""
        return unit_name(kind, self.slave_unit)

    @cached_property
    def initialized_block(self) -> Any:
        """The block with these data, from which the predictions are taken.

        Raises:
            UserError: the block refuses these data.
        """
        stepper = Stepper(self.recipe.block())
        try:
            stepper.initialize(self.start)
        except RefusedError as e:
            raise UserError(f"{self.origin}: {e}" if self.origin else str(e)) from None
        return stepper.block

    def pitch(self, length: float) -> float:
        """The distance of two cuts, in u of the master, that gives pieces of this length, in u of true material."""
        return (length + self._lost_length) / float(self.value("material_factor"))

    def length(self, pitch: float) -> float:
        """The length of a piece, in u of true material, of two cuts at this distance, in u of the master."""
        return pitch * float(self.value("material_factor")) - self._lost_length

    @property
    def _lost_length(self) -> float:
        """What each piece takes of the material in addition to its own length."""
        return float(self.value("kerf")) + float(self.value("length_correction"))

    def start_values(self, length: float) -> dict[str, Any]:
        """The start values of a run: the machine starts by itself, and cuts pieces of this length only."""
        return {
            **self.start,
            "auto_start": True,
            "length": length,
            "source": Source.LENGTH,
            "start_mode": StartMode.FRONT,
            "late_mode": LateMode.SKIP,
            "master.input_mode": MasterInput.START_OF_STEP,
            "master.period": 0.0,
            **dict.fromkeys(("hold", "waste", "start", "stop", "abort", "cut_now", "take_sample", "order.add"), False),
        }

    # --- what each kind answers ---

    @property
    @abstractmethod
    def greatest_velocity(self) -> float:
        """The greatest line velocity that some length admits; 0: there is none."""

    @property
    @abstractmethod
    def greatest_velocity_bound(self) -> str:
        """For which lengths the line may run so fast, and what limits it, in words after the velocity."""

    @abstractmethod
    def check(self) -> None:
        """Raise a UserError if the machine can cut nothing at all."""

    @abstractmethod
    def predict_greatest_velocity(self, length: float) -> Prediction:
        """Predict the greatest line velocity at which pieces of this length can be cut."""

    @abstractmethod
    def predict_shortest_length(self, velocity: float) -> Prediction:
        """Predict the length of the shortest pieces that can be cut at this line velocity, in u/s > 0."""

    @abstractmethod
    def pitch_range(self, slow_velocity: float) -> tuple[float, float]:
        """The pitches between which the line velocity is limited by the pitch: the shortest one at a slow line
        velocity, and the one beyond which all are alike."""

    @property
    def special_lengths(self) -> Sequence[float]:
        """Lengths at which the greatest line velocity has a corner or a step."""
        return ()

    @property
    def lead_in(self) -> float:
        """The travel of the master before the first piece of a run starts, in u."""
        return 0.0

    def first_velocity(self, velocity: float) -> float:
        """The line velocity up to the first cut of a run, where that has to be slower than this one."""
        return velocity

    @abstractmethod
    def check_cycle(self, prediction: Prediction, run: CuttingRun) -> Check:
        """Check a run of the block at a prediction: the parts of its cycle."""

    @abstractmethod
    def simulate_cycle(self, length: float, velocity: float, steps: int) -> Reals:
        """Simulate one cycle with pieces of this length: time since its start, position, velocity, acceleration of the
        slave, and state, a column each."""

    @property
    @abstractmethod
    def cycle_limits(self) -> tuple[Sequence[float], Sequence[float], Sequence[float]]:
        """The limits of the slave's position, velocity and acceleration in a cycle, with sign."""
