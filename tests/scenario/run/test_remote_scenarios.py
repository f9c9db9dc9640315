"""Scenarios with two clocks: what [remote] parts, what the block sees of it, how it is evaluated and shown."""

import csv
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from motionsync_fmu.errors import UserError
from motionsync_fmu.pages.report.chart import Chart
from motionsync_fmu.pages.report.page import run_charts, write_report
from motionsync_fmu.scenario.clocks import Clocks, Rate
from motionsync_fmu.scenario.evaluate.csv_files import inputs_csv
from motionsync_fmu.scenario.evaluate.expectations import check_expectations
from motionsync_fmu.scenario.evaluate.outcome import evaluate_run
from motionsync_fmu.scenario.evaluate.remote_errors import remote_errors
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.remote_view import Accuracy
from motionsync_fmu.scenario.run.simulation import run_in_process, scheduled_steps
from motionsync_fmu.scenario.scenario import Scenario
from tests import regenerate
from tests.support.fake_blocks.listener import ListenerOracle, registered
from tests.support.scenarios.scenario_texts import assert_refused

VALID = """\
title = "A faster sender"
source = "By hand"
fmu = "Listener"
stop_time = 4.0
step_size = 0.002

[start]
share = 0.5

[remote]
position = 10.0
velocity = 100.0
segments = [
    { duration = 1.0 },
    { duration = 1.0, acceleration = 20.0 },
]
sender_cycle = 0.001998
phase = 0.25
jitter = 0.01
seed = 5
lost = [[70, 72], [900, 900]]
first_index = 65

[[set]]
at = 3.0
delay_time_offset = 0.01

[remote.accuracy]
from = 0.5
index = 1.5
position = 0.5
"""


@pytest.fixture(autouse=True)
def listener() -> Iterator[None]:
    with registered():
        yield


def scenario(folder: Path, *changes: tuple[str, str]) -> Scenario:
    text = VALID
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    file = folder / "scenario.toml"
    file.write_text(text, "utf-8")
    return load_scenario(file)


CALM = ("jitter = 0.01\nseed = 5\nlost = [[70, 72], [900, 900]]\n", "")
STEADY = ("    { duration = 1.0, acceleration = 20.0 },\n", "")


# --- what it parts ---


def test_it_is_read(tmp_path: Path) -> None:
    remote = scenario(tmp_path).remote
    assert remote
    assert remote.clocks == Clocks(0.002, [Rate(0.0, 0.001998)], 0.25, 0.01, 5, [(70, 72), (900, 900)], 65)
    assert (remote.cycles, remote.data_cycle) == (2000, 0.002)
    assert remote.axis.at(2.0).position == pytest.approx(220.0)
    assert remote.delays == [(0.0, 0.0), (3.0, 0.01)]
    assert remote.accuracy == Accuracy(0.5, 1.5, 0.5, 0.0)


