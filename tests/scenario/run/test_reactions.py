"""Scenarios that react: when a reaction happens and what it sets, at every step size, and what the reader refuses.

In most of these runs a free saw moves at 100 mm/s from 0 on: it is at 100 t, and passes 50 exactly at a scan.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync_fmu.errors import UserError
from motionsync_fmu.production_line.reader import load_line
from motionsync_fmu.scenario.evaluate.csv_files import inputs_csv
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording
from motionsync_fmu.scenario.run.simulation import run_in_process, simulate
from motionsync_fmu.scenario.scenario import Scenario
from tests import ROOT, regenerate
from tests.support.blocks.drawn import drawn
from tests.support.hosts.fmus import Fmus
from tests.support.scenarios.scenario_texts import FREE_SAW, assert_refused, write_scenario
from tests.support.scenarios.stored_references import keep
from tests.support.scenarios.verdicts import checks_of

MOVING = FREE_SAW + "velocity = 500.0\n"
FINE = 0.001
STEP_SIZES = (0.01, FINE, 0.007, 0.0333, 0.3)  # s


def ran(text: str, folder: Path, step_size: float = 0.01) -> Recording:
    return run_in_process(load_scenario(write_scenario(text, folder)), step_size)


def recorded_sets(recording: Recording) -> list[tuple[float, dict[str, Any]]]:
    """What was set, and when."""
    return [(s.at, dict(s.values)) for s in recording.settings]


# --- when a reaction happens ---


@pytest.mark.parametrize("step_size", STEP_SIZES)
@pytest.mark.parametrize(
    ("when", "at"),
    [
        ("slave.position > 50", 0.51),  # at 50 exactly at 0.5: not yet beyond it there
        ("slave.position > 49.9999", 0.51),  # beyond it for a microsecond at 0.5, which that scan does not see
        ("slave.position > 49.99", 0.5),  # for 100 microseconds; it sees what was there 78 microseconds before
        ("slave.position > 50.1", 0.51),
        ("slave.position == 50", 0.0),  # no scan sees it there
    ],
)
def test_a_scan_sees_what_was_there_shortly_before_it(when: str, at: float, step_size: float, tmp_path: Path) -> None:
    reaction = f'[[on]]\nwhen = "{when}"\nset = {{ "halt.execute" = true }}\n'
    recording = ran(MOVING + reaction, tmp_path, step_size)
    assert recorded_sets(recording) == ([(at, {"halt.execute": True})] if at else [])
    if at:  # from there on it slows down, and not before
        rises = np.flatnonzero(recording.values["slave.acceleration"] != 0.0)
        assert recording.time[rises[0] - 1] == at
        assert recording.values["slave.position"][rises[0] - 1] == pytest.approx(100.0 * at, abs=1e-12)


@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_it_sets_some_time_later_at_a_point_of_its_own(step_size: float, tmp_path: Path) -> None:
    """Seen by the scan at 0.51; 0.3333 s later is no multiple of any step size."""
    reaction = '[[on]]\nwhen = "slave.position > 50"\nafter = 0.3333\nset = { "halt.execute" = true }\n'
    recording = ran(MOVING + reaction, tmp_path, step_size)
    assert recorded_sets(recording) == [(0.8433, {"halt.execute": True})]
    i = int(np.flatnonzero(recording.time == 0.8433)[0])
    assert recording.values["slave.position"][i] == pytest.approx(84.33, abs=1e-12)
    assert recording.values["slave.acceleration"][i : i + 2].tolist()[0] == 0.0
    assert recording.values["slave.acceleration"][i + 1] < 0.0


def test_what_holds_at_the_beginning_has_not_become_true(tmp_path: Path) -> None:
    """It is at rest from 0.57 on. From 1 s on it takes 2 sqrt(100/100000) = 0.0632 s to 100, with a jerk of 100000, and
    half of that to 50: the scan at 1.04 sees it beyond 50."""
    text = MOVING + (
        '[[set]]\nat = 0.5\n"halt.execute" = true\n[[set]]\nat = 1.0\n"move_velocity.execute" = true\n'
        '[[on]]\nwhen = "slave.velocity > 50"\nrepeat = true\nset = { "halt.execute" = false }\n'
    )
    assert [at for at, _ in recorded_sets(ran(text, tmp_path))] == [0.5, 1.0, 1.04]


def test_rounding_makes_nothing_greater_or_smaller_than_itself(tmp_path: Path) -> None:
    """At constant velocity its numbers are around 100, at some points above, at others below."""
    reactions = "".join(
        f'[[on]]\nwhen = "slave.velocity {c}"\nrepeat = true\nset = {{ "halt.jerk" = 1.0 }}\n'
        for c in ("> 100", "< 100", "> 99.99999999", "== 100.000001")
    )
    noisy = MOVING.replace("= 100.0\n", "= 100.00000000000003\n", 1)
    assert recorded_sets(ran(noisy + reactions, tmp_path)) == []
    equal = '[[on]]\nwhen = "slave.velocity == 300"\nset = { "halt.jerk" = 1.0 }\n[[set]]\nat = 0.5\n'
    faster = '"move_velocity.velocity" = 300.0\n"move_velocity.execute" = true\n'
    assert len(recorded_sets(ran(MOVING + equal + faster, tmp_path))) == 2


def test_an_enumeration_is_compared_by_the_name_of_a_member(tmp_path: Path) -> None:
    """halt at 0.5, from 100 with 10000 mm/s2 and its jerk of 100000: 2 sqrt(100/100000) = 0.063 s; at rest at 0.57."""
    text = MOVING + (
        '[[set]]\nat = 0.5\n"halt.execute" = true\n'
        '[[on]]\nwhen = "plcopen_state == STANDSTILL"\nset = { "halt.execute" = false }\n'
    )
    assert recorded_sets(ran(text, tmp_path)) == [(0.5, {"halt.execute": True}), (0.57, {"halt.execute": False})]


# --- what a reaction sets, and in which order ---


def test_what_is_set_at_one_time_is_set_in_the_order_of_the_file_after_what_has_a_time(tmp_path: Path) -> None:
    """The later one wins; a delayed reaction comes before one that sees its condition only then."""
    text = MOVING + (
        '[[on]]\nwhen = "slave.position > 50"\nset = { "halt.jerk" = 1.0 }\n'
        '[[on]]\nwhen = "slave.position > 50"\nset = { "halt.jerk" = 2.0 }\nadd = { "halt.deceleration" = 3.0 }\n'
        '[[on]]\nwhen = "slave.position > 40"\nafter = 0.1\nset = { "halt.jerk" = 4.0 }\n'
        '[[set]]\nat = 0.51\n"halt.jerk" = 5.0\n"halt.deceleration" = 6.0\n'
    )
    assert recorded_sets(ran(text, tmp_path)) == [
        (0.51, {"halt.jerk": 5.0, "halt.deceleration": 6.0}),
        (0.51, {"halt.jerk": 4.0}),
        (0.51, {"halt.jerk": 1.0}),
        (0.51, {"halt.jerk": 2.0, "halt.deceleration": 9.0}),
    ]


def test_what_a_reaction_sets_is_seen_by_the_next_scan(tmp_path: Path) -> None:
    """Since outputs change in a step only: each link of a chain takes a scan."""
    text = MOVING + (
        '[[on]]\nwhen = "slave.position > 50"\nset = { "move_velocity.execute" = true }\n'
        '[[on]]\nwhen = "move_velocity.in_velocity"\nset = { "reset.execute" = true }\n'
        '[[on]]\nwhen = "reset.done"\nset = { "halt.execute" = true }\n'
    )
    assert [at for at, _ in recorded_sets(ran(text, tmp_path))] == [0.51, 0.52, 0.53]


def test_an_addition_counts_from_the_present_value(tmp_path: Path) -> None:
    """From the start value, from what was set, and from the last addition; whole numbers stay whole."""
    pulses = "".join(
        f'[[set]]\nat = {at}\n"move_velocity.execute" = {level}\n'
        for at, level in ((0.105, "true"), (0.205, "false"), (0.305, "true"), (0.405, "false"), (0.505, "true"))
    )
    text = MOVING.replace("[master]", '"halt.jerk" = 10.0\n\n[master]') + (
        f'{pulses}[[set]]\nat = 0.35\n"halt.jerk" = 100.0\n'
        '[[on]]\nwhen = "move_velocity.in_velocity"\nrepeat = true\n'
        'add = { "halt.jerk" = 1.5, "halt.deceleration" = 2, "gear_in_pos.ratio_numerator" = -2 }\n'
    )
    given = [
        (at, values) for at, values in recorded_sets(ran(text, tmp_path)) if "gear_in_pos.ratio_numerator" in values
    ]
    assert [at for at, _ in given] == [0.11, 0.31, 0.51]
    assert [v["halt.jerk"] for _, v in given] == [11.5, 13.0, 101.5]
    assert [v["halt.deceleration"] for _, v in given] == [2.0, 4.0, 6.0]
    assert [v["gear_in_pos.ratio_numerator"] for _, v in given] == [-1.0, -3.0, -5.0]


@pytest.mark.parametrize(
    ("often", "times"),
    [("", 1), ("times = 2\n", 2), ("repeat = true\n", 3), ("times = 9\n", 3), ("repeat = false\n", 1)],
)
def test_it_happens_once_or_some_times_or_each_time(often: str, times: int, tmp_path: Path) -> None:
    """reset is done three times."""
    levels = [(0.1 * i, "true" if i % 2 else "false") for i in range(1, 7)]
    pulses = "".join(f'[[set]]\nat = {at:g}\n"reset.execute" = {level}\n' for at, level in levels)
    recording = ran(f'{MOVING}{pulses}[[on]]\nwhen = "reset.done"\n{often}set = {{ "halt.jerk" = 1.0 }}\n', tmp_path)
    assert [at for at, values in recorded_sets(recording) if "halt.jerk" in values] == [0.11, 0.31, 0.51][:times]
    assert [(u.actual, u.expected) for u in recording.unmet] == (
        [("3 times", "reaction to reset.done 9 times")] if "9" in often else []
    )


def test_what_would_be_set_at_the_end_does_not_happen(tmp_path: Path) -> None:
    reaction = '[[on]]\nwhen = "slave.position > {}"\nafter = {}\nset = {{ "halt.execute" = true }}\n'
    for position, after, times in ((50, 1.49, 0), (50, 1.48, 1), (197.5, 0.0, 1), (198.5, 0.0, 1), (199.5, 0.0, 0)):
        recording = ran(MOVING + reaction.format(position, after), tmp_path)
        assert (len(recording.settings), len(recording.unmet)) == (times, 1 - times)


def test_without_reactions_there_are_no_scans(tmp_path: Path) -> None:
    assert len(ran(MOVING, tmp_path, 0.5).time) == 5


PROGRAM = """
[[set]]
at = 0.51
"move_velocity.execute" = true
"halt.jerk" = 300.0

