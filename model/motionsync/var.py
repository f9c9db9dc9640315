"""Declarations: what a field is to the outside world, written once, at the field; and what a block guarantees.

    from . import var

    position: float = var.input(0.0, "the master's position", Unit.POSITION)

To the type checker each function returns its start value's type, so the line is an ordinary typed dataclass field;
at run time it returns a `dataclasses.field` whose metadata holds the `Declaration`. A field without a declaration
belongs to the block's state, but is not visible outside the block.
"""

import array as numbers
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableSequence
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from enum import Enum, EnumMeta, IntEnum
from functools import cache, partial
from math import inf, nextafter
from operator import attrgetter, eq
from typing import Any, Protocol, Self, TypeAlias, TypeVar, cast

from .numerics.computable_range import LARGEST, SMALLEST_LIMIT

T = TypeVar("T")
Reals: TypeAlias = MutableSequence[float]
Wholes: TypeAlias = MutableSequence[int]
NO_NUMBERS = numbers.array("d")
LARGEST_INPUT = 1e12  # a Real input beyond it is refused, as NaN is: squares and cubes of the allowed ones are finite


class Unit(Enum):
    """What a Real measures, as powers of four base units.

    These are the position unit `u`, which is chosen when the FMU is built; the second; the degree, which stays a degree
    whatever unit positions have; and the slave's own position unit, which is `u` unless it is chosen, too."""

    NONE = (0, 0, "")
    POSITION = (1, 0, "Position")
    VELOCITY = (1, -1, "Velocity")
    ACCELERATION = (1, -2, "Acceleration")
    JERK = (1, -3, "Jerk")
    PER_POSITION = (-1, 0, "PerPosition")
    PER_POSITION2 = (-2, 0, "PerPositionSquared")
    MOMENTUM = (2, -3, "AccelerationPower")  # velocity times acceleration
    TIME = (0, 1, "Time")
    ANGLE = (0, 0, "Angle", 1)
    SLAVE_POSITION = (0, 0, "SlavePosition", 0, 1)
    SLAVE_VELOCITY = (0, -1, "SlaveVelocity", 0, 1)
    SLAVE_ACCELERATION = (0, -2, "SlaveAcceleration", 0, 1)
    SLAVE_JERK = (0, -3, "SlaveJerk", 0, 1)
    SLAVE_PER_MASTER = (-1, 0, "SlavePerMaster", 0, 1)

    def __init__(self, position: int, second: int, quantity: str, degree: int = 0, slave: int = 0) -> None:
        self.position = position
        self.second = second
        self.quantity = quantity
        self.degree = degree
        self.slave = slave

    def of_slave(self) -> "Unit":
        """The member for the same quantity in the slave's position unit instead of `u`; itself if there is none."""
        return next((unit for unit in Unit if unit.quantity == f"Slave{self.quantity}"), self)


