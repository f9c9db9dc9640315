"""A value of a variable cycle that comes late is met by joining the running motion, if the limits allow it."""

import math
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionsync.follower.cam_section import CamSection
from motionsync.follower.faults import DropReason, Fault
from motionsync.follower.interface import State
from motionsync.motion.quintic_peaks import QuinticPeaks
from tests.model.follower.harness import RECOVERING, FollowerHarness, near, parked, quintic
from tests.support.blocks.drawn import drawn


def test_a_late_value_is_met_from_the_way_home() -> None:
    """Home from 1200 to 1450; at 1300 the slave is at s, s', s'' of that quintic and has 350 to the meeting."""
    follower = parked(**RECOVERING, master_cycle=650.0).to(1300.0)
    before = follower.slave
    follower.set({"sync_master": 1650.0}).run(2.0**-20)
    assert (follower.state, follower.slave) == (State.M_FOLLOWING, near(*before, tolerance=1e-4))
    assert follower.missing == near(0.0, 350.0, 550.0, tolerance=1e-5)
    section = CamSection()
    section.set_quintic(0.0, 250.0, 250.0, 300.0, 1.0, 0.0, 400.0, 0.0)
    s, d1, d2, _ = section.at(100.0)
    u, t = 0.5, 350.0
    h = 0.5 * u * u * (1.0 - u) ** 3  # Hermite's function of the second derivative
    expected = quintic(t, s, d1, 500.0, 1.0, 175.0) + d2 * t * t * h
    assert follower.to(1475.0).position == near(expected % 400.0)
    assert follower.to(1750.0).slave == near(200.0, 100.0, 0.0)
    assert follower["cycle"] == 1


@pytest.mark.parametrize("speed", [100.0, 37.0])
@pytest.mark.parametrize(("meeting", "is_retained"), [(1150.0, True), (1299.0, True), (1301.0, False), (1999.0, False)])
def test_a_value_whose_meeting_has_passed_waits_up_to_the_park(meeting: float, is_retained: bool, speed: float) -> None:
    """There is nothing to join, so the value waits as without recover_late_sync; one that could be joined, were it not
    too soon, is dropped at once."""
    follower = parked(speed=speed, **RECOVERING).to(1300.0).set({"sync_master": meeting}).run(1e-3)
    reason = follower["local.drop_reason"]
    assert reason == (DropReason.NONE if is_retained else DropReason.TOO_SOON)
    assert (follower.to(1310.0).state, follower["local.meeting_known"]) == (State.M_HOMING, is_retained)
    assert follower["master_to_out"] == near(meeting + 200.0 - 1310.0 if is_retained else 0.0)
    assert (follower.to(1451.0).state, follower["local.meeting_known"]) == (State.M_WAITING, False)
    assert follower["local.drop_reason"] == (DropReason.TOO_SOON if is_retained else DropReason.NONE)


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
    follower = parked(**RECOVERING, master_cycle=650.0).to(1300.0)
    follower.set({"sync_master": 1700.0, "max_speed": 99.0}).run(0.01)
    assert (follower.state, follower["local.drop_reason"]) == (State.M_HOMING, DropReason.LIMITS)
    follower.set({"max_speed": 0.0})
    assert follower.to(1600.0).position == near(18.75)


@drawn(80)
@given(
    st.floats(0.3, 3.0),
    st.floats(0.3, 3.0),
    st.floats(0.3, 3.0),
    st.sampled_from([1.0, 0.25, 3.0]),
    st.floats(0.4, 2.2),
    st.floats(0.02, 0.98),
    st.floats(0.002, 0.9) | st.just(0.0),
    st.booleans(),
)
def test_what_is_valid_in_time_is_valid_late(
    to_sync: float,
    to_out: float,
    onwards: float,
    ratio: float,
    tightness: float,
    place: float,
    shift: float,
    is_later: bool,
) -> None:
    """A value whose meeting is `master_cycle` after the one before, or later, is met, whether it comes in the
    synchronized phase or on the way home; an earlier one is not. A late value is joined if the slave is then no faster
    than on the way to the earliest meeting; else it is met from the park. `tightness`: the slave's travel home and to
    the meeting over the master's that a cycle leaves."""
    available = (to_sync + onwards) / ratio / tightness
    cycle = available + to_out / ratio
    meeting = 2.0 * cycle * (1.0 if is_later else 1.0 - 0.5 * shift) + (shift * cycle if is_later else 0.0)
    is_valid = is_later or shift == 0.0
    values = {
        **RECOVERING,
        "slave_cycle": to_sync + to_out + onwards,
        "sync_slave": to_sync,
        "sync_out": to_sync + to_out,
        "k_slave_master": ratio,
        "master_cycle": cycle,
        "sync_master": cycle,
    }
    out = cycle + to_out / ratio
    begin = parked(-2.0 * to_sync / ratio, cycle, **values).to(cycle + 0.5 * to_out / ratio)
    in_time = begin.twin().set({"sync_master": meeting})
    late = begin.twin().to(out + 1e-6 * cycle)
    home = late.block.sequence.current.cam_section.end
    late.to(out + place * (home - out))
    assume(late.master_position < meeting - 1e-3 * cycle)
    earliest = late.twin().set({"sync_master": 2.0 * cycle})
    late.set({"sync_master": meeting}).run(1e-9)
    reason = late["local.drop_reason"]
    is_joined = late.state == State.M_FOLLOWING
    assert reason in ((DropReason.NONE, DropReason.TOO_FAST) if is_valid else (DropReason.TOO_SOON,))
    assert is_joined == (reason == DropReason.NONE)
    if is_joined:
        fastest = greatest_speed(earliest, 2.0 * cycle)
        assert greatest_speed(late.twin(), meeting) <= fastest * (1.0 + 1e-4)
    for follower in (in_time, late):
        follower.to(max(meeting, 2.0 * cycle) + 0.25 * to_out / ratio)
        assert (follower.state == State.M_SYNCHRONIZED) == is_valid
        assert follower["cycle"] == 1


def greatest_speed(follower: FollowerHarness, until: float) -> float:
    """Up to a position of the master."""
    begin, speeds = follower.master_position, [abs(follower.slave[1])]
    for i in range(200):
        speeds.append(abs(follower.to(begin + (i + 1) / 200.0 * (until - begin)).slave[1]))
    return max(speeds)


@pytest.mark.parametrize(
    "values", [{"recover_late_sync": False}, {"stop_in_park": True}, {"slave_cycle": 0.0}, {"sync_master": 1290.0}]
)
def test_nothing_else_is_joined(values: dict[str, Any]) -> None:
    late = {"sync_master": values.pop("sync_master", 1650.0)}
    cycle = 850.0 if values.get("slave_cycle") == 0.0 else 650.0
    follower = parked(**{**RECOVERING, "master_cycle": cycle, **values}).to(1300.0)
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