[[on]]
when = "slave.position > 50"
set = { "halt.jerk" = 1000.0 }

[[on]]
when = "move_velocity.in_velocity"
after = 0.2
times = 2
set = { "move_velocity.execute" = false }
add = { "move_velocity.velocity" = 50.0, "halt.jerk" = 1.0 }

[[on]]
when = "slave.position > 75"
after = 0.15
set = { "move_velocity.execute" = true }

[[on]]
when = "plcopen_state == CONTINUOUS_MOTION"
set = { "reset.execute" = true }
"""


def test_the_oracle_finds_the_same_by_itself(tmp_path: Path) -> None:
    """The last reaction has its state from the beginning. The others: by hand."""
    scenario = load_scenario(write_scenario(MOVING + PROGRAM, tmp_path))
    expected = [
        (0.51, {"move_velocity.execute": True, "halt.jerk": 300.0}),
        (0.51, {"halt.jerk": 1000.0}),
        (0.72, {"move_velocity.execute": False, "move_velocity.velocity": 150.0, "halt.jerk": 1001.0}),
        (0.91, {"move_velocity.execute": True}),
        (1.16, {"move_velocity.execute": False, "move_velocity.velocity": 200.0, "halt.jerk": 1002.0}),
    ]
    assert recorded_sets(run_in_process(scenario, 0.01)) == expected
    result = regenerate.settings(regenerate.solved(scenario, [])[0])
    assert [(s.at, dict(s.values)) for s in result] == expected


# --- what did not happen ---


@pytest.mark.parametrize(
    ("often", "expected"),
    [
        ("", "reaction to slave.position > 1000 once"),
        ("times = 2\n", "reaction to slave.position > 1000 2 times"),
        ("repeat = true\n", "reaction to slave.position > 1000 at least once"),
    ],
)
def test_what_never_happened_is_reported_and_fails_if_required(often: str, expected: str, tmp_path: Path) -> None:
    text = f'{MOVING}[[on]]\nwhen = "slave.position > 1000"\n{often}set = {{ "halt.execute" = true }}\n'
    scenario = load_scenario(write_scenario(text, tmp_path))
    recording = run_in_process(scenario, 0.01)
    (unmet,) = recording.unmet
    assert (unmet.expected, unmet.actual) == (expected, "never")
    assert checks_of(scenario, recording) == []
    required = load_scenario(write_scenario(text.replace("[[on]]", "[[on]]\nrequired = true"), tmp_path))
    (check,) = checks_of(required, run_in_process(required, 0.01))
    assert (check.expected, check.actual, check.passed) == (expected, "never", False)


# --- the cyclic cut ---

CYCLIC_CUT = ROOT / "scenarios" / "FlyingSaw" / "cyclic_cut" / "scenario.toml"


def of_the_oracle(scenario: Scenario) -> str:
    """The inputs, with the reactions where the oracle finds them from its own trajectory."""
    settled, _ = regenerate.with_reference(scenario.file, keep)
    return inputs_csv(settled)


def cyclic_cut(velocity: float, length: float, folder: Path) -> Scenario:
    """The cyclic cut for another line and other battens, with the number of cuts that there have to be.

    Its segments take 2075 from the way of a line that keeps its velocity: 225 + 1350 + 200 - 600 + 900. Mark n is cut
    where the line has gone 1250 + n lengths.
    """
    cuts = math.floor((33.0 * velocity - 2075.0 - 1250.0) / length) + 1
    text = CYCLIC_CUT.read_text()
    for old, new in (
        ("\nvelocity = 1000.0", f"\nvelocity = {velocity}"),
        ("\nlength = 1500.0", f"\nlength = {length}"),
        ("\ncount = 20", f"\ncount = {cuts}"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    return load_scenario(write_scenario(text, folder))


@pytest.mark.parametrize(
    ("velocity", "length"),
    [
        (300.0, 700.0),
        (300.0, 3000.0),
        (400.0, 800.0),
        (500.0, 1100.0),
        (600.0, 1000.0),
        (750.0, 1300.0),
        (900.0, 1500.0),
        (1000.0, 1500.0),
        (1000.0, 2400.0),
        (1200.0, 2000.0),
        (1200.0, 3000.0),
    ],
)
def test_the_cyclic_cut_cuts_other_lengths_from_other_lines(velocity: float, length: float, tmp_path: Path) -> None:
    """All cuts are there and on their marks, nothing is refused, and the saw keeps the limits of its axis."""
    scenario = cyclic_cut(velocity, length, tmp_path)
    recording = run_in_process(scenario, scenario.step_size)
    result = checks_of(scenario, recording)
    assert len(result) == 4
    assert [c for c in result if not c.passed] == []
    slave = {name: recording.values[f"slave.{name}"] for name in ("position", "velocity", "acceleration", "jerk")}
    assert -250.0 <= slave["position"].min() <= slave["position"].max() <= 800.0
    assert np.abs(slave["velocity"]).max() <= 1500.0
    assert np.abs(slave["acceleration"]).max() <= 10000.0 * (1.0 + 1e-9)


def test_what_the_machine_cannot_do_is_refused_and_reported(tmp_path: Path) -> None:
    """600 mm at 1200 mm/s: a cut each 0.5 s, of which it saws for 0.25 s."""
    scenario = cyclic_cut(1200.0, 600.0, tmp_path)
    broken = [c for c in checks_of(scenario, run_in_process(scenario, scenario.step_size)) if not c.passed]
    assert "error = false, from 0 s to 33 s" in [c.expected for c in broken]
    assert any(c.expected.startswith("number of cuts") for c in broken)


def test_the_cyclic_cut_takes_the_next_mark_on_its_way_home() -> None:
    """Numbers by hand, in u, u/s and s.

    The first ramp leads from rest over 500 of the line and 250 of the saw: 500 (x^3 - x^4/2), so 46.875 half way, at 1.
    In sync since 1.25, seen at 1.26, it goes home at 1.51 from 510: with 10000 and a jerk of 200000 it is at 510 again
    and at -1000 0.25 later, and at 370 at 1.9. At 2.1 it is found to be below 180; mark 1 is 650 away then. The order
    waits for 500, until 2.25. The stop from -1000 takes 0.15 and 75, so it has begun at 2.195: after 0.05 the saw is
    45.8333 nearer and at -750, and 0.005 later, at -10000, another 3.625 nearer and at -700.
    """
    recording = run_in_process(load_scenario(CYCLIC_CUT), 0.01)

    def at(time: float, name: str) -> float:
        return float(recording.values[name][np.argmin(np.abs(recording.time - time))])

    assert [s.at for s in recording.settings[:4]] == [0.1, 1.51, 2.1, 3.01]
    assert at(1.0, "slave.position") == pytest.approx(46.875, abs=1e-9)
    assert (at(1.9, "slave.position"), at(1.9, "slave.velocity")) == pytest.approx((370.0, -1000.0), abs=1e-9)
    assert at(2.2, "state_code") == 11.0  # PREPHASE
    assert at(2.3, "characteristics.slave_position_start") == pytest.approx(25.5416666666667, abs=1e-9)
    assert at(2.3, "characteristics.slave_velocity_start") == pytest.approx(-700.0, abs=1e-9)
    assert at(2.3, "characteristics.master_position_end") == pytest.approx(2750.0, abs=1e-9)


@pytest.mark.parametrize("step_size", [0.01, 0.001, 0.007])
def test_reactions_happen_at_the_scans_of_the_oracle(step_size: float) -> None:
    scenario = load_scenario(CYCLIC_CUT)
    assert scenario.reactions
    recording = run_in_process(scenario, step_size)
    assert inputs_csv(scenario.with_recorded_inputs(recording.settings, scenario.master)) == of_the_oracle(scenario)


@pytest.mark.parametrize("step_size", [0.01, 0.007])
def test_they_happen_there_in_an_fmu_too(step_size: float, fmus: Fmus) -> None:
    scenario = load_scenario(CYCLIC_CUT)
    recording = simulate(scenario, fmus.python("FlyingSaw"), step_size)
    assert inputs_csv(scenario.with_recorded_inputs(recording.settings, scenario.master)) == of_the_oracle(scenario)


@given(st.floats(0.001, 0.5))
@drawn(15, anew=True)
def test_a_scenario_that_reacts_means_the_same_at_every_step_size(step_size: float) -> None:
    """The first five cuts; both runs have the scans and their looks in common."""
    scenario = load_scenario(CYCLIC_CUT)
    scenario = replace(scenario, stop_time=8.0, expectations=(), cuts=None)
    one, other = (run_in_process(scenario, h) for h in (scenario.step_size, step_size))
    assert recorded_sets(one) == recorded_sets(other)
    common, i, j = np.intersect1d(one.time, other.time, return_indices=True)
    assert len(common) >= 1590  # 800 scans, and a look before each
    for name in ("slave.position", "slave.velocity", "state_code", "in_sync", "gear_in_pos.busy"):
        scale = max(1.0, float(np.abs(one.values[name]).max()))
        np.testing.assert_allclose(one.values[name][i], other.values[name][j], atol=1e-9 * scale, rtol=0.0)


# --- files with a mistake ---

VALID = (
    MOVING
    + """\