class Role(Enum):
    """What a variable is to a tool, which finds it by its role, not by its name. A block gives each role at most once.

    The first five belong to a block that works in cycles of its own, on telegrams from a controller with another clock.
    A tool makes the telegrams from the motion of an axis, and evaluates the block's outputs. The part with the
    CYCLE_INDEX is the remote axis: it also has `position`, `velocity` and `acceleration`. The next ones are the limits
    of the slave's axis, with which a tool compares the slave's motion; EXCEEDED_LIMIT and LIMIT_EXCEEDED are what the
    block itself says of it.

    The last ones belong to a block that records the pieces which it cuts off the master's material. The part with
    PIECES counts: it also has `skipped` and `late`. That of ORDERS also has `remaining` and `repeat`. That of
    LAST_LENGTH describes the piece: it also has `error`, `kind` (an enumeration with the members PRODUCT and
    MERGED), `good`, `time` and `reserve`. That of MAX_MASTER_VELOCITY also has the `reserve` at the present
    velocity. A tool measures each piece once more, from the positions of slave and master while CUTTING: it is as
    long as the material's travel between two cuts, less KERF and LENGTH_CORRECTION. A tool that turns has a
    CUT_SPACING and an EDGE_RADIUS: with the angle 0 at a cut, its edge is at the sine of the angle along the
    material.
    """

    TASK_CYCLE = "the length of the block's own cycles, s"
    DATA_CYCLE = "the nominal length of the sender's cycles, s; 0: the same as the block's own"
    DELAY = "a time by which the outputs are later than the cycle's instant, s"
    CYCLE_INDEX = "the sender's cycle counter, as it is in the telegram"
    CORRECTED_INDEX = "the sender's cycle index at the cycle's instant, as the block estimates it"
    MIN_POSITION = "the lower end position of the slave's axis"
    MAX_POSITION = "the upper end position of the slave's axis"
    MAX_VELOCITY = "the greatest speed of the slave's axis; 0: no limit"
    MAX_ACCELERATION = "the greatest acceleration of the slave's axis; 0: no limit"
    MAX_DECELERATION = "the greatest deceleration of the slave's axis; 0: as its greatest acceleration"
    MAX_JERK = "the greatest jerk of the slave's axis; 0: no limit"
    PEAK_VELOCITY = "the greatest speed of the slave in the present cycle at the present velocity of the master"
    PEAK_ACCELERATION = "the greatest acceleration of the slave in this cycle"
    PEAK_JERK = "the greatest jerk of the slave in this cycle"
    EXCEEDED_LIMIT = "which limit of its axis the setpoint exceeds, a plain Integer with codes; 0: none"
    LIMIT_EXCEEDED = "whether the setpoint exceeds a limit of its axis"
    ORDERS = "how many orders are left, the active one included"
    PIECES = "how many pieces have been cut off; where it rises, LAST_LENGTH is the length of one"
    LAST_LENGTH = "the length of the piece that was cut off last"
    RUNNING = "whether pieces are cut; the first one after a start is not measured from the cut before"
    CUTTING = "whether the tool works in the material, in sync with it"
    COUPLING_FACTOR = "the slave's travel over the master's in sync"
    CUT_SPACING = "of a tool that turns: the slave's travel from one position at which it cuts to the next one"
    EDGE_RADIUS = "of a tool that turns: the slave's travel per rad if its edge is in sync along the material, or 0"
    MATERIAL_FACTOR = "the material's true travel over the master's"
    CALIBRATION_FACTOR = "a further factor of it, from a piece that was measured"
    KERF = "the length of material that a cut removes"
    LENGTH_CORRECTION = "by how much a piece is cut longer than its recorded length"
    LENGTH_TOLERANCE = "the greatest error of a good piece's length"
    MAX_MASTER_VELOCITY = "the greatest velocity of the master at which each cut is reached"
    MASTER_REQUEST = "the velocity that the block requests of the master"
    WARNING = "whether one of the other Booleans in its group is true: each is a warning to the operator"


class Report(Enum):
    """When the importer's log reports the code in a plain Integer."""

    CHANGES = "where the code changes, but not to 0"
    STEPS = "after each step in which the code is not 0"
    EPISODES = (
        "the first time; and once it has not come again for a while, how often it came and the worst value of the "
        "first variable in its message: the one farthest from the second variable, its limit"
    )


class Enumeration(IntEnum):
    """An enumeration whose members describe themselves: `NAME = value, "description"`.

    Further strings name variables whose values a log message shows. A leading dot means: in the same group as the
    error_id that carries this code (for `halt.error_id`, `.velocity` is `halt.velocity`). Such a name is left out where
    the group has no such variable.
    """

    description: str
    names: tuple[str, ...]

    def __new__(cls, value: int, description: str, *names: str) -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.description = description
        member.names = names
        return member


