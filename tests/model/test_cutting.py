"""What holds for every machine that cuts to length, whatever carries its blade and whatever its inputs are."""

import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from math import ceil
from random import Random
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from motionsync.blocks import BLOCKS
from motionsync.cutting.faults import MarkRefusal, NoLength, PieceFault
from motionsync.cutting.interface import LateMode, Source, StartMode
from motionsync.master import MasterInput
from motionsync_fmu.interface.stepper import Stepper
from tests.support.blocks.drawn import drawn
from tests.support.blocks.finite import run_finite
from tests.support.blocks.runs import BlockRun

INTEGER = 2147483647  # the largest number of FMI's Integer
MARKS: dict[str, Any] = {"source": Source.MARK, "auto_start": True, "mark.sensor_distance": 700.0}

pytestmark = pytest.mark.parametrize("machine", ["CutToLength", "RotaryKnife"])


class Line:
    """A machine with windows of sync that any knife has, on a line whose velocity is constant in each step."""

    def __init__(self, machine: str, start: dict[str, Any], velocity: float = 600.0) -> None:
        self.block: Any = BLOCKS[machine]()
        self.stepper = Stepper(self.block)
        self.position, self.velocity = 0.0, velocity
        self.stepper.initialize(start | {"master.velocity": velocity})

    def step(self, h: float, **values: Any) -> "Line":
        inputs = {name.replace("__", "."): value for name, value in values.items()}
        self.stepper.step(h, inputs | {"master.position": self.position, "master.velocity": self.velocity})
        self.position += self.velocity * h
        return self

    def mark(self, position: float) -> "Line":
        """An edge of the sensor, in a step of 1 ms; it falls in the next one."""
        return self.step(1e-3, mark__detected=True, mark__position=position).step(1e-3, mark__detected=False)

    def run(self, duration: float, h: float = 0.01) -> list[tuple[float, bool]]:
        """Length and `good` of each piece that is cut in that time, s."""
        pieces = []
        for _ in range(round(duration / h)):
            cuts = self["statistics.cuts"]
            self.step(h)
            if self["statistics.cuts"] > cuts:
                pieces.append((self["last.length"], self["last.good"]))
        return pieces

    def __getitem__(self, name: str) -> Any:
        return self.stepper[name]


def calls_of(act: Callable[[], object]) -> int:
    """How many functions of Python `act` calls."""
    number = 0

    def count(_frame: Any, event: str, _argument: Any) -> None:
        nonlocal number
        number += event == "call"

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        act()
    finally:
        sys.setprofile(before)
    return number


# --- no piece without a length ----------------------------------------------------------------------------------------


@drawn(40, anew=True)
@given(st.floats(1.0, 5000.0), st.lists(st.floats(-6000.0, 3000.0), min_size=1, max_size=6), st.floats(0.0, 20.0))
def test_a_mark_whose_cut_is_not_beyond_the_material_before_it_is_refused(
    machine: str, front: float, positions: list[float], kerf: float
) -> None:
    """The front end is `front` before the place of the cut, its cut half a kerf further on. C = p + 700 has to be
    beyond it, or beyond the cut of the mark before if that still waits (one that is too near is left out at once), by
    more than a kerf."""
    line = Line(machine, {**MARKS, "front_position": -front, "kerf": kerf}).step(1e-3)
    front_end = front - 0.5 * kerf
    last, newest, refused = front_end, front_end, 0
    for position in positions:
        is_refused = position + 700.0 - last - kerf <= 1e-6
        line.mark(position)
        assert line["local.mark_refusal"] == 0  # it holds for the step of the edge
        refused += is_refused
        newest = newest if is_refused else position + 700.0
        last = newest if line["local.marks_waiting"] or line["next_cut.known"] else front_end
        counts = [line[f"statistics.{name}"] for name in ("marks", "marks_refused", "marks_outside")]
        assert sum(counts) == counts[0] + refused
        assert line["warning.mark_refused"] == is_refused
    assert all(length > 0.0 for length, _ in line.run(4.0))


