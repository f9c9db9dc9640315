"""The Follower's oracle against numbers worked out by hand and the specification's closed forms."""

import random
from collections.abc import Callable
from typing import Any

import pytest

from tests.oracle.follower import events, reference
from tests.oracle.follower_cycle import (
    Cam,
    Values,
    Way,
    connection,
    deceleration,
    following,
    home_end,
    homing,
    way_to_park,
)
from tests.oracle.master import Number, mp

IN_ALARM, IDLE, POSITIONING, WAITING, NEXT_CYCLE, FOLLOWING = -1.0, 1.0, 2.0, 3.0, 4.0, 5.0
SYNCHRONIZED, DECEL, HOMING = 8.0, 9.0, 10.0

PARK = {"at": 0.5, "position_to_park": True}
CYCLIC = {"slave_cycle": 400.0}
ON_AND_ON = {"slave_cycle": 400.0, "stop_in_park": False}
VARIABLE = {"variable_cycle": True}
RECOVER = {**ON_AND_ON, **VARIABLE, "recover_late_sync": True}


def close(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=1e-12)


def scenario(
    segments: list[dict[str, float]], *sets: dict[str, Any], position: float = 0.0, **start: Any
) -> dict[str, Any]:
    """A scenario of the segments' length, in steps of 10 ms; names have `__` for a dot; the meeting is at 500."""
    dotted = {name.replace("__", "."): value for name, value in ({"sync_master": 500.0} | start).items()}
    return {
        "stop_time": sum(segment["duration"] for segment in segments),
        "step_size": 0.01,
        "start": dotted,
        "master": {"position": position, "velocity": segments[0].get("velocity", 0.0), "segments": segments},
        "set": [{name.replace("__", "."): value for name, value in table.items()} for table in sets],
    }


def steady(*sets: dict[str, Any], duration: float = 30.0, velocity: float = 100.0, **options: Any) -> dict[str, Any]:
    """Positioned to park at 0.5 s, the master at 100 u/s from 0: it is at 100·t."""
    return scenario([{"duration": duration, "velocity": velocity}], PARK, *sets, **options)


def at(given: dict[str, Any], time: float) -> dict[str, float]:
    """The row just after `time`."""
    return reference(given, [time])[-1]


def motion(row: dict[str, float]) -> tuple[float, float, float]:
    return row["slave.position"], row["slave.velocity"], row["slave.acceleration"]


def shown(given: dict[str, Any], time: float) -> tuple[float, Any]:
    row = at(given, time)
    return row["state"], close(row["slave.position"])


def named(given: dict[str, Any], *names: str) -> list[float]:
    return [time for time, event in events(given) if event in names]


def to_go(row: dict[str, float]) -> list[float]:
    return [row[f"master_to_{point}"] for point in ("start", "sync", "out")]


# --- the closed forms of the specification ----------------------------------------------------------------------------


def q(u: Number) -> Number:
    return u**3 - u**4 / 2


def numbers(chance: random.Random, slave_cycle: bool) -> Values:
    """Parameters with room, of a cyclic slave sometimes just about."""
    park, lift, run, stop, k = (mp.mpf(chance.uniform(0.1, 10)) for _ in range(5))
    sync, wait = park + lift, mp.mpf(chance.uniform(0, 3))
    out, rest = sync + run, mp.mpf(chance.uniform(0.1, 30))
    needed = run / k + wait + (0 if slave_cycle else 2 * (lift + stop) / k)
    return Values(
        needed + rest, lift + run + stop if slave_cycle else 0 * k, park, sync, out, stop, wait, k, False, True
    )


def way(values: Values, old: Number) -> Way:
    return Way(values, old, old + values.cycle, True, old + values.run, values.out, values.k)


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
    decel, braking = deceleration(way(v, meeting)), 2 * v.space_stop / v.k
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
    room = v.cycle - v.run - v.wait

    def braked(u: Number, r: Number) -> Number:
        return r * u + (10 - 6 * r) * u**3 + (8 * r - 15) * u**4 + (6 - 3 * r) * u**5

    phase = way_to_park(way(v, meeting), mp.mpf(0))
    assert phase
    if room >= 2 * (lift + back) / v.k:
        ramp, travel = 2 * lift / v.k, min(room - 2 * lift / v.k, 2.5 * back / v.k)
        assert phase.reduced is None
        assert v.steady_ramp() is None
    else:
        ramp, travel = room * lift / (lift + back), room * back / (lift + back)
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
    phase = connection(way(v, meeting), mp.mpf(0))
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
    assert motion(before) == (close(0.0), close(0.0), close(0.0))
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


