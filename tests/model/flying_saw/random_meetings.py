"""Random synchronisations to a position, and what the property tests of the FlyingSaw share."""

import math
from dataclasses import dataclass
from random import Random
from typing import Any

from hypothesis import settings
from hypothesis import strategies as st

from motionsync.master import MasterInput
from tests.model.flying_saw.harness import FlyingSawHarness
from tests.support.harness import Row

START, END = MasterInput.START_OF_STEP, MasterInput.END_OF_STEP
TICK = 2.0**-20  # s
PEAKS = ("check_max_acceleration", "check_max_deceleration", "check_max_jerk")
settings.register_profile("flying saw", derandomize=True, deadline=None, max_examples=100)
repeatable = settings.get_profile("flying saw")
rngs = st.integers(0, 2**32 - 1).map(Random)


def sign(x: float) -> float:
    return math.copysign(1.0, x)


@dataclass(frozen=True)
class Meeting:
    """gear_in_pos to a point `duration` ahead of the master at its `speed`, and `distance` ahead of the slave."""

    speed: float
    ratio: float
    duration: float
    master_position: float
    position: float
    velocity: float
    distance: float

    @property
    def master_sync(self) -> float:
        return self.master_position + self.speed * self.duration

    @property
    def slave_sync(self) -> float:
        return self.position + self.distance

    @property
    def length(self) -> float:
        """The manoeuvre's distances are of this size."""
        return max(abs(self.distance), abs(self.speed * self.duration), abs(self.velocity * self.duration))

    def saw(self, *modes: str, mode: MasterInput = START, **values: Any) -> FlyingSawHarness:
        initial = {"axis.initial_position": self.position, "axis.initial_velocity": self.velocity}
        limits = {"axis.max_velocity": 1e6, "axis.max_acceleration": 1e7, "axis.max_jerk": 1e8}
        return FlyingSawHarness(
            initial | limits | values, master_position=self.master_position, speed=self.speed, mode=mode
        ).modes(*modes)

    def give(self, saw: FlyingSawHarness, **values: Any) -> FlyingSawHarness:
        aims = {"master_sync_position": self.master_sync, "slave_sync_position": self.slave_sync}
        return saw.give("gear_in_pos", **aims, ratio_numerator=self.ratio, **values)


@st.composite
def meetings(draw: st.DrawFn) -> Meeting:
    speed = draw(st.floats(10.0, 1000.0)) * draw(st.sampled_from([1.0, -1.0]))
    ratio = draw(st.floats(0.2, 3.0)) * draw(st.sampled_from([1.0, -1.0]))
    duration = draw(st.floats(0.1, 4.0))
    synchronous = ratio * speed
    return Meeting(
        speed=speed,
        ratio=ratio,
        duration=duration,
        master_position=draw(st.floats(-1e3, 1e3)),
        position=draw(st.floats(-1e3, 1e3)),
        velocity=synchronous * draw(st.sampled_from([0.0, 1.0]) | st.floats(-1.0, 2.0)),
        distance=synchronous * duration * draw(st.floats(0.05, 1.8)),
    )


def samples(saw: FlyingSawHarness, duration: float, number: int = 60) -> list[Row]:
    rows = saw.rows(duration, cuts=[i / number * duration for i in range(1, number)])
    return list(rows.values())


Order = tuple[dict[str, Any], tuple[str, ...]]


def to_velocity(rng: Random, length: float, speed: float) -> Order:
    ratio = rng.choice([1.0, 0.5, rng.uniform(0.3, 2.0)])
    values = {
        "ratio_numerator": ratio,
        "acceleration": length * rng.uniform(2.0, 20.0),
        "deceleration": length * rng.uniform(2.0, 20.0),
        "jerk": length * rng.uniform(20.0, 200.0),
        "velocity": rng.choice([0.0, 0.0, abs(ratio * speed) * rng.uniform(1.0, 1.3)]),
    }
    return {f"gear_in_velo.{name}": value for name, value in values.items()}, ("gear_in_velo",)