def test_the_first_piece_ends_at_the_first_mark_behind_the_front_end(machine: str) -> None:
    """B = 3000: the edges at 1000 and 2299 would be cut at 1700 and 2999; pieces are 2700 and 300 long."""
    line = Line(machine, {**MARKS, "front_position": -3000.0}, 200.0).step(1e-3)
    for position in (1000.0, 2299.0, 5000.0, 5300.0):
        line.run((position - line.position) / 200.0)
        line.mark(position)
    assert line["statistics.marks_refused"] == 2
    assert line.run(5.0) == [(pytest.approx(2700.0), True), (pytest.approx(300.0), True)]


def test_a_cut_now_before_the_front_end_is_refused(machine: str) -> None:
    """The front end comes to the place of the cut after 5 s; a second command later on is carried out."""
    line = Line(machine, {"auto_start": True, "front_position": -3000.0}).step(0.1)
    line.step(0.1, cut_now=True)
    assert (line["error_id"], line["statistics.cuts"]) == (PieceFault.CUT_NOW, 0)
    line.step(0.1, cut_now=False).run(4.9)
    line.step(0.1, cut_now=True)
    assert line["error_id"] == PieceFault.NONE
    ((length, is_accepted),) = line.run(1.0)
    assert (0.0 < length < 1000.0, is_accepted) == (True, False)


# --- calibration ------------------------------------------------------------------------------------------------------


@drawn(25, anew=True)
@given(st.floats(700.0, 1500.0), st.floats(0.0, 20.0), st.lists(st.floats(0.2, 4.0), min_size=1, max_size=4))
def test_a_calibration_whose_factor_is_beyond_a_half_to_two_is_refused(
    machine: str, length: float, kerf: float, shares: list[float]
) -> None:
    """Each share is (measured + kerf)/(length + kerf) of the same piece; the factor is their product, as long as it
    stays within 0.5 to 2. What is refused leaves it, and the line's limits, as they were."""
    line = Line(machine, {"auto_start": True, "length": length, "kerf": kerf}, 500.0)
    line.run(3.5)
    assert line["last.length"] == pytest.approx(length)
    line.step(1e-3, hold=True)
    factor = 1.0
    for share in shares:
        limit = line["limits.max_line_velocity"]
        line.step(1e-3, calibration__execute=True, calibration__measured_length=share * (length + kerf) - kerf)
        is_accepted = 0.5 <= factor * share <= 2.0
        factor *= share if is_accepted else 1.0
        assert line["calibration.factor"] == pytest.approx(factor, rel=1e-9)
        assert line["error_id"] == (PieceFault.NONE if is_accepted else PieceFault.CALIBRATION)
        assert is_accepted or line["limits.max_line_velocity"] == limit
        line.step(1e-3, calibration__execute=False)


# --- work that a user cannot enlarge ----------------------------------------------------------------------------------


def random_scale(r: Random, machine: str) -> dict[str, Any]:
    """Start values that are within their ranges, and fit to each other by chance only."""
    length = 10.0 ** r.uniform(-6.0, 12.0)
    start: dict[str, Any] = {
        "material_factor": 10.0 ** r.uniform(-12.0, 12.0),
        "length": length,
        "kerf": r.choice((0.0, length * r.random(), 10.0 ** r.uniform(-6.0, 6.0))),
        "length_correction": length * r.choice((0.0, 0.0, 0.1, -0.1)),
        "front_position": r.choice((0.0, 1.0, -1.0)) * 10.0 ** r.uniform(0.0, 12.0),
        "trim_length": length * r.choice((0.0, 0.3)),
        "start_mode": r.choice((StartMode.FRONT, StartMode.TRIM)),
        "late_mode": r.choice(list(LateMode)),
        "source": r.choice((Source.LENGTH, Source.LENGTH, Source.MARK)),
        "auto_start": r.random() < 0.7,
        "master.position": r.choice((0.0, 1.0, -1.0)) * 10.0 ** r.uniform(0.0, 12.0),
        "master.velocity": r.choice((0.0, 1.0, 1.0)) * 10.0 ** r.uniform(-6.0, 6.0),
        "master.input_mode": r.choice(list(MasterInput)),
        **{f"axis.max_{name}": 10.0 ** r.uniform(0.0, 12.0) for name in ("velocity", "acceleration", "jerk")},
    }
    if machine == "RotaryKnife":
        start["knife.circumference"] = circumference = 10.0 ** r.uniform(-3.0, 6.0)
        start["sync.before"], start["sync.after"] = (circumference * r.choice((0.0, 0.05, 0.1)) for _ in range(2))
        start["sync.mode"] = r.choice((1, 2))
    return start


