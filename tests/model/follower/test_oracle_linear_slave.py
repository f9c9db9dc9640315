"""The Follower's oracle against numbers worked out by hand: the closed forms of its phases, and a linear slave."""

import random
from collections.abc import Callable
from typing import Any

import pytest

from tests.model.follower.oracle_cases import (
    CYCLIC,
    DECEL,
    FOLLOWING,
    HOMING,
    IDLE,
    IN_ALARM,
    NEXT_CYCLE,
    PARK,
    SYNCHRONIZED,
    VARIABLE,
    WAITING,
    at,
    close,
    motion,
    named,
    scenario,
    shown,
    steady,
    to_go,
)
from tests.oracle import mp
from tests.oracle.follower import events, reference
from tests.oracle.follower_cycle import (
    Cam,
    SyncExit,
    Values,
    connection,
    deceleration,
    following,
    home_end,
    homing,
    way_to_park,
)
from tests.oracle.mp import Number

# --- the closed forms of the specification ----------------------------------------------------------------------------


def q(u: Number) -> Number:
    return u**3 - u**4 / 2


def numbers(chance: random.Random, slave_cycle: bool) -> Values:
    """Parameters with travel enough, of a cyclic slave sometimes just about."""
    park, lift, run, stop, k = (mp.mpf(chance.uniform(0.1, 10)) for _ in range(5))
    sync, wait = park + lift, mp.mpf(chance.uniform(0, 3))
    out, rest = sync + run, mp.mpf(chance.uniform(0.1, 30))
    needed = run / k + wait + (0 if slave_cycle else 2 * (lift + stop) / k)
    return Values(
        needed + rest, lift + run + stop if slave_cycle else 0 * k, park, sync, out, stop, wait, k, False, True
    )


def sync_exit(values: Values, meeting: Number) -> SyncExit:
    return SyncExit(values, meeting, meeting + values.cycle, True, meeting + values.run, values.out, values.k)


def agrees(law: Any, begin: Number, end: Number, form: Callable[[Number], Number]) -> None:
    """The law is `form` of u = 0 … 1 over begin … end."""
    assert isinstance(law, Cam)
    for i in range(11):
        u = mp.mpf(i) / 10
        assert abs(law.over(begin + u * (end - begin), mp.mpf("-1e-30"))[0] - form(u)) < 1e-35


@pytest.mark.parametrize("seed", range(20))
def test_linear_closed_forms(seed: int) -> None:
    chance = random.Random(seed)
    v = numbers(chance, False)
    assert not v.fault
    meeting, ramp = mp.mpf(chance.uniform(-50, 50)), 2 * (v.sync - v.park) / v.k
    start = (v.park, mp.mpf(0), mp.mpf(0))
    agrees(
        following(v, start, meeting - ramp, meeting, mp.mpf(0)).law,
        meeting - ramp,
        meeting,
        lambda u: v.park + v.k * ramp * q(u),
    )
    decel, braking = deceleration(sync_exit(v, meeting)), 2 * v.space_stop / v.k
    assert decel
    begin = meeting + v.run
    assert abs(decel.end - begin - braking) < 1e-40
    agrees(decel.law, begin, decel.end, lambda u: v.out + v.k * braking * (u - q(u)))
    home, stroke = homing(decel, decel.end, home_end(decel)), v.out + v.space_stop - v.park
    assert abs(home.end - (meeting + v.cycle - ramp - v.wait)) < 1e-40
    agrees(
        home.law,
        decel.end,
        home.end,
        lambda u: v.park + stroke * (1 - 10 * u**3 + 15 * u**4 - 6 * u**5),
    )


