"""The inputs of the Gearing as its oracle reads them: modes, requests of an edge, their faults, and triggers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tests.oracle.gearing.laws import ZERO
from tests.oracle.master import CLOSE
from tests.oracle.numerics import mp
from tests.oracle.numerics.mp import Number

STOPPED, WAITING_FOR_STARTPOSITION, GEAR_IN, ACTIVE, WAITING_FOR_STOPPOSITION, GEAR_OUT = range(6)
STATES = ("STOPPED", "WAITING_FOR_STARTPOSITION", "GEAR_IN", "ACTIVE", "WAITING_FOR_STOPPOSITION", "GEAR_OUT")
NONE, MASTER_BASED, TIME_BASED = 1, 2, 3
DIRECTIONS = {1: (1,), 2: (-1,), 3: (1, -1), 4: (1,), 5: (-1,), 6: (1, -1), 7: (1, -1)}
LAST_DIRECT, CONTINUE_SYNCHRONIZED = 3, 7
DIRECTIONS_NAMED = ("CW", "CCW", "CW_CCW")
MEMBERS: dict[str, tuple[str, ...]] = {
    "gear_in.start_mode": (
        *(f"{d}_DIRECT" for d in DIRECTIONS_NAMED),
        *(f"WITH_{d}_REFERENCE_POSITION" for d in DIRECTIONS_NAMED),
        "CONTINUE_SYNCHRONIZED",
    ),
    "gear_out.stop_mode": (
        *(f"{d}_DIRECT" for d in DIRECTIONS_NAMED),
        *(f"WITH_{d}_STOP_POSITION" for d in DIRECTIONS_NAMED),
    ),
    "gear_in.transition": ("NONE", "MASTER_BASED", "TIME_BASED"),
    "gear_out.transition": ("NONE", "MASTER_BASED", "TIME_BASED"),
}
"""The names of enumerations' members, from 1 on; scripts hold numbers or names."""
RATIO = ("gearing.numerator", "gearing.denominator")

DEFAULTS: dict[str, Any] = {
    "activate": True,
    "start": False,
    "reset": False,
    "gearing.numerator": 1,
    "gearing.denominator": 1,
    "gear_in.start_mode": 4,
    "gear_in.transition": MASTER_BASED,
    "gear_in.reference_position": 0.0,
    "gear_in.offset": 0.0,
    "gear_in.distance": 100.0,
    "gear_in.time": 1.0,
    "gear_out.stop_mode": 3,
    "gear_out.transition": MASTER_BASED,
    "gear_out.distance": 100.0,
    "gear_out.time": 1.0,
    "gear_out.stop_position": 0.0,
    "set_master.execute": False,
    "set_master.value": 0.0,
    "set_slave.execute": False,
    "set_slave.value": 0.0,
}
"""What may be set while the block runs, with the start values."""


@dataclass(frozen=True, slots=True)
class GearRequest:
    """What an edge read: the directions that count, and how. `position`: m_a of a gear-in, the stop position."""

    directions: tuple[int, ...]
    direct: bool
    transition: int
    distance: Number
    time: Number
    position: Number
    continued: bool = False

    @classmethod
    def read(cls, inputs: Mapping[str, Any], group: str) -> "GearRequest":
        """What an edge reads of a group of inputs."""
        mode = inputs["gear_in.start_mode" if group == "gear_in" else "gear_out.stop_mode"]
        position = mp.mpf(inputs["gear_out.stop_position"])
        if group == "gear_in":
            position = mp.mpf(inputs["gear_in.reference_position"]) + mp.mpf(inputs["gear_in.offset"])
        distance, transition = mp.mpf(inputs[f"{group}.distance"]), int(inputs[f"{group}.transition"])
        if transition == NONE or (transition == MASTER_BASED and distance == 0):
            transition, distance = NONE, ZERO
        return cls(
            DIRECTIONS[int(mode)],
            int(mode) <= LAST_DIRECT,
            transition,
            distance,
            mp.mpf(inputs[f"{group}.time"]),
            position,
            group == "gear_in" and int(mode) == CONTINUE_SYNCHRONIZED,
        )

    @property
    def immediate(self) -> bool:
        """It starts by the master's direction, not at a position."""
        return self.direct or self.transition == TIME_BASED

    def met(self, direction: int, at_rest: bool) -> bool:
        """The condition of an immediate one; `at_rest`: both directions include rest."""
        return direction in self.directions or (at_rest and len(self.directions) == 2)


@dataclass(frozen=True, slots=True)
class Triggers:
    """The trigger by direction, each again every `spacing` (u; 0: only once)."""

    by_direction: Mapping[int, Number]
    spacing: Number

    def following(self, master: Number, direction: int) -> Number:
        """The first occurrence at or ahead of the master in that direction; the only one may lie behind."""
        x = self.by_direction[direction]
        return first_ahead(x, self.spacing, master, direction)

    def shown(self, master: Number, direction: int) -> tuple[Number, Number]:
        """The next occurrence for a master that moves so, and how far it is from the first one given."""
        d = direction if direction in self.by_direction else next(iter(self.by_direction))
        x = self.following(master, d)
        return x, x - self.by_direction[d]


def first_ahead(x: Number, spacing: Number, position: Number, direction: int) -> Number:
    """The first x + n·spacing with direction·(x + n·spacing - position) >= 0, to rounding; x itself without spacing."""
    if spacing == 0:
        return x
    turns = (position - x) * direction / spacing
    margin = CLOSE * (1 + (abs(x) + abs(position)) / spacing)
    return x + direction * mp.ceil(turns - margin) * spacing


def fault(inputs: Mapping[str, Any], group: str, *, ratio: bool) -> int:
    """The first fault of a group's values, 0 if there is none."""
    if ratio and inputs["gearing.denominator"] == 0:
        return 1
    if ratio and inputs["gearing.numerator"] == 0:
        return 2
    if inputs[f"{group}.transition"] == TIME_BASED and not inputs[f"{group}.time"] > 0:
        return 3
    return 0 if inputs[f"{group}.distance"] >= 0 else 4


def number(name: str, value: Any) -> Any:
    """A member's number for its name; other values as they are."""
    return MEMBERS[name].index(value) + 1 if isinstance(value, str) else value
