"""Declarations: what a field is to the outside world, written once, beside the field; and what a block promises.

    from . import var

    position: float = var.input(0.0, "the master's position", Unit.POSITION)

To the type checker each function returns its start value's type, so the line is an ordinary typed dataclass field;
at run time it returns a `dataclasses.field` whose metadata holds the `Declaration`. A field without a declaration
belongs to the block's state, but nobody outside the block sees it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import Enum, IntEnum
from math import inf
from typing import Protocol, Self, TypeVar

from .limits import LEAST_LIMIT, MOST

T = TypeVar("T")
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
        """The same measure in the slave's position unit instead of `u`, where there is such a member; else itself."""
        return next((unit for unit in Unit if unit.quantity == f"Slave{self.quantity}"), self)


class Role(Enum):
    """What a variable is to a tool, which finds it by its role, whatever its name is. A block gives each role at most
    once.

    The first five belong to a block that works in cycles of its own, on telegrams from a controller with another clock.
    A tool makes the telegrams from the motion of an axis, and it judges what the block puts out. The part in which the
    CYCLE_INDEX lies is the remote axis: it also has `position`, `velocity` and `acceleration`. The next ones are the
    limits of the slave's axis, beside which a tool shows what the slave did.

    The last ones belong to a block that keeps books of the pieces which it cuts off the master's material. The part in
    which PIECES lies counts: it also has `skipped` and `late`. That of LAST_LENGTH describes the piece: it also has
    `error`, `kind` (an enumeration with the member PRODUCT), `good`, `time` and `reserve`. That of MAX_MASTER_VELOCITY
    also has the `reserve` at the present velocity. A tool measures each piece once more, from the positions of slave
    and master while CUTTING: it is as long as the material's travel between two cuts, less KERF and LENGTH_CORRECTION.
    """

    TASK_CYCLE = "the length of the block's own cycles, s"
    DATA_CYCLE = "the nominal length of the sender's cycles, s; 0: the same as the block's own"
    DELAY = "a time by which the outputs are later than the cycle's instant, s"
    CYCLE_INDEX = "the sender's cycle counter, as the telegram tells it"
    CORRECTED_INDEX = "the sender's cycle index at the cycle's instant, as the block estimates it"
    MIN_POSITION = "the lower end position of the slave's axis"
    MAX_POSITION = "the upper end position of the slave's axis"
    MAX_VELOCITY = "the greatest speed of the slave's axis; 0: no limit"
    MAX_ACCELERATION = "the greatest acceleration of the slave's axis; 0: no limit"
    MAX_DECELERATION = "the greatest deceleration of the slave's axis; 0: as its greatest acceleration"
    MAX_JERK = "the greatest jerk of the slave's axis; 0: no limit"
    PIECES = "how many pieces have been cut off; where it rises, LAST_LENGTH is the length of one"
    LAST_LENGTH = "the length of the piece that was cut off last"
    RUNNING = "whether pieces are cut; the first one after a start is not measured from the cut before"
    CUTTING = "whether the tool works in the material, in sync with it"
    COUPLING_FACTOR = "the slave's travel over the master's in sync"
    MATERIAL_FACTOR = "the material's true travel over the master's"
    CALIBRATION_FACTOR = "a further factor of it, from a piece that was measured"
    KERF = "the length of material that a cut removes"
    LENGTH_CORRECTION = "by how much a piece is cut longer than its told length"
    LENGTH_TOLERANCE = "how far the length of a good piece may be off"
    MAX_MASTER_VELOCITY = "the greatest velocity of the master at which each cut is reached"
    MASTER_REQUEST = "the velocity that the block asks the master for"


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


class Block(Protocol):
    """What every block is to the tools that run it: a dataclass whose declared fields are its variables.

    Whoever runs a block sets its inputs and parameters, calls `initialize` once or more, and then sets inputs and calls
    `step` again and again. The runner guarantees what `initialize` and `step` may rely on: every value is within its
    declared limits, Real inputs are finite and within ±1e12, and a step is longer than 0 and at most 1e6 s. Only a
    tunable parameter may have any value after initialization; a command that needs a good one is refused by the block.
    These are the causalities that the block declares; it does not know whether an FMU shows others.

    The block guarantees in return:
    - Neither method raises an exception, and no output and no part of the state ever becomes NaN or infinite.
    - Neither method allocates memory: all parts and lists are made with the block and keep their lengths. The same code
      therefore runs compiled, without Python.
    - All that a later result depends on is in the block's fields: a copy of the fields is a copy of the block, and it
      goes on with the same bits.
    - Positions inside the block are unwrapped: they are continuous over the turns of a modulo axis, relative to a whole
      number of turns that the block drops (`rebase`) whenever nothing in it lies at a particular turn.
    """

    def initialize(self) -> Enumeration:
        """Set the outputs for the present parameters and inputs, before any time passes.

        It may be called again and again while parameters and inputs still change; the last call counts. The answer is a
        member of the block's own `Refusal` enumeration: 0 if done, else why the values contradict one another."""

    def step(self, h: float) -> Enumeration:
        """Go on by h seconds, from t to t+h, with the present inputs; the outputs are those at t+h.

        The answer is a member of the block's own `Refusal` enumeration: 0 if done. Any other answer means that the step
        is refused and has changed nothing in the block, so that no copy is needed to go on with other inputs."""


