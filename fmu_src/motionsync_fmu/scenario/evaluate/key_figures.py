"""The key figures of a run: the slave's extreme values, next to the limits of its axis, its cuts and its pieces.

The console and the report print the same texts of them.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from motionsync.motion.exceeded_limit import SETPOINT_TOLERANCE
from motionsync.var import Role, Unit

from ...interface.roles import find_by_role
from ...interface.units import unit_name
from ..engineering import ROUNDING, engineering
from ..recording import Reals, Recording, greatest_position
from ..scenario import Scenario
from .axis_figures import FollowingError, LoadFigures, find_following_error, find_load_figures
from .cuts import Cut, uncut_text
from .cutting_results import CuttingResults
from .production import Production
from .time_series import time_series
from .true_pieces import TruePieces

NOWHERE = 1e9  # u; an end position this far away bounds nothing
OWN_PEAKS = {
    "velocity": Role.PEAK_VELOCITY,
    "acceleration": Role.PEAK_ACCELERATION,
    "jerk": Role.PEAK_JERK,
}  # what a block itself shows of its present cycle
SLAVE_OUTPUTS = ("slave.position", "slave.velocity", "slave.acceleration", "slave.jerk")


@dataclass(frozen=True)
class Peak:
    """How far one of the slave's values went, at the communication points, and as far as the block itself knows.

    Attributes:
        name: "position", "velocity", "acceleration", "deceleration" or "jerk". An axis without a limit of its own for
            the deceleration has none of that name; its "acceleration" is that of both.
        least, greatest: between these the value was, in `unit`. The least deceleration and acceleration are 0 or more
            where the axis has a limit for each: they are magnitudes then.
        at: the time at which the value was nearest to its limit, in s; without a limit, the time of its greatest
            magnitude.
        limit: the greatest allowed magnitude, of the position the upper end position; None: there is none.
        lower: the lower end position; None: there is none, and for every value but the position.
        own: the greatest magnitude in the cycles of a block that shows it; 0: it does not. It is the true one: between
            the communication points the value may be greater than at them.
        exceeded: whether the value was beyond a limit at any time, by more than the rounding of a setpoint.
    """

    name: str
    unit: str
    least: float
    greatest: float
    at: float
    limit: float | None
    lower: float | None
    exceeded: bool
    own: float = 0.0

    @property
    def value(self) -> float:
        """The greatest magnitude."""
        return max(abs(self.least), abs(self.greatest), self.own)

    @property
    def value_text(self) -> str:
        """The greatest magnitude, of a position the least and the greatest: `1200 mm/s`, `0 to 334.9 mm`."""
        if self.name == "position":
            return _range_text(self.least, self.greatest, self.unit, self.value)
        return engineering(self.value, self.unit)

    @property
    def limit_text(self) -> str:
        """The limit: `1500 mm/s`, `-250 to 650 mm`; empty if there is none."""
        if self.lower is not None and self.limit is not None:
            return _range_text(self.lower, self.limit, self.unit)
        if self.lower is not None:
            return f"at least {engineering(self.lower, self.unit)}"
        if self.limit is None:
            return ""
        return f"{'at most ' if self.name == 'position' else ''}{engineering(self.limit, self.unit)}"

    @property
    def text(self) -> str:
        """The whole figure: `velocity 1300 mm/s at 0.5 s, limit 1200 mm/s`, with the time if the limit is exceeded."""
        at = f" at {engineering(self.at, 's')}" if self.exceeded else ""
        limit = f", limit {self.limit_text}" if self.limit_text else ""
        return f"{self.name} {self.value_text}{at}{limit}"


@dataclass(frozen=True)
class KeyFigures:
    """The figures of a run.

    Attributes:
        peaks: one for each of the slave's values.
        production: what was made by a block that reports its pieces; None: it does not.
        cuts: the cuts in the order of time; empty if the scenario has no table [cuts].
        uncut: the positions of the marks that passed the saw without a cut, in u, in the sequence of passing.
        tolerance: how far a cut may be from its mark, in u; None: the scenario has no table [cuts].
        true_pieces: the pieces as a tape measure finds them; None: as for `find_true_pieces`.
        following_error: the greatest one; None: there is no servo.
        load: what the motor has to give; None: this is not known.
        unit: the unit of the material's positions.
        scale: the greatest magnitude of the positions of material and saw, in u: errors are compared with it.
    """

    peaks: tuple[Peak, ...]
    production: Production | None
    cuts: tuple[Cut, ...]
    uncut: tuple[float, ...]
    tolerance: float | None
    true_pieces: TruePieces | None
    following_error: FollowingError | None
    load: LoadFigures | None
    unit: str
    scale: float

    @property
    def peaks_text(self) -> str:
        """Where the peaks are from: between the communication points a value may be greater than at them."""
        own = "as the block knows them, else " if any(peak.own for peak in self.peaks) else ""
        return f"{own}at the communication points"

    @property
    def worst(self) -> Cut | None:
        """The cut that is farthest from its mark; None without cuts."""
        return max(self.cuts, key=lambda cut: abs(cut.error), default=None)

    @property
    def worst_text(self) -> str:
        """How far the worst cut is from its mark: `0.0021 mm`, `0 (to rounding)`; empty without cuts."""
        return engineering(abs(self.worst.error), self.unit, scale=self.scale) if self.worst else ""

    @property
    def tolerance_text(self) -> str:
        """How far a cut may be from its mark: `0.1 mm`; empty if the scenario has no table [cuts]."""
        return "" if self.tolerance is None else engineering(self.tolerance, self.unit)

    @property
    def cuts_text(self) -> str:
        """The cuts in words; empty if the scenario has no table [cuts]."""
        if self.tolerance is None:
            return ""
        if not self.worst:
            return "no cut"
        count = f"{len(self.cuts)} cut{'s' * (len(self.cuts) > 1)}, worst error {self.worst_text}"
        if abs(self.worst.error) <= ROUNDING * self.scale:
            return count
        number = f"cut {1 + self.cuts.index(self.worst)}, " if len(self.cuts) > 1 else ""
        return f"{count} ({number}mark {engineering(self.worst.mark, self.unit)})"

    @property
    def work_text(self) -> str:
        """What was made or cut, in a few words; empty if neither is known."""
        return self.production.short_text if self.production else self.cuts_text

    @property
    def uncut_text(self) -> str:
        """The marks that passed uncut, in words; empty if there are none."""
        return uncut_text(self.uncut, self.unit)


def compute_key_figures(scenario: Scenario, recording: Recording, results: CuttingResults | None = None) -> KeyFigures:
    """The figures of a run of a scenario. `results`: its cuts and pieces, if the caller has them."""
    spec = scenario.cuts
    results = results or CuttingResults(scenario, recording)
    return KeyFigures(
        tuple(find_peaks(scenario, recording)),
        results.production,
        results.cuts,
        results.uncut,
        spec.tolerance if spec else None,
        results.true_pieces,
        find_following_error(scenario, recording),
        find_load_figures(scenario, recording),
        unit_name(Unit.POSITION, scenario.unit),
        greatest_position(recording),
    )


# --- peaks ---


def find_peaks(scenario: Scenario, recording: Recording) -> list[Peak]:
    """How far each of the slave's values went in a run of a scenario."""

    def unit(kind: Unit) -> str:
        return unit_name(kind, scenario.slave_unit or scenario.unit)

    def limit(role: Role) -> Reals | None:
        """The value of the variable with this role at each point; None if the block has none."""
        v = find_by_role(scenario.recipe.variables.values(), role)
        return time_series(scenario, recording, v.name) if v else None

    position, velocity, acceleration, jerk = (recording.values[name] for name in SLAVE_OUTPUTS)
    most, slowing = limit(Role.MAX_ACCELERATION), limit(Role.MAX_DECELERATION)
    peaks = [
        _find_stroke(position, limit(Role.MIN_POSITION), limit(Role.MAX_POSITION), recording.time, unit(Unit.POSITION)),
        _find_peak("velocity", velocity, _finite_limit(limit(Role.MAX_VELOCITY)), recording.time, unit(Unit.VELOCITY)),
    ]
    if slowing is None:
        allowed = _finite_limit(most)
        peaks.append(_find_peak("acceleration", acceleration, allowed, recording.time, unit(Unit.ACCELERATION)))
    else:
        faster, slower = _split_by_speed(velocity, acceleration)
        slowing = np.where(slowing == 0.0, 0.0 if most is None else most, slowing)
        for name, values, highest in (("acceleration", faster, most), ("deceleration", slower, slowing)):
            peaks.append(_find_peak(name, values, _finite_limit(highest), recording.time, unit(Unit.ACCELERATION)))
    peaks.append(_find_peak("jerk", jerk, _finite_limit(limit(Role.MAX_JERK)), recording.time, unit(Unit.JERK)))
    return [replace(peak, own=_find_own(scenario, recording, peak)) for peak in peaks]


