"""What the curves of a rotary knife and their limits are computed from: fixed for a machine."""

from dataclasses import dataclass


@dataclass(slots=True)
class Knife:
    """The cylinder, its blades, and the axis that turns it. The slave's unit is that of its position.

    Attributes:
        turn: the slave's position per turn of the cylinder.
        circumference: of the circle on which the blades' edges run, u of the material.
        spacing: the slave's travel from one blade to the next: turn over the number of blades.
        park_angle: where the blade nearest to the cut rests, as the slave's position beyond a cut.
        is_horizontal: in the window the edge's speed along the material is the line's; else that along its circle.
        may_park: the knife may stand between two cuts.
        max_velocity, max_acceleration, max_jerk: limits of the axis, in the slave's unit per s, s2, s3.
    """

    turn: float = 360.0
    circumference: float = 600.0
    spacing: float = 360.0
    park_angle: float = 180.0
    is_horizontal: bool = False
    may_park: bool = True
    max_velocity: float = 3600.0
    max_acceleration: float = 72000.0
    max_jerk: float = 1e6