@pytest.mark.parametrize("seed", range(40))
def test_cyclic_closed_forms(seed: int) -> None:
    """Quintics with r = k·M/S; those of the way in are those of the way out, reversed."""
    chance = random.Random(seed)
    v = numbers(chance, True)
    assert not v.fault
    meeting = mp.mpf(chance.uniform(-50, 50))
    lift, back, begin = v.sync - v.park, v.park + v.slave_cycle - v.out, meeting + v.run
    available = v.cycle - v.run - v.wait

    def braked(u: Number, r: Number) -> Number:
        return r * u + (10 - 6 * r) * u**3 + (8 * r - 15) * u**4 + (6 - 3 * r) * u**5

    phase = way_to_park(sync_exit(v, meeting), mp.mpf(0))
    assert phase
    if available >= 2 * (lift + back) / v.k:
        ramp, travel = 2 * lift / v.k, min(available - 2 * lift / v.k, 2.5 * back / v.k)
        assert phase.reduced is None
        assert v.steady_ramp() is None
    else:
        ramp, travel = available * lift / (lift + back), available * back / (lift + back)
        assert phase.reduced == ramp == v.steady_ramp()
    assert abs(phase.ramp - ramp) < 1e-40
    agrees(phase.law, begin, begin + travel, lambda u: v.out + back * braked(u, v.k * travel / back))
    start = (v.park, mp.mpf(0), mp.mpf(0))
    agrees(
        following(v, start, -ramp, mp.mpf(0), mp.mpf(0)).law,
        -ramp,
        mp.mpf(0),
        lambda u: v.sync - lift * braked(1 - u, v.k * ramp / lift),
    )
    travel, space = v.cycle - v.run, v.sync + v.slave_cycle - v.out
    r = v.k * travel / space
    phase = connection(sync_exit(v, meeting), mp.mpf(0))
    assert phase
    if r < 2:
        agrees(
            phase.law,
            begin,
            begin + travel,
            lambda u: v.out + space * (r * u + (1 - r) * (10 * u**3 - 15 * u**4 + 6 * u**5)),
        )
    else:
        half, middle = space / v.k, v.out + space / 2
        agrees(phase.law, begin, begin + half, lambda u: v.out + v.k * half * (u - q(u)))
        agrees(phase.law, begin + half, begin + travel - half, lambda u: middle)
        agrees(phase.law, begin + travel - half, begin + travel, lambda u: middle + v.k * half * q(u))


def test_beyond_two_and_a_half_a_cyclic_slave_would_run_past_park() -> None:
    """The third derivative at rest is S/M³·(60 - 24 r): 0 at 2.5."""
    given = steady(**CYCLIC)
    before = reference(given, [9.5])[0]
    assert named(given, "at park")[1] == close(9.5)
    assert before["state"] == HOMING
    assert before["slave.position"] in (0.0, 400.0)  # both are park; rounding decides on which side it is
    assert motion(before)[1:] == (close(0.0), close(0.0))
    assert before["slave.jerk"] == close(0.0)


# --- a linear slave ---------------------------------------------------------------------------------------------------


def test_before_any_positioning_there_is_no_cycle() -> None:
    given = scenario([{"duration": 20.0, "velocity": 100.0}], slave__initial_position=70.0)
    assert events(given) == []
    row = at(given, 15.0)
    assert (row["state"], row["state_code"], *motion(row)) == (IDLE, IDLE, 70.0, 0.0, 0.0)
    assert to_go(row) == [0.0, 0.0, 0.0]


def test_a_linear_cycle() -> None:
    """M_f = 200 before 500, synchronized to 700, rest at 900, home at 1300 = the next start; q(1/2) = 3/32."""
    given = steady()
    assert [name for _, name in events(given)][2:7] == ["following", "synchronized", "decel", "homing", "at park"]
    assert named(given, "following") == [close(3.0), close(13.0), close(23.0)]
    assert named(given, "synchronized", "decel", "homing")[:3] == [close(5.0), close(7.0), close(9.0)]
    row = at(given, 4.0)
    assert (row["state"], row["cycle"], row["slave.jerk"]) == (FOLLOWING, 0.0, close(0.0))
    assert motion(row) == (close(18.75), close(50.0), close(75.0))
    assert motion(at(given, 6.0)) == (close(200.0), close(100.0), 0.0)
    row = at(given, 8.0)
    assert (row["state"], row["cycle"]) == (DECEL, 1.0)
    assert motion(row) == (close(381.25), close(50.0), close(-75.0))
    assert motion(at(given, 9.0)) == (close(400.0), close(0.0), close(0.0))
    row = at(given, 10.0)  # u = 1/4: 106/1024 of 400, 30·9/256, 60·u·(1-u)·(1-2u)
    assert row["state"] == HOMING
    assert motion(row) == (close(400 - 41.40625), close(-105.46875), close(-140.625))
    assert at(given, 18.0)["cycle"] == 2.0


def test_both_rows_of_a_change() -> None:
    before, after = reference(steady(), [3.0])
    assert (before["state"], after["state"]) == (WAITING, FOLLOWING)
    assert (before["slave.jerk"], after["slave.jerk"]) == (0.0, close(150.0))  # 6·100³/200²


def test_travel_to_go() -> None:
    given = steady()
    assert to_go(at(given, 1.0)) == [close(200.0), close(400.0), close(600.0)]
    assert to_go(at(given, 4.0)) == [0.0, close(100.0), close(300.0)]
    assert to_go(at(given, 6.0)) == [0.0, 0.0, close(100.0)]
    assert to_go(at(given, 8.0)) == [close(500.0), close(700.0), close(900.0)]
    assert to_go(at(given, 11.0)) == [close(200.0), close(400.0), close(600.0)]


