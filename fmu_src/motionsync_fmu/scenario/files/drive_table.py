"""The keys of the table [master] of a scenario whose master follows a velocity that the block requests."""

import math

from motionsync.var import Unit

from ...interface.variables import Variable
from ..drive import Drive
from .keys import Key, TableKeys, number
from .toml_tables import TomlTable
from .variable_tables import OutputTable, Subject

DRIVE = TableKeys(
    "[master], a master that follows",
    "A master that follows a velocity which the block requests has these keys in place of acceleration and segments.",
    (
        Key("follows", "what it follows", "an output or local variable that is a velocity in the master's unit"),
        number("time_constant", "of a lag of first order (PT1)", "s", above=0.0),
        number("max_acceleration", "in both directions", "u/s2", default=math.inf, above=0.0),
    ),
)
SCRIPTED = ("acceleration", "segments")  # what a master that follows a velocity does not have


class VelocityTable(OutputTable):
    """A table that names an output which is a velocity."""

    required = "an output or local variable that is a velocity in the master's unit"

    def fits(self, v: Variable) -> bool:
        return super().fits(v) and v.declaration.unit is Unit.VELOCITY


def read_drive(table: TomlTable, block: Subject) -> Drive | None:
    """The drive in the table [master]; None: the master is scripted.

    Raises:
        UserError: the first mistake in it.
    """
    given = [key for key in DRIVE.names if key in table]
    if not given:
        return None
    if "follows" not in given:
        table.fail(given[0], "belongs to a master that follows a velocity: follows is missing")
    for key in SCRIPTED:
        if key in table:
            table.fail(key, "a master that follows a velocity starts with its position and velocity alone")
    name = table.string("follows")
    VelocityTable(table, block).variable(name, "follows")
    limit = DRIVE.value(table, "max_acceleration")
    return Drive(name, DRIVE.value(table, "time_constant"), limit)
