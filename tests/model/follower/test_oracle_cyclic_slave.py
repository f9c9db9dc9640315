"""The Follower's oracle against numbers worked out by hand: a cyclic slave, a variable cycle, late values."""

import pytest

from tests.model.follower.oracle_cases import (
    CYCLIC,
    FOLLOWING,
    HOMING,
    NEXT_CYCLE,
    ON_AND_ON,
    RECOVER,
    SYNCHRONIZED,
    VARIABLE,
    WAITING,
    at,
    close,
    motion,
    named,
    shown,
    steady,
    to_go,
)
from tests.oracle.follower import reference

# --- a cyclic slave ---------------------------------------------------------------------------------------------------


def test_a_cyclic_slave_with_travel_to_spare() -> None:
    """M_h = 250 from 300 to 400 = 0: u = 1/2 gives 2.5/2 - 5/8 + 5/16 - 1.5/32 = 57/64."""
    given = steady(**CYCLIC)
    assert named(given, "homing", "following") == [close(x) for x in (3.0, 7.0, 13.0, 17.0, 23.0, 27.0)]
    assert shown(given, 8.25) == (HOMING, 389.0625)
    assert shown(given, 10.0) == (WAITING, 0.0)
    assert shown(given, 14.0) == (FOLLOWING, 18.75)
    assert shown(given, 16.0) == (SYNCHRONIZED, 200.0)


@pytest.mark.parametrize(("cycle", "wait"), [(500.0, 0.0), (620.0, 120.0)])
def test_a_cyclic_slave_short_of_travel(cycle: float, wait: float) -> None:
    """R = 300: 150 each way; the first way in has 200. The quintics with r = 1.5: 47/64 of the way at the middle."""
    given = steady(master_cycle=cycle, space_wait_in_park=wait, **CYCLIC)
    assert named(given, "following")[0] == close(3.0)
    assert motion(at(given, 4.0))[0] == close(18.75)
    assert shown(given, 7.75) == (HOMING, 373.4375)
    assert named(given, "at park")[1] == close(8.5)
    start = 8.5 + wait / 100
    assert named(given, "following")[1] == close(start)
    assert shown(given, start + 0.75) == (FOLLOWING, 26.5625)
    before = reference(given, [start + 1.5])[0]
    assert motion(before) == (close(100.0), close(100.0), close(0.0))


def test_after_a_skipped_start_the_way_in_stays_short() -> None:
    given = steady(
        {"at": 8.0, "skip_next_cycle": True}, {"at": 9.0, "skip_next_cycle": False}, master_cycle=500, **CYCLIC
    )
    assert named(given, "start skipped") == [close(8.5)]
    assert named(given, "following")[1] == close(13.5)
    assert shown(given, 14.25) == (FOLLOWING, 26.5625)


def test_synchronism_ended_early_gives_a_cyclic_slave_travel() -> None:
    """At 600: R = 400, L + S_h = 100 + 200: M_f = 400/3."""
    given = steady({"at": 6.0, "end_synchronism": True}, master_cycle=500.0, **CYCLIC)
    assert named(given, "at park")[1] == close(6 + 8 / 3)
    assert named(given, "following")[1] == close(10 - 4 / 3)


def test_without_stop_in_park_a_slave_with_travel_to_spare_rests_in_between() -> None:
    """S = 200, M = 800: 200 down to 400, rest to 1300, 200 up."""
    given = steady(**ON_AND_ON)
    assert shown(given, 8.0) == (FOLLOWING, 381.25)
    row = at(given, 10.0)
    assert (row["state"], *motion(row)) == (FOLLOWING, 0.0, 0.0, 0.0)
    assert shown(given, 14.0) == (FOLLOWING, 18.75)
    assert named(given, "synchronized") == [close(5.0), close(15.0), close(25.0)]
    assert to_go(at(given, 10.0)) == [0.0, close(500.0), close(700.0)]
    before, after = reference(given, [9.0])
    assert (before["slave.jerk"], after["slave.jerk"]) == (close(150.0), 0.0)


def test_without_stop_in_park_a_slave_short_of_travel_goes_through() -> None:
    """r = 1.5: at a quarter 1.5/4 - 5/64 + 7.5/256 - 3/1024 of 200; at the middle slope 0.375."""
    given = steady(master_cycle=500.0, **ON_AND_ON)
    assert shown(given, 7.75) == (FOLLOWING, 300 + 64.6484375)
    before, after = reference(given, [8.5])
    assert (before["slave.position"], after["slave.position"]) == (400.0, 0.0)
    assert after["slave.velocity"] == close(37.5)
    assert motion(reference(given, [10.0])[0]) == (close(100.0), close(100.0), close(0.0))
    assert at(given, 13.0)["cycle"] == 2.0


@pytest.mark.parametrize(("cycle", "slave"), [(600.0, 300 + 81.25), (599.999, 300 + 79.296875)])
def test_at_twice_the_slaves_travel_the_shape_changes(cycle: float, slave: float) -> None:
    """M = 400, S = 200: two ramps, 13/32 of 200 at their first middle; the quintic with r = 2 has 203/512 there."""
    given = steady(master_cycle=cycle, **ON_AND_ON)
    assert at(given, 8.0)["slave.position"] == close(slave, 1e-6)