def _find_own(scenario: Scenario, recording: Recording, peak: Peak) -> float:
    """The greatest magnitude of a value in the cycles of a block that shows it; 0: it does not.

    A cycle that is beyond the limit is not carried out."""
    role = OWN_PEAKS.get(peak.name)
    v = role and find_by_role(scenario.recipe.variables.values(), role)
    if not v:
        return 0.0
    values = recording.values.get(v.name, np.zeros(1))
    most = math.inf if peak.limit is None else peak.limit * (1.0 + SETPOINT_TOLERANCE)
    return float(values[values <= most].max(initial=0.0))


def _finite_limit(limit: Reals | None) -> Reals | None:
    """A limit whose 0 means that there is none, as infinity; None if it is nowhere finite."""
    if limit is None or not limit.any():
        return None
    return np.where(limit == 0.0, math.inf, limit)


def _split_by_speed(velocity: Reals, acceleration: Reals) -> tuple[Reals, Reals]:
    """The magnitudes of the acceleration where the speed grows and where it falls; 0 elsewhere.

    Where the slave is at rest at a point, the adjacent points decide whether its speed grows or falls."""
    still = np.abs(velocity) <= ROUNDING * float(np.abs(velocity).max())
    moving = np.where(still, 0.0, velocity)
    before, after = np.concatenate([[0.0], moving[:-1]]), np.concatenate([moving[1:], [0.0]])
    grows = np.where(still, after, moving) * acceleration > 0.0
    falls = np.where(still, before, moving) * acceleration < 0.0
    magnitude = np.abs(acceleration)
    return np.where(grows, magnitude, 0.0), np.where(falls, magnitude, 0.0)


