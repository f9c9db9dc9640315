"""The picture of the machine: what the page knows is what the recording has. How it looks is tested in a browser."""

import json
import re
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.interface.recipe import Recipe
from motionsync_fmu.pages.machine import description
from motionsync_fmu.pages.machine.fragment import machine
from motionsync_fmu.pages.machine.signals import MOST_KNOTS, held, smooth
from motionsync_fmu.scenario.encoder import Encoder
from motionsync_fmu.scenario.files.encoder_table import with_encoder
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT


@cache
def run(name: str) -> tuple[Scenario, Recording]:
    scenario = load_scenario(ROOT / "scenarios" / name / "scenario.toml")
    return scenario, run_in_process(scenario, scenario.step_size)


def data_of(name: str) -> dict[str, Any]:
    """What the page of a scenario's run knows."""
    return data_of_run(*run(name))


def data_of_run(scenario: Scenario, recording: Recording) -> dict[str, Any]:
    script = re.search(r'<script type="application/json">(.*?)</script>', machine(scenario, recording), re.S)
    assert script
    return dict(json.loads(script[1]))


def value(signal: dict[str, list[float]], t: float) -> float:
    """A smooth signal at t: the cubic with the values and slopes of both knots, by its four conditions."""
    last = max(i for i, knot in enumerate(signal["t"]) if knot <= t)
    if signal["t"][last] == t:
        return signal["x"][last]
    h, u = signal["t"][last + 1] - signal["t"][last], t - signal["t"][last]
    conditions = np.array(
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, h, h**2, h**3], [0.0, 1.0, 2 * h, 3 * h**2]]
    )
    ends = [signal["x"][last], signal["v"][last], signal["x"][last + 1], signal["v"][last + 1]]
    return float(np.linalg.solve(conditions, ends) @ [1.0, u, u**2, u**3])


# --- signals ---


def test_a_constant_jerk_needs_two_knots() -> None:
    t = np.linspace(0.0, 2.0, 201)
    signal, within = smooth(t, 5.0 - t + 3.0 * t**3, -1.0 + 9.0 * t**2, 1e-6)
    assert signal == {"t": [0.0, 2.0], "x": [5.0, 27.0], "v": [-1.0, 35.0]}
    assert within == 1e-6


def test_a_smooth_signal_keeps_its_tolerance_with_fewer_knots() -> None:
    """sin 3t: its fourth derivative is at most 81, so a cubic over h misses it by 81 h^4/384; 1e-4 allows h = 0.147."""
    t = np.arange(0.0, 10.0, 0.002)
    signal, _ = smooth(t, np.sin(3.0 * t), 3.0 * np.cos(3.0 * t), 1e-4)
    assert len(signal["t"]) < 10.0 / 0.147 * 1.5
    assert max(abs(value(signal, s) - np.sin(3.0 * s)) for s in t.tolist()) <= 1e-4


def test_a_velocity_that_jumps_is_a_corner() -> None:
    """At rest until 1 s, at 10 u/s from then on: between the points at 1.0 and 1.1 s it is a straight line."""
    t = np.arange(21) / 10.0
    moving = t > 1.0
    signal, _ = smooth(t, np.where(moving, 10.0 * (t - 1.0), 0.0), np.where(moving, 10.0, 0.0), 1e-6)
    assert [value(signal, s) for s in (0.5, 0.95, 1.05, 1.55)] == pytest.approx([0.0, 0.0, 0.5, 5.5], abs=1e-6)


def test_a_jump_is_a_straight_line_over_its_step() -> None:
    t = np.arange(21) / 10.0
    signal, _ = smooth(t, np.where(t > 1.0, 3.0, 0.0), np.zeros(21), 1e-6)
    assert [value(signal, s) for s in (0.95, 1.05, 1.15)] == pytest.approx([0.0, 1.5, 3.0], abs=1e-6)


def test_noise_stays_within_the_tolerance_that_the_signal_reports() -> None:
    t = np.arange(3 * MOST_KNOTS) / 100.0
    noise = np.random.default_rng(1).normal(size=len(t))
    signal, within = smooth(t, noise, np.zeros(len(t)), 1e-3)
    assert within > 1e-3
    assert len(signal["t"]) <= 3 * MOST_KNOTS
    assert max(abs(value(signal, s) - x) for s, x in zip(t[::97].tolist(), noise[::97], strict=True)) <= within


