"""The same cuts, ordered from a FlyingSaw by its commands, put its carriage where that of the CutToLength is.

What a user of a FlyingSaw writes himself: gear_in_pos before each cut, which leads over D = 100 to the sync positions
C + D / k and D and begins where the master is 2 D / k before; when the cut is through, move_absolute home. All places
and instants of these orders are computed here, from the length and the line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol, Self

import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.scenario.fmu_instance import FmuInstance
from tests.model.cut_to_length.harness import REFERENCE, ROUND
from tests.support.fmus import Fmus
from tests.support.harness import MOTION, moved

AXIS = {name: value for name, value in REFERENCE.items() if name.startswith("axis.")}
H, END = 2.0**-6, 9.0  # s
LENGTH, WAY, CUT_TIME = 1500.0, 100.0, 0.25  # ROUND's; the approach is no longer than WAY up to 1100 u/s
AGAIN = 0.75  # s after a cut the carriage is at home; the next approach is ordered


class Machine(Protocol):
    """A block in this process, or an FMU."""

    def initialize(self, values: Mapping[str, Any]) -> Self: ...

    def step(self, h: float, values: Mapping[str, Any]) -> object: ...

    def get(self, names: Any) -> dict[str, Any]: ...


@dataclass(frozen=True)
class Line:
    """It runs from place 0 at 0 s; from `begin` to `end` it gets faster or slower."""

    speed: float
    begin: float
    end: float
    acceleration: float

    def at(self, time: float) -> dict[str, float]:
        """The master's inputs at a time."""
        place, speed = moved(0.0, self.speed, 0.0, min(time, self.begin))
        place, speed = moved(place, speed, self.acceleration, max(min(time, self.end) - self.begin, 0.0))
        place, speed = moved(place, speed, 0.0, max(time - self.end, 0.0))
        acceleration = self.acceleration if self.begin <= time < self.end else 0.0
        return {"master.position": place, "master.velocity": speed, "master.acceleration": acceleration}

    def time(self, place: float) -> float:
        """When it is at a place; it runs forwards."""
        low, high = 0.0, 2.0 * END
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.at(middle)["master.position"] < place else (low, middle)
        return high


LINES = [
    (Line(1000.0, 0.0, 0.0, 0.0), 1.0),
    (Line(1000.0, 3.0, 4.0, 50.0), 1.02),  # in the second cut
    (Line(1050.0, 1.75, 3.25, -200.0), 1.0),  # from the first cut into the second
]


def positions(machine: Machine, line: Line, orders: Mapping[float, dict[str, Any]]) -> list[dict[str, Any]]:
    """The carriage at the multiples of H; the line and the orders take effect at their own times."""
    grid = [i * H for i in range(int(END / H) + 1)]
    times = sorted({*grid, *orders, line.begin, line.end})
    seen, found = set(grid), []
    for now, then in pairwise(times):
        machine.step(then - now, {**line.at(now), **orders.get(now, {})})
        if then in seen:
            found.append(machine.get(MOTION))
    return found


def cut_to_length(machine: Machine, line: Line, factor: float) -> list[dict[str, Any]]:
    machine.initialize({**ROUND, "material_factor": factor, **line.at(0.0)})
    return positions(machine, line, {0.0: {"start": True}})


def flying_saw(machine: Machine, line: Line, factor: float) -> list[dict[str, Any]]:
    machine.initialize({**AXIS, **line.at(0.0)})
    orders: dict[float, dict[str, Any]] = {}
    ordered = 0.0
    for number in range(1, 20):
        sync = (number * LENGTH + WAY) / factor
        through = line.time(sync) + CUT_TIME
        orders[ordered] = {
            "gear_in_pos.ratio_numerator": factor,
            "gear_in_pos.master_sync_position": sync,
            "gear_in_pos.slave_sync_position": WAY,
            "gear_in_pos.master_start_distance": 2.0 * WAY / factor,
            "gear_in_pos.execute": True,
            "move_absolute.execute": False,
        }
        if through + AGAIN >= END:
            break
        orders[through] = {
            "gear_in_pos.execute": False,
            "move_absolute.position": 0.0,
            "move_absolute.velocity": AXIS["axis.max_velocity"],
            "move_absolute.execute": True,
        }
        ordered = through + AGAIN
    return positions(machine, line, {time: values for time, values in orders.items() if time < END})


def assert_agree(make: Callable[[str], Machine], line: Line, factor: float) -> None:
    one = cut_to_length(make("CutToLength"), line, factor)
    other = flying_saw(make("FlyingSaw"), line, factor)
    ready = line.time(5.0 * LENGTH / factor - WAY / factor)  # five cuts
    compared = [(x, y) for i, (x, y) in enumerate(zip(one, other, strict=True)) if (i + 1) * H < ready]
    assert max(x["slave.position"] for x, _ in compared) > 340.0
    for x, y in compared:
        for name, allowed in zip(MOTION[:3], (1e-9, 1e-7, 1e-5), strict=True):
            assert x[name] == pytest.approx(y[name], abs=allowed, rel=0.0), name


@pytest.mark.parametrize(("line", "factor"), LINES)
def test_the_blocks_put_their_carriages_at_the_same_places(line: Line, factor: float) -> None:
    blocks = {"CutToLength": CutToLength, "FlyingSaw": FlyingSaw}
    assert_agree(lambda name: Stepper(blocks[name]()), line, factor)


def test_the_fmus_put_their_carriages_at_the_same_places(fmus: Fmus) -> None:
    opened: list[FmuInstance] = []

    def instance(name: str) -> FmuInstance:
        opened.append(FmuInstance(fmus.native(name)))
        return opened[-1]

    try:
        assert_agree(instance, *LINES[1])
    finally:
        for machine in opened:
            machine.close()