[[on]]
when = "in_sync"
set = { "halt.execute" = true }

[[on]]
when = "state == SYNCHRON"
after = 0.5
times = 2
set."halt.execute" = true
add."halt.jerk" = 1.0

[[on]]
when = "slave.position < 5"

[on.set]
"move_absolute.execute" = true

[cuts]
while = "in_sync"
length = 100.0
"""
)

MISTAKES = {
    "no condition": ('when = "in_sync"\n', "", "when", 12, ("is missing",)),
    "unknown output": ('"in_sync"\nset', '"in_snc"\nset', "when", 13, ("FlyingSaw has no", "'in_sync'")),
    "input": ("slave.position < 5", "master.position < 5", "when", 24, ("master.position", "input", "output or local")),
    "parameter": ("slave.position < 5", "axis.max_jerk < 5", "when", 24, ("axis.max_jerk", "parameter")),
    "no comparison": ('"slave.position < 5"', '"slave.position"', "when", 24, ("compare",)),
    "no such comparison": ("position < 5", "position >= 5", "when", 24, ("NAME > VALUE",)),
    "no text": ('"in_sync"\nset', "true\nset", "when", 13, ("NAME == VALUE",)),
    "no member": ("== SYNCHRON", "== SYNCRON", "when", 17, ("SYNCRON", "SYNCHRON")),
    "before": ("after = 0.5", "after = -0.5", "after", 18, ("-0.5", ">= 0")),
    "too late": ("after = 0.5", "after = 2.0", "after", 18, ("2", "< 2")),
    "never": ("times = 2", "times = 0", "times", 19, ("0 is not allowed",)),
    "fraction": ("times = 2", "times = 2.5", "times", 19, ("2.5", "whole")),
    "times and repeat": ("times = 2", "times = 2\nrepeat = true", "times", 19, ("repeat", "one of both")),
    "repeat is no Boolean": ("times = 2", 'repeat = "yes"', "repeat", 19, ("'yes'", "true nor false")),
    "required is no Boolean": ("times = 2", "required = 1", "required", 19, ("1", "true nor false")),
    "unknown key": ("times = 2", "time = 2", "time", 19, ("unknown key", "times")),
    "unknown input in braces": (
        '{ "halt',
        '{ "hlt',
        "hlt.execute",
        14,
        ("no variable 'hlt.execute'", "'halt.execute'"),
    ),
    "unknown input": ('set."halt', 'set."hlt', "hlt.execute", 20, ("no variable", "'halt.execute'")),
    "unknown input in a table": ('"move_absolute.e', '"move_absolut.e', "move_absolut.execute", 27, ("no variable",)),
    "set of an output": (
        'set."halt.execute" = true',
        'set."in_sync" = true',
        "in_sync",
        20,
        ("output", "input or tunable"),
    ),
    "set of the axis": (
        'set."halt.execute" = true',
        'set."master.velocity" = 1.0',
        "master.velocity",
        20,
        ("[master]",),
    ),
    "set of another type": (
        'set."halt.execute" = true',
        'set."halt.execute" = 1',
        "halt.execute",
        20,
        ("1 is no Boolean",),
    ),
    "set is no table": ('set = { "halt.execute" = true }', "set = true", "set", 14, ("must be a table",)),
    "nothing": ('set = { "halt.execute" = true }\n', "", "when", 13, ("sets nothing",)),
    "added to a Boolean": (
        'add."halt.jerk" = 1.0',
        'add."stop.execute" = 1.0',
        "stop.execute",
        21,
        ("Boolean", "number"),
    ),
    "a text is added": (
        'add."halt.jerk" = 1.0',
        'add."halt.jerk" = "length"',
        "halt.jerk",
        21,
        ("'length' is no Real",),
    ),
    "too much is added": ('add."halt.jerk" = 1.0', 'add."halt.jerk" = inf', "halt.jerk", 21, ("finite",)),
    "set and added": (
        'add."halt.jerk"',
        'set."halt.jerk" = 1.0\nadd."halt.jerk"',
        "add",
        22,
        ("halt.jerk", "one of both"),
    ),
    "one table": ('[[on]]\nwhen = "in_sync', '[on]\nwhen = "in_sync', "on", 12, ("list of tables", "[[on]]")),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_reported_with_file_line_and_key(name: str, tmp_path: Path) -> None:
    old, new, key, line, words = MISTAKES[name]
    assert load_scenario(write_scenario(VALID, tmp_path))
    text = VALID.replace(old, new, 1)
    if name == "one table":
        text = text[: text.index("[[on]]")]
    assert_refused(text, tmp_path, line, key, *words)


def test_the_length_of_the_cuts_can_be_added(tmp_path: Path) -> None:
    text = VALID.replace('add."halt.jerk" = 1.0', 'add."halt.jerk" = "cuts.length"')
    assert load_scenario(write_scenario(text, tmp_path)).reactions[1].add == {"halt.jerk": 100.0}
    file = write_scenario(text[: text.index("[cuts]")], tmp_path)
    with pytest.raises(UserError, match=r":21: halt\.jerk: .*no length in a table \[cuts\]"):
        load_scenario(file)


def test_a_line_does_not_react(tmp_path: Path) -> None:
    line = (ROOT / "scenarios" / "line" / "line.toml").read_text()
    file = tmp_path / "line.toml"
    file.write_text(line + '\n[[on]]\nwhen = "in_sync"\nset = { "halt.execute" = true }\n')
    with pytest.raises(UserError, match=rf":{len(line.splitlines()) + 2}: on: a line cannot react: .*\[\[set\]\]"):
        load_line(file)


def test_the_delay_of_a_remote_axis_is_not_set_by_a_reaction(tmp_path: Path) -> None:
    text = (ROOT / "scenarios" / "RemoteSync" / "no_drift" / "scenario.toml").read_text()
    reaction = '\n[[on]]\nwhen = "slave.position > 1"\nset = { "delay_time_offset" = 0.002 }\n'
    with pytest.raises(UserError, match=r"when: delay_time_offset .*\[\[set\]\]"):
        load_scenario(write_scenario(text + reaction, tmp_path))
