"""A block's variables and cells, read from its declarations.

This module is part of the Python FMU. It must not import motionsync, which the FMU has under another name."""

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from decimal import Decimal
from enum import IntEnum
from functools import cache
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, get_type_hints

if TYPE_CHECKING:
    from motionsync.var import Declaration

LONGEST_STEP = 1e6  # s; a step may not be longer
QUIET_TIME = 10.0  # s; a code that has not come for so long has ended (`Report.EPISODES`)
SHOWN_DIGITS, COMPUTED_DIGITS = 12, 7  # of a value that was set, and of a computed one, in a log line
LEAST_INTEGER, GREATEST_INTEGER = -(2**31), 2**31 - 1  # of FMI's Integers
ORDER = {"input": 0, "output": 1, "parameter": 2, "local": 3}  # of the variables, by the causality that is declared
KINDS = {float: "Real", int: "Integer", bool: "Boolean"}


@dataclass(frozen=True)
class Cell:
    """One field that holds a value: `name` is its path in the block, `owner` the object that has it."""

    name: str
    owner: Any = field(repr=False)
    attribute: str
    type: type
    declaration: "Declaration | None"
    choices: frozenset[int] | None = field(repr=False)  # an enumeration's values

    def get(self) -> Any:
        return getattr(self.owner, self.attribute)

    def set(self, value: Any) -> None:
        """Set the value. A number that is no member of the enumeration is stored, and refused at initialization."""
        fits = self.choices is None or value in self.choices
        setattr(self.owner, self.attribute, self.type(value) if fits else int(value))


@dataclass(frozen=True)
class Variable:
    """A declared cell. Its index in `variables()` is its value reference in both flavours.

    Attributes:
        causality: what the FMU shows; the block may declare another one, which `declaration` has.
        period: the parameter that holds the period of this position; empty: it never wraps.
    """

    cell: Cell
    declaration: "Declaration"
    depends: tuple[str, ...]
    start: Any
    causality: str
    period: str = ""

    @property
    def name(self) -> str:
        return self.cell.name

    @property
    def kind(self) -> str:
        """FMI's type: Real, Integer, Boolean or Enumeration."""
        return KINDS.get(self.cell.type, "Enumeration")

    @property
    def variability(self) -> str:
        if self.causality == "parameter":
            return "tunable" if self.declaration.tunable or self.declaration.causality == "input" else "fixed"
        return "continuous" if self.kind == "Real" and not self.declaration.discrete else "discrete"

    @property
    def settable(self) -> bool:
        return self.causality in ("input", "parameter")

    @property
    def checked(self) -> bool:
        """Whether each step checks the value's range; only the initialization checks the other variables.

        Each step checks the Real inputs: those that the FMU shows, and those that the block declares and relies on."""
        return self.kind == "Real" and "input" in (self.causality, self.declaration.causality)

    @property
    def restricted(self) -> bool:
        """Whether more than a least and a greatest value limits the range."""
        d = self.declaration
        return d.above > -inf or d.below < inf or d.smallest > 0.0 or not d.zero

    @property
    def choices(self) -> list[Any]:
        """The members of an enumeration, each with `name`, `value` and `description`; empty for other types."""
        return members(self.cell.type)

    def allows(self, value: Any) -> bool:
        """Whether a value, a number or Boolean, is within the declared limits. NaN never is."""
        if self.cell.choices is not None:
            return value in self.cell.choices
        if self.cell.type is bool:
            return True
        fits = self.cell.type is not int or LEAST_INTEGER <= value <= GREATEST_INTEGER
        return fits and self.declaration.allows(value)

    def text(self, value: float) -> str:
        """A value as people read it: an enumeration's member by name, true or false, a number with ten digits."""
        if self.kind == "Boolean" and value in (0, 1):
            return "true" if value else "false"
        return next((str(member.name) for member in self.choices if member == value), f"{value:.10g}")

    def literal(self, value: Any) -> str:
        """A value as modelDescription.xml and command lines write it."""
        if self.kind == "Boolean":
            return str(bool(value)).lower()
        return repr(float(value)) if self.kind == "Real" else str(int(value))

    @property
    def allowed_range(self) -> str:
        """The allowed values in words."""
        if self.choices:
            return ", ".join(f"{member.value} {member.name}" for member in self.choices)
        d = self.declaration
        if self.kind == "Integer":
            return f"{max(d.min, LEAST_INTEGER)} to {min(d.max, GREATEST_INTEGER)}"
        low = max(d.min, d.smallest) if d.smallest else d.min
        limits = (
            (d.above > -inf, f"> {d.above:g}"),
            (d.above == -inf < low, f">= {low:g}"),
            (d.below < inf, f"< {d.below:g}"),
            (d.max < inf == d.below, f"<= {d.max:g}"),
        )
        forms = (
            (d.min < 0.0 < d.smallest, f"a magnitude of {d.smallest:g} to {d.max:g}"),
            (low > -inf and d.max < inf, f"{low:g} to {d.max:g}"),
            (True, " and ".join(text for applies, text in limits if applies) or "finite"),
        )
        zero = "0, or " if d.smallest and d.zero else ""
        return zero + next(text for applies, text in forms if applies)

    @property
    def allowed_values(self) -> str:
        """The allowed values in words, for a value that is not even of the variable's type."""
        if self.kind == "Boolean":
            return "true or false"
        if self.choices:
            return self.allowed_range
        form = "whole number without a point" if self.kind == "Integer" else "number"
        return f"a {form}, {self.allowed_range}"

    def refusal(self, value: Any) -> str:
        """Why a value is not allowed, naming variable, value and range; empty if it is."""
        if self.allows(value):
            return ""
        unwired = "; an unwired input gives 0" if self.causality == "input" and value == 0 else ""
        return f"{self.name} = {shown(value)} is not allowed: it must be {self.allowed_range}{unwired}"


