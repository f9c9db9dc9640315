"""A plan of a line: what its machine can do at each of some lengths, and at each of some line velocities."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from ..errors import UserError
from .comparison import Comparison, compare
from .confirmation import confirm
from .machine import Machine
from .motor import predict_motor_use
from .prediction import TOLERANCE, Prediction, WorkingPoint

DEFAULT_COUNT = 9  # about so many lengths or velocities are planned where none are given
LONGEST_PITCH = 1.25  # of the longest pitch that limits the line: the longest default pitch
LEAST_VELOCITY = 0.1  # of the greatest line velocity: the least default velocity


@dataclass(frozen=True, repr=False)
class MachinePlan:
    """What one machine can do.

    Attributes:
        over_length: the greatest line velocity at each length.
        over_velocity: the shortest length at each line velocity.
        has_given_lengths: whether the lengths are those that were asked for; else they are a selection.
        working_points: each length that is asked for, or that the machine's scenario cuts, at each such line velocity.
    """

    machine: Machine
    over_length: list[Prediction]
    over_velocity: list[Prediction]
    has_given_lengths: bool
    working_points: list[WorkingPoint]

    def __repr__(self) -> str:
        return f"{self.machine.title}: {len(self.predictions)} predictions"

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
        machine = self.machine
        return {
            "title": machine.title,
            "machine": machine.kind,
            "block": machine.block,
            "unit": machine.unit,
            "slave_unit": machine.slave_unit,
            "start": {name: machine.recipe.variables[name].text(value) for name, value in machine.start.items()},
            "confirmed": self.is_confirmed,
            "greatest_velocity": machine.greatest_velocity,
            "over_length": [_as_json(prediction) for prediction in self.over_length],
            "over_velocity": [_as_json(prediction) for prediction in self.over_velocity],
            "working_points": [asdict(point) | {"margin": point.margin} for point in self.working_points],
        }


@dataclass(frozen=True)
class LinePlan:
    """What the machines that are planned for a line can do.

    Attributes:
        machines: the plan of each; there is at least one.
        comparison: which machine is better for the orders; None: there is one machine only.
    """

    machines: tuple[MachinePlan, ...]
    comparison: Comparison | None

    @property
    def title(self) -> str:
        if self.comparison:
            labels = [compared.label for compared in self.comparison.machines]
            return f"{labels[0][0].upper()}{labels[0][1:]}, or {', or '.join(labels[1:])}?"
        return self.machines[0].machine.title

    @property
    def name(self) -> str:
        """Of the folder for the page."""
        return "_or_".join(dict.fromkeys(plan.machine.name for plan in self.machines))

    @property
    def predictions(self) -> list[Prediction]:
        return [prediction for plan in self.machines for prediction in plan.predictions]

    @property
    def is_confirmed(self) -> bool:
        """Whether the runs of the blocks did all that was predicted."""
        return all(plan.is_confirmed for plan in self.machines)

    @property
    def runs(self) -> int:
        """How many runs of the blocks were evaluated."""
        return sum(plan.runs for plan in self.machines)

    def as_json(self) -> dict[str, Any]:
        """The plan as `--json` prints it."""
        return {
            "confirmed": self.is_confirmed,
            "comparison": self.comparison.as_json() if self.comparison else None,
            "machines": [plan.as_json() for plan in self.machines],
        }


def _as_json(prediction: Prediction) -> dict[str, Any]:
    return asdict(prediction) | {
        "figures": {name: figure.value for name, figure in prediction.figures.items()},
        "cycle_time": prediction.cycle_time,
        "confirmed": prediction.is_confirmed,
    }


def make_plan(machines: Sequence[Machine], lengths: Sequence[float], velocities: Sequence[float]) -> LinePlan:
    """Predict and confirm for each machine, length and line velocity. `lengths`, `velocities`: empty: a default
    selection, in which the machine's own orders and line velocity are.

    Raises:
        UserError: a machine can cut nothing, a length is not allowed, or machines have different units.
    """
    if len({machine.unit for machine in machines}) > 1:
        units = ", ".join(f"{machine.title}: {machine.unit}" for machine in machines)
        raise UserError(f"machines that are compared need the same unit ({units})")
    for machine in machines:
        machine.check()
        for length in lengths:
            check_length(machine, length)
    own_orders = sorted({order for machine in machines for order in machine.orders})
    own_velocities = [machine.line_velocity for machine in machines if machine.line_velocity]
    plans = tuple(plan_machine(machine, lengths, velocities) for machine in machines)
    if len(machines) == 1:
        return LinePlan(plans, None)
    orders = lengths or own_orders or default_lengths(machines[0])
    return LinePlan(plans, compare(machines, sorted(orders), max([*velocities] or own_velocities, default=None)))


def plan_machine(machine: Machine, lengths: Sequence[float], velocities: Sequence[float]) -> MachinePlan:
    """The plan of one machine; `lengths`, `velocities` as for `make_plan`."""
    own_velocities = [machine.line_velocity] if machine.line_velocity else []
    points = [
        plan_working_point(machine, length, velocity)
        for length in lengths or machine.orders
        for velocity in velocities or own_velocities
    ]
    shown_lengths, shown_velocities = lengths or default_lengths(machine), velocities or default_velocities(machine)
    over_length = [confirm(machine, machine.predict_greatest_velocity(length)) for length in shown_lengths]
    over_velocity = [confirm(machine, machine.predict_shortest_length(velocity)) for velocity in shown_velocities]
    return MachinePlan(
        machine, _with_motor(machine, over_length), _with_motor(machine, over_velocity), bool(lengths), points
    )


def plan_working_point(machine: Machine, length: float, velocity: float) -> WorkingPoint:
    """The plan for pieces of this length at this line velocity."""
    greatest = machine.predict_greatest_velocity(length).velocity
    is_reached = greatest >= velocity * (1.0 - TOLERANCE)
    motor = predict_motor_use(machine, machine.load, length, velocity) if machine.load and is_reached else None
    return WorkingPoint(length, velocity, greatest, motor)


def _with_motor(machine: Machine, predictions: list[Prediction]) -> list[Prediction]:
    """The predictions with what the motor has to give, where the load is known, and there is a cycle."""
    load = machine.load
    if load is None:
        return predictions
    return [
        replace(p, motor=predict_motor_use(machine, load, p.length, p.velocity)) if p.cycle and p.length else p
        for p in predictions
    ]


def check_length(machine: Machine, length: float) -> None:
    """Refuse a length that leaves no distance between two cuts."""
    if machine.pitch(length) <= 0.0:
        raise UserError(
            f"length {length:g} is not allowed: with kerf = {machine.value('kerf'):g} and length_correction = "
            f"{machine.value('length_correction'):g} it must be > {machine.length(0.0):g}"
        )


def default_velocities(machine: Machine) -> list[float]:
    """Round line velocities up to the greatest one, that one itself, and the machine's own one."""
    top = machine.greatest_velocity
    own = {machine.line_velocity} if machine.line_velocity else set[float]()
    return sorted({*(v for v in round_values(LEAST_VELOCITY * top, top) if v < top), top, *own})


def default_lengths(machine: Machine) -> list[float]:
    """Round lengths from those of a slow line up to those that no longer limit the line, and the machine's own ones."""
    low, high = machine.pitch_range(LEAST_VELOCITY * machine.greatest_velocity)
    beyond = machine.length(LONGEST_PITCH * high)
    if beyond <= 0.0:  # the kerf alone takes longer than any cycle
        low, beyond = machine.pitch(0.0), machine.length(machine.pitch(0.0) + high)
    return sorted({*(x for x in round_values(machine.length(low), beyond) if x > 0.0), *machine.orders})


def round_values(low: float, high: float) -> list[float]:
    """About DEFAULT_COUNT round numbers between two numbers."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415 (it takes long to load)

    ticks = MaxNLocator(DEFAULT_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if low <= tick <= high]