@pytest.mark.parametrize(("position", "start"), [(-1250.0, -700.0), (-700.0, -700.0), (-699.0, 300.0), (301.0, 1300.0)])
def test_the_first_meeting_is_the_first_whose_start_is_ahead(position: float, start: float) -> None:
    segments = [{"duration": 1.0, "velocity": 0.0}, {"duration": 15.0, "velocity": 100.0}]
    given = scenario(segments, PARK, position=position)
    time = 0.5 if start == position else 1 + (start - position) / 100
    assert named(given, "following")[0] == close(time)
    assert at(given, 0.75)["state"] == (FOLLOWING if start == position else WAITING)


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


# --- a cyclic slave ---------------------------------------------------------------------------------------------------


def test_a_cyclic_slave_with_room() -> None:
    """M_h = 250 from 300 to 400 = 0: u = 1/2 gives 2.5/2 - 5/8 + 5/16 - 1.5/32 = 57/64."""
    given = steady(**CYCLIC)
    assert named(given, "homing", "following") == [close(x) for x in (3.0, 7.0, 13.0, 17.0, 23.0, 27.0)]
    assert shown(given, 8.25) == (HOMING, 389.0625)
    assert shown(given, 10.0) == (WAITING, 0.0)
    assert shown(given, 14.0) == (FOLLOWING, 18.75)
    assert shown(given, 16.0) == (SYNCHRONIZED, 200.0)


@pytest.mark.parametrize(("cycle", "wait"), [(500.0, 0.0), (620.0, 120.0)])
def test_a_cyclic_slave_short_of_room(cycle: float, wait: float) -> None:
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


def test_synchronism_ended_early_gives_a_cyclic_slave_room() -> None:
    """At 600: R = 400, L + S_h = 100 + 200: M_f = 400/3."""
    given = steady({"at": 6.0, "end_synchronism": True}, master_cycle=500.0, **CYCLIC)
    assert named(given, "at park")[1] == close(6 + 8 / 3)
    assert named(given, "following")[1] == close(10 - 4 / 3)


def test_without_stop_in_park_a_slave_with_room_rests_in_between() -> None:
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


def test_without_stop_in_park_a_slave_short_of_room_goes_through() -> None:
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
    kept = steady({"at": 6.0, "skip_next_cycle": True}, master_cycle=500.0, **ON_AND_ON)
    assert named(kept, "start skipped")[:2] == [close(8.5), close(13.5)]
    assert at(kept, 9.0)["state"] == NEXT_CYCLE


def test_no_room_for_the_next_meeting_without_stop() -> None:
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


def test_a_value_in_decel_is_kept_for_park() -> None:
    given = steady({"at": 7.5, "sync_master": 1700.0}, **VARIABLE)
    assert named(given, "at park")[1] == close(13.0)
    assert named(given, "following")[1] == close(15.0)
    assert to_go(at(given, 8.0)) == [close(700.0), close(900.0), close(1100.0)]


def test_a_value_in_homing_that_is_late_at_park_is_missed() -> None:
    """1450 would have started at 1250; next cycle until 1450 + 1000 - 200."""
    given = steady({"at": 10.0, "sync_master": 1450.0}, **VARIABLE)
    assert named(given, "start missed") == [close(13.0)]
    assert [at(given, t)["state"] for t in (13.5, 22.4, 22.6)] == [NEXT_CYCLE, NEXT_CYCLE, WAITING]


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
    late = steady({"at": 13.5, "sync_master": 1350.0 - 1500.0}, master__period=1500.0, **VARIABLE)
    assert named(late, "start missed") == [close(13.5)]