def summary(thing: Any) -> str:
    """The first line of a docstring, without its full stop."""
    return (thing.__doc__ or "").strip().split("\n")[0].rstrip(".")


def members(kind: Any) -> list[Any]:
    """All members of an enumeration; none of any other type."""
    return list(kind) if issubclass(kind, IntEnum) else []


def shown(value: Any) -> str:
    """A value that was set, in a log line: a Real with twelve digits at most."""
    return rounded(value, SHOWN_DIGITS) if isinstance(value, float) else str(value)


def computed(value: Any) -> str:
    """A value that a block has computed, in a log line: a Real with seven digits at most."""
    return rounded(value, COMPUTED_DIGITS) if isinstance(value, float) else str(value)


def rounded(value: float, digits: int) -> str:
    """A number in so many digits, or in six if they are enough."""
    short, long = f"{value:g}", f"{value:.{digits}g}"
    return short if short == long or Decimal(short) == Decimal(long) else long


def step_size_refusal(h: float) -> str:
    """Why a step size, in s, is not allowed, naming value and range; empty if it is."""
    allowed = 0.0 < h <= LONGEST_STEP
    return "" if allowed else f"step size = {shown(h)} is not allowed: it must be > 0 and <= {LONGEST_STEP:g}"


def refusals(block_type: type[Any]) -> list[Any]:
    """All refusals that a block's `initialize` and `step` may return: the members of its own enumeration except 0."""
    answers = (get_type_hints(getattr(block_type, name))["return"] for name in ("initialize", "step"))
    return [answer for kind in dict.fromkeys(answers) for answer in members(kind) if answer != 0]


def variables_in_message(choice: Any, available: Container[str], coded: str = "") -> list[str]:
    """The names of the variables whose values belong to the message of a refusal or fault.

    `coded`: the variable that holds the fault's code. A name such as `.velocity` is in the group of `coded`, and is
    left out if this group has no such variable."""
    group = coded.rpartition(".")[0]
    names = [group + name if name.startswith(".") else name for name in choice.names]
    optional = [name.startswith(".") for name in choice.names]
    return [full for full, may_lack in zip(names, optional, strict=True) if not may_lack or full in available]


