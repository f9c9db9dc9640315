"""Factor, angle and direction of the coupling; a master with a period; its input modes."""

import math

import pytest

from motionsync.flying_saw.interface import State
from motionsync.master import MasterInput
from tests.model.flying_saw.harness import AIMS, FIRST, INSTANT, FlyingSawHarness, first_example, near
from tests.support.blocks.harness import grid

END, ONLY = MasterInput.END_OF_STEP, MasterInput.POSITION_ONLY


def test_the_factor_is_numerator_by_denominator_by_the_cosine_of_the_angle() -> None:
    saw = FlyingSawHarness({"diagonal_angle": 60.0}, speed=10.0).give(
        "gear_in_velo", ratio_numerator=-3.0, ratio_denominator=4
    )
    saw.run(2.0)
    assert saw["coupling_factor"] == near(-1.5, tolerance=1e-15)
    assert saw.slave[1:] == near(-15.0, 0.0)


@pytest.mark.parametrize("ratio", [0.8, -0.8])
@pytest.mark.parametrize("vm", [100.0, -100.0])
def test_in_sync_the_slave_is_on_its_line(ratio: float, vm: float) -> None:
    """The line passes through (2 v_m, ratio v_m + 3), however the master moves afterwards."""
    saw = FlyingSawHarness({"axis.initial_position": 3.0}, speed=vm)
    point = 2.0 * vm, ratio * 2.0 * vm * 0.5 + 3.0
    saw.give("gear_in_pos", ratio_numerator=ratio, master_sync_position=point[0], slave_sync_position=point[1])
    saw.run(2.5)
    for acceleration in (0.0, 40.0, -90.0, 250.0):
        saw.run(0.7, acceleration=acceleration)
        expected = point[1] + ratio * (saw.master_position - point[0])
        assert (saw.state, saw.slave) == (State.SYNCHRON, near(expected, ratio * saw.speed, ratio * acceleration))


@pytest.mark.parametrize(
    ("speed", "position", "ahead"),
    [
        *((10.0, 80.0, 50.0), (10.0, 20.0, 90.0), (10.0, 0.0, 70.0), (10.0, 30.0, 100.0)),
        *((-10.0, 20.0, 10.0), (-10.0, 80.0, 50.0), (-10.0, 0.0, 30.0), (-10.0, 30.0, 100.0)),
        *((10.0, 100.0, 70.0), (10.0, 230.0, 200.0), (-10.0, -30.0, 60.0), (-10.0, -270.0, 300.0)),
    ],
)
def test_with_a_period_a_sync_position_in_it_is_the_next_one_ahead_and_others_are_literal(
    speed: float, position: float, ahead: float
) -> None:
    """The master is at 30 of a period of 100; the slave starts at 0 and is to be in sync `ahead` further."""
    saw = FlyingSawHarness({"master.period": 100.0}, master_position=30.0, speed=speed)
    aims = {"master_sync_position": position, "slave_sync_position": 0.25 * math.copysign(ahead, speed)}
    saw.give("gear_in_pos", **aims).run(ahead / 10.0 - 1e-3)
    assert saw.state == State.SYNCHRONIZING
    saw.run(2e-3)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(0.25 * math.copysign(ahead, speed) + 1e-3 * speed, speed, 0.0)
    for _ in range(30):
        saw.run(1.7)
    whole = 51.0 + 1e-3
    assert saw.slave[0] == near(0.25 * math.copysign(ahead, speed) + whole * speed)  # never wrapped


@pytest.mark.parametrize(("speed", "position"), [(10.0, 130.0 - 100.0 * 2), (-10.0, 130.0)])
def test_with_a_period_a_literal_position_behind_is_refused(speed: float, position: float) -> None:
    saw = FlyingSawHarness({"master.period": 100.0}, master_position=30.0, speed=speed)
    saw.give("gear_in_pos", master_sync_position=position, slave_sync_position=math.copysign(9.0, speed))
    assert saw.run(INSTANT)["gear_in_pos.error_id"] == 0x42DE


