"""What the machine refuses, and what it does with parameters, inputs and answers that are invalid or never come.

Unless stated otherwise the machine is ROUND on a line of 1000 u/s, which is at m = 1000 t (`harness.py`)."""

import math
from typing import Any

import pytest

from motionsync.cut_to_length.block import CutToLength
from motionsync.cut_to_length.faults import Fault, Refusal
from motionsync.cut_to_length.interface import State, ToolMode
from motionsync.cutting.faults import PieceFault
from motionsync.cutting.interface import LateMode, PieceKind, StartMode
from motionsync_fmu.interface.stepper import RefusedError
from motionsync_fmu.interface.variables import variables
from tests.model.cut_to_length.harness import (
    HOME_AGAIN,
    JUST,
    CutToLengthHarness,
    each,
    idle_machine,
    near,
    started_machine,
)
from tests.model.cut_to_length.machine_results import GREATEST_VELOCITIES


def cell_values(saw: CutToLengthHarness) -> dict[str, str]:
    """Every cell of the block but the master's inputs, to the last bit."""
    inputs = ("master.position", "master.velocity", "master.acceleration")
    return {name: repr(cell.get()) for name, cell in saw.stepper.cells.items() if name not in inputs}


# --- refused calls ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "refusal"),
    [
        ({"home_position": -251.0, "axis.initial_position": 0.0}, Refusal.HOME),
        ({"home_position": 651.0}, Refusal.HOME),
        ({"home_position": 650.0}, Refusal.NONE),
        ({"axis.initial_position": -250.1}, Refusal.INITIAL_POSITION),
        ({"axis.initial_position": 650.1}, Refusal.INITIAL_POSITION),
        ({"axis.initial_position": -250.0}, Refusal.NONE),
        ({"mark.spacing": 100.0, "mark.window": 50.0}, Refusal.WINDOW),
        ({"mark.spacing": 100.0, "mark.window": 49.9}, Refusal.NONE),
        ({"mark.spacing": 0.0, "mark.window": 49.9}, Refusal.NONE),
        ({"master.period": 1.0, "master.position": 2e15}, Refusal.MASTER_TURNS),
    ],
)
def test_start_values_that_contradict_one_another(values: dict[str, Any], refusal: Refusal) -> None:
    ends = {"axis.min_position": -250.0, "axis.max_position": 650.0}
    block = CutToLength()
    by_name = {v.name: v for v in variables(block)}
    for name, value in {**ends, **values}.items():
        by_name[name].cell.set(value)
    assert block.initialize() == refusal
    assert set(refusal.names) <= set(by_name)


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"home_position": -251.0, "axis.min_position": -250.0}, "home_position"),
        ({"mark.spacing": 100.0, "mark.window": 50.0}, "mark.window"),
        ({"material_factor": 1e12, "calibration.factor": 1.5}, "material_factor"),
    ],
)
def test_tuned_values_that_contradict_one_another_are_named_and_a_start_refused(
    values: dict[str, Any], named: str
) -> None:
    saw = idle_machine().set(values).give("start").now()
    codes = next(v.declaration.codes for v in variables(CutToLength()) if v.name == "local.refused_parameter")
    assert codes is not None
    assert [code.description.split()[0] for code in codes if code == saw["local.refused_parameter"]] == [named]
    assert saw["local.refused_parameter"] > 1000
    assert (saw.state, saw["error_id"]) == (State.OFF, PieceFault.TUNABLE)