def message_text(
    choice: Any, names: Iterable[str], value_of: Callable[[str], Any], text_of: Callable[[Any], str] = shown
) -> str:
    """A refusal or fault in words, with the values of these variables as `text_of` writes them."""
    values = ", ".join(f"{name} = {text_of(value_of(name))}" for name in names)
    return f"{choice.description} ({values})" if values else str(choice.description)


@cache
def field_types(part_class: type) -> Mapping[str, Any]:
    """The declared type of each field of a block or a part."""
    return MappingProxyType(get_type_hints(part_class))


def cells(block: Any, prefix: str = "", hidden: bool = False, slave_unit: bool = False) -> Iterator[Cell]:
    """Every cell of the block, in the order of declaration. Together the cells are the block's whole state."""
    part_class: type = type(block)
    hints = field_types(part_class)
    for f in fields(block):
        value, name = getattr(block, f.name), prefix + f.name
        if is_dataclass(value):
            marks = (hidden or f.metadata.get("hidden", False), slave_unit or f.metadata.get("slave_unit", False))
            yield from cells(value, f"{name}.", *marks)
            continue
        hint = list if isinstance(value, list) else hints[f.name]
        if type(value) is not hint:  # an int in a float field would be an integer in compiled code
            raise TypeError(f"{name} is declared {hint.__name__}, but starts as {value!r}")
        choices = frozenset(member.value for member in members(hint)) or None
        declaration = None if hidden else f.metadata.get("declaration")
        if declaration and slave_unit:
            declaration = replace(declaration, unit=declaration.unit.of_slave())
        yield Cell(name, block, f.name, hint, declaration, choices)


def declared_of_parts(block: Any, key: str, prefix: str = "") -> dict[str, Any]:
    """What the parts of a block declare of their variables by a parameter of `var.part`, by the variables' names.

    `key`: the parameter's name: `depends`, say."""
    by_name: dict[str, Any] = {}
    for f in fields(block):
        value = getattr(block, f.name)
        if is_dataclass(value):
            declared: Mapping[str, Any] = f.metadata.get(key, {})
            by_name |= {f"{prefix}{f.name}.{name}": of_variable for name, of_variable in declared.items()}
            by_name |= declared_of_parts(value, key, f"{prefix}{f.name}.")
    return by_name


def variables(block: Any, overrides: Mapping[str, str] | None = None) -> list[Variable]:
    """The declared variables with the block's present values as start values, in the order in which FMUs list them.

    `overrides`: the causality of each variable that has another one than the block declares, by name."""
    depends, periods = (declared_of_parts(block, key) for key in ("depends", "periods"))
    overrides = overrides or {}
    result = [
        Variable(
            c,
            c.declaration.of_real_input() if c.type is float and overrides.get(c.name) == "input" else c.declaration,
            depends.get(c.name, c.declaration.depends),
            c.get(),
            overrides.get(c.name, c.declaration.causality),
            periods.get(c.name, ""),
        )
        for c in cells(block)
        if c.declaration
    ]
    return _in_order([_with_codes(v, result) if v.declaration.of_parameters else v for v in result])


def _with_codes(v: Variable, listed: list[Variable]) -> Variable:
    """A variable that shows which of the listed parameters is refused, with their ranges as the texts of its codes."""
    numbered = enumerate((w for w in listed if w.declaration.tunable and w.kind != "Boolean"), 1)
    texts = {number: (w.name, w.allowed_range) for number, w in numbered}
    return replace(v, declaration=v.declaration.with_parameters(texts))


def _in_order(listed: list[Variable]) -> list[Variable]:
    """The variables with what is wired first, then what is set once, then what is watched.

    A group is where its first one is, and its signals come first in it. Else the order is that of declaration."""
    groups: dict[str, list[Variable]] = {}
    for v in listed:
        groups.setdefault(v.name.partition(".")[0], []).append(v)
    place = {v.name: ORDER[v.declaration.causality] for v in listed}
    ordered = sorted(groups.values(), key=lambda group: min(place[v.name] for v in group))
    return [v for group in ordered for v in sorted(group, key=lambda v: place[v.name] >= ORDER["parameter"])]