def test_all_but_the_sender_s_cycle_may_be_left_out(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(VALID[: VALID.index("[remote]")] + "[remote]\nsender_cycle = 0.002\n")
    remote = load_scenario(file).remote
    assert remote
    assert (remote.clocks, remote.accuracy) == (Clocks(0.002, [Rate(0.0, 0.002)], lost=[]), None)


def test_the_cycles_are_those_of_the_block(tmp_path: Path) -> None:
    start = ("share = 0.5", "task_cycle_time = 0.004\ndata_cycle_time = 0.002\ndelay_time_offset = 0.003")
    remote = scenario(tmp_path, start).remote
    assert remote
    assert (remote.clocks.task_cycle, remote.cycles, remote.data_cycle) == (0.004, 1000, 0.002)
    assert remote.delays[0] == (0.0, 0.003)


def test_the_sender_s_cycle_may_change(tmp_path: Path) -> None:
    listed = "sender_cycle = [{ at = 0, cycle = 0.001998 }, { at = 2.0, cycle = 0.002002 }]"
    remote = scenario(tmp_path, ("sender_cycle = 0.001998", listed)).remote
    assert remote
    assert remote.clocks.rates == [Rate(0.0, 0.001998), Rate(2.0, 0.002002)]


RATES = "sender_cycle = [\n    { at = 0.0, cycle = 0.002 },\n    { at = 1.0, cycle = 0.001 },\n]"
# What is replaced, by what; the key and the words of the message, and the text on whose line it is (the new one).
MISTAKES: dict[str, tuple[str, str, str, tuple[str, ...]] | tuple[str, str, str, tuple[str, ...], str]] = {
    "a master": ("[remote]", "[master]", "master", ("Listener has no inputs master.*", "[remote]")),
    "no remote": (VALID[VALID.index("[remote]") :], "", "remote", ("missing",), "title"),
    "unknown key": ("phase =", "phases =", "phases", ("unknown key", "position", "sender_cycle", "first_index")),
    "key of a segment": ("{ duration = 1.0 },", "{ time = 1.0 },", "time", ("unknown key", "duration")),
    "duration": ("{ duration = 1.0 },", "{ duration = -1.0 },", "duration", ("-1", "> 0")),
    "cycle missing": ("sender_cycle = 0.001998\n", "", "sender_cycle", ("missing",), "[remote]"),
    "cycle negative": ("0.001998", "-0.002", "sender_cycle", ("-0.002", "> 0")),
    "cycle is a text": ("0.001998", '"2 ms"', "sender_cycle", ("'2 ms'", "number")),
    "cycle absurdly short": ("0.001998", "1e-9", "remote", ("1,000,000 cycles",), "[remote]"),
    "own cycle absurdly short": ("share = 0.5", "task_cycle_time = 1e-9", "remote", ("cycles",), "[remote]"),
    "no cycles": ("= 0.001998", "= []", "sender_cycle", ("empty",)),
    "cycles are numbers": ("= 0.001998", "= [0.002]", "sender_cycle", ("{ at = ..., cycle = ... }",)),
    "later cycle 0": ("sender_cycle = 0.001998", RATES.replace("0.001 ", "0 "), "cycle", ("> 0",), "{ at = 1.0"),
    "cycles backwards": ("sender_cycle = 0.001998", RATES.replace("1.0", "-1"), "at", ("-1", "> 0"), "{ at = -1"),
    "first cycle late": ("sender_cycle = 0.001998", RATES.replace("0.0,", "0.5,"), "at", ("0.5", "0"), "{ at = 0.5"),
    "a cycle's key": (
        "sender_cycle = 0.001998",
        RATES.replace("at = 1", "from = 1"),
        "from",
        ("at, cycle",),
        "{ from",
    ),
    "phase": ("phase = 0.25", "phase = 1.0", "phase", (">= 0 and < 1",)),
    "jitter negative": ("jitter = 0.01", "jitter = -0.01", "jitter", (">= 0 and <= 0.15",)),
    "jitter of a cycle": ("jitter = 0.01", "jitter = 1.0", "jitter", ("<= 0.15",)),
    "seed": ("seed = 5", "seed = 5.5", "seed", ("5.5", "whole number")),
    "first index": ("first_index = 65", "first_index = 65536", "first_index", ("65536", "0 to 65535")),
    "lost backwards": ("[70, 72]", "[72, 70]", "lost", ("[72, 70]", "backwards")),
    "lost before the first": ("[70, 72]", "[60, 72]", "lost", ("[60, 72]", "65")),
    "lost a number": ("[[70, 72], [900, 900]]", "70", "lost", ("[first, last]",)),
    "lost a telegram": ("[900, 900]", "900", "lost", ("900 is not a range [first, last]",)),
    "lost half a telegram": ("[900, 900]", "[900, 900.5]", "lost", ("whole numbers",)),
    "lost three": ("[900, 900]", "[900, 901, 902]", "lost", ("[first, last]",)),
    "start of an input": ("share = 0.5", '"remote.position" = 1.0', "remote.position", ("[remote]",)),
    "set of an input": ("delay_time_offset = 0.01", '"remote.cycle_index" = 1', "remote.cycle_index", ("[remote]",)),
    "another table": (
        "[remote.accuracy]",
        "[remote.accurate]",
        "accurate",
        ("unknown key",),
        "[remote.accurate",
    ),
    "accuracy of nothing": ("index = 1.5\nposition = 0.5\n", "", "remote.accuracy", ("nothing",), "[remote.accuracy]"),
    "accuracy without from": ("from = 0.5\n", "", "from", ("missing",), "[remote.accuracy]"),
    "accuracy after the end": ("from = 0.5", "from = 5.0", "from", ("<= 4",)),
    "key of the accuracy": ("index = 1.5", "indices = 1.5", "indices", ("unknown key", "behind")),
    "index": ("index = 1.5", "index = -1.5", "index", (">= 0",)),
    "position": ("position = 0.5", 'position = "0.5"', "position", ("number",)),
    "behind": ("position = 0.5", "position = 0.5\nbehind = -1", "behind", (">= 0",), "behind"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, key, parts, *named_line = MISTAKES[name]
    assert VALID.count(old) == 1
    assert_refused(VALID.replace(old, new), tmp_path, named_line[0] if named_line else new, key, *parts)


@pytest.mark.parametrize(
    ("accuracy", "message"),
    [("{ from = 9, index = 1 }", "from: 9 "), ("1.0", r"accuracy: must be a table: \[remote\.accuracy\]")],
)
def test_a_mistake_in_an_accuracy_on_one_line_names_that_line(accuracy: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(VALID[: VALID.index("[remote.accuracy]")].replace("seed = 5", f"accuracy = {accuracy}"))
    with pytest.raises(UserError, match=f":20: {message}"):
        load_scenario(file)


def test_a_block_with_a_master_has_no_remote_axis(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r":10: remote: Synchronizer has no inputs remote\.\*.* \[master\]"):
        scenario(tmp_path, ('"Listener"', '"Synchronizer"'))


# --- what the block sees ---


def test_each_step_shows_the_telegram_of_its_cycle(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    assert s.remote
    seen = s.remote.clocks.telegrams(s.master, 2000)
    steps = list(scheduled_steps(s, 0.002))
    assert [values["remote.cycle_index"] for _, _, values in steps] == seen.cycle_index.tolist()
    for i, name in enumerate(("position", "velocity", "acceleration")):
        assert [values[f"remote.{name}"] for _, _, values in steps] == seen.motion[:, i].tolist()
    assert {type(values["remote.cycle_index"]) for _, _, values in steps} == {int}


@pytest.mark.parametrize("step_size", [0.0007, 0.0013, 0.002 / 3])
def test_steps_within_a_cycle_give_the_same_outputs(step_size: float, tmp_path: Path) -> None:
    s = scenario(tmp_path)
    whole, parts = run_in_process(s, 0.002), run_in_process(s, step_size)
    acted = [s.remote.clocks.count_cycles(t) for t in parts.time.tolist()] if s.remote else []
    for name, values in parts.values.items():
        np.testing.assert_array_equal(values, whole.values[name][acted], err_msg=name)


def test_a_step_of_several_cycles_shows_the_first_one_s_telegram(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    assert s.remote
    shown = [values["remote.cycle_index"] for _, _, values in scheduled_steps(s, 0.01)]
    assert shown == s.remote.telegrams.cycle_index[::5].tolist()


def test_the_input_file_has_the_telegrams_as_numbers(tmp_path: Path) -> None:
    s = scenario(tmp_path, ("stop_time = 4.0", "stop_time = 3.5"), ("at = 3.0", "at = 3.0\nshifted = false"))
    header, *rows = list(csv.reader(inputs_csv(s).splitlines()))
    columns = ["delay_time_offset", "remote.acceleration", "remote.cycle_index", "remote.position", "remote.velocity"]
    assert header == ["time", *columns, "shifted"]
    assert len(rows) == 1750
    assert rows[0][3] == "65"
    assert [row[-1] for row in rows[1499:1501]] == ["1", "0"]


def test_an_oracle_is_stepped_as_the_fmu_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    columns = ("slave.position", "corrected_cycle_index", "shifted")
    oracle = SimpleNamespace(COLUMNS=columns, ListenerOracle=ListenerOracle)
    monkeypatch.setattr(regenerate, "oracle", lambda name: oracle)
    s = scenario(
        tmp_path, ("share = 0.5", "share = 0.25\nshifted = false"), ("at = 3.0", "at = 3.0015\nshifted = true")
    )
    recording = run_in_process(s, 0.002)
    _, text = regenerate.with_reference(s.file)
    header, *rows = list(csv.reader(text.splitlines()))
    assert header == ["time", "slave.position", "corrected_cycle_index", "shifted"]
    table = np.array(rows, float)
    np.testing.assert_array_equal(table[:, 0], [i * 0.002 for i in range(10, 2001, 10)])
    at = np.searchsorted(recording.time, table[:, 0] - 1e-9)
    for column, name in enumerate(header[1:3], 1):
        np.testing.assert_array_equal(table[:, column], recording.values[name][at])
    np.testing.assert_array_equal(table[:, 3], table[:, 0] > 3.0015)


# --- how it is evaluated ---


def test_the_errors_are_those_against_the_true_axis(tmp_path: Path) -> None:
    """The true index is 0.25 + 1.001001 n; the telegram is its whole part behind, the Listener adds a half."""
    s = scenario(tmp_path, CALM, STEADY)
    assert s.remote
    result = remote_errors(s.remote, run_in_process(s, 0.002))
    age = (0.25 + np.arange(2000) * 0.002 / 0.001998) % 1.0
    clear = np.minimum(age, 1.0 - age) > 1e-9
    np.testing.assert_allclose(result.index[clear], -age[clear], atol=1e-9)
    np.testing.assert_allclose(result.corrected_index[clear], 0.5 - age[clear], atol=1e-9)
    np.testing.assert_allclose(result.position[clear], -0.1998 * age[clear], atol=1e-9)
    np.testing.assert_allclose(result.corrected_position[clear], 0.1 - 0.1998 * age[clear], atol=1e-9)
    np.testing.assert_allclose(result.received[:, 1], 100.0)
    np.testing.assert_array_equal(result.time, np.arange(1, 2001) * 0.002)


def test_the_error_of_an_index_that_wraps_does_not_jump(tmp_path: Path) -> None:
    plain, wrapping = (
        remote_errors(s.remote, run_in_process(s, 0.002))
        for first in (65, 64000)
        if (s := scenario(tmp_path, CALM, ("first_index = 65", f"first_index = {first}"))).remote
    )
    np.testing.assert_allclose(wrapping.index, plain.index, atol=1e-9)
    np.testing.assert_allclose(wrapping.corrected_index, plain.corrected_index, atol=1e-9)


def test_an_event_is_known_to_a_cycle(tmp_path: Path) -> None:
    """The first cycle acts at 0 and is over at 0.002; in shorter steps it shows before."""
    accuracy = VALID[VALID.index("[remote.accuracy]") :]
    s = scenario(tmp_path, (accuracy, '[[expect]]\nwhen = "state == LISTENING"\ntime = 0.002\n'))
    (error,) = check_expectations(s, run_in_process(s, 0.0007))
    assert (error.actual, error.passed) == ("0.0007 s", True)
    assert error.expected == "first state == LISTENING at 0.002 s ± 0.002"


def test_the_slave_may_be_behind_by_design(tmp_path: Path) -> None:
    s, behind = (
        scenario(tmp_path, CALM, STEADY, ("position = 0.5", f"position = 0.5\nbehind = {n}")) for n in (0, 1.5)
    )
    assert s.remote
    assert behind.remote
    recording = run_in_process(s, 0.002)
    ahead = (
        remote_errors(behind.remote, recording).corrected_position
        - remote_errors(s.remote, recording).corrected_position
    )
    np.testing.assert_allclose(ahead, 1.5 * 0.2, atol=1e-9)


@pytest.mark.parametrize(
    ("accuracy", "expected"),
    [
        ("index = 1.0\nposition = 0.1", [("0.999", True), ("at most 0.0999 mm away", True)]),
        ("index = 0.998\nposition = 0.0998", [("0.999", False), ("at most 0.0999 mm away", False)]),
        ("index = 1.5", [("0.999", True)]),
        ("position = 0.2", [("at most 0.0999 mm away", True)]),
    ],
)
def test_the_accuracy_is_an_expectation(accuracy: str, expected: list[tuple[str, bool]], tmp_path: Path) -> None:
    s = scenario(tmp_path, CALM, STEADY, ("index = 1.5\nposition = 0.5", accuracy))
    checks = check_expectations(s, run_in_process(s, 0.002))
    assert [(c.actual, c.passed) for c in checks] == expected
    assert all(" from 0.5 s on" in c.expected for c in checks)


# --- how it is shown ---


def lines(chart: Chart) -> set[tuple[str, str]]:
    """The axis and the name of each line of a chart, without what is shaded."""
    return {(t["yaxis"], t["name"]) for t in chart.traces if t["mode"] == "lines" and "fill" not in t}


def test_the_report_shows_what_was_received_and_both_errors(tmp_path: Path) -> None:
    s = scenario(tmp_path)
    recording = run_in_process(s, 0.002)
    charts = run_charts(s, recording)
    assert list(charts) == ["errors", "motion", "lanes"]
    heads = [[note["text"] for note in charts[name].layout["annotations"]] for name in ("errors", "motion")]
    assert heads[0] == ["index error in cycles", "axis error in mm"]
    assert heads[1][:4] == ["position in mm", "velocity in mm/s", "acceleration in mm/s²", "jerk in mm/s³"]
    assert lines(charts["errors"]) == {(axis, name) for axis in ("y", "y2") for name in ("received", "slave")}
    assert lines(charts["motion"]) == {
        *((f"y{row}", name) for row in ("", 2, 3, 4) for name in ("remote axis", "slave")),
        *((f"y{row}", "received") for row in ("", 2, 3)),
    }
    write_report(tmp_path / "report.html", s, recording, evaluate_run(s, recording))
    page = (tmp_path / "report.html").read_text("utf-8")
    assert "telegrams of 0.001998 s cycles" in page
    assert "corrected_cycle_index within 1.5 cycles" in page