def merged(first: type[Enumeration], *others: type[Enumeration]) -> type[Enumeration]:
    """An enumeration with the members of several, in the order of their values; the first one describes it.

    Members of the same name are the same."""
    return _with_members(first, (member for kind in (first, *others) for member in kind))


def selected(kind: type[Enumeration], *names: str) -> type[Enumeration]:
    """The enumeration with 0 and the members of these names alone."""
    return _with_members(kind, [member for member in kind if member == 0 or member.name in names])


def _with_members(
    kind: type[Enumeration], members: Iterable[Enumeration], others: Mapping[str, tuple[Any, ...]] | None = None
) -> type[Enumeration]:
    """An enumeration with these members and the `others`, given by their values; described as `kind` is."""
    values = {m.name: (m.value, m.description, *m.names) for m in members} | dict(others or {})
    by_number: Any = dict(sorted(values.items(), key=lambda item: item[1][0]))
    made = EnumMeta.__call__(Enumeration, kind.__name__, by_number, module=kind.__module__)
    made.__doc__ = kind.__doc__
    return cast(type[Enumeration], made)


class Block(Protocol):
    """What every block is to the tools that run it: a dataclass whose declared fields are its variables.

    A runner sets the block's inputs and parameters, calls `initialize` once or more, and then sets inputs and calls
    `step` again and again. It guarantees what `initialize` and `step` may rely on: every value is within its
    declared limits, Real inputs are finite and within ±1e12, and a step is longer than 0 and at most 1e6 s. Only a
    tunable parameter may have any value after initialization; a command that needs a valid one is refused by the block.
    These are the causalities that the block declares; it does not know whether an FMU shows others.

    The block guarantees in return:
    - Neither method raises an exception, and no output and no part of the state ever becomes NaN or infinite.
    - Neither method allocates memory: all parts and lists are made with the block and keep their lengths. The same code
      therefore runs compiled, without Python.
    - All that a later result depends on is in the block's fields: a copy of the fields is a copy of the block, and
      continues with the same bits.
    - Positions inside the block are unwrapped: they are continuous over the turns of a modulo axis, relative to a whole
      number of turns that the block drops (`rebase`) whenever nothing in it is at a particular turn.
    """

    def initialize(self) -> Enumeration:
        """Set the outputs for the present parameters and inputs, before any time passes.

        It may be called again and again while parameters and inputs still change; the last call counts. It returns a
        member of the block's own `Refusal` enumeration: 0 if done, else why the values contradict one another."""

    def step(self, h: float) -> Enumeration:
        """Advance by h seconds, from t to t+h, with the present inputs; the outputs are those at t+h.

        It returns a member of the block's own `Refusal` enumeration: 0 if done. Any other one means that the step is
        refused and has changed nothing in the block, so that no copy is needed to continue with other inputs."""


