"""What the Gearing refuses: commands, ratios, start values."""

from typing import Any

import pytest

from motionsync.gearing.block import Gearing
from motionsync.gearing.faults import Fault, Refusal
from motionsync.gearing.interface import StopMode
from motionsync_fmu.interface.variables import variables
from tests.model.gearing.harness import (
    ACTIVE,
    MASTER,
    NONE,
    STOPPED,
    TIME,
    WAITING_FOR_START,
    GearingHarness,
    in_gear,
)


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"gearing.denominator": 0, "gearing.numerator": 0}, Fault.DENOMINATOR),
        ({"gearing.numerator": 0, "gear_in.distance": -1.0}, Fault.NUMERATOR),
        ({"gear_in.transition": TIME, "gear_in.time": 0.0, "gear_in.distance": -1.0}, Fault.TIME),
        ({"gear_in.transition": TIME, "gear_in.time": float("nan")}, Fault.TIME),
        ({"gear_in.distance": -1.0}, Fault.DISTANCE),
        ({"gear_in.distance": float("nan")}, Fault.DISTANCE),
        ({"gear_in.start_mode": 8}, Fault.CHOICE),
        ({"gear_in.transition": 0}, Fault.CHOICE),
        ({"gear_in.time": 0.0, "gear_in.transition": MASTER, "gear_out.distance": -1.0}, Fault.NONE),
    ],
)
def test_gear_in_values_are_checked_at_the_rising_edge(values: dict[str, Any], fault: Fault) -> None:
    gear = GearingHarness(speed=10.0).set(values).start().run(1.0)
    assert gear.state == (WAITING_FOR_START if fault == Fault.NONE else STOPPED)
    assert (gear["error"], gear["error_id"]) == (fault != Fault.NONE, fault)
    gear.set({"reset": True}).run(1.0)
    assert gear["error_id"] == 0


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        ({"transition": TIME, "time": -1.0, "distance": -1.0}, Fault.TIME),
        ({"distance": -1.0}, Fault.DISTANCE),
        ({"stop_mode": 7}, Fault.CHOICE),
        ({"transition": TIME, "time": 1.0, "distance": -1.0}, Fault.DISTANCE),
    ],
)
def test_gear_out_values_are_checked_at_the_falling_edge(values: dict[str, Any], fault: Fault) -> None:
    gear = in_gear().stop(**values).run(1.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, fault)
    gear.start().run(1.0)
    assert (gear.state, gear["error_id"]) == (ACTIVE, fault)  # ignored
    gear.stop(transition=NONE, distance=0.0, stop_mode=StopMode.CW_CCW_DIRECT).run(1.0)
    assert (gear.state, gear["error_id"]) == (STOPPED, 0)


@pytest.mark.parametrize(
    ("values", "refusal"),
    [
        ({"gearing.denominator": 0}, Refusal.DENOMINATOR),
        ({"gearing.numerator": 0}, Refusal.NUMERATOR),
        ({"gear_in.transition": TIME, "gear_in.time": 0.0}, Refusal.GEAR_IN_TIME),
        ({"gear_out.transition": TIME, "gear_out.time": -1.0}, Refusal.GEAR_OUT_TIME),
        ({"gear_out.time": -1.0}, Refusal.NONE),
        ({"master.period": 1.0, "master.position": 2e15}, Refusal.MASTER_TURNS),
    ],
)
def test_bad_parameters_are_refused_at_the_initialization(values: dict[str, Any], refusal: Refusal) -> None:
    block = Gearing()
    by_name = {v.name: v for v in variables(block)}
    for name, value in values.items():
        by_name[name].cell.set(value)
    assert block.initialize() == refusal
    assert set(refusal.names) <= set(by_name)


@pytest.mark.parametrize(
    ("name", "accepted", "refused"),
    [
        ("gear_in.distance", [0.0, 1e-9, 1e12], [-1.0, 1e-10, float("nan"), 2e12]),
        ("gear_out.distance", [0.0, 1e-9, 1e12], [-1.0, 1e-10, float("nan"), 2e12]),
        ("slave.period", [0.0, 1e-9], [-1.0, 1e-10, float("inf")]),
        ("slave.initial_position", [-1e12], [2e12, float("nan")]),
        ("gear_in.time", [-1.0, 0.0, 1e12], [float("nan"), float("inf")]),
        ("gear_in.start_mode", [1, 7], [0, 8]),
        ("gear_out.stop_mode", [1, 6], [0, 7]),
        ("gear_in.transition", [1, 3], [0, 4]),
    ],
)
def test_the_limits_that_are_declared(name: str, accepted: list[Any], refused: list[Any]) -> None:
    allows = next(v.allows for v in variables(Gearing()) if v.name == name)
    assert all(allows(x) for x in accepted)
    assert not any(allows(x) for x in refused)


def test_each_fault_and_each_dependency_names_variables_of_the_block() -> None:
    names = {v.name for v in variables(Gearing())}
    assert all(set(fault.names) <= names for fault in Fault)
    dependent = {v.name: v.depends for v in variables(Gearing()) if v.depends and not v.name.startswith("master.")}
    start = ("slave.initial_position", "slave.period")
    assert dependent == {"slave.position": start, "local.line_offset": start}