def test_a_signal_of_hours_takes_less_than_seconds() -> None:
    """396,000 points in 33 minutes: strokes of 300 mm, which need more knots than a page has."""
    t = np.arange(396_000) * 0.005
    begin = process_time()
    signal, _ = smooth(t, 300.0 * np.sin(3.0 * t) ** 3, 2700.0 * np.sin(3.0 * t) ** 2 * np.cos(3.0 * t), 1e-4)
    assert process_time() - begin < 8.0
    assert len(signal["t"]) <= MOST_KNOTS


def test_a_held_signal_has_its_changes_alone() -> None:
    t = np.arange(6) / 2.0
    assert held(t, np.array([1.0, 1.0, 3.0, 3.0, 3.0, 1.0])) == {"t": [0.0, 1.0, 2.5], "x": [1.0, 3.0, 1.0]}


# --- machines ---


@pytest.mark.parametrize(
    "name", ["FlyingSaw/cyclic_cut", "FlyingSaw/negative_ratio", "Follower/linear_wait_in_park", "Gearing/ccw_direct"]
)
def test_the_page_knows_both_axes_far_better_than_a_screen_shows(name: str) -> None:
    """The picture is about 1000 px wide: a fifth of a millionth of its span is 0.0002 px."""
    _, recording = run(name)
    data = data_of(name)
    assert data["within"] <= 2e-7 * data["span"]
    axes = (data["master"], recording.master[:, 0]), (data["slave"], recording.values["slave.position"])
    for signal, recorded in axes:
        drawn = [value(signal, t) for t in recording.time[::13].tolist()]
        assert drawn == pytest.approx(recorded[::13].tolist(), abs=data["within"])


def test_the_cyclic_cut_is_below_300_kilobytes() -> None:
    assert len(machine(*run("FlyingSaw/cyclic_cut")).encode()) < 300_000


def test_the_saw_is_down_while_it_cuts() -> None:
    _, recording = run("FlyingSaw/cyclic_cut")
    data = data_of("FlyingSaw/cyclic_cut")
    down = [
        (begin, end) for (begin, x), (end, _) in pairwise(zip(data["down"]["t"], data["down"]["x"], strict=True)) if x
    ]
    assert len(down) == 20
    for begin, end in down:
        inside = (recording.time >= begin) & (recording.time < end)
        assert recording.values["in_sync"][inside].all()
    assert recording.values["in_sync"].sum() == sum(
        ((recording.time >= begin) & (recording.time < end)).sum() for begin, end in down
    )


def test_the_window_holds_the_end_positions_that_are_near() -> None:
    """cyclic_cut: the saw runs from 0 to 620, the end positions are -250 and 800; position_example_1 has none."""
    data = data_of("FlyingSaw/cyclic_cut")
    assert data["ends"] == [-250.0, 800.0]
    assert data["window"][0] < -250.0
    assert data["window"][1] > 800.0
    assert data_of("FlyingSaw/position_example_1")["ends"] == [None, None]


def test_the_products_of_a_follower_are_where_it_meets_them() -> None:
    """linear_wait_in_park: meetings at master positions 1000, 2000, 3000, the slave being at 100; ratio 1."""
    data = data_of("Follower/linear_wait_in_park")
    assert data["marks"]["places"] == [900.0, 1900.0, 2900.0]
    assert data["zone"] == [100.0, 300.0]


def test_the_products_of_a_measured_line_do_not_follow_its_noise() -> None:
    """The same meetings: the block plans them by what it takes for the master, which is off by some 0.05 mm. The second
    one is over at 2200, that is at 4.4 s, and then the third one is determined."""
    scenario, _ = run("Follower/linear_wait_in_park")
    encoder = Encoder(resolution=0.05, noise=0.02, delay=0.002)
    start = with_encoder(dict(scenario.start), encoder, scenario.recipe.variables)
    measured = replace(scenario, encoder=encoder, start=start, stop_time=4.6)
    recording = run_in_process(measured, measured.step_size)
    assert np.ptp(recording.values["master.smoothed_position"] - recording.master[:, 0]) > 0.02
    assert data_of_run(measured, recording)["marks"]["places"] == [900.0, 1900.0, 2900.0]


def test_a_block_without_a_picture_has_none() -> None:
    scenario, recording = run("FlyingSaw/cyclic_cut")
    unknown = replace(scenario, recipe=Recipe("Unknown"))
    assert machine(unknown, recording) == ""


