"""What a machine can do at one length or at one line velocity."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from ..scenario.evaluate.expectations import Check

SHARE = 0.01  # by which limits are raised, and times and distances reduced, to compute gains
TOLERANCE = 1e-9  # relative; nearer to a limit means at it
ROUNDING = 1e-14  # relative
HALVINGS = 200

LENGTH, LINE = "length", "line velocity"
VELOCITY, ACCELERATION, JERK = "velocity", "acceleration", "jerk"  # the limits of an axis
NOT_TAKEN = "parking is not allowed"  # a bound of pieces that the block does not take


class Figure(NamedTuple):
    """A further figure of a cycle, in its unit."""

    value: float
    unit: str


class Gap(NamedTuple):
    """Lengths between which not every piece can be cut, although shorter and longer ones can; `end` None: no longer
    one can."""

    begin: float
    end: float | None


@dataclass(frozen=True)
class CuttingRun:
    """What the block did while some pieces passed.

    Attributes:
        pieces: how many had to pass; the run ends with the first that is skipped.
        cuts, skipped: how many cuts were made, and how many left out.
        has_warned: whether the warning line_too_fast was active before a cut was left out.
        has_exceeded_limit: whether the slave exceeded a limit of its axis.
        has_skipped_gap: whether a gap was not opened, because of the axis's limits.
        reserve: the share of the last piece's cycle in which the slave was at rest.
        refusal: why the block refused a step; empty: it did not.
    """

    pieces: int
    cuts: int
    skipped: int
    has_warned: bool
    has_exceeded_limit: bool
    has_skipped_gap: bool
    reserve: float
    refusal: str = ""

    @property
    def has_made_all(self) -> bool:
        """Whether every cut was made, within the limits of the axis."""
        return self.cuts >= self.pieces and not self.skipped and not self.has_exceeded_limit and not self.refusal

    @property
    def text(self) -> str:
        """The result in words."""
        if self.refusal:
            return self.refusal
        parts = [f"{self.cuts} cuts, {self.skipped} skipped"]
        parts += ["the warning line_too_fast"] if self.has_warned else []
        parts += ["a limit of the axis exceeded"] if self.has_exceeded_limit else []
        return ", ".join(parts)


@dataclass(frozen=True)
class MotorUse:
    """Forces in N, or torques in N m where the slave turns.

    Attributes:
        rms: the root of the mean square over a cycle and the rest after it.
        peak: the greatest magnitude.
        rms_share, peak_share: of what the motor can give; None: this is not known.
        unit: the unit of forces.
    """

    rms: float
    peak: float
    rms_share: float | None
    peak_share: float | None
    unit: str


@dataclass(frozen=True)
class WorkingPoint:
    """A length and a line velocity that are both given.

    Attributes:
        length: of the pieces, in u of true material.
        velocity: of the line, in u/s of the master.
        greatest_velocity: that of the line at this length; 0: none is possible.
        motor: what the slave's motor has to give; None: the line is too fast, or the load is not known.
    """

    length: float
    velocity: float
    greatest_velocity: float
    motor: MotorUse | None

    @property
    def margin(self) -> float:
        """By what share the line might be faster; below 0: it is too fast."""
        return self.greatest_velocity / self.velocity - 1.0


@dataclass(frozen=True)
class Prediction:
    """The greatest line velocity at one length, or the shortest length at one line velocity.

    Attributes:
        given: LENGTH or LINE: which of the two is given; the other one is the result.
        length: of the pieces, in u of true material; None: at this line velocity no length is possible.
        velocity: of the line, in u/s of the master; 0: no velocity is possible.
        lost: the line velocity above which cuts are lost, or the length below which they are; between it and the
            result the machine warns, and uses up a reserve. None: there is no result.
        bound: what limits the result, one of the machine's `bound_colours`.
        limited_by: the same in words, as exactly as it is known.
        gains: by what share of its value the result improves when a limit or need is relaxed by SHARE, by their names.
        cycle: the parts of the shortest cycle at this velocity in their sequence, in s; None: there is none.
        figures: further figures of this cycle, by name.
        gap: lengths above the result that cannot be cut at this velocity; None: all longer pieces can.
        checks: what runs of the block were expected to do, and did; empty: it was not run.
        note: a limitation of the confirmation; empty: none.
        motor: what the slave's motor has to give; None: there is no cycle, or the load is not known.
    """

    given: str
    length: float | None
    velocity: float
    lost: float | None
    bound: str
    limited_by: str
    gains: Mapping[str, float] = field(default_factory=dict)
    cycle: Mapping[str, float] | None = None
    figures: Mapping[str, Figure] = field(default_factory=dict)
    gap: Gap | None = None
    checks: list[Check] = field(default_factory=list)
    note: str = ""
    motor: MotorUse | None = None

    @property
    def is_confirmed(self) -> bool:
        """Whether the runs of the block did what was predicted."""
        return all(check.passed for check in self.checks)

    @property
    def cycle_time(self) -> float | None:
        """The time of the cycle, in s; None: there is none."""
        return math.fsum(self.cycle.values()) if self.cycle else None


def relative_gain(better: float, worse: float) -> float:
    """By what share one value is greater than the other; 0 where that is rounding."""
    share = better / worse - 1.0
    return share if share > TOLERANCE else 0.0


def greatest_gain(gains: Mapping[str, float], names: Iterable[str]) -> str:
    """Which of these limits or needs improves the result most; empty: none does."""
    name = max(names, key=lambda name: gains[name])
    return name if gains[name] else ""


def find_boundary(safe: float, lost: float, is_lost: Callable[[float], bool]) -> float:
    """The last value from `safe` towards `lost` at which no cut is lost, by bisection."""
    if not is_lost(lost):
        return lost
    for _ in range(HALVINGS):
        middle = 0.5 * (safe + lost)
        if abs(lost - safe) <= ROUNDING * abs(safe):
            break
        if is_lost(middle):
            lost = middle
        else:
            safe = middle
    return safe