def test_a_cyclic_slave_without_stop_and_without_a_value() -> None:
    """To park over 250; a value in homing is kept; the way in is 2L/k."""
    given = steady({"at": 8.0, "sync_master": 1600.0}, **ON_AND_ON, **VARIABLE)
    assert shown(given, 8.25) == (HOMING, 389.0625)
    assert named(given, "following")[1] == close(14.0)
    known = steady({"at": 6.0, "sync_master": 1600.0}, **ON_AND_ON, **VARIABLE)
    assert shown(known, 8.0) == (FOLLOWING, 381.25)
    assert named(known, "synchronized")[1] == close(16.0)


# --- recovery ---------------------------------------------------------------------------------------------------------


def test_recovery_in_homing() -> None:
    """At 800, u = 0.4 of 250: 379.264, slope 0.4752, curvature -0.006912. To (500, 1, 0) at 1100; the middle of a
    quintic is at (s0 + s1)/2 + 5M/32·(s0' - s1') + M²/64·(s0'' + s1'')."""
    given = steady({"at": 8.0, "sync_master": 1100.0}, **RECOVER)
    before, after = at(given, 8.0), at(given, 8.0 + 1e-7)
    assert motion(before) == (close(379.264), close(47.52), close(-69.12))
    assert (before["state"], after["state"]) == (HOMING, FOLLOWING)
    assert motion(after) == tuple(pytest.approx(x, rel=1e-5) for x in motion(before))
    middle = (379.264 + 500) / 2 + 5 * 300 / 32 * (0.4752 - 1) + 300**2 / 64 * -0.006912
    assert shown(given, 9.5) == (FOLLOWING, close(middle - 400))
    assert motion(reference(given, [11.0])[0]) == (close(100.0), close(100.0), close(0.0))
    assert named(given, "decel", "synchronized")[1] == close(11.0)
    assert to_go(at(given, 9.0)) == [0.0, close(200.0), close(400.0)]


@pytest.mark.parametrize("checked", [True, False])
def test_recovery_keeps_the_limits(checked: bool) -> None:
    """To 900: 120.736 over 100 is faster than 110; refused it is kept, and late at park: until 900 + 800."""
    given = steady({"at": 8.0, "sync_master": 900.0}, max_speed=110.0, check_speed=checked, **RECOVER)
    if checked:
        assert named(given, "recovery refused") == [close(8.0)]
        assert named(given, "start missed", "waiting") == [close(9.5), close(17.0)]
        assert at(given, 9.6)["state"] == NEXT_CYCLE
    else:
        assert named(given, "synchronized")[1] == close(9.0)


def test_recovery_and_the_acceleration() -> None:
    """From rest over 150: the limit is that of the quintic, found here by sampling."""
    value = {"at": 10.0, "sync_master": 1150.0}
    free = steady(value, **RECOVER)
    assert named(free, "recovered") == [close(10.0)]
    assert shown(free, 10.75) == (FOLLOWING, 26.5625)
    greatest = max(abs(at(free, 10.0 + i / 64)["slave.acceleration"]) for i in range(97))
    for limit, count in ((greatest * 1.01, 1), (greatest * 0.99, 0)):
        given = steady(value, {"at": 9.9, "max_acceleration": limit}, **RECOVER)
        assert len(named(given, "recovered")) == count


def test_recovery_at_park_only_where_the_start_is_late() -> None:
    given = steady({"at": 10.0, "sync_master": 1250.0}, **RECOVER)
    assert named(given, "recovered") == []
    assert named(given, "following")[1] == close(10.5)
    passed = steady({"at": 10.0, "sync_master": 1000.0}, **RECOVER)
    assert (named(passed, "recovered"), named(passed, "start missed")) == ([], [close(10.0)])


# --- positioning ------------------------------------------------------------------------------------------------------

STANDING = [{"duration": 5.0, "velocity": 0.0}, {"duration": 10.0, "velocity": 100.0}]


