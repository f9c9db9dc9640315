"""What the comments of `new.toml` say of a figure is what the run does, for the template's figures and for others that
the machine can do: then the scenario is as expected, too.

Each comment on a figure has a claim here, with its words: who changes the comment changes the claim. A claim measures
in the run what the comment names. A figure that a comment states itself is a part of its claim."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motionsync.blocks import BLOCKS
from motionsync_fmu import new
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Reals, Recording
from tests.support.scenarios.recordings import run_compiled
from tests.support.scenarios.verdicts import checks_of

Booleans = np.ndarray[Any, np.dtype[np.bool_]]
FIGURE = re.compile(r'(?m)^"?(?P<key>[\w.]+)"? = (?P<value>[^#\n]*?) *# (?P<comment>.*)$')
ADVICE = {  # what is named of no run, but to whom changes the file
    "longer for slower masters",
    "longer for slower lines",
    "longer for slower lines and longer pieces",
    "longer if the two clocks drift less",
}


@dataclass
class Run:
    """A run of a scenario, by what was recorded; `values`: the figures as the file has them, without units."""

    recording: Recording
    values: dict[str, float]

    def __post_init__(self) -> None:
        self.time = self.recording.time
        self.master, self.velocity = self.recording.master[:, 0], self.recording.master[:, 1]

    def __getitem__(self, name: str) -> Reals:
        return self.recording.columns[name]

    @property
    def step(self) -> float:
        """What the master travels in a step at most: so exact is a place at which something shows."""
        return float(np.abs(np.diff(self.master)).max())

    def first(self, condition: Booleans) -> int:
        """The first point at which something holds."""
        return int(np.flatnonzero(condition)[0])

    def phases(self, condition: Booleans) -> list[tuple[int, int]]:
        """The points at which something begins to hold, and at which it no longer does."""
        change = np.diff(condition.astype(int))
        begins, ends = np.flatnonzero(change > 0) + 1, np.flatnonzero(change < 0) + 1
        return [(int(b), int(ends[ends > b][0])) for b in begins if (ends > b).any()]

    def greatest(self, name: str) -> float:
        return float(np.abs(self[name]).max())

    def cuts(self) -> list[int]:
        return [int(i) + 1 for i in np.flatnonzero(np.diff(self["statistics.cuts"]) > 0)]


Measure = Callable[[Run], float]


@dataclass(frozen=True)
class Claim:
    """What a comment says.

    Attributes:
        comment: its words.
        measure: what it names, in the run; a limit is the greatest value, which stays below it.
        others: further values of the figure that the rest of the template allows.
        is_limit: whether it says what the machine can do at most.
        steps: how many steps of the master the run shows it late at most; of a time, of the communication points.
    """

    comment: str
    measure: Measure
    others: tuple[float, ...] = ()
    is_limit: bool = False
    steps: float = 1.01
    is_time: bool = False


def at_end(name: str) -> Measure:
    return lambda run: float(run[name][-1])


def master_velocity(run: Run) -> float:
    return float(run.velocity[-1])


def limit(comment: str, name: str, *others: float) -> Claim:
    return Claim(comment, lambda run: run.greatest(name), others, is_limit=True)


def catching_up(run: Run) -> tuple[float, float]:
    """Where the master is when the slave of a Gearing starts to move, and when it is in gear."""
    moving = run.first(run["slave.velocity"] != 0.0) - 1
    return float(run.master[moving]), float(run.master[run.first(run["in_gear"] > 0.0)])


def turn_phase(run: Run) -> float:
    """The slave's travel in the stop of a Synchronizer: up to its rest from where the master leaves it."""
    begin, end = run.phases(run["syn_ramp_on"] > 0.0)[0]
    period = run.values["master.period"]
    turns = np.diff(run["slave.position"][begin - 1 : end + 1])
    travel = float((turns - period * np.round(turns / period)).sum())
    return travel - float(run.master[begin] - run.master[begin - 1]) * 0.5


def meeting(run: Run, name: str) -> float:
    """The value of an output when the slave of a FlyingSaw is first in sync."""
    return float(run[name][run.first(run["in_sync"] > 0.0)])


def first_sync(run: Run) -> float:
    return float(run.master[run.first(run["in_sync"] > 0.0)])


