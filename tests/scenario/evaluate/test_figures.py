"""The figures of a run, from recordings that are written by hand."""

from pathlib import Path

import numpy as np
import pytest

from motionsync_fmu.scenario.engineering import engineering, line_speed
from motionsync_fmu.scenario.evaluate.key_figures import KeyFigures, Peak, compute_key_figures
from motionsync_fmu.scenario.files.reader import load_scenario
from motionsync_fmu.scenario.recording import Recording

SAW = """\
title = "A saw"
source = "By hand"
fmu = "FlyingSaw"
stop_time = 4.0
step_size = 1.0

[start]
"axis.max_velocity" = 1000.0
"axis.max_acceleration" = 4000.0
"axis.max_deceleration" = 6000.0
"axis.max_jerk" = 50000.0
"axis.max_position" = 650.0

[master]
velocity = 500.0
"""
CUTS = '\n[cuts]\nwhile = "in_sync"\nlength = 500.0\n'


def figures_of(
    tmp_path: Path,
    text: str = SAW,
    *,
    master: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0),
    cutting: tuple[int, ...] = (0, 0, 0, 0, 0),
    **slave: tuple[float, ...],
) -> KeyFigures:
    """The figures of five points, one second apart; `slave`: the slave's values, 0 where none are given."""
    file = tmp_path / "scenario.toml"
    file.write_text(text, "utf-8")
    still = (0.0, 0.0, 0.0, 0.0, 0.0)
    values = {
        f"slave.{name}": np.array(slave.get(name, still)) for name in ("position", "velocity", "acceleration", "jerk")
    }
    axis = np.zeros((5, 4))
    axis[:, 0] = master
    scenario = load_scenario(file)
    values["in_sync"] = np.array(cutting, float)
    return compute_key_figures(scenario, Recording(np.arange(5.0), values, axis, [], scenario.settings))


def peak(figures: KeyFigures, name: str) -> Peak:
    (chosen,) = [p for p in figures.peaks if p.name == name]
    return chosen


# --- numbers ---


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (100.0, "100 mm"),
        (0.0021, "0.0021 mm"),
        (1200.0000000001, "1200 mm"),
        (448623.4, "448623 mm"),
        (448600.0, "448600 mm"),
        (12345.6, "12346 mm"),
        (334.9123, "334.9 mm"),
        (-162.3, "-162.3 mm"),
        (0.1 + 0.2, "0.3 mm"),
        (9.99996, "10 mm"),
        (99999.96, "100000 mm"),
        (0.000012345, "0.00001234 mm"),
        (3.6e-12, "3.6e-12 mm"),
        (1.2e12, "1.2e12 mm"),
        (123456789.0, "123456789 mm"),
        (0.0, "0 mm"),
        (-0.0, "0 mm"),
    ],
)
def test_numbers_are_as_engineers_write_them(value: float, text: str) -> None:
    assert engineering(value, "mm") == text


def test_what_is_rounding_is_called_so() -> None:
    assert engineering(3.6e-12, "mm", scale=1000.0) == "0 (to rounding)"
    assert engineering(-1e-6, "mm", scale=1000.0) == "0 (to rounding)"
    assert engineering(2e-6, "mm", scale=1000.0) == "0.000002 mm"
    assert engineering(0.0, "mm", scale=1000.0) == "0 mm"
    assert engineering(7.0) == "7"


def test_the_velocity_of_a_line_is_in_metres_per_minute_too() -> None:
    """60 s of 2/3 m; a unit of positions that is no length has none."""
    assert line_speed(2000.0 / 3.0, "mm") == "666.7 mm/s (40 m/min)"
    assert line_speed(0.5, "m") == "0.5 m/s (30 m/min)"
    assert line_speed(90.0, "deg") == "90 deg/s"
    assert line_speed(2.0, "1") == "2 1/s"


# --- peaks ---