def test_positioning_to_park() -> None:
    """1000 with 500, 5000, 50000: 2 + 0.1 + 0.1 s."""
    given = scenario(STANDING, PARK, slave__initial_position=1000.0)
    assert shown(given, 0.5 + 1.1) == (POSITIONING, 500.0)
    assert motion(at(given, 1.6)) == (close(500.0), close(-500.0), close(0.0))
    assert named(given, "at park") == [close(2.7)]
    assert shown(given, 3.0) == (WAITING, 0.0)
    assert at(given, 0.55)["slave.jerk"] == -50000.0


@pytest.mark.parametrize(("start", "moved"), [(350.0, 50.0), (150.0, -150.0), (200.0, 200.0), (-30.0, 30.0)])
def test_a_cyclic_slave_goes_to_the_nearest_turn_of_park(start: float, moved: float) -> None:
    given = scenario(STANDING, PARK, slave__initial_position=start, **CYCLIC)
    assert at(given, 0.0)["slave.position"] == start % 400
    row = at(given, 0.52)
    assert row["slave.jerk"] * moved > 0
    assert shown(given, 4.0) == (WAITING, 0.0)


def test_a_slave_at_park_needs_no_limits() -> None:
    limits = {f"positioning__{name}": 0.0 for name in ("velocity", "acceleration", "jerk")}
    assert at(scenario(STANDING, PARK, **limits), 0.6)["state"] == WAITING
    refused = at(scenario(STANDING, PARK, slave__initial_position=1.0, **limits), 0.6)
    assert (refused["state"], refused["error_id"], refused["error"]) == (IDLE, 1.0, 1.0)


def test_positioning_needs_a_standstill() -> None:
    """In following it is refused, and reset clears the error; with the master at rest it is accepted."""
    sets = {"at": 4.0, "position_to_cycle": True}, {"at": 4.5, "reset": True}
    given = steady(*sets)
    assert [at(given, t)["error_id"] for t in (4.0, 4.1, 4.6)] == [0.0, 1.0, 0.0]
    assert at(given, 4.1)["state"] == FOLLOWING
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 5.0, "velocity": 0.0}]
    stopped = scenario(segments, PARK, {"at": 4.2, "position_to_park": False}, {"at": 4.5, "position_to_park": True})
    assert at(stopped, 4.51)["state"] == POSITIONING
    assert shown(stopped, 6.0) == (WAITING, 0.0)


@pytest.mark.parametrize(
    ("position", "state", "slave"),
    [
        (250.0, WAITING, 0.0),
        (300.0, FOLLOWING, 0.0),
        (400.0, FOLLOWING, 18.75),
        (600.0, SYNCHRONIZED, 200.0),
        (700.0, DECEL, 300.0),
        (800.0, DECEL, 381.25),
        (1000.0, HOMING, 358.59375),
        (1350.0 - 4 * 1100.0, WAITING, 0.0),
    ],
)
def test_positioning_to_the_cycle(position: float, state: float, slave: float) -> None:
    """With a wait of 100 and a cycle of 1100 the homing ends at 1300, the next start is 1400."""
    command = {"at": 0.5, "position_to_cycle": True}
    options = {"master_cycle": 1100.0, "space_wait_in_park": 100.0}
    given = scenario(STANDING, command, position=position, slave__initial_position=50.0, **options)
    assert at(given, 0.52)["state"] == POSITIONING
    assert shown(given, 4.0) == (state, close(slave))
    assert at(given, 4.0)["cycle"] == 0.0
    never_stopped = scenario([{"duration": 24.0, "velocity": 100.0}], PARK, **options)
    later = 11.0 + ((position + 100.0) / 100 % 11.0)
    assert at(given, 6.0)["slave.position"] == close(at(never_stopped, later)["slave.position"])


