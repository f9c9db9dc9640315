"""What happens again and again is logged where it happens first, and once at its end: how often, the worst value."""

from collections.abc import Iterator

import pytest

from motionsync_fmu.fmus.fmu import Flavour
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.support.hosts.fmus import Fmus
from tests.support.hosts.native_host import state_functions

AXIS = "axis.max_velocity = 1200"
LIMIT = "local: limit exceeded: the slave is faster than its axis can be"
START = {
    "axis.max_velocity": 1200.0,
    "axis.max_acceleration": 1e9,
    "axis.max_deceleration": 1e9,
    "axis.max_jerk": 1e12,
    "axis.max_position": 1e9,
    "auto_start": True,
    "length": 1e6,
    "tool.cut_time": 1e3,
    "front_position": 999e3,
}


@pytest.fixture(params=["python", "native", "fmi3"])
def saw(request: pytest.FixtureRequest, fmus: Fmus) -> Iterator[FmuInstance]:
    """A CutToLength that is in sync from 2 s on, for a cut that lasts until the end of the test."""
    with FmuInstance(getattr(fmus, request.param)("CutToLength")) as instance:
        yield instance


class Line:
    """A line that has run at 1000 u/s until the carriage is in sync, and then runs as the test says."""

    def __init__(self, saw: FmuInstance, h: float) -> None:
        self.saw, self.h, self.position = saw, h, 0.0
        saw.initialize({**START, "master.velocity": 1000.0})
        self.run(1000.0, 2.0)
        assert saw.get(["in_sync"])["in_sync"]
        assert not self.messages

    def run(self, velocity: float, duration: float) -> None:
        """Run at a velocity, u/s, for some seconds."""
        for _ in range(round(duration / self.h)):
            self.saw.step(self.h, {"master.position": self.position, "master.velocity": velocity})
            self.position += self.h * velocity

    @property
    def messages(self) -> list[str]:
        return [text for text in self.saw.messages if "limit exceeded" in text]


def all_of(times: int, begin: str, end: str, worst: str) -> str:
    return f"{LIMIT} (times: {times}, from {begin} s to {end} s, worst: local.exceeded_value = {worst}, {AXIS})"


@pytest.mark.parametrize("h", [0.01, 0.1])
def test_the_first_excess_is_logged_and_then_the_worst_and_how_often(saw: FmuInstance, h: float) -> None:
    """Three times too fast within 10 s: one line; 10 s later the whole. Then it begins anew."""
    line = Line(saw, h)
    line.run(1300.0, 1.0)  # from 2 s on
    first = f"{LIMIT} (local.exceeded_value = 1300, {AXIS})"
    assert line.messages == [first]
    for velocity, duration in ((1000.0, 2.0), (1500.0 + 1.0 / 3.0, 1.0), (1100.0, 2.0), (1400.0, 1.0), (1100.0, 9.9)):
        line.run(velocity, duration)
    assert line.messages == [first]
    line.run(1100.0, 0.2)
    whole = all_of(3, f"{2.0 + h:.7g}", "9", "1500.333")
    assert line.messages == [first, whole]
    line.run(1250.0, 1.0)
    again = f"{LIMIT} (local.exceeded_value = 1250, {AXIS})"
    assert line.messages == [first, whole, again]
    saw.terminate()
    assert line.messages == [first, whole, again]  # it has said all


def test_what_is_under_way_at_the_end_is_logged_there(saw: FmuInstance) -> None:
    line = Line(saw, 0.1)
    for velocity in (1210.0, 1220.0, 1215.0):
        line.run(velocity, 0.1)
    assert len(line.messages) == 1
    saw.terminate()
    assert line.messages[1:] == [all_of(1, "2.1", "2.3", "1220")]


def test_a_flood_is_two_lines(saw: FmuInstance) -> None:
    """A velocity that flickers by the resolution of an encoder: 250 times too fast in 500 steps."""
    line = Line(saw, 0.01)
    for k in range(500):
        line.run(1000.0 if k % 2 else 1300.0 + k, 0.01)
    saw.terminate()
    assert line.messages == [
        f"{LIMIT} (local.exceeded_value = 1300, {AXIS})",
        all_of(250, "2.01", "6.99", "1798"),
    ]


def test_a_restored_state_goes_on_with_what_it_had(saw: FmuInstance) -> None:
    """The state is saved with two excesses under way; what follows is forgotten with it. Serialized, it is the same."""
    line = Line(saw, 0.1)
    for velocity in (1300.0, 1000.0, 1310.0, 1000.0):
        line.run(velocity, 0.1)
    save, serialize, deserialize, restore, _ = state_functions(saw)
    state, position = save(), line.position
    packed = serialize(state)
    for given in (state, deserialize(packed)):
        restore(given)
        line.position, saw.time, before = position, 2.4, len(saw.messages)
        for velocity in (1999.0, 1000.0):
            line.run(velocity, 0.1)
        restore(given)
        line.position, saw.time = position, 2.4
        line.run(1320.0, 0.1)
        line.run(1000.0, 10.2)
        assert saw.messages[before:] == [all_of(3, "2.1", "2.5", "1320")]


@pytest.mark.parametrize("flavour", Flavour)
def test_an_exceeded_limit_is_logged_once_with_its_value(fmus: Fmus, flavour: Flavour) -> None:
    """A move of a FlyingSaw at 300 u/s, whose axis can do 200; its end takes the output back."""
    limited = []
    with FmuInstance(fmus.built(flavour, "FlyingSaw")) as saw:
        saw.initialize({"axis.max_velocity": 200.0, "move_absolute.position": 900.0, "move_absolute.velocity": 300.0})
        for _ in range(40):
            saw.step(0.1, {"move_absolute.execute": True})
            limited.append(saw.get(["limit_exceeded"])["limit_exceeded"])
        messages = [text for text in saw.messages if "limit exceeded" in text]
    assert limited == [True] * sum(limited) + [False] * (40 - sum(limited))
    assert 30 < sum(limited) < 40  # 3 s at 300 u/s, with short ramps
    assert len(messages) == 1
    assert "local.exceeded_value = 300" in messages[0]
    assert "axis.max_velocity = 200" in messages[0]