def test_a_ratio_and_a_wait() -> None:
    """k = 2: 100 each for the ramps and the run; home at 1500 - 100 - 50."""
    given = steady(k_slave_master=2.0, space_wait_in_park=50.0)
    expected = {4.0: FOLLOWING, 5.0: SYNCHRONIZED, 6.0: DECEL, 7.0: HOMING, 13.5: WAITING, 14.0: FOLLOWING}
    for time, state in expected.items():
        assert at(given, time)["state"] == state
    assert motion(at(given, 4.5)) == (close(2 * 100 * 3 / 32), close(100.0), close(2 * 1.5 / 100 * 1e4))
    assert motion(at(given, 5.5)) == (close(200.0), close(200.0), 0.0)


def test_the_meeting_at_the_middle() -> None:
    given = steady(align_center=True)
    assert named(given, "synchronized")[0] == close(4.0)
    assert at(given, 5.0)["slave.position"] == close(200.0)


@pytest.mark.parametrize(
    ("position", "start", "state"),
    [
        (-1250.0, -700.0, WAITING),
        (-700.0, -700.0, FOLLOWING),
        (-699.0, 300.0, NEXT_CYCLE),
        (-501.0, 300.0, NEXT_CYCLE),
        (-500.0, 300.0, WAITING),
        (301.0, 1300.0, NEXT_CYCLE),
    ],
)
def test_the_first_meeting_is_the_first_whose_start_is_ahead(position: float, start: float, state: float) -> None:
    """Meetings are at 500 + n 1000, their starts 200 before: where the start to the one ahead has passed, it is too
    late for this cycle."""
    segments = [{"duration": 1.0, "velocity": 0.0}, {"duration": 15.0, "velocity": 100.0}]
    given = scenario(segments, PARK, position=position)
    time = 0.5 if start == position else 1 + (start - position) / 100
    assert named(given, "following")[0] == close(time)
    assert at(given, 0.75)["state"] == state