@pytest.mark.parametrize(
    ("position", "state", "slave", "options"),
    [
        (925.0, FOLLOWING, 26.5625, {}),
        (775.0, HOMING, 373.4375, {}),
        (600.0, SYNCHRONIZED, 200.0, {}),
        (775.0, FOLLOWING, 364.6484375, {"stop_in_park": False}),
        (700.0, FOLLOWING, 300.0, {"stop_in_park": False}),
        (500.0, SYNCHRONIZED, 100.0, {"stop_in_park": False}),
    ],
)
def test_positioning_a_cyclic_slave_to_the_cycle(
    position: float, state: float, slave: float, options: dict[str, Any]
) -> None:
    """C = 500, everywhere as in every cycle; from 50 below, over the nearest turn."""
    command = {"at": 0.5, "position_to_cycle": True}
    options = {"master_cycle": 500.0, "slave__initial_position": slave - 50 + 800.0} | CYCLIC | options
    given = scenario(STANDING, command, position=position, **options)
    assert at(given, 0.52)["slave.velocity"] > 0
    assert shown(given, 4.0) == (state, close(slave))
    assert at(given, 5.0 + (1200.5 - position) / 100)["cycle"] == 1.0 + (position < 700)


def test_positioning_to_a_variable_cycle() -> None:
    command = {"at": 0.5, "position_to_cycle": True}
    assert shown(scenario(STANDING, command, position=600.0, **VARIABLE), 4.0) == (SYNCHRONIZED, 200.0)
    waiting = scenario(STANDING, command, position=0.0, **VARIABLE)
    assert named(waiting, "following") == [close(8.0)]
    late = scenario(STANDING, command, position=1350.0, **VARIABLE)
    assert (at(late, 4.0)["state"], named(late, "following")) == (WAITING, [])


def test_a_variable_cycle_without_a_value() -> None:
    """The value's cycle is over at 1300; with the master standing at 1350 there is none."""
    segments = [{"duration": 13.5, "velocity": 100.0}, {"duration": 3.0, "velocity": 0.0}]
    given = scenario(segments, PARK, {"at": 14.0, "position_to_cycle": True}, **VARIABLE)
    row = at(given, 14.1)
    assert (row["state"], row["error_id"]) == (WAITING, 1.0)


def test_an_interrupted_cycle_is_taken_up_again() -> None:
    """Alarm in following at 400 (the master stops at once), positioned elsewhere, then back to the cycle."""
    segments = [{"duration": 4.0, "velocity": 100.0}, {"duration": 6.0, "velocity": 0.0}, {"duration": 8.0}]
    segments[2]["velocity"] = 100.0
    sets = [{"at": 3.5, "max_speed": 40.0}, {"at": 4.5, "max_speed": 0.0, "reset": True}]
    sets.append({"at": 6.0, "position_to_cycle": True})
    for options in ({}, VARIABLE):
        given = scenario(segments, PARK, *sets, **options)
        assert named(given, "alarm 6")[0] < 4.0
        assert (at(given, 4.2)["state"], at(given, 5.0)["state"]) == (IN_ALARM, IDLE)
        assert shown(given, 8.0) == (FOLLOWING, 18.75)
        assert named(given, "synchronized") == [close(11.0)]


@pytest.mark.parametrize("velocity", [1.0, -1.0])
def test_the_master_must_stand_during_positioning_to_the_cycle(velocity: float) -> None:
    """1e-6 u at 1 u/s: 1 us into the movement at 0.6 s, with the velocity reached by then: 250, 5000."""
    segments = [{"duration": 0.6, "velocity": 0.0}, {"duration": 2.0, "velocity": velocity}]
    command = {"at": 0.5, "position_to_cycle": True}
    given = scenario(segments, command, position=250.0, slave__initial_position=500.0)
    assert named(given, "alarm 2") == [close(0.6 + 1e-6)]
    row = at(given, 0.62)
    assert (row["state"], row["error_id"], row["slave.acceleration"]) == (IN_ALARM, 2.0, 5000.0)
    speed = 250 + 5000e-6
    assert motion(at(given, 1.0))[0] == pytest.approx(500 - 25 / 3 - 250e-6 - speed**2 / 1e4, abs=1e-6)
    assert motion(at(given, 1.0))[1:] == (0.0, 0.0)
    to_park = scenario(segments, PARK, position=250.0, slave__initial_position=500.0)
    assert at(to_park, 2.0)["state"] == WAITING