def test_skipped_at_sync_out_the_slave_goes_to_park() -> None:
    """As with stop in park: 150 home, start at 850, where it is read again."""
    sets = {"at": 6.0, "sync_assumed": True}, {"at": 8.0, "sync_assumed": False}
    given = steady(*sets, master_cycle=500.0, **ON_AND_ON)
    assert shown(given, 7.75) == (HOMING, 373.4375)
    assert named(given, "following")[1] == close(8.5)
    assert shown(given, 9.25) == (FOLLOWING, 26.5625)
    held = steady({"at": 6.0, "skip_next_cycle": True}, master_cycle=500.0, **ON_AND_ON)
    assert named(held, "start skipped")[:2] == [close(8.5), close(13.5)]
    assert at(held, 9.0)["state"] == NEXT_CYCLE


def test_no_travel_for_the_next_meeting_without_stop() -> None:
    """Set to 690 for a cycle of 350: 690 is from 500 + 175 on, but not behind 700."""
    given = steady({"at": 6.0, "sync_master": 690.0}, master_cycle=350.0, **ON_AND_ON)
    assert named(given, "alarm 5") == [close(7.0)]


# --- a variable cycle -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("set_at", [3.5, 5.0, 6.99])
def test_a_value_in_time_is_the_next_meeting(set_at: float) -> None:
    given = steady({"at": 3.2, "sync_master": 1900.0}, {"at": set_at, "sync_master": 1600.0}, **VARIABLE)
    assert named(given, "at park")[1] == close(14.0)
    assert named(given, "following") == [close(3.0), close(14.0)]
    assert to_go(at(given, 8.0)) == [close(600.0), close(800.0), close(1000.0)]
    assert shown(given, 16.5) == (SYNCHRONIZED, 150.0)


def test_without_a_value_the_slave_goes_to_park_as_if_it_were_one_cycle_later() -> None:
    given = steady(**VARIABLE)
    assert named(given, "at park")[1] == close(13.0)
    assert at(given, 20.0)["state"] == WAITING
    assert to_go(at(given, 8.0)) == [0.0, 0.0, 0.0]
    assert to_go(at(given, 20.0)) == [0.0, 0.0, 0.0]
    assert len(named(given, "following")) == 1


def test_a_value_too_near_is_lost() -> None:
    given = steady({"at": 6.0, "sync_master": 1499.0}, space_wait_in_park=50.0, **VARIABLE)
    assert named(given, "at park")[1] == close(12.5)
    assert at(given, 14.0)["state"] == WAITING
    assert len(named(given, "following")) == 1
    exact = steady({"at": 6.0, "sync_master": 1500.0}, **VARIABLE)
    assert named(exact, "following")[1] == close(13.0)


def test_a_value_in_decel_is_saved_for_park() -> None:
    given = steady({"at": 7.5, "sync_master": 1700.0}, **VARIABLE)
    assert named(given, "at park")[1] == close(13.0)
    assert named(given, "following")[1] == close(15.0)
    assert to_go(at(given, 8.0)) == [close(700.0), close(900.0), close(1100.0)]


def test_a_value_in_homing_that_is_less_than_a_cycle_ahead_is_lost_at_park() -> None:
    given = steady({"at": 10.0, "sync_master": 1450.0}, **VARIABLE)
    assert named(given, "value too soon") == [close(13.0)]
    assert [at(given, t)["state"] for t in (13.5, 22.4, 22.6)] == [WAITING, WAITING, WAITING]


def test_values_at_park() -> None:
    """At 1350: 1600 is in time, 1500 is not."""
    assert named(steady({"at": 13.5, "sync_master": 1600.0}, **VARIABLE), "following")[1] == close(14.0)
    late = steady({"at": 13.5, "sync_master": 1500.0}, **VARIABLE)
    assert named(late, "start missed") == [close(13.5)]
    assert [at(late, t)["state"] for t in (13.4, 13.6, 22.9, 23.1)] == [WAITING, NEXT_CYCLE, NEXT_CYCLE, WAITING]
    again = steady({"at": 13.5, "sync_master": 1500.0}, {"at": 14.0, "sync_master": 1800.0}, **VARIABLE)
    assert named(again, "following")[1] == close(16.0)


def test_a_value_set_again_is_not_new() -> None:
    given = steady({"at": 6.0, "sync_master": 500.0}, **VARIABLE)
    assert len(named(given, "following")) == 1


def test_a_skipped_start_uses_the_value_up() -> None:
    given = steady({"at": 1.0, "skip_next_cycle": True}, {"at": 4.0, "skip_next_cycle": False}, **VARIABLE)
    assert named(given, "start skipped") == [close(3.0)]
    assert [at(given, t)["state"] for t in (3.1, 12.9, 13.1)] == [NEXT_CYCLE, NEXT_CYCLE, WAITING]
    assert named(given, "following") == []