@dataclass(frozen=True)
class Declaration:
    """The public properties of a variable.

    Attributes:
        causality: FMI's `input`, `parameter`, `output` or `local`; an FMU may be built with another one.
        discrete: a Real that changes at commands only (Integers, Booleans and enumerations always are discrete).
        tunable: a parameter that may change while running.
        min, max: limits, both of which are allowed.
        above, below: limits, both of which are refused.
        smallest: the least magnitude of a value other than 0.
        zero: whether 0 itself is allowed.
        depends: the inputs and parameters on which the value after initialization depends (of outputs and locals).
        codes: what the values of a plain Integer mean, for the log; 0 is never reported.
        report: when the log reports such a value.
        role: what a tool knows of the variable beyond FMI; None: nothing.
        wraps_at: a counter that restarts at 0 where it would reach this number; 0: it does not wrap.
        command: a Boolean input whose edge gives a command.
        of_parameters: `codes` are completed by the tunable parameters of the block, which may be out of their ranges.
    """

    causality: str
    description: str
    unit: Unit = Unit.NONE
    discrete: bool = False
    tunable: bool = False
    min: float = -inf
    max: float = inf
    above: float = -inf
    below: float = inf
    smallest: float = 0.0
    zero: bool = True
    depends: tuple[str, ...] = ()
    codes: type[Enumeration] | None = None
    report: Report = Report.CHANGES
    role: Role | None = None
    wraps_at: int = 0
    command: bool = False
    of_parameters: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """The least and the greatest value within the limits; both are finite."""
        return max(self.min, nextafter(self.above, inf)), min(self.max, nextafter(self.below, -inf))

    @property
    def least_magnitude(self) -> float:
        """The least magnitude of a value, of one other than 0 if `zero`."""
        return self.smallest if self.zero else max(self.smallest, nextafter(0.0, inf))

    def allows(self, value: float) -> bool:
        """Whether a number is within the limits. NaN never is."""
        low, high = self.ends
        return low <= value <= high and (abs(value) >= self.least_magnitude or (self.zero and value == 0.0))

    def with_parameters(self, texts: Mapping[int, tuple[str, str]]) -> "Declaration":
        """The declaration with codes for tunable parameters, too.

        `texts`: by the number that `first_invalid` gives, each one's name and range."""
        assert self.codes
        return replace(self, codes=_with_parameters(self.codes, tuple(texts.items())))

    def of_real_input(self) -> "Declaration":
        """The declaration of a Real parameter that an FMU shows as an input: it is within ±1e12, as Real inputs are.

        It changes where a command reads it, not continuously."""
        return replace(self, discrete=True, min=max(self.min, -LARGEST_INPUT), max=min(self.max, LARGEST_INPUT))


def input(
    start: T,
    description: str,
    unit: Unit = Unit.NONE,
    *,
    discrete: bool = False,
    role: Role | None = None,
    wraps_at: int = 0,
) -> T:
    """A Real input is within ±1e12. Integers and Booleans have no limits but those of their type."""
    limit = LARGEST_INPUT if isinstance(start, float) else inf
    declaration = Declaration("input", description, unit, discrete, min=-limit, max=limit, role=role, wraps_at=wraps_at)
    return _declared_field(start, declaration)


def command(start: bool, description: str) -> bool:
    """A Boolean input whose edge gives a command."""
    return _declared_field(start, Declaration("input", description, command=True))


def parameter(
    start: T,
    description: str,
    unit: Unit = Unit.NONE,
    *,
    tunable: bool = False,
    min: float = -inf,
    max: float = inf,
    above: float = -inf,
    below: float = inf,
    smallest: float = 0.0,
    zero: bool = True,
    role: Role | None = None,
) -> T:
    declaration = Declaration(
        "parameter", description, unit, False, tunable, min, max, above, below, smallest=smallest, zero=zero, role=role
    )
    return _declared_field(start, declaration)


def position(start: float, description: str, unit: Unit = Unit.POSITION, *, role: Role | None = None) -> float:
    """A tunable parameter that is a position: within ±1e12."""
    return parameter(start, description, unit, tunable=True, min=-LARGEST, max=LARGEST, role=role)


def length(
    start: float,
    description: str,
    unit: Unit = Unit.POSITION,
    *,
    min: float = 0.0,
    smallest: float = 0.0,
    zero: bool = True,
    tunable: bool = True,
    role: Role | None = None,
) -> float:
    """A parameter that is a length, tunable unless said otherwise: at most 1e12."""
    return parameter(
        start, description, unit, tunable=tunable, min=min, max=LARGEST, smallest=smallest, zero=zero, role=role
    )


def duration(start: float, description: str) -> float:
    """A tunable parameter that is a time: 0 to 1e6 s."""
    return parameter(start, description, Unit.TIME, tunable=True, min=0.0, max=1e6)


def limit(
    start: float, description: str, unit: Unit, *, zero: bool = True, tunable: bool = True, role: Role | None = None
) -> float:
    """A limit of a motion: within the range for computations, or 0 where that has a meaning of its own."""
    return length(start, description, unit, smallest=SMALLEST_LIMIT, zero=zero, tunable=tunable, role=role)