# --- alarms -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sets", "options", "fault", "state"),
    [
        ([], {"max_speed": 90.0}, 6, FOLLOWING),
        ([{"at": 6.0, "max_speed": 90.0}], {}, 7, SYNCHRONIZED),
        ([{"at": 7.5, "max_speed": 50.0}], {}, 8, DECEL),
        ([], {"max_speed": 150.0}, 9, HOMING),
        ([], {"max_acceleration": 70.0}, 10, FOLLOWING),
        ([{"at": 7.3, "max_acceleration": 50.0}], {}, 12, DECEL),
        ([], {"max_acceleration": 100.0}, 13, HOMING),
    ],
)
def test_limits_of_each_phase(sets: list[dict[str, Any]], options: dict[str, Any], fault: int, state: float) -> None:
    given = steady(*sets, **options)
    (time,) = named(given, f"alarm {fault}")
    before, after = reference(given, [time])
    assert (before["state"], after["state"], after["error_id"]) == (state, IN_ALARM, fault)
    assert motion(before) == motion(after)
    previous = reference(given, [time - 0.01])[0]
    column, limit = ("slave.velocity", "max_speed") if fault < 10 else ("slave.acceleration", "max_acceleration")
    limits = [x[limit] for x in [options, *sets] if limit in x]
    assert abs(after[column]) > limits[0]
    assert abs(previous[column]) <= limits[0] or sets
    off = {"check_speed": False, "check_acceleration": False}
    assert not any("alarm" in name for _, name in events(steady(*sets, **options | off)))


def test_the_acceleration_while_synchronized() -> None:
    segments = [{"duration": 5.5, "velocity": 100.0}, {"duration": 1.0, "acceleration": 60.0}]
    given = scenario(segments, PARK, {"at": 5.2, "max_acceleration": 50.0})
    assert named(given, "alarm 11") == [close(5.51)]


@pytest.mark.parametrize(("step", "time"), [(0.01, 4.61), (0.1, 4.7)])
def test_limits_are_judged_at_the_ends_of_the_steps(step: float, time: float) -> None:
    """3u² - 2u³ > 0.9 from u = 0.8042, at 4.6084 s; the stop ramp is linear, with 1000."""
    given = steady(max_speed=90.0, max_acceleration=1000.0) | {"step_size": step}
    assert named(given, "alarm 6") == [close(time)]
    u = (time - 3) / 2
    speed = 100 * (3 * u**2 - 2 * u**3)
    position = 200 * (u**3 - u**4 / 2)
    row = at(given, time)
    assert motion(row) == (close(position), close(speed), close(3 * u * (1 - u) / 100 * 1e4))
    row = at(given, time + 0.05)
    assert motion(row) == (close(position + 0.05 * speed - 1.25), close(speed - 50), -1000.0)
    assert row["slave.jerk"] == 0.0
    assert motion(at(given, time + 0.2)) == (close(position + speed**2 / 2000), 0.0, 0.0)
    assert to_go(row) == [0.0, 0.0, 0.0]


def test_a_limit_exactly_reached_is_kept() -> None:
    assert not any("alarm" in name for _, name in events(steady(max_speed=187.5)))


def test_both_limits_at_once_are_the_fault_of_the_speed() -> None:
    """In homing: at 10 s the speed is 105, the acceleration 141."""
    given = steady({"at": 10.0, "max_speed": 1.0, "max_acceleration": 1.0})
    assert at(given, 10.02)["error_id"] == 9.0


def test_reset() -> None:
    """Ignored while the stop ramp lasts (2 s with 50); then idle until a new positioning."""
    sets = {"at": 5.5, "max_speed": 90.0, "max_acceleration": 50.0}, {"at": 6.0, "reset": True}
    more = (
        {"at": 7.0, "reset": False, "position_to_park": False, "max_speed": 0.0, "max_acceleration": 0.0},
        {"at": 9.0, "reset": True},
    )
    last = {"at": 9.5, "position_to_park": True}, {"at": 8.5, "position_to_cycle": True}
    given = steady(*sets, *more, *last)
    assert named(given, "alarm 7", "stopped") == [close(5.51), close(7.51)]
    row = at(given, 8.0)
    assert (row["state"], row["error_id"], *motion(row)) == (IN_ALARM, 7.0, close(151.0 + 100.0), 0.0, 0.0)
    assert at(given, 8.9)["error_id"] == 7.0
    row = at(given, 9.2)
    assert (row["state"], row["error"], row["error_id"]) == (IDLE, 0.0, 0.0)
    assert at(given, 9.6)["state"] == POSITIONING
    assert named(given, "following") == [close(3.0), close(13.0), close(23.0)]


