"""A block in this process, driven by the names of its variables as a host drives an FMU."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from operator import attrgetter
from typing import Any, Self

from ..errors import choose
from .variables import Cell, cells, message_text, shown, variables_in_message


class RefusedError(Exception):
    """A block refused its initialization or a step. The text names the call, the reason and the values that matter.

    Attributes:
        refusal: the block's answer, a member of its `Refusal`.
    """

    def __init__(self, refusal: Any, text: str) -> None:
        super().__init__(text)
        self.refusal = refusal


class Cells(Mapping[str, Cell]):
    """All cells of a block by name. Blocks of one type have the same cells: a block's own are made as they are used."""

    def __init__(self, block: Any) -> None:
        block_type: type = type(block)
        self._block, self._of_type = block, _cells_of_type(block_type)

    def __getitem__(self, name: str) -> Cell:
        part, c = name.rpartition(".")[0], self._of_type[name]
        owner = attrgetter(part)(self._block) if part else self._block
        return Cell(name, owner, c.attribute, c.type, c.declaration, c.choices)

    def __contains__(self, name: object) -> bool:
        return name in self._of_type

    def __iter__(self) -> Iterator[str]:
        return iter(self._of_type)

    def __len__(self) -> int:
        return len(self._of_type)


@cache
def _cells_of_type(block_type: type) -> dict[str, Cell]:
    """The cells of a new block of this type."""
    return {cell.name: cell for cell in cells(block_type())}


@cache
def _reader(block_type: type, names: tuple[str, ...]) -> Callable[[Any], Any]:
    """A function that reads these cells of a block of this type, as a tuple if there are several."""
    for name in names:
        choose(_cells_of_type(block_type), name, f"variable of {block_type.__name__}")
    return attrgetter(*names)


class Stepper:
    """One instance of a block.

    Unlike an FMU, a stepper does not check whether a value is in the range of its variable.

    Attributes:
        block: the instance, for everything that a stepper does not offer.
        cells: all cells of the block by name; cells that are no variables are included.
    """

    def __init__(self, block: Any) -> None:
        self.block = block
        self.cells = Cells(block)
        self._type: type = type(block)
        self._set_cells: dict[str, Cell] = {}  # those that were set

    def __repr__(self) -> str:
        return f"Stepper of a {self._type.__name__}"

    def set(self, values: Mapping[str, Any]) -> Self:
        """Set cells.

        Raises:
            UserError: the block has no cell of a name.
        """
        for name, value in values.items():
            if name not in self._set_cells:
                self._set_cells[name] = choose(self.cells, name, f"variable of {self._type.__name__}")
            self._set_cells[name].set(value)
        return self

    def get(self, names: Iterable[str]) -> dict[str, Any]:
        """The present values of these cells."""
        names = tuple(names)
        return dict(zip(names, self.values(names), strict=True))

    def values(self, names: tuple[str, ...]) -> tuple[Any, ...]:
        """The present values of these cells, in this order."""
        if len(names) < 2:
            return tuple(self[name] for name in names)
        values: tuple[Any, ...] = _reader(self._type, names)(self.block)
        return values

    def __getitem__(self, name: str) -> Any:
        return _reader(self._type, (name,))(self.block)

    def initialize(self, values: Mapping[str, Any] | None = None) -> Self:
        """Set start values of parameters and inputs, then initialize.

        Raises:
            RefusedError: the block refuses.
        """
        self.set(values or {})
        if refusal := self.block.initialize():
            raise self._refused("initialize()", refusal)
        return self

    def step(self, h: float, values: Mapping[str, Any] | None = None) -> Self:
        """Set the inputs that belong to the present time, then step on by h seconds.

        Raises:
            RefusedError: the block refuses; its state has not changed, except for the inputs.
        """
        self.set(values or {})
        if refusal := self.block.step(h):
            raise self._refused(f"step({shown(h)})", refusal)
        return self

    def _refused(self, call: str, refusal: Any) -> RefusedError:
        text = message_text(refusal, variables_in_message(refusal, self.cells), self.__getitem__)
        return RefusedError(refusal, f"{self._type.__name__} refuses {call}: {text}")
