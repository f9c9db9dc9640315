"""Columns of a recording that are computed after the run: what the servo makes of the setpoint, and what a load needs.

Neither acts back on the block. Runs in Python and in compiled code get the columns from here, and so the same bits.
"""

from collections.abc import Mapping

from motionsync.var import Declaration, Unit

from ..interface.variables import Cell, Variable
from .load import Load
from .recording import Reals, unwrapped
from .servo import Servo

SETPOINT = ("slave.position", "slave.velocity", "slave.acceleration")
ACTUAL_POSITION, ACTUAL_VELOCITY = "actual.slave.position", "actual.slave.velocity"
FOLLOWING_ERROR = "actual.slave.following_error"
FORCE, POWER = "load.force", "load.power"

OF_SERVO = {
    ACTUAL_POSITION: ("the axis's position behind the servo, not wrapped", Unit.SLAVE_POSITION),
    ACTUAL_VELOCITY: ("the axis's velocity behind the servo", Unit.SLAVE_VELOCITY),
    FOLLOWING_ERROR: ("the setpoint less the axis's position", Unit.SLAVE_POSITION),
}
OF_LOAD = {
    FORCE: ("the motor's force in N; its torque in N m where the axis turns", Unit.NONE),
    POWER: ("the motor's power in W; negative where it brakes", Unit.NONE),
}


def computed_variables(*, servo: bool, load: bool) -> dict[str, Variable]:
    """The columns as variables, by name; `servo`, `load`: whether the scenario has these tables."""
    columns = (OF_SERVO if servo else {}) | (OF_LOAD if load else {})
    return {name: _variable(name, Declaration("local", *texts)) for name, texts in columns.items()}


def _variable(name: str, declaration: Declaration) -> Variable:
    return Variable(Cell(name, None, name, float, declaration, None), declaration, (), 0.0, declaration.causality)


def needed_outputs(servo: Servo | None, load: Load | None) -> tuple[str, ...]:
    """The outputs of the block from which the columns are computed."""
    return SETPOINT[:2] if servo else SETPOINT[1:] if load else ()


def compute_columns(
    servo: Servo | None, load: Load | None, slave_period: float, time: Reals, values: Mapping[str, Reals]
) -> dict[str, Reals]:
    """The columns of a run by name, each of shape (points,); none if an output is missing that they need.

    `slave_period`: that of the slave's position, in u; 0: it is not wrapped. `time`: the communication points, in s;
    `values`: the recorded outputs."""
    needed = needed_outputs(servo, load)
    if not needed or any(name not in values for name in needed):
        return {}
    columns: dict[str, Reals] = {}
    velocity = values[SETPOINT[1]]
    if servo:
        setpoint = unwrapped(time, values[SETPOINT[0]], velocity, slave_period)
        actual = servo.follow(time, setpoint, velocity)
        velocity, acceleration = actual.velocity, actual.acceleration
        columns |= {ACTUAL_POSITION: actual.position, ACTUAL_VELOCITY: velocity}
        columns[FOLLOWING_ERROR] = setpoint - actual.position
    else:
        acceleration = values[SETPOINT[2]]
    if load:
        columns[FORCE] = load.force(velocity, acceleration)
        columns[POWER] = load.power(columns[FORCE], velocity)
    return columns
