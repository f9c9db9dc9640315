"""What a host in compiled code knows of a run: where the block's variables are, and where it records them.

A variable is two numbers: its offset in the block, in bytes, and how it is stored. An address has 64 bits on every
machine."""

from dataclasses import dataclass

from motionsync import var
from motionsync.var import Enumeration


class Stored(Enumeration):
    """How the value of a variable is stored."""

    REAL = 0, "a double"
    WORD = 1, "an integer of 64 bits: an Integer, a member of an enumeration"
    FLAG = 2, "a byte: a Boolean"


@dataclass(slots=True)
class Host:
    """What a host knows of a run.

    Attributes:
        block: the address of the block's memory.
        position, velocity, acceleration, cycle_index: the offsets of the inputs of the axis.
        sets: the variables that the program sets.
        sees: the outputs that the program sees.
        records: the variables that are recorded.
        checks: the offsets of the Reals that each step checks.
        limits: of each of these the least and the greatest value, the least magnitude of a value other than 0, and
            whether 0 is allowed (1) or not (0).
        times: where the communication points are recorded, s; empty: nothing is recorded.
        axis: the motion of the axis at each point, four numbers each.
        values: the recorded variables, one after the other, each at all points that `times` has space for.
        count: how many points have been recorded.
        cause, number: why a batch stopped the run, and the refusal or the checked Real that it is about.
    """

    block: int = 0
    position: int = 0
    velocity: int = 0
    acceleration: int = 0
    cycle_index: int = 0
    sets: var.Wholes = var.series()
    sees: var.Wholes = var.series()
    records: var.Wholes = var.series()
    checks: var.Wholes = var.series()
    limits: var.Reals = var.series()
    times: var.Reals = var.series()
    axis: var.Reals = var.series()
    values: var.Reals = var.series()
    count: int = 0
    cause: int = 0
    number: int = 0