@pytest.mark.parametrize(
    ("jump", "time"), [({"velocity": -50.0}, 6.0 + 1e-6 / 50), ({"acceleration": -100.0}, 7.0 + (2e-8) ** 0.5)]
)
def test_the_master_must_not_go_back(jump: dict[str, float], time: float) -> None:
    """More than 1e-6 below the largest value, there at rest: 600; or 650 after one second of braking."""
    given = scenario([{"duration": 6.0, "velocity": 100.0}, {"duration": 3.0, **jump}], PARK)
    assert named(given, "alarm 14") == [pytest.approx(time, rel=1e-9)]
    row = at(given, 8.0)
    assert (row["state"], row["error_id"]) == (IN_ALARM, 14.0)
    assert motion(row) == (close(200.0 if "velocity" in jump else 250.0), 0.0, 0.0)


def test_a_little_back_is_no_fall() -> None:
    """0.9e-6 back and on again: the largest value is used."""
    segments = [{"duration": 6.0, "velocity": 100.0}, {"duration": 0.5, "velocity": -1.8e-6}]
    given = scenario([*segments, {"duration": 3.0, "velocity": 100.0}], PARK)
    assert not any("alarm" in name for _, name in events(given))
    assert motion(at(given, 6.3)) == (close(200.0), 0.0, 0.0)
    assert named(given, "decel") == [close(6.5 + (100 + 0.9e-6) / 100)]


def test_at_park_the_master_may_go_back() -> None:
    """From 290 back to -750, past the start at -700: that one is then the next."""
    segments = [{"duration": 2.9, "velocity": 100.0}, {"duration": 10.4, "velocity": -100.0}]
    given = scenario([*segments, {"duration": 5.0, "velocity": 100.0}], PARK)
    assert named(given, "following") == [close(13.8)]
    assert to_go(at(given, 5.0))[0] == close(220.0)
    assert to_go(at(given, 13.0))[0] == close(20.0)


# --- parameters -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "fault"),
    [
        ({"sync_slave": 0.0}, 3),
        ({"sync_out": 100.0}, 3),
        ({"slave_cycle": 300.0}, 3),
        ({"k_slave_master": 0.0}, 4),
        ({"k_slave_master": -1.0}, 4),
        ({"master_cycle": 600.0}, 5),
        ({"master_cycle": 1000.0, "space_wait_in_park": 400.0}, 5),
        ({"slave_cycle": 400.0, "master_cycle": 200.0}, 5),
        ({"slave_cycle": 400.0, "master_cycle": 300.0, "space_wait_in_park": 100.0}, 5),
    ],
)
def test_parameters_with_which_no_cycle_runs(options: dict[str, Any], fault: int) -> None:
    with pytest.raises(ValueError, match=f"fault {fault} "):
        events(steady(**options))


@pytest.mark.parametrize(
    ("values", "fault", "time"),
    [
        ({"sync_out": 90.0}, 3, 3.0),
        ({"k_slave_master": 0.0}, 4, 1.0),
        ({"master_cycle": 600.0}, 5, 3.0),
        ({"space_wait_in_park": 400.0}, 5, 3.0),
    ],
)
def test_parameters_are_judged_when_a_cycle_starts(values: dict[str, Any], fault: int, time: float) -> None:
    given = steady({"at": 1.0, **values})
    assert named(given, f"alarm {fault}") == [close(time)]
    assert motion(at(given, time + 0.1)) == (0.0, 0.0, 0.0)


def test_a_wrong_script_is_refused() -> None:
    with pytest.raises(ValueError, match="never an edge"):
        events(steady({"at": 0.0, "reset": True}))
    with pytest.raises(ValueError, match="slave_cycle cannot be set"):
        events(steady({"at": 1.0, "slave_cycle": 300.0}))
