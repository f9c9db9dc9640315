"""Searches: boundaries that follow from closed forms, in both directions; what has none; what is refused."""

from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu import search
from motionsync_fmu.errors import Interrupted, UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.variation.values import split_setting
from tests import ROOT
from tests.oracle.cut_to_length.limits import Saw
from tests.support.blocks.drawn import drawn
from tests.support.scenarios.scenario_texts import EVEN_RAMP, write_scenario

MACHINES = ROOT / "scenarios" / "CutToLength" / "any_length" / "scenario.toml"
VELOCITY = "master.velocity=100..5000"
FOLLOWING = (  # the ramp starts where the master is at 110, which it passes at 5000 mm/s after the command, too
    "gear_in_pos.master_start_distance=2*gear_in_pos.slave_sync_position",
    "gear_in_pos.master_sync_position=110+gear_in_pos.master_start_distance",
)


@pytest.fixture
def ramp(tmp_path: Path) -> Path:
    """A scenario whose peak acceleration is 0.75 v2/S, where v is the line's velocity and S the way of the saw."""
    return write_scenario(EVEN_RAMP, tmp_path)


def search_rows(
    scenario: Path, vary: str, until: str, grid: Sequence[str] = (), **options: Any
) -> list[dict[str, Any]]:
    """The rows of a search; `grid`: texts NAME=VALUES."""
    factors = dict(map(split_setting, grid))
    rows: list[dict[str, Any]] = search(scenario, vary=vary, until=until, set=factors, **options).to_pylist()
    return rows


def greatest_velocity(acceleration: float, way: float) -> float:
    """That of a line for which the peak acceleration, 0.75 v2/S, is at its limit."""
    return sqrt(acceleration * way / 0.75)


@drawn(4, anew=True)
@given(
    accelerations=st.lists(st.floats(1e3, 2e4), min_size=1, max_size=4, unique=True),
    way=st.floats(20.0, 200.0),
    relative=st.sampled_from([1e-3, 1e-6]),
)
def test_the_greatest_line_velocity_is_found(
    ramp: Path, accelerations: list[float], way: float, relative: float
) -> None:
    """Up to it nothing is refused, and above it the command is: so it holds below the boundary."""
    grid = [
        "axis.max_acceleration=" + ",".join(map(repr, accelerations)),
        f"gear_in_pos.slave_sync_position={way!r}",
        *FOLLOWING,
    ]
    rows = search_rows(ramp, VELOCITY, "fault == 0", grid, relative=relative)
    assert [row["axis.max_acceleration"] for row in rows] == accelerations
    for row in rows:
        expected = greatest_velocity(row["axis.max_acceleration"], way)
        assert row["holds"] == "below"
        assert row["master.velocity"] <= expected * (1.0 + 1e-9)
        assert row["master.velocity.beside"] >= expected * (1.0 - 1e-9)
        assert row["master.velocity.beside"] / row["master.velocity"] - 1.0 <= relative
        assert row["gear_in_pos.master_start_distance"] == 2.0 * way


def test_the_shortest_way_is_found_with_what_follows_from_it(ramp: Path) -> None:
    """S = 0.75 v2/a; the start distance follows, and so is that of the boundary. At 500 mm/s and 4000 mm/s2: 46.875."""
    grid = [*FOLLOWING, "master.velocity=250,500"]
    rows = search_rows(ramp, "gear_in_pos.slave_sync_position=1..400", "fault == 0", grid)
    assert [row["holds"] for row in rows] == ["above", "above"]
    for row, expected in zip(rows, (0.75 * 250.0**2 / 4000.0, 46.875), strict=True):
        assert row["gear_in_pos.slave_sync_position"] == pytest.approx(expected, rel=1e-6)
        assert row["gear_in_pos.master_start_distance"] == 2.0 * row["gear_in_pos.slave_sync_position"]


def test_a_measure_in_the_condition_is_taken_and_reported(ramp: Path) -> None:
    """The acceleration is 3000 at most where v2 = 3000 S/0.75; at the ends of the steps it may be a little less."""
    (row,) = search_rows(ramp, VELOCITY, "slave.acceleration.max <= 3000 and fault == 0", relative=1e-4)
    assert row["master.velocity"] == pytest.approx(sqrt(3000.0 * 100.0 / 0.75), rel=5e-3)
    assert row["slave.acceleration.max"] == pytest.approx(3000.0, rel=1e-2)
    assert row["slave.acceleration.max"] <= 3000.0


@pytest.mark.parametrize(("velocity", "acceleration"), [(500.0, 10000.0), (1000.0, 10000.0), (1000.0, 5000.0)])
def test_the_shortest_length_is_that_of_the_oracle(velocity: float, acceleration: float) -> None:
    """And the prediction of the block: the kerf is 0, so pitch and length are the same."""
    setting = [f"master.velocity={velocity}", f"axis.max_acceleration={acceleration}"]
    (row,) = search_rows(MACHINES, "length=50..6000", "passed", setting, measures={"limits.min_length": ("last",)})
    expected = machine(acceleration).shortest_pitch(velocity)
    assert row["length.beside"] <= expected * (1.0 + 1e-9)
    assert row["length"] >= expected * (1.0 - 1e-9)
    assert row["length"] - row["length.beside"] <= 1e-6 * row["length"]
    assert row["limits.min_length.last"] == pytest.approx(expected, rel=1e-9)


