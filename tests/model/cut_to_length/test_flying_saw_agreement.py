"""The same cuts, requested from a FlyingSaw by its commands, put its carriage where that of the CutToLength is.

What a user of a FlyingSaw writes himself: gear_in_pos before each cut, which leads over D = 100 to the sync positions
C + D / k and D and starts where the master is 2 D / k before; when the cut is through, move_absolute home. All
positions and instants of these requests are computed in this test, from the length and the line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol, Self

import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.interface.stepper import Stepper
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.model.cut_to_length.harness import REFERENCE, ROUND
from tests.support.blocks.harness import MOTION, advance
from tests.support.hosts.fmus import Fmus

AXIS = {name: value for name, value in REFERENCE.items() if name.startswith("axis.")}
SAMPLE_TIME, STOP_TIME = 2.0**-6, 9.0  # s
LENGTH, LEAD, CUT_TIME = 1500.0, 100.0, 0.25  # ROUND's; the approach is no longer than LEAD up to 1100 u/s
PAUSE = 0.75  # s after a cut the carriage is at home; the next approach is requested


class Machine(Protocol):
    """A block in this process, or an FMU."""

    def initialize(self, values: Mapping[str, Any]) -> Self: ...

    def step(self, h: float, values: Mapping[str, Any]) -> object: ...

    def get(self, names: Any) -> dict[str, Any]: ...


@dataclass(frozen=True)
class Line:
    """It runs from position 0 at 0 s; from `begin` to `end` it gets faster or slower."""

    speed: float
    begin: float
    end: float
    acceleration: float

    def at(self, time: float) -> dict[str, float]:
        """The master's inputs at a time."""
        position, speed = advance(0.0, self.speed, 0.0, min(time, self.begin))
        position, speed = advance(position, speed, self.acceleration, max(min(time, self.end) - self.begin, 0.0))
        position, speed = advance(position, speed, 0.0, max(time - self.end, 0.0))
        acceleration = self.acceleration if self.begin <= time < self.end else 0.0
        return {"master.position": position, "master.velocity": speed, "master.acceleration": acceleration}

    def time(self, position: float) -> float:
        """When it is at a position; it runs forwards."""
        low, high = 0.0, 2.0 * STOP_TIME
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.at(middle)["master.position"] < position else (low, middle)
        return high


LINES = [
    (Line(1000.0, 0.0, 0.0, 0.0), 1.0),
    (Line(1000.0, 3.0, 4.0, 50.0), 1.02),  # in the second cut
    (Line(1050.0, 1.75, 3.25, -200.0), 1.0),  # from the first cut into the second
]


def simulate(machine: Machine, line: Line, requests: Mapping[float, dict[str, Any]]) -> list[dict[str, Any]]:
    """The carriage at the multiples of SAMPLE_TIME; the line and the requests take effect at their own times."""
    grid = [i * SAMPLE_TIME for i in range(int(STOP_TIME / SAMPLE_TIME) + 1)]
    times = sorted({*grid, *requests, line.begin, line.end})
    sample_times, rows = set(grid), []
    for now, then in pairwise(times):
        machine.step(then - now, {**line.at(now), **requests.get(now, {})})
        if then in sample_times:
            rows.append(machine.get(MOTION))
    return rows


def cut_to_length(machine: Machine, line: Line, factor: float) -> list[dict[str, Any]]:
    machine.initialize({**ROUND, "material_factor": factor, **line.at(0.0)})
    return simulate(machine, line, {0.0: {"start": True}})


def flying_saw(machine: Machine, line: Line, factor: float) -> list[dict[str, Any]]:
    machine.initialize({**AXIS, **line.at(0.0)})
    requests: dict[float, dict[str, Any]] = {}
    request_time = 0.0
    for number in range(1, 20):
        sync = (number * LENGTH + LEAD) / factor
        cut_end = line.time(sync) + CUT_TIME
        requests[request_time] = {
            "gear_in_pos.ratio_numerator": factor,
            "gear_in_pos.master_sync_position": sync,
            "gear_in_pos.slave_sync_position": LEAD,
            "gear_in_pos.master_start_distance": 2.0 * LEAD / factor,
            "gear_in_pos.execute": True,
            "move_absolute.execute": False,
        }
        if cut_end + PAUSE >= STOP_TIME:
            break
        requests[cut_end] = {
            "gear_in_pos.execute": False,
            "move_absolute.position": 0.0,
            "move_absolute.velocity": AXIS["axis.max_velocity"],
            "move_absolute.execute": True,
        }
        request_time = cut_end + PAUSE
    return simulate(machine, line, {time: values for time, values in requests.items() if time < STOP_TIME})


def assert_agree(make: Callable[[str], Machine], line: Line, factor: float) -> None:
    cut_to_length_rows = cut_to_length(make("CutToLength"), line, factor)
    flying_saw_rows = flying_saw(make("FlyingSaw"), line, factor)
    end_time = line.time(5.0 * LENGTH / factor - LEAD / factor)  # five cuts
    pairs = zip(cut_to_length_rows, flying_saw_rows, strict=True)
    compared = [(x, y) for i, (x, y) in enumerate(pairs) if (i + 1) * SAMPLE_TIME < end_time]
    assert max(x["slave.position"] for x, _ in compared) > 340.0
    for x, y in compared:
        for name, allowed in zip(MOTION[:3], (1e-9, 1e-7, 1e-5), strict=True):
            assert x[name] == pytest.approx(y[name], abs=allowed, rel=0.0), name


@pytest.mark.parametrize(("line", "factor"), LINES)
def test_the_blocks_put_their_carriages_at_the_same_positions(line: Line, factor: float) -> None:
    blocks = {"CutToLength": CutToLength, "FlyingSaw": FlyingSaw}
    assert_agree(lambda name: Stepper(blocks[name]()), line, factor)


def test_the_fmus_put_their_carriages_at_the_same_positions(fmus: Fmus) -> None:
    opened: list[FmuInstance] = []

    def instance(name: str) -> FmuInstance:
        opened.append(FmuInstance(fmus.native(name)))
        return opened[-1]

    try:
        assert_agree(instance, *LINES[1])
    finally:
        for machine in opened:
            machine.close()
