"""The tables [servo] and [load] of a scenario file: what follows the setpoint, and what the axis moves."""

from ..load import Load
from ..servo import Servo
from .keys import TableKeys, number
from .toml_tables import TomlTable

LEAST_GAIN, MOST_GAIN = 1e-3, 1e6  # 1/s: with less, what is computed is rounding
LONGEST = 1e3  # s
SHORTEST = 1e-9  # s: a shorter time constant would be rounding of the communication points
MOST_FEEDFORWARD = 10.0
MOST = 1e12  # of mass, inertia and forces

SERVO = TableKeys(
    "[servo]",
    "A position controller with feedforward, between the setpoint and the tool.",
    (
        number("position_gain", "Kv", "1/s", least=LEAST_GAIN, most=MOST_GAIN),
        number("velocity_time_constant", "Tv of the velocity loop", "s", smallest=SHORTEST, most=LONGEST),
        number("feedforward", "share of the setpoint's velocity", default=1.0, least=0.0, most=MOST_FEEDFORWARD),
        number("dead_time", "how late the setpoint acts", "s", default=0.0, least=0.0, most=LONGEST),
    ),
)
LOAD = TableKeys(
    "[load]",
    "What the slave's axis moves. Forces are torques, in N m, where the slave is in deg or rad.",
    (
        number("mass", "of a slave in mm, m or 1", "kg", above=0.0, most=MOST),
        number("inertia", "of a slave in deg or rad, instead of the mass", "kg m2", above=0.0, most=MOST),
        number("friction", "Coulomb friction", "N", default=0.0, least=0.0, most=MOST),
        number("peak_force", "peak force of the motor", "N", absent="no limit", above=0.0, most=MOST),
        number("continuous_force", "continuous (rms) force of the motor", "N", absent="no limit", above=0.0, most=MOST),
    ),
)


def read_servo(table: TomlTable) -> Servo:
    """The servo in the table [servo].

    Raises:
        UserError: the first mistake in it.
    """
    return Servo(**SERVO.read(table))


def read_load(table: TomlTable, unit: str) -> Load:
    """The load in the table [load]; `unit`: that of the slave's positions.

    Raises:
        UserError: the first mistake in it.
    """
    load = Load(0.0, 0.0, unit)
    name, other, quantity = ("inertia", "mass", "kg m2") if load.turns else ("mass", "inertia", "kg")
    if other in table:
        table.fail(other, f"the slave is in {unit}: what it moves is the {name}, in {quantity}")
    values = LOAD.without(other).read(table)
    return Load(values.pop(name), unit=unit, **values)
