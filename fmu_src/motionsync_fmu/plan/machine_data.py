"""The data of a machine that cuts to length, as start values of the block's own parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from motionsync.cut_to_length.machine_limits import Machine, max_line_velocity

from ..errors import UserError
from ..interface.recipe import Recipe
from ..interface.stepper import RefusedError, Stepper
from ..scenario.load import Load

BLOCK = "CutToLength"
ENDLESS_PITCH = 1e300  # with it the cycle time limits nothing


@dataclass(frozen=True)
class MachineData:
    """A machine, and what it cuts.

    Attributes:
        title: of the page.
        name: of the folder for the page.
        origin: where the data come from, in words; empty: from the command line.
        recipe: the block's FMU.
        unit: the unit of positions, a key of BASES.
        start: values of parameters and inputs of the block, by name; the others have their own start values.
        load: what the carriage moves; None: this is not known.
    """

    title: str
    name: str
    origin: str
    recipe: Recipe
    unit: str
    start: Mapping[str, Any]
    load: Load | None = None

    def value(self, name: str) -> Any:
        """The value of a parameter or input."""
        return self.start.get(name, self.recipe.variables[name].start)

    @cached_property
    def machine(self) -> Machine:
        """The machine data from which the block computes its predictions.

        Raises:
            UserError: the block refuses these data.
        """
        stepper = Stepper(self.recipe.block())
        try:
            stepper.initialize(self.start)
        except RefusedError as e:
            raise UserError(f"{self.origin}: {e}" if self.origin else str(e)) from None
        machine: Machine = stepper.block.carriage.machine
        return machine

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

    @cached_property
    def greatest_velocity(self) -> float:
        """The greatest admissible line velocity, however long the pieces are; 0: there is none."""
        return max_line_velocity(self.machine, ENDLESS_PITCH)