def test_the_master_stops_and_goes_on() -> None:
    """At 400 from 4 s to 6 s, with 200 u/s from there; the slave is where the master has it."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 2.0, "velocity": 0.0}, {"duration": 9.0}]
    segments[2]["velocity"] = 200.0
    given = scenario(segments, PARK)
    assert motion(at(given, 5.0)) == (close(18.75), 0.0, 0.0)
    before, after = reference(given, [4.0])
    assert (before["slave.velocity"], after["slave.velocity"]) == (close(50.0), 0.0)
    assert motion(at(given, 6.25)) == (
        close(200 * (27 / 64 - 81 / 512)),
        close(200 * 27 / 32),
        close(1.125 / 200 * 4e4),
    )
    assert named(given, "synchronized", "decel") == [close(6.5), close(7.5), close(11.5), close(12.5)]


def test_an_accelerating_master() -> None:
    """100 + 50·t from 300: at 400 its velocity is sqrt(2)·100; slope 1/2, curvature 1.5/200."""
    segments = [{"duration": 1.0, "velocity": 100.0}, {"duration": 5.0, "acceleration": 50.0}]
    given = scenario(segments, PARK, position=200.0)
    time = 1 + (2**0.5 - 1) * 2
    row = at(given, time)
    assert motion(row) == (close(18.75), close(50 * 2**0.5), close(150.0 + 25.0))
    assert row["slave.jerk"] == close(3 * 1.5 / 200 * 100 * 2**0.5 * 50)


def test_a_jump_over_several_phases_in_one_step_loses_nothing() -> None:
    given = steady(duration=1.2, velocity=10000.0) | {"step_size": 0.6}
    assert at(given, 1.05)["cycle"] == 5.0  # ends at 5700, 6700, … 9700; positioned at 5000
    assert motion(at(given, 1.05))[0] == close(at(steady(), 15.0)["slave.position"])


def test_a_skipped_start() -> None:
    """Skipped at 300: next cycle until 300 + 1000 - 100, then waiting; skipped again at 1300."""
    skip = {"at": 1.0, "skip_next_cycle": True}
    given = steady(skip, {"at": 14.0, "skip_next_cycle": False}, space_wait_in_park=100.0)
    assert named(given, "start skipped") == [close(3.0), close(13.0)]
    assert named(given, "waiting") == [close(12.0), close(22.0)]
    assert [at(given, t)["state"] for t in (2.9, 3.1, 11.9, 12.1, 13.1, 22.1)] == [3.0, 4.0, 4.0, 3.0, 4.0, 3.0]
    assert named(given, "following") == [close(23.0)]
    assert to_go(at(given, 4.0)) == [close(900.0), close(1100.0), close(1300.0)]
    assert at(given, 14.0)["cycle"] == 0.0


def test_an_assumed_meeting_is_not_carried_out() -> None:
    given = steady({"at": 1.0, "sync_assumed": True}, {"at": 5.0, "sync_assumed": False})
    assert named(given, "following")[0] == close(13.0)


def test_synchronism_ended_early() -> None:
    """At 600: 200 takes the place of 300; rest at 300 at 800; home at 1300; the next cycle is whole."""
    given = steady({"at": 6.0, "end_synchronism": True}, {"at": 6.5, "end_synchronism": False})
    before, after = at(given, 6.0), at(given, 6.0 + 1e-6)
    assert (before["state"], after["state"], after["cycle"]) == (SYNCHRONIZED, DECEL, 1.0)
    assert motion(at(given, 7.0)) == (close(281.25), close(50.0), close(-75.0))
    assert motion(at(given, 8.0))[0] == close(300.0)
    assert shown(given, 10.5) == (HOMING, 150.0)
    assert named(given, "following")[1] == close(13.0)
    assert motion(at(given, 16.5)) == (close(250.0), close(100.0), 0.0)


def test_synchronism_can_be_ended_only_while_it_lasts() -> None:
    given = steady({"at": 4.0, "end_synchronism": True})
    assert named(given, "decel")[0] == close(7.0)


def test_stop_after_forward() -> None:
    """Held from 900; released at 1000: 300 to the next start is less than 400, so home at 2300."""
    given = steady({"at": 6.0, "stop_after_forward": True}, {"at": 10.0, "stop_after_forward": False})
    assert named(given, "held") == [close(9.0)]
    row = at(given, 9.5)
    assert (row["state"], *motion(row)) == (DECEL, close(400.0), 0.0, 0.0)
    assert shown(given, 16.5) == (HOMING, 200.0)
    assert to_go(at(given, 10.5)) == [close(1250.0), close(1450.0), close(1650.0)]
    assert named(given, "following") == [close(3.0), close(23.0)]


@pytest.mark.parametrize(("release", "home"), [(8.0, 13.0), (9.0, 13.0), (18.99, 23.0 + 10), (19.0, 23.0)])
def test_released_in_time_the_slave_comes_home_as_ever(release: float, home: float) -> None:
    """Before 900 nothing is held; with exactly 400 left the next start is taken, with less the one after it."""
    sets = {"at": 6.0, "stop_after_forward": True}, {"at": release, "stop_after_forward": False}
    given = steady(*sets, duration=40.0)
    expected = 23.0 if release in (18.99, 19.0) else home
    assert named(given, "at park")[1] == close(expected)


def test_a_variable_cycle_comes_home_over_the_undisturbed_travel() -> None:
    sets = {"at": 6.0, "stop_after_forward": True}, {"at": 10.0, "stop_after_forward": False}
    given = steady(*sets, **VARIABLE)
    assert named(given, "at park")[1] == close(14.0)


@pytest.mark.parametrize(("value", "meeting"), [(600.0, 1600.0), (450.0, 1450.0), (-2000.0, 1000.0), (999.0, 1999.0)])
def test_a_changed_meeting_counts_from_sync_out_on(value: float, meeting: float) -> None:
    """The first occurrence from 500 + 500 on."""
    given = steady({"at": 5.5, "sync_master": value}, space_stop_slave=10.0)
    assert named(given, "synchronized")[1] == close(meeting / 100)
    assert named(given, "at park")[1] == close(meeting / 100 - 2)


def test_a_meeting_too_near_to_come_home_in_between() -> None:
    """1001: its start, 801, is before the end of the stroke, 900; the slave stops from 100 with 5000."""
    given = steady({"at": 5.5, "sync_master": 1.0})
    assert named(given, "alarm 5") == [close(7.0)]
    row = at(given, 7.01)
    assert (row["state"], row["error"], row["error_id"], row["cycle"]) == (IN_ALARM, 1.0, 5.0, 1.0)
    assert motion(row) == (close(300 + 1 - 0.25), close(50.0), -5000.0)
    assert motion(at(given, 8.0)) == (close(301.0), 0.0, 0.0)


def test_parameters_are_read_at_the_start_and_at_sync_out() -> None:
    """A sync_out of 400 set in following counts from the next start; a new braking space from sync_out on."""
    given = steady({"at": 4.0, "sync_out": 400.0}, {"at": 6.0, "space_stop_slave": 50.0})
    assert named(given, "decel", "homing") == [close(x) for x in (7.0, 8.0, 18.0, 19.0, 28.0, 29.0)]
    assert at(given, 8.0)["slave.position"] == close(350.0)


def test_a_meeting_changed_at_park() -> None:
    assert named(steady({"at": 2.0, "sync_master": 450.0}), "following")[0] == close(2.5)
    assert named(steady({"at": 2.0, "sync_master": 350.0}), "following")[0] == close(11.5)