def saw_start(run: Run) -> float:
    """How far before the meeting the saw starts, and its way doubled, which is the same."""
    start = float(run.master[run.first(run["slave.velocity"] > 0.0) - 1])
    travel = first_sync(run) - start
    assert travel == pytest.approx(2.0 * meeting(run, "slave.position"), abs=2.0 * run.step)
    return travel


def mark(run: Run, number: int) -> float:
    """Where the saw is on the material: the master's position less the saw's, when it is in sync for that time."""
    begin, _ = run.phases(run["in_sync"] > 0.0)[number]
    return float(run.master[begin] - run["slave.position"][begin])


def sync_point(run: Run) -> float:
    """The master's position at the first meeting, whose mark is the one that the comment names."""
    assert mark(run, 0) == pytest.approx(1000.0, abs=run.step)
    return first_sync(run)


def cut_time(run: Run) -> float:
    return min(float(run.time[end] - run.time[begin]) for begin, end in run.phases(run["in_sync"] > 0.0))


def pitch(run: Run) -> float:
    """The master's travel from cut to cut."""
    return float(np.diff(run.master[run.cuts()]).mean())


def last_length(run: Run) -> float:
    lengths = run["last.length"][run.cuts()]
    assert np.ptp(lengths) < 1e-6
    return float(lengths[0])


def synchronous(run: Run) -> list[tuple[int, int]]:
    """The synchronized phases of a Follower."""
    return run.phases(run["state_code"] == 8.0)


def follower_at_sync(run: Run) -> float:
    """The slave at the meeting: at the first point in sync, less what it has travelled since; k is 1."""
    begin, _ = synchronous(run)[0]
    beyond = (run.master[begin] - run.values["sync_master"]) % run.values["master_cycle"]
    return float(run["slave.position"][begin] - beyond)


def window(run: Run, is_before: bool) -> float:
    """The material that passes in the window of a cut of a RotaryKnife before it, or after it."""
    for begin, end in run.phases(run["knife.in_window"] > 0.0)[1:]:
        (cut,) = (cut for cut in run.cuts() if begin <= cut <= end)
        return float(run.master[cut] - run.master[begin] if is_before else run.master[end] - run.master[cut])
    raise AssertionError("no window")


def blades(run: Run) -> float:
    """How often the knife's travel from one cut to the next, which is that from blade to blade, goes into a turn."""
    first, second = run.cuts()[1:3]
    turns = np.diff(run["slave.position"][first : second + 1])
    return 360.0 / float((turns - 360.0 * np.round(turns / 360.0)).sum())


def front(run: Run) -> float:
    """Where the material begins, from the knife at the start: a piece before the first cut. No cut is skipped."""
    assert run["statistics.skipped"][-1] == 0.0
    start = run.first(run["running"] > 0.0) - 1
    return float(run.master[start] - run.master[run.cuts()[0]] + last_length(run))


def sender_cycle(run: Run) -> float:
    """The sender's cycle, by the drift in ppm that the block finds, which is the one that the comment names."""
    assert run["drift"][-1] == pytest.approx(2000.0, rel=1e-3)
    return run.values["task_cycle_time"] / (1.0 + float(run["drift"][-1]) * 1e-6)