def output(
    start: T,
    description: str,
    unit: Unit = Unit.NONE,
    *,
    discrete: bool = False,
    depends: tuple[str, ...] = (),
    codes: type[Enumeration] | None = None,
    role: Role | None = None,
) -> T:
    declaration = Declaration("output", description, unit, discrete, depends=depends, codes=codes, role=role)
    return _declared_field(start, declaration)


def local(
    start: T,
    description: str,
    unit: Unit = Unit.NONE,
    *,
    discrete: bool = False,
    min: float = -inf,
    max: float = inf,
    depends: tuple[str, ...] = (),
    codes: type[Enumeration] | None = None,
    report: Report = Report.CHANGES,
    role: Role | None = None,
) -> T:
    declaration = Declaration(
        "local", description, unit, discrete, min=min, max=max, depends=depends, codes=codes, report=report, role=role
    )
    return _declared_field(start, declaration)


def refused_parameter(start: int, description: str, contradictions: type[Enumeration]) -> int:
    """An Integer local that shows which tunable parameter is refused; 0: none.

    It is the number that `first_invalid` gives for the block, with a text from that parameter's declaration, or one of
    `contradictions`, of several values, numbered from 1001 on."""
    return _declared_field(start, Declaration("local", description, codes=contradictions, of_parameters=True))


def switch(start: bool, description: str) -> bool:
    """A Boolean parameter that may change while running."""
    return parameter(start, description, tunable=True)


def snapshot(start: float, description: str, unit: Unit = Unit.NONE, *, role: Role | None = None) -> float:
    """A Real local that holds a value as of some event, and does not change between events."""
    return local(start, description, unit, discrete=True, role=role)


def part(
    kind: Callable[[], T],
    depends: Mapping[str, tuple[str, ...]] | None = None,
    *,
    periods: Mapping[str, str] | None = None,
    hidden: bool = False,
    slave_unit: bool = False,
) -> T:
    """An object that is made once with the block, and holds a part of its variables and state.

    `depends`: what the outputs and locals in the part depend on after initialization, by their names in the part.
    `periods`: of the positions in the part that wrap, the parameters that hold their periods (0: such a one does not).
    `hidden`: the part's declared fields are not variables of the block; it stores values that such variables had.
    `slave_unit`: what the part declares in the position unit is in the slave's own position unit.
    """
    metadata = {"depends": depends or {}, "periods": periods or {}, "hidden": hidden, "slave_unit": slave_unit}
    return field(default_factory=kind, metadata=metadata)


def array(length: int) -> list[float]:
    """A list of fixed length, zeros at first."""
    return field(default_factory=lambda: [0.0] * length)


def series() -> Any:
    """Numbers given from outside, `Reals` or `Wholes`, as many as there are: an `array` of doubles or of 64-bit
    integers, whose elements are read and written. None are given at first. No block has such a field, since its state
    would not be in its own memory."""
    return field(default_factory=lambda: NO_NUMBERS, metadata={"series": True})


def count(most: int, start: int = 0) -> int:
    """A number from 0 to `most` that is no variable. A state with another number is refused.

    Any other integer of a state is within ±2^60, so that sums do not overflow; a factor of a product is a count."""
    return field(default=start, metadata={"most": most})


def copy(into: T, source: T) -> None:
    """Copy every field of one part into another part of the same class, with the parts and lists inside.

    This function and the next three are also part of compiled code; nothing else in this module is."""
    _copier(type(source))(into, source)  # type: ignore[arg-type]


def same(a: T, b: T) -> bool:
    """Whether all fields of two parts of one class are equal, with those of the parts and the elements of the lists.

    Numbers are compared by `==`: 0.0 is the same as -0.0, and a part with a NaN is not even the same as itself. `b` may
    be of a class that derives from that of `a`, whose fields count."""
    return _comparison(type(a))(a, b)  # type: ignore[arg-type]


