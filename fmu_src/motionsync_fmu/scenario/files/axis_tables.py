"""The tables [servo] and [load] of a scenario file: what follows the setpoint, and what the axis moves."""

from ..load import Load
from ..servo import Servo
from .toml_tables import TomlTable

MOST_GAIN = 1e6  # 1/s
LONGEST = 1e3  # s
SHORTEST = 1e-9  # s: a shorter time constant would be rounding of the communication points
MOST_FEEDFORWARD = 10.0
MOST = 1e12  # of mass, inertia and forces


def read_servo(table: TomlTable) -> Servo:
    """The servo in the table [servo].

    Raises:
        UserError: the first mistake in it.
    """
    table.allow_only("position_gain", "velocity_time_constant", "feedforward", "dead_time")
    return Servo(
        table.number("position_gain", above=0.0, most=MOST_GAIN),
        table.number_or_0("velocity_time_constant", smallest=SHORTEST, most=LONGEST),
        table.number("feedforward", default=1.0, least=0.0, most=MOST_FEEDFORWARD),
        table.number("dead_time", default=0.0, least=0.0, most=LONGEST),
    )


def read_load(table: TomlTable, unit: str) -> Load:
    """The load in the table [load]; `unit`: that of the slave's positions.

    Raises:
        UserError: the first mistake in it.
    """
    load = Load(0.0, 0.0, unit)
    name, other, quantity = ("inertia", "mass", "kg m2") if load.turns else ("mass", "inertia", "kg")
    if other in table:
        table.fail(other, f"the slave is in {unit}: what it moves is the {name}, in {quantity}")
    table.allow_only(name, "friction", "peak_force", "continuous_force")
    return Load(
        table.number(name, above=0.0, most=MOST),
        table.number("friction", default=0.0, least=0.0, most=MOST),
        unit,
        *(
            table.number(key, above=0.0, most=MOST) if key in table else None
            for key in ("peak_force", "continuous_force")
        ),
    )