def test_a_peak_is_reported_beside_its_limit(tmp_path: Path) -> None:
    result = figures_of(tmp_path, velocity=(0.0, 900.0, -1300.0, 0.0, 0.0), jerk=(0.0, 0.0, -50000.00001, 20000.0, 0.0))
    velocity, jerk = peak(result, "velocity"), peak(result, "jerk")
    assert (velocity.least, velocity.greatest, velocity.value) == (-1300.0, 900.0, 1300.0)
    assert (velocity.at, velocity.limit, velocity.exceeded) == (2.0, 1000.0, True)
    assert velocity.text == "velocity 1300 mm/s at 2 s, limit 1000 mm/s"
    assert not jerk.exceeded  # by 2e-10 of the limit: rounding
    assert jerk.text == "jerk 50000 mm/s3, limit 50000 mm/s3"


def test_acceleration_and_deceleration_have_limits_of_their_own(tmp_path: Path) -> None:
    """Backwards, a negative acceleration is one; a slave at rest accelerates if it moves that way afterwards."""
    result = figures_of(
        tmp_path,
        velocity=(0.0, -100.0, -400.0, -100.0, 0.0),
        acceleration=(-4500.0, -3000.0, 0.0, 5500.0, 5800.0),
    )
    speeding, slowing = peak(result, "acceleration"), peak(result, "deceleration")
    assert (speeding.value, speeding.at, speeding.limit, speeding.exceeded) == (4500.0, 0.0, 4000.0, True)
    assert (slowing.value, slowing.at, slowing.limit, slowing.exceeded) == (5800.0, 4.0, 6000.0, False)
    assert slowing.text == "deceleration 5800 mm/s2, limit 6000 mm/s2"


def test_a_limit_that_changes_on_the_way_counts_from_then_on(tmp_path: Path) -> None:
    later = '\n[[set]]\nat = 2.0\n"axis.max_velocity" = 500.0\n'
    run = (0.0, 900.0, 900.0, 600.0, 0.0)
    assert not peak(figures_of(tmp_path, velocity=run), "velocity").exceeded
    result = peak(figures_of(tmp_path, SAW + later, velocity=run), "velocity")
    assert (result.at, result.limit, result.exceeded) == (3.0, 500.0, True)


def test_the_stroke_is_shown_with_the_end_positions(tmp_path: Path) -> None:
    """The lower end position is not given: the block's own is a thousand kilometres away and bounds nothing."""
    stroke = peak(figures_of(tmp_path, position=(0.0, -162.34, 575.5, 650.0, 1e-13)), "position")
    assert (stroke.least, stroke.greatest, stroke.limit, stroke.lower) == (-162.34, 650.0, 650.0, None)
    assert stroke.text == "position -162.3 to 650 mm, limit at most 650 mm"
    both = SAW.replace("[start]", '[start]\n"axis.min_position" = -100.0')
    stroke = peak(figures_of(tmp_path, both, position=(0.0, -162.34, 575.5, 650.0, 0.0)), "position")
    assert stroke.text == "position -162.3 to 650 mm at 1 s, limit -100 to 650 mm"


def test_a_block_without_limits_has_peaks_without_them(tmp_path: Path) -> None:
    text = SAW[: SAW.index("[start]")].replace("FlyingSaw", "Synchronizer") + "[master]\nvelocity = 1.0\n"
    result = figures_of(tmp_path, 'unit = "deg"\n' + text, velocity=(0.0, 2.5, 0.0, 0.0, 0.0))
    assert [p.name for p in result.peaks] == ["position", "velocity", "acceleration", "jerk"]
    assert [(p.limit, p.exceeded, p.limit_text) for p in result.peaks] == [(None, False, "")] * 4
    assert peak(result, "velocity").text == "velocity 2.5 deg/s"


def test_a_limit_of_zero_is_none_where_the_block_says_so(tmp_path: Path) -> None:
    text = (
        'title = "t"\nsource = "s"\nfmu = "Follower"\nslave_unit = "deg"\nstop_time = 4.0\nstep_size = 1.0\n[master]\n'
    )
    free = figures_of(tmp_path, text, velocity=(0.0, 900.0, 0.0, 0.0, 0.0))
    assert peak(free, "velocity").text == "velocity 900 deg/s"
    bound = figures_of(tmp_path, text + "[start]\nmax_speed = 800.0\n", velocity=(0.0, 900.0, 0.0, 0.0, 0.0))
    assert peak(bound, "velocity").text == "velocity 900 deg/s at 1 s, limit 800 deg/s"


# --- cuts ---


