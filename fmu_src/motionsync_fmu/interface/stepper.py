"""A block in this process, driven by the names of its variables as a host drives an FMU."""

from collections.abc import Iterable, Mapping
from typing import Any, Self

from ..errors import choose
from .variables import cells, message_text, shown, variables_in_message


class RefusedError(Exception):
    """A block refused its initialization or a step. The text names the call, the reason and the values that matter.

    Attributes:
        refusal: the block's answer, a member of its `Refusal`.
    """

    def __init__(self, refusal: Any, text: str) -> None:
        super().__init__(text)
        self.refusal = refusal


class Stepper:
    """One instance of a block.

    Unlike an FMU, a stepper does not check whether a value is in the range of its variable.

    Attributes:
        block: the instance, for everything that a stepper does not offer.
        cells: all cells of the block by name; cells that are no variables are included.
    """

    def __init__(self, block: Any) -> None:
        self.block = block
        self.cells = {cell.name: cell for cell in cells(block)}

    def set(self, values: Mapping[str, Any]) -> Self:
        """Set cells.

        Raises:
            UserError: the block has no cell of a name.
        """
        for name, value in values.items():
            choose(self.cells, name, f"variable of {type(self.block).__name__}").set(value)
        return self

    def get(self, names: Iterable[str]) -> dict[str, Any]:
        """The present values of these cells."""
        return {name: self[name] for name in names}

    def __getitem__(self, name: str) -> Any:
        return choose(self.cells, name, f"variable of {type(self.block).__name__}").get()

    def initialize(self, values: Mapping[str, Any] | None = None) -> Self:
        """Set start values of parameters and inputs, then initialize.

        Raises:
            RefusedError: the block refuses.
        """
        self.set(values or {})
        self._raise_if_refused("initialize()", self.block.initialize())
        return self

    def step(self, h: float, values: Mapping[str, Any] | None = None) -> Self:
        """Set the inputs that belong to the present time, then step on by h seconds.

        Raises:
            RefusedError: the block refuses; its state has not changed, except for the inputs.
        """
        self.set(values or {})
        self._raise_if_refused(f"step({shown(h)})", self.block.step(h))
        return self

    def _raise_if_refused(self, call: str, refusal: Any) -> None:
        if refusal:
            text = message_text(refusal, variables_in_message(refusal, self.cells), self.__getitem__)
            raise RefusedError(refusal, f"{type(self.block).__name__} refuses {call}: {text}")