def test_a_period_gives_the_first_occurrence_ahead() -> None:
    """Period 1500: at 1600 the value 300 is 1800; 2000 at the start is 500, the master being at 0."""
    given = steady({"at": 6.0, "sync_master": 300.0}, sync_master=2000.0, master__period=1500.0, **VARIABLE)
    assert named(given, "synchronized") == [close(5.0), close(18.0)]
    late = steady({"at": 15.5, "sync_master": 1550.0 - 1500.0}, master__period=1500.0, **VARIABLE)
    assert named(late, "start missed") == [close(15.5)]


def test_a_cyclic_slave_without_stop_and_without_a_value() -> None:
    """To park over 250; a value in homing is held; the way in is 2L/k."""
    given = steady({"at": 8.0, "sync_master": 1600.0}, **ON_AND_ON, **VARIABLE)
    assert shown(given, 8.25) == (HOMING, 389.0625)
    assert named(given, "following")[1] == close(14.0)
    given_early = steady({"at": 6.0, "sync_master": 1600.0}, **ON_AND_ON, **VARIABLE)
    assert shown(given_early, 8.0) == (FOLLOWING, 381.25)
    assert named(given_early, "synchronized")[1] == close(16.0)


# --- recovery ---------------------------------------------------------------------------------------------------------


def test_recovery_in_homing() -> None:
    """At 800, u = 0.4 of 250: 379.264, slope 0.4752, curvature -0.006912. To (500, 1, 0) at 1150; the middle of a
    quintic is at (s0 + s1)/2 + 5M/32·(s0' - s1') + M²/64·(s0'' + s1'')."""
    given = steady({"at": 8.0, "sync_master": 1150.0}, master_cycle=650.0, **RECOVER)
    before, after = at(given, 8.0), at(given, 8.0 + 1e-7)
    assert motion(before) == (close(379.264), close(47.52), close(-69.12))
    assert (before["state"], after["state"]) == (HOMING, FOLLOWING)
    assert motion(after) == tuple(pytest.approx(x, rel=1e-5) for x in motion(before))
    middle = (379.264 + 500) / 2 + 5 * 350 / 32 * (0.4752 - 1) + 350**2 / 64 * -0.006912
    assert shown(given, 9.75) == (FOLLOWING, close(middle))
    assert motion(reference(given, [11.5])[0]) == (close(100.0), close(100.0), close(0.0))
    assert named(given, "decel", "synchronized")[1] == close(11.5)
    assert to_go(at(given, 9.0)) == [0.0, close(250.0), close(450.0)]


@pytest.mark.parametrize("set_at", [6.0, 7.5, 9.0, 9.6, 10.8])
@pytest.mark.parametrize(("meeting", "is_met"), [(1150.0, True), (1149.0, False), (900.0, False)])
def test_a_value_counts_late_if_it_counts_in_time(meeting: float, is_met: bool, set_at: float) -> None:
    """In M_SYNCHRONIZED, twice in M_HOMING, and at park; the meeting before is at 500, C is 650."""
    given = steady({"at": set_at, "sync_master": meeting}, master_cycle=650.0, **RECOVER)
    assert named(given, "synchronized")[1:] == ([close(meeting / 100)] if is_met else [])


@pytest.mark.parametrize("checked", [True, False])
def test_recovery_keeps_the_limits(checked: bool) -> None:
    """Its slope goes up to 1; refused it is held, and is in time at park."""
    limit, none = {"at": 8.9, "max_speed": 50.0}, {"at": 9.2, "max_speed": 0.0}
    value = {"at": 9.0, "sync_master": 1250.0}
    given = steady(limit, value, none, master_cycle=650.0, check_speed=checked, **RECOVER)
    assert named(given, "recovery refused") == ([close(9.0)] if checked else [])
    assert named(given, "following")[1] == close(10.5 if checked else 9.0)


def test_recovery_and_the_acceleration() -> None:
    """From rest over 150: the limit is that of the quintic, found here by sampling."""
    value = {"at": 10.0, "sync_master": 1150.0}
    free = steady(value, master_cycle=650.0, **RECOVER)
    assert named(free, "recovered") == [close(10.0)]
    assert shown(free, 10.75) == (FOLLOWING, 26.5625)
    greatest = max(abs(at(free, 10.0 + i / 64)["slave.acceleration"]) for i in range(97))
    for limit, count in ((greatest * 1.01, 1), (greatest * 0.99, 0)):
        given = steady(value, {"at": 9.9, "max_acceleration": limit}, master_cycle=650.0, **RECOVER)
        assert len(named(given, "recovered")) == count


def test_recovery_at_park_only_where_the_start_is_late() -> None:
    given = steady({"at": 10.0, "sync_master": 1250.0}, master_cycle=650.0, **RECOVER)
    assert named(given, "recovered") == []
    assert named(given, "following")[1] == close(10.5)
    passed = steady({"at": 12.0, "sync_master": 1200.0}, master_cycle=650.0, **RECOVER)
    assert (named(passed, "recovered"), named(passed, "start missed")) == ([], [close(12.0)])