def first_invalid(part: object) -> int:
    """The number of the first tunable parameter in a part that is out of its declared range; 0: there is none.

    They are numbered from 1 on in the order of declaration, those in the parts inside included, Booleans left out."""
    return _first_invalid(type(part), part)


def copy_valid(into: T, source: T) -> None:
    """Copy one part into another, as `copy` does, if all tunable parameters in it are within their declared ranges.

    `source` may be of a class that derives from that of `into`, whose fields count."""
    kind: type = type(into)
    if _first_invalid(kind, source) == 0:
        _copier(kind)(into, source)


@cache
def _comparison(part_class: type) -> Callable[[Any, Any], bool]:
    """The comparison of two parts of a class, written as one expression: a step may have many of them."""
    tests = (f"all(map(eq, a.{n}, b.{n}))" if _is_list(f) else f"a.{n} == b.{n}" for n, f in _elements(part_class))
    function: Callable[[Any, Any], bool] = eval(f"lambda a, b: {' and '.join(tests)}", {"eq": eq})
    return function


@cache
def _copier(part_class: type) -> Callable[[Any, Any], None]:
    """The copying of one part of a class into another, written as one function: a step may have many of them."""
    elements = _elements(part_class)
    lines = (f"    a.{n}[:] = b.{n}" if _is_list(f) else f"    a.{n} = b.{n}" for n, f in elements)
    scope: dict[str, Any] = {}
    exec("\n".join(["def copy_fields(a, b):", *lines]), scope)
    function: Callable[[Any, Any], None] = scope["copy_fields"]
    return function


def _first_invalid(part_class: type, part: object) -> int:
    """As `first_invalid`, of the parameters that a class has."""
    for number, (read, is_allowed) in enumerate(_tunables(part_class), 1):
        if not is_allowed(read(part)):
            return number
    return 0


@cache
def _tunables(part_class: type) -> list[tuple[Callable[[Any], Any], Callable[[Any], bool]]]:
    """What reads each numbered parameter of a part, and whether a value is within its range."""
    shown = ((name, f, f.metadata.get("declaration")) for name, f in _elements(part_class, hidden=False))
    tunables = ((name, f, d) for name, f, d in shown if d and d.tunable and not isinstance(f.default, bool))
    return [(attrgetter(name), partial(_is_allowed, type(f.default), d)) for name, f, d in tunables]


def _is_allowed(kind: type, declaration: Declaration, value: Any) -> bool:
    """Whether a value is within the declared range of a field of that kind."""
    return value in kind._value2member_map_ if isinstance(kind, EnumMeta) else declaration.allows(value)


def _elements(part_class: type, path: str = "", hidden: bool = True) -> Iterator[tuple[str, Field[Any]]]:
    """The fields of a part and of the parts inside, by their names with dots; `hidden`: of hidden parts, too."""
    for f in fields(part_class):
        name, factory = f"{path}{f.name}", f.default_factory
        if not (isinstance(factory, type) and is_dataclass(factory)):
            yield name, f
        elif hidden or not f.metadata["hidden"]:
            yield from _elements(factory, f"{name}.", hidden)


def _is_list(f: Field[Any]) -> bool:
    return f.default_factory is not MISSING


@cache
def _with_parameters(kind: type[Enumeration], texts: tuple[tuple[int, tuple[str, str]], ...]) -> type[Enumeration]:
    """An enumeration completed by tunable parameters: by number, each one's name and range."""
    parameters = {
        name.upper().replace(".", "_"): (number, f"{name} must be {allowed}", name) for number, (name, allowed) in texts
    }
    return _with_members(kind, kind, parameters)


def _declared_field(start: T, declaration: Declaration) -> T:
    return field(default=start, metadata={"declaration": declaration})