def test_with_a_period_the_start_distance_may_be_longer_than_it() -> None:
    """The sync position is 90 in the master's present turn, so the start, 250 before it, is passed already."""
    saw = FlyingSawHarness({"master.period": 100.0}, master_position=30.0, speed=10.0)
    saw.give("gear_in_pos", master_sync_position=90.0, slave_sync_position=15.0, master_start_distance=250.0)
    assert saw.run(INSTANT).state == State.SYNCHRONIZING
    other = FlyingSawHarness({"master.period": 100.0}, master_position=30.0, speed=10.0)
    other.give("gear_in_pos", master_sync_position=20.0, slave_sync_position=15.0, master_start_distance=40.0)
    assert other.run(4.9).state == State.PREPHASE
    assert other.run(0.2).state == State.SYNCHRONIZING
    assert other.run(4.0).slave == near(15.0 + 1.0, 10.0, 0.0)


def test_with_a_period_the_coupling_position_is_a_place_not_one_of_every_turn() -> None:
    """The master goes two turns and a half back from 30 and forwards again: only 30 in the same turn counts."""
    saw = FlyingSawHarness({"master.period": 100.0}, master_position=30.0, speed=50.0).modes(
        "rollback_lock", "instant_stop_on_rollback"
    )
    saw.give("gear_in_velo").run(1.0)
    start = saw.slave[0] - 50.0
    saw.speed = -45.0
    for _ in range(8):
        saw.run(0.9)
    assert (saw.state, saw.master_position) == (State.PREPHASE, near(80.0 - 324.0))
    saw.speed = 45.0
    for _ in range(6):
        assert saw.run(1.0).state == State.PREPHASE
    assert saw.slave == near(start, 0.0, 0.0)
    saw.run(0.2)
    assert saw.state == State.SYNCHRON
    assert saw["local.coupling_position"] == near(30.0)


def test_the_input_correction_belongs_to_the_path() -> None:
    """The master was predicted at 999.5 and is at 1000.5: the input correction passes the sync position."""
    saw = first_example().give("gear_in_pos", **FIRST).run(2.999)
    assert saw.state == State.SYNCHRONIZING
    saw.master_position = 1000.5
    saw.release().give("gear_out").run(INSTANT)
    assert saw.slave == near(1000.5 + 500.0 * INSTANT, 500.0, 0.0)
    assert saw.results("gear_in_pos") >= {"command_aborted"}


def test_with_inputs_of_the_step_s_end_a_command_acts_with_the_master_of_the_call_before() -> None:
    saw = FlyingSawHarness(
        {"axis.initial_position": -250.0, "axis.initial_velocity": 250.0}, master_position=-500.0, speed=500.0, mode=END
    )
    saw.give("gear_in_pos", **FIRST).run(1.0)
    assert saw["characteristics.master_position_start"] == -500.0
    other = first_example().give("gear_in_pos", **FIRST).run(1.0)
    assert saw.slave == near(*other.slave)
    saw.run(1.0, acceleration=-30.0).run(2.0, acceleration=40.0)
    other.run(1.0, acceleration=-30.0).run(2.0, acceleration=40.0)
    assert saw.state == State.SYNCHRON
    assert saw.slave == near(*other.slave)


def test_with_positions_only_the_master_s_motion_is_estimated() -> None:
    saw = FlyingSawHarness(
        {"axis.initial_position": -250.0, "axis.initial_velocity": 250.0},
        master_position=-550.0,
        speed=500.0,
        mode=ONLY,
    )
    saw.set({"axis.initial_position": -275.0})
    assert saw.block.initialize() == 0
    saw.run(0.1, cuts=grid(0.1, 0.02))
    assert saw.slave == near(-250.0, 250.0, 0.0)
    saw.give("gear_in_pos", **FIRST).run(3.1, cuts=grid(3.1, 0.02))
    assert (saw.state, saw.slave) == (State.SYNCHRON, near(1050.0, 500.0, 0.0, tolerance=1e-8))
    assert saw["characteristics.slave_velocity_max"] == pytest.approx(506.0, abs=5e-3)


def test_with_positions_only_the_master_is_at_rest_at_first() -> None:
    saw = FlyingSawHarness(speed=100.0, mode=ONLY)
    assert saw.give("gear_in_pos", **AIMS).run(0.1)["gear_in_pos.error_id"] == 0x426E
    saw.release().run(0.1).run(0.1)
    assert saw.give("gear_in_pos", **AIMS).run(0.1)["gear_in_pos.error_id"] == 0