def test_the_worst_cut_is_reported_with_its_mark(tmp_path: Path) -> None:
    """The saw is at the master minus 500.25 and minus 1000 while it cuts: 0.25 before the mark, and on it."""
    result = figures_of(
        tmp_path,
        SAW + CUTS,
        master=(400.0, 600.0, 800.0, 1100.0, 1200.0),
        position=(0.0, 99.75, 0.0, 100.0, 0.0),
        cutting=(0, 1, 0, 1, 0),
    )
    assert [(c.mark, c.error) for c in result.cuts] == [(500.0, 0.25), (1000.0, 0.0)]
    assert result.worst == result.cuts[0]
    assert result.worst_text == "0.25 mm"
    assert result.cuts_text == "2 cuts, worst error 0.25 mm (cut 1, mark 500 mm)"
    assert (result.uncut, result.uncut_text) == ((), "")


def test_of_cuts_that_are_exact_none_is_the_worst(tmp_path: Path) -> None:
    """500 + 1e-9 - 500 in numbers of 53 bits: what is left is rounding beside the positions."""
    positions = {"master": (400.0, 600.0, 800.0, 1100.0, 1200.0), "position": (0.0, 100.0 + 1e-9, 0.0, 100.0, 0.0)}
    result = figures_of(tmp_path, SAW + CUTS, cutting=(0, 1, 0, 1, 0), **positions)
    assert result.worst
    assert 0.0 < abs(result.worst.error) < 2e-9
    assert result.cuts_text == "2 cuts, worst error 0 (to rounding)"


def test_marks_that_pass_uncut_are_named(tmp_path: Path) -> None:
    """The saw reaches to 100: of the marks after the place where it starts, those up to 2900 - 100 have gone by."""
    result = figures_of(
        tmp_path,
        SAW + CUTS,
        master=(0.0, 600.0, 1200.0, 2000.0, 2900.0),
        position=(0.0, 100.0, 0.0, 0.0, 0.0),
        cutting=(0, 1, 0, 0, 0),
    )
    assert result.uncut == (1000.0, 1500.0, 2000.0, 2500.0)
    assert result.uncut_text == "4 marks passed uncut: 1000, 1500, 2000, 2500 mm"
    many = figures_of(tmp_path, SAW + CUTS, master=(0.0, 0.0, 0.0, 0.0, 2900.0))
    assert many.uncut_text == "5 marks passed uncut: 500, 1000, … mm"
    assert many.cuts_text == "no cut"


def test_a_mark_within_the_reach_of_the_saw_is_not_lost_yet(tmp_path: Path) -> None:
    """The mark at 2000 is 100 behind the saw's home, where the saw can be."""
    result = figures_of(
        tmp_path,
        SAW + CUTS,
        master=(0.0, 600.0, 1100.0, 1600.0, 2100.0),
        position=(0.0, 100.0, 100.0, 100.0, 0.0),
        cutting=(0, 1, 1, 1, 0),
    )
    assert 2000.0 not in result.uncut


@pytest.mark.parametrize(("ratio", "away"), [(1.0, 0.0), (2.0, 0.0), (-1.0, 0.0), (1.0, 250.0)])
def test_marks_are_counted_in_both_directions(tmp_path: Path, ratio: float, away: float) -> None:
    """Backwards from 100 - `away`, offset 50: the marks at -450 and -950 pass the saw that rests at 0."""
    text = SAW + CUTS + f"ratio = {ratio}\noffset = 50.0\n"
    result = figures_of(tmp_path, text, master=(40.0 - away, 0.0, -500.0, -900.0, -1000.0))
    assert result.uncut == (-450.0, -950.0)


def test_the_tolerance_of_cuts_is_a_tenth_of_a_millimetre(tmp_path: Path) -> None:
    for unit, tolerance in (("mm", 0.1), ("m", 1e-4), ("deg", 0.05), ("rad", 0.05), ("1", 0.05)):
        result = figures_of(tmp_path, f'unit = "{unit}"\n' + SAW + CUTS)
        assert result.tolerance == pytest.approx(tolerance, rel=1e-15)
    assert figures_of(tmp_path, SAW + CUTS + "tolerance = 0.7\n").tolerance == 0.7
    assert figures_of(tmp_path).tolerance is None
    assert figures_of(tmp_path).cuts_text == ""
