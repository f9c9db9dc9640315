"""A plan: what a machine can do at a choice of lengths, and at a choice of line velocities."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from matplotlib.ticker import MaxNLocator

from motionsync.cut_to_length.limits import shortest_pitch

from ..errors import UserError
from .confirmation import confirmed
from .machine_data import MachineData
from .prediction import Point, fastest, shortest

FEW = 9  # lengths or velocities that are chosen where none are given
SLOWEST = 0.1  # of the greatest line velocity: the least one that is chosen
BEYOND = 1.25  # of the longest pitch that matters: the longest one that is chosen


@dataclass(frozen=True)
class Plan:
    """What a machine can do.

    Attributes:
        over_length: the greatest line velocity at each length.
        over_velocity: the shortest length at each line velocity.
    """

    data: MachineData
    over_length: list[Point]
    over_velocity: list[Point]

    @property
    def points(self) -> list[Point]:
        return [*self.over_length, *self.over_velocity]

    @property
    def confirmed(self) -> bool:
        """Whether the runs of the block did all that was predicted."""
        return all(point.confirmed for point in self.points)

    @property
    def runs(self) -> int:
        """How many runs of the block were judged."""
        return sum(len(point.checks) for point in self.points)

    def as_json(self) -> dict[str, Any]:
        """What `--json` prints."""
        return {
            "title": self.data.title,
            "unit": self.data.unit,
            "start": {name: self.data.recipe.variables[name].text(value) for name, value in self.data.start.items()},
            "confirmed": self.confirmed,
            "greatest_velocity": self.data.greatest_velocity,
            "over_length": [_as_json(point) for point in self.over_length],
            "over_velocity": [_as_json(point) for point in self.over_velocity],
        }


def _as_json(point: Point) -> dict[str, Any]:
    return asdict(point) | {
        "limited_by": point.limited_by,
        "cycle_time": point.cycle.time if point.cycle else None,
        "confirmed": point.confirmed,
    }


def make_plan(data: MachineData, lengths: Sequence[float], velocities: Sequence[float]) -> Plan:
    """Predict and confirm all points. `lengths`, `velocities`: none given: a choice that shows all there is to see.

    Raises:
        UserError: the machine can cut nothing, or a length is none.
    """
    if data.greatest_velocity <= 0.0:
        room = data.machine.max_position - data.machine.home_position
        raise UserError(
            f"axis.max_position = {data.machine.max_position:g} is too near: from home_position = "
            f"{data.machine.home_position:g} there are {room:g}, and no cycle is that short"
        )
    lengths, velocities = lengths or chosen_lengths(data), velocities or chosen_velocities(data)
    points = [confirmed(data, predicted) for predicted in _predicted(data, lengths, velocities)]
    return Plan(data, points[: len(lengths)], points[len(lengths) :])


def _predicted(data: MachineData, lengths: Sequence[float], velocities: Sequence[float]) -> Iterator[Point]:
    yield from (fastest(data, length) for length in lengths)
    yield from (shortest(data, velocity) for velocity in velocities)


def chosen_velocities(data: MachineData) -> list[float]:
    """Round line velocities up to the greatest one, and that one."""
    top = data.greatest_velocity
    return [*(v for v in round_values(SLOWEST * top, top) if v < top), top]


def chosen_lengths(data: MachineData) -> list[float]:
    """Round lengths from those of a slow line up to those that the cycle time no longer limits."""
    top = data.greatest_velocity
    low, high = (shortest_pitch(data.machine, v) for v in (SLOWEST * top, top))
    beyond = data.length(BEYOND * high)
    if beyond <= 0.0:  # the kerf alone takes longer than any cycle
        low, beyond = data.pitch(0.0), data.length(data.pitch(0.0) + high)
    return [length for length in round_values(data.length(low), beyond) if length > 0.0]


def round_values(low: float, high: float) -> list[float]:
    """About FEW round numbers between two numbers."""
    ticks = MaxNLocator(FEW, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if low <= tick <= high]
