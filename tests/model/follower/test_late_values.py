"""A value of a variable cycle that comes late is met by joining the running motion, if the limits allow it."""

import math
from itertools import pairwise
from typing import Any

import pytest

from motionsync.follower.cam_section import CamSection
from motionsync.follower.faults import Fault
from motionsync.follower.interface import State
from motionsync.quintic_peaks import QuinticPeaks
from tests.model.follower.harness import RECOVERING, near, parked, quintic


def test_a_late_value_is_met_from_the_way_home() -> None:
    """Home from 1200 to 1450; at 1300 the slave is at s, s', s'' of that quintic and has 300 to the meeting."""
    follower = parked(**RECOVERING).to(1300.0)
    before = follower.slave
    follower.set({"sync_master": 1600.0}).run(2.0**-20)
    assert (follower.state, follower.slave) == (State.M_FOLLOWING, near(*before, tolerance=1e-4))
    assert follower.missing == near(0.0, 300.0, 500.0, tolerance=1e-5)
    section = CamSection()
    section.set_quintic(0.0, 250.0, 250.0, 300.0, 1.0, 0.0, 400.0, 0.0)
    s, d1, d2, _ = section.at(100.0)
    u, t = 0.5, 300.0
    h = 0.5 * u * u * (1.0 - u) ** 3  # Hermite's function of the second derivative
    expected = quintic(t, s, d1, 500.0, 1.0, 150.0) + d2 * t * t * h
    assert follower.to(1450.0).position == near(expected % 400.0)
    assert follower.to(1700.0).slave == near(200.0, 100.0, 0.0)
    assert follower["cycle"] == 1


def test_a_late_value_is_met_from_the_park() -> None:
    follower = parked(**RECOVERING).to(2000.0).set({"sync_master": 2150.0}).to(2075.0)
    assert (follower.state, follower.position) == (State.M_FOLLOWING, near(quintic(150.0, 0.0, 0.0, 100.0, 1.0, 75.0)))
    assert follower.to(2200.0).slave == near(150.0, 100.0, 0.0)


def test_a_value_that_is_not_late_is_met_from_the_park_as_ever() -> None:
    follower = parked(**RECOVERING).to(2000.0).set({"sync_master": 2300.0}).to(2200.0)
    assert follower.position == near(18.75)


@pytest.mark.parametrize("values", [{"sync_assumed": True}, {"skip_next_cycle": True}])
def test_a_value_is_not_joined_while_it_would_not_be_carried_out(values: dict[str, Any]) -> None:
    follower = parked(**RECOVERING).to(2000.0).set({"sync_master": 2150.0, **values}).to(2075.0)
    assert (follower.state, follower.position) == (State.M_WAITING_NEXT_CYCLE, 0.0)


@pytest.mark.parametrize(
    ("limits", "joined"),
    [
        # from rest over 150 to 100 and d1 1: s' up to 1.024, s'' up to 0.0140
        ({"max_speed": 103.0}, True),
        ({"max_speed": 102.0}, False),
        ({"max_speed": 102.0, "check_speed": False}, True),
        ({"max_acceleration": 150.0}, True),
        ({"max_acceleration": 130.0}, False),
        ({"max_acceleration": 130.0, "check_acceleration": False}, True),
    ],
)
def test_a_late_value_is_met_within_the_limits_only(limits: dict[str, Any], joined: bool) -> None:
    positions = [quintic(150.0, 0.0, 0.0, 100.0, 1.0, i / 8.0) for i in range(1201)]
    ratios = [(after - before) * 8.0 for before, after in pairwise(positions)]
    assert 1.02 < max(ratios) < 1.03
    follower = parked(**RECOVERING).to(2000.0).set({"sync_master": 2150.0, **limits}).run(0.01)
    assert follower.state == (State.M_FOLLOWING if joined else State.M_WAITING_NEXT_CYCLE)
    assert follower.fault == Fault.NONE


def test_a_late_value_that_is_refused_on_the_way_home_is_saved_for_the_park() -> None:
    follower = parked(**RECOVERING).to(1300.0).set({"sync_master": 1700.0, "max_speed": 99.0}).run(0.01)
    assert follower.state == State.M_HOMING
    follower.set({"max_speed": 0.0})
    assert follower.to(1600.0).position == near(18.75)


@pytest.mark.parametrize(
    "values", [{"recover_late_sync": False}, {"stop_in_park": True}, {"slave_cycle": 0.0}, {"sync_master": 1290.0}]
)
def test_nothing_else_is_joined(values: dict[str, Any]) -> None:
    late = {"sync_master": values.pop("sync_master", 1600.0)}
    follower = parked(**{**RECOVERING, **values}).to(1300.0)
    before = follower.state
    assert follower.set(late).to(1400.0).state == (State.M_HOMING if before == State.M_DECEL else before)


def test_peaks_of_a_quintic() -> None:
    section, peaks = CamSection(), QuinticPeaks()
    section.set_quintic(0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0)  # 10 u^3 - 15 u^4 + 6 u^5
    peaks.measure(section.quintic)
    assert (peaks.d1, peaks.d2) == near(1.875 / 2.0, 10.0 / math.sqrt(3.0) / 4.0)
    section.set_quintic(0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.01, 0.0)  # nothing is left of a steeper one
    peaks.measure(section.quintic)
    assert (peaks.d1, peaks.d2) == near(0.01875 / 2.0, 0.1 / math.sqrt(3.0) / 4.0)