@dataclass(frozen=True)
class Declaration:
    """What the outside world knows of a variable.

    Attributes:
        causality: FMI's `input`, `parameter`, `output` or `local`; an FMU may be built with another one.
        discrete: a Real that changes at commands only (Integers, Booleans and enumerations always are discrete).
        tunable: a parameter that may change while running.
        min, max: limits, both of which are allowed.
        above, below: limits, both of which are refused.
        smallest: the least magnitude of a value other than 0.
        zero: whether 0 itself is allowed.
        depends: the inputs and parameters on which the value after initialization depends (of outputs and locals).
        codes: what the values of a plain Integer mean; a log message says so when the value changes, but not to 0.
        role: what the variable is to a block that works in cycles; None: nothing.
        wraps_at: a counter that begins again at 0 where it would reach this number; 0: it does not wrap.
        command: a Boolean input whose edge gives a command.
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
    role: Role | None = None
    wraps_at: int = 0
    command: bool = False

    def of_real_input(self) -> "Declaration":
        """The declaration of a Real parameter that an FMU shows as an input: it lies within ±1e12, as Real inputs do.

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
    """A Real input lies within ±1e12. Integers and Booleans have no limits but those of their type."""
    limit = LARGEST_INPUT if isinstance(start, float) else inf
    declaration = Declaration("input", description, unit, discrete, min=-limit, max=limit, role=role, wraps_at=wraps_at)
    return _declared(start, declaration)


def command(start: bool, description: str) -> bool:
    """A Boolean input whose edge gives a command."""
    return _declared(start, Declaration("input", description, command=True))


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
    return _declared(start, declaration)


def limit(start: float, description: str, unit: Unit, *, zero: bool = True, role: Role | None = None) -> float:
    """A tunable limit of a motion: one that can be computed with, and 0 where that has a meaning of its own."""
    return parameter(
        start, description, unit, tunable=True, min=0.0, max=MOST, smallest=LEAST_LIMIT, zero=zero, role=role
    )


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
    return _declared(start, declaration)


def local(
    start: T,
    description: str,
    unit: Unit = Unit.NONE,
    *,
    discrete: bool = False,
    min: float = -inf,
    max: float = inf,
    codes: type[Enumeration] | None = None,
    role: Role | None = None,
) -> T:
    declaration = Declaration("local", description, unit, discrete, min=min, max=max, codes=codes, role=role)
    return _declared(start, declaration)


def part(
    kind: Callable[[], T],
    depends: Mapping[str, tuple[str, ...]] | None = None,
    *,
    hidden: bool = False,
    slave_unit: bool = False,
) -> T:
    """An object that is made once with the block, and holds a part of its variables and state.

    `depends`: what the outputs and locals in the part depend on after initialization, by their names in the part.
    `hidden`: the part's declared fields are not variables of the block; it keeps values that such variables had.
    `slave_unit`: what the part declares in the position unit is in the slave's own position unit.
    """
    return field(default_factory=kind, metadata={"depends": depends or {}, "hidden": hidden, "slave_unit": slave_unit})


def ring(length: int) -> list[float]:
    """A list of fixed length, zeros at first."""
    return field(default_factory=lambda: [0.0] * length)


def count(most: int) -> int:
    """A number from 0 to `most`, 0 at first, that is no variable. A state with another number is refused."""
    return field(default=0, metadata={"most": most})


def copy(into: T, source: T) -> None:
    """Copy every field of one part into another part of the same class, with the parts and lists inside.

    This function is also part of compiled code; nothing else in this module is."""
    for f in fields(source):  # type: ignore[arg-type]
        value = getattr(source, f.name)
        if is_dataclass(value):
            copy(getattr(into, f.name), value)
        elif isinstance(value, list):
            getattr(into, f.name)[:] = value
        else:
            setattr(into, f.name, value)


def _declared(start: T, declaration: Declaration) -> T:
    return field(default=start, metadata={"declaration": declaration})