AXES = """
[[picture]]
scene = "axes"
master_period = ["master.period"]
slave_period = ["master.period"]
coupled = ["state == EXECUTING"]
changing = ["syn_ramp_on"]
master_marks = [{ label = "ramp", at = "local.ramp_begin", shown = ["syn_ramp_on"] }]
"""


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('scene = "axes"', "", "2: scene: is missing"),
        ('scene = "axes"', 'scene = "axis"', "3: scene: 'axis' is none of axes, belt"),
        ('changing = ["syn_ramp_on"]', "", "2: changing: is missing"),
        ('label = "ramp", ', "", "8: label: is missing"),
        ("ramp_begin", "ramp_start", "8: at: Synchronizer has no variable 'local.ramp_start'; do you mean"),
        ("EXECUTING", "RUNNING", "6: coupled: 'RUNNING' is no Enumeration: it must be 0 READY,"),
        ('"master.period"', '"master.period unless cyclic"', "4: master_period: Synchronizer has no variable"),
        ('scene = "axes"', 'scene = "belt"', "2: tool: is missing"),
    ],
)
def test_a_mistake_in_a_description_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: str, after: str, message: str
) -> None:
    file = tmp_path / "machine.toml"
    monkeypatch.setattr(description, "block_file", lambda *_: file)
    file.write_text(AXES)
    block = Recipe("Synchronizer")
    assert [picture["scene"] for picture in description.pictures_of(block)] == ["axes"]
    file.write_text(AXES.replace(before, after))
    with pytest.raises(UserError, match=re.escape(f"machine.toml:{message}")):
        description.pictures_of(block)


def test_the_description_of_every_block_has_no_mistake(block: str) -> None:
    description.pictures_of(Recipe(block))


# --- a cylinder with blades ---

FORMATS = "RotaryKnife/formats"


def test_the_page_knows_the_cylinder_and_where_its_cuts_are() -> None:
    """Cuts at 800, 1400, 2000, 2400, 3300, 4800, 5100, ... 7800 of a line of 1000 mm/s, when each place is there."""
    data = data_of(FORMATS)
    assert (data["scene"], data["turn"], data["circumference"], data["blades"], data["park"], data["ratio"]) == (
        "cylinder",
        360.0,
        600.0,
        1,
        180.0,
        1.0,
    )
    assert {name: signal["x"] for name, signal in data["sync"].items()} == {
        "before": [30.0],
        "after": [30.0],
        "overspeed": [0.0],
    }
    assert data["along_material"] is False
    places = [800, 1400, 2000, 2400, 3300, 4800, *range(5100, 8000, 300)]
    assert [cut["place"] for cut in data["cuts"]] == pytest.approx(places, abs=1e-6)
    assert [cut["end"] for cut in data["cuts"]] == pytest.approx([place / 1000 for place in places], abs=1e-9)
    assert [piece["length"] for piece in data["pieces"]] == pytest.approx([600.0, *np.diff(places)], abs=1e-6)


def test_the_cylinder_is_known_without_its_jumps_from_turn_to_turn() -> None:
    """16 turns from park to park and on: the knife, which shows 0 to 360, is drawn on from turn to turn."""
    scenario, recording = run(FORMATS)
    data = data_of(FORMATS)
    shown = [value(data["slave"], t) for t in recording.time[::7].tolist()]
    wrapped = np.mod(shown, 360.0) - recording.values["slave.position"][::7]
    assert np.abs(wrapped - 360.0 * np.round(wrapped / 360.0)).max() < 1e-3
    assert max(np.abs(np.diff(shown))) < 360.0 * 7 * scenario.step_size * 2006.25 / 360.0 + 1e-6


@pytest.mark.parametrize("key", ["turn", "along_material", "next_cut"])
def test_a_cylinder_needs_all_of_its_keys(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, key: str) -> None:
    file = ROOT / "model" / "motionsync" / "rotary_knife" / "machine.toml"
    text = "\n".join(line for line in file.read_text("utf-8").splitlines() if not line.startswith(f"{key} "))
    (tmp_path / "machine.toml").write_text(text, "utf-8")
    monkeypatch.setattr(description, "block_file", lambda *_: tmp_path / "machine.toml")
    with pytest.raises(UserError, match=f"{key}.*is missing"):
        description.pictures_of(Recipe("RotaryKnife"))