CLAIMS: dict[str, dict[str, Claim]] = {
    "Gearing": {
        "gearing.numerator": Claim(
            "the slave moves so much ...",
            lambda run: float(run["slave.velocity"][-1] / run.velocity[-1]) * run.values["gearing.denominator"],
            (3, -2),
            steps=0.0,
        ),
        "gearing.denominator": Claim(
            "... while the master moves so much",
            lambda run: float(run.velocity[-1] / run["slave.velocity"][-1]) * run.values["gearing.numerator"],
            (4, -3),
            steps=0.0,
        ),
        "gear_in.distance": Claim(
            "the master's way while the slave catches up ...",
            lambda run: float(np.diff(catching_up(run))[0]),
            (50.0, 730.0),
            steps=2.01,
        ),
        "gear_in.reference_position": Claim(
            "... and where the middle of that way is", lambda run: float(np.mean(catching_up(run))), (333.0, 1200.0)
        ),
        "velocity": Claim("how fast the master moves", master_velocity, (50.0, 1000.0), steps=0.0),
    },
    "Synchronizer": {
        "master.period": Claim("one turn", lambda run: run.greatest("master.smoothed_position"), (400.0, 720.0)),
        "rest_value": Claim(
            "where the slave rests",
            lambda run: float(run["slave.position"][run.first(run.time >= 14.9)]),
            (90.0, 301.0),
            steps=0.0,
        ),
        "slave.position": Claim(
            "rest_value", lambda run: float(run["slave.position"][run.first(run.time >= 14.999)]), steps=0.0
        ),
        "output_phasing": Claim("the slave's way in a stop or a start", turn_phase, (45.0, 130.0), steps=2.01),
        "velocity": Claim("how fast the master turns", master_velocity, (100.0, 720.0), steps=0.0),
    },
    "FlyingSaw": {
        "axis.max_position": limit(
            "the stroke: how far the saw can travel from its home", "slave.position", 400.0, 5000.0
        ),
        "axis.max_velocity": limit("how fast the saw can be", "slave.velocity", 1500.0, 4000.0),
        "axis.max_acceleration": limit("how fast it can accelerate and brake", "slave.acceleration", 5000.0, 30000.0),
        "gear_in_pos.master_sync_position": Claim("the mark at 1000 meets the saw", sync_point),
        "gear_in_pos.slave_sync_position": Claim(
            "where the saw is then", lambda run: meeting(run, "slave.position"), steps=1.01
        ),
        "gear_in_pos.master_start_distance": Claim("the saw starts so much before: twice its way", saw_start),
        "velocity": Claim("how fast the line runs", master_velocity, (100.0, 700.0), steps=0.0),
        "after": Claim("how long a cut takes", cut_time, (0.05, 0.5), steps=2.01, is_time=True),
        "length": Claim("how far apart the marks are", lambda run: mark(run, 2) - mark(run, 1), (800.0, 6000.0)),
        "offset": Claim("where the first one is", lambda run: mark(run, 0)),
    },
    "CutToLength": {
        "length": Claim("how long the pieces are", last_length, (500.0, 1234.5, 25000.0), steps=0.0),
        "axis.max_position": limit(
            "the stroke: how far the carriage can travel from its home", "slave.position", 450.0, 5000.0
        ),
        "axis.max_velocity": limit("how fast the carriage can be", "slave.velocity", 800.0, 4000.0),
        "axis.max_acceleration": limit("how fast it can accelerate and brake", "slave.acceleration", 4000.0, 30000.0),
        "axis.max_jerk": limit("how fast its acceleration can change", "slave.jerk", 40000.0, 1e6),
        "tool.cut_time": Claim(
            "how long a cut takes, from sync to free", cut_time, (0.05, 0.5), steps=2.01, is_time=True
        ),
        "kerf": Claim("how much material the blade removes", lambda run: pitch(run) - last_length(run), (4.0, 11.0)),
        "velocity": Claim("how fast the line runs", master_velocity, (100.0, 900.0), steps=0.0),
    },
    "RotaryKnife": {
        "length": Claim("how long the pieces are", last_length, (350.0, 1500.0, 20000.0), steps=0.0),
        "knife.circumference": Claim(
            "of the circle on which the blades' edges run",
            lambda run: 360.0 / float((run["slave.velocity"] / run.velocity)[run.first(run["knife.in_window"] > 0.0)]),
            (450.0, 900.0),
            steps=0.0,
        ),
        "knife.blades": Claim("how many blades, evenly spaced", blades, (2, 3), steps=1e-4),
        "axis.max_velocity": limit("how fast the knife can turn", "slave.velocity", 2000.0, 7200.0),
        "axis.max_acceleration": limit(
            "how fast it can accelerate and brake, in deg/s2", "slave.acceleration", 40000.0, 2e5
        ),
        "axis.max_jerk": limit("how fast its acceleration can change, in deg/s3", "slave.jerk", 2e6, 8e6),
        "sync.before": Claim(
            "how much material passes in sync before each cut", lambda run: window(run, True), (5.0, 40.0), steps=1.01
        ),
        "sync.after": Claim("and how much after it", lambda run: window(run, False), (5.0, 40.0), steps=1.01),
        "front_position": Claim(
            "where the material begins: far enough before the knife for its first turn", front, (-2500.0, -4111.0)
        ),
        "velocity": Claim("how fast the line runs", master_velocity, (100.0, 2500.0), steps=0.0),
    },
    "RemoteSync": {
        "task_cycle_time": Claim(
            "the receiver's cycle", lambda run: float(run.time[-1] / (run["local.cycles"][-1] + 1.0)), steps=0.0
        ),
        "velocity": Claim("how fast the axis moves", at_end("slave.velocity"), (100.0, 2000.0), steps=0.0),
        "sender_cycle": Claim(
            "the sender's cycle by the receiver's clock: it is 2000 ppm fast", sender_cycle, steps=0.0
        ),
    },
    "Follower": {
        "master_cycle": Claim(
            "how far the master moves from one meeting to the next",
            lambda run: float(run.master[synchronous(run)[2][0]] - run.master[synchronous(run)[1][0]]),
            (900.0, 3000.0),
        ),
        "sync_master": Claim(
            "where in that cycle the slave has to be in sync",
            lambda run: float(run.master[synchronous(run)[0][0]] % run.values["master_cycle"]),
            (250.0, 777.0),
        ),
        "sync_slave": Claim("where the slave is then, from its park", follower_at_sync, (60.0, 150.0), steps=0.0),
        "sync_out": Claim(
            "where the slave leaves the master",
            lambda run: float(run["slave.position"][synchronous(run)[0][1]]),
            (200.0, 330.0),
        ),
        "space_stop_slave": Claim(
            "how much way the slave needs after that to stop",
            lambda run: run.greatest("slave.position") - run.values["sync_out"],
            (70.0, 130.0),
        ),
        "max_speed": limit("how fast the slave can be", "slave.velocity", 600.0, 4000.0),
        "max_acceleration": limit("how fast it can accelerate and brake", "slave.acceleration", 6000.0, 30000.0),
        "velocity": Claim("how fast the master moves", master_velocity, (100.0, 400.0), steps=0.0),
    },
}