def _find_peak(name: str, values: Reals, limit: Reals | None, time: Reals, unit: str) -> Peak:
    magnitude = np.abs(values)
    i = int(np.argmax(magnitude if limit is None else magnitude / limit))
    if limit is not None and math.isinf(limit[i]):  # the slave moved only where there was no limit
        i = int(np.argmax(magnitude))
    allowed = None if limit is None or math.isinf(limit[i]) else float(limit[i])
    exceeded = limit is not None and bool((magnitude > limit * (1.0 + SETPOINT_TOLERANCE)).any())
    return Peak(name, unit, float(values.min()), float(values.max()), float(time[i]), allowed, None, exceeded)


def _find_stroke(position: Reals, lower: Reals | None, upper: Reals | None, time: Reals, unit: str) -> Peak:
    """The peak of the position, between two end positions that may be far away."""
    below = np.full(len(time), -math.inf) if lower is None else lower - position
    above = np.full(len(time), -math.inf) if upper is None else position - upper
    beyond = np.maximum(below, above)
    i = int(np.argmax(np.abs(position) if lower is None and upper is None else beyond))
    allowed = ROUNDING * max(1.0, float(np.ptp(position)), float(np.abs(position).max()))

    def end(limit: Reals | None) -> float | None:
        return None if limit is None or abs(limit[i]) >= NOWHERE else float(limit[i])

    exceeded = bool((beyond > allowed).any())
    least, greatest = float(position.min()), float(position.max())
    return Peak("position", unit, least, greatest, float(time[i]), end(upper), end(lower), exceeded)


def _range_text(low: float, high: float, unit: str, scale: float = 0.0) -> str:
    return f"{_number_text(low, scale)} to {_number_text(high, scale)} {unit}".strip()


def _number_text(value: float, scale: float) -> str:
    """A number without its unit; 0 where it is rounding at this scale."""
    return engineering(0.0 if abs(value) <= ROUNDING * scale else value)
