"""What a run asks of the slave's axis: its following error, and the force and power of its motor."""

from dataclasses import dataclass

import numpy as np

from motionsync.var import Unit

from ...interface.units import unit_name
from ..computed_columns import FOLLOWING_ERROR, FORCE, POWER
from ..engineering import engineering
from ..load import Load
from ..recording import Reals, Recording
from ..scenario import Scenario
from .time_series import true_stretches
from .true_pieces import cutting_flag

TORQUE = "N m"


@dataclass(frozen=True)
class FollowingError:
    """The greatest following error: its magnitude in `unit`, and its time in s."""

    greatest: float
    at: float
    unit: str


@dataclass(frozen=True)
class LoadFigures:
    """What the motor has to give. Forces are in N, or torques in N m where the axis turns.

    Attributes:
        peak: the greatest magnitude of the force in the whole run.
        peak_at: its time, in s.
        rms: the root of the mean square of the force over the cycles.
        peak_power: the greatest magnitude of the power in the whole run, in W.
        work: the work for a cycle in J; what comes back while braking is taken off. None: there are no cycles.
        begin: of the cycles, in s: the start of the first cut; without two cuts that of the run.
        end: of the cycles, in s: the start of the last cut; without two cuts the end of the run.
        cycles: how many there are from `begin` to `end`; 0: it is the whole run.
        peak_share: of the greatest force that the motor can give for a while; None: this is not given.
        rms_share: of the force that it can give for ever; None: this is not given.
        unit: the unit of forces.
    """

    peak: float
    peak_at: float
    rms: float
    peak_power: float
    work: float | None
    begin: float
    end: float
    cycles: int
    peak_share: float | None
    rms_share: float | None
    unit: str

    @property
    def what(self) -> str:
        """What the motor gives: a force, or a torque."""
        return "torque" if self.unit == TORQUE else "force"

    @property
    def beyond_motor(self) -> list[str]:
        """What the motor cannot give, a sentence each."""
        shares = (("peak", self.peak, self.peak_share), ("rms", self.rms, self.rms_share))
        return [
            f"beyond the motor: {name} {self.what} {engineering(force, self.unit)}, {100.0 * share:.3g} % of its own"
            for name, force, share in shares
            if share is not None and share > 1.0
        ]


def find_following_error(scenario: Scenario, recording: Recording) -> FollowingError | None:
    """The greatest following error of a run; None without a servo."""
    if FOLLOWING_ERROR not in recording.computed:
        return None
    magnitude = np.abs(recording.computed[FOLLOWING_ERROR])
    i = int(np.argmax(magnitude))
    unit = unit_name(Unit.POSITION, scenario.slave_unit or scenario.unit)
    return FollowingError(float(magnitude[i]), float(recording.time[i]), unit)


def find_load_figures(scenario: Scenario, recording: Recording) -> LoadFigures | None:
    """What the motor has to give in a run; None without a load."""
    load = scenario.load
    if load is None or FORCE not in recording.computed:
        return None
    force, power = recording.computed[FORCE], recording.computed[POWER]
    cuts = _cut_starts(scenario, recording)
    cycles = max(len(cuts) - 1, 0)
    inside = slice(cuts[0], cuts[-1] + 1) if cycles else slice(None)
    time = recording.time[inside]
    magnitude = np.abs(force)
    at = int(np.argmax(magnitude))
    peak, rms = float(magnitude[at]), root_mean_square(time, force[inside])
    return LoadFigures(
        peak,
        float(recording.time[at]),
        rms,
        float(np.abs(power).max()),
        integral(time, power[inside]) / cycles if cycles else None,
        float(time[0]),
        float(time[-1]),
        cycles,
        share(peak, load.peak_force),
        share(rms, load.continuous_force),
        force_unit(load),
    )


def force_unit(load: Load) -> str:
    """The unit of the forces of a load, or of its torques."""
    return TORQUE if load.turns else "N"


def root_mean_square(time: Reals, values: Reals) -> float:
    """By trapezoids, from the first time to the last."""
    return float(np.sqrt(integral(time, values * values) / (time[-1] - time[0])))


def integral(time: Reals, values: Reals) -> float:
    """By trapezoids, from the first time to the last."""
    return float(np.trapezoid(values, time))


def _cut_starts(scenario: Scenario, recording: Recording) -> list[int]:
    """The points at which cuts start."""
    name = cutting_flag(scenario)
    return [first for first, _ in true_stretches(recording.values[name])] if name else []


def share(value: float, given: float | None) -> float | None:
    """A force as a share of what the motor can give; None: this is not known."""
    return None if given is None else value / given