@drawn(60, anew=True)
@given(st.integers(0, 2**32 - 1))
def test_no_scale_leads_to_an_error_or_to_endless_work(machine: str, seed: int) -> None:
    """Far positions, fine pitches, steep factors, and all commands: a step is made or refused, with a bounded number of
    operations, and what is cut has a length."""
    r = Random(seed)
    start = random_scale(r, machine)
    position, velocity = start["master.position"], start["master.velocity"]
    shares = {
        "start": 0.2,
        "stop": 0.02,
        "abort": 0.02,
        "reset": 0.3,
        "cut_now": 0.2,
        "mark.detected": 0.3,
        "hold": 0.05,
    }

    def steps() -> Iterator[tuple[float, dict[str, Any]]]:
        nonlocal position, velocity
        for _ in range(50):
            h = 10.0 ** r.uniform(-4.0, 0.0)
            position += velocity * h
            velocity *= r.choice((0.0, -0.1, 2.0)) if r.random() < 0.1 else 1.0
            latched = position - r.choice((0.0, -1.0, 1e3)) * r.random()
            values = {"master.position": position, "master.velocity": velocity, "mark.position": latched}
            yield h, values | {name: r.random() < share for name, share in shares.items()}

    cuts, stepped = 0, list[Any]()
    run = run_finite(BLOCKS[machine](), BlockRun(start, list(steps())))
    with suppress(StopIteration):
        while True:
            assert calls_of(lambda: stepped.append(next(run))) < 1_000_000
            block = stepped.pop()
            assert block.statistics.cuts == cuts or block.last.length > 0.0
            cuts = block.statistics.cuts


@drawn(40, anew=True)
@given(
    spacing=st.floats(1e-3, 1e6),
    window=st.floats(1e-6, 0.49),
    every=st.sampled_from([1, 2, 1000, INTEGER]),
    most=st.sampled_from([0, 3, 1000, INTEGER]),
    substitute=st.booleans(),
    position=st.one_of(st.floats(-1e12, 1e12), st.sampled_from([1e12, 1e9])),
)
def test_marks_cost_a_bounded_number_of_operations(
    machine: str, spacing: float, window: float, every: int, most: int, substitute: bool, position: float
) -> None:
    """A mark anywhere after a first one, and then a line that makes a jump of a thousand spacings."""
    start = {**MARKS, "mark.spacing": spacing, "mark.window": window * spacing, "mark.every": every}
    line = Line(
        machine,
        start | {"mark.max_missing": most, "mark.substitute": substitute, "mark.sensor_distance": 1e3 * spacing},
    )
    line.step(1e-3).mark(0.0)
    assert calls_of(lambda: line.mark(position)) < 100_000
    line.position += 1000.0 * spacing * min(every, 1000)
    assert calls_of(lambda: line.step(1e-3)) < 100_000
    assert 0 <= line["statistics.marks_missing"] <= INTEGER


@drawn(40, anew=True)
@given(st.floats(10.0, 500.0), st.floats(0.0, 0.4), st.floats(1.5, 8000.0), st.integers(0, 10000), st.booleans())
def test_missing_marks_are_counted(
    machine: str, spacing: float, window: float, spacings: float, most: int, substitute: bool
) -> None:
    """After a mark at 0 there should be one at each k q; it is missing when the master is beyond k q + w."""
    start = {**MARKS, "mark.spacing": spacing, "mark.window": window * spacing, "mark.max_missing": most}
    start |= {"mark.substitute": substitute, "mark.every": 200, "mark.sensor_distance": 9000.0 * spacing}
    line = Line(machine, start, 0.0).step(1e-3)
    line.mark(0.0)
    line.position = spacings * spacing
    missing = max(ceil(spacings - window) - 1, 0) if window > 0.0 else 0
    line.step(1e-3)
    assert line["statistics.marks_missing"] == min(missing, most + 1)
    assert line["error_id"] == (PieceFault.MARKS_MISSING if missing > most else PieceFault.NONE)
    if substitute and missing <= most:
        assert line["local.marks_waiting"] == 1 + missing // 200