@pytest.mark.parametrize(
    ("name", "valid", "invalid"),
    [
        ("material_factor", [1e-6, 1e12], [0.0, -1.0, math.nan]),
        ("diagonal_angle", [-89.9, 0.0], [90.0, -90.0]),
        ("kerf", [0.0], [-1e-9, math.inf]),
        ("homing.slowest", [1.0, 1e-3], [0.0, 1.1]),
        ("line.margin", [0.0, 0.99], [1.0, -0.1]),
        ("sample_length", [1e-6], [0.0, -1.0]),
        ("gap.travel", [1.0], [0.0]),
        ("mark.every", [1], [0]),
        ("batch_size", [0], [-1]),
        ("axis.max_velocity", [1.0], [0.0]),
        ("homing.velocity", [0.0, 1.0], [-1.0]),
        ("source", [1, 2], [0, 3]),
        ("tool.mode", [1, 2, 3], [0, 4]),
        ("late_mode", [1, 2, 3], [0, 4]),
    ],
)
def test_the_limits_that_are_declared(name: str, valid: list[Any], invalid: list[Any]) -> None:
    allows = next(v.allows for v in variables(CutToLength()) if v.name == name)
    assert all(allows(x) for x in valid)
    assert not any(allows(x) for x in invalid)


@pytest.mark.parametrize("speed", [1e12, -1e12, 2e7])
def test_a_step_with_too_much_travel_is_refused_and_changes_nothing(speed: float) -> None:
    """More than 1e4 pieces of 1500 in 1 s."""
    saw = started_machine().at(1.0)
    before = cell_values(saw)
    present = saw.speed
    saw.speed = speed
    with pytest.raises(RefusedError) as refused:
        saw.run(1.0)
    assert refused.value.refusal == Refusal.TRAVEL
    assert cell_values(saw) == before
    saw.speed = present
    saw.at(2.0)
    assert saw["last.length"] == near(1500.0)


# --- refused commands -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("length", "quantity"), [(0.0, 1), (-1.0, 1), (1000.0, 0), (1000.0, -3)])
def test_an_order_needs_a_length_and_a_quantity(length: float, quantity: int) -> None:
    saw = idle_machine().order(length, quantity).now()
    assert (saw["error"], saw["error_id"], saw["order.waiting"]) == (True, PieceFault.ORDER, 0)


def test_the_65th_order_is_refused_and_64_stay() -> None:
    saw = idle_machine()
    for i in range(64):
        saw.order(1200.0 + i).now()
    assert (saw["order.waiting"], saw["error"]) == (64, False)
    saw.order(5000.0).now()
    assert (saw["order.waiting"], saw["error_id"]) == (64, PieceFault.ORDERS_FULL)
    saw.give("start").watched(4.0)
    assert saw.lengths() == each(1200.0, 1201.0, 1202.0)
    saw.order(5000.0).now()
    assert (saw["order.waiting"], saw["error_id"]) == (62, 0)


def test_the_last_refusal_is_shown_until_a_reset() -> None:
    saw = idle_machine().order(-1.0).now().give("cut_now").now()
    assert saw["error_id"] == PieceFault.CUT_NOW
    saw.run(0.1)
    assert saw["error_id"] == PieceFault.CUT_NOW
    saw.give("reset").now()
    assert (saw["error"], saw["error_id"]) == (False, 0)


def test_a_fault_goes_before_a_refusal() -> None:
    saw = started_machine({"tool.mode": ToolMode.FEEDBACK}).at(3.0)
    saw.give("cut_now").now()
    assert (saw.state, saw["error_id"]) == (State.FAULT, Fault.STROKE)


# --- tuned parameters -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("invalid", [-1.0, math.nan, math.inf, 2e12])
@pytest.mark.parametrize("name", ["kerf", "material_factor", "sample_length"])
def test_no_piece_is_fixed_with_an_invalid_parameter(name: str, invalid: float) -> None:
    """It becomes invalid during the cut: that piece ends as it was fixed. With a valid value again, the second is
    measured from where it began."""
    saw = idle_machine({"sample_length": 1200.0})
    valid = saw[name]
    saw.give("start").at(0.5).give("take_sample").at(1.7).set({name: invalid}).at(1.86)
    assert saw["last.length"] == near(1500.0)
    assert (saw["warning.no_length"], saw["next_cut.known"]) == (True, False)
    assert (saw["error"], saw["error_id"]) == (True, PieceFault.TUNABLE)
    saw.set({name: valid}).now()
    assert (saw["warning.no_length"], saw["next_cut.position"]) == (False, near(2700.0))


