"""A plan of a line: what its machine can do at each of some lengths, and at each of some line velocities."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from matplotlib.ticker import MaxNLocator

from motionsync.cut_to_length.machine_limits import shortest_pitch

from ..errors import UserError
from .confirmation import confirm
from .machine_data import MachineData
from .motor import predict_motor_use
from .prediction import Prediction, predict_greatest_velocity, predict_shortest_length

DEFAULT_COUNT = 9  # about so many lengths or velocities are planned where none are given
LEAST_VELOCITY = 0.1  # of the greatest line velocity: the least default velocity
LONGEST_PITCH = 1.25  # of the longest pitch that the cycle time limits: the longest default pitch


@dataclass(frozen=True)
class LinePlan:
    """What the machine of a line can do.

    Attributes:
        over_length: the greatest line velocity at each length.
        over_velocity: the shortest length at each line velocity.
    """

    data: MachineData
    over_length: list[Prediction]
    over_velocity: list[Prediction]

    @property
    def predictions(self) -> list[Prediction]:
        return [*self.over_length, *self.over_velocity]

    @property
    def is_confirmed(self) -> bool:
        """Whether the runs of the block did all that was predicted."""
        return all(prediction.is_confirmed for prediction in self.predictions)

    @property
    def runs(self) -> int:
        """How many runs of the block were evaluated."""
        return sum(len(prediction.checks) for prediction in self.predictions)

    def as_json(self) -> dict[str, Any]:
        """The plan as `--json` prints it."""
        return {
            "title": self.data.title,
            "unit": self.data.unit,
            "start": {name: self.data.recipe.variables[name].text(value) for name, value in self.data.start.items()},
            "confirmed": self.is_confirmed,
            "greatest_velocity": self.data.greatest_velocity,
            "over_length": [_as_json(prediction) for prediction in self.over_length],
            "over_velocity": [_as_json(prediction) for prediction in self.over_velocity],
        }


def _as_json(prediction: Prediction) -> dict[str, Any]:
    return asdict(prediction) | {
        "limited_by": prediction.limited_by,
        "cycle_time": prediction.cycle.time if prediction.cycle else None,
        "confirmed": prediction.is_confirmed,
    }


def make_plan(data: MachineData, lengths: Sequence[float], velocities: Sequence[float]) -> LinePlan:
    """Predict and confirm for each length and line velocity. `lengths`, `velocities`: empty: a default selection.

    Raises:
        UserError: the machine can cut nothing, or a length is not allowed.
    """
    if data.greatest_velocity <= 0.0:
        travel = data.machine.max_position - data.machine.home_position
        raise UserError(
            f"axis.max_position = {data.machine.max_position:g} is too near: from home_position = "
            f"{data.machine.home_position:g} the travel is {travel:g}, and no cycle is that short"
        )
    lengths, velocities = lengths or default_lengths(data), velocities or default_velocities(data)
    over_length = [confirm(data, predict_greatest_velocity(data, length)) for length in lengths]
    over_velocity = [confirm(data, predict_shortest_length(data, velocity)) for velocity in velocities]
    return LinePlan(data, _with_motor(data, over_length), _with_motor(data, over_velocity))


def _with_motor(data: MachineData, predictions: list[Prediction]) -> list[Prediction]:
    """The predictions with what the motor has to give, where the load is known, and there is a cycle."""
    load = data.load
    if load is None:
        return predictions
    return [
        replace(p, motor=predict_motor_use(data, load, p.length, p.velocity)) if p.cycle and p.length else p
        for p in predictions
    ]


def default_velocities(data: MachineData) -> list[float]:
    """Round line velocities up to the greatest one, which comes last."""
    top = data.greatest_velocity
    return [*(v for v in round_values(LEAST_VELOCITY * top, top) if v < top), top]


def default_lengths(data: MachineData) -> list[float]:
    """Round lengths from those of a slow line up to those that the cycle time no longer limits."""
    top = data.greatest_velocity
    low, high = (shortest_pitch(data.machine, v) for v in (LEAST_VELOCITY * top, top))
    beyond = data.length(LONGEST_PITCH * high)
    if beyond <= 0.0:  # the kerf alone takes longer than any cycle
        low, beyond = data.pitch(0.0), data.length(data.pitch(0.0) + high)
    return [length for length in round_values(data.length(low), beyond) if length > 0.0]


def round_values(low: float, high: float) -> list[float]:
    """About DEFAULT_COUNT round numbers between two numbers."""
    ticks = MaxNLocator(DEFAULT_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if low <= tick <= high]