TUBE = """
title = "Tubes of 6 m"
fmu = "CutToLength"
stop_time = 60.0
step_size = 0.01
[start]
auto_start = true
length = 6000.0
kerf = 3.0
"axis.max_position" = 5000.0
"axis.max_velocity" = 2000.0
"axis.max_acceleration" = 4000.0
"axis.max_deceleration" = 4000.0
"tool.cut_time" = 1.0
[master]
velocity = 667.0
[cuts]
tolerance = 0.1
"""


def test_a_line_at_which_cuts_are_skipped_does_not_pass(tmp_path: Path) -> None:
    """The scenario does not expect a number of pieces, but that none is lost.

    The first cycles have the approach's reserve, so that in a minute up to 0.5 % more than the limit does no harm."""
    file = write_scenario(TUBE, tmp_path)
    (row,) = search_rows(file, "master.velocity=300..1990", "passed")
    given = {name: v.start for name, v in Recipe("CutToLength").variables.items()} | load_scenario(file).start
    limit = Saw.of(given, 1.0).max_line_velocity(6003.0)
    assert row["holds"] == "below"
    assert limit <= row["master.velocity"] <= 1.005 * limit
    (run,) = search_rows(file, "master.velocity=300..1990", "skipped == 0")
    assert run["master.velocity"] == row["master.velocity"]


def machine(acceleration: float) -> Saw:
    """The machine of CutToLength/any_length with another limit of the acceleration, in the words of the oracle."""
    given = {name: v.start for name, v in Recipe("CutToLength").variables.items()} | load_scenario(MACHINES).start
    return Saw.of(given | {"axis.max_acceleration": acceleration}, 1.0)


def test_without_a_boundary_the_row_says_so_and_the_others_are_found(ramp: Path) -> None:
    """With 1e6 mm/s2 each velocity of the range is possible, with 1 mm/s2 none is."""
    rows = search_rows(ramp, "master.velocity=300..700", "fault == 0", ["axis.max_acceleration=1,3000,1e6"])
    assert [row["holds"] for row in rows] == ["at neither end", "below", "at both ends"]
    assert [row["runs"] for row in rows[::2]] == [2, 2]
    for row in rows[::2]:
        assert row["master.velocity"] is None
        assert row["master.velocity.beside"] is None
    assert rows[1]["master.velocity"] == pytest.approx(greatest_velocity(3000.0, 100.0), rel=1e-6)


def test_what_holds_only_inside_the_range_has_no_boundary_at_its_ends(ramp: Path) -> None:
    """The peak of the acceleration is between 1000 and 2000 from 365 to 516 mm/s."""
    (row,) = search_rows(ramp, VELOCITY, "slave.acceleration.max > 1000 and slave.acceleration.max < 2000")
    assert (row["holds"], row["runs"]) == ("at neither end", 2)
    (row,) = search_rows(
        ramp, "master.velocity=400..5000", "slave.acceleration.max > 1000 and slave.acceleration.max < 2000"
    )
    assert row["holds"] == "below"


def test_why_the_run_beside_is_refused_is_reported(tmp_path: Path) -> None:
    """A negative stop_time is no scenario: all above 0 is one."""
    file = write_scenario(EVEN_RAMP.replace("stop_time = 1.0", "stop_time = 1.0\ntolerance = 1e-9"), tmp_path)
    (row,) = search_rows(file, "tolerance=-1..1", "passed", relative=1e-3)
    assert row["holds"] == "above"
    assert "tolerance" in row["refusal"]


def test_samples_are_points_like_those_of_a_grid(ramp: Path) -> None:
    rows = search_rows(
        ramp, VELOCITY, "fault == 0", ["axis.max_acceleration=2000..9000"], samples=5, seed=3, relative=1e-3
    )
    assert [row["point"] for row in rows] == [0, 1, 2, 3, 4]
    assert len({row["axis.max_acceleration"] for row in rows}) == 5
    for row in rows:
        expected = greatest_velocity(row["axis.max_acceleration"], 100.0)
        assert row["master.velocity"] == pytest.approx(expected, rel=1.1e-3)


def test_an_interrupted_search_says_what_is_kept(ramp: Path, tmp_path: Path) -> None:
    def stop(done: int, points: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="nothing is kept without a folder"):
        search(ramp, vary=VELOCITY, until="fault == 0", relative=0.1, progress=stop)
    with pytest.raises(Interrupted, match="nothing is kept without a folder"):
        search(ramp, vary=VELOCITY, until="fault == 0", relative=0.1, workers=2, progress=stop)
    with pytest.raises(Interrupted, match="the same command starts them"):
        search(ramp, vary=VELOCITY, until="fault == 0", relative=0.1, output=tmp_path / "found", progress=stop)


def test_a_mistake_in_python_is_a_user_error(ramp: Path) -> None:
    with pytest.raises(UserError, match="no column of a row"):
        search_rows(ramp, VELOCITY, "lat == 0")


def test_a_folder_keeps_what_is_found_without_one(ramp: Path, tmp_path: Path) -> None:
    grid = {"axis.max_acceleration": [2000.0, 4000.0, 6000.0]}
    alone = search(ramp, vary=VELOCITY, until="fault == 0", set=grid, relative=1e-2)
    assert alone.num_rows == 3
    together = search(
        ramp, vary=VELOCITY, until="fault == 0", set=grid, relative=1e-2, workers=2, output=tmp_path / "found"
    )
    assert together.equals(alone)
