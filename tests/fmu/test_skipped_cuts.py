"""Each skipped cut is a line in the importer's log: which one, why, and by how much."""

from collections.abc import Iterator

import pytest

from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.run.fmu_instance import FmuInstance
from tests.oracle.cut_to_length.limits import Saw
from tests.support.hosts.fmus import Fmus

H, VELOCITY, LENGTH = 0.01, 1000.0, 1500.0
START = {
    "auto_start": True,
    "length": LENGTH,
    "axis.max_velocity": 2000.0,
    "axis.max_acceleration": 10000.0,
    "axis.max_deceleration": 10000.0,
    "axis.max_jerk": 1e9,
    "axis.max_position": 1e6,
}


@pytest.fixture(params=["python", "native", "fmi3"])
def saw(request: pytest.FixtureRequest, fmus: Fmus) -> Iterator[FmuInstance]:
    with FmuInstance(getattr(fmus, request.param)("CutToLength")) as instance:
        yield instance


def run(saw: FmuInstance, until: float, hold: tuple[float, float] = (0.0, 0.0), **changed: float) -> list[str]:
    """What is logged up to a time, s; the line runs at 1000 u/s, and no approach starts in the time `hold`.

    The first cut is at 1500, and without a kerf the others are each 1500 farther."""
    changes = {name.replace("__", "."): value for name, value in changed.items()}
    saw.initialize({**START, "master.velocity": VELOCITY, **changes})
    for k in range(round(until / H)):
        inputs = {"master.position": k * H * VELOCITY, "master.velocity": VELOCITY}
        saw.step(H, inputs | {"hold": hold[0] <= k * H < hold[1] - 1e-9})
    return saw.messages


def max_line_velocity(**changed: float) -> str:
    """That of the pieces, by the oracle."""
    values = {name: v.start for name, v in Recipe("CutToLength").variables.items()} | START
    changes = {name.replace("__", "."): value for name, value in changed.items()}
    return f"{Saw.of(values | changes, 1.0).max_line_velocity(LENGTH):.7g}"


def test_a_cut_for_which_the_carriage_is_not_ready(saw: FmuInstance) -> None:
    """At 1480 the carriage may start again; from there it has 20 to the cut and needs 0.75 v2/a = 75."""
    (text,) = run(saw, 4.5, (1.0, 1.48))
    assert text == (
        "local: cut skipped: the carriage was not ready in time (local.skipped_cut = 1500, statistics.skipped = 1, "
        f"local.line_velocity = 1000, local.missing_distance = 55, limits.max_line_velocity = {max_line_velocity()})"
    )
    assert saw.get(["statistics.cuts", "last.length"]) == {"statistics.cuts": 1, "last.length": pytest.approx(3000.0)}


def test_each_cut_of_a_line_that_is_faster_than_the_carriage(saw: FmuInstance) -> None:
    expected = (
        "local: cut skipped: the carriage cannot be as fast as the line (local.skipped_cut = {}, "
        "statistics.skipped = {}, local.line_velocity = 1000, axis.max_velocity = 900.5)"
    )
    assert run(saw, 5.0, axis__max_velocity=900.5) == [expected.format(1500 * n, n) for n in (1, 2, 3)]


def test_each_cut_for_which_the_stroke_is_too_short(saw: FmuInstance) -> None:
    """In sync the carriage would go 75 and 250 far, at least."""
    text = (
        "local: cut skipped: the stroke is too short at this line velocity (local.skipped_cut = {}, "
        "statistics.skipped = {}, local.line_velocity = 1000, limits.max_line_velocity = {})"
    )
    limit = max_line_velocity(axis__max_position=300.0)
    assert run(saw, 3.2, axis__max_position=300.0) == [text.format(1500 * n, n, limit) for n in (1, 2)]