@pytest.mark.parametrize("ahead", [10_001.0, 1e6, 1e9])
def test_a_mark_far_ahead_is_refused_and_the_next_one_is_taken(machine: str, ahead: float) -> None:
    """The limit is at 1e4 spacings of 50 between the master and the cut."""
    start = {**MARKS, "mark.spacing": 50.0, "mark.window": 5.0, "mark.max_missing": INTEGER, "mark.substitute": False}
    line = Line(machine, start).step(1e-3).mark(0.0)
    line.step(1e-3, mark__detected=True, mark__position=50.0 * ahead)
    assert line["local.mark_refusal"] == MarkRefusal.FAR
    line.step(1e-3, mark__detected=False)
    line.run((51.0 - line.position) / 600.0, 1e-3)
    line.mark(50.0)
    assert [line[f"statistics.marks{name}"] for name in ("", "_missing", "_refused")] == [2, 0, 1]


@drawn(20, anew=True)
@given(st.floats(2e-6, 1e-2), st.floats(1.0, 2000.0), st.sampled_from([1, 2, 3]))
def test_marks_that_are_too_close_do_not_stop_the_line(machine: str, apart: float, velocity: float, late: int) -> None:
    """On a creeping line; then it runs, in steps in which it travels more than 1e4 of their distance."""
    line = Line(machine, {**MARKS, "late_mode": late}, 0.01).step(1e-3)
    line.mark(0.0).mark(apart)
    line.velocity = velocity
    for _ in range(100):
        line.step(0.05)  # it would raise if the step were refused
    assert line["local.marks_waiting"] <= 2


@pytest.mark.parametrize(
    "counter", ["cuts", "pieces_good", "skipped", "late", "marks", "marks_missing", "marks_outside", "marks_refused"]
)
def test_a_counter_stays_at_its_largest_number(machine: str, counter: str) -> None:
    start = {**MARKS, "mark.spacing": 300.0, "mark.window": 10.0, "front_position": -100.0}
    line = Line(machine, start).step(1e-3)
    setattr(line.block.statistics, counter, INTEGER)
    for position in (0.0, 100.0, 300.0, 900.0, 1e9, 1200.0):
        line.run((min(position, 1100.0) - line.position) / 600.0, 1e-3)
        line.mark(position)
    line.run(4.0)
    assert line[f"statistics.{counter}"] == INTEGER


# --- no length --------------------------------------------------------------------------------------------------------


@drawn(25, anew=True)
@given(st.floats(-1e6, 1e-6), st.floats(-30.0, 30.0), st.floats(0.0, 10.0))
def test_the_reason_why_there_is_no_length_is_shown(
    machine: str, length: float, correction: float, kerf: float
) -> None:
    """The input length is none; that of an order does not suffice if the correction takes it away. With a length all is
    well."""
    line = Line(machine, {"auto_start": True, "length": length, "length_correction": correction, "kerf": kerf}, 100.0)
    line.step(1e-3)
    assert (line["local.no_length"], line["warning.no_length"]) == (NoLength.NOT_GIVEN, True)
    line.step(1e-3, order__add=True, order__length=20.0)
    has_length = 20.0 + correction + kerf > 1e-6
    assert line["warning.no_length"] != has_length
    assert line["local.no_length"] == (NoLength.NONE if has_length else NoLength.TOO_SHORT)
    line.step(1e-3, length=300.0, order__clear=True)
    assert (line["local.no_length"], line["warning.no_length"]) == (NoLength.NONE, False)
    line.step(1e-3, stop=True).run(20.0, 0.1)
    line.step(1e-3, length=length)
    assert (line["running"], line["local.no_length"]) == (False, NoLength.NONE)
