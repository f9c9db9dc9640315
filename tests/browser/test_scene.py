"""What the machine is drawn from, as its page makes it of a recording: as in the recording, and as it is evaluated."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.evaluate.cuts import find_cuts
from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.evaluate.remote_errors import remote_errors
from motionsync_fmu.scenario.evaluate.time_series import time_series
from motionsync_fmu.scenario.files.encoder_table import with_encoder
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
from motionsync_fmu.scenario.settings import Setting
from tests import ROOT
from tests.browser.conftest import Windows, opened_pages, write_machine
from tests.browser.runs import record, run
from tests.browser.visit import Visit

SceneOf = Callable[[Scenario, Recording], dict[str, Any]]
"""What is drawn of a run; a signal has the columns `t` and `x`."""

KINDS = "CutToLength/sample_and_waste"
CYCLIC_CUT, FORMATS, MEETINGS = "FlyingSaw/cyclic_cut", "RotaryKnife/formats", "Follower/linear_wait_in_park"


OF_PIECE = ("number", "kind", "begin", "end", "length")
DRAWN = "JSON.stringify(motionsyncMachine.drawn(), (_, x) => ArrayBuffer.isView(x) ? [...x] : x)"


@pytest.fixture
def scene_of(windows: Windows, tmp_path: Path) -> Iterator[SceneOf]:
    """All runs of a test are shown in one window."""
    with opened_pages(windows) as open_page:
        visits: list[Visit] = []

        def scene(scenario: Scenario, recording: Recording) -> dict[str, Any]:
            file = write_machine(tmp_path / "machine.html", scenario, recording)
            if visits:
                visits[0].load()
            else:
                visits.append(open_page(file))
            return dict(json.loads(visits[0].page.evaluate(DRAWN)))

        yield scene


def at_points(signal: dict[str, list[float]], recording: Recording) -> Any:
    """A signal at the middle of each step: there it has the value of the point before."""
    middles = 0.5 * (recording.time[1:] + recording.time[:-1])
    return np.array(signal["x"])[np.maximum(np.searchsorted(signal["t"], middles, "right") - 1, 0)]


def furthest(drawn: Any, expected: Any) -> float:
    """How far numbers are apart at most; there have to be as many of both."""
    assert np.shape(drawn) == np.shape(expected)
    return float(np.abs(np.subtract(drawn, expected)).max(initial=0.0))


@pytest.mark.parametrize(
    "name", [CYCLIC_CUT, "FlyingSaw/negative_ratio", MEETINGS, "Gearing/ccw_direct", "CutToLength/recorded_line"]
)
def test_the_page_knows_both_axes_far_better_than_a_screen_shows(scene_of: SceneOf, name: str) -> None:
    """The picture is about 1000 px wide: a fifth of a millionth of its span is 0.0002 px."""
    scenario, recording = run(name)
    scene = scene_of(scenario, recording)
    assert scene["within"] <= 2e-7 * scene["span"]
    for axis, positions in (("master", recording.master[:, 0]), ("slave", recording.values["slave.position"])):
        assert furthest(scene[axis]["t"], recording.time) <= 1e-9
        assert furthest(scene[axis]["x"], positions) <= scene["within"]


@pytest.mark.slow
@pytest.mark.parametrize("block", ["CutToLength", "RotaryKnife", "FlyingSaw"])
def test_the_cuts_and_pieces_that_are_drawn_are_those_that_are_evaluated(scene_of: SceneOf, block: str) -> None:
    """Of all scenarios."""
    for file in sorted((ROOT / "scenarios" / block).glob("*/scenario.toml")):
        scenario = load_scenario(file)
        recording = record(scenario)
        scene, pieces = scene_of(scenario, recording), find_pieces(scenario, recording)
        if names := scenario.recipe.piece_variables:
            assert furthest(at_points(scene["request"], recording), recording.values[names.request][:-1]) < 1e-5
            drawn = [[piece[key] for key in OF_PIECE] for piece in scene["pieces"]]
            assert furthest(drawn, [[getattr(piece, key) for key in OF_PIECE] for piece in pieces]) < 1e-5, file
            assert [piece["name"] for piece in scene["pieces"]] == [piece.name for piece in pieces]
            ends = [(p.sync, p.sync) if names.turns else p.cut or (p.reported_at, p.reported_at) for p in pieces]
            cuts = [(*times, piece.end, piece.end) for times, piece in zip(ends, pieces, strict=True)]
        else:
            spec = scenario.cuts
            cuts = [(c.begin, c.end, c.mark + c.error, c.mark) for c in find_cuts(spec, recording)] if spec else []
        drawn = [[cut[key] for key in ("begin", "end", "place", "mark")] for cut in scene["cuts"]]
        assert furthest(drawn, cuts) < 1e-5, file


@pytest.mark.parametrize("name", ["CutToLength/rotary_master", KINDS, FORMATS])
def test_the_next_cut_is_in_the_turn_in_which_it_is_made(scene_of: SceneOf, name: str) -> None:
    """It is the place that the block knows, but for turns of the master; the last one is not made in the run."""
    scenario, recording = run(name)
    scene, pieces = scene_of(scenario, recording), find_pieces(scenario, recording)
    determined, reported = (recording.values[f"next_cut.{of}"][:-1] for of in ("known", "position"))
    assert (at_points(scene["marks"]["shown"], recording) == determined).all()
    next_cuts = at_points(scene["marks"]["next"], recording)
    away = (next_cuts - reported)[determined != 0.0]
    assert np.abs(away - scenario.period * np.round(away / (scenario.period or 1.0))).max() < 1e-5
    names = scenario.recipe.piece_variables
    assert names
    cutting = recording.values[names.cutting][:-1] != 0.0
    made = (determined != 0.0) & ~cutting & (recording.time[:-1] < pieces[-1].reported_at)
    later = np.searchsorted([piece.reported_at for piece in pieces], recording.time[:-1][made], "right")
    assert furthest(next_cuts[made], np.array([piece.end for piece in pieces])[later]) < 1.0


COUPLED = {
    "Gearing/stop_position_master_based": (["ACTIVE", "WAITING_FOR_STOPPOSITION"], ["GEAR_IN", "GEAR_OUT"]),
    "Follower/cyclic_park": (["M_SYNCHRONIZED"], ["M_FOLLOWING", "M_HOMING"]),
    "Synchronizer/phasing_changed_while_executing": (["syn_synchronized"], ["syn_ramp_on"]),
}
"""States and outputs in which two axes are in step; and in which they come in step, or leave it."""

WAITING = ["WAITING_FOR_STARTPOSITION", "WAITING_FOR_STOPPOSITION"]
MARKS: dict[str, dict[str, tuple[list[str], list[str]]]] = {
    "Gearing/stop_position_master_based": {
        "trigger": (["local.trigger_position"], [*WAITING, "GEAR_IN", "GEAR_OUT"]),
    },
    "Follower/cyclic_park": {
        "meeting": (["local.meeting_position"], ["local.meeting_known"]),
        "in sync": (["sync_slave", "sync_out"], []),
        "park": (["park_slave"], []),
    },
    "Synchronizer/phasing_changed_while_executing": {
        "ramp": (["local.ramp_begin", "local.ramp_end"], ["EXECUTING", "STACKED", "syn_ramp_on"]),
        "rest": (["rest_value"], []),
    },
}
"""By label, the variables of a mark's place or of its ends, and when it is shown (empty: always); the first is the
master's mark, the others are the slave's."""


@pytest.mark.parametrize("name", COUPLED)
def test_two_axes_are_coupled_and_marked_as_the_block_says(scene_of: SceneOf, name: str) -> None:
    scenario, recording = run(name)
    scene = scene_of(scenario, recording)
    names = {int(member): member.name for member in scenario.recipe.variables["state"].choices}
    states = np.array([names[int(state)] for state in recording.values["state"][:-1]])

    def holds(conditions: list[str]) -> Any:
        outputs = recording.values
        return np.any([outputs[c][:-1] != 0.0 if c in outputs else states == c for c in conditions], axis=0)

    coupled, changing = map(holds, COUPLED[name])
    assert coupled.any()
    assert changing.any()
    assert (at_points(scene["coupling"], recording) == np.where(coupled, 2, np.where(changing, 1, 0))).all()
    drawn = {mark["label"]: mark for axis in scene["axes"] for mark in axis["marks"]}
    of_master, *of_slave = MARKS[name]
    assert [[mark["label"] for mark in axis["marks"]] for axis in scene["axes"]] == [[of_master], of_slave]
    for label, (variables, shown) in MARKS[name].items():
        for key, variable in zip(["at"] if len(variables) == 1 else ["from", "to"], variables, strict=True):
            later = scenario.recipe.variables[variable].settable  # what is set at a point is recorded at the next one
            expected = time_series(scenario, recording, variable)[1 if later else 0 :][: len(states)]
            assert furthest(at_points(drawn[label][key], recording), expected) < 1e-9
        assert ("shown" in drawn[label]) == bool(shown)
        assert not shown or (at_points(drawn[label]["shown"], recording) == holds(shown)).all()
    moved = recording.master[:, 0], recording.values["slave.position"]
    for axis, positions in zip(scene["axes"], moved, strict=True):
        assert axis["period"] or axis["range"][0] < positions.min() <= positions.max() < axis["range"][1]


@pytest.mark.parametrize(
    ("name", "start", "periods"),
    [
        ("Gearing/rotary_axes", {"master.period": 300.0, "slave.period": 200.0}, [300.0, 200.0]),
        ("Gearing/ccw_direct", {}, [0.0, 0.0]),
        ("Synchronizer/polynomial", {"master.period": 180.0}, [180.0, 180.0]),
        ("Follower/cyclic_park", {"master_cycle": 900.0}, [900.0, 400.0]),
        ("Follower/cyclic_park", {"master_cycle": 900.0, "variable_cycle": True}, [0.0, 400.0]),
        ("Follower/cyclic_park", {"master_cycle": 900.0, "master.period": 700.0}, [700.0, 400.0]),
    ],
)
def test_the_periods_of_two_axes_are_those_of_the_start_values(
    scene_of: SceneOf, name: str, start: dict[str, float], periods: list[float]
) -> None:
    scenario, recording = run(name)
    scene = scene_of(replace(scenario, start={**scenario.start, **start}), recording)
    assert [axis["period"] for axis in scene["axes"]] == periods


def test_a_mark_moves_when_its_parameter_is_set(scene_of: SceneOf) -> None:
    scenario, recording = run("Synchronizer/polynomial")
    settings = [*recording.settings, Setting(1.0, {"rest_value": 77.0})]
    scene = scene_of(scenario, replace(recording, settings=settings))
    (rest,) = (mark["at"] for mark in scene["axes"][1]["marks"] if mark["label"] == "rest")
    assert (at_points(rest, recording) == np.where(recording.time[:-1] < 1.0 - 1e-9, 180.0, 77.0)).all()


def test_the_window_holds_the_end_positions_that_are_near(scene_of: SceneOf) -> None:
    """cyclic_cut: the saw runs from 0 to 620, the end positions are -250 and 800; position_example_1 has none."""
    scene = scene_of(*run(CYCLIC_CUT))
    assert scene["ends"] == [-250.0, 800.0]
    assert scene["window"][0] < -250.0
    assert scene["window"][1] > 800.0
    assert scene_of(*run("FlyingSaw/position_example_1"))["ends"] == [None, None]


@pytest.mark.parametrize(
    "name", [CYCLIC_CUT, "FlyingSaw/negative_ratio", "FlyingSaw/position_example_1", MEETINGS, KINDS]
)
def test_a_carriage_has_its_home_and_its_zone(scene_of: SceneOf, name: str) -> None:
    """Its arrows are as long as the fastest of both velocities."""
    scenario, recording = run(name)
    scene, position = scene_of(scenario, recording), recording.values["slave.position"]
    start = {n: v.start for n, v in scenario.recipe.variables.items() if v.settable} | dict(scenario.start)
    if name.startswith("FlyingSaw"):
        moved = recording.values["move_absolute.busy"].any()
        assert moved == (name == CYCLIC_CUT)
        home = (start["move_absolute.position"], "home") if moved else (position[0], "start")
    else:
        home = (start["park_slave"], "park") if name == MEETINGS else (start["home_position"], "home")
    assert (scene["home"]["at"], scene["home"]["label"]) == (pytest.approx(home[0], abs=1e-9), home[1])
    inside = position[recording.values["in_sync"] != 0.0] if name != MEETINGS else np.array([100.0, 300.0])
    assert scene["zone"] == pytest.approx([inside.min(), inside.max()], abs=1e-9)
    velocities = recording.values["slave.velocity"], scene["ratio"] * recording.master[:, 1]
    assert scene["fastest"] == pytest.approx(max(np.abs(v).max() for v in velocities))


@pytest.mark.parametrize("ratio", [1.0, -1.0])
def test_a_window_has_room_for_the_pieces_where_the_material_goes(scene_of: SceneOf, ratio: float) -> None:
    """Beyond the end positions 14 % of the length of 1050; where the material goes 70 % more, since pieces are long."""
    scenario, recording = run(CYCLIC_CUT)
    assert scenario.cuts
    scene = scene_of(replace(scenario, cuts=replace(scenario.cuts, ratio=ratio)), recording)
    assert scene["ratio"] == ratio
    below, above = -250.0 - scene["window"][0], scene["window"][1] - 800.0
    assert (below, above)[:: int(ratio)] == (pytest.approx(0.14 * 1050.0), pytest.approx(0.84 * 1050.0))


def test_a_window_shows_the_usual_errors_of_a_remote_axis(scene_of: SceneOf) -> None:
    """Of 98 % of the errors of its telegrams, the greatest is at 1/1.6 of the way to the border."""
    scenario, recording = run("RemoteSync/slow_sender_jitter")
    assert scenario.remote
    scene, errors = scene_of(scenario, recording), remote_errors(scenario.remote, recording)
    for drawn, name in (
        ("telegram", "position"),
        ("corrected", "corrected_position"),
        ("telegram_index", "index"),
        ("corrected_index", "corrected_index"),
    ):
        assert furthest(scene[drawn]["t"], errors.time) <= 1e-9
        assert furthest(scene[drawn]["x"], getattr(errors, name)) < 1e-9
    assert scene["half"] == pytest.approx(1.6 * np.quantile(np.abs(errors.position), 0.98))


def test_the_products_of_a_follower_are_where_it_meets_them(scene_of: SceneOf) -> None:
    """linear_wait_in_park: meetings at master positions 1000, 2000, 3000, the slave being at 100; ratio 1."""
    scene = scene_of(*run(MEETINGS))
    assert scene["marks"]["places"] == [900.0, 1900.0, 2900.0]
    assert scene["zone"] == [100.0, 300.0]


def test_the_products_of_a_measured_line_do_not_follow_its_noise(scene_of: SceneOf) -> None:
    """The same meetings: the block plans them by what it takes for the master, which is off by some 0.05 mm. The second
    one is over at 2200, that is at 4.4 s, and then the third one is determined."""
    scenario, _ = run(MEETINGS)
    encoder = Encoder(resolution=0.05, noise=0.02, delay=0.002)
    start = with_encoder(dict(scenario.start), encoder, scenario.recipe.variables)
    measured = replace(scenario, encoder=encoder, start=start, stop_time=4.6)
    recording = record(measured)
    assert np.ptp(recording.values["master.smoothed_position"] - recording.master[:, 0]) > 0.02
    assert scene_of(measured, recording)["marks"]["places"] == [900.0, 1900.0, 2900.0]


def test_the_page_knows_the_cylinder(scene_of: SceneOf) -> None:
    scene = scene_of(*run(FORMATS))
    size = {"turn": 360.0, "circumference": 600.0, "blades": 1, "park": 180.0, "ratio": 1.0, "along_material": False}
    assert scene.items() >= {"scene": "cylinder", **size}.items()


def test_the_cylinder_is_known_without_its_jumps_from_turn_to_turn(scene_of: SceneOf) -> None:
    """16 turns from park to park and on: the knife, which shows 0 to 360, is drawn on from turn to turn."""
    scenario, recording = run(FORMATS)
    shown = np.array(scene_of(scenario, recording)["slave"]["x"])
    wrapped = np.mod(shown, 360.0) - recording.values["slave.position"]
    assert np.abs(wrapped - 360.0 * np.round(wrapped / 360.0)).max() < 1e-3
    assert np.abs(np.diff(shown)).max() < scenario.step_size * 2006.25 + 1e-6


def test_of_a_recording_of_hours_remain_few_points_and_every_cut(scene_of: SceneOf) -> None:
    """33 s of cyclic_cut, repeated: the master goes on, the saw does the same again. 80 runs are 528,000 points."""
    scenario, once = run(CYCLIC_CUT)
    runs, points = 80, len(once.time) - 1
    again = np.tile(np.arange(points), runs)
    time = again_and_on(once.time, runs)
    master = once.master[again]
    master[:, 0] = again_and_on(once.master[:, 0], runs)
    long = replace(once, time=time, master=master, values={name: x[again] for name, x in once.values.items()})
    scene = scene_of(scenario, long)
    assert len(scene["slave"]["t"]) < 70_000
    assert len(scene["cuts"]) == 20 * runs
    shown = np.interp(scene["slave"]["t"], time, long.values["slave.position"])
    assert furthest(scene["slave"]["x"], shown) < 1e-6


def again_and_on(values: Any, runs: int) -> Any:
    """A column that goes on from its end as from its beginning, so many times."""
    return (values[:-1] + (values[-1] - values[0]) * np.arange(runs)[:, None]).ravel()
