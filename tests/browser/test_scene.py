"""What the machine is drawn from, as its page makes it of a recording: as in the recording, and as it is evaluated."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.interface.roles import KNIFE
from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.evaluate.cuts import find_cuts
from motionsync_fmu.scenario.evaluate.find_pieces import find_pieces
from motionsync_fmu.scenario.files.encoder_table import with_encoder
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.scenario import Scenario
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
            ends = [
                (p.sync, p.sync) if names.tool == KNIFE else p.cut or (p.reported_at, p.reported_at) for p in pieces
            ]
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


def test_the_saw_is_down_while_it_cuts(scene_of: SceneOf) -> None:
    _, recording = run(CYCLIC_CUT)
    down = at_points(scene_of(*run(CYCLIC_CUT))["down"], recording)
    assert down.tolist() == recording.values["in_sync"][:-1].tolist()
    assert len(np.flatnonzero(np.diff(down) > 0)) == 20


def test_the_window_holds_the_end_positions_that_are_near(scene_of: SceneOf) -> None:
    """cyclic_cut: the saw runs from 0 to 620, the end positions are -250 and 800; position_example_1 has none."""
    scene = scene_of(*run(CYCLIC_CUT))
    assert scene["ends"] == [-250.0, 800.0]
    assert scene["window"][0] < -250.0
    assert scene["window"][1] > 800.0
    assert scene_of(*run("FlyingSaw/position_example_1"))["ends"] == [None, None]


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


def test_the_page_knows_the_cylinder_and_where_its_cuts_are(scene_of: SceneOf) -> None:
    """Cuts at 800, 1400, 2000, 2400, 3300, 4800, 5100, ... 7800 of a line of 1000 mm/s, when each place is there."""
    scene = scene_of(*run(FORMATS))
    size = {"turn": 360.0, "circumference": 600.0, "blades": 1, "park": 180.0, "ratio": 1.0, "along_material": False}
    assert scene.items() >= {"scene": "cylinder", **size}.items()
    window = {"before": 30.0, "after": 30.0, "overspeed": 0.0}
    assert {name: set(signal["x"]) for name, signal in scene["sync"].items()} == {
        name: {x} for name, x in window.items()
    }
    places = [800, 1400, 2000, 2400, 3300, 4800, *range(5100, 8000, 300)]
    assert [cut["place"] for cut in scene["cuts"]] == pytest.approx(places, abs=1e-6)
    assert [cut["end"] for cut in scene["cuts"]] == pytest.approx([place / 1000 for place in places], abs=1e-9)
    assert [piece["length"] for piece in scene["pieces"]] == pytest.approx([600.0, *np.diff(places)], abs=1e-6)


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
