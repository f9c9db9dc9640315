"""The laws of the Gearing: the two curves, the line, the places of a grid, the direction of a motion."""

from motionsync.gearing.curves import gear_in_curve, gear_out_curve
from motionsync.gearing.line import SynchronousLine, direction_of
from motionsync.numerics.grid import first_on_grid_ahead, nearest_on_grid


def test_the_curve_on_to_the_line_and_the_one_off_it() -> None:
    assert gear_in_curve(0.0, 8.0) == (0.0, 0.0, 0.0, 6.0 / 64.0)
    assert gear_in_curve(4.0, 8.0) == (0.75, 0.5, 1.5 / 8.0, 0.0)  # 8 (1/8 - 1/32), 3/4 - 1/4, 6 (1/2 - 1/4)
    assert gear_in_curve(8.0, 8.0) == (4.0, 1.0, 0.0, -6.0 / 64.0)
    assert gear_out_curve(0.0, 8.0) == (0.0, 1.0, 0.0, -6.0 / 64.0)
    assert gear_out_curve(4.0, 8.0) == (3.25, 0.5, -1.5 / 8.0, 0.0)
    assert gear_out_curve(8.0, 8.0) == (4.0, 0.0, 0.0, 6.0 / 64.0)
    assert gear_in_curve(9.0, 8.0)[0] == gear_out_curve(9.0, 8.0)[0] == 4.0
    assert gear_in_curve(-1.0, 8.0)[0] == gear_out_curve(-1.0, 8.0)[0] == 0.0


def test_the_line_reckons_numerator_first() -> None:
    line = SynchronousLine(7, -3, 1.0, 100.0)
    assert line.at(1.3) == 100.0 + 7 * (1.3 - 1.0) / -3
    assert line.to_master(line.to_slave(6.0)) == 6.0


def test_places_on_a_grid() -> None:
    assert [first_on_grid_ahead(1.0, 10.0, 1.0, x, True) for x in (1.0, 1.1, 11.0, -8.9)] == [1.0, 11.0, 11.0, 1.0]
    assert [first_on_grid_ahead(1.0, 10.0, -1.0, x, True) for x in (1.0, 0.9, 11.0, -8.9)] == [1.0, -9.0, 11.0, -9.0]
    assert [first_on_grid_ahead(1.0, 10.0, direction, 1.0, False) for direction in (1.0, -1.0)] == [11.0, -9.0]
    assert first_on_grid_ahead(1.0, 0.0, 1.0, 5.0, True) == 1.0
    assert [nearest_on_grid(1.0, 10.0, x) for x in (5.9, 6.1, -4.1)] == [1.0, 11.0, -9.0]
    assert nearest_on_grid(1.0, 0.0, 99.0) == 1.0


def test_a_direction_is_that_of_the_velocity_or_at_standstill_of_the_acceleration() -> None:
    assert [direction_of(v, a) for v, a in [(2.0, -1.0), (-2.0, 1.0), (0.0, 1.0), (0.0, -1.0), (0.0, 0.0)]] == [
        *(1.0, -1.0, 1.0, -1.0, 0.0)
    ]