def commented(text: str) -> list[tuple[str, str, str]]:
    """Key, value and comment of each commented figure."""
    return [(match["key"], match["value"], match["comment"]) for match in FIGURE.finditer(text)]


def number(literal: str) -> float:
    """A figure of the templates, which have them in mm, deg and s, or with one of these units."""
    value, _, unit = literal.strip('"').partition(" ")
    factor = {"": 1.0, "m/min": 1000.0 / 60.0, "rpm": 6.0}[unit]
    return float(value) * factor


def run_with(block: str, folder: Path, key: str, value: float | None) -> Run:
    """A run of the new scenario, in which a figure has another value."""
    file = new(block, folder)
    text = file.read_text("utf-8")
    if value is not None:
        text, count = re.subn(rf'(?m)^("?{re.escape(key)}"? = )[^#\n]*', rf"\g<1>{value!r} ", text)
        assert count == 1
        file.write_text(text, "utf-8")
    scenario = load_scenario(file)
    (run,) = run_compiled(scenario)
    assert run.recording, run.failure
    if key != "rest_value":  # which an expectation has as its value
        assert [check for check in checks_of(scenario, run.recording) if not check.passed] == []
    figures = {k: number(literal) for k, literal, comment in commented(text) if comment not in ADVICE}
    return Run(run.recording, figures)


@pytest.mark.parametrize("block", CLAIMS)
def test_each_comment_on_a_figure_has_its_claim(block: str, tmp_path: Path) -> None:
    text = new(block, tmp_path).read_text("utf-8")
    stated = {(key, comment) for key, _, comment in commented(text) if comment not in ADVICE}
    assert stated == {(key, claim.comment) for key, claim in CLAIMS[block].items()}


@pytest.mark.parametrize("block", BLOCKS)
def test_a_figure_in_any_other_comment_is_a_unit_s_example(block: str, tmp_path: Path) -> None:
    """As "6 m" in the first lines: it says nothing of the run."""
    text = new(block, tmp_path).read_text("utf-8")
    comments = [line.partition("#")[2] for line in text.splitlines() if "#" in line and not FIGURE.match(line)]
    assert re.findall(r"\d+", re.sub(r'"\d+ [\w/]+"', "", " ".join(comments))) == []


@pytest.mark.parametrize(("block", "key"), [(block, key) for block, claims in CLAIMS.items() for key in claims])
def test_the_run_does_what_the_comment_says(block: str, key: str, tmp_path: Path) -> None:
    claim = CLAIMS[block][key]
    for index, value in enumerate((None, *claim.others)):
        run = run_with(block, tmp_path / str(index), key, value)
        named, measured = run.values[key], claim.measure(run)
        assert run["error"].max() == 0.0
        if claim.is_limit:
            assert 0.0 < measured <= named * (1.0 + 1e-9)
        else:
            unit = float(np.diff(run.time).max()) if claim.is_time else run.step
            assert measured == pytest.approx(named, rel=1e-6, abs=claim.steps * unit)