@pytest.mark.parametrize(
    ("name", "invalid"),
    [
        ("tool.cut_time", -1.0),
        ("tool.on_delay", math.nan),
        ("approach.distance", -1.0),
        ("approach.reserve", math.inf),
        ("home_position", 700.0),
        ("home_position", -251.0),
        ("axis.max_jerk", 0.0),
        ("homing.velocity", -1.0),
        ("gap.travel", 0.0),
    ],
)
def test_no_approach_begins_with_an_invalid_parameter(name: str, invalid: float) -> None:
    """The cycle under way ends with the values that it began with; meanwhile the cut at 3000 is missed."""
    saw = idle_machine()
    valid = saw[name]
    saw.give("start").at(1.5).set({name: invalid}).at(2.8)
    if not name.startswith(("homing", "axis")):
        assert saw["local.home_time"] == near(HOME_AGAIN)
    assert saw["last.length"] == near(1500.0)
    saw.at(2.95)
    assert (saw.state, saw["statistics.cuts"]) == (State.WAITING, 1)
    assert (saw["error"], saw["error_id"]) == (True, PieceFault.TUNABLE)
    assert saw["local.refused_parameter"] != 0
    saw.set({name: valid}).watched(5.0)
    assert (saw["last.kind"], saw["last.length"]) == (PieceKind.MERGED, near(3000.0))


# --- what never comes -------------------------------------------------------------------------------------------------


def test_a_tool_that_never_answers() -> None:
    """The cut starts at 1.6 and may last 0.3 s. The blade leaves within 0.04 s, in sync; then home from s = 440."""
    values: dict[str, Any] = {"tool.mode": ToolMode.FEEDBACK, "tool.timeout": 0.3, "tool.retract_time": 0.04}
    saw = started_machine(values).at(1.9 - JUST)
    assert (saw.state, saw["error"]) == (State.CUTTING, False)
    saw.at(1.9 + JUST)
    assert (saw.state, saw["error_id"], saw["running"]) == (State.FAULT, Fault.TOOL_TIMEOUT, False)
    assert (saw["tool.command"], saw["tool.blade_down"], saw["statistics.cuts"]) == (False, True, 0)
    assert saw["tool.command_time"] == near(1.9)
    assert (saw["line.stop_request"], saw["line.velocity_request"]) == (True, 0.0)
    saw.at(1.93)
    assert saw.slave == near(430.0, 1000.0, 0.0)
    saw.at(1.94 + 1e-3)
    assert (saw["tool.blade_down"], saw["statistics.unsynchronised"]) == (False, 0)
    saw.at(3.0)
    assert saw["local.home_time"] == near(1.94 + 0.5 + 215.0 / 1500.0)
    assert saw.slave == (0.0, 0.0, 0.0)
    assert saw.state == State.FAULT
    saw.give("reset").now().set({"start_mode": StartMode.CONTINUE}).give("start").now()
    assert saw["error_id"] == PieceFault.START


def test_without_a_timeout_the_tool_may_take_any_time() -> None:
    values: dict[str, Any] = {"tool.mode": ToolMode.FEEDBACK, "tool.timeout": 0.0, "axis.max_position": 1e9}
    saw = started_machine(values).at(100.0)
    assert (saw.state, saw["error"]) == (State.CUTTING, False)
    assert saw.slave == near(98500.0, 1000.0, 0.0)
    saw.give("tool.done").now()
    assert saw["last.length"] == near(1500.0)


@pytest.mark.parametrize("mode", list(LateMode))
def test_a_length_that_never_comes(mode: LateMode) -> None:
    saw = started_machine({"length": 0.0, "late_mode": mode}).at(50.0)
    assert (saw.state, saw["error"], saw["warning.no_length"]) == (State.WAITING, False, True)
    assert saw["limits.max_line_velocity"] == near(GREATEST_VELOCITIES[2000.0])
