"""The registered blocks: one entry each, with the run that the block's documentation shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .synchronizer import Synchronizer


@dataclass(frozen=True)
class Example:
    """A run with a master at constant velocity that shows what the block is for.

    Attributes:
        caption: what the picture of the run shows.
        velocity: the master's, in u/s; it begins at position 0.
        duration: in s.
        start: start values of parameters and inputs.
        inputs: what is set when: (time in s, values).
    """

    caption: str
    velocity: float
    duration: float
    start: Mapping[str, Any]
    inputs: tuple[tuple[float, Mapping[str, Any]], ...]


@dataclass(frozen=True)
class Registered:
    """A block and its example."""

    type: type[Any]
    example: Example


BLOCKS: Mapping[str, Registered] = {
    "Synchronizer": Registered(
        Synchronizer,
        Example(
            "One turn is 360. A stop at rest_value 180, then a start: the slave leaves the master at 90 and rests at "
            "180; it leaves its rest at 101.25 of the next turn and is back on the master at 270.",
            velocity=180.0,
            duration=4.0,
            start={"master.period": 360.0, "master.velocity": 180.0, "rest_value": 180.0},
            inputs=((0.2, {"stop": True}), (1.8, {"start": True})),
        ),
    ),
}
